/*
 * A simulated device for tests: a slave on a dictionary made from a table, in virtual time, with
 * what it sends and tells recorded. Conversations with it are tables that read like a candump log.
 */
#ifndef TEST_SUPPORT_DEVICE_H
#define TEST_SUPPORT_DEVICE_H

#include "slave/slave.h"

#define DEVICE_RECORDS 256u
#define DEVICE_NODE    5u

struct device_entry {
    uint16_t index;
    uint8_t sub, type, access;
    uint32_t value;
    bool mappable;
};

struct device {
    struct od od;
    struct slave slave;
    co_us_t now;
    struct co_outbox out;
    struct co_frame out_frames[8];
    struct co_event out_events[8];
    unsigned frame_count, frame_taken, event_count, event_taken;
    bool stalled; /* frames that are no SDO requests, and its owner, find a full outbox first */
    struct {
        co_us_t at;
        struct co_frame frame;
    } frames[DEVICE_RECORDS];
    struct co_event events[DEVICE_RECORDS];
};

/* Entries up to one with index 0. It is not started. */
void device_init(struct device *self, const struct device_entry *entries);
/* The same on a dictionary that is there already; the device owns it then. */
void device_init_od(struct device *self, const struct od *od);
void device_done(struct device *self);

void device_start(struct device *self);
/* Lets the time pass up to this moment, deadlines at the moment itself included. */
void device_run(struct device *self, co_us_t until);
/* Takes what is in the outbox. */
void device_drain(struct device *self);
/* So many frames and events of room remain, until device_drain(). */
void device_fill(struct device *self, unsigned frames, unsigned events);
void device_hear(struct device *self, const char *frame);
/* The oldest frame not taken yet; "" when there is none. In a static buffer. */
const char *device_next_frame(struct device *self, co_us_t *ret_at);
/* The oldest event not taken yet: "state 5", "written 1017:00 = 100", "emcy 8130 11", ... */
const char *device_next_event(struct device *self);
void device_forget(struct device *self);

/* A client's expedited transfers; the abort code, or 0. No answer is 1. */
#define DEVICE_SILENT 1u
sdo_abort_t device_write(struct device *self, uint16_t index, uint8_t sub, uint8_t size,
                         uint32_t value);
sdo_abort_t device_read(struct device *self, uint16_t index, uint8_t sub, uint32_t *ret_value);
/* A value that must be readable. */
uint32_t device_value(struct device *self, uint16_t index, uint8_t sub);

/*
 * "send N", "set INDEX:SUB VALUE", "answer N ASK", "hold", "release", "request N", "flags rN|tN
 * F", "verdict N CODE [at CHANNEL]", "give N HEXSIZE [at CHANNEL]", "refuse N CODE [at
 * CHANNEL]", "watch INDEX:SUB", "time MS DAYS", "raise CODE INFO BITS F0F1" (the field goes on with
 * 030405), "clear BITS F0F1", "bus ok|passive|lost", "overrun", "lose N", "taken"; with " -> E"
 * behind it: enum co_err that is to be returned, as a number.
 */
void device_do(struct device *self, const char *text);

enum talk_step_kind {
    HEARS,  /* a frame comes to the device */
    ECHOES, /* the same, one of its own */
    DOES,   /* its owner calls it, see device_do() */
    SENDS,  /* the device sends it, at this moment, and nothing before it */
    TELLS,  /* ... an event, some time since the last one */
    QUIET   /* nothing was sent up to this moment */
};

struct talk_step {
    co_us_t at; /* ms */
    enum talk_step_kind kind;
    const char *text;
};

#define DEVICE_STEPS 48u

struct device_talk {
    const char *name;
    struct talk_step steps[DEVICE_STEPS]; /* up to one without text */
};

/* Runs a conversation on a device that was just started; it must end with nothing left to say. */
void device_talk(struct device *self, const struct device_talk *talk);

#endif
