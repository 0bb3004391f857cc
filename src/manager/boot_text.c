#include "manager/boot_text.h"

#include "base/bytes.h"
#include "proto/emcy.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

struct text { /* appends, never beyond the end */
    char *at;
    size_t room;
};

__attribute__((format(printf, 2, 3))) static void add(struct text *self, const char *format, ...)
{
    va_list args;
    int length;

    va_start(args, format);
    length = vsnprintf(self->at, self->room, format, args);
    va_end(args);
    if (length < 0)
        return;
    if ((size_t)length >= self->room)
        length = self->room ? (int)self->room - 1 : 0;
    self->at += length;
    self->room -= (size_t)length;
}

/* --- failures --- */

static const struct compared {
    char letter;
    uint16_t index;
    uint8_t sub;
    const char *name;    /* of the object */
    const char *element; /* that says what to expect */
} compared[] = {
    { 'C', 0x1000, 0, "device type", "Device_Type_Identification" },
    { 'D', 0x1018, 1, "vendor-ID", "Vendor_Identification" },
    { 'M', 0x1018, 2, "product code", "Product_Code" },
    { 'N', 0x1018, 3, "revision number", "Revision_Number" },
    { 'O', 0x1018, 4, "serial number", "Serial_Number" },
    { 'H', 0x1F56, 1, "software identification", "NMT_Verify_Software" },
};

static const struct compared *find_compared(uint16_t index, uint8_t sub)
{
    for (size_t i = 0; i < sizeof compared / sizeof compared[0]; i++)
        if (compared[i].index == index && compared[i].sub == sub)
            return &compared[i];
    return NULL;
}

static void add_object(struct text *text, uint16_t index, uint8_t sub)
{
    const struct compared *known = find_compared(index, sub);

    add(text, "%04Xh:%02X", index, sub);
    if (known)
        add(text, " %s", known->name);
}

static void add_silence_of_server(struct text *text, const struct node_config *config,
                                  const struct boot_failure *failure)
{
    co_us_t timeout = failure->letter == 'J' ? configure_node_timeout(config, failure->index)
                                             : CO_MS(config->sdo_timeout);

    if (failure->step == BOOT_UPDATE_SOFTWARE)
        timeout = CO_MS(failure->expected);
    add(text, "no answer within %u ms", (unsigned)(timeout / 1000u));
}

static void add_outcome(struct text *text, const struct node_config *config,
                        const struct boot_failure *failure)
{
    switch ((enum sdo_outcome)failure->outcome) {
    case SDO_OUTCOME_NO_ANSWER: add_silence_of_server(text, config, failure); break;
    case SDO_OUTCOME_NOT_SENT: add(text, "the request could not be sent: check the bus"); break;
    case SDO_OUTCOME_ABORTED:
        add(text, "the node answers abort %08Xh, %s", failure->abort_code,
            sdo_abort_text(failure->abort_code));
        break;
    case SDO_OUTCOME_TOGGLE:
    case SDO_OUTCOME_PROTOCOL:
        add(text, "wrong answer, aborted with %08Xh, %s", failure->abort_code,
            sdo_abort_text(failure->abort_code));
        break;
    case SDO_OUTCOME_OVERFLOW: add(text, "the answer is longer than 8 bytes"); break;
    case SDO_OUTCOME_CANCELLED: add(text, "the node has started anew meanwhile"); break;
    case SDO_OUTCOME_OK: break;
    }
}

static void add_read_failure(struct text *text, const struct node_config *config,
                             const struct boot_failure *failure)
{
    add(text, "read ");
    add_object(text, failure->index, failure->sub);
    add(text, ": ");
    add_outcome(text, config, failure);
    if (failure->outcome != SDO_OUTCOME_NO_ANSWER)
        return;
    add(text, " (%u tries): ", BOOT_READ_TRIES);
    if (failure->letter == 'B')
        add(text, "the node is absent or off, or has another node-ID or bit rate");
    else
        add(text, "the node has gone in mid-boot");
}

static const char *file_of(const struct node_config *config)
{
    if (config->dcf_file)
        return config->dcf_file;
    return config->ccf_file ? config->ccf_file : "the configuration";
}

static void add_write_failure(struct text *text, const struct node_config *config,
                              const struct boot_failure *failure)
{
    add(text, "write ");
    add_object(text, failure->index, failure->sub);
    if (failure->entry && failure->size >= 1 && failure->size <= 4)
        add(text, " = %0*Xh", 2 * failure->size, failure->expected);
    else if (failure->entry)
        add(text, " (%u%s bytes)", failure->size, failure->size == UINT8_MAX ? " or more" : "");
    if (failure->entry)
        add(text, " (entry %u of %u of %s", failure->entry, ccf_count(&config->ccf),
            file_of(config));
    if (failure->entry && ccf_line(&config->ccf, failure->entry))
        add(text, ", line %u", ccf_line(&config->ccf, failure->entry));
    add(text, failure->entry ? "): " : " \"save\": ");
    add_outcome(text, config, failure);
}

static void add_difference(struct text *text, const struct node_config *config,
                           const struct boot_failure *failure)
{
    const struct compared *known = find_compared(failure->index, failure->sub);

    add_object(text, failure->index, failure->sub);
    add(text, " is %08Xh, configuration expects %08Xh: wrong device at node %u", failure->actual,
        failure->expected, config->node_id);
    if (known)
        add(text, ", or remove %s to skip the check", known->element);
}

/* E and F: asked before it is reset; K: at the end of its boot. */
static void add_silence(struct text *text, const struct boot_failure *failure)
{
    if (failure->letter == 'F')
        add(text,
            "no answer to guarding within %u ms: the state of this node, which is to be kept "
            "alive (NMT_Check_Nodestate), is not known; it is not reset",
            (unsigned)(SUPERVISION_ASK_TIMEOUT / 1000u));
    else if (failure->letter == 'E')
        add(text,
            "no heartbeat within %u ms: the state of this node, which is to be kept alive "
            "(NMT_Check_Nodestate), is not known; it is not reset",
            failure->expected);
    else
        add(text,
            "no heartbeat within %u ms (Consumer_Heartbeat_Time): does the configuration set "
            "1017h to a shorter time?",
            failure->expected);
}

/* --- failures of the software --- */

static const char *const phase_texts[] = {
    [SOFTWARE_ASK] = "ask whether its program runs",
    [SOFTWARE_STOP] = "stop its program",
    [SOFTWARE_STOPPING] = "wait for its program to stop",
    [SOFTWARE_CLEAR] = "clear its program",
    [SOFTWARE_CLEARING] = "wait for its flash to be cleared",
    [SOFTWARE_WRITE] = "write its program",
    [SOFTWARE_WRITING] = "wait for its flash to be written",
    [SOFTWARE_COMPARE] = "compare its new program",
    [SOFTWARE_START] = "start its program",
    [SOFTWARE_STARTING] = "wait for its program to start",
};

/* 1F57h, bits 1 to 7 */
static const char *flash_text(uint32_t status)
{
    static const char *const texts[] = {
        "no error",       "no valid program",  "data format unknown",
        "checksum wrong", "flash not cleared", "flash write error",
        "address error",  "flash secured",     "memory access error"
    };
    uint32_t code = status >> 1 & 0x7Fu;

    return code < sizeof texts / sizeof texts[0] ? texts[code] : "error of the manufacturer";
}

static void add_other_software(struct text *text, const struct boot_failure *failure)
{
    add_object(text, failure->index, failure->sub);
    add(text, " is %08Xh, configuration expects %08Xh", failure->actual, failure->expected);
}

static void add_update_failure(struct text *text, const struct node_config *config,
                               const struct boot_failure *failure)
{
    uint32_t phase = failure->entry;
    bool flash = phase == SOFTWARE_CLEARING || phase == SOFTWARE_WRITING;

    add(text, "%s, %04Xh:%02X: ", phase_texts[phase], failure->index, failure->sub);
    if (failure->outcome != SDO_OUTCOME_OK)
        add_outcome(text, config, failure);
    else if (phase == SOFTWARE_COMPARE)
        add(text,
            "it is %08Xh, configuration expects %08Xh: Software_File is another program than "
            "Software_Identification says",
            failure->actual, failure->expected);
    else if (flash && (failure->actual & 1u) == 0)
        add(text, "flash status %08Xh, %s", failure->actual, flash_text(failure->actual));
    else
        add(text, "still %08Xh after %u ms", failure->actual, failure->expected);
}

static void add_software_failure(struct text *text, const struct node_config *config,
                                 const struct boot_failure *failure)
{
    if (failure->step == BOOT_UPDATE_SOFTWARE) {
        add_update_failure(text, config, failure);
        return;
    }
    if (failure->letter == 'G') {
        add(text, "Software_Identification is missing: NMT_Verify_Software has nothing to compare "
                  "with");
        return;
    }
    if (failure->index == 0x1F51) {
        add(text, "its program, 1F51h:01, does not go on running: started %u times",
            SOFTWARE_TRIES);
        return;
    }
    add_other_software(text, failure);
    if (failure->letter == 'I' && config->software)
        add(text, ", and %u updates have not changed that: see what they failed with",
            SOFTWARE_TRIES);
    else if (failure->letter == 'I')
        add(text, ": there is no Software_File to update it with");
    else if (config->check_node_state)
        add(text, ": a node that is to be kept alive (NMT_Check_Nodestate) is not updated");
    else
        add(text, ": update it, or set NMT_Allow_Software_Update");
}

static bool is_of_software(const struct boot_failure *failure)
{
    return failure->step == BOOT_UPDATE_SOFTWARE ||
           (failure->step == BOOT_CHECK_SOFTWARE && failure->outcome == SDO_OUTCOME_OK);
}

static void add_failure(struct text *text, const struct node_config *config,
                        const struct boot_failure *failure)
{
    add(text, "boot error %c: ", failure->letter);
    if (is_of_software(failure))
        add_software_failure(text, config, failure);
    else if (failure->letter == 'J')
        add_write_failure(text, config, failure);
    else if (failure->letter == 'E' || failure->letter == 'F' || failure->letter == 'K')
        add_silence(text, failure);
    else if (failure->outcome != SDO_OUTCOME_OK)
        add_read_failure(text, config, failure);
    else
        add_difference(text, config, failure);
}

/* --- events --- */

static void add_node(struct text *text, const struct network_config *config, uint8_t node_id)
{
    const struct node_config *node = network_config_node(config, node_id);

    add(text, "node %u", node_id);
    if (node_id == config->manager_node_id)
        add(text, " (manager)");
    else if (node && node->name)
        add(text, " \"%s\"", node->name);
    add(text, ": ");
}

static const char *const step_texts[] = {
    [BOOT_DEVICE_TYPE] = "boot begins, asks for its device type",
    [BOOT_IDENTITY] = "checks its identity",
    [BOOT_CHECK_CONFIGURATION] = "checks its configuration date",
    [BOOT_SAVE] = "saves its configuration",
    [BOOT_CHECK_STATE] = "asks for its state, it is to be kept alive",
    [BOOT_CHECK_SOFTWARE] = "checks its software",
};

static void add_software(struct text *text, const struct node_config *node,
                         const struct co_event *event)
{
    switch (event->detail) {
    case SOFTWARE_STOP: add(text, "stops its program"); break;
    case SOFTWARE_CLEAR: add(text, "clears its program"); break;
    case SOFTWARE_WRITE:
        add(text, "writes its program: %u bytes of %s", (unsigned)event->actual,
            node->software_file);
        break;
    case SOFTWARE_COMPARE: add(text, "its program is written, compares it"); break;
    default: add(text, "starts its program"); break;
    }
}

/* False for steps that other events tell. */
static bool add_step(struct text *text, const struct node_config *node,
                     const struct co_event *event)
{
    uint8_t step = event->detail;

    if (step == BOOT_RESET)
        add(text, "reset, boot delay %u ms", node->boot_delay);
    else if (step == BOOT_CONFIGURE && node->verify_configuration)
        add(text, "compares its configuration: %u entr%s of %s", (unsigned)event->actual,
            event->actual == 1 ? "y" : "ies", file_of(node));
    else if (step == BOOT_CONFIGURE)
        add(text, "configures it: %u entr%s of %s", (unsigned)event->actual,
            event->actual == 1 ? "y" : "ies", file_of(node));
    else if (step == BOOT_ERROR_CONTROL)
        add(text, "waits for its heartbeat, at most %u ms", node->consumer_heartbeat_time);
    else if (step < sizeof step_texts / sizeof step_texts[0] && step_texts[step])
        add(text, "%s", step_texts[step]);
    else
        return false;
    return true;
}

static void add_emergency(struct text *text, const struct co_event *event)
{
    add(text, "emergency %04Xh, %s, error register %02Xh, field", (unsigned)event->code,
        emcy_text((uint16_t)event->code), event->detail);
    for (unsigned i = 3; i < 8; i++)
        add(text, " %02X", event->data[i]);
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
        add(text, "is configured already (entries compared: %u)", (unsigned)event->expected);
    else
        add(text, "entries written: %u of %u, the others were there", (unsigned)event->actual,
            (unsigned)event->expected);
}

/* How a boot goes on. */
static bool add_progress(struct text *text, const struct node_config *node,
                         const struct co_event *event)
{
    switch (event->type) {
    case MANAGER_NODE_STEP: return node && add_step(text, node, event);
    case MANAGER_NODE_COMPARED: add_compared(text, event); return true;
    case MANAGER_NODE_SOFTWARE: add_software(text, node, event); return true;
    case MANAGER_NODE_READ:
        add_object(text, event->index, event->sub);
        add(text, " is %08Xh", (unsigned)event->actual);
        return true;
    default: return false;
    }
}

static bool add_good_news(struct text *text, const struct node_config *node,
                          const struct co_event *event)
{
    if (fixed_text(event)) {
        add(text, "%s", fixed_text(event));
        return true;
    }
    switch (event->type) {
    case MANAGER_STATE:
    case MANAGER_NODE_STATE: add(text, "is %s", nmt_state_text(event->detail)); return true;
    case MANAGER_NODE_BACK:
        add(text, "%s, %s", event->actual ? "answers guarding again" : "heartbeat is back",
            nmt_state_text(event->detail));
        return true;
    case MANAGER_NODE_BOOT_UP:
        add(text, "boot-up message%s", event->actual ? "" : " of a node that is not configured");
        return true;
    default: return add_progress(text, node, event);
    }
}

static void add_node_id_taken(struct text *text, uint8_t state)
{
    add(text, "another device has this node-ID: it ");
    if (state == NMT_INITIALISING)
        add(text, "sends a boot-up message");
    else
        add(text, "says that it is %s", nmt_state_text(state));
    add(text, "; is a second manager running? else change Manager_Node_Id");
}

static bool add_bad_news(struct text *text, const struct node_config *node,
                         const struct co_event *event)
{
    struct boot_failure failure;

    switch (event->type) {
    case MANAGER_NODE_FAILED:
        failure = boot_failure_of(event);
        add_failure(text, node, &failure);
        return true;
    case MANAGER_NODE_LOST:
        add(text, "%s %u ms, was %s",
            event->actual ? "no answer to guarding for" : "heartbeat lost: silent for",
            (unsigned)event->expected, nmt_state_text(event->detail));
        return true;
    case MANAGER_NODE_TOGGLE:
        add(text, "guarding toggle error no %u", (unsigned)event->actual);
        return true;
    case MANAGER_NODE_UNFOLLOWED:
        add(text,
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
        add(text, "a tool commands by 1F82h: \"");
    else
        add(text, "another NMT master is on the bus: it commands \"");
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (names[i].command == event->detail)
            add(text, "%s", names[i].name);
    if (event->node == NMT_ALL_NODES)
        add(text, "\" to all nodes");
    else
        add(text, "\" to node %u", event->node);
}

static void add_missing(struct text *text, const struct network_config *config,
                        const struct co_event *event)
{
    const struct node_config *node = network_config_node(config, event->node);
    const char *name = node && node->name ? node->name : "";

    if (event->actual > 1)
        add(text, "%u mandatory nodes are missing, among them ", (unsigned)event->actual);
    else
        add(text, "mandatory ");
    add(text, "node %u%s%s%s", event->node, name[0] ? " \"" : "", name, name[0] ? "\"" : "");
    if (event->actual == 1)
        add(text, " is missing");
}

static bool add_network_news(struct text *text, const struct network_config *config,
                             const struct co_event *event, enum co_severity *ret_severity)
{
    switch (event->type) {
    case MANAGER_NETWORK_UP:
        *ret_severity = CO_INFO;
        add(text, "network is up: %u of %u nodes booted", (unsigned)event->actual,
            (unsigned)event->expected);
        return true;
    case MANAGER_WAITING:
        *ret_severity = CO_WARNING;
        add(text, "network waits: ");
        add_missing(text, config, event);
        return true;
    case MANAGER_HALTED:
        *ret_severity = CO_ERROR;
        add(text, "network not started: ");
        add_missing(text, config, event);
        if (event->expected)
            add(text, " after %u ms (Boot_Time)", (unsigned)event->expected);
        return true;
    case MANAGER_DROPPED:
        *ret_severity = CO_WARNING;
        add(text, "%u frames not looked at: this computer is too slow for the bus",
            (unsigned)event->actual);
        return true;
    case MANAGER_NMT_REQUEST:
    case MANAGER_SECOND_MASTER:
        *ret_severity = event->type == MANAGER_NMT_REQUEST ? CO_INFO : CO_WARNING;
        add_command(text, event);
        return true;
    case MANAGER_SYNC_MISSING:
        *ret_severity = CO_WARNING;
        add(text, "SYNC is not on the bus: the interface does not send it");
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
    return add_bad_news(&line, node, event);
}

void boot_text_failure(const struct node_config *config, const struct boot_failure *failure,
                       char *text, size_t size)
{
    struct text line = { text, size };

    text[0] = '\0';
    if (failure->letter)
        add_failure(&line, config, failure);
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
        add_failure(&line, node->config, &node->failure);
        if (node->step == BOOT_RETRY)
            add(&line, "; tried %u time%s", node->attempts, node->attempts == 1 ? "" : "s");
        return;
    }
    add(&line, "%s", waits_for(node));
    if (node->step == BOOT_CONFIGURE)
        add(&line, ", entry %u of %u", node->entry_number, ccf_count(&node->config->ccf));
}
