#include "api/log.h"

#include "api/callback.h"
#include "mcanopen.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>

static struct {
    pthread_mutex_t lock;
    MCANOPEN_LOG_T hook;
    void *context;
} hook_slot = { .lock = PTHREAD_MUTEX_INITIALIZER };

static _Thread_local bool in_hook;

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

void log_put(enum co_severity severity, const char *text)
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

void log_sink(void *context, enum co_severity severity, const char *text)
{
    (void)context;
    log_put(severity, text);
}
