#!/usr/bin/env python3
"""Processes killed (kill -9) at each step of a boot, and started again: a device's, the manager's.

The device of node 6 is behind a gate (gate.c), which holds the frame that begins the step until
the process is dead: so each step is met exactly, however fast the programs are.
"""
import signal

import plant
from devices import UNSIGNED8, UNSIGNED32, Entry, Record, dcf, network, node, standard

# The frames of node 6's boot: as they reach the gate.
STEPS = {
    "before the reset": "000#8200",
    "boot-up message": "706#00",
    "read of the device type": "606#40001000",
    "device type": "586#43001000",
    "read of the vendor-ID": "606#40181001",
    "serial number": "586#43181004",
    "read of the configuration date": "606#40201001",
    "first write": "606#2F006201",
    "its answer": "586#60006201",
    "heartbeat time": "606#2B171000",
    "configuration date": "606#23201001",
    "save": "606#23101001",
    "answer to save": "586#60101001",
    "first heartbeat": "706#7F",
    "start": "000#0106",
    "operational": "706#05",
}
# One frame of each step, where MCANOPEN_TEST_BRIEF asks for no more.
MORE = ("device type", "serial number", "its answer", "heartbeat time", "configuration date",
        "answer to save")


def is_up_again(lines):
    """Operational after a boot-up message."""
    starts = [i for i, line in enumerate(lines) if "node 6: boot-up message" in line]
    return starts and any("node 6: is operational" in line for line in lines[starts[0]:])


class Killed(plant.PlantTest):
    def setUp(self):
        super().setUp()
        self.write("five.dcf", dcf(5, standard(5, heartbeat=300)))
        self.write("six.dcf", dcf(6, [
            *standard(6, heartbeat=300), Record(0x1010, [Entry(0x1010, UNSIGNED32, 1)]),
            Record(0x1020, [Entry(0x1020, UNSIGNED32, 0, "rw", value) for value in (15000, 7)]),
            Record(0x6200, [Entry(0x6200, UNSIGNED8, 0, "rw", "0x55")])]))

    def network(self, **values):
        watched = {"Consumer_Heartbeat_Time": 1500, "SDO_Timeout": 300}
        return self.write("network.xml", network(
            [node(5, DCF_File="five.dcf", **watched),
             node(6, DCF_File="six.dcf", Vendor_Identification="0x29A", Serial_Number=6,
                  Save_Configuration="TRUE", **watched, **values)], Boot_Delay=200))

    def start_six(self, gate):
        return self.start_sim("--node", 6, self.folder / "six.dcf", bus=gate.inner)

    def judge_device(self, frame, xml, noticed):
        """Killed at this frame: node 5 boots on; started again: the network is up."""
        gate = plant.Gate(self, frame)
        five = self.start_sim("--node", 5, self.folder / "five.dcf")
        six = self.start_six(gate)
        boot = self.start_boot("--all", xml)
        gate.wait()
        six.kill()
        gate.let_pass()
        if noticed:
            boot.wait_for("node 5: booted")
            boot.wait_for("error: node 6: ")
        seen = len(boot.out.lines)
        six = self.start_six(gate)
        boot.wait_until(lambda lines: is_up_again(lines[seen:]), "node 6 operational")
        boot.wait_for("node 5: is operational")
        self.assertEqual(boot.stop(signal.SIGINT), 0, boot.story())
        self.end(gate, five, six)
        if noticed:
            plant.say(next(line for line in boot.out.lines if "error: node 6: " in line).strip())

    def judge_device_noticed(self, frame, xml):
        self.judge_device(frame, xml, True)

    def judge_device_at_once(self, frame, xml):
        self.judge_device(frame, xml, False)

    def judge_manager(self, frame, xml):
        """Killed at this frame and started again: the network is up."""
        gate = plant.Gate(self, frame)
        sims = self.start_sim("--node", 5, self.folder / "five.dcf"), self.start_six(gate)
        boot = self.start_boot("--all", xml)
        gate.wait()
        boot.kill()
        gate.let_pass()
        again = self.boot("--once", "--all", xml)
        self.assertIn("network is up: 2 of 2 nodes booted", again.out.text())
        self.end(gate, *sims)

    def end(self, gate, *sims):
        for sim in sims:
            self.assert_stopped(sim)
        gate.process.close()
        self.bus.remove()

    def judge_all(self, judge, xml, steps):
        for name, frame in steps.items():
            if plant.BRIEF and name in MORE:
                continue
            with self.subTest(f"{name}, {frame}"):
                plant.say(f"{name}, {frame}")
                judge(frame, xml)

    def test_device(self):
        """an optional node's process is killed at each step, and started again when it is missed"""
        steps = {name: frame for name, frame in STEPS.items() if name != "save"}  # 10 s until then
        self.judge_all(self.judge_device_noticed, self.network(), steps)

    def test_device_at_once(self):
        """a mandatory node's process is killed at each step and started again at once"""
        self.judge_all(self.judge_device_at_once, self.network(NMT_Mandatory_Slave="TRUE"), STEPS)

    def test_manager(self):
        """the manager's process is killed at each step and started again"""
        self.judge_all(self.judge_manager, self.network(),
                       {"own boot-up message": "77F#00", **STEPS})


if __name__ == "__main__":
    plant.main()
