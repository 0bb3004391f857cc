/* What the reader says about files: each oddity with its line, and which of them refuse a file. */
#include "dcf/dcf.h"
#include "support/dcf_file.h"
#include "support/guarded.h"
#include "support/messages.h"

#include <check.h>
#include <stdio.h>
#include <string.h>

#define U8_OBJECT(rest)     OBJECT("2000", VAR("2000", "5", "rw") rest)
#define NETWORK             "NodeName=N\nNetNumber=1\nNetworkName=\nCANopenManager=0\n"
#define COMMISSIONING(rest) LINES("[DeviceComissioning]\n" rest NETWORK)

static const struct {
    const char *name;
    const char *file;
    const char *messages;
} warnings[] = {
    { "nothing to say", CLEAN, "" },
    { "sections are missing", "[1000]\n",
      " warning: a section [FileInfo] expected, it is missing\n"
      " warning: a section [DeviceInfo] expected, it is missing\n"
      " warning: a section [DummyUsage] expected, it is missing\n"
      "1: warning: [1000] DataType: a data type of CiA 301 expected, it is missing: the entry "
      "cannot be used\n"
      "1: warning: [1000]: AccessType expected, it is missing: taken as ro\n"
      "1: warning: ParameterName: a text expected, it is missing or empty (1 such sections)\n"
      " warning: a section [MandatoryObjects] expected, it is missing\n"
      "1: warning: [1000]: its index expected in [MandatoryObjects], it is in no list\n"
      " warning: an object 1001h expected in every device, it is missing\n"
      " warning: an object 1018h expected in every device, it is missing\n" },
    { "file information",
      "[FileInfo]\nFileName=\nFileVersion=005\nFileRevision=1.0\nEDSVersion=4.04\n"
      "ModificationTime=9:45\nCreationTime=09:45AM x\nCreationDate=2004-05-15\n"
      "ModificationDate=05-15-04\nAuthor=me\n" DEVICE_INFO LISTS OPTIONAL MANDATORY,
      "1: warning: [FileInfo]: FileName expected, it is missing or empty\n"
      "3: warning: [FileInfo] FileVersion: no leading zero expected, there is \"005\": read as a "
      "decimal number\n"
      "4: warning: [FileInfo] FileRevision: a number like 26 or 0x1A expected, there is \"1.0\": "
      "read as 1\n"
      "5: warning: [FileInfo] EDSVersion: 3.0 or 4.0 expected, there is \"4.04\"\n"
      "7: warning: [FileInfo] CreationTime: hh:mm(AM|PM) expected, there is \"09:45AM x\"\n"
      "8: warning: [FileInfo] CreationDate: mm-dd-yyyy expected, there is \"2004-05-15\"\n"
      "6: warning: [FileInfo] ModificationTime: hh:mm(AM|PM) expected, there is \"9:45\"\n"
      "9: warning: [FileInfo] ModificationDate: mm-dd-yyyy expected, there is \"05-15-04\"\n"
      "10: warning: [FileInfo]: a keyword of CiA 306 for this section expected, there is "
      "\"Author\": ignored\n" },
    { "file information that cannot be",
      "[FileInfo]\nFileName=a.eds\nFileVersion=\nEDSVersion=4\nModificationTime=13:45PM\n"
      "CreationTime=09:60AM\nCreationDate=13-01-2004\nModificationDate=12-32-2004\n" DEVICE_INFO
          LISTS OPTIONAL MANDATORY,
      "1: warning: [FileInfo]: FileVersion, FileRevision expected, they are missing or empty\n"
      "4: warning: [FileInfo] EDSVersion: 3.0 or 4.0 expected, there is \"4\"\n"
      "6: warning: [FileInfo] CreationTime: hh:mm(AM|PM) expected, there is \"09:60AM\"\n"
      "7: warning: [FileInfo] CreationDate: mm-dd-yyyy expected, there is \"13-01-2004\"\n"
      "5: warning: [FileInfo] ModificationTime: hh:mm(AM|PM) expected, there is \"13:45PM\"\n"
      "8: warning: [FileInfo] ModificationDate: mm-dd-yyyy expected, there is \"12-32-2004\"\n" },
    { "device information",
      FILE_INFO "[DeviceInfo]\nVendorName=V\nVendorNumber=\nProductName=\nProductNumber=2\n"
                "BaudRate_100=1\nBaudRate_500=2\nBaudRate_auto=1\nSimpleBootUpSlave=yes\n"
                "Granularity=65\nNrOfRXPDO=513\nExtendedBootUpMaster=0\nLMT_ProductName=P\n"
                "CompactPDO=0x40\nDynamicChannelsSupported=2\n" LISTS OPTIONAL MANDATORY,
      "9: warning: [DeviceInfo]: VendorNumber, ProductName, RevisionNumber, OrderCode, "
      "BaudRate_10, "
      "BaudRate_20, BaudRate_50, BaudRate_125, BaudRate_250, BaudRate_800, BaudRate_1000, "
      "SimpleBootUpMaster, NrOfTXPDO, LSS_Supported expected, they are missing or empty\n"
      "15: warning: [DeviceInfo] BaudRate_500: a number of 0..1 expected, there is \"2\": ignored\n"
      "18: warning: [DeviceInfo] Granularity: a number of 0..64 expected, there is \"65\": "
      "ignored\n"
      "19: warning: [DeviceInfo] NrOfRXPDO: a number of 0..512 expected, there is \"513\": "
      "ignored\n"
      "22: warning: [DeviceInfo] CompactPDO: up to 3Fh expected (one bit for each sub-index), "
      "there "
      "is 40h: the others are ignored\n"
      "22: warning: [DeviceInfo] CompactPDO: NrOfRXPDO or NrOfTXPDO expected with it, there are no "
      "PDOs\n"
      "17: warning: [DeviceInfo] SimpleBootUpSlave: a number like 26 or 0x1A expected, there is "
      "\"yes\": read as 1\n"
      "23: warning: [DeviceInfo] DynamicChannelsSupported: a number of 0..1 expected, there is "
      "\"2\": ignored\n"
      "20: warning: [DeviceInfo] ExtendedBootUpMaster: not expected any more, kept free for old "
      "files: ignored\n"
      "21: warning: [DeviceInfo] LMT_ProductName: not expected any more, kept free for old files: "
      "ignored\n"
      "14: warning: [DeviceInfo]: a keyword of CiA 306 for this section expected, there is "
      "\"BaudRate_100\": ignored\n"
      "16: warning: [DeviceInfo]: a keyword of CiA 306 for this section expected, there is "
      "\"BaudRate_auto\": ignored\n" },
    { "compact PDOs of none", LINES("[DeviceInfo]\nCompactPDO=3\n"),
      "63: warning: [DeviceInfo]: expected once, it is also in line 9: keys of both are taken, of "
      "the same ones the later\n"
      "64: warning: [DeviceInfo] CompactPDO: NrOfRXPDO or NrOfTXPDO expected with it, there are no "
      "PDOs\n" },
    { "a section twice with the same", LINES("[DummyUsage]\nDummy0005=1\nDummy0006=1\n"),
      "63: warning: [DummyUsage]: expected once, it is also in line 30: keys of both are taken, of "
      "the same ones the later\n" },
    { "dummies",
      LINES("[DummyUsage]\nDummy0007=1\nDummy0008=1\nDummy0010=1\nDummy001B=0\n"
            "Dummy001C=0\nDummy0001=2\n"),
      "63: warning: [DummyUsage]: expected once, it is also in line 30: keys of both are taken, of "
      "the same ones the later\n"
      "69: warning: [DummyUsage] Dummy0001: a number of 0..1 expected, there is \"2\": ignored\n"
      "65: warning: [DummyUsage]: a keyword of CiA 306 for this section expected, there is "
      "\"Dummy0008\": ignored\n"
      "68: warning: [DummyUsage]: a keyword of CiA 306 for this section expected, there is "
      "\"Dummy001C\": ignored\n" },
    { "commissioning",
      LINES("[DeviceComissioning]\nNodeID=5\nBaudrate=500\nNodeName=\n"
            "NetworkName=\nNetNumber=x\nCANopenManager=2\nLSS_SerialNumber=y\n"
            "NodeRefd=r\nNetRefd=s\nNetNo=1\n"),
      "68: warning: [DeviceComissioning] NetNumber: a number of 0..4294967295 expected, there is "
      "\"x\": ignored\n"
      "69: warning: [DeviceComissioning] CANopenManager: a number of 0..1 expected, there is "
      "\"2\": "
      "ignored\n"
      "70: warning: [DeviceComissioning] LSS_SerialNumber: a number of 0..4294967295 expected, "
      "there "
      "is \"y\": ignored\n"
      "73: warning: [DeviceComissioning]: a keyword of CiA 306 for this section expected, there is "
      "\"NetNo\": ignored\n" },
    { "commissioning of a device in no network",
      LINES("[DeviceComissioning]\nNodeID=5\nBaudrate=500\n"),
      "63: warning: [DeviceComissioning]: NodeName, NetNumber, NetworkName, CANopenManager "
      "expected, "
      "they are missing\n" },
    { "data types of the device are listed as well",
      LINES("[OptionalObjects]\nSupportedObjects=2\n1=0x40\n2=0x41\n[0040]\nParameterName=T\n"
            "ObjectType=5\nDataType=7\nAccessType=ro\n[0041]\nParameterName=T\nObjectType=5\n"
            "DataType=7\nAccessType=ro\n"),
      "63: warning: [OptionalObjects]: expected once, it is also in line 39: keys of both are "
      "taken, "
      "of the same ones the later\n"
      "64: warning: [OptionalObjects] SupportedObjects: expected once, it is also in line 40: "
      "\"2\" "
      "counts, not \"0\"\n" },
    { "a list that begins with 0", LINES("[OptionalObjects]\n0=0x1001\nSupportedObjects=1\n"),
      "63: warning: [OptionalObjects]: expected once, it is also in line 39: keys of both are "
      "taken, "
      "of the same ones the later\n"
      "65: warning: [OptionalObjects] SupportedObjects: expected once, it is also in line 40: "
      "\"1\" "
      "counts, not \"0\"\n"
      "64: warning: [OptionalObjects]: 1001h expected once, it is also in line 35\n"
      "63: warning: [OptionalObjects]: 1 to 1 expected, 1 is missing\n" },
    { "1018h was optional in version 3",
      "[FileInfo]\nFileName=a\nFileVersion=1\nFileRevision=0\n" DEVICE_INFO
      "[DummyUsage]\n[MandatoryObjects]\nSupportedObjects=2\n1=0x1000\n2=0x1001\n"
      "[OptionalObjects]\nSupportedObjects=1\n1=0x1018\n" MANDATORY,
      "" },
    { "an empty object", U8_OBJECT("DefaultValue=\nParameterValue=\nLowLimit=\nObjFlags=\n"), "" },
    { "text as a number", U8_OBJECT("DefaultValue=No\n"),
      "67: warning: [2000] DefaultValue: a number (UNSIGNED8) expected, there is \"No\": "
      "ignored\n" },
    { "a default beyond its type", U8_OBJECT("DefaultValue=0x360\n"),
      "67: warning: [2000] DefaultValue: a number (UNSIGNED8) expected, there is \"0x360\", which "
      "does not fit the type: ignored\n" },
    { "a comment behind a number", U8_OBJECT("ParameterValue=3 ; three\n"),
      "67: warning: [2000] ParameterValue: a number alone expected, there is \"3 ; three\": what "
      "follows it is ignored\n" },
    { "a leading zero", U8_OBJECT("DefaultValue=010\n"),
      "67: warning: [2000] DefaultValue: no leading zero expected, there is \"010\": read as a "
      "decimal number\n" },
    { "a suffix", U8_OBJECT("DefaultValue=1LL\n"),
      "67: warning: [2000] DefaultValue: a number without suffix expected, there is \"1LL\": the "
      "suffix is ignored\n" },
    { "a number as assemblers have it", U8_OBJECT("ParameterValue=1Ah\n"),
      "67: warning: [2000] ParameterValue: a number like 26 or 0x1A expected, there is \"1Ah\": "
      "read as 0x1A\n" },
    { "another spelling of $NODEID", U8_OBJECT("DefaultValue=(NodeId+0x10)\n"),
      "67: warning: [2000] DefaultValue: a number like 26 or 0x1A expected, there is "
      "\"(NodeId+0x10)\": read as $NODEID+0x10\n" },
    { "a negative number with the digits of a wider type",
      OBJECT("2000", VAR("2000", "2", "rw") "ParameterValue=0xFFFFFFFE\nHighLimit=-2\n"),
      "67: warning: [2000] ParameterValue: not more digits than its type has expected, there is "
      "\"0xFFFFFFFE\": those before are ignored\n" },
    { "quotes", OBJECT("2000", VAR("2000", "9", "rw") "DefaultValue=\"a\"\n"),
      "67: warning: [2000] DefaultValue: text without quotes expected, there is \"\"a\"\": the "
      "quotes count as characters\n" },
    { "text as octets", OBJECT("2000", VAR("2000", "0xA", "rw") "DefaultValue=xyz\n"),
      "67: warning: [2000] DefaultValue: hexadecimal digits expected, there is \"xyz\": taken as "
      "text\n" },
    { "the value of a DOMAIN", OBJECT("2000", VAR("2000", "0xF", "rw") "DefaultValue=0\n"),
      "67: warning: [2000] DefaultValue: pairs of hexadecimal digits (DOMAIN) expected, there is "
      "\"0\": ignored\n" },
    { "bytes of a DOMAIN", OBJECT("2000", VAR("2000", "0xF", "rw") "ParameterValue=0x0102\n"),
      "67: warning: [2000] ParameterValue: a DownloadFile as value of a DOMAIN expected, there is "
      "\"0x0102\": taken as bytes\n" },
    { "an unknown key", U8_OBJECT("Unit=m\nFactor=0.1\n"),
      "67: warning: [2000]: a keyword of CiA 306 for this section expected, there is \"Unit\": "
      "ignored\n"
      "68: warning: [2000]: a keyword of CiA 306 for this section expected, there is \"Factor\": "
      "ignored\n" },
    { "an access type with something behind it", OBJECT("2000", VAR("2000", "5", "rw # rw")),
      "66: warning: [2000] AccessType: rw alone expected, there is \"rw # rw\"\n" },
    { "an unknown access type", OBJECT("2000", VAR("2000", "5", "any")),
      "66: warning: [2000] AccessType: ro, wo, rw, rwr, rww or const expected, there is \"any\": "
      "taken as ro\n" },
    { "keys of a variable with sub-indices",
      OBJECT("2000",
             "[2000]\nParameterName=x\nObjectType=9\nHighLimit=7\nDataType=5\nAccessType=ro\n"
             "PDOMapping=0\nDefaultValue=\nObjFlags=0\nDenotation=d\nSubNumber=1\n" VAR("2000sub0",
                                                                                        "5", "ro")),
      "66: warning: [2000]: DataType, AccessType, HighLimit not expected with this ObjectType: "
      "ignored\n" },
    { "PDOMapping of a record",
      OBJECT("2000", "[2000]\nParameterName=x\nObjectType=9\nPDOMapping=1\nSubNumber=1\n" VAR(
                         "2000sub0", "5", "ro")),
      "66: warning: [2000]: PDOMapping not expected with this ObjectType: ignored\n" },
    { "SubNumber of a variable", U8_OBJECT("SubNumber=1\nCompactSubObj=0\n"),
      "67: warning: [2000]: SubNumber not expected with this ObjectType: ignored\n" },
    { "no SubNumber of a variable", U8_OBJECT("SubNumber=0\n"), "" },
    { "limits of a DOMAIN",
      OBJECT("2000", VAR("2000", "0xF", "rw") "ObjectType=2\nLowLimit=1\nPDOMapping=0\n"),
      "68: warning: [2000]: LowLimit not expected with this ObjectType: ignored\n" },
    { "a compact variable", OBJECT("2000", VAR("2000", "5", "rw") "CompactSubObj=2\nSubNumber=3\n"),
      "63: warning: [2000] ObjectType: 8 or 9 expected with CompactSubObj, there is 7: taken as 8\n"
      "68: warning: [2000]: SubNumber not expected with this ObjectType: ignored\n" },
    { "a file for a DOMAIN that cannot be transferred so",
      OBJECT("2000", VAR("2000", "0xF", "wo") "ObjectType=2\nUploadFile=a/b.bin\n" VAR(
                         "2001", "0xF", "const") "ObjectType=2\nDownloadFile=a.bin\n"),
      "68: warning: [2000] UploadFile: expected for what can be read, AccessType is wo\n"
      "74: warning: [2001] DownloadFile: expected for what can be written, AccessType is const\n"
      "69: warning: [2001]: its index expected in [ManufacturerObjects], it is in no list\n" },
    { "a file for a DOMAIN elsewhere",
      OBJECT("2000",
             VAR("2000", "0xF", "rw") "ObjectType=2\nUploadFile=../a.bin\nDownloadFile=b.bin\n"),
      "68: warning: [2000] UploadFile: a name below the folder of this file expected, there is "
      "\"../a.bin\"\n" },
    { "a file from a number", U8_OBJECT("UploadFile=a\n"),
      "67: warning: [2000] UploadFile: expected for a DOMAIN only, this is UNSIGNED8: ignored\n" },
    { "compact PDOs with too many bits", LINES("[DeviceInfo]\nCompactPDO=0x43\n"),
      "63: warning: [DeviceInfo]: expected once, it is also in line 9: keys of both are taken, of "
      "the same ones the later\n"
      "64: warning: [DeviceInfo] CompactPDO: up to 3Fh expected (one bit for each sub-index), "
      "there "
      "is 43h: the others are ignored\n"
      "64: warning: [DeviceInfo] CompactPDO: NrOfRXPDO or NrOfTXPDO expected with it, there are no "
      "PDOs\n" },
    { "an access type in other words", OBJECT("2000", VAR("2000", "5", "R/W")),
      "66: warning: [2000] AccessType: ro, wo, rw, rwr, rww or const expected, there is \"R/W\": "
      "taken as rw\n" },
    { "an unknown data type", OBJECT("2000", VAR("2000", "0x40", "rw") "DefaultValue=1\n"),
      "65: warning: [2000] DataType: a data type of CiA 301 expected, there is 0x40: the entry "
      "cannot be used\n" },
    { "no data type", OBJECT("2000", "[2000]\nParameterName=x\nAccessType=rw\nDefaultValue=1\n"),
      "63: warning: [2000] DataType: a data type of CiA 301 expected, it is missing: the entry "
      "cannot be used\n" },
    { "a data type by its name", OBJECT("2000", VAR("2000", "Unsigned8", "rw") "DefaultValue=9\n"),
      "65: warning: [2000] DataType: a number expected, there is \"Unsigned8\": taken as "
      "0x0005\n" },
    { "an object type by its name", U8_OBJECT("ObjectType=VAR\n"),
      "67: warning: [2000] ObjectType: a number expected, there is \"VAR\": taken as 7\n" },
    { "an object type that is told once", U8_OBJECT("ObjectType=07\n"),
      "67: warning: [2000] ObjectType: no leading zero expected, there is \"07\": read as a "
      "decimal "
      "number\n" },
    { "unknown flags", U8_OBJECT("ObjFlags=0x10\n"),
      "67: warning: [2000] ObjFlags: 0..3 expected, there is 10: bits 2 to 31 are ignored\n" },
    { "a flag that is none", U8_OBJECT("PDOMapping=2\n"),
      "67: warning: [2000] PDOMapping: a number of 0..1 expected, there is \"2\": ignored\n" },
    { "a file for a number", U8_OBJECT("DownloadFile=a\n"),
      "67: warning: [2000] DownloadFile: expected for a DOMAIN only, this is UNSIGNED8: "
      "ignored\n" },
    { "limits of another type", U8_OBJECT("LowLimit=-30\nHighLimit=50\nParameterValue=60\n"),
      "67: warning: [2000] LowLimit: a number (UNSIGNED8) expected, there is \"-30\", which does "
      "not fit the type: ignored\n" },
    { "limits in the wrong order", U8_OBJECT("LowLimit=3\nHighLimit=1\nParameterValue=60\n"),
      "67: warning: 2000h:00: LowLimit up to HighLimit expected, there are 3 and 1: both are "
      "ignored\n" },
    { "hexadecimal limits without sign",
      OBJECT("2000", VAR("2000", "2", "rw") "LowLimit=0x00\nHighLimit=0xFF\nParameterValue=-1\n"),
      "67: warning: 2000h:00: LowLimit up to HighLimit expected, there are 0 and -1: both are "
      "ignored\n" },
    { "values at their limits",
      U8_OBJECT("LowLimit=1\nHighLimit=3\nDefaultValue=1\nParameterValue=3\n"), "" },
    { "signed values at their limits",
      OBJECT("2000", VAR("2000", "2", "rw") "LowLimit=-3\nHighLimit=0xFF\nDefaultValue=-3\n"
                                            "ParameterValue=-1\n"),
      "" },
    { "a default outside its limits", U8_OBJECT("LowLimit=1\nHighLimit=3\nDefaultValue=4\n"),
      "69: warning: 2000h:00 DefaultValue: 1 to 3 expected (its limits), there is 4\n" },
    { "a read-only value outside its limits",
      OBJECT("2000", VAR("2000", "3", "ro") "LowLimit=-1\nParameterValue=-2\n"),
      "68: warning: 2000h:00 ParameterValue: -1 to (none) expected (its limits), there is -2\n" },
    { "a read-only value that is none", OBJECT("2000", VAR("2000", "5", "ro") "ParameterValue=x\n"),
      "67: warning: [2000] ParameterValue: a number (UNSIGNED8) expected, there is \"x\": "
      "ignored\n" },
    { "a name is missing", OBJECT("2000", "[2000]\nParameterName=\nDataType=5\nAccessType=ro\n"),
      "63: warning: ParameterName: a text expected, it is missing or empty (1 such sections)\n" },
    { "SubNumber",
      OBJECT("2000",
             "[2000]\nParameterName=x\nObjectType=8\nSubNumber=3\n" VAR("2000sub0", "5", "ro")
                 VAR("2000sub2", "5", "ro") VAR("2000subFF", "7", "ro")),
      "63: warning: [2000] SubNumber: 2 expected (so many sub-index sections are there), it is "
      "3\n" },
    { "no sub-indices", OBJECT("2000", "[2000]\nParameterName=x\nObjectType=8\n"),
      "63: warning: [2000]: sections for its sub-indices expected, there are none: nothing of it "
      "is used\n" },
    { "sub-indices in decimal",
      OBJECT("2000",
             "[2000]\nParameterName=x\nObjectType=8\nSubNumber=3\n" VAR("2000sub0", "5", "ro")
                 VAR("2000sub9", "7", "ro") VAR("2000sub10", "7", "ro")),
      "75: warning: [2000sub10]: [2000subA] expected behind [2000sub9], sub-indices are "
      "hexadecimal: taken as 16\n" },
    { "no sub-index 0",
      OBJECT("2000",
             "[2000]\nParameterName=x\nObjectType=8\nSubNumber=1\n" VAR("2000sub1", "5", "ro")),
      "63: warning: [2000]: a section [2000sub0] expected, it is missing\n" },
    { "sub-index 0 of another type",
      OBJECT("2000", "[2000]\nParameterName=x\nObjectType=8\n"
                     "SubNumber=1\n" VAR("2000sub0", "6", "ro")),
      "67: warning: [2000sub0] DataType: UNSIGNED8 expected for sub-index 0, there is "
      "UNSIGNED16\n" },
    { "a sub-index that is an array",
      OBJECT("2000", "[2000]\nParameterName=x\nObjectType=9\nSubNumber=1\n" VAR(
                         "2000sub0", "5", "ro") "ObjectType=8\n"),
      "67: warning: [2000sub0] ObjectType: 7 (VAR) expected for a sub-index, there is 8\n" },
    { "a VAR with sub-indices",
      OBJECT("2000", "[2000]\nParameterName=x\nSubNumber=1\n" VAR("2000sub0", "5", "ro")),
      "63: warning: [2000] ObjectType: 8 or 9 (there are sub-indices) expected, there is 7: taken "
      "as 9\n" },
    { "an unknown object type", U8_OBJECT("ObjectType=3\n"),
      "63: warning: [2000] ObjectType: 2, 5, 6, 7, 8 or 9 expected, there is 3: taken as 7\n" },
    { "sub-indices without object", OBJECT("2000", VAR("2000sub0", "5", "ro")),
      "63: warning: [2000sub0]: a section [2000] for its object expected, it is missing\n" },
    { "an array of nothing", OBJECT("2000", "[2000]\nParameterName=x\nObjectType=8\nSubNumber=2\n"),
      "63: warning: [2000]: sections for its sub-indices expected, there are none: nothing of it "
      "is used\n" },
    { "... that does not say so",
      OBJECT("2000", "[2000]\nParameterName=x\nObjectType=8\nDataType=5\nAccessType=rw\n"),
      "66: warning: [2000]: DataType, AccessType not expected with this ObjectType: ignored\n"
      "63: warning: [2000]: sections for its sub-indices expected, there are none: nothing of it "
      "is used\n" },
    { "no SubNumber",
      OBJECT("2000", "[2000]\nParameterName=x\nObjectType=8\n" VAR("2000sub0", "5", "ro")),
      "63: warning: [2000] SubNumber: 1 expected (so many sub-index sections are there), it is "
      "missing\n" },
    { "a SubNumber that is none",
      OBJECT("2000",
             "[2000]\nParameterName=x\nObjectType=8\nSubNumber=A\n" VAR("2000sub0", "5", "ro")),
      "66: warning: [2000] SubNumber: a number of 0..255 expected, there is \"A\": ignored\n" },
    { "a SubNumber of a VAR that is 0", U8_OBJECT("SubNumber=0\nCompactSubObj=0\n"), "" },
    { "compact and not",
      OBJECT("2000", "[2000]\nParameterName=x\nObjectType=8\nSubNumber=1\nCompactSubObj=3\n" VAR(
                         "2000sub0", "5", "ro")),
      "63: warning: [2000] CompactSubObj: 0 expected (there are sub-index sections), it is 3: "
      "ignored\n" },
    { "compact with too many",
      OBJECT("2000", VAR("2000", "5", "ro") "ObjectType=8\nCompactSubObj=255\n"),
      "63: warning: [2000] CompactSubObj: at most 254 expected, there is 255: taken as 254\n" },
    { "compact with a value",
      OBJECT("2000", VAR("2000", "5", "rw") "ObjectType=8\nCompactSubObj=2\nParameterValue=1\n"),
      "69: warning: [2000] ParameterValue: a section [2000Value] expected for a compact object: "
      "ignored\n" },
    { "values of compact objects",
      OBJECT(
          "2000",
          VAR("2000", "5",
              "rw") "ObjectType=8\nCompactSubObj=2\n[2000Value]\nNrOfEntries=1\n2=1\n3=1\n0x1=1\n"),
      "72: warning: [2000Value]: a sub-index of 2000h in decimal expected, there is \"3\": "
      "ignored\n"
      "73: warning: [2000Value]: a sub-index of 2000h in decimal expected, there is \"0x1\": "
      "ignored\n"
      "69: warning: [2000Value] NrOfEntries: 3 expected (so many are there), it is 1\n" },
    { "a list with its number spelt otherwise",
      LINES("[OptionalObjects]\nSupportedObjects=\nSupported Objects=0\n"),
      "63: warning: [OptionalObjects]: expected once, it is also in line 39: keys of both are "
      "taken, of the same ones the later\n"
      "64: warning: [OptionalObjects] SupportedObjects: expected once, it is also in line 40: "
      "\"\" counts, not \"0\"\n"
      "65: warning: [OptionalObjects]: SupportedObjects expected, there is \"Supported "
      "Objects\"\n" },
    { "a list without its number, and an index with something behind it",
      LINES("[OptionalObjects]\nSupportedObjects=\n1=1002h\n" VAR("1002", "7", "ro")),
      "63: warning: [OptionalObjects]: expected once, it is also in line 39: keys of both are "
      "taken, of the same ones the later\n"
      "64: warning: [OptionalObjects] SupportedObjects: expected once, it is also in line 40: "
      "\"\" counts, not \"0\"\n"
      "65: warning: [OptionalObjects] 1: a number like 26 or 0x1A expected, there is \"1002h\": "
      "read as 0x1002\n"
      "63: warning: [OptionalObjects] SupportedObjects: 1 expected (so many are listed), it is "
      "missing\n" },
    { "an index in no list", LINES(VAR("2000", "5", "ro")),
      "63: warning: [2000]: its index expected in [ManufacturerObjects], it is in no list\n" },
    { "indices without section or in the wrong list, and twice",
      LINES("[OptionalObjects]\n1=0x6000\n2=0x2000\n3=0x1000\n4=none\nFoo=1\n"),
      "63: warning: [OptionalObjects]: expected once, it is also in line 39: keys of both are "
      "taken, of the same ones the later\n"
      "64: warning: [OptionalObjects]: a section [6000] for this index expected, it is missing\n"
      "65: warning: [OptionalObjects]: 2000h expected in [ManufacturerObjects], it is here\n"
      "65: warning: [OptionalObjects]: a section [2000] for this index expected, it is missing\n"
      "66: warning: [OptionalObjects]: 1000h expected once, it is also in line 34\n"
      "67: warning: [OptionalObjects] 4: an index expected, there is \"none\": ignored\n"
      "63: warning: [OptionalObjects] SupportedObjects: 4 expected (so many are listed), it is 0\n"
      "68: warning: [OptionalObjects]: a keyword of CiA 306 for this section expected, there is "
      "\"Foo\": ignored\n" },
    { "PDO counts", LINES("[DeviceInfo]\nNrOfRXPDO=1\nNrOfTXPDO=2\n"),
      "63: warning: [DeviceInfo]: expected once, it is also in line 9: keys of both are taken, of "
      "the same ones the later\n"
      "64: warning: [DeviceInfo] NrOfRXPDO: expected once, it is also in line 27: \"1\" counts, "
      "not "
      "\"0\"\n"
      "65: warning: [DeviceInfo] NrOfTXPDO: expected once, it is also in line 28: \"2\" counts, "
      "not "
      "\"0\"\n"
      "64: warning: [DeviceInfo] NrOfRXPDO: 0 expected (so many communication parameters are "
      "there), it is 1\n"
      "65: warning: [DeviceInfo] NrOfTXPDO: 0 expected (so many communication parameters are "
      "there), it is 2\n" },
    { "no node-ID, no bit rate", COMMISSIONING("NodeID=\n"),
      "63: warning: [DeviceComissioning] NodeID: 1..127 expected, it is missing or empty\n"
      "63: warning: [DeviceComissioning] Baudrate: 10, 20, 50, 125, 250, 500, 800 or 1000 "
      "expected, there is none: not configured\n" },
    { "a bit rate in bit/s", COMMISSIONING("NodeID=05\nBaudrate=500000\n"),
      "64: warning: [DeviceComissioning] NodeID: no leading zero expected, there is \"05\": read "
      "as "
      "a decimal number\n"
      "65: warning: [DeviceComissioning] Baudrate: 500 expected (kbit/s), there is \"500000\"\n" },
    { "a bit rate with its unit", COMMISSIONING("NodeID=5\nBaudrate=1000 kBit/s\n"),
      "65: warning: [DeviceComissioning] Baudrate: 1000 expected (kbit/s), there is \"1000 "
      "kBit/s\"\n" },
    { "a node-ID and bit rate that are not configured", COMMISSIONING("NodeID=0xFF\nBaudrate=0\n"),
      "64: warning: [DeviceComissioning] NodeID: 1..127 expected, there is \"0xFF\": taken as not "
      "configured\n"
      "65: warning: [DeviceComissioning] Baudrate: 10, 20, 50, 125, 250, 500, 800 or 1000 "
      "expected, there is 0: not configured\n" },
};

static struct messages messages;
static struct dcf dcf;

static enum co_err parse(const char *text)
{
    messages_init(&messages);
    return guarded_dcf_parse(text, strlen(text), &messages.report, &dcf);
}

START_TEST(test_warning)
{
    ck_assert_msg(parse(warnings[_i].file) == CO_OK, "%s:\n%s", warnings[_i].name, messages.text);
    ck_assert_msg(strcmp(messages.text, warnings[_i].messages) == 0, "%s:\n%s", warnings[_i].name,
                  messages.text);
    dcf_done(&dcf);
}
END_TEST

static const struct {
    const char *name;
    const char *file;
    enum dcf_error kind;
    const char *message;
} errors[] = {
    { "a value that is no number", U8_OBJECT("ParameterValue=abc\n"), DCF_ERROR_WRONG_PARAMETER,
      "67: error: [2000] ParameterValue: a number (UNSIGNED8) expected, there is \"abc\"\n" },
    { "a value beyond its type", U8_OBJECT("ParameterValue=256\n"), DCF_ERROR_OUT_OF_RANGE,
      "67: error: [2000] ParameterValue: a number in the range of UNSIGNED8 expected, there is "
      "\"256\"\n" },
    { "a value above its limits", U8_OBJECT("LowLimit=1\nHighLimit=3\nParameterValue=4\n"),
      DCF_ERROR_OUT_OF_LIMITS,
      "69: error: 2000h:00 ParameterValue: 1 to 3 expected (its limits), there is 4\n" },
    { "a value below its limits",
      OBJECT("2000", VAR("2000", "4", "rw") "LowLimit=-5\nHighLimit=0xFFFFFFFE\n"
                                            "ParameterValue=-6\n"),
      DCF_ERROR_OUT_OF_LIMITS,
      "69: error: 2000h:00 ParameterValue: -5 to -2 expected (its limits), there is -6\n" },
    { "a fraction outside its limits",
      OBJECT("2000", VAR("2000", "8", "rw") "LowLimit=0.5\nHighLimit=1e3\nParameterValue=0.25\n"),
      DCF_ERROR_OUT_OF_LIMITS,
      "69: error: 2000h:00 ParameterValue: 0.5 to 1000 expected (its limits), there is 0.25\n" },
    { "64 bits above their limit",
      OBJECT("2000", VAR("2000", "0x1B", "rw") "HighLimit=0x7FFFFFFFFFFFFFFF\n"
                                               "ParameterValue=0x8000000000000000\n"),
      DCF_ERROR_OUT_OF_LIMITS,
      "68: error: 2000h:00 ParameterValue: (none) to 9223372036854775807 expected (its limits), "
      "there is 9223372036854775808\n" },
    { "a double outside its limits",
      OBJECT("2000", VAR("2000", "0x11", "rw") "HighLimit=1e300\nParameterValue=2e300\n"),
      DCF_ERROR_OUT_OF_LIMITS,
      "68: error: 2000h:00 ParameterValue: (none) to 1e+300 expected (its limits), there is "
      "2e+300\n" },
    { "a boolean that is none", OBJECT("2000", VAR("2000", "1", "rw") "ParameterValue=2\n"),
      DCF_ERROR_OUT_OF_RANGE,
      "67: error: [2000] ParameterValue: 0 or 1 in the range of BOOLEAN expected, there is "
      "\"2\"\n" },
    { "a fraction that is none", OBJECT("2000", VAR("2000", "8", "rw") "ParameterValue=1,5\n"),
      DCF_ERROR_WRONG_PARAMETER,
      "67: error: [2000] ParameterValue: a decimal fraction or a hexadecimal bit pattern (REAL32) "
      "expected, there is \"1,5\"\n" },
    { "a time that is none", OBJECT("2000", VAR("2000", "0xC", "rw") "ParameterValue=noon\n"),
      DCF_ERROR_WRONG_PARAMETER,
      "67: error: [2000] ParameterValue: days and milliseconds, or 12 hexadecimal digits "
      "(TIME_OF_DAY) expected, there is \"noon\"\n" },
    { "a value of no type", OBJECT("2000", VAR("2000", "0x40", "rw") "ParameterValue=1\n"),
      DCF_ERROR_WRONG_PARAMETER,
      "65: warning: [2000] DataType: a data type of CiA 301 expected, there is 0x40: the entry "
      "cannot be used\n"
      "67: error: [2000] ParameterValue: a data type of CiA 301 (unknown type) expected, there is "
      "\"1\"\n" },
    { "a value of a compact object",
      OBJECT("2000", VAR("2000", "5", "rw") "ObjectType=8\nCompactSubObj=2\nHighLimit=9\n"
                                            "[2000Value]\nNrOfEntries=1\n2=10\n"),
      DCF_ERROR_OUT_OF_LIMITS,
      "72: error: 2000h:02 ParameterValue: (none) to 9 expected (its limits), there is 10\n" },
    { "a node-ID that is too high", COMMISSIONING("NodeID=128\nBaudrate=500\n"),
      DCF_ERROR_WRONG_MODULE_NO,
      "64: error: [DeviceComissioning] NodeID: 1..127 expected, there is \"128\"\n" },
    { "a node-ID that is no number", COMMISSIONING("NodeID=five\nBaudrate=500\n"),
      DCF_ERROR_WRONG_NODE_ID,
      "64: error: [DeviceComissioning] NodeID: 1..127 expected, there is \"five\"\n" },
    { "a bit rate of no CANopen network", COMMISSIONING("NodeID=5\nBaudrate=333\n"),
      DCF_ERROR_WRONG_BAUDRATE,
      "65: error: [DeviceComissioning] Baudrate: 10, 20, 50, 125, 250, 500, 800 or 1000 expected, "
      "there is \"333\"\n" },
    { "a node-ID beyond all numbers", COMMISSIONING("NodeID=18446744073709551621\nBaudrate=500\n"),
      DCF_ERROR_WRONG_NODE_ID,
      "64: error: [DeviceComissioning] NodeID: 1..127 expected, there is "
      "\"18446744073709551621\"\n" },
    { "a bit rate beyond all numbers", COMMISSIONING("NodeID=5\nBaudrate=18446744073709552116\n"),
      DCF_ERROR_WRONG_BAUDRATE,
      "65: error: [DeviceComissioning] Baudrate: 10, 20, 50, 125, 250, 500, 800 or 1000 expected, "
      "there is \"18446744073709552116\"\n" },
    { "a bit rate in bit/s with a unit of kbit/s", COMMISSIONING("NodeID=5\nBaudrate=500000k\n"),
      DCF_ERROR_WRONG_BAUDRATE,
      "65: error: [DeviceComissioning] Baudrate: 10, 20, 50, 125, 250, 500, 800 or 1000 expected, "
      "there is \"500000k\"\n" },
    { "a formula that leaves its type",
      OBJECT("2000",
             VAR("2000", "5", "rw") "ParameterValue=$NODEID+250\n"
                                    "[DeviceComissioning]\nNodeID=6\nBaudrate=500\n" NETWORK),
      DCF_ERROR_OUT_OF_RANGE,
      "67: error: 2000h:00: a value of UNSIGNED8 expected, with node-ID 6 this is too large\n" },
    { "a module that is not there",
      LINES("[SupportedModules]\nNrOfEntries=2\n[ConnectedModules]\nNrOfEntries=2\n1=2\n2=3\n"),
      DCF_ERROR_WRONG_MODULE_NO,
      "63: warning: [SupportedModules]: an object 1027h (the list of modules) expected, it is "
      "missing\n"
      "68: error: [ConnectedModules] 2: a module of 1..2 expected, there is \"3\"\n"
      "63: warning: [SupportedModules]: a section [M1ModuleInfo] expected, it is missing\n" },
    { "a module that is no number", LINES("[ConnectedModules]\nNrOfEntries=1\n1=IO-1\n"),
      DCF_ERROR_WRONG_MODULE_NO,
      "65: error: [ConnectedModules] 1: a module of 1..127 expected, there is \"IO-1\"\n" },
    { "module 0", LINES("[ConnectedModules]\nNrOfEntries=1\n1=0\n"), DCF_ERROR_WRONG_MODULE_NO,
      "65: error: [ConnectedModules] 1: a module of 1..127 expected, there is \"0\"\n" },
    { "all errors are told, the kind is the first one's",
      U8_OBJECT("ParameterValue=256\n[DeviceComissioning]\nNodeID=200\nBaudrate=500\n" NETWORK),
      DCF_ERROR_WRONG_MODULE_NO,
      "69: error: [DeviceComissioning] NodeID: 1..127 expected, there is \"200\"\n"
      "67: error: [2000] ParameterValue: a number in the range of UNSIGNED8 expected, there is "
      "\"256\"\n" },
};

START_TEST(test_error)
{
    ck_assert_int_eq(parse(errors[_i].file), CO_ERR_FORMAT);
    ck_assert_msg(strcmp(messages.text, errors[_i].message) == 0, "%s:\n%s", errors[_i].name,
                  messages.text);
    ck_assert_int_eq(messages.report.error_kind, errors[_i].kind);
    ck_assert_uint_eq(dcf.count, 0);
    ck_assert_ptr_null(dcf.entries);
}
END_TEST

static Suite *messages_suite(void)
{
    Suite *suite = suite_create("dcf_messages");
    TCase *tests = tcase_create("dcf_messages");

    tcase_add_loop_test(tests, test_warning, 0, sizeof warnings / sizeof warnings[0]);
    tcase_add_loop_test(tests, test_error, 0, sizeof errors / sizeof errors[0]);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(messages_suite());
    int failed;

    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}
