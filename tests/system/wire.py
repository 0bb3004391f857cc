#!/usr/bin/env python3
"""Compares two records of the same conversation on the bus, as tests/support/wire_log.h does.

    wire.py EXPECTED ACTUAL      files; exit code 0 the same, 1 not, with the place

Lines are "(seconds) interface ID#DATA", as candump -L and mcanopen dump print them, or "ID#DATA"
alone; '#' at the beginning of a line makes it a comment. Time stamps, and what different nodes say
in which order, do not count: nodes boot in parallel. What counts:

  - the NMT commands, in order
  - for each node its frames (CAN-IDs with its node-ID, and NMT commands to it or to all), in order
  - for each node the states its heartbeats tell, in order, among themselves: a heartbeat that
    tells the same state again is cut, so it does not matter how long a log goes on
"""
import re
import sys
from itertools import zip_longest
from pathlib import Path

THE_END = "the end"
FRAME = re.compile(r"[0-9A-F]{3}#(R|([0-9A-F]{2})*)")


def frames_of(text):
    """The frames of a log, as "ID#DATA"."""
    words = (line.split()[-1].upper() for line in text.splitlines()
             if line.strip() and not line.startswith("#"))
    return [word for word in words if FRAME.fullmatch(word)]


def _parts(frame):
    can_id, _, data = frame.partition("#")
    return int(can_id, 16), data


def is_heartbeat(frame):
    can_id, data = _parts(frame)
    return 0x700 < can_id < 0x780 and len(data) == 2 and data != "00"


def _lanes_of(frame):
    can_id, data = _parts(frame)
    if is_heartbeat(frame):
        return [("heartbeats of node", can_id & 0x7F)]
    if can_id != 0:
        return [("node", can_id & 0x7F)]
    target = int(data[2:4], 16)
    return [("network", 0)] + [("node", node) for node in range(1, 128) if target in (0, node)]


def lanes(frames):
    """{(kind, node): its frames}."""
    result = {}
    for frame in frames:
        for lane in _lanes_of(frame):
            in_lane = result.setdefault(lane, [])
            if not is_heartbeat(frame) or in_lane[-1:] != [frame]:
                in_lane.append(frame)
    return result


def difference(expected, actual):
    """Where two lists of frames part, as a text; None: nowhere."""
    one, other = lanes(expected), lanes(actual)
    for lane in sorted(one.keys() | other.keys()):
        pairs = zip_longest(one.get(lane, []), other.get(lane, []), fillvalue=THE_END)
        for number, (frame, is_frame) in enumerate(pairs, 1):
            if frame != is_frame:
                return f"{lane[0]} {lane[1]}, frame {number}: expected {frame}, is {is_frame}"
    return None


def main(arguments):
    texts = [frames_of(Path(name).read_text(encoding="utf-8")) for name in arguments]
    found = difference(*texts)
    print(found or f"the same: {len(texts[0])} and {len(texts[1])} frames")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
