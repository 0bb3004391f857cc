/*
 * What the files of slave/ share: slave.c is the NMT machine, the others are its objects.
 */
#ifndef CO_SLAVE_SLAVE_INTERNAL_H
#define CO_SLAVE_SLAVE_INTERNAL_H

#include "slave/slave.h"

#define COB_ID_INVALID 0x80000000u /* of most communication objects; not of SYNC and TIME */
#define COB_ID_BIT30   0x40000000u /* its meaning depends on the object */

#define LAST_COMMUNICATION_OBJECT 0x1FFFu

/* A value that a client wants to write, after the checks of the SDO server. */
struct slave_write {
    const struct od *od;
    struct od_entry *entry;
    const uint8_t *value;
    uint32_t size;
    uint64_t number; /* the value as one */
};

/* slave_objects.c: the rules of the communication objects. */
bool slave_is_default(const struct od_entry *entry, const uint8_t *value, uint32_t size);
sdo_abort_t slave_check_write(const struct slave_write *write);
/* slave_mapping.c: those of 1600h.. and 1A00h... */
sdo_abort_t slave_check_mapping(const struct slave_write *write);

/* slave_store.c: 1010h, 1011h, 1020h. */
bool slave_is_store_command(const struct slave_write *write);
/* "save" or "load", whose signature is checked already. */
sdo_abort_t slave_execute_store(struct slave *self, const struct slave_write *write);
/* Before a value is set: if it differs, the stored configuration is no longer the verified one. */
void slave_note_change(struct slave *self, const struct slave_write *write);
/* Power-on values, of all objects or only of 1000h..1FFFh. */
void slave_reset_objects(struct slave *self, bool application);
void slave_free_factory(struct slave *self);

/* slave_errors.c: 1001h, 1003h, 1014h, 1015h, 1016h, 1029h. */
enum co_err slave_make_consumers(struct slave *self);
/* Error free, and all parameters anew. */
void slave_reset_errors(struct slave *self);
void slave_configure_emcy(struct slave *self);
void slave_configure_consumer(struct slave *self, uint8_t sub);
void slave_consume_heartbeat(struct slave *self, const struct co_frame *frame, co_us_t now,
                             struct co_outbox *out);
void slave_watch_consumers(struct slave *self, co_us_t now, struct co_outbox *out);
/* The master or a watched node is silent: emergency, and what 1029h says. Room: 2 events. */
void slave_error_control_lost(struct slave *self, co_us_t now, struct co_outbox *out);
void slave_error_control_back(struct slave *self, co_us_t now, struct co_outbox *out);
/* Errors that 1003h does not have are no data, which the dictionary cannot say. */
bool slave_history_lacks(const struct slave *self, const struct co_frame *request);

/* slave_guarding.c: 100Ch, 100Dh. The life time runs from the first request on. */
void slave_reset_guarding(struct slave *self);
void slave_answer_guarding(struct slave *self, const struct co_frame *request, co_us_t now,
                           struct co_outbox *out);
void slave_watch_guarding(struct slave *self, co_us_t now, struct co_outbox *out);
/*
 * A heartbeat of its own takes the place of guarding, and without a life time there is none to
 * watch: that ends life guarding at once. Another life time counts from the next request on. Room:
 * 1 event.
 */
void slave_configure_guarding(struct slave *self, co_us_t now, struct co_outbox *out);

/* slave.c */
void slave_enter_state(struct slave *self, enum nmt_state state, struct co_outbox *out);

#endif
