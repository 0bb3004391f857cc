#include "conform.h"

#include "../verbs.h"
#include "base/bytes.h"
#include "od/abort.h"
#include "port/clock.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#define TRACE_AT_MOST 64u /* lines; what is left out is told */

/* --- what checks say: the first word counts --- */

static bool say(struct conform *self, enum conform_verdict verdict, const char *format,
                va_list args)
{
    if (self->verdict == CONFORM_PASS) {
        self->verdict = verdict;
        vsnprintf(self->reason, sizeof self->reason, format, args);
    }
    return false;
}

bool conform_fail(struct conform *self, const char *format, ...)
{
    va_list args;

    va_start(args, format);
    say(self, CONFORM_FAIL, format, args);
    va_end(args);
    return false;
}

bool conform_skip(struct conform *self, const char *format, ...)
{
    va_list args;

    va_start(args, format);
    say(self, CONFORM_SKIP, format, args);
    va_end(args);
    return false;
}

bool conform_help(struct conform *self, const char *format, ...)
{
    va_list args;

    va_start(args, format);
    say(self, CONFORM_HELP, format, args);
    va_end(args);
    return false;
}

/* --- one check --- */

static void begin_trace(struct conform *self)
{
    conform_mark(self);
    self->frame_count = 0;
    self->unanswered = 0;
    self->begin = clock_now();
    self->verdict = CONFORM_PASS;
    self->reason[0] = '\0';
    memset(self->shown, 0, sizeof self->shown);
    conform_show(self, 0x000);
    for (uint32_t function = 0; function < 0x800; function += 0x80)
        conform_show(self, function + self->options.node);
    conform_show(self, 0x080);
}

static bool is_shown(const struct conform *self, const struct co_frame *frame)
{
    if (frame->flags & CO_FRAME_OWN)
        return true;
    return frame->id < 0x800 && (self->shown[frame->id / 8] >> frame->id % 8 & 1) != 0;
}

static size_t count_shown(const struct conform *self)
{
    size_t count = 0;

    for (size_t i = 0; i < self->frame_count; i++)
        count += is_shown(self, &self->frames[i].frame);
    return count;
}

static void print_frame(const struct conform *self, const struct bus_rx *rx, FILE *stream)
{
    const co_us_t time = rx->time > self->begin ? rx->time - self->begin : 0;
    char text[CO_FRAME_TEXT_SIZE];

    fprintf(stream, "(%" PRIu64 ".%06" PRIu64 ") %c %s\n", time / 1000000u, time % 1000000u,
            rx->frame.flags & CO_FRAME_OWN ? '>' : '<',
            co_frame_format(&rx->frame, text, sizeof text));
}

/* The last frames of the check, as text; NULL: no memory. */
static char *make_trace(const struct conform *self)
{
    const size_t count = count_shown(self);
    const size_t most = self->options.verbose ? count : TRACE_AT_MOST;
    size_t left_out = count > most ? count - most : 0, size;
    char *text = NULL;
    FILE *stream = open_memstream(&text, &size);

    if (!stream)
        return NULL;
    if (left_out > 0)
        fprintf(stream, "... %zu frames\n", left_out);
    for (size_t i = 0; i < self->frame_count; i++)
        if (is_shown(self, &self->frames[i].frame) && (left_out == 0 || left_out-- == 0))
            print_frame(self, &self->frames[i], stream);
    fclose(stream);
    return text;
}

static bool keep_result(struct conform *self, const struct conform_family *family)
{
    struct conform_result *results = realloc(self->results,
                                             (self->result_count + 1) * sizeof *results);
    struct conform_result *result;

    if (!results)
        return false;
    self->results = results;
    result = &results[self->result_count];
    *result = (struct conform_result){ .family = family,
                                       .check = self->check,
                                       .verdict = self->verdict,
                                       .reason = strdup(self->reason),
                                       .trace = make_trace(self),
                                       .duration = clock_now() - self->begin };
    self->result_count++;
    conform_print_result(self, result);
    return result->reason && result->trace;
}

static bool meets_needs(struct conform *self)
{
    const struct conform_check *check = self->check;

    if ((check->needs & CONFORM_EDS) && !self->has_eds)
        return conform_skip(self, self->options.eds ? "the EDS cannot be used" : "give --eds FILE");
    if ((check->needs & CONFORM_STORE) && !self->options.allow_store)
        return conform_skip(self, "it writes non-volatile memory: give --allow-store");
    return check->object == 0 || conform_need_object(self, check->object);
}

/* --- the device --- */

static void end_silent(struct conform *self, const char *when)
{
    if (self->end != CONFORM_RUNS)
        return;
    self->end = CONFORM_SILENT;
    snprintf(self->message, sizeof self->message,
             "no answer from node %u on %s%s: is it connected and powered, at this bit rate, "
             "with this node-ID?",
             self->options.node, self->options.bus, when);
}

/* Does it answer an SDO request? */
static bool is_alive(struct conform *self)
{
    struct conform_value value;

    return conform_read(self, 0x1000, 0, &value) != CONFORM_NO_ANSWER;
}

/* In pre-operational, with the values of a reset. What is wrong with the boot-up message is a
 * finding of the checks of NMT. */
static bool settle(struct conform *self, unsigned attempts, const char *when)
{
    for (; attempts > 0 && self->end == CONFORM_RUNS; attempts--) {
        begin_trace(self);
        conform_reset(self, CONFORM_RESET_NODE);
        conform_nmt(self, CONFORM_PREOP);
        if (is_alive(self))
            return true;
    }
    end_silent(self, when);
    return false;
}

static bool run_check(struct conform *self, const struct conform_family *family,
                      const struct conform_check *check)
{
    bool runs, kept;
    char when[128];

    begin_trace(self);
    self->check = check;
    runs = meets_needs(self);
    if (runs && !check->run(self))
        conform_fail(self, "the check could not be made");
    if (self->end != CONFORM_RUNS)
        return false;
    kept = keep_result(self, family);
    snprintf(when, sizeof when, " after the check %s", check->name);
    if (runs && (self->verdict == CONFORM_FAIL || (check->needs & CONFORM_RESET)))
        return settle(self, 2, when) && kept;
    return kept;
}

/* --- all checks --- */

static bool is_in(const char *list, const char *name)
{
    const size_t length = strlen(name);

    for (const char *at = list; at && *at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL)
        if (strncmp(at, name, length) == 0 && (at[length] == ',' || at[length] == '\0'))
            return true;
    return false;
}

bool conform_selects(const char *list, const struct conform_family *family,
                     const struct conform_check *check)
{
    return is_in(list, family->name) || is_in(list, check->name);
}

static bool is_selected(const struct conform *self, const struct conform_family *family,
                        const struct conform_check *check)
{
    const struct conform_options *options = &self->options;

    return (!options->only || conform_selects(options->only, family, check)) &&
           !(options->skip && conform_selects(options->skip, family, check));
}

static bool run_family(struct conform *self, const struct conform_family *family)
{
    bool begun = false;
    char when[128];

    snprintf(when, sizeof when, " before the checks of %s", family->name);
    for (size_t i = 0; i < family->count; i++) {
        if (!is_selected(self, family, &family->checks[i]))
            continue;
        if (!begun && !settle(self, 2, when))
            return false;
        begun = true;
        if (!run_check(self, family, &family->checks[i]))
            return false;
    }
    return true;
}

static void run_families(struct conform *self)
{
    for (size_t i = 0; i < conform_family_count; i++)
        if (!run_family(self, conform_families[i]))
            return;
}

/* It may be stopped, or just about to boot. */
static bool find_node(struct conform *self)
{
    begin_trace(self);
    if (is_alive(self))
        return true;
    conform_nmt(self, CONFORM_PREOP);
    return is_alive(self) || settle(self, 1, "");
}

static bool know_device(struct conform *self)
{
    if (conform_know_device(self))
        return true;
    self->end = CONFORM_BUS_LOST;
    snprintf(self->message, sizeof self->message, "out of memory");
    return false;
}

static int exit_code(const struct conform *self)
{
    bool failed = false;

    if (self->end == CONFORM_BUS_LOST || (self->end == CONFORM_SILENT && self->result_count == 0))
        return EXIT_BUS;
    for (size_t i = 0; i < self->result_count; i++)
        failed |= self->results[i].verdict == CONFORM_FAIL;
    return failed || self->end != CONFORM_RUNS ? EXIT_NOT_UP : EXIT_UP;
}

static bool tell(const struct conform *self)
{
    if (self->options.json)
        conform_print_json(self);
    else
        conform_print_summary(self);
    if (self->message[0] != '\0')
        fprintf(stderr, "mcanopen conform: %s\n", self->message);
    return !self->options.junit || conform_write_junit(self, self->options.junit);
}

static void free_run(struct conform *self)
{
    for (size_t i = 0; i < self->result_count; i++) {
        free(self->results[i].reason);
        free(self->results[i].trace);
    }
    free(self->results);
    free(self->frames);
    conform_forget_device(self);
}

/* The device is left as it was found, also when the user has stopped the run. */
static void leave_device(struct conform *self)
{
    if (self->end == CONFORM_STOPPED)
        bus_send(self->bus,
                 &(struct co_frame){
                     .id = 0, .dlc = 2, .data = { CONFORM_RESET_NODE, self->options.node } });
    if (self->end == CONFORM_RUNS)
        settle(self, 2, " at the end");
}

int conform_run(struct conform *self)
{
    const struct bus_options options = { .own_frames = true };
    const struct bus_filter all = { .id = 0 }; /* own remote frames, too */
    int result;

    if (bus_open(self->options.bus, &options, &self->bus, self->message, sizeof self->message) !=
        CO_OK) {
        fprintf(stderr, "mcanopen conform: %s\n", self->message);
        return EXIT_BUS;
    }
    self->message[0] = '\0';
    bus_set_filters(self->bus, &all, 1);
    if (find_node(self) && know_device(self))
        run_families(self);
    leave_device(self);
    bus_close(self->bus);
    result = exit_code(self);
    if (!tell(self) && result == EXIT_UP)
        result = EXIT_USAGE;
    free_run(self);
    return result;
}
