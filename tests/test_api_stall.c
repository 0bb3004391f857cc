/* After a protocol thread has not run: what came meanwhile is known before time counts. */
#include "api/registry.h"
#include "port/clock.h"
#include "support/api_plant.h"
#include "support/api_wire.h"
#include "support/suite.h"

#include <unistd.h>

#define STALL CO_MS(600)

static struct api_plant *plant;
static struct api_wire *wire;

static void set_up(void)
{
    plant = api_plant_new();
    wire = api_wire_open(plant->bus);
    api_devices_start(plant);
}

static void tear_down(void)
{
    api_plant_free(plant);
    api_wire_close(wire);
}

static void say_heartbeat(void)
{
    api_wire_say(wire, "70A#05");
    usleep(5000);
}

/* As when the process is stopped, or the machine: heartbeats of node 10 come, nobody takes them. */
static void stall(void)
{
    const co_us_t end = clock_now() + STALL;
    struct managed *managed;
    co_us_t now;

    ck_assert_int_eq(registry_enter(0, true, &managed), MCANOPEN_OK);
    network_enter(managed->network, &now);
    while (clock_now() < end)
        say_heartbeat();
    network_leave(managed->network, 127);
    registry_leave();
}

#define SUPERVISED(id, more)                                                                       \
    API_NODE_WITH(id, "<NMT_Auto_Start_Slave>FALSE</NMT_Auto_Start_Slave>" more)

/* Of both what was due in the meantime; the guarded node is asked, and its answer waited for. */
START_TEST(nobody_is_missed)
{
    unsigned asked;

    api_wire_answer(wire, "709#R", "709#05");
    api_wire_answer(wire, "000#82", "70A#05");
    api_boot(plant,
             SUPERVISED(9, "<Guard_Time>50</Guard_Time><Life_Time_Factor>4</Life_Time_Factor>")
                 SUPERVISED(10, "<Consumer_Heartbeat_Time>300</Consumer_Heartbeat_Time>"));
    api_wire_wait(wire, "709#R", 3);
    stall();
    asked = api_wire_count(wire, "709#R");
    while (api_wire_count(wire, "709#R") < asked + 3)
        say_heartbeat();
    ck_assert_uint_eq(api_log_count(plant, "no answer to guarding"), 0);
    ck_assert_uint_eq(api_log_count(plant, "heartbeat lost"), 0);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("stall");

    tcase_set_timeout(tests, API_LIMIT);
    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_add_test(tests, nobody_is_missed);
    return suite_run("api_stall", tests);
}
