#include "manager/boot_failure.h"

#include "base/bytes.h"
#include "manager/event.h"
#include "proto/sdo_client.h"

#define GARBLED_ATTEMPTS 3u

bool boot_failure_is_same(const struct boot_failure *a, const struct boot_failure *b)
{
    return a->letter == b->letter && a->step == b->step && a->outcome == b->outcome &&
           a->index == b->index && a->sub == b->sub && a->abort_code == b->abort_code &&
           a->actual == b->actual;
}

/* SDO_TIMEOUT: for the node our request was missing, a frame was lost or late. */
static bool is_passing(sdo_abort_t code)
{
    return code == SDO_NO_CONNECTION || code == SDO_DEVICE_STATE || code == SDO_TIMEOUT;
}

/* The same among the segments. */
static bool is_of_segments(sdo_abort_t code)
{
    return code == SDO_TOGGLE || code == SDO_BLOCK_SEQUENCE || code == SDO_BLOCK_CRC;
}

/* Answers that fit no request: who else speaks there may have ended next time. */
static bool is_garbled(const struct boot_failure *self)
{
    return self->outcome == SDO_OUTCOME_TOGGLE || self->outcome == SDO_OUTCOME_PROTOCOL;
}

/*
 * No answer, or one that says "not now", or that frames were lost, may be another one next time. A
 * configuration is not repeated in parts: the next attempt starts with a reset of the node.
 */
bool boot_failure_is_worth_a_retry(const struct boot_failure *self, unsigned attempts)
{
    if (self->outcome == SDO_OUTCOME_NO_ANSWER || self->outcome == SDO_OUTCOME_NOT_SENT ||
        self->outcome == SDO_OUTCOME_CANCELLED)
        return true;
    if (self->letter == 'E' || self->letter == 'F') /* nothing is done to it but asking */
        return true;
    if (self->letter == 'B' || (is_garbled(self) && attempts < GARBLED_ATTEMPTS))
        return true;
    return self->outcome == SDO_OUTCOME_ABORTED &&
           (is_passing(self->abort_code) || is_of_segments(self->abort_code));
}

struct co_event boot_failure_event(const struct boot_failure *self)
{
    struct co_event event = { .type = MANAGER_NODE_FAILED,
                              .detail = (uint8_t)self->letter,
                              .index = self->index,
                              .sub = self->sub,
                              .code = self->abort_code,
                              .expected = self->expected,
                              .actual = self->actual };

    event.data[0] = self->outcome;
    event.data[1] = self->step;
    event.data[2] = self->size;
    put_le32(event.data + 4, self->entry);
    return event;
}

struct boot_failure boot_failure_of(const struct co_event *event)
{
    return (struct boot_failure){ .letter = (char)event->detail,
                                  .step = event->data[1],
                                  .outcome = event->data[0],
                                  .index = event->index,
                                  .sub = event->sub,
                                  .abort_code = event->code,
                                  .expected = (uint32_t)event->expected,
                                  .actual = (uint32_t)event->actual,
                                  .entry = get_le32(event->data + 4),
                                  .size = event->data[2] };
}
