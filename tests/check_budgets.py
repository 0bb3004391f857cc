#!/usr/bin/env python3
"""The budgets of function and file sizes as a test, measured by lizard.

    check_budgets.py [--root DIR]

lizard is a package of PyPI. tests/run.sh puts it into build/venv; by hand:
    python3 -m venv build/venv && build/venv/bin/pip install -r tests/requirements.txt
MCANOPEN_VENV names another place. Without lizard this test fails.
"""
import argparse
import os
import statistics
import sys
from pathlib import Path

import nesting

FOLDERS = ("src", "tools", "tests", "examples")
SUFFIXES = (".c", ".h", ".py", ".sh")
MAX_LINES, MEDIAN_LINES, P95_LINES = 60, 12, 40
MAX_COMPLEXITY, MAX_NESTING, MAX_PARAMETERS = 12, 4, 6
MAX_FILE_LINES, MAX_COLUMNS = 600, 100
API_PREFIXES = ("mcanOpen", "canOpen")  # signatures that the manual fixes
PERCENTILE_FROM = 20  # so few functions have no meaningful median


def venv_folder(root):
    return Path(os.environ.get("MCANOPEN_VENV", root / "build" / "venv"))


def load_lizard(root):
    """The module, from here or from the venv; None when there is none."""
    for folder in sorted(venv_folder(root).glob("lib/python3*/site-packages")):
        sys.path.append(str(folder))
    try:
        import lizard
    except ImportError:
        return None
    return lizard


def source_files(root, folder):
    return sorted(p for p in (root / folder).rglob("*")
                  if p.suffix in SUFFIXES and p.is_file() and not {"data", "corpus"} & set(p.parts))


def nesting_of(path, text):
    """A function that tells the nesting of a function that lizard has found in this text."""
    if path.suffix == ".py":
        depths = nesting.python_nesting(text)
        return lambda function: depths[function.start_line]
    lines = text.splitlines()
    return lambda function: nesting.c_nesting(
        "\n".join(lines[function.start_line - 1:function.end_line]))


def functions_of(lizard, path):
    """The functions of a file, each with its nesting."""
    functions = lizard.analyze_file(str(path)).function_list
    depth_of = nesting_of(path, path.read_text(encoding="utf-8"))
    for function in functions:
        function.nesting = depth_of(function)
    return functions


def function_findings(path, function):
    place = f"{path}:{function.start_line}: {function.name}"
    parameters = len(function.full_parameters)
    if function.length > MAX_LINES:
        yield f"{place}: {function.length} lines, budget {MAX_LINES}"
    if function.cyclomatic_complexity > MAX_COMPLEXITY:
        yield f"{place}: complexity {function.cyclomatic_complexity}, budget {MAX_COMPLEXITY}"
    if function.nesting > MAX_NESTING:
        yield f"{place}: nesting {function.nesting}, budget {MAX_NESTING}"
    if parameters > MAX_PARAMETERS and not function.name.startswith(API_PREFIXES):
        yield f"{place}: {parameters} parameters, budget {MAX_PARAMETERS}"


def file_findings(path, shown):
    lines = path.read_text(encoding="utf-8").splitlines()
    if len(lines) > MAX_FILE_LINES:
        yield f"{shown}:{MAX_FILE_LINES + 1}: {len(lines)} lines, budget {MAX_FILE_LINES}"
    for number, line in enumerate(lines, 1):
        if len(line) > MAX_COLUMNS:
            yield f"{shown}:{number}: {len(line)} columns, budget {MAX_COLUMNS}"


def percentile(sorted_values, percent):
    return sorted_values[max(0, -(-len(sorted_values) * percent // 100) - 1)]


def spread_findings(name, lengths):
    """Median and 95th percentile of the lengths of these functions."""
    lengths = sorted(lengths)
    if len(lengths) < PERCENTILE_FROM:
        return
    median, p95 = statistics.median(lengths), percentile(lengths, 95)
    print(f"{name}: {len(lengths)} functions, lines: median {median:g}, p95 {p95},"
          f" max {lengths[-1]}")
    if median > MEDIAN_LINES:
        yield f"{name}: median of {median:g} lines, budget {MEDIAN_LINES}"
    if p95 > P95_LINES:
        yield f"{name}: 95th percentile of {p95} lines, budget {P95_LINES}"


def check_folder(lizard, root, folder):
    findings, lengths = [], []
    for path in source_files(root, folder):
        shown = path.relative_to(root)
        findings += file_findings(path, shown)
        if path.suffix == ".sh":
            continue
        for function in functions_of(lizard, path):
            findings += function_findings(shown, function)
            lengths.append(function.length)
    return findings, lengths


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parent.parent)
    root = parser.parse_args(arguments).root
    lizard = load_lizard(root)
    if lizard is None:
        print("check_budgets: lizard is missing. Run sh tests/run.sh, or:"
              " python3 -m venv build/venv && build/venv/bin/pip install -r tests/requirements.txt")
        return 2
    findings, all_lengths = [], []
    for folder in FOLDERS:
        found, lengths = check_folder(lizard, root, folder)
        findings += found
        all_lengths += lengths
        if folder == "src":
            findings += spread_findings(folder, lengths)
    findings += spread_findings("all", all_lengths)
    for finding in findings:
        print(finding)
    print(f"check_budgets: {len(findings)} findings")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
