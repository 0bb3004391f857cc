#!/usr/bin/env python3
"""dcftest from outside: its lines, its options, its exit codes, JSON and SARIF."""
import json
import os
import re
import subprocess
from pathlib import Path
from urllib.parse import unquote, urlparse

import plant
from dcftest import (CLEAN, DCFTEST, ERRORS, TROUBLE, DcftestTest, device, with_error,
                     with_warning)

NOBODY = 65534
# What the problem matchers of editors expect of a compiler.
GCC_LINE = re.compile(r"^(?P<file>.*?):(?P<line>\d+):(?P<column>\d*):?\s+"
                      r"(?P<severity>warning|error):\s+(?P<text>.*)$")


class Lines(DcftestTest):
    def test_clean(self):
        self.write("a.dcf", device())
        self.write("a.eds", device(None))
        for name in ("a.dcf", "a.eds"):
            done = self.run_tool(name)
            self.assertEqual((done.returncode, done.out, done.err), (CLEAN, "", ""))

    def test_error(self):
        text = with_error()
        self.write("a.dcf", text)
        line = text.splitlines().index("ParameterValue=256") + 1
        lines = self.check(ERRORS, "a.dcf")
        self.assertEqual(len(lines), 1, lines)
        self.assertRegex(lines[0], rf"^a\.dcf:{line}: error: .*256.* \[[a-z0-9-]+\]$")

    def test_warning(self):
        self.write("a.dcf", with_warning())
        lines = self.check(CLEAN, "a.dcf")
        self.assertEqual(len(lines), 1, lines)
        self.assertRegex(lines[0], r"^a\.dcf:\d+: warning: .* \[comment\]$")
        self.assertEqual(lines, self.check(ERRORS, "--strict", "a.dcf"))

    def test_all_lines_are_those_of_a_compiler(self):
        self.write("a.eds", "soon\n[1000]\n# x\n")
        lines = self.check(CLEAN, "a.eds")
        self.assertGreater(len(lines), 3)
        places = [int(GCC_LINE.match(line)["line"]) for line in lines]
        self.assertEqual(places, sorted(places))
        self.assertEqual(places[0], 1)
        for line in lines:
            self.assertRegex(line, r" \[[a-z0-9-]+\]$")

    def test_same_errors_as_the_manager(self):
        """What only the making of a configuration finds: a file that the DCF names."""
        self.write("a.dcf", device().replace("[2000]\n", "[2000]\nDownloadFile=no.bin\n")
                   .replace("DataType=0x0005\nAccessType=rw", "DataType=0xF\nAccessType=rw"))
        lines = self.check(ERRORS, "a.dcf")
        self.assertTrue(any("error: 2000h:00 DownloadFile: " in line for line in lines), lines)
        self.write("no.bin", "x")
        self.assertFalse(any("DownloadFile" in line for line in self.check(CLEAN, "a.dcf")))

    def test_what_does_not_fit_together(self):
        """Beyond the reading: warnings that the manager does not have."""
        self.write("a.dcf", device().replace("DefaultValue=4\n", "DefaultValue=3\n"))
        lines = self.check(CLEAN, "a.dcf")
        self.assertEqual(len(lines), 1, lines)
        self.assertRegex(lines[0], r"^a\.dcf:\d+: warning: 1018h:00 .* \[sub-0-default\]$")

    def test_node_id(self):
        """$NODEID+200 is an UNSIGNED8 for some node-IDs."""
        self.write("a.dcf", device(value="$NODEID+200"))
        self.write("none.dcf", device(value="$NODEID+200").replace("NodeID=5\n", ""))
        self.check(CLEAN, "-q", "a.dcf")
        self.check(ERRORS, "-q", "--node-id", 100, "a.dcf")
        self.check(ERRORS, "-q", "none.dcf")
        self.check(CLEAN, "-q", "-n", "0x10", "none.dcf")

    def test_many_messages(self):
        """More than anybody reads are counted."""
        objects = "".join(f"[{index:04X}]\nParameterName=x\nDataType=5\nAccessType=rw\n"
                          for index in range(0x2000, 0x2000 + 10020))
        self.write("a.dcf", device().replace("[2000]", "[5FFF]") + objects)
        done = self.run_tool("--summary", "a.dcf")
        lines = done.out.splitlines()
        self.assertEqual(len(lines), 10001)
        missing = int(re.fullmatch(r"a\.dcf:1: info: warnings that are not shown: (\d+)",
                                   lines[-1])[1])
        self.assertEqual(done.err, f"1 file, 0 errors, {10000 + missing} warnings\n")
        self.assertEqual(self.check(CLEAN, "-q", "a.dcf"), [])
        self.write("a.dcf", objects.replace("AccessType=rw\n", "AccessType=rw\nParameterValue=x\n"))
        lines = self.check(ERRORS, "-q", "a.dcf")
        self.assertEqual(len(lines), 10001)
        self.assertEqual(lines[-1], "a.dcf:1: info: errors that are not shown: 20")


class Files(DcftestTest):
    def test_order(self):
        """As given; of folders by name, whatever their depth; endings in any case."""
        (self.folder / "plant" / "b" / "c").mkdir(parents=True)
        (self.folder / "plant" / "empty").mkdir()
        for name in ("z.dcf", "plant/b/c/d.EDS", "plant/b/a.Dcf", "plant/b.eds", "plant/a.dcf",
                     "plant/readme.txt", "plant/eds"):
            self.write(name, with_warning())
        names = [line.split(":")[0] for line in self.check(CLEAN, "z.dcf", "plant", "plant/a.dcf")]
        self.assertEqual(names, ["z.dcf", "plant/a.dcf", "plant/b/a.Dcf", "plant/b/c/d.EDS",
                                 "plant/b.eds", "plant/a.dcf"])

    def test_links(self):
        """Those to files are taken, those to folders not: there is no way round in circles."""
        (self.folder / "plant").mkdir()
        self.write("plant/a.dcf", with_warning())
        os.symlink("a.dcf", self.folder / "plant" / "b.dcf")
        os.symlink("..", self.folder / "plant" / "c.dcf")
        os.symlink(".", self.folder / "plant" / "d")
        (self.folder / "other").mkdir()
        self.write("other/e.dcf", with_warning())
        os.symlink("../other", self.folder / "plant" / "e")
        os.symlink("plant", self.folder / "here")
        names = [line.split(":")[0] for line in self.check(CLEAN, "here")]
        self.assertEqual(names, ["here/a.dcf", "here/b.dcf"])

    def test_stdin(self):
        self.write("a.dcf", device())
        lines = self.check(CLEAN, "-", "a.dcf", input=with_warning().encode())
        self.assertRegex(lines[0], r"^stdin:\d+: warning: .* \[comment\]$")
        self.assertEqual(len(lines), 1)

    def test_unreadable(self):
        os.symlink("nowhere", self.folder / "link.dcf")
        (self.folder / "empty").mkdir()
        self.write("a.dcf", with_warning())
        lines = self.check(ERRORS, "no.dcf", "a.dcf", ".", "empty", "a.dcf/b")
        self.assertEqual([line for line in lines if "comment" not in line],
                         ["no.dcf: error: no such file [unreadable]",
                          "./link.dcf: error: no such file [unreadable]",
                          "empty: error: no file in it ends in .eds or .dcf [unreadable]",
                          "a.dcf/b: error: Not a directory [unreadable]"])

    def test_no_rights(self):
        (self.folder / "plant" / "closed").mkdir(parents=True)
        self.write("plant/a.dcf", device()).chmod(0)
        (self.folder / "plant" / "closed").chmod(0)
        self.addCleanup((self.folder / "plant" / "closed").chmod, 0o700)
        self.folder.chmod(0o755)
        self.assertEqual(self.check_as_nobody("plant"), [
            "plant/a.dcf: error: permission denied [unreadable]",
            "plant/closed: error: permission denied [unreadable]"])

    def check_as_nobody(self, *arguments):
        if os.geteuid() != 0:
            return self.check(ERRORS, *arguments)
        try:
            return self.check(ERRORS, *arguments, user=NOBODY, extra_groups=[])
        except PermissionError:
            return self.skipTest("the tools are where only root may go")

    def test_jobs(self):
        """The output is the same, however many are at work."""
        texts = [device(), with_warning(), with_error(), "soon\n", ""]
        for number in range(300):
            self.write(f"{number:03}.dcf", texts[number % len(texts)])
        for form in ([], ["--json"], ["--sarif"]):
            one = self.check(ERRORS, "-j1", *form, ".")
            for jobs in (2, 7, 1024):
                self.assertEqual(one, self.check(ERRORS, f"--jobs={jobs}", *form, "."))
            self.assertEqual(one, self.check(ERRORS, *form, "."))

    def test_summary(self):
        self.write("a.dcf", with_warning())
        self.write("b.dcf", with_error())
        self.assertEqual(self.run_tool("a.dcf").err, "")
        self.assertEqual(self.run_tool("--summary", "a.dcf").err, "1 file, 0 errors, 1 warning\n")
        self.assertEqual(self.run_tool("-q", ".").err, "2 files, 1 error, 1 warning\n")
        self.assertEqual(self.run_tool("-qq", ".").err, "")


class Options(DcftestTest):
    def test_help(self):
        done = self.run_tool()
        self.assertEqual((done.returncode, done.out), (TROUBLE, ""))
        shown = self.run_tool("--help")
        self.assertEqual((shown.returncode, shown.err), (CLEAN, ""))
        self.assertEqual(shown.out, done.err)
        self.assertEqual(shown.out, self.run_tool("-h").out)
        self.assertRegex(self.run_tool("--version").out, r"^dcftest \d+\.\d+\.\d+\n$")

    def test_usage(self):
        self.write("a.dcf", device())
        self.refuse("a file or a folder expected", "--strict")
        self.refuse("--help", "--nonsense", "a.dcf")
        self.refuse("--help", "--rule")
        self.refuse("1..127", "-n", "128", "a.dcf")
        self.refuse("1..127", "-n", "five", "a.dcf")
        self.refuse("1..1024", "-j", "0", "a.dcf")
        self.refuse("1..1024", "-j", "-1", "a.dcf")
        self.refuse("not both", "--json", "--sarif", "a.dcf")

    def test_rules(self):
        self.write("a.dcf", with_warning() + "x" * 300 + "=1\n")
        rules = self.rules_of("a.dcf")
        self.assertLessEqual({"comment", "line-length"}, rules)
        self.assertEqual(self.rules_of("--rule", "comment", "a.dcf"), {"comment"})
        self.assertEqual(self.rules_of("--rule", "comment,line-length", "a.dcf"),
                         {"comment", "line-length"})
        self.assertEqual(self.rules_of("--rule=comment", "--rule=line-length", "a.dcf"),
                         {"comment", "line-length"})
        self.assertEqual(self.rules_of("--no-rule", "comment", "a.dcf"), rules - {"comment"})
        self.assertEqual(self.rules_of("--rule=comment,line-length", "--no-rule=comment", "a.dcf"),
                         {"line-length"})
        self.check(CLEAN, "--strict", "--rule", "byte-order-mark", "a.dcf")

    def rules_of(self, *arguments):
        return {re.search(r"\[([a-z0-9-]+)\]$", line)[1] for line in self.check(CLEAN, *arguments)}

    def test_errors_are_always_told(self):
        self.write("a.dcf", with_error())
        self.assertEqual(len(self.check(ERRORS, "--rule", "comment", "a.dcf")), 1)
        self.refuse('"unreadable" is an error', "--no-rule", "unreadable", "a.dcf")

    def test_unknown_rules(self):
        self.write("a.dcf", with_error())
        self.refuse('--rule: no rule "coment"; did you mean comment', "--rule", "coment", "a.dcf")
        self.refuse('no rule "line-lenght"; did you mean line-length?',
                    "--no-rule", "comment,line-lenght", "a.dcf")
        self.refuse("Try 'dcftest --list-rules'", "--rule", "something else at all", "a.dcf")
        self.refuse('no rule ""', "--rule", "comment,", "a.dcf")

    def test_list_rules(self):
        lines = self.check(CLEAN, "--list-rules")
        rules = json.loads("\n".join(self.check(CLEAN, "--list-rules", "--json")))
        self.assertEqual(len(lines), 2 * len(rules))
        for number, rule in enumerate(rules):
            self.assertEqual(list(rule), ["name", "severity", "clause", "code", "text"])
            code = f", {rule['code']}" if rule["code"] else ""
            self.assertEqual(lines[2 * number],
                             f"{rule['name']}: {rule['severity']} [{rule['clause']}{code}]")
            self.assertEqual(lines[2 * number + 1], f"    {rule['text']}")
            self.assertIn(rule["severity"], ("error", "warning"))
            self.assertTrue(rule["code"] or rule["severity"] == "warning", rule)
        names = [rule["name"] for rule in rules]
        self.assertEqual(len(set(names)), len(names))

    def test_quiet(self):
        self.write("a.dcf", with_error().replace("[DummyUsage]", "# a comment\n[DummyUsage]"))
        self.write("b.dcf", with_warning())
        self.assertEqual(len(self.check(ERRORS, "a.dcf")), 2)
        self.assertEqual(len(self.check(ERRORS, "-q", "a.dcf")), 1)
        self.assertEqual(self.check(ERRORS, "-qq", "a.dcf"), [])
        self.assertEqual(self.check(CLEAN, "-q", "b.dcf"), [])
        self.assertEqual(self.check(ERRORS, "--quiet", "--strict", "b.dcf"), [])

    def test_full_output(self):
        self.write("a.dcf", with_error())
        with open("/dev/full", "w", encoding="ascii") as full:
            for form in ([], ["--json"], ["--sarif"]):
                done = subprocess.run([DCFTEST, *form, "a.dcf"], stdout=full, cwd=self.folder,
                                      stderr=subprocess.PIPE, timeout=plant.LIMIT, check=False)
                self.assertEqual(done.returncode, TROUBLE)
                self.assertIn(b"No space left", done.stderr)


class Forms(DcftestTest):
    """The same messages as JSON and SARIF."""

    def setUp(self):
        super().setUp()
        self.write("a.dcf", with_error())
        self.write("b c%ü.dcf", with_warning())
        self.write("d.dcf", device())
        (self.folder / "latin.eds").write_bytes(b"[1000]\nParameterName=\xfc\nDataType=\xfc\n")
        self.names = ["a.dcf", "b c%ü.dcf", "d.dcf", "latin.eds", "no.dcf"]

    def as_json(self, *arguments):
        return json.loads("\n".join(self.check(ERRORS, *arguments, *self.names)))

    def test_json(self):
        found = self.as_json("--json")
        lines = self.check(ERRORS, *self.names)
        self.assertEqual([each["file"] for each in found["files"]], self.names)
        messages = [m for each in found["files"] for m in each["messages"]]
        self.assertEqual([self.line_of(m) for m in messages],
                         [line.encode(errors="surrogateescape").decode("utf-8", "replace")
                          for line in lines])
        self.assertEqual(found["summary"]["files"], 5)
        for kind in ("error", "warning"):
            count = sum(f": {kind}: " in line for line in lines)
            self.assertEqual(found["summary"][kind + "s"], count)
            self.assertEqual(sum(each[kind + "s"] for each in found["files"]), count)

    @staticmethod
    def line_of(message):
        place = "" if message["rule"] == "unreadable" else f"{message['line'] or 1}:"
        return (f"{message['file']}:{place} {message['severity']}: {message['text']} "
                f"[{message['rule']}]")

    def test_json_message(self):
        found = self.as_json("--json")
        message = found["files"][0]["messages"][0]
        line = with_error().splitlines().index("ParameterValue=256") + 1
        self.assertEqual({**message, "rule": 0, "clause": 0, "text": 0},
                         {"file": "a.dcf", "line": line, "severity": "error", "rule": 0,
                          "clause": 0, "code": "CANOPEN_DCF_OUT_OF_RANGE", "index": 0x2000,
                          "sub": None, "text": 0})
        self.assertIn("CiA 306", message["clause"])
        last = found["files"][4]["messages"]
        self.assertEqual([(m["line"], m["index"], m["code"]) for m in last],
                         [(None, None, "CANOPEN_DCF_INIT_ERROR")])

    def test_json_sub_index(self):
        self.write("a.dcf", device().replace("[1018sub3]", "[1018sub3]\n# x"))
        messages = json.loads("\n".join(self.check(CLEAN, "--json", "a.dcf")))["files"][0]
        self.assertEqual([(m["index"], m["sub"]) for m in messages["messages"]], [(0x1018, 3)])

    def test_json_quiet(self):
        found = self.as_json("--json", "-q")
        self.assertEqual({m["severity"] for each in found["files"] for m in each["messages"]},
                         {"error"})
        self.assertGreater(found["summary"]["warnings"], 0)

    def test_sarif(self):
        log = self.as_json("--sarif")
        self.assertEqual(log["version"], "2.1.0")
        self.assertIn("sarif-schema-2.1.0.json", log["$schema"])
        self.assertEqual(len(log["runs"]), 1)
        run = log["runs"][0]
        self.assertEqual(run["invocations"], [{"executionSuccessful": True, "exitCode": ERRORS}])
        messages = [m for each in self.as_json("--json")["files"] for m in each["messages"]]
        self.assertEqual(len(run["results"]), len(messages))
        for result, message in zip(run["results"], messages):
            self.check_result(result, message, run["tool"]["driver"]["rules"])

    def check_result(self, result, message, rules):
        self.assertEqual(result["ruleId"], message["rule"])
        self.assertEqual(rules[result["ruleIndex"]]["id"], message["rule"])
        self.assertEqual(result["level"], message["severity"])
        self.assertEqual(result["message"], {"text": message["text"]})
        self.assertEqual(len(result["locations"]), 1)
        physical = result["locations"][0]["physicalLocation"]
        self.assertEqual(unquote(physical["artifactLocation"]["uri"]), message["file"])
        self.assertRegex(physical["artifactLocation"]["uri"], r"^[A-Za-z0-9._~/%-]+$")
        where = {"startLine": message["line"] or 1}
        self.assertEqual(physical.get("region"),
                         None if message["rule"] == "unreadable" else where)

    def test_sarif_rules(self):
        driver = self.as_json("--sarif")["runs"][0]["tool"]["driver"]
        self.assertEqual(driver["name"], "dcftest")
        self.assertRegex(driver["semanticVersion"], r"^\d+\.\d+\.\d+$")
        listed = json.loads("\n".join(self.check(CLEAN, "--list-rules", "--json")))
        for rule, known in zip(driver["rules"], listed, strict=True):
            self.assertEqual(rule["id"], known["name"])
            self.assertEqual(rule["shortDescription"], {"text": known["text"]})
            self.assertIn(known["clause"], rule["help"]["text"])
            self.assertEqual(rule["defaultConfiguration"], {"level": known["severity"]})

    def test_sarif_absolute(self):
        """An absolute path is a URI with its scheme."""
        path = self.folder / "b c%ü.dcf"
        log = json.loads("\n".join(self.check(CLEAN, "--sarif", path)))
        place = log["runs"][0]["results"][0]["locations"][0]["physicalLocation"]
        uri = urlparse(place["artifactLocation"]["uri"])
        self.assertEqual((uri.scheme, uri.netloc, Path(unquote(uri.path))), ("file", "", path))


class WithEds(DcftestTest):
    def test_eds(self):
        """What is not as in the EDS is told, with lines of the DCF."""
        self.write("a.eds", device(None))
        self.write("same.dcf", device())
        self.write("b.dcf", device().replace("AccessType=rw", "AccessType=ro"))
        self.assertEqual(self.check(CLEAN, "--eds", "a.eds", "same.dcf"), [])
        lines = self.check(CLEAN, "--eds", "a.eds", "b.dcf", "same.dcf")
        self.assertTrue(lines)
        for line in lines:
            self.assertRegex(line, r"^b\.dcf:\d+: warning: .* \[eds-access\]$")
        self.check(ERRORS, "--strict", "--eds", "a.eds", "b.dcf")
        self.assertEqual(self.check(CLEAN, "--strict", "b.dcf"), [])

    def test_bad_eds(self):
        self.write("a.dcf", device())
        self.write("b.eds", with_error())
        lines = self.check(ERRORS, "--eds", "b.eds", "a.dcf")
        self.assertEqual([line.split(":")[0] for line in lines], ["b.eds"])
        self.assertEqual(self.check(ERRORS, "--eds=no.eds", "a.dcf"),
                         ["no.eds: error: no such file [unreadable]"])
        found = json.loads("\n".join(self.check(ERRORS, "--json", "--eds=no.eds", "a.dcf")))
        self.assertEqual(found["summary"], {"files": 1, "errors": 1, "warnings": 0})
        (self.folder / "two").mkdir()
        self.write("two/a.eds", device(None))
        self.write("two/b.eds", device(None))
        self.refuse("--eds: one file expected", "--eds", "two", "a.dcf")


if __name__ == "__main__":
    plant.main()
