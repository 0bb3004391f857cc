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
    unsigned lost = event_queue_take_lost(queue);
    enum co_err err;

    if (lost > 0) {
        *event = lost_event(lost);
        return MCANOPEN_OK;
    }
    err = event_queue_take(queue, deadline, event);
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
