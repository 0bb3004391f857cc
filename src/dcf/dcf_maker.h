/*
 * Making a concise DCF: what its parts share. Only for src/dcf/.
 */
#ifndef CO_DCF_DCF_MAKER_H
#define CO_DCF_DCF_MAKER_H

#include "dcf/dcf_build.h"

struct dcf_maker {
    const struct dcf *dcf;
    const struct dcf_ccf_options *options;
    struct co_report *report;
    struct ccf ccf;
    bool no_memory;
};

/*
 * What the entry is to have: its ParameterValue; where all is written, else its DefaultValue. NULL:
 * none.
 */
const struct dcf_value *dcf_maker_value(const struct dcf_maker *self,
                                        const struct dcf_entry *entry);
/* True if the entry has such a value or a file and may be written. */
bool dcf_maker_writes(const struct dcf_maker *self, const struct dcf_entry *entry);
/* The entry that is written, or NULL. */
const struct dcf_entry *dcf_maker_find(const struct dcf_maker *self, uint16_t index, uint8_t sub);

void dcf_maker_put(struct dcf_maker *self, const struct dcf_entry *entry);
void dcf_maker_put_number(struct dcf_maker *self, const struct dcf_entry *entry, uint64_t number);

/* dcf_ccf_pdo.c: all that belongs to this PDO; 'communication' is 1400h.., 1800h.. */
void dcf_maker_put_pdo(struct dcf_maker *self, uint16_t communication);
bool dcf_is_pdo(uint16_t index);

/* dcf_ccf_groups.c */
/* An entry without an order among others; a COB-ID in use is switched off first. */
void dcf_maker_put_single(struct dcf_maker *self, const struct dcf_entry *entry);
void dcf_maker_put_sync(struct dcf_maker *self);
void dcf_maker_put_error_control(struct dcf_maker *self);

#endif
