/*
 * SDO transfers of the application for which no call waits: their data, and the way of their ends
 * to the application's functions.
 *
 *   in   requests, from any thread; the ends of transfers, from the protocol thread
 *   out  one call of the application's function for each request, by the control daemon
 *
 *   locking  the network's, for the list; none is held while the application's function runs
 */
#ifndef CO_API_SDO_ASYNC_H
#define CO_API_SDO_ASYNC_H

#include <stdatomic.h>
#include <stdbool.h>

struct managed;
struct sdo_async;

struct sdo_async_list { /* of one network, in the order in which they came */
    struct sdo_async *first, *last;
    unsigned count;
    unsigned last_number;
    atomic_bool due; /* some may have ended: the daemon is to look */
};

/*
 * Under the network's lock: a transfer has ended. True if it may be one of these, and the daemon is
 * not to look already.
 */
bool sdo_async_note_end(struct managed *managed);

/* By the control daemon: tells the ends of those that have ended since. */
void sdo_async_tell(struct managed *managed);
/* The same at the very end: those that have not ended never will. */
void sdo_async_tell_rest(struct managed *managed);

#endif
