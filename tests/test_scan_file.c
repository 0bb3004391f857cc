/* Nodes from EDS files: canOpenCreateNodeFromFile, canOpenGetPDOHnd; the example's device. */
#include "mcanopen.h"
#include "support/scan_plant.h"
#include "support/suite.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>

#define DEVICE  TEST_DATA_DIR "/../../examples/cia401-io/cia401-io.eds"
#define NO_FILE TEST_DATA_DIR "/no-such-device.eds"
#define NO_EDS  TEST_DATA_DIR "/link/vcan.txt"
#define INPUTS  0x6000
#define OUTPUTS 0x6200
#define BOTH    (READ_ACCESS | WRITE_ACCESS)

static struct scan_plant *plant;
static char log_text[1000];

static void on_log(void *context, int level, const char *text)
{
    (void)context;
    (void)level;
    snprintf(log_text, sizeof log_text, "%s", text);
}

static void set_up(void)
{
    plant = scan_plant_new(0);
    log_text[0] = '\0';
    mcanOpenSetLog(on_log, NULL);
}

static void tear_down(void)
{
    mcanOpenSetLog(NULL, NULL);
    scan_plant_free(plant);
}

static HNODE make(const SLAVE_NODE_INFO *info)
{
    HNODE node = NULL;

    ck_assert_int_eq(canOpenCreateNodeFromFile(0, 5, scan_on_event, DEVICE, info, &node),
                     SCANOPEN_OK);
    scan_plant_keep(plant, node, 5);
    return node;
}

START_TEST(a_node_has_what_its_file_says)
{
    HNODE node = make(NULL);
    uint32_t value = 0;

    ck_assert_uint_eq(scan_get(node, 0x1000, 0), 0x00030191);
    scan_activate(plant, node);
    ck_assert_uint_eq(scan_sdo_read(plant, 5, 0x1018, 2, &value), 0);
    ck_assert_uint_eq(value, 0x6200);
    ck_assert_uint_eq(scan_sdo_read(plant, 5, 0x1800, 1, &value), 0);
    ck_assert_uint_eq(value & 0x7FF, 0x185);
    ck_assert_uint_eq(scan_sdo_read(plant, 5, 0x2000, 0, &value), 0x06020000);
}
END_TEST

/* Its PDOs live: inputs that the application writes are sent, received outputs are there. */
START_TEST(its_process_data)
{
    HNODE node = make(NULL);
    uint8_t inputs = 0x5A;

    scan_activate(plant, node);
    scan_operational(plant, node);
    scan_forget(plant);
    ck_assert_int_eq(canOpenWriteDictionary(node, INPUTS, 1, &inputs), SCANOPEN_OK);
    scan_expect(plant, "185#5A");
    scan_send(plant, "205#A5");
    scan_expect_nothing_more(plant, node);
    ck_assert_uint_eq(scan_get(node, OUTPUTS, 1), 0xA5);
}
END_TEST

static int on_output(int net, int id, int index, int sub, void *data)
{
    const uint8_t *value = data;

    scan_note("%d/%d %04X:%02X %02X", net, id, (unsigned)index, (unsigned)sub, *value);
    return SCANOPEN_OK;
}

START_TEST(its_entries_get_handlers)
{
    DictionaryData data = { .uint8 = { .val = 1, .defval = 1 } };
    HNODE node = make(NULL);

    ck_assert_int_eq(
        canOpenInitDictionary(node, OUTPUTS, 1, NULL, BOTH | MAPPABLE, &data, on_output),
        SCANOPEN_OK);
    scan_activate(plant, node);
    scan_operational(plant, node);
    scan_send(plant, "205#A5");
    scan_await_note("0/5 6200:01 A5");
}
END_TEST

START_TEST(handles_of_its_pdos)
{
    HNODE node = make(NULL);
    HPDO tx = NULL, rx = NULL;
    uint8_t data[8] = { 0x77 };

    ck_assert_int_eq(canOpenGetPDOHnd(node, 0x1800, &tx), SCANOPEN_OK);
    ck_assert_int_eq(canOpenGetPDOHnd(node, 0x1400, &rx), SCANOPEN_OK);
    scan_activate(plant, node);
    scan_operational(plant, node);
    scan_forget(plant);
    ck_assert_int_eq(canOpenWritePDO(tx, data), SCANOPEN_OK);
    scan_expect(plant, "185#77");
    ck_assert_int_eq(canOpenReadPDO(rx, data), SCANOPEN_RX_TIMEOUT); /* it does not wait */
    ck_assert_int_eq(canOpenReadPDO(tx, data), SCANOPEN_SERVICE_NOT_ALLOWED);
}
END_TEST

START_TEST(what_the_info_may_say)
{
    SLAVE_NODE_INFO info = { .ulOptions = PDO_ACCEPT_LONG };
    HNODE node = NULL;

    info.ulOptions = GUARDING; /* the file says that */
    ck_assert_int_eq(canOpenCreateNodeFromFile(0, 5, NULL, DEVICE, &info, &node),
                     SCANOPEN_WRONG_PARAMETER);
    info.ulOptions = PDO_ACCEPT_LONG;
    node = make(&info);
    scan_activate(plant, node);
    scan_operational(plant, node);
    scan_forget(plant);
    scan_send(plant, "205#A5FFFFFF");
    scan_expect_nothing_more(plant, node);
    ck_assert_uint_eq(scan_get(node, OUTPUTS, 1), 0xA5);
}
END_TEST

START_TEST(files_that_are_none)
{
    HNODE node = NULL;

    ck_assert_int_eq(canOpenCreateNodeFromFile(0, 5, NULL, NO_FILE, NULL, &node),
                     SCANOPEN_WRONG_PARAMETER);
    ck_assert_msg(strstr(log_text, "no-such-device.eds: error: ") != NULL, "%s", log_text);
    ck_assert_int_eq(canOpenCreateNodeFromFile(0, 5, NULL, NO_EDS, NULL, &node),
                     SCANOPEN_WRONG_PARAMETER);
    ck_assert_msg(strstr(log_text, "vcan.txt:") != NULL, "%s", log_text);
    ck_assert_int_eq(canOpenCreateNodeFromFile(0, 5, NULL, NULL, NULL, &node),
                     SCANOPEN_WRONG_PARAMETER);
    ck_assert_ptr_null(node);
    make(NULL); /* the node-ID is still free ... */
    ck_assert_int_eq(canOpenCreateNodeFromFile(0, 5, NULL, DEVICE, NULL, &node),
                     SCANOPEN_WRONG_PARAMETER); /* ... and now in use */
}
END_TEST

static void *remove_none(void *unused)
{
    (void)unused;
    ck_assert_int_eq(canOpenRemoveNetwork(200), SCANOPEN_WRONG_PARAMETER);
    return NULL;
}

static void on_log_elsewhere(void *context, int level, const char *text)
{
    pthread_t thread;

    ck_assert_int_eq(pthread_create(&thread, NULL, remove_none, NULL), 0);
    ck_assert_int_eq(pthread_join(thread, NULL), 0);
    on_log(context, level, text);
}

/* Under no lock: another thread may make and remove meanwhile. */
START_TEST(a_log_hook_that_waits_for_another_thread)
{
    HNODE node = NULL;

    mcanOpenSetLog(on_log_elsewhere, NULL);
    ck_assert_int_eq(canOpenCreateNodeFromFile(0, 5, NULL, NO_EDS, NULL, &node),
                     SCANOPEN_WRONG_PARAMETER);
    ck_assert_ptr_nonnull(strstr(log_text, "vcan.txt"));
}
END_TEST

START_TEST(wrong_arguments)
{
    HNODE node = make(NULL), other = NULL;
    HPDO pdo = (HPDO)log_text;

    ck_assert_int_eq(canOpenCreateNodeFromFile(1, 6, NULL, DEVICE, NULL, &other),
                     SCANOPEN_WRONG_PARAMETER); /* no such network */
    ck_assert_int_eq(canOpenCreateNodeFromFile(0, 0, NULL, DEVICE, NULL, &other),
                     SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenCreateNodeFromFile(0, 128, NULL, DEVICE, NULL, &other),
                     SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenCreateNodeFromFile(0, 6, NULL, DEVICE, NULL, NULL),
                     SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenGetPDOHnd(node, 0x1801, &pdo), SCANOPEN_WRONG_INDEX);
    ck_assert_ptr_null(pdo);
    ck_assert_int_eq(canOpenGetPDOHnd(node, 0x1600, &pdo), SCANOPEN_WRONG_INDEX);
    ck_assert_int_eq(canOpenGetPDOHnd(node, 0x13FF, &pdo), SCANOPEN_WRONG_INDEX);
    ck_assert_int_eq(canOpenGetPDOHnd(node, 0x1A00, &pdo), SCANOPEN_WRONG_INDEX);
    ck_assert_int_eq(canOpenGetPDOHnd(node, 0x1800, NULL), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenGetPDOHnd(NULL, 0x1800, &pdo), SCANOPEN_INVALID_HANDLE);
}
END_TEST

START_TEST(whatever_bit_rate_the_interface_has)
{
    const SLAVE_NET_INFO info = { .usBaudrate = BAUDRATE_AS_IT_IS };
    struct scan_plant *slow = scan_plant_bare(1);

    ck_assert_int_eq(canOpenCreateNetworkEx(1, &info), SCANOPEN_OK);
    ck_assert_int_eq(canOpenRemoveNetwork(1), SCANOPEN_OK);
    scan_plant_free(slow);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("file");

    tcase_set_timeout(tcase, SCAN_LIMIT);
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    tcase_add_test(tcase, a_node_has_what_its_file_says);
    tcase_add_test(tcase, its_process_data);
    tcase_add_test(tcase, its_entries_get_handlers);
    tcase_add_test(tcase, handles_of_its_pdos);
    tcase_add_test(tcase, what_the_info_may_say);
    tcase_add_test(tcase, files_that_are_none);
    tcase_add_test(tcase, a_log_hook_that_waits_for_another_thread);
    tcase_add_test(tcase, wrong_arguments);
    tcase_add_test(tcase, whatever_bit_rate_the_interface_has);
    return suite_run("scan_file", tcase);
}
