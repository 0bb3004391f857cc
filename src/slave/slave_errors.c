#include "slave/slave_internal.h"

#include "base/bytes.h"

#include <string.h>

#define ERROR_GENERIC       0x01u /* bits of 1001h */
#define ERROR_COMMUNICATION 0x10u

#define EMCY_MESSAGE_LOST  0x8100u
#define EMCY_ERROR_CONTROL 0x8130u /* a watched node has fallen silent */

#define REASON_QUEUE 1u /* of EMCY_MESSAGE_LOST */

#define TEMPORARY_ERROR_CONTROL 0x01u /* bits of the first byte of the field */
#define TEMPORARY_PASSIVE       0x02u
#define TEMPORARY_BUS_LOST      0x04u
#define STICKY_LOST             0x02u /* of the second one */
#define OF_APPLICATION          0xE0u /* in both of them */

#define SDO_UPLOAD       0x40u /* initiates, without their flags */
#define SDO_BLOCK_UPLOAD 0xA0u

enum error_behaviour { TO_PREOPERATIONAL = 0, NO_CHANGE = 1, TO_STOPPED = 2 };

static bool has_internal_error(const struct slave_errors *errors)
{
    return errors->lost > 0 || errors->faults > 0 || errors->told_bus != SLAVE_BUS_OK;
}

/* True if it has changed. */
static bool set_error_register(struct slave *self)
{
    const struct slave_errors *errors = &self->errors;
    const uint64_t before = od_number(self->od, 0x1001, 0, 0);
    unsigned bits = errors->raised;

    if (has_internal_error(errors))
        bits |= ERROR_COMMUNICATION;
    if (bits != 0 || errors->application > 0)
        bits |= ERROR_GENERIC;
    od_set_number(self->od, 0x1001, 0, bits);
    return bits != before;
}

static void send_error_register(struct slave *self, co_us_t now, struct co_outbox *out)
{
    const struct od_entry *entry = od_find(self->od, 0x1001, 0);

    if (entry->map_count > 0)
        slave_mapped_changed(self, entry, now, out);
}

void slave_update_error_register(struct slave *self, co_us_t now, struct co_outbox *out)
{
    if (set_error_register(self))
        send_error_register(self, now, out);
}

uint8_t slave_highest_sub(const struct od *od, uint16_t index, uint8_t limit)
{
    for (uint8_t sub = limit; sub > 0; sub--)
        if (od_find(od, index, sub) != NULL)
            return sub;
    return 0;
}

static void record_error(struct od *od, uint16_t code, uint16_t info)
{
    const uint8_t capacity = slave_highest_sub(od, 0x1003, 254);
    const uint64_t recorded = od_number(od, 0x1003, 0, 0);
    uint8_t count = recorded < capacity ? (uint8_t)(recorded + 1) : capacity;

    if (capacity == 0)
        return;
    for (uint8_t sub = count; sub > 1; sub--)
        od_set_number(od, 0x1003, sub, od_number(od, 0x1003, (uint8_t)(sub - 1), 0));
    od_set_number(od, 0x1003, 1, (uint32_t)info << 16 | code);
    od_set_number(od, 0x1003, 0, count);
}

/*
 * One emergency for what has just changed; there is room for the event, which PDOs with 1001h that
 * have something to tell would take.
 */
static void send(struct slave *self, const struct slave_error *error, co_us_t now,
                 struct co_outbox *out)
{
    struct emcy_message message = { .code = error->code };
    struct co_event event = { .type = SLAVE_EMERGENCY, .node = self->node, .code = error->code };
    const bool changed = set_error_register(self);

    message.error_register = (uint8_t)od_number(self->od, 0x1001, 0, 0);
    memcpy(message.field, error->field, sizeof message.field);
    if (error->code != 0)
        record_error(self->od, error->code, error->info);
    event.detail = message.error_register;
    put_le16(event.data, message.code);
    event.data[2] = message.error_register;
    memcpy(event.data + 3, message.field, sizeof message.field);
    co_outbox_put_event(out, &event);
    if (changed)
        send_error_register(self, now, out);
    emcy_producer_raise(&self->emcy, &message);
    slave_step_emcy(self, now, out);
}

/* ---- errors of the application ---- */

enum co_err slave_raise_error(struct slave *self, const struct slave_error *error, co_us_t now,
                              struct co_outbox *out)
{
    struct slave_errors *errors = &self->errors;

    if (!co_outbox_room(out, 0, 1))
        return CO_ERR_AGAIN;
    errors->application++;
    errors->raised |= error->error_register;
    errors->temporary |= error->field[0] & OF_APPLICATION;
    errors->sticky |= error->field[1] & OF_APPLICATION;
    send(self, error, now, out);
    return CO_OK;
}

enum co_err slave_clear_error(struct slave *self, uint8_t bits, const uint8_t field[5], co_us_t now,
                              struct co_outbox *out)
{
    struct slave_errors *errors = &self->errors;
    struct slave_error none = { .code = 0 };

    if (errors->application == 0)
        return CO_ERR_STATE;
    if (!co_outbox_room(out, 0, 1))
        return CO_ERR_AGAIN;
    memcpy(none.field, field, sizeof none.field);
    errors->application--;
    errors->raised &= errors->application > 0 ? (uint8_t)~bits : 0;
    errors->temporary &= errors->application > 0 ? field[0] : 0;
    errors->sticky |= field[1] & OF_APPLICATION;
    send(self, &none, now, out);
    return CO_OK;
}

/* ---- errors of the device itself ---- */

static uint8_t temporary_bits(const struct slave_errors *errors)
{
    unsigned bits = errors->temporary;

    if (errors->lost > 0)
        bits |= TEMPORARY_ERROR_CONTROL;
    if (errors->told_bus == SLAVE_BUS_PASSIVE)
        bits |= TEMPORARY_PASSIVE;
    if (errors->told_bus == SLAVE_BUS_LOST)
        bits |= TEMPORARY_BUS_LOST;
    return (uint8_t)bits;
}

void slave_announce(struct slave *self, const struct emcy_message *error, co_us_t now,
                    struct co_outbox *out)
{
    struct slave_error own = { .code = error->code };

    self->errors.sticky |= error->field[1];
    memcpy(own.field, error->field, sizeof own.field);
    own.field[0] = temporary_bits(&self->errors);
    own.field[1] = self->errors.sticky;
    own.info = get_le16(own.field);
    send(self, &own, now, out);
}

static void announce_end(struct slave *self, co_us_t now, struct co_outbox *out)
{
    const struct emcy_message none = { .code = 0 };

    slave_announce(self, &none, now, out);
}

void slave_raise_fault(struct slave *self, const struct emcy_message *error, bool again,
                       co_us_t now, struct co_outbox *out)
{
    if (!again)
        self->errors.faults++;
    slave_announce(self, error, now, out);
}

void slave_clear_fault(struct slave *self, co_us_t now, struct co_outbox *out)
{
    self->errors.faults--;
    announce_end(self, now, out);
}

void slave_apply_error_behaviour(struct slave *self, co_us_t now, struct co_outbox *out)
{
    switch (od_number(self->od, 0x1029, 1, TO_PREOPERATIONAL)) {
    case TO_PREOPERATIONAL:
        if (self->state == NMT_OPERATIONAL)
            slave_enter_state(self, NMT_PREOPERATIONAL, now, out);
        break;
    case TO_STOPPED:
        if (self->state != NMT_STOPPED)
            slave_enter_state(self, NMT_STOPPED, now, out);
        break;
    default: break;
    }
}

void slave_error_control_lost(struct slave *self, co_us_t now, struct co_outbox *out)
{
    const struct emcy_message error = { .code = EMCY_ERROR_CONTROL };

    self->errors.lost++;
    slave_announce(self, &error, now, out);
    slave_apply_error_behaviour(self, now, out);
}

void slave_error_control_back(struct slave *self, co_us_t now, struct co_outbox *out)
{
    self->errors.lost--;
    announce_end(self, now, out);
}

enum co_err slave_lose_pdos(struct slave *self, unsigned count, co_us_t now, struct co_outbox *out)
{
    const struct emcy_message error = {
        .code = EMCY_MESSAGE_LOST,
        .field = { 0, STICKY_LOST, REASON_QUEUE, (uint8_t)(count < UINT8_MAX ? count : UINT8_MAX) }
    };

    if (!co_outbox_room(out, 0, 1))
        return CO_ERR_AGAIN;
    slave_raise_fault(self, &error, self->errors.pdos_lost, now, out);
    self->errors.pdos_lost = true;
    return CO_OK;
}

enum co_err slave_pdos_taken(struct slave *self, co_us_t now, struct co_outbox *out)
{
    if (!self->errors.pdos_lost)
        return CO_OK;
    if (!co_outbox_room(out, 0, 1))
        return CO_ERR_AGAIN;
    self->errors.pdos_lost = false;
    slave_clear_fault(self, now, out);
    return CO_OK;
}

bool slave_history_lacks(const struct slave *self, const struct co_frame *request)
{
    const uint8_t *data = request->data;
    const bool upload = (data[0] & 0xE0u) == SDO_UPLOAD || (data[0] & 0xE3u) == SDO_BLOCK_UPLOAD;

    return request->dlc == 8 && (request->flags & CO_FRAME_RTR) == 0 && upload &&
           get_le16(data + 1) == 0x1003 && od_find(self->od, 0x1003, data[3]) != NULL &&
           data[3] > od_number(self->od, 0x1003, 0, UINT8_MAX);
}

/* ---- emergencies on their way ---- */

void slave_configure_emcy(struct slave *self)
{
    const uint32_t cob_id = (uint32_t)od_number(self->od, 0x1014, 0, COB_ID_INVALID);
    const co_us_t inhibit = od_number(self->od, 0x1015, 0, 0) * 100;

    emcy_producer_configure(&self->emcy, cob_id, inhibit);
}

void slave_enable_emcy(struct slave *self)
{
    const bool services = self->state == NMT_PREOPERATIONAL || self->state == NMT_OPERATIONAL;

    emcy_producer_enable(&self->emcy, services && self->errors.told_bus != SLAVE_BUS_LOST);
}

/* The first one is told at once, those after it together, when the queue has room again. */
static bool is_loss_due(const struct slave *self)
{
    return self->emcy.lost > 0 &&
           (!self->errors.emcy_lost_told || !emcy_producer_is_full(&self->emcy));
}

static void tell_lost(struct slave *self, struct co_outbox *out)
{
    const struct co_event event = { .type = SLAVE_EMCY_LOST,
                                    .node = self->node,
                                    .actual = self->emcy.lost };

    if (is_loss_due(self) && co_outbox_room(out, 0, 1)) {
        co_outbox_put_event(out, &event);
        self->emcy.lost = 0;
        self->errors.emcy_lost_told = true;
    }
    if (!emcy_producer_is_full(&self->emcy) && self->emcy.lost == 0)
        self->errors.emcy_lost_told = false;
}

void slave_step_emcy(struct slave *self, co_us_t now, struct co_outbox *out)
{
    emcy_producer_on_time(&self->emcy, now, out);
    tell_lost(self, out);
}

co_us_t slave_emcy_deadline(const struct slave *self)
{
    return is_loss_due(self) ? 0 : emcy_producer_deadline(&self->emcy);
}

void slave_reset_errors(struct slave *self)
{
    const uint8_t bus = self->errors.bus;

    self->errors = (struct slave_errors){ .bus = bus, .overrun_end = CO_NEVER };
    self->sync_heard.wrong = false;
    self->told_sync_wrong = false;
    od_set_number(self->od, 0x1001, 0, 0);
    od_set_number(self->od, 0x1003, 0, 0);
    emcy_producer_init(&self->emcy, COB_ID_INVALID);
    slave_configure_emcy(self);
}
