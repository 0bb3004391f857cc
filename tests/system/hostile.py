"""Files that nobody means: what test_hostile_files.py gives to the tools. Each is made anew."""
import random

MIB = 1 << 20

GOOD = """[FileInfo]
FileName=good.dcf
[DeviceInfo]
VendorName=nobody
[DeviceComissioning]
NodeID=5
[MandatoryObjects]
SupportedObjects=1
1=0x1000
[1000]
ParameterName=Device type
ObjectType=7
DataType=7
AccessType=ro
DefaultValue=0
PDOMapping=0
"""
VARIABLE = "ParameterName={name}\nObjectType=7\nDataType={type}\nAccessType=rw\n"


def variable(index, name="a", type_=5, more="ParameterValue=1\n"):
    return f"[{index:X}]\n" + VARIABLE.format(name=name, type=type_) + more


def variables(count, **options):
    return "".join(variable(0x2000 + i, **options) for i in range(count))


def arrays(count):
    return "".join(f"[{0x2000 + i:X}]\nParameterName=a\nObjectType=8\nDataType=5\nAccessType=rw\n"
                   "CompactSubObj=254\n" for i in range(count))


def junk(size):
    return random.Random(1).randbytes(size)


# name: contents, and what the error is; None: the file is taken, whatever the warnings
DEVICES = {
    "empty": ("", "there is no section in it"),
    "junk": (junk(MIB), "none of its sections is one of CiA 306"),
    "zeros": (bytes(16 * MIB), "there is no section in it"),
    "utf16-le": (b"\xff\xfe" + GOOD.encode("utf-16-le"), "this is UTF-16: store it as plain text"),
    "utf16-be": (b"\xfe\xff" + GOOD.encode("utf-16-be"), "this is UTF-16: store it as plain text"),
    "utf16-no-mark": (GOOD.encode("utf-16-le"), "none of its sections is one of CiA 306"),
    "nul": (GOOD.replace("Device type", "Device\0type"), None),
    "line of a comment": (GOOD + ";" + "x" * (10 * MIB), None),
    "line of a section": (GOOD + "[" + "x" * (10 * MIB) + "]\n", None),
    "line of a number": (GOOD + variable(0x2000, more=f"ParameterValue={'1' * (10 * MIB)}\n"),
                         "ParameterValue: a number in the range of UNSIGNED8 expected"),
    "line of a text": (GOOD + variable(0x2000, "n" * MIB, 9,
                                       f"ParameterValue={'x' * (10 * MIB)}\n"), None),
    "line of brackets": ("[" * (16 * MIB), "none of its sections is one of CiA 306"),
    "ten million sections": ("[0]\n" * 10_000_000,
                             "at most 16777216 bytes expected, there are 40000000"),
    "eight million sections": ("[\n" * (8 * MIB), "at most 524288 sections expected"),
    "half a million of one": ("[1000]\n" * 524_288, None),
    "half a million of any": ("".join(f"[x{i}]\n" for i in range(524_288)),
                              "none of its sections is one of CiA 306"),
    "two million keys": ("[1000]\n" + "a=\n" * 2_097_153, "at most 2097152 keywords expected"),
    "half a million keys of one": (GOOD + "a=1\n" * 500_000, None),
    "ten million entries": (GOOD + arrays(40_000), "at most 131072 entries expected"),
    "all objects": (GOOD + variables(0xE000), None),
    "all texts": (GOOD + variables(0xC000, name="\xe4" * 100, type_=9), None),
    "pipe in it": (GOOD + variable(0x2000, type_=15, more="DownloadFile=pipe\n")
                   .replace("ObjectType=7", "ObjectType=2"),
                   "a readable file expected, \"pipe\": time-out"),
}

BEGIN = "<CANopen_Manager><Manager_Instance><Net_No>0</Net_No><Baudrate>500</Baudrate>"
END = "</Manager_Instance></CANopen_Manager>"
TOO_MUCH = "more than 200000 elements, or 1000 attributes in one: this is no configuration"


def around(text, count):
    return BEGIN + text * count + END


def reading(element, name):
    """A network with a node that has this file."""
    return (f"{BEGIN}<Node_Instance><Node_Id>5</Node_Id><{element}>{name}</{element}>"
            f"</Node_Instance>{END}")


# name: contents, what the error is
NETWORKS = {
    "empty": ("", "the file is empty"),
    "junk": (junk(MIB), "there is a NUL byte: this is no text in UTF-8"),
    "zeros": (bytes(8 * MIB), "there is a NUL byte: this is no text in UTF-8"),
    "utf16": (b"\xff\xfe" + around("", 0).encode("utf-16-le"), "there is a NUL byte"),
    "too large": (around(" ", 9 * MIB), "the file is larger than 8388608 bytes"),
    "deep": (around("<a>", 100_000), "XML: Excessive depth"),
    "deeper": (around("<a>", 2 * MIB), TOO_MUCH),
    "elements": (around("<a/>", 2 * MIB - 100), TOO_MUCH),
    "comments": (around("<!---->", MIB), TOO_MUCH),
    "attributes": ("<a " + " ".join(f"b{i}=''" for i in range(700_000)) + "/>", TOO_MUCH),
    "some attributes": ("<a>" + ("<b " + " ".join(f"b{i}=''" for i in range(999)) + "/>") * 190 +
                        "</a>", "the root element is a"),
    "text": (around("<Name>" + "a" * (8 * MIB - 1000) + "</Name>", 1), "is too long"),
    "characters": (around("<Name>" + "&lt;" * (2 * MIB - 1000) + "</Name>", 1), "is too long"),
    "name": (around("<" + "a" * (8 * MIB - 1000) + "/>", 1), "XML: Name too long"),
    "entities": ("<!DOCTYPE a [" + "<!ENTITY b 'c'>" * 1000 + "]><a>&b;</a>", "<!DOCTYPE>"),
    "DCF is a pipe": (reading("DCF_File", "pipe"), "nothing comes out of this pipe or device"),
    "DCF is zeros": (reading("DCF_File", "/dev/zero"), "larger than 64 MiB"),
    "DCF is large": (reading("DCF_File", "2 GB"), "larger than 64 MiB"),
    "CCF is large": (reading("CCF_File", "2 GB"), "CCF_File: 2 GB: larger than 64 MiB"),
    "CCF is a folder": (reading("CCF_File", "folder"), "a folder, expected a file"),
    "CCF is zeros": (reading("CCF_File", "64 MB"), "64 MB: error: the 0 entries of the count end"),
    "software is a pipe": (reading("Software_File", "pipe"), "nothing comes out of this pipe"),
}

# name: contents, what the error is
CONCISE = {
    "empty": (b"", "begins with a count of 4 bytes, the file has 0"),
    "junk": (junk(MIB), "a value of 4050313105 bytes expected, 1048565 are left"),
    "zeros": (bytes(7000), "the 0 entries of the count end at byte 4, 6996 more bytes follow"),
    "text": (GOOD, "entry 1 of 1818838619 at byte 4"),
    "count": (b"\xff\xff\xff\xff" + bytes(7), "entry 2 of 4294967295 at byte 11"),
    "size": (b"\1\0\0\0\0\x20\1\xff\xff\xff\xff", "a value of 4294967295 bytes expected"),
}
