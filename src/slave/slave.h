/*
 * A local CANopen device: its communication objects, its NMT state machine and its reset rules
 * (CiA 301, 7.3), on an object dictionary that its owner has filled.
 *
 *   in   frames of the bus (all of them, those of other local devices too), the time
 *   out  boot-up, heartbeat, guarding and SDO answers, emergencies; the events below
 *
 *            slave_start()             start                 stop
 *   (off) ---> INITIALISING --> PRE-OPERATIONAL <--> OPERATIONAL <--> STOPPED
 *                    ^ boot-up                                           |
 *                    +------ reset node, reset communication ------------+
 *
 * Reset communication brings the power-on values of 1000h..1FFFh back, reset node those of all
 * objects. The power-on values are the DefaultValues, or what 1010h "save" stored since.
 *
 * Events of the heartbeat consumers (1016h) are passed on: PROTO_HB_STATE, PROTO_HB_LOST with the
 * node-ID of the producer. The outbox needs room for at least 2 frames and 4 events.
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

enum slave_event {
    SLAVE_STATE = 100, /* node, detail: the NMT state entered; NMT_INITIALISING with each reset */
    SLAVE_WRITTEN,     /* node, index, sub: a client has written an entry, actual: its number */
    SLAVE_EMCY         /* node, code, detail (1001h), data: it has raised an emergency */
};

struct slave_consumer; /* one entry of 1016h */
struct slave_factory;  /* the values that 1011h "load" brings back */

struct slave {
    uint8_t node;
    uint8_t state;      /* enum nmt_state */
    uint8_t told_state; /* by the last SLAVE_STATE */
    bool boot_up_due;   /* initialising; goes on when the outbox has room */
    struct od *od;
    struct sdo_server server;
    uint8_t *buffer; /* of the SDO server */
    struct hb_producer heartbeat;
    struct emcy_producer emcy;
    uint8_t raised; /* bits of 1001h by slave_raise_error() */
    unsigned lost;  /* watched nodes, and the guarding master, that are silent */
    struct guard_slave guard;
    struct slave_consumer *consumers; /* the sub-indices 1.. of 1016h */
    unsigned consumer_count;
    bool consumers_due; /* a change found no room in the outbox */
    co_us_t consumer_deadline;
    struct slave_factory *factory; /* NULL: nothing was ever saved */
    uint8_t load;                  /* bit n: 1011:n "load" waits for the reset */
    bool application_changed;      /* objects from 2000h on differ from the power-on values */
};

/*
 * Prepares a device; it is silent until slave_start(). Objects that every device needs and the
 * dictionary lacks are added: 1000h, 1001h, 1018h. CO_ERR_MEMORY; CO_ERR_ARG: node not 1..127.
 */
enum co_err slave_init(struct slave *self, uint8_t node, struct od *od);
void slave_done(struct slave *self);
/* 1016h is its owner's to watch: the device reports no heartbeats and does nothing about them. */
void slave_leave_heartbeats(struct slave *self);

/* Power on: reset node, boot-up, pre-operational. */
void slave_start(struct slave *self, co_us_t now, struct co_outbox *out);

/* What an NMT command of the master, or of the device itself, does. */
void slave_command(struct slave *self, enum nmt_command command, co_us_t now,
                   struct co_outbox *out);

/* Frames with CO_FRAME_OWN are its own and ignored. */
void slave_on_frame(struct slave *self, const struct co_frame *frame, co_us_t now,
                    struct co_outbox *out);
void slave_on_time(struct slave *self, co_us_t now, struct co_outbox *out);
co_us_t slave_deadline(const struct slave *self);

/*
 * An error of the device: 1001h gets these bits (and the generic one), 1003h an entry, the network
 * an emergency. CO_ERR_AGAIN: the outbox has no room, nothing was done.
 */
enum co_err slave_raise_error(struct slave *self, const struct emcy_message *error, co_us_t now,
                              struct co_outbox *out);
/* The errors with these bits of 1001h have gone: emergency 0000h. CO_ERR_AGAIN as above. */
enum co_err slave_clear_error(struct slave *self, uint8_t bits, co_us_t now, struct co_outbox *out);

#endif
