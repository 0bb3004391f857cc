#include "dcftest_online.h"

#include "base/bytes.h"
#include "common_file.h"
#include "dcf/dcf.h"
#include "dcftest_sdo.h"
#include "port/clock.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define LONGEST       65536u /* bytes of a value without a fixed size */
#define TRIES         2u
#define FLAG_NO_SCAN  2u /* ObjFlags: refuse read on scan */
#define FIRST_OBJECT  0x1000u
#define DEVICE_TYPE   0x1000u
#define ERROR_HISTORY 0x1003u
#define IDENTITY      0x1018u
#define STRUCTURE     0xFFu /* sub-index of a description, which few devices have */
#define PROGRESS      CO_MS(100)

struct run {
    const struct settings *settings;
    const struct online *online;
    const struct dcf *dcf;
    struct result *result;
    struct sdo_reader reader;
    uint8_t node_id;
    uint8_t *buffer; /* LONGEST */
    unsigned read, compared, missing, different;
    unsigned write_only, protected, domains; /* left out */
    bool silent;                             /* nothing was answered, or no more */
    co_us_t shown;
};

static void tell(struct run *self, enum tool_rule rule, unsigned line, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

static void tell(struct run *self, enum tool_rule rule, unsigned line, const char *format, ...)
{
    char text[CO_REPORT_TEXT_SIZE];
    va_list args;

    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    result_add(self->result, self->settings, &tool_rules[rule], line, text);
}

/* --- what to expect --- */

/* A number of [DeviceInfo] that 1018h repeats; 0: none. */
static uint32_t identity_number(const struct dcf *dcf, const struct dcf_entry *entry)
{
    if (entry->index != IDENTITY)
        return 0;
    switch (entry->sub) {
    case 1: return dcf->vendor_number;
    case 2: return dcf->product_number;
    case 3: return dcf->revision_number;
    default: return 0;
    }
}

struct expected {
    const struct dcf_value *value; /* NULL: a number of [DeviceInfo] */
    uint32_t number;
    enum tool_rule rule;
    unsigned line;
};

static bool is_zero(const struct dcf_value *value)
{
    for (uint32_t i = 0; i < value->size; i++)
        if (value->bytes[i] != 0)
            return false;
    return true;
}

/* False: the file says nothing that the device has to keep to. */
static bool expect(const struct run *self, const struct dcf_entry *entry, struct expected *ret)
{
    const bool is_type = entry->index == DEVICE_TYPE && entry->initial.given &&
                         !is_zero(&entry->initial);

    *ret = (struct expected){ .rule = RULE_ONLINE_VALUE, .line = entry->line };
    ret->number = identity_number(self->dcf, entry);
    if (entry->parameter.given)
        ret->value = &entry->parameter;
    else if (ret->number == 0 && entry->initial.given && (self->online->all || is_type))
        ret->value = &entry->initial;
    if (ret->value)
        ret->line = ret->value->line;
    if (is_type || entry->index == IDENTITY)
        ret->rule = RULE_ONLINE_IDENTITY;
    return ret->value || ret->number != 0;
}

static uint8_t *expected_bytes(const struct run *self, const struct expected *expected,
                               uint32_t *ret_size)
{
    uint8_t *bytes = malloc(expected->value ? expected->value->size + 1u : 4u);

    if (bytes && expected->value)
        *ret_size = dcf_value(expected->value, self->node_id, bytes);
    if (bytes && !expected->value) {
        *ret_size = 4;
        put_le(bytes, 4, expected->number);
    }
    return bytes;
}

/* --- what the device has --- */

static void tell_size(struct run *self, const struct dcf_entry *entry, uint64_t size)
{
    const uint32_t wanted = value_number_size(entry->type);

    self->different++;
    if (wanted == 0)
        tell(self, RULE_ONLINE_SIZE, entry->line,
             "%04Xh:%02X: size %u at most expected, the device has more", entry->index, entry->sub,
             LONGEST);
    else if (size > 0)
        tell(self, RULE_ONLINE_SIZE, entry->line,
             "%04Xh:%02X: size %u expected (of its data type), the device has size %llu",
             entry->index, entry->sub, wanted, (unsigned long long)size);
    else
        tell(self, RULE_ONLINE_SIZE, entry->line,
             "%04Xh:%02X: size %u expected (of its data type), the device has another",
             entry->index, entry->sub, wanted);
}

static void compare(struct run *self, const struct dcf_entry *entry, uint32_t size)
{
    const uint32_t wanted = value_number_size(entry->type);
    struct expected expected;
    uint32_t expected_size = 0;
    uint8_t *bytes;

    if (wanted != 0 && size != wanted) {
        tell_size(self, entry, size);
        return;
    }
    if (!expect(self, entry, &expected))
        return;
    bytes = expected_bytes(self, &expected, &expected_size);
    self->result->no_memory |= bytes == NULL;
    self->compared++;
    if (bytes && !value_is_same(entry->type, bytes, expected_size, self->buffer, size)) {
        self->different++;
        tell(self, expected.rule, expected.line, "%04Xh:%02X: %s %s, device %s", entry->index,
             entry->sub, self->dcf->is_dcf ? "DCF" : "EDS",
             value_show(entry->type, bytes, expected_size).text,
             value_show(entry->type, self->buffer, size).text);
    }
    free(bytes);
}

static void tell_refusal(struct run *self, const struct dcf_entry *entry, sdo_abort_t code)
{
    const bool absent = code == SDO_NO_OBJECT || code == SDO_NO_SUB;

    /* What is not there now may be there at another time. */
    if ((entry->index == ERROR_HISTORY && entry->sub > 0) || code == SDO_NO_DATA ||
        (absent && entry->sub == STRUCTURE))
        return;
    self->missing++;
    if (absent)
        tell(self, RULE_ONLINE_OBJECT, entry->line,
             "%04Xh:%02X: the device does not have it: abort %08lXh, %s", entry->index, entry->sub,
             (unsigned long)code, sdo_abort_text(code));
    else
        tell(self, RULE_ONLINE_OBJECT, entry->line,
             "%04Xh:%02X: the device does not let it be read: abort %08lXh, %s", entry->index,
             entry->sub, (unsigned long)code, sdo_abort_text(code));
}

/* False: the bus is lost. */
static bool read_object(struct run *self, uint16_t index, uint8_t sub, uint32_t room,
                        struct co_event *ret_done)
{
    for (unsigned i = 0; i < TRIES; i++) {
        if (!sdo_reader_read(&self->reader, index, sub, self->buffer, room, ret_done))
            return false;
        if (ret_done->detail != SDO_OUTCOME_NO_ANSWER)
            break;
    }
    return true;
}

/* It may be this object alone for which there is no answer. */
static bool check_alive(struct run *self, const struct dcf_entry *entry)
{
    struct co_event done;

    if (self->read > 0 && !read_object(self, DEVICE_TYPE, 0, 4, &done))
        return false;
    if (self->read > 0 && done.detail != SDO_OUTCOME_NO_ANSWER) {
        self->missing++;
        tell(self, RULE_ONLINE_OBJECT, entry->line,
             "%04Xh:%02X: the device gives no answer within %u ms, to others it does", entry->index,
             entry->sub, self->online->timeout);
        return true;
    }
    self->silent = true;
    snprintf(self->reader.message, sizeof self->reader.message,
             "node %u does not answer to %04Xh:%02X within %u ms: it is absent, off or stopped, "
             "or has another node-ID or bit rate",
             self->node_id, entry->index, entry->sub, self->online->timeout);
    return false;
}

/* False: it makes no sense to go on. */
static bool check_entry(struct run *self, const struct dcf_entry *entry)
{
    const uint32_t size = value_number_size(entry->type);
    struct co_event done;

    if (!read_object(self, entry->index, entry->sub, size > 0 ? size : LONGEST, &done))
        return false;
    switch ((enum sdo_outcome)done.detail) {
    case SDO_OUTCOME_OK: compare(self, entry, (uint32_t)done.actual); break;
    case SDO_OUTCOME_ABORTED: tell_refusal(self, entry, done.code); break;
    case SDO_OUTCOME_OVERFLOW: tell_size(self, entry, done.actual); break;
    case SDO_OUTCOME_NO_ANSWER: return check_alive(self, entry);
    case SDO_OUTCOME_NOT_SENT:
    case SDO_OUTCOME_CANCELLED: return false;
    case SDO_OUTCOME_TOGGLE:
    case SDO_OUTCOME_PROTOCOL:
        self->missing++;
        tell(self, RULE_ONLINE_OBJECT, entry->line,
             "%04Xh:%02X: the device does not keep to the SDO protocol: %s", entry->index,
             entry->sub, sdo_abort_text(done.code));
        break;
    }
    self->read++;
    return true;
}

/* --- all of them --- */

static bool is_read(struct run *self, const struct dcf_entry *entry)
{
    unsigned *left_out = NULL;

    if (entry->type == OD_DOMAIN)
        left_out = &self->domains;
    if (entry->flags & FLAG_NO_SCAN)
        left_out = &self->protected;
    if (entry->access == OD_WO)
        left_out = &self->write_only;
    if (left_out && entry->index >= FIRST_OBJECT)
        ++*left_out;
    return !left_out && entry->index >= FIRST_OBJECT && entry->access != OD_NONE;
}

static void show_progress(struct run *self, size_t number, const struct dcf_entry *entry)
{
    if (self->settings->quiet || !isatty(STDERR_FILENO) || clock_now() < self->shown + PROGRESS)
        return;
    self->shown = clock_now();
    fprintf(stderr, "\rnode %u: entry %lu of %lu, %04Xh:%02X ", self->node_id,
            (unsigned long)number, (unsigned long)self->dcf->count, entry->index, entry->sub);
}

static bool check_entries(struct run *self)
{
    const struct dcf *dcf = self->dcf;
    bool good = true;

    for (size_t i = 0; good && i < dcf->count; i++) {
        show_progress(self, i + 1, &dcf->entries[i]);
        if (is_read(self, &dcf->entries[i]))
            good = check_entry(self, &dcf->entries[i]);
    }
    if (self->shown)
        fputs("\r\033[K", stderr);
    return good;
}

static void print_count(const struct run *self)
{
    if (self->settings->quiet)
        return;
    fprintf(stderr,
            "node %u on %s: %u entries read, %u values compared; %u differ, %u cannot be read; "
            "left out: %u write-only, %u by ObjFlags, %u domains\n",
            self->node_id, self->online->bus, self->read, self->compared, self->different,
            self->missing, self->write_only, self->protected, self->domains);
}

static void tell_others(const struct run *self)
{
    if (self->reader.foreign > 0)
        fprintf(stderr,
                "dcftest: somebody else has sent %u requests to the SDO server of node %u: answers "
                "may have been mixed up\n",
                self->reader.foreign, self->node_id);
}

/* The exit code of the bus; what was found until then is in the result. */
static int check_device(struct run *self)
{
    bool good;

    self->buffer = malloc(LONGEST);
    if (!self->buffer) {
        self->result->no_memory = true;
        return DCFTEST_CLEAN;
    }
    good = sdo_reader_open(&self->reader, self->online->bus, self->node_id,
                           CO_MS(self->online->timeout)) &&
           check_entries(self);
    sdo_reader_close(&self->reader);
    free(self->buffer);
    if (good)
        print_count(self);
    else
        fprintf(stderr, "dcftest: %s\n", self->reader.message);
    tell_others(self);
    return good ? DCFTEST_CLEAN : DCFTEST_BUS;
}

/* --- the file --- */

static void take_error(void *context, const struct co_message *message)
{
    const struct run *self = context;

    if (message->severity == CO_ERROR)
        result_take(self->result, self->settings, message);
}

static int check_parsed(struct run *self)
{
    const struct dcf *dcf = self->dcf;

    self->node_id = self->settings->node_id;
    if (self->node_id == 0 && dcf->has_node_id)
        self->node_id = dcf->node_id;
    if (self->node_id == 0) {
        fputs("dcftest: -n: the node-ID of the device expected, the file has none\n", stderr);
        return DCFTEST_TROUBLE;
    }
    if (dcf->has_node_id && dcf->node_id != self->node_id)
        tell(self, RULE_ONLINE_IDENTITY, dcf->node_id_line,
             "NodeID is %u, the device that is asked has node-ID %u", dcf->node_id, self->node_id);
    return check_device(self);
}

static int check_text(struct run *self, const char *text, size_t size)
{
    struct co_report report = { .sink = take_error, .context = self };
    struct dcf dcf;
    enum co_err err = dcf_parse(text, size, &report, &dcf);
    int result = DCFTEST_CLEAN;

    self->dcf = &dcf;
    if (err == CO_OK)
        result = check_parsed(self);
    else if (err == CO_ERR_MEMORY)
        self->result->no_memory = true;
    self->dcf = NULL;
    dcf_done(&dcf);
    return result;
}

int online_check(const struct settings *settings, const struct online *online,
                 const struct file *file, const struct writer *writer)
{
    struct result result;
    struct run run = { .settings = settings, .online = online, .result = &result };
    struct totals totals = { .files = 0 };
    char *text = NULL;
    size_t size = 0;
    int code = DCFTEST_CLEAN;

    result_init(&result, file_input_name(file->path));
    if (read_or_tell(settings, file, &result, &text, &size))
        code = check_text(&run, text, size);
    result_finish(&result, settings, text, size);
    free(text);
    if (!write_one(settings, writer, &result, &totals))
        return DCFTEST_TROUBLE;
    return code != DCFTEST_CLEAN ? code : exit_code(settings, &totals);
}
