#!/usr/bin/env python3
"""The public headers and the version script name the same functions and tables.

    check_prototypes.py MAP HEADERS        HEADERS: the folder of the public headers

Every declaration must also begin with MCANOPEN_API: without it the symbol stays hidden.
"""
import pathlib
import re
import sys

from check_exports import names_of_map

COMMENT = re.compile(r"/\*.*?\*/", re.S)
DIRECTIVE = re.compile(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", re.M)
DECLARED = re.compile(r"\bMCANOPEN_API\b([^;(\[]*?)(\w+)\s*[(\[][^;]*;")
PROTOTYPE = re.compile(r"^[a-z][\w *]*?\b(\w+)\([^;{}]*\);", re.M)


def names_of_header(text):
    """The names that a header declares for export, and those that it declares without."""
    text = DIRECTIVE.sub("", COMMENT.sub(" ", text))
    declared = {match.group(2) for match in DECLARED.finditer(text)}
    rest = DECLARED.sub("", text)
    hidden = {m.group(1) for m in PROTOTYPE.finditer(rest) if not m.group(0).startswith("typedef")}
    return declared, hidden


def check(map_text, headers):
    """headers: texts by name. A list of findings, and the number of names."""
    in_map, in_headers, findings = names_of_map(map_text), set(), []
    for header, text in sorted(headers.items()):
        declared, hidden = names_of_header(text)
        findings += [f"{header}: {name} lacks MCANOPEN_API" for name in sorted(hidden)]
        findings += [f"{header}: {name} is not in the map" for name in sorted(declared - in_map)]
        in_headers |= declared
    findings += [f"map: {name} is in no header" for name in sorted(in_map - in_headers)]
    return findings, len(in_map)


def main(arguments):
    if len(arguments) != 2:
        print(__doc__.strip())
        return 2
    map_text = pathlib.Path(arguments[0]).read_text(encoding="utf-8")
    paths = pathlib.Path(arguments[1]).glob("*.h")
    headers = {path.name: path.read_text(encoding="utf-8") for path in paths}
    findings, count = check(map_text, headers)
    for finding in findings:
        print(finding)
    print(f"check_prototypes: {count} names in the map, {len(findings)} findings")
    return 1 if findings or not count or not headers else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
