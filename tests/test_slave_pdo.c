/* PDOs of a device, seen from the bus and from its application. */
#include "slave/slave.h"

#include "slave/slave_internal.h"
#include "support/device.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define OFF 0x80000000u

/* Numbers with gaps, up to the last one; RPDO 2 shares its CAN-ID with RPDO 1. */
static const struct device_entry entries[] = {
    { 0x1005, 0, OD_UNSIGNED32, OD_RW, 0x80, false },
    { 0x1006, 0, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1007, 0, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1014, 0, OD_UNSIGNED32, OD_RW, 0x85, false },
    { 0x1016, 0, OD_UNSIGNED8, OD_CONST, 2, false },
    { 0x1016, 1, OD_UNSIGNED32, OD_RW, 0x000A03E8, false },
    { 0x1016, 2, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1400, 1, OD_UNSIGNED32, OD_RW, 0x205, false },
    { 0x1400, 2, OD_UNSIGNED8, OD_RW, 255, false },
    { 0x1400, 5, OD_UNSIGNED16, OD_RW, 0, false },
    { 0x1600, 0, OD_UNSIGNED8, OD_RW, 2, false },
    { 0x1600, 1, OD_UNSIGNED32, OD_RW, 0x20000010, false },
    { 0x1600, 2, OD_UNSIGNED32, OD_RW, 0x20010010, false },
    { 0x1401, 1, OD_UNSIGNED32, OD_RW, 0x205, false },
    { 0x1401, 2, OD_UNSIGNED8, OD_RW, 1, false },
    { 0x1601, 0, OD_UNSIGNED8, OD_RW, 1, false },
    { 0x1601, 1, OD_UNSIGNED32, OD_RW, 0x20020020, false },
    { 0x15FF, 1, OD_UNSIGNED32, OD_RW, 0x20012345, false },
    { 0x15FF, 2, OD_UNSIGNED8, OD_RW, 255, false },
    { 0x17FF, 0, OD_UNSIGNED8, OD_RW, 1, false },
    { 0x17FF, 1, OD_UNSIGNED32, OD_RW, 0x20030008, false },
    { 0x1800, 1, OD_UNSIGNED32, OD_RW, 0x185, false },
    { 0x1800, 2, OD_UNSIGNED8, OD_RW, 255, false },
    { 0x1800, 3, OD_UNSIGNED16, OD_RW, 0, false },
    { 0x1800, 5, OD_UNSIGNED16, OD_RW, 0, false },
    { 0x1A00, 0, OD_UNSIGNED8, OD_RW, 1, false },
    { 0x1A00, 1, OD_UNSIGNED32, OD_RW, 0x21000010, false },
    { 0x1802, 1, OD_UNSIGNED32, OD_RW, 0x40000385, false },
    { 0x1802, 2, OD_UNSIGNED8, OD_RW, 0, false },
    { 0x1A02, 0, OD_UNSIGNED8, OD_RW, 2, false },
    { 0x1A02, 1, OD_UNSIGNED32, OD_RW, 0x21000010, false },
    { 0x1A02, 2, OD_UNSIGNED32, OD_RW, 0x20000010, false },
    { 0x19FF, 1, OD_UNSIGNED32, OD_RW, OFF | 0x485, false },
    { 0x19FF, 2, OD_UNSIGNED8, OD_RW, 254, false },
    { 0x19FF, 3, OD_UNSIGNED16, OD_RW, 100, false },
    { 0x1BFF, 0, OD_UNSIGNED8, OD_RW, 1, false },
    { 0x1BFF, 1, OD_UNSIGNED32, OD_RW, 0x20030008, false },
    { 0x2000, 0, OD_UNSIGNED16, OD_RW, 0, true },
    { 0x2001, 0, OD_UNSIGNED16, OD_RWW, 0, true },
    { 0x2002, 0, OD_UNSIGNED32, OD_RWW, 0, true },
    { 0x2003, 0, OD_UNSIGNED8, OD_RW, 0, true },
    { 0x2100, 0, OD_UNSIGNED16, OD_RW, 0x1111, true },
    { 0x2101, 0, OD_UNSIGNED16, OD_RW, 0x2222, false },
    { 0 },
};

static struct device device;

static void setup(void)
{
    device_init(&device, entries);
}

static void teardown(void)
{
    device_done(&device);
}

/* clang-format off */
#define BOOT { 0, SENDS, "705#00" }
#define START { 0, HEARS, "000#0105" }
#define STATES { 0, TELLS, "state 0" }, { 0, TELLS, "state 127" }, { 0, TELLS, "state 5" }

static const struct device_talk talks[] = {
    { "nothing before the start, and nothing behind its end",
      { BOOT, { 0, DOES, "flags t1 1" },
        { 1, DOES, "send 1 -> -13" }, { 1, DOES, "set 2100:00 1" }, { 1, HEARS, "185#R2" },
        { 1, HEARS, "080#" }, { 1, HEARS, "205#11223344" }, { 1, DOES, "request 1 -> -13" },
        { 2, HEARS, "000#0105" }, { 2, SENDS, "185#0100" },
        { 3, HEARS, "000#0205" }, { 3, DOES, "send 1 -> -13" }, { 3, DOES, "set 2100:00 2" },
        { 3, HEARS, "185#R2" }, { 3, HEARS, "080#" }, { 9, QUIET, "-" } } },
    { "sent by the application",
      { BOOT, START, { 1, DOES, "send 1" }, { 1, SENDS, "185#1111" },
        { 2, DOES, "set 2100:00 1234" }, { 2, QUIET, "-" },
        { 3, DOES, "send 1" }, { 3, SENDS, "185#3412" },
        { 4, DOES, "send 2 -> -1" }, { 4, DOES, "send 0 -> -1" }, { 4, DOES, "send 513 -> -1" },
        { 4, DOES, "send 512 -> -1" }, { 5, DOES, "send 3" }, { 5, QUIET, "-" },
        { 6, HEARS, "080#" }, { 6, SENDS, "385#34120000" } } },
    { "sent with each change",
      { BOOT, { 0, DOES, "flags t1 1" }, START, { 0, SENDS, "185#1111" },
        { 1, DOES, "set 2100:00 2" }, { 1, SENDS, "185#0200" },
        { 2, DOES, "set 2100:00 2" }, { 2, SENDS, "185#0200" }, { 3, DOES, "set 2101:00 2" },
        { 4, HEARS, "605#2B00210003000000" }, { 4, SENDS, "585#6000210000000000" },
        { 4, SENDS, "185#0300" },
        { 5, HEARS, "605#2B00210003000000" }, { 5, SENDS, "585#6000210000000000" },
        { 6, HEARS, "605#2B01210003000000" }, { 6, SENDS, "585#6001210000000000" },
        { 7, DOES, "flags t1 0" }, { 7, DOES, "set 2100:00 4" }, { 8, QUIET, "-" } } },
    { "an SDO write is an event to one of type 0",
      { BOOT, START, { 1, HEARS, "080#" }, { 1, SENDS, "385#11110000" }, { 2, HEARS, "080#" },
        { 3, HEARS, "605#2B00210003000000" }, { 3, SENDS, "585#6000210000000000" },
        { 4, HEARS, "080#" }, { 4, SENDS, "385#03000000" }, { 5, HEARS, "080#" } } },
    { "held, then sent once",
      { BOOT, { 0, DOES, "flags t1 1" }, START, { 0, SENDS, "185#1111" },
        { 1, DOES, "hold" }, { 1, DOES, "set 2100:00 2" }, { 2, DOES, "set 2100:00 3" },
        { 3, QUIET, "-" }, { 3, DOES, "release" }, { 3, SENDS, "185#0300" },
        { 4, DOES, "release" }, { 4, DOES, "hold" }, { 5, DOES, "set 2100:00 4" },
        { 5, DOES, "send 1" }, { 5, SENDS, "185#0400" }, { 6, DOES, "release" }, { 7, QUIET, "-" },
        { 7, DOES, "hold" }, { 7, DOES, "set 2100:00 5" }, { 8, HEARS, "000#8005" },
        { 9, DOES, "release" }, { 9, HEARS, "000#0105" }, { 9, SENDS, "185#0500" },
        { 10, QUIET, "-" } } },
    { "the inhibit time: what calls return, and one frame at its end",
      { BOOT, { 0, DOES, "flags t512 1" },
        { 0, HEARS, "605#23FF190185040000" }, { 0, SENDS, "585#60FF190100000000" },
        START, { 0, SENDS, "485#00" },
        { 1, DOES, "set 2003:00 1 -> -16" }, { 2, DOES, "send 512 -> -16" },
        { 3, DOES, "set 2003:00 3 -> -16" }, { 9, QUIET, "-" }, { 10, SENDS, "485#03" },
        { 20, DOES, "set 2003:00 4" }, { 20, SENDS, "485#04" } } },
    { "received: at once, by number, and told",
      { BOOT, START, { 0, DOES, "flags r1 1" }, { 0, DOES, "flags r512 1" }, STATES,
        { 1, HEARS, "205#11223344" }, { 1, TELLS, "rpdo 1 11223344 at 1" },
        { 2, HEARS, "00012345#7F" }, { 2, TELLS, "rpdo 512 7F at 2" },
        { 3, HEARS, "345#7F" }, { 3, HEARS, "00000205#11223344" }, { 3, HEARS, "205#R4" },
        { 3, ECHOES, "205#11223344" }, { 3, TELLS, "" },
        { 4, DOES, "flags r1 0" }, { 4, HEARS, "205#11223344" }, { 4, TELLS, "" } } },
    { "one frame for two RPDOs, one of them synchronous",
      { BOOT, { 0, DOES, "flags r1 1" }, { 0, DOES, "flags r2 1" }, START, STATES,
        { 1, HEARS, "205#11223344" }, { 1, TELLS, "rpdo 1 11223344 at 1" }, { 1, TELLS, "" },
        { 5, HEARS, "080#" }, { 5, SENDS, "385#11111122" },
        { 5, TELLS, "rpdo 2 11223344 at 1" }, { 5, TELLS, "" } } },
    { "TPDOs of a SYNC go out before its data is taken over",
      { BOOT, { 0, HEARS, "605#2F00140201000000" }, { 0, SENDS, "585#6000140200000000" },
        START, { 1, HEARS, "205#AABBCCDD" }, { 2, HEARS, "080#" }, { 2, SENDS, "385#11110000" },
        { 3, HEARS, "080#" }, { 3, SENDS, "385#1111AABB" } } },
    { "data received is mirrored where it differs",
      { BOOT, { 0, DOES, "flags t512 1" },
        { 0, HEARS, "605#23FF190185040000" }, { 0, SENDS, "585#60FF190100000000" },
        START, { 0, SENDS, "485#00" },
        { 20, HEARS, "00012345#01" }, { 20, SENDS, "485#01" },
        { 40, HEARS, "00012345#01" }, { 60, QUIET, "-" },
        { 61, HEARS, "00012345#02" }, { 61, SENDS, "485#02" },
        { 62, HEARS, "00012345#03" }, { 63, HEARS, "00012345#04" }, { 71, SENDS, "485#04" } } },
    { "too short, too long: one emergency each",
      { BOOT, START, STATES,
        { 1, HEARS, "605#2301140105020080" }, { 1, SENDS, "585#6001140100000000" },
        { 1, TELLS, "written 1401:01 = 2147484165" },
        { 2, HEARS, "205#112233" }, { 2, SENDS, "085#1082110004010304" },
        { 2, TELLS, "rpdo 1 wrong 8210, 3 of 4" }, { 2, TELLS, "emcy 8210 11" },
        { 3, HEARS, "205#" }, { 3, TELLS, "" },
        { 4, HEARS, "205#1122334455" }, { 4, SENDS, "085#2082110004010504" },
        { 4, TELLS, "rpdo 1 wrong 8220, 5 of 4" }, { 4, TELLS, "emcy 8220 11" },
        { 5, HEARS, "205#11223344" }, { 5, SENDS, "085#0000000004000000" },
        { 5, TELLS, "emcy 0000 00" }, { 6, HEARS, "205#11223344" }, { 6, TELLS, "" } } },
    { "two that are wrong: the register clears with the second",
      { BOOT, START,
        { 1, HEARS, "205#" }, { 1, SENDS, "085#1082110004010004" },
        { 1, SENDS, "085#1082110004020004" },
        { 2, HEARS, "605#2301140105020080" }, { 2, SENDS, "585#6001140100000000" },
        { 2, SENDS, "085#0000110004000000" },
        { 3, HEARS, "205#11223344" }, { 3, SENDS, "085#0000000004000000" } } },
    { "wrong together with a silent producer",
      { BOOT, START, { 0, HEARS, "70A#05" },
        { 1, HEARS, "00012345#" }, { 1, SENDS, "085#1082110004000001" },
        { 1000, SENDS, "085#3081110104000000" }, { 1001, HEARS, "000#0105" },
        { 1001, SENDS, "085#0000110104000000" }, { 1002, HEARS, "00012345#" },
        { 1002, SENDS, "085#1082110104000001" } } },
    { "a deadline",
      { BOOT, { 0, HEARS, "605#2B00140564000000" }, { 0, SENDS, "585#6000140500000000" },
        START, { 500, HEARS, "205#11223344" }, { 599, QUIET, "-" },
        { 600, SENDS, "085#5082110000010000" }, { 700, HEARS, "205#11223344" },
        { 700, SENDS, "085#0000000000000000" }, { 750, HEARS, "000#8005" },
        { 2000, QUIET, "-" } } },
    { "an error is told again after a reset, and gone with it",
      { BOOT, START, { 1, HEARS, "00012345#" }, { 1, SENDS, "085#1082110004000001" },
        { 2, HEARS, "000#8205" }, { 2, SENDS, "705#00" }, { 3, HEARS, "000#0105" },
        { 4, HEARS, "00012345#" }, { 4, SENDS, "085#1082110004000001" },
        { 5, HEARS, "000#8005" }, { 6, HEARS, "000#0105" },
        { 6, SENDS, "085#0000000004000000" } } },
    { "confirmations",
      { BOOT, { 0, DOES, "flags t1 2" }, START, STATES,
        { 1, DOES, "send 1" }, { 1, SENDS, "185#1111" }, { 1, TELLS, "" },
        { 2, ECHOES, "185#1111" }, { 2, TELLS, "confirmed 1" },
        { 3, ECHOES, "185#R2" }, { 3, HEARS, "185#1111" }, { 3, ECHOES, "385#00000000" },
        { 3, TELLS, "" },
        { 4, DOES, "flags t1 0" }, { 4, ECHOES, "185#1111" }, { 4, TELLS, "" } } },
    { "requests: allowed, forbidden, own",
      { BOOT, START, { 1, HEARS, "185#R2" }, { 1, SENDS, "185#1111" },
        { 2, HEARS, "185#R0" }, { 2, SENDS, "185#1111" },
        { 3, HEARS, "385#R4" }, { 3, ECHOES, "185#R2" }, { 3, HEARS, "185#1122" },
        { 4, DOES, "request 1" }, { 4, SENDS, "205#R4" },
        { 5, DOES, "request 512" }, { 5, SENDS, "00012345#R1" },
        { 6, DOES, "request 3 -> -1" },
        { 7, HEARS, "605#2300140105020080" }, { 7, SENDS, "585#6000140100000000" },
        { 8, DOES, "request 1 -> -1" } } },
    { "parameters take effect at once",
      { BOOT, START, { 1, HEARS, "605#2B00180564000000" }, { 1, SENDS, "585#6000180500000000" },
        { 101, SENDS, "185#1111" },
        { 150, HEARS, "605#2300180185010080" }, { 150, SENDS, "585#6000180100000000" },
        { 400, QUIET, "-" },
        { 400, HEARS, "605#230018018A010000" }, { 400, SENDS, "585#6000180100000000" },
        { 499, QUIET, "-" }, { 500, SENDS, "18A#1111" },
        { 501, HEARS, "18A#R2" }, { 501, SENDS, "18A#1111" }, { 502, HEARS, "185#R2" },
        { 510, HEARS, "605#2F00180201000000" }, { 510, SENDS, "585#6000180200000000" },
        { 700, QUIET, "-" }, { 700, HEARS, "080#" }, { 700, SENDS, "18A#1111" },
        { 700, SENDS, "385#11110000" } } },
    { "an event-driven one that is switched on is sent",
      { BOOT, { 0, DOES, "flags t1 1" }, START, { 0, SENDS, "185#1111" },
        { 1, HEARS, "605#2300180185010080" }, { 1, SENDS, "585#6000180100000000" },
        { 1, DOES, "set 2100:00 2" },
        { 2, HEARS, "605#2300180185010000" }, { 2, SENDS, "585#6000180100000000" },
        { 2, SENDS, "185#0200" } } },
    { "another mapping",
      { BOOT, { 0, HEARS, "605#2300140105020080" }, { 0, SENDS, "585#6000140100000000" },
        { 0, HEARS, "605#2301140105020080" }, { 0, SENDS, "585#6001140100000000" },
        { 0, HEARS, "605#2F00160000000000" }, { 0, SENDS, "585#6000160000000000" },
        { 0, HEARS, "605#2300160110000120" }, { 0, SENDS, "585#6000160100000000" },
        { 0, HEARS, "605#2300160208000200" }, { 0, SENDS, "585#6000160200000000" },
        { 0, HEARS, "605#2F00160002000000" }, { 0, SENDS, "585#6000160000000000" },
        { 0, HEARS, "605#2300140105020000" }, { 0, SENDS, "585#6000140100000000" },
        START, { 1, HEARS, "205#11223344" }, { 1, SENDS, "085#2082110004010403" },
        { 2, HEARS, "205#112233" }, { 2, SENDS, "085#0000000004000000" },
        { 3, HEARS, "605#4001200000000000" }, { 3, SENDS, "585#4B01200011220000" } } },
};
/* clang-format on */

#define TALKS ((int)(sizeof talks / sizeof talks[0]))

/* Each twice: with room in the outbox, and without in the first moment. */
START_TEST(conversation)
{
    device_start(&device);
    device.stalled = _i % 2 != 0;
    device_talk(&device, &talks[_i / 2]);
}
END_TEST

static void start_operational(void)
{
    device_start(&device);
    device_hear(&device, "000#0105");
    device_drain(&device);
    device_forget(&device);
}

START_TEST(by_number)
{
    ck_assert_uint_eq(slave_rpdo(&device.slave, 1)->number, 1);
    ck_assert_uint_eq(slave_rpdo(&device.slave, 2)->number, 2);
    ck_assert_ptr_null(slave_rpdo(&device.slave, 3));
    ck_assert_ptr_null(slave_rpdo(&device.slave, 511));
    ck_assert_uint_eq(slave_rpdo(&device.slave, 512)->number, 512);
    ck_assert_ptr_null(slave_rpdo(&device.slave, 0));
    ck_assert_ptr_null(slave_rpdo(&device.slave, 513));
    ck_assert_ptr_null(slave_rpdo(&device.slave, UINT16_MAX));
    ck_assert_uint_eq(slave_tpdo(&device.slave, 1)->number, 1);
    ck_assert_ptr_null(slave_tpdo(&device.slave, 2));
    ck_assert_uint_eq(slave_tpdo(&device.slave, 3)->number, 3);
    ck_assert_uint_eq(slave_tpdo(&device.slave, 512)->number, 512);
    ck_assert_ptr_null(slave_tpdo(&device.slave, 0));
    slave_pdo_set_flags(&device.slave, PDO_TRANSMIT, 2, SLAVE_PDO_NOTIFY); /* there is none */
}
END_TEST

START_TEST(what_was_received)
{
    struct rpdo *rpdo = slave_rpdo(&device.slave, 1);

    start_operational();
    device_hear(&device, "205#11223344");
    device_drain(&device);
    ck_assert_str_eq(device_next_event(&device), "");
    rpdo->waiters = 1;
    device_hear(&device, "205#55667788");
    device_drain(&device);
    ck_assert_str_eq(device_next_event(&device), "rpdo 1 55667788 at 0");
    ck_assert_uint_eq(rpdo->received, 2);
    ck_assert_uint_eq(rpdo->dlc, 4);
    ck_assert_mem_eq(rpdo->data, "\x55\x66\x77\x88", 4);
    device_hear(&device, "205#55667788AA");
    ck_assert_uint_eq(rpdo->errors, 1);
    ck_assert_uint_eq(rpdo->wrong_size, 5);
    ck_assert_uint_eq(rpdo->received, 2);
    device.slave.accept_long = true;
    device_hear(&device, "205#01020304AA");
    ck_assert_uint_eq(rpdo->received, 3);
    ck_assert_uint_eq(rpdo->errors, 1);
    ck_assert_uint_eq(rpdo->dlc, 4);
}
END_TEST

static struct od_entry *entry_at(uint16_t index)
{
    return od_find(&device.od, index, 0);
}

/* How many PDOs an entry is in: each counts once. */
START_TEST(count_of_mappings)
{
    device_start(&device);
    ck_assert_uint_eq(entry_at(0x2100)->map_count, 2);
    ck_assert_uint_eq(entry_at(0x2000)->map_count, 2);
    ck_assert_uint_eq(entry_at(0x2001)->map_count, 1);
    ck_assert_uint_eq(entry_at(0x2101)->map_count, 0);
    ck_assert_uint_eq(device_write(&device, 0x1800, 1, 4, OFF), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x1A00, 0, 1, 0), SDO_OK);
    ck_assert_uint_eq(entry_at(0x2100)->map_count, 1);
    ck_assert_uint_eq(device_write(&device, 0x1A00, 0, 1, 1), SDO_OK);
    ck_assert_uint_eq(entry_at(0x2100)->map_count, 2);
    ck_assert_uint_eq(device_write(&device, 0x1802, 1, 4, OFF), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x1A02, 0, 1, 0), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x1A02, 1, 4, 0x20000010), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x1A02, 0, 1, 2), SDO_OK);
    ck_assert_uint_eq(entry_at(0x2100)->map_count, 1);
    ck_assert_uint_eq(entry_at(0x2000)->map_count, 2);
    device_hear(&device, "000#8205");
    ck_assert_uint_eq(entry_at(0x2100)->map_count, 2);
    device_hear(&device, "000#8105");
    ck_assert_uint_eq(entry_at(0x2100)->map_count, 2);
}
END_TEST

START_TEST(what_is_sent_by_change)
{
    start_operational();
    ck_assert(!slave_entry_is_sent(&device.slave, entry_at(0x2100)));
    device_do(&device, "flags t3 1"); /* of type 0 */
    ck_assert(!slave_entry_is_sent(&device.slave, entry_at(0x2100)));
    device_do(&device, "flags t1 1");
    ck_assert(slave_entry_is_sent(&device.slave, entry_at(0x2100)));
    ck_assert(!slave_entry_is_sent(&device.slave, entry_at(0x2101)));
    ck_assert(!slave_entry_is_sent(&device.slave, entry_at(0x2002)));
    ck_assert_uint_eq(device_write(&device, 0x1800, 1, 4, OFF), SDO_OK);
    ck_assert(!slave_entry_is_sent(&device.slave, entry_at(0x2100)));
}
END_TEST

/* The application's own value of a communication parameter works as a client's. */
START_TEST(changed_by_the_application)
{
    const unsigned generation = device.slave.listen_generation;

    start_operational();
    od_set_number(&device.od, 0x1400, 1, 0x222);
    ck_assert_int_eq(
        slave_entry_changed(&device.slave, od_find(&device.od, 0x1400, 1), device.now, &device.out),
        CO_OK);
    ck_assert_uint_ne(device.slave.listen_generation, generation);
    device_hear(&device, "222#11223344");
    ck_assert_uint_eq(od_number(&device.od, 0x2001, 0, 0), 0x4433);
}
END_TEST

/* What finds no room stays due, and goes first; nothing is lost. */
START_TEST(full_outbox)
{
    start_operational();
    device_do(&device, "flags t1 3");
    device_do(&device, "flags r1 1");
    device_fill(&device, 0, 0);
    device_do(&device, "set 2100:00 1234 -> -3");
    device_do(&device, "send 1 -> -3");
    device_do(&device, "request 1 -> -3");
    device_hear(&device, "205#11223344");
    ck_assert_uint_eq(slave_deadline(&device.slave), 0);
    ck_assert_uint_eq(od_number(&device.od, 0x2001, 0, 0), 0);
    device_drain(&device);
    device_hear(&device, "205#55667788"); /* the first one is taken over before */
    device_drain(&device);
    ck_assert_str_eq(device_next_frame(&device, NULL), "185#3412");
    ck_assert_str_eq(device_next_frame(&device, NULL), "");
    ck_assert_str_eq(device_next_event(&device), "rpdo 1 11223344 at 0");
    ck_assert_str_eq(device_next_event(&device), "rpdo 1 55667788 at 0");
    ck_assert_uint_gt(slave_deadline(&device.slave), 0);
}
END_TEST

/* A SYNC with room for one frame: the data received waits until both have gone. */
START_TEST(sync_with_little_room)
{
    start_operational();
    ck_assert_uint_eq(device_write(&device, 0x1800, 2, 1, 1), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x1400, 2, 1, 1), SDO_OK);
    device_forget(&device);
    device_hear(&device, "205#AABBCCDD");
    device_fill(&device, 1, 4);
    device_hear(&device, "080#");
    ck_assert_uint_eq(od_number(&device.od, 0x2000, 0, 0), 0);
    device_drain(&device);
    device_run(&device, 0);
    ck_assert_uint_eq(od_number(&device.od, 0x2000, 0, 0), 0xBBAA);
    ck_assert_str_eq(device_next_frame(&device, NULL), "185#1111");
    ck_assert_str_eq(device_next_frame(&device, NULL), "385#11110000");
}
END_TEST

static const struct slave_filter *find_filter(const struct slave_filter *filters, unsigned count,
                                              const struct slave_filter *wanted)
{
    const struct slave_filter *found = NULL;

    for (unsigned i = 0; i < count; i++)
        if (filters[i].id == wanted->id && filters[i].ext == wanted->ext &&
            filters[i].rtr == wanted->rtr) {
            ck_assert_msg(found == NULL, "%03X twice", wanted->id);
            found = &filters[i];
        }
    return found;
}

static void expect_filters(const struct slave_filter *wanted)
{
    struct slave_filter filters[32];
    unsigned count = 0, listens = slave_listens(&device.slave, filters, 32);

    for (; wanted[count].id != 0 || count == 0; count++)
        ck_assert_msg(find_filter(filters, listens, &wanted[count]) != NULL, "%03X",
                      wanted[count].id);
    ck_assert_uint_eq(listens, count);
}

START_TEST(what_it_listens_to)
{
    struct slave_filter first[2] = { { 9, true, true }, { 9, true, true } };
    unsigned generation;

    device_start(&device);
    expect_filters((const struct slave_filter[]){ { 0, false, false },
                                                  { 0x605, false, false },
                                                  { 0x705, false, true },
                                                  { 0x80, false, false },
                                                  { 0x70A, false, false },
                                                  { 0x205, false, false },
                                                  { 0x12345, true, false },
                                                  { 0x185, false, true },
                                                  { 0 } });
    ck_assert_uint_eq(slave_listens(&device.slave, first, 1), 8);
    ck_assert_uint_eq(first[1].id, 9);
    ck_assert_uint_eq(slave_listens(&device.slave, NULL, 0), 8);
    generation = device.slave.listen_generation;
    ck_assert_uint_eq(device_write(&device, 0x1017, 0, 2, 100), SDO_NO_OBJECT);
    ck_assert_uint_eq(device_write(&device, 0x2100, 0, 2, 100), SDO_OK);
    ck_assert_uint_eq(device.slave.listen_generation, generation);
    ck_assert_uint_eq(device_write(&device, 0x1400, 1, 4, OFF), SDO_OK);
    ck_assert_uint_ne(device.slave.listen_generation, generation);
    ck_assert_uint_eq(slave_listens(&device.slave, NULL, 0), 8); /* RPDO 2 has it, too */
    ck_assert_uint_eq(device_write(&device, 0x1401, 1, 4, OFF), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x1802, 1, 4, OFF), SDO_OK); /* the last with SYNC */
    generation = device.slave.listen_generation;
    ck_assert_uint_eq(device_write(&device, 0x1016, 1, 4, 0), SDO_OK);
    ck_assert_uint_ne(device.slave.listen_generation, generation);
    expect_filters((const struct slave_filter[]){ { 0, false, false },
                                                  { 0x605, false, false },
                                                  { 0x705, false, true },
                                                  { 0x12345, true, false },
                                                  { 0x185, false, true },
                                                  { 0 } });
    generation = device.slave.listen_generation;
    device_hear(&device, "000#8205");
    ck_assert_uint_ne(device.slave.listen_generation, generation);
    ck_assert_uint_eq(slave_listens(&device.slave, NULL, 0), 8);
}
END_TEST

/* All 1024 PDOs, each with an identifier of 29 bits. */
START_TEST(as_many_as_there_can_be)
{
    struct device other;
    struct od od;

    od_init(&od);
    ck_assert_int_eq(od_add_number(&od, 0x2000, 0, OD_UNSIGNED16, OD_RW, 0x1234), CO_OK);
    for (uint16_t i = 0; i < 512; i++) {
        ck_assert_int_eq(od_add_number(&od, 0x1400 + i, 1, OD_UNSIGNED32, OD_RW, 0x21000000 + i),
                         0);
        ck_assert_int_eq(od_add_number(&od, 0x1600 + i, 0, OD_UNSIGNED8, OD_RW, 1), 0);
        ck_assert_int_eq(od_add_number(&od, 0x1600 + i, 1, OD_UNSIGNED32, OD_RW, 0x20000010), 0);
        ck_assert_int_eq(od_add_number(&od, 0x1800 + i, 1, OD_UNSIGNED32, OD_RW, 0x22000000 + i),
                         0);
        ck_assert_int_eq(od_add_number(&od, 0x1A00 + i, 0, OD_UNSIGNED8, OD_RW, 1), 0);
        ck_assert_int_eq(od_add_number(&od, 0x1A00 + i, 1, OD_UNSIGNED32, OD_RW, 0x20000010), 0);
    }
    device_init_od(&other, &od);
    device_start(&other);
    ck_assert_uint_eq(od_find(&other.od, 0x2000, 0)->map_count, 1024);
    ck_assert_uint_eq(slave_listens(&other.slave, NULL, 0), 3 + 1024);
    device_hear(&other, "000#0105");
    for (unsigned i = 0; i < 512; i++) {
        char text[32];

        snprintf(text, sizeof text, "010%05X#%02X00", i, i & 0xFF);
        device_hear(&other, text);
        ck_assert_uint_eq(od_number(&other.od, 0x2000, 0, 0), i & 0xFF);
        ck_assert_uint_eq(slave_rpdo(&other.slave, (uint16_t)(i + 1))->received, 1);
        ck_assert_int_eq(slave_pdo_send(&other.slave, (uint16_t)(i + 1), 0, &other.out), CO_OK);
        device_drain(&other);
        snprintf(text, sizeof text, "020%05X#%02X00", i, i & 0xFF);
        ck_assert_str_eq(device_next_frame(&other, NULL), i == 0 ? "705#00" : text);
        device_forget(&other);
    }
    device_done(&other);
}
END_TEST

/* Descriptions that make no sense: nothing mapped, too much, other kinds of PDOs. */
START_TEST(odd_descriptions)
{
    static const struct device_entry odd[] = {
        { 0x1400, 1, OD_UNSIGNED32, OD_RW, 0x205, false }, /* without mapping and type */
        { 0x1401, 1, OD_UNSIGNED32, OD_RW, 0x305, false },
        { 0x1601, 0, OD_UNSIGNED8, OD_RW, 255, false }, /* multiplexed */
        { 0x1601, 1, OD_UNSIGNED32, OD_RW, 0x20000040, false },
        { 0x1402, 1, OD_UNSIGNED32, OD_RW, 0x405, false },
        { 0x1602, 0, OD_UNSIGNED8, OD_RW, 4, false }, /* more than there is room for */
        { 0x1602, 1, OD_UNSIGNED32, OD_RW, 0x20000020, false },
        { 0x1602, 2, OD_UNSIGNED32, OD_RW, 0, false },
        { 0x1602, 3, OD_UNSIGNED32, OD_RW, 0x3FFF0020, false },
        { 0x1602, 4, OD_UNSIGNED32, OD_RW, 0x20000020, false },
        { 0x1403, 2, OD_UNSIGNED8, OD_RW, 255, false }, /* without COB-ID */
        { 0x1800, 1, OD_UNSIGNED32, OD_RW, 0x185, false },
        { 0x1A00, 0, OD_UNSIGNED8, OD_RW, 3, false }, /* more than there are */
        { 0x1A00, 1, OD_UNSIGNED32, OD_RW, 0x20000020, false },
        { 0x2000, 0, OD_UNSIGNED32, OD_RW, 0, true },
        { 0 },
    };
    struct device other;

    device_init(&other, odd);
    device_start(&other);
    device_hear(&other, "000#0105");
    ck_assert_uint_eq(slave_rpdo(&other.slave, 1)->map.count, 0);
    ck_assert_uint_eq(slave_rpdo(&other.slave, 2)->map.count, 0);
    ck_assert_uint_eq(slave_rpdo(&other.slave, 3)->map.count, 2);
    ck_assert_ptr_null(slave_rpdo(&other.slave, 4));
    ck_assert_uint_eq(slave_tpdo(&other.slave, 1)->map.count, 1);
    device_hear(&other, "205#1122334455667788");
    device_hear(&other, "305#1122334455667788");
    device_drain(&other);
    ck_assert_uint_eq(od_number(&other.od, 0x2000, 0, 0), 0);
    device_hear(&other, "405#1122334455667788");
    ck_assert_uint_eq(od_number(&other.od, 0x2000, 0, 0), 0x44332211);
    device_done(&other);
}
END_TEST

/* Devices in which PDOs are the least: the same memory for all of them. */
START_TEST(size_of_a_device)
{
    const struct slave_pdos *pdos = device.slave.pdos;
    const size_t table = 2048 * sizeof *pdos->first;
    const size_t each = sizeof(struct rpdo) > sizeof(struct tpdo) ? sizeof(struct rpdo)
                                                                  : sizeof(struct tpdo);

    /* with 8 PDOs of 8 fields each and the SDO server's buffer */
    ck_assert_uint_lt(sizeof device.slave + sizeof *pdos + table + 8 * each + 1024 +
                          64 * (sizeof(struct pdo_field) + sizeof(struct slave_mapped)),
                      16 * 1024);
}
END_TEST

static Suite *make_suite(void)
{
    Suite *suite = suite_create("slave_pdo");
    TCase *tcase = tcase_create("slave_pdo");

    tcase_add_checked_fixture(tcase, setup, teardown);
    suite_add_tcase(suite, tcase);
    tcase_add_loop_test(tcase, conversation, 0, TALKS * 2);
    tcase_add_test(tcase, by_number);
    tcase_add_test(tcase, what_was_received);
    tcase_add_test(tcase, count_of_mappings);
    tcase_add_test(tcase, what_is_sent_by_change);
    tcase_add_test(tcase, changed_by_the_application);
    tcase_add_test(tcase, full_outbox);
    tcase_add_test(tcase, sync_with_little_room);
    tcase_add_test(tcase, what_it_listens_to);
    tcase_add_test(tcase, as_many_as_there_can_be);
    tcase_add_test(tcase, odd_descriptions);
    tcase_add_test(tcase, size_of_a_device);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(make_suite());
    int failed;

    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
