#include "ccfread_diff.h"

#include "base/bytes.h"
#include "common_file.h"

#include <stdlib.h>
#include <string.h>

#define HEADER_SIZE 7u
#define NOWHERE     UINT32_MAX

struct ccf_entry diff_entry(const struct diff_side *side, const struct diff_item *item)
{
    const uint8_t *bytes = side->input.bytes + item->offset;

    return (struct ccf_entry){ .index = item->index,
                               .sub = item->sub,
                               .size = get_le32(bytes + 3),
                               .value = bytes + HEADER_SIZE };
}

/* ---- the entries of a file ------------------------------------------------------------------ */

static int compare_objects(const struct diff_item *a, const struct diff_item *b)
{
    if (a->index != b->index)
        return a->index < b->index ? -1 : 1;
    return a->sub - b->sub;
}

static int compare_items(const void *left, const void *right)
{
    const struct diff_item *a = left, *b = right;
    const int order = compare_objects(a, b);

    return order != 0 ? order : a->position < b->position ? -1 : 1;
}

/* The counterpart has as many writes of its object behind it. */
static int compare_writes(const struct diff_item *a, const struct diff_item *b)
{
    const int order = compare_objects(a, b);

    if (order != 0 || a->later == b->later)
        return order;
    return a->later > b->later ? -1 : 1;
}

static void count_writes(struct diff_item *items, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        items[i].occurrence = i > 0 && compare_objects(&items[i - 1], &items[i]) == 0
                                  ? items[i - 1].occurrence + 1
                                  : 1;
    for (uint32_t i = count; i > 1; i--)
        items[i - 2].later = items[i - 1].occurrence > 1 ? items[i - 1].later + 1 : 0;
}

static uint32_t count_entries(struct diff_side *self)
{
    struct ccf_reader reader;
    struct ccf_entry entry;
    uint32_t count = 0;

    ccf_reader_init_bytes(&reader, self->input.bytes, self->input.size, &self->input.report);
    while (ccf_read_checked(&reader, &self->input.report, &entry))
        count++;
    self->broken = reader.broken;
    return count;
}

static void list_entries(struct diff_side *self)
{
    struct ccf_reader reader = {
        .bytes = self->input.bytes, .size = self->input.size, .position = 4, .left = self->count
    };
    struct ccf_entry entry;

    for (uint32_t i = 0; i < self->count; i++) {
        self->items[i].offset = (uint32_t)reader.position;
        self->items[i].position = i;
        ccf_read(&reader, &entry);
        self->items[i].index = entry.index;
        self->items[i].sub = entry.sub;
    }
    qsort(self->items, self->count, sizeof *self->items, compare_items);
    count_writes(self->items, self->count);
}

static bool open_side(struct diff_side *self, const char *name)
{
    if (!input_read(&self->input, name))
        return false;
    self->count = count_entries(self);
    self->items = calloc((size_t)self->count + 1, sizeof *self->items);
    if (!self->items) {
        file_tell("ccfread", self->input.name, CO_ERR_MEMORY);
        input_done(&self->input);
        return false;
    }
    list_entries(self);
    return true;
}

static void close_side(struct diff_side *self)
{
    free(self->items);
    input_done(&self->input);
}

/* ---- order ---------------------------------------------------------------------------------- */

/*
 * The longest rising sequence of where[] (places in b, by place in a) stays; the others have moved.
 * last[n] is the place in a where the lowest sequence of n + 1 ends, before[] the one in front.
 */
struct order {
    uint32_t *where, *before, *last;
    uint32_t count, length;
};

static void order_done(struct order *self)
{
    free(self->where);
    free(self->before);
    free(self->last);
}

static bool order_init(struct order *self, uint32_t count)
{
    *self = (struct order){ .where = malloc((count + 1) * sizeof *self->where),
                            .before = malloc((count + 1) * sizeof *self->before),
                            .last = malloc((count + 1) * sizeof *self->last),
                            .count = count };
    if (!self->where || !self->before || !self->last) {
        order_done(self);
        return false;
    }
    for (uint32_t i = 0; i < count; i++)
        self->where[i] = NOWHERE;
    return true;
}

/* How many sequences end lower than this place in b. */
static uint32_t find_length(const struct order *self, uint32_t place)
{
    uint32_t low = 0, high = self->length;

    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;

        if (self->where[self->last[middle]] < place)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static void find_sequence(struct order *self)
{
    for (uint32_t i = 0; i < self->count; i++) {
        uint32_t length;

        if (self->where[i] == NOWHERE)
            continue;
        length = find_length(self, self->where[i]);
        self->before[i] = length > 0 ? self->last[length - 1] : NOWHERE;
        self->last[length] = i;
        if (length == self->length)
            self->length++;
    }
}

/* In where[] is left what has moved. */
static void drop_sequence(struct order *self)
{
    uint32_t place = self->length > 0 ? self->last[self->length - 1] : NOWHERE;

    while (place != NOWHERE) {
        self->where[place] = NOWHERE;
        place = self->before[place];
    }
}

/* ---- both ----------------------------------------------------------------------------------- */

typedef void pair_fn(void *context, struct diff_item *a, struct diff_item *b);

/* Each entry once: with its counterpart, or NULL for it. */
static void pair_up(struct diff *self, pair_fn *tell, void *context)
{
    uint32_t i = 0, k = 0;

    while (i < self->a.count || k < self->b.count) {
        struct diff_item *a = i < self->a.count ? &self->a.items[i] : NULL;
        struct diff_item *b = k < self->b.count ? &self->b.items[k] : NULL;
        const int order = !a ? 1 : !b ? -1 : compare_writes(a, b);

        tell(context, order <= 0 ? a : NULL, order >= 0 ? b : NULL);
        i += order <= 0;
        k += order >= 0;
    }
}

static void note_place(void *context, struct diff_item *a, struct diff_item *b)
{
    struct order *order = context;

    if (a && b)
        order->where[a->position] = b->position;
}

static bool find_moved(struct diff *self)
{
    struct order order;

    if (!order_init(&order, self->a.count))
        return false;
    pair_up(self, note_place, &order);
    find_sequence(&order);
    drop_sequence(&order);
    for (uint32_t i = 0; i < self->a.count; i++)
        self->a.items[i].moved = order.where[self->a.items[i].position] != NOWHERE;
    order_done(&order);
    return true;
}

static bool is_same_value(const struct diff *self, const struct diff_item *a,
                          const struct diff_item *b)
{
    const struct ccf_entry left = diff_entry(&self->a, a), right = diff_entry(&self->b, b);

    return left.size == right.size && memcmp(left.value, right.value, left.size) == 0;
}

static void tell_pair(void *context, struct diff_item *a, struct diff_item *b)
{
    struct diff *self = context;

    if (!b)
        diff_print(self, DIFF_REMOVED, a, NULL);
    else if (!a)
        diff_print(self, DIFF_ADDED, NULL, b);
    else if (!is_same_value(self, a, b))
        diff_print(self, DIFF_CHANGED, a, b);
    if (a && b && a->moved)
        diff_print(self, DIFF_MOVED, a, b);
}

static int compare(struct diff *self)
{
    if (!find_moved(self)) {
        file_tell("ccfread", self->a.input.name, CO_ERR_MEMORY);
        return EXIT_TROUBLE;
    }
    pair_up(self, tell_pair, self);
    diff_print_end(self);
    if (self->failed)
        return input_tell_output();
    return self->found > 0 || self->a.broken || self->b.broken ? EXIT_FOUND : EXIT_GOOD;
}

int diff_files(const char *a, const char *b, const struct dcf *eds, bool json)
{
    struct diff self = { .eds = eds, .json = json };
    int result = EXIT_TROUBLE;

    if (!open_side(&self.a, a))
        return result;
    if (open_side(&self.b, b)) {
        result = compare(&self);
        close_side(&self.b);
    }
    close_side(&self.a);
    return result;
}
