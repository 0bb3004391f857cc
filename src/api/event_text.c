#include "mcanopen.h"

#include "od/abort.h"
#include "paraInfo.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>

#define PARA_SHIFT 8u

struct line {
    char *text;
    size_t size;
    size_t length; /* what there would be with room enough */
};

__attribute__((format(printf, 2, 3))) static void add(struct line *self, const char *format, ...)
{
    size_t used = self->length < self->size ? self->length : self->size - 1;
    va_list args;
    int length;

    va_start(args, format);
    length = vsnprintf(self->text + used, self->size - used, format, args);
    va_end(args);
    if (length > 0)
        self->length += (size_t)length;
}

static const char *state_text(unsigned state)
{
    switch (state) {
    case MCANOPEN_STATE_OFFLINE: return "offline";
    case MCANOPEN_STATE_STOPPED: return "stopped";
    case MCANOPEN_STATE_OPERATIONAL: return "operational";
    case MCANOPEN_STATE_PREOPERATIONAL: return "pre-operational";
    default: return "not of CiA 301";
    }
}

static const char *bus_text(int state)
{
    static const char *const texts[] = { "error active", "error warning", "error passive",
                                         "bus-off", "interface down" };

    return state >= 0 && (size_t)state < sizeof texts / sizeof texts[0] ? texts[state] : "unknown";
}

/* Meaning of the status letters of CiA 302-2. */
static const char *letter_text(char letter)
{
    static const char *const texts['O' - 'A' + 1] = {
        "not in the network list",
        "no answer to the read of 1000h",
        "device type differs",
        "vendor-ID differs",
        "no heartbeat",
        "no guarding answer",
        "program version not configured",
        "software update not allowed",
        "software download failed",
        "configuration download failed",
        "no heartbeat after the boot",
        "was operational already",
        "product code differs",
        "revision number differs",
        "serial number differs",
    };

    return letter >= 'A' && letter <= 'O' ? texts[letter - 'A'] : "unknown letter";
}

static const char *step_text(unsigned step)
{
    static const char *const texts[] = {
        [MCANOPEN_STEP_IDLE] = "not begun",
        [MCANOPEN_STEP_RESET] = "reset",
        [MCANOPEN_STEP_DEVICE_TYPE] = "device type",
        [MCANOPEN_STEP_IDENTITY] = "identity",
        [MCANOPEN_STEP_CHECK_CONFIGURATION] = "check of the configuration",
        [MCANOPEN_STEP_CONFIGURE] = "configuration",
        [MCANOPEN_STEP_SAVE] = "save",
        [MCANOPEN_STEP_ERROR_CONTROL] = "error control",
        [MCANOPEN_STEP_READY] = "ready",
        [MCANOPEN_STEP_STARTED] = "started",
        [MCANOPEN_STEP_RETRY] = "retry",
        [MCANOPEN_STEP_FAILED] = "failed",
        [MCANOPEN_STEP_CHECK_STATE] = "check of the state",
        [MCANOPEN_STEP_CHECK_SOFTWARE] = "check of the software",
        [MCANOPEN_STEP_UPDATE_SOFTWARE] = "software update",
        [MCANOPEN_STEP_RESTORE] = "restore",
    };

    return step < sizeof texts / sizeof texts[0] ? texts[step] : "unknown";
}

static const char *update_text(unsigned step)
{
    switch (step) {
    case MCANOPEN_UPDATE_STOP: return "stop the program";
    case MCANOPEN_UPDATE_CLEAR: return "clear the program";
    case MCANOPEN_UPDATE_WRITE: return "write the program";
    case MCANOPEN_UPDATE_COMPARE: return "compare the program";
    case MCANOPEN_UPDATE_START: return "start the program";
    default: return "unknown";
    }
}

static const char *command_text(unsigned command)
{
    switch (command) {
    case MCANOPEN_NMT_START: return "start";
    case MCANOPEN_NMT_STOP: return "stop";
    case MCANOPEN_NMT_ENTER_PREOPERATIONAL: return "enter pre-operational";
    case MCANOPEN_NMT_RESET_NODE: return "reset node";
    case MCANOPEN_NMT_RESET_COMMUNICATION: return "reset communication";
    default: return "unknown";
    }
}

/* A char of an event; it may be anything where the message is not known. */
static void add_char(struct line *line, char c)
{
    if (c >= ' ' && c <= '~')
        add(line, " %c", c);
    else
        add(line, " %d", c);
}

static void add_c(struct line *line, const EVENT_T *event, unsigned message)
{
    add(line, "%s", cParaInfo[message]);
    add_char(line, event->para.c);
    if (message == MCANOPEN_MSG_BOOT_ERROR)
        add(line, ": %s", letter_text(event->para.c));
}

/* What a number means, for messages whose number is one of a list; else NULL. */
static const char *meaning_text(unsigned message, unsigned value)
{
    switch (message) {
    case MCANOPEN_MSG_NODE_STATE:
    case MCANOPEN_MSG_NODE_STARTED:
    case MCANOPEN_MSG_MANAGER_STATE:
    case MCANOPEN_MSG_NOT_STARTED:
    case MCANOPEN_MSG_NODE_ID_TAKEN: return state_text(value);
    case MCANOPEN_MSG_BOOT_STEP: return step_text(value);
    case MCANOPEN_MSG_SOFTWARE_UPDATE: return update_text(value);
    case MCANOPEN_MSG_FOREIGN_COMMAND:
    case MCANOPEN_MSG_REQUESTED_COMMAND: return command_text(value);
    default: return NULL;
    }
}

static void add_uc(struct line *line, const EVENT_T *event, unsigned message)
{
    const unsigned value = event->para.uc;
    const char *meaning = meaning_text(message, value);

    add(line, "%s", ucParaInfo[message]);
    switch (message) {
    case MCANOPEN_MSG_BOOT_UP:
    case MCANOPEN_MSG_SYNC_MISSING:
    case MCANOPEN_MSG_BUS_BUSY: break;
    case MCANOPEN_MSG_NODE_BOOTED:
        add(line, "%s", value == 'L' ? ", was operational already" : "");
        break;
    default: add(line, " %u", value); break;
    }
    if (meaning)
        add(line, " (%s)", meaning);
}

static void add_s(struct line *line, const EVENT_T *event, unsigned message)
{
    add(line, "%s %d", sParaInfo[message], event->para.s);
}

static void add_us(struct line *line, const EVENT_T *event, unsigned message)
{
    add(line, "%s %u", usParaInfo[message], event->para.us);
}

static void add_i(struct line *line, const EVENT_T *event, unsigned message)
{
    add(line, "%s %d", iParaInfo[message], event->para.i);
    if (message == MCANOPEN_MSG_BUS_STATE)
        add(line, " (%s)", bus_text(event->para.i));
}

static void add_ui(struct line *line, const EVENT_T *event, unsigned message)
{
    add(line, "%s %u", uiParaInfo[message], event->para.ui);
}

static void add_l(struct line *line, const EVENT_T *event, unsigned message)
{
    add(line, "%s %ld", lParaInfo[message], event->para.l);
}

static void add_ul(struct line *line, const EVENT_T *event, unsigned message)
{
    unsigned long value = event->para.ul;

    add(line, "%s", ulParaInfo[message]);
    if (message == MCANOPEN_MSG_EMERGENCY)
        add(line, ": error code %04lXh, error register %02lXh", value & 0xFFFF, value >> 16 & 0xFF);
    else
        add(line, " %lu", value);
}

static void add_write(struct line *line, const EVENT_T *event, unsigned message)
{
    const ERROR_T *err = &event->para.write.err;
    sdo_abort_t code = (sdo_abort_t)err->eclass << 24 | (sdo_abort_t)err->code << 16 |
                       (sdo_abort_t)err->spec << 8 | err->global;

    add(line, "%s %04Xh:%02X", writeParaInfo[message], event->para.write.index,
        event->para.write.subindex);
    if (message != MCANOPEN_MSG_OBJECT_WRITTEN)
        add(line, ", abort code %08Xh (%s)", (unsigned)code, sdo_abort_text(code));
}

static void add_str(struct line *line, const EVENT_T *event, unsigned message)
{
    const char *str = event->para.str;

    add(line, "%s ", strParaInfo[message]);
    for (size_t i = 0; i < sizeof event->para.str && str[i]; i++)
        add(line, "%c", (unsigned char)str[i] < ' ' ? ' ' : str[i]);
}

/* In the order of the bits of PARA. */
static void (*const add_value[])(struct line *line, const EVENT_T *event, unsigned message) = {
    add_c, add_uc, add_s, add_us, add_i, add_ui, add_l, add_ul, add_write, add_str,
};

/* True when exactly one bit is set, and it is one that has a member in para. */
static bool find_kind(unsigned long flags, size_t *ret_kind)
{
    for (size_t kind = 0; kind < sizeof add_value / sizeof add_value[0]; kind++) {
        if ((flags & PARA) == 1UL << (kind + PARA_SHIFT)) {
            *ret_kind = kind;
            return true;
        }
    }
    return false;
}

int mcanOpenEventText(const EVENT_T *event, char *text, int size)
{
    struct line line = { .text = text, .size = size > 0 ? (size_t)size : 0 };
    unsigned long flags = event ? (unsigned long)event->event : 0;
    size_t kind;

    if (!text || size < 1)
        return MCAL_PARA_ERROR;
    text[0] = '\0';
    if (!event || !find_kind(flags, &kind))
        return MCAL_PARA_ERROR;
    if (!(flags & NET_NOT_VAL))
        add(&line, "Net: %d ", event->net);
    if (!(flags & NOD_NOT_VAL))
        add(&line, "Node: %d ", event->node);
    add_value[kind](&line, event, (unsigned)(flags & 0xFF));
    return line.length < line.size ? MCANOPEN_OK : MCAL_BUFFER_OVERFLOW;
}
