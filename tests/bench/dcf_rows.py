"""What reading a large EDS costs: instructions, with callgrind, and memory, with massif."""
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import large_eds
from count_rows import collected
from rows import LIMIT, NotRun, Row, result_of

OBJECTS = 10000
SIZES = [1000, OBJECTS, 30000]


def peak(path):
    """Bytes of the heap at its largest, in a file of massif."""
    return max(map(int, re.findall(r"^mem_heap_B=(\d+)$", path.read_text(encoding="ascii"), re.M)))


def per_byte(bench, tool, objects):
    """Of the whole process, for a byte of an EDS with so many objects."""
    text = large_eds.make(bench.count(objects))
    with tempfile.TemporaryDirectory() as folder:
        eds, out = Path(folder) / "large.eds", Path(folder) / "out"
        eds.write_text(text, encoding="ascii")
        told = result_of(bench.start("bench_dcf", eds))
        if told["messages"]:
            raise ValueError(f"there are {told['messages']} messages about a file without faults")
        if bench.smoke:
            raise NotRun("a smoke test counts nothing")
        if not shutil.which("valgrind"):
            raise NotRun("valgrind is not installed")
        option = "--callgrind-out-file" if tool == "callgrind" else "--massif-out-file"
        subprocess.run(["valgrind", f"--tool={tool}", f"{option}={out}",
                        *bench.command("bench_dcf", [eds])],
                       check=True, timeout=LIMIT, capture_output=True)
        return (collected(out) if tool == "callgrind" else peak(out)) / len(text)


def measure_read(bench):
    return {"value": per_byte(bench, "callgrind", OBJECTS)}


def growth(tool):
    """The largest figure of the sizes to the smallest."""
    def measure(bench):
        values = [per_byte(bench, tool, objects) for objects in SIZES]
        return {"value": max(values) / min(values), "samples": values}
    return measure


ROWS = [
    Row("dcf-read", "instructions for a byte of an EDS of 10,000 objects, read and checked", "<=",
        60, measure_read),
    Row("dcf-growth", "the same of 1,000, 10,000 and 30,000 objects, most / least", "<=", 1.1,
        growth("callgrind")),
    Row("dcf-memory", "bytes of memory for a byte, same sizes, most / least", "<=", 1.1,
        growth("massif")),
]
