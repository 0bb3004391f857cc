/* Why a boot has failed, in words. */
#include "manager/boot_text_parts.h"

#include <stdarg.h>
#include <stdio.h>

void text_add(struct text *self, const char *format, ...)
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

const char *text_element_of(uint16_t index, uint8_t sub)
{
    const struct compared *known = find_compared(index, sub);

    return known ? known->element : NULL;
}

void text_add_object(struct text *text, uint16_t index, uint8_t sub)
{
    const struct compared *known = find_compared(index, sub);

    text_add(text, "%04Xh:%02X", index, sub);
    if (known)
        text_add(text, " %s", known->name);
}

static void add_silence_of_server(struct text *text, const struct node_config *config,
                                  const struct boot_failure *failure)
{
    co_us_t timeout = failure->letter == 'J' ? configure_node_timeout(config, failure->index)
                                             : CO_MS(config->sdo_timeout);

    if (failure->step == BOOT_UPDATE_SOFTWARE)
        timeout = CO_MS(failure->expected);
    text_add(text, "no answer within %u ms", (unsigned)(timeout / 1000u));
}

static void add_outcome(struct text *text, const struct node_config *config,
                        const struct boot_failure *failure)
{
    switch ((enum sdo_outcome)failure->outcome) {
    case SDO_OUTCOME_NO_ANSWER: add_silence_of_server(text, config, failure); break;
    case SDO_OUTCOME_NOT_SENT:
        text_add(text, "the request could not be sent: check the bus");
        break;
    case SDO_OUTCOME_ABORTED:
        text_add(text, "the node answers abort %08Xh, %s", failure->abort_code,
                 sdo_abort_text(failure->abort_code));
        break;
    case SDO_OUTCOME_TOGGLE:
    case SDO_OUTCOME_PROTOCOL:
        text_add(text, "wrong answer, aborted with %08Xh, %s", failure->abort_code,
                 sdo_abort_text(failure->abort_code));
        break;
    case SDO_OUTCOME_OVERFLOW: text_add(text, "the answer is longer than 8 bytes"); break;
    case SDO_OUTCOME_CANCELLED: text_add(text, "the node has started anew meanwhile"); break;
    case SDO_OUTCOME_OK: break;
    }
}

static void add_read_failure(struct text *text, const struct node_config *config,
                             const struct boot_failure *failure)
{
    text_add(text, "read ");
    text_add_object(text, failure->index, failure->sub);
    text_add(text, ": ");
    add_outcome(text, config, failure);
    if (failure->outcome != SDO_OUTCOME_NO_ANSWER) {
        text_add_advice(text, failure);
        return;
    }
    text_add(text, " (%u tries): ", BOOT_READ_TRIES);
    if (failure->letter == 'B')
        text_add(text, "the node is absent or off, or has another node-ID or bit rate");
    else
        text_add(text, "the node has gone in mid-boot: power, cable, its watchdog?");
}

const char *text_file_of(const struct node_config *config)
{
    if (config->dcf_file)
        return config->dcf_file;
    return config->ccf_file ? config->ccf_file : "the configuration";
}

static void add_command_failure(struct text *text, const struct node_config *config,
                                const struct boot_failure *failure)
{
    const char *signature = failure->step == BOOT_RESTORE ? "load" : "save";

    if (failure->step == BOOT_RESTORE && failure->expected != 0) {
        text_add(text, "no boot-up message within %u ms after %04Xh:%02X \"load\" and its reset",
                 failure->expected, failure->index, failure->sub);
        return;
    }
    if (failure->step == BOOT_CHECK_CONFIGURATION)
        text_add(text, "read %04Xh:%02X: ", failure->index, failure->sub);
    else
        text_add(text, "write %04Xh:%02X \"%s\": ", failure->index, failure->sub, signature);
    add_outcome(text, config, failure);
    text_add_advice(text, failure);
}

static void add_write_failure(struct text *text, const struct node_config *config,
                              const struct boot_failure *failure)
{
    if (!failure->entry) {
        add_command_failure(text, config, failure);
        return;
    }
    text_add(text, "write ");
    text_add_object(text, failure->index, failure->sub);
    if (failure->size >= 1 && failure->size <= 4)
        text_add(text, " = %0*Xh", 2 * failure->size, failure->expected);
    else
        text_add(text, " (%u%s bytes)", failure->size,
                 failure->size == UINT8_MAX ? " or more" : "");
    text_add(text, " (entry %u of %u of %s", failure->entry, ccf_count(&config->ccf),
             text_file_of(config));
    if (ccf_line(&config->ccf, failure->entry))
        text_add(text, ", line %u", ccf_line(&config->ccf, failure->entry));
    text_add(text, "): ");
    add_outcome(text, config, failure);
    text_add_advice(text, failure);
}

static void add_difference(struct text *text, const struct node_config *config,
                           const struct boot_failure *failure)
{
    const char *element = text_element_of(failure->index, failure->sub);

    text_add_object(text, failure->index, failure->sub);
    text_add(text, " is %08Xh, configuration expects %08Xh: wrong device at node %u",
             failure->actual, failure->expected, config->node_id);
    if (element)
        text_add(text, ", or remove %s to skip the check", element);
}

/* E and F: asked before it is reset; K: at the end of its boot. */
static void add_silence(struct text *text, const struct node_config *config,
                        const struct boot_failure *failure)
{
    if (failure->letter == 'F')
        text_add(text,
                 "no answer to guarding within %u ms: the state of this node, which is to be kept "
                 "alive (NMT_Check_Nodestate), is not known; it is not reset: reset it by hand",
                 (unsigned)(SUPERVISION_ASK_TIMEOUT / 1000u));
    else if (failure->letter == 'E')
        text_add(text,
                 "no heartbeat within %u ms: the state of this node, which is to be kept alive "
                 "(NMT_Check_Nodestate), is not known; it is not reset: reset it by hand",
                 failure->expected);
    else if (failure->outcome == SDO_OUTCOME_CANCELLED)
        text_add(text, "the node has started anew while its heartbeat was waited for");
    else
        text_add_heartbeat_advice(text, config, failure);
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
    text_add_object(text, failure->index, failure->sub);
    text_add(text, " is %08Xh, configuration expects %08Xh", failure->actual, failure->expected);
}

static void add_update_failure(struct text *text, const struct node_config *config,
                               const struct boot_failure *failure)
{
    uint32_t phase = failure->entry;
    bool flash = phase == SOFTWARE_CLEARING || phase == SOFTWARE_WRITING;

    text_add(text, "%s, %04Xh:%02X: ", phase_texts[phase], failure->index, failure->sub);
    if (failure->outcome != SDO_OUTCOME_OK)
        add_outcome(text, config, failure);
    else if (phase == SOFTWARE_COMPARE)
        text_add(text,
                 "it is %08Xh, configuration expects %08Xh: Software_File is another program than "
                 "Software_Identification says",
                 failure->actual, failure->expected);
    else if (flash && (failure->actual & 1u) == 0)
        text_add(text, "flash status %08Xh, %s", failure->actual, flash_text(failure->actual));
    else
        text_add(text, "still %08Xh after %u ms", failure->actual, failure->expected);
    if (failure->outcome == SDO_OUTCOME_ABORTED)
        text_add_advice(text, failure);
}

static void add_software_failure(struct text *text, const struct node_config *config,
                                 const struct boot_failure *failure)
{
    if (failure->step == BOOT_UPDATE_SOFTWARE) {
        add_update_failure(text, config, failure);
        return;
    }
    if (failure->letter == 'G') {
        text_add(text,
                 "Software_Identification is missing: NMT_Verify_Software has nothing to compare "
                 "with");
        return;
    }
    if (failure->index == 0x1F51) {
        text_add(text, "its program, 1F51h:01, does not go on running: started %u times",
                 SOFTWARE_TRIES);
        return;
    }
    add_other_software(text, failure);
    if (failure->letter == 'I' && config->software)
        text_add(text, ", and %u updates have not changed that: see what they failed with",
                 SOFTWARE_TRIES);
    else if (failure->letter == 'I')
        text_add(text, ": there is no Software_File to update it with");
    else if (config->check_node_state)
        text_add(text, ": a node that is to be kept alive (NMT_Check_Nodestate) is not updated");
    else
        text_add(text, ": update it, or set NMT_Allow_Software_Update");
}

static bool is_of_software(const struct boot_failure *failure)
{
    return failure->step == BOOT_UPDATE_SOFTWARE ||
           (failure->step == BOOT_CHECK_SOFTWARE && failure->outcome == SDO_OUTCOME_OK);
}

void text_add_failure(struct text *text, const struct node_config *config,
                      const struct boot_failure *failure)
{
    text_add(text, "boot error %c: ", failure->letter);
    if (is_of_software(failure))
        add_software_failure(text, config, failure);
    else if (failure->letter == 'J')
        add_write_failure(text, config, failure);
    else if (failure->letter == 'E' || failure->letter == 'F' || failure->letter == 'K')
        add_silence(text, config, failure);
    else if (failure->outcome != SDO_OUTCOME_OK)
        add_read_failure(text, config, failure);
    else
        add_difference(text, config, failure);
}

void boot_text_failure(const struct node_config *config, const struct boot_failure *failure,
                       char *text, size_t size)
{
    struct text line = { text, size };

    text[0] = '\0';
    if (failure->letter)
        text_add_failure(&line, config, failure);
}
