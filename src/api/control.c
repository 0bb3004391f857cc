#include "api/control.h"

#include "api/event_map.h"
#include "api/log.h"
#include "api/trace.h"
#include "manager/boot_text.h"

#include <stdio.h>

/* An event for the log, on its way from a protocol thread. */
struct log_event {
    struct managed *managed;
    struct co_event event;
};

enum co_err control_init(struct registry *registry)
{
    enum co_err err = event_queue_init(&registry->events, sizeof(EVENT_T), CONTROL_EVENTS);

    if (err != CO_OK)
        return err;
    err = event_queue_init(&registry->logs, sizeof(struct log_event), CONTROL_LOG_EVENTS);
    if (err != CO_OK)
        event_queue_done(&registry->events);
    return err;
}

void control_done(struct registry *registry)
{
    event_queue_done(&registry->events);
    event_queue_done(&registry->logs);
}

/* Under the network's lock: what takes time is left to the daemon. */
void control_on_event(void *context, struct network *network, const struct co_event *event)
{
    struct managed *managed = context;
    struct log_event line = { managed, *event };
    EVENT_T events[EVENT_MAP_MAX];
    unsigned count;

    (void)network;
    if (event->type == RUNTIME_FRAME && !trace_wanted(managed->config, event))
        return;
    count = event_map(managed->config, event, events);
    for (unsigned i = 0; i < count; i++)
        event_queue_put(&managed->registry->events, &events[i]);
    if (event->type != MANAGER_REQUEST_DONE)
        event_queue_put(&managed->registry->logs, &line);
    else
        control_wake(managed);
}

/* Where the queue is full, the daemon is awake, and looks when it has done what it does. */
void control_wake(struct managed *managed)
{
    const struct log_event line = { managed, { .type = MANAGER_REQUEST_DONE } };

    if (sdo_async_note_end(managed))
        event_queue_put(&managed->registry->logs, &line);
}

static void bus_state_text(const struct network *network, uint8_t state, char *text, size_t size)
{
    static const char *const states[] = { "error active", "error warning", "error passive",
                                          "bus-off", "down" };
    char why[CO_REPORT_TEXT_SIZE];

    network_explain(network, why, sizeof why);
    snprintf(text, size, "bus is %s: %s", state <= BUS_DOWN ? states[state] : "?", why);
}

static void unsent_text(const struct network *network, const struct co_event *event, char *text,
                        size_t size)
{
    char why[CO_REPORT_TEXT_SIZE];

    network_explain(network, why, sizeof why);
    snprintf(text, size, "%u frames given up: the bus did not take them: %s",
             (unsigned)event->actual, why);
}

static void busy_text(const struct network *network, char *text, size_t size)
{
    char why[CO_REPORT_TEXT_SIZE];

    network_explain(network, why, sizeof why);
    snprintf(text, size, "frames have to wait for the bus: %s", why);
}

bool control_bus_text(const struct network *network, const struct co_event *event, char *text,
                      size_t size)
{
    switch (event->type) {
    case RUNTIME_FRAMES_LOST:
        snprintf(text, size, "%u received frames lost: this computer is too slow for the bus",
                 (unsigned)event->actual);
        return true;
    case RUNTIME_UNSENT: unsent_text(network, event, text, size); return true;
    case RUNTIME_BUSY: busy_text(network, text, size); return true;
    case RUNTIME_BUS_STATE: bus_state_text(network, event->detail, text, size); return true;
    default: return false;
    }
}

/* Other tools may change the configuration, with the names in it, while it is read. */
static bool manager_text(const struct log_event *line, enum co_severity *ret_severity, char *text,
                         size_t size)
{
    struct network *network = line->managed->network;
    bool is_news;

    network_hold(network);
    is_news = boot_text_event(line->managed->config, &line->event, ret_severity, text, size);
    network_release(network);
    return is_news;
}

/* False: nothing is to be said. */
static bool make_text(const struct log_event *line, enum co_severity *ret_severity, char *text,
                      size_t size)
{
    if (line->event.type != RUNTIME_FRAME)
        return control_bus_text(line->managed->network, &line->event, text, size) ||
               manager_text(line, ret_severity, text, size);
    *ret_severity = CO_INFO;
    trace_text(&line->event, text, size);
    return true;
}

/* Which network a message is about, where that is not clear by itself. */
static const char *name_of(const struct managed *managed)
{
    if (managed->config->name)
        return managed->config->name;
    return managed->registry->network_count > 1 ? network_name(managed->network) : "";
}

static void log_line(const struct log_event *line)
{
    const struct managed *managed = line->managed;
    const char *name = name_of(managed);
    char text[CO_REPORT_TEXT_SIZE], full[CO_REPORT_TEXT_SIZE + 64];
    enum co_severity severity = CO_WARNING;

    if (!make_text(line, &severity, text, sizeof text))
        return;
    snprintf(full, sizeof full, "%.63s%s%s", name, name[0] ? ": " : "", text);
    log_put(severity, full);
}

static void log_lost(unsigned count)
{
    char text[80];

    snprintf(text, sizeof text, "%u messages lost: the log hook is too slow", count);
    log_put(CO_WARNING, text);
}

void *control_run(void *context)
{
    struct registry *self = context;
    struct log_event line;
    unsigned lost;

    while (event_queue_take(&self->logs, CO_NEVER, &line, &lost) == CO_OK) {
        if (lost > 0)
            log_lost(lost);
        else if (line.event.type != MANAGER_REQUEST_DONE)
            log_line(&line);
        for (size_t i = 0; i < self->network_count; i++)
            sdo_async_tell(&self->networks[i]);
    }
    for (size_t i = 0; i < self->network_count; i++)
        sdo_async_tell_rest(&self->networks[i]);
    return NULL;
}
