#!/usr/bin/env python3
"""Breaks each rule of check_layers.py once, in a small made-up tree, and sees it found."""
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import check_layers

HEADER = "#ifndef CO_{name}_H\n#define CO_{name}_H\n{body}\n#endif\n"


def header(name, body=""):
    return HEADER.format(name=name, body=body)


def body(statement):
    return f"void *f(void)\n{{\n    {statement}\n}}\n"


GOOD = {
    "include/mcanopen.h": header("PUBLIC", "#include <stdint.h>\n#ifdef __cplusplus\n#endif"),
    "src/base/time.h": header("BASE_TIME", "#include <stdint.h>"),
    "src/base/text.c": '#include "base/time.h"\n\n#include <stdio.h>\n#include <string.h>\n',
    "src/od/od.h": header("OD", '#include "base/time.h"'),
    "src/od/od.c": '#include "od/od.h"\n\n#include <stdlib.h>\n\n'
                   'void *od_new(void)\n{\n    return malloc(1);\n}\n',
    "src/dcf/dcf.h": header("DCF", '#include "od/od.h"'),
    "src/proto/nmt.h": header("NMT"),
    "src/proto/sync.h": header("SYNC", '#include "base/time.h"'),
    "src/proto/sync.c": '#include "proto/sync.h"\n\n#include "proto/nmt.h"\n\n'
                        '/* a clock: time(NULL), malloc(3) */\nconst char *sync_text(void)\n{\n'
                        '    return "time(NULL)"; // free(1)\n}\n',
    "src/proto/emcy.h": header("EMCY"),
    "src/proto/sdo_client.h": header("SDO_CLIENT"),
    "src/proto/sdo_client_block.c": '#include "proto/sdo_client.h"\n',
    "src/slave/slave.h": header("SLAVE", '#include "proto/sync.h"'),
    "src/manager/xml.h": header("XML", '#include "slave/slave.h"'),
    "src/manager/xml.c": '#include "manager/xml.h"\n\n#include <libxml/parser.h>\n',
    "src/port/clock.h": header("CLOCK", '#include "base/time.h"'),
    "src/port/clock.c": '#include "port/clock.h"\n\n#include <time.h>\n#if 1\n#endif\n',
    "src/runtime/network.h": header("NETWORK", '#include "port/clock.h"\n#include <pthread.h>'),
    "src/api/registry.c": '#include "mcanopen.h"\n\n#include "runtime/network.h"\n'
                         '#ifdef MCANOPEN_TRACE\n#endif\nstatic int handles;\n'
                         'int *handle_table(void)\n{\n    return &handles;\n}\n',
    "examples/01-first.c": "#include <mcanopen.h>\n#include <stdio.h>\n",
}
# rule, file, text of the file (None: the good text with a line behind it)
BROKEN = [
    ("arrow", "src/base/time.h", header("BASE_TIME", '#include "od/od.h"')),
    ("arrow", "src/od/od.h", header("OD", '#include "proto/nmt.h"')),
    ("arrow", "src/dcf/dcf.h", header("DCF", '#include "proto/nmt.h"')),
    ("arrow", "src/proto/sync.h", header("SYNC", '#include "slave/slave.h"')),
    ("arrow", "src/slave/slave.h", header("SLAVE", '#include "manager/xml.h"')),
    ("arrow", "src/slave/slave.h", header("SLAVE", '#include "port/clock.h"')),
    ("arrow", "src/manager/xml.h", header("XML", '#include "runtime/network.h"')),
    ("arrow", "src/port/clock.h", header("CLOCK", '#include "od/od.h"')),
    ("arrow", "src/runtime/network.h", header("NETWORK", '#include "api/registry.h"')),
    ("arrow", "src/runtime/network.h", header("NETWORK", "#include <mcanopen.h>")),
    ("arrow", "src/api/log.h", header("LOG", '#include "proto/nmt.h"')),
    ("arrow", "src/api/log.h", header("LOG", '#include "port/clock.h"')),
    ("arrow", "src/api/log.h", header("LOG", '#include "elsewhere/clock.h"')),
    ("path", "src/proto/sync.h", header("SYNC", '#include "nmt.h"')),
    ("machine", "src/proto/sync.h", header("SYNC", '#include "proto/emcy.h"')),
    ("machine", "src/proto/nmt.h", header("NMT", '#include "proto/emcy.h"')),
    ("os", "src/base/time.h", header("BASE_TIME", "#include <time.h>")),
    ("os", "src/od/od.h", header("OD", "#include <pthread.h>")),
    ("os", "src/dcf/dcf.h", header("DCF", "#include <unistd.h>")),
    ("os", "src/proto/sync.h", header("SYNC", "#include <errno.h>")),
    ("os", "src/slave/slave.h", header("SLAVE", "#include <sys/types.h>")),
    ("os", "src/manager/xml.h", header("XML", "#include <linux/can.h>")),
    ("os", "src/dcf/read.c", '#include "dcf/dcf.h"\n' + body('return fopen("a", "r");')),
    ("os", "src/proto/sync.c", '#include "proto/sync.h"\n' + body("return time(0);")),
    ("os", "src/proto/sync.c", '#include "proto/sync.h"\n' + body('printf("x");')),
    ("os", "src/base/text.c", '#include "base/time.h"\n' + body("return stderr;")),
    ("heap", "src/proto/sync.c", '#include "proto/sync.h"\n' + body("free(0);")),
    ("heap", "src/proto/sync.c", '#include "proto/sync.h"\n' + body("return malloc(1);")),
    ("libxml", "src/dcf/dcf.h", header("DCF", "#include <libxml/parser.h>")),
    ("first", "src/od/od.c", '#include <stdlib.h>\n#include "od/od.h"\n'),
    ("first", "src/base/text.c", '#include <stdio.h>\n#include "base/time.h"\n'),
    ("first", "src/base/text.c", "int x;\n"),
    ("condition", "src/od/od.c", '#include "od/od.h"\n#if 0\n#endif\n'),
    ("condition", "src/od/od.c", '#include "od/od.h"\n#ifdef __linux__\n#endif\n'),
    ("condition", "src/od/od.h", header("OD", "#ifndef OTHER\n#endif")),
    ("condition", "examples/01-first.c", "#include <mcanopen.h>\n#ifdef __linux__\n#endif\n"),
    ("tree", "src/util/list.h", header("LIST")),
    ("tree", "src/base/deep/list.h", header("LIST")),
    ("example", "examples/01-first.c", '#include "base/time.h"\n'),
    ("example", "examples/01-first.c", "#include <base/time.h>\n"),
    ("public", "include/mcanopen.h", header("PUBLIC", '#include "base/time.h"')),
]
# rule, file, text: sources that look innocent, their objects do not
BROKEN_OBJECTS = [
    ("variable", "src/od/od.c", '#include "od/od.h"\nint od_count;\n'),
    ("variable", "src/port/clock.c", '#include "port/clock.h"\nint f(void)\n{\n'
     "    static int calls = 7;\n    return calls++;\n}\n"),
    ("variable", "src/runtime/network.c", '#include "runtime/network.h"\n_Thread_local int tls;\n'),
    ("os", "src/slave/slave.c", '#include "slave/slave.h"\n#define JOIN(a, b) a##b\n'
     "int JOIN(usle, ep)(unsigned t);\nint f(void)\n{\n    return JOIN(usle, ep)(1);\n}\n"),
    ("heap", "src/proto/sync.c", '#include "proto/sync.h"\n#define JOIN(a, b) a##b\n'
     "void JOIN(fr, ee)(void *p);\nvoid f(void *p)\n{\n    JOIN(fr, ee)(p);\n}\n"),
    ("object", "src/slave/slave.c", None),
]
CONSTANTS = ('#include "od/od.h"\nconst char *const od_names[] = { "a", "b" };\n'
             "const int od_x = 3;\n")


class Tree:
    """The good tree in a folder of its own, with changes."""

    def __init__(self, changes=()):
        self.folder = tempfile.TemporaryDirectory()
        self.root = Path(self.folder.name) / "tree"
        for name, text in {**GOOD, **dict(changes)}.items():
            path = self.root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")

    def compile(self, but=()):
        objects = self.root.parent / "objects"
        for source in sorted((self.root / "src").glob("*/*.c")):
            target = objects / source.parent.name / (source.name + ".o")
            target.parent.mkdir(parents=True, exist_ok=True)
            if source not in but and source.parent.name != "manager":
                compile_one(self.root, source, target)
        (self.root / "src/manager/xml.c").unlink()
        return objects

    def findings(self, with_objects=False, but=()):
        out = check_layers.Findings(self.root)
        check_layers.check_tree(out, self.root)
        if with_objects:
            objects = self.compile(but)
            check_layers.check_objects(out, self.root, objects)
        self.folder.cleanup()
        return out.lines


def compile_one(root, source, target):
    compiler = os.environ.get("CC", "cc").split()
    subprocess.run(compiler + ["-w", "-fPIC", f"-I{root}/include", f"-I{root}/src", "-c",
                               str(source), "-o", str(target)], check=True)


class CheckLayers(unittest.TestCase):
    def assert_found(self, lines, rule, name):
        self.assertEqual(len(lines), 1, lines)
        self.assertIn(f"[{rule}]", lines[0])
        self.assertTrue(lines[0].startswith(name + ":"), lines[0])

    def test_good_tree(self):
        self.assertEqual(Tree().findings(), [])

    def test_each_rule_of_sources(self):
        for rule, name, text in BROKEN:
            with self.subTest(rule=rule, name=name, text=text):
                self.assert_found(Tree({name: text}).findings(), rule, name)

    def test_good_objects(self):
        self.assertEqual(Tree({"src/od/od.c": CONSTANTS}).findings(with_objects=True), [])

    def test_each_rule_of_objects(self):
        for rule, name, text in BROKEN_OBJECTS:
            with self.subTest(rule=rule, name=name):
                tree = Tree({name: text or '#include "slave/slave.h"\n'})
                but = () if text else (tree.root / name,)
                self.assert_found(tree.findings(with_objects=True, but=but), rule, name)

    def test_exit_code(self):
        tree = Tree({"src/od/od.h": header("OD", "#include <time.h>")})
        script = Path(check_layers.__file__)
        with tree.folder:
            result = subprocess.run([sys.executable, str(script), "--root", str(tree.root)],
                                    check=False, capture_output=True, text=True)
        self.assertEqual(result.returncode, 1)
        self.assertIn("src/od/od.h:3: [os] od includes <time.h>", result.stdout)


if __name__ == "__main__":
    unittest.main()
