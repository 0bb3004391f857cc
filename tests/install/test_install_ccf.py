#!/usr/bin/env python3
"""mcanopen_add_ccf() of an installed copy, moved to another prefix: examples/dcf-in-cmake, and a
project with each of its arguments.

    test_install_ccf.py INSTALL_JSON       INSTALL_JSON: as CMake has written it
"""
import os
import shutil
import sys
import tempfile
import unittest
from pathlib import Path

from installation import Installation, Settings, run

ALL = {"pump.ccf": ["pump.dcf"], "valve-9.ccf": ["-n9", "valve.dcf"],
       "valve-10.ccf": ["-n10", "valve.dcf"]}
PROJECT = """cmake_minimum_required(VERSION 3.20)
project(plant LANGUAGES NONE)
find_package(mcanopen 0.1 REQUIRED)
"""


class AddCcf(unittest.TestCase):
    settings = None  # main() sets it

    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="mcanopen-install-ccf-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        run(cls.settings.cmake, "--install", cls.settings.build, "--prefix", cls.folder / "first",
            DESTDIR="")
        cls.copy = Installation(cls.settings, (cls.folder / "first").rename(cls.folder / "moved"))

    def setUp(self):
        """A copy of the example, whose files may change."""
        self.project = Path(tempfile.mkdtemp(dir=self.folder))
        self.source, self.binary = self.project / "source", self.project / "build"
        shutil.copytree(self.settings.source / "examples/dcf-in-cmake", self.source)

    def configure(self, *options):
        return run(self.settings.cmake, "-S", self.source, "-B", self.binary, "-G",
                   self.settings.generator, f"-DCMAKE_PREFIX_PATH={self.copy.prefix}", *options)

    def build(self, *arguments):
        return run(self.settings.cmake, "--build", self.binary, *arguments)

    def made(self):
        """The names of those that a build makes."""
        said = self.build()
        return sorted(name for name in ALL if f"Making {name}" in said)

    def touch(self, path):
        """Newer than all that has been built."""
        newest = max(file.stat().st_mtime for file in self.binary.iterdir())
        os.utime(path, (newest + 1, newest + 1))

    def bytes_of(self, *arguments):
        run(self.copy.prefix / "bin/dcf2ccf", *arguments, self.project / "expected")
        return (self.project / "expected").read_bytes()

    def try_lines(self, *lines):
        (self.source / "CMakeLists.txt").write_text(PROJECT + "\n".join(lines) + "\n",
                                                    encoding="utf-8")
        return self.configure()


class Example(AddCcf):
    def test_bytes(self):
        """those of dcf2ccf; and the files are installed"""
        self.configure()
        self.assertEqual(self.made(), sorted(ALL))
        run(self.settings.cmake, "--install", self.binary, "--prefix", self.project / "there",
            DESTDIR="")
        for name, (*options, dcf) in ALL.items():
            expected = self.bytes_of(*options, self.source / dcf)
            self.assertEqual((self.binary / name).read_bytes(), expected)
            self.assertEqual((self.project / "there/share/plant" / name).read_bytes(), expected)
            self.assertGreater(len(expected), 50)
        self.assertIn("tank 3", self.copy.tool("ccfread", self.binary / "pump.ccf"))

    def test_what_is_made_again(self):
        """what depends on a newer DCF, DownloadFile or dcf2ccf; else nothing"""
        self.configure()
        self.build()
        for names, newer in ((["pump.ccf"], self.source / "pump.dcf"),
                             (["pump.ccf"], self.source / "recipe.csv"),
                             (["valve-10.ccf", "valve-9.ccf"], self.source / "valve.dcf"),
                             (sorted(ALL), self.copy.prefix / "bin/dcf2ccf")):
            self.assertEqual(self.made(), [], newer)
            self.touch(newer)
            self.assertEqual(self.made(), names, newer)
            os.utime(newer, (1e9, 1e9))

    def test_another_download_file(self):
        """the one before is not missed"""
        self.configure()
        self.build()
        (self.source / "recipe.csv").rename(self.source / "other.csv")
        dcf = self.source / "pump.dcf"
        dcf.write_text(dcf.read_text(encoding="utf-8").replace("recipe.csv", "other.csv"),
                       encoding="utf-8")
        self.touch(dcf)
        self.assertEqual(self.made(), ["pump.ccf"])
        self.touch(self.source / "other.csv")
        self.assertEqual(self.made(), ["pump.ccf"])

    def test_error(self):
        """ends the build with its place; the older file stays until the error is mended"""
        self.configure()
        self.build()
        dcf = self.source / "pump.dcf"
        good = dcf.read_text(encoding="utf-8")
        line = good[:good.index("ParameterValue=200")].count("\n") + 1
        before = (self.binary / "pump.ccf").read_bytes()
        dcf.write_text(good.replace("ParameterValue=200", "ParameterValue=70000"),
                       encoding="utf-8")
        self.touch(dcf)
        with self.assertRaisesRegex(AssertionError, rf"{dcf}:{line}: error: .*70000"):
            self.build()
        self.assertEqual((self.binary / "pump.ccf").read_bytes(), before)
        dcf.write_text(good.replace("ParameterValue=200", "ParameterValue=300"), encoding="utf-8")
        self.touch(dcf)
        self.assertEqual(self.made(), ["pump.ccf"])
        self.assertNotEqual((self.binary / "pump.ccf").read_bytes(), before)


class Arguments(AddCcf):
    def test_options(self):
        """are those of dcf2ccf; DCFs that the build makes; folders with blanks"""
        self.try_lines(
            "add_custom_command(OUTPUT made.dcf DEPENDS valve.dcf",
            "    COMMAND ${CMAKE_COMMAND} -E copy ${CMAKE_SOURCE_DIR}/valve.dcf made.dcf)",
            "mcanopen_add_ccf(made made.dcf NODE_ID 0x20)",
            'mcanopen_add_ccf(old pump.dcf valve.dcf OLD_STYLE OUTPUT_DIRECTORY "old style")',
            "mcanopen_add_ccf(values valve.dcf ALL_VALUES QUIET OUTPUT all/values.bin)")
        self.build("--target", "made")
        self.assertFalse((self.binary / "old style/pump.ccf").exists())
        self.build()
        valve, pump = self.source / "valve.dcf", self.source / "pump.dcf"
        for name, expected in (("made.ccf", self.bytes_of("-n", 0x20, valve)),
                               ("old style/pump.ccf", self.bytes_of("--old-style", pump)),
                               ("old style/valve.ccf", self.bytes_of("--old-style", valve)),
                               ("all/values.bin", self.bytes_of("--all", valve))):
            self.assertEqual((self.binary / name).read_bytes(), expected, name)
        self.assertNotEqual(self.bytes_of("--old-style", pump), self.bytes_of(pump))
        self.assertNotEqual(self.bytes_of("--all", valve), self.bytes_of(valve))

    def test_refused(self):
        """when CMake runs"""
        shutil.copytree(self.source, self.source / "sub")
        for arguments, text in (("", "a DCF expected"),
                                ("pump.dcf OUTPUT", "OUTPUT: a value expected"),
                                ("pump.dcf valve.dcf OUTPUT x", "OUTPUT: one DCF expected, not 2"),
                                ("pump.dcf sub/pump.dcf", "two files would be"),
                                ("pump.dcf)\nmcanopen_add_ccf(two pump.dcf", "two files would be"),
                                ("pump.dcf NODE_ID x", "NODE_ID: 1..127 expected, not x"),
                                ("pump.dcf NODE_ID 0", "NODE_ID: 1..127 expected, not 0"),
                                ("pump.dcf NODE_ID 128", "NODE_ID: 1..127 expected, not 128"),
                                ("pump.dcf NODE_ID FF", "NODE_ID: 1..127 expected, not FF")):
            with self.assertRaisesRegex(AssertionError, text.replace(" ", r"\s+")):
                self.try_lines(f"mcanopen_add_ccf(plant {arguments})")

    def test_another_program(self):
        """MCANOPEN_DCF2CCF, for builds for another machine"""
        program = self.project / "own"
        program.write_text(f'#!/bin/sh\nexec "{self.copy.prefix}/bin/dcf2ccf" --all "$@"\n',
                           encoding="utf-8")
        program.chmod(0o755)
        self.configure(f"-DMCANOPEN_DCF2CCF={program}")
        self.build()
        self.assertEqual((self.binary / "valve-9.ccf").read_bytes(),
                         self.bytes_of("--all", "-n9", self.source / "valve.dcf"))


def main(arguments):
    if not arguments:
        print(__doc__.strip())
        return 2
    AddCcf.settings = Settings(arguments[0])
    unittest.main(argv=["test_install_ccf.py", "-v", *arguments[1:]])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
