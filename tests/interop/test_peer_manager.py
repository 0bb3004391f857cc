#!/usr/bin/env python3
"""python-canopen as a tool beside 'mcanopen boot': it reads and commands through the manager."""
import struct

import canopen
from peers import PeerTest, plant
from devices import Entry, dcf, network, node, standard

MANAGER = 127
MISSING, STOPPED, OPERATIONAL, PREOPERATIONAL = 0x01, 0x04, 0x05, 0x7F
RESET_NODE, RESET_COMMUNICATION, ALL = 0x06, 0x07, 0x80
REQUEST_NMT, REQUEST_GUARDING = 0x1F82, 0x1F83
WRITE_ONLY, READ_ONLY, INVALID, NOT_NOW = 0x06010001, 0x06010002, 0x06090030, 0x08000022


class PeerManager(PeerTest):
    def boot_devices(self, *numbers, absent=(), **values):
        """Devices of python-canopen, booted; the manager as a tool sees it."""
        texts = {number: dcf(number, [*standard(number), Entry(0x2000, 5, 0, "rw", number)])
                 for number in (*numbers, *absent)}
        for number, text in texts.items():
            self.write(f"{number}.dcf", text)
        nodes = [node(number, DCF_File=f"{number}.dcf", SDO_Timeout=20000 if number in numbers
                      else 200, Serial_Number=number) for number in texts]
        xml = self.write("network.xml", network(nodes, **values))
        devices = self.add_devices({number: texts[number] for number in numbers})
        self.process = self.start_boot(xml)
        tool = canopen.RemoteNode(MANAGER, canopen.ObjectDictionary())
        tool.sdo.RESPONSE_TIMEOUT = plant.LIMIT
        self.network.add_node(tool)
        return tool.sdo, devices

    def read(self, sdo, index, sub=0):
        return int.from_bytes(sdo.upload(index, sub), "little")

    def request(self, sdo, number, value):
        sdo.download(REQUEST_NMT, number, bytes([value]))

    def assert_refused(self, code, action, *arguments):
        with self.assertRaises(canopen.SdoAbortedError, msg=f"{arguments}") as caught:
            action(*arguments)
        self.assertEqual(f"{caught.exception.code:08X}", f"{code:08X}", f"{arguments}")

    def test_look(self):
        """states, and what the network's configuration is"""
        sdo, _ = self.boot_devices(5, 6, absent=[9], Boot_Time=50000)
        self.process.wait_for("network is up")
        states = [self.read(sdo, REQUEST_NMT, number) for number in (5, 6, 9, 77, MANAGER)]
        self.assertEqual(states, [OPERATIONAL, OPERATIONAL, MISSING, 0, OPERATIONAL])
        self.assert_refused(WRITE_ONLY, sdo.upload, REQUEST_NMT, ALL)
        for index, sub, value in ((0x1F80, 0, 1), (0x1F81, 5, 5), (0x1F81, 7, 0), (0x1F88, 6, 6),
                                  (0x1F89, 0, 50000), (0x1028, 5, 0x85), (0x1028, 7, 0x80000000),
                                  (REQUEST_GUARDING, 5, 0), (0x1000, 0, 0)):
            self.assertEqual(self.read(sdo, index, sub), value, f"{index:04X}h:{sub}")
        self.assert_refused(READ_ONLY, sdo.download, 0x1028, 5, struct.pack("<L", 0))
        self.assert_stopped(self.process)

    def test_command(self):
        """stop, pre-operational, start, of one node and of all; the manager tells of it"""
        sdo, (five, six) = self.boot_devices(5, 6)
        self.process.wait_for("network is up")
        self.request(sdo, 5, STOPPED)
        self.process.wait_for('a tool commands by 1F82h: "stop" to node 5')
        self.assertEqual(self.read(sdo, REQUEST_NMT, 5), STOPPED)
        self.request(sdo, 5, OPERATIONAL)
        self.request(sdo, ALL, PREOPERATIONAL)
        self.heard.wait_for("000#8000")
        self.request(sdo, ALL, OPERATIONAL)
        self.heard.wait_for("000#0100|000#0106")
        self.assert_refused(INVALID, self.request, sdo, 77, STOPPED)
        self.assert_refused(INVALID, self.request, sdo, 5, 0x01)
        self.assert_stopped(self.process)
        self.assertEqual([five.nmt.state, six.nmt.state], ["OPERATIONAL", "OPERATIONAL"])

    def test_reset(self):
        """a node, then all: booted and configured anew"""
        sdo, (five, six) = self.boot_devices(5, 6)
        self.process.wait_for("network is up")
        for number, value, command in ((5, RESET_COMMUNICATION, "000#8205"),
                                       (ALL, RESET_NODE, "000#8100")):
            begin = self.heard.count()
            self.request(sdo, number, value)
            configured = self.heard.wait_for("605#2F00200005......",
                                             self.heard.wait_for(command, begin))
            self.heard.wait_for("000#0105", configured)
        self.heard.wait_for("000#0106", begin)
        self.process.wait_for("network is up", times=2)
        self.assertEqual([device.written()[0x2000, 0] for device in (five, six)], [b"\5", b"\6"])
        self.assert_stopped(self.process)

    def test_start_network(self):
        """a network that waits for its application is started by the tool"""
        sdo, devices = self.boot_devices(5, 6, NMT_Auto_Operational="FALSE")
        for device in devices:
            self.process.wait_for(f"node {device.id}: booted")
        self.assert_refused(NOT_NOW, self.request, sdo, 5, OPERATIONAL)
        self.request(sdo, MANAGER, OPERATIONAL)
        self.process.wait_for("network is up")
        self.assertEqual(self.read(sdo, REQUEST_NMT, MANAGER), OPERATIONAL)
        self.heard.wait_for("000#0106")
        self.assert_stopped(self.process)


if __name__ == "__main__":
    plant.main()
