#!/usr/bin/env python3
"""Exceeds each budget of check_budgets.py by one, and keeps each exactly."""
import contextlib
import io
import os
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import check_budgets
import nesting

ROOT = Path(__file__).resolve().parent.parent


def long_function(name, lines):
    return f"int {name}(int a)\n{{\n" + "    a++;\n" * (lines - 4) + "    return a;\n}\n\n"


def branches(count):
    return "int f(int a)\n{\n" + "    if (a == 1)\n        a++;\n" * count + "    return a;\n}\n"


def nested(count):
    loops = "while (a) {\n" * count + "a--;" + "}\n" * count
    return "int f(int a)\n{\n" + loops + "return a;\n}\n"


def nested_python(count):
    lines = ["def f(a):"] + ["    " * (i + 1) + "if a:" for i in range(count)]
    return "\n".join(lines + ["    " * (count + 1) + "a()"]) + "\n\n\n"


def parameters(name, count):
    text = ", ".join(f"int a{i}" for i in range(count))
    return f"int {name}({text})\n{{\n    return 0;\n}}\n"


def many(lengths):
    return "".join(long_function(f"f{i}", lines) for i, lines in enumerate(lengths))


# what the finding says ("": none), and the source
CASES = [
    ("", long_function("f", 60)),
    ("61 lines, budget 60", long_function("f", 61)),
    ("", branches(11)),
    ("complexity 13, budget 12", branches(12)),
    ("", nested(4)),
    ("nesting 5, budget 4", nested(5)),
    ("", parameters("f", 6)),
    ("7 parameters, budget 6", parameters("f", 7)),
    ("", parameters("mcanOpenConfig", 9)),
    ("", parameters("canOpenCreateNode", 9)),
    ("", "int x;\n" * 600),
    ("601 lines, budget 600", "int x;\n" * 601),
    ("", "/* " + "x" * 94 + " */\n"),
    ("101 columns, budget 100", "/* " + "x" * 95 + " */\n"),
    ("", many([12] * 20)),
    ("median of 13 lines, budget 12", many([13] * 20)),
    ("", many([8] * 19 + [55])),
    ("95th percentile of 41 lines, budget 40", many([8] * 18 + [41] * 2)),
]
C_NESTING = [
    (0, "a();"),
    (0, "int b[] = { 1, { 2 } }; struct x y = (struct x){ 0 }; { a(); }"),
    (1, "if (a)\n b(); /* if (a) if (b) */ c = \"if (a) if (b) {\";"),
    (1, "if (a)\n b();\nelse if (c)\n d();\nelse if (e)\n f();\nelse\n g();"),
    (2, "if (a)\n b();\nelse\n for (;;)\n c();"),
    (2, "switch (a) {\ncase 1: return;\ncase 'x':\ncase A:\n if (b)\n c();\n break;\n"
        "default: d();\n}"),
    (3, "for (;;) { while (b) do { c(); } while (d); }"),
    (2, "FOR_EACH(a, b)\n if (c)\n d();"),
    (2, "FOR_EACH(a, b) {\n if (c)\n d();\n}"),
    (1, "BEGIN_TABLE(A)\n ENTRY(1)\n ENTRY(2)\nEND_TABLE()\nif (a)\n b();"),
    (1, "again:\n if (a) { b = c ? d : e; goto again; }"),
]


def run(root):
    output = io.StringIO()
    with contextlib.redirect_stdout(output):
        code = check_budgets.main(["--root", str(root)])
    return code, output.getvalue()


class CheckBudgets(unittest.TestCase):
    def setUp(self):
        venv = os.environ.get("MCANOPEN_VENV", str(ROOT / "build" / "venv"))
        self.enterContext(mock.patch.dict(os.environ, {"MCANOPEN_VENV": venv}))

    def check(self, folder, text, name="module.c"):
        with tempfile.TemporaryDirectory() as root:
            path = Path(root) / folder / name
            path.parent.mkdir(parents=True)
            path.write_text(text, encoding="utf-8")
            return run(root)

    def test_each_budget(self):
        for finding, text in CASES:
            with self.subTest(finding=finding):
                code, output = self.check("src/od", text)
                self.assertEqual(code, 1 if finding else 0, output)
                self.assertIn(finding, output)

    def test_nesting_of_python(self):
        elifs = "def f(a):\n    if a:\n        a()\n" + "    elif a:\n        a()\n" * 6
        for text, expected in ((nested_python(4) * 3, 0), (nested_python(5), 1), (elifs, 0)):
            code, output = self.check("tests", text, "module.py")
            self.assertEqual(code, expected, output)

    def test_nesting_of_c(self):
        for expected, body in C_NESTING:
            with self.subTest(body=body):
                self.assertEqual(nesting.c_nesting("int f(int a)\n{\n" + body + "\n}\n"), expected)

    def test_each_folder(self):
        for folder in check_budgets.FOLDERS:
            with self.subTest(folder=folder):
                self.assertEqual(self.check(folder, long_function("f", 61))[0], 1)

    def test_without_lizard(self):
        with mock.patch.object(check_budgets, "load_lizard", return_value=None):
            code, output = self.check("src", "")
        self.assertEqual(code, 2)
        self.assertIn("lizard is missing", output)


if __name__ == "__main__":
    unittest.main()
