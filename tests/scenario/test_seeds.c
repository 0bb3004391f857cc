/*
 * Networks made from a seed, with faults from the same seed: lost frames, slow devices, resets,
 * power cycles, cables, orders and requests of the application, outboxes with hardly any room. The
 * watch looks at each start command; in the end, when the faults have stopped, all must be up.
 *
 *   SCENARIO_SEEDS=1000  tries that many seeds, SCENARIO_FIRST_SEED=4711 from this one on
 */
#include "support/suite.h"
#include "support/watch.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SEEDS            150
#define NODES_MAX        20u
#define FAULTY_MS        15000u
#define STEP_MS          5u
#define REQUESTS         6u
#define ONE_IN(chaos, n) (random_below(chaos, n) == 0)

struct chaos {
    struct plant *plant;
    uint64_t random;
    unsigned node_count;
    bool faulty;
    unsigned loss;               /* one frame in so many is lost */
    bool beats[NODES_MAX + 1];   /* has a heartbeat, so that losses are noticed */
    co_us_t back[NODES_MAX + 1]; /* when it is switched on, or plugged in, again; 0: it is */
    struct sdo_request requests[REQUESTS];
    uint8_t targets[REQUESTS];
    uint8_t buffers[REQUESTS][8];
    unsigned submitted, cancelled, done;
};

/* xorshift64*, good enough and the same everywhere */
static unsigned random_below(struct chaos *chaos, unsigned limit)
{
    chaos->random ^= chaos->random >> 12;
    chaos->random ^= chaos->random << 25;
    chaos->random ^= chaos->random >> 27;
    return (unsigned)((chaos->random * 0x2545F4914F6CDD1Du) >> 33) % limit;
}

/* --- a network --- */

static void add_node_xml(struct chaos *chaos, FILE *xml, unsigned id)
{
    static const char *const flags[] = { "NMT_Mandatory_Slave", "NMT_Reset_Node",
                                         "Verify_Configuration" };

    fprintf(xml, "<Node_Instance><Node_Id>%u</Node_Id>", id);
    for (size_t i = 0; i < sizeof flags / sizeof flags[0]; i++)
        if (ONE_IN(chaos, 3))
            fprintf(xml, "<%s>TRUE</%s>", flags[i], flags[i]);
    if (ONE_IN(chaos, 2))
        fprintf(xml,
                "<Vendor_Identification>0x29A</Vendor_Identification>"
                "<Serial_Number>%u</Serial_Number>",
                id);
    chaos->beats[id] = !ONE_IN(chaos, 4);
    if (chaos->beats[id])
        fprintf(xml, "<Consumer_Heartbeat_Time>900</Consumer_Heartbeat_Time>");
    else if (ONE_IN(chaos, 2))
        fprintf(xml, "<Guard_Time>200</Guard_Time><Life_Time_Factor>4</Life_Time_Factor>");
    if (ONE_IN(chaos, 4))
        fprintf(xml, "<Boot_Delay>%u</Boot_Delay>", random_below(chaos, 500));
    fprintf(xml, "</Node_Instance>");
}

static char *make_xml(struct chaos *chaos)
{
    static const char *const flags[] = { "NMT_Start_All", "NMT_Reset_All" };
    static const char *const actions[] = { "RESET_SLAVE", "RESET_ALL", "STOP_ALL" };
    char *text = NULL;
    size_t size = 0;
    FILE *xml = open_memstream(&text, &size);

    ck_assert_ptr_nonnull(xml);
    for (size_t i = 0; i < sizeof flags / sizeof flags[0]; i++)
        if (ONE_IN(chaos, 2))
            fprintf(xml, "<%s>TRUE</%s>", flags[i], flags[i]);
    fprintf(xml, "<NMT_Action_On_Error>%s</NMT_Action_On_Error>", actions[random_below(chaos, 3)]);
    if (ONE_IN(chaos, 2))
        fprintf(xml, "<Boot_Time>%u</Boot_Time>", 100 + random_below(chaos, 4000));
    for (unsigned id = 1; id <= chaos->node_count; id++)
        add_node_xml(chaos, xml, id);
    fclose(xml);
    return text;
}

static void add_device(struct chaos *chaos, uint8_t id)
{
    struct plant_device *device = plant_add_device(chaos->plant, id);
    uint8_t entries = (uint8_t)random_below(chaos, 8);

    for (uint8_t i = 1; i <= entries; i++) {
        plant_add_object(device, 0x6200, i, 4, 0);
        plant_configure(chaos->plant, id, 0x6200, i, 4, random_below(chaos, 1000000) + 1);
    }
    if (chaos->beats[id])
        plant_configure(chaos->plant, id, 0x1017, 0, 2, 300);
}

/* --- what the bus does --- */

static bool is_of(const struct co_frame *frame, uint32_t base, uint8_t *ret_node)
{
    *ret_node = (uint8_t)(frame->id - base);
    return frame->id > base && frame->id <= base + NODES_MAX;
}

/* What nobody could notice is not lost: CAN repeats what was not heard. */
static bool may_be_lost(const struct chaos *chaos, const struct co_frame *frame)
{
    uint8_t node;

    if (frame->id == NMT_CAN_ID)
        return false;
    if (is_of(frame, NMT_ERROR_CONTROL_ID, &node)) /* nor a restart between two writes */
        return chaos->beats[node] && !boot_node_is_in_mid_boot(plant_node(chaos->plant, node));
    return true;
}

static enum sim_fate on_frame(struct plant *plant, const struct co_frame *frame, uint8_t sender)
{
    struct chaos *chaos = plant->fault_context;

    if (!chaos->faulty)
        return SIM_DELIVER;
    if (plant->devices[sender] && ONE_IN(chaos, 200))
        plant->devices[sender]->sim->hold_until = plant->sim.now + CO_MS(random_below(chaos, 400));
    if (!may_be_lost(chaos, frame) || !ONE_IN(chaos, chaos->loss))
        return SIM_DELIVER;
    return ONE_IN(chaos, 2) ? SIM_LOSE : SIM_UNHEARD;
}

/* --- what happens to devices --- */

static void strike(struct chaos *chaos, uint8_t id)
{
    struct plant_device *device = chaos->plant->devices[id];
    co_us_t back = chaos->plant->sim.now + CO_MS(random_below(chaos, 3000));

    switch (random_below(chaos, 4)) {
    case 0:
        sim_power(&chaos->plant->sim, device->sim, false);
        chaos->back[id] = back;
        break;
    case 1:
        device->sim->unplugged = chaos->beats[id];
        chaos->back[id] = back;
        break;
    case 2:
        slave_command(&device->slave, NMT_RESET_COMMUNICATION, chaos->plant->sim.now,
                      &device->sim->box);
        break;
    default:
        slave_command(&device->slave, NMT_RESET_NODE, chaos->plant->sim.now, &device->sim->box);
        break;
    }
}

static void bring_back(struct chaos *chaos, uint8_t id)
{
    struct plant_device *device = chaos->plant->devices[id];

    chaos->back[id] = 0;
    device->sim->unplugged = false;
    device->sim->hold_until = 0;
    if (!device->sim->active)
        sim_power(&chaos->plant->sim, device->sim, true);
}

static void trouble_devices(struct chaos *chaos)
{
    for (uint8_t id = 1; id <= chaos->node_count; id++) {
        bool well = chaos->back[id] == 0;

        if (!well && (!chaos->faulty || chaos->back[id] <= chaos->plant->sim.now))
            bring_back(chaos, id);
        else if (well && chaos->faulty && ONE_IN(chaos, 1200) &&
                 co_outbox_room(&chaos->plant->devices[id]->sim->box, 2, 4))
            strike(chaos, id);
    }
}

/* --- what the application does --- */

static void on_request_done(struct plant *plant, const struct co_event *event)
{
    struct chaos *chaos = plant->fault_context;

    if (event->type == MANAGER_REQUEST_DONE)
        chaos->done++;
}

static void submit(struct chaos *chaos, unsigned i)
{
    const uint8_t target = (uint8_t)(1 + random_below(chaos, chaos->node_count + 1));

    chaos->requests[i].transfer = (struct sdo_transfer){
        .index = 0x1018, .sub = 1, .buffer = chaos->buffers[i], .size = 8, .timeout = CO_MS(100)
    };
    chaos->targets[i] = target;
    chaos->submitted++;
    manager_submit(chaos->plant->manager, target, &chaos->requests[i], chaos->plant->sim.now,
                   &chaos->plant->manager_device->box);
}

static void cancel(struct chaos *chaos, unsigned i)
{
    uint8_t state = chaos->requests[i].state;

    chaos->cancelled += state == REQUEST_QUEUED || state == REQUEST_RUNNING;
    manager_cancel(chaos->plant->manager, chaos->targets[i], &chaos->requests[i],
                   chaos->plant->sim.now, &chaos->plant->manager_device->box);
}

static void trouble_manager(struct chaos *chaos)
{
    static const enum nmt_command commands[] = { NMT_START, NMT_STOP, NMT_ENTER_PREOPERATIONAL,
                                                 NMT_RESET_NODE, NMT_RESET_COMMUNICATION };
    unsigned i = random_below(chaos, REQUESTS);
    uint8_t state = chaos->requests[i].state;

    if (!chaos->faulty)
        return;
    if ((state == REQUEST_IDLE || state == REQUEST_DONE) && ONE_IN(chaos, 4))
        submit(chaos, i);
    else if (ONE_IN(chaos, 20))
        cancel(chaos, i);
    if (ONE_IN(chaos, 500))
        plant_command(chaos->plant, commands[random_below(chaos, 5)],
                      (uint8_t)random_below(chaos, chaos->node_count + 1));
}

/* --- a run --- */

static struct plant *make_plant(struct chaos *chaos, unsigned seed)
{
    static const unsigned bitrates[] = { 1000000, 125000, 0 }, boxes[] = { SIM_BOX, 4, 7 };
    char *xml;

    chaos->random = 0x9E3779B97F4A7C15u * (seed + 1u);
    chaos->node_count = 1 + random_below(chaos, NODES_MAX);
    chaos->loss = 20 + random_below(chaos, 400);
    xml = make_xml(chaos);
    chaos->plant = plant_new(xml, bitrates[random_below(chaos, 3)]);
    snprintf(chaos->plant->name, sizeof chaos->plant->name, "seed %u", seed);
    chaos->plant->sim.box_size = boxes[random_below(chaos, 3)];
    free(xml);
    for (uint8_t id = 1; id <= chaos->node_count; id++)
        add_device(chaos, id);
    chaos->plant->fault = on_frame;
    chaos->plant->fault_context = chaos;
    chaos->plant->on_event = on_request_done;
    watch_start(chaos->plant);
    plant_power_on(chaos->plant);
    return chaos->plant;
}

static void run_ms(struct chaos *chaos, unsigned ms)
{
    for (unsigned i = 0; i < ms / STEP_MS; i++) {
        trouble_devices(chaos);
        trouble_manager(chaos);
        plant_run_ms(chaos->plant, STEP_MS);
    }
}

/* What the application has stopped only it starts again. */
static void start_what_was_stopped(struct chaos *chaos)
{
    plant_command(chaos->plant, NMT_START, chaos->plant->config->manager_node_id);
    run_ms(chaos, 5000);
    for (uint8_t id = 1; id <= chaos->node_count; id++)
        plant_command(chaos->plant, NMT_START, id);
    run_ms(chaos, 1000);
}

START_TEST(test_seed)
{
    struct chaos *chaos = calloc(1, sizeof *chaos);
    struct plant *plant;

    ck_assert_ptr_nonnull(chaos);
    plant = make_plant(chaos, (unsigned)_i);
    chaos->faulty = true;
    run_ms(chaos, FAULTY_MS);
    chaos->faulty = false;
    run_ms(chaos, 20000);
    start_what_was_stopped(chaos);
    watch_expect_up(plant, "is not up");
    ck_assert_uint_eq(chaos->submitted, chaos->done + chaos->cancelled);
    ck_assert_uint_gt(chaos->done, 0);
    ck_assert_uint_eq(plant->manager->dropped, 0);
    plant_free(plant);
    free(chaos);
}
END_TEST

static int number_from(const char *variable, int preset)
{
    const char *text = getenv(variable);

    return text ? (int)strtol(text, NULL, 10) : preset;
}

int main(void)
{
    TCase *tcase = tcase_create("seeds");
    int first = number_from("SCENARIO_FIRST_SEED", 0);

    tcase_set_timeout(tcase, 60);
    tcase_add_loop_test(tcase, test_seed, first, first + number_from("SCENARIO_SEEDS", SEEDS));
    return suite_run("seeds", tcase);
}
