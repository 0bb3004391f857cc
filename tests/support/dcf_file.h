/* Pieces of EDS and DCF files. */
#ifndef TEST_SUPPORT_DCF_FILE_H
#define TEST_SUPPORT_DCF_FILE_H

/* A file without anything to say about; what it has besides begins at line 63. */
#define FILE_INFO                                                                                  \
    "[FileInfo]\nFileName=a.eds\nFileVersion=1\nFileRevision=0\nEDSVersion=4.0\n"                  \
    "ModificationTime=09:45AM\nModificationDate=05-15-2004\nLastEDS=e.eds\n"
#define DEVICE_INFO                                                                                \
    "[DeviceInfo]\nVendorName=V\nVendorNumber=1\nProductName=P\nProductNumber=2\n"                 \
    "RevisionNumber=3\nOrderCode=O\nBaudRate_10=0\nBaudRate_20=0\nBaudRate_50=0\n"                 \
    "BaudRate_125=0\nBaudRate_250=0\nBaudRate_500=1\nBaudRate_800=0\nBaudRate_1000=0\n"            \
    "SimpleBootUpMaster=0\nSimpleBootUpSlave=1\nGranularity=8\nNrOfRXPDO=0\nNrOfTXPDO=0\n"         \
    "LSS_Supported=0\n"
#define LISTS                                                                                      \
    "[DummyUsage]\nDummy0005=1\n[MandatoryObjects]\nSupportedObjects=3\n1=0x1000\n"                \
    "2=0x1001\n3=0x1018\n[ManufacturerObjects]\nSupportedObjects=0\n"
#define OPTIONAL "[OptionalObjects]\nSupportedObjects=0\n"
#define VAR(name, type, access)                                                                    \
    "[" name "]\nParameterName=Name\nDataType=" type "\nAccessType=" access "\n"
#define MANDATORY                                                                                  \
    VAR("1000", "7", "ro")                                                                         \
    "DefaultValue=1\n" VAR("1001", "5",                                                            \
                           "ro") "[1018]\nParameterName=Identity\nObjectType=9\nSubNumber="        \
                                 "2\n" VAR("1018sub0", "5",                                        \
                                           "const") "DefaultValue=1\n" VAR("1018sub1", "7", "ro")
#define LINES(text) FILE_INFO DEVICE_INFO LISTS OPTIONAL MANDATORY text
#define CLEAN       LINES("")

/* With one manufacturer object, to be described from line 63 on. */
#define OBJECT(name, text)                                                                         \
    FILE_INFO DEVICE_INFO                                                                          \
        "[DummyUsage]\n[MandatoryObjects]\nSupportedObjects=3\n1=0x1000\n"                         \
        "2=0x1001\n3=0x1018\n[ManufacturerObjects]\nSupportedObjects=1\n1=0x" name                 \
        "\n" OPTIONAL MANDATORY text

#endif
