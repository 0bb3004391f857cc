/*
 * Node 5 for test_peer_sdo*.py and test_peer_errors.py. Prints each event of the node as
 * "event KIND ARGUMENT ARGUMENT". Runs until the end of stdin; there "error CODE INFORMATION
 * REGISTER" and "reset REGISTER" do what objects 2300h and 2301h do, in any NMT state.
 *
 *   2000h       domain; 2001h visible string, 2002h octet string: of up to 100,000 bytes each
 *   2003h       domain, whose handler says yes or no: see on_checked()
 *   2010h       numbers of all types; 2011h, 2012h a time of day, a time difference
 *   2300h       raises an error: code, information << 16, register << 32, bytes for the field << 40
 *   2301h       takes one back: register, bytes for the field << 8
 */
#include <scanopen.h>

#include <stdio.h>
#include <string.h>

enum { NET = 0, NODE = 5, LARGE = 100000, CHECKED = 0x2003, NOT_NOW = 0x08000022, FIELD = 5 };

static HNODE node;
static DictionaryData zero;
static unsigned char domain[LARGE], octets[LARGE], checked[LARGE];
static char text[LARGE];

static DictionaryData large = { .domain = { domain, LARGE, 0 } };
static DictionaryData large_text = { .visstring = { text, LARGE, 0 } };
static DictionaryData large_octets = { .octstring = { octets, LARGE, 0 } };
static DictionaryData large_checked = { .domain = { checked, LARGE, 0 } };

/* What begins with FFh is refused. */
static int on_checked(int net, int node_id, int index, int sub, void *data)
{
    const RecDomain *value = data;

    (void)net, (void)node_id, (void)index, (void)sub;
    return value->ulLength > 0 && *(const unsigned char *)value->pData == 0xFF ? NOT_NOW
                                                                               : SCANOPEN_OK;
}

static void take_bytes(unsigned char *field, uint64_t bytes)
{
    for (unsigned i = 0; i < FIELD; i++)
        field[i] = (unsigned char)(bytes >> 8 * i);
}

static int on_error(int net, int node_id, int index, int sub, void *data)
{
    unsigned char field[FIELD];
    uint64_t what;

    (void)net, (void)node_id, (void)index, (void)sub;
    memcpy(&what, data, sizeof what);
    take_bytes(field, what >> 40);
    return canOpenSetError(node, what & 0xFFFF, what >> 16 & 0xFFFF, what >> 32 & 0xFF, field);
}

static int on_error_gone(int net, int node_id, int index, int sub, void *data)
{
    unsigned char field[FIELD];
    uint32_t what;

    (void)net, (void)node_id, (void)index, (void)sub;
    memcpy(&what, data, sizeof what);
    take_bytes(field, what >> 8);
    return canOpenResetError(node, what & 0xFF, field);
}

static int on_event(SLAVE_EVENT *event)
{
    const SLAVE_EMCY *emcy = event->arg.pArg2;

    if (event->ulEvent == EV_EMCY) {
        printf("event %02lX %lu", event->ulEvent, event->ulArg1);
        for (unsigned i = 0; i < sizeof emcy->ucData; i++)
            printf(" %02X", emcy->ucData[i]);
        printf("\n");
    } else {
        printf("event %02lX %lX %lX\n", event->ulEvent, event->ulArg1, event->arg.ulArg2);
    }
    return SCANOPEN_OK;
}

static const char numbers[] = { TYP_BOOL,   TYP_INT8,  TYP_INT16,  TYP_INT32,
                                TYP_INT64,  TYP_UINT8, TYP_UINT16, TYP_UINT32,
                                TYP_UINT64, TYP_FLOAT, TYP_DOUBLE, 0 };

#define RW (READ_ACCESS | WRITE_ACCESS)
BEGIN_DICTIONARY_TABLE(Objects)
    DICTIONARY_ENTRY(0x2000, 0, OBJ_VAR, MAP_DOMAIN, RW, &large, NULL, NULL)
    DICTIONARY_ENTRY(0x2001, 0, OBJ_VAR, MAP_VIS_STRING, RW, &large_text, NULL, NULL)
    DICTIONARY_ENTRY(0x2002, 0, OBJ_VAR, MAP_OCT_STRING, RW, &large_octets, NULL, NULL)
    DICTIONARY_ENTRY(CHECKED, 0, OBJ_VAR, MAP_DOMAIN, RW, &large_checked, on_checked, NULL)
    DICTIONARY_ENTRY(0x2010, 11, OBJ_RECORD, numbers, RW, &zero, NULL, NULL)
    DICTIONARY_ENTRY(0x2011, 0, OBJ_VAR, MAP_TIME_OF_DAY, RW, &zero, NULL, NULL)
    DICTIONARY_ENTRY(0x2012, 0, OBJ_VAR, MAP_TIME_DIFFERENCE, RW, &zero, NULL, NULL)
    DICTIONARY_ENTRY(0x2300, 0, OBJ_VAR, MAP_UINT64, WRITE_ACCESS, &zero, on_error, NULL)
    DICTIONARY_ENTRY(0x2301, 0, OBJ_VAR, MAP_UINT32, WRITE_ACCESS, &zero, on_error_gone, NULL)
END_DICTIONARY_TABLE()

static int create_node(void)
{
    const SLAVE_NODE_INFO info = { .ulOptions = BLOCK_TRANSFER | ERROR_REGISTER | ADDITIONAL_SDOS |
                                                MANUFACTURER_INFO | CONSUMER_HEARTBEAT |
                                                PRODUCER_HEARTBEAT | EMCY_CONSUMER |
                                                ERROR_BEHAVIOUR_OBJECT,
                                   .ulEventMask = EV_ALL & ~EV_WRITE_DICTIONARY,
                                   .ucServerSDO = 2,
                                   .ucMaxErrors = 4,
                                   .ucMaxIdentityObject = 4,
                                   .ulVendorId = 0x29A,
                                   .pszDeviceName = "device for peers of other make",
                                   .pszHwVersion = "1",
                                   .pszSwVersion = "1.0",
                                   .ucMaxConsumerHB = 3 };
    int result = canOpenCreateNodeEx(NET, NODE, on_event, &info, &node);

    if (result == SCANOPEN_OK)
        result = DECLARE_DICTIONARY(node, Objects);
    return result == SCANOPEN_OK ? canOpenActivateNode(node) : result;
}

static void obey(const char *line)
{
    unsigned code, information, mask;

    if (sscanf(line, "error %x %x %x", &code, &information, &mask) == 3)
        printf("error %d\n",
               canOpenSetError(node, (unsigned short)code, (unsigned short)information,
                               (unsigned short)mask, NULL));
    else if (sscanf(line, "reset %x", &mask) == 1)
        printf("reset %d\n", canOpenResetError(node, (unsigned short)mask, NULL));
}

int main(void)
{
    const SLAVE_NET_INFO network = { .usBaudrate = 1000 };
    int result = canOpenCreateNetworkEx(NET, &network);
    char line[64];

    setvbuf(stdout, NULL, _IOLBF, 0);
    if (result == SCANOPEN_OK)
        result = create_node();
    printf("%s (%d)\n", result == SCANOPEN_OK ? "on the bus" : "error", result);
    while (result == SCANOPEN_OK && fgets(line, sizeof line, stdin))
        obey(line);
    canOpenResetNode(node);
    canOpenDeleteNode(node);
    canOpenRemoveNetwork(NET);
    return result == SCANOPEN_OK ? 0 : 1;
}
