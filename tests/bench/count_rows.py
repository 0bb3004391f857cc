"""What is counted, not timed: instructions, with callgrind, and bytes."""
import shutil
import subprocess
import tempfile
from pathlib import Path

from rows import LIMIT, NotRun, Row, result_of

TIMES = 1000
READS = 10000  # of bench_device
FEW, MANY = 10, 10000  # objects
NODES = 100
MANY_NODES = 126


def collected(path):
    """Instructions in a file of callgrind."""
    for line in Path(path).read_text(encoding="ascii", errors="replace").splitlines():
        if line.startswith(("summary:", "totals:")):
            return int(line.split()[1])
    raise ValueError("callgrind has counted nothing")


def instructions(bench, functions, name, *arguments):
    """Instructions in these functions and what they call, all their calls together."""
    command = bench.command(name, arguments)
    result_of(bench.start(name, *arguments))  # tells when the library cannot do it yet
    if bench.smoke:
        raise NotRun("a smoke test counts no instructions")
    if not shutil.which("valgrind"):
        raise NotRun("valgrind is not installed")
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "callgrind"
        subprocess.run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={out}",
                        *(f"--toggle-collect={function}" for function in functions), *command],
                       check=True,
                       env=bench.environment, timeout=LIMIT, capture_output=True)
        return collected(out)


def per_frame(kind):
    def measure(bench):
        times = bench.count(TIMES)
        return {"value": instructions(bench, ["slave_on_frame"], "bench_machines", kind, times)
                // times}
    return measure


def per_read(bench, how, objects):
    function = "canOpenReadDictionaryHnd" if how == "read-by-handle" else "canOpenReadDictionary"
    return instructions(bench, [function], "bench_device", how, bench.count(objects, FEW)) // READS


def measure_growth(bench):
    few, many = (per_read(bench, "read-by-handle", objects) for objects in (FEW, MANY))
    return {"value": many - few, "ours": many}


def measure_against_index(bench):
    handle = per_read(bench, "read-by-handle", FEW)
    index = per_read(bench, "read-by-index", FEW)
    return {"value": handle / index, "ours": handle, "neutral": index}


def per_node(bench, nodes):
    """Of a manager that boots so many nodes and watches them for 10 s."""
    functions = ["manager_on_frame", "manager_on_time", "manager_deadline"]
    return instructions(bench, functions, "bench_network", nodes) // nodes


def measure_nodes(bench):
    one, many = (per_node(bench, nodes) for nodes in (1, MANY_NODES))
    return {"value": many / one, "ours": many, "few": one}


def measure_memory(bench):
    nodes = bench.count(NODES, 3)
    result = bench.run("bench_device", "memory", nodes)
    return {"value": result["bytes"] // nodes, "threads": result["threads"]}


ROWS = [
    Row("sdo-upload", "instructions for an expedited upload through the machines", "<=", 2000,
        per_frame("upload")),
    Row("sdo-download", "instructions for an expedited download through the machines", "<=", 2000,
        per_frame("download")),
    Row("rpdo-bytes", "instructions for an RPDO of 8 x UNSIGNED8 through the machines", "<=", 1500,
        per_frame("rpdo-bytes")),
    Row("rpdo-words", "instructions for an RPDO of 2 x UNSIGNED32 through the machines", "<=", 1500,
        per_frame("rpdo-words")),
    Row("handle-growth", "instructions more for a read by handle among 10,000 objects than 10",
        "<=", 0, measure_growth),
    Row("manager-nodes", "instructions for a node, booted and watched for 10 s: of 126 / of 1",
        "<=", 1.1, measure_nodes),
    Row("handle-index", "instructions for a read by handle / by index, 10 objects", "<=", 0.99,
        measure_against_index),
    Row("memory", "bytes for one more device with the objects that all have", "<=", 32768,
        measure_memory),
]
