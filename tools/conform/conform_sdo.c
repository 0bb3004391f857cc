#include "conform.h"

#include "base/bytes.h"
#include "od/abort.h"

#include <string.h>

#define UNANSWERED_AT_MOST 5u
#define IMPATIENT          10u /* ms */

void conform_request(uint8_t request[8], uint8_t command, uint16_t index, uint8_t sub)
{
    memset(request, 0, 8);
    request[0] = command;
    put_le16(request + 1, index);
    request[3] = sub;
}

/* A device that has died in the middle of a long check is not waited for each time. */
static unsigned patience(const struct conform *self)
{
    const unsigned ms = self->options.sdo_timeout;

    return self->unanswered >= UNANSWERED_AT_MOST && ms > IMPATIENT ? IMPATIENT : ms;
}

bool conform_exchange(struct conform *self, const uint8_t request[8], uint8_t ret_answer[8])
{
    const size_t from = conform_send_data(self, 0x600u + self->options.node, request, 8);
    const size_t at = conform_await(self, from, 0x580u + self->options.node, patience(self));

    memset(ret_answer, 0, 8);
    if (at == CONFORM_NOTHING) {
        self->unanswered++;
        return false;
    }
    self->unanswered = 0;
    memcpy(ret_answer, conform_frame(self, at)->data, 8);
    return true;
}

const char *conform_result_text(uint32_t result, char *text, size_t size)
{
    if (result == SDO_OK)
        snprintf(text, size, "success");
    else if (result == CONFORM_NO_ANSWER)
        snprintf(text, size, "no answer");
    else if (result == CONFORM_BAD_ANSWER)
        snprintf(text, size, "an answer that is none to this request");
    else
        snprintf(text, size, "abort %08X (%s)", (unsigned)result, sdo_abort_text(result));
    return text;
}

/* The abort code in an answer, or what else is wrong with it; SDO_OK: neither. */
static uint32_t judge(struct conform *self, const uint8_t request[8], const uint8_t answer[8],
                      uint8_t mask, uint8_t command)
{
    const bool initiate = request[0] >= 0x20 && request[0] < 0x60;

    if (answer[0] == 0x80)
        return get_le32(answer + 4);
    if ((answer[0] & mask) == command && (!initiate || memcmp(answer + 1, request + 1, 3) == 0))
        return SDO_OK;
    snprintf(self->bad_answer, sizeof self->bad_answer,
             "the answer %02X %02X %02X %02X to the request %02X %02X %02X %02X", answer[0],
             answer[1], answer[2], answer[3], request[0], request[1], request[2], request[3]);
    return CONFORM_BAD_ANSWER;
}

/* One request with the answer that it must have. */
static uint32_t step(struct conform *self, const uint8_t request[8], uint8_t mask, uint8_t command,
                     uint8_t answer[8])
{
    if (!conform_exchange(self, request, answer))
        return CONFORM_NO_ANSWER;
    return judge(self, request, answer, mask, command);
}

/* --- uploads --- */

static void append(struct conform_value *value, const uint8_t *bytes, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++, value->size++)
        if (value->size < CONFORM_VALUE_MAX)
            value->bytes[value->size] = bytes[i];
}

static uint32_t read_segments(struct conform *self, struct conform_value *value)
{
    uint8_t toggle = 0, answer[8];

    do {
        const uint8_t request[8] = { (uint8_t)(0x60 | toggle) };
        uint32_t result = step(self, request, 0xF0, toggle, answer);

        if (result != SDO_OK)
            return result;
        append(value, answer + 1, 7u - (answer[0] >> 1 & 7u));
        toggle ^= 0x10;
        value->cut = value->size >= CONFORM_UPLOAD_MAX;
    } while ((answer[0] & 0x01) == 0 && !value->cut);
    return SDO_OK;
}

/* The server must not wait for the rest. */
static void give_up(struct conform *self, uint16_t index, uint8_t sub)
{
    uint8_t request[8];

    conform_request(request, 0x80, index, sub);
    put_le32(request + 4, SDO_COMMAND);
    conform_send_data(self, 0x600u + self->options.node, request, sizeof request);
}

uint32_t conform_read(struct conform *self, uint16_t index, uint8_t sub,
                      struct conform_value *ret_value)
{
    uint8_t request[8], answer[8];
    uint32_t result;

    memset(ret_value, 0, sizeof *ret_value);
    conform_request(request, 0x40, index, sub);
    result = step(self, request, 0xE0, 0x40, answer);
    if (result != SDO_OK)
        return result;
    if ((answer[0] & 0x02) == 0) {
        ret_value->announced = answer[0] & 0x01 ? get_le32(answer + 4) : 0;
        result = read_segments(self, ret_value);
        if (result == CONFORM_BAD_ANSWER || ret_value->cut)
            give_up(self, index, sub);
        return result;
    }
    append(ret_value, answer + 4, answer[0] & 0x01 ? 4u - (answer[0] >> 2 & 3u) : 4u);
    return SDO_OK;
}

uint64_t conform_number(struct conform *self, uint16_t index, uint8_t sub, uint64_t missing)
{
    struct conform_value value;

    if (conform_read(self, index, sub, &value) != SDO_OK || value.size > 8)
        return missing;
    return get_le(value.bytes, value.size);
}

/* --- downloads --- */

static uint32_t write_segments(struct conform *self, const uint8_t *bytes, uint32_t size)
{
    uint8_t toggle = 0, answer[8];

    for (uint32_t at = 0, count; at < size || at == 0; at += count, toggle ^= 0x10) {
        uint8_t request[8] = { 0 };
        uint32_t result;

        count = size - at < 7 ? size - at : 7;
        request[0] = (uint8_t)(toggle | (7 - count) << 1 | (at + count == size));
        if (count > 0)
            memcpy(request + 1, bytes + at, count);
        result = step(self, request, 0xFF, 0x20 | toggle, answer);
        if (result != SDO_OK || at + count == size)
            return result;
    }
    return SDO_OK;
}

uint32_t conform_write(struct conform *self, uint16_t index, uint8_t sub, const void *bytes,
                       uint32_t size)
{
    const bool expedited = size >= 1 && size <= 4;
    uint8_t request[8], answer[8];
    uint32_t result;

    conform_request(request, expedited ? (uint8_t)(0x23 | (4 - size) << 2) : 0x21, index, sub);
    if (expedited)
        memcpy(request + 4, bytes, size);
    else
        put_le32(request + 4, size);
    result = step(self, request, 0xFF, 0x60, answer);
    if (result != SDO_OK || expedited)
        return result;
    result = write_segments(self, bytes, size);
    if (result == CONFORM_BAD_ANSWER)
        give_up(self, index, sub);
    return result;
}

uint32_t conform_write_number(struct conform *self, uint16_t index, uint8_t sub, uint32_t size,
                              uint64_t number)
{
    uint8_t bytes[8];

    put_le(bytes, sizeof bytes, number);
    return conform_write(self, index, sub, bytes, size);
}

/* --- what must work, and what must not --- */

static bool fail_access(struct conform *self, const char *what, uint16_t index, uint8_t sub,
                        uint32_t result)
{
    char text[CONFORM_RESULT_SIZE];

    if (result == CONFORM_BAD_ANSWER)
        return conform_fail(self, "%s %04Xh:%02X: expected success, received %s", what, index, sub,
                            self->bad_answer);
    return conform_fail(self, "%s %04Xh:%02X: expected success, received %s", what, index, sub,
                        conform_result_text(result, text, sizeof text));
}

bool conform_must_read(struct conform *self, uint16_t index, uint8_t sub,
                       struct conform_value *ret_value)
{
    const uint32_t result = conform_read(self, index, sub, ret_value);

    return result == SDO_OK || fail_access(self, "read", index, sub, result);
}

bool conform_must_read_number(struct conform *self, uint16_t index, uint8_t sub,
                              uint64_t *ret_number)
{
    struct conform_value value;

    if (!conform_must_read(self, index, sub, &value))
        return false;
    if (value.size > 8)
        return conform_fail(self, "read %04Xh:%02X: expected a number, received %u bytes", index,
                            sub, (unsigned)value.size);
    *ret_number = get_le(value.bytes, value.size);
    return true;
}

bool conform_must_write_bytes(struct conform *self, uint16_t index, uint8_t sub, const void *bytes,
                              uint32_t size)
{
    const uint32_t result = conform_write(self, index, sub, bytes, size);

    return result == SDO_OK || fail_access(self, "write", index, sub, result);
}

bool conform_must_write(struct conform *self, uint16_t index, uint8_t sub, uint32_t size,
                        uint64_t number)
{
    uint8_t bytes[8];

    put_le(bytes, sizeof bytes, number);
    return conform_must_write_bytes(self, index, sub, bytes, size);
}

bool conform_must_abort(struct conform *self, const char *what, uint32_t result,
                        const uint32_t *codes)
{
    char expected[256] = "", received[CONFORM_RESULT_SIZE];
    size_t length = 0;

    for (size_t i = 0; codes[i] != 0; i++) {
        if (codes[i] == result)
            return true;
        if (length < sizeof expected)
            length += (size_t)snprintf(expected + length, sizeof expected - length, "%s%08X",
                                       i == 0 ? "" : " or ", (unsigned)codes[i]);
    }
    return conform_fail(self, "%s: expected abort %s, received %s", what, expected,
                        result == CONFORM_BAD_ANSWER
                            ? self->bad_answer
                            : conform_result_text(result, received, sizeof received));
}

bool conform_must_answer_abort(struct conform *self, const char *what, const uint8_t answer[8],
                               const uint32_t *codes)
{
    static const uint8_t silence[8]; /* as conform_exchange() has it */

    if (answer[0] == 0x80)
        return conform_must_abort(self, what, get_le32(answer + 4), codes);
    if (memcmp(answer, silence, sizeof silence) == 0)
        return conform_must_abort(self, what, CONFORM_NO_ANSWER, codes);
    return conform_fail(self, "%s: expected abort %08X, received %02X %02X %02X %02X ...", what,
                        (unsigned)codes[0], answer[0], answer[1], answer[2], answer[3]);
}
