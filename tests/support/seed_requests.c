#include "support/seed.h"

#include "base/bytes.h"
#include "support/watch.h"

#include <check.h>
#include <stdio.h>
#include <string.h>

#define NUMBERS 8u     /* 2001h:01..08: each another value on each node */
#define TEXT    0x2002 /* a sentence that tells whose it is */
#define SCRATCH 0x2003 /* :01 to :20: what was written last */
#define WRITTEN 32u    /* of these; an answer to a write before to the same one looks the same */

static uint32_t number_of(uint8_t node, uint8_t sub)
{
    return 0xA5000000u | (uint32_t)node << 8 | sub;
}

static unsigned text_of(uint8_t node, char *ret_text, size_t size)
{
    return (unsigned)snprintf(ret_text, size, "object 2002h:00 of node %u, and of no other", node);
}

void seed_add_request_objects(struct seed *self, uint8_t node, bool written)
{
    struct plant_device *device = self->plant->devices[node];
    char text[64];
    struct od_spec spec = { .index = TEXT,
                            .type = OD_VISIBLE_STRING,
                            .access = OD_RO,
                            .size = text_of(node, text, sizeof text) };
    uint8_t bytes[sizeof text];

    memcpy(bytes, text, sizeof text);
    spec.value = bytes;
    ck_assert_int_eq(od_add(&device->od, &spec, NULL), CO_OK);
    for (uint8_t sub = 1; sub <= NUMBERS; sub++)
        plant_add_object(device, 0x2001, sub, 4, number_of(node, sub));
    for (uint8_t sub = 1; written && sub <= WRITTEN; sub++)
        plant_add_object(device, SCRATCH, sub, 4, 0);
}

/* --- requests --- */

static void choose(struct seed *self, struct seed_request *request)
{
    struct sdo_transfer *transfer = &request->request.transfer;

    memset(transfer, 0, sizeof *transfer);
    memset(request->buffer, 0, sizeof request->buffer);
    transfer->timeout = CO_MS(100);
    transfer->buffer = request->buffer;
    transfer->size = sizeof request->buffer;
    transfer->index = 0x2001;
    transfer->sub = (uint8_t)(1 + seed_below(self, NUMBERS));
    switch (seed_below(self, 4)) {
    case 0:
        transfer->index = TEXT;
        transfer->sub = 0;
        transfer->block = seed_one_in(self, 2) ? 4 : 0;
        break;
    case 1:
        request->written = ++self->counter;
        put_le32(request->buffer, request->written);
        transfer->index = SCRATCH;
        transfer->sub = (uint8_t)(1 + request->written % WRITTEN);
        transfer->download = true;
        transfer->source = request->buffer;
        transfer->size = 4;
        break;
    default: break;
    }
}

static void submit(struct seed *self, struct seed_request *request)
{
    const struct plant_device *device;

    request->target = (uint8_t)(1 + seed_below(self, self->node_count + 1)); /* one is not there */
    device = self->plant->devices[request->target];
    choose(self, request);
    request->resets = device ? device->resets : 0;
    request->open = true;
    self->submitted++;
    manager_submit(self->plant->manager, request->target, &request->request, self->plant->sim.now,
                   &self->plant->manager_device->box);
}

static void cancel(struct seed *self, struct seed_request *request)
{
    manager_cancel(self->plant->manager, request->target, &request->request, self->plant->sim.now,
                   &self->plant->manager_device->box);
    if (request->request.state != REQUEST_IDLE)
        return; /* it was over already */
    self->cancelled++;
    request->open = false;
}

static void check_data(struct seed *self, const struct seed_request *request)
{
    const struct sdo_transfer *transfer = &request->request.transfer;
    const struct plant_device *device = self->plant->devices[request->target];
    char text[64];
    bool right;

    if (request->request.result.detail != SDO_OUTCOME_OK)
        return;
    if (transfer->download)
        right = device->resets != request->resets ||
                od_number(&device->od, SCRATCH, transfer->sub, 0) == request->written;
    else if (transfer->index == TEXT)
        right = request->request.result.actual == text_of(request->target, text, sizeof text) &&
                memcmp(request->buffer, text, strlen(text)) == 0;
    else
        right = get_le32(request->buffer) == number_of(request->target, transfer->sub);
    watch_check(self->plant, right, request->target, "a request has ended with other data");
}

/* One event may stand for several of them. */
void seed_on_event(struct plant *plant, const struct co_event *event)
{
    struct seed *self = plant->fault_context;

    if (event->type != MANAGER_REQUEST_DONE)
        return;
    for (unsigned i = 0; i < SEED_REQUESTS; i++) {
        struct seed_request *request = &self->requests[i];

        if (!request->open || request->target != event->node ||
            request->request.state != REQUEST_DONE)
            continue;
        request->open = false;
        self->done++;
        check_data(self, request);
    }
}

void seed_forget_requests(struct seed *self)
{
    for (unsigned i = 0; i < SEED_REQUESTS; i++) {
        self->lost += self->requests[i].open;
        self->requests[i].open = false;
        self->requests[i].request.state = REQUEST_IDLE;
    }
}

/* --- orders --- */

static void order(struct seed *self)
{
    static const enum nmt_command commands[] = { NMT_START, NMT_STOP, NMT_ENTER_PREOPERATIONAL,
                                                 NMT_RESET_NODE, NMT_RESET_COMMUNICATION };

    plant_command(self->plant, commands[seed_below(self, 5)],
                  (uint8_t)seed_below(self, self->node_count + 1));
}

void seed_apply(struct seed *self)
{
    struct seed_request *request = &self->requests[seed_below(self, SEED_REQUESTS)];

    if (!self->plant->manager_device->active)
        return;
    if (!request->open && seed_one_in(self, 10))
        submit(self, request);
    else if (request->open && seed_one_in(self, 50))
        cancel(self, request);
    if (self->faulty && self->has[SEED_ORDERS] && seed_one_in(self, 500))
        order(self);
}
