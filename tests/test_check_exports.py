#!/usr/bin/env python3
"""check_exports.py sees a name too many and a name too few, in both kinds of libraries."""
import contextlib
import io
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import check_exports

MAP = ("/* API */\nMCAN_0.1 {\n  global: one; # first\n    two;\n  local: *;\n};\n"
       "MCAN_2 { three; } MCAN_0.1;\n")


def build(folder, source):
    """A shared library and an archive of the same source."""
    compiler = os.environ.get("CC", "cc").split()
    base = Path(folder)
    (base / "x.c").write_text(source, encoding="utf-8")
    subprocess.run(compiler + ["-fPIC", "-c", "x.c", "-o", "x.o"], cwd=folder, check=True)
    subprocess.run(compiler + ["-shared", "x.o", "-o", "libx.so.0"], cwd=folder, check=True)
    subprocess.run(["ar", "rcs", "libx.a", "x.o"], cwd=folder, check=True)
    return [str(base / "libx.so.0"), str(base / "libx.a")]


def run(source, map_text=MAP):
    output = io.StringIO()
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(output):
        libraries = build(folder, source)
        (Path(folder) / "x.map").write_text(map_text, encoding="utf-8")
        code = check_exports.main([f"{folder}/x.map"] + libraries)
    return code, output.getvalue()


class CheckExports(unittest.TestCase):
    def test_equal(self):
        code, output = run("int one, two; void three(void) {} static int four;\n")
        self.assertEqual(code, 0, output)

    def test_one_too_many(self):
        code, output = run("int one, two, three, four;\n")
        self.assertEqual(code, 1)
        self.assertEqual(output.count("exports four"), 2, output)

    def test_one_too_few(self):
        code, output = run("int one, three;\n")
        self.assertEqual(code, 1)
        self.assertEqual(output.count("lacks two"), 2, output)

    def test_wildcards_are_refused(self):
        with self.assertRaises(ValueError):
            run("int one;\n", "{ global: one*; local: *; };\n")


if __name__ == "__main__":
    unittest.main()
