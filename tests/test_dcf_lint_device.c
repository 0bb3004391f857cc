/* What a file tells of the device and of its place in the network. */
#include "support/lint.h"
#include "support/suite.h"

#define COMMISSIONED(rest) "[DeviceComissioning]\nNodeID=5\n" rest
#define DEVICE_TYPE(value) "[1000]\nDefaultValue=" value "\n"
#define CONSUMERS(one, two)                                                                        \
    ARRAY_OF("1016", 3)                                                                            \
    VALUE("1016sub0", "5", "ro", "2")                                                              \
    VALUE("1016sub1", "7", "rw", one) VALUE("1016sub2", "7", "rw", two)
#define GUARDING(time, factor) VALUE("100C", "6", "rw", time) VALUE("100D", "5", "rw", factor)

static const struct lint_row devices_rows[] = {
    { "its numbers", "[DeviceInfo]\nVendorNumber=0x17\nProductNumber=3\n", "" },
    { "another vendor", "[DeviceInfo]\nVendorNumber=0x18\n",
      "2 identity: [DeviceInfo] VendorNumber: 0x17 expected (DefaultValue of 1018h:01), there is "
      "0x18\n" },
    { "another product and revision",
      "[DeviceInfo]\nProductNumber=3\nRevisionNumber=4\n" VALUE("1018sub2", "7", "ro", "2")
          VALUE("1018sub3", "7", "ro", "5") "[1018sub0]\nDefaultValue=3\n",
      "2 identity: [DeviceInfo] ProductNumber: 0x2 expected (DefaultValue of 1018h:02), there is "
      "0x3\n3 identity: [DeviceInfo] RevisionNumber: 0x5 expected (DefaultValue of 1018h:03), "
      "there is 0x4\n" },
    { "no bit rate", "[DeviceInfo]\nBaudRate_500=0\nBaudRate_125=0\n",
      "0 no-bit-rate: [DeviceInfo]: a BaudRate_... with 1 expected, there is none\n" },
    { "a bit rate of the device", COMMISSIONED("Baudrate=125\n"), "" },
    { "another bit rate", COMMISSIONED("Baudrate=250\n"),
      "3 bit-rate-unsupported: [DeviceComissioning] Baudrate: a bit rate of the device expected, "
      "BaudRate_250 is 0\n" },
    { "a bit rate that is not told", COMMISSIONED("Baudrate=0\n"), "" },
    { "a manager", COMMISSIONED("CANopenManager=1\n") VALUE("1F80", "7", "rw", "1"), "" },
    { "a manager that is none", COMMISSIONED("CANopenManager=1\n"),
      "3 manager: [DeviceComissioning] CANopenManager: 0 expected (the device has no 1F80h), there "
      "is 1\n" },
    { "the EDS of a DCF", COMMISSIONED("[FileInfo]\nLastEDS=a.eds\n"), "" },
    { "the EDS of an EDS", "[FileInfo]\nLastEDS=a.eds\n",
      "2 last-eds: [FileInfo] LastEDS: expected in a DCF only, this file has no "
      "[DeviceComissioning]\n" },
    { "inputs and outputs",
      DEVICE_TYPE("0x30191") VALUE("6000", "5", "ro", "0") VALUE("6200", "5", "ro", "0"), "" },
    { "an output less", DEVICE_TYPE("0x30191") VALUE("6000", "5", "ro", "0"),
      "2 profile-object: 1000h: an object 6200h (digital outputs) expected for device type "
      "0x30191, it is missing\n" },
    { "a drive", DEVICE_TYPE("0x20192") VALUE("6040", "6", "rw", "0") VALUE("6041", "6", "ro", "0"),
      "" },
    { "a drive without controlword", DEVICE_TYPE("0x20192") VALUE("6041", "6", "ro", "0"),
      "2 profile-object: 1000h: an object 6040h (controlword) expected for device type 0x20192, it "
      "is missing\n" },
    { "heartbeat, and guarding that is off", GUARDING("0", "3"), "" },
    { "heartbeat and guarding", GUARDING("100", "3"),
      "5 heartbeat-and-guarding: 100Ch: 0 expected where there is a heartbeat (1017h is 1000 ms), "
      "there are 100 ms: heartbeat counts\n" },
    { "two nodes are watched", CONSUMERS("0x00050064", "0x00060064"), "" },
    { "the last node is watched", CONSUMERS("0x007F0064", "0x00060064"), "" },
    { "a node is watched twice", CONSUMERS("0x00050064", "0x00050065"),
      "19 heartbeat-consumer-twice: 1016h:02: a node that is not watched yet expected, node 5 is "
      "by sub-index 1\n" },
    { "a node is named twice", CONSUMERS("0x00050064", "0x00050000"), "" },
    { "what is no node", CONSUMERS("0x00000064", "0x00800064"),
      "19 heartbeat-consumer: 1016h:02: a node-ID of 1..127 in bits 16 to 31 expected, there is "
      "0080h\n" },
    { "a SYNC counter", VALUE("1019", "5", "rw", "2"), "" },
    { "the highest SYNC counter", VALUE("1019", "5", "rw", "240"), "" },
    { "a SYNC counter of one", VALUE("1019", "5", "rw", "1"),
      "5 sync-counter: 1019h: 0 or 2..240 expected, there is 1\n" },
    { "a SYNC counter that is too large", VALUE("1019", "5", "rw", "241"),
      "5 sync-counter: 1019h: 0 or 2..240 expected, there is 241\n" },
    { "SYNC and its period", VALUE("1005", "7", "rw", "0x40000080") VALUE("1006", "7", "rw", "0"),
      "" },
    { "SYNC without period", VALUE("1005", "7", "rw", "0x40000080"),
      "5 sync-period: 1005h: an object 1006h (communication cycle period) expected, the device is "
      "to send SYNC\n" },
};

START_TEST(devices)
{
    lint_check(&devices_rows[_i]);
}
END_TEST

START_TEST(neither_heartbeat_nor_guarding)
{
    ck_assert_str_eq(lint_of_file(LINES("[FileInfo]\nLastEDS=\n[DeviceInfo]\nBaudRate_125=1\n")),
                     "0 no-error-control: an object 1017h (heartbeat) expected, or 100Ch and 100Dh "
                     "(guarding), there is neither\n");
    ck_assert_str_eq(lint_of_file(LINES("[FileInfo]\nLastEDS=\n" VALUE("100C", "6", "rw", "0")
                                            VALUE("100D", "5", "rw", "0"))),
                     "");
    ck_assert_str_ne(
        lint_of_file(LINES("[DeviceInfo]\nBaudRate_125=1\n" VALUE("100C", "6", "rw", "0"))), "");
}
END_TEST

#define ROWS(table) (int)(sizeof(table) / sizeof *(table))

int main(void)
{
    TCase *tests = tcase_create("dcf_lint_device");

    tcase_add_loop_test(tests, devices, 0, ROWS(devices_rows));
    tcase_add_test(tests, neither_heartbeat_nor_guarding);
    return suite_run("dcf_lint_device", tests);
}
