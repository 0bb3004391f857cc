"""SDO transfers of some size, both ways, with the device as server and with the manager as client;
each is compared with the same transfer between two yardsticks."""
import struct
import tempfile
from contextlib import contextmanager
from pathlib import Path

from bus_rows import NEUTRAL_NODE, NODE, took_all
from rows import ROOT, Row, compare, wait_for_socket

TINY, SMALL, LARGE = 1024, 64 * 1024, 1024 * 1024  # the first one for smoke tests
DOMAINS = {TINY: 0x2100, SMALL: 0x2101, LARGE: 0x2102}
TURNS = {SMALL: 20, LARGE: 2}  # one takes 1 s, and 17 s: the best one of a single round
WRITES = 20  # for each node that is booted
MEASURABLE = 1000  # transfers; some kernels count processor time in steps of 10 ms
MODES = {"seg-up": "segmented upload", "seg-dn": "segmented download",
         "blk-up": "block upload", "blk-dn": "block download"}


@contextmanager
def neutral_server(bench):
    domains = [f"-o{index:#x}={size}" for size, index in DOMAINS.items()]
    process = bench.start("neutral_sdo_server", "-n", NEUTRAL_NODE, *domains)
    with bench.while_running(wait_for_socket(process)):
        yield


def neutral_rate(bench, node, mode, size):
    """kB/s of a yardstick as the client."""
    check = ["-V"] if mode.endswith("up") else []
    return took_all(bench.run("neutral_sdo_client", "-n", node, "-x", DOMAINS[size], "-m", mode,
                              "-s", size, "-c", 1, *check))["kB_s"]


def manager_result(bench, direction, index, size, times):
    return bench.run("bench_manager", ROOT / "tests" / "bench" / "manager.xml", direction,
                     NEUTRAL_NODE, index, size, times)


def manager_rate(bench, mode, size):
    direction = "read" if mode.endswith("up") else "write"
    direction += "-block" if mode.startswith("blk") else ""
    return manager_result(bench, direction, DOMAINS[size], size, 1)["kB_s"]


def as_server(mode, size):
    def measure(bench):
        some = bench.count(size, TINY)
        with bench.while_running(bench.device("serve-domains")), neutral_server(bench):
            return compare(bench, max, lambda: neutral_rate(bench, NODE, mode, some),
                           lambda: neutral_rate(bench, NEUTRAL_NODE, mode, some), TURNS[size], 1)
    return measure


def as_client(mode, size):
    def measure(bench):
        some = bench.count(size, TINY)
        with neutral_server(bench):
            return compare(bench, max, lambda: manager_rate(bench, mode, some),
                           lambda: neutral_rate(bench, NEUTRAL_NODE, mode, some), TURNS[size], 1)
    return measure


def read_rate(bench, count):
    return manager_result(bench, "read", 0x1000, 4, count)["ops_s"]


def measure_reads(bench):
    count = bench.count(200)

    def neutral():
        return took_all(bench.run("neutral_sdo_client", "-n", NEUTRAL_NODE, "-x", 0x1000, "-m",
                                  "exp-up", "-c", count))["ops_s"]
    with neutral_server(bench):
        return compare(bench, max, lambda: read_rate(bench, count), neutral, 20)


# --- booting ---

def network_of(nodes, folder):
    """A configuration: so many mandatory nodes, with so many writes for each."""
    values = (struct.pack("<HBIL", 0x2100, sub + 1, 4, sub) for sub in range(WRITES))
    (folder / "node.ccf").write_bytes(struct.pack("<L", WRITES) + b"".join(values))
    node = ("<Node_Instance><Node_Id>{}</Node_Id><NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>"
            "<CCF_File>node.ccf</CCF_File></Node_Instance>")
    path = folder / "network.xml"
    path.write_text("<CANopen_Manager><Manager_Instance><Net_No>0</Net_No><Baudrate>1000</Baudrate>"
                    "<Manager_Node_Id>127</Manager_Node_Id>" +
                    "".join(node.format(each + 1) for each in range(nodes)) +
                    "</Manager_Instance></CANopen_Manager>", encoding="ascii")
    return path


def boot_cost(bench, config, nodes):
    """CPU us per transfer of the manager."""
    slaves = bench.start("neutral_slaves", "-f", 1, "-l", nodes)
    with bench.while_running(wait_for_socket(slaves)):
        result = bench.run("bench_manager", config, "boot")
    transfers = slaves.result["sdo_transfers"]
    if result["nodes"] != nodes or transfers < nodes * WRITES:
        raise RuntimeError(f"{result['nodes']} nodes have booted with {transfers} transfers")
    return result["cpu_s"] / transfers * 1e6


def neutral_cost(bench, count):
    """The same of the yardstick, which writes as often to one server."""
    result = took_all(bench.run("neutral_sdo_client", "-n", NEUTRAL_NODE, "-x", 0x2100, "-u", 1,
                                "-m", "exp-dn", "-w", 20, "-c", count))
    used = result["user_s"] + result["sys_s"]
    if used == 0:
        raise RuntimeError(f"{count} writes have taken no time that can be measured")
    return used / count * 1e6


def measure_boot(bench):
    nodes = bench.count(126, 3)

    def neutral():
        server = bench.start("neutral_slaves", "-f", NEUTRAL_NODE, "-l", NEUTRAL_NODE)
        with bench.while_running(wait_for_socket(server)):
            return neutral_cost(bench, max(nodes * WRITES, MEASURABLE))
    with tempfile.TemporaryDirectory() as folder:
        config = network_of(nodes, Path(folder))
        return compare(bench, min, lambda: boot_cost(bench, config, nodes), neutral, 5)


def rows(size, name):
    for mode, text in MODES.items():
        text = f"{text} of {name.upper()}iB"
        yield Row(f"server-{mode}-{name}", f"{text}, server: rate / neutral server's",
                  ">=", 0.9, as_server(mode, size))
        yield Row(f"client-{mode}-{name}", f"{text}, client: rate / neutral client's",
                  ">=", 0.9, as_client(mode, size))


READS = Row("read-sdo", "expedited mcanOpenReadSDO: rate / neutral client's", ">=", 0.7,
            measure_reads)
BOOT = Row("boot-126", f"CPU time to boot 126 nodes, {WRITES} writes each / neutral client's",
           "<=", 1.5, measure_boot)
SHORT = [READS, BOOT, *rows(SMALL, "64k")]
LONG = list(rows(LARGE, "1m"))
