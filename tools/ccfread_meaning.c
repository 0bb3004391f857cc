#include "ccfread_value.h"

#include "base/bytes.h"

#define BIT31      0x80000000u
#define BIT30      0x40000000u
#define EXTENDED   0x20000000u
#define CAN_ID_11  0x7FFu
#define CAN_ID_29  0x1FFFFFFFu
#define NUMBER_32  4u
#define MAPPED_MAX 64u

static void add_can_id(struct text *text, uint32_t cob_id)
{
    if (cob_id & EXTENDED)
        text_add(text, ", CAN-ID %08lXh of 29 bits", (unsigned long)(cob_id & CAN_ID_29));
    else
        text_add(text, ", CAN-ID %03lXh", (unsigned long)(cob_id & CAN_ID_11));
}

static void add_on_off(struct text *text, uint32_t cob_id)
{
    text_add(text, ": %s", cob_id & BIT31 ? "off" : "on");
    add_can_id(text, cob_id);
}

static void add_sync(struct text *text, uint32_t cob_id)
{
    text_add(text, ": %s", cob_id & BIT30 ? "produced" : "not produced");
    add_can_id(text, cob_id);
}

static void add_time_stamp(struct text *text, uint32_t cob_id)
{
    text_add(text, ": %s, %s", cob_id & BIT31 ? "consumed" : "not consumed",
             cob_id & BIT30 ? "produced" : "not produced");
    add_can_id(text, cob_id);
}

static void add_tpdo(struct text *text, uint32_t cob_id)
{
    add_on_off(text, cob_id);
    if (cob_id & BIT30)
        text_add(text, ", no RTR");
}

static void add_mapping(struct text *text, uint32_t mapped)
{
    text_add(text, ": %04lXh:%02lX, %lu bits", (unsigned long)(mapped >> 16),
             (unsigned long)(mapped >> 8 & 0xFF), (unsigned long)(mapped & 0xFF));
}

static void add_heartbeat(struct text *text, uint32_t consumer)
{
    text_add(text, ": node %lu, %lu ms", (unsigned long)(consumer >> 16 & 0xFF),
             (unsigned long)(consumer & 0xFFFF));
}

static void add_date(struct text *text, uint32_t days)
{
    text_add(text, ": ");
    text_add_date(text, days);
}

static void add_clock(struct text *text, uint32_t ms)
{
    text_add(text, ": ");
    text_add_clock(text, ms);
}

static const struct meaning {
    uint16_t first, last; /* objects */
    uint8_t first_sub, last_sub;
    void (*add)(struct text *text, uint32_t number);
} meanings[] = {
    { 0x1005, 0x1005, 0, 0, add_sync },     { 0x1012, 0x1012, 0, 0, add_time_stamp },
    { 0x1014, 0x1014, 0, 0, add_on_off },   { 0x1016, 0x1016, 1, 127, add_heartbeat },
    { 0x1020, 0x1020, 1, 1, add_date },     { 0x1020, 0x1020, 2, 2, add_clock },
    { 0x1028, 0x1028, 1, 127, add_on_off }, { 0x1200, 0x12FF, 1, 2, add_on_off },
    { 0x1400, 0x15FF, 1, 1, add_on_off },   { 0x1600, 0x17FF, 1, MAPPED_MAX, add_mapping },
    { 0x1800, 0x19FF, 1, 1, add_tpdo },     { 0x1A00, 0x1BFF, 1, MAPPED_MAX, add_mapping },
};

void value_add_meaning(struct text *text, const struct ccf_entry *entry)
{
    if (entry->size != NUMBER_32)
        return;
    for (size_t i = 0; i < sizeof meanings / sizeof meanings[0]; i++) {
        const struct meaning *meaning = &meanings[i];

        if (entry->index >= meaning->first && entry->index <= meaning->last &&
            entry->sub >= meaning->first_sub && entry->sub <= meaning->last_sub)
            meaning->add(text, get_le32(entry->value));
    }
}
