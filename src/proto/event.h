/*
 * What the machines of proto/ tell their owner, through the outbox.
 */
#ifndef CO_PROTO_EVENT_H
#define CO_PROTO_EVENT_H

enum proto_event {
    PROTO_NONE = 0,
    /*
     * A transfer of an SDO client has ended; exactly one for each start.
     *   node, index, sub   the server and the object
     *   detail             enum sdo_outcome
     *   code               abort code, ours or the server's; 0: it went well, or nothing was sent
     *   actual             bytes transferred; for SDO_OUTCOME_OVERFLOW bytes needed, 0 unknown
     *   expected           1: asked for blocks, the server has shown that it has none
     */
    PROTO_SDO_DONE,
    /*
     * An SDO server has received a whole value for an entry and waits for sdo_server_verdict().
     *   index, sub, actual   the object, the number of bytes; sdo_server_value() has them
     *   code                 number of the transfer: sdo_server.number while it still waits
     */
    PROTO_SDO_WRITE,
    /*
     * A client reads an entry whose bytes are with the owner: sdo_server_give() is waited for.
     *   index, sub   the object
     *   code         number of the transfer, as in PROTO_SDO_WRITE
     */
    PROTO_SDO_READ,
    /*
     * A watched node's heartbeat reports another NMT state, or is its first, or its first after a
     * loss: node, detail (state).
     */
    PROTO_HB_STATE,
    /* A watched node has been silent for its whole period: node, detail (last state). */
    PROTO_HB_LOST,
    /* An emergency has come: node, code (error code), detail (error register), data (8 bytes). */
    PROTO_EMCY,
    /*
     * A guarded node's first answer, its first one after a loss, or one with another NMT state:
     * node, detail (state).
     */
    PROTO_GUARD_STATE,
    /*
     * A guarded node gives no answer, see guarding.h; once until it answers again: node, detail
     * (state of its last answer; NMT_INITIALISING: it has given none).
     */
    PROTO_GUARD_LOST,
    /*
     * A guarded node has answered with the wrong toggle bit: node, detail (state), actual (how
     * many so far). It is not lost.
     */
    PROTO_GUARD_TOGGLE,
    /* The master of this device asks no more: node (the device's own). */
    PROTO_LIFE_LOST,
    /* It asks again, or life guarding has ended: node (the device's own). */
    PROTO_LIFE_BACK,
    /*
     * An RPDO's data was taken over: index (number), sub (bytes), code (generation of the mapping),
     * actual (when its frame came), data.
     */
    PROTO_RPDO,
    /*
     * An RPDO has come with a wrong length or not in time, or is right again: index (number), code
     * (emergency code, or 0), expected (the code before), detail (bytes received), sub (bytes
     * mapped).
     */
    PROTO_RPDO_FAULT,
    /* A TPDO needs new data: index (number), code (of this question). */
    PROTO_TPDO_WANTED,
    /* Somebody else is to send SYNC, and does not. */
    PROTO_SYNC_MISSING
};

#endif
