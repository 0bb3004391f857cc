#!/usr/bin/env python3
"""All files of the corpus, read by us and by python-canopen: index and sub-index, data type, access
and default value with node-ID 5 are the same, or DIFFERENCES tells why not.

Files that python-canopen does not take are only read by us.
"""
import configparser
import fnmatch
import logging
import struct
import subprocess
import unittest
from dataclasses import dataclass

from canopen.objectdictionary import datatypes, import_od
from peers import plant, variables

NODE = 5
VALUES = str(plant.TOOLS.parent / "tests" / "dcf_values")
SIZES = {0x01: 1, 0x02: 1, 0x03: 2, 0x04: 4, 0x05: 1, 0x06: 2, 0x07: 4, 0x10: 3, 0x12: 5, 0x13: 6,
         0x14: 7, 0x15: 8, 0x16: 3, 0x18: 5, 0x19: 6, 0x1A: 7, 0x1B: 8}
OURS_ALONE, TYPE, ACCESS, DEFAULT = "ours alone", "type", "access", "default"

# File, object, what differs, why. An object is a pattern, or "compact": of an object with
# CompactSubObj or CompactPDO; "empty": the line is "DefaultValue=".
DIFFERENCES = [
    ("*", "compact", OURS_ALONE,
     "python-canopen makes sub-indices behind the first when they are asked for, and no PDOs"),
    ("*", "compact", ACCESS,
     "sub-index 0 is const (CiA 306); python-canopen gives it no access of its own, so rw"),
    ("*", "compact", DEFAULT,
     "sub-index 0 is the number of the others, which python-canopen does not tell"),
    ("*", "empty", DEFAULT, "an empty default is none; python-canopen takes an empty string"),
    ("*/sample.eds", "2020:00", TYPE, "40h is no type of CiA 301: python-canopen takes DOMAIN"),
    ("Daxbot+node-canopen/test.eds", "20??:00", TYPE,
     "1Ch to 1Fh are reserved: python-canopen takes DOMAIN"),
    ("oresat+oresat-firmware/app~39ada83f.eds", "10??:0?", DEFAULT,
     "DataType 0: no type, no value of it"),
    ("oresat+oresat-firmware/app~abf4de6e.eds", "6007:0?", ACCESS, 'the file has "r"'),
    ("oresat+oresat-firmware/app~d369ea83.eds", "6005:0?", DEFAULT,
     'OCTET_STRING "0": meant as a byte; python-canopen wants pairs of digits'),
    ("samsamfire+gocanopen/base~*.eds", "20??:00", DEFAULT,
     "a REAL as hexadecimal bit pattern, which python-canopen does not take"),
    ("ipa320+cob_robots/ElmoSimplIQ.dcf", "100B:00", DEFAULT,
     "$NODEID alone, which python-canopen does not take"),
]


@dataclass
class Value:
    type: int
    access: str
    default: str  # bytes in hexadecimal, or "-"


class File:
    """The sections of a file as text, for what a difference is about."""

    def __init__(self, path):
        self.name = str(path.relative_to(plant.CORPUS))
        self.sections = {}
        keys = {}
        for line in path.read_bytes().decode("latin-1").splitlines():
            key, equals, value = line.partition("=")
            if line.startswith("["):
                keys = self.sections.setdefault(line[1:line.index("]")].lower(), {})
            elif equals:
                keys[key.strip().lower()] = value.strip()

    def section(self, index, sub):
        whole = self.sections.get(f"{index:04x}", {})
        return self.sections.get(f"{index:04x}sub{sub:x}", whole if sub == 0 else {})

    def is_compact(self, index):
        whole = self.sections.get(f"{index:04x}", {})
        compact_pdo = self.sections.get("deviceinfo", {}).get("compactpdo", "0")
        is_pdo = 0x1400 <= index <= 0x1BFF and compact_pdo != "0"
        return whole.get("compactsubobj", "0") != "0" or is_pdo and not whole

    def matches(self, place, what):
        """What stands in DIFFERENCES for an object."""
        if what == "compact":
            return self.is_compact(place[0])
        if what == "empty":
            return self.section(*place).get("defaultvalue") == ""
        return fnmatch.fnmatchcase(f"{place[0]:04X}:{place[1]:02X}", what)


def files():
    return [path for path in sorted(plant.CORPUS.rglob("*"))
            if path.suffix.lower() in (".eds", ".dcf")]


def read_ours(paths):
    """{path: {(index, sub-index): Value}}"""
    done = subprocess.run([VALUES, str(NODE), *map(str, paths)], capture_output=True, text=True,
                          check=True, timeout=plant.LIMIT)
    found = {}
    for line in done.stdout.splitlines():
        if line.startswith("= "):
            values = found.setdefault(line[2:], {})
            continue
        index, sub, kind, access, default = line.split(" ")
        values[int(index, 16), int(sub, 16)] = Value(int(kind, 16), access, default)
    return found


def default_of(entry):
    """As bytes; texts have theirs as in the file, numbers those of their type."""
    value = entry.default
    if value is None:
        return "-"
    if isinstance(value, bytes):
        return value.hex()
    if isinstance(value, str):
        unicode = entry.data_type == datatypes.UNICODE_STRING
        return value.encode("utf-16-le" if unicode else "utf-8").hex()
    if isinstance(value, float):
        return struct.pack("<f" if entry.data_type == datatypes.REAL32 else "<d", value).hex()
    size = SIZES.get(entry.data_type)
    if not size:
        return f"{value}, of no type"
    return (value & ((1 << 8 * size) - 1)).to_bytes(size, "little").hex()


def read_theirs(path):
    """The same by python-canopen; None where it does not take the file."""
    try:
        dictionary = import_od(str(path), NODE)
    except (ValueError, configparser.Error):
        return None
    return {(each.index, each.subindex): Value(each.data_type, each.access_type, default_of(each))
            for each in variables(dictionary)}


def differences(ours, theirs):
    """(place, what, ours, theirs)"""
    for place in sorted(ours.keys() | theirs.keys()):
        mine, other = ours.get(place), theirs.get(place)
        if not mine or not other:
            yield place, OURS_ALONE if mine else "theirs alone", mine, other
            continue
        for what in (TYPE, ACCESS, DEFAULT):
            if getattr(mine, what) != getattr(other, what):
                yield place, what, getattr(mine, what), getattr(other, what)


@unittest.skipUnless(plant.CORPUS.is_dir(), f"no corpus in {plant.CORPUS}")
class Reading(unittest.TestCase):
    def explain(self, file, difference):
        """The rows of the table that tell why; there has to be one."""
        place, what, ours, theirs = difference
        rows = [row for row in DIFFERENCES
                if row[2] == what and fnmatch.fnmatchcase(file.name, row[0])
                and file.matches(place, row[1])]
        self.assertTrue(rows, f"{file.name}: {place[0]:04X}h:{place[1]:02X} {what}: "
                              f"we read {ours}, python-canopen reads {theirs}")
        return rows

    def test_same_as_python_canopen(self):
        """python-canopen reads the same from the corpus, but for what is listed"""
        logging.disable(logging.WARNING)
        paths = files()
        all_ours = read_ours(paths)
        needed, taken, values = [], 0, 0
        for path in paths:
            theirs = read_theirs(path)
            if theirs is None:
                continue
            taken += 1
            values += len(theirs)
            file = File(path)
            for difference in differences(all_ours[str(path)], theirs):
                needed += self.explain(file, difference)
        plant.say(f"{len(paths)} files, {taken} taken by python-canopen, {values} entries")
        for row in DIFFERENCES:
            self.assertIn(row, needed, "this difference does not occur")


if __name__ == "__main__":
    plant.main()
