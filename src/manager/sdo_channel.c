#include "manager/sdo_channel.h"

#include "proto/event.h"

#include <stddef.h>

void sdo_channel_init(struct sdo_channel *self, uint8_t node, unsigned *block_downloads)
{
    *self = (struct sdo_channel){ .block_downloads = block_downloads };
    sdo_client_init(&self->client, node);
}

void sdo_channel_forget(struct sdo_channel *self)
{
    self->no_blocks = false;
}

/* May the transfer go in blocks as it wants? */
static bool take_blocks(struct sdo_channel *self, const struct sdo_transfer *transfer)
{
    if (self->no_blocks)
        return false;
    if (!transfer->download || transfer->block == 0)
        return true;
    if (*self->block_downloads >= SDO_CHANNEL_BLOCK_DOWNLOADS)
        return false;
    ++*self->block_downloads;
    self->counted = true;
    return true;
}

/* Nothing runs any more. */
static void end_request(struct sdo_channel *self)
{
    if (self->counted)
        --*self->block_downloads;
    self->counted = false;
    self->running = NULL;
}

static void start_next(struct sdo_channel *self, co_us_t now, struct co_outbox *out)
{
    struct sdo_request *request = self->first;

    if (self->running || !request || sdo_client_busy(&self->client))
        return;
    self->first = request->next;
    if (!self->first)
        self->last = NULL;
    request->next = NULL;
    request->state = REQUEST_RUNNING;
    self->running = request;
    if (!take_blocks(self, &request->transfer))
        request->transfer.block = 0;
    sdo_client_start(&self->client, &request->transfer, now, out);
}

void sdo_channel_submit(struct sdo_channel *self, struct sdo_request *request, co_us_t now,
                        struct co_outbox *out)
{
    request->next = NULL;
    request->state = REQUEST_QUEUED;
    if (self->last)
        self->last->next = request;
    else
        self->first = request;
    self->last = request;
    start_next(self, now, out);
}

void sdo_channel_submit_first(struct sdo_channel *self, struct sdo_request *request, co_us_t now,
                              struct co_outbox *out)
{
    request->next = self->first;
    request->state = REQUEST_QUEUED;
    self->first = request;
    if (!self->last)
        self->last = request;
    start_next(self, now, out);
}

static void unlink_waiting(struct sdo_channel *self, struct sdo_request *request)
{
    struct sdo_request *previous = NULL;

    for (struct sdo_request *r = self->first; r; previous = r, r = r->next) {
        if (r != request)
            continue;
        if (previous)
            previous->next = r->next;
        else
            self->first = r->next;
        if (self->last == r)
            self->last = previous;
        return;
    }
}

/* Its end, where it is told, is on its way to sdo_channel_on_done() and counted. */
static bool end_running(struct sdo_channel *self, sdo_abort_t code, struct co_outbox *out)
{
    bool busy = sdo_client_busy(&self->client);

    if (busy && code == SDO_OK) {
        sdo_client_init(&self->client, self->client.node); /* the server has forgotten it too */
        return true;
    }
    if (busy && !sdo_client_cancel(&self->client, code, out))
        return false;
    self->cancelled++;
    return true;
}

bool sdo_channel_cancel(struct sdo_channel *self, struct sdo_request *request, sdo_abort_t code,
                        co_us_t now, struct co_outbox *out)
{
    if (self->running == request) {
        if (!end_running(self, code, out))
            return false;
        end_request(self);
        start_next(self, now, out);
    } else {
        unlink_waiting(self, request);
    }
    request->state = REQUEST_IDLE;
    return true;
}

void sdo_channel_clear(struct sdo_channel *self, co_us_t now, struct co_outbox *out)
{
    struct sdo_request *running = self->running;

    for (struct sdo_request *r = self->first; r; r = r->next)
        r->state = REQUEST_IDLE;
    self->first = NULL;
    self->last = NULL;
    if (running && !sdo_channel_cancel(self, running, SDO_TIMEOUT, now, out))
        sdo_channel_cancel(self, running, SDO_OK, now, out);
}

struct sdo_request *sdo_channel_on_done(struct sdo_channel *self, const struct co_event *event,
                                        co_us_t now, struct co_outbox *out)
{
    struct sdo_request *request = self->running;

    self->no_blocks |= event->expected != 0;
    if (self->cancelled > 0) { /* the end of what sdo_channel_cancel() took out */
        self->cancelled--;
        start_next(self, now, out);
        return NULL;
    }
    if (!request)
        return NULL;
    request->state = REQUEST_DONE;
    request->result = *event;
    end_request(self);
    start_next(self, now, out);
    return request;
}

void sdo_request_give_up(struct sdo_request *request, uint8_t node)
{
    request->state = REQUEST_DONE;
    request->result = (struct co_event){ .type = PROTO_SDO_DONE,
                                         .node = node,
                                         .detail = SDO_OUTCOME_NOT_SENT,
                                         .index = request->transfer.index,
                                         .sub = request->transfer.sub };
}

struct sdo_request *sdo_channel_give_up(struct sdo_channel *self)
{
    struct sdo_request *request = self->running;

    if (request) {
        sdo_client_init(&self->client, self->client.node);
        end_request(self);
    } else {
        request = self->first;
        if (!request)
            return NULL;
        unlink_waiting(self, request);
    }
    sdo_request_give_up(request, self->client.node);
    return request;
}
