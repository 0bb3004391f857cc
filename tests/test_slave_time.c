/* 1012h of a local device: TIME that it hears and sends, by state and by what a client writes. */
#include "slave/slave.h"

#include "support/device.h"
#include "support/suite.h"

#include <check.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static const struct device_entry entries[] = {
    { 0x1012, 0, OD_UNSIGNED32, OD_RW, 0xC0000100, false },
    { 0 },
};

static const struct device_entry none[] = { { 0x2000, 0, OD_UNSIGNED8, OD_RW, 0, false }, { 0 } };

/* clang-format off */
#define BOOT { 0, SENDS, "705#00" }, { 0, TELLS, "state 0" }, { 0, TELLS, "state 127" }
#define TIME "010000000200"

static const struct device_talk talks[] = {
    { "in pre-operational and operational, not in stopped",
      { BOOT, { 1, HEARS, "100#" TIME }, { 1, TELLS, "time 1 2" },
        { 2, DOES, "time 1 2" }, { 2, SENDS, "100#" TIME },
        { 3, HEARS, "000#0105" }, { 3, TELLS, "state 5" },
        { 4, HEARS, "100#FF5B2605983A" }, { 4, TELLS, "time 86399999 15000" },
        { 5, DOES, "time 86399999 15000" }, { 5, SENDS, "100#FF5B2605983A" },
        { 6, HEARS, "000#0205" }, { 6, TELLS, "state 4" },
        { 7, HEARS, "100#" TIME }, { 8, TELLS, "" },
        { 9, HEARS, "000#8005" }, { 9, TELLS, "state 127" },
        { 10, HEARS, "100#" TIME }, { 10, TELLS, "time 1 2" } } },
    { "its own is none",
      { BOOT, { 1, DOES, "time 1 2" }, { 1, SENDS, "100#" TIME }, { 1, ECHOES, "100#" TIME },
        { 2, TELLS, "" } } },
    { "the client changes the identifier, and who takes part",
      { BOOT, { 1, HEARS, "605#2312100000010000" }, { 1, SENDS, "585#6012100000000000" },
        { 1, TELLS, "written 1012:00 = 256" }, { 2, HEARS, "100#" TIME }, { 2, TELLS, "" },
        { 3, HEARS, "605#2312100081010080" }, { 3, SENDS, "585#6012100000000000" },
        { 3, TELLS, "written 1012:00 = 2147484033" },
        { 4, HEARS, "100#" TIME }, { 4, TELLS, "" },
        { 5, HEARS, "181#" TIME }, { 5, TELLS, "time 1 2" },
        { 6, HEARS, "605#2312100081010040" }, { 6, SENDS, "585#6012100000000000" },
        { 6, TELLS, "written 1012:00 = 1073742209" }, { 7, HEARS, "181#" TIME }, { 7, TELLS, "" },
        { 8, DOES, "time 1 2" }, { 8, SENDS, "181#" TIME },
        { 9, HEARS, "000#8205" }, { 9, SENDS, "705#00" }, { 9, TELLS, "state 0" },
        { 9, TELLS, "state 127" }, { 10, HEARS, "181#" TIME }, { 10, TELLS, "" },
        { 11, HEARS, "100#" TIME }, { 11, TELLS, "time 1 2" } } },
    { "of a wrong length, or asked for",
      { BOOT, { 1, HEARS, "100#0100000002" }, { 1, HEARS, "100#R6" },
        { 1, HEARS, "100#0100000002000000" }, { 2, TELLS, "" } } },
};
/* clang-format on */

START_TEST(conversation)
{
    struct device device;

    device_init(&device, entries);
    device_start(&device);
    device_talk(&device, &talks[_i]);
    device_done(&device);
}
END_TEST

static const struct {
    const char *command;
    enum co_err err;
} states[] = { { "000#0105", CO_OK }, { "000#8005", CO_OK }, { "000#0205", CO_ERR_STATE } };

START_TEST(orders_by_state)
{
    const struct time_of_day time = { 1, 2 };
    struct device device;

    device_init(&device, entries);
    ck_assert_int_eq(slave_send_time(&device.slave, &time, &device.out), CO_ERR_STATE);
    device_start(&device);
    device_hear(&device, states[_i].command);
    ck_assert_int_eq(slave_send_time(&device.slave, &time, &device.out), states[_i].err);
    device_done(&device);
}
END_TEST

START_TEST(without_the_object)
{
    const struct time_of_day time = { 1, 2 };
    struct device device;

    device_init(&device, none);
    device_start(&device);
    device_forget(&device);
    device_hear(&device, "100#010000000200");
    device_hear(&device, "000#");
    device_drain(&device);
    ck_assert_str_eq(device_next_event(&device), "");
    ck_assert_int_eq(slave_send_time(&device.slave, &time, &device.out), CO_ERR_ARG);
    device_done(&device);
}
END_TEST

static bool listens(const struct device *device, uint32_t id)
{
    struct slave_filter filters[32];
    const unsigned count = slave_listens(&device->slave, filters, COUNT(filters));

    for (unsigned i = 0; i < count; i++)
        if (filters[i].id == id && !filters[i].ext && !filters[i].rtr)
            return true;
    return false;
}

/* The bus lets TIME through to who consumes it, and to nobody else. */
START_TEST(what_it_listens_to)
{
    struct device device;
    unsigned generation;

    device_init(&device, entries);
    device_start(&device);
    ck_assert(listens(&device, 0x100));
    generation = device.slave.listen_generation;
    ck_assert_uint_eq(device_write(&device, 0x1012, 0, 4, 0x100), SDO_OK);
    ck_assert_uint_ne(device.slave.listen_generation, generation);
    ck_assert(!listens(&device, 0x100));
    ck_assert_uint_eq(device_write(&device, 0x1012, 0, 4, 0x40000100), SDO_OK);
    ck_assert(!listens(&device, 0x100));
    device_done(&device);
}
END_TEST

/* What finds no room is an old time soon: it is not kept. */
START_TEST(no_room)
{
    struct device device;

    device_init(&device, entries);
    device_start(&device);
    device_forget(&device);
    device_fill(&device, 0, 0);
    device_hear(&device, "100#010000000200");
    device_drain(&device);
    device_run(&device, CO_MS(10));
    ck_assert_str_eq(device_next_event(&device), "");
    device_done(&device);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("slave_time");

    tcase_add_loop_test(tcase, conversation, 0, COUNT(talks));
    tcase_add_loop_test(tcase, orders_by_state, 0, COUNT(states));
    tcase_add_test(tcase, without_the_object);
    tcase_add_test(tcase, what_it_listens_to);
    tcase_add_test(tcase, no_room);
    return suite_run("slave_time", tcase);
}
