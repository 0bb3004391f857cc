#!/usr/bin/env python3
"""The file tools without memory: each allocation fails once. A tool may end with an error, it may
do without; it does not crash, and what it says with exit code 0 is complete.
"""
import os
import subprocess

import plant
from devices import UNSIGNED8, VISIBLE_STRING, Entry, dcf, network, node, standard

FAIL = plant.TOOLS.parent / "tests" / "libfail_malloc.so"
FAILED = b"<allocation failed>\n"


class WithoutMemory(plant.PlantTest):
    def setUp(self):
        super().setUp()
        if plant.SANITIZED:
            self.skipTest("sanitizers have an allocator of their own")
        text = dcf(5, [*standard(5), Entry(0x2000, UNSIGNED8, 0, "rw", 7),
                       Entry(0x2001, VISIBLE_STRING, "a", "rw", "a text")])
        (self.folder / "plant").mkdir()
        for name in ("a.dcf", "plant/a.dcf", "plant/b.dcf"):
            self.write(name, text.replace("[DummyUsage]", "# a comment\n[DummyUsage]"))
        subprocess.run([plant.TOOLS / "dcf2ccf", "a.dcf", "a.ccf"], cwd=self.folder, check=True,
                       capture_output=True, timeout=plant.LIMIT)

    def run_tool(self, words, number):
        environment = {**os.environ, "LD_PRELOAD": str(FAIL), "FAIL_AT": str(number)}
        return subprocess.run([plant.TOOLS / words[0], *words[1:]], cwd=self.folder, check=False,
                              capture_output=True, timeout=plant.LIMIT, env=environment)

    def fail_each(self, *words, step=1, good=0):
        """Every step-th allocation; the exit code is 'good' where none fails."""
        whole = self.run_tool(words, 0)
        self.assertEqual(whole.returncode, good, whole.stderr)
        number = 1
        while FAILED in (done := self.run_tool(words, number)).stderr:
            self.assertIn(done.returncode, (0, 1, 2, 3),
                          f"{words}, allocation {number}: {done.stderr}")
            if done.returncode == 0:
                self.assertEqual(done.stdout, whole.stdout, f"{words}, allocation {number}")
            number += step
        plant.say(f"{' '.join(words)}: {number} allocations")
        self.assertGreater(number, 3)

    def test_dcftest(self):
        self.fail_each("dcftest", "a.dcf")
        self.fail_each("dcftest", "-j2", "plant")
        self.fail_each("dcftest", "--eds", "a.dcf", "a.dcf")
        self.fail_each("dcftest", "--json", "a.dcf")
        self.fail_each("dcftest", "--sarif", "a.dcf", step=41)
        self.fail_each("dcftest", "--list-rules", "--json", step=41)
        self.fail_each("dcftest", "--online", "-i", self.bus.name, "--timeout=1", "a.dcf", good=3)

    def test_dcf2ccf(self):
        self.fail_each("dcf2ccf", "a.dcf", "b.ccf")
        self.fail_each("dcf2ccf", "a.dcf", "-")

    def test_check(self):
        self.write("network.xml", network([node(5, DCF_File="a.dcf"), node(6, CCF_File="a.ccf")]))
        eds = ("--eds", "6=a.dcf")
        self.fail_each("mcanopen", "check", *eds, "network.xml", step=3)
        self.fail_each("mcanopen", "check", "--json", *eds, "network.xml", step=13)

    def test_ccfread(self):
        self.fail_each("ccfread", "a.ccf")
        self.fail_each("ccfread", "--json", "a.ccf")
        self.fail_each("ccfread", "--eds", "a.dcf", "a.ccf")
        self.fail_each("ccfread", "--diff", "a.ccf", "a.ccf")
        (self.folder / "b.ccf").write_bytes(bytes(4))
        self.fail_each("ccfread", "--json", "--diff", "a.ccf", "b.ccf", good=1)


if __name__ == "__main__":
    plant.main()
