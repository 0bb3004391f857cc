#include "slave/slave_internal.h"

#define COB_ID_TIME 0x1012u

/* A device without the object takes no part. */
void slave_configure_time(struct slave *self)
{
    self->time.cob_id = (uint32_t)od_number(self->od, COB_ID_TIME, 0, 0);
    self->listen_generation++;
}

bool slave_hear_time(struct slave *self, const struct co_frame *frame, struct co_outbox *out)
{
    struct co_event event = { .type = SLAVE_TIME, .node = self->node };
    struct time_of_day time;

    if (!time_stamp_on_frame(&self->time, frame, &time))
        return false;
    event.code = time.ms;
    event.index = time.days;
    if (co_outbox_room(out, 0, 1)) /* it is an old one as soon as there would be */
        co_outbox_put_event(out, &event);
    return true;
}

enum co_err slave_send_time(const struct slave *self, const struct time_of_day *time,
                            struct co_outbox *out)
{
    return time_stamp_send(&self->time, time, out);
}
