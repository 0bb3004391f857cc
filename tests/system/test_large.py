#!/usr/bin/env python3
"""The largest network: 126 simulated nodes, each configured with 21 writes, from two processes.

The log has exactly the frames that the boot needs, none twice, whatever the speed of the machine:
the time-outs of this network are longer than the test may take.
"""
from collections import Counter

import plant
from devices import (UNSIGNED8, UNSIGNED16, UNSIGNED32, Entry, Record, dcf, network, node,
                     standard)

NODES = range(1, 127)
VALUES = 20  # and 1017h
IDENTITIES = 2
# boot-up (after the reset), 1000h, identity, configuration, first heartbeat, start
FRAMES_OF_NODE = 1 + 2 + 2 * IDENTITIES + 2 * (VALUES + 1) + 1 + 1
FRAMES_OF_MANAGER = 2  # boot-up, reset of all
KINDS = {UNSIGNED8: 0xFF, UNSIGNED16: 0xFFFF, UNSIGNED32: 0xFFFFFFFF}


def value(node_id, number):
    """One that fits its type and differs from node to node."""
    kind = list(KINDS)[number % len(KINDS)]
    return kind, (node_id * 0x01030507 + number) & KINDS[kind]


def device_file(node_id):
    entries = [Entry(0x2000, kind, 0, "rw", f"0x{number:X}")
               for kind, number in (value(node_id, each) for each in range(1, VALUES + 1))]
    objects = [*standard(node_id, heartbeat=60000), Record(0x2000, entries)]
    return dcf(node_id, objects)


def download(node_id, sub):
    kind, number = value(node_id, sub)
    size = {UNSIGNED8: 1, UNSIGNED16: 2, UNSIGNED32: 4}[kind]
    data = number.to_bytes(size, "little").ljust(4, b"\0").hex().upper()
    return f"{0x600 + node_id:03X}#{0x23 + 4 * (4 - size):02X}0020{sub:02X}{data}"


class Large(plant.PlantTest):
    def make_network(self):
        nodes = []
        for node_id in NODES:
            self.write(f"{node_id}.dcf", device_file(node_id))
            nodes.append(node(node_id, DCF_File=f"{node_id}.dcf", SDO_Timeout=60000,
                              Consumer_Heartbeat_Time=65000, Vendor_Identification="0x29A",
                              Serial_Number=node_id))
        return self.write("network.xml", network(nodes, Boot_Delay=3000))

    def test_frames(self):
        """126 nodes boot with the number of frames that the formula gives"""
        xml = self.make_network()
        sim = self.start_sim(xml)
        dump = self.dump()
        boot = self.boot("--once", "--timeout", 120, "-q", xml)
        self.assert_stopped(sim)
        frames = dump.end()
        table = [line for line in boot.out.text().splitlines() if line.endswith(" booted")]
        self.assertEqual(len(table), len(NODES), boot.story())
        self.assertNotIn("lost", boot.out.text())
        self.check(frames)

    def check(self, frames):
        kinds = Counter(int(frame[:3], 16) & 0x780 for frame in frames)
        repeated = [frame for frame, count in Counter(frames).items()
                    if count > 1 and frame.startswith("6")]
        self.assertEqual(repeated, [], "requests sent twice")
        plant.say(f"{len(frames)} frames, {dict((hex(k), v) for k, v in sorted(kinds.items()))}")
        self.assertEqual(len(frames), len(NODES) * FRAMES_OF_NODE + FRAMES_OF_MANAGER)
        self.assertEqual(kinds[0x600], len(NODES) * (1 + IDENTITIES + VALUES + 1))
        self.assertEqual(kinds[0x580], kinds[0x600])
        there = set(frames)
        for node_id in NODES:
            for sub in range(1, VALUES + 1):
                self.assertIn(download(node_id, sub), there, f"node {node_id}, value {sub}")


if __name__ == "__main__":
    plant.main()
