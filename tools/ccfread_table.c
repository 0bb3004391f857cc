#include "ccfread_value.h"
#include "ccfread_view.h"

#include <stdio.h>

uint8_t view_type(const struct view_entry *entry)
{
    return entry->described && value_fits(entry->entry, entry->described->type)
               ? entry->described->type
               : 0;
}

static bool begin(void)
{
    return true;
}

static bool open_file(const struct view_file *file, bool has_eds)
{
    printf("%s%s: %lu %s, %zu bytes\n", file->is_first ? "" : "\n", file->name,
           (unsigned long)file->count, file->count == 1 ? "entry" : "entries", file->size);
    if (has_eds)
        puts("  offset  object      size  type             value                                   "
             "  name");
    else
        puts("  offset  object      size  value");
    return !ferror(stdout);
}

static bool show(const struct view_entry *self, bool has_eds)
{
    const struct ccf_entry *entry = self->entry;
    const struct dcf_entry *described = self->described;
    struct text value;

    text_clear(&value);
    value_add(&value, entry, view_type(self));
    value_add_meaning(&value, entry);
    printf("%c%7zu  %04Xh:%02X %7lu  ", self->extra ? '+' : ' ', self->offset, entry->index,
           entry->sub, (unsigned long)entry->size);
    if (has_eds)
        printf("%-15s  ", described ? od_type_name(described->type) : "-");
    if (described && described->name && described->name[0]) {
        printf("%-40s  ", value.line);
        value_put_name(described->name);
    } else {
        fputs(value.line, stdout);
    }
    return putchar('\n') != EOF;
}

static bool close_file(const struct view_file *file, const struct view_rest *rest,
                       const char *error)
{
    struct text bytes;

    (void)file;
    (void)error;
    if (rest->size > 0) {
        text_clear(&bytes);
        text_add_dump(&bytes, rest->bytes, rest->size);
        printf("%8zu  no entry %7zu  %s\n", rest->offset, rest->size, bytes.line);
    }
    return fflush(stdout) == 0 && !ferror(stdout);
}

const struct view view_table = {
    .begin = begin, .open = open_file, .show = show, .close = close_file, .end = begin
};
