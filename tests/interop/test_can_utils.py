#!/usr/bin/env python3
"""candump, cansend, canplayer and cangen on the bus of 'mcanopen boot' and 'mcanopen sim'."""
import os
import re
import signal

from peers import (EXAMPLE, configured, differences, patient_example, plant, read_dictionary,
                   say_by_hand)
from devices import Entry, dcf, network, node, standard
from sdo_log import Downloads

FILES = {2: "io.dcf", 5: "pump.dcf", 7: "level.dcf", 9: "valve.dcf"}
PATIENT = {"SDO_Timeout": 20000}
FLOOD_ID = 0x0FE  # an emergency of a node that is in no network here: it is received, and no news
FLOOD = 20000  # frames, twice what a receive queue holds
FULL_BUS = ("-g", "1", "-c", "4")  # frames of 8 bytes, about as many as 500 kbit/s carry
LOST = r"(\d+) received frames lost"
SWITCHED_OFF = 0x80000000


def number(data):
    return int.from_bytes(data, "little")


class CanUtils(plant.PlantTest):
    def write_example(self):
        texts = {key: (EXAMPLE / name).read_text(encoding="utf-8") for key, name in FILES.items()}
        for key, name in FILES.items():
            self.write(name, texts[key])
        return texts, self.write("network.xml", patient_example())

    def write_small(self, **values):
        """A network of node 5, simulated."""
        text = dcf(5, [*standard(5), Entry(0x2000, 7, 0, "rw", 0x12345678),
                       Entry(0x2001, 9, "", "rw", "eleven bytes and more")])
        device = self.write("five.dcf", text)
        nodes = [node(5, Name="five", DCF_File="five.dcf", **PATIENT)]
        xml = self.write("network.xml", network(nodes, Boot_Delay=300, **values))
        return device, xml

    # ---- candump ----

    def assert_log_is_configuration(self, key, text, downloads):
        expected = configured(text, key)
        self.assertEqual(differences(expected, downloads.values[key]), [], f"node {key}")
        defaults = read_dictionary(text, key)
        for (index, sub), value in downloads.values[key].items():
            if (index, sub) not in expected:
                default = defaults.get_variable(index, sub)
                self.assertEqual(value, default.encode_raw(default.default),
                                 f"node {key}: {index:04X}h:{sub:02X} is not of its DCF")
        return len(expected)

    def assert_mapped_while_off(self, history):
        """Mapped objects are written while their PDO is off and their number is 0."""
        values, mapped = {}, 0
        for key, index, sub, value in history:
            if 0x1600 <= index < 0x1800 or 0x1A00 <= index < 0x1C00:
                cob_id = values.get((key, index - 0x200, 1), 0)
                self.assertTrue(cob_id & SWITCHED_OFF, f"node {key}: {index:04X}h:{sub:02X}")
                self.assertTrue(sub == 0 or values[key, index, 0] == 0, f"node {key}: {index:04X}h")
                mapped += sub > 0
            values[key, index, sub] = number(value)
        self.assertGreater(mapped, 0)

    def test_candump(self):
        """the log of a boot, decoded back, is the configuration"""
        texts, xml = self.write_example()
        sim = self.start_sim(xml)
        own = self.start([plant.MCANOPEN, "dump", self.bus.name])
        own.wait_for("listening on", own.err)
        dump = self.dump()
        boot = self.boot("--once", "--all", xml)
        self.assert_stopped(sim)
        frames = dump.end()
        downloads = Downloads(frames)
        self.assertEqual(downloads.aborts, [])
        values = sum(self.assert_log_is_configuration(key, text, downloads)
                     for key, text in texts.items())
        self.assert_mapped_while_off(downloads.history)
        commands = [frame for frame in frames if frame.startswith("000#")]
        self.assertEqual(commands[0], "000#8200", boot.story())
        self.assertEqual(sorted(commands[1:]), ["000#0102", "000#0105", "000#0107", "000#0109"])
        own.wait_for(" 7FF#")
        self.assertEqual([line.split()[2] for line in own.out.text().splitlines()][:len(frames)],
                         frames, "mcanopen dump and candump")
        plant.say(f"{len(frames)} frames, {values} values")

    def test_sync(self):
        """SYNC of the manager comes from its start on, without a gap"""
        device, xml = self.write_small(Sync_Interval=20000, Sync_Cob_Id="0x90")
        self.start_sim("--node", 5, device)
        dump = self.dump()
        boot = self.start_boot(xml)
        boot.wait_for("network is up")
        dump.wait_for("090#", times=dump.frames().count("090#") + 10)
        self.assert_stopped(boot)
        frames = dump.end()
        self.assertLess(frames.index("090#"), frames.index("000#0105"))
        self.assertNotIn("SYNC", boot.out.text())
        plant.say(f"{frames.count('090#')} SYNCs")

    # ---- cansend ----

    def started(self, **values):
        """A boot that goes on, with node 5 operational."""
        device, xml = self.write_small(**values)
        self.start_sim("--node", 5, device)
        boot = self.start_boot(xml)
        boot.wait_for("network is up")
        boot.wait_for("node  name")  # the table comes once, and takes lines
        self.fence(boot, "0001")
        return boot

    def fence(self, boot, code):
        """An emergency with this code: what was sent before it has been seen when it is told."""
        say_by_hand(self, f"085#{code[2:]}{code[:2]}00")
        boot.wait_for(f"emergency {code}h")

    def assert_reported(self, boot, frame, pattern):
        before = len(boot.out.lines)
        say_by_hand(self, frame)
        boot.wait_until(lambda lines: any(re.search(pattern, line) for line in lines[before:]),
                        f"{pattern} after {frame}")

    def test_reported(self):
        """emergency, boot-up and a foreign master, sent by hand, are reported"""
        boot = self.started()
        for frame, pattern in (
                ("085#00FF81A1A2A3A4A5", 'node 5 "five": emergency FF00h, .* error register 81h, '
                                         "field A1 A2 A3 A4 A5"),
                ("085#0010", "emergency 1000h, .* error register 00h, field 00 00 00 00 00"),
                ("085#0000000000000000", "emergency 0000h"),
                ("72A#00", "node 42: boot-up message of a node that is not configured"),
                ("000#0105", 'another NMT master .* "start" to node 5'),
                ("000#0100", 'another NMT master .* "start" to all nodes'),
                ("705#00", 'node 5 "five": boot-up message')):
            self.assert_reported(boot, frame, pattern)
        boot.wait_for('node 5 "five": booted', times=2)
        boot.wait_for("start command sent", times=2)
        self.assert_stopped(boot)

    def test_boot_up_of_the_third_edition(self):
        """an emergency without data is a boot-up message"""
        boot = self.started()
        self.assert_reported(boot, "085#", 'node 5 "five": boot-up message')
        boot.wait_for('node 5 "five": booted', times=2)
        boot.wait_for("start command sent", times=2)
        self.assert_stopped(boot)

    def test_preset_emergency_consumer(self):
        """with Preset_Emergency_Consumer the emergencies of other nodes as well"""
        boot = self.started(Preset_Emergency_Consumer="TRUE")
        self.assert_reported(boot, "0AA#0010010000000000", "node 42: emergency 1000h")
        self.assert_stopped(boot)

    def test_ignored(self):
        """29 bits, remote frames, wrong lengths and strange commands are no news"""
        boot = self.started()
        before = len(boot.out.lines)
        for frame in ("00000085#0010010000000000", "00000705#00", "0000072A#00", "00000000#0105",
                      "00000585#6000200000000000", "1FFFFFFF#0102030405060708",
                      "085#R", "705#R", "72A#R", "000#R", "585#R", "605#R",
                      "085#00", "705#", "72A#", "000#", "000#01", "000#010500",
                      "585#", "585#60", "585#600020", "605#", "605#40", "605#4000200000000000",
                      "585#4300100000000000", "5AA#6000200000000000", "0AA#0010010000000000",
                      "000#AA05", "080#", "100#010203040506", "7E5#0400000000000000", "67F#R"):
            say_by_hand(self, frame)
        self.fence(boot, "0002")
        news = boot.out.lines[before:]
        self.assertEqual(len(news), 1, "\n".join(news))
        self.assert_stopped(boot)

    # ---- canplayer ----

    def record(self, xml, device):
        """The frames of a boot of the simulated node 5, without its heartbeats."""
        sim = self.start_sim("--node", 5, device)
        dump = self.dump()
        self.boot("--once", "--all", xml)
        self.assert_stopped(sim)
        frames = dump.end()
        kept = [frame for frame in frames if frame.endswith("#8200") or frame == "705#00"
                or frame[:3] in ("605", "585")]
        return kept[kept.index("000#8200"):]

    def test_canplayer(self):
        """a recorded device, played by canplayer, is booted like the device itself"""
        device, xml = self.write_small()
        record = self.record(xml, device)
        self.assertGreater(len(record), 10)
        pipe = self.folder / "pipe"
        os.mkfifo(pipe)
        dump = self.dump()
        self.start(["canplayer", "-t", "-I", pipe])
        boot = self.start_boot("--once", "--all", xml)
        with open(pipe, "w", encoding="ascii", buffering=1) as player:
            for place, frame in enumerate(record):
                if frame.startswith(("585", "705")):
                    player.write(f"(0.000000) {self.bus.name} {frame}\n")
                dump.wait_for(frame, times=record[:place + 1].count(frame))
        self.assertEqual(boot.wait(), 0, boot.story())
        self.assertIn("1 of 1 nodes booted", boot.out.text())
        plant.say(f"{len(record)} frames")

    # ---- cangen ----

    def flood(self, count, *options):
        return self.start(["cangen", self.bus.name, "-I", f"{FLOOD_ID:X}", "-L", "8", "-D", "i",
                           "-n", count, *options])

    def test_flood_while_booting(self):
        """a network boots on a bus that others fill"""
        texts, xml = self.write_example()
        self.start_sim(xml)
        generator = self.flood(1000000, *FULL_BUS)
        boot = self.boot("--once", "--all", xml)
        self.assertIsNone(generator.popen.poll(), "the flood was over before the boot")
        generator.kill()
        self.assertIn("4 of 4 nodes booted", boot.out.text())
        plant.say(f"{self.lost(boot.out.lines, LOST)} frames lost")

    def lost(self, lines, pattern):
        return sum(int(found[1]) for found in (re.search(pattern, line) for line in lines) if found)

    def stopped_while_flooded(self, process):
        process.popen.send_signal(signal.SIGSTOP)
        generator = self.flood(FLOOD, "-g", "0", "-i")
        self.assertEqual(generator.wait(), 0, generator.story())
        process.popen.send_signal(signal.SIGCONT)

    def test_lost(self):
        """what a stopped manager loses is counted and told, and it goes on"""
        boot = self.started()
        self.stopped_while_flooded(boot)
        self.fence(boot, "0003")
        boot.wait_for("received frames lost")
        lost = self.lost(boot.out.lines, LOST)
        self.assertLess(lost, FLOOD)
        self.assert_reported(boot, "72A#00", "node 42: boot-up message")
        self.assert_stopped(boot)
        plant.say(f"{lost} of {FLOOD} frames lost")

    def test_lost_exactly(self):
        """received and lost frames together are those sent"""
        own = self.start([plant.MCANOPEN, "dump", self.bus.name])
        own.wait_for("listening on", own.err)
        self.stopped_while_flooded(own)
        say_by_hand(self, "123#")
        own.wait_for("frames lost", own.err)
        own.wait_for(" 123#")
        got = sum(f" {FLOOD_ID:03X}#" in line for line in own.out.text().splitlines())
        lost = self.lost(own.err.text().splitlines(), r"(\d+) frames lost")
        self.assertEqual(got + lost, FLOOD)
        self.assertGreater(lost, 0)
        plant.say(f"{got} received, {lost} lost")


if __name__ == "__main__":
    plant.main()
