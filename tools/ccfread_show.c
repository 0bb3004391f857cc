#include "ccfread_show.h"

#include "base/bytes.h"
#include "ccfread_input.h"
#include "ccfread_value.h"

#include <stdio.h>

#define COUNT_SIZE   4u
#define WARNING_SIZE 256u

struct walk {
    struct show *show;
    struct input input;
    struct ccf_reader reader;
    unsigned long shown;
};

/* What keeps the device from taking the entry, as far as its EDS knows; "" : nothing. */
static void check_entry(const struct walk *self, const struct view_entry *entry,
                        char warning[WARNING_SIZE])
{
    const struct dcf_entry *described = entry->described;

    warning[0] = '\0';
    if (!described)
        snprintf(warning, WARNING_SIZE, "no such entry in %s", self->show->eds_name);
    else if (!value_fits(entry->entry, described->type))
        snprintf(warning, WARNING_SIZE, "%s of %lu bytes expected, there are %lu",
                 od_type_name(described->type), (unsigned long)od_type_size(described->type),
                 (unsigned long)entry->entry->size);
    else if (described->access == OD_RO || described->access == OD_CONST)
        snprintf(warning, WARNING_SIZE, "a writable entry expected, this one is read-only");
}

static bool show_entry(struct walk *self, const struct ccf_entry *entry, size_t offset, bool extra)
{
    const struct dcf *eds = self->show->eds;
    char warning[WARNING_SIZE];
    struct view_entry seen = { .entry = entry,
                               .described = eds ? dcf_find(eds, entry->index, entry->sub) : NULL,
                               .offset = offset,
                               .extra = extra,
                               .is_first = self->shown == 0 };
    bool good;

    if (eds)
        check_entry(self, &seen, warning);
    if (eds && warning[0])
        seen.warning = warning;
    self->shown++;
    good = self->show->view->show(&seen, eds != NULL);
    if (seen.warning)
        co_report_add(&self->input.report, CO_WARNING, 0, "entry %lu at byte %zu (%04Xh:%02X): %s",
                      self->shown, offset, entry->index, entry->sub, warning);
    return good;
}

static bool is_all_entries(struct ccf_reader reader)
{
    struct co_report quiet = { .file = NULL };
    struct ccf_entry entry;

    while (reader.position < reader.size && ccf_read_checked(&reader, &quiet, &entry)) {
    }
    return reader.position == reader.size;
}

/* A count that is too small hides entries, when what follows is whole. */
static bool show_extra(struct walk *self)
{
    struct co_report quiet = { .file = NULL };
    struct ccf_reader *reader = &self->reader;
    struct ccf_reader extra = *reader;
    struct ccf_entry entry;
    bool good = true;

    if (reader->size < COUNT_SIZE || reader->left > 0)
        return true;
    extra.broken = false;
    extra.left = UINT32_MAX;
    if (!is_all_entries(extra))
        return true;
    while (good && extra.position < extra.size) {
        reader->position = extra.position;
        good = ccf_read_checked(&extra, &quiet, &entry) &&
               show_entry(self, &entry, reader->position, true);
    }
    reader->position = extra.position;
    return good;
}

static bool show_entries(struct walk *self)
{
    struct ccf_reader *reader = &self->reader;
    struct ccf_entry entry;
    bool good = true;
    size_t offset;

    ccf_reader_init_bytes(reader, self->input.bytes, self->input.size, &self->input.report);
    do {
        offset = reader->position;
        if (!ccf_read_checked(reader, &self->input.report, &entry))
            break;
        good = show_entry(self, &entry, offset, false);
    } while (good);
    return good && (!reader->broken || show_extra(self));
}

static bool show_all(struct walk *self)
{
    const struct view *view = self->show->view;
    const struct input *input = &self->input;
    const struct view_file file = { .name = input->name,
                                    .bytes = input->bytes,
                                    .size = input->size,
                                    .count = input->size < COUNT_SIZE ? 0 : get_le32(input->bytes),
                                    .is_first = self->show->files++ == 0 };
    struct view_rest rest;

    if (!view->open(&file, self->show->eds != NULL) || !show_entries(self))
        return false;
    rest = (struct view_rest){ .bytes = input->bytes + self->reader.position,
                               .offset = self->reader.position,
                               .size = input->size - self->reader.position };
    return view->close(&file, &rest, self->reader.broken ? input->error : NULL);
}

int show_file(struct show *self, const char *name)
{
    struct walk walk = { .show = self };

    if (!input_read(&walk.input, name))
        return EXIT_TROUBLE;
    self->failed = !show_all(&walk);
    input_done(&walk.input);
    return walk.reader.broken ? EXIT_FOUND : EXIT_GOOD;
}
