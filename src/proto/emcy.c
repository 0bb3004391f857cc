#include "proto/emcy.h"

#include "base/bytes.h"
#include "proto/event.h"

#include <string.h>

#define COB_ID_INVALID 0x80000000u
#define COB_ID_EXT     0x20000000u
#define NODE_MAX       127u

void emcy_producer_init(struct emcy_producer *self, uint32_t cob_id)
{
    *self = (struct emcy_producer){ .cob_id = cob_id };
}

void emcy_producer_configure(struct emcy_producer *self, uint32_t cob_id, co_us_t inhibit)
{
    self->cob_id = cob_id;
    if (self->not_before > 0) /* the time runs from the emergency sent last */
        self->not_before = self->not_before - self->inhibit + inhibit;
    self->inhibit = inhibit;
    if (cob_id & COB_ID_INVALID)
        self->count = 0;
}

void emcy_producer_enable(struct emcy_producer *self, bool enabled)
{
    self->enabled = enabled;
}

bool emcy_producer_is_full(const struct emcy_producer *self)
{
    return self->count == EMCY_QUEUE_MAX;
}

void emcy_producer_raise(struct emcy_producer *self, const struct emcy_message *message)
{
    if (self->cob_id & COB_ID_INVALID)
        return;
    if (emcy_producer_is_full(self))
        self->lost++;
    else
        self->count++;
    self->queue[(self->first + self->count - 1) % EMCY_QUEUE_MAX] = *message;
}

static struct co_frame message_frame(const struct emcy_message *message, uint32_t cob_id)
{
    const bool ext = (cob_id & COB_ID_EXT) != 0;
    struct co_frame frame = co_frame_make(cob_id & (ext ? 0x1FFFFFFFu : 0x7FFu), 8);

    if (ext)
        frame.flags |= CO_FRAME_EXT;
    put_le16(frame.data, message->code);
    frame.data[2] = message->error_register;
    memcpy(frame.data + 3, message->field, sizeof message->field);
    return frame;
}

void emcy_producer_on_time(struct emcy_producer *self, co_us_t now, struct co_outbox *out)
{
    while (now >= emcy_producer_deadline(self) && co_outbox_room(out, 1, 0)) {
        struct co_frame frame = message_frame(&self->queue[self->first], self->cob_id);

        co_outbox_put_frame(out, &frame);
        self->first = (self->first + 1) % EMCY_QUEUE_MAX;
        self->count--;
        self->not_before = now + self->inhibit;
    }
}

co_us_t emcy_producer_deadline(const struct emcy_producer *self)
{
    return self->enabled && self->count > 0 ? self->not_before : CO_NEVER;
}

bool emcy_parse(const struct co_frame *frame, struct co_event *ret_event)
{
    struct co_event event = { .type = PROTO_EMCY };

    if (frame->flags & (CO_FRAME_EXT | CO_FRAME_RTR) || frame->dlc < 2)
        return false;
    if (frame->id <= EMCY_CAN_ID || frame->id > EMCY_CAN_ID + NODE_MAX)
        return false;
    memcpy(event.data, frame->data, frame->dlc < 8 ? frame->dlc : 8);
    event.node = (uint8_t)(frame->id - EMCY_CAN_ID);
    event.code = get_le16(event.data);
    event.detail = event.data[2];
    *ret_event = event;
    return true;
}

/* The first line that fits tells the meaning. */
static const struct {
    uint16_t mask;
    uint16_t code;
    const char *text;
} texts[] = {
    { 0xFFFF, 0x8110, "CAN overrun, objects lost" },
    { 0xFFFF, 0x8120, "CAN controller in error passive mode" },
    { 0xFFFF, 0x8130, "heartbeat or life guarding error" },
    { 0xFFFF, 0x8140, "recovered from bus-off" },
    { 0xFFFF, 0x8150, "CAN-ID collision" },
    { 0xFFFF, 0x8210, "PDO not processed because of its length" },
    { 0xFFFF, 0x8220, "PDO length exceeded" },
    { 0xFFFF, 0x8230, "multiplexed PDO not processed, no such object" },
    { 0xFFFF, 0x8240, "unexpected SYNC data length" },
    { 0xFFFF, 0x8250, "RPDO time-out" },
    { 0xFF00, 0x0000, "error reset or no error" },
    { 0xFF00, 0x1000, "generic error" },
    { 0xFF00, 0x2000, "current" },
    { 0xFF00, 0x2100, "current, device input side" },
    { 0xFF00, 0x2200, "current inside the device" },
    { 0xFF00, 0x2300, "current, device output side" },
    { 0xFF00, 0x3000, "voltage" },
    { 0xFF00, 0x3100, "mains voltage" },
    { 0xFF00, 0x3200, "voltage inside the device" },
    { 0xFF00, 0x3300, "output voltage" },
    { 0xFF00, 0x4000, "temperature" },
    { 0xFF00, 0x4100, "ambient temperature" },
    { 0xFF00, 0x4200, "device temperature" },
    { 0xFF00, 0x5000, "device hardware" },
    { 0xFF00, 0x6000, "device software" },
    { 0xFF00, 0x6100, "internal software" },
    { 0xFF00, 0x6200, "user software" },
    { 0xFF00, 0x6300, "data set" },
    { 0xFF00, 0x7000, "additional modules" },
    { 0xFF00, 0x8000, "monitoring" },
    { 0xFF00, 0x8100, "communication" },
    { 0xFF00, 0x8200, "protocol error" },
    { 0xFF00, 0x9000, "external error" },
    { 0xFF00, 0xF000, "additional functions" },
    { 0xFF00, 0xFF00, "device specific" },
    { 0xF000, 0x1000, "generic error" },
    { 0xF000, 0x2000, "current" },
    { 0xF000, 0x3000, "voltage" },
    { 0xF000, 0x4000, "temperature" },
    { 0xF000, 0x5000, "device hardware" },
    { 0xF000, 0x6000, "device software" },
    { 0xF000, 0x7000, "additional modules" },
    { 0xF000, 0x8000, "monitoring" },
    { 0xF000, 0x9000, "external error" },
    { 0xF000, 0xF000, "additional functions" },
};

const char *emcy_text(uint16_t code)
{
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        if ((code & texts[i].mask) == texts[i].code)
            return texts[i].text;
    }
    return "unknown error code";
}
