/*
 * Values that 'mcanopen sim' gives to objects of its devices: once, rising and falling, or back and
 * forth.
 *
 *   NODE:INDEX[:SUB]=VALUE             --set
 *   NODE:INDEX[:SUB]=A..B/MS[/STEP]    --ramp: from A to B within MS, then anew; each STEP ms
 *   NODE:INDEX[:SUB]=A..B/MS           --toggle: A and B in turns of MS
 *   NODE:INDEX[:SUB]=PATH              --file: the bytes of a domain are in this file
 *
 * INDEX and SUB are hexadecimal. Values go through the slave interface: what is mapped is sent.
 */
#ifndef TOOLS_MCANOPEN_SIM_VALUES_H
#define TOOLS_MCANOPEN_SIM_VALUES_H

#include "base/time.h"
#include "scanopen.h"

#include <stdbool.h>
#include <stddef.h>

enum sim_motion { SIM_SET, SIM_RAMP, SIM_TOGGLE, SIM_FILE };

#define SIM_TEXT_MAX 64u

struct sim_value {
    enum sim_motion motion;
    const char *option; /* as given, for messages */
    unsigned node, index, sub;
    char from[SIM_TEXT_MAX], to[SIM_TEXT_MAX];
    const char *path; /* SIM_FILE: a part of the option */
    unsigned period_ms, step_ms;
    HNODE handle;
    unsigned char type; /* of the entry */
    co_us_t begin, due; /* CO_NEVER: never again */
};

/* False: the option is malformed; a message was given. */
bool sim_value_parse(enum sim_motion motion, const char *option, struct sim_value *ret_value);
/*
 * Gives the object its first value; before the node is activated. False: there is no such object,
 * or it may not have the value; a message was given.
 */
bool sim_value_begin(struct sim_value *self, HNODE node, co_us_t now);
/* The next one, when it is due. */
void sim_value_step(struct sim_value *self, co_us_t now);

#endif
