#!/usr/bin/env python3
"""What dcftest says to each real file, kept as text: who changes it sees what changes.

    test_corpus_messages.py --update    writes tests/data/corpus_messages.txt anew; read it through

Of a rule that a file breaks several times the first message is kept, with their number and a sum
of all of them. The corpus is no part of the project; without it this is reported as not run.
"""
import difflib
import re
import sys
import unittest
import zlib

import plant
from dcftest import CLEAN, ERRORS, DcftestTest

KEPT = plant.DATA / "corpus_messages.txt"
UPDATE = "python3 tests/system/test_corpus_messages.py --update"
LINE = re.compile(r"(?P<file>.+?\.(?:eds|dcf)):(?P<text>\d+: \w+: .* \[(?P<rule>[a-z0-9-]+)\])")


def names():
    return sorted(str(path.relative_to(plant.CORPUS)) for path in plant.CORPUS.rglob("*")
                  if path.suffix.lower() in (".eds", ".dcf"))


def summarize(lines):
    """{file: [a text for each rule, in the order of their first lines]}"""
    found = {}
    for line in lines:
        match = LINE.fullmatch(line)
        if not match:
            raise ValueError(f"this is no message about a file of the corpus: {line}")
        found.setdefault(match["file"], {}).setdefault(match["rule"], []).append(match["text"])
    return {file: [summary(texts) for texts in rules.values()] for file, rules in found.items()}


def summary(texts):
    if len(texts) == 1:
        return texts[0]
    return f"{texts[0]} x{len(texts)} {zlib.crc32('/'.join(texts).encode()):08x}"


@unittest.skipUnless(plant.CORPUS.is_dir(), f"no corpus in {plant.CORPUS}")
class Messages(DcftestTest):
    def collect(self):
        """A line for each file, and below it those of its messages."""
        done = self.run_tool("-j", "1", plant.CORPUS)
        self.assertIn(done.returncode, (CLEAN, ERRORS), done.err)
        told = summarize(line.removeprefix(f"{plant.CORPUS}/") for line in done.out.splitlines())
        return [line for file in names()
                for line in [file, *(f"  {text}" for text in told.get(file, []))]]

    def test_as_kept(self):
        """dcftest says to real files what it said"""
        kept = KEPT.read_text(encoding="utf-8").splitlines()
        told = self.collect()
        changes = list(difflib.unified_diff(kept, told, "kept", "told", n=0, lineterm=""))
        plant.say(f"{len(names())} files, {len(told) - len(names())} kinds of messages")
        if changes:
            self.fail("\n".join(["", *changes, f"where this is right: {UPDATE}"]))


def update():
    test = Messages("collect")
    test.setUp()
    KEPT.write_text("\n".join(test.collect()) + "\n", encoding="utf-8")
    test.doCleanups()


if __name__ == "__main__":
    if sys.argv[1:] == ["--update"]:
        update()
    else:
        plant.main()
