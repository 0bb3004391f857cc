#!/usr/bin/env python3
"""The comparison of logs notices what counts, and only that."""
import unittest

import plant
import wire

LOG = """# a boot
(1.0) can0 77F#00
(1.0) can0 000#8200
(1.1) can0 705#00
(1.1) can0 706#00
(1.2) can0 605#4000100000000000
(1.2) can0 585#4300100092010200
(1.3) can0 706#7F
(1.4) can0 000#0105
(1.4) can0 000#0106
(1.5) can0 706#05
"""


def changed(old, new):
    if old not in LOG:
        raise ValueError(old)
    return wire.frames_of(LOG.replace(old, new))


class Comparison(unittest.TestCase):
    def judge(self, actual):
        return wire.difference(wire.frames_of(LOG), actual)

    def test_the_same(self):
        self.assertIsNone(self.judge(wire.frames_of(LOG)))
        self.assertIsNone(self.judge(changed("(1.2) can0", "(7.5)   vcan0 ")))
        self.assertIsNone(self.judge(changed("705#00\n(1.1) can0 706#00", "706#00\n705#00")))

    def test_repeated_heartbeats_are_cut(self):
        self.assertIsNone(self.judge(changed("706#7F", "706#7F\n706#7F\n706#7F")))
        self.assertIsNone(self.judge(wire.frames_of(LOG + "706#05\n706#05\n")))

    def test_another_state_counts(self):
        self.assertIn("heartbeats of node 6", self.judge(wire.frames_of(LOG + "706#7F\n")))
        self.assertIn("is the end", self.judge(changed("706#05", "")))

    def test_each_frame_counts(self):
        for line in wire.frames_of(LOG):
            self.assertIn(line, self.judge(changed(line, "")), line)
            self.assertIsNotNone(self.judge(changed(line, line + "\n" + line)) if
                                 not wire.is_heartbeat(line) else line, line)

    def test_each_byte_counts(self):
        self.assertIn("node 5, frame 4", self.judge(changed("92010200", "92010201")))

    def test_order_of_commands_counts(self):
        swapped = changed("000#0105\n(1.4) can0 000#0106", "000#0106\n000#0105")
        self.assertIn("network 0, frame 2", self.judge(swapped))

    def test_order_of_a_nodes_frames_counts(self):
        early = changed("705#00", "705#00\n000#0105")
        self.assertIsNotNone(self.judge(early))


if __name__ == "__main__":
    plant.main()
