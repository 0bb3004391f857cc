/*
 * Checks of the default SDO server: block downloads.
 */
#include "check_common.h"
#include "conform_families.h"

#include "base/bytes.h"
#include "od/abort.h"

#include <string.h>

#define REQUEST(self)  (0x600u + (self)->options.node)
#define RESPONSE(self) (0x580u + (self)->options.node)
#define SEGMENT        7u

/* The present value of an object, which is written back. */
struct download {
    const struct conform_object *object;
    struct conform_value before;
    uint32_t segments;
    bool crc; /* both sides use it */
};

static const uint32_t *const wrong_length = CODES(SDO_TOO_LONG, SDO_TOO_SHORT, SDO_TYPE_LENGTH,
                                                  SDO_GENERAL);

/* --- the protocol, step by step --- */

static bool take_value(struct conform *self, struct download *download)
{
    if (!conform_must_read(self, download->object->index, download->object->sub, &download->before))
        return false;
    download->segments = (download->before.size + SEGMENT - 1) / SEGMENT;
    return true;
}

static bool choose_number(struct conform *self, struct download *download)
{
    memset(download, 0, sizeof *download);
    download->object = conform_writable(self, 2);
    if (!download->object)
        download->object = conform_writable(self, 4);
    if (!download->object)
        return conform_skip(self, "no object is known that can be written back without harm: give "
                                  "one with --eds FILE");
    return take_value(self, download);
}

/* At least three segments. */
static bool choose_string(struct conform *self, struct download *download)
{
    memset(download, 0, sizeof *download);
    download->object = check_writable_string(self, 2 * SEGMENT + 1);
    if (!download->object)
        return conform_skip(self, "no writable string of 15 bytes or more is known: give one with "
                                  "--eds FILE");
    return take_value(self, download);
}

/* Initiates it with the size of the value; fails unless the server gives a block size. */
static bool start(struct conform *self, struct download *download, bool crc)
{
    uint8_t request[8], answer[8];

    conform_request(request, crc ? 0xC6 : 0xC2, download->object->index, download->object->sub);
    put_le32(request + 4, download->before.size);
    if (!conform_exchange(self, request, answer))
        return conform_fail(self, "block download: no answer");
    if (answer[0] == 0x80 && get_le32(answer + 4) == SDO_COMMAND)
        return conform_skip(self, "the server has no block downloads");
    if ((answer[0] & 0xFB) != 0xA0 || memcmp(answer + 1, request + 1, 3) != 0)
        return conform_fail(self, "block download: expected A0 or A4, received %02X", answer[0]);
    if (answer[4] < 1 || answer[4] > 127)
        return conform_fail(self, "block download: expected a block size of 1 to 127, received %u",
                            answer[4]);
    download->crc = crc && (answer[0] & 0x04) != 0;
    if (answer[4] >= download->segments)
        return true;
    check_give_up(self, download->object);
    return conform_skip(self, "the server's blocks of %u segments are too short for this check",
                        answer[4]);
}

/* The segment 'number' of the value (from 0), sent with this sequence number. */
static size_t send_segment(struct conform *self, const struct download *download, uint32_t number,
                           uint8_t sequence)
{
    const uint32_t at = number * SEGMENT;
    const uint32_t rest = download->before.size - at;
    uint8_t data[8] = { sequence };

    if (number + 1 == download->segments)
        data[0] |= 0x80;
    memcpy(data + 1, download->before.bytes + at, rest < SEGMENT ? rest : SEGMENT);
    return conform_send_data(self, REQUEST(self), data, sizeof data);
}

/* The server's answer to a sub-block. */
static bool expect_acknowledged(struct conform *self, size_t from, uint8_t count)
{
    const size_t at = conform_await(self, from, RESPONSE(self), self->options.sdo_timeout);
    const uint8_t *data;

    if (at == CONFORM_NOTHING)
        return conform_fail(self, "expected A2 %02X, received nothing", count);
    data = conform_frame(self, at)->data;
    if (data[0] != 0xA2 || data[1] != count)
        return conform_fail(self, "expected A2 %02X, received %02X %02X %02X", count, data[0],
                            data[1], data[2]);
    if (data[2] < 1 || data[2] > 127)
        return conform_fail(self, "expected a block size of 1 to 127, received %u", data[2]);
    return true;
}

/* Segments from this one to the last, as a sub-block. */
static bool send_rest(struct conform *self, const struct download *download, uint32_t number)
{
    uint8_t sequence = 0;
    size_t from = 0;

    while (number < download->segments)
        from = send_segment(self, download, number++, ++sequence);
    return expect_acknowledged(self, from, sequence);
}

static void make_end(const struct download *download, uint8_t request[8])
{
    const uint32_t unused = download->segments * SEGMENT - download->before.size;

    memset(request, 0, 8);
    request[0] = (uint8_t)(0xC1 | unused << 2);
    if (download->crc)
        put_le16(request + 1, check_crc16(download->before.bytes, download->before.size));
}

static bool finish(struct conform *self, const struct download *download)
{
    uint8_t request[8], answer[8];

    make_end(download, request);
    return check_step(self, request, 0xA1, answer) &&
           check_unchanged(self, download->object, &download->before);
}

/* --- checks --- */

static bool check_download(struct conform *self)
{
    struct download download;

    return choose_number(self, &download) && start(self, &download, false) &&
           send_rest(self, &download, 0) && finish(self, &download);
}

static bool check_download_long(struct conform *self)
{
    struct download download;

    return choose_string(self, &download) && start(self, &download, false) &&
           send_rest(self, &download, 0) && finish(self, &download);
}

static bool check_download_crc(struct conform *self)
{
    struct download download;

    if (!choose_number(self, &download) || !start(self, &download, true) ||
        !send_rest(self, &download, 0) || !finish(self, &download))
        return false;
    return download.crc || conform_skip(self, "the server has no CRC");
}

static bool check_wrong_crc(struct conform *self)
{
    struct download download;
    uint8_t request[8], answer[8];

    if (!choose_number(self, &download) || !start(self, &download, true))
        return false;
    if (!download.crc) {
        check_give_up(self, download.object);
        return conform_skip(self, "the server has no CRC");
    }
    if (!send_rest(self, &download, 0))
        return false;
    make_end(&download, request);
    request[1] ^= 0x01;
    conform_exchange(self, request, answer);
    return conform_must_answer_abort(self, "end with a wrong CRC", answer, CODES(SDO_BLOCK_CRC)) &&
           check_unchanged(self, download.object, &download.before);
}

/* The server may answer as soon as it sees the gap; then the rest of the sub-block is not sent. */
static size_t send_with_gap(struct conform *self, const struct download *download)
{
    const size_t from = send_segment(self, download, 0, 1);

    for (uint32_t i = 2; i < download->segments; i++) {
        send_segment(self, download, i, (uint8_t)(i + 1));
        if (conform_await(self, from, RESPONSE(self), 10) != CONFORM_NOTHING)
            break;
    }
    return from;
}

/* A segment is missing in the middle: the server has only what came before it. */
static bool check_gap(struct conform *self)
{
    struct download download;

    return choose_string(self, &download) && start(self, &download, true) &&
           expect_acknowledged(self, send_with_gap(self, &download), 1) &&
           send_rest(self, &download, 1) && finish(self, &download);
}

static bool check_first_missing(struct conform *self)
{
    struct download download;

    if (!choose_number(self, &download) || !start(self, &download, true))
        return false;
    return expect_acknowledged(self, send_segment(self, &download, 0, 2), 0) &&
           send_rest(self, &download, 0) && finish(self, &download);
}

static bool check_sequence_zero(struct conform *self)
{
    const uint8_t data[8] = { 0 };
    struct download download;
    uint8_t answer[8];

    if (!choose_number(self, &download) || !start(self, &download, false))
        return false;
    conform_exchange(self, data, answer);
    return conform_must_answer_abort(self, "segment with the sequence number 0", answer,
                                     CODES(SDO_BLOCK_SEQUENCE, SDO_COMMAND, SDO_GENERAL)) &&
           check_unchanged(self, download.object, &download.before);
}

/* The end says that all 7 bytes of the segment count. */
static bool check_wrong_length(struct conform *self)
{
    const uint8_t end[8] = { 0xC1 };
    struct download download;
    uint8_t answer[8];

    if (!choose_number(self, &download) || !start(self, &download, false) ||
        !send_rest(self, &download, 0))
        return false;
    conform_exchange(self, end, answer);
    return conform_must_answer_abort(self, "end with more bytes than announced", answer,
                                     wrong_length) &&
           check_unchanged(self, download.object, &download.before);
}

/* Refused at once, or when as many bytes have come. */
static bool check_too_long(struct conform *self)
{
    const uint8_t segments[][8] = { { 0x01 }, { 0x82 } }, end[8] = { 0xC1 };
    struct download download;
    uint8_t request[8], answer[8];

    if (!choose_number(self, &download))
        return false;
    conform_request(request, 0xC2, download.object->index, download.object->sub);
    put_le32(request + 4, 14);
    conform_exchange(self, request, answer);
    if (answer[0] == 0x80 && get_le32(answer + 4) == SDO_COMMAND)
        return conform_skip(self, "the server has no block downloads");
    if (answer[0] != 0x80) {
        conform_send_data(self, REQUEST(self), segments[0], 8);
        if (conform_exchange(self, segments[1], answer) && answer[0] == 0xA2)
            conform_exchange(self, end, answer);
    }
    return conform_must_answer_abort(self, "14 bytes to a number", answer, wrong_length) &&
           check_unchanged(self, download.object, &download.before);
}

static bool check_abort(struct conform *self)
{
    struct download download;
    uint8_t request[8];
    size_t from;

    if (!choose_number(self, &download) || !start(self, &download, false))
        return false;
    conform_request(request, 0x80, download.object->index, download.object->sub);
    put_le32(request + 4, SDO_GENERAL);
    from = conform_send_data(self, REQUEST(self), request, sizeof request);
    return conform_expect_none(self, from, RESPONSE(self), CONFORM_QUIET) &&
           check_unchanged(self, download.object, &download.before);
}

static bool check_read_only(struct conform *self)
{
    uint8_t request[8], answer[8];

    conform_request(request, 0xC2, 0x1000, 0);
    put_le32(request + 4, 4);
    conform_exchange(self, request, answer);
    if (answer[0] == 0x80 && get_le32(answer + 4) == SDO_COMMAND)
        return conform_skip(self, "the server has no block downloads");
    return conform_must_answer_abort(self, "block download to 1000h", answer,
                                     CODES(SDO_READ_ONLY, SDO_ACCESS, SDO_GENERAL)) &&
           check_still_serves(self);
}

#define CLAUSE "CiA 301, 7.2.4.3 (SDO block download)"

static const struct conform_check checks[] = {
    { "sdo-block-download", "a number is written in a block", CLAUSE, 0, 0, check_download },
    { "sdo-block-download-long", "a string is written in a block", CLAUSE, CONFORM_EDS, 0,
      check_download_long },
    { "sdo-block-download-crc", "the right CRC is accepted", CLAUSE, 0, 0, check_download_crc },
    { "sdo-block-crc-wrong", "a wrong CRC is refused, nothing is written", CLAUSE, 0, 0,
      check_wrong_crc },
    { "sdo-block-gap", "a segment that did not come is asked for again", CLAUSE, CONFORM_EDS, 0,
      check_gap },
    { "sdo-block-first-missing", "a first segment that did not come is asked for again", CLAUSE, 0,
      0, check_first_missing },
    { "sdo-block-sequence-zero", "the sequence number 0 is refused", CLAUSE, 0, 0,
      check_sequence_zero },
    { "sdo-block-length-wrong", "an end with the wrong length is refused", CLAUSE, 0, 0,
      check_wrong_length },
    { "sdo-block-too-long", "more bytes than a number has are refused", CLAUSE, 0, 0,
      check_too_long },
    { "sdo-block-download-abort", "an abort ends a block download, nothing is written", CLAUSE, 0,
      0, check_abort },
    { "sdo-block-read-only", "a block download to 1000h is refused", CLAUSE, 0, 0,
      check_read_only },
};

const struct conform_family conform_sdo_block_download = { "sdo", "SDO block download", checks,
                                                           sizeof checks / sizeof checks[0] };
