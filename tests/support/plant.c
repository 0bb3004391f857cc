#include "support/plant.h"

#include "support/guarded.h"

#include "base/bytes.h"
#include "manager/boot_text.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void on_event(void *context, const struct co_event *event)
{
    struct plant *self = context;
    char text[BOOT_TEXT_SIZE];
    enum co_severity severity;
    int length;

    if (self->watch_event)
        self->watch_event(self, event);
    if (self->on_event)
        self->on_event(self, event);
    if (!boot_text_event(self->config, event, &severity, text, sizeof text))
        return;
    length = snprintf(self->events + self->events_size, PLANT_TEXT_SIZE - self->events_size,
                      "%u %s: %s\n", (unsigned)(self->sim.now / 1000u - 1000u),
                      co_severity_text(severity), text);
    if (length > 0 && (size_t)length < PLANT_TEXT_SIZE - self->events_size)
        self->events_size += (size_t)length;
}

static bool begins_like(const struct co_frame *frame, const char *beginning)
{
    char text[CO_FRAME_TEXT_SIZE];

    co_frame_format(frame, text, sizeof text);
    return strncmp(text, beginning, strlen(beginning)) == 0;
}

static bool tell_lie(struct plant *self, const struct co_frame *frame)
{
    for (unsigned i = 0; i < self->lie_count; i++) {
        struct plant_lie *lie = &self->lies[i];

        if (lie->times == 0 || !begins_like(frame, lie->request))
            continue;
        lie->times--;
        if (lie->answer)
            sim_say(&self->sim, lie->answer);
        return true;
    }
    return false;
}

static void note_boot_up(struct plant *self, const struct co_frame *frame, enum sim_fate fate)
{
    uint8_t node, state;

    if (nmt_parse_error_control(frame, &node, &state) && state == NMT_INITIALISING &&
        self->devices[node])
        self->devices[node]->reborn = fate != SIM_DELIVER;
}

static enum sim_fate on_frame(void *context, const struct co_frame *frame, uint8_t sender)
{
    struct plant *self = context;
    enum sim_fate fate = self->fault ? self->fault(self, frame, sender) : SIM_DELIVER;

    if (fate == SIM_DELIVER && tell_lie(self, frame))
        return SIM_UNHEARD;
    note_boot_up(self, frame, fate);
    if (fate == SIM_DELIVER && self->on_delivered)
        self->on_delivered(self, frame, sender);
    return fate;
}

/* The manager does not look at all nodes each time: does it miss one whose deadline has moved? */
static void on_step(void *context)
{
    struct plant *self = context;
    const struct manager *manager = self->manager;

    self->network_state = manager->state;
    if (!self->manager_device || !self->manager_device->active || self->sim.steps % 16 != 0)
        return;
    for (unsigned node = 1; node <= NETWORK_NODE_MAX; node++) {
        co_us_t deadline = sdo_client_deadline(&manager->channels[node].client);

        if (manager->nodes[node].config)
            deadline = co_earlier(deadline, boot_node_deadline(&manager->nodes[node]));
        if (deadline < manager_deadline(manager))
            ck_abort_msg("%s: node %u: its deadline is not the manager's", self->name, node);
    }
}

struct plant *plant_new(const char *xml, unsigned bitrate)
{
    struct plant *self = calloc(1, sizeof *self);
    struct co_report report = { .file = "plant.xml" };
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);

    ck_assert_ptr_nonnull(self);
    fprintf(stream,
            "<?xml version=\"1.0\"?>\n<CANopen_Manager><Manager_Instance><Net_No>0</Net_No>"
            "<Baudrate>1000</Baudrate>%s</Manager_Instance></CANopen_Manager>",
            xml);
    fclose(stream);
    ck_assert_msg(guarded_config_parse(text, size, &report, &self->config, &self->config_count) ==
                      CO_OK,
                  "%s", report.first_error);
    free(text);
    sim_init(&self->sim, bitrate);
    self->sim.context = self;
    self->sim.on_event = on_event;
    self->sim.fault = on_frame;
    self->sim.on_step = on_step;
    self->manager = calloc(1, sizeof *self->manager);
    ck_assert_ptr_nonnull(self->manager);
    return self;
}

void plant_free(struct plant *self)
{
    for (unsigned node = 1; node <= NETWORK_NODE_MAX; node++) {
        if (!self->devices[node])
            continue;
        slave_done(&self->devices[node]->slave);
        od_done(&self->devices[node]->od);
        free(self->devices[node]);
    }
    if (self->manager_device)
        manager_done(self->manager);
    free(self->manager);
    network_config_free(self->config, self->config_count);
    sim_done(&self->sim);
    free(self);
}

static void add_number(struct od *od, uint16_t index, uint8_t sub, uint8_t size,
                       enum od_access access, uint32_t value)
{
    uint8_t type = size == 1 ? OD_UNSIGNED8 : size == 2 ? OD_UNSIGNED16 : OD_UNSIGNED32;

    ck_assert_int_eq(od_add_number(od, index, sub, type, access, value), CO_OK);
}

struct plant_device *plant_add_device(struct plant *self, uint8_t node)
{
    struct plant_device *device = calloc(1, sizeof *device);

    ck_assert_ptr_nonnull(device);
    od_init(&device->od);
    add_number(&device->od, 0x1000, 0, 4, OD_RO, 0x00020192);
    add_number(&device->od, 0x1001, 0, 1, OD_RO, 0);
    add_number(&device->od, 0x1017, 0, 2, OD_RW, 0);
    add_number(&device->od, 0x1018, 0, 1, OD_RO, 4);
    add_number(&device->od, 0x1018, 1, 4, OD_RO, 0x29A);
    add_number(&device->od, 0x1018, 2, 4, OD_RO, 1);
    add_number(&device->od, 0x1018, 3, 4, OD_RO, 0x10001);
    add_number(&device->od, 0x1018, 4, 4, OD_RO, node);
    self->devices[node] = device;
    ck_assert_int_eq(slave_init(&device->slave, node, &device->od), CO_OK);
    device->sim = sim_add_slave(&self->sim, &device->slave);
    return device;
}

void plant_add_object(struct plant_device *device, uint16_t index, uint8_t sub, uint8_t size,
                      uint32_t value)
{
    add_number(&device->od, index, sub, size, OD_RW, value);
}

void plant_configure(struct plant *self, uint8_t node, uint16_t index, uint8_t sub, uint8_t size,
                     uint32_t value)
{
    uint8_t bytes[4];

    put_le(bytes, size, value);
    for (size_t i = 0; i < self->config->node_count; i++)
        if (self->config->nodes[i].node_id == node)
            ck_assert_int_eq(ccf_append(&self->config->nodes[i].ccf, index, sub, bytes, size),
                             CO_OK);
}

void plant_power_on(struct plant *self)
{
    for (unsigned node = 1; node <= NETWORK_NODE_MAX; node++)
        if (self->devices[node])
            sim_power(&self->sim, self->devices[node]->sim, true);
    sim_run(&self->sim, self->sim.now + CO_MS(100));
    self->sim.trace_count = 0;
    self->sim.busy = 0;
    self->sim.now = CO_MS(1000);
    ck_assert_int_eq(manager_init(self->manager, self->config), CO_OK);
    self->manager_device = sim_add_manager(&self->sim, self->manager);
    sim_power(&self->sim, self->manager_device, true);
}

void plant_power(struct plant *self, uint8_t node, bool on)
{
    sim_power(&self->sim, self->devices[node]->sim, on);
}

void plant_power_manager(struct plant *self, bool on)
{
    if (on) {
        manager_done(self->manager);
        ck_assert_int_eq(manager_init(self->manager, self->config), CO_OK);
    }
    sim_power(&self->sim, self->manager_device, on);
}

void plant_lie(struct plant *self, const char *request, const char *answer, unsigned times)
{
    ck_assert_uint_lt(self->lie_count, PLANT_LIES);
    self->lies[self->lie_count++] = (struct plant_lie){ request, answer, times };
}

enum co_err plant_command(struct plant *self, enum nmt_command command, uint8_t node)
{
    return manager_command(self->manager, command, node, self->sim.now, &self->manager_device->box);
}

unsigned plant_sent(const struct plant *self, const char *frame)
{
    unsigned count = 0;

    for (size_t i = 0; i < self->sim.trace_count; i++)
        count += begins_like(&self->sim.trace[i].frame, frame);
    return count;
}

/* The end of a block download, or of an attempt at one. */
static bool ends_blocks(const struct co_frame *frame, uint8_t node)
{
    static const uint8_t none[5];

    if (frame->id == SDO_RESPONSE_ID + node)
        return frame->data[0] == 0x80;
    return (frame->data[0] & 0xE3u) == 0xC1 && memcmp(frame->data + 3, none, sizeof none) == 0;
}

static void add_transfer(FILE *text, const struct co_frame *frame)
{
    unsigned command = frame->data[0] >> 5, index = get_le16(frame->data + 1);
    bool writes = command == 1 || command == 6;

    if (index == 0x1000 || (!writes && command != 2))
        return;
    fprintf(text, " %c%04X:%X", command == 6 ? 'b' : writes ? 'w' : 'r', index, frame->data[3]);
    if (writes)
        fprintf(text, "=%X", get_le16(frame->data + 4));
}

const char *plant_talk(struct plant *self, uint8_t node)
{
    FILE *text = fmemopen(self->talk, sizeof self->talk, "w");
    bool in_blocks = false;

    for (size_t i = 0; i < self->sim.trace_count; i++) {
        const struct co_frame *frame = &self->sim.trace[i].frame;

        if (frame->id != SDO_REQUEST_ID + node && frame->id != SDO_RESPONSE_ID + node)
            continue;
        if (in_blocks) {
            in_blocks = !ends_blocks(frame, node);
            continue;
        }
        if (frame->id == SDO_RESPONSE_ID + node)
            continue;
        add_transfer(text, frame);
        in_blocks = frame->data[0] >> 5 == 6;
    }
    fputc('\0', text);
    ck_assert_int_eq(fclose(text), 0);
    return self->talk;
}

void plant_run_ms(struct plant *self, unsigned ms)
{
    sim_run(&self->sim, self->sim.now + CO_MS(ms));
}

struct boot_node *plant_node(struct plant *self, uint8_t node)
{
    return &self->manager->nodes[node];
}

unsigned plant_said_times(const struct plant *self, const char *text)
{
    unsigned times = 0;

    for (const char *at = strstr(self->events, text); at; at = strstr(at + 1, text))
        times++;
    return times;
}

bool plant_said(const struct plant *self, const char *text)
{
    return plant_said_times(self, text) > 0;
}
