#include "mcanopen_sim_values.h"

#include "api/scan.h"
#include "base/bytes.h"
#include "dcf/dcf_number.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DEFAULT_STEP_MS 100u
#define LEAST_MS        1u
#define MOST_MS         3600000u
#define FILE_MOST       (16u * 1024u * 1024u) /* bytes of a domain */

static const char *const names[] = { "--set", "--ramp", "--toggle", "--file" };

static bool refuse(enum sim_motion motion, const char *option, const char *why)
{
    fprintf(stderr, "mcanopen sim: %s %s: %s\n", names[motion], option, why);
    return false;
}

/* ---- the option ---- */

/* A hexadecimal number up to 'most', and what stands behind it. */
static bool read_number(const char **text, int base, unsigned long most, unsigned *ret_number)
{
    char *end;
    const unsigned long number = strtoul(*text, &end, base);

    if (end == *text || **text == '-' || number > most)
        return false;
    *text = end;
    *ret_number = (unsigned)number;
    return true;
}

static bool read_place(const char **text, struct sim_value *value)
{
    if (!read_number(text, 10, NMT_NODE_MAX, &value->node) || value->node == 0 || *(*text)++ != ':')
        return false;
    if (!read_number(text, 16, UINT16_MAX, &value->index))
        return false;
    if (**text == ':') {
        ++*text;
        if (!read_number(text, 16, UINT8_MAX, &value->sub))
            return false;
    }
    return *(*text)++ == '=';
}

static bool copy(const char *text, size_t length, char ret_text[SIM_TEXT_MAX])
{
    if (length == 0 || length >= SIM_TEXT_MAX)
        return false;
    memcpy(ret_text, text, length);
    ret_text[length] = '\0';
    return true;
}

/* "A..B/MS[/STEP]" */
static bool read_motion(const char *text, struct sim_value *value)
{
    const char *dots = strstr(text, "..");
    const char *slash = dots ? strchr(dots, '/') : NULL;

    if (!slash || !copy(text, (size_t)(dots - text), value->from) ||
        !copy(dots + 2, (size_t)(slash - dots) - 2, value->to))
        return false;
    text = slash + 1;
    if (!read_number(&text, 10, MOST_MS, &value->period_ms) || value->period_ms < LEAST_MS)
        return false;
    value->step_ms = value->motion == SIM_TOGGLE ? value->period_ms : DEFAULT_STEP_MS;
    if (*text == '/' && value->motion == SIM_RAMP) {
        text++;
        if (!read_number(&text, 10, MOST_MS, &value->step_ms) || value->step_ms < LEAST_MS)
            return false;
    }
    return *text == '\0';
}

bool sim_value_parse(enum sim_motion motion, const char *option, struct sim_value *ret_value)
{
    struct sim_value value = { .motion = motion, .option = option, .due = CO_NEVER };
    const char *text = option;

    if (!read_place(&text, &value))
        return refuse(motion, option,
                      "expected NODE:INDEX[:SUB]=..., with INDEX and SUB in "
                      "hexadecimal: 5:6000:1=...");
    if (motion == SIM_SET && !copy(text, strlen(text), value.from))
        return refuse(motion, option, "expected a value behind the =");
    if (motion == SIM_FILE && *text == '\0')
        return refuse(motion, option, "expected a file behind the =");
    value.path = text;
    if ((motion == SIM_RAMP || motion == SIM_TOGGLE) && !read_motion(text, &value))
        return refuse(motion, option, "expected A..B/MS behind the =: 0..100/2000");
    *ret_value = value;
    return true;
}

/* ---- values ---- */

static struct dcf_slice slice_of(const char *text)
{
    return (struct dcf_slice){ text, strlen(text) };
}

/* As it travels; false: not of this type. */
static bool bytes_of(const char *text, uint8_t type, uint8_t ret_bytes[8])
{
    struct dcf_number number;
    unsigned quirks = 0;

    memset(ret_bytes, 0, 8);
    if (type == OD_REAL32 || type == OD_REAL64)
        return dcf_real_parse(slice_of(text), type, ret_bytes, &quirks) == DCF_FITS;
    return dcf_number_parse(slice_of(text), &number) &&
           dcf_number_store(&number, type, ret_bytes) == DCF_FITS;
}

static double to_double(uint8_t type, const uint8_t bytes[8])
{
    union {
        uint32_t bits;
        float value;
    } small = { .bits = get_le32(bytes) };
    union {
        uint64_t bits;
        double value;
    } large = { .bits = get_le(bytes, 8) };
    struct od_entry entry = { .type = type, .size = od_type_size(type) };

    if (type == OD_REAL32)
        return (double)small.value;
    if (type == OD_REAL64)
        return large.value;
    entry.value = entry.small[0];
    memcpy(entry.value, bytes, 8);
    return (double)od_entry_signed(&entry);
}

static void from_double(uint8_t type, double value, uint8_t ret_bytes[8])
{
    union {
        float value;
        uint32_t bits;
    } small = { .value = (float)value };
    union {
        double value;
        uint64_t bits;
    } large = { .value = value };

    if (type == OD_REAL32)
        put_le(ret_bytes, 8, small.bits);
    else if (type == OD_REAL64)
        put_le(ret_bytes, 8, large.bits);
    else
        put_le(ret_bytes, 8, (uint64_t)(int64_t)value);
}

static int write_bytes(const struct sim_value *self, const uint8_t bytes[8])
{
    union scan_number number;

    scan_number_from(self->type, bytes, &number);
    return canOpenWriteDictionary(self->handle, (unsigned short)self->index,
                                  (unsigned short)self->sub, &number);
}

static int write_text(const struct sim_value *self)
{
    static const unsigned long longest = SIM_TEXT_MAX;
    RecVisString text = { .ulSize = longest, .ulLength = strlen(self->from) };
    int result;

    text.pData = strndup(self->from, longest); /* stays the device's until the program ends */
    result = text.pData ? canOpenWriteDictionary(self->handle, (unsigned short)self->index,
                                                 (unsigned short)self->sub, &text)
                        : SCANOPEN_OUT_OF_MEMORY;
    if (result != SCANOPEN_OK)
        free(text.pData);
    return result;
}

static const char *text_of(int result)
{
    switch (result) {
    case SCANOPEN_WRONG_INDEX: return "the device has no such object";
    case SCANOPEN_WRONG_SUBINDEX: return "the object has no such sub-index";
    case SCANOPEN_VALUE_TOO_HIGH: return "above the HighLimit of the object";
    case SCANOPEN_VALUE_TOO_LOW: return "below the LowLimit of the object";
    case SCANOPEN_ACCESS_ERROR: return "the object belongs to the device itself";
    default: return "the device does not take it";
    }
}

static bool find_type(struct sim_value *self)
{
    struct scan_node *node;
    const struct od_entry *entry;

    if (scan_enter(self->handle, &node) != SCANOPEN_OK)
        return false;
    entry = od_find(&node->od, (uint16_t)self->index, (uint8_t)self->sub);
    if (entry)
        self->type = entry->type;
    scan_leave(node);
    return entry != NULL;
}

/* ---- in time ---- */

/* True as long as there is something to come. */
static bool has_more(const struct sim_value *self)
{
    return self->motion == SIM_RAMP || self->motion == SIM_TOGGLE;
}

static int write_now(const struct sim_value *self, co_us_t now)
{
    const co_us_t period = CO_MS(self->period_ms);
    uint8_t from[8], to[8], bytes[8];

    if (!bytes_of(self->from, self->type, from) ||
        (has_more(self) && !bytes_of(self->to, self->type, to)))
        return SCANOPEN_WRONG_TYPE;
    if (!has_more(self))
        return write_bytes(self, from);
    if (self->motion == SIM_TOGGLE)
        return write_bytes(self, (now - self->begin) / period % 2 == 0 ? from : to);
    from_double(self->type,
                to_double(self->type, from) +
                    (to_double(self->type, to) - to_double(self->type, from)) *
                        (double)((now - self->begin) % period) / (double)period,
                bytes);
    return write_bytes(self, bytes);
}

static bool is_text(const struct sim_value *self)
{
    return self->motion == SIM_SET && scan_is_text(self->type);
}

static bool begin_file(const struct sim_value *self)
{
    const int result = canOpenSetDomainFile(self->handle, (unsigned short)self->index,
                                            (unsigned short)self->sub, self->path, FILE_MOST);

    if (result == SCANOPEN_WRONG_INDEX || result == SCANOPEN_WRONG_TYPE)
        return refuse(self->motion, self->option, "expected an object 2000h..9FFFh of type DOMAIN");
    if (result != SCANOPEN_OK)
        return refuse(self->motion, self->option, text_of(result));
    return true;
}

bool sim_value_begin(struct sim_value *self, HNODE node, co_us_t now)
{
    char why[SIM_TEXT_MAX + 80];
    int result;

    self->handle = node;
    if (!find_type(self))
        return refuse(self->motion, self->option, "the device has no such object");
    if (self->motion == SIM_FILE)
        return begin_file(self);
    self->begin = now;
    result = is_text(self) ? write_text(self) : write_now(self, now);
    if (result == SCANOPEN_WRONG_TYPE) {
        snprintf(why, sizeof why, "not a value of type %s", od_type_name(self->type));
        return refuse(self->motion, self->option, why);
    }
    if (result != SCANOPEN_OK && result != SCANOPEN_INHIBITED)
        return refuse(self->motion, self->option, text_of(result));
    self->due = has_more(self) ? now + CO_MS(self->step_ms) : CO_NEVER;
    return true;
}

/* Late by more than a step: the steps between are left out. */
void sim_value_step(struct sim_value *self, co_us_t now)
{
    const co_us_t step = CO_MS(self->step_ms);

    if (self->due > now)
        return;
    write_now(self, now);
    self->due += ((now - self->due) / step + 1) * step;
}
