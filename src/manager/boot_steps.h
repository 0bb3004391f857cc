/*
 * What the parts of a node's boot machine share: boot_node.c, boot_node_alive.c,
 * configure_node.c, software.c; nobody else.
 */
#ifndef CO_MANAGER_BOOT_STEPS_H
#define CO_MANAGER_BOOT_STEPS_H

#include "manager/boot_node.h"

/* boot_node.c: entering a step, its requests, and the ends of an attempt */
void boot_node_enter(struct boot_node *self, enum boot_step step, struct co_outbox *out);
void boot_node_put_event(const struct boot_node *self, struct co_event event,
                         struct co_outbox *out);
void boot_node_want(struct boot_node *self, const struct sdo_transfer *transfer);
void boot_node_read(struct boot_node *self, uint16_t index, uint8_t sub);
/* Where the value may have more than 8 bytes. */
void boot_node_read_into(struct boot_node *self, uint16_t index, uint8_t sub, uint8_t *buffer,
                         uint32_t size);
/* What the last read has brought; the event for it. */
uint32_t boot_node_number_read(const struct boot_node *self);
void boot_node_tell_read(const struct boot_node *self, struct co_outbox *out);
void boot_node_fail(struct boot_node *self, const struct boot_failure *failure, co_us_t now,
                    struct co_outbox *out);
/* For what its last request has ended with. */
void boot_node_fail_request(struct boot_node *self, char letter, co_us_t now,
                            struct co_outbox *out);
/* It has booted. */
void boot_node_succeed(struct boot_node *self, co_us_t now, struct co_outbox *out);
/* CHECK_STATE: it has told. */
void boot_node_on_state_known(struct boot_node *self, co_us_t now, struct co_outbox *out);
/* ... or has not, after it has not answered to the first read either. */
void boot_node_fail_unanswered(struct boot_node *self, co_us_t now, struct co_outbox *out);
void boot_node_enter_error_control(struct boot_node *self, co_us_t now, struct co_outbox *out);

/* configure_node.c: CHECK_CONFIGURATION, CONFIGURE and SAVE (CiA 302-3); on to error control */
void configure_node_enter(struct boot_node *self, co_us_t now, struct co_outbox *out);
void configure_node_on_check(struct boot_node *self, bool ok, co_us_t now, struct co_outbox *out);
/* The boot delay after a reset is over. */
void configure_node_on_restart(struct boot_node *self, co_us_t now, struct co_outbox *out);
void configure_node_on_done(struct boot_node *self, bool ok, co_us_t now, struct co_outbox *out);

/* software.c: CHECK_SOFTWARE, on to the configuration, and UPDATE_SOFTWARE, on to a new boot */
void software_enter(struct boot_node *self, co_us_t now, struct co_outbox *out);
void software_on_check(struct boot_node *self, bool ok, co_us_t now, struct co_outbox *out);
void software_on_update(struct boot_node *self, bool ok, co_us_t now, struct co_outbox *out);
void software_on_time(struct boot_node *self);

#endif
