#include "port/can_cyclic.h"

#include "port/can_format.h"

#include <errno.h>
#include <linux/can/bcm.h>
#include <string.h>
#include <unistd.h>

/* What CAN_BCM is told in one message. */
union cyclic_job {
    struct bcm_msg_head head; /* with the frames behind it */
    char bytes[sizeof(struct bcm_msg_head) + BUS_CYCLIC_MAX * sizeof(struct can_frame)];
};

void can_cyclic_close(struct can_cyclic *self)
{
    if (self->fd >= 0)
        close(self->fd);
    self->fd = -1;
}

void can_cyclic_set(struct can_cyclic *self, const struct co_frame *frames, unsigned count,
                    co_us_t period)
{
    can_cyclic_close(self);
    self->count = count;
    self->period = period;
    if (count > 0)
        memcpy(self->frames, frames, count * sizeof *frames);
}

static enum co_err open_socket(struct can_cyclic *self)
{
    self->fd = self->calls->socket(PF_CAN, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_BCM);
    if (self->fd >= 0)
        return CO_OK;
    return errno == EPROTONOSUPPORT || errno == EAFNOSUPPORT || errno == ESOCKTNOSUPPORT
               ? CO_ERR_UNSUPPORTED
               : can_parse_error(errno);
}

static enum co_err connect_socket(struct can_cyclic *self, int index)
{
    const struct sockaddr_can address = { .can_family = AF_CAN, .can_ifindex = index };

    return self->calls->connect(self->fd, (const struct sockaddr *)&address, sizeof address) < 0
               ? can_parse_error(errno)
               : CO_OK;
}

static void fill_job(const struct can_cyclic *self, union cyclic_job *job)
{
    memset(&job->head, 0, sizeof job->head); /* the holes, too: the kernel gets it */
    job->head.opcode = TX_SETUP;
    job->head.flags = SETTIMER | STARTTIMER; /* which sends the first one at once */
    job->head.ival2.tv_sec = (long)(self->period / 1000000u);
    job->head.ival2.tv_usec = (long)(self->period % 1000000u);
    job->head.nframes = self->count;
    for (unsigned i = 0; i < self->count; i++)
        job->head.frames[i] = can_format_frame(&self->frames[i]);
    job->head.can_id = job->head.frames[0].can_id;
}

/*
 * A 64-bit kernel misreads the message of a 32-bit program: bytes 5 to 8 of the first frame are the
 * number of frames for it. Where these are 0 it refuses with EINVAL.
 */
static bool is_readable(const struct can_cyclic *self)
{
    return sizeof(long) == 8 || self->frames[0].dlc <= 4;
}

static enum co_err send_job(struct can_cyclic *self)
{
    union cyclic_job job;
    size_t size = sizeof job.head + self->count * sizeof job.head.frames[0];

    if (!is_readable(self))
        return CO_ERR_UNSUPPORTED;
    fill_job(self, &job);
    if (self->calls->send(self->fd, &job, size, 0) >= 0)
        return CO_OK;
    return errno == EINVAL ? CO_ERR_UNSUPPORTED : can_parse_error(errno);
}

static enum co_err start(struct can_cyclic *self, int index)
{
    enum co_err err = open_socket(self);

    if (!err)
        err = connect_socket(self, index);
    if (!err)
        err = send_job(self);
    if (err)
        can_cyclic_close(self);
    return err;
}

enum co_err can_cyclic_follow(struct can_cyclic *self, int index, unsigned outages)
{
    if (index == 0 || outages != self->outages)
        can_cyclic_close(self);
    self->outages = outages;
    return index != 0 && self->count > 0 && self->fd < 0 ? start(self, index) : CO_OK;
}
