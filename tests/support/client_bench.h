/*
 * An SDO client on node 5 with a guarded buffer, for conversations. Calls of the owner:
 *
 *     "read 1008:00 16"      upload with room for 16 bytes; "write 2000:00 414243" download,
 *     "write+ ...", "write- ..."  with the size told in advance; without it even when expedited
 *     "write 2000:00 -"      of nothing
 *     "blocks of 4"          from now on in blocks, with so many segments
 *     "handed over"          the requests are with the bus, and no own frame comes back
 *     "cancel 08000022"      has to cancel; "cancel nothing" has to find nothing to cancel
 *     "late 2"               so many answers have been ignored
 *
 * An end is described as "outcome, code, bytes" and the data of an upload: "ok 00000000 2 E803",
 * with "no blocks" behind it when the server has shown that it has none.
 */
#ifndef TEST_SUPPORT_CLIENT_BENCH_H
#define TEST_SUPPORT_CLIENT_BENCH_H

#include "proto/sdo_client.h"
#include "support/talk.h"

#define BENCH_NODE  5
#define BENCH_ROOM  300
#define BENCH_GUARD 16

struct client_bench {
    struct sdo_client client;
    struct sdo_transfer transfer;
    uint8_t buffer[BENCH_ROOM + BENCH_GUARD];
    uint8_t block; /* of the next transfers */
    unsigned starts, ends;
};

void client_bench_init(struct client_bench *self);
void client_bench_start(struct client_bench *self, const char *text, co_us_t now,
                        struct co_outbox *out);
void client_bench_describe(struct client_bench *self, const struct co_event *event, char *text,
                           size_t size);

/* Holds a whole conversation. */
void client_bench_talk(const struct talk *talk, enum talk_stall stall);

#endif
