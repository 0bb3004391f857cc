#!/usr/bin/env python3
"""python-canopen as master moves large data by SDO. By far the most of its time are the segments,
that each need an answer; so they come once each way.
"""
from peers import plant
from sdo_client import CHECKED, DOMAIN, LARGEST, SdoTest

SIZES = [65536, LARGEST]


class PeerSdoLarge(SdoTest):
    def test_large(self):
        """in blocks, and between blocks and segments"""
        for size in SIZES:
            data = self.value(size)
            self.sdo.write_block(DOMAIN, 0, data)
            self.assertTrue(self.sdo.read_block(DOMAIN, 0) == data, f"{size} bytes in blocks")
        self.assertTrue(self.sdo.upload(DOMAIN, 0) == data, "what was written in blocks")
        data = self.value(LARGEST)
        self.sdo.download(CHECKED, 0, data)
        self.assertTrue(self.sdo.read_block(CHECKED, 0) == data, "what was written in segments")


if __name__ == "__main__":
    plant.main()
