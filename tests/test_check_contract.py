#!/usr/bin/env python3
"""check_contract.py finds the names of headers, and each way in which the table can be wrong."""
import contextlib
import io
import tempfile
import unittest
from pathlib import Path

import check_contract
import contract

TYPES = """
#ifndef SCANOPEN_TYPES_H
#define SCANOPEN_TYPES_H
#define SCANOPEN_OK 0
#define SCANOPEN_WRONG_INDEX (-1001) /* a code, SCANOPEN_NOT_THERE */
#define SCANOPEN_WRONG_PARAMETER (-1006)
#define SCANOPEN_INVALID_HANDLE (-1017)
#define SCANOPEN_SERVICE_NOT_ALLOWED (-1014)
#define EV_RESET 4UL
#define LIST(a, b) \\
    ((a) << 16 | (b))
enum { NodeInit = 0, NodeStopped };
typedef struct node *HNODE;
typedef HNODE HNDO;
typedef int (*PFN_HANDLER)(int Net, void *Data);
typedef struct {
    unsigned long ulArg1, ulReserved[4]; /* ulNothing; */
    union {
        unsigned long ulArg2;
        void *pArg2;
    } arg;
} EVENT, *pEVENT;
typedef struct {
    int hidden;
} _COS_ENTRY;
#endif
"""
FUNCTIONS = """
/* Makes. Not from
 * callbacks. */
MCANOPEN_API int canOpenMake(HNODE Node, int *Number);
/*
 * Reads one.
 *   SCANOPEN_WRONG_INDEX  no such thing; never SCANOPEN_OK
 */
MCANOPEN_API int canOpenReadDictionary(HNODE Node,
                                       void *Data);
/* As canOpenReadDictionary. */
MCANOPEN_API int canOpenReadDictionaryHnd(HDICT Entry, void *Data);
MCANOPEN_API void canOpenGetVersions(int *Versions);
"""
MANAGER = """
#define MCANOPEN_H
#define MCAL_NO_NET (-9)
#define MCAL_PARA_ERROR (-7)
#define MCAL_SYS_ERROR (-8)
#define MCAL_BUFFER_OVERFLOW (-16)
#define CANOPEN_DCF_INIT_ERROR (-101)
/* Defined so that programs compile. Real files have these faults: */
#define CANOPEN_DCF_DOUBLE_KEYWORD (-111)
enum { MCANOPEN_MSG_TEXT = 1 };
/*
 * Reads.
 *   MCAL_BUFFER_OVERFLOW  too long; after MCANOPEN_OK never
 */
MCANOPEN_API int mcanOpenReadSDO(unsigned short net, int *len);
/* As mcanOpenReadSDO. */
MCANOPEN_API int mcanOpenWriteSDO(unsigned short net, int len);
/* CANOPEN_DCF_...  as told at each code */
MCANOPEN_API int mcanOpenConfig(const char *file);
/* Never MCANOPEN_ERROR. */
MCANOPEN_API const char *mcanOpenGetErrorText(void);
MCANOPEN_API extern const char *const cParaInfo[PARA_INFO_SIZE];
"""
NAMES = {
    ("constant", "SCANOPEN_OK"), ("constant", "NodeInit"), ("constant", "NodeStopped"),
    ("event", "EV_RESET"), ("macro", "LIST"), ("type", "HNODE"), ("type", "HNDO"),
    ("type", "PFN_HANDLER"), ("type", "EVENT"), ("type", "pEVENT"), ("member", "EVENT.ulArg1"),
    ("member", "EVENT.ulReserved"), ("member", "EVENT.ulArg2"), ("member", "EVENT.pArg2"),
    ("function", "canOpenMake"), ("function", "canOpenReadDictionary"),
    ("function", "canOpenReadDictionaryHnd"), ("function", "canOpenGetVersions"),
    ("error", "canOpenMake SCANOPEN_INVALID_HANDLE"),
    ("error", "canOpenMake SCANOPEN_WRONG_PARAMETER"),
    ("error", "canOpenMake SCANOPEN_SERVICE_NOT_ALLOWED"),
    ("error", "canOpenReadDictionary SCANOPEN_INVALID_HANDLE"),
    ("error", "canOpenReadDictionary SCANOPEN_WRONG_PARAMETER"),
    ("error", "canOpenReadDictionary SCANOPEN_WRONG_INDEX"),
    ("error", "canOpenReadDictionaryHnd SCANOPEN_INVALID_HANDLE"),
    ("error", "canOpenReadDictionaryHnd SCANOPEN_WRONG_PARAMETER"),
    ("constant", "CANOPEN_DCF_DOUBLE_KEYWORD"), ("constant", "cParaInfo"),
    ("event", "MCANOPEN_MSG_TEXT"), ("function", "mcanOpenReadSDO"),
    ("function", "mcanOpenWriteSDO"), ("function", "mcanOpenConfig"),
    ("function", "mcanOpenGetErrorText"), ("error", "mcanOpenReadSDO MCAL_BUFFER_OVERFLOW"),
    ("error", "mcanOpenConfig CANOPEN_DCF_INIT_ERROR"),
} | {("error", f"mcanOpen{f}SDO MCAL_{e}") for f in ("Read", "Write")
     for e in ("NO_NET", "PARA_ERROR", "SYS_ERROR")}
ELEMENTS = """
static const struct element network_rows[] = {
    { "Net_No", UCHAR(0), NETWORK(net), .mandatory = true }, /* "the" number */
    { "Folder", ASCII, NETWORK(folder),
      .alias = "Path" },
};
static const struct element node_rows[] = {
    { "NMT_Action_On_Error", ELEMENT_ACTION, 0, 0, ACTION_RESET_SLAVE, NODE(action) },
};
"""
ELEMENT_NAMES = {("element", f"Manager_Instance/{n}") for n in ("Net_No", "Folder", "Path")} | {
    ("element", f"Node_Instance/NMT_Action_On_Error{v}") for v in ("", " STOP_ALL")}
HEADERS = (FUNCTIONS, TYPES, "", MANAGER, "", "")
SOURCE = ('START_TEST(it_makes)\n{ canOpenMake(SCANOPEN_OK, ulArg1); config("<Path>a</Path>"); }\n')


def row(kind, name, test="later", remark="not yet"):
    return f"{kind}\t{name}\t{test}\t{remark}\n"


def table(*changed):
    """A table that is right, but for these lines."""
    changed_names = [tuple(line.split("\t")[:2]) for line in changed]
    names = NAMES | ELEMENT_NAMES
    return "# comment\n" + "".join(row(*n) for n in sorted(names) if n not in changed_names) + \
        "".join(changed)


def run(text):
    output = io.StringIO()
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(output):
        root = Path(folder)
        (root / "include").mkdir()
        (root / "tests").mkdir()
        (root / contract.ELEMENTS).parent.mkdir(parents=True)
        (root / contract.ELEMENTS).write_text(ELEMENTS, encoding="utf-8")
        for name, header in zip(contract.HEADERS, HEADERS):
            (root / "include" / name).write_text(header, encoding="utf-8")
        (root / "tests" / "test_make.c").write_text(SOURCE, encoding="utf-8")
        (root / "tests" / "contract.tsv").write_text(text, encoding="utf-8")
        code = check_contract.main(["--root", folder])
    return code, output.getvalue()


class Names(unittest.TestCase):
    def test_all_of_the_headers(self):
        self.assertEqual(contract.public_names(HEADERS), NAMES)


    def test_elements(self):
        self.assertEqual(set(contract.element_names(ELEMENTS)), ELEMENT_NAMES)


class Table(unittest.TestCase):
    def expect(self, finding, text):
        code, output = run(text)
        self.assertEqual(code, 1, output)
        self.assertIn(finding, output)
        self.assertIn(", 1 findings", output)

    def test_right(self):
        code, output = run(table(row("function", "canOpenMake", "test_make:it_makes", ""),
                                 row("member", "EVENT.ulArg1", "test_make:it_makes", ""),
                                 row("element", "Manager_Instance/Path", "test_make:it_makes")))
        self.assertEqual(code, 0, output)

    def test_name_without_row(self):
        lines = table().splitlines(True)
        self.expect("lacks event EV_RESET", "".join(k for k in lines if "EV_RESET" not in k))

    def test_row_without_name(self):
        self.expect("canOpenBreak is nowhere", table(row("function", "canOpenBreak")))

    def test_wrong_kind(self):
        self.expect("constant EV_RESET is nowhere", table() + row("constant", "EV_RESET"))

    def test_two_rows(self):
        self.expect("has another row", table() + row("event", "EV_RESET"))

    def test_no_such_program(self):
        self.expect("no test program test_break",
                    table(row("function", "canOpenMake", "test_break:it_makes")))

    def test_no_such_test(self):
        for test in ("test_make:it_breaks", "test_make"):
            self.expect("test_make has no test", table(row("function", "canOpenMake", test)))

    def test_name_not_used(self):
        self.expect("test_make does not use SCANOPEN_WRONG_PARAMETER",
                    table(row("error", "canOpenMake SCANOPEN_WRONG_PARAMETER",
                              "test_make:it_makes")))

    def test_element_not_used(self):
        self.expect("test_make does not use Folder",
                    table(row("element", "Manager_Instance/Folder", "test_make:it_makes")))

    def test_no_remark(self):
        self.expect("needs a remark", table(row("event", "EV_RESET", "none", "")))

    def test_no_table(self):
        with self.assertRaises(ValueError):
            run("function canOpenMake later\n")


if __name__ == "__main__":
    unittest.main()
