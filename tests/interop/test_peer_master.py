#!/usr/bin/env python3
"""python-canopen as master reads and writes every object of devices of 'mcanopen sim'."""
import struct

import canopen
from canopen.objectdictionary import datatypes
from peers import EXAMPLE, PeerTest, plant, read_dictionary, variables
from devices import Entry, Record, dcf, standard

NODE = 5
READ_ONLY, WRITE_ONLY, NO_OBJECT, NO_SUB = 0x06010002, 0x06010001, 0x06020000, 0x06090011
TOO_LONG, TOO_SHORT, TOO_HIGH, TOO_LOW = 0x06070012, 0x06070013, 0x06090031, 0x06090032
NO_DATA = 0x08000024
SWITCHED_OFF = 0x80000000  # in a COB-ID

# Each type of CiA 301, its default, another value. python-canopen packs numbers as they stand in
# the file, so negative ones stand there in decimal.
TYPES = [
    (0x01, "1", False), (0x02, "-128", 127), (0x03, "-2", -32768), (0x04, "-70000", 2147483647),
    (0x05, "0xFF", 1), (0x06, "0xFFFE", 1), (0x07, "0xFFFFFFFE", 1), (0x08, "1.5", -0.25),
    (0x09, "a text of more than four bytes", "another text, this one is longer than its default"),
    (0x0A, "0011223344556677", bytes(range(40))), (0x10, "-8388608", 8388607),
    (0x11, "-0.1", 1e300), (0x12, "-549755813888", 7), (0x13, "-2", 140737488355327),
    (0x14, "-36028797018963968", 7), (0x15, "-9223372036854775808", 7),
    (0x16, "0xFEDCBA", 1), (0x18, "0xFEDCBA9876", 1), (0x19, "0xFEDCBA987654", 1),
    (0x1A, "0xFEDCBA98765432", 1), (0x1B, "0xFEDCBA9876543210", 1),
]

# What these objects take; others take anything of their type. Those before "None" come first, they
# switch PDOs off and mappings free.
SPECIAL = {
    (0x1400, 1): SWITCHED_OFF | 0x205, (0x1800, 1): SWITCHED_OFF | 0x185,
    (0x1600, 0): 0, (0x1A00, 0): 0, None: None,
    (0x1003, 0): 0, (0x1010, 1): 0x65766173, (0x1011, 1): 0x64616F6C,
    (0x1014, 0): SWITCHED_OFF | 0x85, (0x1016, 1): 0x007F0BB8, (0x1029, 1): 1, (0x1800, 2): 1,
    **{(0x1600, sub): 0x60420010 for sub in range(1, 5)},
    **{(0x1A00, sub): 0x60440010 for sub in range(1, 5)},
}
FIRST = list(SPECIAL)[:list(SPECIAL).index(None)]
SIGNATURES = (0x1010, 0x1011)  # these do not keep what is written


def other_value(entry):
    """One that the entry does not have by default."""
    key = entry.index, entry.subindex
    if key in SPECIAL:
        return SPECIAL[key]
    if entry.data_type == datatypes.VISIBLE_STRING:
        return "written by a peer of other make"
    return 0x5A if entry.default != 0x5A else 0x5B


class PeerMaster(PeerTest):
    def simulate(self, text):
        """The device as python-canopen sees it."""
        boot_up = self.heard.count()
        self.sim = self.start_sim("--node", NODE, self.write("device.dcf", text))
        self.heard.wait_for("705#00", boot_up)
        node = canopen.RemoteNode(NODE, read_dictionary(text, NODE))
        node.sdo.RESPONSE_TIMEOUT = plant.LIMIT
        return self.network.add_node(node)

    def example(self):
        return self.simulate((EXAMPLE / "pump.dcf").read_text(encoding="utf-8"))

    def assert_refused(self, code, action, *arguments):
        with self.assertRaises(canopen.SdoAbortedError, msg=f"{arguments}") as caught:
            action(*arguments)
        self.assertEqual(f"{caught.exception.code:08X}", f"{code:08X}", f"{arguments}")

    def assert_defaults(self, node):
        """Each object that can be read has its DefaultValue."""
        count = 0
        for entry in variables(node.object_dictionary):
            where = f"{entry.index:04X}h:{entry.subindex:02X}"
            if entry.index == 0x1003 and entry.subindex > 0:
                self.assert_refused(NO_DATA, node.sdo.upload, entry.index, entry.subindex)
            elif entry.readable:
                value = entry.decode_raw(node.sdo.upload(entry.index, entry.subindex))
                self.assertIsNotNone(entry.default, where)
                self.assertEqual(value, entry.default, where)
            else:
                self.assert_refused(WRITE_ONLY, node.sdo.upload, entry.index, entry.subindex)
            count += 1
        return count

    def write_and_read(self, node, entry, value):
        data = entry.encode_raw(value)
        node.sdo.download(entry.index, entry.subindex, data)
        if entry.index not in SIGNATURES and entry.readable:
            is_now = node.sdo.upload(entry.index, entry.subindex)
            self.assertEqual(is_now, data, f"{entry.index:04X}h:{entry.subindex:02X}")

    def write_everything(self, node, values):
        """Each object takes a value, or refuses it as it cannot be written."""
        entries = sorted(variables(node.object_dictionary),
                         key=lambda each: (each.index, each.subindex) not in FIRST)
        taken = 0
        for entry in entries:
            if entry.writable:
                self.write_and_read(node, entry, values(entry))
                taken += 1
            else:
                self.assert_refused(READ_ONLY, node.sdo.download, entry.index, entry.subindex,
                                    entry.encode_raw(entry.default or 0))
        return taken, len(entries) - taken

    def test_example(self):
        """every object of the example's pump: read, written, read back"""
        node = self.example()
        count = self.assert_defaults(node)
        taken, refused = self.write_everything(node, other_value)
        self.assertGreater(taken, 30)
        self.assertGreater(refused, 20)
        plant.say(f"{count} objects: {taken} written and read back, {refused} refused")

    def test_configured_by_peer(self):
        """the example's pump, configured by python-canopen in its own order"""
        node = self.example()
        node.load_configuration()
        compared = 0
        for entry in variables(node.object_dictionary):
            if entry.value is not None:
                value = entry.decode_raw(node.sdo.upload(entry.index, entry.subindex))
                self.assertEqual(value, entry.value, f"{entry.index:04X}h:{entry.subindex:02X}")
                compared += 1
        self.assertGreater(compared, 15)

    def test_mapping_by_peer(self):
        """PDOs as python-canopen reads them, and maps them anew"""
        node = self.example()
        node.tpdo.read()
        pdo = node.tpdo[1]
        self.assertEqual([(var.index, var.subindex, var.length) for var in pdo],
                         [(0x6041, 0, 16), (0x6044, 0, 16)])
        self.assertEqual((pdo.enabled, pdo.cob_id, pdo.trans_type), (True, 0x185, 255))
        pdo.clear()
        for index, sub in ((0x6046, 2), (0x1001, 0), (0x6041, 0)):
            pdo.add_variable(index, sub)
        pdo.trans_type, pdo.inhibit_time, pdo.event_timer = 254, 50, 300
        pdo.save()
        self.assertEqual([node.sdo[0x1A00][sub].raw for sub in range(1, 4)],
                         [0x60460220, 0x10010008, 0x60410010])
        self.assertEqual(node.sdo[0x1A00][0].raw, 3)
        self.assertEqual([node.sdo[0x1800][sub].raw for sub in (1, 2, 3, 5)], [0x185, 254, 50, 300])

    def test_types(self):
        """every data type"""
        entries = [Entry(0x2000, kind, default) for kind, default, _ in TYPES]
        node = self.simulate(dcf(NODE, [*standard(NODE), Record(0x2000, entries),
                                        Entry(0x2001, 5, 0, "wo"), Entry(0x2002, 7, 9, "const")]))
        self.assert_defaults(node)
        self.write_everything(node, lambda entry: TYPES[entry.subindex - 1][2]
                              if entry.index == 0x2000 else other_value(entry))

    def test_refused(self):
        """what is missing, too long, too short, too high or low is refused by the right code"""
        limits = Entry(0x2000, 5, "10\nLowLimit=5\nHighLimit=20")
        sdo = self.simulate(dcf(NODE, [*standard(NODE), limits])).sdo
        for index, sub, code in ((0x1F50, 0, NO_OBJECT), (0x5FFF, 1, NO_OBJECT),
                                 (0x1018, 5, NO_SUB), (0x1018, 255, NO_SUB), (0x1017, 1, NO_SUB)):
            self.assert_refused(code, sdo.upload, index, sub)
            self.assert_refused(code, sdo.download, index, sub, b"\x01")
            self.assert_refused(code, sdo.download, index, sub, b"segmented")
        self.assert_refused(TOO_LONG, sdo.download, 0x1017, 0, b"\x01\x02\x03")
        self.assert_refused(TOO_SHORT, sdo.download, 0x1017, 0, b"\x01")
        self.assert_refused(TOO_LONG, sdo.download, 0x1017, 0, b"segmented")
        self.assert_refused(TOO_HIGH, sdo.download, 0x2000, 0, b"\x15")
        self.assert_refused(TOO_LOW, sdo.download, 0x2000, 0, b"\x04")
        self.assertEqual(sdo.upload(0x2000, 0), b"\x0A")
        self.assertEqual(sdo.upload(0x1017, 0), b"\x00\x00")

    def test_block(self):
        """block transfers, and a download in segments whose size is not told"""
        sdo = self.example().sdo
        with sdo[0x1008].open("rb", block_transfer=True) as stream:
            self.assertEqual(stream.read(), b"Frequency inverter")
        with sdo[0x2001].open("wb", size=20, block_transfer=True) as stream:
            stream.write(b"twenty bytes of text")
        self.assertEqual(sdo[0x2001].raw, "twenty bytes of text")
        with sdo[0x2001].open("wb") as stream:  # no size told, an empty last segment
            stream.write(b"seven b")
        self.assertEqual(sdo[0x2001].raw, "seven b")

    def command(self, node, state, answer):
        """The answer is the next heartbeat, or the boot-up, after the command."""
        before = self.heard.count()
        node.nmt.state = state
        return self.heard.wait_for(answer, before)

    def test_nmt(self):
        """NMT commands, boot-up, heartbeats; what a reset leaves"""
        node = self.example()
        node.sdo[0x1017].raw = 50
        node.sdo[0x2000].raw = 77
        self.command(node, "OPERATIONAL", "705#05")
        self.assertEqual(node.sdo[0x2000].raw, 77)
        self.command(node, "STOPPED", "705#04")
        asked = self.heard.count()
        self.network.send_message(0x605, struct.pack("<BHBL", 0x40, 0x1000, 0, 0))
        self.command(node, "PRE-OPERATIONAL", "705#7F")
        self.assertNotIn("585", [frame[:3] for frame in self.heard.frames[asked:]])
        self.command(node, "RESET COMMUNICATION", "705#00")
        self.assertEqual(node.sdo[0x1017].raw, 0)
        self.assertEqual(node.sdo[0x2000].raw, 77)
        self.command(node, "RESET", "705#00")
        self.assertEqual(node.sdo[0x2000].raw, 10)
        everyone = self.heard.count()
        self.network.nmt.state = "RESET"
        self.heard.wait_for("705#00", everyone)

    def test_guarding(self):
        """node guarding: the answers toggle and tell the state"""
        node = self.example()
        begin = self.heard.count()
        node.nmt.start_node_guarding(0.02)
        self.addCleanup(node.nmt.stop_node_guarding)
        self.heard.wait_for("705#FF", self.heard.wait_for("705#7F", begin))
        self.command(node, "OPERATIONAL", "705#[08]5")
        node.nmt.stop_node_guarding()
        answers = [frame for frame in self.heard.frames[begin:]  # the kernel's requests come, too
                   if frame.startswith("705#") and frame != "705#R"]
        for one, other in zip(answers, answers[1:]):
            self.assertNotEqual(int(one[4:], 16) & 0x80, int(other[4:], 16) & 0x80, answers)

    def test_emergency(self):
        """a heartbeat that it watches ends: emergency, and its history; then it is back"""
        node = self.example()
        node.sdo[0x1016][1].raw = 0x00640000 | 200
        self.network.send_message(0x764, [5])
        self.heard.wait_for("085#3081110100000000")
        self.assertEqual(node.sdo[0x1001].raw, 0x11)
        self.assertEqual(node.sdo[0x1003][1].raw, 0x00018130)
        self.network.send_message(0x764, [5])
        self.heard.wait_for("085#0000000000000000")
        self.assertEqual([entry.code for entry in node.emcy.log][:2], [0x8130, 0])


if __name__ == "__main__":
    plant.main()
