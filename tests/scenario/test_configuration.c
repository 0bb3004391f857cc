/*
 * Configuration by the date in 1020h, and saving it.
 */
#include "support/suite.h"
#include "support/watch.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DATES                                                                                      \
    "<Configuration_Date>5000</Configuration_Date>"                                                \
    "<Configuration_Time>6000</Configuration_Time>"
#define SAVE "<Save_Configuration>TRUE</Save_Configuration>"

static struct plant *make_plant(const char *node)
{
    char xml[1024];
    struct plant *plant;

    snprintf(xml, sizeof xml, "<Node_Instance><Node_Id>5</Node_Id>%s</Node_Instance>", node);
    plant = plant_new(xml, 1000000);
    plant_add_object(plant_add_device(plant, 5), 0x6200, 1, 1, 0);
    plant_configure(plant, 5, 0x6200, 1, 1, 0x55);
    watch_start(plant);
    return plant;
}

static void add_1020(struct plant *plant, uint32_t date, uint32_t time)
{
    plant_add_object(plant->devices[5], 0x1020, 0, 1, 2);
    plant_add_object(plant->devices[5], 0x1020, 1, 4, date);
    plant_add_object(plant->devices[5], 0x1020, 2, 4, time);
}

/* What the device holds in 1020h, and what is read and written therefore. */
static const struct check {
    const char *name;
    const char *node;
    uint32_t date, time;
    const char *lie, *answer;
    unsigned reads_1, reads_2, writes;
} checks[] = {
    { "the same", DATES, 5000, 6000, NULL, NULL, 1, 1, 0 },
    { "another date", DATES, 5001, 6000, NULL, NULL, 1, 0, 1 },
    { "another time", DATES, 5000, 6001, NULL, NULL, 1, 1, 1 },
    { "never configured", DATES, 0, 0, NULL, NULL, 1, 0, 1 },
    { "no dates given", "", 5000, 6000, NULL, NULL, 0, 0, 1 },
    { "refused", DATES, 5000, 6000, "605#40201001", "585#8020100100000206", 1, 0, 1 },
    { "time refused", DATES, 5000, 6000, "605#40201002", "585#8020100211000906", 1, 1, 1 },
    { "no answer", DATES, 5000, 6000, "605#40201001", NULL, 3, 0, 1 },
    { "a short answer", DATES, 5000, 6000, "605#40201001", "585#4F20100188000000", 1, 0, 1 },
};

START_TEST(test_check)
{
    const struct check *check = &checks[_i];
    struct plant *plant = make_plant(check->node);

    add_1020(plant, check->date, check->time);
    if (check->lie)
        plant_lie(plant, check->lie, check->answer, 3);
    if (check->writes == 0)
        od_set_number(&plant->devices[5]->od, 0x6200, 1, 0x55);
    plant_power_on(plant);
    if (check->writes == 0) /* as if it had been saved: the reset at power on has taken it */
        od_set_number(&plant->devices[5]->od, 0x6200, 1, 0x55);
    plant_run_ms(plant, 1500);
    watch_expect_up(plant, check->name);
    ck_assert_msg(plant_sent(plant, "605#40201001") == check->reads_1, "%s", check->name);
    ck_assert_msg(plant_sent(plant, "605#40201002") == check->reads_2, "%s", check->name);
    ck_assert_msg(plant_sent(plant, "605#2") == check->writes, "%s", check->name);
    ck_assert_uint_eq(plant_said_times(plant, "is configured already"), check->writes == 0);
    plant_free(plant);
}
END_TEST

/* A device without 1020h at all */
START_TEST(test_no_1020)
{
    struct plant *plant = make_plant(DATES);

    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    watch_expect_up(plant, "without 1020h");
    ck_assert_uint_eq(plant_sent(plant, "605#2"), 1);
    plant_free(plant);
}
END_TEST

/* Without dates in the network's file, those that the configuration itself writes are meant. */
START_TEST(test_dates_of_configuration)
{
    struct plant *plant = make_plant("");

    add_1020(plant, 0, 0);
    plant_configure(plant, 5, 0x1020, 1, 4, 77);
    plant_configure(plant, 5, 0x1020, 2, 4, 78);
    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    watch_expect_up(plant, "first");
    ck_assert_uint_eq(plant_sent(plant, "605#2"), 3);
    ck_assert_int_eq(plant_command(plant, NMT_RESET_COMMUNICATION, 5), CO_OK);
    plant_run_ms(plant, 1000);
    watch_expect_up(plant, "second");
    ck_assert_uint_eq(plant_sent(plant, "605#2"), 6); /* it was not saved */
    plant_free(plant);
}
END_TEST

/* --- save --- */

static struct plant *make_saving(void)
{
    struct plant *plant = make_plant(DATES SAVE);

    add_1020(plant, 0, 0);
    plant_add_object(plant->devices[5], 0x1010, 0, 1, 1);
    plant_add_object(plant->devices[5], 0x1010, 1, 4, 1);
    plant_configure(plant, 5, 0x1020, 1, 4, 5000);
    plant_configure(plant, 5, 0x1020, 2, 4, 6000);
    return plant;
}

/* Saved once, last of all; after a power cycle there is nothing to write, nor to save. */
START_TEST(test_save)
{
    struct plant *plant = make_saving();

    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    watch_expect_up(plant, "is not up");
    ck_assert_uint_eq(plant_sent(plant, "605#2310100173617665"), 1);
    plant->sim.trace_count = 0;
    plant_power(plant, 5, false);
    plant_power(plant, 5, true);
    plant_run_ms(plant, 1000);
    watch_expect_up(plant, "is not up again");
    ck_assert_uint_eq(plant_sent(plant, "605#2"), 0);
    ck_assert(plant_said(plant, "is configured already"));
    plant_free(plant);
}
END_TEST

/* The same with the dates that the configuration itself has, and none in the network's file. */
START_TEST(test_saved_dates_of_configuration)
{
    struct plant *plant = make_plant(SAVE);

    add_1020(plant, 0, 0);
    plant_add_object(plant->devices[5], 0x1010, 0, 1, 1);
    plant_add_object(plant->devices[5], 0x1010, 1, 4, 1);
    plant_configure(plant, 5, 0x1020, 1, 4, 77);
    plant_configure(plant, 5, 0x1020, 2, 4, 78);
    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    watch_expect_up(plant, "is not up");
    plant->sim.trace_count = 0;
    plant_power(plant, 5, false);
    plant_power(plant, 5, true);
    plant_run_ms(plant, 1000);
    watch_expect_up(plant, "is not up again");
    ck_assert_uint_eq(plant_sent(plant, "605#40201001"), 1);
    ck_assert_uint_eq(plant_sent(plant, "605#2"), 0);
    plant_free(plant);
}
END_TEST

/* The device writes its flash for 9.9 s: no time-out; 10.1 s is one, and all is begun anew. */
static enum sim_fate slow_flash(struct plant *plant, const struct co_frame *frame, uint8_t sender)
{
    unsigned *ms = plant->fault_context;

    (void)sender;
    if (frame->id == 0x605 && frame->data[0] == 0x23 && frame->data[1] == 0x10)
        plant->devices[5]->sim->hold_until = plant->sim.now + CO_MS(*ms);
    return SIM_DELIVER;
}

START_TEST(test_slow_flash)
{
    unsigned failures = _i ? 1 : 0, ms = _i ? 10100 : 9900;
    struct plant *plant = make_saving();

    plant->fault = slow_flash;
    plant->fault_context = &ms;
    plant_power_on(plant);
    plant_run_ms(plant, 10050);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_SAVE);
    plant_run_ms(plant, 250);
    ck_assert_int_eq(plant_node(plant, 5)->booted, _i == 0);
    ck_assert_uint_eq(plant_said_times(plant, "boot error J: write 1010h:01 \"save\": no answer"),
                      failures);
    ms = 10;
    plant_run_ms(plant, 3000);
    watch_expect_up(plant, "is not up");
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), failures);
    plant_free(plant);
}
END_TEST

#define TEXT "a text of more than four bytes"

/* SDO_Block_Size: in blocks what is longer than 4 bytes, if the device has them. */
static const struct blocks {
    const char *node;
    bool served;
    unsigned in_blocks, in_segments;
} blocks[] = {
    { "<SDO_Block_Size>8</SDO_Block_Size>", true, 2, 0 },
    { "<SDO_Block_Size>8</SDO_Block_Size>", false, 1, 2 },
    { "", true, 0, 2 },
};

START_TEST(test_blocks)
{
    const struct blocks *row = &blocks[_i];
    const struct od_spec spec = {
        .index = 0x2010, .type = OD_VISIBLE_STRING, .access = OD_RW, .capacity = 100
    };
    struct plant *plant = make_plant(row->node);
    struct ccf *ccf = &plant->config->nodes[0].ccf;
    struct slave *slave = &plant->devices[5]->slave;
    struct od_entry *entry;

    ck_assert_int_eq(od_add(slave->od, &spec, &entry), CO_OK);
    for (unsigned i = 0; i < 2; i++)
        ck_assert_int_eq(ccf_append(ccf, 0x2010, 0, (const uint8_t *)TEXT, sizeof TEXT - 1), CO_OK);
    slave->channels[0].server.block = row->served;
    plant_power_on(plant);
    plant_run_ms(plant, 1500);
    watch_expect_up(plant, row->node);
    ck_assert_uint_eq(entry->size, sizeof TEXT - 1);
    ck_assert_mem_eq(entry->value, TEXT, sizeof TEXT - 1);
    ck_assert_uint_eq(plant_sent(plant, "605#C61020001E"), row->in_blocks);
    ck_assert_uint_eq(plant_sent(plant, "605#211020001E"), row->in_segments);
    ck_assert_uint_eq(plant_sent(plant, "605#2F006201"), 1);
    plant_free(plant);
}
END_TEST

#define MANY  40u
#define LARGE 2000u

static void add_large_object(struct plant_device *device)
{
    const struct od_spec spec = {
        .index = 0x2010, .type = OD_DOMAIN, .access = OD_RW, .capacity = LARGE
    };
    struct sdo_server *server = &device->slave.channels[0].server;

    ck_assert_int_eq(od_add(&device->od, &spec, NULL), CO_OK);
    server->buffer = realloc(server->buffer, LARGE);
    ck_assert_ptr_nonnull(server->buffer);
    device->slave.buffer_size = LARGE;
}

/* More segments than the bus takes in a server's time-out: only some go in blocks. */
START_TEST(test_blocks_of_many)
{
    static uint8_t value[LARGE] = { 1, 2, 3 };
    static char xml[MANY * 120];
    struct plant *plant;

    for (unsigned node = 1; node <= MANY; node++)
        snprintf(xml + strlen(xml), sizeof xml - strlen(xml),
                 "<Node_Instance><Node_Id>%u</Node_Id><SDO_Block_Size>127</SDO_Block_Size>"
                 "<SDO_Timeout>1000</SDO_Timeout></Node_Instance>",
                 node);
    plant = plant_new(xml, 1000000);
    for (uint8_t node = 1; node <= MANY; node++) {
        add_large_object(plant_add_device(plant, node));
        ck_assert_int_eq(ccf_append(&plant->config->nodes[node - 1].ccf, 0x2010, 0, value, LARGE),
                         CO_OK);
    }
    plant_power_on(plant);
    plant_run_ms(plant, 5000);
    for (uint8_t node = 1; node <= MANY; node++) {
        const struct od_entry *entry = od_find(&plant->devices[node]->od, 0x2010, 0);

        ck_assert(plant_node(plant, node)->booted);
        ck_assert_uint_eq(entry->size, LARGE);
        ck_assert_mem_eq(entry->value, value, LARGE);
    }
    ck_assert_uint_eq(plant_sent(plant, "601#C61020"), 1);
    ck_assert_uint_eq(plant_sent(plant, "603#211020"), 1);
    plant_free(plant);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("configuration");

    tcase_add_loop_test(tcase, test_check, 0, sizeof checks / sizeof checks[0]);
    tcase_add_test(tcase, test_no_1020);
    tcase_add_test(tcase, test_dates_of_configuration);
    tcase_add_test(tcase, test_save);
    tcase_add_test(tcase, test_saved_dates_of_configuration);
    tcase_add_loop_test(tcase, test_blocks, 0, sizeof blocks / sizeof blocks[0]);
    tcase_add_test(tcase, test_blocks_of_many);
    tcase_add_loop_test(tcase, test_slow_flash, 0, 2);
    return suite_run("configuration", tcase);
}
