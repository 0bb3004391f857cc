/*
 * A plant, its faults and its operators, made from one number: a seed.
 *
 *   in   the number
 *   out  a plant that is powered on; a fault for each node that has one, and what the manager's
 *        record of that node has to say in the end
 *
 * Each node has one fault at most. Some are there for good; those of others, and lost frames, end
 * after SEED_FAULTY_MS. A node that has only had such is as healthy as one without.
 *
 * seed.c makes the plan and the plant, seed_faults.c plays the faults as time goes on,
 * seed_requests.c the application, seed_verdict.c looks at what has become of it.
 */
#ifndef TEST_SUPPORT_SEED_H
#define TEST_SUPPORT_SEED_H

#include "support/loader.h"
#include "support/plant.h"

#define SEED_FAULTY_MS   15000u
#define SEED_SETTLED_MS  60000u
#define SEED_ENTRIES     8u
#define SEED_REQUESTS    8u
#define SEED_BEAT(nodes) ((nodes) > 30u ? 1000u : 300u) /* ms: heartbeats of a plant */

enum seed_fault {
    /* For good, from the start: the boot ends with a cause. */
    SEED_OFF,          /* B: has no power */
    SEED_MUTE,         /* B: hears, and boots, but its answers get lost */
    SEED_TYPE,         /* C */
    SEED_VENDOR,       /* D */
    SEED_PRODUCT,      /* M */
    SEED_REVISION,     /* N */
    SEED_SERIAL,       /* O */
    SEED_NO_IDENTITY,  /* D, M, N, O: refuses to tell it */
    SEED_REFUSES,      /* J: a configuration write, with an abort code */
    SEED_RESETS,       /* J: resets itself in mid configuration, always */
    SEED_HANGS,        /* B: stops for ever, in mid boot */
    SEED_NO_HEARTBEAT, /* K */
    SEED_NO_STATE,     /* E, F: to be kept alive, and does not tell its state */
    SEED_NO_SOFTWARE,  /* G: does not tell its software */
    SEED_OLD_SOFTWARE, /* H: may not be updated */
    SEED_BAD_UPDATE,   /* I: the update fails */
    /* For good, at any time. */
    SEED_DIES, /* B */
    /* They end. */
    SEED_BUSY,        /* some requests are refused: not now */
    SEED_LATE,        /* answers late, later than SDO_Timeout too */
    SEED_RESETS_ONCE, /* in mid boot */
    SEED_POWER,       /* power fails, and comes back */
    SEED_CABLE,       /* is unplugged for a while */
    SEED_UPDATE,      /* no fault: gets its new program */
    SEED_FAULTS,
    /* Of the network: they stand in no record of their own. */
    SEED_LOSS = SEED_FAULTS, /* frames get lost */
    SEED_MANAGER,            /* the manager's power fails */
    SEED_ORDERS,             /* the application resets, stops and starts nodes */
    SEED_KINDS,
    SEED_NONE
};

struct seed_node {
    uint8_t id;
    uint8_t fault; /* enum seed_fault */
    bool mandatory, beats, guarded, kept_alive, verified;
    bool hit;         /* by something that a record may tell of: lost frames, its own fault */
    unsigned answers; /* to SDO requests, since its boot-up message or since the start */
    unsigned at;      /* the answer at which it happens */
    unsigned strikes; /* how often it still happens */
    unsigned late_ms;
    co_us_t at_time; /* ... or when */
    co_us_t back_at; /* not 0: without power, or unplugged, until then */
    /* What it refuses. */
    uint16_t index;
    uint8_t sub;
    uint32_t code;
    struct boot_failure cause; /* what its record has to say; letter 0: nothing */
    struct loader *loader;
};

/* A request of the application. */
struct seed_request {
    struct sdo_request request;
    uint8_t target;
    uint8_t buffer[64];
    uint32_t written;
    unsigned resets; /* of the device before */
    bool open;       /* neither told nor taken back */
};

struct seed_totals {
    unsigned seeds, nodes, clean, never_started;
    unsigned faults[SEED_KINDS];
    uint64_t virtual_us;
    uint64_t frames, requests;
};

struct seed {
    struct plant *plant;
    unsigned number;
    uint64_t random;
    unsigned node_count;
    bool faulty; /* what ends has not ended yet */
    bool clean;  /* no faults at all */
    bool starts; /* no mandatory node is faulty for good */
    bool has[SEED_KINDS];
    bool needs_start; /* only the application starts the network, or some of its nodes */
    unsigned loss;    /* one frame in so many */
    co_us_t manager_off, manager_on;
    struct seed_node nodes[NETWORK_NODE_MAX + 1];
    struct seed_request requests[SEED_REQUESTS];
    uint32_t counter; /* values written by the application */
    unsigned submitted, done, cancelled, lost;
};

/* The name of a kind, for tables. */
const char *seed_fault_name(unsigned kind);
/* xorshift64*, good enough and the same everywhere */
unsigned seed_below(struct seed *self, unsigned limit);
bool seed_one_in(struct seed *self, unsigned n);

struct seed *seed_new(unsigned number);
void seed_free(struct seed *self);
/* All of it: the faults, then SEED_SETTLED_MS without those that end. */
void seed_run(struct seed *self);
/* Fails the test where anything is not as it has to be; see seed_verdict.c. */
void seed_judge(struct seed *self);
void seed_add_up(const struct seed *self, struct seed_totals *totals);
/* The sum of so many. */
void seed_print(const struct seed_totals *parts, unsigned count);

/* --- for the parts of it --- */

/* Is there for good. */
bool seed_is_permanent(unsigned fault);
/* Has to be operational in the end. */
bool seed_is_healthy(const struct seed_node *node);
void seed_play_faults(struct seed *self);
/* Not written to by the application is one that would forget then when it was configured. */
void seed_add_request_objects(struct seed *self, uint8_t node, bool written);
void seed_apply(struct seed *self); /* the application, each few ms */
void seed_on_event(struct plant *plant, const struct co_event *event);
void seed_forget_requests(struct seed *self); /* the manager has lost its power */

#endif
