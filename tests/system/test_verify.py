#!/usr/bin/env python3
"""Verify_Configuration between processes: what the device has already is not written again."""
import plant
from devices import UNSIGNED8, UNSIGNED16, Entry, Record, dcf, network, node, standard

WRITES = ("605#2F", "605#2B", "605#23", "605#21")
READ_BACK = ["605#40002000", "605#40006201", "605#40006202", "605#40171000"]


class Verify(plant.PlantTest):
    def test_twice(self):
        """the second boot writes what the reset has taken, and nothing else"""
        io = Record(0x6200, [Entry(0x6200, UNSIGNED8, 0, "rw", value) for value in ("85", "0x66")])
        own = Entry(0x2000, UNSIGNED16, 0, "rw", "0x1234")
        self.write("five.dcf", dcf(5, [*standard(5, heartbeat=500), own, io]))
        xml = self.write("network.xml", network([node(5, DCF_File="five.dcf", SDO_Timeout=20000,
                                                      Verify_Configuration="TRUE")]))
        self.start_sim("--node", 5, self.folder / "five.dcf")
        first = self.boot("--once", xml)
        self.assertIn("entries written: 4 of 4, the others were there", first.out.text())
        dump = self.dump()
        second = self.boot("--once", xml)
        self.assertIn("compares its configuration: 4 entries of five.dcf", second.out.text())
        self.assertIn("entries written: 1 of 4, the others were there", second.out.text())
        dump.wait_for("705#05")
        frames = [frame for frame in dump.end() if frame.startswith("605#")]
        self.assertEqual([frame for frame in frames if frame.startswith(WRITES)],
                         ["605#2B171000F4010000"])
        reads = [frame[:12] for frame in frames if not frame.startswith(WRITES)]
        self.assertEqual(reads, ["605#40001000", *READ_BACK])


if __name__ == "__main__":
    plant.main()
