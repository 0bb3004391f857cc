#include "support/tool.h"

#include "support/watch.h"

#include "base/bytes.h"
#include "proto/event.h"

#include <check.h>

static struct {
    struct sdo_client client;
    void (*next)(struct plant *plant, const struct co_frame *frame, uint8_t sender);
    struct co_outbox out;
    struct co_frame frames[160];
    struct co_event events[4];
} tool;

static void on_delivered(struct plant *plant, const struct co_frame *frame, uint8_t sender)
{
    struct co_frame heard = *frame;

    if (tool.next)
        tool.next(plant, frame, sender);
    if (frame->id == SDO_REQUEST_ID + TOOL_MANAGER)
        heard.flags |= CO_FRAME_OWN;
    sdo_client_on_frame(&tool.client, &heard, plant->sim.now, &tool.out);
}

void tool_attach(struct plant *plant)
{
    sdo_client_init(&tool.client, TOOL_MANAGER);
    co_outbox_init(&tool.out, tool.frames, 160, tool.events, 4);
    tool.next = plant->on_delivered;
    plant->on_delivered = on_delivered;
}

static void say_all(struct plant *plant)
{
    struct co_frame frame;
    char text[CO_FRAME_TEXT_SIZE];

    while (co_outbox_take_frame(&tool.out, &frame)) {
        co_frame_format(&frame, text, sizeof text);
        sim_say(&plant->sim, text);
    }
}

/* The abort code, 0 or TOOL_SILENCE, and the bytes that were transferred. */
static uint32_t run(struct plant *plant, const struct sdo_transfer *transfer, uint32_t *ret_size)
{
    struct co_event done = { .type = 0 };

    sdo_client_start(&tool.client, transfer, plant->sim.now, &tool.out);
    while (!co_outbox_take_event(&tool.out, &done)) {
        say_all(plant);
        sim_run(&plant->sim, plant->sim.now + 100);
        sdo_client_on_time(&tool.client, plant->sim.now, &tool.out);
    }
    say_all(plant);
    *ret_size = (uint32_t)done.actual;
    if (done.detail == SDO_OUTCOME_OK)
        return 0;
    return done.detail == SDO_OUTCOME_ABORTED ? done.code : TOOL_SILENCE;
}

uint32_t tool_write(struct plant *plant, uint16_t index, uint8_t sub, const void *bytes,
                    uint32_t size)
{
    const struct sdo_transfer transfer = { .download = true,
                                           .indicate_size = true,
                                           .index = index,
                                           .sub = sub,
                                           .source = bytes,
                                           .size = size,
                                           .timeout = CO_MS(2000) };
    uint32_t written;

    return run(plant, &transfer, &written);
}

uint32_t tool_put(struct plant *plant, uint16_t index, uint8_t sub, uint8_t size, uint32_t value)
{
    uint8_t bytes[4];

    put_le(bytes, size, value);
    return tool_write(plant, index, sub, bytes, size);
}

uint32_t tool_read(struct plant *plant, uint16_t index, uint8_t sub, void *bytes, uint32_t *size)
{
    const struct sdo_transfer transfer = {
        .index = index, .sub = sub, .buffer = bytes, .size = *size, .timeout = CO_MS(2000)
    };

    return run(plant, &transfer, size);
}

uint32_t tool_get(struct plant *plant, uint16_t index, uint8_t sub)
{
    uint8_t bytes[4] = { 0 };
    uint32_t size = sizeof bytes;
    uint32_t code = tool_read(plant, index, sub, bytes, &size);

    ck_assert_msg(code == 0, "%04Xh:%02X: abort %08Xh", index, sub, code);
    return (uint32_t)get_le(bytes, size);
}

void tool_set(struct plant *plant, uint16_t index, uint8_t sub, uint32_t value)
{
    ck_assert_uint_eq(tool_put(plant, index, sub, 4, value), 0);
    plant_run_ms(plant, 2);
}

void tool_boot_all(struct plant *plant)
{
    ck_assert_uint_eq(tool_put(plant, 0x1F82, 0x80, 1, 7), 0);
    plant_run_ms(plant, 1000);
}

void tool_expect_state(const struct plant *plant, uint8_t node, int state)
{
    const int is = plant->devices[node]->slave.state;

    ck_assert_msg(is == state, "node %u is %d, not %d", node, is, state);
}

void tool_expect_value(const struct plant *plant, uint8_t node, uint16_t index, uint64_t value)
{
    ck_assert_uint_eq(od_number(&plant->devices[node]->od, index, 1, 0xDEAD), value);
}

/* --- a plant for it --- */

const uint8_t tool_concise[12] = { 1, 0, 0, 0, 0x00, 0x62, 1, 1, 0, 0, 0, 0x55 };
const uint8_t tool_concise_more[20] = { 2, 0,    0, 0,    0x00, 0x62, 1, 1, 0, 0,
                                        0, 0x66, 1, 0x62, 1,    1,    0, 0, 0, 0x77 };

struct plant *tool_plant(const char *xml)
{
    struct plant *plant = plant_new(xml, 1000000);

    for (uint8_t node = 5; node <= 7; node++) {
        struct plant_device *device = plant_add_device(plant, node);

        plant_add_object(device, 0x6200, 1, 1, 0);
        plant_add_object(device, 0x6201, 1, 1, 0);
    }
    watch_start(plant);
    tool_attach(plant);
    plant_power_on(plant);
    return plant;
}

struct plant *tool_plant_run(const char *xml)
{
    struct plant *plant = tool_plant(xml);

    plant_run_ms(plant, 1000);
    return plant;
}

uint32_t tool_put_concise(struct plant *plant, uint8_t node, const uint8_t *bytes, uint32_t size)
{
    const uint32_t code = tool_write(plant, 0x1F22, node, bytes, size);

    plant_run_ms(plant, 2); /* what follows from it is behind the answer */
    return code;
}
