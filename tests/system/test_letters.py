#!/usr/bin/env python3
"""Each letter that a boot can fail with: what 'mcanopen boot' prints, and what to do about it.

One line is compared from its beginning to its end, so that an engineer finds in it the node, the
object, what was expected and what came, the abort code in words, file and line, and an advice.
"""
import re

import plant
from devices import UNSIGNED8, UNSIGNED32, Entry, Record, dcf, network, node, standard

QUICK = {"Boot_Delay": 100}
ASKED = "the state of this node, which is to be kept alive (NMT_Check_Nodestate), is not known; " \
        "it is not reset: reset it by hand"
NO_OBJECT = "the node answers abort 06020000h, object does not exist"
WRONG = "wrong device at node 5, or remove {} to skip the check"
ALIVE = {"NMT_Check_Nodestate": "TRUE"}
VERIFIED = {"NMT_Verify_Software": "TRUE", "Software_Identification": "0x22"}


class Letters(plant.PlantTest):
    """Node 5, the pump: vendor 29Ah, product 1, program 11h, no heartbeat."""

    def setUp(self):
        super().setUp()
        program = Record(0x1F56, [Entry(0x1F56, UNSIGNED32, "0x11", "ro")])
        entry = Entry(0x2000, UNSIGNED8, 0, "rw")
        self.device = self.write("device.dcf", dcf(5, [*standard(5), program, entry]))
        self.write("program.bin", "program")
        self.start_sim("--node", 5, self.device)

    def line_of(self, **values):
        """What is told of the failure, without the node's name; it stands in the table, too."""
        xml = self.write("network.xml", network([node(5, Name="pump", **values)], **QUICK))
        boot = self.boot("--once", "--all", "--timeout", 3, xml, code=1)
        found = re.search(r'^ *[\d.]+  error: node 5 "pump": (boot error .*)$', boot.out.text(),
                          re.M)
        self.assertIsNotNone(found, boot.story())
        rows = [line for line in boot.out.lines if line.startswith("   5  pump")]
        self.assertIn(found.group(1), rows[-1])
        plant.say(found.group(1))
        return found.group(1)

    def test_identity(self):
        """C, D, M, N, O: another device"""
        for letter, place, is_, element in (
                ("C", "1000h:00 device type", 0x20192, "Device_Type_Identification"),
                ("D", "1018h:01 vendor-ID", 0x29A, "Vendor_Identification"),
                ("M", "1018h:02 product code", 1, "Product_Code"),
                ("N", "1018h:03 revision number", 0x10001, "Revision_Number"),
                ("O", "1018h:04 serial number", 5, "Serial_Number")):
            self.assertEqual(self.line_of(**{element: "0x77"}),
                             f"boot error {letter}: {place} is {is_:08X}h, configuration expects "
                             f"00000077h: {WRONG.format(element)}")

    def test_state(self):
        """E: a node that is to be kept alive does not tell its state (F: test_boot_text)"""
        self.assertEqual(self.line_of(Consumer_Heartbeat_Time=300, **ALIVE),
                         f"boot error E: no heartbeat within 300 ms: {ASKED}")

    def test_software(self):
        """G, H, I: its program"""
        self.assertEqual(self.line_of(NMT_Verify_Software="TRUE"),
                         "boot error G: Software_Identification is missing: NMT_Verify_Software "
                         "has nothing to compare with")
        self.assertEqual(self.line_of(**VERIFIED),
                         "boot error H: 1F56h:01 software identification is 00000011h, "
                         "configuration expects 00000022h: update it, or set "
                         "NMT_Allow_Software_Update")
        self.assertEqual(self.line_of(NMT_Allow_Software_Update="TRUE",
                                      Software_File="program.bin", **VERIFIED),
                         f"boot error I: stop its program, 1F51h:01: {NO_OBJECT}: the device has "
                         "no program download: update it by its own tool")

    def test_configuration(self):
        """J: a write of the file"""
        text = self.device.read_text(encoding="utf-8").replace("0x2000", "0x2001")
        text = text.replace("[2000]", "[2001]").replace("DataType=0x0005\nAccessType=rw\n",
                                                        "DataType=0x0005\nAccessType=rw\n"
                                                        "ParameterValue=9\n")
        self.write("other.dcf", text)
        line = text[:text.index("ParameterValue=9")].count("\n") + 1
        self.assertEqual(self.line_of(DCF_File="other.dcf"),
                         f"boot error J: write 2001h:00 = 09h (entry 1 of 1 of other.dcf, line "
                         f"{line}): {NO_OBJECT}: is the file of another device, or of another "
                         f"version of it?")

    def test_heartbeat(self):
        """K: no heartbeat, and what the file says of it"""
        self.assertEqual(self.line_of(Consumer_Heartbeat_Time=300),
                         "boot error K: no heartbeat within 300 ms (Consumer_Heartbeat_Time): the "
                         "configuration does not set 1017h: add it, with a half of that time")

    def test_absent(self):
        """B: nothing there"""
        xml = self.write("network.xml", network([node(6, Name="valve", SDO_Timeout=100)], **QUICK))
        boot = self.boot("--once", "--all", "--timeout", 1.5, xml, code=1)
        self.assertIn('error: node 6 "valve": boot error B: read 1000h:00 device type: no answer '
                      "within 100 ms (3 tries): the node is absent or off, or has another node-ID "
                      "or bit rate", boot.out.text())
        rows = [line for line in boot.out.lines if line.startswith("   6  valve")]
        self.assertRegex(rows[-1], r"; tried \d times?$")

    def test_kept_alive(self):
        """L: no error, it was running"""
        xml = self.write("network.xml", network(
            [node(5, Name="pump", Guard_Time=500, Life_Time_Factor=2, **ALIVE)], **QUICK))
        self.boot("--once", "--all", xml)
        boot = self.boot("--once", "--all", xml)
        self.assertIn('node 5 "pump": is running already: kept alive (L)', boot.out.text())
        self.assertNotIn("reset", boot.out.text())


if __name__ == "__main__":
    plant.main()
