/*
 * Node 5 on network 0 that keeps its power-on values in a file: 1017h, 2000h and 6000h (16 bits,
 * DefaultValues 0, 20 and 60), 2001h (a string, "abc"), 2002h (read only, 1). One for the process.
 *
 *     store_set_up();
 *     store_start();
 *     store_change(1);
 *     store_save(1);
 *     store_restart();
 *     store_expect_changed(1);
 */
#ifndef TEST_SUPPORT_STORE_NODE_H
#define TEST_SUPPORT_STORE_NODE_H

#include "support/scan_plant.h"
#include "support/suite.h"

#define STORE_SAVE 0x65766173U
#define STORE_LOAD 0x64616F6CU

/* A folder for the file alone, a plant, and the log. */
void store_set_up(void);
void store_tear_down(void);
/* The same in two parts. */
void store_make_folder(void);
void store_remove_folder(void);

extern struct scan_plant *store_plant;
extern HNODE store_node;
extern char store_folder[SUITE_PATH_SIZE], store_path[SUITE_PATH_SIZE + 16];

/* Some line since the beginning, or since it was cleared, has the text; "": any line. */
bool store_log_has(const char *text);
void store_log_clear(void);

SLAVE_NODE_INFO store_info(unsigned long mask);
/* The node, off the bus and without a file; its handler is scan_on_event. */
void store_make(unsigned long mask);
/* With the file, and on the bus; its handler is not called. */
void store_start(void);
/* As after a power cut: nothing remains but the file. */
void store_restart(void);
/* An NMT command, and the boot-up message. */
void store_reset(const char *command);

/* By SDO. */
void store_put(unsigned index, unsigned size, uint32_t value);
uint32_t store_save(unsigned sub);
uint32_t store_load(unsigned sub);
/* Three values that this number makes. */
void store_change(unsigned by);

/* 1017h, 2000h, 6000h */
bool store_is(uint32_t communication, uint32_t manufacturer, uint32_t application);
void store_expect(uint32_t communication, uint32_t manufacturer, uint32_t application);
bool store_is_changed(unsigned by);
void store_expect_changed(unsigned by);
void store_expect_defaults(void);
/* How many there are in the folder. */
unsigned store_files(void);

#endif
