#!/usr/bin/env python3
"""Every message about networks and buses has its row in docs/real-hardware.md.

    check_messages.py [--root DIR]

A message's stable part is the longest piece of its text between the places that vary ("%s"). It
must stand in the first column of a table. Texts of a single word are not looked for: they say
nothing by themselves.
"""
import argparse
import re
import sys
from pathlib import Path

PAGE = "docs/real-hardware.md"
SOURCES = ("src/manager/boot_text*.c", "src/api/control.c", "src/api/event_text.c",
           "src/api/mcanopen.c", "src/api/nets.c", "src/api/scan_e*.c", "src/port/*.c")
STRING = re.compile(r'"((?:\\.|[^"\\])*)"')
# Adjacent strings, and what may have quotes in it but is no message: whichever begins first.
TOKEN = re.compile(rf"{STRING.pattern}(?:\s*{STRING.pattern})*"
                   r"|/\*.*?\*/|'(?:\\.|[^\\'])+'|^#.*?$|_Static_assert\(.*?;",
                   re.DOTALL | re.MULTILINE)
CONVERSION = re.compile(r"%[-+ #0]*(?:\d+|\*)?(?:\.(?:\d+|\*))?(?:hh|h|ll|l|z)?[a-zA-Z]")
WORDS = re.compile(r"[A-Za-z]{2,} +[A-Za-z(]")


def texts_of(source):
    for token in TOKEN.finditer(source):
        if token.group().startswith('"'):
            parts = STRING.findall(token.group())
            yield "".join(parts).replace('\\"', '"').replace("\\n", " ")


def normal(text):
    return re.sub(r"\s+", " ", text).strip()


def stable_part(text):
    """None: nothing that a person could look for."""
    pieces = [normal(piece) for piece in CONVERSION.split(text)]
    longest = max(pieces, key=len)
    return longest.strip(' ":;,') if WORDS.search(longest) else None


def first_columns(page):
    """The text of the first column of each table row, one line each."""
    rows = [line for line in page.splitlines() if line.startswith("|")]
    columns = (row.replace("\\|", "\0").split("|")[1] for row in rows)
    return "\n".join(normal(column.replace("`", "")) for column in columns)


def findings(root):
    known = first_columns((root / PAGE).read_text(encoding="utf-8"))
    for pattern in SOURCES:
        for path in sorted(root.glob(pattern)):
            for text in texts_of(path.read_text(encoding="utf-8")):
                part = stable_part(text)
                if part and part not in known:
                    yield f'{path.relative_to(root)}: "{part}" has no row in {PAGE}'


def main(arguments):
    parser = argparse.ArgumentParser()
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parent.parent)
    found = list(findings(parser.parse_args(arguments).root))
    print("\n".join(found + [f"check_messages: {len(found)} findings"]))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
