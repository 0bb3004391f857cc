/*
 * A local CANopen device: its communication objects, its NMT state machine and its reset rules
 * (CiA 301, 7.3), on an object dictionary that its owner has filled.
 *
 *   in   frames of the bus (all of them, those of other local devices too), the time
 *   out  boot-up, heartbeat, guarding and SDO answers, emergencies, PDOs, SYNC, TIME; the events
 *        below
 *
 *            slave_start()             start                 stop
 *   (off) ---> INITIALISING --> PRE-OPERATIONAL <--> OPERATIONAL <--> STOPPED
 *                    ^ boot-up                                           |
 *                    +------ reset node, reset communication ------------+
 *
 * Reset communication brings the power-on values of 1000h..1FFFh back, reset node those of all
 * objects. The power-on values are the DefaultValues, or what 1010h "save" stored since.
 *
 * PROTO_HB_STATE of the heartbeat consumers (1016h) is passed on, with the node-ID of the producer.
 * The outbox needs room for at least 2 frames and 4 events.
 *
 *   owner    runtime/, or a test; it owns the dictionary
 *   locking  none; the owner's
 */
#ifndef CO_SLAVE_SLAVE_H
#define CO_SLAVE_SLAVE_H

#include "base/outbox.h"
#include "od/od.h"
#include "proto/emcy.h"
#include "proto/guarding.h"
#include "proto/heartbeat.h"
#include "proto/nmt.h"
#include "proto/sdo_server.h"
#include "proto/sync.h"
#include "proto/time_stamp.h"
#include "slave/slave_pdo.h"

enum slave_event {
    /*
     * node, detail: the NMT state entered; NMT_INITIALISING with each reset, and then sub: by which
     * NMT command, 0 when it is switched on.
     */
    SLAVE_STATE = 100,
    SLAVE_WRITTEN,   /* node, index, sub: a client has written an entry, actual: its number */
    SLAVE_EMERGENCY, /* node, code, detail (1001h), data: it has raised an emergency */
    /*
     * A client has sent a value for an entry that is watched or fetched; the server waits for
     * slave_verdict() and slave_received() has the bytes.
     *   node, index, sub   the entry
     *   actual             bytes
     *   detail, code       channel and number of the transfer, struct slave_transfer
     */
    SLAVE_VERDICT,
    /*
     * A client reads an entry that is fetched; the server waits for slave_give().
     *   node, index, sub   the entry
     *   detail, code       as above
     */
    SLAVE_FETCH,
    /* node, index, sub: neither has come in time, the client was told 08000020h */
    SLAVE_VERDICT_LATE,
    /*
     * The data of an RPDO was taken over.
     *   node, index   the PDO's number
     *   sub           bytes
     *   code          generation of the mapping, rpdo.generation
     *   actual        when its frame was received
     *   data
     */
    SLAVE_RPDO,
    SLAVE_TPDO_WANTED,    /* node, index (number), code: for slave_tpdo_answer() */
    SLAVE_RPDO_REFUSED,   /* node, index (number): one that is waited for has a wrong length */
    SLAVE_RPDO_ASKED,     /* node, index (number): a remote frame of its own for it is on the bus */
    SLAVE_TPDO_CONFIRMED, /* node, index (number): its frame is on the bus */
    /*
     * An RPDO was not processed, or has not come in time; an emergency as well, and once until it
     * is right again.
     *   node, index   the PDO's number
     *   code          8210h too short, 8220h too long, 8250h silent
     *   detail, sub   bytes received and mapped
     */
    SLAVE_PDO_ERROR,
    SLAVE_SYNC_LENGTH,  /* node, code (8240h), detail (bytes received), sub (expected): as above */
    SLAVE_SYNC_MISSING, /* node: what slave_sync_external() promised does not come; once */
    SLAVE_TIME,         /* node, code (ms after midnight), index (days since 1984-01-01): a TIME */
    SLAVE_WATCH,    /* node: one that 1016h watches, detail: enum slave_watching, sub: its state */
    SLAVE_GUARDING, /* node, detail: enum slave_watching, of life guarding */
    /*
     * An emergency that 1028h listens to.
     *   node           of this device
     *   index, detail  the entry of 1028h: its sub-index; the node-ID of the producer
     *   code           COB-ID
     *   actual         when its frame was received
     *   data
     */
    SLAVE_EMCY_HEARD,
    SLAVE_EMCY_LOST /* node, actual: so many emergencies of its own found no room in the queue */
};

enum slave_watching {
    WATCH_BEGINS, /* with the first heartbeat or request, and with the first one after a time-out */
    WATCH_ENDS,   /* by a changed parameter or a reset */
    WATCH_BOOT_UP, /* of the node; watching goes on with its next heartbeat */
    WATCH_TIMEOUT
};

/* What the owner knows of the bus. */
enum slave_bus {
    SLAVE_BUS_OK,
    SLAVE_BUS_PASSIVE,
    SLAVE_BUS_LOST /* bus-off, or the interface is down */
};

/*
 * The error state: free of errors, or not. Each error is counted once, from its emergency to the
 * one with code 0000h that says that it has gone. 1001h is what the errors that there are say
 * together, with the generic bit as long as there is one.
 *
 *   application      slave_raise_error() to slave_clear_error()
 *   lost             8130h: a node or the master is silent, until it is heard again
 *   faults           what is wrong in the device's communication:
 *                    8210h.. 8250h: an RPDO or SYNC, until a right one comes
 *     overrun        8110h: received frames were lost, until 1 s has passed without
 *     pdos_lost      8100h: slave_lose_pdos() to slave_pdos_taken()
 *   told_bus         8120h: error passive, until the controller is not
 *                    8140h: the bus was lost; the emergency for that and its end come when it is
 *                    back
 *
 * Emergencies of the device itself begin their field with two bytes of bits: what there is (1:
 * error control, 2: error passive, 4: bus lost), and what has been since the last reset (1: the
 * controller had errors, 2: something was lost, 4: PDOs of a wrong length). Bits 5..7 of both are
 * the application's, see slave_raise_error().
 */
struct slave_errors {
    unsigned application; /* errors of it */
    uint8_t raised;       /* their bits of 1001h */
    uint8_t temporary;    /* its bits of the first byte */
    uint8_t sticky;       /* the second byte */
    unsigned lost;
    unsigned faults;
    uint8_t bus;      /* enum slave_bus, as it is ... */
    uint8_t told_bus; /* ... and as the network knows it */
    bool outage;      /* it was lost meanwhile, and the network does not know */
    bool overrun_due; /* frames were lost, and the network does not know */
    bool overrun;
    co_us_t overrun_end;
    bool pdos_lost;
    bool emcy_lost_told; /* ... that the queue was full, since it was */
};

/* An error of the application. */
struct slave_error {
    uint16_t code;
    uint16_t info;          /* for 1003h */
    uint8_t error_register; /* bits for 1001h */
    uint8_t field[5];
};

struct slave_consumer; /* one entry of 1016h */
struct slave_hearing;  /* one of 1028h */
struct slave_pdos;     /* what 1400h..1BFFh say */

/* A client's read or write that the owner is asked about. */
struct slave_transfer {
    uint8_t channel;
    uint32_t number;
};

/* One of the device's SDO servers. */
struct slave_channel {
    uint16_t index;           /* 1200h .. 127Fh */
    struct sdo_server server; /* its buffer is NULL until the first request */
    bool verdict_due;         /* a verdict found no room in the outbox */
    sdo_abort_t verdict;
    uint32_t verdict_number;
};

struct slave {
    uint8_t node;
    uint8_t state;      /* enum nmt_state */
    uint8_t told_state; /* by the last SLAVE_STATE */
    bool boot_up_due;   /* initialising; goes on when the outbox has room */
    uint8_t reset_by;   /* ... because of this NMT command; 0: switched on */
    struct od *od;
    struct slave_channel *channels; /* the first one is 1200h */
    unsigned channel_count;
    uint32_t buffer_size; /* of an SDO server */
    struct hb_producer heartbeat;
    struct emcy_producer emcy;
    struct slave_errors errors;
    struct guard_slave guard;
    bool told_guarding;               /* life guarding runs, as told */
    struct slave_consumer *consumers; /* the sub-indices 1.. of 1016h */
    unsigned consumer_count;
    bool consumers_due; /* a change found no room in the outbox */
    co_us_t consumer_deadline;
    struct slave_hearing *heard; /* emergencies that are listened to */
    unsigned heard_count, heard_room;
    unsigned heard_dropped;   /* the outbox had no room */
    uint8_t load;             /* bit n: 1011:n "load" waits for the reset */
    bool application_changed; /* objects from 2000h on differ from the power-on values */
    unsigned changes;         /* counts what clients, and resets, do to these */

    struct slave_pdos *pdos;
    bool accept_long; /* the owner's: of RPDOs that are too long the first bytes count */
    bool assume_sync; /* the owner's: without 1005h, which files leave out, SYNC is 080h */
    struct sync_producer sync;
    struct sync_consumer sync_heard;
    bool told_sync_wrong;
    struct time_stamp time;
    bool consumes_sync;
    co_us_t window_end;         /* of the last SYNC; CO_NEVER: up to the next one */
    unsigned listen_generation; /* counts what may have changed slave_listens() ... */
    unsigned sync_generation;   /* ... and what changes slave_sync_plan(), or makes it begin anew */
    unsigned late_verdicts;
};

/*
 * Prepares a device; it is silent until slave_start(). Objects that every device needs and the
 * dictionary lacks are added: 1000h, 1001h, 1018h. CO_ERR_MEMORY; CO_ERR_ARG: node not 1..127.
 */
enum co_err slave_init(struct slave *self, uint8_t node, struct od *od);
void slave_done(struct slave *self);
/* The node that is watched by sub-index i + 1 of 1016h, as SLAVE_WATCH has told; 0: none. */
uint8_t slave_watched_node(const struct slave *self, unsigned i);
/* 1016h is its owner's to watch: the device reports no heartbeats and does nothing about them. */
void slave_leave_heartbeats(struct slave *self);
/* The same for 1028h and emergencies of others. */
void slave_leave_emergencies(struct slave *self);

/* Whether SDO block transfers are; they are until this says otherwise. */
void slave_serve_blocks(struct slave *self, bool served);

/* Power on: reset node, boot-up, pre-operational. */
void slave_start(struct slave *self, co_us_t now, struct co_outbox *out);
/* The same with the values that the dictionary has, not the power-on values. */
void slave_switch_on(struct slave *self, co_us_t now, struct co_outbox *out);

/* What an NMT command of the master, or of the device itself, does. */
void slave_command(struct slave *self, enum nmt_command command, co_us_t now,
                   struct co_outbox *out);

/* Frames with CO_FRAME_OWN are its own and ignored. */
void slave_on_frame(struct slave *self, const struct co_frame *frame, co_us_t now,
                    struct co_outbox *out);
void slave_on_time(struct slave *self, co_us_t now, struct co_outbox *out);
co_us_t slave_deadline(const struct slave *self);

/*
 * An error of the application: 1001h gets these bits, 1003h an entry, the network an emergency with
 * the field as it is. Bits 5..7 of its first two bytes are the application's part in what the
 * device says itself: those of the first one count until slave_clear_error(), those of the second
 * one until the next reset. CO_ERR_AGAIN: the outbox has no room, nothing was done.
 */
enum co_err slave_raise_error(struct slave *self, const struct slave_error *error, co_us_t now,
                              struct co_outbox *out);
/*
 * One of them has gone, with these bits of 1001h: emergency 0000h with this field, whose bits 5..7
 * of the first byte are those that stay. With the last one all bits go. CO_ERR_STATE: there is
 * none; CO_ERR_AGAIN as above.
 */
enum co_err slave_clear_error(struct slave *self, uint8_t bits, const uint8_t field[5], co_us_t now,
                              struct co_outbox *out);

/* Between boot-ups and before the first one it is remembered. */
void slave_on_bus(struct slave *self, enum slave_bus bus, co_us_t now, struct co_outbox *out);
/* Received frames did not reach the device. */
void slave_on_frames_lost(struct slave *self, co_us_t now, struct co_outbox *out);
/*
 * So many received PDOs found no room on their way to the application: 8100h, each time.
 * CO_ERR_AGAIN as above.
 */
enum co_err slave_lose_pdos(struct slave *self, unsigned count, co_us_t now, struct co_outbox *out);
/* The application has taken all that are left. */
enum co_err slave_pdos_taken(struct slave *self, co_us_t now, struct co_outbox *out);

/* The client of SLAVE_VERDICT or SLAVE_FETCH still waits. */
bool slave_waits_for(const struct slave *self, struct slave_transfer transfer);
/* The value that SLAVE_VERDICT told of, while its client waits. */
const uint8_t *slave_received(const struct slave *self, struct slave_transfer transfer);
/*
 * What the application says of that value: SDO_OK stores it, if limits and state still allow, any
 * other code goes to the client. What is fetched the owner has stored already. A transfer that has
 * ended is ignored.
 */
void slave_verdict(struct slave *self, struct slave_transfer transfer, sdo_abort_t code,
                   co_us_t now, struct co_outbox *out);

struct slave_value {
    sdo_abort_t code; /* SDO_OK, or why there is none */
    const uint8_t *bytes;
    uint32_t size;
};
/* For SLAVE_FETCH; the bytes are copied. A transfer that has ended is ignored. */
void slave_give(struct slave *self, struct slave_transfer transfer, const struct slave_value *value,
                co_us_t now, struct co_outbox *out);

/*
 * Sends TIME. CO_ERR_STATE: not pre-operational or operational; CO_ERR_ARG: 1012h does not make it
 * a producer; CO_ERR_AGAIN: no room.
 */
enum co_err slave_send_time(const struct slave *self, const struct time_of_day *time,
                            struct co_outbox *out);

#endif
