#!/usr/bin/env python3
"""Every public name, and every element of the manager's file, stands in tests/contract.tsv.

    check_contract.py [--root DIR]

Both ways: each name of the headers and of the file's reader has exactly one row, and each row a
name that is there (see contract.py). The test has to exist, and its source to use the name: the
function, the error code, the member, the constant, the element.
"""
import argparse
import re
import sys
from pathlib import Path

import contract

TABLE = "tests/contract.tsv"
FOLDERS = ("tests", "tests/scenario", "tests/vcan")
CASE = re.compile(r"\bSTART_TEST\((\w+)\)")


class Sources:
    """The test programs' sources, each with the helpers that it includes."""

    def __init__(self, root):
        self.root = root
        self.texts = {}

    def text(self, program):
        """None: there is no such program."""
        if program not in self.texts:
            paths = (self.root / f / f"{program}.c" for f in FOLDERS)
            path = next((p for p in paths if p.exists()), None)
            self.texts[program] = path and path.read_text(encoding="utf-8")
        return self.texts[program]

    def uses(self, program, word):
        texts = [self.text(program)] + self.helpers(self.text(program), set())
        return any(re.search(rf"\b{word}\b", t) for t in texts)

    def helpers(self, text, known):
        """The texts of what is included from tests/support, and of what that includes."""
        texts = []
        for name in set(re.findall(r'"support/(\w+)\.h"', text)) - known:
            known.add(name)
            paths = (self.root / "tests" / "support" / f"{name}.{end}" for end in "hc")
            own = [p.read_text(encoding="utf-8") for p in paths if p.exists()]
            texts += own + [h for t in own for h in self.helpers(t, known)]
        return texts


def check_test(row, sources):
    """What is wrong with the test of a row, one text at most."""
    program, _, case = row.test.partition(":")
    text = sources.text(program)
    if text is None:
        return f"there is no test program {program}"
    if case not in CASE.findall(text):
        return f"{program} has no test {case or '(none named)'}"
    words = re.split(r"[./ ]", row.name)
    words = words[1:] if row.kind in ("member", "element") else words
    missing = [w for w in words if not sources.uses(program, w)]
    return f"{program} does not use {missing[0]}" if missing else None


def check_row(row, names, sources):
    if (row.kind, row.name) not in names:
        return f"{row.kind} {row.name} is nowhere"
    if row.has_test:
        return check_test(row, sources)
    return None if row.remark else f"{row.name}: '{row.test}' needs a remark"


def check_rows(rows, names, sources):
    seen = set()
    for row in rows:
        finding = check_row(row, names, sources)
        if (row.kind, row.name) in seen:
            finding = f"{row.kind} {row.name} has another row"
        seen.add((row.kind, row.name))
        if finding:
            yield f"{TABLE}:{row.line}: {finding}"
    for kind, name in sorted(names - seen):
        yield f"{TABLE}: lacks {kind} {name}"


def main(arguments):
    parser = argparse.ArgumentParser()
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parent.parent)
    root = parser.parse_args(arguments).root
    names = contract.all_names(root)
    rows = contract.parse_rows((root / TABLE).read_text(encoding="utf-8"))
    findings = list(check_rows(rows, names, Sources(root)))
    print("\n".join(findings))
    counts = {test: sum(row.test == test for row in rows) for test in ("later", "none")}
    print(f"check_contract: {len(rows)} names, {counts['later']} for later, {counts['none']} "
          f"without test, {len(findings)} findings")
    return 1 if findings or not names else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
