#include "mcanopen.h"

#include "api/callback.h"
#include "api/registry.h"

static EVENT_T lost_event(unsigned lost)
{
    EVENT_T event = { .event = (long)(NET_NOT_VAL | NOD_NOT_VAL | PARA_UL |
                                      MCANOPEN_MSG_EVENTS_LOST),
                      .net = -1,
                      .node = -1 };

    event.para.ul = lost;
    return event;
}

static int take(struct event_queue *queue, co_us_t deadline, EVENT_T *event)
{
    unsigned lost = 0;
    enum co_err err = event_queue_take(queue, deadline, event, &lost);

    if (lost > 0)
        *event = lost_event(lost);
    if (err == CO_ERR_STATE)
        return MCAL_NO_NET;
    return err == CO_OK ? MCANOPEN_OK : MCAL_NO_EVENT;
}

int mcanOpenEvent(EVENT_T *event, int wait)
{
    struct event_queue *queue;
    int result;

    if (!event || (wait != 0 && wait != 1))
        return MCAL_PARA_ERROR;
    if (wait && callback_running())
        return MCAL_UNSUPPORTED;
    result = registry_enter_events(&queue);
    if (result != MCANOPEN_OK)
        return result;
    result = take(queue, wait ? CO_NEVER : 0, event);
    registry_leave();
    return result;
}

int mcanOpenGetLostEvents(unsigned int *count)
{
    struct event_queue *queue;
    int result;

    if (!count)
        return MCAL_PARA_ERROR;
    result = registry_enter_events(&queue);
    if (result != MCANOPEN_OK)
        return result;
    *count = event_queue_lost(queue);
    registry_leave();
    return MCANOPEN_OK;
}
