#!/usr/bin/env python3
"""Every message about EDS and DCF files has its rule, and every rule has its message.

    check_rules.py [--root DIR]

The rules stand in src/dcf/dcf_rules.def. Files of src/dcf tell them by dcf_tell(); only concise
DCFs, which are no text, are beyond them.
"""
import argparse
import re
import sys
from pathlib import Path

RULES = "src/dcf/dcf_rules.def"
WITHOUT = {"ccf.c"}
RULE = re.compile(r"^DCF_RULE\((\w+),\s*\"([^\"]*)\"", re.MULTILINE)


def findings(root):
    texts = {path: path.read_text(encoding="utf-8") for path in sorted(root.glob("src/*/*.c"))}
    for path, text in texts.items():
        if path.parent.name == "dcf" and path.name not in WITHOUT and "co_report_add(" in text:
            yield f"{path.relative_to(root)}: co_report_add(): dcf_tell() expected"
    everything = "\n".join(texts.values())
    for rule, name in RULE.findall((root / RULES).read_text(encoding="utf-8")):
        if not re.search(rf"\bDCF_RULE_{rule}\b", everything):
            yield f"{RULES}: {rule}: nobody tells it"
        if name != rule.lower().replace("_", "-"):
            yield f"{RULES}: {rule}: its name is expected alike, it is {name}"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parent.parent)
    found = list(findings(parser.parse_args().root))
    for line in found:
        print(line)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
