#!/usr/bin/env python3
"""mcanopen conform: what it says of our own device and of one that is not that of its EDS, its
options and its exit codes.
"""
import json
import re
import unittest
import xml.etree.ElementTree

import plant

DEVICE = plant.DATA / "conform.eds"
QUICK = ("--sdo-timeout", "300", "--boot-timeout", "300")

# How a device can differ from the EDS that the tester has: section, key, the device's own value;
# and the checks that must fail, no others.
DEVIATIONS = [
    ("1000", "DefaultValue", "0x000F0192", "sdo-read-expedited od-defaults"),
    ("1018sub2", "DefaultValue", "8", "eds-identity od-defaults"),
    ("2001", "DefaultValue", "9", "od-defaults"),
    ("2012", "DataType", "0x0005", "od-read od-defaults od-write-defaults"),
    ("2022sub1", "AccessType", "rw", "od-read-only"),
    ("2003", "AccessType", "ro", "od-write-defaults"),
    ("2004", "AccessType", "rw", "sdo-read-write-only"),
    ("2021sub1", "HighLimit", "200", "od-limits"),
    ("2021sub3", "LowLimit", "-200", "od-limits"),
    ("2040sub0", "DefaultValue", "15", "od-sub-count od-defaults"),
    ("1200sub1", "DefaultValue", "$NODEID+0x601",
     "sdo-default-channel sdo-default-fixed od-defaults"),
]
# Those that wait for nothing to come, and say nothing of the EDS.
SLOW = ("sdo-one-answer,sdo-abort-silent,sdo-short-frames,sdo-stopped,sdo-abort-upload,"
        "sdo-abort-download,sdo-half-channel,sdo-timeout,sdo-block-upload-abort,"
        "sdo-block-download-abort")


def deviating(section, key, value):
    """The text of the device's EDS with another value in it."""
    head, mark, rest = DEVICE.read_text().partition(f"[{section}]\n")
    assert mark, section
    changed, count = re.subn(f"(?m)^{key}=.*$", f"{key}={value}", rest, count=1)
    assert count, key
    return head + mark + changed


class Conform(plant.PlantTest):
    def start_conform(self, *arguments):
        return self.run_command([*plant.WRAP, plant.MCANOPEN, "conform", "--bus", self.bus.name,
                                 *arguments])

    def conform(self, *arguments, code=0):
        process = self.start_conform(*arguments)
        self.assertEqual(process.code, code, process.story())
        return process

    def report(self, *arguments, code=0):
        process = self.start_conform("--json", *arguments)
        report = json.loads(process.out.text())
        failed = [check for check in report["checks"] if check["verdict"] == "FAIL"]
        self.assertEqual(process.code, code, json.dumps(failed, indent=2) + process.err.text())
        return report

    def verdicts(self, *arguments, code=0):
        """{check: verdict}"""
        return {check["name"]: check["verdict"]
                for check in self.report(*arguments, code=code)["checks"]}

    def test_with_eds(self):
        """our device, all checks: none fails, and none is left out but what needs a hand"""
        self.start_sim("--node", "5", DEVICE)
        report = self.report("--node", "5", "--eds", DEVICE, "--allow-store")
        others = {check["name"]: (check["verdict"], check["reason"]) for check in report["checks"]
                  if check["verdict"] != "PASS"}
        plant.say(f"{report['passed']} passed")
        self.assertEqual(set(others), {"eds-bit-rates"}, others)
        self.assertEqual(others["eds-bit-rates"][0], "NEEDS-HELP")
        self.assertEqual(report["lost"], 0)

    def test_without_eds(self):
        """what only the file can tell is skipped"""
        self.start_sim("--node", "5", DEVICE)
        verdicts = self.verdicts("--node", "5", "--skip", "control,nmt,sync,sdo-timeout")
        self.assertNotIn("FAIL", verdicts.values())
        self.assertEqual(verdicts["eds-identity"], "SKIP")
        self.assertEqual(verdicts["sdo-read-expedited"], "PASS")
        self.assertEqual(verdicts["sdo-segmented-read"], "PASS")
        self.assertEqual(verdicts["store-save"], "SKIP")

    def test_no_node(self):
        """a device that does not answer ends the run"""
        self.start_sim("--node", "5", DEVICE)
        process = self.conform("--node", "6", *QUICK, code=3)
        self.assertIn("no answer from node 6", process.err.text())

    def test_stopped(self):
        """the user gives up: the device is reset, and what there is is told"""
        dump = self.dump()
        self.start_sim("--node", "5", DEVICE)
        process = self.start([plant.MCANOPEN, "conform", "--bus", self.bus.name, "--node", "5"])
        process.wait_for("sdo-short-frames")
        self.assertEqual(process.stop(), 1, process.story())
        self.assertIn("stopped before the end", process.err.text())
        self.assertIn(" failed,", process.out.text())
        dump.process.wait_until(lambda lines: [line.split()[2] for line in lines[-2:]] ==
                                ["000#8105", "705#00"], "a last reset")

    def test_dies(self):
        """a device that dies ends the run with the check that it did not survive"""
        sim = self.start_sim("--node", "5", DEVICE)
        process = self.start([plant.MCANOPEN, "conform", "--bus", self.bus.name, "--node", "5",
                              *QUICK])
        process.wait_for("sdo-short-frames")
        sim.kill()
        self.assertEqual(process.wait(), 1, process.story())
        self.assertIn("no answer from node 5", process.err.text())
        self.assertIn("1 failed", process.out.text())

    def test_finding(self):
        """what was expected and received, the frames, and the summary"""
        self.start_sim("--node", "5", self.write("device.eds", deviating(*DEVIATIONS[0][:3])))
        process = self.conform("--node", "5", "--eds", DEVICE, "--only", "sdo-read-expedited",
                               code=1)
        self.assertIn("FAIL        sdo-read-expedited", process.out.text())
        self.assertIn("the EDS says 000F0191, received 000F0192", process.out.text())
        self.assertIn("> 605#4000100000000000", process.out.text())
        self.assertIn("< 585#4300100092010F00", process.out.text())
        self.assertIn("1 checks, 0 passed, 1 failed", process.out.text())

    def test_bad_eds(self):
        """a file that is none is a finding, and the rest goes on without it"""
        self.start_sim("--node", "5", DEVICE)
        only = ("--node", "5", "--only", "eds-valid,eds-standard,eds-identity,sdo-read-expedited")
        bad = self.write("bad.eds", "\0")
        verdicts = self.verdicts("--eds", bad, *only, code=1)
        self.assertEqual(verdicts, {"eds-valid": "FAIL", "eds-standard": "SKIP",
                                    "eds-identity": "SKIP", "sdo-read-expedited": "PASS"})

    def test_poor_eds(self):
        """a file that is not as the standard has it; what is ours in it is no finding"""
        self.start_sim("--node", "5", DEVICE)
        only = ("--node", "5", "--only", "eds-valid,eds-standard")
        text = DEVICE.read_text()
        poor = self.write("poor.eds", text.replace("=0x000F0191", "=0x1000F01910"))
        process = self.conform("--eds", poor, *only, code=1)
        self.assertIn("PASS        eds-valid", process.out.text())
        self.assertIn('there is "0x1000F01910", which does not fit', process.out.text())
        self.conform("--eds", self.write("own.eds", text + "\n[Vendor]\nKey=1\n"), *only)

    def test_junit(self):
        """the results as XML"""
        self.start_sim("--node", "5", self.write("device.eds", deviating(*DEVIATIONS[0][:3])))
        path = self.folder / "results.xml"
        self.conform("--node", "5", "--eds", DEVICE, "--junit", path, "--only",
                     "eds,sdo-read-expedited", code=1)
        suite = xml.etree.ElementTree.parse(path).getroot()
        self.assertEqual((suite.get("tests"), suite.get("failures")), ("6", "1"))
        outcome = {case.get("name"): [each.tag for each in case] for case in suite}
        self.assertEqual(outcome["eds-valid"], [])
        self.assertEqual(outcome["eds-bit-rates"], ["skipped"])
        self.assertEqual(outcome["sdo-read-expedited"], ["failure"])
        self.assertIn("605#4000100000000000", suite.find("*/failure").text)

    def test_junit_nowhere(self):
        """results that cannot be written"""
        self.start_sim("--node", "5", DEVICE)
        process = self.conform("--node", "5", "--only", "eds", "--junit", self.folder, code=2)
        self.assertIn("Is a directory", process.err.text())

    def test_selection(self):
        """checks and families by name"""
        self.start_sim("--node", "5", DEVICE)
        only = self.verdicts("--node", "5", "--only", "eds,sdo-one-answer", "--skip",
                             "eds-mandatory")
        self.assertEqual(set(only), {"eds-valid", "eds-standard", "eds-identity",
                                     "eds-bit-rates", "sdo-one-answer"})

    def test_list(self):
        """each check has a name of its own, which begins with that of a family"""
        lines = self.conform("--list").out.text().splitlines()
        names = [line.split()[1] for line in lines]
        self.assertEqual(len(names), len(set(names)))
        self.assertIn("sdo-read-expedited", names)

    def test_verbose_and_quiet(self):
        """the frames of all checks; of those that pass nothing"""
        self.start_sim("--node", "5", DEVICE)
        only = ("--node", "5", "--only", "sdo-read-expedited")
        self.assertIn("< 585#4300100091010F00", self.conform("-v", *only).out.text())
        lines = self.conform("-q", *only).out.text().splitlines()
        self.assertEqual(len(lines), 1)
        self.assertIn("1 passed", lines[0])

    def test_usage(self):
        """wrong options"""
        self.assertIn("no check and no family",
                      self.conform("--node", "5", "--only", "sdo,none", code=2).err.text())
        self.assertIn("expected 1..127", self.conform("--node", "128", code=2).err.text())
        self.assertIn("No such file",
                      self.conform("--node", "5", "--eds", "none.eds", code=2).err.text())
        self.assertIn("Usage:", self.conform(code=2).err.text())
        self.assertIn("not expected", self.conform("--node", "5", "6", code=2).err.text())


class Deviating(Conform):
    """A device that is not that of its EDS fails the right checks, and no others."""

    def test_deviations(self):
        for section, key, value, checks in DEVIATIONS:
            with self.subTest(section=section, key=key):
                sim = self.start_sim("--node", "5",
                                     self.write("device.eds", deviating(section, key, value)))
                verdicts = self.verdicts("--node", "5", "--eds", DEVICE, "--only", "eds,sdo,od",
                                         "--skip", SLOW, code=1)
                failed = {name for name, verdict in verdicts.items() if verdict == "FAIL"}
                self.assertEqual(failed, set(checks.split()))
                self.assert_stopped(sim)


def load_tests(loader, _tests, _pattern):
    """Deviating borrows what Conform has, but not its tests."""
    suite = loader.loadTestsFromTestCase(Conform)
    suite.addTest(Deviating("test_deviations"))
    return suite


if __name__ == "__main__":
    plant.main()
