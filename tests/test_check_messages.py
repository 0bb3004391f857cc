#!/usr/bin/env python3
"""check_messages.py finds the messages of a source, and sees one without a row."""
import contextlib
import io
import tempfile
import unittest
from pathlib import Path

import check_messages

SOURCE = r'''
#include "some header.h"
/* "a comment here" */
static const char quote = '"';
_Static_assert(sizeof(int) == 4, "an int has bytes");
const char *one = "%s: the bus is \"off\" after "
                  "%u ms", *two = "start", *three = "%04Xh:%02X", *four = "no such node\n";
'''
PAGE = """# Messages
the bus is "off" after, in plain text
| message | meaning |
|---|---|
| `X: the bus is "off" after N ms` | no such node |
"""


def run(page):
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        for path, text in (("src/port/x.c", SOURCE), (check_messages.PAGE, page)):
            (root / path).parent.mkdir(parents=True)
            (root / path).write_text(text, encoding="utf-8")
        output = io.StringIO()
        with contextlib.redirect_stdout(output):
            code = check_messages.main(["--root", folder])
    return code, output.getvalue()


class CheckMessages(unittest.TestCase):
    def test_texts(self):
        self.assertEqual(list(check_messages.texts_of(SOURCE)),
                         ['%s: the bus is "off" after %u ms', "start", "%04Xh:%02X",
                          "no such node "])

    def test_stable_parts(self):
        parts = [check_messages.stable_part(text) for text in check_messages.texts_of(SOURCE)]
        self.assertEqual(parts, ['the bus is "off" after', None, None, "no such node"])

    def test_missing(self):
        code, output = run(PAGE)
        self.assertEqual(code, 1)
        self.assertIn('src/port/x.c: "no such node" has no row', output)
        self.assertIn("check_messages: 1 findings", output)

    def test_complete(self):
        code, output = run(PAGE + "| no such  node | it is not there |\n")
        self.assertEqual(code, 0, output)


if __name__ == "__main__":
    unittest.main()
