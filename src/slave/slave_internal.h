/*
 * What the files of slave/ share: slave.c is the NMT machine, the others are its objects.
 */
#ifndef CO_SLAVE_SLAVE_INTERNAL_H
#define CO_SLAVE_SLAVE_INTERNAL_H

#include "slave/slave.h"

#define COB_ID_INVALID 0x80000000u /* of most communication objects; not of SYNC and TIME */
#define COB_ID_BIT30   0x40000000u /* its meaning depends on the object */
#define COB_ID_EXT     0x20000000u /* 29-bit identifier */

#define FIRST_RPDO_OBJECT  0x1400u
#define FIRST_RPDO_MAPPING 0x1600u
#define FIRST_TPDO_OBJECT  0x1800u
#define FIRST_TPDO_MAPPING 0x1A00u
#define LAST_TPDO_OBJECT   0x1BFFu

#define LAST_COMMUNICATION_OBJECT 0x1FFFu

/* A value that a client wants to write, after the checks of the SDO server. */
struct slave_write {
    const struct od *od;
    struct od_entry *entry;
    const uint8_t *value;
    uint32_t size;
    uint64_t number;  /* the value as one */
    bool assume_sync; /* as in struct slave */
};

/* slave_objects.c: the rules of the communication objects. */
bool slave_is_default(const struct od_entry *entry, const uint8_t *value, uint32_t size);
sdo_abort_t slave_check_write(const struct slave_write *write);
/* slave_cob_ids.c: another communication object of the device uses the CAN-ID in it. */
bool slave_can_id_is_taken(const struct slave_write *write);
/* It holds no COB-ID in use, or one that a client might give it on a device with nothing else. */
bool slave_is_permitted(const struct od_entry *entry, uint32_t cob_id);
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
/* What "load" has ordered, without waiting for the reset any longer. */
void slave_execute_loads(struct slave *self);

/* slave_errors.c: the error state, 1001h, 1003h, 1014h, 1015h, 1029h. */
/* Free of errors, and all parameters anew. */
void slave_reset_errors(struct slave *self);
void slave_configure_emcy(struct slave *self);
/* The NMT state and the bus let emergencies out; else they wait. */
void slave_enable_emcy(struct slave *self);
void slave_step_emcy(struct slave *self, co_us_t now, struct co_outbox *out);
co_us_t slave_emcy_deadline(const struct slave *self);
/* The master or a watched node is silent: emergency, and what 1029h says. Room: 2 events. */
void slave_error_control_lost(struct slave *self, co_us_t now, struct co_outbox *out);
void slave_error_control_back(struct slave *self, co_us_t now, struct co_outbox *out);
/* What 1029h says. */
void slave_apply_error_behaviour(struct slave *self, co_us_t now, struct co_outbox *out);
/*
 * Something of the device's communication is wrong (instead: 'again', it was already, in another
 * way), or right again. The second byte of the field has the sticky bits of it. Room: 1 event.
 */
void slave_raise_fault(struct slave *self, const struct emcy_message *error, bool again,
                       co_us_t now, struct co_outbox *out);
void slave_clear_fault(struct slave *self, co_us_t now, struct co_outbox *out);
/* An emergency of the device itself for what has just changed. Room: 1 event. */
void slave_announce(struct slave *self, const struct emcy_message *error, co_us_t now,
                    struct co_outbox *out);
/* 1001h, and the PDOs that map it. */
void slave_update_error_register(struct slave *self, co_us_t now, struct co_outbox *out);
/* Errors that 1003h does not have are no data, which the dictionary cannot say. */
bool slave_history_lacks(const struct slave *self, const struct co_frame *request);
uint8_t slave_highest_sub(const struct od *od, uint16_t index, uint8_t limit);

/* slave_bus.c: what the state of the bus means to it. */
void slave_step_bus(struct slave *self, co_us_t now, struct co_outbox *out);
co_us_t slave_bus_deadline(const struct slave *self);

/* slave_heartbeat.c: 1016h. */
enum co_err slave_make_consumers(struct slave *self);
void slave_reset_consumers(struct slave *self);
void slave_configure_consumer(struct slave *self, uint8_t sub);
void slave_consume_heartbeat(struct slave *self, const struct co_frame *frame, co_us_t now,
                             struct co_outbox *out);
void slave_watch_consumers(struct slave *self, co_us_t now, struct co_outbox *out);
/* The node that sub-index i+1 of 1016h watches; 0: none. */
uint8_t slave_consumer_node(const struct slave *self, unsigned i);

/* slave_emcy.c: 1028h. */
enum co_err slave_make_hearing(struct slave *self);
void slave_configure_hearing(struct slave *self);
void slave_hear_emcy(struct slave *self, const struct co_frame *frame, co_us_t now,
                     struct co_outbox *out);
/* With COB_ID_EXT where it has 29 bits; i < heard_count. */
uint32_t slave_heard_can_id(const struct slave *self, unsigned i);

/* slave_guarding.c: 100Ch, 100Dh. The life time runs from the first request on. */
void slave_reset_guarding(struct slave *self);
void slave_answer_guarding(struct slave *self, const struct co_frame *request, co_us_t now,
                           struct co_outbox *out);
void slave_watch_guarding(struct slave *self, co_us_t now, struct co_outbox *out);
co_us_t slave_guarding_deadline(const struct slave *self);
/*
 * A heartbeat of its own takes the place of guarding, and without a life time there is none to
 * watch: that ends life guarding at once. Another life time counts from the next request on. Room:
 * 1 event.
 */
void slave_configure_guarding(struct slave *self, co_us_t now, struct co_outbox *out);

/* The CAN-ID of a COB-ID, with COB_ID_EXT where it has 29 bits. */
uint32_t slave_can_id(uint32_t cob_id);

/* slave_servers.c: the SDO channels. */
enum co_err slave_make_channels(struct slave *self);
void slave_free_channels(struct slave *self);
void slave_enable_channels(struct slave *self, bool enabled);
/* False: there is no memory. */
bool slave_give_buffer(const struct slave *self, struct slave_channel *channel);
/* What 1201h.. say: of all of them, and of one. Another CAN-ID ends the channel's transfer. */
void slave_configure_channels(struct slave *self);
void slave_configure_channel(struct slave *self, uint16_t index);
bool slave_is_additional_server(uint16_t index);
/* The channel whose clients' requests have this CAN-ID, or NULL. */
struct slave_channel *slave_channel_of(const struct slave *self, uint32_t can_id);

/* slave_sdo.c: what an SDO server does, and what its writes mean. */
co_us_t slave_heartbeat_period(const struct slave *self);
/* What a new value of a communication object changes besides the dictionary. */
void slave_take_over(struct slave *self, uint16_t index, uint8_t sub, co_us_t now,
                     struct co_outbox *out);
void slave_serve(struct slave *self, struct slave_channel *channel, const struct co_frame *request,
                 co_us_t now, struct co_outbox *out);
void slave_step_sdo(struct slave *self, co_us_t now, struct co_outbox *out);
co_us_t slave_sdo_deadline(const struct slave *self);

/* Which TPDO maps an entry. */
struct slave_mapped {
    const struct od_entry *entry;
    uint16_t tpdo; /* its place in slave_pdos.tpdos */
};

/* The PDOs of a device. Slots number the RPDOs and, behind them, the TPDOs. */
struct slave_pdos {
    struct rpdo *rpdos; /* by number, which may have gaps */
    struct tpdo *tpdos;
    unsigned rpdo_count, tpdo_count;
    struct pdo_field *fields; /* of all mappings */
    uint16_t *first;          /* by a CAN-ID's low bits: slot + 1 of a valid PDO; 0: none */
    uint16_t *next;           /* by slot: the next one with the same low bits */
    struct slave_mapped *mapped;
    unsigned mapped_count;
    bool mapped_stale; /* a mapping has changed since */
    bool hold;
    bool running;     /* NMT state operational */
    co_us_t deadline; /* none of the PDOs has an earlier one */
};

/* slave_pdo_table.c: the PDOs that there are, their parameters and mappings. */
enum co_err slave_make_pdos(struct slave *self);
void slave_free_pdos(struct slave *self);
/* All parameters anew, no faults. */
void slave_reset_pdos(struct slave *self, co_us_t now);
void slave_configure_pdo(struct slave *self, uint16_t index, uint8_t sub, co_us_t now,
                         struct co_outbox *out);
/* Slot + 1 of the first valid PDO that may have this identifier; 0: none. */
unsigned slave_first_slot(const struct slave_pdos *pdos, uint32_t can_id);
/* Those that map an entry, from the place returned up to another entry or the end of 'mapped'. */
const struct slave_mapped *slave_tpdos_of(struct slave_pdos *pdos, const struct od_entry *entry);
bool slave_has_synchronous_pdo(const struct slave *self);

/* slave_pdo.c: what they do. */
void slave_run_pdos(struct slave *self, bool run, co_us_t now, struct co_outbox *out);
void slave_step_tpdo(struct slave *self, struct tpdo *tpdo, co_us_t now, struct co_outbox *out);
void slave_step_rpdo(struct slave *self, struct rpdo *rpdo, co_us_t now, struct co_outbox *out);
/* What is due. */
void slave_step_pdos(struct slave *self, co_us_t now, struct co_outbox *out);
co_us_t slave_pdo_deadline(const struct slave *self);
void slave_hear_pdo(struct slave *self, const struct co_frame *frame, co_us_t now,
                    struct co_outbox *out);
void slave_sync_pdos(struct slave *self, const struct tpdo_sync *sync, co_us_t now,
                     struct co_outbox *out);
enum co_err slave_mapped_changed(struct slave *self, const struct od_entry *entry, co_us_t now,
                                 struct co_outbox *out);

/* slave_sync.c: 1005h, 1006h, 1007h, 1019h. */
/* Those that are taken over; the window is looked up with each SYNC. */
bool slave_is_sync_object(uint16_t index);
void slave_configure_sync(struct slave *self);
void slave_enable_sync(struct slave *self, bool enabled);
/* PDOs have changed: does anything depend on SYNC? */
void slave_update_sync_consumer(struct slave *self);
/* False: it is none, or nothing to this device. */
bool slave_hear_sync(struct slave *self, const struct co_frame *frame, co_us_t now,
                     struct co_outbox *out);
void slave_step_sync(struct slave *self, co_us_t now, struct co_outbox *out);
co_us_t slave_sync_deadline(const struct slave *self);

/* slave_time.c: 1012h. */
void slave_configure_time(struct slave *self);
/* False: it is none, or nothing to this device. */
bool slave_hear_time(struct slave *self, const struct co_frame *frame, struct co_outbox *out);

/* slave.c */
/* Switched on and not initialising. */
bool slave_is_on(const struct slave *self);
void slave_enter_state(struct slave *self, enum nmt_state state, co_us_t now,
                       struct co_outbox *out);

#endif
