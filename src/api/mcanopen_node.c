#include "mcanopen.h"

#include "api/error_map.h"
#include "api/registry.h"
#include "manager/boot_text.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

/* --- NMT commands --- */

/* Over when the command was put out: the network sends what its queue holds. */
static int command(int net, int node, enum nmt_command nmt)
{
    struct managed *managed;
    struct co_outbox *out;
    co_us_t now;
    int result;

    if (node < 0 || node > (int)NMT_NODE_MAX)
        return MCAL_PARA_ERROR;
    result = registry_enter(net, true, &managed);
    if (result != MCANOPEN_OK)
        return result;
    out = network_enter(managed->network, &now);
    result = error_of_bus_state(network_bus_state(managed->network));
    if (result == MCANOPEN_OK && !network_takes(managed->network, NMT_CAN_ID))
        result = MCAL_CAN_CONTR_BUSY;
    if (result == MCANOPEN_OK)
        result = error_of_command(manager_command(managed->manager, nmt, (uint8_t)node, now, out));
    network_leave(managed->network, managed->config->manager_node_id);
    registry_leave();
    return result;
}

int mcanOpenStartNode(int net, int nodeID)
{
    return command(net, nodeID, NMT_START);
}

int mcanOpenStopNode(int net, int nodeID)
{
    return command(net, nodeID, NMT_STOP);
}

int mcanOpenResetNode(int net, int nodeID)
{
    return command(net, nodeID, NMT_RESET_NODE);
}

int mcanOpenEnterPreop(int net, int nodeID)
{
    return command(net, nodeID, NMT_ENTER_PREOPERATIONAL);
}

int mcanOpenNodeControl(int net, int nodeID, long flags)
{
    (void)net;
    (void)nodeID;
    (void)flags;
    return MCANOPEN_OK;
}

/* --- state --- */

static int state_of(const struct manager *manager, uint8_t node, int *ret_state)
{
    if (node == manager->config->manager_node_id)
        *ret_state = manager->device.state;
    else if (manager->nodes[node].config)
        *ret_state = manager->nodes[node].nmt_state;
    else
        return MCAL_NODE_NOT_EXISTEND;
    return MCANOPEN_OK;
}

int mcanOpenGetNodeState(int net, int nodeID, int *state)
{
    struct managed *managed;
    co_us_t now;
    int result;

    if (!state || nodeID < 1 || nodeID > (int)NMT_NODE_MAX)
        return MCAL_PARA_ERROR;
    result = registry_enter(net, false, &managed);
    if (result != MCANOPEN_OK)
        return result;
    network_enter(managed->network, &now);
    result = state_of(managed->manager, (uint8_t)nodeID, state);
    network_leave(managed->network, managed->config->manager_node_id);
    registry_leave();
    return result;
}

static void fill_history(const struct boot_node *node, BOOT_RECORD_T *record)
{
    const struct node_config *config = node->config;
    const struct boot_failure *last = &node->history.last;
    const char *file = config->dcf_file ? config->dcf_file : config->ccf_file;

    record->tried = node->tried;
    record->keptAlive = node->kept_alive;
    record->entries = ccf_count(&config->ccf);
    record->failures = node->history.failures;
    record->failedStep = last->step;
    record->failedLetter = last->letter;
    record->failedIndex = last->index;
    record->failedSubindex = last->sub;
    record->failedAbortCode = last->abort_code;
    record->failedExpected = last->expected;
    record->failedActual = last->actual;
    if (last->step == BOOT_CONFIGURE) {
        record->failedEntry = last->entry;
        record->failedLine = ccf_line(&config->ccf, last->entry);
    }
    record->failedTime = node->history.failed_at;
    record->bootedTime = node->history.booted_at;
    boot_text_failure(config, last, record->failedText, sizeof record->failedText);
    if (file)
        snprintf(record->file, sizeof record->file, "%s", file);
}

static void fill_record(const struct boot_node *node, BOOT_RECORD_T *record)
{
    *record = (BOOT_RECORD_T){ .mandatory = node->config->mandatory,
                               .state = node->nmt_state,
                               .step = node->step,
                               .letter = node->booted && node->kept_alive ? 'L'
                                                                          : node->failure.letter,
                               .booted = node->booted,
                               .index = node->failure.index,
                               .subindex = node->failure.sub,
                               .abortCode = node->failure.abort_code,
                               .expected = node->failure.expected,
                               .actual = node->failure.actual,
                               .attempts = node->attempts };
    if (node->config->name)
        snprintf(record->name, sizeof record->name, "%s", node->config->name);
    boot_text_node(node, record->text, sizeof record->text);
    fill_history(node, record);
}

/* Applications of the first version end here. */
#define FIRST_SIZE offsetof(BOOT_RECORD_T, failures)

int mcanOpenGetBootRecord(int net, int nodeID, BOOT_RECORD_T *record)
{
    struct managed *managed;
    BOOT_RECORD_T whole;
    co_us_t now;
    int result;

    if (!record || record->size < (int)FIRST_SIZE || nodeID < 1 || nodeID > (int)NMT_NODE_MAX)
        return MCAL_PARA_ERROR;
    result = registry_enter(net, false, &managed);
    if (result != MCANOPEN_OK)
        return result;
    network_enter(managed->network, &now);
    if (managed->manager->nodes[nodeID].config)
        fill_record(&managed->manager->nodes[nodeID], &whole);
    else
        result = MCAL_NODE_NOT_EXISTEND;
    network_leave(managed->network, managed->config->manager_node_id);
    registry_leave();
    if (result == MCANOPEN_OK) {
        whole.size = record->size;
        memcpy(record, &whole,
               (size_t)whole.size < sizeof whole ? (size_t)whole.size : sizeof whole);
    }
    return result;
}
