/*
 * The tags of frames that were sent and whose confirmation has not come back yet: SocketCAN returns
 * an own frame without saying which local device sent it. Internal to port/.
 *
 * Frames of one identifier keep their order on the way, others may pass each other (queueing
 * disciplines, controllers with several mailboxes). So a confirmation belongs to the oldest frame
 * that looks the same, and older ones of its identifier will not come back any more. Locking: the
 * owner's.
 */
#ifndef CO_PORT_BUS_TAGS_H
#define CO_PORT_BUS_TAGS_H

#include "base/frame.h"

#define BUS_TAGS_MAX 1024u /* as many frames as a long transmit queue holds */

struct bus_tags {
    struct co_frame frames[BUS_TAGS_MAX]; /* the oldest first */
    unsigned count;
};

/* Before the frame is sent. Where there is no room, the oldest one is forgotten. */
void bus_tags_push(struct bus_tags *self, const struct co_frame *frame);
/* The newest one was not sent after all. Nothing, if it has been confirmed or forgotten since. */
void bus_tags_take_back(struct bus_tags *self, const struct co_frame *frame);
/* The tag of a frame that came back; 0: not known. */
uint8_t bus_tags_confirm(struct bus_tags *self, const struct co_frame *frame);

#endif
