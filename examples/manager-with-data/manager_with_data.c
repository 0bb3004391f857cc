/*
 * A manager and the process data of its network in one program: node 1 of network.xml, a device in
 * this process, handles the PDOs. The inputs of node 2 become lines 1..8 of node 5, and those lines
 * the outputs of node 2. Runs until SIGINT or SIGTERM.
 */
#define _POSIX_C_SOURCE 200809L /* sigwait */

#include <mcanopen.h>
#include <scanopen.h>

#include <signal.h>
#include <stdio.h>

enum { NET = 0, NODE = 1, BUTTONS = 0x2000, LAMPS = 0x2001, LINES_IN = 0x2002, LINES_OUT = 0x2003 };
enum { IN = READ_ACCESS | WRITE_ACCESS | MAPPABLE, OUT = READ_ACCESS | MAPPABLE };
static HNODE node;
static DictionaryData zero;

static int on_data(int net, int node_id, int index, int sub, void *data)
{
    (void)net, (void)node_id, (void)sub;
    if (data && index == BUTTONS) {
        const uint64_t lines = *(uint8_t *)data;

        canOpenWriteDictionary(node, LINES_OUT, 0, &lines);
    } else if (data) {
        const uint32_t *lines = data;
        uint8_t lamps = *lines & 0xFF, before = lamps;

        canOpenReadDictionary(node, LAMPS, 0, &before);
        if (lamps != before) /* the lines come all the time: only news are sent on */
            canOpenWriteDictionary(node, LAMPS, 0, &lamps);
    }
    return SCANOPEN_OK;
}

BEGIN_DICTIONARY_TABLE(Image)
    DICTIONARY_ENTRY(BUTTONS, 0, OBJ_VAR, MAP_UINT8, IN, &zero, on_data, NULL)
    DICTIONARY_ENTRY(LAMPS, 0, OBJ_VAR, MAP_UINT8, OUT, &zero, NULL, NULL)
    DICTIONARY_ENTRY(LINES_IN, 0, OBJ_VAR, MAP_UINT32, IN, &zero, on_data, NULL)
    DICTIONARY_ENTRY(LINES_OUT, 0, OBJ_VAR, MAP_UINT64, OUT, &zero, NULL, NULL)
END_DICTIONARY_TABLE()

static const struct {
    uint32_t can_id;
    uint16_t kind, mapping[6];
} pdos[] = { { 0x182, RECEIVE_PDO, { BUTTONS, 0 } },
             { 0x202, TRANSMIT_PDO, { LAMPS, 0 } },
             { 0x185, RECEIVE_PDO, { LINES_IN, 0, TYP_UINT32, 0 } }, /* 4 bytes for nobody */
             { 0x205, TRANSMIT_PDO, { LINES_OUT, 0 } } };

static int create_node(void)
{
    const SLAVE_NODE_INFO info = { .ucMaxIdentityObject = 1, .usRxPDO = 2, .usTxPDO = 2 };
    HPDO pdo;
    int result = canOpenCreateNodeEx(NET, NODE, NULL, &info, &node);

    if (result == SCANOPEN_OK)
        result = DECLARE_DICTIONARY(node, Image);
    for (int i = 0; result == SCANOPEN_OK && i < 4; i++)
        result = canOpenDefinePDO(node, NULL, pdos[i].can_id, pdos[i].kind | AUTO_NOTIFY | 255, 0,
                                  0, 0, 0, pdos[i].mapping, &pdo);
    return result == SCANOPEN_OK ? canOpenActivateNode(node) : result;
}

static void tell(void *context, int level, const char *text)
{
    (void)context;
    fprintf(stderr, "%s%s\n", level == MCANOPEN_LOG_ERROR ? "error: " : "", text);
}

int main(int argc, char **argv)
{
    const SLAVE_NET_INFO network = { .usBaudrate = 500 };
    sigset_t end;
    int number, result;

    sigemptyset(&end);
    sigaddset(&end, SIGINT);
    sigaddset(&end, SIGTERM);
    sigprocmask(SIG_BLOCK, &end, NULL);
    mcanOpenInitialize();
    mcanOpenSetLog(tell, NULL);
    result = mcanOpenConfig(argc > 1 ? argv[1] : "network.xml");
    if (result == MCANOPEN_OK)
        result = canOpenCreateNetworkEx(NET, &network);
    if (result == SCANOPEN_OK)
        result = create_node();
    if (result == SCANOPEN_OK) {
        mcanOpenStart();
        sigwait(&end, &number);
    }
    canOpenResetNode(node);
    canOpenDeleteNode(node);
    canOpenRemoveNetwork(NET);
    mcanOpenCleanup();
    fprintf(stderr, "manager-with-data: ends with %d\n", result);
    return result == SCANOPEN_OK ? 0 : 1;
}
