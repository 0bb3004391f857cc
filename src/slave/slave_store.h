/*
 * Power-on values of a local device that its owner keeps (1010h "save", 1011h "load").
 *
 * Without an owner who keeps them the device executes both itself, in its dictionary alone. An
 * owner who does is asked (1010h and 1011h watched: SLAVE_VERDICT), and goes on in two steps:
 *
 *   slave_begin_store()   -> image: all power-on values that will differ from the DefaultValues
 *   ... the owner writes the image, which may take SLAVE_STORE_TIME ...
 *   slave_end_store()     they are the power-on values; then slave_verdict(SLAVE_DONE)
 *
 * A "load" waits for the reset in the device, but not in the image: what is switched off and on has
 * the DefaultValues. slave_recall_image() takes an image back, before the device is made.
 *
 *   owner    as the device
 *   locking  none; the owner's
 */
#ifndef CO_SLAVE_SLAVE_STORE_H
#define CO_SLAVE_SLAVE_STORE_H

#include "dcf/ccf.h"
#include "od/od_store.h"
#include "slave/slave.h"

#define SLAVE_STORE_TIME CO_MS(10000)

/* A verdict: the command was executed, only the answer is due. No handler can return it. */
#define SLAVE_DONE 0xFFFFFFFFu

/* A command whose effect is prepared. */
struct slave_store {
    bool save;           /* or load */
    uint8_t group;       /* sub-index of the groups that CiA 301 names: 1..4 */
    struct od_plan plan; /* "save": the new power-on values */
    unsigned changes;    /* of the device, up to then */
    struct ccf image;
};

/* The entry is one of 1010:1.., 1011:1... */
bool slave_is_store_entry(const struct od_entry *entry);
/*
 * The client's command; the client waits up to SLAVE_STORE_TIME from now on.
 *
 *   CO_ERR_STATE   it waits no more
 *   CO_ERR_MEMORY
 *   CO_ERR_VALUE   a string does not fit into the memory that it has after a reset
 */
enum co_err slave_begin_store(struct slave *self, struct slave_transfer transfer, co_us_t now,
                              struct slave_store *ret_store);
/* Executes it, whether the client still waits or not. */
void slave_end_store(struct slave *self, struct slave_store *store);
void slave_free_store(struct slave_store *store);

/*
 * All parameters get their DefaultValues, then those in the image the values there, as power-on
 * values and as present ones. What does not fit is left out and told. CO_ERR_MEMORY: nothing was
 * changed. 'image' may be NULL.
 */
enum co_err slave_recall_image(struct od *od, const struct ccf *image, struct co_report *report);

#endif
