#include "manager/verify.h"

#include <string.h>

#define NO_SEQUENCE  UINT16_MAX
#define TPDOS        512u  /* behind as many RPDOs */
#define SDO_CHANNELS 1024u /* behind the PDOs */
#define SYNC         1280u
#define CONSUMERS    1281u

static const struct range { /* of objects, and the number of the first one's sequence */
    uint16_t first, last, sequence;
    bool together; /* all are one sequence */
} ranges[] = {
    { 0x1005, 0x1006, SYNC, true },   { 0x1016, 0x1016, CONSUMERS, true },
    { 0x1019, 0x1019, SYNC, true },   { 0x1200, 0x12FF, SDO_CHANNELS, false },
    { 0x1400, 0x15FF, 0, false },     { 0x1600, 0x17FF, 0, false },
    { 0x1800, 0x19FF, TPDOS, false }, { 0x1A00, 0x1BFF, TPDOS, false },
};

static uint16_t sequence_of(uint16_t index)
{
    for (size_t i = 0; i < sizeof ranges / sizeof ranges[0]; i++) {
        const struct range *range = &ranges[i];

        if (index >= range->first && index <= range->last)
            return (uint16_t)(range->sequence + (range->together ? 0 : index - range->first));
    }
    return NO_SEQUENCE;
}

/* Written to make something happen: what is read there says nothing about that. */
static bool is_command(uint16_t index)
{
    return index == 0x1010 || index == 0x1011 || (index >= 0x1F50 && index <= 0x1F57);
}

static bool is_same_object(const struct ccf_entry *a, const struct ccf_entry *b)
{
    return a->index == b->index && a->sub == b->sub;
}

static bool occurs_once(const struct ccf *ccf, const struct ccf_entry *entry)
{
    struct ccf_reader reader;
    struct ccf_entry other;
    unsigned times = 0;

    ccf_reader_init(&reader, ccf);
    while (ccf_read(&reader, &other))
        times += is_same_object(&other, entry);
    return times == 1;
}

/* No entry behind, which the reader reads on, is for the same object. */
static bool is_last(struct ccf_reader behind, const struct ccf_entry *entry)
{
    struct ccf_entry other;

    while (ccf_read(&behind, &other))
        if (is_same_object(&other, entry))
            return false;
    return true;
}

static bool is_first_of(const struct ccf *ccf, const struct ccf_entry *entry, uint16_t sequence)
{
    struct ccf_reader reader;
    struct ccf_entry other = { .value = NULL };

    ccf_reader_init(&reader, ccf);
    while (ccf_read(&reader, &other) && sequence_of(other.index) != sequence)
        ;
    return other.value == entry->value;
}

static enum verify_order read_next_of_sequence(struct verify *self)
{
    while (ccf_read(&self->ahead, &self->wanted))
        if (sequence_of(self->wanted.index) == self->sequence &&
            is_last(self->ahead, &self->wanted))
            return VERIFY_READ;
    return VERIFY_SKIP;
}

static enum verify_order on_sequence(struct verify *self, const struct ccf_entry *entry,
                                     uint16_t sequence)
{
    bool differs = (self->differs[sequence / 8u] & 1u << sequence % 8u) != 0;

    if (!is_first_of(self->ccf, entry, sequence))
        return differs ? VERIFY_WRITE : VERIFY_SKIP;
    self->sequence = sequence;
    ccf_reader_init(&self->ahead, self->ccf);
    return read_next_of_sequence(self);
}

void verify_begin(struct verify *self, const struct ccf *ccf)
{
    self->ccf = ccf;
    memset(self->differs, 0, sizeof self->differs);
}

enum verify_order verify_on_entry(struct verify *self, const struct ccf_entry *entry)
{
    uint16_t sequence = sequence_of(entry->index);

    if (sequence != NO_SEQUENCE)
        return on_sequence(self, entry, sequence);
    if (is_command(entry->index) || entry->size > VERIFY_SIZE || !occurs_once(self->ccf, entry))
        return VERIFY_WRITE;
    self->sequence = NO_SEQUENCE;
    self->wanted = *entry;
    return VERIFY_READ;
}

enum verify_order verify_on_value(struct verify *self, bool known, size_t size)
{
    bool same = known && size == self->wanted.size &&
                memcmp(self->value, self->wanted.value, size) == 0;
    uint16_t sequence = self->sequence;

    if (same)
        return sequence == NO_SEQUENCE ? VERIFY_SKIP : read_next_of_sequence(self);
    if (sequence != NO_SEQUENCE)
        self->differs[sequence / 8u] |= (uint8_t)(1u << sequence % 8u);
    return VERIFY_WRITE;
}
