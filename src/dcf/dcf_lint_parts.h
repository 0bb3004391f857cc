/*
 * Whether things fit together: what the parts of the lint share. Only for src/dcf/.
 */
#ifndef CO_DCF_DCF_LINT_PARTS_H
#define CO_DCF_DCF_LINT_PARTS_H

#include "dcf/dcf_build.h"

struct dcf_lint {
    const struct dcf *dcf;
    struct co_report *report;
};

struct dcf_lint_object { /* the entries of one index */
    const struct dcf_entry *entries;
    size_t count;
};

/* dcf_lint_objects.c: sub-indices of an object against each other */
void dcf_lint_object(const struct dcf_lint *self, const struct dcf_lint_object *object);

/* What the device has when it is configured: the ParameterValue if that is written, else the
 * DefaultValue; NULL: the file does not tell. */
const struct dcf_value *dcf_lint_effective(const struct dcf_entry *entry);

/* 1600h.., 1A00h.. */
bool dcf_lint_is_mapping(uint16_t index);

#endif
