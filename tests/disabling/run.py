#!/usr/bin/env python3
"""The disabling run: a test that does not notice that its function is gone is none.

    run.py BUILD [NAME...]           BUILD: the folder of a build with tests, build/debug;
                                     NAME: of a function or an element, only these

For each function of tests/contract.tsv, the tests named for it and for its errors are run alone
with that function disabled, so that it returns "not implemented" (see make_switches.py); for each
element of the manager's XML file with the reader keeping its default (elements.c): each must fail.
Without that each must pass. The last line is the sum of both.
"""
import os
import re
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

TESTS = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(TESTS))
import contract  # noqa: E402, found there

LIMIT = 20  # seconds; a test that waits for a disabled function without an end is a bad test
# Of the time limits of the tests themselves, most of which are 60 s: many an effect is waited for.
PATIENCE, PATIENCE_DISABLED = "10", "0.07"
TRIES = 3  # what passes without its function is run again: on a busy machine time may pass as well
WORKERS = 4 * (os.cpu_count() or 1)  # these tests wait more than they work
CHECKS = re.compile(r"^\d+%: Checks: (\d+), Failures: (\d+), Errors: (\d+)$", re.M)


def pairs_of(rows):
    """The (function, test) of all rows that have both, each once; function None: not disabled."""
    found = {(row.name.split()[0], row.test) for row in rows
             if row.kind in ("function", "error", "element") and row.has_test}
    return sorted(found) + [(None, test) for test in sorted({t for _, t in found})]


def run_test(build, function, test):
    """The output, or None when it did not end in time."""
    program, _, case = test.partition(":")
    environment = dict(os.environ, TEST_ONLY=case, CK_TIMEOUT_MULTIPLIER=PATIENCE)
    environment.pop("MCANOPEN_DISABLE", None)
    if function:
        environment.update(MCANOPEN_DISABLE=function, CK_TIMEOUT_MULTIPLIER=PATIENCE_DISABLED)
    try:
        done = subprocess.run([str(build / "tests" / program)], env=environment, text=True,
                              capture_output=True, timeout=LIMIT, check=False)
    except subprocess.TimeoutExpired:
        return None
    return done.stdout + done.stderr


def judge(function, test, output):
    """None, or what is wrong with this run."""
    if output is None:
        return f"{test}: not over after {LIMIT} s" + (f" without {function}" if function else "")
    counts = CHECKS.search(output)
    if not counts or counts.group(1) == "0":
        return f"{test}: did not run: {output.strip() or 'no output'}"
    failed = int(counts.group(2)) + int(counts.group(3))
    if function and not failed:
        return f"{test}: passes without {function}"
    return f"{test}: fails:\n{output.strip()}" if failed and not function else None


def verdict_of(build, function, test):
    """None, or what is wrong."""
    for _ in range(TRIES):
        verdict = judge(function, test, run_test(build, function, test))
        if not verdict or not function:
            break
    return verdict


def remove_buses(begin):
    """Those of the virtual buses that belong to tests that have failed."""
    for path in Path("/dev/shm").glob(f"mcanopen-{os.getuid()}-*"):
        process = re.fullmatch(r"mcanopen-\d+-(?:api|scan)-(\d+)-.*", path.name)
        if process and not Path("/proc", process.group(1)).exists():
            if path.stat().st_mtime >= begin:
                path.unlink(missing_ok=True)


def main(arguments):
    if not arguments:
        print(__doc__.strip())
        return 2
    build, only = Path(arguments[0]), set(arguments[1:])
    rows = contract.parse_rows((TESTS / "contract.tsv").read_text(encoding="utf-8"))
    pairs = [p for p in pairs_of(rows) if not only or p[0] in only]
    begin, begin_date = time.monotonic(), time.time()
    with ThreadPoolExecutor(WORKERS) as pool:
        verdicts = list(pool.map(lambda p: verdict_of(build, *p), pairs))
    remove_buses(begin_date)
    findings = [v for v in verdicts if v]
    print("\n".join(findings))
    print(f"disabling run: {len({f for f, _ in pairs if f})} functions and elements, "
          f"{len(pairs)} runs, {time.monotonic() - begin:.1f} s")
    print(f"{len(pairs) - len(findings)} passed, {len(findings)} failed")
    return 1 if findings or not pairs else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
