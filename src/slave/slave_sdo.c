#include "slave/slave_internal.h"

#include "base/bytes.h"
#include "proto/event.h"
#include "slave/slave_store.h"

#include <string.h>

#define SEGMENTS 32u /* of a block upload, in one step */

/* Outbox room for what one request may cause, besides segments. */
static bool has_room(const struct co_outbox *out)
{
    return co_outbox_room(out, 2, 2);
}

co_us_t slave_heartbeat_period(const struct slave *self)
{
    return CO_MS(od_number(self->od, 0x1017, 0, 0));
}

static bool is_error_control(uint16_t index)
{
    return index == 0x100C || index == 0x100D || index == 0x1016 || index == 0x1017;
}

static void take_over_error_control(struct slave *self, uint16_t index, uint8_t sub, co_us_t now,
                                    struct co_outbox *out)
{
    if (index == 0x1016) {
        slave_configure_consumer(self, sub);
        slave_watch_consumers(self, now, out);
        self->listen_generation++;
        return;
    }
    if (index == 0x1017)
        hb_producer_start(&self->heartbeat, slave_heartbeat_period(self), true, now);
    slave_configure_guarding(self, now, out);
    if (index == 0x1017)
        hb_producer_on_time(&self->heartbeat, now, out);
}

void slave_take_over(struct slave *self, uint16_t index, uint8_t sub, co_us_t now,
                     struct co_outbox *out)
{
    if (index >= FIRST_RPDO_OBJECT && index <= LAST_TPDO_OBJECT)
        slave_configure_pdo(self, index, sub, now, out);
    else if (slave_is_sync_object(index))
        slave_configure_sync(self);
    else if (index == 0x1012)
        slave_configure_time(self);
    else if (index == 0x1014 || index == 0x1015)
        slave_configure_emcy(self);
    else if (index == 0x1028)
        slave_configure_hearing(self);
    else if (slave_is_additional_server(index))
        slave_configure_channel(self, index);
    else if (is_error_control(index))
        take_over_error_control(self, index, sub, now, out);
}

/* The value in the server's buffer. */
static struct slave_write received_write(const struct slave *self,
                                         const struct slave_channel *channel)
{
    const struct sdo_server *server = &channel->server;
    const uint8_t *value = sdo_server_value(server);

    return (struct slave_write){ .od = self->od,
                                 .entry = od_find(self->od, server->index, server->sub),
                                 .value = value,
                                 .size = server->size,
                                 .number = get_le(value, server->size < 8 ? server->size : 8),
                                 .assume_sync = self->assume_sync };
}

static bool changes(const struct slave_write *write)
{
    return write->entry->size != write->size ||
           memcmp(write->entry->value, write->value, write->size) != 0;
}

static sdo_abort_t store_value(struct slave *self, const struct slave_write *write)
{
    const sdo_abort_t code = slave_check_write(write);

    if (code != SDO_OK)
        return code;
    if (write->entry->fetched) /* the owner has stored it */
        return SDO_OK;
    if (slave_is_store_command(write))
        return slave_execute_store(self, write);
    slave_note_change(self, write);
    return od_set(write->entry, write->value, write->size);
}

/* Stores the value if the code says so, and answers. */
static void finish_write(struct slave *self, struct slave_channel *channel,
                         const struct slave_write *write, sdo_abort_t code, co_us_t now,
                         struct co_outbox *out)
{
    const struct co_event event = { .type = SLAVE_WRITTEN,
                                    .node = self->node,
                                    .index = write->entry->index,
                                    .sub = write->entry->sub,
                                    .actual = write->number };
    const bool other = write->entry->map_count > 0 && changes(write);

    if (code == SDO_OK)
        code = store_value(self, write);
    else if (code == SLAVE_DONE)
        code = SDO_OK;
    sdo_server_verdict(&channel->server, code, now, out);
    if (code != SDO_OK)
        return;
    co_outbox_put_event(out, &event);
    slave_take_over(self, event.index, event.sub, now, out); /* that may close the channel */
    if (other)
        slave_mapped_changed(self, write->entry, now, out);
}

static uint8_t place_of(const struct slave *self, const struct slave_channel *channel)
{
    return (uint8_t)(channel - self->channels);
}

/* What the device itself has against it comes before the application is asked. */
static void ask_for_verdict(struct slave *self, struct slave_channel *channel,
                            const struct slave_write *write, co_us_t now, struct co_outbox *out)
{
    const sdo_abort_t code = slave_check_write(write);
    const struct co_event event = { .type = SLAVE_VERDICT,
                                    .node = self->node,
                                    .index = write->entry->index,
                                    .sub = write->entry->sub,
                                    .actual = write->size,
                                    .detail = place_of(self, channel),
                                    .code = channel->server.number };

    if (code == SDO_OK)
        co_outbox_put_event(out, &event);
    else
        sdo_server_verdict(&channel->server, code, now, out);
}

static void take_write(struct slave *self, struct slave_channel *channel, co_us_t now,
                       struct co_outbox *out)
{
    const struct slave_write write = received_write(self, channel);

    if (write.entry->watched || write.entry->fetched)
        ask_for_verdict(self, channel, &write, now, out);
    else
        finish_write(self, channel, &write, SDO_OK, now, out);
}

static void ask_for_value(struct slave *self, const struct slave_channel *channel,
                          struct co_outbox *out)
{
    const struct co_event event = { .type = SLAVE_FETCH,
                                    .node = self->node,
                                    .index = channel->server.index,
                                    .sub = channel->server.sub,
                                    .detail = place_of(self, channel),
                                    .code = channel->server.number };

    co_outbox_put_event(out, &event);
}

/* For its owner. */
static bool is_waiting(const struct sdo_server *server)
{
    return (server->state == SDO_SERVER_VERDICT || server->state == SDO_SERVER_FETCH) &&
           !server->unsent;
}

static bool waits_for_verdict(const struct sdo_server *server, uint32_t number)
{
    return server->state == SDO_SERVER_VERDICT && server->number == number && !server->unsent;
}

static void execute_verdict(struct slave *self, struct slave_channel *channel, co_us_t now,
                            struct co_outbox *out)
{
    struct slave_write write;

    if (!channel->verdict_due || !has_room(out))
        return;
    channel->verdict_due = false;
    if (!waits_for_verdict(&channel->server, channel->verdict_number) ||
        now >= channel->server.deadline)
        return;
    write = received_write(self, channel);
    finish_write(self, channel, &write, channel->verdict, now, out);
}

bool slave_waits_for(const struct slave *self, struct slave_transfer transfer)
{
    const struct sdo_server *server;

    if (transfer.channel >= self->channel_count)
        return false;
    server = &self->channels[transfer.channel].server;
    return is_waiting(server) && server->number == transfer.number;
}

const uint8_t *slave_received(const struct slave *self, struct slave_transfer transfer)
{
    return sdo_server_value(&self->channels[transfer.channel].server);
}

void slave_verdict(struct slave *self, struct slave_transfer transfer, sdo_abort_t code,
                   co_us_t now, struct co_outbox *out)
{
    struct slave_channel *channel;

    if (!slave_waits_for(self, transfer))
        return;
    channel = &self->channels[transfer.channel];
    if (channel->verdict_due || channel->server.state != SDO_SERVER_VERDICT ||
        now >= channel->server.deadline)
        return;
    channel->verdict = code;
    channel->verdict_number = transfer.number;
    channel->verdict_due = true;
    execute_verdict(self, channel, now, out);
}

void slave_give(struct slave *self, struct slave_transfer transfer, const struct slave_value *value,
                co_us_t now, struct co_outbox *out)
{
    if (slave_waits_for(self, transfer))
        sdo_server_give(&self->channels[transfer.channel].server, value->code, value->bytes,
                        value->size, now, out);
}

/* Steps a server, with a frame or without; there is room for what it may give. */
static void step_server(struct slave *self, struct slave_channel *channel,
                        const struct co_frame *request, co_us_t now, struct co_outbox *out)
{
    const unsigned room = out->frame_capacity - out->frame_count;
    struct co_frame frames[SEGMENTS], frame;
    struct co_event events[2], event;
    struct co_outbox inner;

    co_outbox_init(&inner, frames, room < SEGMENTS ? room : SEGMENTS, events, 2);
    if (request != NULL)
        sdo_server_on_frame(&channel->server, request, now, &inner);
    else
        sdo_server_on_time(&channel->server, now, &inner);
    while (co_outbox_take_frame(&inner, &frame))
        co_outbox_put_frame(out, &frame);
    while (co_outbox_take_event(&inner, &event))
        if (event.type == PROTO_SDO_WRITE)
            take_write(self, channel, now, out);
        else if (event.type == PROTO_SDO_READ)
            ask_for_value(self, channel, out);
}

static void refuse_history(struct slave_channel *channel, const struct co_frame *request,
                           co_us_t now, struct co_outbox *out)
{
    struct co_frame frame = *request;

    frame.data[0] = 0x80;
    put_le32(frame.data + 4, SDO_NO_DATA);
    sdo_server_on_frame(&channel->server, &frame, now, out);
    frame.id = channel->server.response_id;
    frame.tag = 0;
    co_outbox_put_frame(out, &frame);
}

void slave_serve(struct slave *self, struct slave_channel *channel, const struct co_frame *request,
                 co_us_t now, struct co_outbox *out)
{
    if (!channel->server.enabled)
        return;
    /* If that still waits for room, it ends with its transfer. */
    execute_verdict(self, channel, now, out);
    slave_give_buffer(self, channel); /* without one, what needs it is refused */
    if (!has_room(out))
        channel->server.dropped++;
    else if (channel->server.state != SDO_SERVER_BLOCK_DOWN && slave_history_lacks(self, request))
        refuse_history(channel, request, now, out);
    else
        step_server(self, channel, request, now, out);
}

static void tell_late_verdict(struct slave *self, const struct slave_channel *channel,
                              struct co_outbox *out)
{
    const struct co_event event = { .type = SLAVE_VERDICT_LATE,
                                    .node = self->node,
                                    .index = channel->server.index,
                                    .sub = channel->server.sub };

    self->late_verdicts++;
    co_outbox_put_event(out, &event);
}

static void step_channel(struct slave *self, struct slave_channel *channel, co_us_t now,
                         struct co_outbox *out)
{
    const struct sdo_server *server = &channel->server;
    bool late;

    execute_verdict(self, channel, now, out);
    if (sdo_server_deadline(server) > now || !has_room(out))
        return;
    late = is_waiting(server);
    step_server(self, channel, NULL, now, out);
    if (late)
        tell_late_verdict(self, channel, out);
}

void slave_step_sdo(struct slave *self, co_us_t now, struct co_outbox *out)
{
    for (unsigned i = 0; i < self->channel_count; i++)
        step_channel(self, &self->channels[i], now, out);
}

co_us_t slave_sdo_deadline(const struct slave *self)
{
    co_us_t deadline = CO_NEVER;

    for (unsigned i = 0; i < self->channel_count; i++) {
        const struct slave_channel *channel = &self->channels[i];

        if (channel->verdict_due)
            return 0;
        deadline = co_earlier(deadline, sdo_server_deadline(&channel->server));
    }
    return deadline;
}
