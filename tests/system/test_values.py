#!/usr/bin/env python3
"""Process data of simulated devices: what 'mcanopen sim' sets, ramps and toggles is on the bus."""
import unittest

import plant
from devices import Entry, dcf, standard

DEVICE = plant.ROOT / "examples" / "cia401-io" / "cia401-io.eds"
DOMAIN = 0xF
TPDO = "185#"
START = "000#0105"


class Values(plant.PlantTest):
    def start_device(self, *arguments):
        """Node 5, operational; what its bus says from the start command on."""
        dump = self.dump()
        self.start_sim("--node", "5", DEVICE, *arguments)
        sender = self.run_command([plant.TOOLS.parent / "tests" / "flood", self.bus.name, 1, START])
        self.assertEqual(sender.code, 0, sender.story())
        dump.wait_for(START)
        return dump

    def refuse(self, text, *arguments):
        sim = self.run_command([plant.TOOLS / "mcanopen", "sim", "--bus", self.bus.name,
                                "--node", "5", DEVICE, *arguments])
        self.assertEqual(sim.code, 2, sim.story())
        self.assertIn(text, sim.err.text())

    def test_set(self):
        """a value stands from the beginning"""
        dump = self.start_device("--set", "5:6000:1=0x2A")
        dump.wait_for(TPDO + "2A")

    def test_toggle(self):
        """two values in turns"""
        dump = self.start_device("--toggle", "5:6000:1=3..200/20")
        dump.wait_for(TPDO + "03", times=3)
        dump.wait_for(TPDO + "C8", times=3)
        values = [frame for frame in dump.end() if frame.startswith(TPDO)]
        self.assertEqual(set(values), {TPDO + "03", TPDO + "C8"})

    def test_ramp(self):
        """it rises, and begins anew"""
        dump = self.start_device("--ramp", "5:6000:1=0..100/200/5")
        process = dump.process
        process.wait_until(lambda _: self.falls(self.ramp(dump)) >= 2, "two ramps")
        values = self.ramp(dump)
        self.assertLess(max(values), 100)
        self.assertGreater(len(set(values)), 3)

    @staticmethod
    def ramp(dump):
        return [int(frame[4:], 16) for frame in dump.frames() if frame.startswith(TPDO)]

    @staticmethod
    def falls(values):
        return sum(b < a for a, b in zip(values, values[1:]))

    def send(self, frame):
        sender = self.run_command([plant.TOOLS.parent / "tests" / "flood", self.bus.name, 1, frame])
        self.assertEqual(sender.code, 0, sender.story())

    def test_file(self):
        """a domain is a file: what is in it is read, what is written is in it"""
        path = self.write("data.bin", "ab")
        device = self.write("device.dcf", dcf(5, [*standard(1), Entry(0x2100, DOMAIN, "")]))
        dump = self.dump()
        self.start_sim("--node", "5", device, "--file", f"5:2100={path}")
        self.send("605#4000210000000000")
        dump.wait_for("585#4B00210061620000")
        self.send("605#2700210078797A00")
        dump.wait_for("585#6000210000000000")
        self.assertEqual(path.read_text(encoding="ascii"), "xyz")
        path.unlink()
        self.send("605#4000210000000000")
        dump.wait_for("585#8000210024000008")

    def test_bad_values(self):
        """each is refused with the reason"""
        self.refuse("expected NODE:INDEX[:SUB]=", "--set", "5:6000:1")
        self.refuse("expected NODE:INDEX[:SUB]=", "--set", "128:6000:1=1")
        self.refuse("expected a value", "--set", "5:6000:1=")
        self.refuse("expected A..B/MS", "--ramp", "5:6000:1=1/100")
        self.refuse("expected A..B/MS", "--toggle", "5:6000:1=1..2/0")
        self.refuse("expected A..B/MS", "--toggle", "5:6000:1=1..2/10/5")
        self.refuse("no such object", "--set", "5:6001:1=1")
        self.refuse("no such object", "--set", "5:6000:77=1")
        self.refuse("not a value of type UNSIGNED8", "--set", "5:6000:1=256")
        self.refuse("not a value of type UNSIGNED8", "--set", "5:6000:1=on")
        self.refuse("belongs to the device itself", "--set", "5:1000:0=1")
        self.refuse("expected a file", "--file", "5:6000:1=")
        self.refuse("expected an object 2000h..9FFFh of type DOMAIN", "--file", "5:6000:1=data")
        self.refuse("expected an object 2000h..9FFFh of type DOMAIN", "--file", "5:1000=data")
        self.refuse("there is no node 6", "--set", "6:6000:1=1")


if __name__ == "__main__":
    plant.main()
