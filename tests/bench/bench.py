#!/usr/bin/env python3
"""Measures and prints; sh tests/bench/run.sh builds what it needs and calls it.

    bench.py --build DIR [--json] [--smoke] [--bus INTERFACE] [ROW...]

Rows on a bus are measured on INTERFACE; without it on a vcan0 of their own (tests/vcan/run.sh).
The exit code is 1 when a measurement has gone wrong, 2 when a target was missed or something was
not measured; a smoke test judges nothing.
"""
import argparse
import json
import os
import shlex
import subprocess
import sys

import bus_rows
import count_rows
import dcf_rows
import transfer_rows
from rows import ROOT, Bench

BUS_MINUTES = 14
LANES = bus_rows.ROWS, transfer_rows.SHORT, transfer_rows.LONG  # each has 15 minutes in run.sh
ON_BUS = sum(LANES, [])
HERE = count_rows.ROWS + dcf_rows.ROWS  # no bus


def run_rows(rows, bench, names):
    return [row.run(bench) for row in rows if not names or row.name in names]


def fail_all(rows, names, reason, verdict):
    return [{"row": row.name, "text": row.text, "relation": row.relation, "target": row.target,
             "verdict": verdict, "reason": reason}
            for row in rows if row.name in names]


def explain(output):
    """Why nothing came back: what tests/vcan/run.sh says, or the end of it."""
    lines = output.strip().splitlines() or ["tests/vcan/run.sh says nothing"]
    cannot = [line for line in lines if line.startswith("this lane cannot run")]
    return (cannot or lines)[-1], "not measured" if cannot else "error"


def read_results(path):
    """One in a line, as far as it got."""
    if not path.exists():
        return []
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def run_on_vcan(options, names):
    """These rows on a bus, in the network or kernel that tests/vcan/run.sh brings."""
    folder = Bench(options.build, "").folder
    results, script = folder / "bus.json", folder / "bus.sh"
    command = [sys.executable, "-B", __file__, "--build", options.build, "--bus", "vcan0",
               "--results", str(results), *(["--smoke"] if options.smoke else []), *names]
    script.write_text(f"exec {shlex.join(command)}\n", encoding="utf-8")
    results.unlink(missing_ok=True)
    environment = dict(os.environ, MCANOPEN_VCAN_SECONDS=str(60 * BUS_MINUTES))
    lane = subprocess.run(["sh", str(ROOT / "tests" / "vcan" / "run.sh"), options.build,
                           str(script)], env=environment, capture_output=True, text=True,
                          check=False)
    measured = read_results(results)
    missing = set(names) - {each["row"] for each in measured}
    reason, verdict = explain(lane.stdout + lane.stderr)
    place = lane.stderr.strip().rpartition(", ")[2] if measured else ""
    return measured + fail_all(ON_BUS, missing, reason, verdict), place


def run_lanes(options):
    results, place = [], ""
    for rows in LANES:
        names = [row.name for row in rows if not options.rows or row.name in options.rows]
        if names:
            found, place = run_on_vcan(options, names)
            results += found
    return results, place


def measure(options):
    """All rows that are wanted, and where the bus was."""
    if options.bus:
        place = options.bus
        results = run_rows(ON_BUS, Bench(options.build, options.bus, options.smoke),
                           options.rows)
    else:
        results, place = run_lanes(options)
    here = Bench(options.build, f"virtual:bench-{os.getpid()}", options.smoke)
    return results + run_rows(HERE, here, options.rows), place


# --- printing ---

def number(value):
    if value is None:
        return "-"
    return f"{value:,.2f}" if isinstance(value, float) and abs(value) < 1000 else f"{value:,.0f}"


def by_verdict(results):
    """The names of the rows that were met, missed ..."""
    found = {}
    for each in results:
        found.setdefault(each["verdict"], []).append(each["row"])
    return found


def exit_code(results, smoke):
    verdicts = set(by_verdict(results))
    if "error" in verdicts:
        return 1
    return 0 if smoke or verdicts <= {"met"} else 2


def print_table(results, place):
    wide = max(len(each["text"]) for each in results)
    print(f"{'':{wide}}  {'measured':>9}  {'target':>9}")
    for each in results:
        target = f"{each['relation']} {number(each['target'])}"
        print(f"{each['text']:{wide}}  {number(each.get('value')):>9}  {target:>9}  "
              f"{each['verdict']}" + (f": {each['reason']}" if "reason" in each else ""))
        if "neutral" in each:
            print(f"    {number(each['ours'])} against {number(each['neutral'])}")
    if place:
        print(f"bus: vcan, {place}")
    print("; ".join(f"{len(rows)} {verdict}: {' '.join(rows)}"
                    for verdict, rows in by_verdict(results).items()))


def parse(arguments):
    parser = argparse.ArgumentParser(prog="run.sh")
    parser.add_argument("--build", required=True, help="folder with the programs")
    parser.add_argument("--json", action="store_true", help="JSON instead of a table")
    parser.add_argument("--smoke", action="store_true", help="few frames, once: does it work?")
    parser.add_argument("--bus", help="a CAN interface that is up")
    parser.add_argument("--results", help=argparse.SUPPRESS)  # rows on the bus only, to this file
    names = [row.name for row in ON_BUS + HERE]
    parser.add_argument("rows", nargs="*", metavar="ROW", help="only these: " + " ".join(names))
    options = parser.parse_args(arguments)
    unknown = set(options.rows) - set(names)
    if unknown:
        parser.error(f"there is no row {' '.join(sorted(unknown))}")
    return options


def main(arguments):
    options = parse(arguments)
    if options.results:
        bench = Bench(options.build, options.bus, options.smoke)
        with open(options.results, "w", encoding="utf-8") as file:
            for row in ON_BUS:
                for result in run_rows([row], bench, options.rows):
                    print(json.dumps(result), file=file, flush=True)
        return 0
    results, place = measure(options)
    if options.json:
        json.dump({"bus": place, "rows": results}, sys.stdout, indent=2)
        print()
    else:
        print_table(results, place)
    return exit_code(results, options.smoke)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
