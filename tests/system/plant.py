"""The real programs on a bus of the test's own: what all system tests share.

    MCANOPEN_TOOLS       folder of mcanopen, dcf2ccf (given by ctest)
    MCANOPEN_TEST_BUS    a CAN interface in place of virtual buses; candump takes the log there.
                         "new": vcans that are made for that
    MCANOPEN_TEST_WRAP   words before "mcanopen boot" and "mcanopen sim", as "valgrind -q ..."
    MCANOPEN_TEST_LIMIT  seconds that something awaited may take (60): only a failure takes them
    MCANOPEN_TEST_BRIEF  not empty: less of the same, for slow places
    TEST_CORPUS_DIR      the corpus of real EDS and DCF files

Nothing here sleeps to be right: a test waits for lines of the programs' output, for frames, or for
the end of a process.
"""
import atexit
import itertools
import os
import queue
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
DATA = HERE.parent / "data"
TOOLS = Path(os.environ.get("MCANOPEN_TOOLS", ROOT / "build" / "debug" / "tools"))
MCANOPEN = str(TOOLS / "mcanopen")
GATE = str(TOOLS.parent / "tests" / "gate")
NEW = "new"
WRAP = os.environ.get("MCANOPEN_TEST_WRAP", "").split()
BRIEF = bool(os.environ.get("MCANOPEN_TEST_BRIEF"))
SANITIZED = os.environ.get("MCANOPEN_TEST_SANITIZED")
LIMIT = float(os.environ.get("MCANOPEN_TEST_LIMIT", "60"))
RECEIVE_BUFFER = str(1 << 22)  # bytes, of candump: it may be slower than those it listens to
CORPUS = Path(os.environ.get("TEST_CORPUS_DIR", ROOT.parent / "shared" / "corpus" / "open"))
SKIPPED = 77  # exit code that ctest is told to take for "not run"


def say(text):
    print(f"    {text}", flush=True)


class Stream:
    """The lines of a pipe, as they come."""

    def __init__(self, pipe, news):
        self.pipe, self.news = pipe, news
        self.lines, self.ended = [], False
        self.thread = threading.Thread(target=self._read, daemon=True)
        self.thread.start()

    def _read(self):
        for line in self.pipe:
            with self.news:
                self.lines.append(line.rstrip("\n"))
                self.news.notify_all()
        with self.news:
            self.ended = True
            self.news.notify_all()

    def text(self):
        with self.news:
            return "\n".join(self.lines)


class Process:
    """A program of ours that runs; it is ended by its own id, at the latest with the test."""

    def __init__(self, command, bus=None, cwd=None, stdin=subprocess.DEVNULL):
        self.command = command
        environment = dict(os.environ, MCANOPEN_NET_0=bus) if bus else None
        self.popen = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                      stdin=stdin, text=True, errors="replace",
                                      env=environment, cwd=cwd)
        news = threading.Condition()
        self.out, self.err = Stream(self.popen.stdout, news), Stream(self.popen.stderr, news)
        self.news = news

    def _await(self, is_reached, what):
        deadline = time.monotonic() + LIMIT
        with self.news:
            while not is_reached():
                ended = self.out.ended and self.err.ended
                left = deadline - time.monotonic()
                if ended or left <= 0:
                    raise AssertionError(f"{'ended' if ended else f'{LIMIT:g} s over'} without"
                                         f" {what}\n{self.story()}")
                self.news.wait(left)

    def wait_for(self, text, where=None, times=1):
        """Until 'times' lines have the text in it."""
        stream = where or self.out
        self._await(lambda: sum(text in line for line in stream.lines) >= times, f'"{text}"')

    def wait_until(self, judge, what):
        """Until judge(lines of stdout) is true."""
        self._await(lambda: judge(self.out.lines), what)

    def wait(self):
        """The exit code."""
        try:
            code = self.popen.wait(LIMIT)
        except subprocess.TimeoutExpired:
            raise AssertionError(f"still runs after {LIMIT:g} s\n{self.story()}") from None
        for stream in (self.out, self.err):
            stream.thread.join(LIMIT)
        return code

    def stop(self, number=signal.SIGTERM):
        if self.popen.poll() is None:
            self.popen.send_signal(number)
        return self.wait()

    def kill(self):
        if self.popen.poll() is None:
            self.popen.kill()
        self.popen.wait()

    def close(self):
        self.kill()
        if self.popen.stdin:
            self.popen.stdin.close()
        for stream in (self.out, self.err):
            stream.thread.join(LIMIT)
            stream.pipe.close()

    def story(self):
        return (f"$ {' '.join(map(str, self.command))}\nstdout:\n" + "\n".join(self.out.lines) +
                "\nstderr:\n" + "\n".join(self.err.lines))


class Bus:
    """A virtual bus of this test alone, or the interface that the environment names."""

    numbers = itertools.count(1)
    idle = queue.SimpleQueue()  # interfaces made, for the next

    def __init__(self):
        number = next(Bus.numbers)
        self.interface = os.environ.get("MCANOPEN_TEST_BUS")
        self.is_new = self.interface == NEW
        if self.is_new:
            self.interface = self._take(number)
        self.name = self.interface or f"virtual:system-{os.getpid()}-{number}"

    @staticmethod
    def _take(number):
        try:
            return Bus.idle.get_nowait()
        except queue.Empty:
            name = f"t{os.getpid()}n{number}"
        for words in (["add", name, "type", "vcan"], ["set", name, "up"]):
            subprocess.run(["ip", "link", *words], check=True)
        atexit.register(subprocess.run, ["ip", "link", "del", name], check=True)
        return name

    def remove(self):
        """What is left where a process was killed."""
        if self.is_new:
            Bus.idle.put(self.interface)
            self.is_new = False
        elif not self.interface:
            name = f"mcanopen-{os.geteuid()}-{self.name.partition(':')[2]}"
            (Path("/dev/shm") / name).unlink(missing_ok=True)


class Dump:
    """The log of a bus: mcanopen dump, or candump on an interface."""

    def __init__(self, test, bus):
        self.test, self.bus = test, bus
        if bus.interface:
            others = self._count_receivers()
            self.process = test.start(["candump", "-L", "-r", RECEIVE_BUFFER, bus.name])
            self._await_receiver(others)
        else:
            self.process = test.start([MCANOPEN, "dump", bus.name])
            self.process.wait_for("listening on", self.process.err)

    def _count_receivers(self):
        lines = Path("/proc/net/can/rcvlist_all").read_text(encoding="ascii").splitlines()
        return sum(line.split()[:1] == [self.bus.interface] for line in lines)

    def _await_receiver(self, others):
        deadline = time.monotonic() + LIMIT
        while self._count_receivers() <= others:
            self.test.assertLess(time.monotonic(), deadline, "candump does not receive")
            time.sleep(0.01)

    def frames(self):
        """What came until now, as "ID#DATA"."""
        return [line.split()[2] for line in self.process.out.text().splitlines()]

    def wait_for(self, frame, times=1):
        self.process.wait_for(f" {frame}", times=times)

    def end(self):
        """Everything that was on the bus until now."""
        if self.bus.interface:
            self.test.run_command(["cansend", self.bus.interface, "7FF#"])
            self.wait_for("7FF#")
        self.process.stop()
        self.test.assertNotIn("lost", self.process.err.text())
        return [frame for frame in self.frames() if frame != "7FF#"]


class Gate:
    """Two buses in one, and a frame that waits between them: see gate.c. 'inner' is the second bus:
    what is alone on it is heard through the gate only.
    """

    def __init__(self, test, frame, number=1):
        self.inner = Bus()
        test.buses.append(self.inner)
        self.process = test.start([GATE, test.bus.name, self.inner.name, frame, number],
                                  stdin=subprocess.PIPE)
        self.process.wait_for("open")

    def wait(self):
        """Until the frame is there; it waits."""
        self.process.wait_for("at ")

    def let_pass(self):
        self.process.popen.stdin.write("\n")
        self.process.popen.stdin.flush()


class PlantTest(unittest.TestCase):
    """A test with a folder, a bus, and processes that end with it."""

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="mcanopen-system-"))
        self.addCleanup(shutil.rmtree, self.folder)
        self.take_bus()
        print(f"  {self.id().split('.', 1)[-1]}: {self.shortDescription() or ''}", flush=True)

    def take_bus(self):
        self.processes, self.buses = [], []
        self.addCleanup(self._clean_up)
        self.bus = Bus()
        self.buses.append(self.bus)

    def _clean_up(self):
        for process in self.processes:
            process.close()
        for bus in self.buses:
            bus.remove()

    def write(self, name, text):
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        return path

    def start(self, command, cwd=None, stdin=subprocess.DEVNULL):
        process = Process([str(word) for word in command], self.bus.name, cwd, stdin)
        self.processes.append(process)
        return process

    def run_command(self, command, cwd=None):
        process = self.start(command, cwd)
        process.code = process.wait()
        return process

    def dump(self):
        return Dump(self, self.bus)

    def start_sim(self, *arguments, bus=None):
        """Returns when the devices are on the bus."""
        name = (bus or self.bus).name
        process = self.start([*WRAP, MCANOPEN, "sim", "-q", "--bus", name, *arguments])
        process.wait_for("simulated device")
        return process

    def start_boot(self, *arguments):
        return self.start([*WRAP, MCANOPEN, "boot", *arguments])

    def boot(self, *arguments, code=0):
        """Runs it to its end, which must have this exit code."""
        process = self.start_boot(*arguments)
        self.assertEqual(process.wait(), code, process.story())
        return process

    def assert_stopped(self, process, number=signal.SIGTERM):
        self.assertEqual(process.stop(number), 0, process.story())


class Scene(PlantTest):
    """One of several plants that a test has at once, in threads; its folder is that of the test."""

    def __init__(self, test):
        super().__init__("take_bus")
        self.folder = test.folder

    def __enter__(self):
        self.take_bus()
        return self

    def __exit__(self, *failure):
        self.doCleanups()


class _Result(unittest.TextTestResult):
    def startTest(self, test):
        self.begin = time.monotonic()
        super().startTest(test)

    def stopTest(self, test):
        print(f"    {time.monotonic() - self.begin:.2f} s", flush=True)
        super().stopTest(test)

    def addSkip(self, test, reason):
        super().addSkip(test, reason)
        print(f"    NOT RUN: {reason}", flush=True)


def main(module="__main__"):
    """Runs the tests of a file, or those named in the arguments, as "Class.test"; the line at the
    end is what tests/run.sh counts.
    """
    names = [f"{module}.{name}" for name in sys.argv[1:]] or [module]
    suite = unittest.defaultTestLoader.loadTestsFromNames(names)
    result = unittest.TextTestRunner(stream=sys.stdout, resultclass=_Result, verbosity=0).run(suite)
    ran = result.testsRun - len(result.skipped)
    failed = {getattr(test, "test_case", test).id()  # of several parts of a test: the test, once
              for test, _ in result.failures + result.errors}
    good = 100 * (ran - len(failed)) // ran if ran else 100
    print(f"{good}%: Checks: {ran}, Failures: {len(failed)}, Errors: 0", flush=True)
    if not result.wasSuccessful():
        sys.exit(1)
    sys.exit(0 if ran else SKIPPED)
