#!/usr/bin/env python3
"""python-canopen as master, and SDO transfers that go wrong: refused, given up, with losses."""
import functools
import itertools

from peers import plant
from sdo_client import (BLOCK, CHECKED, DOMAIN, LARGEST, NUMBERS, TOO_LONG, TOO_SHORT, SdoTest,
                        closing, forget)

NOT_NOW, NO_OBJECT, NO_SUB = 0x08000022, 0x06020000, 0x06090011
READ_ONLY, WRITE_ONLY = 0x06010002, 0x06010001
TIMED_OUT, WRONG_CRC = 0x05040000, 0x05040004


class PeerSdoFaults(SdoTest):
    def test_refused(self):
        """what is missing, forbidden, too long, or not wanted by the handler, in each way"""
        kept = self.value(100)
        self.sdo.download(CHECKED, 0, kept)
        for write in self.writers():
            self.assert_refused(NO_OBJECT, write, 0x5FFF, 0, b"more than four")
            self.assert_refused(NO_SUB, write, NUMBERS, 12, b"more than four")
            self.assert_refused(READ_ONLY, write, 0x1008, 0, b"more than four")
            for size in (1, 4, 7, 100, BLOCK + 1):
                self.assert_refused(NOT_NOW, write, CHECKED, 0, b"\xFF" + self.value(size - 1))
                self.assert_read(kept, CHECKED)
        for read in self.readers():
            self.assert_refused(NO_OBJECT, read, 0x5FFF, 0)
            self.assert_refused(NO_SUB, read, NUMBERS, 12)
            self.assert_refused(WRITE_ONLY, read, 0x2300, 0)
            self.assertEqual(read(0x1008, 0), b"device for peers of other make")
        for how in ({"force_segment": True}, {"block_transfer": True}):
            open_to_write = functools.partial(self.sdo.open_to_write, size=LARGEST + 1, **how)
            open_to_write.__name__ = f"{how}"
            self.assert_refused(TOO_LONG, open_to_write, DOMAIN, 0)

    def test_wrong(self):
        """another size than was told, and a wrong CRC: refused, and the old value is kept"""
        kept = self.value(30)
        self.sdo.download(DOMAIN, 0, kept)
        for told, size, code in ((20, 10, TOO_SHORT), (20, 19, TOO_SHORT), (10, 20, TOO_LONG)):
            self.assert_refused(code, self.write_other_size, told, size)
            self.assert_read(kept)
            self.assert_refused(code, self.write_other_block_size, told, size)
            self.assert_read(kept)
        self.assert_refused(WRONG_CRC, self.write_wrong_crc)
        self.assert_read(kept)

    def write_other_size(self, told, size):
        stream = self.sdo.open_to_write(DOMAIN, 0, size=told, force_segment=True)
        stream.size = size
        with closing(stream):
            for position in range(0, size, 7):
                stream.write(bytes(min(7, size - position)))

    def write_other_block_size(self, told, size):
        stream = self.sdo.open_to_write(DOMAIN, 0, size=told, block_transfer=True)
        with closing(stream):
            for position in range(0, size, 7):
                stream.send(bytes(min(7, size - position)), position + 7 >= size)

    def write_wrong_crc(self):
        stream = self.sdo.open_to_write(DOMAIN, 0, size=7, block_transfer=True)
        stream.send(b"seven b", True)
        stream._crc.process(b"?")
        stream.close()

    # ---- transfers that are given up, or lose frames ----

    @staticmethod
    def begin(client, segments, **how):
        """A download whose first segments are there."""
        stream = client.open_to_write(DOMAIN, 0, size=10000, **how)
        for _ in range(segments):
            stream.write(b"seven b")
        return stream

    @staticmethod
    def begin_reading(client, segments, **how):
        stream = client.open(DOMAIN, 0, "rb", buffering=0, **how)
        for _ in range(segments):
            stream.read(7)
        return stream

    def halves(self):
        """Each kind of transfer, begun."""
        for segments in (0, 1, 2, 127, 128, 300):
            yield self.begin(self.sdo, segments)
            yield self.begin(self.sdo, segments, block_transfer=True)
            yield self.begin_reading(self.sdo, segments)
            yield self.begin_reading(self.sdo, segments, block_transfer=True)

    def test_aborted(self):
        """python-canopen aborts in mid-transfer: nothing was written, and the next one is served"""
        kept = self.value(5000)
        self.sdo.download(DOMAIN, 0, kept)
        for stream in self.halves():
            self.sdo.abort()
            forget(stream)
            self.assertEqual(self.sdo.settle(), bytes(4))
        self.assertEqual(self.sdo.read_block(DOMAIN, 0), kept)

    def test_abandoned(self):
        """python-canopen begins another transfer instead: that one is served"""
        kept = self.value(5000)
        self.sdo.download(DOMAIN, 0, kept)
        for segments in (0, 1, 2, 300):
            for stream in (self.begin(self.sdo, segments), self.begin_reading(self.sdo, segments),
                           self.begin_reading(self.sdo, segments, block_transfer=True)):
                forget(stream)
                self.assertEqual(self.sdo.settle(), bytes(4))
        self.assertEqual(self.sdo.read_block(DOMAIN, 0), kept)

    def test_silent(self):
        """python-canopen falls silent on both channels: the device gives up, and says so"""
        kept = self.value(5000)
        self.sdo.download(DOMAIN, 0, kept)
        clients = self.sdo, self.open_channel()
        for how in ({}, {"block_transfer": True}):
            forget(self.begin(clients[0], 3, **how))
            forget(self.begin_reading(clients[1], 3, **how))
            for client in clients:
                self.assertEqual(f"{client.wait_for_abort():08X}", f"{TIMED_OUT:08X}")
        self.assertEqual(self.sdo.read_block(DOMAIN, 0), kept)

    def test_lost_segments(self):
        """segments of block transfers get lost: they come again, once each. Not those of the last
        block, of which python-canopen loses count."""
        for lost in ([2], [3, 4, 5], [60], [2, 200], [2, 130, 131, 400]):
            data = self.value(4 * BLOCK)
            self.write_with_losses(lost, data)
            self.assert_read_block(data)
            self.sdo.lose(responses=lost)
            self.assert_read_block(data)
            self.assertGreater(self.sdo.received, 2 + 4 * 127, f"{lost}")
            self.sdo.lose()
        self.write_with_losses([1 + 127], data)  # without its end a block ends by the device's time
        self.assert_read_block(data)

    def write_with_losses(self, lost, data):
        self.sdo.lose(requests=lost)
        self.sdo.write_block(DOMAIN, 0, data)
        self.assertGreater(self.sdo.network.sent, 2 + (len(data) + 6) // 7, f"{lost}")
        self.sdo.lose()

    def assert_read_block(self, data):
        self.assertTrue(self.sdo.read_block(DOMAIN, 0) == data, f"{len(data)} bytes in blocks")

    def test_block_sizes(self):
        """python-canopen asks for blocks of other sizes, and changes them on the way"""
        data = self.value(3000)
        self.sdo.write_block(DOMAIN, 0, data)
        for sizes in ([1], [2], [3, 1], [126, 2], [5, 127, 1], [64]):
            with self.sdo.open_to_read(DOMAIN, 0) as stream:
                self.change_sizes(stream, itertools.cycle(sizes))
                got = stream.readall()
            self.assertTrue(got == data, f"{sizes}")

    def change_sizes(self, stream, sizes):
        """It acknowledges a block and tells the size of the next one in one frame."""
        acknowledge = stream._ack_block

        def change_and_acknowledge():
            stream.blksize = next(sizes)
            acknowledge()

        stream._ack_block = change_and_acknowledge


if __name__ == "__main__":
    plant.main()
