/*
 * A device as an application makes it with scanopen.h, for the measurements: on network 0
 * (MCANOPEN_NET_0 says where), operational by itself.
 *
 *   in   what it shall do
 *   out  on stdout "ready" when it is on the bus, and one line of JSON at the end; exit code 77
 *        with a line on stderr where a function of the library is not there yet
 */
#ifndef TEST_BENCH_DEVICE_H
#define TEST_BENCH_DEVICE_H

#include "scanopen.h"

#define DEVICE_NODE   5
#define DEVICE_NUMBER 0x2000 /* UINT32, for SDO */
#define DEVICE_OUTPUT 0x2001 /* UINT64, received by PDO */
#define DEVICE_INPUT  0x2002 /* UINT64, transmitted by PDO */
#define DEVICE_TINY   0x2100 /* domains, for SDO */
#define DEVICE_SMALL  0x2101
#define DEVICE_LARGE  0x2102
#define DEVICE_MANY   0x3000 /* UINT32, as many as wanted */

#define DEVICE_TINY_SIZE  1024u
#define DEVICE_SMALL_SIZE (64u * 1024u)
#define DEVICE_LARGE_SIZE (1024u * 1024u)

struct device {
    SLAVE_NODE_INFO info;      /* more than what device_create() gives it */
    PFN_COS_DATA_HANDLER told; /* of DEVICE_OUTPUT; NULL: no received PDO */
    int transmission;          /* type of the PDO with DEVICE_INPUT and its flags; -1: none */
    HNODE node;
    HPDO sent; /* the PDO with DEVICE_INPUT */
};

/* Ends the program where the result is an error; warnings pass. */
int device_need(const char *what, int result);

void device_open_network(void);
/* A node without objects of its own. */
HNODE device_create_node(int node_id, const SLAVE_NODE_INFO *info);
void device_add_number(HNODE node, unsigned short index);
void device_add_domain(HNODE node, unsigned short index, uint8_t *memory, unsigned long size);
/* The network, the node, its objects and PDOs; not yet active. */
void device_create(struct device *self);
/* On the bus and operational; says so. */
void device_run(const struct device *self);
void device_remove(const struct device *self);

/* What bench_device can do; each returns the exit code. number: the argument, or 0. */
int device_serve(unsigned long number);
int device_serve_domains(unsigned long number);
int device_write_pdo(unsigned long count);
int device_write_dictionary(unsigned long count);
int device_count_pdos(unsigned long number);
int device_time_pdos(unsigned long number);
int device_answer_sync(unsigned long number);
int device_produce_sync(unsigned long period_us);
int device_idle(unsigned long heartbeats);
int device_read_by_handle(unsigned long objects);
int device_read_by_index(unsigned long objects);
int device_memory(unsigned long nodes);

#endif
