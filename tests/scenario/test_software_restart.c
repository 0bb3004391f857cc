/*
 * A device that starts anew in the middle of its software update, by itself or because its program
 * stops or starts.
 */
#include "support/loader.h"
#include "support/suite.h"
#include "support/tool.h"

static const struct middle {
    const char *phase;
    bool slow; /* its flash, so that there is time */
    unsigned restarts;
    bool tried_again;
} middles[] = {
    { "stops its program", false, 1, false },  { "stops its program", false, 3, false },
    { "clears its program", true, 1, false },  { "clears its program", true, 2, true },
    { "writes its program", true, 1, false },  { "writes its program", true, 3, false },
    { "starts its program", false, 1, false }, { "starts its program", false, 2, false },
};

START_TEST(test_restart)
{
    const struct middle *row = &middles[_i];
    struct loader loader;

    loader_make(&loader, LOADER_UPDATE);
    loader.clear_ms = row->slow ? 3000 : 50;
    loader.write_ms = row->slow ? 3000 : 50;
    loader_run_until(&loader, row->phase, 10000);
    for (unsigned i = 0; i < row->restarts; i++) {
        loader_run(&loader, 120);
        loader_restart(&loader, 100);
        loader_run(&loader, 150);
    }
    loader_run_until(&loader, "node 5: start command sent", 30000);
    loader_run(&loader, 10);
    loader_expect_updated(&loader, row->phase);
    ck_assert_uint_eq(loader.programs, 1);
    ck_assert_msg(plant_said(loader.plant, "the node has started anew meanwhile") ==
                      row->tried_again,
                  "%s: %s", row->phase, loader.plant->events);
    plant_free(loader.plant);
}
END_TEST

/* While it is asked for its state, or for its new program. */
static const struct asked {
    const char *from; /* when this was said */
    const char *request;
} asked[] = {
    { "boot begins", "605#40511F01" },
    { "writes its program", "605#40561F01" },
};

START_TEST(test_restart_while_asked)
{
    struct loader loader;

    loader_make(&loader, LOADER_UPDATE);
    loader_run_until(&loader, asked[_i].from, 1000);
    plant_lie(loader.plant, asked[_i].request, NULL, 1);
    while (loader.plant->lies[0].times > 0)
        loader_run(&loader, 1);
    loader_restart(&loader, 50);
    loader_run(&loader, 3000);
    loader_expect_updated(&loader, asked[_i].from);
    ck_assert(!plant_said(loader.plant, "error"));
    ck_assert_uint_eq(plant_said_times(loader.plant, "checks its software"), 2);
    plant_free(loader.plant);
}
END_TEST

/* It is not to be booted any more (1F81h): its update ends all the same, then it is left alone. */
static const struct left {
    const char *phase; /* it restarts in that ... */
    bool slow;
    const char *unheard; /* ... or when it has not heard this, behind it */
} left[] = { { "stops its program", false, NULL },
             { "stops its program", false, "605#2F511F0103" },
             { "clears its program", true, NULL },
             { "writes its program", true, NULL },
             { "starts its program", false, NULL } };

START_TEST(test_restart_when_left_alone)
{
    const struct left *row = &left[_i];
    struct loader loader;

    loader_make(&loader, LOADER_UPDATE);
    tool_attach(loader.plant);
    loader.clear_ms = row->slow ? 3000 : 50;
    loader.write_ms = row->slow ? 3000 : 50;
    loader_run_until(&loader, row->phase, 10000);
    if (row->unheard)
        plant_lie(loader.plant, row->unheard, NULL, 1);
    tool_set(loader.plant, 0x1F81, 5, 0x01);
    loader_run(&loader, 120);
    ck_assert(!row->unheard || loader.plant->lies[0].times == 0);
    loader_restart(&loader, 100);
    loader_run(&loader, 15000);
    ck_assert_msg(loader.running && loader.id == LOADER_NEW, "%s", loader.plant->events);
    ck_assert_uint_eq(loader.programs, 1);
    ck_assert_int_eq(plant_node(loader.plant, 5)->step, BOOT_READY);
    ck_assert_uint_eq(plant_said_times(loader.plant, "checks its software"), 1);
    ck_assert(!plant_said(loader.plant, "error"));
    ck_assert_int_eq(loader.plant->devices[5]->slave.state, NMT_PREOPERATIONAL);
    plant_free(loader.plant);
}
END_TEST

/* In the middle of the download it is begun again, a second later; but not for ever. */
START_TEST(test_restart_in_download)
{
    bool always = _i == 1;
    struct loader loader;

    loader_make(&loader, LOADER_UPDATE);
    loader.die_in_write = 100;
    loader_run_until(
        &loader, "boot error I: write its program, 1F50h:01: the node has started anew meanwhile",
        5000);
    loader.die_in_write = always ? 100 : 0;
    loader_run(&loader, 10000);
    if (always)
        loader_expect_failed(&loader,
                             "and 3 updates have not changed that: see what they failed with");
    else
        loader_expect_updated(&loader, "once");
    ck_assert_uint_eq(plant_said_times(loader.plant, "writes its program"), always ? 3 : 2);
    plant_free(loader.plant);
}
END_TEST

/* A boot-up message of a device that was given up boots it, but does not write its flash again;
 * when the application begins anew that is allowed again. */
START_TEST(test_given_up)
{
    struct loader loader;

    loader_make(&loader, LOADER_UPDATE);
    loader.die_in_write = 100;
    loader_run_until(&loader, "and 3 updates have not changed that", 20000);
    loader.die_in_write = 0;
    loader_restart(&loader, 100);
    loader_run(&loader, 3000);
    ck_assert_uint_eq(loader.programs, 0);
    ck_assert_int_eq(plant_node(loader.plant, 5)->step, BOOT_FAILED);
    ck_assert_int_eq(plant_command(loader.plant, NMT_RESET_COMMUNICATION, 127), CO_OK);
    loader_run(&loader, 3000);
    loader_expect_updated(&loader, "begun anew");
    plant_free(loader.plant);
}
END_TEST

/* The device is replaced by an old one, again and again in the life of a plant: each is updated. */
START_TEST(test_replaced_often)
{
    struct loader loader;

    loader_make(&loader, LOADER_UPDATE);
    for (unsigned i = 1; i <= 4; i++) {
        loader_run(&loader, 5000);
        loader_expect_updated(&loader, "replaced");
        ck_assert_uint_eq(loader.programs, i);
        loader.id = LOADER_OLD;
        loader_restart(&loader, 100);
    }
    plant_free(loader.plant);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("software_restart");

    tcase_add_loop_test(tcase, test_restart, 0, sizeof middles / sizeof middles[0]);
    tcase_add_loop_test(tcase, test_restart_while_asked, 0, sizeof asked / sizeof asked[0]);
    tcase_add_loop_test(tcase, test_restart_when_left_alone, 0, sizeof left / sizeof left[0]);
    tcase_add_loop_test(tcase, test_restart_in_download, 0, 2);
    tcase_add_test(tcase, test_given_up);
    tcase_add_test(tcase, test_replaced_often);
    return suite_run("software_restart", tcase);
}
