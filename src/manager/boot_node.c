#include "manager/boot_node.h"

#include "base/bytes.h"
#include "manager/boot_steps.h"

#include <string.h>

void boot_node_init(struct boot_node *self, uint8_t node, const struct node_config *config)
{
    memset(self, 0, sizeof *self);
    self->config = config;
    self->deadline = CO_NEVER;
    self->nmt_state = NMT_INITIALISING;
    supervision_init(&self->supervision, node);
}

bool boot_node_is_booted_by_master(const struct boot_node *self)
{
    return self->config && self->config->nmt_slave;
}

bool boot_node_is_under_way(const struct boot_node *self)
{
    return (self->step >= BOOT_DEVICE_TYPE && self->step <= BOOT_ERROR_CONTROL) ||
           self->step == BOOT_CHECK_STATE || self->step == BOOT_CHECK_SOFTWARE ||
           self->step == BOOT_RESTORE;
}

bool boot_node_is_in_mid_boot(const struct boot_node *self)
{
    return boot_node_is_booted_by_master(self) && self->config->auto_start_slave &&
           boot_node_is_under_way(self) && self->step != BOOT_CHECK_STATE;
}

bool boot_node_is_written(const struct boot_node *self)
{
    return self->step == BOOT_CONFIGURE || self->step == BOOT_SAVE;
}

enum nmt_command boot_node_reset_command(const struct boot_node *self)
{
    return self->config->reset_node ? NMT_RESET_NODE : NMT_RESET_COMMUNICATION;
}

void boot_node_put_event(const struct boot_node *self, struct co_event event, struct co_outbox *out)
{
    event.node = self->config->node_id;
    co_outbox_put_event(out, &event);
}

void boot_node_enter(struct boot_node *self, enum boot_step step, struct co_outbox *out)
{
    self->step = (uint8_t)step;
    self->deadline = CO_NEVER;
    if ((step == BOOT_DEVICE_TYPE || self->unanswered) && self->told.letter == 'B')
        return; /* an absent node is asked each second: not news */
    boot_node_put_event(
        self,
        (struct co_event){ .type = MANAGER_NODE_STEP,
                           .detail = (uint8_t)step,
                           .actual = step == BOOT_CONFIGURE ? self->reader.left : 0 },
        out);
}

/* --- how an attempt ends --- */

/* One that is watched only has no boot behind that, which would begin its supervision. */
static void watch_failed(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    co_us_t limit;

    if (!self->config->auto_start_slave && !boot_node_is_without_heartbeat(self))
        supervision_start(&self->supervision, self->config, now, out, &limit);
}

void boot_node_fail(struct boot_node *self, const struct boot_failure *failure, co_us_t now,
                    struct co_outbox *out)
{
    bool retry = boot_failure_is_worth_a_retry(failure, ++self->attempts) &&
                 self->config->auto_start_slave; /* else it has no boot to be tried again */

    self->failure = *failure;
    self->history.last = *failure;
    self->history.failures++;
    self->history.failed_at = now;
    self->tried = true;
    self->booted = false;
    if (failure->outcome != SDO_OUTCOME_CANCELLED)
        self->restarts = 0;
    if (failure->letter == 'B') {
        self->nmt_state = NMT_INITIALISING;
        self->absent = failure->outcome != SDO_OUTCOME_ABORTED &&
                       failure->outcome != SDO_OUTCOME_CANCELLED;
        self->state_known = false;
    }
    if (!boot_failure_is_same(failure, &self->told)) {
        self->told = *failure;
        boot_node_put_event(self, boot_failure_event(failure), out);
    }
    self->step = retry ? BOOT_RETRY : BOOT_FAILED;
    self->deadline = retry ? now + BOOT_RETRY_INTERVAL : CO_NEVER;
    self->reset_due = self->stopped != NODE_NOT_STOPPED || failure->step == BOOT_CONFIGURE ||
                      failure->step == BOOT_SAVE;
    self->reset_command = (uint8_t)boot_node_reset_command(self);
    watch_failed(self, now, out);
}

static void fail_at_entry(struct boot_node *self, struct boot_failure failure, co_us_t now,
                          struct co_outbox *out)
{
    failure.step = self->step;
    if (self->step == BOOT_CONFIGURE) {
        failure.entry = self->entry_number;
        failure.size = self->entry.size < UINT8_MAX ? (uint8_t)self->entry.size : UINT8_MAX;
        failure.expected = (uint32_t)get_le(self->entry.value,
                                            self->entry.size < 4 ? self->entry.size : 4);
    }
    boot_node_fail(self, &failure, now, out);
}

void boot_node_fail_request(struct boot_node *self, char letter, co_us_t now, struct co_outbox *out)
{
    const struct co_event *result = &self->request.result;
    const struct boot_failure failure = {
        .letter = letter,
        .outcome = result->detail,
        .index = result->index,
        .sub = result->sub,
        .abort_code = result->code,
    };

    fail_at_entry(self, failure, now, out);
}

void boot_node_succeed(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    self->tried = true;
    self->booted = true;
    self->reset_repeated = false;
    self->attempts = 0;
    self->restarts = 0;
    self->software.tries = 0;
    self->restoring = RESTORE_TO_COME;
    self->failure = (struct boot_failure){ .letter = 0 };
    self->history.booted_at = now;
    self->told = self->failure;
    self->state_known = false; /* of the next boot */
    boot_node_put_event(
        self,
        (struct co_event){ .type = MANAGER_NODE_BOOTED, .detail = self->kept_alive ? 'L' : 0 },
        out);
    boot_node_enter(self, self->kept_alive ? BOOT_STARTED : BOOT_READY, out);
}

/* --- reads and writes --- */

void boot_node_want(struct boot_node *self, const struct sdo_transfer *transfer)
{
    self->request.transfer = *transfer;
    self->request_due = true;
}

void boot_node_read_into(struct boot_node *self, uint16_t index, uint8_t sub, uint8_t *buffer,
                         uint32_t size)
{
    struct sdo_transfer transfer = { .index = index,
                                     .sub = sub,
                                     .buffer = buffer,
                                     .size = size,
                                     .timeout = CO_MS(self->config->sdo_timeout) };

    self->tries = 1;
    boot_node_want(self, &transfer);
}

void boot_node_read(struct boot_node *self, uint16_t index, uint8_t sub)
{
    boot_node_read_into(self, index, sub, self->value, sizeof self->value);
}

/* --- the steps, last one first: each goes on to the next when it has nothing to do --- */

void boot_node_enter_error_control(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    co_us_t limit;

    if (self->config->consumer_heartbeat_time != 0)
        boot_node_enter(self, BOOT_ERROR_CONTROL, out);
    if (supervision_start(&self->supervision, self->config, now, out, &limit))
        self->deadline = limit;
    else
        boot_node_succeed(self, now, out);
}

static void ask_for_state(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    boot_node_enter(self, BOOT_CHECK_STATE, out);
    self->deadline = supervision_ask(&self->supervision, self->config, now, out);
}

/* A node to be kept alive is left alone if it is operational. */
static void enter_check_state(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    if (!self->config->check_node_state || self->state_known) {
        software_enter(self, now, out);
        return;
    }
    ask_for_state(self, now, out);
}

struct identity {
    uint8_t sub;
    char letter;
    uint32_t expected; /* 0: not compared */
};

static struct identity identity_of(const struct boot_node *self, uint8_t sub)
{
    const struct node_config *config = self->config;

    switch (sub) {
    case 1: return (struct identity){ sub, 'D', config->vendor_id };
    case 2: return (struct identity){ sub, 'M', config->product_code };
    case 3: return (struct identity){ sub, 'N', config->revision_number };
    default: return (struct identity){ 4, 'O', config->serial_number };
    }
}

/* Only what is to be compared is read: a device need not have the others. */
static void read_identity_from(struct boot_node *self, uint8_t sub, co_us_t now,
                               struct co_outbox *out)
{
    while (sub <= 4 && identity_of(self, sub).expected == 0)
        sub++;
    if (sub > 4) {
        enter_check_state(self, now, out);
        return;
    }
    if (self->step != BOOT_IDENTITY)
        boot_node_enter(self, BOOT_IDENTITY, out);
    self->part = sub;
    boot_node_read(self, 0x1018, sub);
}

/* --- results --- */

uint32_t boot_node_number_read(const struct boot_node *self)
{
    const struct co_event *result = &self->request.result;

    return (uint32_t)get_le(self->value, result->actual < 4 ? (size_t)result->actual : 4);
}

void boot_node_tell_read(const struct boot_node *self, struct co_outbox *out)
{
    boot_node_put_event(self,
                        (struct co_event){ .type = MANAGER_NODE_READ,
                                           .index = self->request.result.index,
                                           .sub = self->request.result.sub,
                                           .actual = boot_node_number_read(self) },
                        out);
}

/*
 * True if the value read is the one expected (0: any); else the attempt has failed with the letter.
 */
static bool compare(struct boot_node *self, char letter, uint32_t expected, co_us_t now,
                    struct co_outbox *out)
{
    struct boot_failure failure = { .letter = letter,
                                    .step = self->step,
                                    .index = self->request.result.index,
                                    .sub = self->request.result.sub,
                                    .expected = expected,
                                    .actual = boot_node_number_read(self) };

    boot_node_tell_read(self, out);
    if (expected == 0 || failure.actual == expected)
        return true;
    boot_node_fail(self, &failure, now, out);
    return false;
}

/* Absent when it was reset, and back without a boot-up message: who knows in which state. */
static bool has_missed_reset(const struct boot_node *self)
{
    return self->absent && !self->reset_heard && !self->reset_repeated &&
           !self->config->check_node_state;
}

/*
 * A stopped node has no SDO. Others have been reset before; one to be kept alive, without a
 * heartbeat that tells it, has to be asked.
 */
static bool may_be_stopped(const struct boot_node *self)
{
    return self->config->check_node_state && !self->state_known &&
           self->config->consumer_heartbeat_time == 0 &&
           self->request.result.detail == SDO_OUTCOME_NO_ANSWER;
}

void boot_node_fail_unanswered(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    self->unanswered = false;
    self->step = BOOT_DEVICE_TYPE;
    boot_node_fail_request(self, 'B', now, out);
}

static void on_device_type(struct boot_node *self, bool ok, co_us_t now, struct co_outbox *out)
{
    if (!ok && may_be_stopped(self)) {
        self->unanswered = true;
        ask_for_state(self, now, out);
        return;
    }
    if (!ok) {
        boot_node_fail_request(self, 'B', now, out);
        return;
    }
    if (!self->stopped_meanwhile)
        self->stopped = NODE_NOT_STOPPED;
    if (has_missed_reset(self)) {
        self->reset_repeated = true;
        boot_node_reset(self, boot_node_reset_command(self), now, out);
        return;
    }
    if (self->nmt_state == NMT_INITIALISING)
        self->nmt_state = NMT_PREOPERATIONAL;
    if (compare(self, 'C', self->config->device_type, now, out))
        read_identity_from(self, 1, now, out);
}

void boot_node_on_state_known(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    if (self->unanswered && self->supervision.last_state != NMT_STOPPED) {
        boot_node_fail_unanswered(self, now, out);
        return;
    }
    self->unanswered = false;
    self->nmt_state = self->supervision.last_state;
    if (self->nmt_state == NMT_OPERATIONAL) {
        self->kept_alive = true;
        boot_node_enter_error_control(self, now, out);
    } else {
        boot_node_reset(self, boot_node_reset_command(self), now, out);
    }
}

static void on_identity(struct boot_node *self, bool ok, co_us_t now, struct co_outbox *out)
{
    struct identity identity = identity_of(self, self->part);

    if (!ok)
        boot_node_fail_request(self, identity.letter, now, out);
    else if (compare(self, identity.letter, identity.expected, now, out))
        read_identity_from(self, (uint8_t)(identity.sub + 1), now, out);
}

/* What a step does with its answers; the others send no requests. */
static void (*const on_answer[])(struct boot_node *self, bool ok, co_us_t now,
                                 struct co_outbox *out) = {
    [BOOT_DEVICE_TYPE] = on_device_type,
    [BOOT_IDENTITY] = on_identity,
    [BOOT_CHECK_CONFIGURATION] = configure_node_on_check,
    [BOOT_CONFIGURE] = configure_node_on_done,
    [BOOT_SAVE] = configure_node_on_done,
    [BOOT_CHECK_SOFTWARE] = software_on_check,
    [BOOT_UPDATE_SOFTWARE] = software_on_update,
    [BOOT_RESTORE] = configure_node_on_done,
};

void boot_node_on_sdo(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    const struct co_event *result = &self->request.result;

    self->request.state = REQUEST_IDLE;
    if (!self->request.transfer.download && result->detail == SDO_OUTCOME_NO_ANSWER &&
        self->tries < BOOT_READ_TRIES) {
        self->tries++;
        self->request_due = true;
        return;
    }
    if (self->step < sizeof on_answer / sizeof on_answer[0] && on_answer[self->step])
        on_answer[self->step](self, result->detail == SDO_OUTCOME_OK, now, out);
}

/* --- a restart in the middle of it --- */

/* 0: not in this step. */
static char letter_of_restart(const struct boot_node *self)
{
    switch (self->step) {
    case BOOT_DEVICE_TYPE: return 'B';
    case BOOT_IDENTITY: return identity_of(self, self->part).letter;
    case BOOT_CHECK_SOFTWARE: return 'G';
    case BOOT_CHECK_CONFIGURATION:
    case BOOT_RESTORE:
    case BOOT_CONFIGURE:
    case BOOT_SAVE: return 'J';
    case BOOT_ERROR_CONTROL: return 'K';
    default: return 0;
    }
}

/*
 * One or two are usual: a boot loader, a device that comes up slowly. The one that answers our
 * reset, behind its boot delay, is none.
 */
bool boot_node_may_begin_anew(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    const bool asks = self->step != BOOT_ERROR_CONTROL;
    const struct boot_failure failure = {
        .letter = letter_of_restart(self),
        .outcome = SDO_OUTCOME_CANCELLED,
        .index = asks ? self->request.transfer.index : 0,
        .sub = asks ? self->request.transfer.sub : 0,
    };

    if (failure.letter == 0 || self->reset_answered || ++self->restarts < BOOT_RESTARTS)
        return true;
    fail_at_entry(self, failure, now, out);
    return false;
}

/* --- orders of the owner --- */

/* It is being reset. */
static void expect_boot_up(struct boot_node *self)
{
    self->reset_heard = false;
    self->absent = false;
    if (self->stopped == NODE_STOPPED)
        self->stopped = NODE_STOPPED_AND_RESET;
}

void boot_node_stop(struct boot_node *self)
{
    self->step = BOOT_IDLE;
    self->deadline = CO_NEVER;
    self->booted = false;
    self->tried = false;
    self->start_due = false;
    self->start_again = false;
    self->reset_due = false;
    expect_boot_up(self);
    self->reset_repeated = false;
    self->state_known = false;
    self->kept_alive = false;
    self->request_due = false;
    self->attempts = 0;
    self->restarts = 0;
    self->software.tries = 0;
    self->restoring = RESTORE_TO_COME;
    self->nmt_state = NMT_INITIALISING;
    supervision_forget(&self->supervision);
    self->told = (struct boot_failure){ .letter = 0 };
    supervision_stop(&self->supervision);
}

void boot_node_begin(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    self->booted = false;
    self->start_due = false;
    self->start_again = false;
    self->reset_due = false;
    self->request_due = false;
    self->held = false;
    self->lost = false;
    self->kept_alive = false;
    self->unanswered = false;
    self->stopped_meanwhile = false;
    supervision_stop(&self->supervision);
    if (!self->config->auto_start_slave) { /* only its error control is the master's */
        boot_node_enter_error_control(self, now, out);
        return;
    }
    boot_node_enter(self, BOOT_DEVICE_TYPE, out);
    boot_node_read(self, 0x1000, 0);
}

void boot_node_reset(struct boot_node *self, enum nmt_command command, co_us_t now,
                     struct co_outbox *out)
{
    self->booted = false;
    self->start_due = false;
    self->start_again = false;
    self->request_due = false;
    expect_boot_up(self);
    supervision_forget(&self->supervision);
    self->nmt_state = NMT_INITIALISING;
    self->reset_command = (uint8_t)command;
    self->state_known = true;
    supervision_stop(&self->supervision);
    boot_node_enter(self, BOOT_RESET, out);
    self->reset_due = true;
    self->deadline = now;
    boot_node_on_time(self, now, out);
}

void boot_node_start(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    self->start_due = true;
    boot_node_on_time(self, now, out);
}

void boot_node_commanded(struct boot_node *self, enum nmt_command command)
{
    if (command == NMT_STOP || command == NMT_START || command == NMT_ENTER_PREOPERATIONAL)
        self->stopped = command == NMT_STOP ? NODE_STOPPED : NODE_NOT_STOPPED;
    self->stopped_meanwhile |= command == NMT_STOP;
    if (command != NMT_START)
        self->start_again = false;
    if (self->step != BOOT_READY && self->step != BOOT_STARTED)
        return;
    self->start_due = false;
    self->unfollowed = 0;
    self->step = command == NMT_START ? BOOT_STARTED : BOOT_READY;
    self->held = command != NMT_START;
    if (!supervision_is_on(&self->supervision))
        self->nmt_state = (uint8_t)nmt_next_state((enum nmt_state)self->nmt_state, command);
}

/* --- time --- */

static void send_start(struct boot_node *self, struct co_outbox *out)
{
    struct co_frame frame = nmt_command_frame(NMT_START, self->config->node_id);
    uint8_t unfollowed = self->step == BOOT_STARTED ? self->unfollowed : 0;

    if (!co_outbox_room(out, 1, 0))
        return;
    co_outbox_put_frame(out, &frame);
    self->start_due = false;
    self->start_again = false;
    boot_node_commanded(self, NMT_START);
    self->unfollowed = unfollowed; /* goes on where the command is repeated */
    boot_node_put_event(self, (struct co_event){ .type = MANAGER_NODE_STARTED }, out);
}

static void on_reset_time(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    struct co_frame frame = nmt_command_frame((enum nmt_command)self->reset_command,
                                              self->config->node_id);

    if (!self->reset_due) {
        configure_node_on_restart(self, now, out);
        return;
    }
    if (!co_outbox_room(out, 1, 0))
        return;
    co_outbox_put_frame(out, &frame);
    self->reset_due = false;
    self->deadline = now + CO_MS(self->config->boot_delay);
}

void boot_node_on_time(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    supervision_on_time(&self->supervision, now, out);
    if (self->start_due)
        send_start(self, out);
    if (now < self->deadline)
        return;
    if (self->step == BOOT_RESET)
        on_reset_time(self, now, out);
    else if (self->step == BOOT_ERROR_CONTROL || self->step == BOOT_CHECK_STATE)
        boot_node_on_silence(self, now, out);
    else if (self->step == BOOT_UPDATE_SOFTWARE)
        software_on_time(self);
    else if (self->step == BOOT_RETRY && self->reset_due)
        boot_node_reset(self, (enum nmt_command)self->reset_command, now, out);
    else if (self->step == BOOT_RETRY)
        boot_node_begin(self, now, out);
}

co_us_t boot_node_deadline(const struct boot_node *self)
{
    co_us_t deadline = co_earlier(self->deadline, supervision_deadline(&self->supervision));

    return self->start_due ? 0 : deadline;
}
