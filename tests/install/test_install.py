#!/usr/bin/env python3
"""An installed copy of this build, moved to another prefix: its files, and applications.

    test_install.py INSTALL_JSON [C | Cxx | Fetched]...       INSTALL_JSON: as CMake has written it

    C        files, exported names, paths, DESTDIR, tools; applications in C, shared and static
    Cxx      applications in C++17, shared and static
    Fetched  an application that has taken the sources in, after its build folder is gone

All applications boot the plant of examples/boot-network, simulated by the installed tool.
"""
import shutil
import sys
import tempfile
import unittest
from pathlib import Path

from installation import Installation, Settings, dynamic_section, files_below, needed_by, run

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import check_exports  # noqa: E402  pylint: disable=wrong-import-position

FLAGS = ("-Wall", "-Wextra", "-Wpedantic", "-Werror", "-Wl,--no-as-needed")


class InstalledCopy(unittest.TestCase):
    """What the tests of one copy share; an application is built from two sources."""

    settings = None  # main() sets it
    language, standard, shared_source, static_source = "C", "-std=c99", None, HERE / "own_names.c"

    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="mcanopen-install-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.shared_source = cls.shared_source or cls.settings.network.with_name("boot.c")
        cls.copy = cls.install()

    @classmethod
    def install(cls):
        """Installs and moves: what still knows the first place is found out."""
        run(cls.settings.cmake, "--install", cls.settings.build, "--prefix", cls.folder / "first",
            DESTDIR="")
        return Installation(cls.settings, (cls.folder / "first").rename(cls.folder / "moved"))

    def compiler(self):
        return self.settings.compilers[self.language]

    def configure(self, build, *options):
        run(self.settings.cmake, "-S", HERE / "consumer", "-B", build,
            "-G", self.settings.generator,
            f"-DCMAKE_BUILD_TYPE={self.settings.config}",
            f"-DCMAKE_C_COMPILER={self.settings.compilers['C']}",
            f"-DCMAKE_{self.language}_COMPILER={self.compiler()}",
            f"-DCONSUMER_LANGUAGES={self.language}",
            f"-DSHARED_SOURCE={self.shared_source}", f"-DSTATIC_SOURCE={self.static_source}",
            f"-DCMAKE_PREFIX_PATH={self.copy.prefix}", *options)

    def check_shared(self, program):
        self.assertIn(f"libmcanopen.so.{self.settings.version.split('.')[0]}", needed_by(program))
        self.assertNotIn("libxml2", " ".join(needed_by(program)))
        self.copy.boots(program)

    def check_static(self, program):
        self.assertNotIn("libmcanopen", " ".join(needed_by(program)))
        self.copy.boots(program)


class Applications:
    """Tests of C and Cxx: applications built in each way."""

    def compile(self, source, program, *flags):
        run(self.compiler(), self.standard, *FLAGS, source, "-o", self.folder / program, *flags)
        return self.folder / program

    def test_pkg_config_shared(self):
        self.check_shared(self.compile(self.shared_source, "pc_shared",
                                       *self.copy.pkg_config("--cflags", "--libs")))

    def test_pkg_config_static(self):
        flags = self.copy.pkg_config("--static", "--cflags", "--libs")
        self.assertEqual(flags.count("-lmcanopen"), 1, flags)
        flags[flags.index("-lmcanopen")] = "-l:libmcanopen.a"
        self.check_static(self.compile(self.static_source, "pc_static", *flags))

    def test_find_package(self):
        build = self.folder / "consumer"
        self.configure(build, "-DMCANOPEN_ARGUMENTS=0.1")
        run(self.settings.cmake, "--build", build)
        self.check_shared(build / "shared")
        self.check_static(build / "static")


class C(Applications, InstalledCopy):
    def test_files(self):
        self.assertEqual(files_below(self.copy.prefix), self.settings.expected_files())

    def test_destdir(self):
        stage = self.folder / "stage"
        run(self.settings.cmake, "--install", self.settings.build, DESTDIR=stage)
        prefix = str(self.settings.prefix).strip("/")
        self.assertEqual(files_below(stage), sorted(
            f"{prefix}/{name}" for name in self.settings.expected_files()))

    def test_soname(self):
        major = self.settings.version.split(".")[0]
        self.assertIn(f"Library soname: [libmcanopen.so.{major}]",
                      dynamic_section(self.copy.libraries / "libmcanopen.so"))

    def test_exported_names(self):
        libraries = [str(self.copy.libraries / f"libmcanopen.{kind}") for kind in ("so", "a")]
        code = check_exports.main([str(self.settings.source / "src/api/mcanopen.map"), *libraries])
        self.assertEqual(code, 0)

    def test_no_search_path(self):
        for name in self.programs():
            self.assertNotRegex(dynamic_section(self.copy.prefix / name), "RPATH|RUNPATH", name)

    def test_no_path_of_build_or_prefix(self):
        """Debug information names the sources, nothing else does."""
        paths = (self.settings.build, self.settings.source, self.folder)
        names = self.programs() + [f"{self.settings.libdir}/libmcanopen.a"]
        for name in names:
            run("objcopy", "--strip-debug", self.copy.prefix / name, self.folder / "stripped")
            self.check_contents(name, (self.folder / "stripped").read_bytes(), paths)
        for file in self.copy.libraries.rglob("*mcanopen*"):
            if file.suffix in (".cmake", ".pc"):
                names.append(file)
                self.check_contents(file.name, file.read_bytes(), paths)
        self.assertEqual(len(names), 11)

    def programs(self):
        return ["bin/mcanopen", "bin/dcf2ccf", "bin/ccfread",
                f"{self.settings.libdir}/libmcanopen.so"]

    def check_contents(self, name, contents, paths):
        for path in paths:
            self.assertEqual(contents.count(bytes(path)), 0, f"{name} has {path}")

    def test_tools(self):
        self.copy.tool("dcf2ccf", self.settings.network.with_name("pump.dcf"),
                       self.folder / "pump.ccf")
        self.assertIn("1017", self.copy.tool("ccfread", self.folder / "pump.ccf"))
        script = self.folder / "boot.sh"
        script.write_text(f'exec "{self.copy.prefix}/bin/mcanopen" boot --once --all "$1"\n',
                          encoding="utf-8")
        script.chmod(0o755)
        self.assertIn("4 of 4 nodes booted", self.copy.boots(script))

    def test_version(self):
        self.assertEqual(self.copy.pkg_config("--modversion"), [self.settings.version])
        with self.assertRaisesRegex(AssertionError, "requested version \"1.0\""):
            self.configure(self.folder / "version", "-DMCANOPEN_ARGUMENTS=1.0")

    def test_without_libxml2(self):
        """Only the static library needs its development files."""
        missing = "-DCMAKE_DISABLE_FIND_PACKAGE_LibXml2=ON"
        demanding = "-DMCANOPEN_ARGUMENTS=COMPONENTS;static"
        self.configure(self.folder / "without", missing)
        with self.assertRaisesRegex(AssertionError, r"static\s+needs[^:]*\sfiles\s+of\s+libxml2"):
            self.configure(self.folder / "refused", missing, demanding)
        self.configure(self.folder / "static", demanding)


class Cxx(Applications, InstalledCopy):
    language, standard = "CXX", "-std=c++17"
    shared_source = static_source = HERE / "boot.cpp"


class Fetched(InstalledCopy):
    """FetchContent: the application's project installs the library as well."""

    @classmethod
    def install(cls):
        return Installation(cls.settings, cls.folder / "application")

    def test_after_the_build_folder_is_gone(self):
        build = self.folder / "build"
        self.configure(build, f"-DMCANOPEN_SOURCE={self.settings.source}",
                       f"-DCMAKE_INSTALL_LIBDIR={self.settings.libdir}",
                       f"-DCONSUMER_DCF={self.settings.network.with_name('pump.dcf')}")
        run(self.settings.cmake, "--build", build)
        ccf = (build / "pump.ccf").read_bytes()
        run(self.settings.cmake, "--install", build, "--prefix", self.copy.prefix, DESTDIR="")
        shutil.rmtree(build)
        self.copy.tool("dcf2ccf", self.settings.network.with_name("pump.dcf"),
                       self.folder / "pump.ccf")
        self.assertEqual(ccf, (self.folder / "pump.ccf").read_bytes())
        self.assertEqual(files_below(self.copy.prefix), sorted(
            self.settings.expected_files() + ["bin/shared", "bin/static"]))
        self.check_shared(self.copy.prefix / "bin/shared")
        self.check_static(self.copy.prefix / "bin/static")


def main(arguments):
    if not arguments:
        print(__doc__.strip())
        return 2
    InstalledCopy.settings = Settings(arguments[0])
    names = arguments[1:] or ["C", "Cxx", "Fetched"]
    unittest.main(argv=["test_install.py", "-v", *names])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
