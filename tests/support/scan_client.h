/*
 * Clients of a node's SDO servers: the manager of the same process, on network 0 of a scan_plant,
 * and one on the bus. What does not work fails the test.
 */
#ifndef TEST_SUPPORT_SCAN_CLIENT_H
#define TEST_SUPPORT_SCAN_CLIENT_H

#include "mcanopen.h"
#include "support/scan_plant.h"

/* The node is active; it is booted, and operational then. Writes network.xml where we are. */
void scan_client_start(int node);
void scan_client_end(void);
/* flags: those of mcanOpenWriteSDO. The abort code; 0: all went well. */
uint32_t scan_client_write(int node, int index, const void *bytes, unsigned size, int flags);
/* flags: TYP_BLOCK, or none. What is read is this. */
void scan_client_expect(int node, int index, const void *bytes, unsigned size, int flags);

/* On the bus: a request and its answer, in turns. */
void scan_talk(struct scan_plant *plant, const char *const *frames, size_t count);
/* This is read. */
void scan_expect_text(struct scan_plant *plant, int node, int index, const char *text);
/* Up to four bytes; the abort code. */
uint32_t scan_write_text(struct scan_plant *plant, int node, int index, const char *text);

#endif
