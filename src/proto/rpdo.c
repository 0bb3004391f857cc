#include "proto/rpdo.h"

#include "proto/event.h"

#include <string.h>

#define COB_ID_INVALID 0x80000000u
#define COB_ID_EXT     0x20000000u

void rpdo_init(struct rpdo *self, uint16_t number, struct pdo_field *fields, uint8_t room)
{
    *self = (struct rpdo){ .cob_id = COB_ID_INVALID, .number = number, .deadline = CO_NEVER };
    pdo_map_init(&self->map, fields, room);
}

static void drop(struct rpdo *self)
{
    self->waiting = false;
    self->due = false;
}

static void begin(struct rpdo *self)
{
    drop(self);
    self->fault = 0;
    self->deadline = CO_NEVER;
}

bool rpdo_is_valid(const struct rpdo *self)
{
    return (self->cob_id & COB_ID_INVALID) == 0;
}

void rpdo_configure(struct rpdo *self, const struct rpdo_parameters *parameters)
{
    if (self->cob_id != parameters->cob_id)
        begin(self);
    if (self->type != parameters->type)
        drop(self);
    if (self->timeout != parameters->timeout)
        self->deadline = CO_NEVER;
    self->cob_id = parameters->cob_id;
    self->type = parameters->type;
    self->timeout = parameters->timeout;
}

void rpdo_remapped(struct rpdo *self)
{
    begin(self);
    self->generation++;
}

void rpdo_start(struct rpdo *self)
{
    begin(self);
    self->running = true;
}

void rpdo_stop(struct rpdo *self)
{
    drop(self);
    self->deadline = CO_NEVER;
    self->running = false;
}

void rpdo_reset(struct rpdo *self)
{
    rpdo_stop(self);
    self->fault = 0;
    self->told_fault = 0;
}

static bool take_over(struct rpdo *self, struct co_outbox *out)
{
    struct co_event event = { .type = PROTO_RPDO,
                              .index = self->number,
                              .sub = pdo_map_size(&self->map),
                              .code = self->generation,
                              .actual = self->next_at };
    const bool tells = self->notify || self->waiters > 0;

    if (tells && !co_outbox_room(out, 0, 1))
        return false;
    memcpy(self->data, self->next, sizeof self->data);
    self->dlc = event.sub;
    self->changed |= pdo_map_write(&self->map, self->data);
    self->received++;
    drop(self);
    if (!tells)
        return true;
    memcpy(event.data, self->data, sizeof event.data);
    co_outbox_put_event(out, &event);
    return true;
}

static void tell_fault(struct rpdo *self, struct co_outbox *out)
{
    const struct co_event event = { .type = PROTO_RPDO_FAULT,
                                    .detail = self->wrong_size,
                                    .index = self->number,
                                    .sub = pdo_map_size(&self->map),
                                    .code = self->fault,
                                    .expected = self->told_fault };

    if (self->fault == self->told_fault || !co_outbox_room(out, 0, 1))
        return;
    co_outbox_put_event(out, &event);
    self->told_fault = self->fault;
}

static void refuse(struct rpdo *self, uint16_t fault, uint8_t size)
{
    self->fault = fault;
    self->wrong_size = size;
    self->errors++;
}

static void accept(struct rpdo *self, const struct co_frame *frame, co_us_t now)
{
    const uint8_t size = pdo_map_size(&self->map);

    if (self->waiting)
        self->replaced++;
    memset(self->next, 0, sizeof self->next);
    memcpy(self->next, frame->data, size);
    self->next_at = now;
    self->waiting = true;
    self->due = self->due || self->type > RPDO_SYNC_TYPE_MAX;
    self->fault = 0;
    self->deadline = self->timeout > 0 ? now + self->timeout : CO_NEVER;
}

static bool listens(const struct rpdo *self)
{
    return self->running && rpdo_is_valid(self) && self->map.count > 0;
}

void rpdo_on_frame(struct rpdo *self, const struct co_frame *frame, bool accept_long, co_us_t now,
                   struct co_outbox *out)
{
    const uint8_t size = pdo_map_size(&self->map);

    if (!listens(self))
        return;
    if (frame->dlc < size)
        refuse(self, RPDO_FAULT_SHORT, frame->dlc);
    else if (frame->dlc > size && !accept_long)
        refuse(self, RPDO_FAULT_LONG, frame->dlc);
    else
        accept(self, frame, now);
    rpdo_on_time(self, now, out);
}

void rpdo_discard(struct rpdo *self)
{
    if (listens(self))
        self->discarded++;
}

void rpdo_on_sync(struct rpdo *self)
{
    self->due = self->waiting;
}

void rpdo_on_time(struct rpdo *self, co_us_t now, struct co_outbox *out)
{
    if (self->due && !take_over(self, out))
        return;
    if (now >= self->deadline) {
        self->fault = RPDO_FAULT_TIMEOUT;
        self->wrong_size = 0;
        self->deadline = CO_NEVER;
    }
    tell_fault(self, out);
}

co_us_t rpdo_deadline(const struct rpdo *self)
{
    return self->due || self->fault != self->told_fault ? 0 : self->deadline;
}

struct co_frame rpdo_request_frame(const struct rpdo *self)
{
    const bool ext = (self->cob_id & COB_ID_EXT) != 0;
    struct co_frame frame = co_frame_make(self->cob_id & (ext ? 0x1FFFFFFFu : 0x7FFu),
                                          pdo_map_size(&self->map));

    frame.flags = (uint8_t)(CO_FRAME_RTR | (ext ? CO_FRAME_EXT : 0));
    return frame;
}
