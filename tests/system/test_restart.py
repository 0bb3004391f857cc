#!/usr/bin/env python3
"""The manager's process ends in different ways, and another one takes over a running plant.

Node 5 sends heartbeats, node 6 is guarded; both send process data all the time.
"""
import signal

import plant
import wire
from devices import dcf, input_byte, network, node, standard

ALIVE = {"NMT_Check_Nodestate": "TRUE"}
HEARTBEAT = {"Consumer_Heartbeat_Time": 2000, "Vendor_Identification": "0x29A"}
GUARDING = {"Guard_Time": 300, "Life_Time_Factor": 7}
DATA = {5: "185#", 6: "186#"}
UP = 0
NOT_UP = 1


class Restart(plant.PlantTest):
    def setUp(self):
        super().setUp()
        self.write("five.dcf", dcf(5, [*standard(5, heartbeat=100), *input_byte()]))
        self.write("six.dcf", dcf(6, [*standard(6), *input_byte()]))

    def network(self, five=None, six=None, **values):
        patient = {"SDO_Timeout": 5000, "Boot_Delay": 100}
        return self.write("network.xml", network(
            [node(5, DCF_File="five.dcf", **HEARTBEAT, **patient, **(five or {})),
             node(6, DCF_File="six.dcf", **GUARDING, **patient, **(six or {}))],
            Boot_Delay=100, **values))

    def start_devices(self):
        self.sims = [self.start_sim("--node", number, self.folder / name,
                                    "--ramp", f"{number}:6000:1=0..250/5000/20")
                     for number, name in ((5, "five.dcf"), (6, "six.dcf"))]

    def start_up(self, xml):
        boot = self.start_boot("--all", xml)
        self.wait_up(boot)
        return boot

    def wait_up(self, boot):
        boot.wait_for("network is up: 2 of 2")
        for number in DATA:
            boot.wait_for(f"node {number}: is operational")

    def await_data(self, dump, count=20):
        """So many more process data of both."""
        for data in DATA.values():
            seen = sum(frame.startswith(data) for frame in dump.frames())
            dump.process.wait_for(f" {data}", times=seen + count)

    def running(self, **values):
        """A plant in operation, its manager, and what is on the bus from then on."""
        self.start_devices()
        boot = self.start_up(self.network(**values))
        dump = self.dump()
        self.await_data(dump, 1)
        return boot, dump

    def assert_untouched(self, frames, number):
        """No command, no write; it goes on as it was."""
        talk = wire.lanes(frames)
        asked = [each for each in talk.get(("node", number), [])
                 if each.startswith(("000#", f"{0x600 + number:03X}#2"))]
        self.assertEqual(asked, [], f"node {number}")
        states = {int(frame[4:], 16) & 0x7F for frame in frames
                  if frame.startswith(f"{0x700 + number:03X}#") and "R" not in frame}
        self.assertEqual(states | {5}, {5}, f"node {number}")  # without guarding it says nothing
        values = [int(frame[4:], 16) for frame in frames if frame.startswith(DATA[number])]
        steps = [(after - before) % 250 for before, after in zip(values, values[1:])]
        self.assertLessEqual(max(steps), 5 + max(values) // 100, f"node {number}: {values}")
        plant.say(f"node {number}: {len(values)} process data, none missing")

    def assert_supervised(self, boot):
        """What becomes silent is missed."""
        for sim in self.sims:
            sim.kill()
        boot.wait_for("error: node 5: heartbeat lost")
        boot.wait_for("error: node 6: no answer to guarding")

    # ---- another manager takes over ----

    def test_kept_alive(self):
        """killed, started again, with keep alive: nothing stops, all are supervised again"""
        boot, dump = self.running()
        boot.kill()
        self.await_data(dump)
        again = self.start_up(self.network(ALIVE, ALIVE))
        for number in DATA:
            again.wait_for(f"node {number}: is running already: kept alive (L)")
        self.await_data(dump)
        frames = dump.end()
        for number in DATA:
            self.assert_untouched(frames, number)
        self.assertEqual([each for each in frames if each.startswith("000#")], [])
        self.assert_supervised(again)

    def test_one_kept_alive(self):
        """... with keep alive for one: only the other one is reset"""
        boot, dump = self.running()
        boot.kill()
        again = self.start_up(self.network(ALIVE))
        again.wait_for("node 5: is running already: kept alive (L)")
        self.await_data(dump)
        frames = dump.end()
        self.assert_untouched(frames, 5)
        commands = [each for each in frames if each.startswith("000#")]
        self.assertEqual(commands, ["000#8206", "000#0106"])
        self.assert_supervised(again)

    def test_booted_anew(self):
        """... without: reset and booted anew"""
        boot, dump = self.running()
        boot.kill()
        again = self.start_up(self.network())
        self.await_data(dump)
        frames = dump.end()
        commands = [each for each in frames if each.startswith("000#")]
        self.assertEqual(commands[0], "000#8200")
        self.assertEqual(sorted(commands[1:]), ["000#0105", "000#0106"])
        self.assertIn("605#2B17100064000000", frames)
        self.assert_supervised(again)

    # ---- it ends by itself ----

    def test_ended(self):
        """SIGINT, SIGTERM in operation: exit code 0, the plant is left as it is"""
        boot, dump = self.running()
        boot.kill()
        xml = self.network(ALIVE, ALIVE)
        for number in (signal.SIGINT, signal.SIGTERM):
            boot = self.start_up(xml)
            boot.wait_for("OPERATIONAL")
            dump = self.dump()
            self.assertEqual(boot.stop(number), UP, boot.story())
            self.await_data(dump)
            frames = dump.end()
            dump.process.close()
            for each in DATA:
                self.assert_untouched(frames, each)
            self.assertEqual(boot.err.lines, [])
            self.assertIn("  OPERATIONAL      booted", boot.out.lines[-1])

    def test_ended_in_boot(self):
        """... in the middle of a boot: exit code 1, with the table, at once"""
        xml = self.network()
        for number in (signal.SIGINT, signal.SIGTERM):
            gate = plant.Gate(self, "605#2B171000")
            sim = self.start_sim("--node", 5, self.folder / "five.dcf", bus=gate.inner)
            boot = self.start_boot("--all", xml)
            gate.wait()
            self.assertEqual(boot.stop(number), NOT_UP, boot.story())
            self.assertRegex(boot.out.text(), r"(?m)^ +5 .* MISSING: is being configured, entry 1")
            self.assert_stopped(sim)
            gate.process.close()

    # ---- it hangs for a while ----

    def hang(self, process, dump, count=100):
        """Stopped for so many process data of both nodes."""
        process.popen.send_signal(signal.SIGSTOP)
        self.await_data(dump, count)
        process.popen.send_signal(signal.SIGCONT)

    def fence(self, boot):
        """What came before has been seen by the manager."""
        flood = plant.TOOLS.parent / "tests" / "flood"
        self.assertEqual(self.run_command([flood, self.bus.name, 1, "72A#00"]).code, 0)
        boot.wait_for("node 42: boot-up message")

    def test_manager_hangs(self):
        """stopped for longer than a heartbeat may be missing: no loss is told that was none"""
        boot, dump = self.running(Heartbeat_Producer_Time=100)
        before = len(boot.out.lines)
        self.hang(boot, dump, 125)
        self.fence(boot)
        dump.wait_for("77F#05", times=dump.frames().count("77F#05") + 3)
        frames = dump.end()
        for number in DATA:
            self.assert_untouched(frames, number)
        told = [line for line in boot.out.lines[before:] if "node 42" not in line]
        self.assertEqual(told, [])
        self.assert_supervised(boot)

    def test_devices_hang(self):
        """devices that hang are missed, and in operation again when they go on"""
        boot, _ = self.running()
        for sim in self.sims:
            sim.popen.send_signal(signal.SIGSTOP)
        boot.wait_for("node 5: heartbeat lost")
        boot.wait_for("node 6: no answer to guarding")
        seen = len(boot.out.lines)
        for sim in self.sims:
            sim.popen.send_signal(signal.SIGCONT)
        for number in DATA:
            boot.wait_until(lambda lines, node=number: self.is_up(lines[seen:], node),
                            f"node {number} operational")
        self.assert_stopped(boot)

    @staticmethod
    def is_up(lines, number):
        """Operational after a start command."""
        told = "\n".join(lines).partition(f"node {number}: start command sent")[2]
        return f"node {number}: is operational" in told


if __name__ == "__main__":
    plant.main()
