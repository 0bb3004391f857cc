#include "dcf/dcf_lexer.h"

#include "base/bytes.h"
#include "dcf/dcf_rules.h"

#include <stdlib.h>
#include <string.h>

#define LINE_SIZE_MAX 255u
#define DOS_END       '\x1A'
#define MANY          1048576u /* there is memory for so many sections or keys */

struct oddity { /* something that many lines may have: one message for all of them */
    unsigned line;
    unsigned count;
};

struct lexer {
    struct dcf_text text;
    struct dcf_slice rest;
    size_t size; /* of the file */
    struct co_report *report;
    unsigned line;
    struct oddity too_long, not_ascii, control, return_only, hash, slashes, indented, not_a_key,
        no_section;
};

static void note(struct lexer *self, struct oddity *oddity)
{
    if (oddity->count++ == 0)
        oddity->line = self->line;
}

static void tell(const struct lexer *self, const struct oddity *oddity, enum dcf_rule rule,
                 const char *what)
{
    if (oddity->count > 1)
        dcf_tell(self->report, rule, oddity->line, "%s (and in %u more lines)", what,
                 oddity->count - 1);
    else if (oddity->count == 1)
        dcf_tell(self->report, rule, oddity->line, "%s", what);
}

/* For as many as there will be, when the rest of the file is like what was read of it. */
static enum co_err grow(const struct lexer *self, void **items, size_t *room, size_t size)
{
    size_t read = self->size - self->rest.size;
    size_t most = *room > MANY / 2 ? 2 * *room : MANY;
    uint64_t guess = (uint64_t)*room * self->size / read;
    size_t more = guess < most ? (size_t)guess + *room / 16 + 64 : most;
    void *grown = realloc(*items, more * size);

    if (!grown)
        return CO_ERR_MEMORY;
    *items = grown;
    *room = more;
    return CO_OK;
}

/* A smaller piece is there even where none is given. */
static void *trim(void *items, size_t count, size_t size)
{
    void *trimmed = count > 0 ? realloc(items, count * size) : NULL;

    return trimmed ? trimmed : items;
}

static enum co_err too_much(const struct lexer *self, unsigned most, const char *what)
{
    dcf_tell(self->report, DCF_RULE_FILE_LIMIT, self->line,
             "at most %u %s expected, there are more", most, what);
    return CO_ERR_FORMAT;
}

static enum co_err add_section(struct lexer *self, struct dcf_slice name)
{
    struct dcf_text *text = &self->text;
    void *items = text->sections;

    if (text->section_count == DCF_SECTIONS_MAX)
        return too_much(self, DCF_SECTIONS_MAX, "sections");
    if (text->section_count == text->section_room) {
        if (grow(self, &items, &text->section_room, sizeof *text->sections) != CO_OK)
            return CO_ERR_MEMORY;
        text->sections = items;
    }
    text->sections[text->section_count++] = (struct dcf_section){ .name = name,
                                                                  .line = self->line };
    return CO_OK;
}

static enum co_err add_key(struct lexer *self, struct dcf_slice name, struct dcf_slice value)
{
    struct dcf_text *text = &self->text;
    void *items = text->keys;

    if (text->key_count == DCF_KEYS_MAX)
        return too_much(self, DCF_KEYS_MAX, "keywords");
    if (text->key_count == text->key_room) {
        if (grow(self, &items, &text->key_room, sizeof *text->keys) != CO_OK)
            return CO_ERR_MEMORY;
        text->keys = items;
    }
    text->keys[text->key_count++] = (struct dcf_key){
        .name = name, .value = value, .tag = dcf_name_tag(name), .line = self->line
    };
    text->sections[text->section_count - 1].count++;
    return CO_OK;
}

static enum co_err read_section(struct lexer *self, struct dcf_slice line)
{
    struct dcf_slice name = dcf_slice_skip(line, 1);
    const char *end = memchr(name.text, ']', name.size);

    if (!end) {
        dcf_tell(self->report, DCF_RULE_SECTION_BRACKETS, self->line,
                 "section \"%s\": \"]\" expected at its end, the line ends without one",
                 dcf_show(name).text);
        return add_section(self, dcf_slice_trim(name));
    }
    if (end + 1 < line.text + line.size)
        dcf_tell(self->report, DCF_RULE_SECTION_BRACKETS, self->line,
                 "nothing expected behind \"]\", there is \"%s\": ignored",
                 dcf_show(dcf_slice_skip(line, (size_t)(end + 1 - line.text))).text);
    return add_section(self, dcf_slice_trim(dcf_slice_cut(name, (size_t)(end - name.text))));
}

static enum co_err read_key(struct lexer *self, struct dcf_slice line)
{
    const char *equals = memchr(line.text, '=', line.size);
    size_t size = equals ? (size_t)(equals - line.text) : 0;
    struct dcf_slice name = dcf_slice_trim(dcf_slice_cut(line, size));

    if (name.size == 0) {
        note(self, &self->not_a_key);
        return CO_OK;
    }
    if (self->text.section_count == 0) {
        note(self, &self->no_section);
        return CO_OK;
    }
    return add_key(self, name, dcf_slice_trim(dcf_slice_skip(line, size + 1)));
}

static enum co_err read_line(struct lexer *self, struct dcf_slice line)
{
    const char *start = line.text;

    if (line.size > LINE_SIZE_MAX)
        note(self, &self->too_long);
    line = dcf_slice_trim(line);
    if (line.size == 0 || line.text[0] == ';')
        return CO_OK;
    if (line.text[0] == '#' || dcf_slice_begins(line, "//")) {
        note(self, line.text[0] == '#' ? &self->hash : &self->slashes);
        return CO_OK;
    }
    if (line.text[0] != '[')
        return read_key(self, line);
    if (line.text != start)
        note(self, &self->indented);
    return read_section(self, line);
}

#define EIGHT_BYTES(byte) (UINT64_C(0x0101010101010101) * (byte))

/*
 * How many of eight bytes at the beginning are ASCII and no control characters. Of others the
 * subtraction borrows, or bit 7 is set: the lowest byte with bit 7 is the first one.
 */
static size_t count_plain(const char *text)
{
    const uint8_t *bytes = (const uint8_t *)text;
    uint64_t eight = get_le32(bytes) | (uint64_t)get_le32(bytes + 4) << 32;
    uint64_t odd = (eight | (eight - EIGHT_BYTES(0x20))) & EIGHT_BYTES(0x80);

    return odd == 0 ? 8 : (size_t)__builtin_ctzll(odd) / 8;
}

static size_t skip_plain(struct dcf_slice text, size_t place)
{
    size_t count = 8;

    while (count == 8 && place + 8 <= text.size) {
        count = count_plain(text.text + place);
        place += count;
    }
    if (count < 8)
        return place;
    while (place < text.size && (unsigned char)(text.text[place] - 0x20) < 0x60)
        place++;
    return place;
}

/* The size of the next line without its end. */
static size_t scan_line(struct lexer *self)
{
    struct dcf_slice rest = self->rest;
    bool not_ascii = false, control = false;
    size_t size = skip_plain(rest, 0);

    for (; size < rest.size; size = skip_plain(rest, size + 1)) {
        unsigned char c = (unsigned char)rest.text[size];

        if (c == '\n' || c == '\r')
            break;
        not_ascii |= c > 0x7F;
        control |= c < 0x20 && c != '\t';
    }
    if (not_ascii)
        note(self, &self->not_ascii);
    if (control)
        note(self, &self->control);
    return size;
}

/* Cuts the next line from the rest; the line end is CR LF, LF or CR. */
static struct dcf_slice take_line(struct lexer *self)
{
    struct dcf_slice rest = self->rest;
    size_t size;

    self->line++;
    size = scan_line(self);
    self->rest = dcf_slice_skip(rest, size);
    if (size + 1 < rest.size && rest.text[size] == '\r' && rest.text[size + 1] == '\n')
        self->rest = dcf_slice_skip(rest, size + 2);
    else if (size < rest.size)
        self->rest = dcf_slice_skip(rest, size + 1);
    if (size < rest.size && rest.text[size] == '\r' && self->rest.text == rest.text + size + 1)
        note(self, &self->return_only);
    return dcf_slice_cut(rest, size);
}

static void skip_marks(struct lexer *self)
{
    if (dcf_slice_begins(self->rest, "\xEF\xBB\xBF")) {
        dcf_tell(self->report, DCF_RULE_BYTE_ORDER_MARK, 1,
                 "plain text expected, the file begins with a byte order mark: ignored");
        self->rest = dcf_slice_skip(self->rest, 3);
    }
    while (self->rest.size > 0 && self->rest.text[self->rest.size - 1] == DOS_END)
        self->rest.size--;
}

static void tell_all(const struct lexer *self)
{
    tell(self, &self->too_long, DCF_RULE_LINE_LENGTH,
         "lines of at most 255 characters expected, this one is longer");
    tell(self, &self->not_ascii, DCF_RULE_CHARACTERS,
         "ASCII characters expected, there are others");
    tell(self, &self->control, DCF_RULE_CONTROL_CHARACTERS,
         "text expected, there are control characters");
    tell(self, &self->return_only, DCF_RULE_LINE_END,
         "lines are expected to end with CR LF or LF, this one does with CR");
    tell(self, &self->hash, DCF_RULE_COMMENT,
         "comments are expected to begin with \";\", this one does with \"#\"");
    tell(self, &self->slashes, DCF_RULE_COMMENT,
         "comments are expected to begin with \";\", this one does with \"//\"");
    tell(self, &self->indented, DCF_RULE_SECTION_BRACKETS,
         "a section is expected in the first column, there are blanks before it");
    tell(self, &self->not_a_key, DCF_RULE_LINE,
         "\"[section]\", \"key=value\" or \"; comment\" expected: ignored");
    tell(self, &self->no_section, DCF_RULE_NO_SECTION,
         "a section expected before the first key: ignored");
}

static enum co_err no_text(struct co_report *report, const char *what)
{
    dcf_tell(report, DCF_RULE_NO_TEXT, 0, "EDS or DCF text expected, %s", what);
    return CO_ERR_FORMAT;
}

static enum co_err read_lines(struct lexer *self)
{
    struct dcf_text *text = &self->text;
    enum co_err err = CO_OK;

    skip_marks(self);
    while (self->rest.size > 0 && err == CO_OK)
        err = read_line(self, take_line(self));
    if (err != CO_OK)
        return err;
    tell_all(self);
    if (text->section_count == 0)
        return no_text(self->report, "there is no section in it");
    text->sections = trim(text->sections, text->section_count, sizeof *text->sections);
    text->keys = trim(text->keys, text->key_count, sizeof *text->keys);
    return dcf_text_sort(text, self->report);
}

enum co_err dcf_lex(const char *text, size_t size, struct co_report *report,
                    struct dcf_text *ret_text)
{
    struct lexer lexer = { .rest = { text, size }, .size = size, .report = report };
    enum co_err err;

    if (size >= 2 && (memcmp(text, "\xFF\xFE", 2) == 0 || memcmp(text, "\xFE\xFF", 2) == 0))
        return no_text(report, "this is UTF-16: store it as plain text");
    if (size > DCF_TEXT_MAX) {
        dcf_tell(report, DCF_RULE_FILE_LIMIT, 0, "at most %u bytes expected, there are %zu",
                 DCF_TEXT_MAX, size);
        return CO_ERR_FORMAT;
    }
    err = read_lines(&lexer);
    if (err != CO_OK) {
        dcf_text_done(&lexer.text);
        return err;
    }
    *ret_text = lexer.text;
    return CO_OK;
}

void dcf_text_done(struct dcf_text *self)
{
    free(self->sections);
    free(self->keys);
    *self = (struct dcf_text){ .section_count = 0 };
}
