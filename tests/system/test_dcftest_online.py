#!/usr/bin/env python3
"""dcftest --online: simulated devices against their DCF."""
import json
import os

import plant
from dcftest import CLEAN, ERRORS, NO_BUS, TROUBLE, DcftestTest, device, with_error
from devices import (UNSIGNED8, UNSIGNED16, UNSIGNED32, VISIBLE_STRING, Entry, Record, dcf,
                     standard)

CONFORM_EDS = plant.DATA / "conform.eds"
INTEGER24, REAL32 = 0x10, 0x08


class Online(DcftestTest):
    """A simulated device against its DCF."""

    OBJECTS = [Entry(0x2000, UNSIGNED8, 7), Entry(0x2001, UNSIGNED16, 500),
               Entry(0x2002, VISIBLE_STRING, "pump"), Entry(0x2003, UNSIGNED32, 1, "wo"),
               Record(0x2004, [Entry(0x2004, INTEGER24, -5), Entry(0x2004, REAL32, 1.5)])]

    def start_device(self, objects=None, **options):
        objects = objects or [*standard(5), *self.OBJECTS]
        path = self.write("device.eds", dcf(None, objects))
        return self.start_sim("--node", 5, path, **options)

    def file_with(self, **values):
        """The DCF of that device with these ParameterValues."""
        text = dcf(5, [*standard(5), *self.OBJECTS])
        for name, value in values.items():
            text = text.replace(f"[{name}]\n", f"[{name}]\nParameterValue={value}\n")
        self.write("a.dcf", text)
        return text

    def compare(self, code, *arguments):
        """Lines of stdout and the text of stderr."""
        done = self.run_tool("--online", "-i", self.bus.name, *arguments)
        self.assertEqual(done.returncode, code, done.out + done.err)
        return done.out.splitlines(), done.err

    def test_same(self):
        self.start_device()
        self.file_with(**{"2000": 7, "2001": 0x1F4, "2002": "pump", "2003": 9, "2004sub1": -5,
                          "2004sub2": 1.5})
        lines, count = self.compare(CLEAN, "-n", 5, "a.dcf")
        self.assertEqual(lines, [])
        self.assertEqual(count, f"node 5 on {self.bus.name}: 14 entries read, 9 values compared; 0 "
                         "differ, 0 cannot be read; left out: 1 write-only, 0 by ObjFlags, 0 "
                         "domains\n")

    def test_values(self):
        """Only the differences are told, in the order of the file, whatever their type."""
        self.start_device()
        text = self.file_with(**{"2000": 7, "2001": 1000, "2002": "drive", "2004sub1": -6,
                                 "2004sub2": 2})
        lines, _ = self.compare(ERRORS, "-n", 5, "a.dcf")
        self.assertEqual(lines, [f"a.dcf:{self.line_of(text, key)}: warning: {rest} [online-value]"
                                 for key, rest in [
            ("ParameterValue=1000", "2001h:00: DCF 1000 (3E8h), device 500 (1F4h)"),
            ("ParameterValue=drive", '2002h:00: DCF "drive", device "pump"'),
            ("ParameterValue=-6", "2004h:01: DCF -6, device -5"),
            ("ParameterValue=2", "2004h:02: DCF 2, device 1.5")]])

    @staticmethod
    def line_of(text, line):
        return text.splitlines().index(line) + 1

    def test_two_values_of_a_running_device(self):
        """What somebody has changed by hand; the file's NodeID is the device's."""
        self.write("a.dcf", dcf(5, [*standard(5, heartbeat=500), *self.OBJECTS]))
        self.start_device(None)
        lines, _ = self.compare(ERRORS, "a.dcf")
        self.assertEqual(len(lines), 1)
        self.assertIn("1017h:00: DCF 500 (1F4h), device 0 [online-value]", lines[0])

    def test_forms(self):
        self.start_device()
        text = self.file_with(**{"2004sub1": 1})
        for form in ("--json", "--sarif"):
            lines, _ = self.compare(ERRORS, form, "a.dcf")
            found = json.loads("\n".join(lines))
            if form == "--json":
                message = found["files"][0]["messages"][0]
                self.assertEqual([message[key] for key in ("line", "rule", "index", "sub")],
                                 [self.line_of(text, "ParameterValue=1"), "online-value", 0x2004,
                                  1])
            else:
                self.assertEqual(found["runs"][0]["results"][0]["ruleId"], "online-value")
        self.assertEqual(self.compare(ERRORS, "-q", "a.dcf"), ([], ""))
        self.assertEqual(self.compare(CLEAN, "--no-rule=online-value", "-q", "a.dcf"), ([], ""))

    def test_absent_objects(self):
        self.start_device([*standard(5), *self.OBJECTS[:2],
                           Record(0x2004, self.OBJECTS[4].entries[1:2])])
        text = self.file_with()
        lines, count = self.compare(ERRORS, "a.dcf")
        self.assertEqual(lines, [
            f"a.dcf:{self.line_of(text, '[2002]')}: warning: 2002h:00: the device does not have "
            "it: abort 06020000h, object does not exist [online-object]",
            f"a.dcf:{self.line_of(text, '[2004sub2]')}: warning: 2004h:02: the device does not "
            "have it: abort 06090011h, sub-index does not exist [online-object]"])
        self.assertIn("2 cannot be read", count)

    def test_types(self):
        self.start_device([*standard(5), Entry(0x2000, UNSIGNED16, 7), Entry(0x2001, UNSIGNED8, 7),
                           *self.OBJECTS[2:]])
        self.file_with(**{"2000": 7})
        lines, _ = self.compare(ERRORS, "a.dcf")
        self.assertEqual([line.split("warning: ")[1] for line in lines], [
            "2000h:00: size 1 expected (of its data type), the device has size 2 [online-size]",
            "2001h:00: size 2 expected (of its data type), the device has size 1 [online-size]"])

    def test_identity(self):
        """The device type, and what [DeviceInfo] says; the node-ID."""
        self.start_device([*standard(5, vendor=0x29B), *self.OBJECTS])
        self.write("a.dcf", dcf(6, [*standard(5), *self.OBJECTS])
                   .replace("DefaultValue=0x20192", "DefaultValue=0x20193"))
        lines, _ = self.compare(ERRORS, "--node-id=5", "a.dcf")
        self.assertEqual([line.split("warning: ")[1] for line in lines], [
            "NodeID is 6, the device that is asked has node-ID 5 [online-identity]",
            "1000h:00: DCF 131475 (20193h), device 131474 (20192h) [online-identity]",
            "1018h:01: DCF 666 (29Ah), device 667 (29Bh) [online-identity]"])

    def test_all(self):
        """DefaultValues are looked at on demand; an EDS has nothing else."""
        self.start_device()
        self.write("a.eds", dcf(None, [*standard(5), Entry(0x2000, UNSIGNED8, 8)]))
        self.assertEqual(self.compare(CLEAN, "-n5", "a.eds")[0], [])
        lines, _ = self.compare(ERRORS, "-n5", "--all", "a.eds")
        self.assertEqual(len(lines), 1)
        self.assertIn("2000h:00: EDS 8, device 7 [online-value]", lines[0])

    def test_left_out(self):
        """ObjFlags bit 1 refuses to be read by a scan; domains are not asked for, either."""
        self.start_device()
        text = self.file_with(**{"2000": "9\nObjFlags=2"})
        self.write("a.dcf", text.replace("DataType=0x0006\nAccessType=rw\nDefaultValue=500",
                                         "DataType=0xF\nAccessType=rw"))
        dump = self.dump()
        _, count = self.compare(CLEAN, "--rule", "online-value", "a.dcf")
        self.assertIn("left out: 1 write-only, 1 by ObjFlags, 1 domains", count)
        asked = [frame for frame in dump.end() if frame.startswith("605#")]
        self.assertFalse([frame for frame in asked if frame[7:13] in ("002000", "012000")])

    def test_nothing_but_reading(self):
        """The plant goes on: no NMT command, no write."""
        self.start_device()
        self.file_with(**{"2001": 9, "2002": "a text that is longer than a frame"})
        dump = self.dump()
        self.compare(ERRORS, "--all", "a.dcf")
        frames = [frame for frame in dump.end() if not frame.startswith("585#")]
        self.assertGreater(len(frames), 10)
        for frame in frames:
            self.assertRegex(frame, r"^605#(40|60|70)")

    def test_defects(self):
        """Devices that do not do what their EDS says."""
        for defect, place, rule in [
                ("od-type", "1000h:00", "online-identity"),
                ("od-identity", "1018h:02", "online-identity"),
                ("od-length", "1001h:00", "online-size"),
                ("od-mandatory", "1001h:00", "online-object"),
                ("od-default", "2001h:00", "online-value"),
                ("sdo-upload-toggle", "1008h:00", "online-object"),
                ("sdo-size", "1008h:00", "online-object")]:
            with self.subTest(defect):
                sim = self.start_sim("--node", 5, CONFORM_EDS, "--defect", defect)
                lines, _ = self.compare(ERRORS, "-n5", "--all", CONFORM_EDS)
                self.assertTrue(any(f"{place}: " in line and line.endswith(f"[{rule}]")
                                    for line in lines), lines)
                sim.stop()
        self.start_sim("--node", 5, CONFORM_EDS)
        self.assertEqual(self.compare(CLEAN, "-n5", "--all", CONFORM_EDS)[0], [])

    def test_one_object_without_answer(self):
        """It is asked for twice; then another object tells that the device is there."""
        gate = plant.Gate(self, "585#4F002000")
        self.start_device(bus=gate.inner)
        text = self.file_with()
        dump = self.dump()
        process = self.start([plant.TOOLS / "dcftest", "--online", "-i", self.bus.name,
                              "--timeout=1000", "a.dcf"], cwd=self.folder)
        gate.wait()
        dump.wait_for("605#4000100000000000", times=2)
        gate.let_pass()
        self.assertEqual(process.wait(), ERRORS, process.story())
        self.assertEqual(process.out.text(),
                         f"a.dcf:{self.line_of(text, '[2000]')}: warning: 2000h:00: the device "
                         "gives no answer within 1000 ms, to others it does [online-object]")
        self.assertEqual(dump.frames().count("605#4000200000000000"), 2)

    def test_device_that_goes_away(self):
        """What was found until then is told."""
        gate = plant.Gate(self, "585#4F002000")
        self.start_device(bus=gate.inner)
        self.write("a.dcf", dcf(5, [*standard(5, heartbeat=7), *self.OBJECTS]))
        lines, text = self.compare(NO_BUS, "--timeout=100", "a.dcf")
        self.assertEqual(len(lines), 1)
        self.assertIn("1017h:00: DCF 7, device 0", lines[0])
        self.assertIn("node 5 does not answer to 2000h:00 within 100 ms", text)

    def test_somebody_else(self):
        """Another client of the same SDO server may get our answers, and we his."""
        self.file_with()
        flood = self.start([plant.TOOLS.parent / "tests" / "flood", self.bus.name, 10 ** 6,
                            "605#4001100000000000"])
        flood.wait_for("flooding")
        _, text = self.compare(NO_BUS, "a.dcf")
        self.assertRegex(text, "somebody else has sent [0-9]+ requests to the SDO server of node 5")
        flood.kill()

    def test_no_answer(self):
        self.file_with()
        lines, text = self.compare(NO_BUS, "--timeout=10", "a.dcf")
        self.assertEqual(lines, [])
        self.assertEqual(text, "dcftest: node 5 does not answer to 1000h:00 within 10 ms: it is "
                         "absent, off or stopped, or has another node-ID or bit rate\n")

    def test_no_bus(self):
        self.file_with()
        done = self.run_tool("--online", "-i", "nocan9", "a.dcf")
        self.assertEqual((done.returncode, done.out), (NO_BUS, ""))
        self.assertIn("nocan9", done.err)

    def test_environment(self):
        """Without -i it is the bus of network 0."""
        self.start_device()
        self.file_with()
        done = self.run_tool("--online", "a.dcf",
                             env={**os.environ, "MCANOPEN_NET_0": self.bus.name})
        self.assertEqual((done.returncode, done.out), (CLEAN, ""))

    def test_slow_bus(self):
        """Frames take their time; so many answers are waited for."""
        if self.bus.interface:
            self.skipTest("an interface has a bit rate of its own")
        self.bus.name += "?bitrate=50000"
        self.addCleanup(self.remove_slow_bus, self.bus.name)
        self.start_device()
        self.file_with(**{"2001": 9})
        self.assertEqual(len(self.compare(ERRORS, "a.dcf")[0]), 1)

    def remove_slow_bus(self, name):
        self.bus.name = name.partition("?")[0]

    def test_bad_files(self):
        self.write("a.dcf", with_error())
        lines, _ = self.compare(ERRORS, "a.dcf")
        self.assertRegex(lines[0], r"^a\.dcf:\d+: error: ")
        self.assertEqual(self.compare(ERRORS, "no.dcf")[0],
                         ["no.dcf: error: no such file [unreadable]"])
        self.write("b.eds", device(None))
        lines, text = self.compare(TROUBLE, "b.eds")
        self.assertEqual(lines, [])
        self.assertIn("-n: the node-ID of the device expected", text)

    def test_usage(self):
        self.write("a.dcf", device())
        self.refuse("one file expected", "--online", "a.dcf", "a.dcf")
        self.refuse("a file or a folder expected", "--online")
        self.refuse("1..60000", "--online", "--timeout=0", "a.dcf")
        self.refuse("belong to --online", "-i", "can0", "a.dcf")
        self.refuse("belong to --online", "--all", "a.dcf")
        self.refuse("no --eds", "--online", "--eds", "a.dcf", "a.dcf")


if __name__ == "__main__":
    plant.main()
