#!/usr/bin/env python3
"""python-canopen as master moves data by SDO: expedited, in segments, in blocks.

Large data has test_peer_sdo_large.py.
"""
import itertools
import struct
import threading

from peers import plant
from sdo_client import (BLOCK, CHECKED, DOMAIN, EXPEDITED, NUMBERS, OCTETS, TEXT, TIME, TIME_SPAN,
                        TOO_LONG, TOO_SHORT, SdoTest)

SMALL_SIZES = range(65)
SEGMENT_SIZES = [127, 128, 255, 256, 1000]
BLOCK_SIZES = [BLOCK - 1, BLOCK, BLOCK + 1, 2 * BLOCK, 2 * BLOCK + 1]

# Those of object 2010h, and values of them.
VALUES = [("<?", True), ("<b", -128), ("<h", -2), ("<i", -70000), ("<q", -(1 << 63)), ("<B", 0xFE),
          ("<H", 0xFEDC), ("<I", 0xFEDCBA98), ("<Q", 0xFEDCBA9876543210), ("<f", -1.5),
          ("<d", 0.1)]


class PeerSdo(SdoTest):
    def assert_moved(self, writers, readers, sizes):
        """Each size in each way."""
        objects = itertools.cycle([DOMAIN, TEXT, OCTETS, CHECKED])
        for size in sizes:
            for write in writers:
                index, data = next(objects), self.value(size)
                write(index, 0, data)
                for read in readers:
                    self.assertEqual(read(index, 0), data, f"{size} bytes of {index:04X}h, "
                                     f"{write.__name__}, {read.__name__}")

    def test_segments(self):
        """small sizes: expedited, in segments, with and without size"""
        self.assert_moved(self.segment_writers(), [self.read_segments],
                          [*SMALL_SIZES, *SEGMENT_SIZES])

    def test_blocks(self):
        """small sizes: in blocks, with and without size and CRC"""
        self.assert_moved(self.block_writers(), self.readers(), SMALL_SIZES)
        self.assert_moved(self.block_writers(), self.block_readers(), BLOCK_SIZES)

    def write_four(self, index, sub, data):
        """Expedited, without size, which python-canopen does not send by itself."""
        self.sdo.request_response(struct.pack("<BHB4s", 0x22, index, sub, data))

    def test_numbers(self):
        """a number of each type in each way, then of a byte more and less"""
        entries = [(NUMBERS, sub, *each) for sub, each in enumerate(VALUES, 1)]
        entries += [(TIME, 0, "<IH", (86399999, 15000)), (TIME_SPAN, 0, "<IH", (1, 65535))]
        for index, sub, form, value in entries:
            data = struct.pack(form, *(value if isinstance(value, tuple) else (value,)))
            for write in self.writers():
                write(index, sub, data)
                for read in self.readers():
                    self.assertEqual(read(index, sub), data)
                self.assert_refused(TOO_LONG, write, index, sub, data + b"\0")
                if len(data) > 1:
                    self.assert_refused(TOO_SHORT, write, index, sub, data[:-1])
                self.assert_read(data, index, sub)
                write(index, sub, bytes(len(data)))
                self.assert_read(bytes(len(data)), index, sub)
            if len(data) <= EXPEDITED:
                self.write_four(index, sub, data)
                self.assert_read(data, index, sub)

    def test_two_channels(self):
        """two clients at once, of 1200h and 1201h; each gets its own"""
        other = self.open_channel()
        threads = [threading.Thread(target=self.run_channel, args=(client, index))
                   for client, index in ((self.sdo, DOMAIN), (other, OCTETS))]
        self.trouble = []
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(self.trouble, [])

    def run_channel(self, sdo, index):
        try:
            for size in (10, 500, 2000):
                for write in (sdo.download, sdo.write_block):
                    data = self.value(size)
                    write(index, 0, data)
                    self.assertEqual(sdo.upload(index, 0), data)
                    self.assertEqual(sdo.read_block(index, 0), data)
        except Exception as error:  # of another thread
            self.trouble.append(f"{index:04X}h: {error!r}")


if __name__ == "__main__":
    plant.main()
