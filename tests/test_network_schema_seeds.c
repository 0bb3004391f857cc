/*
 * docs/network.xsd takes what the reader takes: documents made from seeds, right and wrong ones.
 * SCHEMA_SEED=N plays one of them again.
 */
#include "manager/network_config.h"
#include "manager/network_config_elements.h"
#include "support/schema.h"
#include "support/suite.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define DOCUMENTS 800u
#define NODE_IDS  90u /* in decimal digits: the differences have the others */

struct maker {
    struct schema_text text;
    uint32_t random;
    unsigned faults; /* one element in so many is wrong; 0: none */
};

static unsigned below(struct maker *self, unsigned limit)
{
    self->random ^= self->random << 13;
    self->random ^= self->random >> 17;
    self->random ^= self->random << 5;
    return self->random % limit;
}

static bool one_in(struct maker *self, unsigned n)
{
    return n > 0 && below(self, n) == 0;
}

static const char *pick(struct maker *self, const char *const *words, unsigned count)
{
    return words[below(self, count)];
}

#define PICK(maker, words) pick(maker, words, sizeof(words) / sizeof *(words))

static void put_blanks(struct maker *self)
{
    static const char *const blanks[] = { "", "", "", "", "\n", " ", "\t", "\r\n", "<!-- a -->" };

    schema_put(&self->text, "%s", PICK(self, blanks));
}

static void put_number(struct maker *self, const struct element *row)
{
    const uint32_t room = row->high - row->low;
    const uint32_t number = row->low + (room < UINT32_MAX ? self->random % (room + 1) : 7);

    /* A node-ID in other digits would be one of the differences. */
    switch (row->high == NETWORK_NODE_MAX ? 4 : below(self, 5)) {
    case 0: schema_put(&self->text, "0x%X", number); break;
    case 1: schema_put(&self->text, "0x%x", row->high); break;
    case 2: schema_put(&self->text, "%u", row->low); break;
    case 3: schema_put(&self->text, "0%u", number); break;
    default: schema_put(&self->text, "%u", number); break;
    }
}

static void put_good(struct maker *self, const struct element *row)
{
    static const char *const rates[] = { "10", "125", "500", "0x64", "0800", "1000" };
    static const char *const bools[] = { "TRUE", "FALSE", "TRUE", "FALSE", "true", "False" };
    static const char *const texts[] = { "a", "a b", "x.dcf", "0", "a &amp; b", "\xC3\xA4" };
    static const char *const actions[] = { "RESET_SLAVE", "RESET_ALL", "STOP_ALL" };

    switch (row->kind) {
    case ELEMENT_NUMBER: put_number(self, row); break;
    case ELEMENT_BITRATE: schema_put(&self->text, "%s", PICK(self, rates)); break;
    case ELEMENT_INT16: schema_put(&self->text, "1:2: 3%s", row->size == 6 ? "" : ":0x4"); break;
    case ELEMENT_BOOL: schema_put(&self->text, "%s", PICK(self, bools)); break;
    case ELEMENT_ASCII: schema_put(&self->text, "%s", PICK(self, texts)); break;
    case ELEMENT_ACTION: schema_put(&self->text, "%s", PICK(self, actions)); break;
    }
}

/* What some kinds of elements take, and others do not. */
static void put_any(struct maker *self)
{
    static const char *const texts[] = { "",     "-1",  "128",   "256",    "65536", "4294967296",
                                         "TRUE", "abc", "1:2:3", "0x",     "1 2",   "<a/>",
                                         "+1",   "99",  "a\nb",  "1:2:3:", "100" };

    schema_put(&self->text, "%s", PICK(self, texts));
}

static void put_element(struct maker *self, const struct element *row)
{
    const char *name = row->alias && one_in(self, 2) ? row->alias : row->name;

    schema_put(&self->text, "<%s>", name);
    put_blanks(self);
    if (one_in(self, self->faults))
        put_any(self);
    else
        put_good(self, row);
    put_blanks(self);
    schema_put(&self->text, "</%s>", name);
    put_blanks(self);
}

/* In the wrong place, unknown, text. No CDATA section of blanks: the reader takes that, and so does
 * the standard, but not the validator of libxml2. */
static void put_stranger(struct maker *self)
{
    static const char *const strangers[] = {
        "text",
        "<Net_No>9</Net_No>",
        "<Node_Id>99</Node_Id>",
        "<Gard_Time>1</Gard_Time>",
        "&#32;",
        "<Boot_Time a=''/>",
        "<Manager_Instance/>",
        "<Node_Instance/>",
        "<![CDATA[a]]>",
        "<Name>a</Name>",
        "<?a b?>",
        "<!-- <a> -->",
    };

    schema_put(&self->text, "%s", PICK(self, strangers));
}

static bool has_number(const struct element *row)
{
    return strcmp(row->name, "Net_No") == 0 || strcmp(row->name, "Node_Id") == 0;
}

/* Some of the rows in any order, one perhaps twice. */
static void put_rows(struct maker *self, const struct element_table *table, unsigned some)
{
    bool given[ELEMENTS_MAX] = { false };

    for (unsigned i = 0; i < some; i++) {
        const unsigned row = below(self, (unsigned)table->count);

        if (has_number(&table->rows[row]) || table->rows[row].mandatory ||
            (given[row] && !one_in(self, self->faults)))
            continue;
        given[row] = true;
        put_element(self, &table->rows[row]);
        if (one_in(self, 4 * self->faults))
            put_stranger(self);
    }
}

static void put_unless_missing(struct maker *self, const char *name, unsigned number)
{
    if (!one_in(self, 2 * self->faults))
        schema_put(&self->text, "<%s>%u</%s>", name, number, name);
}

static void put_node(struct maker *self, unsigned id)
{
    schema_put(&self->text, "<Node_Instance>");
    put_rows(self, &node_elements, below(self, 5));
    put_unless_missing(self, "Node_Id", one_in(self, self->faults) ? 5 : id);
    put_rows(self, &node_elements, below(self, 5));
    schema_put(&self->text, "</Node_Instance>\n");
}

static void put_network(struct maker *self, unsigned net)
{
    unsigned id = below(self, 9);

    schema_put(&self->text, "<Manager_Instance>");
    put_unless_missing(self, "Net_No", one_in(self, self->faults) ? 0 : net);
    for (unsigned nodes = below(self, 4); nodes > 0; nodes--) {
        put_rows(self, &network_elements, below(self, 3));
        id += 1 + below(self, NODE_IDS / 6);
        put_node(self, id);
    }
    put_unless_missing(self, "Baudrate", 500);
    put_rows(self, &network_elements, below(self, 4));
    schema_put(&self->text, "</Manager_Instance>\n");
}

static const char *make_document(struct maker *self, unsigned seed)
{
    self->text.size = 0;
    self->random = 0x9E3779B9u * seed;
    self->faults = seed % 3 == 0 ? 0 : 8 + below(self, 40);
    schema_put(&self->text, "<CANopen_Manager>\n");
    for (unsigned net = 0; net == 0 || one_in(self, 3); net++)
        put_network(self, net);
    schema_put(&self->text, "</CANopen_Manager>\n");
    return self->text.bytes;
}

START_TEST(documents_of_seeds)
{
    static struct maker maker;
    const char *seed = getenv("SCHEMA_SEED");
    const unsigned first = seed ? (unsigned)strtoul(seed, NULL, 10) : 1;
    unsigned taken = 0;

    for (unsigned i = 0; i < (seed ? 1 : DOCUMENTS); i++)
        taken += schema_agrees(make_document(&maker, first + i));
    ck_assert(seed || (taken > DOCUMENTS / 4 && taken < DOCUMENTS * 3 / 4));
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("seeds");

    tcase_add_checked_fixture(tests, schema_load, schema_free);
    tcase_set_timeout(tests, 60);
    tcase_add_test(tests, documents_of_seeds);
    return suite_run("network_schema_seeds", tests);
}
