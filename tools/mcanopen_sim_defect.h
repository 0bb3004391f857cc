/*
 * Defects that 'mcanopen sim --defect' gives to its device, for tests of testers: each is a row of
 * a table with a function over the frames that the device sends, or over those that it gets.
 *
 * A function may alter the frame and says whether it goes on. It may send others, which no defect
 * alters. Called under the gate's lock.
 */
#ifndef TOOLS_MCANOPEN_SIM_DEFECT_H
#define TOOLS_MCANOPEN_SIM_DEFECT_H

#include "base/frame.h"

#include <stdbool.h>
#include <stdint.h>

struct sim_gate;
struct defect_use;

typedef bool defect_alter(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame);

#define DEFECT_CODES_MAX 5u
#define DEFECT_ANY_SUB   (-1)

struct sim_defect {
    const char *name, *family, *text;
    defect_alter *from_device, *to_device; /* NULL: nothing is altered */
    /* what shared functions work on: objects, abort codes (0: no more), a number */
    uint16_t first, last;
    int sub;
    uint32_t codes[DEFECT_CODES_MAX];
    uint32_t number;
};

struct defect_use {
    const struct sim_defect *defect;
    /* the defect's own memory, at first 0 */
    unsigned count;
    uint32_t value;
    bool on;
};

/* What the gate has seen of the device and its clients. */
struct sim_device_view {
    uint8_t node;
    uint8_t state;            /* that the NMT commands on the bus lead to */
    struct co_frame request;  /* the last one to the SDO server */
    struct co_frame initiate; /* the last one that began a transfer, or ended a block transfer */
    unsigned block_left;      /* block download: segments of the sub-block to come */
    bool block_segment;       /* the last request is one */
    bool block_last;          /* with the end of the data */
    uint8_t block_seqno;
};

void gate_to_bus(struct sim_gate *self, const struct co_frame *frame);
void gate_to_device(struct sim_gate *self, const struct co_frame *frame);
const struct sim_device_view *gate_view(const struct sim_gate *self);

/* NULL: there is none of that name. */
const struct sim_defect *sim_defect_find(const char *name);
/* All of them on stdout. */
void sim_defect_list(void);

/* The tables of the families; each ends with a row without a name. */
extern const struct sim_defect sim_defects_sdo[], sim_defects_block[], sim_defects_od[],
    sim_defects_pdo[], sim_defects_errors[], sim_defects_nmt[];

/* --- shared functions --- */

bool defect_is_from(const struct sim_gate *gate, const struct co_frame *frame, uint32_t base);
/* An expedited answer to the upload of an object of the row; or of any object. */
bool defect_is_value(const struct sim_gate *gate, const struct co_frame *frame);
bool defect_concerns(const struct sim_defect *defect, const struct co_frame *sdo);
/* An answer of the server with the object of the last initiate, 4 more bytes 0. */
struct co_frame defect_answer(const struct sim_gate *gate, uint8_t command);

/* Frames of this CAN-ID + node-ID (number) are lost. */
defect_alter defect_lose;
/* Refused with one of the row's codes, an expedited write is confirmed after all. */
defect_alter defect_confirm_refused;
/* Writes of the row's objects, of any value or of number, are confirmed and have no effect. */
defect_alter defect_swallow_write;
/* Values read from the row's objects differ in the bits of number. */
defect_alter defect_alter_value;

#endif
