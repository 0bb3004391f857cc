#!/usr/bin/env python3
"""Files that nobody means, given to all tools that read files: 2 GB, lines of 10 MB, ten million
sections, folders, pipes, devices. With 512 MiB of addresses each gives a clear message and the exit
code of a bad file, or is taken; none needs more memory, prints for ever or hangs.
"""
import concurrent.futures
import ctypes
import os
import re
import resource
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

import plant
from hostile import CONCISE, DEVICES, MIB, NETWORKS

ADDRESSES = 512 * MIB
LINES = 10_100  # dcftest shows the most: 10,000 findings of each severity
BUS = "virtual:hostile-files"
PR_CAPBSET_DROP, CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH = 24, 1, 2


def tool(name):
    return str(plant.TOOLS / name)


# The command before the file, and the exit code where the file is refused.
DEVICE_TOOLS = {
    "dcftest": ([tool("dcftest")], 1),
    "dcf2ccf": ([tool("dcf2ccf"), "--output", "/dev/null"], 2),
    "ccfread": ([tool("ccfread"), "--eds"], 2),
    "sim": ([plant.MCANOPEN, "sim", "--bus", BUS, "--node", "5"], 2),
}
NETWORK_TOOLS = {
    "boot": ([plant.MCANOPEN, "boot", "--once"], 2),
    "check": ([plant.MCANOPEN, "check"], 1),
    "check": ([plant.MCANOPEN, "check"], 1),
    "sim": ([plant.MCANOPEN, "sim", "--bus", BUS], 2),
    "dcf2ccf": ([tool("dcf2ccf"), "--output", "/dev/null", "--from-network"], 2),
}
CONCISE_TOOLS = {"ccfread": ([tool("ccfread")], 1)}

SIM_DOES_NOT_READ = ("CCF", "software", "pipe in it")
INNER = "pipe|folder|2 GB|64 MB|/dev/zero"  # files that others name

# What is no file at all: the error.
STRANGE = {
    "none": "o such file",
    "2 GB": "larger than 64 MiB",
    "folder": "folder|no file in it",
    "secret": "ermission denied|right",
    "/dev/zero": "larger than 64 MiB",
    "pipe": "nothing comes out of this pipe or device",
    "itself": "Too many levels of symbolic links",
}


def limit():
    """In the child: little memory, and no more rights to files than others have."""
    libc = ctypes.CDLL(None)
    resource.setrlimit(resource.RLIMIT_AS, (ADDRESSES, ADDRESSES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    for capability in (CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH):
        libc.prctl(PR_CAPBSET_DROP, capability, 0, 0, 0)


class HostileFiles(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="mcanopen-hostile-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        (cls.folder / "folder").mkdir()
        (cls.folder / "itself").symlink_to("itself")
        os.mkfifo(cls.folder / "pipe")
        (cls.folder / "secret").write_text("secret\n", encoding="ascii")
        (cls.folder / "secret").chmod(0)
        for name, size in ("2 GB", 2048 * MIB), ("64 MB", 64 * MIB):
            (cls.folder / name).touch()
            os.truncate(cls.folder / name, size)

    def setUp(self):
        if plant.SANITIZED or plant.WRAP:
            self.skipTest("programs with sanitizers do not start in little memory")

    def write(self, name, contents):
        data = contents if isinstance(contents, bytes) else contents.encode("latin-1")
        (self.folder / name).write_bytes(data)
        return name

    def run_tool(self, command):
        """The exit code, and all that was printed."""
        done = subprocess.run(command, cwd=self.folder, preexec_fn=limit, timeout=plant.LIMIT,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, check=False,
                              env=dict(os.environ, MCANOPEN_NET_0=BUS))
        return done.returncode, done.stdout.decode("utf-8", "replace")

    def judge(self, name, command, code, error):
        """error: a pattern; None: the file is taken."""
        ended, text = self.run_tool([*command, name])
        lines = text.splitlines()
        story = f"$ {' '.join(command)} '{name}'\nexit code {ended}\n" + "\n".join(lines[:20])
        self.assertLess(len(lines), LINES, story)
        self.assertNotIn("memory", text, story)
        if error is None:
            self.assertEqual(ended, 0, story)
            return
        self.assertEqual(ended, code, story)
        self.assertRegex(text, error, story)
        self.assertRegex(text, f"{re.escape(name)}|{INNER}", story)

    def judge_all(self, cases):
        """Several at a time: those with pipes wait, others work, and may take much memory."""
        threads = concurrent.futures.ThreadPoolExecutor
        with threads(os.cpu_count()) as workers, threads(32) as waiters:
            futures = {(waiters if "pipe" in case[0] else workers).submit(self.judge, *case): case
                       for case in cases}
            for future, case in futures.items():
                with self.subTest(f"{Path(case[1][0]).name} {case[0]}"):
                    future.result()

    def cases_of(self, files, tools, ending):
        for name, (contents, error) in files.items():
            file = self.write(name + ending, contents)
            for command, code in tools.values():
                simulates = command[1:2] == ["sim"]  # until it is ended; nothing is configured
                if not (simulates and (error is None or name.startswith(SIM_DOES_NOT_READ))):
                    yield file, command, code, error and re.escape(error)

    def test_device_files(self):
        """EDS and DCF files"""
        self.judge_all(self.cases_of(DEVICES, {key: DEVICE_TOOLS[key]
                                               for key in ("dcftest", "dcf2ccf", "sim")}, ".dcf"))

    def test_networks(self):
        """XML files, and what they name"""
        self.judge_all(self.cases_of(NETWORKS, NETWORK_TOOLS, ".xml"))

    def test_concise(self):
        """concise DCFs"""
        self.judge_all(self.cases_of(CONCISE, CONCISE_TOOLS, ".ccf"))

    def test_strange(self):
        """what is no file, or not readable"""
        tools = [*DEVICE_TOOLS.values(), *NETWORK_TOOLS.values(), ([tool("ccfread")], 2)]
        self.judge_all((name, command, code, error) for name, error in STRANGE.items()
                       for command, code in tools if command[1:] != ["--eds"])


if __name__ == "__main__":
    plant.main()
