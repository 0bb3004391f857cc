/*
 * Whether what a file describes fits together, beyond what reading it shows: objects against CiA
 * 301, sub-indices against their object, PDOs against what they map, COB-IDs against each other,
 * the commissioning against the device.
 *
 *   in   a description from dcf_parse()
 *   out  warnings, each with its rule
 *
 * The manager does not ask: a device may well work with a file that has such faults.
 */
#ifndef CO_DCF_DCF_LINT_H
#define CO_DCF_DCF_LINT_H

#include "dcf/dcf.h"

/* CO_ERR_MEMORY: the messages are not complete. */
enum co_err dcf_lint(const struct dcf *self, struct co_report *report);

#endif
