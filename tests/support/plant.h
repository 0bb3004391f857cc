/*
 * A plant for scenario tests: an XML text, simulated devices made in code, all in a struct sim.
 */
#ifndef TEST_SUPPORT_PLANT_H
#define TEST_SUPPORT_PLANT_H

#include "support/sim.h"

#define PLANT_TEXT_SIZE 65536u

struct plant_device {
    struct od od;
    struct slave slave;
    struct sim_device *sim;
};

struct plant {
    struct sim sim;
    struct network_config *config;
    size_t config_count;
    struct manager *manager;
    struct sim_device *manager_device;
    struct plant_device *devices[NETWORK_NODE_MAX + 1]; /* by node-ID; NULL: not simulated */
    char events[PLANT_TEXT_SIZE]; /* each event's text, a line each */
    size_t events_size;
    bool (*fault)(struct plant *self, const struct co_frame *frame, uint8_t sender);
    void *fault_context;
};

/* The XML is the inside of <Manager_Instance>; Net_No and Baudrate are given already. */
struct plant *plant_new(const char *xml, unsigned bitrate);
void plant_free(struct plant *self);

/* A device of type 00020192h, vendor 29Ah, product 1, revision 10001h, serial the node-ID. */
struct plant_device *plant_add_device(struct plant *self, uint8_t node);
/* Adds an UNSIGNED8/16/32 to a device. */
void plant_add_object(struct plant_device *device, uint16_t index, uint8_t sub, uint8_t size,
                      uint32_t value);
/* A write for the node's configuration. */
void plant_configure(struct plant *self, uint8_t node, uint16_t index, uint8_t sub, uint8_t size,
                     uint32_t value);

/* Powers devices, then the manager. */
void plant_power_on(struct plant *self);
void plant_run_ms(struct plant *self, unsigned ms);
struct boot_node *plant_node(struct plant *self, uint8_t node);
bool plant_said(const struct plant *self, const char *text);
/* How often the events have this text. */
unsigned plant_said_times(const struct plant *self, const char *text);

#endif
