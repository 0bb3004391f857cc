"""Texts of network and device files that the tests make."""

FILE = """[FileInfo]
FileName=device.dcf
FileVersion=1
FileRevision=1
EDSVersion=4.0
Description=made by a test
CreationTime=09:00AM
CreationDate=11-22-2026
CreatedBy=tests
LastEDS=device.eds

[DeviceInfo]
VendorName=tests
VendorNumber=0x29A
ProductName=simulated
ProductNumber=1
RevisionNumber=0x10001
OrderCode=T-1
BaudRate_10=0
BaudRate_20=0
BaudRate_50=0
BaudRate_125=0
BaudRate_250=0
BaudRate_500=0
BaudRate_800=0
BaudRate_1000=1
SimpleBootUpMaster=0
SimpleBootUpSlave=1
Granularity=8
NrOfRXPDO=0
NrOfTXPDO=0
LSS_Supported=0

[DummyUsage]
Dummy0005=1

"""
UNSIGNED8, UNSIGNED16, UNSIGNED32, VISIBLE_STRING = 5, 6, 7, 9


class Entry:
    """A VAR; value: what the configuration writes."""

    def __init__(self, index, kind, default, access="rw", value=None):
        self.index, self.kind, self.default = index, kind, default
        self.access, self.value = access, value
        self.mappable = 0

    def lines(self, number=None):
        yield f"[{self.index:04X}{'' if number is None else f'sub{number:X}'}]"
        yield f"ParameterName=object {self.index:04X}"
        yield "ObjectType=7"
        yield f"DataType=0x{self.kind:04X}"
        yield f"AccessType={self.access}"
        yield f"DefaultValue={self.default}"
        yield f"PDOMapping={self.mappable}"
        if self.value is not None:
            yield f"ParameterValue={self.value}"
        yield ""


class Mapped(Entry):
    """A VAR that may be in PDOs."""

    def __init__(self, *values):
        super().__init__(*values)
        self.mappable = 1


class Record:
    """A RECORD of entries; sub 0 is made here."""

    def __init__(self, index, entries):
        self.index = index
        self.entries = [Entry(index, UNSIGNED8, len(entries), "const"), *entries]

    def lines(self):
        yield from (f"[{self.index:04X}]", f"ParameterName=record {self.index:04X}",
                    "ObjectType=9", f"SubNumber={len(self.entries)}", "")
        for number, entry in enumerate(self.entries):
            yield from entry.lines(number)


def identity(serial, vendor=0x29A):
    values = (vendor, 1, 0x10001, serial)
    return Record(0x1018, [Entry(0x1018, UNSIGNED32, f"0x{v:X}", "ro") for v in values])


def standard(serial, vendor=0x29A, heartbeat=None):
    """What each device here has: 1000h, 1001h, 1017h, 1018h."""
    return [Entry(0x1000, UNSIGNED32, "0x20192", "ro"), Entry(0x1001, UNSIGNED8, 0, "ro"),
            Entry(0x1017, UNSIGNED16, 0, "rw", heartbeat), identity(serial, vendor)]


def input_byte():
    """6000h:01 and the TPDO with it, sent when it changes."""
    cob_id, kind = Entry(0x1800, UNSIGNED32, "$NODEID+0x180"), Entry(0x1800, UNSIGNED8, 255)
    return [Record(0x1800, [cob_id, kind]), Record(0x1A00, [Entry(0x1A00, UNSIGNED32, 0x60000108)]),
            Record(0x6000, [Mapped(0x6000, UNSIGNED8, 0, "ro")])]


def object_list(section, indexes):
    yield from (f"[{section}]", f"SupportedObjects={len(indexes)}")
    yield from (f"{number}=0x{index:04X}" for number, index in enumerate(indexes, 1))
    yield ""


def count(indexes, first):
    """PDOs of a direction."""
    return sum(first <= index < first + 0x200 for index in indexes)


def file_information(node, indexes):
    info = FILE.replace("NrOfTXPDO=0", f"NrOfTXPDO={count(indexes, 0x1800)}")
    info = info.replace("NrOfRXPDO=0", f"NrOfRXPDO={count(indexes, 0x1400)}")
    if node is not None:
        return info
    return info.replace("LastEDS=device.eds\n", "").replace("=device.dcf", "=device.eds")


def dcf(node, objects, baudrate=1000):
    """A device configuration file; node None: an EDS."""
    lines = []
    if node is not None:
        lines += ["[DeviceComissioning]", f"NodeID={node}", f"NodeName=node{node}",
                  f"Baudrate={baudrate}", "NetNumber=1", "NetworkName=", "CANopenManager=0", ""]
    indexes = [each.index for each in objects]
    mandatory = {0x1000, 0x1001, 0x1018}
    lines += object_list("MandatoryObjects", [i for i in indexes if i in mandatory])
    lines += object_list("OptionalObjects", [i for i in indexes if i not in mandatory
                                             and not 0x2000 <= i < 0x6000])
    lines += object_list("ManufacturerObjects", [i for i in indexes if 0x2000 <= i < 0x6000])
    for each in objects:
        lines += each.lines()
    return file_information(node, indexes) + "\n".join(lines) + "\n"


def elements(values, indent):
    return "".join(f"{indent}<{name}>{value}</{name}>\n" for name, value in values.items())


def node(node_id, **values):
    return ("    <Node_Instance>\n" + elements({"Node_Id": node_id, **values}, "      ")
            + "    </Node_Instance>\n")


def network(nodes, **values):
    values = {"Net_No": 0, "Baudrate": 1000, **values}
    return ('<?xml version="1.0" encoding="UTF-8"?>\n<CANopen_Manager>\n  <Manager_Instance>\n'
            + elements(values, "    ") + "".join(nodes)
            + "  </Manager_Instance>\n</CANopen_Manager>\n")
