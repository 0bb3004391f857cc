/*
 * Another participant of a virtual bus: records what is on it, says what it is told to, and answers
 * frames as a device would that does not keep to the protocol, or as one that is not there.
 */
#ifndef TEST_SUPPORT_API_WIRE_H
#define TEST_SUPPORT_API_WIRE_H

#include "base/time.h"

#include <stdbool.h>

struct api_wire;

/* A thread of its own, from now on. */
struct api_wire *api_wire_open(const char *bus);
void api_wire_close(struct api_wire *self);

/* Each frame whose text begins like 'request' is answered; the newest rule counts. "": not. */
void api_wire_answer(struct api_wire *self, const char *request, const char *answer);
void api_wire_say(struct api_wire *self, const char *frame);
/* How many frames so far began like this. */
unsigned api_wire_count(struct api_wire *self, const char *frame);
/* Until there have been so many. */
void api_wire_wait(struct api_wire *self, const char *frame, unsigned count);
/* When the number-th of them, from 1, was received; waits for it. */
co_us_t api_wire_time(struct api_wire *self, const char *frame, unsigned number);

/* All that the manager, node 127 of network 0, has sent before is there. */
void api_wire_settle(struct api_wire *self);

#endif
