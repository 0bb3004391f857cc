#!/usr/bin/env python3
"""Fills in what the manual pages have from elsewhere: rules of the tools, elements of the XML file.

    make_man.py TOOLS           writes it; TOOLS is the folder of the programs (build/debug/tools)
    make_man.py TOOLS --check   tells which pages are not as they would be written (exit code 1)

The pages are docs/man/*; all but what stands between the comments "made by make_man.py" and
"end of it" is written by hand.
"""
import json
import re
import subprocess
import sys
from pathlib import Path

from make_schema import PAGE as NETWORK_PAGE

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
MAN = HERE / "man"
BEGIN = '.\\" made by make_man.py: '
END = '.\\" end of it\n'
OURS = "addition of mcanopen"


def text(words):
    """A line of running text: nothing of it is a request or an escape."""
    words = words.replace("\\", "\\e")
    return ("\\&" if words.startswith((".", "'")) else "") + words


# ---- rules -----------------------------------------------------------------------------------

def rules_of(command):
    return json.loads(subprocess.run([*command, "--list-rules", "--json"], check=True,
                                     stdout=subprocess.PIPE).stdout)


def groups_of(path):
    """The heading above each rule in a list of them."""
    groups, heading = {}, None
    for line in path.read_text(encoding="utf-8").splitlines():
        found = re.match(r"/\* (?:--- )?(.*?)(?: ---)? \*/$", line)
        if found:
            heading = found.group(1)[0].upper() + found.group(1)[1:]
        found = re.match(r'\w+_RULE\(\w+,\s*"([^"]+)"', line)
        if found:
            groups[found.group(1)] = heading
    return groups


def rule_lines(rule):
    code = f"; {rule['code']}" if rule["severity"] == "error" and rule.get("code") else ""
    yield f".It Sy {rule['name']} Pq {rule['severity']}"
    yield text(rule["text"])
    yield text(f"[{rule['clause']}{code}]")


def rule_list(rules, groups, first, last):
    heading, is_open = first, False
    for rule in rules:
        group = groups.get(rule["name"], last) or first
        if group != heading or not is_open:
            if is_open:
                yield ".El"
            yield f".Ss {group}"
            yield ".Bl -tag -width Ds"
            heading, is_open = group, True
        yield from rule_lines(rule)
    if is_open:
        yield ".El"


def rules_of_files(tools):
    groups = groups_of(ROOT / "src/dcf/dcf_rules.def")
    return rule_list(rules_of([tools / "dcftest"]), groups, "The text", "Other")


def rules_of_networks(tools):
    """Without those of the files of devices."""
    of_files = {rule["name"] for rule in rules_of([tools / "dcftest"])}
    rules = [rule for rule in rules_of([tools / "mcanopen", "check"])
             if rule["name"] not in of_files]
    return rule_list(rules, groups_of(ROOT / "tools/audit/audit_rules.def"), "The network", "Files")


# ---- elements --------------------------------------------------------------------------------

def plain(markdown):
    """Markdown as mdoc: code in bold, links as what they are called."""
    words = re.sub(r"see \[below\]\(#[\w-]+\)", r"see docs/network-xml.md", markdown)
    words = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", words)
    return re.sub(r"`([^`]*)`", r"\\fB\1\\fR", words.replace("\\", "\\e")).replace("**", "")


def element_lines(cells):
    name, kind, span, default, *_, meaning = cells
    ours = f" ({OURS})" if "*(ours)*" in name else ""
    parts = [kind, plain(span)] if span else [kind]
    parts.append("mandatory" if default == "**must**" else
                 "no default" if default == "-" else f"default {plain(default)}")
    yield f".It Li {re.match('`(.*?)`', name).group(1)}"
    yield f"{', '.join(parts)}{ours}."
    for sentence in re.split(r"(?<=\w[.])\s(?=[A-Z])", plain(meaning)):
        yield ("\\&" if sentence.startswith((".", "'")) else "") + sentence


def elements_of(parent):
    page = NETWORK_PAGE.read_text(encoding="utf-8")
    part = page.split(f"## Elements of `<{parent}>`\n", 1)[1].split("\n## ", 1)[0]
    yield ".Bl -tag -width Ds"
    for line in part.splitlines():
        if line.startswith("| `"):
            yield from element_lines([cell.strip() for cell in line.strip("| ").split(" |")])
    yield ".El"


# ---- pages -----------------------------------------------------------------------------------

PARTS = {
    "rules of files": rules_of_files,
    "rules of networks": rules_of_networks,
    "elements of Manager_Instance": lambda tools: elements_of("Manager_Instance"),
    "elements of Node_Instance": lambda tools: elements_of("Node_Instance"),
}


def made(page, tools):
    """A page with its parts as they are to be."""
    def part(found):
        return found[1] + "\n".join(PARTS[found[2]](tools)) + "\n" + END

    return re.sub(f"({re.escape(BEGIN)}([^\n]*)\n).*?{re.escape(END)}", part, page, flags=re.DOTALL)


def main(arguments):
    tools, check = Path(arguments[0]), arguments[1:] == ["--check"]
    stale = 0
    for path in sorted(MAN.iterdir()):
        page = path.read_text(encoding="utf-8")
        wanted = made(page, tools)
        if wanted == page:
            continue
        stale += 1
        if check:
            print(f"{path.relative_to(ROOT)}: not as docs/make_man.py writes it: run it")
        else:
            path.write_text(wanted, encoding="utf-8")
            print(f"{path.relative_to(ROOT)}: written")
    return 1 if check and stale else 0


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1:]))
