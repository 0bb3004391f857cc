#!/usr/bin/env python3
"""What masters save in simulated devices is there when they are started again (sim --store)."""
import signal

import plant
from devices import UNSIGNED8, UNSIGNED16, UNSIGNED32, Entry, Record, dcf, network, node, standard

FLOOD = plant.TOOLS.parent / "tests" / "flood"
READ = "605#4000200000000000"


def store_device(node_id):
    return dcf(node_id, [
        *standard(node_id, heartbeat=300),
        Record(0x1010, [Entry(0x1010, UNSIGNED32, 1)]),
        Record(0x1011, [Entry(0x1011, UNSIGNED32, 1)]),
        Record(0x1020, [Entry(0x1020, UNSIGNED32, 0, "rw", value) for value in (15000, 7)]),
        Entry(0x2000, UNSIGNED16, 20), Record(0x6200, [Entry(0x6200, UNSIGNED8, 0, "rw", "0x55")])])


class Store(plant.PlantTest):
    def setUp(self):
        super().setUp()
        self.device = self.write("five.dcf", store_device(5))
        self.store = self.folder / "store"
        self.store.mkdir()

    def start_device(self):
        return self.start_sim("--store", self.store, "--node", 5, self.device)

    def ask(self, dump, frame, answer):
        """The answer comes once more than before."""
        before = sum(f.startswith(answer) for f in dump.frames())
        sender = self.run_command([FLOOD, self.bus.name, 1, frame])
        self.assertEqual(sender.code, 0, sender.story())
        dump.wait_for(answer, before + 1)

    def test_killed(self):
        """saved, killed, started again; loaded, killed, started again"""
        dump = self.dump()
        sim = self.start_device()
        self.ask(dump, READ, "585#4B00200014000000")
        self.ask(dump, "605#2B00200034120000", "585#6000200000000000")
        self.ask(dump, "605#2310100173617665", "585#6010100100000000")
        sim.kill()
        sim = self.start_device()
        self.ask(dump, READ, "585#4B00200034120000")
        self.ask(dump, "605#231110016C6F6164", "585#6011100100000000")
        self.ask(dump, READ, "585#4B00200034120000")
        sim.kill()
        sim = self.start_device()
        self.ask(dump, READ, "585#4B00200014000000")
        self.assert_stopped(sim)

    def test_shown(self):
        """the file is one for ccfread"""
        dump = self.dump()
        sim = self.start_device()
        self.ask(dump, "605#2B00200034120000", "585#6000200000000000")
        self.ask(dump, "605#2310100173617665", "585#6010100100000000")
        self.assert_stopped(sim)
        shown = self.run_command([plant.TOOLS / "ccfread", self.store / "node-5.ccf"])
        self.assertEqual(shown.code, 0, shown.story())
        self.assertIn("2000", shown.out.text())
        self.assertEqual([path.name for path in self.store.iterdir()], ["node-5.ccf"])

    def test_configured_once(self):
        """a manager that saves its configuration finds it after the device's restart"""
        xml = self.write("network.xml", network([node(
            5, DCF_File="five.dcf", Configuration_Date=15000, Configuration_Time=7,
            Save_Configuration="TRUE", Consumer_Heartbeat_Time=1500)], Boot_Delay=200))
        for written in (1, 0):
            dump = self.dump()
            sim = self.start_device()
            self.boot("--once", "--all", xml)
            sim.stop(signal.SIGKILL)
            frames = dump.end()
            self.assertEqual(sum(f.startswith("605#2F006201") for f in frames), written)
            self.assertEqual(sum(f.startswith("605#23101001") for f in frames), written)
            self.bus.remove()

    def test_no_folder(self):
        """a folder that is not there is told"""
        sim = self.run_command([plant.MCANOPEN, "sim", "--bus", self.bus.name, "--store",
                                self.folder / "none", "--node", 5, self.device])
        self.assertEqual(sim.code, 2, sim.story())
        self.assertIn("expected a folder", sim.err.text())

    def test_without_1010(self):
        """a device that saves nothing runs all the same"""
        path = self.write("six.dcf", dcf(6, standard(6)))
        self.assert_stopped(self.start_sim("--store", self.store, "--node", 6, path))
        self.assertEqual(list(self.store.iterdir()), [])


if __name__ == "__main__":
    plant.main()
