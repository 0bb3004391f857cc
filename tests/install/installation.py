"""What the tests of an installed copy share: settings of the build, commands, simulated devices."""
import json
import os
import re
import subprocess
import tempfile
import time
from pathlib import Path

START_SECONDS = 30
RUN_SECONDS = 60


class Settings:
    """install.json, which CMake writes."""

    def __init__(self, file):
        values = json.loads(Path(file).read_text(encoding="utf-8"))
        self.source, self.build = Path(values["source"]), Path(values["build"])
        self.prefix, self.libdir = Path(values["prefix"]), values["libdir"]
        self.config, self.version = values["config"], values["version"]
        self.cmake, self.generator = values["cmake"], values["generator"]
        self.compilers = {"C": values["c_compiler"], "CXX": values["cxx_compiler"]}
        self.network = self.source / "examples" / "boot-network" / "network.xml"

    def expected_files(self):
        text = (self.source / "tests/install/files.txt").read_text(encoding="utf-8")
        words = {"LIBDIR": self.libdir, "CONFIG": (self.config or "noconfig").lower(),
                 "VERSION": self.version, "MAJOR": self.version.split(".", maxsplit=1)[0]}
        return sorted(re.sub("@([A-Z]+)@", lambda m: words[m[1]], text).splitlines())


def run(*command, **variables):
    """The output of a command that succeeds, with these environment variables besides."""
    done = subprocess.run([str(word) for word in command], text=True, timeout=300, check=False,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          env={**os.environ, **{k: str(v) for k, v in variables.items()}})
    if done.returncode != 0:
        words = " ".join(str(word) for word in command)
        raise AssertionError(f"exit code {done.returncode} of: {words}\n{done.stdout}")
    return done.stdout


def files_below(folder):
    """All files as files.txt has them."""
    found = []
    for path in folder.rglob("*"):
        name = str(path.relative_to(folder))
        if path.is_symlink():
            found.append(f"{name} -> {os.readlink(path)}")
        elif not path.is_dir():
            found.append(name)
    return sorted(found)


def dynamic_section(file):
    return run("readelf", "-dW", file)


def needed_by(file):
    return re.findall(r"\(NEEDED\)\s+Shared library: \[(.*)\]", dynamic_section(file))


class Installation:
    """A copy below a prefix, wherever that is now."""

    def __init__(self, settings, prefix):
        self.settings, self.prefix = settings, prefix
        self.libraries = prefix / settings.libdir

    def tool(self, name, *arguments, **variables):
        return run(self.prefix / "bin" / name, *arguments, **variables)

    def pkg_config(self, *arguments):
        return run("pkg-config", *arguments, "mcanopen",
                   PKG_CONFIG_PATH=self.libraries / "pkgconfig").split()

    def boots(self, program):
        """The output of an application that boots the simulated plant and ends well."""
        with Plant(self) as bus:
            return run("timeout", RUN_SECONDS, program, self.settings.network,
                       MCANOPEN_NET_0=bus, LD_LIBRARY_PATH=self.libraries)


class Plant:
    """The devices of examples/boot-network, simulated by the installed tool on their own bus."""

    count = 0

    def __init__(self, installation):
        Plant.count += 1
        self.name = f"install-{os.getpid()}-{Plant.count}"
        self.installation = installation
        self.process = self.log = None

    def __enter__(self):
        bus = f"virtual:{self.name}"
        command = [self.installation.prefix / "bin/mcanopen", "sim", "-q", "--bus", bus,
                   self.installation.settings.network]
        self.log = tempfile.TemporaryFile("w+", encoding="utf-8")
        try:
            self.process = subprocess.Popen(command, stdout=self.log, stderr=subprocess.STDOUT)
            self.wait_until_up()
        except BaseException:
            self.__exit__()
            raise
        return bus

    def wait_until_up(self):
        end = time.monotonic() + START_SECONDS
        while "simulated devices on" not in self.output():
            if self.process.poll() is not None or time.monotonic() > end:
                raise AssertionError(f"mcanopen sim does not start:\n{self.output()}")
            time.sleep(0.02)

    def output(self):
        return os.pread(self.log.fileno(), 65536, 0).decode()

    def __exit__(self, *_):
        self.log.close()
        if self.process:
            self.process.kill()
            self.process.wait()
        Path(f"/dev/shm/mcanopen-{os.getuid()}-{self.name}").unlink(missing_ok=True)
