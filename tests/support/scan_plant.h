/*
 * The slave API as an application has it: one network with a virtual bus of its own, local nodes on
 * it, and an observer that sends frames to them and sees what they send. Several plants with
 * different network numbers may stand side by side. Real threads, real time, no sleeps: what is
 * waited for is a frame, a note (scan_notes.h) or a state. Texts of frames are those of candump,
 * "601#4000100000000000"; remote frames have their length, "181#R0".
 *
 *     struct scan_plant *plant = scan_plant_new(0);
 *     HNODE node = scan_node(plant, 5, NULL);
 *     ...                                          canOpenExtendDictionary, DECLARE_PDO
 *     scan_activate(plant, node);
 *     scan_operational(plant, node);
 *     scan_send(plant, "205#0102");
 *     scan_expect(plant, "185#01");
 *     scan_expect_nothing_more(plant, node);
 *     scan_plant_free(plant);
 *
 * The functions of the library that are used here must work; each fails the test if it does not.
 */
#ifndef TEST_SUPPORT_SCAN_PLANT_H
#define TEST_SUPPORT_SCAN_PLANT_H

#include "base/time.h"
#include "scanopen.h"
#include "support/scan_notes.h"

#include <check.h>
#include <stdbool.h>

#define SCAN_PATIENCE_S 30 /* a test that waits longer has failed */
#define SCAN_PATIENCE   CO_MS(1000 * SCAN_PATIENCE_S)
#define SCAN_LIMIT      60 /* seconds: time limit of a test case */
#define SCAN_BITRATE    500

struct scan_plant;

/* Network 'net' on a bus of its own, opened with canOpenCreateNetworkEx. */
struct scan_plant *scan_plant_new(int net);
/* The same, but the network is left to the test; the environment leads it to the bus. */
struct scan_plant *scan_plant_bare(int net);
/* The same on a bus where frames take the time that they need at 'kbit' kbit/s. */
struct scan_plant *scan_plant_slow(int net, unsigned kbit);
/*
 * Removes the plant's nodes and its network, those that are left, and the observer. A function that
 * returns "not implemented" does not fail here but in the test that is about it.
 */
void scan_plant_free(struct scan_plant *self);
const char *scan_bus_name(const struct scan_plant *self);

/* --- nodes --- */

/*
 * All zero but: type 00020192h, 1018h with vendor 29Ah, product 1, revision 2, serial number 3;
 * 1005h with 80h (SYNCHRON_PDOS), 8 receive and 8 transmit PDOs, all events.
 */
SLAVE_NODE_INFO scan_info(void);
/* A node with scan_on_event; info NULL: scan_info(). scan_plant_free() removes it. */
HNODE scan_node(struct scan_plant *self, int id, const SLAVE_NODE_INFO *info);
/* A node made otherwise: scan_plant_free() removes it, too. */
void scan_plant_keep(struct scan_plant *self, HNODE node, int id);
/* Its node-ID. */
int scan_id(const struct scan_plant *self, HNODE node);
/* Activates, and takes the boot-up message from the bus. */
void scan_activate(struct scan_plant *self, HNODE node);
/* NMT commands to one node, then waits for the state. */
void scan_operational(struct scan_plant *self, HNODE node);
void scan_preoperational(struct scan_plant *self, HNODE node);
void scan_stop(struct scan_plant *self, HNODE node);
/* As the API tells it. */
int scan_state(HNODE node);

/* --- objects: OBJ_VAR without a limit --- */

/* type: TYP_BOOL .. TYP_UINT32, TYP_CHAR. */
void scan_number(HNODE node, unsigned short index, int type, unsigned short flags, uint32_t value,
                 PFN_COS_DATA_HANDLER handler);
/* The value of such an entry, read by canOpenReadDictionary. */
uint32_t scan_get(HNODE node, unsigned short index, unsigned short sub);
/* What canOpenWriteDictionary returns. */
int scan_set(HNODE node, unsigned short index, unsigned short sub, uint32_t value);

/* --- the bus --- */

void scan_send(struct scan_plant *self, const char *frame);
/* The next frame is this one; waits for it. "185#R*" is any that begins like this. */
void scan_expect(struct scan_plant *self, const char *frame);
/* The first two bytes of the next frame, whatever it is, the low one first; waits for it. */
unsigned scan_next_number(struct scan_plant *self);
/* Skips frames until this one; false: it did not come within ms. */
bool scan_await_within(struct scan_plant *self, const char *frame, unsigned ms);
void scan_await(struct scan_plant *self, const char *frame);
/*
 * Time of the frame expected or awaited last, on the clock of clock_now(); a busy machine may give
 * it some ms later than it was sent.
 */
co_us_t scan_time(const struct scan_plant *self);
/*
 * No frame is there that was not expected, and what was sent to the active node until now brings
 * none: asks it for 1000h and looks at what comes before the answer.
 */
void scan_expect_nothing_more(struct scan_plant *self, HNODE node);
/* Forgets all frames until now. */
void scan_forget(struct scan_plant *self);

/* --- SDO, as a client on the bus; frames of others are kept for scan_expect() --- */

/* Returns the abort code, 0: done. Up to 4 bytes expedited. */
uint32_t scan_sdo_read(struct scan_plant *self, int id, unsigned index, unsigned sub,
                       uint32_t *ret_value);
uint32_t scan_sdo_write(struct scan_plant *self, int id, unsigned index, unsigned sub,
                        unsigned size, uint32_t value);
/* Any size, in segments where needed; *size is the room, then what came. */
uint32_t scan_sdo_upload(struct scan_plant *self, int id, unsigned index, unsigned sub, void *data,
                         unsigned *size);

#endif
