#include "runtime/daemon.h"

static void *run(void *context)
{
    struct daemon *self = context;
    _Alignas(max_align_t) unsigned char element[DAEMON_ELEMENT_MAX];
    unsigned lost;

    while (event_queue_take(&self->queue, CO_NEVER, element, &lost) == CO_OK) {
        if (lost == 0)
            self->work(self->context, element);
        else if (self->lost)
            self->lost(self->context, lost);
    }
    return NULL;
}

enum co_err daemon_start(struct daemon *self, const char *name, size_t element_size,
                         unsigned capacity)
{
    enum co_err err = event_queue_init(&self->queue, element_size, capacity);

    if (err != CO_OK)
        return err;
    err = thread_start(&self->thread, name, run, self);
    if (err != CO_OK)
        event_queue_done(&self->queue);
    return err;
}

void daemon_put(struct daemon *self, const void *element)
{
    event_queue_put(&self->queue, element);
}

void daemon_add(struct daemon *self, const void *element)
{
    event_queue_add(&self->queue, element);
}

void daemon_wake(struct daemon *self)
{
    event_queue_wake(&self->queue);
}

void daemon_stop(struct daemon *self)
{
    event_queue_open(&self->queue); /* what is left is dropped */
    event_queue_close(&self->queue);
    thread_join(&self->thread);
    event_queue_done(&self->queue);
}

enum co_err daemon_set_priority(struct daemon *self, int native)
{
    return thread_set_priority(&self->thread, native);
}
