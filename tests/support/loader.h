/*
 * A device with a boot loader for scenario tests: a node of a plant, with 1F50h, 1F51h, 1F56h and
 * 1F57h, whose behaviour the test sets. Where a test has a single one, that is node 5, made by
 * loader_make() and run by loader_run(); else it calls loader_step() and loader_hear().
 */
#ifndef TEST_SUPPORT_LOADER_H
#define TEST_SUPPORT_LOADER_H

#include "support/plant.h"

#define LOADER_OLD  0x11u /* what the device has in 1F56h:01 ... */
#define LOADER_NEW  0x22u /* ... and should have */
#define LOADER_SIZE 2000u /* of the program */

/* Elements of a node whose program is to be the new one; and may be replaced. */
#define LOADER_VERIFY                                                                              \
    "<NMT_Verify_Software>TRUE</NMT_Verify_Software>"                                              \
    "<Software_Identification>0x22</Software_Identification>"
#define LOADER_UPDATE LOADER_VERIFY "<NMT_Allow_Software_Update>TRUE</NMT_Allow_Software_Update>"

/* The boot loader: how it behaves, and how it stands. */
struct loader {
    struct plant *plant;
    uint8_t node;
    unsigned off_at_stop, off_at_start; /* ms that it is gone; 0: it stays */
    unsigned clear_ms, write_ms;        /* its flash is busy */
    uint32_t cleared, written;          /* 1F57h after that */
    uint32_t written_id;                /* 1F56h; 0: what the program says */
    bool deaf;                          /* it takes no commands */
    unsigned die_in_write;              /* segments after which it restarts, the next time */
    bool running;
    uint32_t id, flash, next_flash;
    co_us_t busy_until, back_at;
    uint8_t commands[8]; /* taken from the bus, not yet followed */
    unsigned command_count;
    unsigned segments, programs;
};

/* Makes the device one that has its old program, and gives the configuration the new one. */
void loader_attach(struct loader *self, struct plant *plant, uint8_t node);
/* What it does as time goes on: every few ms. */
void loader_step(struct loader *self);
/* Each frame to it, from plant.on_delivered or fault. */
void loader_hear(struct loader *self, const struct co_frame *frame);

/* A plant with node 5 alone, which has these elements; powered on. */
void loader_make(struct loader *self, const char *node);
void loader_run(struct loader *self, unsigned ms);
/* Until the text was said; the test fails when the time is over. */
void loader_run_until(struct loader *self, const char *said, unsigned ms);
/* It is gone for so long, and then sends its boot-up message; 0: nothing happens. */
void loader_restart(struct loader *self, unsigned ms);
/* It follows this though it has not answered to it. */
void loader_follow(struct loader *self, uint8_t command);
/* It is operational, and has its program and its configuration. */
void loader_expect_updated(struct loader *self, const char *what);
/* Its boot has ended, and this was said once. */
void loader_expect_failed(struct loader *self, const char *said);

#endif
