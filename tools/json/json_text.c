#include "json/json_text.h"

#include <stdlib.h>
#include <string.h>

/* Each byte is a character of two bytes at most. */
static json_t *from_latin_1(const char *bytes, size_t size)
{
    char *text = malloc(2 * size + 1);
    size_t length = 0;
    json_t *result;

    if (!text)
        return NULL;
    for (size_t i = 0; i < size; i++) {
        const unsigned char byte = (unsigned char)bytes[i];

        if (byte >= 0x80)
            text[length++] = (char)(0xC0 | byte >> 6);
        text[length++] = (char)(byte >= 0x80 ? 0x80 | (byte & 0x3F) : byte);
    }
    result = json_stringn(text, length);
    free(text);
    return result;
}

json_t *json_text_of(const char *bytes, size_t size)
{
    json_t *result = json_stringn(bytes, size);

    return result ? result : from_latin_1(bytes, size);
}

json_t *json_text(const char *text)
{
    return json_text_of(text, strlen(text));
}

json_t *json_with(json_t *object, const char *key, json_t *value)
{
    if (object && json_object_set_new(object, key, value) == 0) /* takes the value anyhow */
        return object;
    if (!object)
        json_decref(value);
    json_decref(object);
    return NULL;
}

bool json_write(json_t *value, size_t flags, FILE *file)
{
    bool good = value && json_dumpf(value, file, flags | JSON_ENCODE_ANY) == 0;

    json_decref(value);
    return good;
}
