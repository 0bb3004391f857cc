#!/usr/bin/env python3
"""Mutants: small faults that are put into the manager and the protocol machines, one at a time.

    run.py BUILD [WORD...]       BUILD: the folder of a build with tests, build/debug
                                 WORD: only the mutants with this in their first line

mutants.txt lists them: what is broken, the test that has to notice, the text before and after. Each
is compiled alone and linked with the named test program in front of the library; the named test
must fail, and pass without the fault. A mutant that survives, or whose text is not there (once) any
more, is an error. The last line is the sum of both.
"""
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
import time
from collections import namedtuple
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

TESTS = Path(__file__).resolve().parent.parent
ROOT = TESTS.parent
FOLDERS = ("src/manager", "src/proto")
LIMIT = 60  # seconds for one program
FAILED = re.compile(r":[FE]:[^:]*:(\w+):\d+: ")

Mutant = namedtuple("Mutant", "name program test before after")


class Bad(Exception):
    """What is wrong with a mutant."""


def parse(text):
    """The mutants of a list; blocks of lines with an empty one between them, # for comments."""
    lines = "\n".join(line for line in text.splitlines() if not line.startswith("#"))
    blocks = re.split(r"\n\s*\n", lines)
    return [parse_block(block.splitlines()) for block in blocks if block.strip()]


def parse_block(block):
    lines = [line for line in block if line.strip()]
    parts = {"by": [], "-": [], "+": []}
    for line in lines[1:]:
        key, _, rest = line.strip().partition(" ")
        if key not in parts:
            raise SystemExit(f"mutants.txt: {lines[0]}: neither by, - nor +: {line}")
        parts[key].append(rest)
    program, _, test = "".join(parts["by"]).partition(":")
    return Mutant(lines[0].strip(), program, test, " ".join(parts["-"]), " ".join(parts["+"]))


def pattern_of(text):
    """The text with any white space between its words."""
    return re.compile(r"\s+".join(re.escape(word) for word in text.split()))


def find(mutant, sources):
    """The one source file that has the text, and its text with the fault."""
    pattern = pattern_of(mutant.before)
    hits = [(path, text) for path, text in sources.items() if pattern.search(text)]
    if len(hits) != 1 or len(pattern.findall(hits[0][1])) != 1:
        raise Bad(f"does not apply: its text is in {[str(p) for p, _ in hits] or 'no file'}")
    path, text = hits[0]
    return path, pattern.sub(lambda _: mutant.after, text)


def run(command, what, **options):
    done = subprocess.run(command, text=True, capture_output=True, check=False, **options)
    if done.returncode != 0:
        raise Bad(f"{what}:\n{done.stdout}{done.stderr}")
    return done.stdout


def compile_command(build, source, mutated, output):
    """As the source is compiled in the build, without warnings: the fault may cause one."""
    entries = json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))
    entry = next(e for e in entries if Path(e["file"]) == source)
    words = shlex.split(entry["command"])
    words[words.index("-o") + 1] = str(output)
    return [str(mutated) if Path(word) == source else word for word in words] + ["-w"]


def link_command(build, program, mutated, output):
    commands = run(["ninja", "-C", str(build), "-t", "commands", f"tests/{program}"],
                   f"no program {program}")
    line = commands.strip().splitlines()[-1].replace(": && ", "").replace(" && :", "")
    words = shlex.split(line)
    at = words.index("-o")
    return words[:at] + [str(mutated), "-o", str(output)] + words[at + 2:]


def tests_failed(program):
    environment = dict(os.environ, CK_DEFAULT_TIMEOUT="15")
    try:
        done = subprocess.run([str(program)], env=environment, text=True, errors="replace",
                              capture_output=True, timeout=LIMIT, check=False)
    except subprocess.TimeoutExpired as expired:
        raise Bad(f"its tests are not over after {LIMIT} s") from expired
    return set(FAILED.findall(done.stdout + done.stderr))


def tests_failed_before(programs, build, pool):
    """By program: those of its tests that fail without any fault."""
    names = [name for name in sorted(programs) if (build / "tests" / name).exists()]
    return dict(zip(names, pool.map(lambda name: tests_failed(build / "tests" / name), names)))


def judge(mutant, build, sources, failed_before):
    """None, or what is wrong."""
    try:
        if mutant.test in failed_before.get(mutant.program, ()):
            raise Bad(f"{mutant.program}:{mutant.test} fails without it, too")
        source, text = find(mutant, sources)
        with tempfile.TemporaryDirectory() as folder:
            mutated, program = Path(folder, source.name), Path(folder, mutant.program)
            mutated.write_text(text, encoding="utf-8")
            run(compile_command(build, source, mutated, mutated.with_suffix(".o")),
                "does not compile", cwd=build)
            run(link_command(build, mutant.program, mutated.with_suffix(".o"), program),
                "does not link", cwd=build)
            failed = tests_failed(program)
    except Bad as bad:
        return f"{mutant.name}: {bad}"
    if mutant.test in failed:
        return None
    return f"{mutant.name}: survives {mutant.program}:{mutant.test}, noticed by {sorted(failed)}"


def read_mutants():
    return parse((TESTS / "mutants/mutants.txt").read_text(encoding="utf-8"))


def read_sources():
    """The text of each source file that mutants are made of."""
    return {path: path.read_text(encoding="utf-8")
            for folder in FOLDERS for path in sorted((ROOT / folder).glob("*.c"))}


def main(arguments):
    if not arguments:
        print(__doc__.strip())
        return 2
    build, words = Path(arguments[0]).resolve(), arguments[1:]
    mutants = [m for m in read_mutants() if not words or any(word in m.name for word in words)]
    sources = read_sources()
    begin = time.monotonic()
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        before = tests_failed_before({m.program for m in mutants}, build, pool)
        verdicts = list(pool.map(lambda m: judge(m, build, sources, before), mutants))
    findings = [v for v in verdicts if v]
    print("\n".join(findings))
    print(f"mutants: {len(mutants)}, {time.monotonic() - begin:.1f} s")
    print(f"{len(mutants) - len(findings)} passed, {len(findings)} failed")
    return 1 if findings or not mutants else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
