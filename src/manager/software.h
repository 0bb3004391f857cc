/*
 * The program of a device: compared with what the network's file expects, and replaced
 * (CiA 302-3, "program download"). Steps CHECK_SOFTWARE and UPDATE_SOFTWARE of a node's boot.
 *
 *   in   the node's configuration, its answers, its boot-up messages, the time
 *   out  SDO requests of the node's boot, its next step, or boot error G, H or I
 *
 *   1F56h:01 ---> as expected: on to the configuration, unless the program is stopped: to START
 *     |
 *     v          1F51h:01 = 0                = 3                          1F50h:01
 *    ASK --------> STOP -> STOPPING -> CLEAR -> CLEARING -> WRITE -> WRITING -> COMPARE
 *     |  is stopped                      ^       (1F57h)             (1F57h)  (1F56h) |
 *     +----------------------------------+                                            v
 *                                boot begins anew <- STARTING <- START (1F51h:01 = 1)
 *
 * The device may go to a boot loader and back on the way: what stops or starts its program need not
 * be answered, and a boot-up message goes on with the update. Only one in the middle of WRITE ends
 * it. What is waited for has a time limit each; silence in that time is none.
 *
 * A device that ends as before is given its program SOFTWARE_TRIES times, not more, until it has
 * booted once: a flash does not stand being written for ever.
 */
#ifndef CO_MANAGER_SOFTWARE_H
#define CO_MANAGER_SOFTWARE_H

#include "base/time.h"

#include <stdbool.h>
#include <stdint.h>

#define SOFTWARE_TRIES       3u
#define SOFTWARE_PAUSE       CO_MS(100)   /* between two questions */
#define SOFTWARE_STATE_LIMIT CO_MS(10000) /* for a program to stop, or to start */
#define SOFTWARE_FLASH_LIMIT CO_MS(60000) /* to clear the flash, or to write it */
#define SOFTWARE_BLOCK_SIZE  127u         /* segments, unless SDO_Block_Size says otherwise */

enum software_phase {
    SOFTWARE_ASK = 1,
    SOFTWARE_STOP,
    SOFTWARE_STOPPING,
    SOFTWARE_CLEAR,
    SOFTWARE_CLEARING,
    SOFTWARE_WRITE,
    SOFTWARE_WRITING,
    SOFTWARE_COMPARE,
    SOFTWARE_START,
    SOFTWARE_STARTING
};

struct software_update {
    uint8_t phase;  /* enum software_phase */
    unsigned tries; /* updates, or starts, since the node's last boot that ended well */
    bool repeated;  /* it has started anew in a phase that was begun again then */
    co_us_t limit;  /* end of what is waited for */
};

#endif
