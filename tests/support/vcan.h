/*
 * A real SocketCAN interface for a test program, and the usual steps on it; each fails the test if
 * it goes wrong.
 */
#ifndef TEST_SUPPORT_VCAN_H
#define TEST_SUPPORT_VCAN_H

#include "port/bus.h"

#define VCAN_PATIENCE CO_MS(10000)

/* Buses opened from now on receive by io_uring, or by poll(); at first, as the kernel has it. */
void vcan_choose(bool io_uring);
/* This kernel has io_uring for us; says so if not. */
bool vcan_has_io_uring(void);
struct bus *vcan_open(const char *name, bool own_frames);
/* A command of the shell. */
void vcan_run(const char *command);
/* Of a frame as text. */
enum co_err vcan_send(struct bus *bus, const char *text, uint8_t tag);
struct bus_rx vcan_receive(struct bus *bus);
struct bus_rx vcan_expect(struct bus *bus, const char *text);
/* vcan delivers before send() returns: what is not there now does not come. */
void vcan_expect_nothing(struct bus *bus);
/* Takes what comes meanwhile. */
void vcan_wait_state(struct bus *bus, enum bus_state state);

#endif
