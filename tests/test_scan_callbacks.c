/*
 * Which functions may be called from a callback: those that wait or delete are refused at once in
 * each kind of handler (docs/threading.md), and a handler that tries harms nothing.
 */
#include "support/scan_plant.h"
#include "support/suite.h"

#include <stdatomic.h>
#include <stdio.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static struct scan_plant *plant;
static HNODE node;
static HPDO tx, tx_done, rx;
static int (*_Atomic chosen)(void);

/* --- refused --- */

static int create_network(void)
{
    return canOpenCreateNetwork(1, NULL, SCAN_BITRATE);
}

static int create_network_ex(void)
{
    const SLAVE_NET_INFO info = { .usBaudrate = SCAN_BITRATE };

    return canOpenCreateNetworkEx(1, &info);
}

static int remove_network(void)
{
    return canOpenRemoveNetwork(0);
}

static int create_node(void)
{
    HNODE other;

    return canOpenCreateNode(0, "old", 6, 0x191, 0, 0, NULL, NULL, NULL, 0, 0, 0, 0, NULL, &other);
}

static int create_node_ex(void)
{
    const SLAVE_NODE_INFO info = scan_info();
    HNODE other;

    return canOpenCreateNodeEx(0, 6, NULL, &info, &other);
}

static int delete_node(void)
{
    return canOpenDeleteNode(node);
}

static int activate_node(void)
{
    return canOpenActivateNode(node);
}

static int reset_node(void)
{
    return canOpenResetNode(node);
}

static int wait_for_state(void)
{
    return canOpenWaitForNodeState(node, WFNS_OPERATIONAL);
}

static int read_pdo(void)
{
    return canOpenReadPDO(rx, NULL);
}

static int request_pdo(void)
{
    return canOpenRequestPDO(rx, NULL);
}

static int write_pdo_and_wait(void)
{
    return canOpenWritePDO(tx_done, NULL);
}

static int set_store_file(void)
{
    return canOpenSetStoreFile(node, "/tmp/mcanopen-no-such-file");
}

static int (*const refused[])(void) = {
    create_network, create_network_ex,  remove_network, create_node, create_node_ex,
    delete_node,    activate_node,      reset_node,     read_pdo,    request_pdo,
    wait_for_state, write_pdo_and_wait, set_store_file,
};

/* --- allowed --- */

static int get_info(void)
{
    int state, error;

    return canOpenGetNodeInfo(node, &state, &error);
}

static int get_parameter(void)
{
    uint64_t now;

    return canOpenGetParameter(node, PARA_GET_TIMESTAMP, &now);
}

static int set_parameter(void)
{
    return canOpenSetParameter(node, PARAM_ENABLE_AUTO_TRANSMISSION, NULL);
}

static int get_versions(void)
{
    CANOPEN_VERSIONS versions;

    canOpenGetVersions(&versions);
    return SCANOPEN_OK;
}

static int use_dictionary(void)
{
    uint8_t value;
    int result = canOpenReadDictionary(node, 0x2001, 0, &value);

    return result == SCANOPEN_OK ? canOpenWriteDictionary(node, 0x2001, 0, &value) : result;
}

static int use_entry(void)
{
    HDICT entry;
    uint8_t value;
    int result = canOpenGetDictionaryHnd(node, 0x2001, 0, &entry);

    if (result == SCANOPEN_OK)
        result = canOpenReadDictionaryHnd(entry, &value);
    return result == SCANOPEN_OK ? canOpenWriteDictionaryHnd(entry, &value) : result;
}

static int write_pdo(void)
{
    return canOpenWritePDO(tx, NULL);
}

static int set_error(void)
{
    return canOpenSetError(node, EMCY_CURRENT, 0, ERROR_CURRENT, NULL);
}

/* Of an error that it has set before. */
static int reset_error(void)
{
    const int result = set_error();

    return result == SCANOPEN_OK ? canOpenResetError(node, ERROR_CURRENT, NULL) : result;
}

static int send_time(void)
{
    return canOpenSendTime(node, NULL);
}

static int (*const allowed[])(void) = {
    get_info,  get_parameter, set_parameter, get_versions, use_dictionary,
    use_entry, write_pdo,     set_error,     reset_error,  send_time,
};

/* --- the callbacks --- */

static int on_event(SLAVE_EVENT *event)
{
    if (event->ulEvent == EV_STATE_CHANGE && event->ulArg1 == NodeOperational)
        scan_note("event %d", atomic_load(&chosen)());
    if (event->ulEvent == EV_CONFIGURATION)
        scan_note("save %d", atomic_load(&chosen)());
    return SCANOPEN_OK;
}

static int on_data(int net, int id, int index, int sub, void *data)
{
    scan_note("%d/%d %04X:%02X %s %d", net, id, (unsigned)index, (unsigned)sub,
              data ? "set" : "wanted", atomic_load(&chosen)());
    return SCANOPEN_OK;
}

static int on_data_ts(int net, int id, int index, int sub, void *data, uint64_t time)
{
    return time != 0 ? on_data(net, id, index, sub, data) : SCANOPEN_WRONG_PARAMETER;
}

static void add_objects(void)
{
    DictionaryData data = { .uint8 = { .val = 1, .defval = 1 } };

    scan_number(node, 0x2000, TYP_UINT8, WRITE_ACCESS | MAPPABLE, 1, on_data);
    scan_number(node, 0x2001, TYP_UINT8, READ_ACCESS | MAPPABLE, 1, on_data);
    scan_number(node, 0x2003, TYP_UINT8, READ_ACCESS | MAPPABLE | MULTI_MAP, 1, NULL);
    ck_assert_int_eq(canOpenExtendDictionary(node, 0x2002, 0, OBJ_VAR, MAP_UINT8), SCANOPEN_OK);
    ck_assert_int_eq(
        canOpenInitDictionaryTs(node, 0x2002, 0, NULL, WRITE_ACCESS, &data, on_data_ts),
        SCANOPEN_OK);
}

static HPDO define(uint32_t cob_id, unsigned mode, const uint16_t *mapping)
{
    HPDO pdo = NULL;

    ck_assert_int_eq(
        canOpenDefinePDO(node, NULL, cob_id, (uint16_t)mode, 0, 0, 1000, 0, mapping, &pdo),
        SCANOPEN_OK);
    return pdo;
}

static void set_up(void)
{
    const uint16_t output[] = { 0x2000, 0, 0, 0 }, input[] = { 0x2001, 0, 0, 0 };
    const uint16_t other[] = { 0x2003, 0, 0, 0 };
    SLAVE_NODE_INFO info = scan_info();

    info.ulOptions |= PARAMETER_STORE | TIME_STAMP;
    info.ulTimestampCobId = TIME_PRODUCE | DEFAULT_TIME_COBID;
    plant = scan_plant_new(0);
    ck_assert_int_eq(canOpenCreateNodeEx(0, 5, on_event, &info, &node), SCANOPEN_OK);
    add_objects();
    rx = define(DEFAULT_PDO1, RECEIVE_PDO | AUTO_NOTIFY_PDO | 255, output);
    tx = define(DEFAULT_PDO1, TRANSMIT_PDO | 255, other);
    tx_done = define(DEFAULT_PDO2, TRANSMIT_PDO | TX_DONE_PDO | 255, other);
    define(DEFAULT_PDO3, TRANSMIT_PDO | 1, input);
    ck_assert_int_eq(canOpenActivateNode(node), SCANOPEN_OK);
}

static void tear_down(void)
{
    canOpenResetNode(node);
    canOpenDeleteNode(node);
    scan_plant_free(plant);
}

/* Every kind of callback makes the call once. */
static void expect_from_callbacks(int (*call)(void), int result)
{
    const char *const forms[] = {
        "event %d",           "0/5 2000:00 set %d", "0/5 2001:00 wanted %d",
        "0/5 2000:00 set %d", "0/5 2002:00 set %d", "save %d"
    };
    char notes[COUNT(forms)][40];

    for (unsigned i = 0; i < COUNT(forms); i++)
        snprintf(notes[i], sizeof notes[i], forms[i], result);
    atomic_store(&chosen, call);
    scan_send(plant, "000#0105");
    scan_expect_note(notes[0]);
    ck_assert_int_eq(scan_state(node), NodeOperational);
    scan_send(plant, "205#07");
    scan_expect_note(notes[1]);
    scan_send(plant, "080#");
    scan_expect_note(notes[2]);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x2000, 0, 1, 8), 0);
    scan_expect_note(notes[3]);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x2002, 0, 1, 9), 0);
    scan_expect_note(notes[4]);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1010, 1, 4, 0x65766173), 0);
    scan_expect_note(notes[5]);
    ck_assert_int_eq(scan_state(node), NodeOperational);
}

START_TEST(not_from_callbacks)
{
    expect_from_callbacks(refused[_i], SCANOPEN_SERVICE_NOT_ALLOWED);
}
END_TEST

START_TEST(from_callbacks)
{
    expect_from_callbacks(allowed[_i], SCANOPEN_OK);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("callbacks");

    tcase_set_timeout(tcase, SCAN_LIMIT);
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    tcase_add_loop_test(tcase, not_from_callbacks, 0, COUNT(refused));
    tcase_add_loop_test(tcase, from_callbacks, 0, COUNT(allowed));
    return suite_run("scan_callbacks", tcase);
}
