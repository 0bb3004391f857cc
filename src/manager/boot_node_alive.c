/* What a node's boot machine makes of its error control: boot-up, heartbeats, guarding answers. */
#include "manager/boot_steps.h"

#define START_FOLLOWED 6u /* of 'unfollowed': it has followed, or never will */
#define START_COMMANDS (START_FOLLOWED / 2u)

void boot_node_on_boot_up(struct boot_node *self, const struct co_frame *frame, co_us_t now,
                          struct co_outbox *out)
{
    bool is_watched_only = !boot_node_is_booted_by_master(self) || !self->config->auto_start_slave;

    self->nmt_state = is_watched_only ? NMT_PREOPERATIONAL : NMT_INITIALISING;
    self->reset_answered = !self->reset_heard;
    self->reset_heard = true;
    if (self->step == BOOT_RESET && self->restoring == RESTORE_LATE)
        self->deadline = now;
    self->attempts = 0;
    if (self->stopped == NODE_STOPPED_AND_RESET) /* else the stop may have come after it */
        self->stopped = NODE_NOT_STOPPED;
    self->state_known = true;
    supervision_on_frame(&self->supervision, frame, now, out);
    supervision_forget(&self->supervision);
}

/* A node that was started and has never followed: the command is repeated, a few times. */
static void check_followed(struct boot_node *self, struct co_outbox *out)
{
    if (self->step != BOOT_STARTED || self->unfollowed >= START_FOLLOWED)
        return;
    if (self->nmt_state == NMT_OPERATIONAL)
        self->unfollowed = START_FOLLOWED;
    else if (++self->unfollowed == START_FOLLOWED)
        boot_node_put_event(self,
                            (struct co_event){ .type = MANAGER_NODE_UNFOLLOWED,
                                               .detail = self->nmt_state,
                                               .actual = START_COMMANDS },
                            out);
    else if (self->unfollowed % 2 == 0) /* the first may have been on its way already */
        self->start_due = true;
}

bool boot_node_is_without_heartbeat(const struct boot_node *self)
{
    return self->step == BOOT_FAILED && self->failure.letter == 'K';
}

/* It has failed for want of a heartbeat, and here is a steady one. */
static bool is_steady_at_last(const struct boot_node *self, co_us_t now)
{
    return boot_node_is_without_heartbeat(self) && supervision_is_alive(&self->supervision, now);
}

void boot_node_on_error_control(struct boot_node *self, const struct co_frame *frame, co_us_t now,
                                struct co_outbox *out)
{
    bool is_steady = is_steady_at_last(self, now);
    uint8_t node, state;

    if (!nmt_parse_error_control(frame, &node, &state) || state == NMT_INITIALISING)
        return;
    supervision_on_frame(&self->supervision, frame, now, out);
    if (state != self->nmt_state) {
        self->nmt_state = state;
        boot_node_put_event(self, (struct co_event){ .type = MANAGER_NODE_STATE, .detail = state },
                            out);
    }
    check_followed(self, out);
    self->stopped = state == NMT_STOPPED ? NODE_STOPPED : NODE_NOT_STOPPED;
    if (is_steady)
        boot_node_enter_error_control(self, now, out);
}

void boot_node_on_alive(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    if (self->step == BOOT_ERROR_CONTROL)
        boot_node_succeed(self, now, out);
    else if (self->step == BOOT_CHECK_STATE)
        boot_node_on_state_known(self, now, out);
}

bool boot_node_on_silence(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    bool checks = self->step == BOOT_CHECK_STATE;
    bool guarded = self->config->consumer_heartbeat_time == 0;
    struct boot_failure failure = { .letter = !checks   ? 'K'
                                              : guarded ? 'F'
                                                        : 'E',
                                    .step = self->step,
                                    .expected = self->config->consumer_heartbeat_time };

    if (!checks && self->step != BOOT_ERROR_CONTROL)
        return false;
    if (checks && self->unanswered)
        boot_node_fail_unanswered(self, now, out);
    else
        boot_node_fail(self, &failure, now, out);
    return true;
}
