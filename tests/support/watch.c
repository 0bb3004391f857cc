#include "support/watch.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LAST_FRAMES 30u
#define LAST_EVENTS 3000u /* characters */

static char *last_frames(const struct plant *plant)
{
    struct sim part = plant->sim;

    if (part.trace_count > LAST_FRAMES) {
        part.trace += part.trace_count - LAST_FRAMES;
        part.trace_count = LAST_FRAMES;
    }
    return sim_trace_text(&part);
}

static const char *last_events(const struct plant *plant)
{
    size_t size = strlen(plant->events);

    return plant->events + (size > LAST_EVENTS ? size - LAST_EVENTS : 0);
}

static void save_events(const struct plant *plant)
{
    const char *name = getenv("SCENARIO_LOG");
    FILE *file = name ? fopen(name, "a") : NULL;

    if (!file)
        return;
    fprintf(file, "%s", plant->events);
    fclose(file);
}

void watch_check(const struct plant *plant, bool ok, uint8_t node, const char *what)
{
    char *text;

    if (ok)
        return;
    if (plant->sim.log)
        fflush(plant->sim.log);
    save_events(plant);
    text = last_frames(plant);
    fprintf(stderr, "%s%s", text, last_events(plant)); /* too much for a message of Check */
    free(text);
    ck_abort_msg("%s: node %u: %s", plant->name, node, what);
}

static bool is_equal(const struct od_entry *entry, const struct ccf_entry *wanted)
{
    return entry && entry->size == wanted->size &&
           (wanted->size == 0 || memcmp(entry->value, wanted->value, wanted->size) == 0);
}

bool watch_is_configured(const struct plant *plant, uint8_t node)
{
    const struct node_config *config = network_config_node(plant->config, node);
    struct ccf_reader reader;
    struct ccf_entry entry;

    ccf_reader_init(&reader, &config->ccf);
    while (ccf_read(&reader, &entry))
        if (!is_equal(od_find(&plant->devices[node]->od, entry.index, entry.sub), &entry))
            return false;
    return true;
}

/* The device has begun another life that nobody can know of yet. */
static bool is_boot_up_under_way(const struct plant *plant, uint8_t node)
{
    const struct co_outbox *box = &plant->devices[node]->sim->box;

    if (plant->devices[node]->slave.boot_up_due || plant->devices[node]->reborn)
        return true;
    for (unsigned i = 0; i < box->frame_count; i++) {
        const struct co_frame *frame = &box->frames[(box->frame_first + i) % box->frame_capacity];

        if (frame->id == NMT_ERROR_CONTROL_ID + node && frame->data[0] == NMT_INITIALISING)
            return true;
    }
    return false;
}

static void check_start_of(const struct plant *plant, const struct node_config *config)
{
    struct plant_device *device = plant->devices[config->node_id];
    bool overtaken;

    if (!device || !device->sim->active || !config->nmt_slave || !config->auto_start_slave ||
        is_boot_up_under_way(plant, config->node_id))
        return;
    if (watch_is_configured(plant, config->node_id))
        return;
    overtaken = boot_node_is_in_mid_boot(&plant->manager->nodes[config->node_id]);
    watch_check(plant, overtaken && !device->overtaken, config->node_id,
                "started without its configuration");
    device->overtaken = true; /* once: a reset has to follow */
}

/* What was put on its way while it was operational may get on the wire later. */
static bool may_start(const struct plant *plant)
{
    bool was_operational = plant->manager->state == NETWORK_RESETTING ||
                           plant->manager->state == NETWORK_STOPPED ||
                           (plant->manager->state == NETWORK_WAITING &&
                            plant->config->auto_operational);

    return plant->manager->device.state == NMT_OPERATIONAL || was_operational;
}

static void check_start(const struct plant *plant, uint8_t target)
{
    watch_check(plant, may_start(plant), target, "started before the manager is operational");
    for (size_t i = 0; i < plant->config->node_count; i++)
        if (target == 0 || target == plant->config->nodes[i].node_id)
            check_start_of(plant, &plant->config->nodes[i]);
}

/* The table of CiA 301, 7.3.2; a reset ends in PRE-OPERATIONAL with the boot-up message. */
static uint8_t state_after(uint8_t state, uint8_t command)
{
    if (command == NMT_RESET_NODE || command == NMT_RESET_COMMUNICATION ||
        state == NMT_INITIALISING)
        return NMT_INITIALISING;
    return command == NMT_START  ? NMT_OPERATIONAL
           : command == NMT_STOP ? NMT_STOPPED
                                 : NMT_PREOPERATIONAL;
}

static void on_command(struct plant_device *device, uint8_t node, const struct co_frame *frame)
{
    enum nmt_command command;

    if (!device->sim->active || device->sim->unplugged || !nmt_command_for(frame, node, &command))
        return;
    device->nmt_state = state_after(device->nmt_state, (uint8_t)command);
    if (device->nmt_state == NMT_INITIALISING)
        device->overtaken = false;
}

static void on_delivered(struct plant *plant, const struct co_frame *frame, uint8_t sender)
{
    if (frame->id != NMT_CAN_ID)
        return;
    if (sender == plant->config->manager_node_id && frame->data[0] == NMT_START)
        check_start(plant, frame->data[1]);
    for (uint8_t id = 1; id <= NETWORK_NODE_MAX; id++)
        if (plant->devices[id])
            on_command(plant->devices[id], id, frame);
}

/* CiA 302-2: without a master's command after its boot-up, where its own 1F80h says so. */
static bool starts_itself(const struct plant_device *device, const struct co_event *event)
{
    return event->detail == NMT_OPERATIONAL && device->nmt_state == NMT_PREOPERATIONAL &&
           (od_number(&device->od, 0x1F80, 0, 4) & 5) == 0;
}

static void on_slave_event(void *context, const struct co_event *event)
{
    struct plant *plant = context;
    struct plant_device *device = plant->devices[event->node];
    bool boots = device && event->detail == NMT_PREOPERATIONAL &&
                 device->nmt_state == NMT_INITIALISING;

    if (!device || event->type != SLAVE_STATE || plant->on_delivered != on_delivered)
        return;
    if (event->detail == NMT_INITIALISING || boots || starts_itself(device, event)) {
        device->nmt_state = event->detail;
        device->resets += event->detail == NMT_INITIALISING;
    }
    if (device->nmt_state != event->detail)
        watch_check(plant, false, event->node, "is in a state that nobody has brought it into");
}

/* Not where the application, or another tool, has ordered it. */
static bool becomes_operational_by_itself(const struct plant *plant, const struct co_event *event)
{
    return event->type == MANAGER_STATE && event->detail == NMT_OPERATIONAL &&
           (plant->network_state == NETWORK_BOOTING || plant->network_state == NETWORK_HALTED);
}

static void on_manager_event(struct plant *plant, const struct co_event *event)
{
    if (!becomes_operational_by_itself(plant, event))
        return;
    for (size_t i = 0; i < plant->config->node_count; i++) {
        const struct node_config *config = &plant->config->nodes[i];
        const struct boot_node *node = &plant->manager->nodes[config->node_id];

        watch_check(plant, !config->nmt_slave || !config->mandatory || node->booted,
                    config->node_id, "mandatory, not booted, and the manager is operational");
        watch_check(plant, !config->nmt_slave || node->tried, config->node_id,
                    "not tried, and the manager is operational");
    }
}

void watch_start(struct plant *plant)
{
    plant->on_delivered = on_delivered;
    plant->watch_event = on_manager_event;
    plant->sim.on_slave_event = on_slave_event;
    for (uint8_t id = 1; id <= NETWORK_NODE_MAX; id++)
        if (plant->devices[id])
            plant->devices[id]->nmt_state = plant->devices[id]->slave.state;
}

static void expect(const struct plant *plant, bool ok, uint8_t node, const char *what,
                   const char *state)
{
    char text[80];

    snprintf(text, sizeof text, "%s: not %s", what, state);
    watch_check(plant, ok, node, text);
}

void watch_expect_up(const struct plant *plant, const char *what)
{
    for (size_t i = 0; i < plant->config->node_count; i++) {
        const uint8_t id = plant->config->nodes[i].node_id;
        const struct plant_device *device = plant->devices[id];

        if (!device || !device->sim->active)
            continue;
        expect(plant, plant->manager->nodes[id].booted, id, what, "booted");
        expect(plant, watch_is_configured(plant, id), id, what, "configured");
        expect(plant, device->slave.state == NMT_OPERATIONAL, id, what, "operational");
    }
    expect(plant, plant->manager->state == NETWORK_OPERATIONAL, 0, what, "operational");
}

struct plant *watch_two(const char *xml)
{
    struct plant *plant = plant_new(xml, 1000000);

    for (uint8_t node = 5; node <= 6; node++) {
        struct plant_device *device = plant_add_device(plant, node);

        for (uint8_t sub = 1; sub <= WATCH_ENTRIES; sub++) {
            plant_add_object(device, 0x6200, sub, 1, 0);
            plant_configure(plant, node, 0x6200, sub, 1, 0x50u + sub);
        }
    }
    watch_start(plant);
    return plant;
}
