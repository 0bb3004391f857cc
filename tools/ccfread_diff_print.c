#include "ccfread_diff.h"
#include "ccfread_json.h"
#include "ccfread_value.h"
#include "json/json_text.h"

#include <stdio.h>
#include <string.h>

#define NUMBER_SIZE 8u

static const char *const words[] = { [DIFF_REMOVED] = "removed",
                                     [DIFF_ADDED] = "added",
                                     [DIFF_CHANGED] = "changed",
                                     [DIFF_MOVED] = "moved" };

static const struct dcf_entry *describe(const struct diff *self, const struct diff_item *item)
{
    return self->eds ? dcf_find(self->eds, item->index, item->sub) : NULL;
}

static uint8_t type_of(const struct diff *self, const struct ccf_entry *entry)
{
    const struct dcf_entry *described = self->eds ? dcf_find(self->eds, entry->index, entry->sub)
                                                  : NULL;

    return described && value_fits(entry, described->type) ? described->type : 0;
}

/* ---- text ----------------------------------------------------------------------------------- */

static void put_heading(const char *mark, const struct diff_side *side)
{
    printf("%s %s: %lu %s, %zu bytes\n", mark, side->input.name, (unsigned long)side->count,
           side->count == 1 ? "entry" : "entries", side->input.size);
}

static void add_value(struct text *text, const struct diff *self, const struct ccf_entry *entry)
{
    value_add(text, entry, type_of(self, entry));
    if (entry->size > NUMBER_SIZE)
        text_add(text, " (%lu bytes)", (unsigned long)entry->size);
    value_add_meaning(text, entry);
}

/* Long values look the same where they differ behind what is shown. */
static void add_place(struct text *text, const struct ccf_entry *a, const struct ccf_entry *b)
{
    const uint32_t both = a->size < b->size ? a->size : b->size;
    uint32_t place = 0;

    if (a->size <= NUMBER_SIZE && b->size <= NUMBER_SIZE)
        return;
    while (place < both && a->value[place] == b->value[place])
        place++;
    text_add(text, ", from byte %lu on", (unsigned long)place);
}

static void put_values(const struct diff *self, const struct diff_item *a,
                       const struct diff_item *b)
{
    const struct ccf_entry left = a ? diff_entry(&self->a, a) : (struct ccf_entry){ .size = 0 };
    const struct ccf_entry right = b ? diff_entry(&self->b, b) : (struct ccf_entry){ .size = 0 };
    struct text text;

    text_clear(&text);
    if (a)
        add_value(&text, self, &left);
    fputs(text.line, stdout);
    fputs(a && b ? " -> " : "", stdout);
    text_clear(&text);
    if (b)
        add_value(&text, self, &right);
    if (a && b)
        add_place(&text, &left, &right);
    fputs(text.line, stdout);
}

static bool put_text(struct diff *self, enum diff_kind kind, const struct diff_item *a,
                     const struct diff_item *b)
{
    const struct diff_item *item = a ? a : b;
    const struct dcf_entry *described = describe(self, item);
    char occurrence[16] = "";

    if (self->found == 0) {
        put_heading("---", &self->a);
        put_heading("+++", &self->b);
    }
    if (item->occurrence > 1 || item->later > 0)
        snprintf(occurrence, sizeof occurrence, " #%lu", (unsigned long)item->occurrence);
    printf("%04Xh:%02X%-5s %-8s ", item->index, item->sub, occurrence, words[kind]);
    if (kind == DIFF_MOVED && a && b)
        printf("from entry %lu to entry %lu", (unsigned long)a->position + 1,
               (unsigned long)b->position + 1);
    else
        put_values(self, a, b);
    if (described && described->name && described->name[0]) {
        fputs("  ", stdout);
        value_put_name(described->name);
    }
    return putchar('\n') != EOF;
}

/* ---- JSON ----------------------------------------------------------------------------------- */

static json_t *with_side(json_t *object, const char *key, const struct diff *self,
                         const struct diff_side *side, const struct diff_item *item)
{
    struct ccf_entry entry;
    json_t *value;

    if (!item)
        return object;
    entry = diff_entry(side, item);
    value = view_json_of(&entry, item->offset, type_of(self, &entry));
    value = json_with(value, "entry", json_integer((json_int_t)item->position + 1));
    return json_with(object, key, value);
}

static bool put_json(struct diff *self, enum diff_kind kind, const struct diff_item *a,
                     const struct diff_item *b)
{
    const struct diff_item *item = a ? a : b;
    const struct dcf_entry *described = describe(self, item);
    json_t *object = json_pack("{ss si si sI}", "change", words[kind], "index", item->index, "sub",
                               item->sub, "occurrence", (json_int_t)item->occurrence);

    if (described && described->name)
        object = json_with(object, "name", json_text(described->name));
    object = with_side(object, "a", self, &self->a, a);
    object = with_side(object, "b", self, &self->b, b);
    fputs(self->found == 0 ? "[\n" : ",\n", stdout);
    return json_write(object, VIEW_JSON_STYLE, stdout);
}

void diff_print(struct diff *self, enum diff_kind kind, const struct diff_item *a,
                const struct diff_item *b)
{
    if (!self->failed)
        self->failed = !(self->json ? put_json(self, kind, a, b) : put_text(self, kind, a, b));
    self->found++;
}

void diff_print_end(struct diff *self)
{
    if (self->json)
        puts(self->found == 0 ? "[]" : "\n]");
    self->failed = self->failed || fflush(stdout) != 0 || ferror(stdout) != 0;
}
