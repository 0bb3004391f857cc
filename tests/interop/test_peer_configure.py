#!/usr/bin/env python3
"""python-canopen configures the network of 'mcanopen boot', whose file knows no node."""
import re
import struct
import time

import canopen
from peers import PeerTest, plant
from devices import UNSIGNED8, UNSIGNED16, VISIBLE_STRING, Entry, dcf, network, node, standard

MANAGER, ALL, RESET_COMMUNICATION = 127, 0x80, 0x07
LISTED, BOOTED, MANDATORY = 0x01, 0x04, 0x08
CONF = struct.unpack("<L", b"conf")[0]
NMT, CONCISE, TEXT, REQUEST = 0x1F82, 0x1F22, 0x1F20, 0x1F25
TABLE = "node  name"


def device(number, value):
    return dcf(number, [*standard(number, heartbeat=500), Entry(0x2000, UNSIGNED8, 0, "rw", value),
                        Entry(0x2001, UNSIGNED16, 0, "rw", 1000 + value),
                        Entry(0x2002, VISIBLE_STRING, "none", "rw", f"pump number {number}")])


class PeerConfigure(PeerTest):
    """The same plant by its file and over CAN: 5 mandatory, 6 not, 9 not there."""

    def setUp(self):
        super().setUp()
        self.texts = {number: device(number, number) for number in (5, 6, 9)}
        for number, text in self.texts.items():
            self.write(f"{number}.dcf", text)

    def start_devices(self):
        return self.start_sim("--node", 5, self.folder / "5.dcf", "--node", 6,
                              self.folder / "6.dcf")

    def remote(self, number):
        """A node as python-canopen sees it."""
        if number not in self.network:
            self.network.add_node(canopen.RemoteNode(number, canopen.ObjectDictionary()))
            self.network[number].sdo.RESPONSE_TIMEOUT = plant.LIMIT
        return self.network[number].sdo

    def number(self, node_id, index, sub=0):
        return int.from_bytes(self.remote(node_id).upload(index, sub), "little")

    def put(self, index, sub, value, size=4):
        self.remote(MANAGER).download(index, sub, value.to_bytes(size, "little"))

    def boot_by_file(self):
        nodes = [node(number, DCF_File=f"{number}.dcf", Serial_Number=number,
                      Vendor_Identification=0x29A, Consumer_Heartbeat_Time=20000,
                      NMT_Mandatory_Slave="TRUE" if number == 5 else "FALSE")
                 for number in self.texts]
        process = self.start_boot(self.write("network.xml", network(
            nodes, Boot_Time=50000, NMT_Start_All="TRUE", Heartbeat_Producer_Time=700)))
        process.wait_for("network is up")
        return process

    def configure(self, concise):
        """Node 5 by its concise DCF, the others by the text."""
        self.put(0x1017, 0, 700, 2)
        self.put(0x1F80, 0, 0x03)
        self.put(0x1F89, 0, 50000)
        for number, text in self.texts.items():
            manager = self.remote(MANAGER)
            if number == 5:
                manager.download(CONCISE, number, concise)
            else:
                manager.download(TEXT, number, text.encode())
            self.put(0x1016, number, number << 16 | 20000)
            self.put(0x1F85, number, 0x29A)
            self.put(0x1F88, number, number)
            self.put(0x1F81, number, LISTED | BOOTED | (MANDATORY if number == 5 else 0))

    def boot_over_can(self, concise):
        process = self.start_boot(self.write("empty.xml", network([])))
        process.wait_for("network is up: 0 of 0")
        self.configure(concise)
        self.put(NMT, ALL, RESET_COMMUNICATION, 1)
        process.wait_for("network is up: 2 of 3")
        return process

    def wait_for_start(self):
        """Until both run, and the manager knows that 9 is missing."""
        wanted, states = [5, 5, 1, 5], []
        deadline = time.monotonic() + plant.LIMIT
        while states != wanted and time.monotonic() < deadline:
            time.sleep(0.02)
            states = [self.number(MANAGER, NMT, number) for number in (5, 6, 9, MANAGER)]
        self.assertEqual(states, wanted)

    def configuration(self):
        """What the manager's dictionary says, and the devices'."""
        said = {}
        for index, sub in [(0x1017, 0), (0x1F80, 0), (0x1F89, 0)]:
            said[index, sub] = self.remote(MANAGER).upload(index, sub)
        for index in (0x1016, 0x1028, 0x1F22, 0x1F26, 0x1F27, 0x1F55, 0x1F81, NMT, 0x1F83, 0x1F84,
                      0x1F85, 0x1F86, 0x1F87, 0x1F88, 0x1F8A):
            for sub in (5, 6, 7, 9):
                said[index, sub] = self.remote(MANAGER).upload(index, sub)
        for number in (5, 6):
            for index in (0x1017, 0x2000, 0x2001, 0x2002):
                said[number, index] = self.remote(number).upload(index, 0)
        return said

    def records(self, process):
        """The table of the boot records, but for how often: that is a matter of time."""
        self.assert_stopped(process)
        lines = process.out.text().split(TABLE)[-1].splitlines()[1:]
        rows = [re.sub(r"; tried \d+ times?$", "", line) for line in lines
                if re.match(r" *\d+ ", line)]
        self.assertEqual(len(rows), 3, process.story())
        return rows

    def run_plant(self, boot, *arguments):
        sim = self.start_devices()
        process = boot(*arguments)
        self.wait_for_start()
        configuration = self.configuration()
        records = self.records(process)
        self.assert_stopped(sim)
        return configuration, records

    def test_same(self):
        """by its file and over CAN it boots to the same"""
        by_file, file_records = self.run_plant(self.boot_by_file)
        self.assertEqual(by_file[5, 0x2002], b"pump number 5")
        over_can, records = self.run_plant(self.boot_over_can, by_file[0x1F22, 5])
        self.assertEqual(over_can, by_file)
        self.assertEqual(records, file_records)

    def test_configure_now(self):
        """1F25h: a value of a running device, and what was wrong with it"""
        sim = self.start_devices()
        process = self.boot_by_file()
        self.wait_for_start()
        manager = self.remote(MANAGER)
        manager.download(TEXT, 6, device(6, 66).encode())
        self.assertEqual(self.number(6, 0x2000), 6)
        begin = self.heard.count()
        self.put(REQUEST, 6, CONF)
        stopped = self.heard.wait_for("000#8006", begin)
        self.heard.wait_for("000#0106", stopped)
        self.assertEqual(self.number(6, 0x2000), 66)
        with self.assertRaises(canopen.SdoAbortedError) as caught:
            manager.download(TEXT, 6, device(5, 66).encode())
        self.assertEqual(caught.exception.code, 0x08000020)
        process.wait_for("what a tool has written to 1F20h:06 is refused: 1F20h:")
        with self.assertRaises(canopen.SdoAbortedError) as caught:
            manager.download(CONCISE, 6, b"\1\0\0\0\0\x20\0\1\0\0\0")
        self.assertEqual(caught.exception.code, 0x06070013)
        self.wait_for_start()
        self.assert_stopped(process)
        self.assert_stopped(sim)


if __name__ == "__main__":
    plant.main()
