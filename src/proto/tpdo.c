#include "proto/tpdo.h"

#include "proto/event.h"

#include <string.h>

#define COB_ID_INVALID    0x80000000u
#define COB_ID_NO_REQUEST 0x40000000u
#define COB_ID_EXT        0x20000000u

void tpdo_init(struct tpdo *self, uint16_t number, struct pdo_field *fields, uint8_t room)
{
    *self = (struct tpdo){ .cob_id = COB_ID_INVALID, .number = number, .timer = CO_NEVER };
    pdo_map_init(&self->map, fields, room);
}

bool tpdo_is_valid(const struct tpdo *self)
{
    return (self->cob_id & COB_ID_INVALID) == 0 && self->map.count > 0;
}

static bool is_active(const struct tpdo *self)
{
    return self->running && tpdo_is_valid(self);
}

static bool is_cyclic(const struct tpdo *self)
{
    return self->type >= 1 && self->type <= TPDO_SYNC_TYPE_MAX;
}

static bool is_event_driven(const struct tpdo *self)
{
    return self->type >= TPDO_EVENT;
}

static void drop(struct tpdo *self)
{
    self->marked = false;
    self->event = false;
    self->by_timer = false;
    self->due = false;
    self->sampling = false;
    self->requested = false;
    self->started = false;
    self->sampled = false;
    self->count = 0;
    self->asking = TPDO_FREE;
    self->timer = CO_NEVER;
}

static void restart_timer(struct tpdo *self, co_us_t now)
{
    self->timer = self->period > 0 && is_event_driven(self) ? now + self->period : CO_NEVER;
}

static void begin(struct tpdo *self, co_us_t now)
{
    drop(self);
    if (!is_active(self))
        return;
    self->event = self->type == 0 || (is_event_driven(self) && self->notify);
    restart_timer(self, now);
}

void tpdo_configure(struct tpdo *self, const struct tpdo_parameters *parameters, co_us_t now)
{
    const bool anew = self->cob_id != parameters->cob_id || self->type != parameters->type ||
                      self->sync_start != parameters->sync_start;
    const bool retime = self->period != parameters->period;

    if (self->not_before > 0) /* the time runs from the frame sent last */
        self->not_before = self->not_before - self->inhibit + parameters->inhibit;
    self->cob_id = parameters->cob_id;
    self->type = parameters->type;
    self->sync_start = parameters->sync_start;
    self->inhibit = parameters->inhibit;
    self->period = parameters->period;
    if (anew)
        begin(self, now);
    else if (retime && is_active(self))
        restart_timer(self, now);
}

void tpdo_remapped(struct tpdo *self, co_us_t now)
{
    begin(self, now);
}

void tpdo_start(struct tpdo *self, co_us_t now)
{
    self->running = true;
    self->not_before = 0;
    begin(self, now);
}

void tpdo_stop(struct tpdo *self)
{
    drop(self);
    self->running = false;
}

void tpdo_reset(struct tpdo *self)
{
    tpdo_stop(self);
    self->not_before = 0;
    self->confirms = 0;
}

void tpdo_trigger(struct tpdo *self)
{
    if (is_active(self) && (self->type == 0 || is_event_driven(self)))
        self->event = true;
}

/* ---- SYNC ---- */

static bool is_its_turn(struct tpdo *self, uint8_t counter)
{
    if (self->type == 0)
        return self->event;
    if (!is_cyclic(self))
        return false;
    if (self->sync_start == 0 || counter == 0 || counter == self->sync_start)
        self->started = true;
    if (!self->started || ++self->count < self->type)
        return false;
    self->count = 0;
    return true;
}

void tpdo_on_sync(struct tpdo *self, const struct tpdo_sync *sync)
{
    if (!is_active(self))
        return;
    if (self->due || (self->sampling && self->asking == TPDO_ASKING))
        self->missed++; /* what the SYNC before was for */
    self->due = self->due || is_its_turn(self, sync->counter);
    self->sampling = self->type == TPDO_SYNC_REQUEST;
    self->answer_end = sync->answer_end;
    self->window_end = sync->window_end;
}

/* ---- requests ---- */

void tpdo_on_request(struct tpdo *self)
{
    if (is_active(self) && (self->cob_id & COB_ID_NO_REQUEST) == 0)
        self->requested = true;
}

/* The answer to a request is what was sent or taken with the last SYNC. */
static bool answers_with_sample(const struct tpdo *self)
{
    return self->sampled && (is_cyclic(self) || self->type == TPDO_SYNC_REQUEST);
}

/* ---- asking ---- */

static bool needs_data(const struct tpdo *self)
{
    if (!self->asks || self->asking == TPDO_ANSWERED)
        return false;
    return self->due || self->sampling || (self->requested && !answers_with_sample(self)) ||
           (self->by_timer && self->timer_asks);
}

static void ask_for_data(struct tpdo *self, co_us_t now, struct co_outbox *out)
{
    const struct co_event event = { .type = PROTO_TPDO_WANTED,
                                    .index = self->number,
                                    .code = self->ask + 1 };

    if (!co_outbox_room(out, 0, 1))
        return;
    co_outbox_put_event(out, &event);
    self->ask++;
    self->asking = TPDO_ASKING;
    self->ask_end = self->due || self->sampling ? self->answer_end : now + TPDO_ANSWER_TIME;
}

void tpdo_answer(struct tpdo *self, uint32_t ask)
{
    if (self->asking == TPDO_ASKING && ask == self->ask)
        self->asking = TPDO_ANSWERED;
}

/* False while the application is asked. */
static bool is_answered(struct tpdo *self, co_us_t now)
{
    if (self->asking != TPDO_ASKING)
        return true;
    if (now < self->ask_end)
        return false;
    self->missed++;
    self->asking = TPDO_ANSWERED;
    return true;
}

/* ---- sending ---- */

bool tpdo_is_timed(const struct tpdo *self)
{
    return self->inhibit > 0 || self->period > 0 || self->due || self->requested ||
           self->sampling || self->asking != TPDO_FREE;
}

static bool may_be_sent(const struct tpdo *self, co_us_t now)
{
    return self->due || self->requested ||
           (self->event && is_event_driven(self) &&
            (self->inhibit == 0 || now >= self->not_before));
}

static void watch_timer(struct tpdo *self, co_us_t now)
{
    if (now < self->timer)
        return;
    self->event = true;
    self->by_timer = true;
}

/* Behind its window it waits for the next SYNC; an answer that came at its end is in time. */
static void watch_window(struct tpdo *self, co_us_t now)
{
    if (!self->due || now <= self->window_end || self->asking == TPDO_ANSWERED)
        return;
    self->due = false;
    self->missed++;
}

static void take_sample(struct tpdo *self)
{
    pdo_map_read(&self->map, self->sample);
    self->sampled = true;
    self->sampling = false;
}

/* The event timer keeps its pace; after a stall it does not make up for what was missed. */
static void advance_timer(struct tpdo *self, co_us_t now)
{
    if (self->by_timer && self->timer + self->period > now)
        self->timer += self->period;
    else
        restart_timer(self, now);
}

static struct co_frame data_frame(const struct tpdo *self)
{
    const bool ext = (self->cob_id & COB_ID_EXT) != 0;
    struct co_frame frame = co_frame_make(self->cob_id & (ext ? 0x1FFFFFFFu : 0x7FFu),
                                          pdo_map_size(&self->map));

    if (ext)
        frame.flags |= CO_FRAME_EXT;
    return frame;
}

static void send(struct tpdo *self, co_us_t now, struct co_outbox *out)
{
    struct co_frame frame = data_frame(self);
    const bool old = !self->due && self->requested && answers_with_sample(self);

    if (old)
        memcpy(frame.data, self->sample, sizeof frame.data);
    else
        pdo_map_read(&self->map, frame.data);
    co_outbox_put_frame(out, &frame);
    self->sent++;
    if (self->due) {
        memcpy(self->sample, frame.data, sizeof self->sample);
        self->sampled = true;
    }
    if (self->due || is_event_driven(self)) {
        self->event = false;
        self->marked = false;
    }
    self->not_before = now + self->inhibit;
    advance_timer(self, now);
    self->by_timer = false;
    self->due = false;
    self->requested = false;
    self->asking = TPDO_FREE;
}

void tpdo_on_time(struct tpdo *self, co_us_t now, struct co_outbox *out)
{
    if (!is_active(self) || !is_answered(self, now))
        return;
    watch_window(self, now);
    watch_timer(self, now);
    if (!self->sampling && !may_be_sent(self, now))
        return;
    if (needs_data(self)) {
        ask_for_data(self, now, out);
        return;
    }
    if (self->sampling)
        take_sample(self);
    if (!may_be_sent(self, now))
        self->asking = TPDO_FREE;
    else if (co_outbox_room(out, 1, 0))
        send(self, now, out);
}

static co_us_t send_time(const struct tpdo *self)
{
    if (self->due || self->requested || self->sampling || self->asking == TPDO_ANSWERED)
        return 0;
    return self->event && is_event_driven(self) ? self->not_before : CO_NEVER;
}

co_us_t tpdo_deadline(const struct tpdo *self)
{
    if (!is_active(self))
        return CO_NEVER;
    if (self->asking == TPDO_ASKING)
        return self->ask_end;
    if (self->by_timer)
        return send_time(self);
    return co_earlier(send_time(self), self->timer);
}
