/*
 * The three public headers together, as C and as C++: the tables at file and at function scope, and
 * every name that the manual spells in two ways. It is compiled, not run.
 */
#include "mcanopen.h"
#include "paraInfo.h"
#include "scanopen.h"

#ifdef __cplusplus
extern "C" {
#endif

int on_data(int NetNo, int NodeNo, int index, int subindex, void *data);
int on_data_ts(int NetNo, int NodeNo, int index, int subindex, void *data, UINT64 time);
int on_event(SLAVE_EVENT *pEvent);
int on_old_event(int, int, int, int);
int tables_at_function_scope(HNODE node);
int tables_at_file_scope(HNODE node);
int both_spellings(void);
int text_of(const EVENT_T *event);

#ifdef __cplusplus
}
#endif

static DictionaryData initial;

static const char record[] = { TYP_INT32, TYP_INT16, 0 };

BEGIN_DICTIONARY_TABLE(Objects)
    DICTIONARY_ENTRY(0x6320, 2, OBJ_ARRAY, MAP_UINT32, MAPPABLE | READ_ACCESS | WRITE_ACCESS,
                     &initial, on_data, NULL)
    DICTIONARY_ENTRY(0x2000, 0, OBJ_VAR, MAP_VIS_STRING, READ_ACCESS, &initial, NULL, NULL)
    DICTIONARY_ENTRY(0x2001, 2, OBJ_RECORD, record, MULTI_MAP | READ_ACCESS, &initial, on_data,
                     NULL)
END_DICTIONARY_TABLE()

BEGIN_DICTIONARY_TABLE_TS(TimedObjects)
    DICTIONARY_ENTRY(0x6120, 2, OBJ_ARRAY, MAP_UINT32, MAPPABLE | READ_ACCESS, &initial, on_data_ts,
                     NULL)
END_DICTIONARY_TABLE_TS()

BEGIN_DICTIONARY_TABLE(Empty)
END_DICTIONARY_TABLE()

BEGIN_DICTIONARY_TABLE(Unused)
END_DICTIONARY_TABLE()

BEGIN_MAPPING_TABLE(Outputs)
    MAPPING_ENTRY(0x6320, 1)
    MAPPING_ENTRY(0x6320, 2)
END_MAPPING_TABLE()

/* Of the same name as a dictionary table. */
BEGIN_PDO_TABLE(Objects)
    PDO_ENTRY(DEFAULT_PDO1, RECEIVE_PDO | ASYNCHRON_PDO | AUTO_NOTIFY_PDO | 255, 0, 5000, 5000, 0,
              Outputs)
    PDO_ENTRY(DEFAULT_PDO_1 | PDO_VALID | RTR_DISALLOW,
              TIMER_DRIVEN_PDO | TRANSMIT_PDO | AUTO_NOTIFY | 255, 0, 5000, 5000, 100, Outputs)
    PDO_ENTRY_UNMAPPED(0x1F0 | PDO_INVALID | RTR_ALLOW, TRANSMIT_PDO | SYNCHRON_PDO | TX_DONE_PDO,
                       10, 0, 0, 0)
END_PDO_TABLE()

int tables_at_file_scope(HNODE node)
{
    int result = DECLARE_DICTIONARY(node, Objects);

    if (result == SCANOPEN_OK)
        result = DECLARE_DICTIONARY(node, TimedObjects);
    if (result == SCANOPEN_OK)
        result = DECLARE_DICTIONARY(node, Empty);
    if (result != SCANOPEN_OK || DECLARE_PDO(node, Objects) != SCANOPEN_OK)
        return result;
    return canOpenWritePDO(_PDO_Table_Objects[1].handle, NULL);
}

int tables_at_function_scope(HNODE node)
{
    BEGIN_DICTIONARY_TABLE(Local)
        DICTIONARY_ENTRY(0x2002, 1, OBJ_ARRAY, MAP_BOOL, READ_ACCESS, NULL, on_data, "text")
    END_DICTIONARY_TABLE()
    BEGIN_MAPPING_TABLE(Local)
        MAPPING_ENTRY(0x0005, 0)
    END_MAPPING_TABLE()
    BEGIN_PDO_TABLE(Local)
        PDO_ENTRY(DEFAULT_PDO4, RECEIVE_PDO | 1, 0, 0, 0, 0, Local)
    END_PDO_TABLE()

    return DECLARE_DICTIONARY(node, Local) + DECLARE_PDO(node, Local);
}

int both_spellings(void)
{
    static const unsigned long heartbeats[] = { CHBT_ENTRY(127, 3000), END_OF_CHBT_LIST };
    static SLAVE_NODE_INFO info;
    static SLAVE_NET_INFO network;
    static CANOPEN_VERSIONS versions;
    HNODE node = NULL;
    HNDO *a = &node;
    HND0 *b = &node;

    network.ulOptions = THREAD_PRIO_OVERWRITE | THREAD_PRIOS_OVERWRITE;
    info.ulOptions = PRODUCER_HERTBEAT | PRODUCER_HEARTBEAT | PDO_ACCEPT_LONG | AUTO_START |
                     TIME_STAMP;
    info.ulEventMask = EV_GUARDING | EV_ALL;
    info.usPdoRxQueusize = info.usPdoRxQueueSize;
    info.ucLifeTime = info.ucLifetime;
    info.usProducerHBTime = info.usProducerHbTime;
    info.pszDevicename = info.pszDeviceName;
    info.pulListCHBT = heartbeats;
    info.ulSyncCobID = DEFAULT_SYNC_COBID | SYNC_PRODUCE;
    canOpenGetVersions(&versions);
    return canOpenCreateNetworkEx(0, &network) + canOpenCreateNetwork(0, "net", 500) +
           canOpenCreateNodeEx(0, 1, on_event, &info, a) +
           canOpenCreateNode(0, "node", 1, 0, GUARDING, 0, NULL, NULL, NULL, 100, 3, 0, 0,
                             on_old_event, b) +
           canOpenInitDictionaryTs(node, 0x2000, 0, NULL, 0, &initial, on_data_ts) +
           canOpenInitDictionaryTS(node, 0x2000, 0, NULL, 0, &initial, on_data_ts) +
           canOpenExtendDictionary(node, 0x2000, 0, OBJ_VAR, MAP_UINT8) +
           (PARA_GET_TIMESTAMP == PARAM_GET_TIMESTAMP) +
           (PARA_GET_TIMESTAMP_FREQUENCY == PARAM_GET_TIMESTAMP_FREQUENCY) +
           (NodeInit == NodeOffline) + CANOPEN_NET(0x0105) + CANOPEN_NODE(0x0105);
}

int text_of(const EVENT_T *event)
{
    char text[MCANOPEN_EVENT_TEXT_SIZE];

    if ((MCANOPEN_CAST(unsigned long, event->event) & PARA) == PARA_I)
        return iParaInfo[event->event & 0xFF][0];
    return mcanOpenEventText(event, text, MCANOPEN_EVENT_TEXT_SIZE);
}
