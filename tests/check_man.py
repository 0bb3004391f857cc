#!/usr/bin/env python3
"""Each tool tells its options, and its manual page has the same ones.

    check_man.py TOOLS [--root DIR]

TOOLS is the folder of the programs. A verb of mcanopen is a tool with a page mcanopen-VERB.1.
"""
import argparse
import re
import subprocess
import sys
from pathlib import Path

TOOLS = ("ccfread", "dcf2ccf", "dcftest", "mcanopen")
SECTIONS = ("NAME", "SYNOPSIS", "DESCRIPTION", "FILES", "EXIT STATUS", "EXAMPLES", "DIAGNOSTICS",
            "SEE ALSO", "STANDARDS")
NO_STATUS = {5}  # files have none
SAME_WORDS = {"--help": "shows this", "--version": "shows the version"}
OPTION = re.compile(r" {2,6}((?:-\w, )?--[\w-]+|-\w\b)(?: ?\S+)*?(?:  +(.*))?$")


def run(command):
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          timeout=20, check=False)
    return done.returncode, done.stdout, done.stderr


# ---- what a tool says ------------------------------------------------------------------------

def options_of(text):
    """{long or only name: (short name or None, its words)} of a text of --help."""
    options = {}
    for line in text.splitlines():
        found = OPTION.match(line)
        if found:
            names = found.group(1).split(", ")
            options[names[-1]] = (names[0] if len(names) == 2 else None, found.group(2) or "")
    return options


def names_of(options):
    return set(options) | {short for short, _ in options.values() if short}


def codes_of(text):
    """The exit codes that --help tells."""
    found = re.search(r"^Exit codes: (.*)", text, re.MULTILINE | re.DOTALL)
    return set(re.findall(r"(?:^|[,;] )(?:\S+ )?(\d)(?= )", found.group(1).replace("\n", " "))) \
        if found else set()


def verbs_of(text):
    """In the order of the list."""
    return list(dict.fromkeys(re.findall(r"^  (\w+) [A-Z-]", text, re.MULTILINE)))


def behaviour(command, text):
    """Help where nothing is given, on request, and the version."""
    name = " ".join([Path(command[0]).name, *command[1:]])
    if not text.startswith(f"Usage: {name} "):
        yield f"{name}: --help: expected to begin with \"Usage: {name} \""
    for words, expected in (((), (2, "", text)), (("-h",), (0, text, ""))):
        if run([*command, *words]) != expected:
            yield (f"{name} {' '.join(words) or 'alone'}: the help expected on "
                   f"{'stdout' if words else 'stderr'}, and exit code {expected[0]}")
    code, out, err = run([*command, "--version"])
    if code != 0 or err or not re.fullmatch(rf"{name.split()[0]} \d+\.\d+\.\d+\n", out):
        yield f"{name} --version: name and version expected, there is {out + err!r}"
    for option, words in SAME_WORDS.items():
        if options_of(text).get(option, ("", ""))[1] != words:
            yield f"{name}: --help: {option}: \"{words}\" expected"


# ---- what a page says ------------------------------------------------------------------------

def page_options(page):
    """The options that have an item of their own."""
    names = set()
    for item in re.findall(r"^\.It (.*)$", page, re.MULTILINE):
        names |= flags_of(item)
    return names


def flags_of(line):
    names, is_flag = set(), False
    for word in line.split():
        if word in ("Fl", "Ar", "Cm", "Op", "Ns", "Pa", "Ev", "Sy", "Li"):
            is_flag = word == "Fl"
        elif is_flag and re.match(r"-?\w", word):
            names.add(f"-{word}")
    return names


def named_options(page):
    """Those that are named anywhere: -qv are two."""
    names = set()
    for line in page.splitlines():
        if line.startswith(".") and not line.startswith('.\\"'):
            names |= flags_of(line)
    for name in list(names):
        if not name.startswith("--") and len(name) > 2:
            names.remove(name)
            names |= {f"-{letter}" for letter in name[1:]}
    return names


def page_codes(page):
    part = re.search(r"^\.Sh EXIT STATUS\n(.*?)(?=^\.Sh )", page, re.MULTILINE | re.DOTALL)
    return set(re.findall(r"^\.It (\d)$", part.group(1), re.MULTILINE)) if part else set()


def section_findings(path, page):
    number = int(path.suffix[1:])
    sections = re.findall(r"^\.Sh (.*)$", page, re.MULTILINE)
    for name in SECTIONS:
        if name not in sections and not (name == "EXIT STATUS" and number in NO_STATUS):
            yield f"{path.name}: .Sh {name} expected"
    for name, section in re.findall(r"^\.Xr (mcanopen\S*|ccfread|dcf\w+) (\d)", page, re.MULTILINE):
        if name != "dcfgen" and not (path.parent / f"{name}.{section}").exists():
            yield f"{path.name}: .Xr {name} {section}: there is no such page"


# ---- both ------------------------------------------------------------------------------------

def compare(name, text, path):
    if not path.exists():
        yield f"{name}: a manual page expected, there is no {path.name}"
        return
    page = path.read_text(encoding="utf-8")
    told = names_of(options_of(text))
    for option in sorted(told - page_options(page)):
        yield f"{path.name}: {option} expected, as --help has it"
    for option in sorted((page_options(page) | named_options(page)) - told):
        yield f"{path.name}: {option} is not in --help"
    if "Exit codes:" in text and codes_of(text) != page_codes(page):
        yield (f"{path.name}: EXIT STATUS: {' '.join(sorted(codes_of(text)))} expected, there is "
               f"{' '.join(sorted(page_codes(page)))}")


def one_name(told):
    """The short name of a long option is the same one in all tools that have one."""
    shorts = {}
    for name, text in told.items():
        for option, (short, _) in options_of(text).items():
            first, by = shorts.setdefault(option, (short, name)) if short else (None, None)
            if short != first:
                yield f"{name}: --help: {option} is {short}, in {by} {first}"


def commands_of(tools):
    for name in TOOLS:
        yield name, [str(tools / name)]
        for verb in verbs_of(run([str(tools / name), "--help"])[1]):
            yield f"{name} {verb}", [str(tools / name), verb]


def findings(tools, root):
    man = root / "docs" / "man"
    told = {}
    for name, command in commands_of(tools):
        told[name] = run([*command, "--help"])[1]
        yield from behaviour(command, told[name])
        yield from compare(name, told[name], man / f"{name.replace(' ', '-')}.1")
    yield from one_name(told)
    for path in sorted(man.iterdir()):
        yield from section_findings(path, path.read_text(encoding="utf-8"))
        if path.suffix == ".1" and path.stem.replace("-", " ") not in told:
            yield f"{path.name}: a page of no tool"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("tools", type=Path)
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parent.parent)
    arguments = parser.parse_args()
    found = list(findings(arguments.tools, arguments.root))
    for line in found:
        print(line)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
