/*
 * A plant for scenario tests: an XML text, simulated devices made in code, all in a struct sim.
 */
#ifndef TEST_SUPPORT_PLANT_H
#define TEST_SUPPORT_PLANT_H

#include "support/sim.h"

/* A node of the XML: its ID and more elements. */
#define PLANT_NODE(id, more) "<Node_Instance><Node_Id>" #id "</Node_Id>" more "</Node_Instance>"

#define PLANT_TEXT_SIZE 262144u

#define PLANT_LIES      8u
#define PLANT_TALK_SIZE 4096u

/* A request that the device never hears, and what is answered in its place. */
struct plant_lie {
    const char *request; /* the frame's text, or the beginning of it */
    const char *answer;  /* NULL: silence */
    unsigned times;      /* how often still */
};

struct plant_device {
    struct od od;
    struct slave slave;
    struct sim_device *sim;
    uint8_t nmt_state; /* by the commands that it has heard, as watch_start() sees it */
    unsigned resets;   /* times that it has begun anew */
    bool reborn;       /* its last boot-up message was lost */
    bool overtaken;    /* a start command was behind its boot-up message on the wire */
};

struct plant {
    char name[64]; /* for messages of tests */
    struct sim sim;
    struct network_config *config;
    size_t config_count;
    struct manager *manager;
    struct sim_device *manager_device;
    struct plant_device *devices[NETWORK_NODE_MAX + 1]; /* by node-ID; NULL: not simulated */
    char events[PLANT_TEXT_SIZE];                       /* each event's text, a line each */
    size_t events_size;
    enum sim_fate (*fault)(struct plant *self, const struct co_frame *frame, uint8_t sender);
    void *fault_context;
    /* After fault() has let it pass, before anybody hears it. */
    void (*on_delivered)(struct plant *self, const struct co_frame *frame, uint8_t sender);
    void (*on_event)(struct plant *self, const struct co_event *event);    /* of the manager */
    void (*watch_event)(struct plant *self, const struct co_event *event); /* the same */
    uint8_t network_state; /* of the manager, after the last step */
    char talk[PLANT_TALK_SIZE];
    struct plant_lie lies[PLANT_LIES];
    unsigned lie_count;
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
/* Powers one device. */
void plant_power(struct plant *self, uint8_t node, bool on);
/* Takes the manager's power away, or starts it anew; it has forgotten everything. */
void plant_power_manager(struct plant *self, bool on);
/* The next 'times' requests that begin like this get this answer, not the device's. */
void plant_lie(struct plant *self, const char *request, const char *answer, unsigned times);
/* An order of the application. */
enum co_err plant_command(struct plant *self, enum nmt_command command, uint8_t node);
/* How often a frame with a text that begins like this was on the wire. */
unsigned plant_sent(const struct plant *self, const char *frame);
/*
 * The SDO transfers with a node, in a buffer of its own until the next call: " rINDEX:SUB" read,
 * " wINDEX:SUB=VALUE" written in a frame or in segments (then with the size), " b" in blocks.
 * Without those of 1000h.
 */
const char *plant_talk(struct plant *self, uint8_t node);
void plant_run_ms(struct plant *self, unsigned ms);
struct boot_node *plant_node(struct plant *self, uint8_t node);
bool plant_said(const struct plant *self, const char *text);
/* How often the events have this text. */
unsigned plant_said_times(const struct plant *self, const char *text);

#endif
