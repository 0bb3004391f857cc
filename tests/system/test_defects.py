#!/usr/bin/env python3
"""Devices that 'mcanopen sim --defect' makes defective: what is on the bus, frame by frame.
test_conform_defects.py looks at each of them through the eyes of a tester.
"""
import plant

DEVICE = plant.DATA / "conform.eds"
START, STOP, RESET = "000#0105", "000#0205", "000#8205"
READ_TYPE, TYPE = "605#4000100000000000", "585#4300100091010F00"


class Defects(plant.PlantTest):
    def send(self, frame):
        sender = self.run_command([plant.TOOLS.parent / "tests" / "flood", self.bus.name, 1, frame])
        self.assertEqual(sender.code, 0, sender.story())

    def talk(self, defects, *talk):
        """Sends each frame, and awaits the one behind it, for the first time or so many; the data
        frames that were there.
        """
        dump = self.dump()
        options = [word for name in defects for word in ("--defect", name)]
        sim = self.start_sim("--node", 5, DEVICE, *options)
        dump.wait_for("705#00", 2 if "boot-up-twice" in defects else 1)
        for frame, answer, *times in talk:
            self.send(frame)
            if answer:
                dump.wait_for(answer, *times)
        self.assert_stopped(sim)
        return [frame for frame in dump.end() if "#R" not in frame]

    def test_none(self):
        """a device without a defect, to compare with"""
        frames = self.talk([], (READ_TYPE, TYPE))
        self.assertEqual(frames, ["705#00", READ_TYPE, TYPE])

    def test_gate(self):
        """what a defect does not concern passes both ways; several defects at once"""
        frames = self.talk(["boot-up-twice", "nmt-stop"], (RESET, "705#00", 4), (STOP, ""),
                           (READ_TYPE, TYPE))
        self.assertEqual(frames, ["705#00"] * 2 + [RESET] + ["705#00"] * 2 +
                         [STOP, READ_TYPE, TYPE])

    def test_stopped(self):
        """a server that answers although the device has said that it is stopped"""
        frames = self.talk(["sdo-stopped"], (STOP, ""), (READ_TYPE, TYPE), ("705#R1", "705#04"))
        self.assertEqual(frames, ["705#00", STOP, READ_TYPE, TYPE, "705#04"])

    def test_confirmed(self):
        """a write that is refused, and told to be done"""
        write = "605#2F18100001000000"
        frames = self.talk(["od-read-only"], (write, "585#6018100000000000"))
        self.assertEqual(frames, ["705#00", write, "585#6018100000000000"])

    def test_help(self):
        """all defects, a line each"""
        process = self.run_command([*plant.WRAP, plant.MCANOPEN, "sim", "--defect", "help"])
        self.assertEqual((process.code, process.err.text()), (0, ""))
        lines = process.out.text().splitlines()
        names = [line.split()[1] for line in lines]
        self.assertEqual(len(names), len(set(names)))
        self.assertLessEqual({"eds", "sdo", "od", "pdo", "emcy", "sync", "control", "store", "nmt"},
                             {line.split()[0] for line in lines})
        plant.say(f"{len(names)} defects")


if __name__ == "__main__":
    plant.main()
