#include "manager/network_config_check.h"

#include "slave/slave_pdo.h"

#include <string.h>

#define NO_IDENTIFIER 0x80000000u /* bits of 1005h: reserved */
#define SYNC_PRODUCER 0x40000000u /* bit of 1005h; the manager sets it by itself */

/* The line of a valid element; 0: not there. */
static unsigned valid_line(const struct element_table *table, const struct element_lines *lines,
                           const char *name)
{
    return lines->valid[element_find(table, name) - table->rows];
}

void check_mandatory(const struct element_table *table, const struct element_lines *lines,
                     unsigned line, struct faults *faults)
{
    for (size_t i = 0; i < table->count; i++)
        if (table->rows[i].mandatory && lines->any[i] == 0)
            faults_error(faults, CO_ERR_VALUE, line, "%s: %s is missing", table->parent,
                         table->rows[i].name);
}

static void check_unique(const char *name, unsigned number, unsigned line, unsigned *lines,
                         struct faults *faults)
{
    if (line == 0)
        return;
    if (lines[number] != 0)
        faults_error(faults, CO_ERR_VALUE, line, "%s: %u is already given in line %u", name, number,
                     lines[number]);
    else
        lines[number] = line;
}

static void check_files(const struct node_config *config, const struct element_lines *lines,
                        struct faults *faults)
{
    unsigned dcf = valid_line(&node_elements, lines, "DCF_File");
    unsigned ccf = valid_line(&node_elements, lines, "CCF_File");

    if (dcf != 0 && ccf > dcf)
        faults_error(faults, CO_ERR_VALUE, ccf, "CCF_File: there is a DCF_File in line %u already",
                     dcf);
    else if (dcf != 0 && ccf != 0)
        faults_error(faults, CO_ERR_VALUE, dcf, "DCF_File: there is a CCF_File in line %u already",
                     ccf);
    else if (ccf != 0 && config->old_config_style)
        faults_note(faults, CO_WARNING, valid_line(&node_elements, lines, "Old_Config_Style"),
                    "Old_Config_Style: has no effect on a CCF_File");
}

/* A device is spared the download only if both are equal, so one alone is a mistake. */
static void check_date(const struct element_lines *lines, struct faults *faults)
{
    unsigned date = valid_line(&node_elements, lines, "Configuration_Date");
    unsigned time = valid_line(&node_elements, lines, "Configuration_Time");

    if (date != 0 && time == 0)
        faults_error(faults, CO_ERR_VALUE, date,
                     "Configuration_Date: needs Configuration_Time too");
    if (time != 0 && date == 0)
        faults_error(faults, CO_ERR_VALUE, time,
                     "Configuration_Time: needs Configuration_Date too");
}

static void check_error_control(const struct node_config *config, const struct element_lines *lines,
                                struct faults *faults)
{
    if (config->consumer_heartbeat_time != 0 && config->guard_time != 0 &&
        config->life_time_factor != 0)
        faults_note(faults, CO_INFO, valid_line(&node_elements, lines, "Guard_Time"),
                    "Guard_Time: not used, Consumer_Heartbeat_Time takes its place");
    if (config->check_node_state && config->consumer_heartbeat_time == 0 &&
        (config->guard_time == 0 || config->life_time_factor == 0))
        faults_note(faults, CO_WARNING, valid_line(&node_elements, lines, "NMT_Check_Nodestate"),
                    "NMT_Check_Nodestate: without Consumer_Heartbeat_Time the state is asked for "
                    "by guarding");
}

/* What cannot come to anything, though each element is right. */
static void check_software(const struct node_config *config, const struct element_lines *lines,
                           struct faults *faults)
{
    unsigned verify = valid_line(&node_elements, lines, "NMT_Verify_Software");
    unsigned allow = valid_line(&node_elements, lines, "NMT_Allow_Software_Update");
    unsigned file = valid_line(&node_elements, lines, "Software_File");

    if (config->verify_software && config->software_identification == 0)
        faults_note(faults, CO_WARNING, verify,
                    "NMT_Verify_Software: without Software_Identification the node does not boot "
                    "(boot error G)");
    if (config->allow_software_update && !config->verify_software)
        faults_note(faults, CO_WARNING, allow,
                    "NMT_Allow_Software_Update: has no effect without NMT_Verify_Software");
    else if (config->allow_software_update && config->check_node_state)
        faults_note(faults, CO_WARNING, allow,
                    "NMT_Allow_Software_Update: has no effect on a node with NMT_Check_Nodestate");
    else if (config->allow_software_update && !config->software_file)
        faults_note(faults, CO_WARNING, allow,
                    "NMT_Allow_Software_Update: there is no Software_File to update it with");
    if (config->software_file && !config->allow_software_update)
        faults_note(faults, CO_WARNING, file,
                    "Software_File: has no effect without NMT_Allow_Software_Update");
}

void check_node(const struct node_config *config, const struct element_lines *lines,
                struct unique_lines *unique, struct faults *faults)
{
    check_mandatory(&node_elements, lines, config->line, faults);
    check_unique("Node_Id", config->node_id, valid_line(&node_elements, lines, "Node_Id"),
                 unique->nodes, faults);
    check_files(config, lines, faults);
    check_date(lines, faults);
    check_error_control(config, lines, faults);
    check_software(config, lines, faults);
}

/* The portable scale; native priorities are the operating system's to judge. */
static void check_priorities(const char *name, const int16_t *values, size_t count, unsigned line,
                             struct faults *faults)
{
    for (size_t i = 0; i < count; i++)
        if (values[i] < 0 || values[i] > 31) {
            faults_error(faults, CO_ERR_VALUE, line,
                         "%s: %d is out of range 0..31 (Native_Thread_Priorities is FALSE)", name,
                         values[i]);
            return;
        }
}

static void check_manager_id(const struct network_config *config, const struct element_lines *lines,
                             const struct unique_lines *unique, struct faults *faults)
{
    unsigned node_line = unique->nodes[config->manager_node_id];
    unsigned line = valid_line(&network_elements, lines, "Manager_Node_Id");

    if (node_line == 0)
        return;
    if (line != 0)
        faults_error(faults, CO_ERR_VALUE, node_line,
                     "Node_Id: %u is the manager's own (Manager_Node_Id in line %u)",
                     config->manager_node_id, line);
    else
        faults_error(faults, CO_ERR_VALUE, node_line,
                     "Node_Id: %u is the manager's own (default of Manager_Node_Id)",
                     config->manager_node_id);
}

static void check_sync(const struct network_config *config, unsigned line, struct faults *faults)
{
    const struct od nothing = { .count = 0 };

    if (line == 0)
        return;
    if ((config->sync_cob_id & NO_IDENTIFIER) != 0 ||
        !slave_may_use(&nothing, config->sync_cob_id & ~SYNC_PRODUCER, true))
        faults_error(faults, CO_ERR_VALUE, line,
                     "Sync_Cob_Id: 0x%X belongs to other services, or is no identifier",
                     (unsigned)config->sync_cob_id);
    else if (!config->has_sync_interval)
        faults_note(faults, CO_WARNING, line, "Sync_Cob_Id: has no effect without Sync_Interval");
}

void check_network(const struct network_config *config, const struct element_lines *lines,
                   struct unique_lines *unique, struct faults *faults)
{
    const struct element_table *table = &network_elements;

    check_mandatory(table, lines, config->line, faults);
    check_unique("Net_No", config->net, valid_line(table, lines, "Net_No"), unique->nets, faults);
    check_manager_id(config, lines, unique, faults);
    if (!config->native_priorities) {
        check_priorities("Manager_Thread_Priorities", config->manager_priorities, 3,
                         valid_line(table, lines, "Manager_Thread_Priorities"), faults);
        check_priorities("Slave_Thread_Priorities", config->slave_priorities, 4,
                         valid_line(table, lines, "Slave_Thread_Priorities"), faults);
    }
    check_sync(config, valid_line(table, lines, "Sync_Cob_Id"), faults);
    if (config->node_count == 0)
        faults_note(
            faults, CO_WARNING, config->line,
            "Manager_Instance: without any Node_Instance there is nothing to manage until other "
            "tools configure it");
    memset(unique->nodes, 0, sizeof unique->nodes);
}
