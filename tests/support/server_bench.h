/*
 * An SDO server on node 5 with a small dictionary, for conversations. Calls of the owner:
 *
 *     "verdict 00000000"     stores the value and says so, or refuses it with the code
 *     "give 414243"          the bytes of an entry that the owner has, "give -" none
 *     "refuse 08000024"      there are none
 *     "channel 640 5C0"      other CAN-IDs; "channel 0 0" none
 *     "blocks of 127"        serves block transfers, with so many segments
 *     "enable", "disable"
 *     "value 1017:00 E803"   the dictionary has this value
 *     "set 1008:00 41"       another value, from the application
 *
 * A write that waits for its verdict is described as "write 1017:00 E803", a read that waits for
 * its bytes as "read 2009:00". A request that finds no room in the outbox is brought again.
 *
 *     1000:00 UNSIGNED32 ro 000F0191h     2000:00 DOMAIN rw, 400 bytes (the buffer has 300)
 *     1003:00 UNSIGNED8  rw high limit 0  2001:00 BOOLEAN rw
 *     1008:00 VISIBLE_STRING const, "CANopenDemoPIC32"
 *     1014:00 UNSIGNED32 rw low limit 81h 2002:00 VISIBLE_STRING ro, empty
 *     1017:00 UNSIGNED16 rw               2003:00 UNSIGNED64 rw
 *     1018:00 .. :01                      2004:00 INTEGER16 rw -100..100
 *     1019:00 UNSIGNED8 rw                2005:00 VISIBLE_STRING rw, 8 bytes
 *     1F50:01 DOMAIN wo                   2006:00 UNSIGNED32 rw
 *                                         2007:00 OCTET_STRING rw, 3 bytes
 *                                         2008:00 DOMAIN ro, 301 bytes
 *                                         2009:00 DOMAIN rw, with the owner
 */
#ifndef TEST_SUPPORT_SERVER_BENCH_H
#define TEST_SUPPORT_SERVER_BENCH_H

#include "proto/sdo_server.h"
#include "support/talk.h"

#define BENCH_NODE     5
#define BENCH_CAPACITY 300

struct server_bench {
    struct od od;
    struct sdo_server server;
    uint8_t *buffer;  /* of exactly BENCH_CAPACITY bytes, for the sanitizer */
    uint32_t writing; /* number of the transfer told last */
};

void server_bench_init(struct server_bench *self);
void server_bench_done(struct server_bench *self);

/* Holds a whole conversation. */
void server_bench_talk(const struct talk *talk, enum talk_stall stall);

#endif
