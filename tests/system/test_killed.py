#!/usr/bin/env python3
"""Processes killed (kill -9) at each frame of a boot, and started again: a device's, the manager's.

The device of node 6 is behind a gate (gate.c), which holds one frame until the process is dead: so
each step is met exactly, however fast the programs are. Which frames there are is seen in a boot
where nothing is killed. Each frame has a plant of its own; some are tried at once.
"""
import signal
import time
from concurrent.futures import ThreadPoolExecutor

import plant
import wire
from devices import (UNSIGNED8, UNSIGNED32, VISIBLE_STRING, Entry, Record, dcf, network, node,
                     standard)

FLOOD = plant.TOOLS.parent / "tests" / "flood"
AT_ONCE = 2 if plant.BRIEF else 8
SHARE = 12 if plant.BRIEF else 7 if plant.SANITIZED else 1  # one frame of so many, others by test
SOFTWARE = 0x1234
HANGING = 0.75  # seconds: longer than SDO_Timeout, and no device gives up in that time
PATIENT = {"Consumer_Heartbeat_Time": 30000, "SDO_Timeout": 10000}
SILENT = "heartbeat lost: silent for 1500 ms|boot error K: no heartbeat within 1500 ms"
FIRST_REQUEST, DATE, SAVE = "606#4000100000000000", "606#4020100100000000", "606#2310100173617665"
COMPARES = "606#4000620100000000"
START, PREOPERATIONAL, OPERATIONAL = "000#0106", "706#7F", "706#05"
# What can be read with one frame, and the answers of a device that is configured.
VALUES = {"606#4000620100000000": "586#4F00620155000000",
          "606#4017100000000000": "586#4B1710002C010000",
          "606#4020100100000000": "586#43201001983A0000",
          "606#4020100200000000": "586#4320100207000000"}


class Step:
    """The frame that is held: the n-th that is like this, among those of the conversation."""

    def __init__(self, frames, place):
        self.frame = frames[place]
        self.number = frames[:place + 1].count(self.frame)
        self.name = f"{self.frame} ({self.number})" if self.number > 1 else self.frame
        done = [each for each in frames[:place + 1] if is_request(each)]
        coming = [each for each in frames[place + 1:] if is_request(each)]
        near = 3 if self.frame == PREOPERATIONAL else 1  # heartbeats come as they like
        self.asked = done[-near:] + coming[:near]
        if DATE in self.asked:  # without an answer the node is configured
            self.asked.append(next(each for each in coming if each != DATE))
        self.is_last = not coming
        self.is_slow = SAVE in self.asked

    def pattern(self):
        """Of the message when the device is gone: what is asked next and not answered, or what was
        asked last, where the programs are slow and it is missed while its answer is held.
        """
        objects = {f"{frame[8:10]}{frame[6:8]}h:{frame[10:12]}" for frame in self.asked}
        causes = [f"boot error .: (read|write) {each} .*no answer within" for each in objects]
        return "|".join(causes + [SILENT] * self.is_last)


def is_request(frame):
    """A read or a write begins."""
    return frame.startswith("606#") and frame[4] in "24"


def is_answer(frame):
    return frame.startswith("586#")


def conversation(frames):
    """What node 6 and its manager said: each frame, but of heartbeats the first of each state."""
    talk, state = [], None
    for frame in frames:
        kind = wire.lanes([frame])
        if ("heartbeats of node", 6) in kind:
            talk += [frame] * (frame != state)
            state = frame
        elif ("node", 6) in kind:
            talk.append(frame)
    return talk


def last_boot(frames):
    """What node 6 and its manager said from the last boot's first request to the start command;
    heartbeats that were on their way may have repeated that."""
    talk = wire.lanes(frames)["node", 6]
    begin = max(place for place, frame in enumerate(talk) if frame == FIRST_REQUEST)
    return talk[begin:talk.index(START, begin) + 1]


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
            Record(0x1011, [Entry(0x1011, UNSIGNED32, 1)]),
            Record(0x1020, [Entry(0x1020, UNSIGNED32, 0, "rw", value) for value in (15000, 7)]),
            Record(0x1F56, [Entry(0x1F56, UNSIGNED32, SOFTWARE, "ro")]),
            Entry(0x2000, VISIBLE_STRING, "", "rw", "more than four bytes"),
            Record(0x6200, [Entry(0x6200, UNSIGNED8, 0, "rw", "0x55")])]))

    def network(self, **values):
        watched = {"Consumer_Heartbeat_Time": 1500, "SDO_Timeout": 500, "Boot_Delay": 100}
        return self.write("network.xml", network(
            [node(5, DCF_File="five.dcf", **{**watched, **PATIENT}),
             node(6, DCF_File="six.dcf", Vendor_Identification="0x29A", Serial_Number=6,
                  NMT_Verify_Software="TRUE", Software_Identification=SOFTWARE,
                  Save_Configuration="TRUE", **{**watched, **values})], Boot_Delay=100))

    def start_six(self, scene, gate):
        return scene.start_sim("--node", 6, self.folder / "six.dcf", bus=gate.inner)

    @staticmethod
    def wait_up(boot):
        for text in ("network is up: 2 of 2", "node 5: is operational", "node 6: is operational"):
            boot.wait_for(text)

    def start_five(self, scene):
        return scene.start_sim("--node", 5, self.folder / "five.dcf")

    # ---- what there is to be seen ----

    def boot_undisturbed(self, xml):
        """All frames, from power-on on."""
        with plant.Scene(self) as scene:
            gate = plant.Gate(scene, "7FF")
            dump = scene.dump()
            sims = self.start_five(scene), self.start_six(scene, gate)
            boot = scene.boot("--once", "--all", xml)
            dump.wait_for(OPERATIONAL)
            frames = dump.end()
            self.end(scene, boot, *sims)
        return frames

    def assert_configured(self, scene, dump):
        """Its values, as it tells them."""
        asked = scene.run_command([FLOOD, scene.bus.name, len(VALUES), *VALUES])
        self.assertEqual(asked.code, 0, asked.story())
        for answer in VALUES.values():
            dump.wait_for(answer)

    def end(self, scene, boot, *sims):
        if boot.popen.poll() is None:
            self.assertEqual(boot.stop(signal.SIGINT), 0, boot.story())
        for sim in sims:
            scene.assert_stopped(sim)

    # ---- one frame ----

    def judge_device(self, scene, step, xml, expected, noticed):
        """Killed at this frame; started again, when it was missed or at once: the network is up."""
        dump = scene.dump()
        gate = plant.Gate(scene, step.frame, step.number)
        five, six = self.start_five(scene), self.start_six(scene, gate)
        boot = scene.start_boot("--all", xml)
        gate.wait()
        six.kill()
        gate.let_pass()
        if noticed:
            boot.wait_for("node 5: is operational")
            boot.wait_for("error: node 6: ")
        seen = len(boot.out.lines)
        six = self.start_six(scene, gate)
        boot.wait_until(lambda lines: is_up_again(lines[seen:]), "node 6 operational")
        boot.wait_for("node 5: is operational")
        self.assert_configured(scene, dump)
        self.end(scene, boot, five, six)
        frames = dump.end()
        if COMPARES not in last_boot(expected):  # what was written late need not be written again
            self.assert_last_boot(frames, expected)
        self.assertEqual(wire.lanes(frames)["node", 5], wire.lanes(expected)["node", 5])
        return self.cause(boot, step) if noticed else "up again"

    def assert_last_boot(self, frames, expected):
        """Nothing is missing. There may be more: on a slow machine something is asked twice, and a
        request of the boot before may come late to the device that has started anew.
        """
        actual, expected = last_boot(frames), last_boot(expected)
        rest = iter(actual)
        missing = [frame for frame in expected if not is_answer(frame) and frame not in rest]
        self.assertEqual(missing, [], actual)
        self.assertLessEqual(set(expected), set(actual))

    def judge_missed(self, *arguments):
        return self.judge_device(*arguments, noticed=True)

    def judge_at_once(self, *arguments):
        return self.judge_device(*arguments, noticed=False)

    def judge_manager(self, scene, step, xml, _):
        """Killed at this frame and started again: the network is up."""
        dump = scene.dump()
        gate = plant.Gate(scene, step.frame, step.number)
        sims = self.start_five(scene), self.start_six(scene, gate)
        boot = scene.start_boot("--all", xml)
        gate.wait()
        boot.kill()
        gate.let_pass()
        again = scene.start_boot("--all", xml)
        self.wait_up(again)
        self.assert_configured(scene, dump)
        self.end(scene, again, *sims)
        dump.end()
        return "up again"

    def judge_hangs(self, scene, step, xml, expected):
        """Stopped at this frame for longer than answers may take: nothing was missed."""
        dump = scene.dump()
        gate = plant.Gate(scene, step.frame, step.number)
        sims = self.start_five(scene), self.start_six(scene, gate)
        boot = scene.start_boot("--all", xml)
        gate.wait()
        boot.popen.send_signal(signal.SIGSTOP)
        gate.let_pass()
        time.sleep(HANGING)
        boot.popen.send_signal(signal.SIGCONT)
        self.wait_up(boot)
        self.end(scene, boot, *sims)
        frames = dump.end()
        self.assertNotIn("error:", boot.out.text())
        self.assert_last_boot(frames, expected)
        return "goes on"

    def cause(self, boot, step):
        """The first message is about what was not answered; the table tells of failures."""
        told = next(line for line in boot.out.lines if "error: node 6: " in line)
        self.assertRegex(told, step.pattern())
        if "boot error" in told:
            self.assertRegex(boot.out.text(), r"node 6 has booted after \d+ failed attempts?, the"
                                              r" last one: boot error")
        return told.split("error: node 6: ")[1]

    # ---- all of them ----

    def judge_all(self, judge, xml, first=0):
        whole = self.boot_undisturbed(xml)
        frames = conversation(whole)
        steps = [Step(frames, place) for place in range(first % SHARE, len(frames), SHARE)]
        with ThreadPoolExecutor(AT_ONCE) as pool:
            results = {step: pool.submit(self.in_scene, judge, step, xml, whole)
                       for step in sorted(steps, key=lambda each: not each.is_slow)}
        for step in steps:
            with self.subTest(step.name):
                plant.say(f"{step.name}: {results[step].result()}")
        plant.say(f"{len(steps)} of {len(frames)} frames")

    def in_scene(self, judge, step, *arguments):
        with plant.Scene(self) as scene:
            return judge(scene, step, *arguments)

    def test_missed(self):
        """an optional node is killed at each frame, and started again when it is missed"""
        self.judge_all(self.judge_missed, self.network())

    def test_at_once(self):
        """a mandatory node is killed at each frame, its default values restored; started at once"""
        xml = self.network(NMT_Mandatory_Slave="TRUE", Restore_Configuration=1)
        self.judge_all(self.judge_at_once, xml, first=2)

    def test_compared(self):
        """... one whose configuration is compared, and what differs written"""
        xml = self.network(Verify_Configuration="TRUE")
        self.judge_all(self.judge_at_once, xml, first=5)

    def test_manager(self):
        """the manager's process is killed at each frame, and started again"""
        self.judge_all(self.judge_manager, self.network(), first=8)

    def test_manager_hangs(self):
        """the manager is stopped at each frame, and goes on when answers should have come"""
        self.judge_all(self.judge_hangs, self.network(), first=10)


if __name__ == "__main__":
    plant.main()
