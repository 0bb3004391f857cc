"""What is measured on a bus, against programs without a CANopen stack on the same one."""
import time

from rows import NotRun, Row, compare, of_counts, result_of, wait_for_socket

NODE, NEUTRAL_NODE = 5, 9
SYNC_ID, TPDO_ID, RPDO_ID = 0x80, 0x180 + NODE, 0x200 + NODE
FOREIGN_ID = 0x305  # nobody's
RPDO_RATE = 12000
PACE = 500  # per second
SETTLES = 0.2  # seconds until what was sent is surely received


def took_all(result):
    if result["bad"] or not result["ok"]:
        raise RuntimeError(f"{result['bad']} of the SDO requests failed: {result['err']}")
    return result


def requests(bench, node, count):
    return took_all(bench.run("neutral_sdo_client", "-n", node, "-x", 0x1000, "-m", "exp-up",
                              "-w", 20, "-c", count))


def neutral_server(bench):
    return bench.while_running(wait_for_socket(bench.start("neutral_sdo_server", "-n",
                                                           NEUTRAL_NODE)))


def round_trip(bench):
    """us, from a request to its answer, between two yardsticks."""
    return requests(bench, NEUTRAL_NODE, bench.count(200))["lat_us"]["p50"]


def paced_round_trip(bench):
    """The same from rest, as often as RPDOs come in rpdo_to_handler(). The requests are nonsense;
    each is answered with an abort."""
    result = bench.run("neutral_pdogen", "-m", "echo", "-I", 0x600 + NEUTRAL_NODE, "-R",
                       0x580 + NEUTRAL_NODE, "-r", PACE, "-c", bench.count(50))
    if result["missing"]:
        raise RuntimeError(f"{result['missing']} requests without answer")
    return result["lat_us"]["p50"]


def check_lost(result):
    if result["sock_drops"]:
        raise RuntimeError(f"canstat itself has lost {result['sock_drops']} frames")
    return result


# --- SDO ---

def request_rate(bench, node):
    return requests(bench, node, bench.count(50))["ops_s"]


def measure_server(bench, server):
    with bench.while_running(server), neutral_server(bench):
        return compare(bench, max, lambda: request_rate(bench, NODE),
                       lambda: request_rate(bench, NEUTRAL_NODE), 40)


def measure_sdo(bench):
    return measure_server(bench, bench.device("serve"))


def measure_simulator(bench):
    return measure_server(bench, bench.simulator(NODE, "examples/boot-network/pump.dcf"))


# --- PDOs ---

def rate_of(bench, count, *producer):
    """TPDOs per second that this producer brings to the bus; none may be missing. The first ones,
    at the start of the device, and the last ones do not count."""
    watch = bench.watch("-I", TPDO_ID, "-q", 0, "-s", 5, "-c", count - 10, "-t", 1000)
    with bench.while_running(watch):
        bench.run_first(*producer)
        watch.wait(20)
    result = check_lost(watch.result)
    if result["frames"] != count - 10 or result["lost"]:
        raise RuntimeError(f"{result['frames']} frames of {count - 10}, {result['lost']} missing")
    return result["frames_s"]


def tpdo_rates(verb):
    def measure(bench):
        count = bench.count(500)
        neutral = ("neutral_pdogen", "-m", "flood", "-I", TPDO_ID, "-c", count)
        return compare(bench, max,
                       lambda: rate_of(bench, count, "bench_device", verb, count),
                       lambda: rate_of(bench, count, *neutral), 16)
    return measure


def rpdos_lost(bench):
    count = bench.count(3 * RPDO_RATE)
    with bench.while_running(bench.device("count-pdos")) as device:
        sent = bench.run_first("neutral_pdogen", "-m", "flood", "-I", RPDO_ID, "-r", RPDO_RATE,
                               "-B", 6, "-c", count)
        time.sleep(SETTLES)
    if not bench.smoke and sent["sent_s"] < RPDO_RATE * 0.97:
        raise NotRun(f"the yardstick's producer reaches {sent['sent_s']:.0f}/s here")
    return sent["sent"] - device.result["received"]


def measure_rpdo_rate(bench):
    return of_counts([rpdos_lost(bench) for _ in range(bench.rounds)])


# --- times of reaction ---

def sync_to_tpdo(bench):
    result = bench.run("neutral_pdogen", "-m", "sync", "-R", TPDO_ID, "-w", 20,
                       "-c", bench.count(200))
    if result["missing"]:
        raise RuntimeError(f"{result['missing']} SYNC without TPDO")
    return result["lat_us"]["p50"]


def measure_sync(bench):
    with bench.while_running(bench.device("answer-sync")), neutral_server(bench):
        return compare(bench, min, lambda: sync_to_tpdo(bench), lambda: round_trip(bench), 10)


def rpdo_to_handler(bench):
    count = bench.count(60)
    with bench.while_running(bench.device("time-pdos")) as device:
        bench.run("neutral_pdogen", "-m", "flood", "-T", "-I", RPDO_ID, "-r", PACE, "-c", count)
        time.sleep(SETTLES)
    if device.result["received"] != count:
        raise RuntimeError(f"{device.result['received']} of {count} PDOs were received")
    return device.result["p50_us"]


def measure_handler(bench):
    with neutral_server(bench):
        return compare(bench, min, lambda: rpdo_to_handler(bench),
                       lambda: paced_round_trip(bench), 15)


# --- SYNC ---

def watch_period(bench, period_us, count):
    watch = bench.watch("-I", SYNC_ID, "-p", period_us, "-s", 5, "-c", count)
    return check_lost(result_of(watch))["rms_dev_us"]


def our_deviation(bench, period_us, count):
    with bench.while_running(bench.device("produce-sync", period_us)):
        return watch_period(bench, period_us, count)


def neutral_deviation(bench, period_us, count):
    producer = bench.start("neutral_pdogen", "-m", "flood", "-I", SYNC_ID, "-D", 0,
                           "-r", 1000000 // period_us, "-c", 1 << 20)
    with bench.while_running(producer):
        return watch_period(bench, period_us, count)


def deviation(period_us, count, turns):
    def measure(bench):
        frames = bench.count(count)
        return compare(bench, min, lambda: our_deviation(bench, period_us, frames),
                       lambda: neutral_deviation(bench, period_us, frames), turns)
    return measure


# --- idling ---

def extra_wake_ups(bench):
    foreign = bench.start("neutral_pdogen", "-m", "flood", "-I", FOREIGN_ID, "-r", 500,
                          "-c", 1 << 20)
    with bench.while_running(foreign):
        result = bench.run("bench_device", "idle", bench.count(40, 4))
    return result["wake_ups"] - result["heartbeats"]


def measure_idle(bench):
    return of_counts([extra_wake_ups(bench) for _ in range(bench.rounds)])


ROWS = [
    Row("sdo", "expedited SDO requests answered: rate / neutral server's", ">=", 0.9, measure_sdo),
    Row("sdo-sim", "the same of `mcanopen sim`", ">=", 0.9, measure_simulator),
    Row("tpdo", "TPDOs by canOpenWritePDO: rate / neutral producer's", ">=", 1.0,
        tpdo_rates("write-pdo")),
    Row("tpdo-dictionary", "TPDOs by canOpenWriteDictionaryHnd: rate / neutral producer's", ">=",
        1.0, tpdo_rates("write-dictionary")),
    Row("rpdo-rate", "RPDOs lost of 36,000 at 12,000/s", "<=", 0, measure_rpdo_rate),
    Row("sync-tpdo", "SYNC to TPDO: time / neutral request to answer", "<=", 1.4, measure_sync),
    Row("rpdo-handler", "RPDO to the object's handler: time / neutral request to answer", "<=",
        1.2, measure_handler),
    Row("sync-1ms", "SYNC each 1 ms: deviation (rms) / neutral producer's", "<=", 1.0,
        deviation(1000, 100, 20)),
    Row("sync-10ms", "SYNC each 10 ms: deviation (rms) / neutral producer's", "<=", 1.0,
        deviation(10000, 20, 15)),
    Row("idle", "wake-ups of an idle device's threads beyond its 40 heartbeats", "<=", 1,
        measure_idle),
]
