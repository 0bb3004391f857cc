#!/usr/bin/env python3
"""The mutants' runner reads its list, finds what it changes, tells survivors; each one applies."""
import importlib.util
import unittest
from pathlib import Path

TESTS = Path(__file__).resolve().parent
SPEC = importlib.util.spec_from_file_location("run", TESTS / "mutants" / "run.py")
run = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(run)

LIST = """# a comment

the limit is one late
by test_x:test_limit
- if (now >= limit)
- stop();
+ if (now > limit)
+ stop();

nothing is done
by test_y:test_all
- go();
+ ;
"""
SOURCE = "if (now >= limit)\n        stop();\n"


class List(unittest.TestCase):
    def test_blocks(self):
        first, second = run.parse(LIST)
        self.assertEqual(first, run.Mutant("the limit is one late", "test_x", "test_limit",
                                           "if (now >= limit) stop();", "if (now > limit) stop();"))
        self.assertEqual((second.program, second.test, second.after), ("test_y", "test_all", ";"))

    def test_unknown_line(self):
        with self.assertRaises(SystemExit):
            run.parse("a name\nfrom test_x:test_limit\n")


class Find(unittest.TestCase):
    mutant = run.parse(LIST)[0]

    def test_white_space_does_not_matter(self):
        source, text = run.find(self.mutant, {"a.c": SOURCE, "b.c": "stop();"})
        self.assertEqual(source, "a.c")
        self.assertEqual(text, "if (now > limit) stop();\n")

    def test_once_and_no_more(self):
        for sources in ({"a.c": "stop();"}, {"a.c": SOURCE * 2}, {"a.c": SOURCE, "b.c": SOURCE}):
            with self.assertRaises(run.Bad):
                run.find(self.mutant, sources)


class Verdict(unittest.TestCase):
    def test_what_failed(self):
        output = ("97%: Checks: 3, Failures: 1, Errors: 1\n"
                  "../x.c:54:F:suite:test_a:0: : node 5: is not up\n"
                  "../x.c:60:E:suite:test_b:12: (after this point) Test timeout expired\n"
                  "../x.c:61:P:suite:test_c:0: Passed\n")
        self.assertEqual(set(run.FAILED.findall(output)), {"test_a", "test_b"})


class Mutants(unittest.TestCase):
    def test_each_applies(self):
        sources = run.read_sources()
        for mutant in run.read_mutants():
            with self.subTest(mutant.name):
                run.find(mutant, sources)


if __name__ == "__main__":
    unittest.main()
