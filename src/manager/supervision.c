#include "manager/supervision.h"

#include "proto/nmt.h"

void supervision_init(struct supervision *self, uint8_t node)
{
    *self = (struct supervision){ .last_heartbeat = 0 };
    hb_consumer_init(&self->heartbeat, node);
    guard_master_init(&self->guard, node);
}

static bool is_guarded(const struct node_config *config)
{
    return config->guard_time != 0 && config->life_time_factor != 0;
}

bool supervision_is_alive(const struct supervision *self, co_us_t now)
{
    return self->last_heartbeat && now - self->last_heartbeat < self->heartbeat.period;
}

/* A heartbeat of this attempt that is not too old counts: the producer runs. */
static void take_up_heartbeat(struct supervision *self, co_us_t now, struct co_outbox *out)
{
    struct co_frame last = nmt_error_control_frame(self->heartbeat.node, self->last_state);

    if (supervision_is_alive(self, now))
        hb_consumer_on_frame(&self->heartbeat, &last, self->last_heartbeat, out);
}

bool supervision_start(struct supervision *self, const struct node_config *config, co_us_t now,
                       struct co_outbox *out, co_us_t *ret_limit)
{
    co_us_t period = CO_MS(config->consumer_heartbeat_time);

    hb_consumer_start(&self->heartbeat, period);
    if (period != 0) {
        *ret_limit = now + period;
        take_up_heartbeat(self, now, out);
        return true;
    }
    if (is_guarded(config))
        guard_master_start(&self->guard, CO_MS(config->guard_time), config->life_time_factor, now);
    return false;
}

void supervision_stop(struct supervision *self)
{
    hb_consumer_start(&self->heartbeat, 0);
    guard_master_stop(&self->guard);
}

co_us_t supervision_ask(struct supervision *self, const struct node_config *config, co_us_t now,
                        struct co_outbox *out)
{
    co_us_t limit;

    if (supervision_start(self, config, now, out, &limit))
        return limit;
    guard_master_ask(&self->guard, SUPERVISION_ASK_TIMEOUT, now);
    return CO_NEVER; /* PROTO_GUARD_LOST will tell */
}

void supervision_forget(struct supervision *self)
{
    self->last_heartbeat = 0;
}

bool supervision_is_on(const struct supervision *self)
{
    return self->heartbeat.period != 0 || self->guard.period != 0;
}

void supervision_on_frame(struct supervision *self, const struct co_frame *frame, co_us_t now,
                          struct co_outbox *out)
{
    uint8_t node, state;

    guard_master_on_frame(&self->guard, frame, now, out);
    hb_consumer_on_frame(&self->heartbeat, frame, now, out);
    if (!nmt_parse_error_control(frame, &node, &state) || state == NMT_INITIALISING)
        return;
    self->last_heartbeat = now;
    self->last_state = state;
}

void supervision_on_time(struct supervision *self, co_us_t now, struct co_outbox *out)
{
    hb_consumer_on_time(&self->heartbeat, now, out);
    guard_master_on_time(&self->guard, now, out);
}

co_us_t supervision_deadline(const struct supervision *self)
{
    return co_earlier(hb_consumer_deadline(&self->heartbeat), guard_master_deadline(&self->guard));
}
