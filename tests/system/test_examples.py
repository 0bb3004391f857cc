#!/usr/bin/env python3
"""The examples: each program on a bus, what it makes of its process data, and how it ends."""
import subprocess
import unittest

import eds
import plant

EXAMPLES = plant.ROOT / "examples"
PROGRAMS = plant.TOOLS.parent / "examples"
FLOOD = plant.TOOLS.parent / "tests" / "flood"
PLANT_NODES = (2, 5, 7, 9)
UPLOAD, ABORT = 0x40, 0x80
AT_ONCE = 100  # requests that wait for nothing: no queue is shorter


def little(value, size=4):
    return value.to_bytes(size, "little").hex().upper()


class ExampleTest(plant.PlantTest):
    def start_example(self, name, *arguments, stdin=subprocess.DEVNULL):
        return self.start([*plant.WRAP, PROGRAMS / name, *arguments], stdin=stdin)

    def start_device(self, name, stdin=subprocess.DEVNULL):
        device = self.start_example(name, stdin=stdin)
        device.wait_for("on the bus", device.err)
        return device

    def boot_in_background(self, example):
        boot = self.start_boot(EXAMPLES / example / "network.xml")
        boot.wait_for("network is up")
        return boot

    def send(self, *frames):
        sender = self.run_command([FLOOD, self.bus.name, len(frames), *frames])
        self.assertEqual(sender.code, 0, sender.story())


class BootNetwork(ExampleTest):
    """The plant of examples/boot-network/run.sh, by the tool and by the program."""

    def setUp(self):
        super().setUp()
        self.xml = EXAMPLES / "boot-network" / "network.xml"
        self.start_sim(self.xml)

    def test_tool(self):
        """mcanopen boot --once --all"""
        dump = self.dump()
        boot = self.boot("--once", "--all", self.xml)
        self.assertIn("network is up: 4 of 4 nodes booted", boot.out.text())
        rows = [line.split() for line in boot.out.lines if " OPERATIONAL " in line]
        self.assertEqual([int(row[0]) for row in rows], list(PLANT_NODES))
        self.assertTrue(all(row[-1] == "booted" for row in rows), boot.story())
        frames = dump.end()
        self.assertEqual(sorted(frame for frame in frames if frame.startswith("000#01")),
                         [f"000#01{node:02X}" for node in PLANT_NODES])
        plant.say(f"{len(frames)} frames")

    def test_program(self):
        """the program on the public API alone"""
        boot = self.start_example("boot-network", self.xml)
        self.assertEqual(boot.wait(), 0, boot.story())
        self.assertIn("network is up", boot.out.lines[-1])
        for node in PLANT_NODES:
            self.assertIn(f"Node: {node} booted", boot.out.text())
        plant.say(boot.out.lines[-1].strip())


class AsyncSdo(ExampleTest):
    def test_all_answer(self):
        """four devices are asked four things each"""
        xml = EXAMPLES / "boot-network" / "network.xml"
        self.start_sim(xml)
        program = self.start_example("async-sdo", xml)
        self.assertEqual(program.wait(), 0, program.story())
        self.assertEqual(len(program.out.lines), 4 * len(PLANT_NODES), program.story())
        for node in PLANT_NODES:
            self.assertIn(f"node {node}: vendor-ID {0x1A0000EE}", program.out.text())
            self.assertIn(f"node {node}: name \"", program.out.text())
        plant.say(f"{len(program.out.lines)} answers")


class AsyncIo(ExampleTest):
    def setUp(self):
        super().setUp()
        self.device = self.start_device("async-io")
        self.frames = self.dump()
        self.boot = self.boot_in_background("async-io")

    def inputs(self):
        """What TPDO 1 has told: (lines 1..32, counter)."""
        data = [bytes.fromhex(frame[4:]) for frame in self.frames.frames()
                if frame.startswith("185#")]
        return [(int.from_bytes(d[:4], "little"), int.from_bytes(d[4:], "little")) for d in data]

    def end(self):
        self.assert_stopped(self.boot)
        self.assert_stopped(self.device)
        self.frames.end()

    def assert_counts(self, inputs, wired, first):
        """One after the other; an answer that takes more than 10 ms comes after its frame."""
        self.assertEqual([each for each in inputs if each[0] != wired], [])
        counts = [count for _, count in inputs]
        self.assertEqual(sorted(set(counts)), list(range(first, counts[-1] + 1)), counts)
        self.assertEqual(counts, sorted(counts))
        plant.say(f"{len(counts)} frames, counted {first}..{counts[-1]}")

    def test_configured(self):
        """outputs by the configuration; the event timer asks for inputs"""
        self.frames.wait_for("185#78563412" + little(1005))
        self.end()
        inputs = self.inputs()
        self.assert_counts(inputs, 0x12345678, inputs[0][1])
        self.assertIn(inputs[0][1], (1000, 1001))

    def test_outputs(self):
        """outputs by RPDO 1 come back as inputs at once"""
        self.send("205#0100008010000000")
        self.frames.wait_for("185#01000080" + little(0x13))
        self.end()
        inputs = self.inputs()
        # The timer may have counted already before the first frame with both of them goes out.
        at = next(i for i, each in enumerate(inputs) if each in ((0x80000001, 0x10),
                                                                  (0x80000001, 0x11)))
        self.assertTrue(all(wired == 0x12345678 for wired, _ in inputs[:at - 1]), inputs)
        self.assert_counts(inputs[at:], 0x80000001, inputs[at][1])


class Cia401Io(ExampleTest):
    def setUp(self):
        super().setUp()
        self.device = self.start_device("cia401-io", stdin=subprocess.PIPE)
        self.frames = self.dump()

    def press(self, buttons):
        self.device.popen.stdin.write(f"{buttons:02X}\n")
        self.device.popen.stdin.flush()

    def end_device(self):
        self.device.popen.stdin.close()
        self.assertEqual(self.device.wait(), 0, self.device.story())

    def test_data(self):
        """inputs by TPDO 1 at the start and when they change, outputs by RPDO 1"""
        boot = self.boot_in_background("cia401-io")
        self.frames.wait_for("182#00")
        self.press(0x05)
        self.frames.wait_for("182#05")
        self.send("202#A1")
        self.device.wait_for("outputs A1")
        self.assert_stopped(boot)
        self.end_device()
        inputs = [frame for frame in self.frames.end() if frame.startswith("182#")]
        self.assertEqual(inputs, ["182#00", "182#05"])
        self.assertEqual(self.device.out.lines, ["outputs A1"])

    def test_manager_lost(self):
        """without the manager's heartbeat the device stops and its outputs go to error values"""
        boot = self.boot_in_background("cia401-io")
        self.frames.wait_for("77F#05")  # before the first one nobody is missed
        self.send("202#23")
        self.device.wait_for("outputs 23")
        boot.kill()
        self.device.wait_for("outputs 81")
        self.frames.wait_for("702#04")
        self.end_device()

    def upload(self, entries):
        """{(index, sub): bytes, or None if aborted} of the device."""
        for begin in range(0, len(entries), AT_ONCE):
            part = entries[begin:begin + AT_ONCE]
            self.send(*(f"602#{UPLOAD:02X}{little(index, 2)}{sub:02X}00000000"
                        for index, sub in part))
            self.frames.wait_for("582#", times=begin + len(part))
        answers = [bytes.fromhex(frame[4:]) for frame in self.frames.frames()
                   if frame.startswith("582#")]
        return {(int.from_bytes(a[1:3], "little"), a[3]):
                None if a[0] == ABORT else a[4:8 - (a[0] >> 2 & 3)] for a in answers}

    def test_eds(self):
        """the EDS file has the objects of the device, with their types and values"""
        file = eds.File(EXAMPLES / "cia401-io" / "cia401-io.eds")
        absent = () if plant.BRIEF else (*range(0x1000, 0x2000), *range(0x6000, 0x7000))
        found = self.upload(sorted({*file.entries, *((index, 0) for index in absent)}))
        expected = {key: eds.encode(entry.kind, entry.keys["defaultvalue"], 2)
                    for key, entry in file.entries.items()}
        self.assertEqual({key: value for key, value in found.items() if value is not None},
                         expected)
        self.end_device()
        plant.say(f"{len(expected)} entries")


class Cia401Files(plant.PlantTest):
    def test_dcf(self):
        """the DCF file is the EDS file with values"""
        described, configured = (eds.File(EXAMPLES / "cia401-io" / f"cia401-io.{kind}").entries
                                 for kind in ("eds", "dcf"))
        values = {key: entry.keys.pop("parametervalue") for key, entry in configured.items()
                  if "parametervalue" in entry.keys}
        self.assertTrue(values)
        self.assertEqual({key: entry.keys for key, entry in described.items()},
                         {key: entry.keys for key, entry in configured.items()})


class LevelSensor(ExampleTest):
    def setUp(self):
        super().setUp()
        self.begin()

    def begin(self):
        self.device = self.start_example("level-sensor", self.folder, stdin=subprocess.PIPE)
        self.device.wait_for("on the bus", self.device.err)

    def measure(self, level):
        self.device.popen.stdin.write(f"{level}\n")
        self.device.popen.stdin.flush()

    def end_device(self):
        self.device.popen.stdin.close()
        self.assertEqual(self.device.wait(), 0, self.device.story())

    def test_conform(self):
        """the device does what its EDS file says, and nothing against CiA 301"""
        tester = self.run_command([*plant.WRAP, plant.TOOLS / "mcanopen", "conform", "--quiet",
                                   "--bus", self.bus.name, "--node", 5, "--allow-store",
                                   "--eds", EXAMPLES / "level-sensor" / "level-sensor.eds"])
        self.assertEqual(tester.code, 0, tester.story())
        self.end_device()
        plant.say(tester.out.lines[-1].strip())

    def test_limit(self):
        """an emergency above the limit, one when it is over; a stored limit outlives the program"""
        frames = self.dump()
        self.send("605#2B002000F4010000", "605#2310100173617665")
        frames.wait_for("585#6010100100000000")
        self.end_device()
        self.begin()
        self.measure(501)
        frames.wait_for("085#0090210000000000")
        self.measure(500)
        frames.wait_for("085#0000000000000000")
        self.end_device()


class ManagerWithData(ExampleTest):
    def test_data(self):
        """inputs of one device reach the other's outputs and come back, through the manager"""
        lamps = self.start_device("cia401-io", stdin=subprocess.PIPE)
        lines = self.start_device("async-io")
        dump = self.dump()
        manager = self.start_example("manager-with-data",
                                     EXAMPLES / "manager-with-data" / "network.xml")
        manager.wait_for("network is up: 3 of 3", manager.err)
        for buttons in ("05", "80"):
            lamps.popen.stdin.write(f"{buttons}\n")
            lamps.popen.stdin.flush()
            lamps.wait_for(f"outputs {buttons}")
        for process in (manager, lines):
            self.assert_stopped(process)
        lamps.popen.stdin.close()
        self.assertEqual(lamps.wait(), 0, lamps.story())
        frames = dump.end()
        self.assertEqual([frame for frame in frames if frame.startswith("202#")],
                         ["202#00", "202#05", "202#80"])
        for frame in ("182#05", "205#0500000000000000", "182#80", "205#8000000000000000"):
            self.assertEqual(frames.count(frame), 1, frame)
        self.assertEqual(sorted(frame for frame in frames if frame.startswith("000#01")),
                         ["000#0101", "000#0102", "000#0105"])


if __name__ == "__main__":
    if not PROGRAMS.is_dir():
        plant.say("NOT RUN: the examples are not built")
        raise SystemExit(plant.SKIPPED)
    plant.main()
