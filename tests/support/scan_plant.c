#include "support/scan_plant.h"

#include "base/bytes.h"
#include "port/bus.h"
#include "port/clock.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define NODES  255u
#define FRAMES 4096u

struct scan_plant {
    int net;
    bool created; /* the network, by us */
    char name[60];
    struct bus *bus;
    struct bus_rx frames[FRAMES]; /* that came and were not expected yet */
    unsigned count;
    co_us_t time;
    HNODE nodes[NODES];
    int ids[NODES];
    unsigned node_count;
};

/* --- plants --- */

/* kbit 0: frames take no time. */
static void choose_name(struct scan_plant *self, unsigned kbit)
{
    static unsigned number;
    size_t size = sizeof self->name;
    int length = snprintf(self->name, size, "virtual:scan-%d-%u", (int)getpid(), number++);

    if (kbit != 0)
        snprintf(self->name + length, size - (size_t)length, "?bitrate=%u", kbit * 1000);
}

static struct scan_plant *make_plant(int net, unsigned kbit)
{
    const struct bus_options options = { .own_frames = false };
    const struct bus_filter all = { .mask = 0 };
    struct scan_plant *self = calloc(1, sizeof *self);
    char variable[32], message[200] = "";

    ck_assert_ptr_nonnull(self);
    self->net = net;
    choose_name(self, kbit);
    snprintf(variable, sizeof variable, "MCANOPEN_NET_%d", net);
    ck_assert_int_eq(setenv(variable, self->name, 1), 0);
    ck_assert_msg(bus_open(self->name, &options, &self->bus, message, sizeof message) == CO_OK,
                  "%s", message);
    ck_assert_int_eq(bus_set_filters(self->bus, &all, 1), CO_OK);
    if (net == 0)
        scan_notes_clear();
    return self;
}

static struct scan_plant *create_network(struct scan_plant *self, unsigned kbit)
{
    const SLAVE_NET_INFO info = { .usBaudrate = (unsigned short)kbit };

    ck_assert_int_eq(canOpenCreateNetworkEx(self->net, &info), SCANOPEN_OK);
    self->created = true;
    return self;
}

struct scan_plant *scan_plant_bare(int net)
{
    return make_plant(net, 0);
}

struct scan_plant *scan_plant_new(int net)
{
    return create_network(make_plant(net, 0), SCAN_BITRATE);
}

struct scan_plant *scan_plant_slow(int net, unsigned kbit)
{
    return create_network(make_plant(net, kbit), kbit);
}

/* In the disabling run the test about a function has to fail, not every test. */
static void expect_removed(int result, int gone)
{
    if (result != SCANOPEN_OK && result != gone && result != SCANOPEN_NOT_IMPLEMENTED)
        ck_abort_msg("cannot be removed: %d", result);
}

void scan_plant_free(struct scan_plant *self)
{
    for (unsigned i = 0; i < self->node_count; i++) {
        expect_removed(canOpenResetNode(self->nodes[i]), SCANOPEN_INVALID_HANDLE);
        expect_removed(canOpenDeleteNode(self->nodes[i]), SCANOPEN_INVALID_HANDLE);
    }
    if (self->created)
        expect_removed(canOpenRemoveNetwork(self->net), SCANOPEN_WRONG_PARAMETER);
    bus_close(self->bus);
    free(self);
}

const char *scan_bus_name(const struct scan_plant *self)
{
    return self->name;
}

/* --- nodes --- */

SLAVE_NODE_INFO scan_info(void)
{
    return (SLAVE_NODE_INFO){ .ulOptions = SYNCHRON_PDOS,
                              .ulEventMask = EV_ALL,
                              .ulDeviceType = 0x00020192,
                              .usRxPDO = 8,
                              .usTxPDO = 8,
                              .ucMaxIdentityObject = 4,
                              .ulVendorId = 0x29A,
                              .ulProductCode = 1,
                              .ulRevisionNumber = 2,
                              .ulSerialNumber = 3,
                              .ulSyncCobID = DEFAULT_SYNC_COBID };
}

HNODE scan_node(struct scan_plant *self, int id, const SLAVE_NODE_INFO *info)
{
    const SLAVE_NODE_INFO usual = scan_info();
    HNODE node = NULL;

    ck_assert_uint_lt(self->node_count, NODES);
    ck_assert_int_eq(canOpenCreateNodeEx(self->net, id, scan_on_event, info ? info : &usual, &node),
                     SCANOPEN_OK);
    ck_assert_ptr_nonnull(node);
    scan_plant_keep(self, node, id);
    return node;
}

void scan_plant_keep(struct scan_plant *self, HNODE node, int id)
{
    self->ids[self->node_count] = id;
    self->nodes[self->node_count++] = node;
}

int scan_id(const struct scan_plant *self, HNODE node)
{
    for (unsigned i = 0; i < self->node_count; i++)
        if (self->nodes[i] == node)
            return self->ids[i];
    ck_abort_msg("no node of this plant");
    return 0;
}

void scan_activate(struct scan_plant *self, HNODE node)
{
    char boot_up[CO_FRAME_TEXT_SIZE];

    ck_assert_int_eq(canOpenActivateNode(node), SCANOPEN_OK);
    snprintf(boot_up, sizeof boot_up, "%03X#00", 0x700u + (unsigned)scan_id(self, node));
    scan_await(self, boot_up);
}

static void command(struct scan_plant *self, HNODE node, unsigned nmt, unsigned short mask,
                    int state)
{
    char frame[CO_FRAME_TEXT_SIZE];

    snprintf(frame, sizeof frame, "000#%02X%02X", nmt, (unsigned)scan_id(self, node));
    scan_send(self, frame);
    ck_assert_int_eq(canOpenWaitForNodeState(node, mask), state);
}

void scan_operational(struct scan_plant *self, HNODE node)
{
    command(self, node, 0x01, WFNS_OPERATIONAL, NodeOperational);
}

void scan_preoperational(struct scan_plant *self, HNODE node)
{
    command(self, node, 0x80, WFNS_PRE_OPERATIONAL, NodePreOperational);
}

void scan_stop(struct scan_plant *self, HNODE node)
{
    command(self, node, 0x02, WFNS_STOPPED, NodeStopped);
}

int scan_state(HNODE node)
{
    int state = -1, last_error = -1;

    ck_assert_int_eq(canOpenGetNodeInfo(node, &state, &last_error), SCANOPEN_OK);
    return state;
}

/* --- objects --- */

static DictionaryData data_of(int type, uint32_t value)
{
    DictionaryData data;

    memset(&data, 0, sizeof data);
    if (type == TYP_UINT32 || type == TYP_INT32)
        data.uint32.val = data.uint32.defval = value;
    else if (type == TYP_UINT16 || type == TYP_INT16)
        data.uint16.val = data.uint16.defval = (uint16_t)value;
    else
        data.uint8.val = data.uint8.defval = (uint8_t)value;
    return data;
}

void scan_number(HNODE node, unsigned short index, int type, unsigned short flags, uint32_t value,
                 PFN_COS_DATA_HANDLER handler)
{
    const char descriptor[] = { (char)type, 0 };
    DictionaryData data = data_of(type, value);

    ck_assert_int_eq(canOpenExtendDictionary(node, index, 0, OBJ_VAR, descriptor), SCANOPEN_OK);
    ck_assert_int_eq(canOpenInitDictionary(node, index, 0, NULL, flags, &data, handler),
                     SCANOPEN_OK);
}

uint32_t scan_get(HNODE node, unsigned short index, unsigned short sub)
{
    uint32_t value = 0;

    ck_assert_int_eq(canOpenReadDictionary(node, index, sub, &value), SCANOPEN_OK);
    return value;
}

int scan_set(HNODE node, unsigned short index, unsigned short sub, uint32_t value)
{
    return canOpenWriteDictionary(node, index, sub, &value);
}

/* --- the bus --- */

void scan_send(struct scan_plant *self, const char *text)
{
    struct co_frame frame;

    ck_assert_msg(co_frame_parse(text, &frame), "no frame: %s", text);
    ck_assert_int_eq(bus_send(self->bus, &frame), CO_OK);
}

static void fetch(struct scan_plant *self)
{
    while (self->count < FRAMES && bus_receive(self->bus, &self->frames[self->count]) == CO_OK) {
        ck_assert_uint_eq(self->frames[self->count].lost, 0);
        self->count++;
    }
}

/* The frame at this place of the list, once it is there; NULL: not until the limit. */
static const struct bus_rx *frame_at(struct scan_plant *self, unsigned at, co_us_t limit)
{
    fetch(self);
    while (at >= self->count && clock_now() < limit) {
        bus_wait(self->bus, limit);
        fetch(self);
    }
    return at < self->count ? &self->frames[at] : NULL;
}

static struct bus_rx take(struct scan_plant *self, unsigned at)
{
    struct bus_rx taken = self->frames[at];

    self->count--;
    memmove(&self->frames[at], &self->frames[at + 1], (self->count - at) * sizeof taken);
    return taken;
}

static bool is_like(const char *got, const char *expected)
{
    size_t length = strcspn(expected, "*");

    return expected[length] ? strncmp(got, expected, length) == 0 : strcmp(got, expected) == 0;
}

void scan_expect(struct scan_plant *self, const char *frame)
{
    char got[CO_FRAME_TEXT_SIZE];

    ck_assert_msg(frame_at(self, 0, clock_now() + SCAN_PATIENCE) != NULL,
                  "nothing came; expected: %s", frame);
    co_frame_format(&self->frames[0].frame, got, sizeof got);
    ck_assert_msg(is_like(got, frame), "%s came; expected: %s", got, frame);
    self->time = take(self, 0).time;
}

unsigned scan_next_number(struct scan_plant *self)
{
    ck_assert_msg(frame_at(self, 0, clock_now() + SCAN_PATIENCE) != NULL, "nothing came");
    ck_assert_uint_ge(self->frames[0].frame.dlc, 2);
    return get_le16(take(self, 0).frame.data);
}

bool scan_await_within(struct scan_plant *self, const char *frame, unsigned ms)
{
    co_us_t limit = clock_now() + CO_MS(ms);
    char got[CO_FRAME_TEXT_SIZE];

    while (frame_at(self, 0, limit)) {
        struct bus_rx rx = take(self, 0);

        self->time = rx.time;
        if (is_like(co_frame_format(&rx.frame, got, sizeof got), frame))
            return true;
    }
    return false;
}

void scan_await(struct scan_plant *self, const char *frame)
{
    ck_assert_msg(scan_await_within(self, frame, 1000 * SCAN_PATIENCE_S), "did not come: %s",
                  frame);
}

co_us_t scan_time(const struct scan_plant *self)
{
    return self->time;
}

void scan_forget(struct scan_plant *self)
{
    do {
        self->count = 0;
        fetch(self);
    } while (self->count > 0);
}

/* --- SDO --- */

static void ask(struct scan_plant *self, int id, const uint8_t bytes[8])
{
    struct co_frame frame = co_frame_make(0x600u + (unsigned)id, 8);

    memcpy(frame.data, bytes, 8);
    ck_assert_int_eq(bus_send(self->bus, &frame), CO_OK);
}

/* Its answer, taken out of the list; what else came stays there. */
static struct bus_rx answer(struct scan_plant *self, int id, unsigned *ret_before)
{
    co_us_t limit = clock_now() + SCAN_PATIENCE;
    unsigned at = 0;
    const struct bus_rx *rx;

    while ((rx = frame_at(self, at, limit)) != NULL && rx->frame.id != 0x580u + (unsigned)id)
        at++;
    ck_assert_msg(rx != NULL, "node %d does not answer", id);
    *ret_before = at;
    return take(self, at);
}

static struct co_frame transfer(struct scan_plant *self, int id, const uint8_t bytes[8])
{
    unsigned before;

    ask(self, id, bytes);
    return answer(self, id, &before).frame;
}

static uint32_t abort_of(const struct co_frame *frame)
{
    return frame->data[0] == 0x80 ? get_le32(frame->data + 4) : 0;
}

static unsigned expedited_size(const struct co_frame *frame)
{
    return frame->data[0] & 1 ? 4u - (frame->data[0] >> 2 & 3) : 4;
}

uint32_t scan_sdo_read(struct scan_plant *self, int id, unsigned index, unsigned sub,
                       uint32_t *ret_value)
{
    uint8_t bytes[4] = { 0 };
    unsigned size = sizeof bytes;
    uint32_t abort_code = scan_sdo_upload(self, id, index, sub, bytes, &size);

    if (abort_code == 0)
        *ret_value = get_le32(bytes);
    return abort_code;
}

uint32_t scan_sdo_write(struct scan_plant *self, int id, unsigned index, unsigned sub,
                        unsigned size, uint32_t value)
{
    uint8_t request[8] = { (uint8_t)(0x23 | (4 - size) << 2), (uint8_t)index, (uint8_t)(index >> 8),
                           (uint8_t)sub };
    struct co_frame frame;

    put_le32(request + 4, value);
    frame = transfer(self, id, request);
    ck_assert(frame.data[0] == 0x60 || frame.data[0] == 0x80);
    return abort_of(&frame);
}

static uint32_t upload_segments(struct scan_plant *self, int id, uint8_t *data, unsigned *size)
{
    uint8_t request[8] = { 0x60 };
    unsigned used = 0;

    for (;;) {
        struct co_frame frame = transfer(self, id, request);
        unsigned count = 7u - (frame.data[0] >> 1 & 7);

        if (abort_of(&frame) != 0)
            return abort_of(&frame);
        ck_assert_uint_le(used + count, *size);
        memcpy(data + used, frame.data + 1, count);
        used += count;
        request[0] ^= 0x10;
        if (frame.data[0] & 1)
            break;
    }
    *size = used;
    return 0;
}

uint32_t scan_sdo_upload(struct scan_plant *self, int id, unsigned index, unsigned sub, void *data,
                         unsigned *size)
{
    const uint8_t request[8] = { 0x40, (uint8_t)index, (uint8_t)(index >> 8), (uint8_t)sub };
    struct co_frame frame = transfer(self, id, request);

    if (abort_of(&frame) != 0)
        return abort_of(&frame);
    if (!(frame.data[0] & 2))
        return upload_segments(self, id, data, size);
    ck_assert_uint_le(expedited_size(&frame), *size);
    *size = expedited_size(&frame);
    memcpy(data, frame.data + 4, *size);
    return 0;
}

void scan_expect_nothing_more(struct scan_plant *self, HNODE node)
{
    const uint8_t request[8] = { 0x40, 0x00, 0x10, 0x00 };
    char got[CO_FRAME_TEXT_SIZE] = "";
    unsigned before;

    ask(self, scan_id(self, node), request);
    answer(self, scan_id(self, node), &before);
    if (before > 0)
        co_frame_format(&self->frames[0].frame, got, sizeof got);
    ck_assert_str_eq(got, "");
}
