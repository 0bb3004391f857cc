/*
 * The manager's configuration file: XML in, one struct network_config for each <Manager_Instance>
 * out.
 *
 *   in   the bytes of the file, a report for messages with line numbers
 *   out  every element of the manual's sections 3.2.3 and 3.2.4, and ours, with value or default
 *
 * All of the file is read and every fault told (up to NETWORK_MESSAGES); a file with a fault gives
 * no configuration.
 *
 * What the file has begun, other tools of the network may change: the manager is then the one who
 * writes it (config_write.h), and this is all the configuration that there is.
 */
#ifndef CO_MANAGER_NETWORK_CONFIG_H
#define CO_MANAGER_NETWORK_CONFIG_H

#include "base/error.h"
#include "base/report.h"
#include "dcf/ccf.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define NETWORK_NODE_MAX     127u
#define NETWORK_INSTANCES    16u /* most <Manager_Instance> of a file */
#define NETWORK_MESSAGES     100u
#define NETWORK_REFUSALS     4u
#define NETWORK_REFUSAL_SIZE CO_REPORT_TEXT_SIZE
#define NETWORK_FILE_SIZE    (8u << 20) /* most bytes of a file */
#define NETWORK_PARTS        200000u    /* most elements, attributes and comments of a file */

enum action_on_error { ACTION_RESET_SLAVE, ACTION_RESET_ALL, ACTION_STOP_ALL };

struct node_config {
    unsigned line; /* of <Node_Instance> */
    uint8_t node_id;
    char *name; /* ours; NULL: none */
    bool nmt_slave;
    bool auto_start_slave;
    bool mandatory;
    uint16_t guard_time; /* ms */
    uint8_t life_time_factor;
    bool check_node_state;
    bool verify_software;
    bool allow_software_update;
    uint16_t consumer_heartbeat_time; /* ms; 0: off */
    uint32_t device_type;             /* 0: not compared; the same for the four below */
    uint32_t vendor_id;
    uint32_t product_code;
    uint32_t revision_number;
    uint32_t serial_number;
    char *dcf_file; /* as written, NULL: none */
    char *ccf_file;
    unsigned file_line;     /* of DCF_File or CCF_File */
    unsigned software_line; /* of Software_File */
    bool old_config_style;
    bool reset_node;             /* NMT_Reset_Node */
    uint16_t boot_delay;         /* ms */
    uint16_t sdo_timeout;        /* ms, not 0 */
    bool indicate_size;          /* SDO_Segmented_Size_Indication */
    bool save_configuration;     /* ours */
    bool restore;                /* 1F81h bit 7: restored by 1011h before it is configured ... */
    uint8_t restore_sub;         /* ... by this sub-index; 0: not */
    uint32_t configuration_date; /* ours; 0: not given */
    uint32_t configuration_time;
    uint32_t software_identification; /* ours, like the next three; 0: not compared */
    char *software_file;
    bool verify_configuration;
    uint8_t sdo_block_size; /* segments in a block; 0: no block transfer */
    struct ccf ccf;         /* what to write to the device; filled by api/ from the file */
    uint8_t *software;      /* its program, likewise; NULL: none */
    uint32_t software_size;
    uint8_t *dcf_text; /* what came over CAN, and the ccf was made of; NULL: none did */
    uint32_t dcf_text_size;
};

struct network_config {
    unsigned line; /* of <Manager_Instance> */
    uint8_t net;
    unsigned baudrate; /* kbit/s */
    uint8_t manager_node_id;
    char *name;                       /* ours */
    char *interface;                  /* ours: "can0", "virtual:demo"; NULL: by net number */
    char *repository;                 /* Config_File_Repository, or NULL */
    uint16_t heartbeat_producer_time; /* ms; 0: off */
    uint32_t boot_time;               /* ms; 0: no limit */
    bool nmt_master;
    bool start_all;
    bool auto_operational;
    bool auto_start;
    enum action_on_error action_on_error;
    uint16_t boot_delay; /* ms */
    bool wait_for_startup;
    bool reset_all;
    bool preset_emergency_consumer;
    bool has_sync_interval;
    uint32_t sync_interval; /* us */
    uint32_t sync_cob_id;
    bool has_manager_priorities, has_slave_priorities;
    int16_t manager_priorities[3]; /* control, error control, boot */
    int16_t slave_priorities[4];   /* NMT, PDO, SDO, EMCY */
    bool native_priorities;        /* false: 0 (lowest) .. 31 */
    uint32_t debug_mask;
    struct node_config *nodes; /* in the order of the file; they stay where they are */
    size_t node_count, node_room;
    /* What was wrong with the last configurations that came over CAN and were not taken. */
    char refusals[NETWORK_REFUSALS][NETWORK_REFUSAL_SIZE]; /* number n is in n % NETWORK_REFUSALS */
    uint32_t refused;                                      /* number of the last one; 0: none yet */
};

/*
 * CO_ERR_FORMAT: no well-formed XML, or not a configuration at all; CO_ERR_VALUE: an unknown
 * element, a value out of range, a duplicate, something mandatory missing; CO_ERR_MEMORY. Kinds of
 * errors (co_report_kind) are these too, and CO_ERR_ARG for a node-ID out of range, CO_ERR_BITRATE
 * for a bit rate that CANopen does not have, CO_ERR_AGAIN for more networks than there is room for.
 * The outputs are untouched on failure.
 */
enum co_err network_config_parse(const char *text, size_t size, struct co_report *report,
                                 struct network_config **ret_networks, size_t *ret_count);
void network_config_free(struct network_config *networks, size_t count);

const struct node_config *network_config_node(const struct network_config *self, uint8_t node_id);

/* A node as in a file that says nothing of it: the defaults, but it is not in the network list. */
struct node_config network_config_unlisted(uint8_t node_id);
/* The node, to be changed; where there is none, a new one that is not listed. NULL: no memory. */
struct node_config *network_config_take_node(struct network_config *self, uint8_t node_id);

#endif
