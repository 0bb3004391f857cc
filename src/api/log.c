#include "api/log.h"

#include "api/callback.h"
#include "mcanopen.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct {
    pthread_mutex_t lock;
    MCANOPEN_LOG_T hook;
    void *context;
} hook_slot = { .lock = PTHREAD_MUTEX_INITIALIZER };

static _Thread_local bool in_hook;

/* Messages for later: severity and text, each with a NUL. */
static _Thread_local struct {
    bool wanted;
    FILE *stream; /* NULL: none yet, or no memory */
    char *messages;
    size_t size;
} kept;

int mcanOpenSetLog(MCANOPEN_LOG_T hook, void *context)
{
    pthread_mutex_lock(&hook_slot.lock);
    hook_slot.hook = hook;
    hook_slot.context = context;
    pthread_mutex_unlock(&hook_slot.lock);
    return MCANOPEN_OK;
}

void log_reset(void)
{
    mcanOpenSetLog(NULL, NULL);
}

static int level_of(enum co_severity severity)
{
    switch (severity) {
    case CO_ERROR: return MCANOPEN_LOG_ERROR;
    case CO_WARNING: return MCANOPEN_LOG_WARNING;
    case CO_INFO: return MCANOPEN_LOG_INFO;
    }
    return MCANOPEN_LOG_ERROR;
}

static void tell(enum co_severity severity, const char *text)
{
    MCANOPEN_LOG_T hook;
    void *context;

    pthread_mutex_lock(&hook_slot.lock);
    hook = hook_slot.hook;
    context = hook_slot.context;
    pthread_mutex_unlock(&hook_slot.lock);
    if (hook && !in_hook) { /* what a hook causes does not come back to it */
        in_hook = true;
        callback_begin();
        hook(context, level_of(severity), text);
        callback_end();
        in_hook = false;
    } else if (severity != CO_INFO) {
        fprintf(stderr, "%s\n", text);
    }
}

/* Without memory it cannot wait for the hook. */
static void keep(enum co_severity severity, const char *text)
{
    if (!kept.stream)
        kept.stream = open_memstream(&kept.messages, &kept.size);
    if (kept.stream)
        fprintf(kept.stream, "%c%s%c", '0' + (int)severity, text, 0);
    else
        fprintf(stderr, "%s\n", text);
}

void log_put(enum co_severity severity, const char *text)
{
    if (kept.wanted)
        keep(severity, text);
    else
        tell(severity, text);
}

void log_keep(void)
{
    kept.wanted = true;
}

void log_release(void)
{
    char *messages;

    kept.wanted = false;
    if (!kept.stream)
        return;
    fclose(kept.stream);
    kept.stream = NULL;
    messages = kept.messages;
    for (size_t i = 0; i < kept.size; i += strlen(messages + i) + 1)
        tell((enum co_severity)(messages[i] - '0'), messages + i + 1);
    free(messages);
}

void log_sink(void *context, const struct co_message *message)
{
    (void)context;
    log_put(message->severity, message->text);
}
