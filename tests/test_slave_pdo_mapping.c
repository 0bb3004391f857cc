/* Mapping PDOs anew over SDO: each abort code of the procedure, and what the PDO does behind it. */
#include "slave/slave.h"

#include "support/device.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define OFF 0x80000000u

static const struct device_entry entries[] = {
    { 0x1005, 0, OD_UNSIGNED32, OD_RW, 0x80, false },
    { 0x1400, 1, OD_UNSIGNED32, OD_RW, 0x205, false },
    { 0x1400, 2, OD_UNSIGNED8, OD_RW, 255, false },
    { 0x1600, 0, OD_UNSIGNED8, OD_RW, 1, false },
    { 0x1600, 1, OD_UNSIGNED32, OD_RW, 0x20000008, false },
    { 0x1600, 2, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1600, 3, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1600, 4, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1401, 1, OD_UNSIGNED32, OD_RW, OFF, false },
    { 0x1601, 0, OD_UNSIGNED8, OD_RW, 0, false },
    { 0x1601, 1, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1402, 1, OD_UNSIGNED32, OD_RO, 0x405, false }, /* fixed: cannot be switched off ... */
    { 0x1602, 0, OD_UNSIGNED8, OD_CONST, 2, false },   /* ... and has always two */
    { 0x1602, 1, OD_UNSIGNED32, OD_RW, 0x20000008, false },
    { 0x1602, 2, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1800, 1, OD_UNSIGNED32, OD_RW, 0x185, false },
    { 0x1800, 2, OD_UNSIGNED8, OD_RW, 255, false },
    { 0x1A00, 0, OD_UNSIGNED8, OD_RW, 1, false },
    { 0x1A00, 1, OD_UNSIGNED32, OD_RW, 0x21000008, false },
    { 0x1A00, 2, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1801, 1, OD_UNSIGNED32, OD_RW, OFF, false },
    { 0x1A01, 0, OD_UNSIGNED8, OD_RW, 0, false },
    { 0x1A01, 1, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1A01, 2, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x2000, 0, OD_UNSIGNED8, OD_RWW, 0, true },
    { 0x2001, 0, OD_UNSIGNED32, OD_RWW, 0, true },
    { 0x2002, 0, OD_BOOLEAN, OD_RWW, 0, true },
    { 0x2003, 1, OD_INTEGER16, OD_WO, 0, true },
    { 0x2004, 0, OD_UNSIGNED8, OD_RW, 0, false },
    { 0x2005, 0, OD_UNSIGNED64, OD_RW, 0, true },
    { 0x2006, 0, OD_VISIBLE_STRING, OD_RW, 0, true },
    { 0x2100, 0, OD_UNSIGNED8, OD_RO, 0x11, true },
    { 0x2101, 0, OD_UNSIGNED16, OD_RWR, 0x2222, true },
    { 0x2102, 0, OD_UNSIGNED8, OD_CONST, 0x33, true },
    { 0 },
};

static struct device device;

static void setup(void)
{
    device_init(&device, entries);
    device_start(&device);
}

static void teardown(void)
{
    device_done(&device);
}

/* ---- one entry ---- */

static const struct {
    const char *what;
    uint32_t entry;
    sdo_abort_t received, sent;
} mapped[] = {
    { "rww", 0x20000008, SDO_OK, SDO_NOT_MAPPABLE },
    { "wo", 0x20030110, SDO_OK, SDO_NOT_MAPPABLE },
    { "ro", 0x21000008, SDO_NOT_MAPPABLE, SDO_OK },
    { "rwr", 0x21010010, SDO_NOT_MAPPABLE, SDO_OK },
    { "const", 0x21020008, SDO_NOT_MAPPABLE, SDO_OK },
    { "rw", 0x20050040, SDO_OK, SDO_OK },
    { "a bit", 0x20020001, SDO_OK, SDO_NOT_MAPPABLE },
    { "a BOOLEAN of a byte", 0x20020008, SDO_OK, SDO_NOT_MAPPABLE },
    { "a BOOLEAN of two bits", 0x20020002, SDO_NOT_MAPPABLE, SDO_NOT_MAPPABLE },
    { "PDOMapping=0", 0x20040008, SDO_NOT_MAPPABLE, SDO_NOT_MAPPABLE },
    { "a string", 0x20060020, SDO_NOT_MAPPABLE, SDO_NOT_MAPPABLE },
    { "half of it", 0x20010010, SDO_NOT_MAPPABLE, SDO_NOT_MAPPABLE },
    { "twice of it", 0x20000010, SDO_NOT_MAPPABLE, SDO_NOT_MAPPABLE },
    { "no bits", 0x20000000, SDO_NOT_MAPPABLE, SDO_NOT_MAPPABLE },
    { "no such object", 0x2FFF0008, SDO_NO_OBJECT, SDO_NO_OBJECT },
    { "no such sub-index", 0x20000108, SDO_NO_SUB, SDO_NO_SUB },
    { "the sub-index 0 that is not there", 0x20030010, SDO_NO_SUB, SDO_NO_SUB },
    { "a dummy", 0x00050008, SDO_OK, SDO_NOT_MAPPABLE },
    { "a dummy bit", 0x00010001, SDO_OK, SDO_NOT_MAPPABLE },
    { "a dummy of another length", 0x00050010, SDO_NOT_MAPPABLE, SDO_NOT_MAPPABLE },
    { "a dummy's sub-index", 0x00050108, SDO_NO_SUB, SDO_NO_SUB },
    { "a data type that is none", 0x00110008, SDO_NOT_MAPPABLE, SDO_NOT_MAPPABLE },
    { "object 0", 0x00000008, SDO_NO_OBJECT, SDO_NO_OBJECT },
};

START_TEST(one_entry)
{
    ck_assert_uint_eq(device_write(&device, 0x1400, 1, 4, OFF), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x1600, 0, 1, 0), SDO_OK);
    ck_assert_msg(device_write(&device, 0x1600, 1, 4, mapped[_i].entry) == mapped[_i].received,
                  "RPDO: %s", mapped[_i].what);
    ck_assert_msg(device_write(&device, 0x1A01, 1, 4, mapped[_i].entry) == mapped[_i].sent,
                  "TPDO: %s", mapped[_i].what);
    ck_assert_uint_eq(slave_check_mapped(&device.od, mapped[_i].entry, false), mapped[_i].received);
    ck_assert_uint_eq(slave_check_mapped(&device.od, mapped[_i].entry, true), mapped[_i].sent);
    if (mapped[_i].received != SDO_OK) /* what was there stays */
        ck_assert_uint_eq(device_value(&device, 0x1600, 1), 0x20000008);
}
END_TEST

/* ---- the procedure ---- */

struct step {
    uint16_t index;
    uint8_t sub, size;
    uint32_t value;
    sdo_abort_t code;
};

#define STEPS 16

/* clang-format off */
static const struct {
    const char *name;
    struct step steps[STEPS];
    const char *hears; /* when operational, behind it */
    uint32_t value;    /* of 2001h then */
} procedures[] = {
    { "as it should be",
      { { 0x1400, 1, 4, OFF | 0x205, SDO_OK }, { 0x1600, 0, 1, 0, SDO_OK },
        { 0x1600, 1, 4, 0x20010020, SDO_OK }, { 0x1600, 2, 4, 0x20030110, SDO_OK },
        { 0x1600, 0, 1, 2, SDO_OK }, { 0x1400, 1, 4, 0x205, SDO_OK } },
      "205#112233445566", 0x44332211 },
    { "entries while it is valid",
      { { 0x1600, 1, 4, 0x20010020, SDO_ACCESS }, { 0x1600, 0, 1, 0, SDO_ACCESS },
        { 0x1600, 0, 1, 1, SDO_ACCESS }, { 0x1600, 2, 4, 0, SDO_ACCESS } },
      "205#11", 0 },
    { "entries while they are counted",
      { { 0x1400, 1, 4, OFF | 0x205, SDO_OK }, { 0x1600, 1, 4, 0x20010020, SDO_ACCESS },
        { 0x1600, 2, 4, 0x20010020, SDO_ACCESS } }, "205#11", 0 },
    { "more than there are entries",
      { { 0x1400, 1, 4, OFF | 0x205, SDO_OK }, { 0x1600, 0, 1, 5, SDO_PDO_LENGTH },
        { 0x1600, 0, 1, 0, SDO_OK }, { 0x1600, 5, 4, 0x20000008, SDO_NO_SUB },
        { 0x1600, 0, 1, 5, SDO_PDO_LENGTH }, { 0x1600, 0, 1, 64, SDO_PDO_LENGTH },
        { 0x1600, 0, 1, 65, SDO_PDO_LENGTH }, { 0x1600, 0, 1, 0xFD, SDO_PDO_LENGTH },
        { 0x1600, 0, 1, 0xFE, SDO_PDO_LENGTH }, { 0x1600, 0, 1, 0xFF, SDO_PDO_LENGTH } },
      "205#1122334455667788", 0 },
    { "more than 64 bits",
      { { 0x1400, 1, 4, OFF | 0x205, SDO_OK }, { 0x1600, 0, 1, 0, SDO_OK },
        { 0x1600, 1, 4, 0x20010020, SDO_OK }, { 0x1600, 2, 4, 0x20010020, SDO_OK },
        { 0x1600, 3, 4, 0x20020001, SDO_OK }, { 0x1600, 0, 1, 3, SDO_PDO_LENGTH },
        { 0x1600, 0, 1, 2, SDO_OK }, { 0x1400, 1, 4, 0x205, SDO_OK } },
      "205#1122334455667788", 0x88776655 },
    { "an empty entry that counts",
      { { 0x1400, 1, 4, OFF | 0x205, SDO_OK }, { 0x1600, 0, 1, 0, SDO_OK },
        { 0x1600, 1, 4, 0x20010020, SDO_OK }, { 0x1600, 2, 4, 0, SDO_OK },
        { 0x1600, 0, 1, 2, SDO_NO_OBJECT }, { 0x1600, 0, 1, 1, SDO_OK },
        { 0x1400, 1, 4, 0x205, SDO_OK } }, "205#11223344", 0x44332211 },
    { "less of the same",
      { { 0x1400, 1, 4, OFF | 0x205, SDO_OK }, { 0x1600, 0, 1, 0, SDO_OK },
        { 0x1600, 1, 4, 0x00070020, SDO_OK }, { 0x1600, 2, 4, 0x20010020, SDO_OK },
        { 0x1600, 0, 1, 2, SDO_OK }, { 0x1600, 0, 1, 1, SDO_OK }, { 0x1600, 0, 1, 2, SDO_OK },
        { 0x1400, 1, 4, 0x205, SDO_OK } }, "205#0000000011223344", 0x44332211 },
    { "nothing at all",
      { { 0x1400, 1, 4, OFF | 0x205, SDO_OK }, { 0x1600, 0, 1, 0, SDO_OK },
        { 0x1400, 1, 4, 0x205, SDO_OK } }, "205#11223344", 0 },
    { "fixed: in place, while it is valid",
      { { 0x1402, 1, 4, OFF, SDO_READ_ONLY }, { 0x1602, 0, 1, 0, SDO_READ_ONLY },
        { 0x1602, 1, 4, 0x21000008, SDO_NOT_MAPPABLE }, { 0x1602, 1, 4, 0x00070120, SDO_NO_SUB },
        { 0x1602, 1, 4, 0x20000008, SDO_OK }, { 0x1602, 2, 4, 0x20010020, SDO_OK } },
      "405#9911223344", 0x44332211 },
    { "bits, and what is left of a byte",
      { { 0x1400, 1, 4, OFF | 0x205, SDO_OK }, { 0x1600, 0, 1, 0, SDO_OK },
        { 0x1600, 1, 4, 0x20020001, SDO_OK }, { 0x1600, 2, 4, 0x20010020, SDO_OK },
        { 0x1600, 0, 1, 2, SDO_OK }, { 0x1400, 1, 4, 0x205, SDO_OK } },
      "205#03000000FE", 0x00000001 },
};
/* clang-format on */

START_TEST(procedure)
{
    const struct step *step = procedures[_i].steps;

    for (; step < procedures[_i].steps + STEPS && step->index != 0; step++) {
        const sdo_abort_t code = device_write(&device, step->index, step->sub, step->size,
                                              step->value);

        ck_assert_msg(code == step->code, "%s: %04X:%02X = %X: %08X, expected %08X",
                      procedures[_i].name, step->index, step->sub, step->value, code, step->code);
    }
    device_hear(&device, "000#0105");
    device_hear(&device, procedures[_i].hears);
    ck_assert_msg(od_number(&device.od, 0x2001, 0, 0) == procedures[_i].value, "%s",
                  procedures[_i].name);
}
END_TEST

/* ---- objects that may be in so many PDOs ---- */

START_TEST(used_up)
{
    od_find(&device.od, 0x2000, 0)->map_max = 2; /* as many as it is in already */
    od_find(&device.od, 0x2001, 0)->map_max = 1;
    ck_assert_uint_eq(device_write(&device, 0x1601, 1, 4, 0x20000008), SDO_NOT_MAPPABLE);
    ck_assert_uint_eq(device_write(&device, 0x1400, 1, 4, OFF | 0x205), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x1600, 0, 1, 0), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x1601, 1, 4, 0x20000008), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x1601, 0, 1, 1), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x1600, 0, 1, 1), SDO_NOT_MAPPABLE);
    ck_assert_uint_eq(device_value(&device, 0x1600, 0), 0);
    ck_assert_uint_eq(device_write(&device, 0x1600, 1, 4, 0x20000008), SDO_NOT_MAPPABLE);
    ck_assert_uint_eq(slave_check_mapped(&device.od, 0x20000008, false), SDO_OK);
    /* Twice in one PDO counts once, and its own PDO is no other. */
    ck_assert_uint_eq(device_write(&device, 0x1600, 1, 4, 0x20010020), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x1600, 2, 4, 0x20010020), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x1600, 0, 1, 2), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x1600, 0, 1, 1), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x1600, 0, 1, 2), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x1602, 2, 4, 0x20010020), SDO_NOT_MAPPABLE);
    ck_assert_uint_eq(device_write(&device, 0x1602, 1, 4, 0x20000008), SDO_OK);
}
END_TEST

/* ---- what is sent ---- */

START_TEST(sent_with_another_mapping)
{
    static const struct step steps[] = {
        { 0x1800, 1, 4, OFF | 0x185, SDO_OK }, { 0x1A00, 0, 1, 0, SDO_OK },
        { 0x1A00, 1, 4, 0x21010010, SDO_OK },  { 0x1A00, 2, 4, 0x21000008, SDO_OK },
        { 0x1A00, 0, 1, 2, SDO_OK },           { 0x1800, 1, 4, 0x185, SDO_OK }
    };

    device_hear(&device, "000#0105");
    device_do(&device, "send 1");
    device_drain(&device);
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) /* also when operational */
        ck_assert_uint_eq(
            device_write(&device, steps[i].index, steps[i].sub, steps[i].size, steps[i].value),
            steps[i].code);
    device_forget(&device);
    device_do(&device, "send 1");
    device_do(&device, "flags t1 1");
    device_do(&device, "set 2101:00 4444");
    device_drain(&device);
    ck_assert_str_eq(device_next_frame(&device, NULL), "185#222211");
    ck_assert_str_eq(device_next_frame(&device, NULL), "185#444411");
    ck_assert_uint_eq(device_write(&device, 0x1800, 1, 4, OFF | 0x185), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x1A00, 0, 1, 0), SDO_OK);
    device_do(&device, "send 1 -> -1");
    ck_assert_uint_eq(device_write(&device, 0x1800, 1, 4, 0x185), SDO_OK);
    device_do(&device, "send 1 -> -1"); /* valid, but empty */
}
END_TEST

/* The application asks anew for what was received for another mapping. */
START_TEST(generation)
{
    const struct rpdo *rpdo = slave_rpdo(&device.slave, 1);
    uint32_t before = rpdo->generation;

    ck_assert_uint_eq(device_write(&device, 0x1400, 1, 4, OFF | 0x205), SDO_OK);
    ck_assert_uint_eq(rpdo->generation, before);
    ck_assert_uint_eq(device_write(&device, 0x1600, 0, 1, 0), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x1600, 1, 4, 0x20010020), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x1600, 0, 1, 1), SDO_OK);
    ck_assert_uint_ne(rpdo->generation, before);
    before = rpdo->generation;
    device_hear(&device, "000#8205");
    ck_assert_uint_ne(rpdo->generation, before);
    ck_assert_uint_eq(rpdo->map.bits, 8);
}
END_TEST

static Suite *make_suite(void)
{
    Suite *suite = suite_create("slave_pdo_mapping");
    TCase *tcase = tcase_create("slave_pdo_mapping");

    tcase_add_checked_fixture(tcase, setup, teardown);
    suite_add_tcase(suite, tcase);
    tcase_add_loop_test(tcase, one_entry, 0, (int)(sizeof mapped / sizeof mapped[0]));
    tcase_add_loop_test(tcase, procedure, 0, (int)(sizeof procedures / sizeof procedures[0]));
    tcase_add_test(tcase, used_up);
    tcase_add_test(tcase, sent_with_another_mapping);
    tcase_add_test(tcase, generation);
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
