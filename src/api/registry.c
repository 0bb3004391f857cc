#include "api/registry.h"

#include "api/callback.h"

static struct registry registry = { .lock = PTHREAD_MUTEX_INITIALIZER,
                                    .idle = PTHREAD_COND_INITIALIZER };

static struct managed *find(int net)
{
    for (size_t i = 0; i < registry.network_count; i++)
        if (registry.networks[i].config->net == net)
            return &registry.networks[i];
    return NULL;
}

/* Under the lock. */
static int enter(int net, bool running, struct managed **ret_managed)
{
    struct managed *managed;

    if (registry.state == REGISTRY_NEW)
        return MCAL_SYS_ERROR;
    managed = registry.open ? find(net) : NULL;
    if (!managed)
        return MCAL_NO_NET;
    if (running && registry.state != REGISTRY_RUNNING)
        return MCAL_NODE_NOT_FREE;
    registry.users++;
    *ret_managed = managed;
    return MCANOPEN_OK;
}

int registry_enter(int net, bool running, struct managed **ret_managed)
{
    int result;

    if (net < 0 || net > UINT8_MAX)
        return MCAL_PARA_ERROR;
    pthread_mutex_lock(&registry.lock);
    result = enter(net, running, ret_managed);
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
    else if (!registry.open)
        result = MCAL_NO_NET;
    else
        registry.users++;
    pthread_mutex_unlock(&registry.lock);
    *ret_queue = &registry.events;
    return result;
}

void registry_close(void)
{
    pthread_mutex_lock(&registry.lock);
    registry.open = false;
    pthread_mutex_unlock(&registry.lock);
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

    *ret_result = callback_running() ? MCAL_UNSUPPORTED : MCAL_SYS_ERROR;
    if (callback_running())
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

void registry_set_state(enum registry_state state)
{
    pthread_mutex_lock(&registry.lock);
    registry.state = state;
    pthread_mutex_unlock(&registry.lock);
}

void registry_end_change(enum registry_state state)
{
    pthread_mutex_lock(&registry.lock);
    registry.state = state;
    registry.open = state == REGISTRY_CONFIGURED || state == REGISTRY_RUNNING;
    registry.changing = false;
    pthread_mutex_unlock(&registry.lock);
}

const char *registry_error_text(void)
{
    return registry.error_text;
}
