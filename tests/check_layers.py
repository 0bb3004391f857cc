#!/usr/bin/env python3
"""The rules of the house as a test: which layer may use what (docs/architecture.md).

    check_layers.py [--root DIR]                 what the sources say
    check_layers.py [--root DIR] --objects DIR   also what the compiled objects say

Each finding is one line "file:line: [rule] text"; the exit code is 1 when there is one.
tests/test_check_layers.py breaks every rule once and sees it found.
"""
import argparse
import re
import subprocess
import sys
from pathlib import Path

LAYERS = {  # layer: whose headers it may include besides its own
    "base": "",
    "od": "base",
    "dcf": "base od",
    "proto": "base od",
    "slave": "base od dcf proto",
    "manager": "base od dcf proto slave",
    "port": "base",
    "runtime": "base od dcf proto slave manager port",
    "api": "base od dcf slave manager runtime",
}
PURE = {"base", "od", "dcf", "proto", "slave", "manager"}  # no operating system in there
PUBLIC_HEADERS = {"mcanopen.h", "scanopen.h", "paraInfo.h", "mcanopen_types.h",
                  "scanopen_types.h", "scanopen_tables.h"}
PUBLIC_LAYERS = {"api"}

# Machines of proto/ do not know each other; headers that are no machine's are shared by all.
MACHINES = ("sdo_client", "sdo_server", "heartbeat", "guarding", "sync", "emcy", "rpdo", "tpdo",
            "time")
SHARED_PROTO = {"event", "nmt", "pdo_map", "sdo"}

C_HEADERS = {"assert.h", "ctype.h", "float.h", "inttypes.h", "limits.h", "locale.h", "math.h",
             "stdalign.h", "stdarg.h", "stdbool.h", "stddef.h", "stdint.h", "stdio.h", "stdlib.h",
             "stdnoreturn.h", "string.h"}

# Calls by the name of the symbol, in sources and objects alike.
OS_CALLS = re.compile(
    r"(pthread_\w+|sem_\w+|f?open(at)?|fdopen|fclose|fread|fwrite|fgets|getline|close|read|write"
    r"|socket|bind|sendto|sendmsg|recv|recvmsg|recvfrom|ioctl|poll|select|epoll_\w+|mmap"
    r"|clock_\w+|gettimeofday|time|timerfd_\w+|nanosleep|usleep|sleep|getenv|secure_getenv|setenv"
    r"|fork|exec[vl]p?e?|system|exit|abort|signal|sigaction|errno|errno_location|syslog"
    r"|v?printf|v?fprintf|puts|fputs|putchar|fputc|putc|perror|stdout|stderr|stdin)")
HEAP_CALLS = re.compile(
    r"(malloc|calloc|realloc|reallocarray|free|strdup|strndup|aligned_alloc|v?asprintf|alloca)")
# Files whose variables outlive a call and may change: the handle table and the log hook.
VARIABLE_FILES = {"api/registry", "api/log", "api/nets", "api/callback", "api/scan"}

CONDITION = re.compile(r"\s*#\s*(if|ifdef|ifndef|elif)\b(.*)")
CONDITION_NAMES = {"__cplusplus", "MCANOPEN_TRACE", "defined"}
INCLUDE = re.compile(r"\s*#\s*include\s*([<\"])([^>\"]+)[>\"]")
CALL = re.compile(r"(?<![\w.>])([A-Za-z_]\w*)\s*\(")


class Findings:
    def __init__(self, root):
        self.root = root
        self.lines = []

    def add(self, path, line, rule, text):
        self.lines.append(f"{path.relative_to(self.root)}:{line}: [{rule}] {text}")


def code_only(text):
    """The text without comments and without the inside of literals, line by line as before."""
    pattern = re.compile(r"//[^\n]*|/\*.*?\*/|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'", re.S)

    def blank(match):
        token = match.group(0)
        if token.startswith("/"):
            return re.sub(r"[^\n]", " ", token)
        return token[0] + token[-1]
    return pattern.sub(blank, text)


def read_lines(path):
    text = path.read_text(encoding="utf-8")
    return text.splitlines(), code_only(text).splitlines()


def includes_of(lines, code):
    """(line number, kind, name); kind is '"' or '<'. Includes inside comments do not count."""
    found = []
    for number, (line, stripped) in enumerate(zip(lines, code), 1):
        match = INCLUDE.match(line)
        if match and stripped.lstrip().startswith("#"):
            found.append((number, match.group(1), match.group(2)))
    return found


def machine_of(stem):
    for machine in MACHINES:
        if stem == machine or stem.startswith(machine + "_"):
            return machine
    return stem


def check_own_kind(out, path, number, name):
    """An include of proto/ in proto/: one's own machine, or a shared header."""
    other = Path(name).stem
    if other in SHARED_PROTO or machine_of(other) == machine_of(path.stem):
        return
    out.add(path, number, "machine", f"includes another machine's header {name}")


def check_project_include(out, path, layer, number, name):
    target = name.split("/")[0] if "/" in name else layer
    if name in PUBLIC_HEADERS:
        if layer not in PUBLIC_LAYERS:
            out.add(path, number, "arrow", f"{layer} includes the public header {name}")
    elif target not in LAYERS:
        out.add(path, number, "arrow", f"includes {name}, which is in no layer")
    elif "/" not in name:
        out.add(path, number, "path", f"write \"{layer}/{name}\", with its layer")
    elif target != layer and target not in LAYERS[layer].split():
        out.add(path, number, "arrow", f"{layer} includes {name}: that arrow goes up")
    elif target == layer == "proto":
        check_own_kind(out, path, number, name)


def check_system_include(out, path, layer, number, name):
    if name in PUBLIC_HEADERS:
        check_project_include(out, path, layer, number, name)
    elif name.startswith("libxml/"):
        if layer != "manager":
            out.add(path, number, "libxml", f"{layer} includes <{name}>")
    elif layer in PURE and name not in C_HEADERS:
        out.add(path, number, "os", f"{layer} includes <{name}>")


def check_own_header_first(out, path, layer, includes):
    own = path.with_suffix(".h")
    number, _, first = includes[0] if includes else (1, "", "nothing")
    if own.exists():
        if first != f"{layer}/{own.name}":
            out.add(path, number, "first", f"includes {first} before its own header")
    elif not first.startswith(layer + "/") and first not in PUBLIC_HEADERS:
        out.add(path, number, "first", f"includes {first} before a header of {layer}")


def check_calls(out, path, layer, code):
    for number, line in enumerate(code, 1):
        if line.lstrip().startswith("#"):
            continue
        for name in CALL.findall(line) + re.findall(r"\b(?:stderr|stdout|stdin|errno)\b", line):
            if OS_CALLS.fullmatch(name):
                out.add(path, number, "os", f"{layer} uses {name}")
            elif layer == "proto" and HEAP_CALLS.fullmatch(name):
                out.add(path, number, "heap", f"{layer} uses {name}")


def check_conditions(out, path, code):
    guard = None
    for number, line in enumerate(code, 1):
        match = CONDITION.match(line)
        if not match:
            continue
        names = set(re.findall(r"[A-Za-z_]\w*", match.group(2)))
        if path.suffix == ".h" and guard is None and match.group(1) == "ifndef":
            guard = names
            if number < len(code) and re.match(r"\s*#\s*define\b", code[number]):
                continue
        if not names or not names <= CONDITION_NAMES:
            out.add(path, number, "condition", line.strip())


def check_source(out, path, layer):
    lines, code = read_lines(path)
    includes = includes_of(lines, code)
    for number, kind, name in includes:
        check = check_project_include if kind == '"' else check_system_include
        check(out, path, layer, number, name)
    if path.suffix == ".c":
        check_own_header_first(out, path, layer, includes)
    if layer in PURE:
        check_calls(out, path, layer, code)
    if layer != "port":
        check_conditions(out, path, code)


def check_example(out, path):
    lines, code = read_lines(path)
    for number, kind, name in includes_of(lines, code):
        beside = kind == '"' and "/" not in name and (path.parent / name).exists()
        if kind == '"' and name not in PUBLIC_HEADERS and not beside:
            out.add(path, number, "example", f"includes {name}, which is not public")
        if kind == "<" and name.split("/")[0] in LAYERS:
            out.add(path, number, "example", f"includes {name}, which is not public")
    check_conditions(out, path, code)


def check_public_header(out, path):
    lines, code = read_lines(path)
    for number, _, name in includes_of(lines, code):
        if name not in PUBLIC_HEADERS and name not in C_HEADERS:
            out.add(path, number, "public", f"includes {name}")


def sources(folder):
    return sorted(p for p in folder.rglob("*") if p.suffix in (".c", ".h") and p.is_file())


def check_tree(out, root):
    src = root / "src"
    for path in sources(src):
        layer = path.relative_to(src).parts[0]
        if layer not in LAYERS or path.parent != src / layer:
            out.add(path, 1, "tree", "is in no layer")
        else:
            check_source(out, path, layer)
    for path in sources(root / "examples"):
        check_example(out, path)
    for path in sources(root / "include"):
        check_public_header(out, path)


SYMBOL = re.compile(r"^[0-9a-f]+ (?P<flags>.{7}) (?P<section>\S+)\s+[0-9a-f]+\s+"
                    r"(?:\.hidden )?(?P<name>\S+)$")
FORTIFIED = re.compile(r"^(?:__(?:isoc99_)?)?(.*?)(?:_chk)?$")

NOT_OURS = (".", "*", "__gcov", "__asan", "__odr_asan")  # of the compiler


def symbols_of(path):
    text = subprocess.run(["objdump", "-t", "-w", str(path)], check=True, capture_output=True,
                          text=True).stdout
    return [m.group("flags", "section", "name") for m in map(SYMBOL.match, text.splitlines()) if m]


def is_variable(flags, section, name):
    """Data that can change at run time; constant tables with pointers lie in .data.rel.ro."""
    if "d" in flags or "F" in flags or name.startswith(NOT_OURS):
        return False
    return section.startswith((".data", ".bss", ".tbss", ".tdata", "*COM*")) and \
        not section.startswith(".data.rel.ro")


def check_object(out, source, layer, symbols):
    module = f"{layer}/{source.stem}"
    for flags, section, name in symbols:
        plain = FORTIFIED.match(name).group(1)
        if section == "*UND*" and layer in PURE and OS_CALLS.fullmatch(plain):
            out.add(source, 1, "os", f"the object needs {name}")
        if section == "*UND*" and layer == "proto" and HEAP_CALLS.fullmatch(plain):
            out.add(source, 1, "heap", f"the object needs {name}")
        if is_variable(flags, section, name) and module not in VARIABLE_FILES:
            out.add(source, 1, "variable", f"{name} can change and outlives its callers")


def check_objects(out, root, objects):
    """objects: the folder that has layer/module.c.o for each source."""
    for source in sorted((root / "src").glob("*/*.c")):
        layer = source.parent.name
        compiled = objects / layer / (source.name + ".o")
        if not compiled.exists():
            out.add(source, 1, "object", f"has not been compiled: no {compiled}")
        elif layer in LAYERS:
            check_object(out, source, layer, symbols_of(compiled))


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parent.parent)
    parser.add_argument("--objects", type=Path, help="folder of the compiled src/")
    options = parser.parse_args(arguments)
    out = Findings(options.root)
    check_tree(out, options.root)
    if options.objects:
        check_objects(out, options.root, options.objects)
    print("".join(line + "\n" for line in out.lines), end="")
    print(f"check_layers: {len(out.lines)} findings")
    return 1 if out.lines else 0


if __name__ == "__main__":
    sys.exit(main())
