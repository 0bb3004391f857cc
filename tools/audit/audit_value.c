/* The values that a node will have, and where to change them. */
#include "audit.h"

#include "base/bytes.h"
#include "od/od.h"

#include <stdio.h>
#include <stdlib.h>

#define NUMBER_SIZE 8u

static uint32_t address_of(uint16_t index, uint8_t sub)
{
    return (uint32_t)index << 8 | sub;
}

static int compare(const void *a, const void *b)
{
    const struct audit_written *left = a, *right = b;

    return (left->address > right->address) - (left->address < right->address);
}

static const struct audit_written *find_written(const struct audit_node *self, uint16_t index,
                                                uint8_t sub)
{
    const struct audit_written key = { .address = address_of(index, sub) };

    if (self->written_count == 0)
        return NULL;
    return bsearch(&key, self->written, self->written_count, sizeof key, compare);
}

static uint64_t number_of(const uint8_t *bytes, uint32_t size)
{
    return get_le(bytes, size < NUMBER_SIZE ? size : NUMBER_SIZE);
}

static struct audit_value written_value(const struct audit_node *self,
                                        const struct audit_written *written)
{
    const struct audit_place dcf = { self->file, written->line };

    return (struct audit_value){ .known = true,
                                 .written = true,
                                 .number = number_of(written->bytes, written->size),
                                 .size = written->size,
                                 .place = self->config->dcf_file
                                              ? dcf
                                              : audit_node_place(self, "CCF_File") };
}

static struct audit_value given_value(const struct audit_node *self, const struct dcf_entry *entry,
                                      const struct dcf_value *given)
{
    struct audit_value value = { .place = { self->description_file, entry->line } };
    uint8_t bytes[NUMBER_SIZE];

    if (!given->given || given->size > sizeof bytes)
        return value;
    value.size = dcf_value(given, self->config->node_id, bytes);
    value.number = number_of(bytes, value.size);
    value.known = true;
    if (given->line != 0)
        value.place.line = given->line;
    return value;
}

static bool may_be_written(const struct dcf_entry *entry)
{
    return entry->access != OD_RO && entry->access != OD_CONST;
}

/* What a file that cannot be used would write: its DCF says so, a CCF does not. */
static struct audit_value intended_value(const struct audit_node *self,
                                         const struct dcf_entry *entry,
                                         const struct audit_value *preset)
{
    struct audit_value value = { .known = false };

    if (!self->has_dcf)
        return value;
    if (!entry->parameter.given)
        return *preset;
    value = given_value(self, entry, &entry->parameter);
    value.written = value.known;
    value.chosen = value.known && (!preset->known || preset->number != value.number);
    return value;
}

struct audit_value audit_value(const struct audit_node *self, uint16_t index, uint8_t sub)
{
    const struct audit_written *written = find_written(self, index, sub);
    const struct dcf_entry *entry = NULL;
    struct audit_value preset = { .known = false }, value;

    if (self->described)
        entry = dcf_find(&self->description, index, sub);
    if (entry)
        preset = given_value(self, entry, &entry->initial);
    if (written) {
        value = written_value(self, written);
        value.chosen = !preset.known || preset.number != value.number;
        return value;
    }
    if (entry && !self->configured && may_be_written(entry))
        return intended_value(self, entry, &preset);
    return preset;
}

uint64_t audit_number(const struct audit_node *self, uint16_t index, uint8_t sub, uint64_t missing)
{
    const struct audit_value value = audit_value(self, index, sub);

    if (value.known)
        return value.number;
    return audit_has(self, index, sub) ? 0 : missing;
}

bool audit_has(const struct audit_node *self, uint16_t index, uint8_t sub)
{
    return find_written(self, index, sub) ||
           (self->described && dcf_find(&self->description, index, sub));
}

bool audit_lacks(const struct audit_node *self, uint16_t index, uint8_t sub)
{
    return self->described && !dcf_find(&self->description, index, sub);
}

struct audit_place audit_entry_place(const struct audit_node *self, uint16_t index, uint8_t sub)
{
    const struct audit_value value = audit_value(self, index, sub);

    if (value.place.file)
        return value.place;
    if (self->described)
        return (struct audit_place){ self->description_file, 0 };
    return audit_node_place(self, "Node_Id");
}

int32_t audit_heartbeat_time(const struct audit_node *self)
{
    const struct audit_value value = audit_value(self, 0x1017, 0);

    if (value.known)
        return (int32_t)(value.number & UINT16_MAX);
    return self->described && (self->configured || self->has_dcf) ? 0 : -1;
}

bool audit_is_known(const struct audit_node *self)
{
    return self->described && self->configured;
}

bool audit_knows_all(const struct audit_network *self)
{
    for (size_t i = 0; i < self->node_count; i++)
        if (!audit_is_known(&self->nodes[i]))
            return false;
    return true;
}

const struct audit_node *audit_find_node(const struct audit_network *self, unsigned node_id)
{
    for (size_t i = 0; i < self->node_count; i++)
        if (self->nodes[i].config->node_id == node_id)
            return &self->nodes[i];
    return NULL;
}

struct audit_label audit_label(const struct audit_node *self)
{
    struct audit_label label;

    if (self->config->name)
        snprintf(label.text, sizeof label.text, "node %u \"%.40s\"", self->config->node_id,
                 self->config->name);
    else
        snprintf(label.text, sizeof label.text, "node %u", self->config->node_id);
    return label;
}

struct audit_label audit_can_id(uint32_t can_id)
{
    const uint32_t number = can_id & 0x1FFFFFFF;
    struct audit_label label;

    snprintf(label.text, sizeof label.text, can_id & 0x20000000 ? "%08Xh" : "%03Xh",
             (unsigned)number);
    return label;
}
