"""A small reader of EDS and DCF files, of its own and not that of the library, for tests that make
configurations from real files and check on the wire what became of them.
"""
import re
import struct

SECTION = re.compile(r"\s*\[([^\]]*)\]")
ENTRY = re.compile(r"([0-9A-F]{4})(?:sub([0-9A-F]{1,2}))?$", re.IGNORECASE)
WRITABLE = ("rw", "rwr", "rww")
BOOLEAN, VISIBLE_STRING, REAL32, REAL64 = 1, 9, 8, 0x11
UNSIGNED = {5: 8, 6: 16, 7: 32, 0x1B: 64, 0x16: 24, 0x18: 40, 0x19: 48, 0x1A: 56}
SIGNED = {2: 8, 3: 16, 4: 32, 0x15: 64, 0x10: 24, 0x12: 40, 0x13: 48, 0x14: 56}
BITS = {**UNSIGNED, **SIGNED, BOOLEAN: 8, REAL32: 32, REAL64: 64}


def number(text, node=0):
    """An integer or a formula with $NODEID; None: neither."""
    total = 0
    for term in text.upper().split("+"):
        term = term.strip()
        try:
            total += node if term == "$NODEID" else int(term, 16 if term.startswith("0X") else 10)
        except ValueError:
            return None
    return total


def encode(kind, text, node=0):
    """The bytes of a value on the wire; None: not a type for this reader."""
    if kind == VISIBLE_STRING:
        return text.encode("latin-1")
    if kind in (REAL32, REAL64):
        value = number(text)  # of a hexadecimal text these are the bits
        if value is None or not text.upper().startswith("0X"):
            return struct.pack("<f" if kind == REAL32 else "<d", float(text))
        return value.to_bytes(BITS[kind] // 8, "little")
    value = number(text, node)
    if value is None or kind not in BITS:
        return None
    return (value & ((1 << BITS[kind]) - 1)).to_bytes(BITS[kind] // 8, "little")


class Entry:
    def __init__(self, index, sub, keys):
        self.index, self.sub, self.keys = index, sub, keys
        self.kind = number(keys.get("datatype", "")) or 0
        self.access = keys.get("accesstype", "").lower()

    def is_object(self):
        """A head of sub-indexes, which has no value."""
        return number(self.keys.get("objecttype", "7")) != 7

    def default(self, node=0):
        return number(self.keys.get("defaultvalue", ""), node)

    def limits(self):
        """(lowest, highest), as far as given and plain; None: not to be understood here."""
        texts = self.keys.get("lowlimit", ""), self.keys.get("highlimit", "")
        if self.kind in (REAL32, REAL64) and any(texts):
            return None
        bits = BITS.get(self.kind, 0)
        lowest = -1 << (bits - 1) if self.kind in SIGNED else 0
        highest = lowest + (1 << bits) - 1
        given = [number(text) if text else plain
                 for text, plain in zip(texts, (lowest, highest))]
        if None in given or not lowest <= given[0] <= given[1] <= highest:
            return None
        return (lowest, highest) if given == [0, 0] else tuple(given)


class File:
    def __init__(self, path):
        self.path = path
        self.lines = path.read_text(encoding="latin-1").splitlines()
        self.sections, self.ends = {}, {}
        name = ""
        for place, line in enumerate(self.lines):
            head = SECTION.match(line)
            if head:
                name = head.group(1).strip().lower()
            elif "=" in line and not line.lstrip().startswith((";", "#")):
                key, _, value = line.partition("=")
                self.sections.setdefault(name, {})[key.strip().lower()] = value.strip()
                self.ends[name] = place + 1
        self.entries = {(entry.index, entry.sub): entry for entry in self._entries()}

    def _entries(self):
        for name, keys in self.sections.items():
            found = ENTRY.match(name)
            if found and not (found.group(2) is None and Entry(0, 0, keys).is_object()):
                yield Entry(int(found.group(1), 16), int(found.group(2) or "0", 16), keys)

    def vendor(self):
        return self.sections.get("deviceinfo", {}).get("vendorname", "")

    def commissioning(self):
        for name in ("devicecomissioning", "devicecommissioning"):
            if name in self.sections:
                return self.sections[name]
        return {}

    def section_of(self, entry):
        for name in (f"{entry.index:04x}sub{entry.sub:x}", f"{entry.index:04x}"):
            if self.sections.get(name) is entry.keys:
                return name
        raise KeyError(f"{self.path}: {entry.index:04X}:{entry.sub:02X}")

    def configured(self, values, node, baudrate):
        """The text of a DCF: this file with a ParameterValue for each of {entry: text}."""
        added = {self.ends[self.section_of(entry)]: f"ParameterValue={text}"
                 for entry, text in values.items()}
        lines = []
        for place, line in enumerate(self.lines + [""]):
            lines += [added[place]] if place in added else []
            lines.append(line)
        if not self.commissioning():
            lines += ["[DeviceComissioning]", f"NodeID={node}", f"Baudrate={baudrate}", ""]
        return "\n".join(lines)


def downloads(frames, node):
    """[(index, sub, bytes)] that SDO downloads to a node have brought, in order."""
    done, current = [], None
    for frame in frames:
        can_id, _, data = frame.partition("#")
        if int(can_id, 16) != 0x600 + node:
            continue
        request = bytes.fromhex(data)
        command = request[0] >> 5
        if command == 1:
            current = (int.from_bytes(request[1:3], "little"), request[3], b"")
            if request[0] & 2:
                size = 4 - (request[0] >> 2 & 3) if request[0] & 1 else 4
                done.append((*current[:2], request[4:4 + size]))
        elif command == 0 and current:
            current = (*current[:2], current[2] + request[1:8 - (request[0] >> 1 & 7)])
            if request[0] & 1:
                done.append(current)
        else:
            current = None
    return done
