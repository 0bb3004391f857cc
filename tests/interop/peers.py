"""python-canopen on the bus of a test: devices and a master of other make than ours.

The bus is a CAN interface (MCANOPEN_TEST_BUS, vcan0); tests/vcan/run.sh brings it, and
tests/run.sh the packages of requirements.txt: sh tests/run.sh interop
"""
import io
import os
import re
import struct
import sys
import threading
import time
from pathlib import Path

import can
import canopen
from canopen.objectdictionary import import_od

os.environ.setdefault("MCANOPEN_TEST_BUS", "vcan0")
os.environ.setdefault("MCANOPEN_TEST_LIMIT", "15")
if "MCANOPEN_BUILD" in os.environ:
    os.environ.setdefault("MCANOPEN_TOOLS", os.environ["MCANOPEN_BUILD"] + "/tools")
sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "system"))

import plant  # noqa: E402 (its folder is known only now)

EXAMPLE = plant.ROOT / "examples" / "boot-network"
LAST_DUMMY = 0x1F  # data types, which python-canopen has among the objects
NMT_RESET_NODE, NMT_RESET_COMMUNICATION = 129, 130
DUMMIES = re.compile(r"^Dummy00\d\d=.*\n", re.MULTILINE)
VALUES = re.compile(r"^ParameterValue=.*\n", re.MULTILINE)


def variables(dictionary):
    """The entries of an object dictionary of python-canopen."""
    for index in sorted(dictionary):
        entry = dictionary[index]
        if index <= LAST_DUMMY:
            continue
        if isinstance(entry, canopen.objectdictionary.ODVariable):
            yield entry
        else:
            yield from (entry.subindices[sub] for sub in sorted(entry.subindices))


def read_dictionary(text, node):
    """python-canopen reads no file that has some of the dummies only; here nobody needs them."""
    dummies = "".join(f"Dummy{number:04d}=0\n" for number in range(1, 8))
    text = DUMMIES.sub("", text).replace("[DummyUsage]\n", "[DummyUsage]\n" + dummies)
    file = io.StringIO(text)
    file.name = "device.eds"
    return import_od(file, node)


def configured(text, node):
    """{(index, sub): bytes}: the values that a DCF gives, as python-canopen reads it."""
    return {(each.index, each.subindex): each.encode_raw(each.value)
            for each in variables(read_dictionary(text, node)) if each.value is not None}


def differences(expected, actual):
    """Lines about {(index, sub): bytes} that are not as expected."""
    return [f"{index:04X}h:{sub:02X} expected {value.hex()}, is "
            f"{actual[index, sub].hex() if (index, sub) in actual else 'not there'}"
            for (index, sub), value in sorted(expected.items())
            if actual.get((index, sub)) != value]


def patient_example():
    """The network file of the example, with time for devices that are no fast ones."""
    text = (EXAMPLE / "network.xml").read_text(encoding="utf-8")
    text = re.sub(r"<Consumer_Heartbeat_Time>\d+<", "<Consumer_Heartbeat_Time>30000<", text)
    text = re.sub(r"<Boot_Time>\d+<", "<Boot_Time>50000<", text)
    return text.replace("</Node_Id>", "</Node_Id><SDO_Timeout>20000</SDO_Timeout>")


def say_by_hand(test, *frames):
    """Frames "ID#DATA" by cansend, in the order given."""
    for frame in frames:
        sent = test.run_command(["cansend", test.bus.name, frame])
        test.assertEqual(sent.code, 0, sent.story())


class Device(canopen.LocalNode):
    """A device of python-canopen.

    Its dictionary is made from the DCF's text without the values, as python-canopen answers with
    ParameterValue where nothing was written. By itself it stays silent after NMT reset commands;
    here it forgets what was written and says boot-up, as CiA 301 has it.
    """

    def __init__(self, node, text):
        super().__init__(node, read_dictionary(VALUES.sub("", text), node))
        self.expected = configured(text, node)

    def associate_network(self, network):
        super().associate_network(network)
        network.unsubscribe(0, self.nmt.on_command)
        network.subscribe(0, self._on_command)

    def remove_network(self):
        self.nmt.stop_heartbeat()
        self.network.subscribe(0, self.nmt.on_command)
        self.network.unsubscribe(0, self._on_command)
        super().remove_network()

    def _on_command(self, can_id, data, timestamp):
        command, node = struct.unpack_from("BB", data)
        if command not in (NMT_RESET_NODE, NMT_RESET_COMMUNICATION):
            self.nmt.on_command(can_id, data, timestamp)
        elif node in (0, self.id):
            self.restart(first=0 if command == NMT_RESET_NODE else 0x1000)

    def restart(self, first=0):
        self.nmt.stop_heartbeat()
        for index in [each for each in self.data_store if not first or each < 0x2000]:
            del self.data_store[index]
        self.nmt.state = "INITIALISING"
        self.nmt.state = "PRE-OPERATIONAL"

    def written(self):
        """{(index, sub): bytes}: what was written since the last reset."""
        return {(index, sub): bytes(value) for index, subs in self.data_store.items()
                for sub, value in subs.items()}


class Heard(can.Listener):
    """Every frame that others send, as "ID#DATA", to wait for."""

    def __init__(self):
        self.frames, self.news = [], threading.Condition()

    def on_message_received(self, msg):
        text = f"{msg.arbitration_id:03X}#" + ("R" if msg.is_remote_frame else msg.data.hex())
        with self.news:
            self.frames.append(text.upper())
            self.news.notify_all()

    def count(self):
        with self.news:
            return len(self.frames)

    def wait_for(self, pattern, since=0):
        """The first frame that matches, after so many others; its number, from 1."""
        deadline = time.monotonic() + plant.LIMIT
        with self.news:
            while True:
                for number, frame in enumerate(self.frames[since:], since + 1):
                    if re.fullmatch(pattern, frame):
                        return number
                left = deadline - time.monotonic()
                if left <= 0:
                    raise AssertionError(f"no {pattern} on the bus: {self.frames[since:]}")
                self.news.wait(left)


class Arrivals:
    """Things that come one by one, to wait for."""

    def __init__(self):
        self.times, self.all, self.news = [], [], threading.Condition()

    def add(self, what, when):
        with self.news:
            self.times.append(when)
            self.all.append(what)
            self.news.notify_all()

    def count(self):
        with self.news:
            return len(self.all)

    def _wait_until(self, judge, what):
        with self.news:
            if not self.news.wait_for(judge, plant.LIMIT):
                raise AssertionError(f"no {what} in {self.all}")

    def wait_for(self, what):
        """Until the last one is this."""
        self._wait_until(lambda: self.all and self.all[-1] == what, what)

    def wait_for_count(self, count):
        self._wait_until(lambda: len(self.all) >= count, f"number {count}")

    def gaps(self, since=0):
        times = self.times[since:]
        return [after - before for before, after in zip(times, times[1:])]


class PeerTest(plant.PlantTest):
    """A test with a network of python-canopen on its bus."""

    def setUp(self):
        super().setUp()
        self.network = canopen.Network()
        self.network.NOTIFIER_CYCLE = 0.1
        self.heard = Heard()
        self.network.listeners.append(self.heard)
        self.network.connect(interface="socketcan", channel=self.bus.name)
        self.addCleanup(self.network.disconnect)

    def add_devices(self, texts):
        """{node: DCF} as devices of python-canopen, powered on."""
        for node, text in texts.items():
            self.network[node] = Device(node, text)
            self.addCleanup(self.network[node].nmt.stop_heartbeat)
            self.network[node].restart()
        return [self.network[node] for node in texts]
