#!/usr/bin/env python3
"""python-canopen watches a device of ours, and is watched: heartbeats, emergencies, 1003h.

The device is sdo_device.c, that raises errors on demand and tells of its events.
"""
import subprocess

import canopen
from peers import Arrivals, PeerTest, plant, read_dictionary
from devices import dcf, standard

NODE, PEER, OTHER = 5, 9, 100
DEVICE = plant.TOOLS.parent / "tests" / "sdo_device"
ERRORS, HISTORY, EMCY_ID, EMCY_INHIBIT = 0x1001, 0x1003, 0x1014, 0x1015
WATCHED, HEARTBEAT, HEARD, BEHAVIOUR = 0x1016, 0x1017, 0x1028, 0x1029
RAISE, TAKE_BACK = 0x2300, 0x2301
SIZES = {ERRORS: 1, HISTORY: 4, EMCY_ID: 4, EMCY_INHIBIT: 2, WATCHED: 4, HEARTBEAT: 2, HEARD: 4,
         BEHAVIOUR: 1, RAISE: 8, TAKE_BACK: 4}
SWITCHED_OFF = 0x80000000
GENERIC, CURRENT, TEMPERATURE, COMMUNICATION, OWN = 0x01, 0x02, 0x08, 0x10, 0x80
LOST = 0x8130
TWICE, NO_DATA = 0x06040043, 0x08000024
NOT_VALID, NOT_STORED = 0x06090030, 0x08000020
STARTS, TIMEOUT, BOOT_UP = "event 40 1", "event 40 3", "event 40 4"


class PeerErrors(PeerTest):
    def setUp(self):
        super().setUp()
        boot_up = self.heard.count()
        self.device = self.start([DEVICE], stdin=subprocess.PIPE)
        self.heard.wait_for("705#00", boot_up)
        self.node = self.network.add_node(canopen.RemoteNode(NODE, canopen.ObjectDictionary()))
        self.node.sdo.RESPONSE_TIMEOUT = plant.LIMIT
        self.states, self.errors = Arrivals(), Arrivals()
        self.node.nmt.add_heartbeat_callback(
            lambda state: self.states.add(state, self.node.nmt.timestamp))
        self.node.emcy.add_callback(
            lambda error: self.errors.add((error.code, error.register, error.data),
                                          error.timestamp))

    def tearDown(self):
        self.device.popen.stdin.close()
        self.assertEqual(self.device.wait(), 0, self.device.story())

    def order(self, command):
        """What its stdin takes."""
        self.device.popen.stdin.write(command + "\n")
        self.device.popen.stdin.flush()

    def read(self, index, sub=0):
        return int.from_bytes(self.node.sdo.upload(index, sub), "little")

    def write(self, index, sub, value):
        size = 1 if sub == 0 and index == HISTORY else SIZES[index]
        self.node.sdo.download(index, sub, value.to_bytes(size, "little"))

    def assert_refused(self, code, action, *arguments):
        with self.assertRaises(canopen.SdoAbortedError, msg=f"{arguments}") as caught:
            action(*arguments)
        self.assertEqual(f"{caught.exception.code:08X}", f"{code:08X}", f"{arguments}")

    def command(self, state, number):
        """An NMT command, until a heartbeat tells the state."""
        self.node.nmt.state = state
        self.states.wait_for(number)

    def peer(self, number, heartbeat):
        """A device of python-canopen, whose heartbeat runs."""
        peer = canopen.LocalNode(number, read_dictionary(dcf(number, standard(number)), number))
        self.network.add_node(peer)
        self.addCleanup(peer.nmt.stop_heartbeat)
        peer.nmt.state = "INITIALISING"
        peer.nmt.state = "PRE-OPERATIONAL"
        peer.nmt.start_heartbeat(heartbeat)
        return peer

    # ---- heartbeats ----

    def test_watched_by_peer(self):
        """python-canopen sees each state in heartbeats, at their pace, until they are off"""
        self.write(HEARTBEAT, 0, 50)
        for state, number in (("OPERATIONAL", 5), ("STOPPED", 4), ("PRE-OPERATIONAL", 127)):
            self.command(state, number)
            self.assertEqual(self.node.nmt.wait_for_heartbeat(plant.LIMIT), state)
        begin = self.states.count()
        self.states.wait_for_count(begin + 10)
        gaps = self.states.gaps(begin)[:9]
        self.assertGreater(sum(gaps), 0.4, f"{gaps}")
        self.assertLess(min(gaps), 0.2, f"{gaps}")
        self.node.nmt.state = "RESET"
        self.states.wait_for(0)
        self.assertEqual(self.read(HEARTBEAT), 0)
        self.write(WATCHED, 1, PEER << 16 | 300)  # another clock: 300 ms without
        count = self.states.count()
        self.network.send_message(0x700 + PEER, [5])
        self.errors.wait_for_count(1)
        self.assertEqual(self.states.count(), count)

    def test_peer_watched(self):
        """heartbeats of python-canopen: when they are missing, and are back, it is told"""
        self.write(WATCHED, 1, PEER << 16 | 400)
        self.write(WATCHED, 3, OTHER << 16 | 4000)
        self.assert_refused(TWICE, self.write, WATCHED, 2, PEER << 16 | 1000)
        peer = self.peer(PEER, 20)
        self.peer(OTHER, 50)
        self.device.wait_for(f"{STARTS} {PEER:X}")
        self.device.wait_for(f"{STARTS} {OTHER:X}")
        peer.nmt.stop_heartbeat()
        self.errors.wait_for((LOST, GENERIC | COMMUNICATION, bytes((1, 0, 0, 0, 0))))
        self.device.wait_for(f"{TIMEOUT} {PEER:X}")
        self.assertEqual(self.read(ERRORS), GENERIC | COMMUNICATION)
        self.assertEqual(self.read(HISTORY, 1) & 0xFFFF, LOST)
        peer.nmt.start_heartbeat(20)
        self.errors.wait_for((0, 0, bytes(5)))
        self.device.wait_for(f"{STARTS} {PEER:X}", times=2)
        self.assertEqual(self.read(ERRORS), 0)
        self.assertEqual(self.errors.count(), 2)
        self.assertNotIn(f"{TIMEOUT} {OTHER:X}", self.device.out.text())

    def test_behaviour(self):
        """what a lost heartbeat does to the state is what python-canopen writes to 1029h"""
        self.write(HEARTBEAT, 0, 30)
        for count, (behaviour, state) in enumerate(((0, 127), (1, 5), (2, 4))):
            self.write(BEHAVIOUR, 1, behaviour)
            self.write(WATCHED, 1, PEER << 16 | 100)
            self.command("OPERATIONAL", 5)
            self.network.send_message(0x700 + PEER, [5])
            self.errors.wait_for_count(2 * count + 1)
            self.assertEqual(self.errors.all[-1][0], LOST)
            begin = self.states.count()
            self.states.wait_for_count(begin + 2)
            self.assertEqual(self.states.all[-1], state)
            if state == 4:
                self.command("PRE-OPERATIONAL", 127)
            self.write(WATCHED, 1, 0)
            self.errors.wait_for((0, 0, bytes(5)))

    # ---- emergencies ----

    def raise_error(self, code, register, information=0, field=b"\0\0\0"):
        """By its object, which takes no more than 3 bytes for the field. Then it is there."""
        count = self.errors.count()
        self.write(RAISE, 0, code | information << 16 | register << 32 |
                   int.from_bytes(field, "little") << 40)
        self.errors.wait_for_count(count + 1)
        return self.errors.all[-1]

    def take_back(self, register, field=b"\0\0\0"):
        count = self.errors.count()
        self.write(TAKE_BACK, 0, register | int.from_bytes(field, "little") << 8)
        self.errors.wait_for_count(count + 1)
        return self.errors.all[-1]

    def history(self):
        return [self.read(HISTORY, sub) for sub in range(1, self.read(HISTORY) + 1)]

    def active(self):
        return [(error.code, error.register) for error in self.node.emcy.active]

    def test_errors(self):
        """errors of the application: code, register, field; python-canopen's list; 1003h"""
        self.assertEqual((self.read(ERRORS), self.history()), (0, []))
        self.assertEqual(self.raise_error(0x2310, CURRENT, 0x1234, b"\x11\x22\x33"),
                         (0x2310, GENERIC | CURRENT, b"\x11\x22\x33\0\0"))
        self.assertEqual(self.raise_error(0x4201, TEMPERATURE | OWN, 0xABCD),
                         (0x4201, GENERIC | CURRENT | TEMPERATURE | OWN, bytes(5)))
        self.assertEqual(self.read(ERRORS), GENERIC | CURRENT | TEMPERATURE | OWN)
        self.assertEqual(self.history(), [0xABCD4201, 0x12342310])
        self.assertEqual(len(self.active()), 2)
        self.assertEqual(self.take_back(TEMPERATURE | OWN, b"\x0A\x0B\x0C"),
                         (0, GENERIC | CURRENT, b"\x0A\x0B\x0C\0\0"))
        self.assertEqual(self.read(ERRORS), GENERIC | CURRENT)
        self.assertEqual(self.active(), [])  # to it each 0000h takes back all
        self.assertEqual(self.take_back(CURRENT), (0, 0, bytes(5)))
        self.assertEqual(self.read(ERRORS), 0)
        self.assertEqual(self.history(), [0xABCD4201, 0x12342310])
        self.assert_refused(NOT_STORED, self.write, TAKE_BACK, 0, CURRENT)  # there is none
        self.assert_refused(NOT_VALID, self.write, RAISE, 0, 0)

    def test_history(self):
        """1003h keeps the latest four, and is cleared by 0 alone"""
        for number in range(1, 7):
            self.raise_error(0xFF00 + number, 0, number)
        self.assertEqual(self.history(), [0x6FF06, 0x5FF05, 0x4FF04, 0x3FF03])
        self.assert_refused(NOT_VALID, self.write, HISTORY, 0, 1)
        self.write(HISTORY, 0, 0)
        self.assertEqual(self.history(), [])
        self.assert_refused(NO_DATA, self.read, HISTORY, 1)
        self.assertEqual(self.read(ERRORS), GENERIC)  # the errors are still there
        self.raise_error(0x5000, 0)
        self.assertEqual(self.history(), [0x5000])

    def test_cob_id(self):
        """1014h: emergencies under another COB-ID, and none"""
        self.assertEqual(self.read(EMCY_ID), 0x80 + NODE)
        others = Arrivals()
        self.network.subscribe(0x3F0, lambda can_id, data, when: others.add(bytes(data), when))
        self.assert_refused(NOT_VALID, self.write, EMCY_ID, 0, 0x3F0)  # while it is in use
        self.write(EMCY_ID, 0, SWITCHED_OFF | 0x3F0)
        self.write(RAISE, 0, 0x1000)
        self.write(EMCY_ID, 0, 0x3F0)
        self.write(RAISE, 0, 0x1001)
        others.wait_for(b"\x01\x10\x01\0\0\0\0\0")
        self.assertEqual((others.count(), self.errors.count()), (1, 0))
        self.assertEqual(self.history(), [0x1001, 0x1000])
        self.node.nmt.state = "RESET"
        self.states.wait_for(0)
        self.assertEqual(self.read(EMCY_ID), 0x80 + NODE)
        self.assertEqual(self.raise_error(0x1002, 0), (0x1002, GENERIC, bytes(5)))

    def test_inhibit(self):
        """1015h: emergencies keep their order and their distance, none is lost"""
        self.write(EMCY_INHIBIT, 0, 1000)  # of 100 us
        for number in range(5):
            self.write(RAISE, 0, 0x1000 + number)
        self.errors.wait_for_count(5)
        self.assertEqual([code for code, _, _ in self.errors.all],
                         [0x1000 + number for number in range(5)])
        self.assertGreater(min(self.errors.gaps()), 0.05, f"{self.errors.gaps()}")

    def test_stopped(self):
        """in STOPPED no emergency is sent; those of meanwhile follow"""
        self.write(HEARTBEAT, 0, 30)
        self.command("STOPPED", 4)
        self.order("error 1000 1 2")
        self.order("error 5000 2 0")
        self.device.wait_for("error 0", times=2)
        begin = self.states.count()
        self.states.wait_for_count(begin + 2)
        self.assertEqual(self.errors.count(), 0)
        self.command("OPERATIONAL", 5)
        self.errors.wait_for_count(2)
        self.assertEqual([code for code, _, _ in self.errors.all], [0x1000, 0x5000])
        self.assertEqual(self.history(), [0x25000, 0x11000])

    def test_consumed(self):
        """emergencies of a device of python-canopen come as events, while 1028h names it"""
        peer, other = self.peer(PEER, 0), self.peer(OTHER, 0)
        self.write(HEARD, PEER, 0x80 + PEER)
        other.emcy.send(0x1000, 1)
        peer.emcy.send(0x8110, 0x11, b"\x01\x02\x03\x04\x05")
        peer.emcy.reset()
        self.device.wait_for("event 20 9 10 81 11 01 02 03 04 05")
        self.device.wait_for("event 20 9 00 00 00 00 00 00 00 00")
        self.assertNotIn(f"event 20 {OTHER}", self.device.out.text())


if __name__ == "__main__":
    plant.main()
