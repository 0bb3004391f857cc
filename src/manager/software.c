#include "manager/software.h"

#include "base/bytes.h"
#include "manager/boot_steps.h"

#define PROGRAM_DATA    0x1F50
#define PROGRAM_CONTROL 0x1F51
#define PROGRAM_ID      0x1F56
#define FLASH_STATUS    0x1F57

#define FLASH_BUSY       1u
#define FLASH_NO_PROGRAM 1u /* error code, in its bits 1 to 7 */

static const uint8_t stop = 0, start = 1, clear = 3; /* written to 1F51h */

static const struct phase { /* by enum software_phase */
    uint16_t index;
    const uint8_t *command; /* written; NULL: read, or the program */
    co_us_t limit;          /* not 0: asked again and again, so long */
} phases[] = {
    [SOFTWARE_ASK] = { PROGRAM_CONTROL, NULL, 0 },
    [SOFTWARE_STOP] = { PROGRAM_CONTROL, &stop, 0 },
    [SOFTWARE_STOPPING] = { PROGRAM_CONTROL, NULL, SOFTWARE_STATE_LIMIT },
    [SOFTWARE_CLEAR] = { PROGRAM_CONTROL, &clear, 0 },
    [SOFTWARE_CLEARING] = { FLASH_STATUS, NULL, SOFTWARE_FLASH_LIMIT },
    [SOFTWARE_WRITE] = { PROGRAM_DATA, NULL, 0 },
    [SOFTWARE_WRITING] = { FLASH_STATUS, NULL, SOFTWARE_FLASH_LIMIT },
    [SOFTWARE_COMPARE] = { PROGRAM_ID, NULL, 0 },
    [SOFTWARE_START] = { PROGRAM_CONTROL, &start, 0 },
    [SOFTWARE_STARTING] = { PROGRAM_CONTROL, NULL, SOFTWARE_STATE_LIMIT },
};

/* --- how it fails --- */

static void fail(struct boot_node *self, struct boot_failure failure, co_us_t now,
                 struct co_outbox *out)
{
    failure.step = self->step;
    failure.entry = self->step == BOOT_UPDATE_SOFTWARE ? self->software.phase : 0;
    boot_node_fail(self, &failure, now, out);
}

/* With the answer that was not the one awaited; what it was read for has taken too long, or not. */
static void fail_answer(struct boot_node *self, co_us_t waited, co_us_t now, struct co_outbox *out)
{
    const struct co_event *result = &self->request.result;
    bool known = result->detail == SDO_OUTCOME_OK && !self->request.transfer.download;
    struct boot_failure failure = { .letter = 'I',
                                    .outcome = result->detail,
                                    .index = result->index,
                                    .sub = result->sub,
                                    .abort_code = result->code,
                                    .expected = (uint32_t)(waited / 1000u),
                                    .actual = known ? boot_node_number_read(self) : 0 };

    fail(self, failure, now, out);
}

static void fail_request(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    fail_answer(self, self->request.transfer.timeout, now, out);
}

/* --- phases --- */

static void write_program(struct boot_node *self, const struct phase *phase)
{
    const struct node_config *config = self->config;
    const uint8_t blocks = config->sdo_block_size ? config->sdo_block_size : SOFTWARE_BLOCK_SIZE;
    struct sdo_transfer transfer = { .download = true,
                                     .indicate_size = config->indicate_size,
                                     .index = phase->index,
                                     .sub = 1,
                                     .source = phase->command,
                                     .size = 1,
                                     .timeout = configure_node_timeout(config, phase->index) };

    if (phase->index == PROGRAM_DATA) {
        transfer.block = blocks;
        transfer.source = config->software;
        transfer.size = config->software_size;
    }
    boot_node_want(self, &transfer);
}

/* Of one that is asked again and again, the first question comes after a pause. */
static void enter_phase(struct boot_node *self, enum software_phase number, co_us_t now,
                        struct co_outbox *out)
{
    const struct phase *phase = &phases[number];
    bool writes = phase->command || phase->index == PROGRAM_DATA;

    self->software.phase = (uint8_t)number;
    self->software.limit = now + phase->limit;
    self->deadline = phase->limit ? now + SOFTWARE_PAUSE : CO_NEVER;
    if (writes)
        write_program(self, phase);
    else if (phase->limit == 0)
        boot_node_read(self, phase->index, 1);
    if (phase->limit == 0 && number != SOFTWARE_ASK)
        boot_node_put_event(self,
                            (struct co_event){ .type = MANAGER_NODE_SOFTWARE,
                                               .detail = (uint8_t)number,
                                               .actual = self->config->software_size },
                            out);
}

void software_on_time(struct boot_node *self)
{
    self->deadline = CO_NEVER;
    boot_node_read(self, phases[self->software.phase].index, 1);
    self->tries = BOOT_READ_TRIES; /* silence is an answer here */
}

static void ask_again(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    if (now >= self->software.limit)
        fail_answer(self, phases[self->software.phase].limit, now, out);
    else
        self->deadline = now + SOFTWARE_PAUSE;
}

/* --- answers --- */

static bool is_silence(const struct boot_node *self)
{
    return self->request.result.detail == SDO_OUTCOME_NO_ANSWER;
}

static bool is_aborted(const struct boot_node *self)
{
    return self->request.result.detail == SDO_OUTCOME_ABORTED;
}

/* One that cannot tell its state is asked to stop all the same. */
static void on_asked(struct boot_node *self, bool ok, co_us_t now, struct co_outbox *out)
{
    if (ok && boot_node_number_read(self) == stop)
        enter_phase(self, SOFTWARE_CLEAR, now, out);
    else if (ok || is_aborted(self))
        enter_phase(self, SOFTWARE_STOP, now, out);
    else
        fail_request(self, now, out);
}

/* STOP and START: it may be gone before it has answered. */
static void on_switched(struct boot_node *self, bool ok, co_us_t now, struct co_outbox *out)
{
    if (ok || is_silence(self))
        enter_phase(self, (enum software_phase)(self->software.phase + 1u), now, out);
    else
        fail_request(self, now, out);
}

/* One that does not let its state be read is taken at its word. */
static void on_stopping(struct boot_node *self, bool ok, co_us_t now, struct co_outbox *out)
{
    if (is_aborted(self) || (ok && boot_node_number_read(self) == stop))
        enter_phase(self, SOFTWARE_CLEAR, now, out);
    else if (ok || is_silence(self))
        ask_again(self, now, out);
    else
        fail_request(self, now, out);
}

static void on_starting(struct boot_node *self, bool ok, co_us_t now, struct co_outbox *out)
{
    if (is_aborted(self) || (ok && boot_node_number_read(self) == start))
        boot_node_begin(self, now, out);
    else if (ok || is_silence(self))
        ask_again(self, now, out);
    else
        fail_request(self, now, out);
}

/* CLEAR, WRITE */
static void on_written(struct boot_node *self, bool ok, co_us_t now, struct co_outbox *out)
{
    if (ok)
        enter_phase(self, (enum software_phase)(self->software.phase + 1u), now, out);
    else
        fail_request(self, now, out);
}

/* The device has no such object. */
static bool is_absent(const struct boot_node *self)
{
    sdo_abort_t code = self->request.result.code;

    return is_aborted(self) && (code == SDO_NO_OBJECT || code == SDO_NO_SUB);
}

/* What may be over next time: the device is busy, or does not answer meanwhile. */
static bool is_busy(const struct boot_node *self, bool ok)
{
    sdo_abort_t code = self->request.result.code;

    if (ok)
        return (boot_node_number_read(self) & FLASH_BUSY) != 0;
    return is_silence(self) || (is_aborted(self) && code == SDO_DEVICE_STATE);
}

/* CLEARING, WRITING */
static void on_flash(struct boot_node *self, bool ok, co_us_t now, struct co_outbox *out)
{
    bool clearing = self->software.phase == SOFTWARE_CLEARING;
    uint32_t error = ok ? boot_node_number_read(self) >> 1 & 0x7Fu : 0;
    bool good = error == 0 || (clearing && error == FLASH_NO_PROGRAM);

    if (is_busy(self, ok))
        ask_again(self, now, out);
    else if ((ok && good) || is_absent(self))
        enter_phase(self, clearing ? SOFTWARE_WRITE : SOFTWARE_COMPARE, now, out);
    else
        fail_request(self, now, out);
}

/* One that does not tell it now may do so when it runs: the next boot asks again. */
static void on_compare(struct boot_node *self, bool ok, co_us_t now, struct co_outbox *out)
{
    struct boot_failure failure = { .letter = 'I',
                                    .index = PROGRAM_ID,
                                    .sub = 1,
                                    .expected = self->config->software_identification };

    if (!ok && !is_aborted(self)) {
        fail_request(self, now, out);
        return;
    }
    failure.actual = boot_node_number_read(self);
    if (ok && failure.actual != failure.expected)
        fail(self, failure, now, out);
    else
        enter_phase(self, SOFTWARE_START, now, out);
}

void software_on_update(struct boot_node *self, bool ok, co_us_t now, struct co_outbox *out)
{
    static void (*const on_answer[])(struct boot_node *, bool, co_us_t, struct co_outbox *) = {
        [SOFTWARE_ASK] = on_asked,         [SOFTWARE_STOP] = on_switched,
        [SOFTWARE_STOPPING] = on_stopping, [SOFTWARE_CLEAR] = on_written,
        [SOFTWARE_CLEARING] = on_flash,    [SOFTWARE_WRITE] = on_written,
        [SOFTWARE_WRITING] = on_flash,     [SOFTWARE_COMPARE] = on_compare,
        [SOFTWARE_START] = on_switched,    [SOFTWARE_STARTING] = on_starting,
    };

    on_answer[self->software.phase](self, ok, now, out);
}

/* --- it has started anew --- */

/* What was under way is begun again: once, else it might go on for ever. */
static void repeat(struct boot_node *self, enum software_phase phase, co_us_t now,
                   struct co_outbox *out)
{
    const struct boot_failure restarted = { .letter = 'I',
                                            .outcome = SDO_OUTCOME_CANCELLED,
                                            .index = phases[self->software.phase].index,
                                            .sub = 1 };

    if (self->software.repeated || phase == SOFTWARE_WRITE) {
        fail(self, restarted, now, out);
        return;
    }
    self->software.repeated = true;
    enter_phase(self, phase, now, out);
}

void software_on_boot_up(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    enum software_phase phase = (enum software_phase)self->software.phase;

    switch (phase) {
    case SOFTWARE_STOP: enter_phase(self, SOFTWARE_STOPPING, now, out); break;
    case SOFTWARE_STOPPING:
    case SOFTWARE_WRITING: self->deadline = now + SOFTWARE_PAUSE; break; /* the limit stays */
    case SOFTWARE_CLEARING: repeat(self, SOFTWARE_CLEAR, now, out); break;
    case SOFTWARE_START:
    case SOFTWARE_STARTING: boot_node_begin(self, now, out); break;
    case SOFTWARE_ASK:
    case SOFTWARE_CLEAR:
    case SOFTWARE_WRITE:
    case SOFTWARE_COMPARE: repeat(self, phase, now, out); break;
    }
}

/* --- the check before --- */

static bool may_update(const struct node_config *config)
{
    return config->allow_software_update && !config->check_node_state;
}

static void enter_update(struct boot_node *self, enum software_phase phase, co_us_t now,
                         struct co_outbox *out)
{
    self->software.tries++;
    self->software.repeated = false;
    boot_node_enter(self, BOOT_UPDATE_SOFTWARE, out);
    enter_phase(self, phase, now, out);
}

/* With the answer, which is not the one expected. */
static void fail_check(struct boot_node *self, char letter, uint32_t expected, co_us_t now,
                       struct co_outbox *out)
{
    struct boot_failure failure = { .letter = letter,
                                    .index = self->request.result.index,
                                    .sub = self->request.result.sub,
                                    .expected = expected,
                                    .actual = boot_node_number_read(self) };

    fail(self, failure, now, out);
}

static void on_other_program(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    const struct node_config *config = self->config;

    if (!may_update(config))
        fail_check(self, 'H', config->software_identification, now, out);
    else if (!config->software || self->software.tries >= SOFTWARE_TRIES)
        fail_check(self, 'I', config->software_identification, now, out);
    else
        enter_update(self, SOFTWARE_ASK, now, out);
}

/* An update may have ended between the program and its start, and the manager have gone since. */
static void on_state(struct boot_node *self, bool ok, co_us_t now, struct co_outbox *out)
{
    if (!ok || boot_node_number_read(self) != stop)
        configure_node_enter(self, now, out);
    else if (self->software.tries >= SOFTWARE_TRIES)
        fail_check(self, 'I', start, now, out);
    else
        enter_update(self, SOFTWARE_START, now, out);
}

static void on_identification(struct boot_node *self, bool ok, co_us_t now, struct co_outbox *out)
{
    if (!ok) {
        boot_node_fail_request(self, 'G', now, out);
        return;
    }
    boot_node_tell_read(self, out);
    if (boot_node_number_read(self) != self->config->software_identification)
        on_other_program(self, now, out);
    else if (may_update(self->config))
        boot_node_read(self, PROGRAM_CONTROL, 1);
    else
        configure_node_enter(self, now, out);
}

void software_on_check(struct boot_node *self, bool ok, co_us_t now, struct co_outbox *out)
{
    if (self->request.result.index == PROGRAM_ID)
        on_identification(self, ok, now, out);
    else
        on_state(self, ok, now, out);
}

void software_enter(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    if (!self->config->verify_software) {
        configure_node_enter(self, now, out);
        return;
    }
    boot_node_enter(self, BOOT_CHECK_SOFTWARE, out);
    if (self->config->software_identification == 0)
        fail(self, (struct boot_failure){ .letter = 'G', .index = PROGRAM_ID, .sub = 1 }, now, out);
    else
        boot_node_read(self, PROGRAM_ID, 1);
}
