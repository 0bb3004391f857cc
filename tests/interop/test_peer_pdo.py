#!/usr/bin/env python3
"""python-canopen sends and receives the PDOs of a device of ours, and maps them anew; with SYNC.

The device is pdo_device.c: outputs that are received are mirrored in inputs, which are sent. "Not
sent" is what an answer by SDO shows that is asked for later and comes without it.
"""
import subprocess
import time

import canopen
from peers import Arrivals, PeerTest, plant, read_dictionary
from devices import Entry, Record, dcf, standard

NODE, PEER = 5, 9
DEVICE = plant.TOOLS.parent / "tests" / "pdo_device"
OUTPUTS, OUTPUT_FLAGS, INPUTS, INPUT_FLAGS = 0x2100, 0x2101, 0x2200, 0x2201
MOMENT, SHARED, NOT_MAPPABLE = 0x2300, 0x2400, 0x2500
WIDTHS = [0x02, 0x03, 0x04, 0x15, 0x05, 0x06, 0x07, 0x1B, 0x08, 0x11]
I8, I16, I32, I64, U8, U16, U32, U64, FLOAT, DOUBLE = range(1, 11)
BITS = dict(zip(range(1, 11), (8, 16, 32, 64, 8, 16, 32, 64, 32, 64)))
NO_MAPPING, MAPPING_TOO_LONG = 0x06040041, 0x06040042
PRODUCES, FRAME_29_BIT = 0x40000000, 0x20000000
FLAGS = [(OUTPUT_FLAGS, sub) for sub in range(1, 9)]

# What RPDO 3 is mapped to, TPDO 4 to the inputs of it, and values for that.
MAPPINGS = [
    (FLAGS + [(OUTPUTS, sub) for sub in (I8, U8, I16, U16)],
     [True, False, False, True, True, False, True, False, -128, 0xFE, -2, 0xFEDC]),
    (FLAGS[5:], [True, False, True]),
    ([(OUTPUTS, I32), (OUTPUTS, FLOAT)], [-70000, 1.5]),
    ([(OUTPUTS, U32), (OUTPUTS, U8), (OUTPUTS, I16), (OUTPUTS, I8)], [0xFEDCBA98, 7, -32768, 127]),
    ([(OUTPUTS, I64)], [-9223372036854775808]),
    ([(OUTPUTS, U64)], [0xFEDCBA9876543210]),
    ([(OUTPUTS, DOUBLE)], [-0.1]),
]


def eds():
    """The device, for python-canopen."""
    def pdo(index, subs):
        kinds = [7, 5, 6, 5, 6, 5][:subs]
        return [Record(index, [Entry(index, kind, 0) for kind in kinds]),
                Record(index + 0x200, [Entry(index + 0x200, 7, 0) for _ in range(12)])]

    def record(index, kinds, access="rw"):
        return Record(index, [Entry(index, kind, 0, access) for kind in kinds])

    objects = [*standard(NODE), Entry(0x1005, 7, 0), Entry(0x1006, 7, 0), Entry(0x1007, 7, 0),
               Entry(0x1019, 5, 0)]
    for number in range(3):
        objects += pdo(0x1400 + number, 5)
    for number in range(4):
        objects += pdo(0x1800 + number, 6)
    objects += [record(OUTPUTS, WIDTHS), record(OUTPUT_FLAGS, [1] * 8),
                record(INPUTS, WIDTHS, "ro"), record(INPUT_FLAGS, [1] * 8, "ro"),
                Entry(MOMENT, 7, 0, "ro"), record(SHARED, [7, 8]), Entry(NOT_MAPPABLE, 5, 0)]
    return dcf(NODE, objects)


def inputs_of(mapping):
    return [(index + INPUTS - OUTPUTS, sub) for index, sub in mapping]


def map_anew(pdo, mapping, **parameters):
    """By python-canopen's own procedure. To it a BOOLEAN has 8 bits, so the length is told; it
    listens only behind the procedure and may miss what comes with its last step, so it does before.
    """
    pdo.clear()
    for index, sub in mapping:
        pdo.add_variable(index, sub, 1 if index in (OUTPUT_FLAGS, INPUT_FLAGS) else None)
    pdo.enabled = True
    pdo.subscribe()
    configure(pdo, **parameters)


def configure(pdo, **parameters):
    for name, value in parameters.items():
        setattr(pdo, name, value)
    pdo.save()


def send(pdo, values):
    for variable, value in zip(pdo, values, strict=True):
        variable.raw = value
    pdo.transmit()


class Received(Arrivals):
    """The values of a PDO that python-canopen receives, frame by frame."""

    def __init__(self, pdo):
        super().__init__()
        pdo.add_callback(lambda pdo: self.add([each.raw for each in pdo], pdo.timestamp))


class Syncs(Arrivals):
    """The SYNCs on the bus: the data of each. Its own are not heard by python-canopen, but for
    those of sync.start(), which the kernel sends.
    """

    def __init__(self, network):
        super().__init__()
        network.subscribe(0x80, lambda can_id, data, when: self.add(bytes(data), when))


class PeerPdo(PeerTest):
    def setUp(self):
        super().setUp()
        self.syncs = Syncs(self.network)
        boot_up = self.heard.count()
        self.device = self.start([DEVICE], stdin=subprocess.PIPE)
        self.heard.wait_for("705#00", boot_up)
        self.node = self.network.add_node(canopen.RemoteNode(NODE, read_dictionary(eds(), NODE)))
        self.node.sdo.RESPONSE_TIMEOUT = plant.LIMIT
        self.node.tpdo.read()
        self.node.rpdo.read()
        self.tpdo, self.rpdo = self.node.tpdo, self.node.rpdo

    def tearDown(self):
        self.device.popen.stdin.close()
        self.assertEqual(self.device.wait(), 0, self.device.story())

    def start_node(self):
        self.node.nmt.state = "OPERATIONAL"
        self.fence()

    def fence(self):
        """What was sent before is processed; what came of it is received."""
        self.assertEqual(self.node.sdo[0x1000].raw, 0x0)

    def value(self, index, sub):
        entry = self.node.sdo[index]
        return entry[sub].raw if sub else entry.raw

    def values(self, mapping):
        return [self.value(index, sub) for index, sub in mapping]

    def wait_for_value(self, value, index, sub=0):
        deadline = time.monotonic() + plant.LIMIT
        while self.value(index, sub) != value:
            self.assertLess(time.monotonic(), deadline, f"{index:04X}h:{sub:02X} is not {value}")

    def sync(self, count=None):
        self.network.sync.transmit(count)
        self.fence()

    def test_read(self):
        """PDOs as python-canopen reads them"""
        def seen(pdo):
            return (pdo.enabled, pdo.rtr_allowed, pdo.cob_id, pdo.trans_type,
                    [(each.index, each.subindex, each.length) for each in pdo])

        outputs = [(OUTPUTS, I8, 8), (OUTPUTS, I16, 16), (OUTPUTS, I32, 32)]
        inputs = [(INPUTS, sub, bits) for _, sub, bits in outputs]
        shared = [(SHARED, 1, 32), (SHARED, 2, 32)]
        self.assertEqual([seen(pdo) for pdo in self.rpdo.values()],
                         [(True, True, 0x205, 255, outputs), (True, True, 0x305, 1, shared),
                          (False, True, 0x405, 255, [])])
        self.assertEqual([seen(pdo) for pdo in self.tpdo.values()],
                         [(True, True, 0x185, 255, inputs), (True, True, 0x285, 1, shared),
                          (True, True, 0x385, 253, [(MOMENT, 0, 32)]),
                          (False, False, 0x485, 255, [])])

    def test_widths(self):
        """mapped anew to objects of all widths: received, mirrored, sent"""
        self.start_node()
        received = Received(self.tpdo[4])
        for mapping, values in MAPPINGS:
            map_anew(self.rpdo[3], mapping)
            map_anew(self.tpdo[4], inputs_of(mapping))
            self.assertNotEqual(self.values(mapping), values)
            send(self.rpdo[3], values)
            received.wait_for(values)
            self.assertEqual(self.values(mapping), values)
            self.assertEqual(self.values(inputs_of(mapping)), values)
            written = [self.value(0x1A03, sub) for sub in range(1, len(mapping) + 1)]
            self.assertEqual(written, [
                index << 16 | sub << 8 | (1 if index == INPUT_FLAGS else BITS[sub])
                for index, sub in inputs_of(mapping)])

    def test_refused(self):
        """what cannot be mapped is refused; then the PDO is off, and can be mapped again"""
        self.start_node()
        cases = [(self.tpdo[1], (NOT_MAPPABLE, 0, None), NO_MAPPING),
                 (self.tpdo[1], (INPUTS, U32, 16), NO_MAPPING),
                 (self.tpdo[1], (INPUT_FLAGS, 1, 2), NO_MAPPING),
                 (self.rpdo[1], (INPUTS, U8, None), NO_MAPPING),
                 (self.rpdo[1], (OUTPUTS, U64, None), MAPPING_TOO_LONG)]
        for pdo, entry, code in cases:
            pdo.clear()
            pdo.add_variable(*entry)
            if code == MAPPING_TOO_LONG:
                pdo.add_variable(OUTPUTS, I8)
            with self.assertRaises(canopen.SdoAbortedError) as caught:
                pdo.save()
            self.assertEqual(f"{caught.exception.code:08X}", f"{code:08X}", f"{entry}")
            self.assertTrue(pdo.com_record[1].raw & 1 << 31)
        received = Received(self.tpdo[1])
        map_anew(self.rpdo[1], [(OUTPUTS, U16)])
        map_anew(self.tpdo[1], [(INPUTS, U16)])
        send(self.rpdo[1], [0xABCD])
        received.wait_for([0xABCD])

    def test_periodic(self):
        """an RPDO that python-canopen sends periodically, and its changes"""
        self.start_node()
        received = Received(self.tpdo[1])
        self.rpdo[1].start(0.02)
        for values in ([1, -300, 70000], [-1, 300, -70000], [5, 6, 7]):
            for variable, value in zip(self.rpdo[1], values, strict=True):
                variable.raw = value
            received.wait_for(values)
        self.rpdo[1].stop()

    def test_peer_device(self):
        """a device of python-canopen and ours exchange PDOs. It does not write what it receives
        into its dictionary, so the values are those of its PDO."""
        peer = self.network.create_node(canopen.LocalNode(PEER, read_dictionary(eds(), PEER)))
        peer.rpdo[1].cob_id, peer.tpdo[1].cob_id = 0x185, 0x205
        for pdo in (peer.rpdo[1], peer.tpdo[1]):
            map_anew(pdo, [(OUTPUTS, I8), (OUTPUTS, I16), (OUTPUTS, I32)])
        received = Received(peer.rpdo[1])
        self.start_node()
        for values in ([1, 2, 3], [-1, -2, -3]):
            send(peer.tpdo[1], values)
            received.wait_for(values)

    def test_long_ids(self):
        """COB-IDs of 29 bits; python-canopen does not write their bit 29, so it is written here"""
        self.start_node()
        for pdo, cob_id in ((self.rpdo[1], 0x1ABCDE05), (self.tpdo[1], 0x12345)):
            pdo.enabled = False
            pdo.save()
            pdo.com_record[1].raw = FRAME_29_BIT | cob_id
            pdo.read()
            self.assertEqual((pdo.enabled, pdo.cob_id), (True, cob_id))
        received = Received(self.tpdo[1])
        send(self.rpdo[1], [1, 2, 3])
        received.wait_for([1, 2, 3])

    def test_sync_consumed(self):
        """by number: each SYNC, each third, those after an event"""
        self.start_node()
        each, events = Received(self.tpdo[2]), Received(self.tpdo[1])
        for count in range(1, 6):
            self.sync()
            self.assertEqual(each.count(), count)
        configure(self.tpdo[2], trans_type=3)
        for count in range(1, 8):
            self.sync()
            self.assertEqual(each.count(), 5 + count // 3)
        acyclic = Received(self.tpdo[4])
        map_anew(self.tpdo[4], [(INPUTS, I32)], trans_type=0)
        for count, value in enumerate((7, 70000, -70000), 1):
            send(self.rpdo[1], [1, 2, value])
            events.wait_for([1, 2, value])
            self.sync()
            self.sync()
            self.assertEqual(acyclic.all, [[7], [70000], [-70000]][:count])

    def test_sync_values(self):
        """received data is taken over by the SYNC, behind what the SYNC sends"""
        self.start_node()
        received, shared = Received(self.tpdo[2]), [(SHARED, 1), (SHARED, 2)]
        old = [0, 0.0]
        for new in ([1, 0.5], [0xFFFFFFFF, -2.5]):
            send(self.rpdo[2], [12345, 1.0])
            send(self.rpdo[2], new)
            self.assertEqual(self.values(shared), old)
            self.sync()
            self.assertEqual(received.all[-1], old)
            self.assertEqual(self.values(shared), new)
            self.sync()
            self.assertEqual(received.all[-1], new)
            old = new
        self.assertEqual(received.count(), 4)

    def test_sync_periodic(self):
        """as many TPDOs as SYNCs, at python-canopen's period"""
        self.start_node()
        received = Received(self.tpdo[2])
        self.network.sync.start(0.02)
        received.wait_for_count(20)
        self.network.sync.stop()
        self.fence()
        self.assertEqual(received.count(), self.syncs.count())

    def test_sync_counter(self):
        """SYNCs with a counter: the first TPDO by the SYNC start value"""
        self.node.sdo[0x1019].raw = 5
        configure(self.tpdo[2], sync_start_value=3)
        self.start_node()
        received = Received(self.tpdo[2])
        counts = []
        for counter in (4, 5, 1, 2, 3, 4, 5, 1):
            self.sync(counter)
            counts.append(received.count())
        self.assertEqual(counts, [0, 0, 0, 0, 1, 2, 3, 4])

    def produce(self, overflow):
        """Our SYNCs, until they have moved data both ways, and some more."""
        received = Received(self.tpdo[2])
        self.node.sdo[0x1019].raw = overflow
        self.node.sdo[0x1006].raw = 20000
        self.node.sdo[0x1005].raw = PRODUCES | 0x80
        for values in ([1, 0.5], [0xFFFFFFFF, -2.5]):
            send(self.rpdo[2], values)
            received.wait_for(values)
        self.syncs.wait_for_count(20)
        self.node.sdo[0x1006].raw = 0
        return received

    def assert_ended(self, received):
        """No SYNC comes while the event timer lets a TPDO come more often than they would."""
        received.wait_for_count(self.syncs.count())
        timed = Received(self.tpdo[1])
        configure(self.tpdo[1], event_timer=40)
        timed.wait_for_count(2)
        count = self.syncs.count()
        timed.wait_for_count(5)
        self.assertEqual((self.syncs.count(), received.count()), (count, count))

    def test_sync_produced(self):
        """ours, without counter: python-canopen and the device itself count as many"""
        self.start_node()
        received = self.produce(0)
        self.assert_ended(received)
        self.assertEqual(set(self.syncs.all), {b""})
        mean = sum(self.syncs.gaps()) / len(self.syncs.gaps())
        self.assertTrue(0.010 < mean < 0.100, f"mean period {mean} s")

    def test_sync_produced_counter(self):
        """ours, with a counter up to 4"""
        self.start_node()
        received = self.produce(4)
        self.assert_ended(received)
        self.assertEqual(self.syncs.all, [bytes([number % 4 + 1])
                                          for number in range(self.syncs.count())])

    def test_inhibit_time(self):
        """set by python-canopen: of many values the first and the last are sent, and few others"""
        self.start_node()
        received = Received(self.tpdo[1])
        for value in range(1, 11):
            send(self.rpdo[1], [0, 0, value])
            received.wait_for([0, 0, value])
        configure(self.tpdo[1], inhibit_time=2000)
        begin = received.count()
        send(self.rpdo[1], [0, 0, 11])
        received.wait_for([0, 0, 11])
        for value in range(12, 32):
            send(self.rpdo[1], [0, 0, value])
        received.wait_for([0, 0, 31])
        gaps, values = received.gaps(begin), [frame[2] for frame in received.all[begin:]]
        self.assertEqual(values, sorted(values))
        self.assertLess(len(values), 20, f"{values}")
        self.assertGreater(min(gaps), 0.1, f"{gaps}")

    def test_event_timer(self):
        """set by python-canopen: sent without a change, until it is off"""
        self.start_node()
        one = Received(self.tpdo[1])
        configure(self.tpdo[1], event_timer=50)
        begin = one.count()
        one.wait_for_count(begin + 6)
        gaps = one.gaps(begin)
        self.assertGreater(sum(gaps), 0.15, f"{gaps}")
        self.assertLess(min(gaps), 0.5, f"{gaps}")
        configure(self.tpdo[1], event_timer=0)
        self.fence()
        count, other = one.count(), Received(self.tpdo[4])
        map_anew(self.tpdo[4], [(INPUTS, U32)], event_timer=50)
        other.wait_for_count(5)
        self.assertEqual(one.count(), count)

    def request(self, pdo, received):
        """The values of the answer, which is the only one."""
        before = received.count()
        pdo.remote_request()
        received.wait_for_count(before + 1)
        self.fence()
        self.assertEqual(received.count(), before + 1)
        return received.all[-1]

    def test_requested(self):
        """remote frames: answered with the data of the moment, or not where they are forbidden"""
        self.start_node()
        received, inputs = Received(self.tpdo[3]), Received(self.tpdo[1])
        fresh = 0
        for count in range(1, 31):
            answer, = self.request(self.tpdo[3], received)
            self.assertIn(answer, (count - 1, count))  # it is asked for, but 10 ms long only
            self.wait_for_value(count, MOMENT)
            fresh += answer == count
        self.assertGreater(fresh, 0, f"{received.all}")
        silent = Received(self.tpdo[4])
        map_anew(self.tpdo[4], [(INPUTS, I32)])
        send(self.rpdo[1], [-1, 2, -3])
        inputs.wait_for([-1, 2, -3])
        silent.wait_for([-3])
        self.assertEqual(self.request(self.tpdo[1], inputs), [-1, 2, -3])
        self.network.send_message(0x485, b"", remote=True)  # remote_request() sends none here
        self.fence()
        self.assertEqual(silent.all, [[0], [-3]])

    def test_requested_sample(self):
        """remote frames: answered with what was so at the last SYNC"""
        self.node.sdo[0x1007].raw = 10000000  # so long the SYNC waits for the data
        configure(self.tpdo[3], trans_type=252)
        self.start_node()
        received = Received(self.tpdo[3])
        for count in range(1, 4):
            self.sync()
            self.assertEqual(received.count(), 2 * (count - 1))
            for _ in range(2):
                self.assertEqual(self.request(self.tpdo[3], received), [count])

    def test_request_of_ours(self):
        """our remote frame is answered by python-canopen, by hand: it hears none"""
        self.start_node()
        asked = self.heard.count()
        self.device.popen.stdin.write("request\n")
        self.device.popen.stdin.flush()
        self.heard.wait_for("205#R", asked)
        send(self.rpdo[1], [1, -2, 0x12345678])
        self.device.wait_for("request 0: 01 FE FF 78 56 34 12 00")


if __name__ == "__main__":
    plant.main()
