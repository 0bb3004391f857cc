#!/usr/bin/env python3
"""'mcanopen conform' against a device of python-canopen, as an application makes it of LocalNode:
what it finds is there, and it finds nothing else. To devices of other make the tester owes both.
"""
import json

from peers import PeerTest, plant
from devices import Entry, Record, dcf, standard

NODE = 5
UNSIGNED8, UNSIGNED16, UNSIGNED32, VISIBLE_STRING = 5, 6, 7, 9

# Each is what LocalNode does, and not what CiA 301 says of an SDO server or an NMT slave.
FINDINGS = {
    # any sub-index of a variable is the variable: the one beyond the last, FFh too
    "sdo-missing-sub", "od-structure",
    # an expedited download whose size is not indicated is taken for one of 4 bytes
    "sdo-no-size",
    # the commands of block transfers are not told apart: this one is read as a request for 0000h
    "sdo-block-end-idle",
    # a request is read as far as it goes, whatever its length
    "sdo-short-frames",
    # the server knows nothing of the NMT state
    "sdo-stopped",
    # a transfer has no state but its buffer: segments are served without one, and after an abort
    "sdo-upload-idle", "sdo-download-idle", "sdo-abort-upload",
    # commands are unpacked from the first two bytes of longer frames
    "nmt-length",
    # 1014h is a variable like others
    "cob-emcy",
}


def device_text():
    return dcf(None, [
        *standard(7),
        Entry(0x1008, VISIBLE_STRING, "a device of another make", "const"),
        Entry(0x1014, UNSIGNED32, f"{0x80 + NODE}"),
        Record(0x1200, [Entry(0x1200, UNSIGNED32, f"{0x600 + NODE}", "ro"),
                        Entry(0x1200, UNSIGNED32, f"{0x580 + NODE}", "ro")]),
        Entry(0x2000, UNSIGNED8, 5), Entry(0x2001, UNSIGNED16, 500),
        Entry(0x2002, UNSIGNED32, 50000), Entry(0x2003, VISIBLE_STRING, "text"),
        Entry(0x2004, UNSIGNED16, 0, "wo"), Entry(0x2005, UNSIGNED16, 7, "ro"),
    ])


class PeerConform(PeerTest):
    def test_findings(self):
        """what LocalNode does otherwise than CiA 301 says, and nothing else"""
        text = device_text()
        self.add_devices({NODE: text})
        eds = self.write("device.eds", text)
        process = self.run_command([plant.MCANOPEN, "conform", "--bus", self.bus.name, "--node",
                                    NODE, "--eds", eds, "--json"])
        report = json.loads(process.out.text())
        found = {check["name"]: check["reason"] for check in report["checks"]
                 if check["verdict"] == "FAIL"}
        for name, reason in found.items():
            plant.say(f"{name}: {reason}")
        verdicts = [check["verdict"] for check in report["checks"]]
        plant.say(f"{verdicts.count('PASS')} passed, {len(found)} failed,"
                  f" {verdicts.count('SKIP')} skipped")
        self.assertEqual(process.code, 1, process.err.text())
        self.assertEqual(set(found), FINDINGS)
        self.assertGreater(verdicts.count("PASS"), 50)


if __name__ == "__main__":
    plant.main()
