/*
 * What callbacks of the library have done, as lines of text in order: handlers run in its threads,
 * the test waits for their notes. One list for the process, as handlers have no context.
 */
#ifndef TEST_SUPPORT_SCAN_NOTES_H
#define TEST_SUPPORT_SCAN_NOTES_H

#include "scanopen.h"

#include <stdbool.h>

#define SCAN_NOTE_SIZE 120u

/* Forgets all; scan_plant_new() does it for the first network. */
void scan_notes_clear(void);
/* Adds a line; for any thread. */
void scan_note(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* The next line is this one; waits for it. */
void scan_expect_note(const char *text);
/* Skips lines until this one. */
void scan_await_note(const char *text);
/* There is no line that was not expected; for calls that are known to be over. */
void scan_expect_no_note(void);
/* How many lines since the beginning are this one. */
unsigned scan_count_notes(const char *text);

/*
 * A node event handler: "event net/node KIND arg1 arg2", numbers in decimal, KIND without "EV_":
 * "event 0/5 STATE_CHANGE 127 0". EV_EMCY: "event 0/5 EMCY cob-ID node 8 bytes", in hex. EV_TIME:
 * "event 0/5 TIME ms days".
 * Returns what scan_on_event_returns() has said, SCANOPEN_OK before that.
 */
int scan_on_event(SLAVE_EVENT *event);
void scan_on_event_returns(int result);

/*
 * An object handler for numbers of four bytes at most: "data net/node 2000:01 1122" with the bytes
 * of the value in the order of the bus, "data 0/5 2000:01 ?" where data is wanted. Returns what
 * scan_on_data_returns() has said, SCANOPEN_OK before that.
 */
int scan_on_data(int net, int node, int index, int sub, void *data);
/* How many bytes the values of an object have, 1..8; 1 where nothing was said. */
void scan_on_data_size(int index, unsigned size);
void scan_on_data_returns(int result);

#endif
