#include "slave/slave_internal.h"

#define EMCY_OVERRUN   0x8110u
#define EMCY_PASSIVE   0x8120u
#define EMCY_RECOVERED 0x8140u

#define STICKY_CONTROLLER 0x01u /* bits of the second byte of the field */
#define STICKY_LOST       0x02u

#define OVERRUN_PAUSE CO_MS(1000)

static bool is_bus_told(const struct slave_errors *errors)
{
    return errors->bus == errors->told_bus && !errors->outage;
}

/* Nothing can be sent: the emergency comes with the recovery. */
static void lose(struct slave *self, co_us_t now, struct co_outbox *out)
{
    self->errors.outage = false;
    self->errors.told_bus = SLAVE_BUS_LOST;
    self->errors.sticky |= STICKY_CONTROLLER;
    slave_update_error_register(self, now, out);
    slave_enable_emcy(self);
    slave_apply_error_behaviour(self, now, out);
}

static void become_passive(struct slave *self, co_us_t now, struct co_outbox *out)
{
    const struct emcy_message error = { .code = EMCY_PASSIVE, .field = { 0, STICKY_CONTROLLER } };

    self->errors.told_bus = SLAVE_BUS_PASSIVE;
    slave_announce(self, &error, now, out);
}

/* 8140h tells of the error that the loss was, 0000h that there is none any more. */
static void recover(struct slave *self, co_us_t now, struct co_outbox *out)
{
    const struct emcy_message recovered = { .code = EMCY_RECOVERED }, none = { .code = 0 };
    const bool was_lost = self->errors.told_bus == SLAVE_BUS_LOST;

    if (was_lost) {
        slave_announce(self, &recovered, now, out);
        self->errors.told_bus = SLAVE_BUS_OK;
        slave_enable_emcy(self);
    }
    self->errors.told_bus = SLAVE_BUS_OK;
    slave_announce(self, &none, now, out);
}

/* From one state to the next, by way of a loss where there was one. */
static void tell_bus(struct slave *self, co_us_t now, struct co_outbox *out)
{
    const struct slave_errors *errors = &self->errors;

    if (errors->outage || (errors->bus == SLAVE_BUS_LOST && errors->told_bus != SLAVE_BUS_LOST))
        lose(self, now, out);
    else if (errors->told_bus != SLAVE_BUS_OK)
        recover(self, now, out);
    else
        become_passive(self, now, out);
}

static void tell_overrun(struct slave *self, co_us_t now, struct co_outbox *out)
{
    const struct emcy_message error = { .code = EMCY_OVERRUN, .field = { 0, STICKY_LOST } };

    self->errors.overrun_due = false;
    if (!self->errors.overrun)
        slave_raise_fault(self, &error, false, now, out);
    self->errors.overrun = true;
}

static void end_overrun(struct slave *self, co_us_t now, struct co_outbox *out)
{
    self->errors.overrun = false;
    self->errors.overrun_end = CO_NEVER;
    slave_clear_fault(self, now, out);
}

void slave_step_bus(struct slave *self, co_us_t now, struct co_outbox *out)
{
    while (slave_is_on(self) && !is_bus_told(&self->errors) && co_outbox_room(out, 0, 2))
        tell_bus(self, now, out);
    if (slave_is_on(self) && self->errors.overrun_due && co_outbox_room(out, 0, 1))
        tell_overrun(self, now, out);
    if (self->errors.overrun && now >= self->errors.overrun_end && co_outbox_room(out, 0, 1))
        end_overrun(self, now, out);
}

co_us_t slave_bus_deadline(const struct slave *self)
{
    if (slave_is_on(self) && (!is_bus_told(&self->errors) || self->errors.overrun_due))
        return 0;
    return self->errors.overrun ? self->errors.overrun_end : CO_NEVER;
}

void slave_on_bus(struct slave *self, enum slave_bus bus, co_us_t now, struct co_outbox *out)
{
    self->errors.bus = (uint8_t)bus;
    if (bus == SLAVE_BUS_LOST && slave_is_on(self))
        self->errors.outage = self->errors.told_bus != SLAVE_BUS_LOST;
    slave_step_bus(self, now, out);
}

void slave_on_frames_lost(struct slave *self, co_us_t now, struct co_outbox *out)
{
    if (!slave_is_on(self))
        return;
    self->errors.overrun_due = true;
    self->errors.overrun_end = now + OVERRUN_PAUSE;
    slave_step_bus(self, now, out);
}
