#!/usr/bin/env python3
"""Concise DCFs of other make: dcfgen (PyPI dcf-tools) makes them of an EDS and a YAML file, dcf2ccf
of a DCF with the same values. They are the same byte for byte, or differ as EXPLAINED has it.

A difference is looked at exactly: without the entries that one side alone has, both have the same
ones; in the same order, where another order is not the difference; and all leave the same values.
"""
import configparser
import re
import struct
import subprocess
import sys
import unittest
import warnings
from collections import Counter
from types import SimpleNamespace

import yaml
from dcfgen.cli import Slave
from peers import plant, read_dictionary, variables
from devices import UNSIGNED8, UNSIGNED16, UNSIGNED32, Entry, Mapped, Record, dcf, standard

DCF2CCF = str(plant.TOOLS / "dcf2ccf")
IO = (plant.ROOT / "examples" / "cia401-io" / "cia401-io.eds").read_text(encoding="utf-8")
NODE = 5
OFF = 0x80000000
SIZE = 60000  # bytes of a file; larger ones take their time, and bring nothing new
FILES = 2  # of each project, for the same reason
INTEGERS = {*range(0x02, 0x08), 0x10, *range(0x12, 0x17), *range(0x18, 0x1C)}
SECTION = re.compile(r"^\[([0-9A-Fa-f]{4}(?:sub[0-9A-Fa-f]+)?)\][ \t]*\r?$", re.M | re.I)
VALUES = re.compile(r"^((ParameterValue|DownloadFile)[ \t]*=.*\n|\[[0-9A-F]{4}Value\][^[]*)",
                    re.M | re.I)  # with those of compact objects
NODE_LAST = re.compile(r"(0x[0-9A-F]+)\+\$NODEID", re.I)  # which dcfgen does not take
REFUSALS = (KeyError, ValueError, TypeError, AttributeError, struct.error, configparser.Error)

EXPLAINED = {
    "order": "dcfgen writes 1016h, 1012h, 1017h, 100Ch, 100Dh and 1029h first and the entries of "
             "'sdo' last, whatever they are; we other objects by index, then error control, then "
             "PDOs: what a PDO maps may depend on the others",
    "off first": "dcfgen does not switch a PDO off that is off by default, and no EMCY at all; we "
                 "do before anything else of a PDO changes, since the device may have saved other "
                 "values, and where an EMCY in use gets another CAN-ID",
    "default": "dcfgen leaves a value out that is the DefaultValue; we write each ParameterValue",
    "nothing mapped": "dcfgen does not write a mapping of nothing where that is the default",
}


def everything():
    """An EDS with what dcfgen has keys for."""
    def rpdo(number, cob_id, mapped):
        first, second = 0x1400 + number, 0x1600 + number
        communication = [Entry(first, UNSIGNED32, cob_id), Entry(first, UNSIGNED8, 255)]
        mapping = Record(second, [Entry(second, UNSIGNED32, each) for each in mapped])
        mapping.entries[0] = Entry(second, UNSIGNED8, sum(each != 0 for each in mapped))
        return [Record(first, communication), mapping]

    consumers = Record(0x1016, [Entry(0x1016, UNSIGNED32, 0), Entry(0x1016, UNSIGNED32, 0)])
    integers = [Entry(0x2000 + kind, kind, 0) for kind in
                (1, 2, 3, 4, 5, 6, 7, 0x10, 0x12, 0x13, 0x14, 0x15, 0x16, 0x18, 0x19, 0x1A, 0x1B)]
    pdos = sorted((*rpdo(0, "$NODEID+0x200", [0x60000108, 0]), *rpdo(1, "$NODEID+0x80000300", [0]),
                   *rpdo(2, "$NODEID+0x80000400", [0])), key=lambda each: each.index)
    values = Record(0x6000, [Mapped(0x6000, UNSIGNED8, 0, "rww"), Mapped(0x6000, UNSIGNED16, 0)])
    return dcf(None, [
        *standard(5)[:2], Entry(0x100C, UNSIGNED16, 0), Entry(0x100D, UNSIGNED8, 0),
        Entry(0x1012, UNSIGNED32, 0x100), Entry(0x1014, UNSIGNED32, "$NODEID+0x80"), consumers,
        *standard(5)[2:], Record(0x1029, [Entry(0x1029, UNSIGNED8, 0)]), *pdos, *integers, values])


ALL = everything()

# name: (EDS, slave, its ParameterValues besides those of PDOs, explained differences: what we have
# more, as (why, index, sub, bytes), or "order")
CASES = {
    "heartbeat and PDOs": (IO, """
        heartbeat_producer: 200
        rpdo: {1: {cob_id: auto, transmission: 1, mapping: [{index: 0x6200, sub_index: 1}]}}
        tpdo: {1: {cob_id: 0x1A5, transmission: 254, inhibit_time: 100, event_timer: 50,
                   mapping: [{index: 0x6000, sub_index: 1}]}}
        """, {(0x1017, 0): 200}, []),
    "heartbeat of the master": (IO, """
        heartbeat_consumer: true
        heartbeat_producer: 200
        """, {(0x1016, 1): 0x7F05DC, (0x1017, 0): 200}, []),
    "guarding": (ALL, """
        guard_time: 100
        life_time_factor: 3
        """, {(0x100C, 0): 100, (0x100D, 0): 3}, []),
    "integers of each length": (ALL, """
        sdo: [{index: 0x2001, value: 1}, {index: 0x2002, value: -2}, {index: 0x2003, value: -3},
              {index: 0x2004, value: -4}, {index: 0x2005, value: 5}, {index: 0x2006, value: 6},
              {index: 0x2007, value: 7}, {index: 0x2015, value: -0x15},
              {index: 0x201B, value: 0xFFFFFFFFFFFFFFFF}]
        """, {(0x2001, 0): 1, (0x2002, 0): -2, (0x2003, 0): -3, (0x2004, 0): -4, (0x2005, 0): 5,
              (0x2006, 0): 6, (0x2007, 0): 7, (0x2015, 0): -0x15, (0x201B, 0): 2 ** 64 - 1}, []),
    "a PDO that is off and stays off": (ALL, """
        rpdo: {1: {cob_id: 0x80000206}}
        """, {}, []),
    "a mapping is taken away": (ALL, """
        rpdo: {1: {cob_id: auto, mapping: []}}
        """, {}, []),
    "everything": (ALL, """
        heartbeat_consumer: true
        heartbeat_producer: 200
        time_cob_id: 0x80000100
        error_behavior: {1: 1}
        rpdo: {1: {cob_id: 0x209, mapping: [{index: 0x6000, sub_index: 2}]}}
        sdo: [{index: 0x2007, value: 7}, {index: 0x2005, value: 5}]
        """, {(0x1016, 1): 0x7F05DC, (0x1017, 0): 200, (0x1012, 0): 0x80000100, (0x1029, 1): 1,
              (0x2007, 0): 7, (0x2005, 0): 5}, ["order"]),
    "another CAN-ID for EMCY": (ALL, """
        sdo: [{index: 0x1014, value: 0x90}]
        """, {(0x1014, 0): 0x90}, [("off first", 0x1014, 0, "90000080")]),
    "a PDO that is off by default": (ALL, """
        rpdo: {2: {cob_id: auto, transmission: 1, mapping: [{index: 0x6000, sub_index: 1}]}}
        """, {}, [("off first", 0x1401, 1, "05030080")]),
    "a transmission type that is the default": (ALL, """
        rpdo: {1: {cob_id: auto, transmission: 255, mapping: [{index: 0x6000, sub_index: 1}]}}
        """, {}, [("default", 0x1400, 2, "FF")]),
    "nothing mapped, as by default": (ALL, """
        rpdo: {3: {cob_id: 0x333, mapping: []}}
        """, {}, [("nothing mapped", 0x1602, 0, "00")]),
}


def entries(data):
    """[(index, sub, bytes)]"""
    count, position, found = struct.unpack_from("<I", data)[0], 4, []
    for _ in range(count):
        index, sub, size = struct.unpack_from("<HBI", data, position)
        found.append((index, sub, data[position + 7:position + 7 + size]))
        position += 7 + size
    assert position == len(data), "bytes behind the last entry"
    return found


def last_values(writes):
    return {(index, sub): data for index, sub, data in writes}


def pdo_parameters(slave, sizes):
    """The ParameterValues that the PDOs of a YAML file stand for; sizes: {(index, sub): bits}"""
    found = {}
    for kind, first, auto in (("rpdo", 0x1400, 0x200), ("tpdo", 0x1800, 0x180)):
        for number, pdo in slave.get(kind, {}).items():
            index, cob_id = first + number - 1, pdo["cob_id"]
            found[index, 1] = auto + (number - 1) * 0x100 + NODE if cob_id == "auto" else cob_id
            for key, sub in (("transmission", 2), ("inhibit_time", 3), ("event_timer", 5)):
                if key in pdo:
                    found[index, sub] = pdo[key]
            for sub, each in enumerate(pdo.get("mapping", []), 1):
                place = each["index"], each.get("sub_index", 0)
                found[index + 0x200, sub] = place[0] << 16 | place[1] << 8 | sizes[place]
            if "mapping" in pdo:
                found[index + 0x200, 0] = len(pdo["mapping"])
    return found


def with_parameters(eds, parameters):
    """The EDS as a DCF; the values stand right below the names of their sections."""
    for (index, sub), value in parameters.items():
        names = [f"{index:04X}sub{sub:X}"] + ([f"{index:04X}"] if sub == 0 else [])
        for name in names:
            eds, count = re.subn(rf"^(\[{name}\][ \t]*\r?\n)", rf"\1ParameterValue={value}\n", eds,
                                 flags=re.MULTILINE | re.IGNORECASE)
            if count:
                break
        else:
            raise AssertionError(f"no section for {index:04X}h:{sub:02X}")
    return eds


class DcfgenTest(plant.PlantTest):
    def our_bytes(self, eds, parameters):
        self.write("ours.dcf", with_parameters(eds, parameters))
        made = self.run_command([DCF2CCF, "-q", "-n", NODE, "ours.dcf"], cwd=self.folder)
        self.assertEqual(made.code, 0, made.story())
        return (self.folder / "ours.ccf").read_bytes()


class Dcfgen(DcfgenTest):
    def their_bytes(self, slaves):
        """[bytes] of [(EDS, slave)], in one run."""
        network = {"master": {"node_id": 127, "heartbeat_producer": 500}}
        for number, (eds, slave) in enumerate(slaves):
            self.write(f"{number}.eds", eds)
            network[f"device{number}"] = {"dcf": f"{number}.eds", "node_id": NODE, **slave}
        self.write("network.yml", yaml.safe_dump(network))
        subprocess.run([sys.executable, "-W", "ignore", "-m", "dcfgen.cli", "-S", "network.yml"],
                       cwd=self.folder, check=True)
        return [(self.folder / f"device{number}.bin").read_bytes() for number in range(len(slaves))]

    def compare(self, ours, theirs, explained):
        more = [(index, sub, bytes.fromhex(data)) for _, index, sub, data in
                (each for each in explained if each != "order")]
        self.assertEqual(last_values(ours), {**last_values(more), **last_values(theirs)})
        left = list(ours)
        for each in more:
            left.remove(each)
        self.assertEqual(Counter(left), Counter(theirs))
        self.assertEqual(left == theirs, "order" not in explained)

    def test_cases(self):
        """the same configuration of devices of the project"""
        slaves = [yaml.safe_load(text) for _, text, _, _ in CASES.values()]
        made = self.their_bytes([(case[0], slave) for case, slave in zip(CASES.values(), slaves)])
        told = set()
        for (name, case), slave, theirs in zip(CASES.items(), slaves, made):
            with self.subTest(name):
                eds, _, others, explained = case
                sizes = {(each.index, each.subindex): len(each)
                         for each in variables(read_dictionary(eds, NODE))}
                ours = self.our_bytes(eds, {**others, **pdo_parameters(slave, sizes)})
                self.assertEqual(ours == theirs, not explained, f"{ours.hex()}\n{theirs.hex()}")
                self.compare(entries(ours), entries(theirs), explained)
                told |= {each if each == "order" else each[0] for each in explained}
        self.assertEqual(told, set(EXPLAINED))


class Chooser:
    """What to configure of a device that dcfgen has read: entries with sections of their own."""

    def __init__(self, device, eds):
        self.device, self.chosen = device, None
        self.sections = {name.upper() for name in SECTION.findall(eds)}

    def has(self, index, *subs):
        return all(self.has_entry(index, sub) for sub in subs)

    def has_entry(self, index, sub):
        entry = self.device.get(index, {}).get(sub)
        names = {f"{index:04X}SUB{sub:X}", *([f"{index:04X}"] if sub == 0 else [])}
        return entry and entry.access_type.write and entry.data_type.index in INTEGERS \
            and names & self.sections

    def mapping(self):
        return [{"index": index, "sub_index": sub} for index in sorted(self.device)
                for sub, entry in self.device[index].items() if index >= 0x2000
                and entry.pdo_mapping and entry.data_type.index in INTEGERS][:2]

    def pdo(self, first, known):
        """{number: PDO} of the first one that can be configured."""
        mapping = self.mapping()
        for number in range(1, 5):
            index = first + number - 1
            if mapping and self.has(index, 1, 2) and self.has(index + 0x200, 0, 1, len(mapping)):
                kind = 1 if known[number].transmission_type != 1 else 2
                return {number: {"cob_id": "auto", "transmission": kind, "mapping": mapping}}
        return {}

    def values(self):
        """Of some objects of the manufacturer, the number 1."""
        found = [(index, sub) for index in sorted(self.device) if 0x2000 <= index < 0x6000
                 for sub in sorted(self.device[index]) if self.has(index, sub)
                 and not hasattr(self.device[index][sub], "low_limit")
                 and not hasattr(self.device[index][sub], "high_limit")]
        return [{"index": index, "sub_index": sub, "value": 1} for index, sub in found[:5]]

    def slave(self):
        """As in the YAML file."""
        if not self.chosen:
            self.chosen = {"rpdo": self.pdo(0x1400, self.device.rpdo), "sdo": self.values(),
                           "tpdo": self.pdo(0x1800, self.device.tpdo)}
            if self.has(0x1017, 0):
                self.chosen["heartbeat_producer"] = 1234
        return self.chosen

    def parameters(self):
        """The same as ParameterValues."""
        slave = self.slave()
        sizes = {(index, sub): entry.data_type.bits() for index, entries_ in self.device.items()
                 for sub, entry in entries_.items() if entry.data_type.index in INTEGERS}
        found = pdo_parameters(slave, sizes)
        found.update({(each["index"], each["sub_index"]): each["value"] for each in slave["sdo"]})
        if "heartbeat_producer" in slave:
            found[0x1017, 0] = slave["heartbeat_producer"]
        return found


def place(write):
    """Where we write it: see "order"."""
    index, sub, _ = write
    if 0x1400 <= index < 0x1C00:
        return 2, index & ~0x200, 0
    return (index in (0x100C, 0x100D, 0x1016, 0x1017), index, sub)


def as_we_do(theirs, told):
    """The writes of dcfgen with what is explained applied to them."""
    ours = sorted(theirs, key=place)
    if ours != theirs:
        told["order"] += 1
    for index, sub, data in theirs:
        off = index, sub, struct.pack("<I", int.from_bytes(data, "little") | OFF)
        if 0x1400 <= index < 0x1C00 and not index & 0x200 and sub == 1 and off not in ours:
            ours.insert(next(i for i, write in enumerate(ours)
                             if write[0] in (index, index + 0x200)), off)
            told["off first"] += 1
    return ours


def sources():
    """The first files of each project."""
    found = {}
    for path in sorted(plant.CORPUS.rglob("*")):
        if path.suffix.lower() in (".eds", ".dcf") and path.stat().st_size < SIZE:
            found.setdefault(path.parent, []).append(path)
    return [path for paths in found.values() for path in paths[:FILES]]


def text_of(path):
    try:
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        return path.read_text(encoding="latin-1")


@unittest.skipUnless(plant.CORPUS.is_dir(), f"no corpus in {plant.CORPUS}")
class DcfgenCorpus(DcfgenTest):
    """Real files; those that dcfgen does not take, or without anything to write, are left out."""

    def their_writes(self, eds):
        """What was chosen, and the writes; None: dcfgen does not take this file."""
        path = self.write("device.eds", eds)
        options = {"cob_id": 0x680, "dcf_path": "", "heartbeat_multiplier": 3.0, "retry_factor": 3}
        arguments = SimpleNamespace(no_strict=True)
        given = {"dcf": str(path), "node_id": NODE}
        try:
            chooser = Chooser(Slave.from_dcf(str(path), {"NODEID": NODE}, arguments), eds)
            made = Slave.from_config("a", {**given, **chooser.slave()}, options, arguments)
        except REFUSALS:
            return None, []
        return chooser, entries(struct.pack("<I", len(made.sdo)) + b"".join(made.sdo))

    def compare(self, eds, told):
        chooser, theirs = self.their_writes(eds)
        if theirs:
            ours = entries(self.our_bytes(eds, chooser.parameters()))
            self.assertEqual(ours, as_we_do(theirs, told))
        return len(theirs)

    def test_files(self):
        """the same bytes, but for what is explained"""
        warnings.simplefilter("ignore")
        told, counts = Counter(), []
        for path in sources():
            with self.subTest(path=path.name):
                text = NODE_LAST.sub(r"$NODEID+\1", VALUES.sub("", text_of(path)))
                counts.append(self.compare(text, told))
        compared = [count for count in counts if count]
        self.assertGreater(len(compared), 20)
        self.assertLessEqual(set(told), set(EXPLAINED))
        plant.say(f"{sum(compared)} writes to {len(compared)} of {len(counts)} devices; "
                  f"explained: {dict(told)}")


if __name__ == "__main__":
    plant.main()
