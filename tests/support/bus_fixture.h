/*
 * A virtual bus for a test program, named after its process, and the usual steps on it; each fails
 * the test if it goes wrong.
 */
#ifndef CO_TESTS_SUPPORT_BUS_FIXTURE_H
#define CO_TESTS_SUPPORT_BUS_FIXTURE_H

#include "port/bus.h"

/* "virtual:test-PID" of this program, and the file it lives in. Choose first, in main(). */
void fixture_choose_name(void);
/* The same bus with "?bitrate=N" behind its name; 0: without. */
void fixture_choose_bitrate(unsigned bitrate);
const char *fixture_name(void);
const char *fixture_path(void);
/* What a failed test, or a killed participant, has left there. */
void fixture_remove_file(void);

struct bus *fixture_open(bool own_frames);
/* Opens and closes. Does not fail. */
enum co_err fixture_try_open(const char *name, char *message, size_t size);

void fixture_send(struct bus *bus, const char *text, uint8_t tag);
/* 123# and the number. */
void fixture_send_number(struct bus *bus, uint32_t number);
uint32_t fixture_number_of(const struct bus_rx *rx);
struct bus_rx fixture_expect(struct bus *bus, const char *text);
void fixture_expect_nothing(struct bus *bus);

#endif
