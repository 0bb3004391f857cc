/*
 * Conformance checks of one CANopen slave, on the level of frames: what all checks share.
 *
 *   in   a bus, the node-ID of the device under test, its EDS where there is one
 *   out  for each check a result, with the frames that led to it
 *
 * The tester uses neither our SDO client nor our slave: a fault in them must not hide itself. Of
 * the stack it takes the bus (port/bus.h) and the reader of EDS files (dcf/).
 *
 * HOW TO WRITE A CHECK. A check is a function and a row in a table of its family; families are
 * listed in conform_families.c. It begins with the device in pre-operational and passes unless it
 * says otherwise, once: conform_fail(), conform_skip(), conform_help(); each returns false, as do
 * the functions below that have told a failure themselves. So:
 *
 *     static bool check_toggle(struct conform *self)
 *     {
 *         if (!conform_need_object(self, 0x1008))
 *             return false;                       (SKIP: the device has no 1008h)
 *         ...
 *         if (at == CONFORM_NOTHING)
 *             return conform_fail(self, "no EMCY within %u ms", ms);
 *         return true;
 *     }
 *
 * What a check changes, it changes back; where that takes a reset, its row says CONFORM_RESET.
 * After a check that fails the device is reset, too, and before each family.
 *
 * FRAMES AND TIME. All frames from the beginning of a check on, our own at their place in the bus
 * order, are kept and have numbers. conform_send() returns the number behind the frame that it has
 * sent; conform_await() looks from a number on, in what has come and what comes until a deadline.
 * So nothing that comes early is missed, and nothing late is taken for an answer. Each wait has a
 * deadline, and ends at once when the bus is lost or the user gives up: CONFORM_NOTHING.
 */
#ifndef TOOLS_CONFORM_H
#define TOOLS_CONFORM_H

#include "dcf/dcf.h"
#include "port/bus.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

struct conform;

/* --- checks --- */

enum conform_needs {
    CONFORM_EDS = 1,   /* --eds; else SKIP */
    CONFORM_STORE = 2, /* --allow-store: it writes non-volatile memory; else SKIP */
    CONFORM_RESET = 4  /* the device is reset after it, whatever its result */
};

struct conform_check {
    const char *name;   /* "sdo-toggle-upload": stable, begins with the family's name */
    const char *title;  /* what the device does when it passes */
    const char *clause; /* "CiA 301, 7.2.4.3" */
    unsigned needs;     /* of enum conform_needs */
    uint16_t object;    /* that the device must have; else SKIP. 0: none */
    bool (*run)(struct conform *self);
};

struct conform_family {
    const char *name; /* "sdo"; several tables may share one, one behind the other */
    const char *title;
    const struct conform_check *checks;
    size_t count;
};

extern const struct conform_family *const conform_families[];
extern const size_t conform_family_count;

enum conform_verdict { CONFORM_PASS, CONFORM_FAIL, CONFORM_SKIP, CONFORM_HELP };

/* "PASS", ... */
const char *conform_verdict_text(enum conform_verdict verdict);

struct conform_result {
    const struct conform_family *family;
    const struct conform_check *check;
    enum conform_verdict verdict;
    char *reason; /* "" of a check that passes */
    char *trace;  /* its frames, a line each: "(seconds) > ID#DATA", "<" from the bus */
    co_us_t duration;
};

/* --- the state of a run --- */

struct conform_options {
    const char *bus;
    uint8_t node;
    const char *eds; /* NULL: none */
    bool allow_store;
    unsigned sdo_timeout, boot_timeout; /* ms */
    const char *only, *skip;            /* names of checks and families, with commas; NULL */
    bool verbose, quiet, json, list;
    const char *junit; /* a file, or NULL */
};

/* An entry of the device: from its EDS, or found by reading. */
struct conform_object {
    uint16_t index;
    uint8_t sub;
    uint8_t type;                  /* enum od_type; 0: not known */
    uint8_t access;                /* enum od_access, of SDO; CONFORM_UNKNOWN */
    const struct dcf_entry *entry; /* in the EDS; NULL: without */
};

#define CONFORM_UNKNOWN 0xFFu /* access */
#define CONFORM_NOTHING SIZE_MAX
#define CONFORM_QUIET   150u /* ms in which nothing must come, where nothing else is said */

enum conform_end {
    CONFORM_RUNS,
    CONFORM_STOPPED, /* Ctrl-C */
    CONFORM_BUS_LOST,
    CONFORM_SILENT /* the device does not answer any more */
};

struct conform {
    struct conform_options options;
    struct bus *bus;
    int signals; /* a file descriptor */
    enum conform_end end;
    char message[512];   /* why it ended */
    unsigned unanswered; /* SDO requests of the check, in a row */
    unsigned lost;       /* frames that the tester was too slow for */
    /* the device */
    struct dcf eds;
    bool has_eds;
    char *eds_messages;             /* what the reader said; NULL: nothing */
    struct conform_object *objects; /* sorted by index and sub-index */
    size_t object_count;
    /* the check that runs */
    const struct conform_check *check;
    enum conform_verdict verdict;
    char reason[1024];
    char bad_answer[128]; /* the last one, in words */
    struct bus_rx *frames;
    size_t frame_count, frame_room;
    co_us_t begin;
    uint8_t shown[0x800 / 8]; /* bit per identifier: it is in the trace; see conform_show() */
    struct conform_result *results;
    size_t result_count, result_room;
};

/* --- what a check says; all return false --- */

bool conform_fail(struct conform *self, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
bool conform_skip(struct conform *self, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* What the user can do so that it can be checked. */
bool conform_help(struct conform *self, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* --- frames --- */

/* The number of the first frame behind it. A bus that does not take it ends the run. */
size_t conform_send(struct conform *self, const struct co_frame *frame);
size_t conform_send_data(struct conform *self, uint32_t id, const void *data, uint8_t dlc);
size_t conform_send_rtr(struct conform *self, uint32_t id, uint8_t dlc);
/* The number of the next frame that comes. */
size_t conform_mark(struct conform *self);

/*
 * The first frame with this identifier from a number on that others have sent; waits for it 'ms'
 * from now on. CONFORM_NOTHING: none.
 */
size_t conform_await(struct conform *self, size_t from, uint32_t id, unsigned ms);
/* The same; it also has this first byte (NMT states, commands). */
size_t conform_await_byte(struct conform *self, size_t from, uint32_t id, uint8_t byte,
                          unsigned ms);
/* Reads for 'ms', then counts the frames with this identifier from a number on. */
unsigned conform_count(struct conform *self, size_t from, uint32_t id, unsigned ms);
/* None of them comes in 'ms'. Fails and tells which came, else. */
bool conform_expect_none(struct conform *self, size_t from, uint32_t id, unsigned ms);
/* What comes in the next 'ms' is taken and kept. */
void conform_listen(struct conform *self, unsigned ms);

const struct co_frame *conform_frame(const struct conform *self, size_t number);
co_us_t conform_time(const struct conform *self, size_t number);
/* Takes the frames from a number on out of the trace: of one of many steps that went well. */
void conform_drop(struct conform *self, size_t from);
/* Frames with this identifier are in the trace. Those of conform_await() and its like are, and all
 * that are sent, NMT commands, SYNC, and the device's predefined ones. */
void conform_show(struct conform *self, uint32_t id);

/* --- NMT --- */

#define CONFORM_START      0x01u
#define CONFORM_STOP       0x02u
#define CONFORM_PREOP      0x80u
#define CONFORM_RESET_NODE 0x81u
#define CONFORM_RESET_COMM 0x82u

/* The number behind it. Where the check goes on with SDO there is nothing to wait for. */
size_t conform_nmt(struct conform *self, uint8_t command);
/* Resets the device and awaits its boot-up message; fails without it. */
bool conform_reset(struct conform *self, uint8_t command);

/* --- SDO, frame by frame --- */

/* Where CiA's code would stand; no code of CiA 301 looks like them. */
#define CONFORM_NO_ANSWER  0xFFFFFFFFu
#define CONFORM_BAD_ANSWER 0xFFFFFFFEu /* one that does not belong to the request */

#define CONFORM_VALUE_MAX  1024u
#define CONFORM_UPLOAD_MAX 65536u /* bytes; then an upload is broken off */

struct conform_value {
    uint32_t announced;               /* by the server, in an upload in segments; 0: nothing */
    bool cut;                         /* there is more */
    uint32_t size;                    /* all that came; the bytes behind CONFORM_VALUE_MAX are
                                         not kept */
    uint8_t bytes[CONFORM_VALUE_MAX]; /* 0 behind the value */
};

/* Sends a request and awaits the server's answer; false: none came. Judges nothing. */
bool conform_exchange(struct conform *self, const uint8_t request[8], uint8_t ret_answer[8]);
/* "40 00 10 00" and an object's multiplexer: bytes 4..7 are 0. */
void conform_request(uint8_t request[8], uint8_t command, uint16_t index, uint8_t sub);

/* SDO_OK, the server's abort code, CONFORM_NO_ANSWER or CONFORM_BAD_ANSWER. */
uint32_t conform_read(struct conform *self, uint16_t index, uint8_t sub,
                      struct conform_value *ret_value);
/* Expedited up to 4 bytes, else in segments; with its size. */
uint32_t conform_write(struct conform *self, uint16_t index, uint8_t sub, const void *bytes,
                       uint32_t size);
uint32_t conform_write_number(struct conform *self, uint16_t index, uint8_t sub, uint32_t size,
                              uint64_t number);
/* Number of up to 8 bytes; 'missing' where it cannot be read. */
uint64_t conform_number(struct conform *self, uint16_t index, uint8_t sub, uint64_t missing);

/* The same with "must work": they fail and say what came. */
bool conform_must_read(struct conform *self, uint16_t index, uint8_t sub,
                       struct conform_value *ret_value);
bool conform_must_read_number(struct conform *self, uint16_t index, uint8_t sub,
                              uint64_t *ret_number);
bool conform_must_write(struct conform *self, uint16_t index, uint8_t sub, uint32_t size,
                        uint64_t number);
bool conform_must_write_bytes(struct conform *self, uint16_t index, uint8_t sub, const void *bytes,
                              uint32_t size);

/*
 * Accepted abort codes, with 0 at the end. conform_must_abort() takes what conform_read() or
 * conform_write() returned, conform_must_answer_abort() an answer frame; both fail with "expected
 * abort 06010002 or ..., received ..." where it is none of them. 'what' names the request.
 */
bool conform_must_abort(struct conform *self, const char *what, uint32_t result,
                        const uint32_t *codes);
bool conform_must_answer_abort(struct conform *self, const char *what, const uint8_t answer[8],
                               const uint32_t *codes);
/* A list for the two: CODES(SDO_READ_ONLY, SDO_ACCESS, SDO_GENERAL). */
#define CODES(...) ((const uint32_t[]){ __VA_ARGS__, 0 })

/* "no answer", "abort 06020000 (object does not exist)", "success". */
const char *conform_result_text(uint32_t result, char *text, size_t size);
#define CONFORM_RESULT_SIZE 96u

/* --- what is known about the device --- */

/* Reads or probes; after it 'objects' is filled. false: no memory. */
bool conform_know_device(struct conform *self);
void conform_forget_device(struct conform *self);
const struct conform_object *conform_find(const struct conform *self, uint16_t index, uint8_t sub);
bool conform_has(const struct conform *self, uint16_t index);
/* Else SKIP "the device has no 1017h". */
bool conform_need_object(struct conform *self, uint16_t index);
/*
 * An object of so many bytes that can be written back without harm: communication parameters first,
 * then those of the EDS. NULL: none is known.
 */
const struct conform_object *conform_writable(struct conform *self, uint32_t size);
/* The present value has at least 'size' bytes and is read in segments. NULL: none is known. */
const struct conform_object *conform_long_object(struct conform *self, uint32_t size);

/* --- running and telling --- */

/* One of enum exit_code. */
int conform_run(struct conform *self);
void conform_print_result(const struct conform *self, const struct conform_result *result);
void conform_print_summary(const struct conform *self);
void conform_print_json(const struct conform *self);
/* false: told on stderr */
bool conform_write_junit(const struct conform *self, const char *path);
/* Is this name in the list "sdo-read,pdo"? */
bool conform_selects(const char *list, const struct conform_family *family,
                     const struct conform_check *check);

#endif
