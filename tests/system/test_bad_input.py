#!/usr/bin/env python3
"""Bad input to 'mcanopen boot' (and 'sim'): one message "file:line: error: ..." on stderr, the
documented exit code, and no frame on the bus.

With MCANOPEN_TEST_WRAP="valgrind -q --error-exitcode=99 --leak-check=full" it shows that these ways
out leave nothing behind.
"""
import re
import subprocess

import plant
from devices import UNSIGNED8, Entry, dcf, network, node, standard

USAGE, BUS = 2, 3
FILE = {"DCF_File": "five.dcf"}


def five(value=None, **options):
    return dcf(5, [*standard(5), Entry(0x2000, UNSIGNED8, 0, "rw", value)], **options)


# name: (XML, what the only error says; LINE stands for a line that holds the text behind it)
NETWORKS = {
    "malformed XML": (network([]).replace("</Baudrate>", "</Baud>"),
                      "network.xml:LINE(</Baud>): error: XML: "),
    "no XML": ("Net_No=0\n", "network.xml:1: error: XML: "),
    "another XML": ("<html/>\n", "network.xml:LINE(<html/>): error: the root element is html"),
    "empty": ("", "network.xml: error: the file is empty"),
    "unknown element": (network([node(5, Node_Name="pump")]),
                        "network.xml:LINE(Node_Name): error: Node_Name: "),
    "element in the wrong place": (network([node(5, Boot_Time=1000)]),
                                   "network.xml:LINE(Boot_Time): error: Boot_Time: belongs "),
    "value out of range": (network([node(5, Guard_Time=70000)]),
                           "network.xml:LINE(70000): error: Guard_Time: 70000 is out of range "),
    "no number": (network([node(5, SDO_Timeout="soon")]),
                  "network.xml:LINE(soon): error: SDO_Timeout: "),
    "node-ID out of range": (network([node(128)]),
                             "network.xml:LINE(128): error: Node_Id: 128 is out of range "),
    "bit rate": (network([node(5)], Baudrate=123), "network.xml:LINE(123): error: Baudrate: "),
    "duplicate node": (network([node(5), node(6), node(5)]),
                       "network.xml:LINE(<Node_Id>5</Node_Id>): error: Node_Id: "),
    "the manager's node-ID": (network([node(5)], Manager_Node_Id=5),
                              "network.xml:LINE(<Node_Id>5</Node_Id>): error: Node_Id: "),
    "missing DCF": (network([node(5, DCF_File="no.dcf")]),
                    "network.xml:LINE(no.dcf): error: DCF_File: no.dcf: no such file"),
    "missing CCF": (network([node(5, CCF_File="no.ccf")]),
                    "network.xml:LINE(no.ccf): error: CCF_File: no.ccf: no such file"),
    "directory as DCF": (network([node(5, DCF_File="folder")]),
                         "network.xml:LINE(folder): error: DCF_File: folder: a folder"),
}

# name: (device file, what the only error says)
DEVICES = {
    "DCF of another node-ID": (five().replace("NodeID=5", "NodeID=6"),
                               "five.dcf:LINE(NodeID=6): error: NodeID is 6, but "),
    "DCF of another bit rate": (five(baudrate=500),
                                "five.dcf:LINE(Baudrate=500): error: Baudrate is 500 kbit/s, "),
    "value that does not fit": (five(value=256),
                                "five.dcf:LINE(ParameterValue=256): error: "),
    "no value": (five(value="soon"), "five.dcf:LINE(ParameterValue=soon): error: "),
    "no device file": ("soon\n", "five.dcf:"),
    "empty device file": ("", "five.dcf:"),
}


def lines_with(text, part):
    return [number for number, line in enumerate(text.splitlines(), 1) if part in line]


def expectations(pattern, text):
    """The beginnings that a message may have."""
    found = re.search(r"LINE\((.*?)\)(?=:)", pattern)
    if not found:
        return [pattern]
    lines = lines_with(text, found.group(1))
    return [pattern.replace(found.group(0), str(line)) for line in lines]


class BadInput(plant.PlantTest):
    def setUp(self):
        super().setUp()
        self.log = self.dump()
        (self.folder / "folder").mkdir()

    def refused(self, command, code, beginnings):
        """One error, which begins in one of these ways; the only errors there are."""
        process = self.run_command([*plant.WRAP, plant.MCANOPEN, *command], cwd=self.folder)
        lines = process.err.text().splitlines()
        errors = [line for line in lines if "error: " in line]
        self.assertEqual(process.code, code, process.story())
        self.assertEqual(len(errors), 1, process.story())
        self.assertTrue(errors[0].startswith(tuple(beginnings)), f"{beginnings}\n{errors[0]}")
        self.assertEqual(process.out.text(), "", "output of a program that did nothing")
        plant.say(errors[0])

    def nothing_on_the_bus(self):
        self.assertEqual(self.log.end(), [])

    def test_networks(self):
        """faults of the network's file"""
        for name, (text, pattern) in NETWORKS.items():
            with self.subTest(name):
                self.write("network.xml", text)
                self.refused(["boot", "--once", "network.xml"], USAGE, expectations(pattern, text))
        self.nothing_on_the_bus()

    def test_devices(self):
        """faults of a device's file"""
        self.write("network.xml", network([node(5, **FILE)]))
        for name, (text, pattern) in DEVICES.items():
            with self.subTest(name):
                self.write("five.dcf", text)
                self.refused(["boot", "--once", "network.xml"], USAGE, expectations(pattern, text))
        self.nothing_on_the_bus()

    def test_ccf(self):
        """a concise DCF that ends too early, at each of its bytes"""
        self.write("five.dcf", five(value=7))
        self.write("network.xml", network([node(5, CCF_File="cut.ccf")]))
        made = self.run_command([plant.TOOLS / "dcf2ccf", "five.dcf", "five.ccf"], cwd=self.folder)
        self.assertEqual(made.code, 0, made.story())
        whole = (self.folder / "five.ccf").read_bytes()
        for size in range(len(whole)):
            with self.subTest(size=size):
                (self.folder / "cut.ccf").write_bytes(whole[:size])
                self.refused(["boot", "--once", "network.xml"], USAGE, ["cut.ccf: error: "])
        self.nothing_on_the_bus()

    def test_missing_files(self):
        """no network file, or a directory in its place"""
        for verb in (["boot", "--once"], ["sim", "--bus", self.bus.name]):
            with self.subTest(verb[0]):
                self.refused([*verb, "no.xml"], USAGE, ["no.xml: error: no such file"])
                self.refused([*verb, "folder"], USAGE, ["folder: error: a folder"])
                self.refused([*verb, "five.dcf/x"], USAGE, ["five.dcf/x: error: "])
        self.nothing_on_the_bus()

    def test_sim(self):
        """what the simulator does not take"""
        sim = ["sim", "-q", "--bus", self.bus.name]
        self.write("five.dcf", "soon\n")
        self.write("network.xml", network([node(5, **FILE)]))
        self.write("missing.xml", network([node(5, DCF_File="no.dcf")]))
        self.refused([*sim, "--node", 5, "no.eds"], USAGE, ["no.eds: error: no such file"])
        self.refused([*sim, "--node", 5, "folder"], USAGE, ["folder: error: a folder"])
        self.refused([*sim, "--node", 5, "five.dcf"], USAGE, ["five.dcf:"])
        self.refused([*sim, "network.xml"], USAGE, ["five.dcf:"])
        self.refused([*sim, "missing.xml"], USAGE,
                     ["missing.xml:8: error: DCF_File: no.dcf: no such file"])
        self.nothing_on_the_bus()


class FullDevice(plant.PlantTest):
    def test_output(self):
        """what is printed is lost: the exit code tells"""
        with open("/dev/full", "w", encoding="ascii") as full:
            code = subprocess.run([*plant.WRAP, plant.MCANOPEN, "boot", "--help"], stdout=full,
                                  stderr=subprocess.DEVNULL, check=False).returncode
        self.assertEqual(code, USAGE)


class BadCommand(plant.PlantTest):
    def refused(self, words, code, text):
        process = self.run_command([*plant.WRAP, plant.MCANOPEN, *words], cwd=self.folder)
        self.assertEqual(process.code, code, process.story())
        self.assertIn(text, process.err.text(), process.story())
        self.assertTrue(process.err.text().startswith(("mcanopen", "Usage", "/")), process.story())
        self.assertEqual(process.out.text(), "", process.story())
        plant.say(f"mcanopen {' '.join(map(str, words))}: {process.err.text().splitlines()[0]}")

    def test_usage(self):
        """no arguments, unknown options, too many files: usage, exit code 2"""
        for words in ([], ["fly"], ["boot"], ["boot", "--fast", "a.xml"], ["boot", "a", "b"],
                      ["sim"], ["sim", "--fast"], ["sim", "a", "b"], ["dump"],
                      ["dump", "--fast", "b"], ["dump", "a", "b"]):
            with self.subTest(" ".join(words)):
                self.refused(words, USAGE, "Usage: mcanopen")

    def test_arguments(self):
        """options with arguments that cannot be meant"""
        for words in (["boot", "--timeout", "0", "a"], ["boot", "--timeout", "soon", "a"],
                      ["sim", "--node", "0", "a"], ["sim", "--node", "128", "a"],
                      ["sim", "--node", "5"], ["sim", "--without", "x", "a"],
                      ["sim", "--net", "x", "a"], ["sim", "--defect", "none", "a"],
                      ["sim", "--defect", "nmt-stop", "--node", "5", "a", "--node", "6", "b"],
                      ["dump", "-n", "x", "a"]):
            with self.subTest(" ".join(words)):
                self.refused(words, USAGE, words[1])

    def test_help(self):
        """--help is no error: exit code 0, on stdout"""
        for words in ([], ["boot"], ["sim"], ["dump"]):
            process = self.run_command([*plant.WRAP, plant.MCANOPEN, *words, "--help"])
            self.assertEqual((process.code, process.err.text()), (0, ""), process.story())
            self.assertIn("Usage: mcanopen", process.out.text())

    def test_bus(self):
        """no such interface, names that none can have: exit code 3"""
        xml = self.write("network.xml", network([node(5)]))
        for name in ("nosuchcan0", "lo", "virtual:", "virtual:a/b", "virtual:a b",
                     "virtual:" + "x" * 200, "a" * 50):
            with self.subTest(name):
                self.bus.name = name
                self.refused(["boot", "--once", xml], BUS, "network.xml:3: error: ")
                self.refused(["sim", "-q", "--bus", name, xml], BUS, "mcanopen sim: ")
                self.refused(["dump", name], BUS, "mcanopen dump: ")
        self.bus.name = "virtual:none-was-made"


if __name__ == "__main__":
    plant.main()
