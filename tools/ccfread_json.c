#include "ccfread_json.h"

#include "ccfread_value.h"
#include "ccfread_view.h"

#include "base/bytes.h"
#include "json/json_text.h"

#include <math.h>
#include <stdlib.h>

#define FIRST_HALF 0xD800u /* of pairs that stand for other characters */
#define LAST_HALF  0xDFFFu

/* Files may have millions of entries: they are written one by one, none is kept. */

static json_t *hex_of(const uint8_t *bytes, size_t size)
{
    static const char digits[] = "0123456789ABCDEF";
    char *text = malloc(2 * size + 1);
    json_t *hex;

    if (!text)
        return NULL;
    for (size_t i = 0; i < size; i++) {
        text[2 * i] = digits[bytes[i] >> 4];
        text[2 * i + 1] = digits[bytes[i] & 0xF];
    }
    hex = json_stringn_nocheck(text, 2 * size);
    free(text);
    return hex;
}

/* JSON numbers of most readers are signed: greater ones are text. */
static json_t *number_of(uint64_t number)
{
    return number <= INT64_MAX ? json_integer((json_int_t)number)
                               : json_sprintf("%llu", (unsigned long long)number);
}

static json_t *time_of(const struct ccf_entry *entry, uint8_t type)
{
    struct text text;

    text_clear(&text);
    value_add_time(&text, entry, type);
    return json_string(text.line);
}

/* null: none, or it has more bytes than numbers have. */
static json_t *integer_of(const struct ccf_entry *entry, uint8_t type)
{
    if (entry->size == 0 || entry->size > sizeof(uint64_t))
        return json_null();
    return od_type_signed(type) ? json_integer(value_signed(entry))
                                : number_of(get_le(entry->value, entry->size));
}

/* At most three bytes. */
static size_t put_utf8(char *text, unsigned unit)
{
    if (unit < 0x80) {
        text[0] = (char)unit;
        return 1;
    }
    if (unit < 0x800) {
        text[0] = (char)(0xC0 | unit >> 6);
        text[1] = (char)(0x80 | (unit & 0x3F));
        return 2;
    }
    text[0] = (char)(0xE0 | unit >> 12);
    text[1] = (char)(0x80 | (unit >> 6 & 0x3F));
    text[2] = (char)(0x80 | (unit & 0x3F));
    return 3;
}

/* null: it has characters that 16 bits do not hold, or half a one. */
static json_t *unicode_of(const struct ccf_entry *entry)
{
    char *text = malloc((size_t)entry->size / 2 * 3 + 1);
    size_t length = 0;
    bool good = entry->size % 2 == 0;
    json_t *string;

    if (!text)
        return NULL;
    for (uint32_t i = 0; good && i < entry->size; i += 2) {
        const unsigned unit = get_le16(entry->value + i);

        good = unit < FIRST_HALF || unit > LAST_HALF;
        length += put_utf8(text + length, unit);
    }
    string = good ? json_stringn(text, length) : json_null();
    free(text);
    return string;
}

static json_t *real_of(const struct ccf_entry *entry)
{
    const double number = value_real(entry);

    return isfinite(number) ? json_real(number) : json_null();
}

/* null: there is nothing but the bytes. */
static json_t *value_of(const struct ccf_entry *entry, uint8_t type)
{
    switch (type) {
    case OD_BOOLEAN:
        return entry->value[0] <= 1 ? json_boolean(entry->value[0]) : integer_of(entry, type);
    case OD_REAL32:
    case OD_REAL64: return real_of(entry);
    case OD_VISIBLE_STRING: return json_text_of((const char *)entry->value, entry->size);
    case OD_TIME_OF_DAY:
    case OD_TIME_DIFFERENCE: return time_of(entry, type);
    case OD_OCTET_STRING:
    case OD_DOMAIN: return json_null();
    case OD_UNICODE_STRING: return unicode_of(entry);
    default: return integer_of(entry, type);
    }
}

static bool begin(void)
{
    return putchar('[') != EOF;
}

static bool end(void)
{
    return puts("\n]") != EOF;
}

static bool open_file(const struct view_file *file, bool has_eds)
{
    (void)has_eds;
    return fputs(file->is_first ? "\n{\"file\": " : ",\n{\"file\": ", stdout) != EOF &&
           json_write(json_text(file->name), VIEW_JSON_STYLE, stdout) &&
           printf(", \"size\": %zu, \"count\": %lu, \"entries\": [", file->size,
                  (unsigned long)file->count) > 0;
}

static json_t *with_description(json_t *object, const struct dcf_entry *described)
{
    object = json_with(object, "type", json_string(od_type_name(described->type)));
    return described->name ? json_with(object, "name", json_text(described->name)) : object;
}

json_t *view_json_of(const struct ccf_entry *entry, size_t offset, uint8_t type)
{
    json_t *value = value_of(entry, type);
    json_t *object = json_pack("{sI sI so}", "offset", (json_int_t)offset, "size",
                               (json_int_t)entry->size, "data", hex_of(entry->value, entry->size));

    return json_is_null(value) ? object : json_with(object, "value", value);
}

static bool show(const struct view_entry *self, bool has_eds)
{
    const struct ccf_entry *entry = self->entry;
    json_t *object = view_json_of(entry, self->offset, view_type(self));

    (void)has_eds;
    object = json_with(object, "index", json_integer(entry->index));
    object = json_with(object, "sub", json_integer(entry->sub));
    if (self->described)
        object = with_description(object, self->described);
    if (self->extra)
        object = json_with(object, "extra", json_true());
    if (self->warning)
        object = json_with(object, "warning", json_text(self->warning));
    return fputs(self->is_first ? "\n  " : ",\n  ", stdout) != EOF &&
           json_write(object, VIEW_JSON_STYLE, stdout);
}

static bool close_file(const struct view_file *file, const struct view_rest *rest,
                       const char *error)
{
    json_t *damage;

    (void)file;
    if (!error)
        return fputs("\n], \"error\": null}", stdout) != EOF;
    damage = json_pack("{so sI sI so}", "message", json_text(error), "offset",
                       (json_int_t)rest->offset, "left", (json_int_t)rest->size, "data",
                       hex_of(rest->bytes, rest->size));
    return fputs("\n], \"error\": ", stdout) != EOF &&
           json_write(damage, VIEW_JSON_STYLE, stdout) && putchar('}') != EOF;
}

const struct view view_json = {
    .begin = begin, .open = open_file, .show = show, .close = close_file, .end = end
};
