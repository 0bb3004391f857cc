/*
 * Codes of the public headers for the errors inside: the one place that maps them.
 */
#ifndef CO_API_ERROR_MAP_H
#define CO_API_ERROR_MAP_H

#include "base/error.h"
#include "dcf/dcf.h"
#include "manager/sdo_channel.h"
#include "mcanopen.h"
#include "runtime/network.h"

/* CANOPEN_DCF_... for what was wrong in a DCF. */
int error_of_dcf(enum dcf_error kind);
/* For what was wrong in the XML file. */
int error_of_xml(enum co_err err);
/* For a bus that could not be opened. */
int error_of_bus(enum co_err err);
/* For an NMT command. */
int error_of_command(enum co_err err);
/* For what would be sent now: MCANOPEN_OK while it may get out. */
int error_of_bus_state(enum bus_state state);
/* For the end of an SDO transfer, with the state of the bus then. */
int error_of_sdo(const struct co_event *result, enum bus_state state);
/* The bytes of an abort code; all 0 for SDO_OK. NULL is fine. */
void error_set(ERROR_T *error, sdo_abort_t code);

#endif
