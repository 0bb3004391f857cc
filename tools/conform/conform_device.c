#include "conform.h"

#include "api/file.h"
#include "dcf/dcf_rules.h"
#include "od/abort.h"

#include <stdlib.h>
#include <string.h>

#define FIRST_OBJECT 0x1000u
#define PROBED_GAP   0x50u /* a drive's second axis has its PDOs 40h behind those of the first */

/* --- objects of the EDS --- */

struct messages {
    FILE *stream;
};

/* What CiA's checker only warns of. */
static bool is_minor(const struct co_message *message)
{
    return message->rule == &dcf_rules[DCF_RULE_UNKNOWN_SECTION] ||
           message->rule == &dcf_rules[DCF_RULE_UNKNOWN_KEY] ||
           message->rule == &dcf_rules[DCF_RULE_LINE_LENGTH];
}

static void keep_message(void *context, const struct co_message *message)
{
    const struct messages *self = context;

    if (is_minor(message))
        return;
    fprintf(self->stream, "%s\n", message->text);
}

static bool parse_eds(struct conform *self, struct co_report *report)
{
    size_t size;
    char *text;
    enum co_err err = file_read(self->options.eds, &text, &size);

    if (err != CO_OK) {
        co_report_add(report, CO_ERROR, 0, "%s", file_error_text(err));
        return false;
    }
    err = dcf_parse(text, size, report, &self->eds);
    free(text);
    return err == CO_OK;
}

/* A file with errors is a finding of the family "eds"; the run goes on as if there were none. */
static bool read_eds(struct conform *self)
{
    struct messages messages;
    struct co_report report = { .file = self->options.eds,
                                .sink = keep_message,
                                .context = &messages };
    size_t size;

    messages.stream = open_memstream(&self->eds_messages, &size);
    if (!messages.stream)
        return false;
    self->has_eds = parse_eds(self, &report);
    fclose(messages.stream);
    return true;
}

static struct conform_object *add_object(struct conform *self, uint16_t index, uint8_t sub)
{
    struct conform_object *objects = realloc(self->objects,
                                             (self->object_count + 1) * sizeof *objects);

    if (!objects)
        return NULL;
    self->objects = objects;
    objects[self->object_count] = (struct conform_object){ .index = index,
                                                           .sub = sub,
                                                           .access = CONFORM_UNKNOWN };
    return &objects[self->object_count++];
}

static bool take_eds_objects(struct conform *self)
{
    for (size_t i = 0; i < self->eds.count; i++) {
        const struct dcf_entry *entry = &self->eds.entries[i];
        struct conform_object *object;

        if (entry->index < FIRST_OBJECT || entry->access == OD_NONE)
            continue;
        object = add_object(self, entry->index, entry->sub);
        if (!object)
            return false;
        object->type = entry->type;
        object->access = entry->access;
        object->entry = entry;
    }
    return true;
}

/* --- objects found by reading --- */

static bool is_absent(uint32_t result)
{
    return result == SDO_NO_OBJECT || result == SDO_NO_SUB || result == SDO_GENERAL;
}

/* A number in sub-index 0 of an object that has a sub-index 1 counts the others. */
static bool probe_subs(struct conform *self, uint16_t index, const struct conform_value *first)
{
    struct conform_value value;

    if (first->size != 1 || is_absent(conform_read(self, index, 1, &value)))
        return true;
    for (unsigned sub = 1; sub == 1 || sub <= first->bytes[0]; sub++) {
        const uint32_t result = conform_read(self, index, (uint8_t)sub, &value);

        if (result == CONFORM_NO_ANSWER || sub == 0xFF)
            break;
        if (!is_absent(result) && !add_object(self, index, (uint8_t)sub))
            return false;
    }
    return true;
}

/* false: no memory */
static bool probe_object(struct conform *self, uint16_t index, uint32_t *ret_result)
{
    struct conform_value value;

    *ret_result = conform_read(self, index, 0, &value);
    self->frame_count = 0;
    if (*ret_result == CONFORM_NO_ANSWER || is_absent(*ret_result))
        return true;
    return add_object(self, index, 0) && probe_subs(self, index, &value);
}

/*
 * On a slow bus it takes long to ask for each index: what belongs together stands together. Ends
 * where the device falls silent.
 */
static bool probe_range(struct conform *self, uint32_t first, uint32_t last)
{
    uint32_t result = SDO_OK;

    for (uint32_t index = first, seen = first; index <= last && index - seen < PROBED_GAP;
         index++) {
        if (!probe_object(self, (uint16_t)index, &result))
            return false;
        if (result == CONFORM_NO_ANSWER)
            break;
        if (!is_absent(result))
            seen = index;
    }
    return true;
}

static bool probe_objects(struct conform *self)
{
    static const struct {
        uint16_t first, last;
    } ranges[] = { { 0x1000, 0x103F }, { 0x1200, 0x127F }, { 0x1280, 0x12FF },
                   { 0x1400, 0x15FF }, { 0x1600, 0x17FF }, { 0x1800, 0x19FF },
                   { 0x1A00, 0x1BFF }, { 0x1F20, 0x1F5F }, { 0x1F80, 0x1FFF } };

    for (size_t i = 0; i < sizeof ranges / sizeof ranges[0]; i++)
        if (!probe_range(self, ranges[i].first, ranges[i].last))
            return false;
    return true;
}

bool conform_know_device(struct conform *self)
{
    if (self->options.eds && !read_eds(self))
        return false;
    return self->has_eds ? take_eds_objects(self) : probe_objects(self);
}

void conform_forget_device(struct conform *self)
{
    if (self->has_eds)
        dcf_done(&self->eds);
    free(self->eds_messages);
    free(self->objects);
}

/* --- looking for objects --- */

const struct conform_object *conform_find(const struct conform *self, uint16_t index, uint8_t sub)
{
    for (size_t i = 0; i < self->object_count; i++)
        if (self->objects[i].index == index && self->objects[i].sub == sub)
            return &self->objects[i];
    return NULL;
}

bool conform_has(const struct conform *self, uint16_t index)
{
    for (size_t i = 0; i < self->object_count; i++)
        if (self->objects[i].index == index)
            return true;
    return false;
}

bool conform_need_object(struct conform *self, uint16_t index)
{
    return conform_has(self, index) || conform_skip(self, "the device has no %04Xh", index);
}

static bool is_writable(const struct conform_object *object)
{
    return object->access == OD_RW || object->access == OD_RWR || object->access == OD_RWW;
}

/* Whose access right is not known is asked for it. */
static bool can_write_back(struct conform *self, const struct conform_object *object, uint32_t size)
{
    struct conform_value value;

    if (object->access != CONFORM_UNKNOWN && !is_writable(object))
        return false;
    if (conform_read(self, object->index, object->sub, &value) != SDO_OK || value.size != size)
        return false;
    return object->access != CONFORM_UNKNOWN ||
           conform_write(self, object->index, object->sub, value.bytes, size) == SDO_OK;
}

static const struct conform_object *find_writable(struct conform *self, uint32_t size)
{
    static const struct {
        uint16_t index;
        uint8_t sub;
    } preferred[] = { { 0x1017, 0 }, { 0x100C, 0 }, { 0x100D, 0 }, { 0x1015, 0 },
                      { 0x1007, 0 }, { 0x1006, 0 }, { 0x1016, 1 }, { 0x1029, 1 },
                      { 0x1400, 2 }, { 0x1800, 2 }, { 0x1005, 0 }, { 0x1014, 0 } };

    for (size_t i = 0; i < sizeof preferred / sizeof preferred[0]; i++) {
        const struct conform_object *object = conform_find(self, preferred[i].index,
                                                           preferred[i].sub);

        if (object && can_write_back(self, object, size))
            return object;
    }
    for (size_t i = 0; i < self->object_count; i++) {
        const struct conform_object *object = &self->objects[i];

        if (object->index >= 0x2000 && object->entry && (object->entry->flags & 1u) == 0 &&
            od_type_size(object->type) == size && can_write_back(self, object, size))
            return object;
    }
    return NULL;
}

/* What was tried is of no interest to the check. */
const struct conform_object *conform_writable(struct conform *self, uint32_t size)
{
    const size_t from = conform_mark(self);
    const struct conform_object *object = find_writable(self, size);

    conform_drop(self, from);
    return object;
}

static bool may_be_long(const struct conform_object *object)
{
    const uint32_t size = od_type_size(object->type);

    return object->access != OD_WO && (object->type == 0 || size == 0 || size > 4);
}

/* As the server says: whether it can send it as well is for the checks to find out. */
static uint32_t long_size(struct conform *self, const struct conform_object *object)
{
    struct conform_value value;
    const uint32_t result = conform_read(self, object->index, object->sub, &value);

    return result == SDO_OK ? value.size : value.announced;
}

static const struct conform_object *find_long_object(struct conform *self, uint32_t size)
{
    for (size_t i = 0; i < self->object_count; i++)
        if (may_be_long(&self->objects[i]) && long_size(self, &self->objects[i]) >= size)
            return &self->objects[i];
    return NULL;
}

const struct conform_object *conform_long_object(struct conform *self, uint32_t size)
{
    const size_t from = conform_mark(self);
    const struct conform_object *object = find_long_object(self, size);

    conform_drop(self, from);
    return object;
}
