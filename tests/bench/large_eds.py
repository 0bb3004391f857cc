#!/usr/bin/env python3
"""large_eds.py OBJECTS FILE: writes an EDS with so many objects, of all kinds that vendors have.

The same text each time. Every second object is a variable; the others are arrays and records of
three to eight sub-indices and compact arrays, so that there are about three sections to an object.
"""
import sys

FIRST, LAST = 0x2000, 0xFFFF
MANUFACTURER = range(0x2000, 0x6000)

STRING = "0x0009"
# Data type, default, limits
TYPES = [
    ("0x0005", "0x10", ("0x00", "0xFF")),
    ("0x0006", "1000", None),
    ("0x0007", "0x00000000", ("0", "0x0001FFFF")),
    ("0x0003", "-20", ("-32768", "32767")),
    ("0x0004", "0x0000C350", None),
    ("0x0008", "12.5", None),
    (STRING, "controller of the third axis", None),
    ("0x0001", "1", None),
    ("0x0007", "$NODEID+0x680", None),
]
ACCESS = ["rw", "ro", "rww", "const", "rwr", "wo"]
SUBS = [3, 4, 8, 5]

HEAD = """[FileInfo]
FileName=large.eds
FileVersion=1
FileRevision=0
EDSVersion=4.0
Description=Device with many objects
CreationTime=09:45AM
CreationDate=05-15-2023
CreatedBy=large_eds.py
ModificationTime=09:45AM
ModificationDate=05-15-2023
ModifiedBy=large_eds.py

[DeviceInfo]
VendorName=Example
VendorNumber=0x0000029A
ProductName=Large
ProductNumber=1
RevisionNumber=0x00010000
OrderCode=L-10000
{rates}
SimpleBootUpMaster=0
SimpleBootUpSlave=1
Granularity=8
DynamicChannelsSupported=0
CompactPDO=0
GroupMessaging=0
NrOfRXPDO=4
NrOfTXPDO=4
LSS_Supported=0

[DummyUsage]
{dummies}

[Comments]
Lines=1
Line1=A device with more objects than any that can be bought

"""


def write_entry(out, section, name, i, sub=None):
    kind, default, limits = TYPES[i % len(TYPES)]
    out.append(f"[{section}]\nParameterName={name}\nObjectType=0x7\nDataType={kind}\n")
    if limits:
        out.append(f"LowLimit={limits[0]}\nHighLimit={limits[1]}\n")
    mapping = 0 if kind == STRING else i % 2
    out.append(f"AccessType={ACCESS[(i + (sub or 0)) % len(ACCESS)]}\nDefaultValue={default}\n"
               f"PDOMapping={mapping}\n")
    if i % 5 == 0:
        out.append("ObjFlags=0x0\n")
    out.append("\n")


def write_count(out, index, count, access="const"):
    out.append(f"[{index:04X}sub0]\nParameterName=Highest sub-index supported\nObjectType=0x7\n"
               f"DataType=0x0005\nAccessType={access}\nDefaultValue={count}\nPDOMapping=0\n\n")


def write_structure(out, index, kind, name, count):
    out.append(f"[{index:04X}]\nParameterName={name}\nObjectType={kind}\n"
               f"SubNumber={count + 1}\n\n")


def write_group(out, index, i):
    count = SUBS[i // 4 % len(SUBS)]
    write_structure(out, index, "0x8" if i % 8 == 1 else "0x9", f"Parameters of unit {i}", count)
    write_count(out, index, count)
    for sub in range(1, count + 1):
        number = i if i % 8 == 1 else i + sub
        write_entry(out, f"{index:04X}sub{sub:X}", f"Parameter {sub} of unit {i}", number, sub)


def write_compact(out, index, i):
    out.append(f"[{index:04X}]\nParameterName=Samples of unit {i}\nObjectType=0x8\n"
               f"DataType=0x0006\nAccessType=ro\nDefaultValue=0\nPDOMapping=0\n"
               f"CompactSubObj={SUBS[i // 4 % 4]}\n\n")


def write_object(out, index, i):
    if i % 2 == 0:
        write_entry(out, f"{index:04X}", f"Value of unit {i}", i)
    elif i % 16 == 15:
        write_compact(out, index, i)
    else:
        write_group(out, index, i)


def write_number(out, section, name, kind, default):
    """The kind as data type and access: "0x0007 rw"."""
    data_type, access = kind.split()
    out.append(f"[{section}]\nParameterName={name}\nObjectType=0x7\nDataType={data_type}\n"
               f"AccessType={access}\nDefaultValue={default}\nPDOMapping=0\n\n")


def write_pdos(out, first, cob_ids, name):
    for i, cob_id in enumerate(cob_ids):
        index = first + i
        write_structure(out, index, "0x9", f"{name} parameter {i + 1}", 2)
        write_count(out, index, 2)
        write_number(out, f"{index:04X}sub1", "COB-ID", "0x0007 rw", f"$NODEID+{cob_id}")
        write_number(out, f"{index:04X}sub2", "Transmission type", "0x0005 rw", "255")
    for i in range(len(cob_ids)):
        index = first + 0x200 + i
        write_structure(out, index, "0x9", f"{name} mapping {i + 1}", 8)
        write_count(out, index, 0, "rw")
        for sub in range(1, 9):
            write_number(out, f"{index:04X}sub{sub}", f"Object {sub}", "0x0007 rw", "0")


def write_common(out):
    write_number(out, "1000", "Device type", "0x0007 ro", "0")
    write_number(out, "1001", "Error register", "0x0005 ro", "0")
    write_number(out, "1005", "COB-ID SYNC", "0x0007 rw", "0x80")
    write_number(out, "1014", "COB-ID EMCY", "0x0007 rw", "$NODEID+0x80")
    write_number(out, "1017", "Producer heartbeat time", "0x0006 rw", "1000")
    write_structure(out, 0x1018, "0x9", "Identity", 4)
    write_count(out, 0x1018, 4)
    for sub, (name, value) in enumerate([("Vendor-ID", "0x0000029A"), ("Product code", "1"),
                                         ("Revision number", "0x00010000"),
                                         ("Serial number", "0")], 1):
        write_number(out, f"1018sub{sub}", name, "0x0007 ro", value)
    write_pdos(out, 0x1400, ["0x200", "0x300", "0x400", "0x500"], "RPDO")
    write_pdos(out, 0x1800, ["0x180", "0x280", "0x380", "0x480"], "TPDO")


COMMON = ([0x1000, 0x1001, 0x1018], [0x1005, 0x1014, 0x1017]
          + [first + i for first in (0x1400, 0x1600, 0x1800, 0x1A00) for i in range(4)])


def write_list(out, name, indices):
    out.append(f"[{name}]\nSupportedObjects={len(indices)}\n")
    out.extend(f"{i}=0x{index:04X}\n" for i, index in enumerate(indices, 1))
    out.append("\n")


def make(objects):
    """The text of an EDS with so many objects besides the common ones."""
    if objects > LAST - FIRST + 1:
        raise ValueError(f"at most {LAST - FIRST + 1} objects have an index")
    own = range(FIRST, FIRST + objects)
    out = [HEAD.format(
        rates="\n".join(f"BaudRate_{rate}=1" for rate in (10, 20, 50, 125, 250, 500, 800, 1000)),
        dummies="\n".join(f"Dummy{i:04X}={int(i >= 5)}" for i in range(1, 8)))]
    write_list(out, "MandatoryObjects", COMMON[0])
    write_list(out, "OptionalObjects", COMMON[1] + [i for i in own if i not in MANUFACTURER])
    write_list(out, "ManufacturerObjects", [i for i in own if i in MANUFACTURER])
    write_common(out)
    for i, index in enumerate(own):
        write_object(out, index, i)
    return "".join(out)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with open(sys.argv[2], "w", encoding="ascii", newline="\n") as file:
        file.write(make(int(sys.argv[1])))
