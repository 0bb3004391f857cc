"""check_man.py finds tools and manual pages that do not say the same."""
import stat
import tempfile
import unittest
from pathlib import Path

import check_man

HELP = """Usage: ccfread [OPTION]... FILE

  -e, --eds FILE  names
      --diff      shows what differs:
                  --eds has the names
  -h, --help      shows this
      --version   shows the version

Exit codes: 0 good; 1 a damaged file, or
2 differences.
"""
PAGE = """.Sh NAME
.Sh SYNOPSIS
.Op Fl e Ar FILE
.Fl h | -help | -version
.Sh DESCRIPTION
.It Fl e Ar FILE , Fl -eds Ar FILE
.It Fl -diff
.It Fl h , -help
.It Fl -version
.Sh FILES
.Sh EXIT STATUS
.It 0
.It 1
.It 2
.Sh EXAMPLES
.Sh DIAGNOSTICS
.Sh SEE ALSO
.Xr ccfread 1
.Sh STANDARDS
"""
TOOL = """#!/bin/sh
folder=$(dirname "$0")
case $1 in
-h | --help) cat "$folder/help"; exit 0 ;;
--version) echo ccfread 1.2.3; exit 0 ;;
esac
cat "$folder/help" >&2
exit 2
"""


class CheckMan(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        (self.root / "docs" / "man").mkdir(parents=True)
        self.page(PAGE)
        self.tool(TOOL, HELP)

    def page(self, text, name="ccfread.1"):
        (self.root / "docs" / "man" / name).write_text(text, encoding="utf-8")

    def tool(self, text, help_text):
        path = self.root / "ccfread"
        path.write_text(text, encoding="utf-8")
        path.chmod(path.stat().st_mode | stat.S_IXUSR)
        (self.root / "help").write_text(help_text, encoding="utf-8")

    def found(self):
        tools, check_man.TOOLS = check_man.TOOLS, ("ccfread",)
        try:
            return list(check_man.findings(self.root, self.root))
        finally:
            check_man.TOOLS = tools

    def test_clean(self):
        self.assertEqual(self.found(), [])

    def test_an_option_that_the_page_lacks(self):
        self.page(PAGE.replace(".It Fl -diff\n", ""))
        self.assertEqual(self.found(), ["ccfread.1: --diff expected, as --help has it"])

    def test_an_option_that_the_tool_lacks(self):
        self.page(PAGE.replace(".Op Fl e", ".Op Fl qe"))
        self.assertEqual(self.found(), ["ccfread.1: -q is not in --help"])

    def test_exit_codes(self):
        self.page(PAGE.replace(".It 1\n", ""))
        self.assertEqual(self.found(), ["ccfread.1: EXIT STATUS: 0 1 2 expected, there is 0 2"])

    def test_no_page(self):
        (self.root / "docs/man/ccfread.1").rename(self.root / "docs/man/ccfwrite.1")
        self.assertEqual(self.found(), [
            "ccfread: a manual page expected, there is no ccfread.1",
            "ccfwrite.1: .Xr ccfread 1: there is no such page", "ccfwrite.1: a page of no tool"])

    def test_sections(self):
        self.page(PAGE.replace(".Sh FILES\n", ""))
        self.assertEqual(self.found(), ["ccfread.1: .Sh FILES expected"])

    def test_help_of_other_words(self):
        self.tool(TOOL, HELP.replace("shows this", "this text"))
        self.assertEqual(self.found(), ['ccfread: --help: --help: "shows this" expected'])

    def test_help_on_the_wrong_stream(self):
        self.tool(TOOL.replace(" >&2", ""), HELP)
        self.assertEqual(self.found(),
                         ["ccfread alone: the help expected on stderr, and exit code 2"])

    def test_version(self):
        self.tool(TOOL.replace("ccfread 1.2.3", "1.2.3"), HELP)
        self.assertEqual(self.found(), [
            "ccfread --version: name and version expected, there is '1.2.3\\n'"])

    def test_one_name_for_one_thing(self):
        told = {"a": "  -n, --node-id ID  x\n", "b": "  --node-id ID  x\n",
                "c": "  -N, --node-id ID  x\n"}
        self.assertEqual(list(check_man.one_name(told)), ["c: --help: --node-id is -N, in a -n"])

    def test_verbs(self):
        self.assertEqual(check_man.verbs_of("  boot FILE  x\n  sim FILE  x\n  sim -n 5  x\n"
                                            "  -h, --help  x\n"), ["boot", "sim"])


if __name__ == "__main__":
    unittest.main()
