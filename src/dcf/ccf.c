#include "dcf/ccf.h"

#include "base/bytes.h"

#include <stdlib.h>
#include <string.h>

#define COUNT_SIZE  4u
#define HEADER_SIZE 7u /* index, sub-index, size */

void ccf_init(struct ccf *self)
{
    *self = (struct ccf){ .size = 0 };
}

void ccf_done(struct ccf *self)
{
    free(self->bytes);
    free(self->lines);
    ccf_init(self);
}

uint32_t ccf_count(const struct ccf *self)
{
    return self->size < COUNT_SIZE ? 0 : get_le32(self->bytes);
}

static enum co_err make_room(struct ccf *self, uint64_t more)
{
    size_t room = self->room < 64 ? 64 : self->room;
    uint8_t *bytes;

    if (more > SIZE_MAX / 2 - self->size)
        return CO_ERR_MEMORY;
    while (room < self->size + more)
        room *= 2;
    if (room == self->room)
        return CO_OK;
    bytes = realloc(self->bytes, room);
    if (!bytes)
        return CO_ERR_MEMORY;
    self->bytes = bytes;
    self->room = room;
    return CO_OK;
}

enum co_err ccf_append(struct ccf *self, uint16_t index, uint8_t sub, const uint8_t *value,
                       uint32_t size)
{
    size_t start = self->size < COUNT_SIZE ? COUNT_SIZE : self->size;
    uint32_t count = ccf_count(self);
    uint8_t *entry;

    if (count == UINT32_MAX || make_room(self, (uint64_t)COUNT_SIZE + HEADER_SIZE + size) != CO_OK)
        return CO_ERR_MEMORY;
    entry = self->bytes + start;
    put_le16(entry, index);
    entry[2] = sub;
    put_le32(entry + 3, size);
    if (size > 0)
        memcpy(entry + HEADER_SIZE, value, size);
    put_le32(self->bytes, count + 1);
    self->size = start + HEADER_SIZE + size;
    return CO_OK;
}

/* Cannot overflow: there are fewer lines than bytes of entries, by far. */
static enum co_err make_room_for_lines(struct ccf *self, size_t count)
{
    size_t room = self->line_room < 16 ? 16 : self->line_room;
    unsigned *lines;

    while (room < count)
        room *= 2;
    if (room == self->line_room)
        return CO_OK;
    lines = realloc(self->lines, room * sizeof *lines);
    if (!lines)
        return CO_ERR_MEMORY;
    self->lines = lines;
    self->line_room = room;
    return CO_OK;
}

enum co_err ccf_note_line(struct ccf *self, unsigned line)
{
    uint32_t count = ccf_count(self);

    if (count == 0 || make_room_for_lines(self, count) != CO_OK)
        return count == 0 ? CO_OK : CO_ERR_MEMORY;
    while (self->line_count < count)
        self->lines[self->line_count++] = 0;
    self->lines[count - 1] = line;
    return CO_OK;
}

unsigned ccf_line(const struct ccf *self, uint32_t number)
{
    return number >= 1 && number <= self->line_count ? self->lines[number - 1] : 0;
}

void ccf_reader_init(struct ccf_reader *self, const struct ccf *ccf)
{
    *self = (struct ccf_reader){
        .bytes = ccf->bytes, .size = ccf->size, .position = COUNT_SIZE, .left = ccf_count(ccf)
    };
}

static void step(struct ccf_reader *self, struct ccf_entry *ret_entry)
{
    const uint8_t *entry = self->bytes + self->position;

    *ret_entry = (struct ccf_entry){ .index = get_le16(entry),
                                     .sub = entry[2],
                                     .size = get_le32(entry + 3),
                                     .value = entry + HEADER_SIZE };
    self->position += HEADER_SIZE + (size_t)ret_entry->size;
    self->left--;
}

bool ccf_read(struct ccf_reader *self, struct ccf_entry *ret_entry)
{
    if (self->left == 0)
        return false;
    step(self, ret_entry);
    return true;
}

void ccf_reader_init_bytes(struct ccf_reader *self, const uint8_t *bytes, size_t size,
                           struct co_report *report)
{
    *self = (struct ccf_reader){ .bytes = bytes, .size = size };
    if (size >= COUNT_SIZE) {
        self->left = get_le32(bytes);
        self->position = COUNT_SIZE;
        return;
    }
    co_report_add(report, CO_ERROR, 0,
                  "a concise DCF begins with a count of %u bytes, the file has %zu", COUNT_SIZE,
                  size);
    co_report_kind(report, CCF_TRUNCATED);
    self->broken = true;
}

static bool break_off(struct ccf_reader *self)
{
    self->broken = true;
    return false;
}

/* What is wrong with the entry at the position goes to the report. */
static bool is_whole(struct ccf_reader *self, struct co_report *report)
{
    const uint8_t *entry = self->bytes + self->position;
    uint32_t count = get_le32(self->bytes), number = count - self->left + 1;
    size_t left = self->size - self->position;

    if (left < HEADER_SIZE) {
        co_report_add(report, CO_ERROR, 0,
                      "entry %lu of %lu at byte %zu: %u bytes of header expected, %zu are left",
                      (unsigned long)number, (unsigned long)count, self->position, HEADER_SIZE,
                      left);
        co_report_kind(report, CCF_TRUNCATED);
        return break_off(self);
    }
    left -= HEADER_SIZE;
    if (left < get_le32(entry + 3)) {
        co_report_add(report, CO_ERROR, 0,
                      "entry %lu of %lu at byte %zu (%04Xh:%02X): a value of %lu bytes expected, "
                      "%zu are left",
                      (unsigned long)number, (unsigned long)count, self->position, get_le16(entry),
                      entry[2], (unsigned long)get_le32(entry + 3), left);
        co_report_kind(report, CCF_TRUNCATED);
        return break_off(self);
    }
    return true;
}

bool ccf_read_checked(struct ccf_reader *self, struct co_report *report,
                      struct ccf_entry *ret_entry)
{
    if (self->broken)
        return false;
    if (self->left > 0) {
        if (!is_whole(self, report))
            return false;
        step(self, ret_entry);
        return true;
    }
    if (self->position == self->size)
        return false;
    co_report_add(
        report, CO_ERROR, 0, "the %lu entries of the count end at byte %zu, %zu more bytes follow",
        (unsigned long)get_le32(self->bytes), self->position, self->size - self->position);
    return break_off(self);
}

enum co_err ccf_parse(const uint8_t *bytes, size_t size, struct co_report *report,
                      struct ccf *ret_ccf)
{
    struct ccf_reader reader;
    struct ccf_entry entry;
    struct ccf ccf;

    ccf_reader_init_bytes(&reader, bytes, size, report);
    while (ccf_read_checked(&reader, report, &entry)) {
    }
    if (reader.broken)
        return CO_ERR_FORMAT;
    ccf_init(&ccf);
    if (make_room(&ccf, size) != CO_OK)
        return CO_ERR_MEMORY;
    memcpy(ccf.bytes, bytes, size);
    ccf.size = size;
    *ret_ccf = ccf;
    return CO_OK;
}
