/*
 * Checks of the default SDO server: transfers in segments.
 */
#include "check_common.h"
#include "conform_families.h"

#include "base/bytes.h"
#include "od/abort.h"

#include <string.h>

#define RESPONSE(self) (0x580u + (self)->options.node)

#define SERVER_TIMEOUT 3000u /* ms; those who never give up are not waited for longer */
#define LONG_UPLOAD    (255u * 7u + 1u)

static const uint32_t sizes[] = { 2, 4 };
#define SIZES (sizeof sizes / sizeof sizes[0])

static const uint32_t *const too_long = CODES(SDO_TOO_LONG, SDO_TYPE_LENGTH, SDO_GENERAL);
static const uint32_t *const too_short = CODES(SDO_TOO_SHORT, SDO_TYPE_LENGTH, SDO_GENERAL);

/* What most checks here need. NULL: skipped. */
static const struct conform_object *need_long(struct conform *self, uint32_t size)
{
    const struct conform_object *object = conform_long_object(self, size);

    if (!object)
        conform_skip(self, "the device has no value of %u bytes or more", (unsigned)size);
    return object;
}

static const struct conform_object *need_writable(struct conform *self)
{
    const struct conform_object *object = conform_writable(self, 2);

    if (!object)
        object = conform_writable(self, 4);
    if (!object)
        conform_skip(self, "no object is known that can be written back without harm: give one "
                           "with --eds FILE");
    return object;
}

/* --- uploads --- */

/* Command 40, and that the answer begins a transfer in segments. */
static bool begin_upload(struct conform *self, const struct conform_object *object,
                         uint8_t answer[8])
{
    if (!check_ask(self, 0x40, object->index, object->sub, answer))
        return conform_fail(self, "read %04Xh:%02X: no answer", object->index, object->sub);
    if ((answer[0] & 0xFE) == 0x40)
        return true;
    return conform_fail(self, "read %04Xh:%02X: expected 41 or 40, received %02X", object->index,
                        object->sub, answer[0]);
}

static bool check_segmented_read(struct conform *self)
{
    const struct conform_object *object = need_long(self, 5);
    struct conform_value value;

    if (!object || !conform_must_read(self, object->index, object->sub, &value))
        return false;
    if (value.announced != 0 && value.size != value.announced && !value.cut)
        return conform_fail(self, "%04Xh:%02X: %u bytes were announced, received %u", object->index,
                            object->sub, (unsigned)value.announced, (unsigned)value.size);
    return check_still_serves(self);
}

/* Toggle bits and lengths are seen to by conform_read(). */
static bool check_long_read(struct conform *self)
{
    const struct conform_object *object = conform_long_object(self, LONG_UPLOAD);
    struct conform_value value;

    if (!object)
        return conform_skip(self, "the device has no value of more than 255 segments");
    return conform_must_read(self, object->index, object->sub, &value);
}

static bool check_toggle_upload(struct conform *self)
{
    const struct conform_object *object = need_long(self, 5);
    uint8_t answer[8];

    if (!object || !begin_upload(self, object, answer))
        return false;
    check_ask(self, 0x70, 0, 0, answer);
    return conform_must_answer_abort(self, "first segment with toggle bit 1", answer,
                                     CODES(SDO_TOGGLE)) &&
           check_still_serves(self);
}

static bool check_toggle_upload_next(struct conform *self)
{
    const struct conform_object *object = need_long(self, 8);
    const uint8_t first[8] = { 0x60 };
    uint8_t answer[8];

    if (!object || !begin_upload(self, object, answer) || !check_step(self, first, 0x00, answer))
        return false;
    conform_exchange(self, first, answer);
    return conform_must_answer_abort(self, "second segment with toggle bit 0", answer,
                                     CODES(SDO_TOGGLE)) &&
           check_still_serves(self);
}

static bool check_upload_idle(struct conform *self)
{
    uint8_t answer[8];

    check_ask(self, 0x60, 0, 0, answer);
    return conform_must_answer_abort(self, "upload segment without a transfer", answer,
                                     CODES(SDO_COMMAND, SDO_GENERAL));
}

static bool check_abort_upload(struct conform *self)
{
    const struct conform_object *object = need_long(self, 5);
    uint8_t request[8], answer[8];
    size_t from;

    if (!object || !begin_upload(self, object, answer))
        return false;
    conform_request(request, 0x80, object->index, object->sub);
    put_le32(request + 4, SDO_GENERAL);
    from = conform_send_data(self, 0x600u + self->options.node, request, 8);
    if (!conform_expect_none(self, from, RESPONSE(self), CONFORM_QUIET))
        return false;
    check_ask(self, 0x60, 0, 0, answer);
    return conform_must_answer_abort(self, "upload segment after an abort", answer,
                                     CODES(SDO_COMMAND, SDO_GENERAL)) &&
           check_still_serves(self);
}

/* Both are legal: the new request is served, or both transfers end with an abort. */
static bool check_interrupted(struct conform *self)
{
    const struct conform_object *object = need_long(self, 5);
    uint8_t answer[8];

    if (!object || !begin_upload(self, object, answer))
        return false;
    if (!check_ask(self, 0x40, 0x1000, 0, answer))
        return conform_fail(self, "a request in the middle of a transfer: no answer");
    if (answer[0] != 0x43 &&
        !conform_must_answer_abort(self, "a request in the middle of a transfer", answer,
                                   CODES(SDO_COMMAND, SDO_GENERAL, SDO_DEVICE_STATE)))
        return false;
    return check_still_serves(self);
}

/* A server that still waits may refuse what comes next, with which its transfer ends. */
static bool serves_at_last(struct conform *self)
{
    struct conform_value value;

    return conform_read(self, 0x1000, 0, &value) == SDO_COMMAND || check_still_serves(self);
}

/* Giving up silently is as good as telling. */
static bool check_timeout(struct conform *self)
{
    const struct conform_object *object = need_long(self, 5);
    uint8_t answer[8];
    size_t at;

    if (!object || !begin_upload(self, object, answer))
        return false;
    at = conform_await(self, conform_mark(self), RESPONSE(self), SERVER_TIMEOUT);
    if (at != CONFORM_NOTHING &&
        !conform_must_answer_abort(self, "an upload that does not go on",
                                   conform_frame(self, at)->data, CODES(SDO_TIMEOUT)))
        return false;
    return serves_at_last(self) && check_still_serves(self);
}

/* An empty value has one segment without data; "no data" is another way to say it. */
static bool check_empty_read(struct conform *self)
{
    for (size_t i = 0; i < self->object_count; i++) {
        const struct conform_object *object = &self->objects[i];
        struct conform_value value;
        uint32_t result;

        if (!object->entry || od_type_size(object->type) != 0 || object->access == OD_WO)
            continue;
        result = conform_read(self, object->index, object->sub, &value);
        if (result == SDO_NO_DATA || (result == SDO_OK && value.size == 0))
            return true;
        if (result == CONFORM_NO_ANSWER)
            return conform_fail(self, "read %04Xh:%02X: no answer", object->index, object->sub);
    }
    return conform_skip(self, "no string or domain without contents is known");
}

/* --- downloads --- */

struct download {
    const struct conform_object *object;
    struct conform_value before;
};

static bool begin(struct conform *self, struct download *download)
{
    download->object = need_writable(self);
    return download->object && conform_must_read(self, download->object->index,
                                                 download->object->sub, &download->before);
}

/* The request that begins a download; announced UINT32_MAX: without a size. */
static void make_initiate(const struct download *download, uint32_t announced, uint8_t request[8])
{
    conform_request(request, announced == UINT32_MAX ? 0x20 : 0x21, download->object->index,
                    download->object->sub);
    if (announced != UINT32_MAX)
        put_le32(request + 4, announced);
}

/* A segment with the first bytes of the present value. */
static void make_segment(const struct download *download, uint8_t toggle, uint32_t count, bool last,
                         uint8_t request[8])
{
    memset(request, 0, 8);
    request[0] = (uint8_t)(toggle | (7 - count) << 1 | last);
    memcpy(request + 1, download->before.bytes, count);
}

static bool write_in_segments(struct conform *self, uint32_t size, bool with_size)
{
    struct download download = { .object = conform_writable(self, size) };
    uint8_t request[8], answer[8];

    if (!download.object)
        return true;
    if (!conform_must_read(self, download.object->index, download.object->sub, &download.before))
        return false;
    make_initiate(&download, with_size ? size : UINT32_MAX, request);
    if (!check_step(self, request, 0x60, answer))
        return false;
    make_segment(&download, 0, size, true, request);
    return check_step(self, request, 0x20, answer) &&
           check_unchanged(self, download.object, &download.before);
}

static bool check_segmented_write(struct conform *self)
{
    if (!need_writable(self))
        return false;
    for (size_t i = 0; i < SIZES; i++)
        if (!write_in_segments(self, sizes[i], true))
            return false;
    return true;
}

static bool check_segmented_no_size(struct conform *self)
{
    if (!need_writable(self))
        return false;
    for (size_t i = 0; i < SIZES; i++)
        if (!write_in_segments(self, sizes[i], false))
            return false;
    return true;
}

static bool check_toggle_download(struct conform *self)
{
    struct download download;
    uint8_t request[8], answer[8];

    if (!begin(self, &download))
        return false;
    make_initiate(&download, download.before.size, request);
    if (!check_step(self, request, 0x60, answer))
        return false;
    make_segment(&download, 0x10, download.before.size, true, request);
    conform_exchange(self, request, answer);
    return conform_must_answer_abort(self, "first segment with toggle bit 1", answer,
                                     CODES(SDO_TOGGLE)) &&
           check_unchanged(self, download.object, &download.before);
}

static bool check_download_idle(struct conform *self)
{
    const uint8_t request[8] = { 0x00, 1, 2, 3, 4, 5, 6, 7 };
    uint8_t answer[8];

    if (!conform_exchange(self, request, answer))
        return conform_fail(self, "download segment without a transfer: no answer");
    return conform_must_answer_abort(self, "download segment without a transfer", answer,
                                     CODES(SDO_COMMAND, SDO_GENERAL));
}

/* Segments of the present value, one byte each, until the server refuses; its last answer. */
static bool send_bytes(struct conform *self, const struct download *download, unsigned count,
                       uint8_t answer[8])
{
    uint8_t toggle = 0, request[8];

    for (unsigned i = 0; i < count; i++, toggle ^= 0x10) {
        make_segment(download, toggle, 1, i + 1 == count, request);
        if (!conform_exchange(self, request, answer))
            return false;
        if ((answer[0] & 0xEF) != 0x20)
            break;
    }
    return true;
}

/* Refused at once, or when as many bytes have come. */
static bool check_announced_too_long(struct conform *self)
{
    struct download download;
    uint8_t request[8], answer[8];

    if (!begin(self, &download))
        return false;
    make_initiate(&download, 100, request);
    if (conform_exchange(self, request, answer) && answer[0] == 0x60)
        send_bytes(self, &download, 100, answer);
    return conform_must_answer_abort(self, "100 bytes to a number", answer, too_long) &&
           check_unchanged(self, download.object, &download.before);
}

static bool check_announced_exceeded(struct conform *self)
{
    struct download download;
    uint8_t request[8], answer[8];

    if (!begin(self, &download))
        return false;
    make_initiate(&download, download.before.size, request);
    if (!check_step(self, request, 0x60, answer))
        return false;
    send_bytes(self, &download, download.before.size + 1, answer);
    return conform_must_answer_abort(self, "a byte more than announced", answer, too_long) &&
           check_unchanged(self, download.object, &download.before);
}

static bool check_announced_missed(struct conform *self)
{
    struct download download;
    uint8_t request[8], answer[8];

    if (!begin(self, &download))
        return false;
    make_initiate(&download, download.before.size, request);
    if (!check_step(self, request, 0x60, answer))
        return false;
    send_bytes(self, &download, 1, answer);
    return conform_must_answer_abort(self, "fewer bytes than announced", answer, too_short) &&
           check_unchanged(self, download.object, &download.before);
}

/* A number without any byte: refused at once, or after its empty segment. */
static bool check_empty_number(struct conform *self)
{
    const uint8_t segment[8] = { 0x0F };
    struct download download;
    uint8_t request[8], answer[8];

    if (!begin(self, &download))
        return false;
    make_initiate(&download, 0, request);
    if (conform_exchange(self, request, answer) && answer[0] == 0x60)
        conform_exchange(self, segment, answer);
    return conform_must_answer_abort(self, "0 bytes to a number", answer, too_short) &&
           check_unchanged(self, download.object, &download.before);
}

static bool check_abort_download(struct conform *self)
{
    struct download download;
    uint8_t request[8], answer[8];
    size_t from;

    if (!begin(self, &download))
        return false;
    make_initiate(&download, download.before.size, request);
    if (!check_step(self, request, 0x60, answer))
        return false;
    conform_request(request, 0x80, download.object->index, download.object->sub);
    put_le32(request + 4, SDO_GENERAL);
    from = conform_send_data(self, 0x600u + self->options.node, request, 8);
    return conform_expect_none(self, from, RESPONSE(self), CONFORM_QUIET) &&
           check_unchanged(self, download.object, &download.before);
}

static bool check_string_write(struct conform *self)
{
    const struct conform_object *object = check_writable_string(self, 8);
    struct conform_value before;

    if (!object)
        return conform_skip(self, "no writable string of 8 bytes or more is known: give one with "
                                  "--eds FILE");
    return conform_must_read(self, object->index, object->sub, &before) &&
           conform_must_write_bytes(self, object->index, object->sub, before.bytes, before.size) &&
           check_unchanged(self, object, &before);
}

/* More than any device keeps; it may say so when it is too much. */
static bool check_huge_string(struct conform *self)
{
    const uint32_t *codes = CODES(SDO_TOO_LONG, SDO_TYPE_LENGTH, SDO_NO_MEMORY, SDO_GENERAL);
    struct download download = { .object = check_writable_string(self, 1) };
    uint8_t request[8], answer[8];

    if (!download.object)
        return conform_skip(self, "no writable string with contents is known: give one with "
                                  "--eds FILE");
    if (!conform_must_read(self, download.object->index, download.object->sub, &download.before))
        return false;
    make_initiate(&download, 0xFFFFFFF0, request);
    conform_exchange(self, request, answer);
    if (answer[0] == 0x60)
        check_give_up(self, download.object);
    else if (!conform_must_answer_abort(self, "4 GiB to a string", answer, codes))
        return false;
    return check_unchanged(self, download.object, &download.before);
}

#define CLAUSE  "CiA 301, 7.2.4.3"
#define ABORTED "CiA 301, 7.2.4.3.17"

static const struct conform_check checks[] = {
    { "sdo-segmented-read", "more than 4 bytes are read in segments, as many as announced", CLAUSE,
      0, 0, check_segmented_read },
    { "sdo-long-read", "more than 255 segments are read, the toggle bit alternates", CLAUSE, 0, 0,
      check_long_read },
    { "sdo-empty-read", "a value without contents can be read", CLAUSE, 0, 0, check_empty_read },
    { "sdo-segmented-write", "2 and 4 bytes can be written in a segment", CLAUSE, 0, 0,
      check_segmented_write },
    { "sdo-segmented-no-size", "a segmented write needs no announced size", CLAUSE, 0, 0,
      check_segmented_no_size },
    { "sdo-string-write", "a string can be written back in segments", CLAUSE, CONFORM_EDS, 0,
      check_string_write },
    { "sdo-toggle-upload", "a first upload segment with toggle bit 1 is refused", ABORTED, 0, 0,
      check_toggle_upload },
    { "sdo-toggle-upload-next", "an upload segment with the last toggle bit is refused", ABORTED, 0,
      0, check_toggle_upload_next },
    { "sdo-toggle-download", "a download segment with the wrong toggle bit is refused", ABORTED, 0,
      0, check_toggle_download },
    { "sdo-upload-idle", "an upload segment without a transfer is refused", ABORTED, 0, 0,
      check_upload_idle },
    { "sdo-download-idle", "a download segment without a transfer is refused", ABORTED, 0, 0,
      check_download_idle },
    { "sdo-announced-too-long", "100 bytes for a number are refused", ABORTED, 0, 0,
      check_announced_too_long },
    { "sdo-announced-exceeded", "more bytes than announced are refused", ABORTED, 0, 0,
      check_announced_exceeded },
    { "sdo-announced-missed", "fewer bytes than announced are refused", ABORTED, 0, 0,
      check_announced_missed },
    { "sdo-empty-number", "a number without a byte is refused", ABORTED, 0, 0, check_empty_number },
    { "sdo-huge-string", "a string of 4 GiB does no harm", ABORTED, CONFORM_EDS, 0,
      check_huge_string },
    { "sdo-abort-upload", "an abort ends an upload", ABORTED, 0, 0, check_abort_upload },
    { "sdo-abort-download", "an abort ends a download, nothing is written", ABORTED, 0, 0,
      check_abort_download },
    { "sdo-interrupted", "a request in the middle of a transfer does no harm", CLAUSE, 0, 0,
      check_interrupted },
    { "sdo-timeout", "a transfer that does not go on does no harm", CLAUSE, 0, 0, check_timeout },
};

const struct conform_family conform_sdo_segment = { "sdo", "SDO in segments", checks,
                                                    sizeof checks / sizeof checks[0] };
