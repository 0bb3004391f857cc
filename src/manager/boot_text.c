#include "manager/boot_text.h"

#include "manager/boot_text_parts.h"
#include "proto/emcy.h"

static void add_node(struct text *text, const struct network_config *config, uint8_t node_id)
{
    const struct node_config *node = network_config_node(config, node_id);

    text_add(text, "node %u", node_id);
    if (node_id == config->manager_node_id)
        text_add(text, " (manager)");
    else if (node && node->name)
        text_add(text, " \"%s\"", node->name);
    text_add(text, ": ");
}

static const char *const step_texts[] = {
    [BOOT_DEVICE_TYPE] = "boot begins, asks for its device type",
    [BOOT_IDENTITY] = "checks its identity",
    [BOOT_CHECK_CONFIGURATION] = "checks its configuration date",
    [BOOT_SAVE] = "saves its configuration",
    [BOOT_CHECK_STATE] = "asks for its state, it is to be kept alive",
    [BOOT_CHECK_SOFTWARE] = "checks its software",
    [BOOT_RESTORE] = "restores its default values",
};

static void add_software(struct text *text, const struct node_config *node,
                         const struct co_event *event)
{
    switch (event->detail) {
    case SOFTWARE_STOP: text_add(text, "stops its program"); break;
    case SOFTWARE_CLEAR: text_add(text, "clears its program"); break;
    case SOFTWARE_WRITE:
        text_add(text, "writes its program: %u bytes of %s", (unsigned)event->actual,
                 node->software_file ? node->software_file : "1F58h");
        break;
    case SOFTWARE_COMPARE: text_add(text, "its program is written, compares it"); break;
    default: text_add(text, "starts its program"); break;
    }
}

/* False for steps that other events tell. */
static bool add_step(struct text *text, const struct node_config *node,
                     const struct co_event *event)
{
    uint8_t step = event->detail;

    if (step == BOOT_RESET)
        text_add(text, "reset, boot delay %u ms", node->boot_delay);
    else if (step == BOOT_CONFIGURE && node->verify_configuration)
        text_add(text, "compares its configuration: %u entr%s of %s", (unsigned)event->actual,
                 event->actual == 1 ? "y" : "ies", text_file_of(node));
    else if (step == BOOT_CONFIGURE)
        text_add(text, "configures it: %u entr%s of %s", (unsigned)event->actual,
                 event->actual == 1 ? "y" : "ies", text_file_of(node));
    else if (step == BOOT_ERROR_CONTROL)
        text_add(text, "waits for its heartbeat, at most %u ms", node->consumer_heartbeat_time);
    else if (step < sizeof step_texts / sizeof step_texts[0] && step_texts[step])
        text_add(text, "%s", step_texts[step]);
    else
        return false;
    return true;
}

static void add_emergency(struct text *text, const struct co_event *event)
{
    text_add(text, "emergency %04Xh, %s, error register %02Xh, field", (unsigned)event->code,
             emcy_text((uint16_t)event->code), event->detail);
    for (unsigned i = 3; i < 8; i++)
        text_add(text, " %02X", event->data[i]);
}

/* News whose text needs no more than the event's type. */
static const char *fixed_text(const struct co_event *event)
{
    switch (event->type) {
    case MANAGER_NODE_UP_TO_DATE: return "is configured already (1020h)";
    case MANAGER_NODE_BOOTED:
        return event->detail == 'L' ? "is running already: kept alive (L)" : "booted";
    case MANAGER_NODE_STARTED: return "start command sent";
    default: return NULL;
    }
}

static void add_compared(struct text *text, const struct co_event *event)
{
    if (event->actual == 0)
        text_add(text, "is configured already (entries compared: %u)", (unsigned)event->expected);
    else
        text_add(text, "entries written: %u of %u, the others were there", (unsigned)event->actual,
                 (unsigned)event->expected);
}

/* How a boot goes on. */
static bool add_progress(struct text *text, const struct node_config *node,
                         const struct co_event *event)
{
    switch (event->type) {
    case MANAGER_NODE_STEP: return node && add_step(text, node, event);
    case MANAGER_NODE_COMPARED: add_compared(text, event); return true;
    case MANAGER_NODE_CONFIGURED:
        text_add(text, "configured, entries written: %u", (unsigned)event->actual);
        return true;
    case MANAGER_NODE_SOFTWARE: add_software(text, node, event); return true;
    case MANAGER_NODE_READ:
        text_add_object(text, event->index, event->sub);
        text_add(text, " is %08Xh", (unsigned)event->actual);
        return true;
    default: return false;
    }
}

static bool add_good_news(struct text *text, const struct node_config *node,
                          const struct co_event *event)
{
    if (fixed_text(event)) {
        text_add(text, "%s", fixed_text(event));
        return true;
    }
    switch (event->type) {
    case MANAGER_STATE:
    case MANAGER_NODE_STATE: text_add(text, "is %s", nmt_state_text(event->detail)); return true;
    case MANAGER_NODE_BACK:
        text_add(text, "%s, %s", event->actual ? "answers guarding again" : "heartbeat is back",
                 nmt_state_text(event->detail));
        return true;
    case MANAGER_WRITTEN:
        text_add(text, "a tool has written %04Xh:%02X", event->index, event->sub);
        return true;
    case MANAGER_NODE_BOOT_UP:
        text_add(text, "boot-up message%s",
                 event->actual ? "" : " of a node that is not configured");
        return true;
    default: return add_progress(text, node, event);
    }
}

static void add_node_id_taken(struct text *text, uint8_t state)
{
    text_add(text, "another device has this node-ID: it ");
    if (state == NMT_INITIALISING)
        text_add(text, "sends a boot-up message");
    else
        text_add(text, "says that it is %s", nmt_state_text(state));
    text_add(text, "; is a second manager running? else change Manager_Node_Id");
}

static bool add_bad_news(struct text *text, const struct node_config *node,
                         const struct co_event *event)
{
    struct boot_failure failure;

    switch (event->type) {
    case MANAGER_NODE_FAILED:
        failure = boot_failure_of(event);
        text_add_failure(text, node, &failure);
        return true;
    case MANAGER_NODE_LOST:
        text_add(text, "%s %u ms, was %s",
                 event->actual ? "no answer to guarding for" : "heartbeat lost: silent for",
                 (unsigned)event->expected, nmt_state_text(event->detail));
        return true;
    case MANAGER_NODE_TOGGLE:
        text_add(text, "guarding toggle error no %u", (unsigned)event->actual);
        return true;
    case MANAGER_NODE_UNFOLLOWED:
        text_add(
            text,
            "has been started %u times and is %s still: it leaves by itself (emergencies, 1029h), "
            "or somebody else commands it",
            (unsigned)event->actual, nmt_state_text(event->detail));
        return true;
    case MANAGER_EMCY: add_emergency(text, event); return true;
    case MANAGER_NODE_ID_TAKEN: add_node_id_taken(text, event->detail); return true;
    default: return false;
    }
}

static enum co_severity severity_of(const struct co_event *event)
{
    switch (event->type) {
    case MANAGER_CONFIG_REFUSED:
    case MANAGER_EMCY:
    case MANAGER_NODE_ID_TAKEN:
    case MANAGER_NODE_TOGGLE: return CO_WARNING;
    default: return CO_ERROR;
    }
}

static void add_command(struct text *text, const struct co_event *event)
{
    static const struct {
        uint8_t command;
        const char *name;
    } names[] = { { NMT_START, "start" },
                  { NMT_STOP, "stop" },
                  { NMT_ENTER_PREOPERATIONAL, "enter pre-operational" },
                  { NMT_RESET_NODE, "reset node" },
                  { NMT_RESET_COMMUNICATION, "reset communication" } };

    if (event->type == MANAGER_NMT_REQUEST)
        text_add(text, "a tool commands by 1F82h: \"");
    else
        text_add(text, "another NMT master is on the bus: it commands \"");
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (names[i].command == event->detail)
            text_add(text, "%s", names[i].name);
    if (event->node == NMT_ALL_NODES)
        text_add(text, "\" to all nodes");
    else
        text_add(text, "\" to node %u", event->node);
}

static void add_refused(struct text *text, const struct network_config *config,
                        const struct co_event *event)
{
    const uint32_t number = (uint32_t)event->actual;

    text_add(text, "what a tool has written to %04Xh:%02X is refused", event->index, event->sub);
    if (config->refused - number < NETWORK_REFUSALS)
        text_add(text, ": %s", config->refusals[number % NETWORK_REFUSALS]);
    else
        text_add(text, "; why is no longer known: others were refused since");
}

static void add_missing(struct text *text, const struct network_config *config,
                        const struct co_event *event)
{
    const struct node_config *node = network_config_node(config, event->node);
    const char *name = node && node->name ? node->name : "";

    if (event->actual > 1)
        text_add(text, "%u mandatory nodes are missing, among them ", (unsigned)event->actual);
    else
        text_add(text, "mandatory ");
    text_add(text, "node %u%s%s%s", event->node, name[0] ? " \"" : "", name, name[0] ? "\"" : "");
    if (event->actual == 1)
        text_add(text, " is missing");
}

static bool add_network_news(struct text *text, const struct network_config *config,
                             const struct co_event *event, enum co_severity *ret_severity)
{
    switch (event->type) {
    case MANAGER_NETWORK_UP:
        *ret_severity = CO_INFO;
        text_add(text, "network is up: %u of %u nodes booted", (unsigned)event->actual,
                 (unsigned)event->expected);
        return true;
    case MANAGER_WAITING:
        *ret_severity = CO_WARNING;
        text_add(text, "network waits: ");
        add_missing(text, config, event);
        return true;
    case MANAGER_HALTED:
        *ret_severity = CO_ERROR;
        text_add(text, "network not started: ");
        add_missing(text, config, event);
        if (event->expected)
            text_add(text, " after %u ms (Boot_Time)", (unsigned)event->expected);
        return true;
    case MANAGER_DROPPED:
        *ret_severity = CO_WARNING;
        text_add(text, "%u frames not looked at: this computer is too slow for the bus",
                 (unsigned)event->actual);
        return true;
    case MANAGER_NMT_REQUEST:
    case MANAGER_SECOND_MASTER:
        *ret_severity = event->type == MANAGER_NMT_REQUEST ? CO_INFO : CO_WARNING;
        add_command(text, event);
        return true;
    case MANAGER_SYNC_MISSING:
        *ret_severity = CO_WARNING;
        text_add(text, "SYNC is not on the bus: the interface does not send it");
        return true;
    default: return false;
    }
}

bool boot_text_event(const struct network_config *config, const struct co_event *event,
                     enum co_severity *ret_severity, char *text, size_t size)
{
    struct text line = { text, size };
    const struct node_config *node = network_config_node(config, event->node);

    if (add_network_news(&line, config, event, ret_severity))
        return true;
    add_node(&line, config, event->node);
    if (add_good_news(&line, node, event)) {
        *ret_severity = CO_INFO;
        return true;
    }
    *ret_severity = severity_of(event);
    if (event->type == MANAGER_CONFIG_REFUSED)
        add_refused(&line, config, event);
    return event->type == MANAGER_CONFIG_REFUSED || add_bad_news(&line, node, event);
}

/* --- state of a node --- */

static const char *const wait_texts[] = {
    [BOOT_IDLE] = "not booted yet",
    [BOOT_RESET] = "in its boot delay after a reset",
    [BOOT_DEVICE_TYPE] = "waits for the answer to 1000h",
    [BOOT_IDENTITY] = "waits for the answer to 1018h",
    [BOOT_CHECK_CONFIGURATION] = "waits for the answer to 1020h",
    [BOOT_CONFIGURE] = "is being configured",
    [BOOT_SAVE] = "saves its configuration",
    [BOOT_ERROR_CONTROL] = "waits for its heartbeat",
    [BOOT_READY] = "booted, not started",
    [BOOT_STARTED] = "started",
    [BOOT_RETRY] = "failed",
    [BOOT_FAILED] = "failed",
    [BOOT_CHECK_STATE] = "waits for it to tell its state",
    [BOOT_CHECK_SOFTWARE] = "waits for the answer to 1F56h",
    [BOOT_UPDATE_SOFTWARE] = "gets its program",
    [BOOT_RESTORE] = "restores its default values",
};

static const char *waits_for(const struct boot_node *node)
{
    if (node->step == BOOT_IDLE && !node->config->nmt_slave)
        return "not booted by this master";
    return node->step < sizeof wait_texts / sizeof wait_texts[0] ? wait_texts[node->step] : "";
}

void boot_text_node(const struct boot_node *node, char *text, size_t size)
{
    struct text line = { text, size };

    if (node->failure.letter && !node->booted) {
        text_add_failure(&line, node->config, &node->failure);
        if (node->step != BOOT_FAILED && node->attempts > 0) /* it is tried again, now or soon */
            text_add(&line, "; tried %u time%s", node->attempts, node->attempts == 1 ? "" : "s");
        return;
    }
    text_add(&line, "%s", waits_for(node));
    if (node->step == BOOT_CONFIGURE)
        text_add(&line, ", entry %u of %u", node->entry_number, ccf_count(&node->config->ccf));
}
