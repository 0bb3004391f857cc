/*
 * A level sensor, the device of docs/make-a-device.md: TPDO 1 has the level, an emergency says that
 * it is above the limit 2000h; 2001h is a file. Levels (0..1000) come from stdin, until its end.
 */
#include <scanopen.h>

#include <stdio.h>

enum { NET = 0, NODE = 5, LIMIT = 0x2000, CURVE = 0x2001, LEVEL = 0x6401 };

static HNODE node;
static DictionaryData level, curve, limit = { .int16 = { 900, 900, 1, 1000 } };

#define RW (READ_ACCESS | WRITE_ACCESS)
BEGIN_DICTIONARY_TABLE(Sensor)
    DICTIONARY_ENTRY(LEVEL, 0, OBJ_VAR, MAP_INT16, READ_ACCESS | MAPPABLE, &level, NULL, NULL)
    DICTIONARY_ENTRY(LIMIT, 0, OBJ_VAR, MAP_INT16, RW, &limit, NULL, NULL)
    DICTIONARY_ENTRY(CURVE, 0, OBJ_VAR, MAP_DOMAIN, RW, &curve, NULL, NULL)
END_DICTIONARY_TABLE()

BEGIN_MAPPING_TABLE(Level)
    MAPPING_ENTRY(LEVEL, 0)
END_MAPPING_TABLE()

BEGIN_PDO_TABLE(Sensor) /* in ms: inhibit time, time-outs, event timer */
    PDO_ENTRY(DEFAULT_PDO1 | RTR_DISALLOW, TRANSMIT_PDO | AUTO_NOTIFY | 255, 10, 0, 0, 1000, Level)
END_PDO_TABLE()

static int on_event(SLAVE_EVENT *event)
{
    printf("event %lX: %lu\n", event->ulEvent, event->ulArg1);
    return SCANOPEN_OK;
}

static int create_node(const char *folder)
{
    const SLAVE_NODE_INFO info = { .ulOptions = ERROR_REGISTER | MANUFACTURER_INFO |
                                                CONSUMER_HEARTBEAT | PRODUCER_HEARTBEAT |
                                                PARAMETER_STORE | PARAMETER_RESET | BLOCK_TRANSFER,
                                   .ulEventMask = EV_STATE_CHANGE | EV_CONSUMER_HEARTBEAT,
                                   .pszDeviceName = "Level sensor",
                                   .pszHwVersion = "A",
                                   .pszSwVersion = "1.0",
                                   .ucMaxConsumerHB = 1,
                                   .ucMaxErrors = 8,
                                   .usProducerHbTime = 500,
                                   .ucMaxIdentityObject = 3,
                                   .ulVendorId = 0x1A0000EE,
                                   .ulProductCode = 0x6401,
                                   .ulRevisionNumber = 0x00010000,
                                   .usTxPDO = 1 };
    char path[256];
    int result = canOpenCreateNodeEx(NET, NODE, on_event, &info, &node);

    if (result == SCANOPEN_OK)
        result = DECLARE_DICTIONARY(node, Sensor);
    if (result == SCANOPEN_OK)
        result = DECLARE_PDO(node, Sensor);
    snprintf(path, sizeof path, "%s/level-sensor.curve", folder);
    if (result == SCANOPEN_OK)
        result = canOpenSetDomainFile(node, CURVE, 0, path, 65536);
    snprintf(path, sizeof path, "%s/level-sensor.ccf", folder);
    if (result == SCANOPEN_OK)
        result = canOpenSetStoreFile(node, path);
    return result == SCANOPEN_OK ? canOpenActivateNode(node) : result;
}

/* Tells the network when the level passes the limit, and when it is back. */
static void watch(int16_t now, int *above)
{
    int16_t most;

    canOpenReadDictionary(node, LIMIT, 0, &most);
    if (now > most && !*above)
        canOpenSetError(node, EMCY_EXTERNAL_ERROR, 1, ERROR_DEVICE_SPECIFIC, NULL);
    else if (now <= most && *above)
        canOpenResetError(node, ERROR_DEVICE_SPECIFIC, NULL);
    *above = now > most;
}

int main(int argc, char **argv)
{
    const SLAVE_NET_INFO network = { .usBaudrate = 500 };
    int result = canOpenCreateNetworkEx(NET, &network), above = 0;
    int16_t now;

    setvbuf(stdout, NULL, _IOLBF, 0);
    if (result == SCANOPEN_OK)
        result = create_node(argc > 1 ? argv[1] : ".");
    fprintf(stderr, "level-sensor: %s (%d)\n", result ? "error" : "on the bus", result);
    while (result == SCANOPEN_OK && scanf("%hd", &now) == 1) {
        canOpenWriteDictionary(node, LEVEL, 0, &now);
        watch(now, &above);
    }
    canOpenResetNode(node);
    canOpenDeleteNode(node);
    canOpenRemoveNetwork(NET);
    return result == SCANOPEN_OK ? 0 : 1;
}
