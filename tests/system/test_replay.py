#!/usr/bin/env python3
"""A seed that fails (one is made to) tells the command that plays it again, with a log."""
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

PROGRAM = Path(os.environ["MCANOPEN_TOOLS"]).resolve().parent / "tests" / "test_seeds"
FRAME = re.compile(r"\(\d+\.\d{6}\) sim [0-9A-F]{3}#(R\d?|([0-9A-F]{2}){0,8})")


def run(command, folder, **environment):
    return subprocess.run(command, cwd=folder, env=dict(os.environ, **environment), text=True,
                          capture_output=True, timeout=120, shell=isinstance(command, str))


class Replay(unittest.TestCase):
    def check_replay(self, **environment):
        with tempfile.TemporaryDirectory() as folder:
            result = run([PROGRAM], folder, SCENARIO_FIRST_SEED="3", SCENARIO_SEEDS="3",
                         SCENARIO_SABOTAGE="4", **environment)
            commands = re.findall(r"^seed (\d+) has failed; replay: (.*)$", result.stdout, re.M)
            self.assertNotEqual(result.returncode, 0, result.stdout)
            self.assertEqual([seed for seed, _ in commands], ["4"], result.stdout)
            result = run(commands[0][1], folder, SCENARIO_SABOTAGE="4")
            self.assertNotEqual(result.returncode, 0, result.stdout)
            self.assertIn("seed 4 ", result.stdout)
            log = (Path(folder) / "seed-4.log").read_text(encoding="ascii").splitlines()
            frames = [line for line in log if FRAME.fullmatch(line)]
            self.assertGreater(len(frames), 1000)
            self.assertEqual(frames, log[:len(frames)])
            self.assertTrue(any("boot-up message" in line for line in log[len(frames):]))

    def test_one_process(self):
        self.check_replay()

    def test_several_processes(self):
        self.check_replay(SCENARIO_JOBS="2")

    def test_all_pass(self):
        with tempfile.TemporaryDirectory() as folder:
            result = run([PROGRAM], folder, SCENARIO_SEEDS="4", SCENARIO_JOBS="2")
        self.assertEqual(result.returncode, 0, result.stdout)
        self.assertNotIn("replay", result.stdout)
        self.assertRegex(result.stdout, r"(?m)^4 seeds, \d+ nodes, 0\.\d+ virtual hours")
        self.assertRegex(result.stdout, r"(?m)^ +\d+ nodes: wrong vendor$")
        self.assertEqual(result.stdout.splitlines()[-1], "4 passed, 0 failed")


if __name__ == "__main__":
    unittest.main()
