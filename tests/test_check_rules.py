"""check_rules.py finds messages without rule and rules without message."""
import tempfile
import unittest
from pathlib import Path

import check_rules

DEFINITIONS = 'DCF_RULE(NODE_ID, "node-id", ERROR, NONE,\n         "clause", "text")\n'
TOLD = "dcf_tell(report, DCF_RULE_NODE_ID, 1, text);"


class CheckRules(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.write("src/dcf/dcf_rules.def", DEFINITIONS)
        self.write("src/dcf/dcf.c", TOLD)

    def write(self, name, text):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def found(self):
        return list(check_rules.findings(self.root))

    def test_clean(self):
        self.write("src/dcf/ccf.c", "co_report_add(report, CO_ERROR, 0, text);")
        self.write("src/api/load.c", "co_report_add(report, CO_ERROR, 0, text);")
        self.assertEqual(self.found(), [])

    def test_a_message_without_rule(self):
        self.write("src/dcf/dcf_info.c", "co_report_add(report, CO_ERROR, 0, text);")
        self.assertEqual(self.found(),
                         ["src/dcf/dcf_info.c: co_report_add(): dcf_tell() expected"])

    def test_a_rule_that_nobody_tells(self):
        self.write("src/dcf/dcf.c", TOLD.replace("NODE_ID", "NODE_ID_2"))
        self.assertEqual(self.found(), ["src/dcf/dcf_rules.def: NODE_ID: nobody tells it"])

    def test_a_rule_of_another_name(self):
        self.write("src/dcf/dcf_rules.def", DEFINITIONS.replace("node-id", "nodeid"))
        self.assertEqual(
            self.found(),
            ["src/dcf/dcf_rules.def: NODE_ID: its name is expected alike, it is nodeid"])


if __name__ == "__main__":
    unittest.main()
