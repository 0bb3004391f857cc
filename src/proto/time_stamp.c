#include "proto/time_stamp.h"

#include "base/bytes.h"

#define COB_ID_CONSUMES 0x80000000u
#define COB_ID_PRODUCES 0x40000000u
#define COB_ID_EXT      0x20000000u
#define MS_MASK         0x0FFFFFFFu

void time_of_day_encode(const struct time_of_day *self, uint8_t ret_bytes[TIME_OF_DAY_SIZE])
{
    put_le32(ret_bytes, self->ms & MS_MASK);
    put_le16(ret_bytes + 4, self->days);
}

struct time_of_day time_of_day_decode(const uint8_t bytes[TIME_OF_DAY_SIZE])
{
    return (struct time_of_day){ .ms = get_le32(bytes) & MS_MASK, .days = get_le16(bytes + 4) };
}

static uint8_t kind_of(uint32_t cob_id)
{
    return (cob_id & COB_ID_EXT) != 0 ? CO_FRAME_EXT : 0;
}

static uint32_t can_id_of(uint32_t cob_id)
{
    return cob_id & (kind_of(cob_id) != 0 ? 0x1FFFFFFFu : 0x7FFu);
}

bool time_stamp_consumes(const struct time_stamp *self)
{
    return (self->cob_id & COB_ID_CONSUMES) != 0;
}

bool time_stamp_on_frame(const struct time_stamp *self, const struct co_frame *frame,
                         struct time_of_day *ret_time)
{
    if (!self->enabled || !time_stamp_consumes(self) || frame->id != can_id_of(self->cob_id) ||
        (frame->flags & (CO_FRAME_EXT | CO_FRAME_RTR)) != kind_of(self->cob_id) ||
        frame->dlc != TIME_OF_DAY_SIZE)
        return false;
    *ret_time = time_of_day_decode(frame->data);
    return true;
}

enum co_err time_stamp_send(const struct time_stamp *self, const struct time_of_day *time,
                            struct co_outbox *out)
{
    struct co_frame frame = co_frame_make(can_id_of(self->cob_id), TIME_OF_DAY_SIZE);

    if (!self->enabled)
        return CO_ERR_STATE;
    if ((self->cob_id & COB_ID_PRODUCES) == 0)
        return CO_ERR_ARG;
    if (!co_outbox_room(out, 1, 0))
        return CO_ERR_AGAIN;
    frame.flags |= kind_of(self->cob_id);
    time_of_day_encode(time, frame.data);
    co_outbox_put_frame(out, &frame);
    return CO_OK;
}
