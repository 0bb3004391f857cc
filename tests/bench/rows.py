"""What a measurement gives, and the programs that measure."""
import json
import os
import statistics
import subprocess
import time
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LIMIT = 120  # seconds, for one run of a program


class NotRun(Exception):
    """Why a row cannot be measured here."""


def judge(value, relation, target):
    return value >= target if relation == ">=" else value <= target


class Row:
    """One line of the table. measure(bench) gives a dict with 'value', and what else it knows."""

    def __init__(self, name, text, relation, target, measure):
        self.name, self.text = name, text
        self.relation, self.target = relation, target
        self.measure = measure

    def run(self, bench):
        result = {"row": self.name, "text": self.text, "relation": self.relation,
                  "target": self.target}
        try:
            result.update(self.measure(bench))
            met = judge(result["value"], self.relation, self.target)
            result["verdict"] = "works" if bench.smoke else "met" if met else "missed"
        except NotRun as reason:
            result.update(verdict="not measured", reason=str(reason))
        except (OSError, ValueError, KeyError, RuntimeError, subprocess.SubprocessError) as error:
            result.update(verdict="error", reason=f"{type(error).__name__}: {error}")
        return result


def compare(bench, better, ours, neutral, turns=5, rounds=None):
    """Medians of the rounds. In each of them both take turns, and what counts is the best turn:
    what others do on this machine makes it slower, never faster."""
    pairs = []
    for _ in range(min(rounds or bench.rounds, bench.rounds)):
        results = [(ours(), neutral()) for _ in range(bench.count(turns, 1))]
        pairs.append(tuple(better(side) for side in zip(*results)))
    ours, neutral = zip(*pairs)
    ratios = [mine / other for mine, other in pairs]
    return {"value": statistics.median(ratios), "ours": statistics.median(ours),
            "neutral": statistics.median(neutral), "samples": ratios}


def of_counts(counts):
    return {"value": statistics.median(counts), "samples": list(counts)}


class Bench:
    """The programs in a build folder, how often and how long they run, and on which bus."""

    def __init__(self, build, bus, smoke=False):
        self.build = Path(build).resolve()
        self.folder = self.build / "tests" / "bench"
        self.bus = bus
        self.smoke = smoke
        self.rounds = 1 if smoke else 5
        self.environment = dict(os.environ, MCANOPEN_NET_0=bus)

    def count(self, number, tiny=20):
        """So many frames; in a smoke test a few."""
        return tiny if self.smoke else number

    def program(self, name):
        path = self.folder / name
        if not path.exists() and name.startswith("neutral_"):
            raise NotRun(f"needs the yardstick ../shared/neutral/{name[8:]}, which is not there")
        if not path.exists():
            raise NotRun(f"{name} is not built")
        return str(path)

    def command(self, name, arguments):
        # The yardsticks know the bus by an option, ours by the environment.
        bus = ["-i", self.bus] if name.startswith("neutral_") else []
        return [self.program(name), *map(str, arguments), *bus]

    def start(self, name, *arguments, before=None):
        return subprocess.Popen(self.command(name, arguments), stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True, env=self.environment,
                                preexec_fn=before)

    def watch(self, *arguments):
        """canstat, which must not disturb those it watches: it runs when nobody else wants to. The
        times are the kernel's, and its buffer is large."""
        watch = wait_for_socket(self.start("neutral_canstat", *arguments))
        os.sched_setscheduler(watch.pid, os.SCHED_IDLE, os.sched_param(0))
        return watch

    def run(self, name, *arguments):
        return result_of(self.start(name, *arguments))

    def run_first(self, name, *arguments):
        """Before all others that want the processor: a receiver on the same one would not only
        receive, but hold up the sender."""
        return result_of(self.start(name, *arguments, before=go_first))

    def device(self, *arguments):
        """bench_device, on the bus."""
        return wait_for_line(self.start("bench_device", *arguments))

    def simulator(self, node, file):
        """mcanopen sim, on the bus."""
        tool = self.build / "tools" / "mcanopen"
        return wait_for_line(subprocess.Popen(
            [tool, "sim", "--quiet", "--bus", self.bus, "--node", str(node), ROOT / file],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True))

    @contextmanager
    def while_running(self, process):
        """What comes out is in .result afterwards."""
        try:
            yield process
            process.terminate()
            process.result = result_of(process)
        finally:
            if process.poll() is None:
                process.kill()
                process.communicate()


def go_first():
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
    except PermissionError:
        pass


def wait_for_line(process):
    """The first line of these programs says that they are on the bus."""
    if not process.stdout.readline():
        result_of(process)
        raise RuntimeError(f"{process.args[0]} is not ready")
    return process


def has_socket(process):
    folder = Path("/proc") / str(process.pid) / "fd"
    try:
        return any(os.readlink(each).startswith("socket:") for each in folder.iterdir())
    except FileNotFoundError:  # closed meanwhile, by the loader
        return False


def wait_for_socket(process):
    """Until a yardstick, which says nothing, listens."""
    limit = time.monotonic() + 10
    while process.poll() is None and not has_socket(process) and time.monotonic() < limit:
        time.sleep(0.01)
    time.sleep(0.03)
    return process


def last_json(text):
    """The last line, where it is JSON."""
    lines = [line for line in text.splitlines() if line.startswith("{")]
    return json.loads(lines[-1]) if lines else {}


def result_of(process):
    """Waits for the end of a program; its line of JSON."""
    try:
        out, errors = process.communicate(timeout=LIMIT)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        raise
    if process.returncode not in (0, 2):  # 2: the yardstick has missed answers, and tells how many
        name = Path(process.args[0]).name
        raise RuntimeError(f"{name}: exit code {process.returncode}: {errors.strip()}")
    return last_json(out)
