#!/usr/bin/env python3
"""mcanopen check: what it accepts boots, what it refuses does not, or does not work.

Each fault is put into the same plant of two simulated devices, which boots without it.
"""
import json
import re
import shutil

import plant
from devices import (UNSIGNED8, UNSIGNED16, UNSIGNED32, Entry, Mapped, Record, dcf, network, node,
                     standard)

EXAMPLES = plant.ROOT / "examples"
BUILT = EXAMPLES / "dcf-in-cmake"
GOLDEN = plant.DATA / "check"
USAGE = 2
IDENTITY = {"Device_Type_Identification": "0x20192", "Vendor_Identification": "0x29A"}


class Mapping(Record):
    """A mapping of one object, as the configuration writes it."""

    def __init__(self, index, preset, mapped):
        super().__init__(index, [Entry(index, UNSIGNED32, preset, "rw", mapped)])
        self.entries[0] = Entry(index, UNSIGNED8, 1, "rw", 1)


def sensor():
    """One byte in a TPDO, for the drive."""
    return [Record(0x1800, [Entry(0x1800, UNSIGNED32, "$NODEID+0x180"),
                            Entry(0x1800, UNSIGNED8, 255)]),
            Record(0x1A00, [Entry(0x1A00, UNSIGNED32, 0x60000108)]),
            Record(0x6000, [Mapped(0x6000, UNSIGNED8, 0, "ro")])]


def drive(cob_id="0x185", mapped="0x62000108"):
    return [Record(0x1400, [Entry(0x1400, UNSIGNED32, "$NODEID+0x200", "rw", cob_id),
                            Entry(0x1400, UNSIGNED8, 255)]),
            Mapping(0x1600, "0x62000108", mapped), Entry(0x1014, UNSIGNED32, "$NODEID+0x80"),
            Record(0x6200, [Mapped(0x6200, UNSIGNED8, 0, "rww")]),
            Record(0x6201, [Mapped(0x6201, UNSIGNED16, 0, "rww")])]


class Check(plant.PlantTest):
    def check(self, *arguments, code=0):
        process = self.run_command([plant.MCANOPEN, "check", *arguments], self.folder)
        self.assertEqual(process.code, code, process.story())
        return process

    def write_plant(self, drive_objects=None, manager=None, **elements):
        """Nodes 5 and 6; the elements are those of node 6."""
        self.write("five.dcf", dcf(5, [*standard(5, heartbeat=300), *sensor()]))
        self.write("six.dcf", dcf(6, [*standard(6, heartbeat=300), *(drive_objects or drive())]))
        common = {"NMT_Mandatory_Slave": "TRUE", "Consumer_Heartbeat_Time": 3000,
                  "SDO_Timeout": 20000}
        six = {**common, **IDENTITY, "DCF_File": "six.dcf", **elements}
        self.write("network.xml", network(
            [node(5, **common, **IDENTITY, DCF_File="five.dcf"),
             node(6, **{name: value for name, value in six.items() if value is not None})],
            Heartbeat_Producer_Time=1000, **(manager or {})))
        return self.folder / "network.xml"

    def simulate(self, *arguments):
        return self.start_sim("--node", 5, self.folder / "five.dcf", "--node", 6,
                              self.folder / "six.dcf", *arguments)

    def refused_rules(self, *arguments):
        """The rules of the errors, of which there are some."""
        report = json.loads(self.check("--json", *arguments, "network.xml", code=1).out.text())
        self.assertFalse(report["bootable"])
        return {message["rule"] for message in report["messages"]
                if message["severity"] == "error"}


class Accepted(Check):
    def test_examples(self):
        """the networks of all examples are clean; what dcftest tells of their files is its own"""
        files = sorted(set(EXAMPLES.glob("*/network.xml")) - {BUILT / "network.xml"})
        self.assertGreater(len(files), 3)
        for path in files:
            process = self.check("--strict", "--no-rule", "file-warnings", path)
            self.assertIn(f"{path}: 0 errors, 0 warnings: nothing against a boot",
                          process.out.text())
        plant.say(f"{len(files)} networks")

    def test_built_example(self):
        """the network whose CCF files a build makes"""
        shutil.copytree(BUILT, self.folder, dirs_exist_ok=True)
        devices = {5: ("pump.dcf", "pump.ccf"), 9: ("valve.dcf", "valve-9.ccf"),
                   10: ("valve.dcf", "valve-10.ccf")}
        eds = []
        for node_id, (source, target) in devices.items():
            made = self.run_command([plant.TOOLS / "dcf2ccf", "-n", node_id, source, target],
                                    self.folder)
            self.assertEqual(made.code, 0, made.story())
            eds += ["--eds", f"{node_id}={source}"]
        self.check("--strict", "--no-rule", "file-warnings", *eds, "network.xml")
        text = self.check("network.xml").out.text()
        self.assertEqual(text.count("[unknown-node]"), len(devices))

    def test_boots(self):
        """what is accepted boots"""
        xml = self.write_plant()
        self.check("--strict", "--no-rule", "file-warnings", xml)
        self.simulate()
        self.boot("--once", xml)


# rule: (elements of node 6, objects of its DCF or None, the letter of its boot error)
NO_BOOT = {
    "device-type": ({"Device_Type_Identification": "0x20193"}, None, "C"),
    "wrong-identity": ({"Vendor_Identification": "0x29B"}, None, "D"),
    "save-object": ({"Save_Configuration": "TRUE"}, None, "J"),
    "restore-object": ({"Restore_Configuration": 1}, None, "J"),
    "software-object": ({"NMT_Verify_Software": "TRUE", "Software_Identification": 1}, None, "G"),
    "pdo-mapping": ({}, drive(mapped="0x63000108"), "J"),
    "restricted-id": ({}, drive(cob_id="0x701"), "J"),
}


class Refused(Check):
    def assert_does_not_boot(self, xml, letter):
        self.simulate()
        boot = self.boot("--once", xml, code=1)
        self.assertIn(f'error: node 6: boot error {letter}', boot.out.text() + boot.err.text())

    def assert_refused(self, rule):
        elements, objects, letter = NO_BOOT[rule]
        xml = self.write_plant(objects, **elements)
        self.assertIn(rule, self.refused_rules())
        self.assert_does_not_boot(xml, letter)

    def test_no_heartbeat(self):
        """no-heartbeat: boot error K"""
        xml = self.write_plant(Consumer_Heartbeat_Time=500)
        self.write("six.dcf", dcf(6, [*standard(6), *drive()]))
        self.assertEqual(self.refused_rules(), {"no-heartbeat"})
        self.assert_does_not_boot(xml, "K")

    def test_ccf(self):
        """refused-write: a CCF with an entry that the device does not have"""
        xml = self.write_plant(DCF_File=None, CCF_File="six.ccf")
        (self.folder / "six.ccf").write_bytes(bytes.fromhex("01000000" "0070" "00" "01000000" "00"))
        self.check(xml)
        self.assertIn("refused-write", self.refused_rules("--eds", "6=six.dcf"))
        self.assert_does_not_boot(xml, "J")

    def test_heartbeat_time(self):
        """heartbeat-time: the node is lost"""
        xml = self.write_plant(Consumer_Heartbeat_Time=100)
        self.assertEqual(self.refused_rules(), {"heartbeat-time"})
        self.simulate()
        self.start_boot(xml).wait_for("node 6: heartbeat lost")

    def test_guarding(self):
        """guarding-heartbeat: the node is lost"""
        xml = self.write_plant(Consumer_Heartbeat_Time=None, Guard_Time=100, Life_Time_Factor=3)
        self.assertEqual(self.refused_rules(), {"guarding-heartbeat"})
        self.simulate()
        self.start_boot(xml).wait_for("node 6: no answer to guarding")

    def test_length(self):
        """pdo-length: emergency 8210h"""
        xml = self.write_plant(drive(mapped="0x62010110"))
        self.assertEqual(self.refused_rules(), {"pdo-length"})
        self.simulate("--toggle", "5:6000:1=0..255/100")
        dump = self.dump()
        self.start_boot(xml)
        dump.wait_for("086#1082")


def add_tests():
    for rule, (_, _, letter) in NO_BOOT.items():
        def test(self, rule=rule):
            self.assert_refused(rule)
        test.__doc__ = f"{rule}: boot error {letter}"
        setattr(Refused, f"test_{rule.replace('-', '_')}", test)


add_tests()


class Output(Check):
    def write_faulty(self):
        """Something of everything."""
        watches = Record(0x1016, [Entry(0x1016, UNSIGNED32, 0, "rw", "0x000503E8"),
                                  Entry(0x1016, UNSIGNED32, 0, "rw", "0x00080BB8")])
        sync = [Entry(0x1005, UNSIGNED32, "0x80", "rw", "0x40000080"),
                Entry(0x1006, UNSIGNED32, 0, "rw", 5000)]
        xml = self.write_plant([*drive(mapped="0x62010110"), watches, *sync],
                               {"Name": "mill", "Sync_Interval": 10000, "Boot_Time": 200},
                               Name="drive", Vendor_Identification="0x29B",
                               Consumer_Heartbeat_Time=400)
        text = xml.read_text(encoding="utf-8").replace(
            "  </Manager_Instance>", node(9, CCF_File="none.ccf") + node(10, Name="lamp")
            + "  </Manager_Instance>")
        self.write("network.xml", text)

    def quote_lines(self, text):
        """What stands in the line of a DCF, in place of its number."""
        lines = (self.folder / "six.dcf").read_text(encoding="utf-8").splitlines()
        return re.sub(r"^six\.dcf:(\d+):", lambda place: f"six.dcf:{lines[int(place[1]) - 1]}:",
                      text, flags=re.MULTILINE)

    def test_golden(self):
        """all of the output"""
        self.write_faulty()
        text = self.quote_lines(self.check("network.xml", code=1).out.text()) + "\n"
        expected = (GOLDEN / "faulty.txt").read_text(encoding="utf-8")
        self.assertEqual(text, expected)

    def test_json(self):
        """the same as JSON"""
        self.write_faulty()
        lines = self.check("network.xml", code=1).out.lines
        report = json.loads(self.check("--json", "network.xml", code=1).out.text())
        messages = [f"{m['file']}{':' + str(m['line']) if m['line'] else ''}: {m['severity']}: "
                    f"{m['text']}{' [' + m['rule'] + ']' if m['rule'] else ''}"
                    for m in report["messages"]]
        self.assertEqual(messages, lines[:len(messages)])
        self.assertEqual(lines[len(messages)], "")
        nodes = report["networks"][0]["nodes"]
        self.assertEqual([each["node"] for each in nodes], [5, 6, 9, 10])
        self.assertEqual(nodes[1]["name"], "drive")
        self.assertEqual(nodes[0]["heartbeat_ms"], 300)
        self.assertIsNone(nodes[3]["heartbeat_ms"])
        self.assertEqual(report["networks"][0]["name"], "mill")
        self.assertGreater(report["networks"][0]["bus_load"]["cyclic_percent"], 0.4)
        self.assertEqual(report["errors"],
                         sum(m["severity"] == "error" for m in report["messages"]))

    def test_quiet(self):
        """-q: errors alone, -qq: nothing"""
        self.write_faulty()
        quiet = self.check("-q", "network.xml", code=1).out.lines
        self.assertTrue(quiet)
        self.assertTrue(all(": error: " in line for line in quiet), quiet)
        self.assertEqual(self.check("-qq", "network.xml", code=1).out.lines, [])

    def test_rules(self):
        """--rule, --no-rule, --strict"""
        xml = self.write_plant(Consumer_Heartbeat_Time=400)
        self.assertIn("[heartbeat-margin]", self.check(xml).out.text())
        self.check("--strict", xml, code=1)
        without = self.check("--strict", "--no-rule", "heartbeat-margin,file-warnings", xml)
        self.assertNotIn("heartbeat-margin", without.out.text())
        self.check("--strict", "--rule", "no-sync,id-collision", xml)
        self.check("--strict", "--rule", "heartbeat-margin", xml, code=1)
        self.write_plant(Consumer_Heartbeat_Time=200)
        self.check("--no-rule", "heartbeat-time", "network.xml")
        wrong = self.check("--rule", "heartbeat-tim", xml, code=USAGE)
        self.assertIn('no rule "heartbeat-tim"; did you mean heartbeat-time?', wrong.err.text())

    def test_files(self):
        """--files tells what dcftest does, --eds compares a DCF"""
        xml = self.write_plant()
        text = (self.folder / "six.dcf").read_text(encoding="utf-8")
        self.write("six.dcf", text.replace("[DummyUsage]", "# a comment\n[DummyUsage]"))
        self.write("six.eds", text.replace("DefaultValue=0x20192", "DefaultValue=0x20193"))
        plain = self.check(xml).out.text()
        self.assertEqual(plain.count("[file-warnings]"), 1)
        told = self.check("--files", xml).out.lines
        dcftest = self.run_command([plant.TOOLS / "dcftest", "six.dcf"], self.folder)
        self.assertTrue(dcftest.out.lines)
        for line in dcftest.out.lines:
            self.assertIn(line, told)
        self.assertNotIn("[file-warnings]", "\n".join(told))
        self.assertIn("[eds-", self.check("--eds", "6=six.eds", xml).out.text())

    def test_documented(self):
        """docs/check.md has each rule with its severity"""
        rules = json.loads(self.check("--list-rules", "--json").out.text())
        page = (plant.ROOT / "docs" / "check.md").read_text(encoding="utf-8")
        table = dict(re.findall(r"^\| `([a-z-]+)` \| (error|warning|info) \|", page, re.MULTILINE))
        own = rules[:[rule["name"] for rule in rules].index("no-text")]  # of files, behind them
        self.assertEqual(table, {rule["name"]: rule["severity"] for rule in own})
        text = self.check("--list-rules").out.text()
        for rule in rules:
            self.assertIn(f"{rule['name']}: {rule['severity']} [{rule['clause']}]\n", text)

    def test_usage(self):
        """wrong usage is exit code 2, a bad XML file 1"""
        self.write_plant()
        for arguments in ([], ["--nonsense"], ["a.xml", "b.xml"], ["--eds", "6", "network.xml"],
                          ["--eds", "128=six.dcf", "network.xml"],
                          ["--eds", "7=six.dcf", "network.xml"]):
            process = self.check(*arguments, code=USAGE)
            self.assertTrue(process.err.lines, arguments)
        self.assertIn("Usage: mcanopen check", self.check("--help").out.text())
        self.assertIn("none.xml: error: no such file", self.check("none.xml", code=1).out.text())
        self.write("bad.xml", "<CANopen_Manager/>")
        self.check("bad.xml", code=1)


if __name__ == "__main__":
    plant.main()
