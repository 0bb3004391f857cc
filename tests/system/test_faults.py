#!/usr/bin/env python3
"""Networks that do not come up, or only later: what 'mcanopen boot' says and with which exit code.

Simulated devices from one or two processes, which are missing, wrong, refuse, or are killed.
"""
import re
import signal

import plant
from devices import UNSIGNED8, Entry, dcf, network, node, standard

UP, NOT_UP = 0, 1
PATIENT = {"SDO_Timeout": 20000}
IMPATIENT = {"SDO_Timeout": 100}
HASTY = {"Boot_Delay": 100}
FIVE = {"DCF_File": "five.dcf", **PATIENT}
MANY = 30000  # writes: they take longer than it takes to kill a process


def switch(value=None, high=None):
    entry = Entry(0x2000, UNSIGNED8, 0, "rw", value)
    text = dcf(5, [*standard(5), entry])
    if high is None:
        return text
    return text.replace("DefaultValue=0\nPDOMapping=0\n\n",
                        f"DefaultValue=0\nLowLimit=0\nHighLimit={high}\n\n")


class FaultTest(plant.PlantTest):
    def setUp(self):
        super().setUp()
        self.five = self.write("five.dcf", switch(0x21))
        self.six = self.write("six.dcf", dcf(6, standard(6, heartbeat=100)))

    def network(self, *nodes, **values):
        return self.write("network.xml", network(nodes, **{**HASTY, **values}))

    def assert_said(self, process, pattern):
        """A line of stdout that is like this."""
        text = process.out.text()
        found = re.search(pattern, text, re.MULTILINE)
        self.assertIsNotNone(found, f"{pattern}\n{process.story()}")
        line = text[text.rfind("\n", 0, found.start()) + 1:]
        plant.say(line.splitlines()[0].strip())

    def row(self, process, node_id):
        """The node's line of the last table."""
        rows = [line for line in process.out.text().splitlines()
                if re.match(rf" *{node_id}  .* (mandatory|optional) ", line)]
        self.assertTrue(rows, process.story())
        return rows[-1]


class Absent(FaultTest):
    def test_mandatory(self):
        """a mandatory node is absent, with Boot_Time: not started, exit code 1"""
        self.start_sim("--node", 6, self.six)
        xml = self.network(node(5, NMT_Mandatory_Slave="TRUE", **IMPATIENT), node(6, **PATIENT),
                           Boot_Time=1000)
        dump = self.dump()
        boot = self.boot("--once", xml, code=NOT_UP)
        self.assert_said(boot, r"error: node 5: boot error B: read 1000h:00 .* no answer within"
                               r" 100 ms \(3 tries\)")
        self.assert_said(boot, r"error: network not started: mandatory node 5 is missing"
                               r" after 1000 ms \(Boot_Time\)")
        self.assertIn("MISSING: boot error B", self.row(boot, 5))
        self.assertNotIn("000#0106", dump.end(), "a node was started")

    def test_optional(self):
        """an optional node is absent: up, exit code 0"""
        self.start_sim("--node", 6, self.six)
        xml = self.network(node(5, **IMPATIENT), node(6, **PATIENT))
        boot = self.boot("--once", xml)
        self.assert_said(boot, r"network is up: 1 of 2 nodes booted")
        self.assertIn("MISSING", self.row(boot, 5))
        self.assertIn("booted", self.row(boot, 6))

    def test_everybody(self):
        """no node answers: it is rather the bus; not where one does, with whatever"""
        xml = self.network(node(5, **IMPATIENT), node(6, **IMPATIENT), node(7, NMT_Slave="FALSE"))
        boot = self.boot("--once", "--all", "--timeout", 1, xml, code=NOT_UP)
        self.assert_said(boot, r"^no node answers: check the cable, its termination, ")
        self.start_sim("--node", 6, self.six)
        xml = self.network(node(5, **IMPATIENT), node(6, Vendor_Identification=1, **PATIENT))
        boot = self.boot("--once", "--all", "--timeout", 1, xml, code=NOT_UP)
        self.assertNotIn("no node answers", boot.out.text())

    def test_all(self):
        """an optional node is absent, with --all and --timeout: exit code 1 after that time"""
        self.start_sim("--node", 6, self.six)
        xml = self.network(node(5, **IMPATIENT), node(6, **PATIENT))
        boot = self.boot("--once", "--all", "--timeout", 1.5, xml, code=NOT_UP)
        self.assert_said(boot, r"^not up within 1\.5 s$")
        self.assertIn("MISSING", self.row(boot, 5))

    def test_left_out(self):
        """a node with NMT_Slave FALSE is nobody's concern, with --all as well"""
        self.start_sim("--node", 6, self.six)
        xml = self.network(node(5, NMT_Slave="FALSE"), node(6, **PATIENT))
        boot = self.boot("--once", "--all", xml)
        self.assertRegex(self.row(boot, 5), r"offline +not booted by this master$")

    def test_pipe(self):
        """a network's file that can be read but once"""
        xml = self.network(node(5, NMT_Mandatory_Slave="TRUE", **IMPATIENT), Boot_Time=100)
        boot = self.run_command(
            ["sh", "-c", f"cat '{xml}' | '{plant.MCANOPEN}' boot --once /dev/stdin"])
        self.assertEqual(boot.code, NOT_UP, boot.story())
        self.assertIn("MISSING", self.row(boot, 5))

    def test_timeout(self):
        """--timeout alone, mandatory node absent without Boot_Time"""
        xml = self.network(node(5, NMT_Mandatory_Slave="TRUE", **IMPATIENT))
        boot = self.boot("--once", "--timeout", 1, xml, code=NOT_UP)
        self.assert_said(boot, r"^not up within 1\.0 s$")


class Wrong(FaultTest):
    """These end at once: what is wrong does not mend itself."""

    def boot_wrong(self, expected, **values):
        sim = self.start_sim("--node", 5, self.five)
        xml = self.network(node(5, Name="pump", **FIVE, **values))
        boot = self.boot("--once", "--all", xml, code=NOT_UP)
        self.assert_said(boot, r'error: node 5 "pump": boot error ' + expected)
        self.assertIn("FAILED: boot error", self.row(boot, 5))
        self.assert_stopped(sim)

    def test_device_type(self):
        """another device type"""
        self.boot_wrong(r"C: 1000h:00 device type is 00020192h, configuration expects 00030191h: "
                        r"wrong device at node 5", Device_Type_Identification="0x30191")

    def test_vendor(self):
        """another vendor"""
        self.boot_wrong(r"D: 1018h:01 vendor-ID is 0000029Ah, configuration expects 0000017Fh: "
                        r"wrong device at node 5, or remove Vendor_Identification",
                        Vendor_Identification="0x17F")

    def test_identity(self):
        """another product code, revision number, serial number"""
        self.boot_wrong("M: 1018h:02 product code is 00000001h", Product_Code=2)
        self.boot_wrong("N: 1018h:03 revision number is 00010001h", Revision_Number=2)
        self.boot_wrong("O: 1018h:04 serial number is 00000005h", Serial_Number=2)

    def test_refused_write(self):
        """the device has no such object, a read-only one, or one with another limit"""
        xml = self.network(node(5, **FIVE))
        devices = {"06020000h": dcf(5, standard(5)),
                   "06010002h": switch().replace("AccessType=rw\nDefaultValue=0\nPDOMapping=0\n\n",
                                                 "AccessType=ro\nDefaultValue=0\n\n"),
                   "06090031h": switch(high=0x20)}
        for code, text in devices.items():
            with self.subTest(code):
                sim = self.start_sim("--node", 5, self.write("real.dcf", text))
                boot = self.boot("--once", "--all", xml, code=NOT_UP)
                self.assert_said(boot, r"error: node 5: boot error J: write 2000h:00 = 21h "
                                       rf"\(entry 1 of 1 of five.dcf, line \d+\): "
                                       rf".* abort {code}, \w")
                self.assert_stopped(sim)

    def test_optional(self):
        """a wrong optional node does not hold the others up: exit code 0 without --all"""
        self.start_sim("--node", 5, self.five, "--node", 6, self.six)
        xml = self.network(node(5, Vendor_Identification=1, **PATIENT), node(6, **PATIENT))
        boot = self.boot("--once", xml)
        self.assert_said(boot, r"network is up: 1 of 2 nodes booted")
        self.assertIn("FAILED", self.row(boot, 5))

    def test_no_heartbeat(self):
        """a node that is to send heartbeats, and is not told to"""
        self.start_sim("--node", 5, self.five)
        xml = self.network(node(5, Consumer_Heartbeat_Time=300, **PATIENT))
        boot = self.boot("--once", xml)
        self.assert_said(boot, r"error: node 5: boot error K: no heartbeat within 300 ms")


class Killed(FaultTest):
    def test_in_boot(self):
        """a device is killed in the middle of its configuration: the others boot on"""
        entry = (0x2000).to_bytes(2, "little") + b"\x00" + (1).to_bytes(4, "little") + b"\x07"
        (self.folder / "long.ccf").write_bytes(MANY.to_bytes(4, "little") + entry * MANY)
        sim = self.start_sim("--node", 5, self.five)
        self.start_sim("--node", 6, self.six)
        xml = self.network(node(5, CCF_File="long.ccf", SDO_Timeout=2000),
                           node(6, Consumer_Heartbeat_Time=30000, DCF_File="six.dcf", **PATIENT))
        dump = self.dump()
        boot = self.start_boot("--once", xml)
        dump.wait_for("605#2F002000", times=100)
        sim.kill()
        self.assertEqual(boot.wait(), UP, boot.story())
        self.assert_said(boot, r"error: node 5: boot error J: write 2000h:00 = 07h "
                               rf"\(entry \d+ of {MANY} of long.ccf\): no answer within 2000 ms")
        self.assertIn("MISSING", self.row(boot, 5))
        self.assertIn("booted", self.row(boot, 6))

    def test_in_operation(self):
        """a device is killed in operation and comes back: lost, booted and started again"""
        sim = self.start_sim("--node", 6, self.six)
        xml = self.network(node(6, Consumer_Heartbeat_Time=1500, DCF_File="six.dcf", **PATIENT))
        boot = self.start_boot("--all", xml)
        boot.wait_for("node 6: is operational")
        sim.kill()
        boot.wait_for("heartbeat lost")
        self.start_sim("--node", 6, self.six)
        boot.wait_for("node 6: is operational", times=2)
        self.assertEqual(boot.stop(signal.SIGINT), UP, boot.story())
        self.assert_said(boot, "error: node 6: heartbeat lost: silent for 1500 ms, was operational")

    def test_boot_again(self):
        """the manager is killed in operation and started again"""
        self.start_sim("--node", 6, self.six)
        xml = self.network(node(6, Consumer_Heartbeat_Time=30000, DCF_File="six.dcf", **PATIENT))
        for _ in range(2):
            boot = self.start_boot(xml)
            boot.wait_for("network is up")
            boot.kill()
        self.boot("--once", "--all", xml)


class Late(FaultTest):
    def test_sigint(self):
        """stay mode: the table when it is up, again at Ctrl-C; exit code 0"""
        self.start_sim("--node", 6, self.six)
        xml = self.network(node(6, Consumer_Heartbeat_Time=30000, DCF_File="six.dcf", **PATIENT))
        for number in (signal.SIGINT, signal.SIGTERM):
            boot = self.start_boot("--all", xml)
            boot.wait_for("OPERATIONAL")
            self.assertEqual(boot.stop(number), UP, boot.story())
            tables = [line for line in boot.out.lines if line.startswith("node  name")]
            self.assertEqual(len(tables), 2, boot.story())

    def test_sigint_not_up(self):
        """Ctrl-C while it waits for a mandatory node: exit code 1, with the table"""
        xml = self.network(node(5, NMT_Mandatory_Slave="TRUE", **IMPATIENT))
        boot = self.start_boot(xml)
        boot.wait_for("boot error B")
        self.assertEqual(boot.stop(signal.SIGINT), NOT_UP, boot.story())
        self.assertIn("MISSING", self.row(boot, 5))

    def test_mandatory(self):
        """the network waits for a mandatory node that comes later"""
        xml = self.network(node(5, NMT_Mandatory_Slave="TRUE", **IMPATIENT), node(6, **PATIENT))
        self.start_sim("--node", 6, self.six)
        dump = self.dump()
        boot = self.start_boot("--once", xml)
        boot.wait_for("boot error B")
        self.start_sim("--node", 5, self.five)
        self.assertEqual(boot.wait(), UP, boot.story())
        self.assert_said(boot, "network is up: 2 of 2 nodes booted")
        self.assert_said(boot, r"^node 5 has booted after \d+ failed attempts?, the last one: "
                               r"boot error B: read 1000h:00 device type: no answer")
        self.assertNotIn("node 6 has booted after", boot.out.text())
        starts = [frame for frame in dump.end() if frame.startswith("000#01")]
        self.assertEqual(sorted(starts), ["000#0105", "000#0106"])

    def test_optional(self):
        """an optional node comes when the network is up: booted, started alone"""
        xml = self.network(node(5, **IMPATIENT), node(6, **PATIENT))
        self.start_sim("--node", 6, self.six)
        dump = self.dump()
        boot = self.start_boot("--timeout", 600, xml)
        boot.wait_for("network is up: 1 of 2")
        self.start_sim("--node", 5, self.five)
        boot.wait_for("node 5: start command sent")
        self.assertEqual(boot.stop(signal.SIGINT), UP, boot.story())
        self.assertIn("booted", self.row(boot, 5))
        starts = [frame for frame in dump.end() if frame.startswith("000#01")]
        self.assertEqual(starts, ["000#0106", "000#0105"])

    def test_two_simulators(self):
        """one network file, its devices from two processes"""
        xml = self.network(node(5, **FIVE), node(6, DCF_File="six.dcf", **PATIENT))
        self.start_sim("--without", 6, xml)
        self.start_sim("--without", 5, xml)
        boot = self.boot("--once", "--all", xml)
        self.assert_said(boot, "network is up: 2 of 2 nodes booted")


if __name__ == "__main__":
    plant.main()
