/*
 * The error state of a local device: what the application and the device itself have to say, how
 * they go together, emergencies that have to wait, and those of others (1028h).
 */
#include "slave/slave.h"

#include "support/device.h"
#include "support/suite.h"

#include <check.h>

static const struct device_entry entries[] = {
    { 0x1001, 0, OD_UNSIGNED8, OD_RO, 0, true },
    { 0x1003, 0, OD_UNSIGNED8, OD_RW, 0, false },
    { 0x1003, 1, OD_UNSIGNED32, OD_RO, 0, false },
    { 0x1014, 0, OD_UNSIGNED32, OD_RW, 0x85, false },
    { 0x1015, 0, OD_UNSIGNED16, OD_RW, 0, false },
    { 0x1016, 0, OD_UNSIGNED8, OD_CONST, 1, false },
    { 0x1016, 1, OD_UNSIGNED32, OD_RW, 0x00070064, false },
    { 0x1028, 0, OD_UNSIGNED8, OD_CONST, 10, false },
    { 0x1028, 2, OD_UNSIGNED32, OD_RW, 0x80000000, false },
    { 0x1028, 7, OD_UNSIGNED32, OD_RW, 0x80000000, false },
    { 0x1028, 10, OD_UNSIGNED32, OD_RW, 0x2001ABCD, false },
    { 0x1029, 0, OD_UNSIGNED8, OD_CONST, 1, false },
    { 0x1029, 1, OD_UNSIGNED8, OD_RW, 1, false },
    { 0x1800, 1, OD_UNSIGNED32, OD_RW, 0x40000185, false },
    { 0x1800, 2, OD_UNSIGNED8, OD_RW, 255, false },
    { 0x1A00, 0, OD_UNSIGNED8, OD_RW, 1, false },
    { 0x1A00, 1, OD_UNSIGNED32, OD_RW, 0x10010008, false },
    { 0 },
};

static struct device device;

static void setup(void)
{
    device_init(&device, entries);
    device_start(&device);
    device_forget(&device);
}

static void teardown(void)
{
    device_done(&device);
}

#define LOSE_7                                                                                     \
    { 10, HEARS, "707#05" },                                                                       \
    {                                                                                              \
        110, SENDS, "085#3081110100000000"                                                         \
    }

/* clang-format off */
static const struct device_talk talks[] = {
    { "an error of the application, and its end",
      { { 1, DOES, "raise 2310 1234 02 0102" }, { 1, SENDS, "085#1023030102030405" },
        { 1, TELLS, "emcy 2310 03" },
        { 2, HEARS, "605#4003100100000000" }, { 2, SENDS, "585#4303100110233412" },
        { 3, DOES, "clear 02 0708" }, { 3, SENDS, "085#0000000708000000" },
        { 3, TELLS, "emcy 0000 00" },
        { 4, HEARS, "605#4003100000000000" }, { 4, SENDS, "585#4F03100001000000" },
        { 5, DOES, "clear 02 0000 -> -13" } } },
    { "each is counted; with the last one all bits have gone",
      { { 1, DOES, "raise 2310 0 02 0000" }, { 1, SENDS, "085#1023030000030405" },
        { 2, DOES, "raise 4200 0 08 0000" }, { 2, SENDS, "085#00420B0000030405" },
        { 3, DOES, "raise 4200 0 08 0000" }, { 3, SENDS, "085#00420B0000030405" },
        { 4, DOES, "clear 08 0000" }, { 4, SENDS, "085#0000030000000000" },
        { 5, DOES, "clear 00 0000" }, { 5, SENDS, "085#0000030000000000" },
        { 6, DOES, "clear 00 0000" }, { 6, SENDS, "085#0000000000000000" } } },
    { "an error without a bit of its own is a generic one",
      { { 1, DOES, "raise 1000 0 00 0000" }, { 1, SENDS, "085#0010010000030405" },
        { 2, DOES, "raise 1000 0 80 0000" }, { 2, SENDS, "085#0010810000030405" },
        { 3, DOES, "clear 81 0000" }, { 3, SENDS, "085#0000010000000000" } } },
    { "errors of both; the application cannot end those of the device",
      { LOSE_7, { 120, DOES, "raise 2310 0 12 0000" }, { 120, SENDS, "085#1023130000030405" },
        { 130, DOES, "clear 12 0000" }, { 130, SENDS, "085#0000110000000000" },
        { 131, DOES, "clear 12 0000 -> -13" },
        { 140, HEARS, "707#05" }, { 140, SENDS, "085#0000000000000000" } } },
    { "the application's bits are in what the device says",
      { { 1, DOES, "raise FF00 0 00 3F5F" }, { 1, SENDS, "085#00FF013F5F030405" },
        { 2, DOES, "raise FF00 0 00 8080" }, { 2, SENDS, "085#00FF018080030405" },
        { 10, HEARS, "707#05" }, { 110, SENDS, "085#308111A1C0000000" },
        { 120, HEARS, "707#05" }, { 120, SENDS, "085#000001A0C0000000" },
        { 121, DOES, "clear 00 8020" }, { 121, SENDS, "085#0000018020000000" },
        { 220, SENDS, "085#30811181E0000000" },
        { 221, DOES, "clear 00 A000" }, { 221, SENDS, "085#000011A000000000" },
        { 230, HEARS, "707#05" }, { 230, SENDS, "085#00000000E0000000" } } },
    { "a mapped error register is sent when it changes",
      { { 0, DOES, "flags t1 1" }, { 0, HEARS, "000#0105" }, { 0, SENDS, "185#00" },
        { 1, DOES, "raise 2310 0 02 0000" }, { 1, SENDS, "185#03" },
        { 1, SENDS, "085#1023030000030405" },
        { 2, DOES, "raise 2320 0 02 0000" }, { 2, SENDS, "085#2023030000030405" },
        { 3, DOES, "bus lost" }, { 3, SENDS, "185#13" },
        { 4, DOES, "clear 02 0000" }, { 4, SENDS, "185#11" },
        { 5, DOES, "clear 00 0000" },
        { 6, DOES, "bus ok" }, { 6, SENDS, "185#00" },
        { 6, SENDS, "085#0000110000000000" }, { 6, SENDS, "085#0000110000000000" },
        { 6, SENDS, "085#4081110401000000" }, { 6, SENDS, "085#0000000001000000" } } },
    { "a reset forgets what has been",
      { { 1, DOES, "raise FF00 0 80 A0A0" }, { 1, SENDS, "085#00FF81A0A0030405" },
        { 2, HEARS, "000#8205" }, { 2, SENDS, "705#00" },
        { 3, DOES, "clear 80 0000 -> -13" }, LOSE_7 } },
    { "in the inhibit time and in stopped it waits",
      { { 0, HEARS, "605#2B151000E8030000" }, { 0, SENDS, "585#6015100000000000" },
        { 1, DOES, "raise 1000 0 00 0000" }, { 1, SENDS, "085#0010010000030405" },
        { 2, DOES, "clear 00 0000" }, { 2, HEARS, "000#0205" }, { 500, QUIET, "-" },
        { 500, DOES, "raise 2000 0 00 0000" },
        { 600, HEARS, "000#8005" }, { 600, SENDS, "085#0000000000000000" },
        { 699, QUIET, "-" }, { 700, SENDS, "085#0020010000030405" } } },
    { "PDOs that the application does not take",
      { { 1, DOES, "lose 3" }, { 1, SENDS, "085#0081110002010300" }, { 1, TELLS, "emcy 8100 11" },
        { 2, DOES, "lose 1000" }, { 2, SENDS, "085#008111000201FF00" },
        { 3, DOES, "taken" }, { 3, SENDS, "085#0000000002000000" },
        { 4, DOES, "taken" }, { 4, QUIET, "-" },
        { 5, DOES, "lose 1" }, { 5, SENDS, "085#0081110002010100" } } },
    { "emergencies of others: the pre-defined node-ID, else the sub-index",
      { { 0, HEARS, "605#2328100207000000" }, { 0, SENDS, "585#8028100230000906" },
        { 0, HEARS, "605#2328100286000000" }, { 0, SENDS, "585#6028100200000000" },
        { 0, HEARS, "605#2328100701060000" }, { 0, SENDS, "585#8028100730000906" },
        { 0, HEARS, "605#2328100799010000" }, { 0, SENDS, "585#6028100700000000" },
        { 0, TELLS, "written 1028:02 = 134" }, { 0, TELLS, "written 1028:07 = 409" },
        { 1, HEARS, "086#3081110102030405" }, { 2, HEARS, "199#0010010102030405" },
        { 3, HEARS, "0001ABCD#0020020102030405" },
        { 3, TELLS, "1028:02 hears 86, node 6: 3081110102030405" },
        { 3, TELLS, "1028:07 hears 199, node 7: 0010010102030405" },
        { 3, TELLS, "1028:0A hears 2001ABCD, node 10: 0020020102030405" },
        { 4, HEARS, "087#3081110102030405" }, { 4, HEARS, "086#30811101020304" },
        { 4, HEARS, "086#R8" }, { 4, HEARS, "00000086#3081110102030405" },
        { 4, ECHOES, "086#3081110102030405" }, { 4, TELLS, "" } } },
    { "an entry of 1028h changes only by way of invalid",
      { { 0, HEARS, "605#2328100286000000" }, { 0, SENDS, "585#6028100200000000" },
        { 0, HEARS, "605#2328100288000000" }, { 0, SENDS, "585#8028100230000906" },
        { 1, HEARS, "605#2328100286000080" }, { 1, SENDS, "585#6028100200000000" },
        { 2, HEARS, "086#3081110102030405" },
        { 2, TELLS, "written 1028:02 = 134" }, { 2, TELLS, "written 1028:02 = 2147483782" },
        { 2, TELLS, "" } } },
    { "not in stopped, nor after a reset",
      { { 0, HEARS, "605#2328100286000000" }, { 0, SENDS, "585#6028100200000000" },
        { 0, HEARS, "000#0205" }, { 1, HEARS, "086#3081110102030405" },
        { 2, HEARS, "000#8205" }, { 2, SENDS, "705#00" }, { 3, HEARS, "086#3081110102030405" },
        { 3, TELLS, "written 1028:02 = 134" }, { 3, TELLS, "state 4" }, { 3, TELLS, "state 0" },
        { 3, TELLS, "state 127" }, { 3, TELLS, "" } } },
    { "a changed entry of 1016h, a reset and a boot-up end the watch",
      { { 1, HEARS, "707#05" }, { 1, TELLS, "watch 7 begins" }, { 1, TELLS, "heard 7: 5" },
        { 2, HEARS, "605#2316100164000800" }, { 2, SENDS, "585#6016100100000000" },
        { 2, TELLS, "written 1016:01 = 524388" }, { 2, TELLS, "watch 7 ends" },
        { 3, HEARS, "708#00" }, { 3, TELLS, "watch 8 boots" },
        { 4, HEARS, "708#7F" }, { 4, TELLS, "watch 8 begins" }, { 4, TELLS, "heard 8: 127" },
        { 5, HEARS, "708#00" }, { 5, TELLS, "watch 8 boots" }, { 5, TELLS, "heard 8: 0" },
        { 6, HEARS, "708#7F" }, { 6, TELLS, "watch 8 begins" }, { 6, TELLS, "heard 8: 127" },
        { 7, HEARS, "000#8205" }, { 7, SENDS, "705#00" }, { 7, TELLS, "watch 8 ends" },
        { 7, TELLS, "state 0" }, { 7, TELLS, "state 127" },
        { 8, HEARS, "707#00" }, { 8, TELLS, "watch 7 boots" }, { 8, TELLS, "" } } },
};
/* clang-format on */

START_TEST(conversation)
{
    device_talk(&device, &talks[_i]);
}
END_TEST

static void raise_many(unsigned count)
{
    for (unsigned i = 0; i < count; i++)
        device_do(&device, "raise 1000 0 00 0000");
}

/* The first loss is told at once, the others when there is room again. */
START_TEST(losses_are_told)
{
    device_hear(&device, "000#0205");
    for (unsigned i = 0; i < EMCY_QUEUE_MAX + 5; i++) {
        raise_many(1);
        device_drain(&device);
        device_run(&device, device.now + CO_MS(1));
        if (i == EMCY_QUEUE_MAX)
            while (device.events[device.event_taken].type != SLAVE_EMCY_LOST)
                device_next_event(&device);
    }
    ck_assert_str_eq(device_next_event(&device), "emcy lost 1");
    for (unsigned i = 0; i < 4; i++)
        ck_assert_str_eq(device_next_event(&device), "emcy 1000 01");
    ck_assert_str_eq(device_next_event(&device), "");
    device_hear(&device, "000#8005");
    device_run(&device, device.now);
    for (unsigned i = 0; i < EMCY_QUEUE_MAX; i++)
        ck_assert_str_eq(device_next_frame(&device, NULL), "085#0010010000030405");
    ck_assert_str_eq(device_next_frame(&device, NULL), "");
    ck_assert_str_eq(device_next_event(&device), "state 127");
    ck_assert_str_eq(device_next_event(&device), "emcy lost 4");
    ck_assert_str_eq(device_next_event(&device), "");
    ck_assert_uint_eq(slave_deadline(&device.slave), CO_NEVER);
}
END_TEST

START_TEST(full_outbox_loss)
{
    device_hear(&device, "000#0205");
    raise_many(1);
    for (unsigned i = 0; i < EMCY_QUEUE_MAX; i++) {
        device_fill(&device, 8, 1); /* for the event of the emergency */
        raise_many(1);
        if (i + 1 < EMCY_QUEUE_MAX)
            device_drain(&device);
    }
    ck_assert_uint_eq(slave_deadline(&device.slave), 0);
    device_drain(&device);
    device_forget(&device);
    device_run(&device, 1);
    ck_assert_str_eq(device_next_event(&device), "emcy lost 1");
}
END_TEST

/* What the PDO with 1001h has to tell, from before, comes behind. */
START_TEST(full_outbox_mapped)
{
    const struct slave_error error = { .code = 0x1000, .error_register = 1 };

    device_do(&device, "flags t1 1");
    device_hear(&device, "000#0105");
    device_drain(&device);
    device_forget(&device);
    slave_tpdo(&device.slave, 1)->confirms = 1;
    device_fill(&device, 8, 1);
    ck_assert_int_eq(slave_raise_error(&device.slave, &error, device.now, &device.out), CO_OK);
    device_drain(&device);
    ck_assert_str_eq(device_next_event(&device), "emcy 1000 01");
    device_run(&device, 1);
    ck_assert_uint_eq(slave_tpdo(&device.slave, 1)->confirms, 0);
}
END_TEST

START_TEST(full_outbox_heard)
{
    device_fill(&device, 8, 0);
    device_hear(&device, "0001ABCD#0020020102030405");
    device_drain(&device);
    ck_assert_uint_eq(device.slave.heard_dropped, 1);
    ck_assert_int_eq(slave_lose_pdos(&device.slave, 1, 0, &device.out), CO_OK);
    device_fill(&device, 8, 0);
    ck_assert_int_eq(slave_lose_pdos(&device.slave, 1, 0, &device.out), CO_ERR_AGAIN);
    ck_assert_int_eq(slave_pdos_taken(&device.slave, 0, &device.out), CO_ERR_AGAIN);
    device_drain(&device);
    ck_assert_str_eq(device_next_frame(&device, NULL), "085#0081110002010100");
    ck_assert_str_eq(device_next_frame(&device, NULL), "");
}
END_TEST

/* A boot-up that was not told in time is not told of another node. */
START_TEST(full_outbox_boot_up_of_a_node)
{
    device_fill(&device, 8, 0);
    device_hear(&device, "707#00");
    ck_assert_uint_eq(slave_deadline(&device.slave), 0);
    device_drain(&device);
    ck_assert_uint_eq(device_write(&device, 0x1016, 1, 4, 0x00080064), SDO_OK);
    device_run(&device, 1);
    ck_assert_str_eq(device_next_event(&device), "written 1016:01 = 524388");
    ck_assert_str_eq(device_next_event(&device), "");
}
END_TEST

START_TEST(what_is_listened_to)
{
    static const uint32_t ids[] = { 0x000, 0x605, 0x705, 0x707, 0x0001ABCD, 0x086 };
    struct slave_filter filters[8];
    const unsigned before = device.slave.listen_generation;

    ck_assert_uint_eq(device_write(&device, 0x1028, 2, 4, 0x86), SDO_OK);
    ck_assert_uint_ne(device.slave.listen_generation, before);
    ck_assert_uint_eq(slave_listens(&device.slave, filters, 8), 6);
    ck_assert_uint_eq(filters[4].id, 0x86);
    ck_assert_uint_eq(filters[5].id, 0x1ABCD);
    ck_assert(filters[5].ext && !filters[4].ext && !filters[4].rtr);
    for (unsigned i = 0; i < 4; i++)
        ck_assert_uint_eq(filters[i].id, ids[i]);
}
END_TEST

/* ---- anything, in any order ---- */

static uint32_t random_state = 1;

static unsigned random_below(unsigned limit)
{
    random_state = random_state * 1664525u + 1013904223u;
    return (random_state >> 8) % limit;
}

static void do_anything(void)
{
    static const char *const calls[] = { "raise 2310 0 02 2040",
                                         "raise 1000 0 00 0000",
                                         "clear 02 2000",
                                         "bus ok",
                                         "bus passive",
                                         "bus lost",
                                         "overrun",
                                         "lose 1",
                                         "taken",
                                         "bus ok" };
    static const char *const frames[] = { "707#05",   "707#00",   "000#0105",
                                          "000#0205", "000#8005", "605#2F29100102000000" };
    const bool application = device.slave.errors.application > 0;
    const unsigned call = random_below(10);

    if (random_below(3) == 0)
        device_hear(&device, frames[random_below(6)]);
    else if (call != 2 || application)
        device_do(&device, calls[call]);
    device_drain(&device);
    if (random_below(4) == 0)
        device_fill(&device, random_below(3), 2 + random_below(3));
}

/* Ends all that can be an error. */
static void end_all(void)
{
    device_drain(&device);
    device_hear(&device, "000#8005");
    device_drain(&device);
    device_do(&device, "bus ok");
    device_do(&device, "taken");
    device_drain(&device);
    device_hear(&device, "605#2316100100000000");
    device_run(&device, device.now + CO_MS(2000));
    while (device.slave.errors.application > 0) {
        device_do(&device, "clear 02 0000");
        device_drain(&device);
        device_forget(&device);
    }
}

/* Whatever has been, who listens knows how it is in the end. */
START_TEST(all_errors_end)
{
    const struct slave_errors *errors = &device.slave.errors;
    unsigned with_errors = 0;

    random_state = (uint32_t)_i + 1;
    for (unsigned i = 0; i < 3000; i++) {
        do_anything();
        device_run(&device, device.now + (random_below(2) ? random_below(150000) : 0));
        device_forget(&device);
        with_errors += od_number(&device.od, 0x1001, 0, 0) != 0;
        ck_assert_uint_eq(od_number(&device.od, 0x1001, 0, 0) & 1,
                          errors->application + errors->lost + errors->faults > 0 ||
                              errors->told_bus != SLAVE_BUS_OK);
    }
    ck_assert_uint_gt(with_errors, 1000);
    device_do(&device, "raise 2310 0 02 0000");
    end_all();
    ck_assert_uint_eq(errors->lost + errors->faults, 0);
    ck_assert_uint_eq(device_value(&device, 0x1001, 0), 0);
    device_forget(&device);
    device_do(&device, "raise 1000 0 00 0000");
    device_drain(&device);
    ck_assert_str_eq(device_next_frame(&device, NULL), "085#0010010000030405");
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("slave_emcy");

    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_loop_test(tcase, conversation, 0, (int)(sizeof talks / sizeof talks[0]));
    tcase_add_test(tcase, losses_are_told);
    tcase_add_test(tcase, full_outbox_loss);
    tcase_add_test(tcase, full_outbox_mapped);
    tcase_add_test(tcase, full_outbox_heard);
    tcase_add_test(tcase, full_outbox_boot_up_of_a_node);
    tcase_add_test(tcase, what_is_listened_to);
    tcase_add_loop_test(tcase, all_errors_end, 0, 8);
    return suite_run("slave_emcy", tcase);
}
