#!/usr/bin/env python3
"""The libraries export the names of the version script, all of them and no others.

    check_exports.py MAP LIBRARY...        LIBRARY: a shared object or a static archive
"""
import re
import subprocess
import sys

COMMENT = re.compile(r"/\*.*?\*/|#[^\n]*", re.S)


def names_of_map(text):
    """The names behind global:, written out: a wildcard would hide what is missing."""
    names, scope = set(), None
    for token in re.findall(r"[\w.*?\[\]]+|[{}]", COMMENT.sub(" ", text)):
        if token in ("global", "local"):
            scope = token
        elif token in "{}":
            scope = "global" if token == "{" else None
        elif scope == "global" and not token.isidentifier():
            raise ValueError(f"{token}: write the names out")
        elif scope == "global":
            names.add(token)
    return names


def names_of_library(library):
    command = ["nm", "-g", "--defined-only", "--format=posix"]
    if ".so" in library.rsplit("/", 1)[-1]:
        command.insert(1, "-D")
    text = subprocess.run(command + [library], check=True, capture_output=True, text=True).stdout
    found = (line.split() for line in text.splitlines())
    return {f[0].split("@")[0] for f in found if len(f) > 1 and f[1] != "A"}


def check(map_names, library):
    actual = names_of_library(library)
    findings = [f"{library}: exports {name}" for name in sorted(actual - map_names)]
    return findings + [f"{library}: lacks {name}" for name in sorted(map_names - actual)]


def main(arguments):
    if len(arguments) < 2:
        print(__doc__.strip())
        return 2
    with open(arguments[0], encoding="utf-8") as file:
        names = names_of_map(file.read())
    findings = [f for library in arguments[1:] for f in check(names, library)]
    for finding in findings:
        print(finding)
    print(f"check_exports: {len(names)} names in the map, {len(findings)} findings")
    return 1 if findings or not names else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
