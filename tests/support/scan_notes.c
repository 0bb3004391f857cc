#include "support/scan_notes.h"

#include "support/scan_plant.h"

#include <check.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define NOTES   4096u
#define OBJECTS 32u

/* Handlers get no context, so this is the process's. */
static struct {
    pthread_mutex_t lock;
    pthread_cond_t changed;
    char lines[NOTES][SCAN_NOTE_SIZE];
    unsigned count, next;
    int event_result, data_result;
    int indices[OBJECTS];
    unsigned sizes[OBJECTS];
    unsigned objects;
} notes = { .lock = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER };

void scan_notes_clear(void)
{
    pthread_mutex_lock(&notes.lock);
    notes.count = notes.next = notes.objects = 0;
    notes.event_result = notes.data_result = SCANOPEN_OK;
    pthread_mutex_unlock(&notes.lock);
}

void scan_note(const char *format, ...)
{
    va_list arguments;

    va_start(arguments, format);
    pthread_mutex_lock(&notes.lock);
    if (notes.count < NOTES)
        vsnprintf(notes.lines[notes.count++], SCAN_NOTE_SIZE, format, arguments);
    pthread_cond_broadcast(&notes.changed);
    pthread_mutex_unlock(&notes.lock);
    va_end(arguments);
}

/* False: none came in time. */
static bool take_note(char text[SCAN_NOTE_SIZE])
{
    struct timespec limit;
    int err = 0;
    bool there;

    clock_gettime(CLOCK_REALTIME, &limit);
    limit.tv_sec += SCAN_PATIENCE_S;
    pthread_mutex_lock(&notes.lock);
    while (notes.next == notes.count && err == 0)
        err = pthread_cond_timedwait(&notes.changed, &notes.lock, &limit);
    there = notes.next < notes.count;
    if (there)
        memcpy(text, notes.lines[notes.next++], SCAN_NOTE_SIZE);
    pthread_mutex_unlock(&notes.lock);
    return there;
}

void scan_expect_note(const char *text)
{
    char got[SCAN_NOTE_SIZE] = "";

    ck_assert_msg(take_note(got), "no note; expected: %s", text);
    ck_assert_str_eq(got, text);
}

void scan_await_note(const char *text)
{
    char got[SCAN_NOTE_SIZE] = "", last[SCAN_NOTE_SIZE] = "";

    while (take_note(got)) {
        if (strcmp(got, text) == 0)
            return;
        memcpy(last, got, sizeof last);
    }
    ck_abort_msg("not noted: %s; last note: %s", text, last);
}

void scan_expect_no_note(void)
{
    char got[SCAN_NOTE_SIZE] = "";

    pthread_mutex_lock(&notes.lock);
    if (notes.next < notes.count)
        memcpy(got, notes.lines[notes.next], SCAN_NOTE_SIZE);
    pthread_mutex_unlock(&notes.lock);
    ck_assert_str_eq(got, "");
}

unsigned scan_count_notes(const char *text)
{
    unsigned times = 0;

    pthread_mutex_lock(&notes.lock);
    for (unsigned i = 0; i < notes.count; i++)
        times += strcmp(notes.lines[i], text) == 0;
    pthread_mutex_unlock(&notes.lock);
    return times;
}

/* --- node events --- */

static const char *const kinds[] = {
    "GUARDING",           "STATE_CHANGE",     "RESET", "CONFIGURATION", "CAN", "EMCY",
    "CONSUMER_HEARTBEAT", "WRITE_DICTIONARY", "SYNC",  "HANDLER",       "TIME"
};

static const char *kind_of(unsigned long event)
{
    for (unsigned i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        if (event == 1UL << i)
            return kinds[i];
    return "?";
}

static void note_emcy(const SLAVE_EVENT *event)
{
    const SLAVE_EMCY *emcy = event->arg.pArg2;
    char bytes[17];

    for (unsigned i = 0; i < 8; i++)
        snprintf(bytes + 2 * i, 3, "%02X", (unsigned)emcy->ucData[i]);
    scan_note("event %u/%u EMCY %lX %u %s", (unsigned)event->usNetNo, (unsigned)event->usModId,
              emcy->ulCobId, (unsigned)emcy->usNodeId, bytes);
}

static void note_time(const SLAVE_EVENT *event)
{
    const CAN_TIME_OF_DAY *time = event->arg.pArg2;

    scan_note("event %u/%u TIME %lu %u", (unsigned)event->usNetNo, (unsigned)event->usModId,
              time->ulMs, (unsigned)time->usDays);
}

int scan_on_event(SLAVE_EVENT *event)
{
    int result;

    if (event->ulEvent == EV_EMCY)
        note_emcy(event);
    else if (event->ulEvent == EV_TIME)
        note_time(event);
    else
        scan_note("event %u/%u %s %lu %lu", (unsigned)event->usNetNo, (unsigned)event->usModId,
                  kind_of(event->ulEvent), event->ulArg1, event->arg.ulArg2);
    pthread_mutex_lock(&notes.lock);
    result = notes.event_result;
    pthread_mutex_unlock(&notes.lock);
    return result;
}

void scan_on_event_returns(int result)
{
    pthread_mutex_lock(&notes.lock);
    notes.event_result = result;
    pthread_mutex_unlock(&notes.lock);
}

/* --- object handlers --- */

static unsigned size_of(int index)
{
    unsigned size = 1;

    pthread_mutex_lock(&notes.lock);
    for (unsigned i = 0; i < notes.objects; i++)
        if (notes.indices[i] == index)
            size = notes.sizes[i];
    pthread_mutex_unlock(&notes.lock);
    return size;
}

/* This machine is little-endian, as the bus is. */
static void format_value(const void *data, unsigned size, char text[17])
{
    const unsigned char *bytes = data;

    text[0] = '\0';
    for (unsigned i = 0; i < size; i++)
        snprintf(text + 2 * i, 3, "%02X", (unsigned)bytes[i]);
}

int scan_on_data(int net, int node, int index, int sub, void *data)
{
    char value[17] = "?";
    int result;

    if (data)
        format_value(data, size_of(index), value);
    scan_note("data %d/%d %04X:%02X %s", net, node, (unsigned)index, (unsigned)sub, value);
    pthread_mutex_lock(&notes.lock);
    result = notes.data_result;
    pthread_mutex_unlock(&notes.lock);
    return result;
}

void scan_on_data_size(int index, unsigned size)
{
    pthread_mutex_lock(&notes.lock);
    if (notes.objects < OBJECTS && size <= 8) {
        notes.indices[notes.objects] = index;
        notes.sizes[notes.objects++] = size;
    }
    pthread_mutex_unlock(&notes.lock);
}

void scan_on_data_returns(int result)
{
    pthread_mutex_lock(&notes.lock);
    notes.data_result = result;
    pthread_mutex_unlock(&notes.lock);
}
