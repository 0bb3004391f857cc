#!/usr/bin/env python3
"""mcanopen conform: what it says of our own device, its options and its exit codes."""
import json
import unittest
import xml.etree.ElementTree

import plant

DEVICE = plant.DATA / "conform.eds"


class Conform(plant.PlantTest):
    def conform(self, *arguments, code=0):
        process = self.run_command([plant.MCANOPEN, "conform", "--bus", self.bus.name, *arguments])
        self.assertEqual(process.code, code, process.story())
        return process

    def verdicts(self, *arguments, code=0):
        """{check: verdict}"""
        report = json.loads(self.conform("--json", *arguments, code=code).out.text())
        return {check["name"]: check["verdict"] for check in report["checks"]}

    def test_with_eds(self):
        """our device, all checks"""
        self.start_sim("--node", "5", DEVICE)
        verdicts = self.verdicts("--node", "5", "--eds", DEVICE)
        self.assertNotIn("FAIL", verdicts.values())
        self.assertEqual(verdicts["eds-valid"], "PASS")
        self.assertEqual(verdicts["sdo-read-expedited"], "PASS")

    def test_without_eds(self):
        """what only the file can tell is skipped"""
        self.start_sim("--node", "5", DEVICE)
        verdicts = self.verdicts("--node", "5")
        self.assertNotIn("FAIL", verdicts.values())
        self.assertEqual(verdicts["eds-identity"], "SKIP")
        self.assertEqual(verdicts["sdo-read-expedited"], "PASS")

    def test_no_node(self):
        """a device that does not answer ends the run"""
        self.start_sim("--node", "5", DEVICE)
        process = self.conform("--node", "6", "--sdo-timeout", "50", "--boot-timeout", "50", code=3)
        self.assertIn("no answer from node 6", process.err.text())

    def test_finding(self):
        """a device that is not that of the EDS"""
        self.start_sim("--node", "5", DEVICE)
        other = self.write("other.eds", DEVICE.read_text().replace("=0x000F0191", "=0x000F0192"))
        process = self.conform("--node", "5", "--eds", other, "--only", "sdo-read-expedited",
                               code=1)
        self.assertIn("FAIL        sdo-read-expedited", process.out.text())
        self.assertIn("> 605#4000100000000000", process.out.text())
        self.assertIn("1 checks, 0 passed, 1 failed", process.out.text())

    def test_junit(self):
        """the results as XML"""
        self.start_sim("--node", "5", DEVICE)
        path = self.folder / "results.xml"
        self.conform("--node", "5", "--junit", path, "--only", "eds,sdo-read-expedited")
        suite = xml.etree.ElementTree.parse(path).getroot()
        self.assertEqual(suite.get("failures"), "0")
        skipped = {case.get("name") for case in suite if case.find("skipped") is not None}
        self.assertIn("eds-valid", skipped)
        self.assertNotIn("sdo-read-expedited", skipped)

    def test_selection(self):
        """checks and families by name"""
        self.start_sim("--node", "5", DEVICE)
        only = self.verdicts("--node", "5", "--only", "eds-mandatory,sdo", "--skip", "eds")
        self.assertIn("sdo-read-expedited", only)
        self.assertNotIn("eds-mandatory", only)

    def test_usage(self):
        """wrong options"""
        self.assertIn("no check and no family",
                      self.conform("--node", "5", "--only", "sdo,none", code=2).err.text())
        self.assertIn("expected 1..127", self.conform("--node", "128", code=2).err.text())
        self.assertIn("No such file",
                      self.conform("--node", "5", "--eds", "none.eds", code=2).err.text())
        self.assertIn("usage:", self.conform(code=2).err.text())
        self.assertIn("sdo-read-expedited", self.conform("--list").out.text())


if __name__ == "__main__":
    plant.main()
