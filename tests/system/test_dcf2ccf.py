#!/usr/bin/env python3
"""dcf2ccf from outside: a network's files are what a manager writes to its devices, build systems
are told what the outputs depend on, and whatever goes wrong, no output is half written.
"""
import json
import os
import re
import signal
import struct
import subprocess
import unittest
from pathlib import Path

import eds
import plant
from devices import UNSIGNED8, UNSIGNED16, UNSIGNED32, VISIBLE_STRING, Entry, Record, dcf
from devices import network, node, standard

DCF2CCF = str(plant.TOOLS / "dcf2ccf")
PLANT = plant.ROOT / "examples" / "boot-network" / "network.xml"
LONG = "a text that an expedited transfer has no room for"
LEFT_ALONE = (0x1000, 0x1001, 0x1010, 0x1011, 0x1018, 0x1200, 0x1F50, 0x1F51)
COMPACT = re.compile(r"[0-9a-f]{4}value")
DOMAIN = """[{index:04X}]
ParameterName=program
ObjectType=2
DataType=0xF
AccessType=rw
DownloadFile={name}

"""


def entries(ccf):
    """[(index, sub, bytes)] of a concise DCF."""
    count, position, found = struct.unpack_from("<I", ccf)[0], 4, []
    for _ in range(count):
        index, sub, size = struct.unpack_from("<HBI", ccf, position)
        found.append((index, sub, ccf[position + 7:position + 7 + size]))
        position += 7 + size
    assert position == len(ccf)
    return found


class Dcf2ccf(plant.PlantTest):
    def convert(self, *arguments, code=0, says=""):
        done = self.run_command([DCF2CCF, *arguments], cwd=self.folder)
        self.assertEqual(done.code, code, done.story())
        self.assertIn(says, done.err.text(), done.story())
        return done

    def device(self, name, *objects, node_id=5):
        return self.write(name, dcf(node_id, [*standard(5), *objects]))

    def files(self, pattern="*"):
        return sorted(str(path.relative_to(self.folder)) for path in self.folder.rglob(pattern)
                      if not path.is_dir())


class Values(Dcf2ccf):
    def test_round_trip(self):
        """DCF, CCF, and the values are those of the DCF: ParameterValues, with --all the others"""
        self.device("a.dcf", Entry(0x2000, UNSIGNED8, 1, "rw", 2), Entry(0x2001, UNSIGNED16, 3),
                    Entry(0x2002, UNSIGNED32, 4, "ro"),
                    Entry(0x2003, VISIBLE_STRING, "x", "rw", LONG))
        given = [(0x2000, 0, b"\2"), (0x2003, 0, LONG.encode())]
        self.convert("a.dcf")
        self.assertEqual(entries((self.folder / "a.ccf").read_bytes()), given)
        self.convert("--all", "a.dcf")
        others = [(0x2001, 0, b"\3\0"), (0x1017, 0, b"\0\0")]
        self.assertEqual(sorted(entries((self.folder / "a.ccf").read_bytes())),
                         sorted(given + others))

    def test_nothing(self):
        """a file without a ParameterValue: a warning, and a count of 0"""
        self.device("a.dcf", Entry(0x2000, UNSIGNED8, 1))
        self.convert("a.dcf", says="a.dcf: warning: nothing to write: no writable entry has a "
                                   "ParameterValue (--all writes DefaultValues as well)")
        self.assertEqual((self.folder / "a.ccf").read_bytes(), bytes(4))
        done = self.convert("-q", "a.dcf")
        self.assertEqual(done.err.text(), "")

    def test_streams(self):
        """- is stdin and stdout; both have the bytes of files"""
        path = self.device("a.dcf", Entry(0x2000, UNSIGNED8, 1, "rw", 2))
        self.convert("a.dcf")
        expected = (self.folder / "a.ccf").read_bytes()
        for arguments in (["-"], ["-", "-"], ["-o", "-", "-"]):
            done = subprocess.run([DCF2CCF, *arguments], input=path.read_bytes(), check=True,
                                  stdout=subprocess.PIPE)
            self.assertEqual(done.stdout, expected, arguments)
        subprocess.run([DCF2CCF, "-", self.folder / "b.ccf"], input=path.read_bytes(), check=True)
        self.assertEqual((self.folder / "b.ccf").read_bytes(), expected)
        done = subprocess.run([DCF2CCF, "-"], input=b"no section", check=False,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.assertEqual((done.returncode, done.stdout), (2, b""))
        self.assertIn(b"stdin: error: ", done.stderr)


class Network(Dcf2ccf):
    def test_same_as_the_manager(self):
        """each node's file has the writes that the manager sends to it at boot"""
        self.convert("--from-network", PLANT, "-o", self.folder)
        self.assertEqual(self.files(), [f"node-{n}.ccf" for n in (2, 5, 7, 9)])
        dump = self.dump()
        self.start_sim(PLANT)
        self.boot("--once", "--all", PLANT)
        frames = dump.end()
        for number in (2, 5, 7, 9):
            made = entries((self.folder / f"node-{number}.ccf").read_bytes())
            self.assertGreater(len(made), 3)
            self.assertEqual(eds.downloads(frames, number), made, number)

    def test_settings_of_the_network(self):
        """node-ID, Old_Config_Style and repository are those of the XML file"""
        mapping = Record(0x1600, [Entry(0x1600, UNSIGNED32, 0, "rw", "0x20000008")])
        mapping.entries[0] = Entry(0x1600, UNSIGNED8, 0, "rw", 1)
        rpdo = Record(0x1400, [Entry(0x1400, UNSIGNED32, "$NODEID+0x200"),
                               Entry(0x1400, UNSIGNED8, 255)])
        (self.folder / "files").mkdir()
        self.device("files/a.dcf", Entry(0x2000, UNSIGNED8, 0), rpdo, mapping, node_id=None)
        settings = {"DCF_File": "a.dcf"}
        self.write("network.xml", network(
            [node(5, **settings), node(0x66, Old_Config_Style="TRUE", **settings)],
            Config_File_Repository="files"))
        self.convert("--from-network", "network.xml")
        self.convert("-n", 5, "files/a.dcf", "new.ccf")
        self.convert("-n", "010", "files/a.dcf", "ten.ccf")
        self.convert("-n", "0xA", "files/a.dcf", "hex.ccf")
        self.assertEqual((self.folder / "ten.ccf").read_bytes(),
                         (self.folder / "hex.ccf").read_bytes())
        self.convert("-n", 0x66, "--old-style", "files/a.dcf", "old.ccf")
        for one, other in (("node-5.ccf", "new.ccf"), ("node-102.ccf", "old.ccf")):
            self.assertEqual((self.folder / one).read_bytes(), (self.folder / other).read_bytes())
        self.assertNotEqual(*((self.folder / name).read_bytes() for name in ("new.ccf", "old.ccf")))

    def test_several_networks(self):
        """a node-ID may be in each of them: its files have the network's number, too"""
        self.device("a.dcf", Entry(0x2000, UNSIGNED8, 1, "rw", 2))
        text = network([node(5, DCF_File="a.dcf")])
        one = text[text.index("  <Manager_Instance>"):text.index("</CANopen_Manager>")]
        self.write("network.xml", text.replace(
            "</CANopen_Manager>", one.replace("<Net_No>0", "<Net_No>7") + "</CANopen_Manager>"))
        (self.folder / "out").mkdir()
        self.convert("--from-network", "network.xml", "-o", "out", "--depfile", "out/d")
        self.assertEqual(self.files("*.ccf"), ["out/net-0-node-5.ccf", "out/net-7-node-5.ccf"])
        self.assertIn("out/net-0-node-5.ccf out/net-7-node-5.ccf:",
                      (self.folder / "out/d").read_text(encoding="utf-8"))

    def test_all_or_nothing(self):
        """an error in one file, and none is written; files that are there stay"""
        self.device("a.dcf", Entry(0x2000, UNSIGNED8, 1, "rw", 2))
        self.device("b.dcf", Entry(0x2000, UNSIGNED8, 1, "rw", 256), node_id=6)
        self.write("node-6.ccf", "old")
        self.write("network.xml", network([node(5, DCF_File="a.dcf"), node(6, DCF_File="b.dcf")]))
        before = self.files()
        self.convert("--from-network", "network.xml", "--depfile", "d", code=2,
                     says="b.dcf:135: error: [2000] ParameterValue: ")
        self.assertEqual(self.files(), before)
        self.assertEqual((self.folder / "node-6.ccf").read_bytes(), b"old")
        self.convert("--from-network", "none.xml", code=2, says="none.xml: error: no such file")
        self.write("network.xml", network([node(5)]))
        self.convert("--from-network", "network.xml", code=2, says="a node with a DCF_File exp")

    def test_an_output_cannot_be_written(self):
        """nor is one written where another one cannot be"""
        self.device("a.dcf", Entry(0x2000, UNSIGNED8, 1, "rw", 2))
        (self.folder / "node-7.ccf").mkdir()
        self.device("node-6.ccf", Entry(0x2000, UNSIGNED8, 1, "rw", 2), node_id=6)
        self.write("network.xml", network([node(5, DCF_File="a.dcf"),
                                           node(6, DCF_File="node-6.ccf")]))
        before = self.files()
        self.convert("--from-network", "network.xml", code=2, says="node-6.ccf: an input, expected")
        self.assertEqual(self.files(), before)
        self.device("c.dcf", Entry(0x2000, UNSIGNED8, 1, "rw", 2), node_id=7)
        self.write("network.xml", network([node(5, DCF_File="a.dcf"), node(7, DCF_File="c.dcf")]))
        before = self.files()
        self.convert("--from-network", "network.xml", code=2, says="node-7.ccf: a folder, expected")
        self.assertEqual(self.files(), before)

    def test_usage(self):
        """what only one DCF has"""
        for arguments in (["-n", "5"], ["--old-style"], ["--all"], ["-o", "-"], ["a.dcf"]):
            self.convert("--from-network", PLANT, *arguments, code=2, says="--from-network: ")
        self.convert("--depfile", "d", "a.dcf", "-", code=2, says="--depfile: ")


class Depfile(Dcf2ccf):
    def rule(self, name="d"):
        return (self.folder / name).read_text(encoding="utf-8")

    def test_rule(self):
        """the DCF and its DownloadFiles; blanks and such as make and ninja read them"""
        (self.folder / "sub").mkdir()
        self.write("sub/pro gram.bin", "x")
        text = dcf(5, standard(5)) + DOMAIN.format(index=0x2000, name="pro gram.bin")
        self.write("sub/a#$.dcf", text)
        self.convert("--depfile", "d", "sub/a#$.dcf", "-o", "sub/b.ccf")
        self.assertEqual(self.rule(), "sub/b.ccf: \\\n  sub/a\\#$$.dcf \\\n  sub/pro\\ gram.bin\n"
                                      "sub/pro\\ gram.bin:\n")

    def test_ninja(self):
        """ninja reads it: what is newer is made again, and nothing else"""
        self.write("pro gram.bin", "x")
        self.write("a.dcf", dcf(5, standard(5)) + DOMAIN.format(index=0x2000, name="pro gram.bin"))
        self.write("build.ninja", "rule ccf\n  depfile = $out.d\n"
                   f"  command = {DCF2CCF} -q --depfile $out.d $in -o $out\n"
                   "build a.ccf: ccf a.dcf\n")
        ninja = ["ninja", "-v"]
        self.assertIn("--depfile", self.run_command(ninja, cwd=self.folder).out.text())
        for name in ("a.dcf", "pro gram.bin"):
            self.assertIn("no work to do", self.run_command(ninja, cwd=self.folder).out.text())
            made = (self.folder / "a.ccf").stat().st_mtime
            os.utime(self.folder / name, (made + 1, made + 1))
            self.assertIn("--depfile", self.run_command(ninja, cwd=self.folder).out.text())
            os.utime(self.folder / name, (made - 1, made - 1))
        (self.folder / "pro gram.bin").rename(self.folder / "other.bin")
        self.write("a.dcf", dcf(5, standard(5)) + DOMAIN.format(index=0x2000, name="other.bin"))
        self.assertIn("--depfile", self.run_command(ninja, cwd=self.folder).out.text())
        self.assertIn("no work to do", self.run_command(ninja, cwd=self.folder).out.text())

    def test_network(self):
        """the XML file, and of each node what its DCF needs"""
        self.write("program.bin", "x")
        self.write("a.dcf", dcf(5, standard(5)) + DOMAIN.format(index=0x2000, name="program.bin"))
        self.device("b.dcf", Entry(0x2000, UNSIGNED8, 1, "rw", 2), node_id=6)
        self.write("network.xml", network([node(5, DCF_File="a.dcf"), node(6, DCF_File="b.dcf")]))
        self.convert("--from-network", "network.xml", "--depfile", "d")
        self.assertEqual(self.rule(), "node-5.ccf node-6.ccf: \\\n  network.xml \\\n  a.dcf \\\n"
                                      "  program.bin \\\n  b.dcf\na.dcf:\nprogram.bin:\n"
                                      "b.dcf:\n")

    def test_names_without_a_way_to_write_them(self):
        """a control character: an error, and no output"""
        self.device("a\nb.dcf", Entry(0x2000, UNSIGNED8, 1, "rw", 2))
        self.convert("--depfile", "d", "a\nb.dcf", code=2, says="d: a file whose name has control")
        self.assertEqual(self.files(), ["a\nb.dcf"])


class NeverHalf(Dcf2ccf):
    def setUp(self):
        super().setUp()
        self.device("a.dcf", Entry(0x2003, VISIBLE_STRING, "x", "rw", LONG))
        self.old = self.write("a.ccf", "old")

    def assert_old(self):
        self.assertEqual(self.old.read_bytes(), b"old")

    def run_limited(self, **options):
        """The disk takes 8 bytes of a file."""
        return subprocess.run(["prlimit", "--fsize=8", DCF2CCF, "-q", "a.dcf"], check=False,
                              cwd=self.folder, text=True, stderr=subprocess.PIPE, **options)

    def test_full_disk(self):
        """the error is told, the old file stays, nothing is left behind"""
        done = self.run_limited(restore_signals=False)  # SIGXFSZ stays ignored, as here
        self.assertEqual(done.returncode, 2)
        self.assertEqual(done.stderr, "dcf2ccf: a.ccf: File too large\n")
        self.assert_old()
        self.assertEqual(self.files(), ["a.ccf", "a.dcf"])

    def test_killed(self):
        """in the middle of writing: the old file stays, and the next run clears up"""
        self.assertEqual(self.run_limited().returncode, -signal.SIGXFSZ)
        self.assert_old()
        self.convert("a.dcf")
        self.assertEqual(self.files(), ["a.ccf", "a.dcf"])
        self.assertIn(LONG.encode(), self.old.read_bytes())

    def test_folder_without_rights(self):
        """the old file stays"""
        self.folder.chmod(0o555)
        humble = ["setpriv", "--inh-caps=-all", "--bounding-set=-all"] if os.geteuid() == 0 else []
        done = self.run_command([*humble, DCF2CCF, "-q", "a.dcf"], cwd=self.folder)
        self.folder.chmod(0o755)
        self.assertEqual(done.code, 2, done.story())
        self.assertEqual(done.err.text(), "dcf2ccf: a.ccf: permission denied")
        self.assert_old()

    def test_links(self):
        """a link stays, and what it leads to is replaced; its mode stays as well"""
        (self.folder / "place").mkdir()
        target = self.write("place/real.ccf", "old")
        target.chmod(0o640)
        link = self.folder / "link.ccf"
        link.symlink_to(target)
        self.convert("a.dcf", "link.ccf")
        self.assertTrue(link.is_symlink())
        self.assertIn(LONG.encode(), target.read_bytes())
        self.assertEqual(target.stat().st_mode & 0o777, 0o640)
        self.assertEqual(self.files("*~"), [])

    def test_inputs_as_outputs(self):
        """however they are named: the DCF, a DownloadFile, also for --depfile"""
        text = dcf(5, standard(5)) + DOMAIN.format(index=0x2000, name="program.bin")
        self.write("b.dcf", text)
        self.write("program.bin", "program")
        (self.folder / "link").symlink_to("b.dcf")
        os.link(self.folder / "program.bin", self.folder / "hard.bin")
        for arguments in (["./b.dcf"], [self.folder / "b.dcf"], ["link"], ["program.bin"],
                          ["hard.bin"], ["--depfile", "program.bin"], ["--depfile", "link"]):
            self.convert("b.dcf", *arguments, code=2, says="an input, expected another file")
        self.assertEqual((self.folder / "b.dcf").read_text(encoding="utf-8"), text)
        self.assertEqual(Path(self.folder / "program.bin").read_bytes(), b"program")
        self.assertFalse((self.folder / "b.ccf").exists())


def is_written(entry):
    """True for a ParameterValue that a configuration has to have."""
    return (entry.keys.get("parametervalue") and entry.access in (*eds.WRITABLE, "wo")
            and entry.index not in LEFT_ALONE
            and not (eds.number(entry.keys.get("objflags", "0")) or 0) & 1)


def expected_values(file):
    """{(index, sub): bytes}, None where these are not known here."""
    return {(entry.index, entry.sub): eds.encode(entry.kind, entry.keys["parametervalue"], 5)
            for entry in file.entries.values() if is_written(entry)}


def compact_objects(file):
    """Those whose values stand in a section of their own."""
    return {int(name[:4], 16) for name in file.sections if COMPACT.fullmatch(name)}


def is_mapping(place):
    """Of what is mapped nothing is written behind the number of mapped objects."""
    return 0x1600 <= place[0] < 0x1800 or 0x1A00 <= place[0] < 0x1C00


def is_switch(place):
    """COB-IDs of PDOs and numbers of mapped objects switch off and on."""
    return 0x1400 <= place[0] < 0x1C00 and place[1] == (0 if is_mapping(place) else 1)


@unittest.skipUnless(plant.CORPUS.is_dir(), f"no corpus in {plant.CORPUS}")
class Others(plant.PlantTest):
    def assert_round_trip(self, file, ccf):
        """The number of values."""
        values = {(index, sub): data for index, sub, data in entries(ccf)}
        expected = expected_values(file)
        for place in sorted(expected.keys() & values.keys()):
            if expected[place] is not None:
                self.assertEqual(values[place], expected[place],
                                 f"{file.path} {place[0]:04X}h:{place[1]:02X}")
        self.assertEqual([place for place in expected.keys() - values.keys()
                          if not is_mapping(place)], [])
        self.assertEqual([place for place in values.keys() - expected.keys()
                          if not is_switch(place) and place[0] not in compact_objects(file)], [])
        return len(values)

    def test_round_trip(self):
        """DCFs of the corpus: the values are their ParameterValues, not their DefaultValues

        But for what a PDO has to have as well: its COB-ID, and the number of mapped objects.
        """
        counts = []
        for path in sorted(plant.CORPUS.rglob("*.dcf")):
            made = subprocess.run([DCF2CCF, "-q", "-n", "5", path, "-"], check=False,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            if made.returncode == 0:
                with self.subTest(path=path.name):
                    counts.append(self.assert_round_trip(eds.File(path), made.stdout))
            else:
                plant.say(f"refused: {made.stderr.decode().splitlines()[0]}")
        plant.say(f"{sum(counts)} values of {len(counts)} files")
        self.assertGreater(sum(map(bool, counts)), 30)

    def test_concise_files(self):
        """those of the corpus, made by others: ccfread shows each entry"""
        files = sorted(plant.CORPUS.rglob("*.bin"))
        self.assertEqual(len(files), 15)
        shown = self.run_command([plant.TOOLS / "ccfread", "--json", *files])
        self.assertEqual(shown.code, 0, shown.story())
        for path, told in zip(files, json.loads(shown.out.text())):
            self.assertEqual([(each["index"], each["sub"], bytes.fromhex(each["data"]))
                              for each in told["entries"]], entries(path.read_bytes()), path)
            self.assertEqual((told["file"], told["error"]), (str(path), None))


if __name__ == "__main__":
    plant.main()
