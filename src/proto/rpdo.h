/*
 * A received PDO (CiA 301, 7.2.2): its data goes into the dictionary at once, or with a SYNC.
 *
 *   in   frames with its COB-ID, SYNCs, the time
 *   out  values in the dictionary
 *        PROTO_RPDO         data was taken over, where somebody wants to know
 *        PROTO_RPDO_FAULT   too short, too long, silent: once until a right one comes; then code 0
 *
 *   frame --> [next] -- types 241..255: at once --> dictionary
 *                    -- types   0..240: SYNC -----> dictionary
 *
 * Of several frames before a SYNC the last one counts. A frame whose event finds no room in the
 * outbox waits in the same place, with the deadline due.
 *
 *   owner    a local device
 *   locking  none; the owner's
 */
#ifndef CO_PROTO_RPDO_H
#define CO_PROTO_RPDO_H

#include "base/outbox.h"
#include "base/time.h"
#include "proto/pdo_map.h"

#define RPDO_FAULT_SHORT   0x8210u /* as emergency codes */
#define RPDO_FAULT_LONG    0x8220u
#define RPDO_FAULT_TIMEOUT 0x8250u

#define RPDO_SYNC_TYPE_MAX 240u

struct rpdo {
    uint32_t cob_id; /* object 14xxh:01; bit 31: not valid */
    uint16_t number; /* 1..512 */
    uint8_t type;
    bool notify;      /* the owner's: PROTO_RPDO with all data taken over */
    bool running;     /* NMT state operational */
    unsigned waiters; /* the owner's: who waits for data; > 0 is as notify */
    unsigned askers;  /* the owner's: who waits for a remote frame of it to be sent */
    co_us_t asked_at; /* the last one of them */
    unsigned asked;   /* remote frames of it that were on the bus, as far as one was waited for */
    uint32_t generation; /* of the mapping */
    struct pdo_map map;

    uint8_t data[PDO_SIZE_MAX]; /* taken over last */
    uint8_t dlc;
    unsigned received;  /* how often data was taken over */
    uint64_t changed;   /* the fields that got another value by that; the owner's to clear */
    unsigned errors;    /* frames of a wrong length ... */
    uint8_t wrong_size; /* ... and that of the last one */
    unsigned replaced;  /* by another before they were taken over */
    unsigned discarded; /* came behind the synchronous window */

    bool waiting; /* 'next' is there */
    bool due;     /* ... and to be taken over */
    uint8_t next[PDO_SIZE_MAX];
    co_us_t next_at;

    uint16_t fault; /* one of the codes above, or 0 */
    uint16_t told_fault;
    co_us_t timeout; /* object 14xxh:05 as time; 0: may be silent for any time */
    co_us_t deadline;
};

struct rpdo_parameters {
    uint32_t cob_id;
    uint8_t type;
    co_us_t timeout;
};

void rpdo_init(struct rpdo *self, uint16_t number, struct pdo_field *fields, uint8_t room);
/* Takes over changed parameters; what waits for a SYNC is dropped where the type differs. */
void rpdo_configure(struct rpdo *self, const struct rpdo_parameters *parameters);
/* Another mapping is there: what was received for the old one is dropped. */
void rpdo_remapped(struct rpdo *self);
bool rpdo_is_valid(const struct rpdo *self);

/* Operational: the faults have gone, the time runs from the first frame on. */
void rpdo_start(struct rpdo *self);
void rpdo_stop(struct rpdo *self);
/* No faults, and nothing to be told. */
void rpdo_reset(struct rpdo *self);

/* A data frame with the COB-ID of this PDO; accept_long: the bytes too many are left out. */
void rpdo_on_frame(struct rpdo *self, const struct co_frame *frame, bool accept_long, co_us_t now,
                   struct co_outbox *out);
/* A synchronous one's window is over: its frames are nothing until the next SYNC. */
void rpdo_discard(struct rpdo *self);
/* What waits becomes due; rpdo_on_time() takes it over. */
void rpdo_on_sync(struct rpdo *self);
void rpdo_on_time(struct rpdo *self, co_us_t now, struct co_outbox *out);
co_us_t rpdo_deadline(const struct rpdo *self);

/* The remote frame that asks for this PDO's data. */
struct co_frame rpdo_request_frame(const struct rpdo *self);

#endif
