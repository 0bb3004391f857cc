/*
 * A device of 8 digital inputs and 8 outputs after CiA 401; cia401-io.eds describes it. Hexadecimal
 * numbers on stdin set the inputs, stdout tells the outputs. Runs until the end of stdin.
 */
#include <scanopen.h>

#include <stdio.h>

enum { NET = 0, NODE = 2 };
enum { INPUTS = 0x6000, OUTPUTS = 0x6200, ERROR_MODE = 0x6206, ERROR_VALUE = 0x6207 };

static HNODE node;
static DictionaryData zeros, ones = { .uint8 = { .val = 0xFF, .defval = 0xFF } };

static int on_outputs(int net, int node_id, int index, int sub, void *data)
{
    (void)net, (void)node_id, (void)index, (void)sub;
    if (data)
        printf("outputs %02X\n", *(uint8_t *)data);
    return SCANOPEN_OK;
}

/* Outputs with a 1 in 6206h go to their value in 6207h, the others stay. */
static void drive_error_values(void)
{
    uint8_t outputs, mode, value;

    canOpenReadDictionary(node, OUTPUTS, 1, &outputs);
    canOpenReadDictionary(node, ERROR_MODE, 1, &mode);
    canOpenReadDictionary(node, ERROR_VALUE, 1, &value);
    outputs = (uint8_t)((outputs & ~mode) | (value & mode));
    canOpenWriteDictionary(node, OUTPUTS, 1, &outputs);
    on_outputs(NET, NODE, OUTPUTS, 1, &outputs);
}

/* To CiA 401 a stop, by a manager or because there is none any more, is an error. */
static int on_state(SLAVE_EVENT *event)
{
    if (event->ulArg1 == NodeStopped)
        drive_error_values();
    return SCANOPEN_OK;
}

#define RW (READ_ACCESS | WRITE_ACCESS)
BEGIN_DICTIONARY_TABLE(Io)
    DICTIONARY_ENTRY(INPUTS, 1, OBJ_ARRAY, MAP_UINT8, READ_ACCESS | MAPPABLE, &zeros, NULL, NULL)
    DICTIONARY_ENTRY(OUTPUTS, 1, OBJ_ARRAY, MAP_UINT8, RW | MAPPABLE, &zeros, on_outputs, NULL)
    DICTIONARY_ENTRY(ERROR_MODE, 1, OBJ_ARRAY, MAP_UINT8, RW, &ones, NULL, NULL)
    DICTIONARY_ENTRY(ERROR_VALUE, 1, OBJ_ARRAY, MAP_UINT8, RW, &zeros, NULL, NULL)
END_DICTIONARY_TABLE()

static int create_node(void)
{
    static const uint16_t outputs[] = { OUTPUTS, 1, 0, 0 }, inputs[] = { INPUTS, 1, 0, 0 };
    const unsigned long nobody[] = { END_OF_CHBT_LIST }; /* watched, until a manager writes 1016h */
    const SLAVE_NODE_INFO info = { .ulOptions = CONSUMER_HEARTBEAT | PRODUCER_HEARTBEAT |
                                                ERROR_BEHAVIOUR_OBJECT,
                                   .ulEventMask = EV_STATE_CHANGE,
                                   .ulDeviceType = 0x00030191,
                                   .ulVendorId = 0x1A0000EE,
                                   .ulProductCode = 0x6200,
                                   .ucMaxIdentityObject = 2,
                                   .ucMaxConsumerHB = 1,
                                   .pulListCHBT = nobody,
                                   .usRxPDO = 1,
                                   .usTxPDO = 1 };
    HPDO pdo;
    int result = canOpenCreateNodeEx(NET, NODE, on_state, &info, &node);

    if (result == SCANOPEN_OK)
        result = DECLARE_DICTIONARY(node, Io);
    if (result == SCANOPEN_OK)
        result = canOpenDefinePDO(node, NULL, DEFAULT_PDO1, RECEIVE_PDO | AUTO_NOTIFY | 255, 0, 0,
                                  0, 0, outputs, &pdo);
    if (result == SCANOPEN_OK)
        result = canOpenDefinePDO(node, NULL, DEFAULT_PDO1 | RTR_DISALLOW,
                                  TRANSMIT_PDO | AUTO_NOTIFY | 255, 0, 0, 0, 0, inputs, &pdo);
    return result == SCANOPEN_OK ? canOpenActivateNode(node) : result;
}

int main(void)
{
    const SLAVE_NET_INFO network = { .usBaudrate = 500 };
    int result = canOpenCreateNetworkEx(NET, &network);
    uint8_t inputs;

    setvbuf(stdout, NULL, _IOLBF, 0);
    if (result == SCANOPEN_OK)
        result = create_node();
    fprintf(stderr, "cia401-io: %s (%d)\n", result == SCANOPEN_OK ? "on the bus" : "error", result);
    while (result == SCANOPEN_OK && scanf("%hhx", &inputs) == 1)
        canOpenWriteDictionary(node, INPUTS, 1, &inputs);
    canOpenResetNode(node);
    canOpenDeleteNode(node);
    canOpenRemoveNetwork(NET);
    return result == SCANOPEN_OK ? 0 : 1;
}
