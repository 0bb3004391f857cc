/*
 * Will this plant boot? What the configuration of a whole network says, judged before anything is
 * on the bus.
 *
 *   in   the manager's XML file, and the files of all nodes, read as mcanOpenConfig() reads them
 *   out  messages with rules (audit_rules.def), each at the element or the line to be changed;
 *        estimates of bus load and boot time
 *
 * The values that a node will have (audit_value()) are what its configuration writes, over the
 * DefaultValues of its EDS or DCF. Where neither is there a value is not known, and what depends on
 * it is not judged.
 *
 * Only audit_open() reads files (audit_open.c, audit_files.c); the checks look at what it has made
 * of them.
 *
 *   owner    a tool, or a test
 *   locking  none
 */
#ifndef TOOLS_AUDIT_H
#define TOOLS_AUDIT_H

#include "base/report.h"
#include "dcf/dcf.h"
#include "manager/network_config.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* --- rules --- */

enum audit_rule {
#define AUDIT_RULE(rule, name, severity, clause, text) AUDIT_RULE_##rule,
#include "audit_rules.def"
#undef AUDIT_RULE
    AUDIT_RULE_COUNT
};

extern const struct co_rule audit_rules[AUDIT_RULE_COUNT];

/* --- the plant --- */

struct audit_place {
    const char *file;
    unsigned line; /* 0: the whole file */
};

struct audit_written { /* the last write of an entry */
    uint32_t address;  /* index and sub-index */
    uint32_t size;
    const uint8_t *bytes; /* in the node's ccf */
    unsigned line;        /* of the DCF; 0: not known */
};

struct audit_node {
    const struct audit_network *network;
    struct node_config *config;
    const void *element;    /* <Node_Instance> */
    char *file;             /* DCF_File or CCF_File where it was found; NULL: none */
    char *description_file; /* what describes the device: the DCF, or an EDS; NULL: nothing */
    struct dcf description;
    bool described;
    bool has_dcf;    /* the description is its DCF_File, if not all of it can be used */
    bool configured; /* what is written to it is known: its file was read, or there is none */
    struct audit_written *written; /* sorted by address */
    size_t written_count;
};

#define AUDIT_MAPPED_MAX 64u

struct audit_pdo {
    const struct audit_node *node;
    bool transmit;
    uint16_t number;          /* from 1 */
    uint32_t cob_id;          /* without bits 30 and 31 */
    bool is_chosen;           /* the COB-ID is another one than the DefaultValue */
    bool is_meant;            /* the configuration writes something of it */
    struct audit_place place; /* of the COB-ID */
    bool has_type;
    uint8_t type; /* transmission type */
    struct audit_place type_place;
    uint32_t inhibit_time; /* us; 0: none */
    uint32_t event_timer;  /* ms; 0: none */
    bool is_mapped;        /* the mapping is known ... */
    uint8_t count;         /* ... of so many objects */
    uint32_t mapped[AUDIT_MAPPED_MAX];
    unsigned bits;
};

/* Who uses a CAN-ID for what. */
enum audit_service {
    AUDIT_NMT,
    AUDIT_SYNC,
    AUDIT_TIME,
    AUDIT_EMCY,
    AUDIT_PDO,
    AUDIT_SDO_REQUEST,
    AUDIT_SDO_ANSWER,
    AUDIT_ERROR_CONTROL
};

struct audit_use {
    uint32_t can_id; /* with bit 29 for 29-bit identifiers */
    enum audit_service service;
    bool sends;
    const struct audit_node *node; /* NULL: the manager */
    uint16_t index;                /* of the object that says so; 0: none */
    uint8_t sub;
    bool is_chosen; /* by the configuration: no DefaultValue */
    struct audit_place place;
};

struct audit_load {       /* thousandths of a bit in a second, frames at their longest */
    uint64_t cyclic;      /* what comes by timers and SYNC */
    uint64_t most;        /* and event-driven PDOs at their inhibit times */
    unsigned unbounded;   /* event-driven PDOs without an inhibit time, which are not counted */
    unsigned unknown;     /* nodes of which not all is known */
    uint64_t sync_period; /* us; 0: nobody sends SYNC */
};

struct audit_boot {  /* us */
    uint64_t least;  /* devices that answer at once */
    uint64_t likely; /* devices that answer in AUDIT_ANSWER_TIME, and the first heartbeats */
    uint64_t least_mandatory, likely_mandatory; /* the same, until the mandatory nodes are there */
    unsigned requests;                          /* SDO requests of all nodes */
};

#define AUDIT_ANSWER_TIME 1000u /* us, from a request to the answer of a device */

struct audit_network {
    const struct audit *audit;
    struct co_report *report;
    struct network_config *config;
    const void *element; /* <Manager_Instance> */
    struct audit_node *nodes;
    size_t node_count;
    struct audit_pdo *pdos;
    size_t pdo_count, pdo_room;
    const struct audit_pdo **producers; /* the TPDOs, sorted by CAN-ID */
    size_t producer_count;
    struct audit_use *uses; /* sorted by CAN-ID */
    size_t use_count, use_room;
    struct audit_load load;
    struct audit_boot boot;
    bool no_memory;
};

struct audit_eds { /* --eds NODE=FILE */
    uint8_t node;
    const char *file;
    bool used; /* there is such a node */
};

struct audit {
    const char *xml_path;
    struct co_report *report;
    struct audit_eds *eds; /* the caller's */
    size_t eds_count;
    bool tells_files; /* all warnings about the files of nodes, not only their number */
    void *doc;        /* the XML file once more, for the lines of its elements */
    struct network_config *configs;
    struct audit_network *networks;
    size_t count;
};

/*
 * Reads the XML file and the files of all nodes; what is wrong goes to the report. False: there is
 * no network to look at (the XML file cannot be read, or has errors, or no memory); nothing is to
 * be closed then. xml_path, report, eds, eds_count and tells_files are set by the caller.
 */
bool audit_open(struct audit *self);
void audit_close(struct audit *self);

/* All checks, and the estimates. False: no memory. */
bool audit_run(struct audit *self);

/* For audit_open(). False: no memory. */
/* All that dcftest has to tell about the file that describes the device, once for each file. */
bool audit_tell_file(const struct audit_node *self);
/* Its DCF against the EDS of the device. */
bool audit_compare_file(const struct audit_node *self, const char *eds_file);

/* --- what the checks use --- */

struct audit_value {
    bool known;
    bool written;    /* by the configuration; else it is the DefaultValue */
    bool chosen;     /* and it is another one than that */
    uint64_t number; /* the first 8 bytes */
    uint32_t size;
    struct audit_place place; /* where it is to be changed */
};

struct audit_value audit_value(const struct audit_node *self, uint16_t index, uint8_t sub);
/* The number of a known value; where the device has the entry and tells no value, 0. */
uint64_t audit_number(const struct audit_node *self, uint16_t index, uint8_t sub, uint64_t missing);
/* What the device is known to have and not to have: both are false for one without description. */
bool audit_has(const struct audit_node *self, uint16_t index, uint8_t sub);
bool audit_lacks(const struct audit_node *self, uint16_t index, uint8_t sub);
/* The entry's line in the description; of no entry, of the whole file. */
struct audit_place audit_entry_place(const struct audit_node *self, uint16_t index, uint8_t sub);

/* "TPDO 3" */
struct audit_label audit_pdo_label(const struct audit_pdo *self);
/* 1600h.., 1A00h.. */
uint16_t audit_mapping_index(const struct audit_pdo *self);
/* Transmission types 0 to 240. */
bool audit_is_synchronous(const struct audit_pdo *self);

/* 1017h in ms; -1: not known. */
int32_t audit_heartbeat_time(const struct audit_node *self);
/* Its file, what it has and what is written to it: all is known. */
bool audit_is_known(const struct audit_node *self);
bool audit_knows_all(const struct audit_network *self);

const struct audit_node *audit_find_node(const struct audit_network *self, unsigned node_id);

/* An element of the node or the network; where it is not given, the line of what holds it. */
struct audit_place audit_node_place(const struct audit_node *self, const char *element);
struct audit_place audit_network_place(const struct audit_network *self, const char *element);

struct audit_label {
    char text[80];
};
/* node 5 "pump" */
struct audit_label audit_label(const struct audit_node *self);
/* 185h, with all digits of one with 29 bits */
struct audit_label audit_can_id(uint32_t can_id);

/* With the name of the network in front, where there are several. */
void audit_tell(const struct audit_network *self, struct audit_place place, enum audit_rule rule,
                const char *format, ...) __attribute__((format(printf, 4, 5)));

/* Bits of a frame on the wire: nominal, or as long as stuff bits make it. */
unsigned audit_frame_bits(bool is_long, unsigned size, bool stuffed);

/* The first producer of a CAN-ID, and how many there are. */
const struct audit_pdo *const *audit_find_producers(const struct audit_network *self,
                                                    uint32_t can_id, size_t *ret_count);
/* The first sender of SYNC; NULL: none. */
const struct audit_use *audit_find_sync(const struct audit_network *self);
/* The period in which a PDO is sent, us; 0: not known, or whenever something happens. */
uint64_t audit_pdo_period(const struct audit_pdo *self);
/* The manager guards it by remote frames. */
bool audit_is_guarded(const struct audit_node *self);

/* --- in the order in which they run --- */

void audit_collect_pdos(struct audit_network *self);
void audit_collect_uses(struct audit_network *self);
void audit_check_nodes(struct audit_network *self);
void audit_check_identity(struct audit_network *self);
void audit_check_configuration(struct audit_network *self);
void audit_check_heartbeats(struct audit_network *self);
void audit_check_guarding(struct audit_network *self);
void audit_check_can_ids(struct audit_network *self);
void audit_check_sync(struct audit_network *self);
void audit_check_mapping(struct audit_network *self);
void audit_check_links(struct audit_network *self);
void audit_check_load(struct audit_network *self);
void audit_check_boot_time(struct audit_network *self);

#endif
