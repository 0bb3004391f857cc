/*
 * Why the boot of a node has failed, and what follows from it.
 *
 *   in   the failure
 *   out  the event that tells it, and back; whether another attempt may end otherwise
 */
#ifndef CO_MANAGER_BOOT_FAILURE_H
#define CO_MANAGER_BOOT_FAILURE_H

#include "base/outbox.h"
#include "base/time.h"
#include "od/abort.h"

/* Why the last attempt failed: kept until the node has booted. */
struct boot_failure {
    char letter;  /* CiA 302-2 status B..O; 0: none */
    uint8_t step; /* enum boot_step */
    /* enum sdo_outcome; SDO_OUTCOME_OK: a value that differs, or no heartbeat; CANCELLED: the node
     * has started anew in the middle of its update, or BOOT_RESTARTS times of its boot */
    uint8_t outcome;
    uint16_t index;
    uint8_t sub;
    sdo_abort_t abort_code;
    uint32_t expected, actual;
    uint32_t entry; /* step CONFIGURE: number of the entry, from 1; UPDATE_SOFTWARE: enum
                     * software_phase, and expected has how many ms it was waited for */
    uint8_t size;   /* ... its bytes (255: more); expected has the value of up to 4 */
};

/* What remains of it when the node has booted, as long as the manager is there. */
struct boot_history {
    unsigned failures;            /* attempts that have failed */
    struct boot_failure last;     /* with letter 0 where none has */
    co_us_t failed_at, booted_at; /* the last time; 0: never */
};

bool boot_failure_is_same(const struct boot_failure *a, const struct boot_failure *b);
/*
 * After so many attempts since the node's boot-up message. No: it has failed for good, until the
 * next one.
 */
bool boot_failure_is_worth_a_retry(const struct boot_failure *self, unsigned attempts);

/* MANAGER_NODE_FAILED, without the node. */
struct co_event boot_failure_event(const struct boot_failure *self);
/* What such an event tells. */
struct boot_failure boot_failure_of(const struct co_event *event);

#endif
