/* The writes that a file asks for, in the order that devices need. */
#include "dcf/dcf_maker.h"

#include "base/bytes.h"

#include <stdlib.h>
#include <string.h>

#define PDOS_MAX 512u

/* One that the device refuses as its own limits say is no value to write. */
static bool is_usable_default(const struct dcf_maker *self, const struct dcf_entry *entry)
{
    return entry->initial.given &&
           !dcf_value_outside(entry, &entry->initial, self->options->node_id);
}

const struct dcf_value *dcf_maker_value(const struct dcf_maker *self, const struct dcf_entry *entry)
{
    if (entry->parameter.given)
        return &entry->parameter;
    return self->options->all && is_usable_default(self, entry) ? &entry->initial : NULL;
}

bool dcf_maker_writes(const struct dcf_maker *self, const struct dcf_entry *entry)
{
    return (entry->download_file || dcf_maker_value(self, entry)) && dcf_entry_downloads(entry);
}

const struct dcf_entry *dcf_maker_find(const struct dcf_maker *self, uint16_t index, uint8_t sub)
{
    const struct dcf_entry *entry = dcf_find(self->dcf, index, sub);

    return entry && dcf_maker_writes(self, entry) ? entry : NULL;
}

static void append(struct dcf_maker *self, const struct dcf_entry *entry, const uint8_t *bytes,
                   uint32_t size)
{
    const struct dcf_value *value = dcf_maker_value(self, entry);
    unsigned line = value && !entry->download_file ? value->line : entry->line;

    if (ccf_append(&self->ccf, entry->index, entry->sub, bytes, size) != CO_OK ||
        ccf_note_line(&self->ccf, line) != CO_OK)
        self->no_memory = true;
}

void dcf_maker_put_number(struct dcf_maker *self, const struct dcf_entry *entry, uint64_t number)
{
    uint8_t bytes[8];
    uint32_t size = od_type_size(entry->type);

    put_le(bytes, size, number);
    append(self, entry, bytes, size);
}

static void put_file(struct dcf_maker *self, const struct dcf_entry *entry)
{
    const struct dcf_ccf_options *options = self->options;
    struct dcf_shown name = dcf_show(dcf_slice_of(entry->download_file));
    enum co_err err = CO_ERR_NOT_FOUND;
    uint8_t *bytes = NULL;
    size_t size = 0;

    if (!dcf_stays_below(entry->download_file)) {
        dcf_tell(self->report, DCF_RULE_DOWNLOAD_FOLDER, entry->line,
                 "%04Xh:%02X DownloadFile: a name below the folder of this file expected, "
                 "there is \"%s\"",
                 entry->index, entry->sub, name.text);
        return;
    }
    if (options->read_file)
        err = options->read_file(options->context, entry->download_file, &bytes, &size);
    if (err == CO_OK && size <= UINT32_MAX)
        append(self, entry, bytes, (uint32_t)size);
    else
        dcf_tell(self->report, DCF_RULE_DOWNLOAD_FILE, entry->line,
                 "%04Xh:%02X DownloadFile: a readable file expected, \"%s\": %s", entry->index,
                 entry->sub, name.text, err == CO_OK ? "too long" : co_err_text(err));
    free(bytes);
}

static void put_value(struct dcf_maker *self, const struct dcf_entry *entry,
                      const struct dcf_value *value)
{
    uint8_t node_id = self->options->node_id;
    uint8_t *bytes;

    if (value->has_node_id && (node_id == 0 || !dcf_formula_fits(value, node_id))) {
        dcf_tell(self->report, node_id == 0 ? DCF_RULE_FORMULA_NODE_ID : DCF_RULE_NODE_ID_FORMULA,
                 value->line,
                 "%04Xh:%02X %s: a node-ID expected with which the formula fits %s, it is %u",
                 entry->index, entry->sub,
                 value == &entry->parameter ? "ParameterValue" : "DefaultValue",
                 od_type_name(entry->type), node_id);
        return;
    }
    bytes = malloc(value->size + 1);
    if (!bytes) {
        self->no_memory = true;
        return;
    }
    append(self, entry, bytes, dcf_value(value, node_id, bytes));
    free(bytes);
}

void dcf_maker_put(struct dcf_maker *self, const struct dcf_entry *entry)
{
    const struct dcf_value *value = dcf_maker_value(self, entry);

    if (entry->download_file)
        put_file(self, entry);
    else if (value)
        put_value(self, entry, value);
}

static bool same(const struct dcf_value *a, const struct dcf_value *b)
{
    return a->given && b->given && a->size == b->size && a->has_node_id == b->has_node_id &&
           memcmp(a->bytes, b->bytes, a->size) == 0;
}

/* A value that is meant to be written and is not; one that the device has anyway is no news. */
static void tell_refused(const struct dcf_maker *self, const struct dcf_entry *entry)
{
    bool read_only = entry->access == OD_RO || entry->access == OD_CONST;

    if (!entry->parameter.given && !entry->download_file)
        return;
    if (dcf_entry_downloads(entry) || same(&entry->parameter, &entry->initial))
        return;
    dcf_tell(self->report, DCF_RULE_VALUE_NOT_WRITTEN,
             entry->parameter.given ? entry->parameter.line : entry->line,
             "%04Xh:%02X: a value for a writable entry expected, %s: not written", entry->index,
             entry->sub,
             read_only          ? "this one is read-only"
             : entry->flags & 1 ? "ObjFlags refuses to write this one"
                                : "configurations leave this object alone");
}

enum place { PLACE_ELSEWHERE, PLACE_BY_INDEX };

static enum place place_of(uint16_t index)
{
    switch (index) {
    case 0x1005:
    case 0x1006:
    case 0x1019:
    case 0x100C:
    case 0x100D:
    case 0x1016:
    case 0x1017:
    case 0x1020: return PLACE_ELSEWHERE;
    default: return dcf_is_pdo(index) ? PLACE_ELSEWHERE : PLACE_BY_INDEX;
    }
}

static void put_all(struct dcf_maker *self)
{
    const struct dcf *dcf = self->dcf;

    for (size_t i = 0; i < dcf->count; i++) {
        tell_refused(self, &dcf->entries[i]);
        if (place_of(dcf->entries[i].index) == PLACE_BY_INDEX &&
            dcf_maker_writes(self, &dcf->entries[i]))
            dcf_maker_put_single(self, &dcf->entries[i]);
    }
    dcf_maker_put_sync(self);
    dcf_maker_put_error_control(self);
    for (unsigned i = 0; i < PDOS_MAX; i++)
        dcf_maker_put_pdo(self, (uint16_t)(0x1400 + i));
    for (unsigned i = 0; i < PDOS_MAX; i++)
        dcf_maker_put_pdo(self, (uint16_t)(0x1800 + i));
    for (uint8_t sub = 0; sub <= 2; sub++) {
        if (dcf_maker_find(self, 0x1020, sub))
            dcf_maker_put(self, dcf_maker_find(self, 0x1020, sub));
    }
}

enum co_err dcf_make_ccf(const struct dcf *self, const struct dcf_ccf_options *options,
                         struct co_report *report, struct ccf *ret_ccf)
{
    static const uint8_t none[4];
    struct dcf_maker maker = { .dcf = self, .options = options, .report = report };
    unsigned errors = report->errors;

    ccf_init(&maker.ccf);
    put_all(&maker);
    if (report->errors > errors || maker.no_memory) {
        ccf_done(&maker.ccf);
        return report->errors > errors ? CO_ERR_VALUE : CO_ERR_MEMORY;
    }
    if (maker.ccf.size == 0)
        return ccf_parse(none, sizeof none, report, ret_ccf);
    *ret_ccf = maker.ccf;
    return CO_OK;
}
