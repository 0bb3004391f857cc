/*
 * Boot of one node: "start boot slave" of CiA 302-2, from the first read to the start.
 *
 *   in   the owner's orders, results of its SDO request, the node's error control frames, the time
 *   out  NMT frames; MANAGER_NODE_... events
 *
 *                +----------------- boot-up message ----------------+
 *                v                                                  |
 *   RESET -> DEVICE_TYPE -> IDENTITY -> CHECK_CONFIGURATION -> CONFIGURE -> SAVE     (*)
 *     ^          | no answer                    | up to date          |
 *     |          v                              +------------+--------+
 *     +------- RETRY (1 s)                                   v
 *                                     FAILED <------- ERROR_CONTROL -> READY -> STARTED
 *
 * The node's SDO request is submitted by the owner: request_due says that it wants to be. The owner
 * hands the result back with boot_node_on_sdo(). Steps for which nothing is configured are passed
 * at once.
 *
 *   RESTORE, where a node is to have its default values first, stands before CONFIGURE, and goes
 *   back to RESET.
 *
 *   (*) CHECK_STATE, then CHECK_SOFTWARE and UPDATE_SOFTWARE (software.h), stand behind IDENTITY
 *
 *   owner    boot_network
 */
#ifndef CO_MANAGER_BOOT_NODE_H
#define CO_MANAGER_BOOT_NODE_H

#include "base/outbox.h"
#include "manager/boot_failure.h"
#include "manager/event.h"
#include "manager/network_config.h"
#include "manager/sdo_channel.h"
#include "manager/software.h"
#include "manager/supervision.h"
#include "manager/verify.h"
#include "proto/nmt.h"

#define BOOT_READ_TRIES     3u           /* of a read that gets no answer */
#define BOOT_RESTARTS       3u           /* of the node in mid boot: that many are a failure */
#define BOOT_RETRY_INTERVAL CO_MS(1000)  /* CiA 302-2: until the next attempt */
#define BOOT_FLASH_TIMEOUT  CO_MS(10000) /* for objects that make a device write its flash */
#define BOOT_RESTORE_LIMIT  CO_MS(10000) /* for the boot-up message of a device that was restored */

/* Values are those of MCANOPEN_STEP_... */
enum boot_step {
    BOOT_IDLE = 0,
    BOOT_RESET = 1,
    BOOT_DEVICE_TYPE = 2,
    BOOT_IDENTITY = 3,
    BOOT_CHECK_CONFIGURATION = 4,
    BOOT_CONFIGURE = 5,
    BOOT_SAVE = 6,
    BOOT_ERROR_CONTROL = 7,
    BOOT_READY = 8,
    BOOT_STARTED = 9,
    BOOT_RETRY = 10,
    BOOT_FAILED = 11,
    BOOT_CHECK_STATE = 12,    /* of a node to be kept alive, behind IDENTITY */
    BOOT_CHECK_SOFTWARE = 13, /* behind that */
    BOOT_UPDATE_SOFTWARE = 14,
    BOOT_RESTORE = 15 /* between CHECK_CONFIGURATION and CONFIGURE; then RESET, and all anew */
};

/* A node is given its default values once before it boots, however often it has to be tried. */
enum restoring {
    RESTORE_TO_COME,
    RESTORE_ORDERED, /* it was told, and is reset; its boot-up message has not come */
    RESTORE_LATE,    /* ... not even in the boot delay */
    RESTORE_DONE
};

/* A stopped node has no SDO: without heartbeat it looks absent until a reset has reached it. */
enum node_stopped { NODE_NOT_STOPPED, NODE_STOPPED, NODE_STOPPED_AND_RESET };

struct boot_node {
    const struct node_config *config; /* NULL: not in the configuration */
    uint8_t step;                     /* enum boot_step */
    uint8_t nmt_state; /* reported, or assumed without error control; INITIALISING: offline */
    bool tried;        /* one attempt has ended, well or not */
    bool booted;       /* the last attempt ended well */
    bool start_due;    /* to be started as soon as there is room */
    bool reset_due;    /* RESET: the command is still to be sent; else the next attempt begins so */
    bool reset_heard;  /* it has sent a boot-up message since the last reset command ... */
    bool reset_answered; /* its last boot-up message was the one that answers our reset command */
    bool absent;         /* ... and once did not answer since then */
    uint8_t stopped;     /* enum node_stopped */
    bool stopped_meanwhile; /* since the first read of this attempt: its answer may be older */
    bool reset_repeated;    /* because it has missed it; once until it has booted */
    uint8_t unfollowed; /* heartbeats that tell another state than the start command asked for */
    bool state_known;   /* CHECK_STATE: it was reset, it need not be asked again */
    bool unanswered;    /* CHECK_STATE: it may be stopped, because it has not answered before */
    bool kept_alive;    /* it was found operational: not configured, not started */
    bool lost;          /* silent, and left to the application */
    bool held;          /* taken out of operation by the application: only it starts the node */
    bool start_again;   /* it ran when it was to be configured */
    uint8_t reset_command;
    co_us_t deadline;
    unsigned attempts; /* since its last boot, or boot-up message */
    unsigned restarts; /* boot-up messages in mid boot, since its last boot or other failure */
    struct boot_failure failure;
    struct boot_history history;
    struct boot_failure told; /* last failure reported, not to report it again each second */
    struct sdo_request request;
    bool request_due;
    unsigned tries;   /* of the running read */
    uint8_t part;     /* IDENTITY, CHECK_CONFIGURATION: sub-index being read */
    uint8_t value[8]; /* what a read brings, what "save" writes */
    struct ccf_reader reader;
    struct ccf_entry entry; /* being written, or compared before */
    uint32_t entry_number;
    uint32_t written;  /* entries, where they are compared before */
    uint8_t restoring; /* enum restoring */
    bool unsaved;      /* it was written to since it has saved its configuration last */
    struct verify verify;
    struct software_update software;
    struct supervision supervision;
};

void boot_node_init(struct boot_node *self, uint8_t node, const struct node_config *config);

/*
 * True for a node that the master boots: in the list (1F81h bit 0) and not left to the application.
 */
bool boot_node_is_booted_by_master(const struct boot_node *self);

/* True from the first step to the end of its boot, but for an update of its program. */
bool boot_node_is_under_way(const struct boot_node *self);
/* The same, where it must not run yet: it is booted by the master, and not asked for its state. */
bool boot_node_is_in_mid_boot(const struct boot_node *self);
/* It has failed for want of a heartbeat. */
bool boot_node_is_without_heartbeat(const struct boot_node *self);
/* Its configuration is being written. */
bool boot_node_is_written(const struct boot_node *self);
/* How long the device may take for a write to this object. */
co_us_t configure_node_timeout(const struct node_config *config, uint16_t index);
/* What it is reset with, by its configuration. */
enum nmt_command boot_node_reset_command(const struct boot_node *self);

/* A new attempt from the first read on. The owner has taken its request back before. */
void boot_node_begin(struct boot_node *self, co_us_t now, struct co_outbox *out);
/* The same after an NMT reset command to the node and its boot delay. */
void boot_node_reset(struct boot_node *self, enum nmt_command command, co_us_t now,
                     struct co_outbox *out);
/*
 * READY or STARTED: its configuration is written, and its error control begins anew. One that runs
 * becomes pre-operational before; there must be room for that frame.
 */
void boot_node_configure(struct boot_node *self, co_us_t now, struct co_outbox *out);
/* Sends NMT start as soon as there is room; it must be READY or STARTED. */
void boot_node_start(struct boot_node *self, co_us_t now, struct co_outbox *out);
/* It was commanded by a broadcast, or directly by the application, or by another master. */
void boot_node_commanded(struct boot_node *self, enum nmt_command command);
/* Back to IDLE, no error control: the network starts anew. */
void boot_node_stop(struct boot_node *self);

/* Its boot-up message: the owner decides what to do about it. */
void boot_node_on_boot_up(struct boot_node *self, const struct co_frame *frame, co_us_t now,
                          struct co_outbox *out);
/*
 * Behind that, where its boot is to begin anew: false for a node that restarts in mid boot again
 * and again, whose attempt has failed therefore.
 */
bool boot_node_may_begin_anew(struct boot_node *self, co_us_t now, struct co_outbox *out);
/* The same in step UPDATE_SOFTWARE, behind that: the update goes on. */
void software_on_boot_up(struct boot_node *self, co_us_t now, struct co_outbox *out);
void boot_node_on_sdo(struct boot_node *self, co_us_t now, struct co_outbox *out);
void boot_node_on_error_control(struct boot_node *self, const struct co_frame *frame, co_us_t now,
                                struct co_outbox *out);
/* Steps CHECK_STATE and ERROR_CONTROL go on when the node has told its state ... */
void boot_node_on_alive(struct boot_node *self, co_us_t now, struct co_outbox *out);
/* ... and end when it does not. True if that was what the silence means. */
bool boot_node_on_silence(struct boot_node *self, co_us_t now, struct co_outbox *out);
void boot_node_on_time(struct boot_node *self, co_us_t now, struct co_outbox *out);
co_us_t boot_node_deadline(const struct boot_node *self);

#endif
