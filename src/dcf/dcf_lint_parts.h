/*
 * Whether things fit together: what the parts of the lint share. Only for src/dcf/.
 */
#ifndef CO_DCF_DCF_LINT_PARTS_H
#define CO_DCF_DCF_LINT_PARTS_H

#include "dcf/dcf_build.h"

struct dcf_lint {
    const struct dcf *dcf;
    struct co_report *report;
    uint8_t node_id; /* of the file, or 1 */
};

struct dcf_lint_object { /* the entries of one index */
    const struct dcf_entry *entries;
    size_t count;
};

/* dcf_lint_objects.c: sub-indices of an object against each other */
void dcf_lint_object(const struct dcf_lint *self, const struct dcf_lint_object *object);

/* dcf_lint_known.c: objects of CiA 301 and 302 */
void dcf_lint_known(const struct dcf_lint *self, const struct dcf_lint_object *object);

/* dcf_lint_pdo.c, dcf_lint_mapping.c: both parameters of a PDO */
void dcf_lint_communication(const struct dcf_lint *self, const struct dcf_lint_object *object);
void dcf_lint_mapping(const struct dcf_lint *self, const struct dcf_lint_object *object);

/* dcf_lint_cob.c; false: no memory */
bool dcf_lint_cob_ids(const struct dcf_lint *self);

/* dcf_lint_device.c */
void dcf_lint_device(const struct dcf_lint *self);

/* dcf_lint_ability.c */
void dcf_lint_abilities(const struct dcf_lint *self);

/* The first object from this index on, and the one behind; false: there is none. */
bool dcf_lint_first(const struct dcf_lint *self, struct dcf_lint_object *ret_object,
                    uint16_t index);
bool dcf_lint_next(const struct dcf_lint *self, struct dcf_lint_object *object);

bool dcf_lint_is_writable(const struct dcf_entry *entry);

/* The entry of a sub-index, or NULL. */
const struct dcf_entry *dcf_lint_sub(const struct dcf_lint_object *object, unsigned sub);

/* False: no value, or none that is a number. With the node-ID of the file, or 1. */
bool dcf_lint_number(const struct dcf_lint *self, const struct dcf_entry *entry,
                     const struct dcf_value *value, uint64_t *ret_number);

/* What the device has when it is configured: the ParameterValue if that is written, else the
 * DefaultValue; NULL: the file does not tell. */
const struct dcf_value *dcf_lint_effective(const struct dcf_entry *entry);

#define DCF_LINT_COB_INVALID 0x80000000u

/* 1600h.., 1A00h.. */
bool dcf_lint_is_mapping(uint16_t index);

#endif
