#include "slave/slave_pdo.h"

#include "base/bytes.h"
#include "proto/event.h"
#include "slave/slave_internal.h"

#define STICKY_PDO_LENGTH 0x04u /* bit of the second byte of the manufacturer specific field */

static void note_deadline(struct slave_pdos *pdos, co_us_t deadline)
{
    pdos->deadline = co_earlier(pdos->deadline, deadline);
}

co_us_t slave_pdo_deadline(const struct slave *self)
{
    return self->pdos->deadline;
}

static co_us_t tpdo_due(const struct tpdo *tpdo)
{
    return tpdo->confirms > 0 ? 0 : tpdo_deadline(tpdo);
}

/* ---- one TPDO ---- */

static void tell_confirmations(struct slave *self, struct tpdo *tpdo, struct co_outbox *out)
{
    const struct co_event event = { .type = SLAVE_TPDO_CONFIRMED,
                                    .node = self->node,
                                    .index = tpdo->number };

    for (; tpdo->confirms > 0 && co_outbox_room(out, 0, 1); tpdo->confirms--)
        co_outbox_put_event(out, &event);
}

void slave_step_tpdo(struct slave *self, struct tpdo *tpdo, co_us_t now, struct co_outbox *out)
{
    struct co_frame frames[1], frame;
    struct co_event events[1], event;
    struct co_outbox inner;

    tell_confirmations(self, tpdo, out);
    co_outbox_init(&inner, frames, co_outbox_room(out, 1, 0), events, co_outbox_room(out, 0, 1));
    tpdo_on_time(tpdo, now, &inner);
    if (co_outbox_take_frame(&inner, &frame))
        co_outbox_put_frame(out, &frame);
    if (co_outbox_take_event(&inner, &event)) {
        event.type = SLAVE_TPDO_WANTED;
        event.node = self->node;
        co_outbox_put_event(out, &event);
    }
    note_deadline(self->pdos, tpdo_due(tpdo));
}

/* It is to be sent now; what became of it. */
static enum co_err send_now(struct slave *self, struct tpdo *tpdo, co_us_t now,
                            struct co_outbox *out)
{
    tpdo_trigger(tpdo);
    slave_step_tpdo(self, tpdo, now, out);
    if (!tpdo->event || tpdo->type == 0 || tpdo->asking == TPDO_ASKING)
        return CO_OK;
    return tpdo->inhibit > 0 && now < tpdo->not_before ? CO_ERR_INHIBITED : CO_ERR_AGAIN;
}

static bool is_event_driven(const struct tpdo *tpdo)
{
    return tpdo->type >= TPDO_EVENT;
}

enum co_err slave_pdo_send(struct slave *self, uint16_t number, co_us_t now, struct co_outbox *out)
{
    struct tpdo *tpdo = slave_tpdo(self, number);

    if (tpdo == NULL || !tpdo_is_valid(tpdo) || (tpdo->type != 0 && !is_event_driven(tpdo)))
        return CO_ERR_ARG;
    if (!tpdo->running)
        return CO_ERR_STATE;
    return send_now(self, tpdo, now, out);
}

void slave_tpdo_answer(struct slave *self, uint16_t number, uint32_t ask, co_us_t now,
                       struct co_outbox *out)
{
    struct tpdo *tpdo = slave_tpdo(self, number);

    if (tpdo == NULL || tpdo->asking != TPDO_ASKING || tpdo->ask != ask)
        return;
    tpdo_answer(tpdo, ask);
    slave_step_tpdo(self, tpdo, now, out);
}

/* ---- changed entries ---- */

static bool is_sent_by_change(const struct tpdo *tpdo)
{
    return tpdo->notify && is_event_driven(tpdo) && tpdo_is_valid(tpdo);
}

static enum co_err tell_change(struct slave *self, struct tpdo *tpdo, co_us_t now,
                               struct co_outbox *out)
{
    if (!tpdo->running)
        return CO_OK;
    if (tpdo->type == 0)
        tpdo_trigger(tpdo);
    if (!is_sent_by_change(tpdo))
        return CO_OK;
    if (!self->pdos->hold)
        return send_now(self, tpdo, now, out);
    tpdo->marked = true;
    return CO_OK;
}

static bool is_mapped_end(const struct slave_pdos *pdos, const struct slave_mapped *mapped,
                          const struct od_entry *entry)
{
    return mapped == pdos->mapped + pdos->mapped_count || mapped->entry != entry;
}

enum co_err slave_mapped_changed(struct slave *self, const struct od_entry *entry, co_us_t now,
                                 struct co_outbox *out)
{
    struct slave_pdos *pdos = self->pdos;
    const struct slave_mapped *mapped = slave_tpdos_of(pdos, entry);
    enum co_err worst = CO_OK;

    for (; !is_mapped_end(pdos, mapped, entry); mapped++) {
        const enum co_err err = tell_change(self, &pdos->tpdos[mapped->tpdo], now, out);

        if (err != CO_OK && worst != CO_ERR_AGAIN)
            worst = err;
    }
    return worst;
}

enum co_err slave_entry_changed(struct slave *self, struct od_entry *entry, co_us_t now,
                                struct co_outbox *out)
{
    if (entry->index <= LAST_COMMUNICATION_OBJECT)
        slave_take_over(self, entry->index, entry->sub, now, out);
    return entry->map_count == 0 ? CO_OK : slave_mapped_changed(self, entry, now, out);
}

bool slave_entry_is_timed(const struct slave *self, const struct od_entry *entry)
{
    struct slave_pdos *pdos = self->pdos;
    const struct slave_mapped *mapped;

    if (entry->index <= LAST_COMMUNICATION_OBJECT)
        return true;
    if (entry->map_count == 0)
        return false;
    mapped = slave_tpdos_of(pdos, entry);
    for (; !is_mapped_end(pdos, mapped, entry); mapped++)
        if (tpdo_is_timed(&pdos->tpdos[mapped->tpdo]))
            return true;
    return false;
}

bool slave_entry_is_sent(const struct slave *self, const struct od_entry *entry)
{
    struct slave_pdos *pdos = self->pdos;
    const struct slave_mapped *mapped;

    if (entry->map_count == 0)
        return false;
    mapped = slave_tpdos_of(pdos, entry);
    for (; !is_mapped_end(pdos, mapped, entry); mapped++)
        if (is_sent_by_change(&pdos->tpdos[mapped->tpdo]))
            return true;
    return false;
}

void slave_hold_transmission(struct slave *self, bool hold, co_us_t now, struct co_outbox *out)
{
    struct slave_pdos *pdos = self->pdos;

    pdos->hold = hold;
    for (unsigned i = 0; !hold && i < pdos->tpdo_count; i++)
        if (pdos->tpdos[i].marked) {
            pdos->tpdos[i].marked = false;
            send_now(self, &pdos->tpdos[i], now, out);
        }
}

/* ---- one RPDO ---- */

static void put_rpdo_event(struct slave *self, struct co_event event, enum slave_event type,
                           struct co_outbox *out)
{
    event.type = (uint16_t)type;
    event.node = self->node;
    event.expected = 0;
    co_outbox_put_event(out, &event);
}

static void tell_rpdo_fault(struct slave *self, const struct co_event *fault, co_us_t now,
                            struct co_outbox *out)
{
    const bool length = fault->code != RPDO_FAULT_TIMEOUT;
    const struct emcy_message error = { .code = (uint16_t)fault->code,
                                        .field = { 0, length ? STICKY_PDO_LENGTH : 0,
                                                   (uint8_t)fault->index, fault->detail,
                                                   length ? fault->sub : 0 } };

    if (fault->code == 0) {
        slave_clear_fault(self, now, out);
        return;
    }
    put_rpdo_event(self, *fault, SLAVE_PDO_ERROR, out);
    slave_raise_fault(self, &error, fault->expected != 0, now, out);
}

/* Entries that are sent, too. */
static void mirror(struct slave *self, struct rpdo *rpdo, co_us_t now, struct co_outbox *out)
{
    const uint64_t changed = rpdo->changed;

    rpdo->changed = 0;
    for (unsigned i = 0; i < rpdo->map.count && changed >> i != 0; i++)
        if ((changed >> i & 1) != 0 && rpdo->map.fields[i].entry->map_count > 1)
            slave_mapped_changed(self, rpdo->map.fields[i].entry, now, out);
}

/* Room inside for data and a fault, as far as there is room for what they mean outside. */
static void init_inner(struct co_outbox *inner, struct co_event *events,
                       const struct co_outbox *out)
{
    co_outbox_init(inner, NULL, 0, events,
                   co_outbox_room(out, 0, 3) ? 2 : co_outbox_room(out, 0, 2));
}

static void pass_on(struct slave *self, struct rpdo *rpdo, struct co_outbox *inner, co_us_t now,
                    struct co_outbox *out)
{
    struct co_event event;

    while (co_outbox_take_event(inner, &event))
        if (event.type == PROTO_RPDO)
            put_rpdo_event(self, event, SLAVE_RPDO, out);
        else
            tell_rpdo_fault(self, &event, now, out);
    if (rpdo->changed != 0)
        mirror(self, rpdo, now, out);
    note_deadline(self->pdos, rpdo_deadline(rpdo));
}

void slave_step_rpdo(struct slave *self, struct rpdo *rpdo, co_us_t now, struct co_outbox *out)
{
    struct co_event events[2];
    struct co_outbox inner;

    init_inner(&inner, events, out);
    rpdo_on_time(rpdo, now, &inner);
    pass_on(self, rpdo, &inner, now, out);
}

/* Unlike the fault, each time. */
static void tell_refused(const struct slave *self, const struct rpdo *rpdo, struct co_outbox *out)
{
    const struct co_event event = { .type = SLAVE_RPDO_REFUSED,
                                    .node = self->node,
                                    .index = rpdo->number };

    if (co_outbox_room(out, 0, 1))
        co_outbox_put_event(out, &event);
}

static void receive_rpdo(struct slave *self, struct rpdo *rpdo, const struct co_frame *frame,
                         co_us_t now, struct co_outbox *out)
{
    const unsigned errors = rpdo->errors;
    struct co_event events[2];
    struct co_outbox inner;

    if (rpdo->type <= RPDO_SYNC_TYPE_MAX && now > self->window_end) {
        rpdo_discard(rpdo);
        return;
    }
    init_inner(&inner, events, out);
    rpdo_on_frame(rpdo, frame, self->accept_long, now, &inner);
    pass_on(self, rpdo, &inner, now, out);
    if (rpdo->waiters > 0 && rpdo->errors != errors)
        tell_refused(self, rpdo, out);
}

enum co_err slave_rpdo_request(struct slave *self, uint16_t number, co_us_t now,
                               struct co_outbox *out)
{
    const struct rpdo *rpdo = slave_rpdo(self, number);
    struct co_frame frame;

    (void)now;
    if (rpdo == NULL || !rpdo_is_valid(rpdo) || rpdo->map.count == 0)
        return CO_ERR_ARG;
    if (!rpdo->running)
        return CO_ERR_STATE;
    if (!co_outbox_room(out, 1, 0))
        return CO_ERR_AGAIN;
    frame = rpdo_request_frame(rpdo);
    co_outbox_put_frame(out, &frame);
    return CO_OK;
}

void slave_expect_request(struct slave *self, uint16_t number, bool expect)
{
    struct rpdo *rpdo = slave_rpdo(self, number);

    if (rpdo == NULL || (!expect && rpdo->askers == 0))
        return;
    rpdo->askers = expect ? rpdo->askers + 1 : rpdo->askers - 1;
    self->listen_generation++;
}

/* ---- all of them ---- */

/* Data that is to go out goes before other data is taken over. */
static bool is_blocked(const struct slave_pdos *pdos, co_us_t now)
{
    return pdos->deadline <= now;
}

void slave_step_pdos(struct slave *self, co_us_t now, struct co_outbox *out)
{
    struct slave_pdos *pdos = self->pdos;
    bool blocked;

    if (now < pdos->deadline)
        return;
    pdos->deadline = CO_NEVER;
    for (unsigned i = 0; i < pdos->tpdo_count; i++)
        if (tpdo_due(&pdos->tpdos[i]) <= now)
            slave_step_tpdo(self, &pdos->tpdos[i], now, out);
        else
            note_deadline(pdos, tpdo_deadline(&pdos->tpdos[i]));
    blocked = is_blocked(pdos, now);
    for (unsigned i = 0; i < pdos->rpdo_count; i++)
        if (!blocked && rpdo_deadline(&pdos->rpdos[i]) <= now)
            slave_step_rpdo(self, &pdos->rpdos[i], now, out);
        else
            note_deadline(pdos, rpdo_deadline(&pdos->rpdos[i]));
}

void slave_sync_pdos(struct slave *self, const struct tpdo_sync *sync, co_us_t now,
                     struct co_outbox *out)
{
    struct slave_pdos *pdos = self->pdos;
    bool blocked = false;

    for (unsigned i = 0; i < pdos->tpdo_count; i++) {
        tpdo_on_sync(&pdos->tpdos[i], sync);
        if (tpdo_due(&pdos->tpdos[i]) <= now)
            slave_step_tpdo(self, &pdos->tpdos[i], now, out);
        blocked = blocked || tpdo_due(&pdos->tpdos[i]) <= now;
    }
    for (unsigned i = 0; i < pdos->rpdo_count; i++) {
        rpdo_on_sync(&pdos->rpdos[i]);
        if (!blocked && pdos->rpdos[i].due)
            slave_step_rpdo(self, &pdos->rpdos[i], now, out);
        note_deadline(pdos, rpdo_deadline(&pdos->rpdos[i]));
    }
}

static void start(struct slave *self, co_us_t now, struct co_outbox *out)
{
    struct slave_pdos *pdos = self->pdos;

    self->window_end = CO_NEVER;
    for (unsigned i = 0; i < pdos->rpdo_count; i++) {
        rpdo_start(&pdos->rpdos[i]);
        slave_step_rpdo(self, &pdos->rpdos[i], now, out);
    }
    for (unsigned i = 0; i < pdos->tpdo_count; i++) {
        tpdo_start(&pdos->tpdos[i], now);
        slave_step_tpdo(self, &pdos->tpdos[i], now, out);
    }
}

static void stop(struct slave_pdos *pdos)
{
    for (unsigned i = 0; i < pdos->rpdo_count; i++)
        rpdo_stop(&pdos->rpdos[i]);
    for (unsigned i = 0; i < pdos->tpdo_count; i++)
        tpdo_stop(&pdos->tpdos[i]);
}

void slave_run_pdos(struct slave *self, bool run, co_us_t now, struct co_outbox *out)
{
    struct slave_pdos *pdos = self->pdos;

    if (pdos->running == run)
        return;
    pdos->running = run;
    if (run)
        start(self, now, out);
    else
        stop(pdos);
}

/* ---- frames ---- */

/* Remote frames ask for TPDOs; an own data frame confirms one. */
static void hear_tpdo(struct slave *self, struct tpdo *tpdo, const struct co_frame *frame,
                      co_us_t now, struct co_outbox *out)
{
    const unsigned kind = frame->flags & (CO_FRAME_OWN | CO_FRAME_RTR);

    if (kind == CO_FRAME_RTR)
        tpdo_on_request(tpdo);
    else if (kind == CO_FRAME_OWN && tpdo->confirm && tpdo->confirms < UINT8_MAX)
        tpdo->confirms++;
    else
        return;
    slave_step_tpdo(self, tpdo, now, out);
}

/* Data, or the device's own request for it. */
static void hear_rpdo(struct slave *self, struct rpdo *rpdo, const struct co_frame *frame,
                      co_us_t now, struct co_outbox *out)
{
    const unsigned kind = frame->flags & (CO_FRAME_OWN | CO_FRAME_RTR);
    const struct co_event event = { .type = SLAVE_RPDO_ASKED,
                                    .node = self->node,
                                    .index = rpdo->number };

    if (kind == 0)
        receive_rpdo(self, rpdo, frame, now, out);
    if (kind != (CO_FRAME_OWN | CO_FRAME_RTR) || rpdo->askers == 0)
        return;
    rpdo->asked++;
    rpdo->asked_at = now;
    if (co_outbox_room(out, 0, 1))
        co_outbox_put_event(out, &event);
}

void slave_hear_pdo(struct slave *self, const struct co_frame *frame, co_us_t now,
                    struct co_outbox *out)
{
    const uint32_t can_id = frame->id | ((frame->flags & CO_FRAME_EXT) != 0 ? COB_ID_EXT : 0);
    struct slave_pdos *pdos = self->pdos;
    unsigned slot = slave_first_slot(pdos, can_id);

    for (; slot > 0; slot = pdos->next[slot - 1]) {
        struct rpdo *rpdo = slot <= pdos->rpdo_count ? &pdos->rpdos[slot - 1] : NULL;
        struct tpdo *tpdo = rpdo == NULL ? &pdos->tpdos[slot - 1 - pdos->rpdo_count] : NULL;

        if (rpdo != NULL && slave_can_id(rpdo->cob_id) == can_id)
            hear_rpdo(self, rpdo, frame, now, out);
        else if (tpdo != NULL && slave_can_id(tpdo->cob_id) == can_id)
            hear_tpdo(self, tpdo, frame, now, out);
    }
}

/* ---- what it listens to ---- */

struct list {
    struct slave_filter *filters;
    unsigned count, max;
};

static void add_filter(struct list *list, uint32_t can_id, bool rtr)
{
    if (list->count < list->max)
        list->filters[list->count] = (struct slave_filter){ .id = can_id & ~COB_ID_EXT,
                                                            .ext = (can_id & COB_ID_EXT) != 0,
                                                            .rtr = rtr };
    list->count++;
}

/* Another RPDO, with a lower number, has the same identifier. */
static bool is_shared(const struct slave_pdos *pdos, unsigned i)
{
    const uint32_t can_id = slave_can_id(pdos->rpdos[i].cob_id);
    unsigned slot = slave_first_slot(pdos, can_id);

    while (slot - 1 < i && slave_can_id(pdos->rpdos[slot - 1].cob_id) != can_id)
        slot = pdos->next[slot - 1];
    return slot - 1 < i;
}

static void list_rpdo(const struct slave_pdos *pdos, unsigned i, struct list *list)
{
    const struct rpdo *rpdo = &pdos->rpdos[i];

    if (!rpdo_is_valid(rpdo))
        return;
    if (!is_shared(pdos, i))
        add_filter(list, slave_can_id(rpdo->cob_id), false);
    if (rpdo->askers > 0) /* its own requests */
        add_filter(list, slave_can_id(rpdo->cob_id), true);
}

static void list_pdos(const struct slave_pdos *pdos, struct list *list)
{
    for (unsigned i = 0; i < pdos->rpdo_count; i++)
        list_rpdo(pdos, i, list);
    for (unsigned i = 0; i < pdos->tpdo_count; i++) {
        const struct tpdo *tpdo = &pdos->tpdos[i];

        if ((tpdo->cob_id & (COB_ID_INVALID | COB_ID_BIT30)) == 0)
            add_filter(list, slave_can_id(tpdo->cob_id), true);
        if ((tpdo->cob_id & COB_ID_INVALID) == 0 && tpdo->confirm) /* its own */
            add_filter(list, slave_can_id(tpdo->cob_id), false);
    }
}

unsigned slave_listens(const struct slave *self, struct slave_filter *ret_filters, unsigned max)
{
    struct list list = { .filters = ret_filters, .max = max };

    add_filter(&list, NMT_CAN_ID, false);
    for (unsigned i = 0; i < self->channel_count; i++)
        if (self->channels[i].server.request_id != 0)
            add_filter(&list, self->channels[i].server.request_id, false);
    add_filter(&list, NMT_ERROR_CONTROL_ID + self->node, true);
    if (self->consumes_sync)
        add_filter(&list, slave_can_id(self->sync_heard.cob_id), false);
    if (time_stamp_consumes(&self->time))
        add_filter(&list, slave_can_id(self->time.cob_id), false);
    for (unsigned i = 0; i < self->consumer_count; i++)
        if (slave_consumer_node(self, i) != 0)
            add_filter(&list, NMT_ERROR_CONTROL_ID + slave_consumer_node(self, i), false);
    for (unsigned i = 0; i < self->heard_count; i++)
        add_filter(&list, slave_heard_can_id(self, i), false);
    list_pdos(self->pdos, &list);
    return list.count;
}
