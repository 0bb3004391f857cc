#!/usr/bin/env python3
"""The disabling run tells tests that notice that their function is gone from those that do not."""
import importlib.util
import os
import stat
import sys
import tempfile
import unittest
from pathlib import Path

TESTS = Path(__file__).resolve().parent
sys.path.insert(0, str(TESTS))
import contract  # noqa: E402, found there


def load(name):
    spec = importlib.util.spec_from_file_location(name, TESTS / "disabling" / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


run, make_switches = load("run"), load("make_switches")
TABLE = ("function\tcanOpenMake\ttest_make:it_makes\n"
         "error\tcanOpenMake SCANOPEN_WRONG_INDEX\ttest_make:it_refuses\n"
         "error\tcanOpenMake SCANOPEN_WRONG_TYPE\ttest_make:it_refuses\n"
         "error\tcanOpenBreak SCANOPEN_WRONG_TYPE\tlater\tno\n"
         "element\tNode_Instance/Action STOP\ttest_make:it_stops\n"
         "constant\tOBJ_VAR\ttest_make:it_counts\n")
# A program that fails as the case's name says; what it sees of the environment decides.
PROGRAM = """#!/bin/sh
case $TEST_ONLY:$MCANOPEN_DISABLE in
good:canOpen*) echo "0%: Checks: 2, Failures: 1, Errors: 1" ;;
blind:*|good:) echo "100%: Checks: 2, Failures: 0, Errors: 0" ;;
broken:*) echo "50%: Checks: 2, Failures: 1, Errors: 0" ;;
*) echo "100%: Checks: 0, Failures: 0, Errors: 0" ;;
esac
"""


class Rows(unittest.TestCase):
    def test_each_function_with_its_tests_once(self):
        self.assertEqual(run.pairs_of(contract.parse_rows(TABLE)), [
            ("Node_Instance/Action", "test_make:it_stops"),
            ("canOpenMake", "test_make:it_makes"), ("canOpenMake", "test_make:it_refuses"),
            (None, "test_make:it_makes"), (None, "test_make:it_refuses"),
            (None, "test_make:it_stops")])


class Verdicts(unittest.TestCase):
    def verdict(self, function, case):
        with tempfile.TemporaryDirectory() as folder:
            program = Path(folder) / "tests" / "test_x"
            program.parent.mkdir()
            program.write_text(PROGRAM, encoding="utf-8")
            program.chmod(program.stat().st_mode | stat.S_IXUSR)
            os.environ.pop("MCANOPEN_DISABLE", None)
            test = f"test_x:{case}"
            return run.judge(function, test, run.run_test(Path(folder), function, test))

    def test_good(self):
        self.assertIsNone(self.verdict("canOpenMake", "good"))
        self.assertIsNone(self.verdict(None, "good"))

    def test_that_notices_nothing(self):
        self.assertIn("passes without canOpenMake", self.verdict("canOpenMake", "blind"))

    def test_that_fails_always(self):
        self.assertIn("test_x:broken: fails", self.verdict(None, "broken"))

    def test_that_is_not_there(self):
        self.assertIn("did not run", self.verdict("canOpenMake", "missing"))

    def test_that_does_not_end(self):
        self.assertIn("not over", run.judge("canOpenMake", "test_x:good", None))


class Switches(unittest.TestCase):
    def test_value(self):
        function = contract.functions_of("MCANOPEN_API int canOpenMake(HNODE Node,\n int *ret);")[0]
        self.assertIn("int __wrap_canOpenMake(HNODE Node, int *ret)\n{\n"
                      '    if (disabled("canOpenMake"))\n'
                      "        return SCANOPEN_NOT_IMPLEMENTED;\n"
                      "    return __real_canOpenMake(Node, ret);\n}\n",
                      make_switches.switch(function))

    def test_no_value(self):
        function = contract.functions_of("MCANOPEN_API void canOpenTell(int *ret);")[0]
        self.assertIn("        return;\n    __real_canOpenTell(ret);\n}\n",
                      make_switches.switch(function))

    def test_of_the_manager(self):
        function = contract.functions_of("MCANOPEN_API int mcanOpenMake(void);")[0]
        self.assertIn("        return MCAL_UNSUPPORTED;\n    return __real_mcanOpenMake();\n}\n",
                      make_switches.switch(function))

    def test_text(self):
        function = contract.functions_of("MCANOPEN_API const char *mcanOpenName(void);")[0]
        self.assertIn("const char *__wrap_mcanOpenName(void)\n{", make_switches.switch(function))
        self.assertIn('        return "";\n', make_switches.switch(function))


if __name__ == "__main__":
    unittest.main()
