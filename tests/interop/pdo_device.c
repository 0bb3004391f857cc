/*
 * Node 5 for test_peer_pdo.py: objects of all widths in PDOs, that a peer maps anew. Runs until the
 * end of stdin; "request" there requests RPDO 1 by remote frame and prints its data.
 *
 *   2100h, 2101h  outputs, flags: written by RPDO or SDO, ...
 *   2200h, 2201h  inputs, flags: ... mirrored here by the handlers, and so sent by TPDO
 *   2300h         moment: counts how often it was asked for
 *   2400h         shared: in an RPDO and in a TPDO, without handlers
 */
#include <scanopen.h>

#include <stdio.h>
#include <string.h>

enum { NET = 0, NODE = 5, FLAGS = 8, OUTPUTS_TO_INPUTS = 0x100, RX_TIMEOUT = 15000 };

static HNODE node;
static DictionaryData zero;

static int on_output(int net, int node_id, int index, int sub, void *data)
{
    (void)net, (void)node_id;
    if (data)
        canOpenWriteDictionary(node, (unsigned short)(index + OUTPUTS_TO_INPUTS),
                               (unsigned short)sub, data);
    return SCANOPEN_OK;
}

static int on_moment(int net, int node_id, int index, int sub, void *data)
{
    uint32_t moment;

    (void)net, (void)node_id, (void)data;
    canOpenReadDictionary(node, (unsigned short)index, (unsigned short)sub, &moment);
    moment++;
    canOpenWriteDictionary(node, (unsigned short)index, (unsigned short)sub, &moment);
    return SCANOPEN_OK;
}

static const char widths[] = { TYP_INT8,   TYP_INT16,  TYP_INT32, TYP_INT64,  TYP_UINT8, TYP_UINT16,
                               TYP_UINT32, TYP_UINT64, TYP_FLOAT, TYP_DOUBLE, 0 };
static const char pair[] = { TYP_UINT32, TYP_FLOAT, 0 };

#define RO (READ_ACCESS | MULTI_MAP)
#define RW (READ_ACCESS | WRITE_ACCESS | MULTI_MAP)
BEGIN_DICTIONARY_TABLE(Objects)
    DICTIONARY_ENTRY(0x2100, 10, OBJ_RECORD, widths, RW, &zero, on_output, NULL)
    DICTIONARY_ENTRY(0x2101, FLAGS, OBJ_ARRAY, MAP_BOOL, RW, &zero, on_output, NULL)
    DICTIONARY_ENTRY(0x2200, 10, OBJ_RECORD, widths, RO, &zero, NULL, NULL)
    DICTIONARY_ENTRY(0x2201, FLAGS, OBJ_ARRAY, MAP_BOOL, RO, &zero, NULL, NULL)
    DICTIONARY_ENTRY(0x2300, 0, OBJ_VAR, MAP_UINT32, RO, &zero, on_moment, NULL)
    DICTIONARY_ENTRY(0x2400, 2, OBJ_RECORD, pair, RW, &zero, NULL, NULL)
    DICTIONARY_ENTRY(0x2500, 0, OBJ_VAR, MAP_UINT8, READ_ACCESS | WRITE_ACCESS, &zero, NULL, NULL)
END_DICTIONARY_TABLE()

BEGIN_MAPPING_TABLE(Outputs)
    MAPPING_ENTRY(0x2100, 1)
    MAPPING_ENTRY(0x2100, 2)
    MAPPING_ENTRY(0x2100, 3)
END_MAPPING_TABLE()

BEGIN_MAPPING_TABLE(Inputs)
    MAPPING_ENTRY(0x2200, 1)
    MAPPING_ENTRY(0x2200, 2)
    MAPPING_ENTRY(0x2200, 3)
END_MAPPING_TABLE()

BEGIN_MAPPING_TABLE(Shared)
    MAPPING_ENTRY(0x2400, 1)
    MAPPING_ENTRY(0x2400, 2)
END_MAPPING_TABLE()

BEGIN_MAPPING_TABLE(Moment)
    MAPPING_ENTRY(0x2300, 0)
END_MAPPING_TABLE()

BEGIN_PDO_TABLE(Received)
    PDO_ENTRY(DEFAULT_PDO1, RECEIVE_PDO | AUTO_NOTIFY | 255, 0, 0, RX_TIMEOUT, 0, Outputs)
    PDO_ENTRY(DEFAULT_PDO2, RECEIVE_PDO | SYNCHRON_PDO | 1, 0, 0, 0, 0, Shared)
    PDO_ENTRY_UNMAPPED(DEFAULT_PDO3 | PDO_INVALID, RECEIVE_PDO | AUTO_NOTIFY | 255, 0, 0, 0, 0)
END_PDO_TABLE()

BEGIN_PDO_TABLE(Sent)
    PDO_ENTRY(DEFAULT_PDO1, TRANSMIT_PDO | AUTO_NOTIFY | 255, 0, 0, 0, 0, Inputs)
    PDO_ENTRY(DEFAULT_PDO2, TRANSMIT_PDO | SYNCHRON_PDO | 1, 0, 0, 0, 0, Shared)
    PDO_ENTRY(DEFAULT_PDO3, TRANSMIT_PDO | 253, 0, 0, 0, 0, Moment)
    PDO_ENTRY_UNMAPPED(DEFAULT_PDO4 | PDO_INVALID | RTR_DISALLOW, TRANSMIT_PDO | AUTO_NOTIFY | 255,
                       0, 0, 0, 0)
END_PDO_TABLE()

static int create_node(void)
{
    const SLAVE_NODE_INFO info = { .ulOptions = SYNCHRON_PDOS | SYNC_GENERATION,
                                   .ulSyncCobID = DEFAULT_SYNC_COBID,
                                   .ucMaxIdentityObject = 1,
                                   .ucMaxMapped = 4,
                                   .usRxPDO = 3,
                                   .usTxPDO = 4 };
    int result = canOpenCreateNodeEx(NET, NODE, NULL, &info, &node);

    if (result == SCANOPEN_OK)
        result = DECLARE_DICTIONARY(node, Objects);
    if (result == SCANOPEN_OK)
        result = DECLARE_PDO(node, Received);
    if (result == SCANOPEN_OK)
        result = DECLARE_PDO(node, Sent);
    return result == SCANOPEN_OK ? canOpenActivateNode(node) : result;
}

static void request(void)
{
    unsigned char data[8] = { 0 };
    const int result = canOpenRequestPDO(_PDO_Table_Received[0].handle, data);

    printf("request %d:", result);
    for (unsigned i = 0; i < sizeof data; i++)
        printf(" %02X", data[i]);
    printf("\n");
}

int main(void)
{
    const SLAVE_NET_INFO network = { .usBaudrate = 1000 };
    int result = canOpenCreateNetworkEx(NET, &network);
    char line[16];

    setvbuf(stdout, NULL, _IOLBF, 0);
    if (result == SCANOPEN_OK)
        result = create_node();
    printf("%s (%d)\n", result == SCANOPEN_OK ? "on the bus" : "error", result);
    while (result == SCANOPEN_OK && fgets(line, sizeof line, stdin))
        if (strcmp(line, "request\n") == 0)
            request();
    canOpenResetNode(node);
    canOpenDeleteNode(node);
    canOpenRemoveNetwork(NET);
    return result == SCANOPEN_OK ? 0 : 1;
}
