#!/usr/bin/env python3
"""The bit rate and the states of a CAN controller, as Linux tells them."""
import fcntl
import os
import struct
import subprocess
import termios
import threading
import time
import tty
import unittest
from pathlib import Path

import plant
from devices import network, node

SLCAN = 17  # line discipline
INTERFACES = Path("/sys/class/net")


class Adapter:
    """A serial CAN adapter; what it is told is read and forgotten."""

    def __init__(self):
        before = set(os.listdir(INTERFACES))
        self.end, self.line = os.openpty()
        tty.setraw(self.line)
        threading.Thread(target=self._read, daemon=True).start()
        fcntl.ioctl(self.line, termios.TIOCSETD, struct.pack("i", SLCAN))
        self.name = (set(os.listdir(INTERFACES)) - before).pop()

    def _read(self):
        try:
            while os.read(self.end, 4096):
                pass
        except OSError:
            pass  # unplugged

    def say(self, text):
        os.write(self.end, text.encode())

    def unplug(self):
        fcntl.ioctl(self.line, termios.TIOCSETD, struct.pack("i", 0))


class Controller(plant.PlantTest):
    def setUp(self):
        try:
            self.adapter = Adapter()
        except (OSError, KeyError) as error:
            raise unittest.SkipTest(f"no slcan here: {error}") from None
        self.addCleanup(self.adapter.unplug)
        os.environ["MCANOPEN_TEST_BUS"] = self.adapter.name
        super().setUp()
        self.xml = self.write("network.xml", network([node(5)], Baudrate="500"))

    def ip(self, *words):
        subprocess.run(["ip", "link", "set", self.adapter.name, *words], check=True)

    def up(self, bitrate):
        self.ip("type", "can", "bitrate", str(bitrate))
        self.ip("up")

    def test_down(self):
        """down, without a bit rate"""
        boot = self.boot(self.xml, code=3)
        name = self.adapter.name
        self.assertIn(f"{name} is down; run: ip link set {name} up type can bitrate 500000",
                      boot.story())

    def test_other_bitrate(self):
        """another bit rate"""
        self.up(250000)
        boot = self.boot(self.xml, code=3)
        self.assertIn(f"{self.adapter.name} is at 250000 bit/s, configured are 500000; run:",
                      boot.story())

    def test_states(self):
        """warning, passive, bus-off, active"""
        self.up(500000)
        boot = self.start_boot(self.xml)
        boot.wait_for("node 5: boot error B")
        for said, told in (("sw010020", "is error warning"), ("sp010020", "is error passive"),
                           ("sb010020", "is bus-off"), ("sa000000", "is error active")):
            self.adapter.say(said + "\r")
            boot.wait_for(f"bus {told}: {self.adapter.name}")
        self.assertIn("room for 10 frames, better run: ip link set", boot.story())
        self.assertIn("bus-off and stays so", boot.story())

    def test_unplugged(self):
        """unplugged and plugged in again"""
        self.up(500000)
        boot = self.start_boot(self.xml)
        boot.wait_for("node 5: boot error B")
        self.adapter.unplug()
        boot.wait_for(f"{self.adapter.name}: no such CAN interface")
        self.adapter = Adapter()
        self.up(250000)
        time.sleep(0.2)  # it must not be used
        self.assertNotIn("error active", boot.story())
        self.ip("down")
        self.up(500000)
        boot.wait_for("bus is error active")


if __name__ == "__main__":
    plant.main()
