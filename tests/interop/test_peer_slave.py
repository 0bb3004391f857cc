#!/usr/bin/env python3
"""'mcanopen boot' boots and configures devices of python-canopen; what they hold is the DCF."""
from peers import EXAMPLE, PeerTest, configured, differences, patient_example, plant
from devices import Entry, Record, dcf, network, node, standard

FILES = {2: "io.dcf", 5: "pump.dcf", 7: "level.dcf", 9: "valve.dcf"}
PATIENT = {"SDO_Timeout": 20000}
LONG = "a text that needs many segments, " * 20

# Data types of CiA 301 with values at their edges. python-canopen packs numbers as they stand in
# the file, so negative ones stand there in decimal.
TYPES = [
    (0x01, "1"), (0x02, "-128"), (0x03, "-32768"), (0x04, "-2147483648"), (0x05, "0xFF"),
    (0x06, "0xFFFE"), (0x07, "0xFFFFFFFE"), (0x08, "1.5"), (0x09, LONG.strip()),
    (0x0A, "00FF10203040506070"), (0x10, "-8388608"), (0x11, "-0.1"), (0x12, "-549755813888"),
    (0x13, "-140737488355328"), (0x14, "-36028797018963968"), (0x15, "-9223372036854775808"),
    (0x16, "0xFEDCBA"), (0x18, "0xFEDCBA9876"), (0x19, "0xFEDCBA987654"),
    (0x1A, "0xFEDCBA98765432"), (0x1B, "0xFEDCBA9876543210"),
]


class PeerSlave(PeerTest):
    def assert_configured(self, device):
        """What it holds is the configuration; what else was written is as it was before."""
        written = device.written()
        different = differences(device.expected, written)
        self.assertEqual(different, [], f"node {device.id}")
        for (index, sub), value in written.items():
            if (index, sub) not in device.expected:
                default = device.object_dictionary.get_variable(index, sub)
                self.assertEqual(value, default.encode_raw(default.default),
                                 f"node {device.id}: {index:04X}h:{sub:02X} is not of its DCF")
        return len(device.expected)

    def test_example(self):
        """the example's four devices, value by value"""
        texts = {number: (EXAMPLE / name).read_text(encoding="utf-8")
                 for number, name in FILES.items()}
        xml = self.write("network.xml", patient_example())
        for number, name in FILES.items():
            self.write(name, texts[number])
        devices = self.add_devices(texts)
        boot = self.boot("--once", "--all", xml)
        values = sum(self.assert_configured(device) for device in devices)
        self.assertGreater(values, 50)
        for device in devices:
            self.assertIn(f"node {device.id} ", boot.out.text())
            self.assertEqual(device.nmt.state, "OPERATIONAL", boot.story())
        self.assertIn("4 of 4 nodes booted", boot.out.text())
        plant.say(f"{values} values in {len(devices)} devices")

    def test_types(self):
        """a value of each data type"""
        entries = [Entry(0x2000, kind, "" if kind in (0x09, 0x0A) else 0, "rw", value)
                   for kind, value in TYPES]
        text = dcf(5, [*standard(5, heartbeat=200), Record(0x2000, entries)])
        device, = self.add_devices({5: text})
        self.assertEqual(len(configured(text, 5)), len(TYPES) + 1)
        self.write("five.dcf", text)
        xml = self.write("network.xml", network([node(5, DCF_File="five.dcf", **PATIENT)]))
        self.boot("--once", "--all", xml)
        self.assert_configured(device)

    def test_refused(self):
        """an object that the device lacks: its abort is told with the object"""
        good = dcf(5, [*standard(5), Entry(0x2000, 5, 0, "rw", 1)])
        more = dcf(5, [*standard(5), Entry(0x2000, 5, 0, "rw", 1), Entry(0x2001, 5, 0, "rw", 1)])
        self.add_devices({5: good})
        self.write("five.dcf", more)
        xml = self.write("network.xml", network([node(5, DCF_File="five.dcf", **PATIENT)]))
        boot = self.boot("--once", "--all", xml, code=1)
        self.assertRegex(boot.out.text(), r"error J: write 2001h:00 .*abort 06020000h")

    def test_wrong_identity(self):
        """another vendor, product code, revision or serial number is told with both values"""
        self.add_devices({5: dcf(5, standard(5))})
        for element, value, told in (
                ("Vendor_Identification", "0x17F", r"D: 1018h:01 vendor-ID is 0000029Ah, "
                                                   r"configuration expects 0000017Fh"),
                ("Product_Code", 2, "M: 1018h:02 product code is 00000001h, "),
                ("Revision_Number", 3, "N: 1018h:03 revision number is 00010001h, "),
                ("Serial_Number", 4, "O: 1018h:04 serial number is 00000005h, "),
                ("Device_Type_Identification", 6, "C: 1000h:00 device type is 00020192h, ")):
            with self.subTest(element):
                xml = self.write("network.xml", network([node(5, **{element: value}, **PATIENT)]))
                boot = self.boot("--once", "--all", xml, code=1)
                self.assertRegex(boot.out.text(), f"error: node 5: boot error {told}")
        self.assertEqual([frame for frame in self.heard.frames if frame.startswith("000#01")], [])

    def test_restarts(self):
        """a device that starts anew in the middle of its configuration: it gets all of it again"""
        text = dcf(5, [*standard(5), *(Entry(0x2000 + n, 5, 0, "rw", n + 1) for n in range(4))])
        device, = self.add_devices({5: text})
        times = []

        def restart(index, **_):
            times.append(index)
            if times.count(0x2002) == 1 and index == 0x2002:
                device.restart()

        device.add_write_callback(restart)
        self.write("five.dcf", text)
        xml = self.write("network.xml", network([node(5, DCF_File="five.dcf", SDO_Timeout=1000)]))
        boot = self.boot("--once", "--all", xml)
        self.assert_configured(device)
        self.assertEqual(times.count(0x2000), 2, times)
        self.assertGreaterEqual(boot.out.text().count("node 5: boot-up message"), 2)
        self.assertEqual(device.nmt.state, "OPERATIONAL")

    def test_no_guarding(self):
        """python-canopen answers no remote frames: its device is told lost, and booted again"""
        text = dcf(5, standard(5))
        self.add_devices({5: text})
        guarded = node(5, Guard_Time=50, Life_Time_Factor=4, **PATIENT)
        boot = self.start_boot(self.write("network.xml", network([guarded])))
        boot.wait_for("node 5: booted")
        self.heard.wait_for("705#R")
        boot.wait_for("error: node 5: no answer to guarding for 200 ms")
        boot.wait_for("node 5: booted", times=2)
        boot.stop()

    def test_emergency(self):
        """its emergencies and the end of its heartbeat are reported"""
        text = dcf(5, standard(5, heartbeat=100))
        device, = self.add_devices({5: text})
        self.write("five.dcf", text)
        watched = node(5, DCF_File="five.dcf", Consumer_Heartbeat_Time=2000, **PATIENT)
        boot = self.start_boot(self.write("network.xml", network([watched])))
        boot.wait_for("node 5: is operational")
        device.emcy.send(0x5530, 0x05, b"\x01\x02\x03\x04\x05")
        boot.wait_for("emergency 5530h")
        self.assertIn("error register 05h, field 01 02 03 04 05", boot.out.text())
        device.nmt.stop_heartbeat()
        boot.wait_for("heartbeat lost")
        boot.wait_for("node 5: booted", times=2)
        self.assert_configured(device)
        self.assert_stopped(boot)


if __name__ == "__main__":
    plant.main()
