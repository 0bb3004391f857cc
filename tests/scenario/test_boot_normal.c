#include "support/plant.h"
#include "support/suite.h"
#include "support/wire_log.h"

#include <stdio.h>
#include <stdlib.h>

/* All defaults; a node that is only there, one with identity, configuration and heartbeat. */
static const char defaults[] = "<Node_Instance><Node_Id>5</Node_Id></Node_Instance>"
                               "<Node_Instance><Node_Id>6</Node_Id>"
                               "<Device_Type_Identification>0x20192</Device_Type_Identification>"
                               "<Vendor_Identification>0x29A</Vendor_Identification>"
                               "<Serial_Number>6</Serial_Number>"
                               "<Consumer_Heartbeat_Time>1500</Consumer_Heartbeat_Time>"
                               "</Node_Instance>";

static const char start_all[] = "<NMT_Start_All>TRUE</NMT_Start_All>";

static const char absent[] = "<Node_Instance><Node_Id>9</Node_Id></Node_Instance>";

static struct plant *make_plant(const char *before, const char *after)
{
    char xml[2048];
    struct plant *plant;

    snprintf(xml, sizeof xml, "%s%s%s", before, defaults, after);
    plant = plant_new(xml, 1000000);
    plant_add_device(plant, 5);
    plant_add_object(plant_add_device(plant, 6), 0x6200, 1, 1, 0);
    plant_configure(plant, 6, 0x6200, 1, 1, 0x55);
    plant_configure(plant, 6, 0x1017, 0, 2, 500);
    plant_power_on(plant);
    return plant;
}

static const struct normal {
    const char *before, *after; /* of the XML */
    const char *log;
    const char *says;
} normals[] = {
    { "", "", "wire/boot_defaults.log", "network is up: 2 of 2 nodes booted" },
    { start_all, "", "wire/boot_start_all.log", "network is up: 2 of 2 nodes booted" },
    { start_all, absent, "wire/boot_absent.log", "network is up: 2 of 3 nodes booted" },
};

START_TEST(test_log)
{
    const struct normal *normal = &normals[_i];
    struct plant *plant = make_plant(normal->before, normal->after);
    char difference[WIRE_LOG_DIFFERENCE_SIZE] = "";
    char *expected, *actual;

    plant_run_ms(plant, 1700);
    expected = wire_log_read(normal->log);
    actual = sim_trace_text(&plant->sim);
    ck_assert_msg(expected && wire_log_same(expected, actual, difference, sizeof difference),
                  "%s: %s\n%s", normal->log, difference, actual);
    ck_assert_msg(plant_said(plant, normal->says), "%s", plant->events);
    ck_assert_int_eq(plant->manager->state, NETWORK_OPERATIONAL);
    ck_assert_int_eq(plant->manager->device.state, NMT_OPERATIONAL);
    ck_assert_int_eq(plant->devices[5]->slave.state, NMT_OPERATIONAL);
    ck_assert_int_eq(plant->devices[6]->slave.state, NMT_OPERATIONAL);
    ck_assert_uint_eq(od_number(&plant->devices[6]->od, 0x6200, 1, 0), 0x55);
    free(expected);
    free(actual);
    plant_free(plant);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("boot_normal");

    tcase_add_loop_test(tcase, test_log, 0, sizeof normals / sizeof normals[0]);
    return suite_run("boot_normal", tcase);
}
