/*
 * What checks of several families need beside frames and SDO: states, emergencies, periods.
 */
#ifndef TOOLS_CONFORM_SERVICES_H
#define TOOLS_CONFORM_SERVICES_H

#include "conform.h"

#define STATE_STOPPED     0x04u
#define STATE_OPERATIONAL 0x05u
#define STATE_PREOP       0x7Fu

#define HEARTBEAT_FAST 50u /* ms, of a device whose state is watched */

/*
 * Gives an object the value that a check needs. An object that is read-only, or does not take this
 * value, is not the check's matter: SKIP. It fails when anything else is wrong.
 */
bool conform_set(struct conform *self, uint16_t index, uint8_t sub, uint32_t size, uint64_t number);

/* --- states --- */

uint32_t conform_control_id(const struct conform *self); /* of heartbeat, guarding, boot-up */
/* The device tells its state from now on: by a fast heartbeat, or when it is asked. */
bool conform_watch_state(struct conform *self);
/* The device tells this state, at some time from a frame on. 'when' is for the message. */
bool conform_expect_state(struct conform *self, size_t from, uint8_t state, const char *when);
/* Gives a device whose state is watched the time to come into it, and judges nothing. */
void conform_await_state(struct conform *self, size_t from, uint8_t state);
/* The device tells this state and no other one, more than once from a frame on. */
bool conform_expect_still(struct conform *self, size_t from, uint8_t state, const char *when);
/* NMT command, and the state that it leads to. */
bool conform_go(struct conform *self, uint8_t command, uint8_t state);
const char *conform_state_text(uint8_t state);

/* --- emergencies --- */

#define EMCY_WAIT 1000u /* ms */

/* The identifier of the device's emergencies; else SKIP. */
bool conform_emcy_id(struct conform *self, uint32_t *ret_id);
/* The first emergency with this code from a frame on; it fails without. */
bool conform_expect_emcy(struct conform *self, size_t from, uint16_t code, size_t *ret_at);
/* The same without a judgement; CONFORM_NOTHING: none. */
size_t conform_find_emcy(struct conform *self, size_t from, uint16_t code);
/* None with this code in 'ms'. */
bool conform_expect_no_emcy(struct conform *self, size_t from, uint16_t code, unsigned ms);

/* --- SYNC --- */

size_t conform_send_sync(struct conform *self);

/* --- periods --- */

/*
 * Awaits 'count' frames from now on, and compares the average of the times between them with 'ms'.
 * Fails when it is off by more than a fifth and 5 ms, three times: a machine under load is late,
 * and not on average.
 */
bool conform_expect_period(struct conform *self, uint32_t id, unsigned count, unsigned ms);

#endif
