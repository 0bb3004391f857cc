/*
 * Checks of the default SDO server: block uploads.
 */
#include "check_common.h"
#include "conform_families.h"

#include "base/bytes.h"
#include "od/abort.h"

#include <string.h>

#define RESPONSE(self) (0x580u + (self)->options.node)
#define SEGMENT        7u

struct upload {
    const struct conform_object *object;
    uint8_t block_size;
    bool strict;                /* an ordinary upload is no answer */
    bool crc;                   /* both sides use it */
    struct conform_value plain; /* as an ordinary upload brings it */
    struct conform_value value; /* what has come; until the end with what the last segment has
                                   too many */
    uint8_t in_block;           /* segments of the present sub-block */
    bool last;                  /* the last one of all was among them */
    size_t from;                /* the next frame that has not been looked at */
};

/* --- the protocol, step by step --- */

/* Servers without block uploads say so, or answer with an ordinary upload, which is a finding of
 * the first check alone. */
static bool has_no_blocks(struct conform *self, const struct upload *upload,
                          const uint8_t answer[8])
{
    if (answer[0] == 0x80 && get_le32(answer + 4) == SDO_COMMAND) {
        conform_skip(self, "the server has no block uploads");
        return true;
    }
    if (answer[0] >> 5 != 2 || upload->strict)
        return false;
    check_give_up(self, upload->object);
    conform_skip(self, "the server answers with ordinary uploads: see sdo-block-upload");
    return true;
}

static void make_initiate(const struct upload *upload, uint8_t command, uint8_t block_size,
                          uint8_t threshold, uint8_t request[8])
{
    conform_request(request, command, upload->object->index, upload->object->sub);
    request[4] = block_size;
    request[5] = threshold;
}

/* The object as it is read otherwise; a value of so many bytes. NULL object: skipped. */
static bool choose(struct conform *self, uint32_t least, struct upload *upload)
{
    static const struct conform_object device_type = { .index = 0x1000 };

    memset(upload, 0, sizeof *upload);
    upload->object = least <= 4 ? &device_type : conform_long_object(self, least);
    if (!upload->object)
        return conform_skip(self, "the device has no value of %u bytes or more", (unsigned)least);
    if (conform_read(self, upload->object->index, upload->object->sub, &upload->plain) != SDO_OK)
        return conform_skip(self, "%04Xh:%02X cannot be read otherwise, to compare",
                            upload->object->index, upload->object->sub);
    return upload->plain.size <= CONFORM_VALUE_MAX - SEGMENT ||
           conform_skip(self, "%04Xh:%02X is too long to compare", upload->object->index,
                        upload->object->sub);
}

static bool check_announced(struct conform *self, const struct upload *upload,
                            const uint8_t answer[8])
{
    if ((answer[0] & 0x02) == 0 || get_le32(answer + 4) == upload->plain.size)
        return true;
    return conform_fail(self, "block upload of %04Xh:%02X: expected the size %u, received %u",
                        upload->object->index, upload->object->sub, (unsigned)upload->plain.size,
                        (unsigned)get_le32(answer + 4));
}

/* Initiates a block upload, with or without CRC, and starts it. */
static bool start(struct conform *self, struct upload *upload, bool crc, uint8_t block_size)
{
    const uint8_t go[8] = { 0xA3 };
    uint8_t request[8], answer[8];

    make_initiate(upload, crc ? 0xA4 : 0xA0, block_size, 0, request);
    if (!conform_exchange(self, request, answer))
        return conform_fail(self, "block upload of %04Xh:%02X: no answer", upload->object->index,
                            upload->object->sub);
    if (has_no_blocks(self, upload, answer))
        return false;
    if ((answer[0] & 0xF9) != 0xC0 || memcmp(answer + 1, request + 1, 3) != 0)
        return conform_fail(self, "block upload of %04Xh:%02X: expected C0 to C6, received %02X",
                            upload->object->index, upload->object->sub, answer[0]);
    upload->crc = crc && (answer[0] & 0x04) != 0;
    upload->block_size = block_size;
    if (!check_announced(self, upload, answer))
        return false;
    upload->from = conform_send_data(self, 0x600u + self->options.node, go, sizeof go);
    return true;
}

/* The next frame of the server. */
static const uint8_t *next(struct conform *self, struct upload *upload, const char *expected)
{
    const size_t at = conform_await(self, upload->from, RESPONSE(self), self->options.sdo_timeout);

    if (at == CONFORM_NOTHING) {
        conform_fail(self, "expected %s, received nothing", expected);
        return NULL;
    }
    upload->from = at + 1;
    return conform_frame(self, at)->data;
}

static void append(struct upload *upload, const uint8_t *bytes)
{
    if (upload->value.size + SEGMENT <= CONFORM_VALUE_MAX)
        memcpy(upload->value.bytes + upload->value.size, bytes, SEGMENT);
    upload->value.size += SEGMENT;
}

/* A sub-block, with all its segments in order. */
static bool take_sub_block(struct conform *self, struct upload *upload)
{
    for (upload->in_block = 0; upload->in_block < upload->block_size && !upload->last;) {
        const uint8_t *data = next(self, upload, "a segment");
        const uint8_t sequence = (uint8_t)(upload->in_block + 1);

        if (!data)
            return false;
        if ((data[0] & 0x7F) != sequence)
            return conform_fail(self, "expected segment %u, received %02X ...", sequence, data[0]);
        append(upload, data + 1);
        upload->in_block = sequence;
        upload->last = (data[0] & 0x80) != 0;
    }
    return true;
}

/* Acknowledges so many segments of the sub-block; the others do not count. */
static void acknowledge(struct conform *self, struct upload *upload, uint8_t count,
                        uint8_t next_size)
{
    const uint8_t request[8] = { 0xA2, count, next_size };

    if (count < upload->in_block) {
        upload->value.size -= SEGMENT * (unsigned)(upload->in_block - count);
        upload->last = false;
    }
    upload->block_size = next_size;
    upload->from = conform_send_data(self, 0x600u + self->options.node, request, sizeof request);
}

static bool check_crc(struct conform *self, const struct upload *upload, uint16_t received)
{
    const uint16_t expected = upload->crc ? check_crc16(upload->value.bytes, upload->value.size)
                                          : 0;

    return expected == received ||
           conform_fail(self, "expected the CRC %04X%s, received %04X", expected,
                        upload->crc ? "" : " (none is used)", received);
}

/* The server's end, and what has come. */
static bool finish(struct conform *self, struct upload *upload)
{
    const uint8_t confirmation[8] = { 0xA1 };
    const uint8_t *data = next(self, upload, "the end C1 ...");

    if (!data)
        return false;
    if ((data[0] & 0xE3) != 0xC1)
        return conform_fail(self, "expected the end C1 to DD, received %02X", data[0]);
    upload->value.size -= data[0] >> 2 & 7u;
    if (upload->value.size != upload->plain.size)
        return conform_fail(self, "expected %u bytes, received %u", (unsigned)upload->plain.size,
                            (unsigned)upload->value.size);
    if (memcmp(upload->value.bytes, upload->plain.bytes, upload->plain.size) != 0)
        return conform_fail(self, "the value is not that of an ordinary upload");
    if (!check_crc(self, upload, get_le16(data + 1)))
        return false;
    conform_send_data(self, 0x600u + self->options.node, confirmation, sizeof confirmation);
    return check_still_serves(self);
}

static bool take_rest(struct conform *self, struct upload *upload)
{
    while (!upload->last) {
        if (!take_sub_block(self, upload))
            return false;
        acknowledge(self, upload, upload->in_block, upload->block_size);
    }
    return finish(self, upload);
}

/* --- checks --- */

static bool check_upload(struct conform *self)
{
    struct upload upload;

    return choose(self, 4, &upload) && start(self, &upload, false, 20) && take_rest(self, &upload);
}

static bool check_upload_long(struct conform *self)
{
    struct upload upload;

    return choose(self, 8, &upload) && start(self, &upload, false, 2) && take_rest(self, &upload);
}

static bool check_upload_crc(struct conform *self)
{
    struct upload upload;

    if (!choose(self, 5, &upload) || !start(self, &upload, true, 127) || !take_rest(self, &upload))
        return false;
    return upload.crc || conform_skip(self, "the server has no CRC");
}

static bool check_upload_sizes(struct conform *self)
{
    struct upload upload;

    if (!choose(self, 3 * SEGMENT + 1, &upload) || !start(self, &upload, false, 2) ||
        !take_sub_block(self, &upload))
        return false;
    acknowledge(self, &upload, 2, 1);
    if (!take_sub_block(self, &upload) ||
        !conform_expect_none(self, upload.from, RESPONSE(self), CONFORM_QUIET))
        return false;
    acknowledge(self, &upload, 1, 127);
    return take_rest(self, &upload);
}

/* Acknowledges less than came: the rest is sent once more, numbered from 1. */
static bool repeat_from(struct conform *self, uint8_t count)
{
    struct upload upload;

    if (!choose(self, SEGMENT + 1, &upload) || !start(self, &upload, true, 2) ||
        !take_sub_block(self, &upload))
        return false;
    acknowledge(self, &upload, count, 3);
    return take_rest(self, &upload);
}

static bool check_repeat_all(struct conform *self)
{
    return repeat_from(self, 0);
}

static bool check_repeat_some(struct conform *self)
{
    return repeat_from(self, 1);
}

static bool check_block_size(struct conform *self)
{
    static const uint8_t wrong[] = { 128, 0, 255 };
    struct upload upload;

    if (!choose(self, 4, &upload))
        return false;
    for (size_t i = 0; i < sizeof wrong; i++) {
        uint8_t request[8], answer[8];
        char what[48];

        make_initiate(&upload, 0xA0, wrong[i], 0, request);
        snprintf(what, sizeof what, "block upload with block size %u", wrong[i]);
        conform_exchange(self, request, answer);
        if (answer[0] >> 5 == 2 && has_no_blocks(self, &upload, answer))
            return false;
        if (!conform_must_answer_abort(self, what, answer,
                                       CODES(SDO_BLOCK_SIZE, SDO_COMMAND, SDO_GENERAL)))
            return false;
    }
    return check_still_serves(self);
}

/* More is acknowledged than was sent. */
static bool check_acknowledged(struct conform *self)
{
    struct upload upload;
    const uint8_t *data;

    if (!choose(self, SEGMENT + 1, &upload) || !start(self, &upload, false, 1) ||
        !take_sub_block(self, &upload))
        return false;
    acknowledge(self, &upload, 128, 20);
    data = next(self, &upload, "an abort");
    return data &&
           conform_must_answer_abort(self, "128 segments acknowledged, 1 was sent", data,
                                     CODES(SDO_BLOCK_SEQUENCE, SDO_COMMAND, SDO_GENERAL)) &&
           check_still_serves(self);
}

/* The server may switch to an ordinary upload, or not. */
static bool check_switch(struct conform *self)
{
    uint8_t request[8], answer[8];
    struct upload upload;

    if (!choose(self, 4, &upload))
        return false;
    make_initiate(&upload, 0xA0, 20, 255, request);
    if (!conform_exchange(self, request, answer))
        return conform_fail(self, "block upload with a threshold of 255 bytes: no answer");
    upload.strict = true; /* here both are right */
    if (has_no_blocks(self, &upload, answer))
        return false;
    if (answer[0] != 0x43 && (answer[0] & 0xF9) != 0xC0)
        return conform_fail(self,
                            "block upload with a threshold of 255 bytes: expected 43 or C0 "
                            "to C6, received %02X",
                            answer[0]);
    if (answer[0] != 0x43)
        check_give_up(self, upload.object);
    return check_still_serves(self);
}

static bool check_abort(struct conform *self)
{
    struct upload upload;
    uint8_t request[8];
    size_t from;

    if (!choose(self, SEGMENT + 1, &upload) || !start(self, &upload, false, 1) ||
        !take_sub_block(self, &upload))
        return false;
    conform_request(request, 0x80, upload.object->index, upload.object->sub);
    put_le32(request + 4, SDO_GENERAL);
    from = conform_send_data(self, 0x600u + self->options.node, request, sizeof request);
    return conform_expect_none(self, from, RESPONSE(self), CONFORM_QUIET) &&
           check_still_serves(self);
}

#define CLAUSE "CiA 301, 7.2.4.3 (SDO block upload)"

static const struct conform_check checks[] = {
    { "sdo-block-upload", "1000h is read in a block", CLAUSE, 0, 0, check_upload },
    { "sdo-block-upload-long", "a longer value is read in several blocks", CLAUSE, 0, 0,
      check_upload_long },
    { "sdo-block-upload-crc", "the CRC is that of the data", CLAUSE, 0, 0, check_upload_crc },
    { "sdo-block-upload-sizes", "the client's block size counts from block to block", CLAUSE, 0, 0,
      check_upload_sizes },
    { "sdo-block-repeat-all", "a block of which nothing came is repeated", CLAUSE, 0, 0,
      check_repeat_all },
    { "sdo-block-repeat-some", "the part of a block that did not come is repeated", CLAUSE, 0, 0,
      check_repeat_some },
    { "sdo-block-size-wrong", "block sizes of 0 and more than 127 are refused", CLAUSE, 0, 0,
      check_block_size },
    { "sdo-block-ack-wrong", "more acknowledged than sent is refused", CLAUSE, 0, 0,
      check_acknowledged },
    { "sdo-block-switch", "with a threshold a short value comes in either way", CLAUSE, 0, 0,
      check_switch },
    { "sdo-block-upload-abort", "an abort ends a block upload", CLAUSE, 0, 0, check_abort },
};

const struct conform_family conform_sdo_block_upload = { "sdo", "SDO block upload", checks,
                                                         sizeof checks / sizeof checks[0] };
