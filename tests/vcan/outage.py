#!/usr/bin/env python3
"""The interface goes away under a network: it ends up booted again, nothing hangs, nobody polls."""
import os
import subprocess
import time
from pathlib import Path

import plant
from devices import UNSIGNED8, UNSIGNED32, Entry, Record, dcf, network, node, standard

DOWN = "20000040#0000000000000000"  # error frames: bus-off,
BACK = "20000100#0000000000000000"  # restarted,
PASSIVE = "20000004#0020000000000000"  # error passive


class Outage(plant.PlantTest):
    def setUp(self):
        super().setUp()
        self.make()
        self.addCleanup(self.ip, "del", self.bus.name)
        io = Record(0x6200, [Entry(0x6200, UNSIGNED8, 0, "rw", "0x55")])
        for number in (5, 6):
            emergency = Entry(0x1014, UNSIGNED32, "$NODEID+0x80", "rw")
            objects = [*standard(number, heartbeat=100), emergency, io]
            self.write(f"{number}.dcf", dcf(number, objects))
        nodes = [node(number, NMT_Mandatory_Slave="TRUE", Consumer_Heartbeat_Time=1000,
                      DCF_File=f"{number}.dcf") for number in (5, 6)]
        self.xml = self.write("network.xml", network(nodes, NMT_Action_On_Error="RESET_ALL"))
        self.sim = self.start_sim("-v", self.xml)

    def ip(self, *words):
        subprocess.run(["ip", "link", *words], check=True)

    def set(self, state):
        self.ip("set", self.bus.name, state)

    def say(self, frame):
        subprocess.run(["cansend", self.bus.name, frame], check=True)

    def boot_and_wait(self):
        boot = self.start_boot(self.xml)
        boot.wait_for("network is up")
        return boot

    def expect_up_again(self, boot, times=2):
        boot.wait_for("network is up", times=times)
        for number in (5, 6):
            self.sim.wait_for(f"node {number}: operational", times=times)
        story = boot.story()
        self.assertNotIn("heartbeat lost", story)
        self.assert_stopped(boot)
        self.assert_stopped(self.sim)

    def test_down(self):
        """down, later up"""
        boot = self.boot_and_wait()
        self.set("down")
        boot.wait_for("bus is down: vcan1 is down; run: ip link set vcan1 up")
        time.sleep(2)  # longer than heartbeats may be missing
        self.set("up")
        self.expect_up_again(boot)

    def test_flap(self):
        """down and up at once, some times"""
        boot = self.boot_and_wait()
        for times in range(2, 5):
            self.set("down")
            self.set("up")
            boot.wait_for("network is up", times=times)
        self.expect_up_again(boot, times=4)

    def test_mid_boot(self):
        """down and up, or removed and made again, at steps of the boot"""
        for number, frame in enumerate(("000#8200", "605#40001000", "586#", "606#2", "705#7F")):
            dump = self.dump()
            boot = self.start_boot(self.xml)
            dump.wait_for(frame)
            away, back = self.ways()[number % 2]
            away()
            if number % 3:
                boot.wait_for("bus is down")  # else it is up again before anybody looks
            back()
            boot.wait_until(self.is_up_since_outage, "the network up again")
            self.assertNotIn("heartbeat lost", boot.story())
            self.assert_stopped(boot)
            dump.process.stop()

    def ways(self):
        """How an interface goes, and comes back."""
        return ((lambda: self.set("down"), lambda: self.set("up")),
                (lambda: self.ip("del", self.bus.name), self.make))

    def make(self):
        self.ip("add", self.bus.name, "type", "vcan")
        self.set("up")

    @staticmethod
    def is_up_since_outage(lines):
        told = [line for line in lines if "bus is error active" in line or "network is up" in line]
        return "network is up" in "".join(told[-1:]) and any("bus is" in line for line in told)

    def test_removed(self):
        """removed and made again"""
        boot = self.boot_and_wait()
        self.ip("del", self.bus.name)
        boot.wait_for("bus is down: ")  # gone, or first down and then gone
        self.make()
        self.expect_up_again(boot)

    def test_another_index(self):
        """removed and made again at once, with other interfaces in between"""
        boot = self.boot_and_wait()
        self.ip("del", self.bus.name)
        self.ip("add", "vcan7", "type", "vcan")
        self.make()
        self.expect_up_again(boot)
        self.ip("del", "vcan7")

    def test_bus_off(self):
        """error passive, bus-off, restarted; the devices tell it by emergencies"""
        boot = self.boot_and_wait()
        dump = self.dump()
        self.say(PASSIVE)
        boot.wait_for("bus is error passive")
        for number in (5, 6):
            dump.wait_for(f"{0x80 + number:03X}#2081110201000000")
        self.say(DOWN)
        boot.wait_for("bus is bus-off")
        self.say(BACK)
        for number in (5, 6):
            dump.wait_for(f"{0x80 + number:03X}#4081110401000000")
        self.expect_up_again(boot)
        dump.process.stop()

    def test_idle(self):
        """without an interface, or with one that is down, nobody polls"""
        boot = self.boot_and_wait()
        for times, (away, back) in enumerate(self.ways(), 2):
            told = len(boot.out.lines)
            away()
            boot.wait_until(lambda lines, since=told: "bus is down: " in "\n".join(lines[since:]),
                            "bus is down")  # gone, or first down and then gone
            before = self.switches(boot), self.cpu_time(boot)
            time.sleep(1)
            switches, used = self.switches(boot) - before[0], self.cpu_time(boot) - before[1]
            plant.say(f"{switches} context switches and {1000 * used:.0f} ms in a second")
            self.assertLess(switches, 10)
            self.assertLess(used, 0.1)
            back()
            boot.wait_for("network is up", times=times)
        self.expect_up_again(boot, times=3)

    def test_down_before(self):
        """an interface that is down: told what to do, exit code 3"""
        self.set("down")
        boot = self.boot("--once", self.xml, code=3)
        self.assertRegex(boot.err.text(), f"error: {self.bus.name} is down; run: ip link set "
                                          f"{self.bus.name} up$")
        self.assertEqual(boot.out.lines, [])

    @staticmethod
    def cpu_time(process):
        stat = Path("/proc", str(process.popen.pid), "stat").read_text()
        fields = stat.rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    @staticmethod
    def switches(process):
        tasks = Path("/proc", str(process.popen.pid), "task")
        return sum(int(line.split()[1]) for status in tasks.glob("*/status")
                   for line in status.read_text().splitlines()
                   if line.startswith("voluntary_ctxt_switches"))


if __name__ == "__main__":
    plant.main()
