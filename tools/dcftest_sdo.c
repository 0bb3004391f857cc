#include "dcftest_sdo.h"

#include "port/clock.h"

#include <stdio.h>
#include <string.h>

#define RETRY CO_MS(1) /* where the bus has no room */

bool sdo_reader_open(struct sdo_reader *self, const char *bus, uint8_t node, co_us_t timeout)
{
    const struct bus_options options = { .own_frames = true };
    const struct bus_filter filters[] = {
        { SDO_RESPONSE_ID + node, 0x7FF, 0, CO_FRAME_EXT | CO_FRAME_RTR },
        { SDO_REQUEST_ID + node, 0x7FF, 0, CO_FRAME_EXT | CO_FRAME_RTR },
    };

    memset(self, 0, sizeof *self);
    if (bus_open(bus, &options, &self->bus, self->message, sizeof self->message) != CO_OK)
        return false;
    if (bus_set_filters(self->bus, filters, sizeof filters / sizeof filters[0]) != CO_OK) {
        snprintf(self->message, sizeof self->message, "%s: no filters can be set", bus);
        sdo_reader_close(self);
        return false;
    }
    self->timeout = timeout;
    sdo_client_init(&self->client, node);
    co_outbox_init(&self->outbox, self->frames, sizeof self->frames / sizeof self->frames[0],
                   self->events, sizeof self->events / sizeof self->events[0]);
    return true;
}

void sdo_reader_close(struct sdo_reader *self)
{
    if (self->bus)
        bus_close(self->bus);
    self->bus = NULL;
}

static bool lose(struct sdo_reader *self, const char *what)
{
    char text[256];

    bus_explain(self->bus, text, sizeof text);
    snprintf(self->message, sizeof self->message, "%s: %s; %s", bus_name(self->bus), what, text);
    return false;
}

static void take(struct sdo_reader *self, const struct co_frame *frame)
{
    if (frame->id == SDO_REQUEST_ID + self->client.node && !(frame->flags & CO_FRAME_OWN))
        self->foreign++;
    sdo_client_on_frame(&self->client, frame, clock_now(), &self->outbox);
}

/* Until the deadline, or something has come. */
static bool listen_until(struct sdo_reader *self, co_us_t deadline)
{
    enum co_err err = bus_wait(self->bus, deadline);
    struct bus_rx rx;

    if (err != CO_OK && err != CO_ERR_TIMEOUT)
        return lose(self, co_err_text(err));
    do {
        err = bus_receive(self->bus, &rx);
        if (err == CO_OK)
            take(self, &rx.frame);
    } while (err == CO_OK && bus_has_fetched(self->bus));
    return err == CO_OK || err == CO_ERR_AGAIN || lose(self, co_err_text(err));
}

static bool send_all(struct sdo_reader *self)
{
    const co_us_t limit = clock_now() + SDO_SEND_TIMEOUT;
    struct co_frame frame;

    while (co_outbox_take_frame(&self->outbox, &frame)) {
        enum co_err err = bus_send(self->bus, &frame);

        while (err == CO_ERR_AGAIN && clock_now() < limit) {
            if (!listen_until(self, clock_now() + RETRY))
                return false;
            err = bus_send(self->bus, &frame);
        }
        if (err != CO_OK)
            return lose(self, co_err_text(err));
    }
    return true;
}

bool sdo_reader_read(struct sdo_reader *self, uint16_t index, uint8_t sub, uint8_t *buffer,
                     uint32_t size, struct co_event *ret_done)
{
    const struct sdo_transfer transfer = {
        .index = index, .sub = sub, .buffer = buffer, .size = size, .timeout = self->timeout
    };

    sdo_client_start(&self->client, &transfer, clock_now(), &self->outbox);
    while (send_all(self)) {
        if (co_outbox_take_event(&self->outbox, ret_done))
            return ret_done->detail != SDO_OUTCOME_NOT_SENT ||
                   lose(self, "a request does not get on the wire: nobody acknowledges it");
        if (!listen_until(self, sdo_client_deadline(&self->client)))
            return false;
        sdo_client_on_time(&self->client, clock_now(), &self->outbox);
    }
    return false;
}
