#include "manager/network_config_elements.h"

#include "manager/network_config.h"

#include <stdlib.h>
#include <string.h>

#define NAME_SIZE_MAX 64u /* nobody means an element by a longer name */

#define MEMBER(type, member)                                                                       \
    .offset = offsetof(struct type, member), .size = sizeof(((struct type *)0)->member)
#define NETWORK(member) MEMBER(network_config, member)
#define NODE(member)    MEMBER(node_config, member)
#define HAS(member)     .given = offsetof(struct network_config, member)

/* The manual's data types, with range and default. */
#define NUMBER(low, high, preset) ELEMENT_NUMBER, low, high, preset
#define UCHAR(preset)             NUMBER(0, UINT8_MAX, preset)
#define USHORT(preset)            NUMBER(0, UINT16_MAX, preset)
#define ULONG(preset)             NUMBER(0, UINT32_MAX, preset)
#define NODE_ID(preset)           NUMBER(1, NETWORK_NODE_MAX, preset)
#define BOOL(preset)              ELEMENT_BOOL, 0, 0, preset
#define ASCII                     ELEMENT_ASCII, 0, 0, 0
#define INT16S                    ELEMENT_INT16, 0, 0, 0

static const struct element network_rows[] = {
    { "Net_No", UCHAR(0), NETWORK(net), .mandatory = true },
    { "Baudrate", ELEMENT_BITRATE, 0, 0, 0, NETWORK(baudrate), .mandatory = true,
      .out_of_range = CO_ERR_BITRATE },
    { "Manager_Node_Id", NODE_ID(127), NETWORK(manager_node_id), .out_of_range = CO_ERR_ARG },
    { "Name", ASCII, NETWORK(name) },           /* ours */
    { "Interface", ASCII, NETWORK(interface) }, /* ours */
    { "Config_File_Repository", ASCII, NETWORK(repository),
      .alias = "Config_File_Path" }, /* so in the manual's example */
    { "Heartbeat_Producer_Time", NUMBER(100, UINT16_MAX, 0),
      NETWORK(heartbeat_producer_time) },                              /* 1017h */
    { "Boot_Time", NUMBER(100, UINT16_MAX, 0), NETWORK(boot_time) },   /* 1F89h */
    { "NMT_Master", BOOL(true), NETWORK(nmt_master) },                 /* 1F80h bit 0 */
    { "NMT_Start_All", BOOL(false), NETWORK(start_all) },              /* 1F80h bit 1 */
    { "NMT_Auto_Operational", BOOL(true), NETWORK(auto_operational) }, /* 1F80h bit 2, inverted */
    { "NMT_Auto_Start", BOOL(true), NETWORK(auto_start) },             /* 1F80h bit 3, inverted */
    { "NMT_Action_On_Error", ELEMENT_ACTION, 0, 0, ACTION_RESET_SLAVE,
      NETWORK(action_on_error) }, /* 1F80h bits 4 and 6 */
    { "Boot_Delay", USHORT(200), NETWORK(boot_delay) },
    { "Wait_For_Startup", BOOL(false), NETWORK(wait_for_startup) },
    { "NMT_Reset_All", BOOL(false), NETWORK(reset_all) },
    { "Preset_Emergency_Consumer", BOOL(false), NETWORK(preset_emergency_consumer) },
    { "Sync_Interval", ULONG(0), NETWORK(sync_interval),
      HAS(has_sync_interval) },                           /* 1005h, 1006h */
    { "Sync_Cob_Id", ULONG(0x80), NETWORK(sync_cob_id) }, /* 1005h */
    { "Manager_Thread_Priorities", INT16S, NETWORK(manager_priorities),
      HAS(has_manager_priorities) },
    { "Slave_Thread_Priorities", INT16S, NETWORK(slave_priorities), HAS(has_slave_priorities) },
    { "Native_Thread_Priorities", BOOL(false), NETWORK(native_priorities) },
    { "Debug_Mask", ULONG(0), NETWORK(debug_mask) },
};

static const struct element node_rows[] = {
    { "Node_Id", NODE_ID(0), NODE(node_id), .mandatory = true, .out_of_range = CO_ERR_ARG },
    { "Name", ASCII, NODE(name) },                                  /* ours */
    { "NMT_Slave", BOOL(true), NODE(nmt_slave) },                   /* 1F81h bit 0 */
    { "NMT_Auto_Start_Slave", BOOL(true), NODE(auto_start_slave) }, /* 1F81h bit 2 */
    { "NMT_Mandatory_Slave", BOOL(false), NODE(mandatory) },        /* 1F81h bit 3 */
    { "Guard_Time", USHORT(0), NODE(guard_time) },                  /* 1F81h bytes 2, 3 */
    { "Life_Time_Factor", UCHAR(0), NODE(life_time_factor) },       /* 1F81h byte 1 */
    { "NMT_Check_Nodestate", BOOL(false), NODE(check_node_state) }, /* 1F81h bit 4 */
    { "NMT_Verify_Software", BOOL(false), NODE(verify_software) },  /* 1F81h bit 5 */
    { "NMT_Allow_Software_Update", BOOL(false), NODE(allow_software_update) }, /* 1F81h bit 6 */
    { "Consumer_Heartbeat_Time", USHORT(0), NODE(consumer_heartbeat_time) },   /* 1016h */
    { "Device_Type_Identification", ULONG(0), NODE(device_type) },             /* 1F84h */
    { "Vendor_Identification", ULONG(0), NODE(vendor_id) },                    /* 1F85h */
    { "Product_Code", ULONG(0), NODE(product_code) },                          /* 1F86h */
    { "Revision_Number", ULONG(0), NODE(revision_number) },                    /* 1F87h */
    { "Serial_Number", ULONG(0), NODE(serial_number) },                        /* 1F88h */
    { "DCF_File", ASCII, NODE(dcf_file) },
    { "CCF_File", ASCII, NODE(ccf_file) },
    { "Old_Config_Style", BOOL(false), NODE(old_config_style) },
    { "NMT_Reset_Node", BOOL(false), NODE(reset_node) },
    { "Boot_Delay", USHORT(200), NODE(boot_delay) },
    { "SDO_Timeout", NUMBER(1, UINT16_MAX, 200), NODE(sdo_timeout) },
    { "SDO_Segmented_Size_Indication", BOOL(true), NODE(indicate_size) },
    { "SDO_Block_Size", NUMBER(0, 127, 0), NODE(sdo_block_size) },          /* ours */
    { "Save_Configuration", BOOL(false), NODE(save_configuration) },        /* ours */
    { "Restore_Configuration", NUMBER(0, 127, 0), NODE(restore_sub) },      /* ours, 1F8Ah */
    { "Verify_Configuration", BOOL(false), NODE(verify_configuration) },    /* ours */
    { "Configuration_Date", ULONG(0), NODE(configuration_date) },           /* ours, 1F26h */
    { "Configuration_Time", ULONG(0), NODE(configuration_time) },           /* ours, 1F27h */
    { "Software_Identification", ULONG(0), NODE(software_identification) }, /* ours, 1F55h */
    { "Software_File", ASCII, NODE(software_file) },                        /* ours, 1F58h */
};

_Static_assert(sizeof network_rows / sizeof *network_rows <= ELEMENTS_MAX, "too many rows");
_Static_assert(sizeof node_rows / sizeof *node_rows <= ELEMENTS_MAX, "too many rows");

const struct element_table network_elements = { "Manager_Instance", network_rows,
                                                sizeof network_rows / sizeof *network_rows };
const struct element_table node_elements = { "Node_Instance", node_rows,
                                             sizeof node_rows / sizeof *node_rows };

const struct element *element_find(const struct element_table *table, const char *name)
{
    for (const struct element *row = table->rows; row < table->rows + table->count; row++)
        if (strcmp(row->name, name) == 0 || (row->alias && strcmp(row->alias, name) == 0))
            return row;
    return NULL;
}

static char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

/* How many characters to insert, delete or replace; upper and lower case are the same. */
static size_t edit_distance(const char *a, const char *b)
{
    size_t row[NAME_SIZE_MAX + 1];
    size_t size = strlen(b);

    for (size_t j = 0; j <= size; j++)
        row[j] = j;
    for (size_t i = 1; a[i - 1] != '\0'; i++) {
        size_t diagonal = row[0];

        row[0] = i;
        for (size_t j = 1; j <= size; j++) {
            size_t best = diagonal + (lower(a[i - 1]) != lower(b[j - 1]));

            diagonal = row[j];
            if (row[j] + 1 < best)
                best = row[j] + 1;
            row[j] = row[j - 1] + 1 < best ? row[j - 1] + 1 : best;
        }
    }
    return row[size];
}

const char *element_nearest(const struct element_table *table, const char *name)
{
    size_t size = strlen(name), least = 2 + size / 6;
    const char *nearest = NULL;

    if (size > NAME_SIZE_MAX)
        return NULL;
    for (const struct element *row = table->rows; row < table->rows + table->count; row++) {
        size_t distance = edit_distance(row->name, name);

        if (distance < least) {
            least = distance;
            nearest = row->name;
        }
    }
    return nearest;
}

void element_put(const struct element *self, void *base, uint32_t value)
{
    char *member = (char *)base + self->offset;
    const uint8_t byte = (uint8_t)value;
    const uint16_t word = (uint16_t)value;

    if (self->size == sizeof byte)
        memcpy(member, &byte, sizeof byte);
    else if (self->size == sizeof word)
        memcpy(member, &word, sizeof word);
    else
        memcpy(member, &value, sizeof value);
}

void elements_preset(const struct element_table *table, void *base)
{
    for (const struct element *row = table->rows; row < table->rows + table->count; row++)
        if (row->preset != 0)
            element_put(row, base, row->preset);
}

void elements_free(const struct element_table *table, void *base)
{
    for (const struct element *row = table->rows; row < table->rows + table->count; row++) {
        char *text = NULL;

        if (row->kind != ELEMENT_ASCII)
            continue;
        memcpy(&text, (char *)base + row->offset, sizeof text);
        free(text);
    }
}
