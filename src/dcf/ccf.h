/*
 * Concise DCF (CiA 302-3, object 1F22h): the writes that configure a device, in order, as bytes.
 *
 *   u32 count, then count times { u16 index, u8 sub, u32 size, size bytes }
 *
 * Little endian, without padding.
 *
 * A CCF file is exactly these bytes.
 */
#ifndef CO_DCF_CCF_H
#define CO_DCF_CCF_H

#include "base/error.h"
#include "base/report.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct ccf { /* owns its bytes: always a whole, valid concise DCF once it holds anything */
    uint8_t *bytes;
    size_t size;
    size_t room;
    unsigned *lines; /* of the file that the entries were made from; NULL: not known */
    size_t line_count, line_room;
};

struct ccf_entry { /* points into the bytes */
    uint16_t index;
    uint8_t sub;
    uint32_t size;
    const uint8_t *value;
};

struct ccf_reader {
    const uint8_t *bytes;
    size_t size;
    size_t position;
    uint32_t left; /* entries not yet read */
    bool broken;   /* what is at the position is no entry */
};

void ccf_init(struct ccf *self); /* empty: count 0 */
void ccf_done(struct ccf *self);
uint32_t ccf_count(const struct ccf *self);

/* CO_ERR_MEMORY */
enum co_err ccf_append(struct ccf *self, uint16_t index, uint8_t sub, const uint8_t *value,
                       uint32_t size);

/* The entry appended last comes from this line. CO_ERR_MEMORY */
enum co_err ccf_note_line(struct ccf *self, unsigned line);
/* Of the entry with this number, from 1; 0: not known. */
unsigned ccf_line(const struct ccf *self, uint32_t number);

/* A kind for co_report_kind(): there is less than the counts and sizes say. */
#define CCF_TRUNCATED 1

/*
 * Takes over a copy of the bytes when they are one whole concise DCF. CO_ERR_FORMAT: truncated or
 * too long, the report says where (entry number and byte offset); CO_ERR_MEMORY.
 */
enum co_err ccf_parse(const uint8_t *bytes, size_t size, struct co_report *report,
                      struct ccf *ret_ccf);

void ccf_reader_init(struct ccf_reader *self, const struct ccf *ccf);
/* False at the end. */
bool ccf_read(struct ccf_reader *self, struct ccf_entry *ret_entry);

/*
 * The same for bytes that may be damaged: false also where they break, which is told in the report,
 * as ccf_parse() does.
 */
void ccf_reader_init_bytes(struct ccf_reader *self, const uint8_t *bytes, size_t size,
                           struct co_report *report);
bool ccf_read_checked(struct ccf_reader *self, struct co_report *report,
                      struct ccf_entry *ret_entry);

#endif
