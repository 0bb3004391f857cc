/*
 * A device under a client that keeps to nothing: frames that are short, of wrong kinds, out of
 * turn, with wrong toggle bits and numbers, transfers that are aborted, abandoned or begun anew in
 * the middle, all from a seed. Whatever comes, each answer is one that this request can have and
 * names its object, values change only as a whole and when the client is told, and after it the
 * device serves as before.
 */
#include "base/bytes.h"
#include "proto/sdo_client.h"
#include "slave/slave.h"
#include "support/hex.h"
#include "support/suite.h"

#include <string.h>

#define NODE    5u
#define STORMS  10
#define FRAMES  10000u /* of one storm */
#define ROOM    64u    /* in the device's outbox */
#define OBJECTS 8u
#define LARGE   300u
#define KEPT    50u /* bytes of the value that the owner keeps */

struct value {
    uint32_t size;
    uint8_t bytes[LARGE];
};

struct abuse {
    struct od od;
    struct slave slave;
    struct co_outbox out;
    struct co_frame frames[ROOM];
    struct co_event events[ROOM];
    struct od_entry *entries[OBJECTS];
    struct value values[OBJECTS]; /* as they were before the frame */
    uint64_t seed;
    co_us_t now;
    struct co_frame request; /* the last one */
    uint8_t state;           /* of the server before it */
    uint16_t index;          /* of the last request that named an object */
    uint8_t sub;
    bool confirmed;           /* the last answer told that a value was taken */
    struct co_event question; /* SLAVE_VERDICT, SLAVE_FETCH */
    unsigned dropped, answers, aborts, writes, blocks, late;
};

static const struct od_spec specs[OBJECTS] = {
    { .index = 0x2000,
      .type = OD_UNSIGNED8,
      .access = OD_RW,
      .has_low = true,
      .low = 10,
      .has_high = true,
      .high = 200,
      .value = (const uint8_t *)"\x20",
      .size = 1 },
    { .index = 0x2001, .type = OD_UNSIGNED32, .access = OD_RW },
    { .index = 0x2002, .type = OD_UNSIGNED16, .access = OD_RO },
    { .index = 0x2003, .type = OD_VISIBLE_STRING, .access = OD_RW, .capacity = 40 },
    { .index = 0x2004, .type = OD_DOMAIN, .access = OD_RW, .capacity = LARGE },
    { .index = 0x2005, .type = OD_DOMAIN, .access = OD_WO, .capacity = 20 },
    { .index = 0x2006, .type = OD_UNSIGNED16, .access = OD_RW },                /* watched */
    { .index = 0x2007, .type = OD_DOMAIN, .access = OD_RO, .capacity = LARGE }, /* fetched */
};

static struct abuse abuse;

static unsigned dice(unsigned sides)
{
    return noise(&abuse.seed) % sides;
}

static struct sdo_server *server(void)
{
    return &abuse.slave.channels[0].server;
}

static void make_room(unsigned room)
{
    co_outbox_init(&abuse.out, abuse.frames, room, abuse.events, room);
}

static void set_up(void)
{
    memset(&abuse, 0, sizeof abuse);
    abuse.now = CO_MS(1000);
    od_init(&abuse.od);
    for (unsigned i = 0; i < OBJECTS; i++)
        ck_assert_int_eq(od_add(&abuse.od, &specs[i], &abuse.entries[i]), CO_OK);
    abuse.entries[6]->watched = true;
    abuse.entries[7]->fetched = true;
    ck_assert_int_eq(slave_init(&abuse.slave, NODE, &abuse.od), CO_OK);
    make_room(ROOM);
    slave_start(&abuse.slave, abuse.now, &abuse.out);
    ck_assert_uint_eq(abuse.slave.state, NMT_PREOPERATIONAL);
}

static void tear_down(void)
{
    slave_done(&abuse.slave);
    od_done(&abuse.od);
}

/* --- values --- */

static void keep_values(void)
{
    for (unsigned i = 0; i < OBJECTS; i++) {
        abuse.values[i].size = abuse.entries[i]->size;
        memcpy(abuse.values[i].bytes, abuse.entries[i]->value, abuse.entries[i]->size);
    }
}

static bool has_changed(unsigned i)
{
    return abuse.values[i].size != abuse.entries[i]->size ||
           memcmp(abuse.values[i].bytes, abuse.entries[i]->value, abuse.entries[i]->size) != 0;
}

/* Only the object of the transfer has a new value, all of it, and the client knows. */
static void check_values(void)
{
    for (unsigned i = 0; i < OBJECTS; i++) {
        const struct od_entry *entry = abuse.entries[i];

        if (!has_changed(i))
            continue;
        if (!abuse.confirmed || entry->index != abuse.index || entry->access == OD_RO)
            ck_abort_msg("%04Xh has changed", entry->index);
        ck_assert_uint_eq(od_check_value(entry, entry->value, entry->size), SDO_OK);
        ck_assert_uint_eq(entry->size, server()->size);
        ck_assert_mem_eq(entry->value, sdo_server_value(server()), entry->size);
        abuse.writes++;
    }
    abuse.confirmed = false;
}

/* --- answers --- */

static void fail_on(const struct co_frame *answer, const char *what)
{
    char request[CO_FRAME_TEXT_SIZE], text[CO_FRAME_TEXT_SIZE];

    ck_abort_msg("%s: %s after %s, in state %u", what, co_frame_format(answer, text, sizeof text),
                 co_frame_format(&abuse.request, request, sizeof request), abuse.state);
}

static void check_object(const struct co_frame *answer)
{
    if (get_le16(answer->data + 1) != abuse.index || answer->data[3] != abuse.sub)
        fail_on(answer, "not the object asked for");
}

static void check_abort(const struct co_frame *answer)
{
    check_object(answer);
    if (strcmp(sdo_abort_text(get_le32(answer->data + 4)), "unknown abort code") == 0)
        fail_on(answer, "no reason");
    abuse.aborts++;
}

static bool is_block_command(uint8_t command)
{
    return command == BLOCK_END_ANSWER || command == BLOCK_ACK || (command & 0xE3) == BLOCK_END;
}

static bool is_initiate_answer(uint8_t command)
{
    return command == 0x60 || command == 0x41 || (command & 0xF3) == 0x43 || command == 0xA4 ||
           command == 0xC6;
}

/* While a block is uploaded everything but an abort and the end is a segment. */
static void check_block_upload(const struct co_frame *answer)
{
    const uint8_t number = answer->data[0] & 0x7F;

    if (answer->data[0] == BLOCK_ABORT)
        check_abort(answer);
    else if (server()->state == SDO_SERVER_BLOCK_UP && (number == 0 || number > SDO_BLOCK_MAX))
        fail_on(answer, "no segment");
    abuse.blocks++;
}

static void check_answer(const struct co_frame *answer)
{
    const uint8_t command = answer->data[0];

    if (answer->id != 0x580 + NODE)
        return;
    abuse.answers++;
    if (answer->dlc != 8)
        fail_on(answer, "short");
    abuse.confirmed = command == 0x60 || command == 0x20 || command == 0x30 ||
                      command == BLOCK_END_ANSWER;
    if (abuse.state == SDO_SERVER_BLOCK_UP || server()->state == SDO_SERVER_BLOCK_UP)
        check_block_upload(answer);
    else if (command == BLOCK_ABORT)
        check_abort(answer);
    else if (is_initiate_answer(command))
        check_object(answer);
    else if (!is_block_command(command) && command >= 0x40)
        fail_on(answer, "no answer");
}

static void drain(void)
{
    struct co_frame frame;
    struct co_event event;

    while (co_outbox_take_frame(&abuse.out, &frame))
        check_answer(&frame);
    while (co_outbox_take_event(&abuse.out, &event)) {
        if (event.type == SLAVE_VERDICT || event.type == SLAVE_FETCH)
            abuse.question = event;
        abuse.late += event.type == SLAVE_VERDICT_LATE;
    }
}

/* --- the device's owner --- */

static void answer_question(sdo_abort_t code)
{
    static const uint8_t bytes[KEPT] = { 1, 2, 3 };
    const struct slave_value value = { .code = code, .bytes = bytes, .size = sizeof bytes };
    const struct slave_transfer transfer = { abuse.question.detail, abuse.question.code };

    if (abuse.question.type == SLAVE_VERDICT)
        slave_verdict(&abuse.slave, transfer, code, abuse.now, &abuse.out);
    else if (abuse.question.type == SLAVE_FETCH)
        slave_give(&abuse.slave, transfer, &value, abuse.now, &abuse.out);
    abuse.question.type = 0;
}

/* What is due now; a deadline that nothing ends would go on for ever. */
static void settle(void)
{
    for (unsigned i = 0; slave_deadline(&abuse.slave) <= abuse.now; i++) {
        ck_assert_uint_lt(i, 1000);
        make_room(ROOM);
        abuse.state = server()->state;
        slave_on_time(&abuse.slave, abuse.now, &abuse.out);
        drain();
        check_values();
        keep_values();
    }
}

/* --- the client --- */

static bool names_object(uint8_t command)
{
    if (abuse.state == SDO_SERVER_BLOCK_DOWN)
        return false;
    switch (command >> 5) {
    case 1:
    case 2: return true;
    case 5: return (command & 0x03) == 0;
    case 6: return (command & 0x01) == 0;
    case 7: return abuse.state == SDO_SERVER_IDLE;
    default: return false;
    }
}

/* The next frame of the transfer that runs, most often. */
static uint8_t fitting_command(uint8_t command)
{
    static const uint8_t block_commands[] = { [SDO_SERVER_BLOCK_UP_START] = BLOCK_START,
                                              [SDO_SERVER_BLOCK_UP] = BLOCK_ACK,
                                              [SDO_SERVER_BLOCK_UP_END] = BLOCK_END_ANSWER };
    const uint8_t toggle = server()->toggle ? 0x10 : 0;

    if (server()->state == SDO_SERVER_UP_SEGMENT)
        return 0x60 | toggle;
    if (server()->state == SDO_SERVER_DOWN_SEGMENT)
        return (uint8_t)(toggle | (dice(6) == 0 ? command & 0x0F : 0));
    if (server()->state == SDO_SERVER_BLOCK_DOWN)
        return (uint8_t)((server()->receiver.in_order + 1) | (dice(6) == 0 ? BLOCK_LAST : 0));
    if (server()->state == SDO_SERVER_BLOCK_DOWN_END)
        return (uint8_t)(BLOCK_END | (command & 0x1C));
    return server()->state < sizeof block_commands && block_commands[server()->state] != 0
               ? block_commands[server()->state]
               : command;
}

static void fit(uint8_t data[8])
{
    static const uint8_t initiates[] = { 0x40, 0x40, 0x2F, 0x23, 0x21, 0x20, 0x22,
                                         0xA0, 0xA4, 0xC0, 0xC4, 0xC2, 0xC6, 0x80 };

    if (server()->state != SDO_SERVER_IDLE && dice(16) != 0) {
        data[0] = fitting_command(data[0]);
    } else {
        data[0] = initiates[dice(sizeof initiates)];
        data[3] = 0;
        put_le16(data + 1, (uint16_t)(0x2000 + dice(OBJECTS + 1)));
        data[5] = data[6] = data[7] = 0;
    }
    if (data[0] == BLOCK_ACK && dice(8) != 0) {
        data[1] = server()->sender.sent;
        data[2] = (uint8_t)(1 + dice(10));
    }
    if (server()->state == SDO_SERVER_BLOCK_DOWN_END && dice(8) != 0)
        put_le16(data + 1, server()->receiver.crc);
}

static struct co_frame make_request(void)
{
    struct co_frame frame = co_frame_make(0x600 + NODE, 8);

    for (unsigned i = 0; i < 8; i++)
        frame.data[i] = (uint8_t)noise(&abuse.seed);
    if (dice(8) != 0)
        fit(frame.data);
    if (dice(50) == 0)
        frame.dlc = (uint8_t)dice(9);
    if (dice(200) == 0)
        frame.flags = dice(2) ? CO_FRAME_RTR : CO_FRAME_EXT;
    if (dice(200) == 0)
        frame.id = dice(0x800);
    return frame;
}

static bool is_request(const struct co_frame *frame)
{
    return frame->id == 0x600 + NODE && (frame->flags & CO_FRAME_EXT) == 0;
}

static void send(struct co_frame frame)
{
    const bool full = dice(40) == 0;

    make_room(full ? dice(2) : ROOM);
    abuse.request = frame;
    abuse.state = server()->state;
    if (is_request(&frame) && full) {
        abuse.dropped++;
    } else if (is_request(&frame) && frame.dlc == 8 && frame.flags == 0 &&
               names_object(frame.data[0])) {
        abuse.index = get_le16(frame.data + 1);
        abuse.sub = frame.data[3];
    }
    slave_on_frame(&abuse.slave, &frame, abuse.now, &abuse.out);
    drain();
    check_values();
    keep_values();
}

static void storm(void)
{
    for (unsigned i = 0; i < FRAMES; i++) {
        struct co_frame frame = make_request();

        if (frame.id == NMT_CAN_ID)
            continue;
        send(frame);
        if (abuse.question.type != 0 && dice(4) == 0) {
            make_room(ROOM);
            answer_question(dice(4) == 0 ? SDO_DEVICE_STATE : SDO_OK);
            drain();
            check_values();
            keep_values();
        }
        abuse.now += dice(abuse.question.type != 0 ? 8 : 80) == 0 ? CO_MS(dice(3000)) : dice(2000);
        settle();
    }
}

/* --- afterwards --- */

struct peer {
    struct sdo_client client;
    struct co_outbox out;
    struct co_frame frames[8];
    struct co_event events[2];
    struct co_event end;
};

static void pass_frames(struct peer *peer)
{
    struct co_frame frame;

    while (co_outbox_take_frame(&peer->out, &frame)) {
        slave_on_frame(&abuse.slave, &frame, abuse.now, &abuse.out);
        frame.flags |= CO_FRAME_OWN;
        sdo_client_on_frame(&peer->client, &frame, abuse.now, &peer->out);
    }
    while (co_outbox_take_frame(&abuse.out, &frame))
        sdo_client_on_frame(&peer->client, &frame, abuse.now, &peer->out);
    while (co_outbox_take_event(&abuse.out, &abuse.question))
        if (abuse.question.type == SLAVE_VERDICT || abuse.question.type == SLAVE_FETCH)
            answer_question(SDO_OK);
}

/* A transfer that keeps to the rules goes well, and at once. */
static void transfer(struct sdo_transfer transfer, uint32_t size)
{
    struct peer peer;

    make_room(ROOM);
    co_outbox_init(&peer.out, peer.frames, 8, peer.events, 2);
    sdo_client_init(&peer.client, NODE);
    transfer.timeout = CO_MS(100);
    sdo_client_start(&peer.client, &transfer, abuse.now, &peer.out);
    for (unsigned i = 0; i < 1000 && sdo_client_busy(&peer.client); i++) {
        pass_frames(&peer);
        sdo_client_on_time(&peer.client, abuse.now, &peer.out);
        slave_on_time(&abuse.slave, abuse.now, &abuse.out);
    }
    pass_frames(&peer);
    ck_assert(co_outbox_take_event(&peer.out, &peer.end));
    ck_assert_uint_eq(peer.end.detail, SDO_OUTCOME_OK);
    ck_assert_uint_eq(peer.end.actual, size);
    ck_assert_uint_eq(peer.end.expected, 0);
}

static void check_there_and_back(uint16_t index, uint32_t size, uint8_t block)
{
    uint8_t sent[LARGE], got[LARGE] = { 0 };

    for (uint32_t i = 0; i < size; i++)
        sent[i] = (uint8_t)(20 + dice(150));
    transfer(
        (struct sdo_transfer){
            .download = true, .block = block, .index = index, .source = sent, .size = size },
        size);
    transfer((struct sdo_transfer){ .block = block, .index = index, .buffer = got, .size = LARGE },
             size);
    ck_assert_mem_eq(got, sent, size);
}

static void check_service(void)
{
    uint8_t got[LARGE];

    check_there_and_back(0x2000, 1, 0);
    check_there_and_back(0x2006, 2, 0);
    check_there_and_back(0x2003, 40, 0);
    check_there_and_back(0x2004, LARGE, 20);
    transfer((struct sdo_transfer){ .block = 5, .index = 0x2007, .buffer = got, .size = LARGE },
             KEPT);
}

/* Among the segments of a block download no request is known as one: there it takes an abort. */
static void end_block_download(void)
{
    struct co_frame frame = co_frame_make(0x600 + NODE, 8);

    if (server()->state != SDO_SERVER_BLOCK_DOWN)
        return;
    frame.data[0] = BLOCK_ABORT;
    make_room(ROOM);
    slave_on_frame(&abuse.slave, &frame, abuse.now, &abuse.out);
    ck_assert_uint_eq(server()->state, SDO_SERVER_IDLE);
}

START_TEST(test_storm)
{
    abuse.seed = (uint64_t)_i + 1;
    keep_values();
    storm();
    ck_assert_uint_eq(server()->dropped, abuse.dropped);
    ck_assert_uint_eq(abuse.slave.state, NMT_PREOPERATIONAL);
    ck_assert_uint_gt(abuse.answers, FRAMES / 4);
    ck_assert_uint_gt(abuse.aborts, FRAMES / 20);
    ck_assert_uint_gt(abuse.writes, 100);
    ck_assert_uint_gt(abuse.blocks, 100);
    ck_assert_uint_gt(abuse.late, 0);
    if (_i % 2)
        end_block_download();
    else
        for (unsigned i = 0; i < 5; i++, settle())
            abuse.now += CO_MS(5000);
    if (_i % 2 == 0)
        ck_assert_uint_eq(server()->state, SDO_SERVER_IDLE);
    check_service();
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("slave_abuse");

    tcase_add_checked_fixture(tcase, set_up, tear_down);
    tcase_add_loop_test(tcase, test_storm, 0, STORMS);
    return suite_run("slave_abuse", tcase);
}
