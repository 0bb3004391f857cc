#include "slave/slave_internal.h"

#include <stdlib.h>
#include <string.h>

#define EMCY_SIZE 8u

struct slave_hearing {
    uint32_t can_id; /* with COB_ID_EXT where it has 29 bits */
    uint8_t sub;
};

enum co_err slave_make_hearing(struct slave *self)
{
    self->heard_room = slave_highest_sub(self->od, 0x1028, NMT_NODE_MAX);
    if (self->heard_room == 0)
        return CO_OK;
    self->heard = calloc(self->heard_room, sizeof *self->heard);
    return self->heard != NULL ? CO_OK : CO_ERR_MEMORY;
}

void slave_leave_emergencies(struct slave *self)
{
    self->heard_room = 0;
    self->heard_count = 0;
}

void slave_configure_hearing(struct slave *self)
{
    self->heard_count = 0;
    for (unsigned sub = 1; sub <= self->heard_room; sub++) {
        const uint64_t cob_id = od_number(self->od, 0x1028, (uint8_t)sub, COB_ID_INVALID);

        if ((cob_id & COB_ID_INVALID) == 0)
            self->heard[self->heard_count++] = (struct slave_hearing){
                .can_id = slave_can_id((uint32_t)cob_id), .sub = (uint8_t)sub
            };
    }
    self->listen_generation++;
}

uint32_t slave_heard_can_id(const struct slave *self, unsigned i)
{
    return self->heard[i].can_id;
}

/*
 * The sub-index is meant to be the producer's node-ID, but many configurations number the entries
 * instead: an identifier of the pre-defined connection set says more.
 */
static uint8_t producer_of(const struct slave_hearing *heard)
{
    if (heard->can_id > EMCY_CAN_ID && heard->can_id <= EMCY_CAN_ID + NMT_NODE_MAX)
        return (uint8_t)(heard->can_id - EMCY_CAN_ID);
    return heard->sub;
}

static void tell(struct slave *self, const struct slave_hearing *heard,
                 const struct co_frame *frame, co_us_t now, struct co_outbox *out)
{
    struct co_event event = { .type = SLAVE_EMCY_HEARD,
                              .node = self->node,
                              .index = heard->sub,
                              .detail = producer_of(heard),
                              .code = heard->can_id,
                              .actual = now };

    if (!co_outbox_room(out, 0, 1)) {
        self->heard_dropped++;
        return;
    }
    memcpy(event.data, frame->data, sizeof event.data);
    co_outbox_put_event(out, &event);
}

void slave_hear_emcy(struct slave *self, const struct co_frame *frame, co_us_t now,
                     struct co_outbox *out)
{
    const uint32_t can_id = frame->id | ((frame->flags & CO_FRAME_EXT) != 0 ? COB_ID_EXT : 0);

    if (self->heard_count == 0 || frame->dlc != EMCY_SIZE ||
        (frame->flags & (CO_FRAME_RTR | CO_FRAME_OWN)) != 0 ||
        (self->state != NMT_PREOPERATIONAL && self->state != NMT_OPERATIONAL))
        return;
    for (unsigned i = 0; i < self->heard_count; i++)
        if (self->heard[i].can_id == can_id)
            tell(self, &self->heard[i], frame, now, out);
}
