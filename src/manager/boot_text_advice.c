/* What to do about a boot that has failed. */
#include "manager/boot_text_parts.h"

#include "base/bytes.h"

static bool is_in(uint16_t index, uint16_t first, uint16_t last)
{
    return index >= first && index <= last;
}

/* --- a write that was refused --- */

/* Codes that say no more than "not so" or "not now". */
static bool is_vague(sdo_abort_t code)
{
    return code == SDO_ACCESS || code == SDO_GENERAL || code == SDO_NOT_STORED ||
           code == SDO_LOCAL_CONTROL || code == SDO_DEVICE_STATE || code == SDO_INVALID_VALUE;
}

static const char *pdo_advice(uint16_t index)
{
    if (is_in(index, 0x1400, 0x15FF) || is_in(index, 0x1800, 0x19FF))
        return "a PDO is changed while it is switched off (bit 31 of its COB-ID)";
    if (is_in(index, 0x1600, 0x17FF) || is_in(index, 0x1A00, 0x1BFF))
        return "a mapping is changed while its sub-index 0 is 0 and the PDO is switched off";
    return NULL;
}

static const struct {
    sdo_abort_t code;
    const char *advice;
} code_advices[] = {
    { SDO_NO_OBJECT, "is the file of another device, or of another version of it?" },
    { SDO_NO_SUB, "is the file of another device, or of another version of it?" },
    { SDO_READ_ONLY, "take its ParameterValue out of the file" },
    { SDO_INVALID_VALUE, "the device's manual has its limits; correct the file" },
    { SDO_VALUE_HIGH, "the device's manual has its limits; correct the file" },
    { SDO_VALUE_LOW, "the device's manual has its limits; correct the file" },
    { SDO_TYPE_LENGTH, "the file has another data type than the device" },
    { SDO_TOO_LONG, "the file has another data type than the device" },
    { SDO_TOO_SHORT, "the file has another data type than the device" },
    { SDO_NOT_MAPPABLE, "the device's manual tells what it can map; 8 bytes in all" },
    { SDO_PDO_LENGTH, "the device's manual tells what it can map; 8 bytes in all" },
    { SDO_HARDWARE, "the device's errors (1001h, 1003h) may tell more" },
    { SDO_LOCAL_CONTROL, "the device takes it in another state: its manual, its switches" },
    { SDO_DEVICE_STATE, "the device takes it in another state: its manual, its switches" },
};

static const char *code_advice(sdo_abort_t code)
{
    for (size_t i = 0; i < sizeof code_advices / sizeof code_advices[0]; i++)
        if (code_advices[i].code == code)
            return code_advices[i].advice;
    return NULL;
}

static const char *save_advice(sdo_abort_t code)
{
    switch (code) {
    case SDO_NO_OBJECT:
    case SDO_NO_SUB:
    case SDO_ACCESS:
    case SDO_READ_ONLY: return "the device cannot save: remove Save_Configuration";
    default: return "its manual tells when it can save; or remove Save_Configuration";
    }
}

static bool is_not_there(sdo_abort_t code)
{
    return code == SDO_NO_OBJECT || code == SDO_NO_SUB;
}

static const char *write_advice(const struct boot_failure *failure)
{
    const char *advice = NULL;

    if (failure->step == BOOT_SAVE)
        return save_advice(failure->abort_code);
    if (failure->step != BOOT_CONFIGURE)
        return NULL;
    if (is_vague(failure->abort_code))
        advice = pdo_advice(failure->index);
    return advice ? advice : code_advice(failure->abort_code);
}

/* --- all kinds --- */

/* What is read, or written for an update, is not there. */
static void add_absence_advice(struct text *text, const struct boot_failure *failure)
{
    const char *element = text_element_of(failure->index, failure->sub);

    if (failure->step == BOOT_UPDATE_SOFTWARE)
        text_add(text, ": the device has no program download: update it by its own tool");
    else if (failure->letter == 'B')
        text_add(text, ": is it in its boot loader?");
    else if (element)
        text_add(text, ": remove %s to skip the check", element);
}

static void add_refusal_advice(struct text *text, const struct boot_failure *failure)
{
    const char *advice = failure->letter == 'J' ? write_advice(failure) : NULL;

    if (advice)
        text_add(text, ": %s", advice);
    else if (failure->letter != 'J' && is_not_there(failure->abort_code))
        add_absence_advice(text, failure);
}

void text_add_advice(struct text *text, const struct boot_failure *failure)
{
    switch ((enum sdo_outcome)failure->outcome) {
    case SDO_OUTCOME_ABORTED: add_refusal_advice(text, failure); break;
    case SDO_OUTCOME_TOGGLE:
    case SDO_OUTCOME_PROTOCOL:
        text_add(text, ": two masters on the bus, or two devices with this node-ID?");
        break;
    case SDO_OUTCOME_NO_ANSWER:
        text_add(text, ": has it gone, or is it slow there (SDO_Timeout)?");
        break;
    case SDO_OUTCOME_OVERFLOW: text_add(text, ": is it another device?"); break;
    case SDO_OUTCOME_NOT_SENT:
    case SDO_OUTCOME_CANCELLED:
    case SDO_OUTCOME_OK: break;
    }
}

/* --- no heartbeat --- */

/* What the configuration writes to 1017h last; false: nothing. */
static bool find_producer_time(const struct node_config *config, unsigned *ret_time)
{
    struct ccf_reader reader;
    struct ccf_entry entry;
    bool found = false;

    ccf_reader_init(&reader, &config->ccf);
    while (ccf_read(&reader, &entry)) {
        if (entry.index != 0x1017 || entry.sub != 0 || entry.size != 2)
            continue;
        *ret_time = get_le16(entry.value);
        found = true;
    }
    return found;
}

void text_add_heartbeat_advice(struct text *text, const struct node_config *config,
                               const struct boot_failure *failure)
{
    unsigned time;

    text_add(text, "no heartbeat within %u ms (Consumer_Heartbeat_Time): ", failure->expected);
    if (!find_producer_time(config, &time))
        text_add(text, "the configuration does not set 1017h: add it, with a half of that time");
    else if (time == 0)
        text_add(text, "the configuration sets 1017h to 0, no heartbeat: set a half of that time");
    else if (time >= failure->expected)
        text_add(text, "the configuration sets 1017h to %u ms: that is too long", time);
    else
        text_add(text, "1017h is set to %u ms, but none comes: has the node gone?", time);
}
