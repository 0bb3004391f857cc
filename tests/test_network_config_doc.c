/* docs/network-xml.md and the reader's table tell the same of each element, in the same order. */
#include "manager/network_config_elements.h"
#include "support/suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PAGE  TEST_DATA_DIR "/../../docs/network-xml.md"
#define CELLS 4u /* element, type, range, default; what is behind them is prose */

struct line {
    char text[2000];
    char *cells[CELLS];
};

/* Cuts "| a | b | c | d | ..."; false: the line is none of these. */
static bool cut(struct line *self)
{
    char *at = self->text;

    if (strncmp(at, "| `", 3) != 0)
        return false;
    for (unsigned i = 0; i < CELLS; i++) {
        char *end = strstr(at + 1, " |");

        if (!end)
            return false;
        *end = '\0';
        self->cells[i] = at + 1 + strspn(at + 1, " ");
        at = end + 1;
    }
    return true;
}

static void expect_name(const struct element *row, const struct line *line)
{
    char name[80];
    size_t size = (size_t)snprintf(name, sizeof name, "`%s`", row->name);

    ck_assert_msg(strncmp(line->cells[0], name, size) == 0, "%s, not %s", line->cells[0], name);
}

static const char *type_of(const struct element *row)
{
    switch (row->kind) {
    case ELEMENT_NUMBER:
        return row->high > UINT16_MAX ? "ULONG" : row->high > UINT8_MAX ? "USHORT" : "UCHAR";
    case ELEMENT_BITRATE: return "USHORT";
    case ELEMENT_INT16: return "INT16";
    case ELEMENT_BOOL: return "BOOL";
    case ELEMENT_ASCII: return "ASCII";
    case ELEMENT_ACTION: return "ENUM";
    }
    return "";
}

/* As the page writes it. */
static void range_of(const struct element *row, char *text, size_t size)
{
    const bool is_preset_apart = row->preset < row->low && !row->mandatory;
    const char *high = row->high > UINT16_MAX ? "%s%u..0x%X" : "%s%u..%u";
    char preset[16] = "";

    if (is_preset_apart)
        snprintf(preset, sizeof preset, "%u or ", row->preset);
    switch (row->kind) {
    case ELEMENT_NUMBER: snprintf(text, size, high, preset, row->low, row->high); break;
    case ELEMENT_BITRATE: snprintf(text, size, "10, 20, 50, 125, 250, 500, 800, 1000"); break;
    case ELEMENT_INT16:
        snprintf(text, size, row->size == 6 ? "three, `a:b:c`" : "four, `a:b:c:d`");
        break;
    case ELEMENT_BOOL:
    case ELEMENT_ASCII: text[0] = '\0'; break;
    case ELEMENT_ACTION: snprintf(text, size, "`RESET_SLAVE`, `RESET_ALL`, `STOP_ALL`"); break;
    }
}

static void preset_of(const struct element *row, char *text, size_t size)
{
    if (row->mandatory)
        snprintf(text, size, "**must**");
    else if (row->kind == ELEMENT_ASCII || row->given != 0)
        snprintf(text, size, "-");
    else if (row->kind == ELEMENT_BOOL)
        snprintf(text, size, row->preset ? "TRUE" : "FALSE");
    else if (row->kind == ELEMENT_ACTION)
        snprintf(text, size, "`RESET_SLAVE`");
    else
        snprintf(text, size, "%u", row->preset);
}

static void expect_row(const struct element *row, const struct line *line)
{
    const char *preset = line->cells[3];
    char text[80], number[16];

    expect_name(row, line);
    ck_assert_msg(strcmp(line->cells[1], type_of(row)) == 0, "%s: %s", row->name, line->cells[1]);
    range_of(row, text, sizeof text);
    ck_assert_msg(strcmp(line->cells[2], text) == 0, "%s: %s, not %s", row->name, line->cells[2],
                  text);
    preset_of(row, text, sizeof text);
    if (strncmp(preset, "0x", 2) == 0) {
        snprintf(number, sizeof number, "%lu", strtoul(preset, NULL, 16));
        preset = number;
    }
    ck_assert_msg(strcmp(preset, text) == 0, "%s: %s, not %s", row->name, preset, text);
}

/* The rows of the table behind a heading. */
static void expect_table(const struct element_table *table)
{
    FILE *page = fopen(PAGE, "r");
    struct line line;
    char heading[80];
    size_t rows = 0;
    bool inside = false;

    ck_assert_ptr_nonnull(page);
    snprintf(heading, sizeof heading, "## Elements of `<%s>`\n", table->parent);
    while (fgets(line.text, sizeof line.text, page)) {
        if (line.text[0] == '#')
            inside = strcmp(line.text, heading) == 0;
        if (!inside || !cut(&line))
            continue;
        ck_assert_uint_lt(rows, table->count);
        expect_row(&table->rows[rows++], &line);
    }
    ck_assert_uint_eq(rows, table->count);
    fclose(page);
}

START_TEST(the_page_is_right)
{
    expect_table(_i == 0 ? &network_elements : &node_elements);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("page");

    tcase_add_loop_test(tests, the_page_is_right, 0, 2);
    return suite_run("network_config_doc", tests);
}
