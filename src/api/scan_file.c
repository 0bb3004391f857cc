/* A node as its EDS or DCF file describes it: canOpenCreateNodeFromFile, canOpenGetPDOHnd. */
#include "api/load.h"
#include "api/log.h"
#include "api/scan.h"
#include "mcanopen.h"

#include <stdlib.h>

#define FIRST_APPLICATION 0x2000u
#define FILE_OPTIONS      (PDO_ACCEPT_LONG)

/* The application may give the entries of its objects handlers and other properties. */
static enum co_err adopt_entries(struct od *od)
{
    for (size_t i = 0; i < od->count; i++) {
        struct scan_entry *owner;

        if (od->entries[i]->index < FIRST_APPLICATION)
            continue;
        owner = calloc(1, sizeof *owner);
        if (!owner)
            return CO_ERR_MEMORY;
        owner->initialized = true;
        od->entries[i]->owner = owner;
    }
    return CO_OK;
}

/* The highest number of a PDO in this direction; numbers may have gaps. */
static uint16_t highest_pdo(const struct od *od, uint16_t first)
{
    uint16_t highest = 0;

    for (uint16_t i = 0; i < SCAN_PDOS; i++)
        if (od_has_object(od, (uint16_t)(first + i)))
            highest = (uint16_t)(i + 1);
    return highest;
}

static int make_pdos(struct scan_node *node)
{
    node->rpdo_max = node->rpdo_count = highest_pdo(&node->od, 0x1400);
    node->tpdo_max = node->tpdo_count = highest_pdo(&node->od, 0x1800);
    node->rpdos = calloc(node->rpdo_max + 1u, sizeof *node->rpdos);
    node->tpdos = calloc(node->tpdo_max + 1u, sizeof *node->tpdos);
    if (!node->rpdos || !node->tpdos)
        return SCANOPEN_OUT_OF_MEMORY;
    for (unsigned i = 0; i < node->rpdo_count; i++)
        node->rpdos[i].mode = RECEIVE_PDO | AUTO_NOTIFY_PDO;
    for (unsigned i = 0; i < node->tpdo_count; i++)
        node->tpdos[i].mode = TRANSMIT_PDO | AUTO_NOTIFY_PDO;
    return SCANOPEN_OK;
}

static int fill_dictionary(struct scan_node *node, const char *path)
{
    struct co_report report = { .sink = log_sink };
    struct dcf dcf;
    enum co_err err;

    if (load_dcf(path, &report, &dcf) != MCANOPEN_OK)
        return SCANOPEN_WRONG_PARAMETER;
    report.file = path;
    err = dcf_make_od(&dcf, node->id, &report, &node->od);
    dcf_done(&dcf);
    if (err == CO_OK)
        err = adopt_entries(&node->od);
    if (err == CO_OK)
        return SCANOPEN_OK;
    return err == CO_ERR_MEMORY ? SCANOPEN_OUT_OF_MEMORY : SCANOPEN_WRONG_PARAMETER;
}

int scan_make_from_file(struct scan_node *node, const char *path)
{
    int result = fill_dictionary(node, path);

    node->from_file = true;
    if (result == SCANOPEN_OK)
        result = make_pdos(node);
    if (result == SCANOPEN_OK)
        scan_count_maps(node);
    return result;
}

int canOpenCreateNodeFromFile(int iNetNo, int iModID, PFN_COS_EVENT_HANDLER EventHandler,
                              const char *FileName, const SLAVE_NODE_INFO *pSlaveInfo, HNODE *HNode)
{
    const SLAVE_NODE_INFO none = { .ulOptions = 0 };
    const struct scan_order order = { .net = iNetNo,
                                      .id = iModID,
                                      .info = pSlaveInfo ? pSlaveInfo : &none,
                                      .file = FileName,
                                      .on_event = EventHandler };

    if (!FileName || (order.info->ulOptions & ~(unsigned long)FILE_OPTIONS) != 0)
        return SCANOPEN_WRONG_PARAMETER;
    return scan_create_node(&order, HNode);
}

/* ---- handles of PDOs ---- */

static int find_pdo(const struct scan_node *node, unsigned index, HPDO *ret_handle)
{
    const bool transmit = index >= 0x1800;
    const unsigned number = index - (transmit ? 0x1800u : 0x1400u) + 1;

    if (index < 0x1400 || (index >= 0x1600 && index < 0x1800) || index >= 0x1A00 ||
        !scan_pdo(node, transmit, (uint16_t)number) || !od_has_object(&node->od, (uint16_t)index))
        return SCANOPEN_WRONG_INDEX;
    *ret_handle = scan_pdo_handle(node, transmit, (uint16_t)number);
    return SCANOPEN_OK;
}

int canOpenGetPDOHnd(HNODE HNode, unsigned short Index, HPDO *Hpdo)
{
    struct scan_node *node;
    int result = scan_enter(HNode, &node);

    if (Hpdo)
        *Hpdo = NULL;
    if (result != SCANOPEN_OK)
        return result;
    network_hold(node->net->network);
    result = Hpdo ? find_pdo(node, Index, Hpdo) : SCANOPEN_WRONG_PARAMETER;
    network_release(node->net->network);
    scan_leave(node);
    return result;
}
