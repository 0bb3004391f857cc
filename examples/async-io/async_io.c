/*
 * A device of 64 output and 64 input lines, made with the tables of scanopen.h: outputs come by
 * RPDO 1 or SDO, inputs go out by TPDO 1. Runs until SIGINT or SIGTERM.
 *
 *   lines 1..32   each input is wired to the output of the same number, and sent when that is set
 *   lines 33..64  the inputs are a counter: the outputs set it, and each event timer of TPDO 1
 *                 counts it up
 */
#define _POSIX_C_SOURCE 200809L /* sigwait */

#include <scanopen.h>

#include <signal.h>
#include <stdio.h>

enum { NET = 0, NODE = 5, OUTPUTS = 0x6320, INPUTS = 0x6120, WIRED = 1, COUNTER = 2 };

static HNODE node;
static DictionaryData zero;

/* Outputs have come, or inputs are wanted (data is NULL). */
static int on_data(int net, int node_id, int index, int sub, void *data)
{
    uint32_t count;

    (void)net, (void)node_id;
    if (data) {
        canOpenWriteDictionary(node, INPUTS, (unsigned short)sub, data);
    } else if (index == INPUTS && sub == COUNTER) {
        canOpenReadDictionary(node, INPUTS, COUNTER, &count);
        count++;
        canOpenWriteDictionary(node, INPUTS, COUNTER, &count);
    }
    return SCANOPEN_OK; /* to an SDO client: the outputs are accepted */
}

BEGIN_DICTIONARY_TABLE(AsyncIo)
    DICTIONARY_ENTRY(OUTPUTS, 2, OBJ_ARRAY, MAP_UINT32, READ_ACCESS | WRITE_ACCESS | MAPPABLE,
                     &zero, on_data, NULL)
    DICTIONARY_ENTRY(INPUTS, 2, OBJ_ARRAY, MAP_UINT32, READ_ACCESS | MAPPABLE, &zero, on_data, NULL)
END_DICTIONARY_TABLE()

BEGIN_MAPPING_TABLE(Outputs)
    MAPPING_ENTRY(OUTPUTS, WIRED)
    MAPPING_ENTRY(OUTPUTS, COUNTER)
END_MAPPING_TABLE()

BEGIN_MAPPING_TABLE(Inputs)
    MAPPING_ENTRY(INPUTS, WIRED)
    MAPPING_ENTRY(INPUTS, COUNTER)
END_MAPPING_TABLE()

/* In ms: inhibit time, time-outs for sending and receiving, event timer. */
BEGIN_PDO_TABLE(AsyncIo)
    PDO_ENTRY(DEFAULT_PDO1, RECEIVE_PDO | ASYNCHRON_PDO | AUTO_NOTIFY | 255, 0, 0, 0, 0, Outputs)
    PDO_ENTRY(DEFAULT_PDO1, TRANSMIT_PDO | TIMER_DRIVEN_PDO | AUTO_NOTIFY | 255, 0, 0, 0, 100,
              Inputs)
END_PDO_TABLE()

static int create_node(void)
{
    const SLAVE_NODE_INFO info = { .ulOptions = PRODUCER_HEARTBEAT,
                                   .usProducerHbTime = 200,
                                   .ulDeviceType = 0x00030000,
                                   .ucMaxIdentityObject = 2,
                                   .ulVendorId = 0x1A0000EE,
                                   .ulProductCode = 0x6320,
                                   .usRxPDO = 1,
                                   .usTxPDO = 1 };
    int result = canOpenCreateNodeEx(NET, NODE, NULL, &info, &node);

    if (result == SCANOPEN_OK)
        result = DECLARE_DICTIONARY(node, AsyncIo);
    if (result == SCANOPEN_OK)
        result = DECLARE_PDO(node, AsyncIo);
    return result == SCANOPEN_OK ? canOpenActivateNode(node) : result;
}

int main(void)
{
    const SLAVE_NET_INFO network = { .usBaudrate = 500 };
    sigset_t end;
    int number, result;

    sigemptyset(&end);
    sigaddset(&end, SIGINT);
    sigaddset(&end, SIGTERM);
    sigprocmask(SIG_BLOCK, &end, NULL);
    result = canOpenCreateNetworkEx(NET, &network);
    if (result == SCANOPEN_OK)
        result = create_node();
    fprintf(stderr, "async-io: %s (%d)\n", result == SCANOPEN_OK ? "on the bus" : "error", result);
    if (result == SCANOPEN_OK)
        sigwait(&end, &number);
    canOpenResetNode(node);
    canOpenDeleteNode(node);
    canOpenRemoveNetwork(NET);
    return result == SCANOPEN_OK ? 0 : 1;
}
