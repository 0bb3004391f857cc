#include "support/watch.h"

#include "base/bytes.h"

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

/* All of it, where SCENARIO_TRACE names a file. */
static void save_trace(const struct plant *plant)
{
    const char *name = getenv("SCENARIO_TRACE");
    FILE *file = name ? fopen(name, "w") : NULL;
    char *text;

    if (!file)
        return;
    text = sim_trace_text(&plant->sim);
    fprintf(file, "%s\n%s", text, plant->events);
    free(text);
    fclose(file);
}

static void check(const struct plant *plant, bool ok, uint8_t node, const char *what)
{
    char *text;

    if (ok)
        return;
    save_trace(plant);
    text = last_frames(plant);
    ck_abort_msg("%s: node %u: %s\n%s%s", plant->name, node, what, text, last_events(plant));
    free(text);
}

bool watch_is_configured(const struct plant *plant, uint8_t node)
{
    const struct node_config *config = network_config_node(plant->config, node);
    struct ccf_reader reader;
    struct ccf_entry entry;

    ccf_reader_init(&reader, &config->ccf);
    while (ccf_read(&reader, &entry))
        if (od_number(&plant->devices[node]->od, entry.index, entry.sub, 0) !=
            get_le(entry.value, entry.size < 8 ? entry.size : 8))
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
    check(plant, overtaken && !device->overtaken, config->node_id,
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
    check(plant, may_start(plant), target, "started before the manager is operational");
    for (size_t i = 0; i < plant->config->node_count; i++)
        if (target == 0 || target == plant->config->nodes[i].node_id)
            check_start_of(plant, &plant->config->nodes[i]);
}

static void on_delivered(struct plant *plant, const struct co_frame *frame, uint8_t sender)
{
    enum nmt_command command;

    if (sender == plant->config->manager_node_id && frame->id == NMT_CAN_ID &&
        frame->data[0] == NMT_START)
        check_start(plant, frame->data[1]);
    for (unsigned id = 1; frame->id == NMT_CAN_ID && id <= NETWORK_NODE_MAX; id++)
        if (plant->devices[id] && nmt_command_for(frame, (uint8_t)id, &command) &&
            (command == NMT_RESET_NODE || command == NMT_RESET_COMMUNICATION))
            plant->devices[id]->overtaken = false;
}

void watch_start(struct plant *plant)
{
    plant->on_delivered = on_delivered;
}

static void expect(const struct plant *plant, bool ok, uint8_t node, const char *what,
                   const char *state)
{
    char text[80];

    snprintf(text, sizeof text, "%s: not %s", what, state);
    check(plant, ok, node, text);
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
