#include "support/api_wire.h"

#include "port/bus.h"
#include "port/clock.h"
#include "port/thread.h"
#include "support/api_plant.h"

#include <stdlib.h>
#include <string.h>

#define RULES  32u
#define FRAMES 131072u

struct rule {
    const char *request, *answer;
};

struct api_wire {
    struct co_lock lock; /* of all below, and of sending */
    struct co_condition changed;
    struct co_thread thread;
    struct bus *bus;
    struct rule rules[RULES];
    unsigned rule_count;
    char (*frames)[CO_FRAME_TEXT_SIZE];
    co_us_t *times; /* of the frames */
    unsigned frame_count;
    bool stop;
};

static bool begins_like(const char *text, const char *beginning)
{
    return strncmp(text, beginning, strlen(beginning)) == 0;
}

static void say(struct api_wire *self, const char *text)
{
    struct co_frame frame;

    ck_assert_msg(co_frame_parse(text, &frame), "no frame: %s", text);
    ck_assert_int_eq(bus_send(self->bus, &frame), CO_OK);
}

static void on_frame(struct api_wire *self, const struct bus_rx *rx)
{
    char *text;

    ck_assert_uint_lt(self->frame_count, FRAMES);
    self->times[self->frame_count] = rx->time;
    text = self->frames[self->frame_count++];
    co_frame_format(&rx->frame, text, CO_FRAME_TEXT_SIZE);
    for (unsigned i = self->rule_count; i-- > 0;) {
        if (!begins_like(text, self->rules[i].request))
            continue;
        if (self->rules[i].answer[0])
            say(self, self->rules[i].answer);
        break;
    }
    condition_signal(&self->changed);
}

static void *run(void *context)
{
    struct api_wire *self = context;
    struct bus_rx rx;
    bool stop = false;

    while (!stop) {
        bus_wait(self->bus, CO_NEVER);
        lock_take(&self->lock);
        while (bus_receive(self->bus, &rx) == CO_OK)
            on_frame(self, &rx);
        stop = self->stop;
        lock_give(&self->lock);
    }
    return NULL;
}

struct api_wire *api_wire_open(const char *bus)
{
    struct api_wire *self = calloc(1, sizeof *self);
    const struct bus_options options = { .own_frames = false };
    const struct bus_filter all = { .mask = 0 };
    char message[200] = "";

    ck_assert_ptr_nonnull(self);
    self->frames = calloc(FRAMES, sizeof *self->frames);
    self->times = calloc(FRAMES, sizeof *self->times);
    ck_assert(self->frames && self->times);
    ck_assert_int_eq(lock_init(&self->lock), CO_OK);
    ck_assert_int_eq(condition_init(&self->changed), CO_OK);
    ck_assert_msg(bus_open(bus, &options, &self->bus, message, sizeof message) == CO_OK, "%s",
                  message);
    ck_assert_int_eq(bus_set_filters(self->bus, &all, 1), CO_OK);
    ck_assert_int_eq(thread_start(&self->thread, "wire", run, self), CO_OK);
    return self;
}

void api_wire_close(struct api_wire *self)
{
    lock_take(&self->lock);
    self->stop = true;
    lock_give(&self->lock);
    bus_wake(self->bus);
    thread_join(&self->thread);
    bus_close(self->bus);
    condition_done(&self->changed);
    lock_done(&self->lock);
    free(self->frames);
    free(self->times);
    free(self);
}

void api_wire_answer(struct api_wire *self, const char *request, const char *answer)
{
    lock_take(&self->lock);
    ck_assert_uint_lt(self->rule_count, RULES);
    self->rules[self->rule_count++] = (struct rule){ request, answer };
    lock_give(&self->lock);
}

void api_wire_say(struct api_wire *self, const char *frame)
{
    lock_take(&self->lock);
    say(self, frame);
    lock_give(&self->lock);
}

static unsigned count(const struct api_wire *self, const char *frame)
{
    unsigned times = 0;

    for (unsigned i = 0; i < self->frame_count; i++)
        times += begins_like(self->frames[i], frame);
    return times;
}

unsigned api_wire_count(struct api_wire *self, const char *frame)
{
    unsigned times;

    lock_take(&self->lock);
    times = count(self, frame);
    lock_give(&self->lock);
    return times;
}

void api_wire_wait(struct api_wire *self, const char *frame, unsigned expected)
{
    co_us_t limit = clock_now() + API_PATIENCE;
    enum co_err err = CO_OK;
    unsigned times;

    lock_take(&self->lock);
    while ((times = count(self, frame)) < expected && err != CO_ERR_TIMEOUT)
        err = condition_wait(&self->changed, &self->lock, limit);
    lock_give(&self->lock);
    ck_assert_msg(times >= expected, "%s: %u times, not %u", frame, times, expected);
}

co_us_t api_wire_time(struct api_wire *self, const char *frame, unsigned number)
{
    co_us_t time = 0;
    unsigned times = 0;

    api_wire_wait(self, frame, number);
    lock_take(&self->lock);
    for (unsigned i = 0; times < number; i++) {
        times += begins_like(self->frames[i], frame);
        time = self->times[i];
    }
    lock_give(&self->lock);
    return time;
}

void api_wire_settle(struct api_wire *self)
{
    unsigned before = api_wire_count(self, "5FF#");
    unsigned char buffer[4];
    int len = sizeof buffer;

    ck_assert_int_eq(mcanOpenReadSDO(0, 127, 0x1000, 0, buffer, &len, NULL), MCANOPEN_OK);
    api_wire_wait(self, "5FF#", before + 1);
}
