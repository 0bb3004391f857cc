#include "api/registry.h"

#include "api/log.h"

static struct registry registry = { .lock = PTHREAD_MUTEX_INITIALIZER,
                                    .idle = PTHREAD_COND_INITIALIZER };

int registry_enter(int net, bool running, struct managed **ret_managed)
{
    int result = MCAL_NO_NET;

    if (net < 0 || net > UINT8_MAX)
        return MCAL_PARA_ERROR;
    pthread_mutex_lock(&registry.lock);
    if (registry.state == REGISTRY_NEW)
        result = MCAL_SYS_ERROR;
    for (size_t i = 0; i < registry.network_count && !registry.changing; i++) {
        if (registry.networks[i].config->net != net)
            continue;
        if (running && registry.state != REGISTRY_RUNNING) {
            result = MCAL_SYS_ERROR;
            break;
        }
        *ret_managed = &registry.networks[i];
        registry.users++;
        result = MCANOPEN_OK;
    }
    pthread_mutex_unlock(&registry.lock);
    return result;
}

void registry_leave(void)
{
    pthread_mutex_lock(&registry.lock);
    if (--registry.users == 0)
        pthread_cond_broadcast(&registry.idle);
    pthread_mutex_unlock(&registry.lock);
}

int registry_enter_events(struct event_queue **ret_queue)
{
    int result = MCANOPEN_OK;

    pthread_mutex_lock(&registry.lock);
    if (registry.state == REGISTRY_NEW)
        result = MCAL_SYS_ERROR;
    else if (registry.state == REGISTRY_INITIALIZED || registry.changing)
        result = MCAL_NO_NET;
    else
        registry.users++;
    pthread_mutex_unlock(&registry.lock);
    *ret_queue = &registry.events;
    return result;
}

void registry_expel(void)
{
    pthread_mutex_lock(&registry.lock);
    while (registry.users > 0)
        pthread_cond_wait(&registry.idle, &registry.lock);
    pthread_mutex_unlock(&registry.lock);
}

struct registry *registry_begin_change(enum registry_state *ret_state, int *ret_result)
{
    struct registry *self = NULL;

    *ret_result = log_in_hook() ? MCAL_UNSUPPORTED : MCAL_SYS_ERROR;
    if (log_in_hook())
        return NULL;
    pthread_mutex_lock(&registry.lock);
    if (!registry.changing) {
        registry.changing = true;
        *ret_state = registry.state;
        self = &registry;
    }
    pthread_mutex_unlock(&registry.lock);
    return self;
}

void registry_end_change(enum registry_state state)
{
    pthread_mutex_lock(&registry.lock);
    registry.state = state;
    registry.changing = false;
    pthread_mutex_unlock(&registry.lock);
}

const char *registry_error_text(void)
{
    return registry.error_text;
}
