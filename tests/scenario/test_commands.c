/*
 * NMT commands: those of the application in every state, those of another master.
 */
#include "support/suite.h"
#include "support/watch.h"

#include <stdio.h>

#define ALL     0
#define SELF    127
#define FOREIGN 77

#define MANDATORY "<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>"

/* Node 5 boots, 6 boots if it is powered, 8 is left to the application, 9 is not the master's. */
#define NODES                                                                                      \
    PLANT_NODE(5, MANDATORY)                                                                       \
    PLANT_NODE(6, "")                                                                              \
    PLANT_NODE(8, "<NMT_Auto_Start_Slave>FALSE</NMT_Auto_Start_Slave>")                            \
    PLANT_NODE(9, "<NMT_Slave>FALSE</NMT_Slave>")

static struct plant *make_plant(const char *network)
{
    static const uint8_t nodes[] = { 5, 6, 8, 9 };
    char xml[2048];
    struct plant *plant;

    snprintf(xml, sizeof xml, "%s" NODES, network);
    plant = plant_new(xml, 1000000);
    for (size_t i = 0; i < sizeof nodes; i++)
        plant_add_object(plant_add_device(plant, nodes[i]), 0x6200, 1, 1, 0);
    plant_configure(plant, 5, 0x6200, 1, 1, 0x55);
    plant_configure(plant, 6, 0x6200, 1, 1, 0x56);
    watch_start(plant);
    return plant;
}

static struct plant *run_plant(const char *network)
{
    struct plant *plant = make_plant(network);

    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    return plant;
}

static int state_of(const struct plant *plant, uint8_t node)
{
    return plant->devices[node]->slave.state;
}

/* --- states in which not everything is possible --- */

static struct plant *off(void)
{
    struct plant *plant = make_plant("");

    ck_assert_int_eq(manager_init(plant->manager, plant->config), CO_OK);
    plant->manager_device = sim_add_manager(&plant->sim, plant->manager);
    plant->manager_device->active = true; /* initialised, but not started */
    return plant;
}

static struct plant *resetting(void)
{
    struct plant *plant = make_plant("");

    plant_power_on(plant);
    plant_run_ms(plant, 100);
    ck_assert_int_eq(plant->manager->state, NETWORK_RESETTING);
    return plant;
}

static struct plant *booting(void)
{
    struct plant *plant = make_plant("");

    plant_lie(plant, "605#", NULL, 2);
    plant_power_on(plant);
    plant_run_ms(plant, 300);
    ck_assert_int_eq(plant->manager->state, NETWORK_BOOTING);
    return plant;
}

static struct plant *halted(void)
{
    struct plant *plant = make_plant("");

    plant_lie(plant, "605#2F", "585#8000620100000206", 1);
    plant_power_on(plant);
    plant_run_ms(plant, 300);
    ck_assert_int_eq(plant->manager->state, NETWORK_HALTED);
    return plant;
}

static struct plant *waiting(void)
{
    return run_plant("<NMT_Auto_Operational>FALSE</NMT_Auto_Operational>");
}

static struct plant *operational(void)
{
    return run_plant("");
}

/* Operational, node 6 absent */
static struct plant *partly(void)
{
    struct plant *plant = make_plant("");

    plant_power_on(plant);
    plant_power(plant, 6, false);
    plant_run_ms(plant, 1000);
    ck_assert_int_eq(plant->manager->state, NETWORK_OPERATIONAL);
    return plant;
}

#define OK     CO_OK
#define STATE  CO_ERR_STATE
#define NOT_IN CO_ERR_NOT_FOUND

/* Answers for a command to all, the manager itself, 5, 6, 8, 9, one that is not in the file. */
static const struct answers {
    const char *name;
    struct plant *(*make)(void);
    enum nmt_command command;
    int err[7];
} answers[] = {
    { "start, booting", booting, NMT_START, { STATE, STATE, STATE, STATE, STATE, STATE, NOT_IN } },
    { "stop, booting", booting, NMT_STOP, { STATE, STATE, STATE, OK, OK, OK, NOT_IN } },
    { "start, resetting",
      resetting,
      NMT_START,
      { STATE, STATE, STATE, STATE, STATE, STATE, NOT_IN } },
    { "stop, resetting", resetting, NMT_STOP, { STATE, STATE, STATE, STATE, STATE, OK, NOT_IN } },
    { "reset, resetting", resetting, NMT_RESET_NODE, { OK, OK, STATE, STATE, OK, OK, NOT_IN } },
    { "reset, booting", booting, NMT_RESET_COMMUNICATION, { OK, OK, OK, OK, OK, OK, NOT_IN } },
    { "start, halted", halted, NMT_START, { STATE, STATE, STATE, STATE, STATE, STATE, NOT_IN } },
    { "reset, halted", halted, NMT_RESET_NODE, { OK, OK, OK, OK, OK, OK, NOT_IN } },
    { "start, waiting", waiting, NMT_START, { OK, OK, STATE, STATE, STATE, STATE, NOT_IN } },
    { "stop, waiting", waiting, NMT_STOP, { OK, OK, OK, OK, OK, OK, NOT_IN } },
    { "start, operational", operational, NMT_START, { OK, OK, OK, OK, OK, OK, NOT_IN } },
    { "pre-operational, operational",
      operational,
      NMT_ENTER_PREOPERATIONAL,
      { OK, OK, OK, OK, OK, OK, NOT_IN } },
    { "start, partly", partly, NMT_START, { OK, OK, OK, STATE, OK, OK, NOT_IN } },
    { "stop, partly", partly, NMT_STOP, { OK, OK, OK, STATE, OK, OK, NOT_IN } },
    { "reset, partly", partly, NMT_RESET_NODE, { OK, OK, OK, OK, OK, OK, NOT_IN } },
    { "start, off", off, NMT_START, { STATE, STATE, STATE, STATE, STATE, STATE, NOT_IN } },
    { "reset, off", off, NMT_RESET_NODE, { STATE, STATE, STATE, STATE, STATE, STATE, NOT_IN } },
};

START_TEST(test_answers)
{
    static const uint8_t nodes[] = { ALL, SELF, 5, 6, 8, 9, FOREIGN };
    const struct answers *row = &answers[_i];

    for (size_t i = 0; i < sizeof nodes; i++) {
        struct plant *plant = row->make();
        int err = (int)plant_command(plant, row->command, nodes[i]);

        ck_assert_msg(err == row->err[i], "%s, node %u: %d", row->name, nodes[i], err);
        plant_run_ms(plant, 3000); /* it harms nobody: see the watch */
        plant_free(plant);
    }
}
END_TEST

/* --- what they do --- */

START_TEST(test_own_start)
{
    struct plant *plant = waiting();

    ck_assert_uint_eq(plant_sent(plant, "000#01"), 0);
    ck_assert_int_eq(plant_command(plant, NMT_START, SELF), CO_OK);
    plant_run_ms(plant, 100);
    ck_assert_int_eq(plant->manager->device.state, NMT_OPERATIONAL);
    ck_assert_int_eq(state_of(plant, 5), NMT_OPERATIONAL);
    ck_assert_int_eq(state_of(plant, 6), NMT_OPERATIONAL);
    ck_assert_int_eq(state_of(plant, 8), NMT_PREOPERATIONAL);
    ck_assert_uint_eq(plant_sent(plant, "000#01"), 2);
    ck_assert_int_eq(plant_command(plant, NMT_START, SELF), CO_OK); /* again: nothing new */
    plant_run_ms(plant, 100);
    ck_assert_uint_eq(plant_sent(plant, "000#01"), 2);
    plant_free(plant);
}
END_TEST

/* Out of operation by the application, and back by it alone. */
START_TEST(test_held)
{
    static const enum nmt_command commands[] = { NMT_STOP, NMT_ENTER_PREOPERATIONAL };
    struct plant *plant = operational();

    ck_assert_int_eq(plant_command(plant, commands[_i % 2], _i < 2 ? 5 : ALL), CO_OK);
    plant_run_ms(plant, 2000);
    ck_assert_int_eq(state_of(plant, 5), _i % 2 ? NMT_PREOPERATIONAL : NMT_STOPPED);
    ck_assert_int_eq(plant_node(plant, 5)->nmt_state, state_of(plant, 5));
    ck_assert_int_eq(state_of(plant, 6), _i < 2 ? NMT_OPERATIONAL : state_of(plant, 5));
    ck_assert_int_eq(plant->manager->device.state, NMT_OPERATIONAL);
    ck_assert_uint_eq(plant_sent(plant, "000#01"), 2);
    ck_assert_int_eq(plant_command(plant, NMT_START, _i < 2 ? 5 : ALL), CO_OK);
    plant_run_ms(plant, 10);
    ck_assert_int_eq(state_of(plant, 5), NMT_OPERATIONAL);
    ck_assert_int_eq(state_of(plant, 6), NMT_OPERATIONAL);
    ck_assert_int_eq(plant_node(plant, 5)->nmt_state, NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* A node that is held and restarts is a new node: it is booted and started. */
START_TEST(test_held_restarts)
{
    struct plant *plant = operational();

    ck_assert_int_eq(plant_command(plant, NMT_STOP, 5), CO_OK);
    plant_run_ms(plant, 100);
    plant_power(plant, 5, false);
    plant_power(plant, 5, true);
    plant_run_ms(plant, 1000);
    ck_assert_int_eq(state_of(plant, 5), NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* A broadcast would start node 6 wherever it is in its boot. */
START_TEST(test_start_all_while_one_boots)
{
    struct plant *plant = partly();

    plant->sim.trace_count = 0;
    ck_assert_int_eq(plant_command(plant, NMT_STOP, 5), CO_OK);
    ck_assert_int_eq(plant_command(plant, NMT_START, ALL), CO_OK);
    plant_run_ms(plant, 100);
    ck_assert_uint_eq(plant_sent(plant, "000#0100"), 0);
    ck_assert_uint_eq(plant_sent(plant, "000#0105"), 1);
    ck_assert_int_eq(state_of(plant, 5), NMT_OPERATIONAL);
    plant_power(plant, 6, true);
    plant_run_ms(plant, 1000);
    ck_assert_int_eq(state_of(plant, 6), NMT_OPERATIONAL);
    ck_assert_int_eq(plant_command(plant, NMT_START, ALL), CO_OK);
    plant_run_ms(plant, 100);
    ck_assert_uint_eq(plant_sent(plant, "000#0100"), 1);
    ck_assert_int_eq(state_of(plant, 9), NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* All are stopped while node 6 boots: it cannot go on, is reset, and boots. */
START_TEST(test_stop_all_while_one_boots)
{
    struct plant *plant = partly();

    plant_lie(plant, "606#2F", NULL, 1);
    plant_power(plant, 6, true);
    plant_run_ms(plant, 50);
    ck_assert_int_eq(plant_node(plant, 6)->step, BOOT_CONFIGURE);
    ck_assert_int_eq(plant_command(plant, NMT_STOP, ALL), CO_OK);
    plant_run_ms(plant, 10);
    ck_assert_int_eq(state_of(plant, 6), NMT_STOPPED);
    plant_run_ms(plant, 5000);
    ck_assert_int_eq(state_of(plant, 5), NMT_STOPPED);
    ck_assert(plant_node(plant, 6)->booted);
    ck_assert_uint_eq(od_number(&plant->devices[6]->od, 0x6200, 1, 0), 0x56);
    plant_free(plant);
}
END_TEST

static const struct reset {
    enum nmt_command command;
    uint8_t node;
    const char *frame;
} resets[] = {
    { NMT_RESET_NODE, ALL, "000#8100" },        { NMT_RESET_COMMUNICATION, ALL, "000#8200" },
    { NMT_RESET_NODE, SELF, "000#8100" },       { NMT_RESET_NODE, 5, "000#8105" },
    { NMT_RESET_COMMUNICATION, 5, "000#8205" },
};

START_TEST(test_reset)
{
    const struct reset *reset = &resets[_i];
    bool all = reset->node != 5;
    struct plant *plant = operational();

    plant->sim.trace_count = 0;
    ck_assert_int_eq(plant_command(plant, reset->command, reset->node), CO_OK);
    plant_run_ms(plant, 1);
    ck_assert_int_eq(plant->manager->device.state, all ? NMT_PREOPERATIONAL : NMT_OPERATIONAL);
    plant_run_ms(plant, 1000);
    ck_assert_uint_eq(plant_sent(plant, reset->frame), 1);
    ck_assert_uint_eq(plant_sent(plant, "000#8"), 1);
    ck_assert_uint_eq(plant_sent(plant, "77F#00"), all);
    ck_assert_uint_eq(plant_sent(plant, "605#"), 2);
    ck_assert_uint_eq(plant_sent(plant, "606#"), all ? 2 : 0);
    ck_assert_int_eq(state_of(plant, 5), NMT_OPERATIONAL);
    ck_assert_int_eq(state_of(plant, 6), NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* The manager's own state, and back. */
START_TEST(test_own_stop)
{
    struct plant *plant = operational();

    ck_assert_int_eq(plant_command(plant, _i ? NMT_STOP : NMT_ENTER_PREOPERATIONAL, SELF), CO_OK);
    ck_assert_int_eq(plant->manager->device.state, _i ? NMT_STOPPED : NMT_PREOPERATIONAL);
    ck_assert_int_eq(plant_command(plant, NMT_START, 5), CO_ERR_STATE);
    plant_power(plant, 6, false);
    plant_power(plant, 6, true);
    plant_run_ms(plant, 1000);
    ck_assert_int_eq(state_of(plant, 5), NMT_OPERATIONAL); /* its own state only */
    ck_assert_int_eq(state_of(plant, 6), NMT_PREOPERATIONAL);
    ck_assert_int_eq(plant_command(plant, NMT_START, SELF), CO_OK);
    plant_run_ms(plant, 100);
    ck_assert_int_eq(state_of(plant, 6), NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* --- another master --- */

START_TEST(test_second_master)
{
    struct plant *plant = operational();

    sim_say(&plant->sim, "000#0205");
    sim_say(&plant->sim, "000#8206");
    plant_run_ms(plant, 1000);
    ck_assert(plant_said(plant, "warning: another NMT master is on the bus: it commands \"stop\" "
                                "to node 5"));
    ck_assert(plant_said(plant, "it commands \"reset communication\" to node 6"));
    ck_assert_int_eq(state_of(plant, 5), NMT_STOPPED);
    ck_assert_int_eq(plant_node(plant, 5)->nmt_state, NMT_STOPPED);
    ck_assert_int_eq(state_of(plant, 6), NMT_OPERATIONAL); /* it has restarted: booted anew */
    ck_assert_int_eq(plant_command(plant, NMT_START, 5), CO_OK);
    plant_run_ms(plant, 10);
    ck_assert_int_eq(state_of(plant, 5), NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* It does not command this one: nobody else can tell what the network's boot has come to. */
START_TEST(test_second_master_commands_all)
{
    struct plant *plant = operational();

    sim_say(&plant->sim, "000#0200");
    plant_run_ms(plant, 10);
    ck_assert(plant_said(plant, "it commands \"stop\" to all nodes"));
    ck_assert_int_eq(plant->manager->device.state, NMT_OPERATIONAL);
    sim_say(&plant->sim, "000#8100");
    plant_run_ms(plant, 1000);
    ck_assert_int_eq(plant->manager->device.state, NMT_OPERATIONAL);
    ck_assert_int_eq(state_of(plant, 5), NMT_OPERATIONAL);
    ck_assert_int_eq(state_of(plant, 6), NMT_OPERATIONAL);
    sim_say(&plant->sim, "000#7700"); /* no command that exists */
    sim_say(&plant->sim, "000#01");
    sim_say(&plant->sim, "000#010500");
    plant_run_ms(plant, 10);
    ck_assert_uint_eq(plant_said_times(plant, "another NMT master"), 2);
    plant_free(plant);
}
END_TEST

/* Error control of the manager's own node-ID, from somebody else: told ever more rarely. */
START_TEST(test_node_id_taken)
{
    struct plant *plant = operational();

    ck_assert(!plant_said(plant, "this node-ID")); /* the manager's own boot-up is no news */
    sim_say(&plant->sim, "77F#00");
    plant_run_ms(plant, 10);
    ck_assert(plant_said(plant, "warning: node 127 (manager): another device has this node-ID: it "
                                "sends a boot-up message"));
    ck_assert(!plant_said(plant, "not configured"));
    for (unsigned i = 0; i < 9; i++) {
        sim_say(&plant->sim, "77F#05");
        plant_run_ms(plant, 10);
    }
    ck_assert(plant_said(plant, "another device has this node-ID: it says that it is operational"));
    ck_assert_uint_eq(plant_said_times(plant, "this node-ID"), 4); /* 1st, 2nd, 4th, 8th */
    sim_say(&plant->sim, "77F#R");
    plant_run_ms(plant, 10);
    ck_assert_uint_eq(plant_said_times(plant, "this node-ID"), 4);
    ck_assert_int_eq(plant->manager->device.state, NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* --- a start that overtakes the news of a restart --- */

/*
 * Node 7 is absent; when that is clear, all is started. Just before that node 5 restarts: its
 * boot-up message is on the wire when the start command is put behind it.
 */
START_TEST(test_start_overtakes)
{
    struct plant *plant = plant_new(PLANT_NODE(5, "") PLANT_NODE(7, ""), 1000000);
    co_us_t start = 0;

    plant_add_object(plant_add_device(plant, 5), 0x6200, 1, 1, 0);
    plant_configure(plant, 5, 0x6200, 1, 1, 0x55);
    plant_power_on(plant);
    while (plant_sent(plant, "607#8000") < 2)
        plant_run_ms(plant, 1);
    start = plant_node(plant, 7)->config->sdo_timeout;
    for (size_t i = 0; i < plant->sim.trace_count; i++)
        if (plant->sim.trace[i].frame.id == 0x607)
            start = plant->sim.trace[i].time + CO_MS(200); /* the last request's time-out */
    sim_run(&plant->sim, start - 30);
    slave_command(&plant->devices[5]->slave, NMT_RESET_NODE, plant->sim.now,
                  &plant->devices[5]->sim->box);
    plant_run_ms(plant, 1);
    ck_assert_uint_eq(plant_sent(plant, "000#0105"), 1);
    ck_assert_int_ne(state_of(plant, 5), NMT_OPERATIONAL); /* not for long */
    plant_run_ms(plant, 1000);
    watch_expect_up(plant, "is not up");
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 1);
    ck_assert_uint_eq(plant_sent(plant, "000#0105"), 2);
    plant_free(plant);
}
END_TEST

/* Before it was operational the manager may go anywhere but there: nobody is started by that. */
START_TEST(test_own_commands_while_it_waits)
{
    static const enum nmt_command commands[] = { NMT_ENTER_PREOPERATIONAL, NMT_STOP };
    struct plant *plant = waiting();

    ck_assert_int_eq(plant_command(plant, commands[_i], SELF), CO_OK);
    plant_run_ms(plant, 1000);
    ck_assert_int_eq(plant->manager->device.state, _i ? NMT_STOPPED : NMT_PREOPERATIONAL);
    ck_assert_uint_eq(plant_sent(plant, "000#01"), 0);
    ck_assert_int_eq(plant_command(plant, NMT_START, SELF), CO_OK);
    plant_run_ms(plant, 100);
    ck_assert_int_eq(state_of(plant, 5), NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* The first and the last node-ID are nodes like others, where they are not the manager's. */
START_TEST(test_first_and_last_node)
{
    struct plant *plant = plant_new(
        "<Manager_Node_Id>2</Manager_Node_Id>" PLANT_NODE(1, "") PLANT_NODE(127, ""), 1000000);

    plant_add_device(plant, 1);
    plant_add_device(plant, 127);
    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    for (unsigned i = 0; i < 2; i++) {
        const uint8_t node = i ? 127 : 1;

        ck_assert_int_eq(state_of(plant, node), NMT_OPERATIONAL);
        ck_assert_int_eq(plant_command(plant, NMT_STOP, node), CO_OK);
        plant_run_ms(plant, 10);
        ck_assert_int_eq(state_of(plant, node), NMT_STOPPED);
    }
    ck_assert_int_eq(plant_command(plant, NMT_STOP, 128), CO_ERR_NOT_FOUND);
    plant_free(plant);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("commands");

    tcase_add_loop_test(tcase, test_answers, 0, sizeof answers / sizeof answers[0]);
    tcase_add_test(tcase, test_own_start);
    tcase_add_loop_test(tcase, test_held, 0, 4);
    tcase_add_test(tcase, test_held_restarts);
    tcase_add_test(tcase, test_start_all_while_one_boots);
    tcase_add_test(tcase, test_stop_all_while_one_boots);
    tcase_add_loop_test(tcase, test_reset, 0, sizeof resets / sizeof resets[0]);
    tcase_add_loop_test(tcase, test_own_stop, 0, 2);
    tcase_add_test(tcase, test_second_master);
    tcase_add_test(tcase, test_second_master_commands_all);
    tcase_add_test(tcase, test_node_id_taken);
    tcase_add_test(tcase, test_start_overtakes);
    tcase_add_loop_test(tcase, test_own_commands_while_it_waits, 0, 2);
    tcase_add_test(tcase, test_first_and_last_node);
    return suite_run("commands", tcase);
}
