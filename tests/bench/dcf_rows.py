"""What dcftest needs for a large EDS: instructions, with callgrind, and memory, with massif."""
import functools
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import large_eds
from count_rows import collected
from rows import LIMIT, NotRun, Row

OBJECTS = 10000
SIZES = [1000, OBJECTS, 30000]


def peak(path):
    """Bytes of the heap at its largest, in a file of massif."""
    return max(map(int, re.findall(r"^mem_heap_B=(\d+)$", path.read_text(encoding="ascii"), re.M)))


@functools.lru_cache
def count(bench, tool, objects):
    """For dcftest with an EDS of so many objects, and the bytes of the EDS."""
    text = large_eds.make(objects)
    with tempfile.TemporaryDirectory() as folder:
        eds, out = Path(folder) / "large.eds", Path(folder) / "out"
        eds.write_text(text, encoding="ascii")
        check = [bench.build / "tools" / "dcftest", "--strict", eds]
        told = subprocess.run(check, capture_output=True, text=True, timeout=LIMIT, check=False)
        if told.returncode != 0:
            raise ValueError(f"this file has no faults: {(told.stdout + told.stderr)[:1000]}")
        if bench.smoke:
            raise NotRun("a smoke test counts nothing")
        if not shutil.which("valgrind"):
            raise NotRun("valgrind is not installed")
        subprocess.run(["valgrind", f"--tool={tool}", f"--{tool}-out-file={out}", *check],
                       check=True, timeout=LIMIT, capture_output=True)
        return (collected(out) if tool == "callgrind" else peak(out)), len(text)


def measure_read(bench):
    instructions, size = count(bench, "callgrind", OBJECTS)
    return {"value": instructions / size}


def growth(tool):
    """For a byte more, the largest figure of the sizes to the smallest."""
    def measure(bench):
        least, size = count(bench, tool, 0)
        values = [(figure - least) / (more - size)
                  for figure, more in (count(bench, tool, objects) for objects in SIZES)]
        return {"value": max(values) / min(values), "samples": values}
    return measure


ROWS = [
    Row("dcf-read", "instructions for a byte of an EDS of 10,000 objects, read and checked", "<=",
        60, measure_read),
    Row("dcf-growth", "for a byte more: with 1,000, 10,000 and 30,000 objects, most / least", "<=",
        1.1, growth("callgrind")),
    Row("dcf-memory", "memory for a byte more: same numbers, most / least", "<=", 1.1,
        growth("massif")),
]
