#!/usr/bin/env python3
"""check_prototypes.py finds what it is there for."""
import unittest

from check_prototypes import check

MAP = "MCANOPEN_0 { global: mcanOpenStart; iParaInfo; local: *; };"
HEADER = """
/* int mcanOpenComment(void); */
#define canOpenMacro(a) \\
    mcanOpenOther(a);
typedef void (*MCANOPEN_LOG_T)(void *context);
MCANOPEN_API void
mcanOpenStart(void);
MCANOPEN_API extern const char *const iParaInfo[256];
"""


class CheckPrototypes(unittest.TestCase):
    def findings(self, map_text, **headers):
        return check(map_text, headers)[0]

    def test_agreement(self):
        self.assertEqual(self.findings(MAP, a=HEADER), [])

    def test_function_missing_in_map(self):
        header = HEADER + "MCANOPEN_API int mcanOpenNew(int a,\n    int b);\n"
        self.assertEqual(self.findings(MAP, a=header), ["a: mcanOpenNew is not in the map"])

    def test_function_missing_in_headers(self):
        old = MAP.replace("iParaInfo;", "iParaInfo; mcanOpenOld;")
        self.assertEqual(self.findings(old, a=HEADER), ["map: mcanOpenOld is in no header"])

    def test_table_missing_in_map(self):
        self.assertEqual(self.findings(MAP.replace("iParaInfo;", ""), a=HEADER),
                         ["a: iParaInfo is not in the map"])

    def test_prototype_without_visibility(self):
        header = HEADER + "int mcanOpenHidden(int a,\n    int b);\n"
        self.assertEqual(self.findings(MAP, a=header), ["a: mcanOpenHidden lacks MCANOPEN_API"])

    def test_names_of_several_headers(self):
        self.assertEqual(self.findings(MAP, a="MCANOPEN_API void mcanOpenStart(void);",
                                       b="MCANOPEN_API extern const char *const iParaInfo[2];"), [])


if __name__ == "__main__":
    unittest.main()
