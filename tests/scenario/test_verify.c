/*
 * Verify_Configuration: what is read, and what is written therefore, frame for frame.
 */
#include "support/suite.h"
#include "support/watch.h"

#include <stdio.h>
#include <string.h>

#define VERIFY "<Verify_Configuration>TRUE</Verify_Configuration>"
#define SAVE   "<Save_Configuration>TRUE</Save_Configuration>"
#define DATES                                                                                      \
    "<Configuration_Date>5000</Configuration_Date>"                                                \
    "<Configuration_Time>6000</Configuration_Time>"

struct object {
    uint16_t index;
    uint8_t sub, size;
    uint32_t value;
};

static struct plant *make_plant(const char *node)
{
    char xml[1024];
    struct plant *plant;

    snprintf(xml, sizeof xml, "<Node_Instance><Node_Id>5</Node_Id>%s</Node_Instance>", node);
    plant = plant_new(xml, 1000000);
    plant_add_device(plant, 5);
    watch_start(plant);
    return plant;
}

static void set(struct plant *plant, const struct object *values)
{
    for (const struct object *o = values; o->index != 0; o++)
        od_set_number(&plant->devices[5]->od, o->index, o->sub, o->value);
}

static void add_objects(struct plant *plant, const struct object *objects)
{
    for (const struct object *o = objects; o->index != 0; o++)
        plant_add_object(plant->devices[5], o->index, o->sub, o->size, o->value);
}

static void configure(struct plant *plant, const struct object *entries)
{
    for (const struct object *o = entries; o->index != 0; o++)
        plant_configure(plant, 5, o->index, o->sub, o->size, o->value);
}

static void expect_up(struct plant *plant, const char *name, const char *said)
{
    watch_expect_up(plant, name);
    ck_assert_msg(plant_said_times(plant, said) == 1, "%s: %s", name, plant->events);
}

/* --- entries that stand alone --- */

static const struct object io[] = {
    { 0x6200, 1, 1, 0 }, { 0x6200, 2, 1, 0 }, { 0x2000, 0, 4, 0 }, { .index = 0 }
};
static const struct object io_entries[] = {
    { 0x6200, 1, 1, 0x55 }, { 0x6200, 2, 1, 0x66 }, { 0x2000, 0, 4, 0x77 }, { .index = 0 }
};

/* What the device holds, what it answers, and what is said to it. */
static const struct alone {
    const char *name;
    uint32_t first, second, third;
    const char *lie, *answer;
    unsigned times;
    const char *talk, *said;
} alones[] = {
    { "all the same", 0x55, 0x66, 0x77, NULL, NULL, 0, " r6200:1 r6200:2 r2000:0",
      "is configured already (entries compared: 3)" },
    { "one differs", 0x55, 0x65, 0x77, NULL, NULL, 0, " r6200:1 r6200:2 w6200:2=66 r2000:0",
      "entries written: 1 of 3, the others were there" },
    { "all differ", 0, 0, 0, NULL, NULL, 0,
      " r6200:1 w6200:1=55 r6200:2 w6200:2=66 r2000:0 w2000:0=77",
      "entries written: 3 of 3, the others were there" },
    { "write-only", 0x55, 0x66, 0x77, "605#40006202", "585#8000620201000106", 1,
      " r6200:1 r6200:2 w6200:2=66 r2000:0", "entries written: 1 of 3, the others were there" },
    { "a value of another size", 0x55, 0x66, 0x77, "605#40006202", "585#4B00620266000000", 1,
      " r6200:1 r6200:2 w6200:2=66 r2000:0", "entries written: 1 of 3, the others were there" },
    { "an answer without a size", 0x55, 0x66, 0x77, "605#40006202", "585#4200620266000000", 1,
      " r6200:1 r6200:2 r2000:0", "is configured already (entries compared: 3)" },
    { "another one", 0x55, 0x66, 0x77, "605#40006202", "585#4200620265000000", 1,
      " r6200:1 r6200:2 w6200:2=66 r2000:0", "entries written: 1 of 3, the others were there" },
    { "a read that is not answered", 0x55, 0x66, 0x77, "605#40006202", NULL, 3,
      " r6200:1 r6200:2 r6200:2 r6200:2 w6200:2=66 r2000:0",
      "entries written: 1 of 3, the others were there" },
    { "the third answer", 0x55, 0x66, 0x77, "605#40006202", NULL, 2,
      " r6200:1 r6200:2 r6200:2 r6200:2 r2000:0", "is configured already (entries compared: 3)" },
};

START_TEST(test_alone)
{
    const struct alone *row = &alones[_i];
    struct plant *plant = make_plant(VERIFY);
    struct od *od = &plant->devices[5]->od;

    add_objects(plant, io);
    configure(plant, io_entries);
    plant_power_on(plant);
    od_set_number(od, 0x6200, 1, row->first);
    od_set_number(od, 0x6200, 2, row->second);
    od_set_number(od, 0x2000, 0, row->third);
    if (row->lie)
        plant_lie(plant, row->lie, row->answer, row->times);
    plant_run_ms(plant, 1500);
    expect_up(plant, row->name, row->said);
    ck_assert_str_eq(plant_talk(plant, 5), row->talk);
    ck_assert(plant_said(plant, "compares its configuration: 3 entries of"));
    plant_free(plant);
}
END_TEST

/* Without the element nothing is read. */
START_TEST(test_off)
{
    struct plant *plant = make_plant("");

    add_objects(plant, io);
    configure(plant, io_entries);
    plant_power_on(plant);
    set(plant, io_entries);
    plant_run_ms(plant, 1000);
    expect_up(plant, "off", "configures it: 3 entries of");
    ck_assert_str_eq(plant_talk(plant, 5), " w6200:1=55 w6200:2=66 w2000:0=77");
    ck_assert(!plant_said(plant, "compared"));
    plant_free(plant);
}
END_TEST

/* The date is looked at first; entries only when it differs. */
START_TEST(test_date_first)
{
    struct plant *plant = make_plant(VERIFY DATES);
    const struct object dates[] = { { 0x1020, 0, 1, 2 },
                                    { 0x1020, 1, 4, 5000 },
                                    { 0x1020, 2, 4, 6000 + (unsigned)_i },
                                    { .index = 0 } };

    add_objects(plant, io);
    add_objects(plant, dates);
    configure(plant, io_entries);
    plant_power_on(plant);
    set(plant, io_entries);
    plant_run_ms(plant, 1000);
    expect_up(plant, "dates", "is configured already");
    ck_assert_str_eq(plant_talk(plant, 5),
                     _i ? " r1020:1 r1020:2 r6200:1 r6200:2 r2000:0" : " r1020:1 r1020:2");
    plant_free(plant);
}
END_TEST

/* A write that is refused fails as it does without comparing. */
START_TEST(test_write_refused)
{
    struct plant *plant = make_plant(VERIFY);

    add_objects(plant, io);
    configure(plant, io_entries);
    plant_power_on(plant);
    plant_lie(plant, "605#2F006202", "585#8000620231000906", 1);
    plant_run_ms(plant, 500);
    ck_assert(plant_said(plant, "boot error J: write 6200h:02 = 66h (entry 2 of 3 of "
                                "the configuration): the node answers abort 06090031h"));
    ck_assert_str_eq(plant_talk(plant, 5), " r6200:1 w6200:1=55 r6200:2 w6200:2=66");
    plant_free(plant);
}
END_TEST

/* --- written in any case --- */

static const struct object any_case[] = { { 0x2000, 0, 4, 0x4321 },     { 0x6200, 1, 1, 0x55 },
                                          { 0x2000, 0, 4, 0x77 },       { 0x1011, 1, 4, 0x6C },
                                          { 0x1010, 1, 4, 0x65766173 }, { 0x1F51, 1, 1, 1 },
                                          { 0x1F80, 0, 4, 4 },          { .index = 0 } };

/* An object written twice (a lock is opened, and closed), commands. */
START_TEST(test_any_case)
{
    struct plant *plant = make_plant(VERIFY);
    const struct object more[] = { { 0x1011, 1, 4, 1 },
                                   { 0x1010, 1, 4, 1 },
                                   { 0x1F51, 1, 1, 1 },
                                   { 0x1F80, 0, 4, 4 },
                                   { .index = 0 } };

    plant->on_delivered = NULL; /* what is written twice is not there in the end */
    add_objects(plant, io);
    add_objects(plant, more);
    configure(plant, any_case);
    plant_power_on(plant);
    set(plant, io_entries);
    plant_lie(plant, "605#23111001", "585#6011100100000000", 1);
    plant_run_ms(plant, 1000);
    ck_assert_str_eq(plant_talk(plant, 5),
                     " w2000:0=4321 r6200:1 w2000:0=77 w1011:1=6C w1010:1=6173 w1F51:1=1 r1F80:0");
    ck_assert(plant_said(plant, "entries written: 5 of 7, the others were there"));
    plant_free(plant);
}
END_TEST

/* A text is compared, up to 64 bytes; what is longer is written: it may be a file. */
START_TEST(test_long_value)
{
    static const uint8_t value[] =
        "0123456789012345678901234567890123456789012345678901234567890123"
        "4";
    const struct od_spec spec = {
        .index = 0x2010, .type = OD_VISIBLE_STRING, .access = OD_RW, .capacity = 100
    };
    const uint32_t size = _i ? 65 : 64;
    struct plant *plant = make_plant(VERIFY);
    struct od_entry *entry;

    plant->on_delivered = NULL; /* knows numbers only */
    ck_assert_int_eq(od_add(&plant->devices[5]->od, &spec, &entry), CO_OK);
    ck_assert_int_eq(ccf_append(&plant->config->nodes[0].ccf, 0x2010, 0, value, size), CO_OK);
    plant_power_on(plant);
    plant_run_ms(plant, 500);
    ck_assert_str_eq(plant_talk(plant, 5), _i ? " w2010:0=41" : " r2010:0 w2010:0=40");
    plant->sim.trace_count = 0;
    ck_assert_int_eq(plant_command(plant, NMT_RESET_COMMUNICATION, 5), CO_OK);
    plant_run_ms(plant, 500);
    ck_assert_str_eq(plant_talk(plant, 5), _i ? " w2010:0=41" : " r2010:0");
    ck_assert_mem_eq(entry->value, value, size);
    plant_free(plant);
}
END_TEST

/* --- sequences --- */

static const struct object pdo[] = { { 0x1800, 0, 1, 2 },   { 0x1800, 1, 4, 0x80000185 },
                                     { 0x1800, 2, 1, 255 }, { 0x1A00, 0, 1, 1 },
                                     { 0x1A00, 1, 4, 0 },   { 0x1A00, 2, 4, 0 },
                                     { 0x1401, 0, 1, 2 },   { 0x1401, 1, 4, 0 },
                                     { 0x6200, 1, 1, 0 },   { .index = 0 } };
static const struct object pdo_entries[] = {
    { 0x1800, 1, 4, 0x80000195 }, { 0x1800, 2, 1, 254 },
    { 0x1A00, 0, 1, 0 },          { 0x1A00, 1, 4, 0x62000108 },
    { 0x6200, 1, 1, 0x55 },       { 0x1401, 1, 4, 0x80000205 },
    { 0x1A00, 0, 1, 1 },          { 0x1401, 1, 4, 0x205 },
    { 0x1800, 1, 4, 0x195 },      { .index = 0 }
};
#define READ_TPDO " r1800:2 r1A00:1 r1A00:0 r1800:1"
#define OTHERS    " r6200:1 r1401:1"

/*
 * A PDO's entries are looked at together, when the first one's turn comes, and written in order
 * when one differs; also where other entries stand between.
 */
static const struct sequence {
    const char *name;
    struct object different; /* from what was configured */
    const char *talk;
} sequences[] = {
    { "all the same", { .index = 0 }, READ_TPDO OTHERS },
    { "another COB-ID",
      { 0x1800, 1, 4, 0x185 },
      READ_TPDO " w1800:1=195 w1800:2=FE w1A00:0=0 w1A00:1=108" OTHERS " w1A00:0=1 w1800:1=195" },
    { "switched off",
      { 0x1800, 1, 4, 0x80000195 },
      READ_TPDO " w1800:1=195 w1800:2=FE w1A00:0=0 w1A00:1=108" OTHERS " w1A00:0=1 w1800:1=195" },
    { "another type",
      { 0x1800, 2, 1, 1 },
      " r1800:2 w1800:1=195 w1800:2=FE w1A00:0=0 w1A00:1=108" OTHERS " w1A00:0=1 w1800:1=195" },
    { "not mapped",
      { 0x1A00, 0, 1, 0 },
      " r1800:2 r1A00:1 r1A00:0 w1800:1=195 w1800:2=FE w1A00:0=0 w1A00:1=108" OTHERS
      " w1A00:0=1 w1800:1=195" },
    { "the other PDO", { 0x1401, 1, 4, 0x206 }, READ_TPDO OTHERS " w1401:1=205 w1401:1=205" },
    { "an object between", { 0x6200, 1, 1, 1 }, READ_TPDO " r6200:1 w6200:1=55 r1401:1" },
};

START_TEST(test_sequence)
{
    const struct sequence *row = &sequences[_i];
    struct plant *plant = make_plant(VERIFY);
    struct od *od = &plant->devices[5]->od;

    plant->on_delivered = NULL; /* an object has several values here */
    add_objects(plant, pdo);
    configure(plant, pdo_entries);
    od_find(od, 0x6200, 1)->mappable = true;
    plant_power_on(plant);
    plant_run_ms(plant, 100); /* in the boot delay: as if it had been saved */
    set(plant, pdo_entries);
    if (row->different.index)
        od_set_number(od, row->different.index, row->different.sub, row->different.value);
    plant_run_ms(plant, 1000);
    ck_assert_msg(plant_node(plant, 5)->booted, "%s: %s", row->name, plant->events);
    ck_assert_str_eq(plant_talk(plant, 5), row->talk);
    ck_assert_uint_eq(od_number(od, 0x1800, 1, 0), 0x195);
    ck_assert_uint_eq(od_number(od, 0x1A00, 0, 0), 1);
    ck_assert_uint_eq(od_number(od, 0x1401, 1, 0), 0x205);
    plant_free(plant);
}
END_TEST

/* What differed in one boot is looked at anew in the next one. */
START_TEST(test_sequence_in_next_boot)
{
    struct plant *plant = make_plant(VERIFY);
    struct od *od = &plant->devices[5]->od;

    plant->on_delivered = NULL; /* an object has several values here */
    add_objects(plant, pdo);
    configure(plant, pdo_entries);
    od_find(od, 0x6200, 1)->mappable = true;
    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    ck_assert(plant_said(plant, "entries written: 9 of 9"));
    plant->sim.trace_count = 0;
    ck_assert_int_eq(plant_command(plant, NMT_RESET_COMMUNICATION, 5), CO_OK);
    plant_run_ms(plant, 100); /* in the boot delay */
    set(plant, pdo_entries);
    plant_run_ms(plant, 1000);
    ck_assert_str_eq(plant_talk(plant, 5), READ_TPDO OTHERS);
    plant_free(plant);
}
END_TEST

/* What else has an order: SYNC, an SDO channel, heartbeat consumers. */
static const struct object ordered[] = { { 0x1005, 0, 4, 0x80 },       { 0x1006, 0, 4, 0 },
                                         { 0x1019, 0, 1, 10 },         { 0x1006, 0, 4, 1000 },
                                         { 0x1005, 0, 4, 0x40000080 }, { 0x1016, 1, 4, 0 },
                                         { 0x1016, 1, 4, 0x801F4 },    { 0x1280, 1, 4, 0x80000600 },
                                         { 0x1280, 1, 4, 0x601 },      { .index = 0 } };
static const struct object ordered_in_device[] = { { 0x1005, 0, 4, 0x80 }, { 0x1006, 0, 4, 0 },
                                                   { 0x1019, 0, 1, 0 },    { 0x1016, 0, 1, 1 },
                                                   { 0x1016, 1, 4, 0 },    { 0x1280, 1, 4, 0 },
                                                   { .index = 0 } };
static const struct {
    struct object different;
    const char *talk;
} orders[] = {
    { { .index = 0 }, " r1019:0 r1006:0 r1005:0 r1016:1 r1280:1" },
    { { 0x1019, 0, 1, 11 },
      " r1019:0 w1005:0=80 w1006:0=0 w1019:0=A w1006:0=3E8 w1005:0=80 r1016:1 r1280:1" },
    { { 0x1016, 1, 4, 0x801F5 }, " r1019:0 r1006:0 r1005:0 r1016:1 w1016:1=0 w1016:1=1F4 r1280:1" },
    { { 0x1280, 1, 4, 0x602 }, " r1019:0 r1006:0 r1005:0 r1016:1 r1280:1 w1280:1=600 w1280:1=601" },
};

START_TEST(test_ordered)
{
    const struct object *different = &orders[_i].different;
    struct plant *plant = make_plant(VERIFY);

    plant->on_delivered = NULL; /* an object has several values here */
    add_objects(plant, ordered_in_device);
    configure(plant, ordered);
    plant_power_on(plant);
    plant_run_ms(plant, 100); /* in the boot delay: as if it had been saved */
    set(plant, ordered);
    if (different->index)
        od_set_number(&plant->devices[5]->od, different->index, different->sub, different->value);
    plant_run_ms(plant, 1000);
    ck_assert_msg(plant_node(plant, 5)->booted, "%s", plant->events);
    ck_assert_str_eq(plant_talk(plant, 5), orders[_i].talk);
    plant_free(plant);
}
END_TEST

/* --- saving --- */

static const struct object store[] = { { 0x1010, 0, 1, 1 }, { 0x1010, 1, 4, 1 }, { .index = 0 } };

/* Only what has changed is saved; a save that failed is made up for when all is there already. */
START_TEST(test_save)
{
    struct plant *plant = make_plant(VERIFY SAVE);

    add_objects(plant, io);
    add_objects(plant, store);
    configure(plant, io_entries);
    plant_power_on(plant);
    plant_lie(plant, "605#23101001", NULL, 1);
    plant_run_ms(plant, 10400);
    ck_assert(plant_said(plant, "boot error J: write 1010h:01 \"save\": no answer"));
    plant->sim.trace_count = 0;
    plant_run_ms(plant, 1500);
    watch_expect_up(plant, "save again");
    ck_assert_str_eq(plant_talk(plant, 5), " r6200:1 r6200:2 r2000:0 w1010:1=6173");
    plant->sim.trace_count = 0;
    ck_assert_int_eq(plant_command(plant, NMT_RESET_COMMUNICATION, 5), CO_OK);
    plant_run_ms(plant, 500);
    watch_expect_up(plant, "nothing to save");
    ck_assert_str_eq(plant_talk(plant, 5), " r6200:1 r6200:2 r2000:0");
    plant_free(plant);
}
END_TEST

#define LOOP(test, rows) tcase_add_loop_test(tcase, test, 0, sizeof rows / sizeof rows[0])

int main(void)
{
    TCase *tcase = tcase_create("verify");

    LOOP(test_alone, alones);
    tcase_add_test(tcase, test_off);
    tcase_add_loop_test(tcase, test_date_first, 0, 2);
    tcase_add_test(tcase, test_write_refused);
    tcase_add_test(tcase, test_any_case);
    tcase_add_loop_test(tcase, test_long_value, 0, 2);
    LOOP(test_sequence, sequences);
    tcase_add_test(tcase, test_sequence_in_next_boot);
    LOOP(test_ordered, orders);
    tcase_add_test(tcase, test_save);
    return suite_run("verify", tcase);
}
