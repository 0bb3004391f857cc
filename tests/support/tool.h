/*
 * Another tool on the simulated bus, which reads and writes the manager's dictionary by SDO.
 */
#ifndef TEST_SUPPORT_TOOL_H
#define TEST_SUPPORT_TOOL_H

#include "support/plant.h"

#define TOOL_MANAGER 127u
#define TOOL_SILENCE 1u /* in place of an abort code: no answer */

/* It listens from now on, behind whoever listens already. One at a time. */
void tool_attach(struct plant *plant);

/* The abort code, or 0. The simulation runs until the answer is there. */
uint32_t tool_write(struct plant *plant, uint16_t index, uint8_t sub, const void *bytes,
                    uint32_t size);
uint32_t tool_put(struct plant *plant, uint16_t index, uint8_t sub, uint8_t size, uint32_t value);
/* Reads up to *size bytes, and how many there are. */
uint32_t tool_read(struct plant *plant, uint16_t index, uint8_t sub, void *bytes, uint32_t *size);
/* The number; an abort fails the test. */
uint32_t tool_get(struct plant *plant, uint16_t index, uint8_t sub);

/* Four bytes, which must be taken, and a moment for what follows from that. */
void tool_set(struct plant *plant, uint16_t index, uint8_t sub, uint32_t value);
/* Reset communication of all, by 1F82h, and a second. */
void tool_boot_all(struct plant *plant);

/* What the devices are, and have. */
void tool_expect_state(const struct plant *plant, uint8_t node, int state);
void tool_expect_value(const struct plant *plant, uint8_t node, uint16_t index, uint64_t value);

/* Nodes 5 to 7, each with UNSIGNED8 6200h:01 and 6201h:01, watched, on the bus;
 * and a second later. */
struct plant *tool_plant(const char *xml);
struct plant *tool_plant_run(const char *xml);

/* Concise DCFs for them: 6200h:01 = 55h; and = 66h with 6201h:01 behind it. */
extern const uint8_t tool_concise[12], tool_concise_more[20];
/* To 1F22h, and a moment for what follows from it. */
uint32_t tool_put_concise(struct plant *plant, uint8_t node, const uint8_t *bytes, uint32_t size);

#endif
