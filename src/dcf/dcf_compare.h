/*
 * A DCF against the EDS of its device: what one has and the other has not, and what differs.
 *
 *   in   two descriptions from dcf_parse()
 *   out  warnings with lines of the DCF, each with its rule ("eds-...")
 */
#ifndef CO_DCF_DCF_COMPARE_H
#define CO_DCF_DCF_COMPARE_H

#include "dcf/dcf.h"

void dcf_compare(const struct dcf *dcf, const struct dcf *eds, struct co_report *report);

#endif
