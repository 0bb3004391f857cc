#!/usr/bin/env python3
"""Devices from their vendors' files: ours, simulated, read by python-canopen, which reads the files
in its own way. Both have to come to the same values.

One file of each project of the corpus. Left out: files and values that python-canopen does not
take, domains (python-canopen takes strange data types for such), and 1003h, the device's history.
"""
import configparser
import struct
import unittest

import canopen
from peers import PeerTest, plant, read_dictionary, variables

NODE = 5
SIZE = 60000  # larger files take their time, and bring nothing new
TYPES = {*range(0x01, 0x0C), 0x10, 0x11, *range(0x12, 0x17), *range(0x18, 0x1C)}
WRITE_ONLY = 0x06010001


def sources():
    """The first file of each project."""
    files = {}
    for path in sorted(plant.CORPUS.rglob("*")):
        if path.suffix.lower() in (".eds", ".dcf") and path.stat().st_size < SIZE:
            files.setdefault(path.parent, path)
    return list(files.values())


def text_of(path):
    try:
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return path.read_text(encoding="latin-1")


def peer_reads(path):
    """A node of python-canopen; None where it does not take the file."""
    try:
        return canopen.RemoteNode(NODE, read_dictionary(text_of(path), NODE))
    except (ValueError, KeyError, configparser.Error):
        return None


def packed(entry):
    """Its default in bytes; None where it has none that python-canopen can pack."""
    if entry.default is None:
        return None
    try:
        return entry.encode_raw(entry.default)
    except (ValueError, TypeError, struct.error):  # a hexadecimal negative number, a character
        return None


@unittest.skipUnless(plant.CORPUS.is_dir(), f"no corpus in {plant.CORPUS}")
class PeerCorpus(PeerTest):
    def assert_equal_values(self, node, path):
        """Returns how many values were compared."""
        count = 0
        for entry in variables(node.object_dictionary):
            if entry.index == 0x1003 or entry.data_type not in TYPES:
                continue
            where = f"{path.name}: {entry.index:04X}h:{entry.subindex:02X}"
            try:
                value = node.sdo.upload(entry.index, entry.subindex)
            except canopen.SdoAbortedError as error:
                self.assertEqual((error.code, entry.readable), (WRITE_ONLY, False), where)
                continue
            if packed(entry) is not None:
                self.assertEqual(value.hex(), packed(entry).hex(), where)
                count += 1
        return count

    def compare(self, path):
        node = peer_reads(path)
        if node is None:
            return 0
        before = self.heard.count()
        sim = self.start_sim("--node", NODE, path)
        self.heard.wait_for("705#00", before)
        node.sdo.RESPONSE_TIMEOUT = plant.LIMIT
        self.network.add_node(node)
        try:
            return self.assert_equal_values(node, path)
        finally:  # the next device has the same node-ID
            del self.network[NODE]
            sim.stop()

    def test_defaults(self):
        """the values of both are the same"""
        counts = []
        for path in sources():
            with self.subTest(path=path.name):
                counts.append(self.compare(path))
        compared = [count for count in counts if count]
        self.assertGreater(len(compared), 15)
        plant.say(f"{sum(compared)} values of {len(compared)} devices")


if __name__ == "__main__":
    plant.main()
