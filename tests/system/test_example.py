#!/usr/bin/env python3
"""The example plant, as examples/boot-network/run.sh has it: by the tool and by the program."""
import unittest

import plant

FOLDER = plant.ROOT / "examples" / "boot-network"
PROGRAM = plant.TOOLS.parent / "examples" / "boot-network"
NODES = (2, 5, 7, 9)


class Example(plant.PlantTest):
    def setUp(self):
        super().setUp()
        self.start_sim(FOLDER / "network.xml")

    def test_tool(self):
        """mcanopen boot --once --all"""
        dump = self.dump()
        boot = self.boot("--once", "--all", FOLDER / "network.xml")
        self.assertIn("network is up: 4 of 4 nodes booted", boot.out.text())
        rows = [line.split() for line in boot.out.lines if " OPERATIONAL " in line]
        self.assertEqual([int(row[0]) for row in rows], list(NODES))
        self.assertTrue(all(row[-1] == "booted" for row in rows), boot.story())
        frames = dump.end()
        self.assertEqual(sorted(frame for frame in frames if frame.startswith("000#01")),
                         [f"000#01{node:02X}" for node in NODES])
        plant.say(f"{len(frames)} frames")

    @unittest.skipUnless(PROGRAM.exists(), "examples are not built")
    def test_program(self):
        """the program on the public API alone"""
        boot = self.run_command([PROGRAM, FOLDER / "network.xml"])
        self.assertEqual(boot.code, 0, boot.story())
        self.assertIn("network is up", boot.out.lines[-1])
        for node in NODES:
            self.assertIn(f"Node: {node} booted", boot.out.text())
        plant.say(boot.out.lines[-1].strip())


if __name__ == "__main__":
    plant.main()
