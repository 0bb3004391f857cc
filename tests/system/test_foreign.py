#!/usr/bin/env python3
"""What else there may be on a bus: another manager, traffic that is not CANopen's; and no bus."""
import errno
import os
import signal
import socket
import struct
import sys
import threading

import plant
from devices import UNSIGNED32, Entry, dcf, network, node, standard

WATCHED = {"Consumer_Heartbeat_Time": 5000, "SDO_Timeout": 1000}
FLOOD = str(plant.TOOLS.parent / "tests" / "flood")
FLOOD_FRAMES = 100000  # some seconds of a full bus
WRITES = 300
# What a manager or a device must not take for its own: 29-bit identifiers, remote frames.
FOREIGN = ("00000000#0205", "00000000#8100", "00000705#00", "00000706#7F",
           "00000585#8000100000000206", "00000605#4000100000000000", "0000077F#00",
           "00000085#0010010000000000",
           "1FFFFFFF#FFFFFFFFFFFFFFFF", "000#R2", "585#R8", "605#R8", "77F#R1", "080#R", "085#R8")
FOREIGN_FD = ((0x000, "0205"), (0x705, "00"), (0x705, "7F00000000000000"), (0x77F, "05"),
              (0x585, "8000100000000206"), (0x605, "4000100000000000AAAAAAAA"))
NO_BUS, NOT_ALLOWED = 3, os.strerror(errno.EPERM)


def has_can():
    try:
        socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW).close()
    except OSError:
        return False
    return True


class FdFlood(threading.Thread):
    """Sends CAN FD frames until it is ended, 2000 a second where the machine can."""

    def __init__(self, interface):
        super().__init__(daemon=True)
        self.socket = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
        self.socket.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FD_FRAMES, 1)
        self.socket.bind((interface,))
        self.frames = [struct.pack("=IB3x64s", can_id, len(data) // 2, bytes.fromhex(data))
                       for can_id, data in FOREIGN_FD]
        self.sent, self.failed = 0, None
        self.over = threading.Event()
        self.start()

    def run(self):
        try:
            while not self.over.wait(0.001):
                for _ in range(2):
                    self.socket.send(self.frames[self.sent % len(self.frames)])
                    self.sent += 1
        except OSError as error:
            self.failed = error

    def end(self):
        self.over.set()
        self.join()
        self.socket.close()


class ForeignTest(plant.PlantTest):
    def setUp(self):
        super().setUp()
        numbers = [Entry(0x2000 + n, UNSIGNED32, 0, "rw", n) for n in range(WRITES)]
        self.write("five.dcf", dcf(5, [*standard(5, heartbeat=200), *numbers]))
        self.write("six.dcf", dcf(6, standard(6, heartbeat=200)))

    def network(self, name="network.xml", **values):
        return self.write(name, network(
            [node(5, DCF_File="five.dcf", NMT_Mandatory_Slave="TRUE", **WATCHED),
             node(6, DCF_File="six.dcf", **WATCHED)], **values))

    def start_devices(self):
        return self.start_sim("--node", 5, self.folder / "five.dcf",
                              "--node", 6, self.folder / "six.dcf")


class SecondManager(ForeignTest):
    def judge(self, node_id, says):
        """One is in operation, another is started, and ended again."""
        sim = self.start_devices()
        first = self.start_boot("--all", self.network())
        first.wait_for("network is up: 2 of 2")
        second = self.start_boot("--all", self.network("other.xml", Manager_Node_Id=node_id))
        for text in says:
            first.wait_for(text)
        second.wait_for("warning: another NMT master is on the bus: it commands \"start\"")
        second.kill()
        boot = self.boot("--once", "--all", self.network())  # of a third, but one after the other
        self.assertIn("network is up: 2 of 2", boot.out.text())
        self.assertIn(first.stop(signal.SIGINT), (0, 1), first.story())
        self.assert_stopped(sim)

    def test_other_node_id(self):
        """a second manager with a node-ID of its own: both tell of the other's commands"""
        self.judge(126, ["warning: another NMT master is on the bus: it commands "
                         "\"reset communication\" to all nodes"])

    def test_same_node_id(self):
        """a second manager with the same node-ID: this is told as well"""
        self.judge(127, ["warning: node 127 (manager): another device has this node-ID: it sends a "
                         "boot-up message",
                         "warning: another NMT master is on the bus: it commands "
                         "\"reset communication\" to all nodes"])


class Flood(ForeignTest):
    def boot_quietly(self):
        sim = self.start_devices()
        boot = self.boot("--once", "--all", self.network())
        self.assertIn("network is up: 2 of 2", boot.out.text())
        for word in ("error", "warning", "another"):
            self.assertNotIn(word, boot.out.text())
        self.assert_stopped(sim)

    def test_foreign(self):
        """a bus full of 29-bit and remote frames"""
        flood = self.start([FLOOD, self.bus.name, FLOOD_FRAMES, *FOREIGN])
        flood.wait_for("flooding")
        self.boot_quietly()
        self.assertIsNone(flood.popen.poll(), "the flood was over too early")

    def test_fd(self):
        """... of CAN FD frames"""
        if not self.bus.interface:
            self.skipTest("a virtual bus has no CAN FD frames")
        flood = FdFlood(self.bus.interface)
        self.addCleanup(flood.end)
        self.boot_quietly()
        self.assertIsNone(flood.failed)
        self.assertGreater(flood.sent, 100)
        plant.say(f"{flood.sent} frames")


class NoBus(ForeignTest):
    def judge(self, words, bus, expected):
        """Each program says so, in one line, and ends with 3."""
        self.bus.name = bus
        sim = ["sim", "--node", 6, self.folder / "six.dcf", "--bus", bus]
        for verb in (["boot", "--once", self.network()], sim, ["dump", bus]):
            process = self.run_command([*words, plant.MCANOPEN, *verb])
            self.assertEqual(process.code, NO_BUS, process.story())
            self.assertEqual(len(process.err.lines), 1, process.story())
            self.assertIn(expected, process.err.text(), process.story())
            plant.say(process.err.lines[0])

    def test_missing(self):
        """an interface that does not exist"""
        expected = "nosuch0: no such CAN interface; ip -br link"
        self.judge([], "nosuch0", expected if has_can() else "nosuch0: this kernel has no CAN")

    def test_not_can(self):
        """an interface that is not CAN"""
        expected = "lo is not a CAN interface; ip -br link"
        self.judge([], "lo", expected if has_can() else "lo: this kernel has no CAN support")

    def test_forbidden(self):
        """CAN sockets are not allowed; the kernel has none"""
        with open(plant.MCANOPEN, "rb") as program:
            if program.read(5)[4] == 1:  # a 32-bit program
                self.skipTest("socketcall() of 32-bit programs cannot be filtered by family")
        here = os.path.dirname(os.path.abspath(__file__))
        deny = [sys.executable, "-B", os.path.join(here, "deny_can.py")]
        self.judge([*deny, errno.EPERM], "can0",
                   f"can0: no right to open a CAN socket: {NOT_ALLOWED}; "
                   "allow AF_CAN to this container or service")
        self.judge([*deny, errno.EAFNOSUPPORT], "can0",
                   "can0: this kernel has no CAN support (run: modprobe can_raw)")


if __name__ == "__main__":
    plant.main()
