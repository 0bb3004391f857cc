/* Texts to values: the part of network_config_elements.h that reads what stands in an element. */
#include "manager/network_config_elements.h"

#include "manager/network_config.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ASCII_MAX 4095u /* as long as a path may be */
#define LIST_MAX  4u
#define BLANKS    " \t\r\n"

struct place { /* where a value comes from and where it goes */
    const struct element *element;
    unsigned line;
    void *base;
    struct faults *faults;
};

static int digit_value(char c)
{
    if (c >= '0' && c <= '9')
        return c - '0';
    if (c >= 'a' && c <= 'f')
        return c - 'a' + 10;
    if (c >= 'A' && c <= 'F')
        return c - 'A' + 10;
    return 16;
}

/* Decimal, also with leading zeros, or 0x and hexadecimal. What is too large to hold becomes
 * INT64_MAX, out of any range. */
static bool parse_digits(const char *text, const char *end, int64_t *ret_value)
{
    const bool negative = text < end && *text == '-';
    int64_t value = 0;
    int base = 10;

    text += negative;
    if (end - text >= 2 && text[0] == '0' && (text[1] == 'x' || text[1] == 'X')) {
        base = 16;
        text += 2;
    }
    if (text == end)
        return false;
    for (; text < end; text++) {
        int digit = digit_value(*text);

        if (digit >= base)
            return false;
        value = value > INT64_MAX / 32 ? INT64_MAX : value * base + digit;
    }
    *ret_value = negative ? -value : value;
    return true;
}

static bool parse_number(const char *text, int64_t *ret_value)
{
    return parse_digits(text, text + strlen(text), ret_value);
}

static void tell_not(const struct place *place, const char *text, const char *what)
{
    char excerpt[FAULTS_EXCERPT_SIZE];

    faults_error(place->faults, CO_ERR_VALUE, place->line, "%s: '%s' is %s", place->element->name,
                 faults_excerpt(text, excerpt), what);
}

static void tell_range(const struct place *place, const char *text, const char *range)
{
    const struct element *element = place->element;
    char excerpt[FAULTS_EXCERPT_SIZE];

    faults_error(place->faults,
                 element->out_of_range != CO_OK ? element->out_of_range : CO_ERR_VALUE, place->line,
                 "%s: %s is out of range %s", element->name, faults_excerpt(text, excerpt), range);
}

static void set_number(const struct place *place, const char *text)
{
    const struct element *element = place->element;
    const bool is_preset_outside = element->preset < element->low && !element->mandatory;
    char range[48];
    int64_t value;

    if (!parse_number(text, &value)) {
        tell_not(place, text, "not a number");
        return;
    }
    if ((value >= element->low && value <= element->high) ||
        (is_preset_outside && value == element->preset)) {
        element_put(element, place->base, (uint32_t)value);
        return;
    }
    if (element->high == UINT32_MAX)
        snprintf(range, sizeof range, "0..0xFFFFFFFF");
    else if (is_preset_outside)
        snprintf(range, sizeof range, "%u or %u..%u", element->preset, element->low, element->high);
    else
        snprintf(range, sizeof range, "%u..%u", element->low, element->high);
    tell_range(place, text, range);
}

static void set_bitrate(const struct place *place, const char *text)
{
    static const uint16_t rates[] = { 10, 20, 50, 100, 125, 250, 500, 800, 1000 };
    char excerpt[FAULTS_EXCERPT_SIZE];
    int64_t value;

    if (!parse_number(text, &value)) {
        tell_not(place, text, "not a number");
        return;
    }
    for (size_t i = 0; i < sizeof rates / sizeof *rates; i++)
        if (value == rates[i]) {
            element_put(place->element, place->base, rates[i]);
            if (value == 100)
                faults_note(place->faults, CO_WARNING, place->line,
                            "%s: 100 is no bit rate of CANopen; some devices have it all the same",
                            place->element->name);
            return;
        }
    faults_error(place->faults, CO_ERR_BITRATE, place->line,
                 "%s: %s is no bit rate of CANopen (10, 20, 50, 125, 250, 500, 800, 1000)",
                 place->element->name, faults_excerpt(text, excerpt));
}

static bool equal_but_case(const char *a, const char *upper)
{
    for (; *a != '\0' && *upper != '\0'; a++, upper++)
        if (*a != *upper && !(*a >= 'a' && *a <= 'z' && *a - 'a' + 'A' == *upper))
            return false;
    return *a == *upper;
}

static void set_bool(const struct place *place, const char *text)
{
    const bool value = equal_but_case(text, "TRUE");
    const char *word = value ? "TRUE" : "FALSE";

    if (!value && !equal_but_case(text, "FALSE")) {
        tell_not(place, text, "neither TRUE nor FALSE");
        return;
    }
    element_put(place->element, place->base, value);
    if (strcmp(text, word) != 0)
        faults_note(place->faults, CO_WARNING, place->line, "%s: '%s' is taken as %s",
                    place->element->name, text, word);
}

static void set_action(const struct place *place, const char *text)
{
    static const char *const names[] = { [ACTION_RESET_SLAVE] = "RESET_SLAVE",
                                         [ACTION_RESET_ALL] = "RESET_ALL",
                                         [ACTION_STOP_ALL] = "STOP_ALL" };

    for (uint32_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(text, names[i]) == 0) {
            element_put(place->element, place->base, i);
            return;
        }
    tell_not(place, text, "none of RESET_SLAVE, RESET_ALL, STOP_ALL");
}

static void set_ascii(const struct place *place, const char *text)
{
    char *copy;

    for (const char *c = text; *c != '\0'; c++)
        if ((unsigned char)*c < ' ' || *c == 0x7F) {
            tell_not(place, text, "text with a line end or another control character");
            return;
        }
    if (strlen(text) > ASCII_MAX) {
        tell_not(place, text, "too long");
        return;
    }
    copy = strdup(text);
    if (!copy) {
        place->faults->no_memory = true;
        return;
    }
    memcpy((char *)place->base + place->element->offset, &copy, sizeof copy);
}

/* False: not exactly count numbers, with or without blanks around each. */
static bool parse_list(const char *text, int64_t *values, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const char *colon = strchr(text, ':');
        const char *end = colon ? colon : text + strlen(text);
        const char *next = colon ? colon + 1 : end;

        text += strspn(text, BLANKS);
        while (end > text && strchr(BLANKS, end[-1]))
            end--;
        if ((colon != NULL) != (i + 1 < count) || !parse_digits(text, end, &values[i]))
            return false;
        text = next;
    }
    return true;
}

static void set_int16(const struct place *place, const char *text)
{
    const struct element *element = place->element;
    const size_t count = element->size / sizeof(int16_t);
    int16_t numbers[LIST_MAX];
    int64_t values[LIST_MAX];
    char what[64];

    if (!parse_list(text, values, count)) {
        snprintf(what, sizeof what, "not %zu numbers separated by colons", count);
        tell_not(place, text, what);
        return;
    }
    for (size_t i = 0; i < count; i++) {
        if (values[i] < INT16_MIN || values[i] > INT16_MAX) {
            tell_range(place, text, "-32768..32767");
            return;
        }
        numbers[i] = (int16_t)values[i];
    }
    memcpy((char *)place->base + element->offset, numbers, element->size);
}

void element_set(const struct element *self, const char *text, unsigned line, void *base,
                 struct faults *faults)
{
    const struct place place = { self, line, base, faults };
    const bool given = true;

    if (*text == '\0') {
        faults_error(faults, CO_ERR_VALUE, line, "%s: the element is empty", self->name);
        return;
    }
    if (self->given != 0)
        memcpy((char *)base + self->given, &given, sizeof given);
    switch (self->kind) {
    case ELEMENT_NUMBER: set_number(&place, text); break;
    case ELEMENT_BITRATE: set_bitrate(&place, text); break;
    case ELEMENT_INT16: set_int16(&place, text); break;
    case ELEMENT_BOOL: set_bool(&place, text); break;
    case ELEMENT_ASCII: set_ascii(&place, text); break;
    case ELEMENT_ACTION: set_action(&place, text); break;
    }
}
