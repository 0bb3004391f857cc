/*
 * The manager API as an application has it, with simulated devices around it: a virtual bus and a
 * temporary folder of its own for each test, real threads, real time. Nothing here sleeps: what is
 * waited for is an event, a line of the log or a frame, and the test's own time limit ends it.
 */
#ifndef TEST_SUPPORT_API_PLANT_H
#define TEST_SUPPORT_API_PLANT_H

#include "mcanopen.h"
#include "port/thread.h"
#include "runtime/network.h"
#include "support/suite.h"

#include <check.h>

#define API_LOG_SIZE 1048576u
#define API_PATIENCE CO_MS(30000) /* a test that waits longer has failed */
#define API_LIMIT    60           /* seconds: time limit of a test case */

/* Kinds of events, to be compared with EVENT_T.event without the NOT_VAL bits. */
#define API_EVENT(kind, message) ((kind) | (unsigned long)(message))
#define API_NETWORK_UP           API_EVENT(PARA_UC, MCANOPEN_MSG_NETWORK_UP)
#define API_NODE_STATE           API_EVENT(PARA_UC, MCANOPEN_MSG_NODE_STATE)

/* A configured node, and one with more in it. */
#define API_NODE_WITH(id, more)                                                                    \
    "<Node_Instance><Node_Id>" #id "</Node_Id>" more "</Node_Instance>\n"
#define API_NODE(id) API_NODE_WITH(id, "")
/* For what has to go well at the first try, also where other tests slow this one down. */
#define API_PATIENT "<SDO_Timeout>2000</SDO_Timeout>"

struct api_device {
    bool made, running;
    struct od od;
    struct slave slave;
};

struct api_plant {
    char bus[40];
    char folder[SUITE_PATH_SIZE];
    struct network *network; /* of the devices */
    struct api_device devices[NMT_NODE_MAX + 1];
    struct co_lock lock; /* of the log */
    struct co_condition changed;
    char log[API_LOG_SIZE]; /* "level text\n" for each line: "0 network.xml:3: error: ..." */
    size_t log_size;
};

/* The log hook is set; the library is not initialized. */
struct api_plant *api_plant_new(void);
/* Ends the library, too, if the test has not. */
void api_plant_free(struct api_plant *self);

/* --- devices; before api_devices_start() --- */

/* Type 00020192h, vendor 29Ah, 1017h. */
void api_add_device(struct api_plant *self, uint8_t node);
/* UNSIGNED8, 16 or 32, read-write. */
void api_add_number(struct api_plant *self, uint8_t node, uint16_t index, uint8_t size,
                    uint32_t value);
/* A DOMAIN of up to 'capacity' bytes. */
void api_add_domain(struct api_plant *self, uint8_t node, uint16_t index, const void *value,
                    uint32_t size, uint32_t capacity);
void api_devices_start(struct api_plant *self);
/* What is in an entry; its size. */
uint32_t api_get(struct api_plant *self, uint8_t node, uint16_t index, void *value, uint32_t room);

/* --- files and configuration --- */

/* The path of a file in the folder; valid until the next call but three. */
const char *api_path(const struct api_plant *self, const char *name);
void api_write(const struct api_plant *self, const char *name, const char *text);
/* Text of a network on this plant's bus; 'inner' goes behind its own elements. */
const char *api_network(const struct api_plant *self, int net, const char *inner);
/* Writes network.xml with one network, number 0, and configures; what mcanOpenConfig returned. */
int api_config(const struct api_plant *self, const char *inner);
/* The same with a whole file. */
int api_config_text(const struct api_plant *self, const char *text);
/* Initializes, configures and starts. */
void api_start(const struct api_plant *self, const char *inner);
/* The same; waits until the network is up. */
void api_boot(const struct api_plant *self, const char *inner);

/* --- waiting --- */

/* Takes events until this one comes; node -1: of any. */
EVENT_T api_wait_event(unsigned long kind, int node);
/* Takes events until the boot of the node has ended well (0) or failed: its letter. */
int api_wait_boot(int node);
/* Takes events until the node's state, as the manager knows it, is this one. */
void api_wait_state(int net, int node, int state);
void api_wait_log(struct api_plant *self, const char *text);
unsigned api_log_count(struct api_plant *self, const char *text);
void api_forget_log(struct api_plant *self);

#endif
