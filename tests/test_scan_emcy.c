/*
 * Errors and emergencies at the API: those of the application, those that the library finds itself,
 * and those of other nodes (EV_EMCY).
 */
#include "support/scan_plant.h"
#include "support/suite.h"

#include "base/frame.h"
#include "mcanopen.h"
#include "port/clock.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static struct scan_plant *plant;
static HNODE node;

static void on_log(void *context, int level, const char *text)
{
    const char *behind = strstr(text, "warning: ");

    (void)context;
    (void)level;
    scan_note("log %s", behind ? behind + 9 : text);
}

static void set_up(void)
{
    SLAVE_NODE_INFO info = scan_info();

    plant = scan_plant_new(0);
    info.ulOptions |= ERROR_REGISTER | EMCY_CONSUMER;
    info.ulEventMask = EV_EMCY;
    info.ucMaxErrors = 5;
    node = scan_node(plant, 5, &info);
    mcanOpenSetLog(on_log, NULL);
}

static void tear_down(void)
{
    scan_plant_free(plant);
    mcanOpenSetLog(NULL, NULL);
}

static int last_error(void)
{
    int state = -1, error = -1;

    ck_assert_int_eq(canOpenGetNodeInfo(node, &state, &error), SCANOPEN_OK);
    return error;
}

static int set_error(unsigned short code)
{
    return canOpenSetError(node, code, 0, 0, NULL);
}

/* --- errors of the application --- */

static const unsigned char field[5] = { 0x01, 0x02, 0x03, 0x04, 0x05 };

START_TEST(an_error_and_its_end)
{
    scan_activate(plant, node);
    ck_assert_int_eq(last_error(), 0);
    ck_assert_int_eq(
        canOpenSetError(node, EMCY_TEMPERATURE | 0x12, 0x3456, ERROR_TEMPERATURE, field),
        SCANOPEN_OK);
    scan_expect(plant, "085#1240090102030405");
    ck_assert_int_eq(last_error(), 0x4012);
    ck_assert_uint_eq(scan_get(node, 0x1001, 0), ERROR_TEMPERATURE | ERROR_GENERIC);
    ck_assert_uint_eq(scan_get(node, 0x1003, 0), 1);
    ck_assert_uint_eq(scan_get(node, 0x1003, 1), 0x34564012);
    ck_assert_int_eq(canOpenSetError(node, EMCY_GENERIC_ERROR, 0, 0, NULL), SCANOPEN_OK);
    scan_expect(plant, "085#0010090000000000");
    ck_assert_int_eq(canOpenResetError(node, ERROR_TEMPERATURE, field), SCANOPEN_OK);
    scan_expect(plant, "085#0000010102030405");
    ck_assert_int_eq(last_error(), EMCY_ERROR_RESET);
    ck_assert_int_eq(canOpenResetError(node, 0, NULL), SCANOPEN_OK);
    scan_expect(plant, "085#0000000000000000");
    ck_assert_uint_eq(scan_get(node, 0x1001, 0), 0);
    ck_assert_uint_eq(scan_get(node, 0x1003, 0), 2);
    scan_expect_nothing_more(plant, node);
}
END_TEST

static const struct {
    unsigned short code;
    const char *frame;
} codes[] = {
    { EMCY_GENERIC_ERROR, "085#0110010000000000" },
    { EMCY_CURRENT, "085#0120010000000000" },
    { EMCY_CURRENT_INPUT, "085#0121010000000000" },
    { EMCY_CURRENT_INSIDE, "085#0122010000000000" },
    { EMCY_CURRENT_OUTPUT, "085#0123010000000000" },
    { EMCY_VOLTAGE, "085#0130010000000000" },
    { EMCY_VOLTAGE_INPUT, "085#0131010000000000" },
    { EMCY_VOLTAGE_INSIDE, "085#0132010000000000" },
    { EMCY_VOLTAGE_OUTPUT, "085#0133010000000000" },
    { EMCY_TEMPERATURE, "085#0140010000000000" },
    { EMCY_TEMPERATURE_AMBIENT, "085#0141010000000000" },
    { EMCY_TEMPERATURE_DEVICE, "085#0142010000000000" },
    { EMCY_DEVICE_HARDWARE, "085#0150010000000000" },
    { EMCY_DEVICE_SOFTWARE, "085#0160010000000000" },
    { EMCY_DEVICE_SOFTWARE_INTERNAL, "085#0161010000000000" },
    { EMCY_DEVICE_SOFTWARE_USER, "085#0162010000000000" },
    { EMCY_DEVICE_SOFTWARE_DATA_SET, "085#0163010000000000" },
    { EMCY_ADDITIONAL_MODULES, "085#0170010000000000" },
    { EMCY_MONITORING, "085#0180010000000000" },
    { EMCY_MONITORING_COMMUNICATION, "085#0181010000000000" },
    { EMCY_EXTERNAL_ERROR, "085#0190010000000000" },
    { EMCY_ADDITIONAL_FUNCTIONS, "085#01F0010000000000" },
    { EMCY_DEVICE_SPECIFIC, "085#01FF010000000000" },
};

START_TEST(all_error_codes)
{
    scan_activate(plant, node);
    for (unsigned i = 0; i < COUNT(codes); i++) {
        ck_assert_int_eq(set_error(codes[i].code | 0x01), SCANOPEN_OK);
        scan_expect(plant, codes[i].frame);
        ck_assert_int_eq(canOpenResetError(node, 0, NULL), SCANOPEN_OK);
        scan_expect(plant, "085#0000000000000000");
    }
}
END_TEST

static const struct {
    unsigned short bits;
    const char *set, *reset;
} bits[] = {
    { ERROR_GENERIC, "085#0010010000000000", "085#0000010000000000" },
    { ERROR_CURRENT, "085#0010030000000000", "085#0000010000000000" },
    { ERROR_VOLTAGE, "085#0010050000000000", "085#0000010000000000" },
    { ERROR_TEMPERATURE, "085#0010090000000000", "085#0000010000000000" },
    { ERROR_COMMUNICATION, "085#0010110000000000", "085#0000010000000000" },
    { ERROR_DEVICE_SPECIFIC, "085#0010210000000000", "085#0000010000000000" },
    { ERROR_MANUFACTURER_SPECIFIC, "085#0010810000000000", "085#0000010000000000" },
};

START_TEST(all_bits_of_the_register)
{
    scan_activate(plant, node);
    ck_assert_int_eq(set_error(EMCY_GENERIC_ERROR), SCANOPEN_OK);
    scan_expect(plant, "085#0010010000000000");
    for (unsigned i = 0; i < COUNT(bits); i++) {
        ck_assert_int_eq(canOpenSetError(node, 0x1000, 0, bits[i].bits, NULL), SCANOPEN_OK);
        scan_expect(plant, bits[i].set);
        ck_assert_int_eq(canOpenResetError(node, bits[i].bits, NULL), SCANOPEN_OK);
        scan_expect(plant, bits[i].reset);
    }
}
END_TEST

START_TEST(errors_without_a_node)
{
    HNODE gone = scan_node(plant, 6, NULL);

    ck_assert_int_eq(canOpenSetError(NULL, EMCY_CURRENT, 0, 0, NULL), SCANOPEN_INVALID_HANDLE);
    ck_assert_int_eq(canOpenResetError(NULL, 0, NULL), SCANOPEN_INVALID_HANDLE);
    ck_assert_int_eq(canOpenDeleteNode(gone), SCANOPEN_OK);
    ck_assert_int_eq(canOpenSetError(gone, EMCY_CURRENT, 0, 0, NULL), SCANOPEN_INVALID_HANDLE);
    ck_assert_int_eq(canOpenResetError(gone, 0, NULL), SCANOPEN_INVALID_HANDLE);
}
END_TEST

START_TEST(arguments_of_errors)
{
    scan_activate(plant, node);
    ck_assert_int_eq(set_error(EMCY_ERROR_RESET), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenSetError(node, 0x1000, 0, 0x40, NULL), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenSetError(node, 0x1000, 0, 0x100, NULL), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenResetError(node, 0x40, NULL), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenResetError(node, 0x1001, NULL), SCANOPEN_WRONG_PARAMETER);
    scan_expect_nothing_more(plant, node);
    ck_assert_uint_eq(scan_get(node, 0x1001, 0), 0);
}
END_TEST

START_TEST(states_without_errors)
{
    ck_assert_int_eq(set_error(EMCY_CURRENT), SCANOPEN_WRONG_NODESTATE);
    ck_assert_int_eq(canOpenResetError(node, 0, NULL), SCANOPEN_WRONG_NODESTATE);
    scan_activate(plant, node);
    ck_assert_int_eq(canOpenResetError(node, 0, NULL), SCANOPEN_WRONG_NODESTATE);
    ck_assert_int_eq(set_error(EMCY_CURRENT), SCANOPEN_OK);
    ck_assert_int_eq(canOpenResetError(node, 0, NULL), SCANOPEN_OK);
    ck_assert_int_eq(canOpenResetError(node, 0, NULL), SCANOPEN_WRONG_NODESTATE);
    ck_assert_int_eq(set_error(EMCY_CURRENT), SCANOPEN_OK);
    ck_assert_int_eq(canOpenResetNode(node), SCANOPEN_OK);
    ck_assert_int_eq(canOpenResetError(node, 0, NULL), SCANOPEN_WRONG_NODESTATE);
    scan_activate(plant, node);
    ck_assert_int_eq(canOpenResetError(node, 0, NULL), SCANOPEN_WRONG_NODESTATE);
    ck_assert_uint_eq(scan_get(node, 0x1001, 0), 0);
}
END_TEST

/* With a reset by NMT they have gone, too; the application is told of that. */
START_TEST(a_reset_ends_errors)
{
    scan_activate(plant, node);
    ck_assert_int_eq(set_error(EMCY_CURRENT), SCANOPEN_OK);
    scan_send(plant, "000#8205");
    scan_await(plant, "705#00");
    ck_assert_int_eq(canOpenResetError(node, 0, NULL), SCANOPEN_WRONG_NODESTATE);
    ck_assert_uint_eq(scan_get(node, 0x1001, 0), 0);
}
END_TEST

START_TEST(kept_back_when_stopped)
{
    scan_activate(plant, node);
    scan_stop(plant, node);
    ck_assert_int_eq(set_error(EMCY_CURRENT), SCANOPEN_OK);
    ck_assert_int_eq(canOpenResetError(node, 0, field), SCANOPEN_OK);
    ck_assert_int_eq(last_error(), 0);
    scan_send(plant, "705#R1");
    scan_expect(plant, "705#04");
    scan_preoperational(plant, node);
    scan_expect(plant, "085#0020010000000000");
    scan_expect(plant, "085#0000000102030405");
}
END_TEST

START_TEST(kept_back_in_the_inhibit_time)
{
    SLAVE_NODE_INFO info = scan_info();
    co_us_t begin;
    HNODE slow;

    info.usEmcyInhibit = 100;
    slow = scan_node(plant, 6, &info);
    scan_activate(plant, slow);
    begin = clock_now();
    for (unsigned i = 1; i <= 3; i++)
        ck_assert_int_eq(canOpenSetError(slow, (unsigned short)(0x1000 + i), 0, 0, NULL),
                         SCANOPEN_OK);
    scan_expect(plant, "086#0110010000000000");
    scan_expect(plant, "086#0210010000000000");
    scan_expect(plant, "086#0310010000000000");
    ck_assert_uint_ge(scan_time(plant) - begin, CO_MS(200));
}
END_TEST

/* More than can wait: the latest one is there, and the log tells how many are not. */
START_TEST(more_than_can_wait)
{
    char frame[CO_FRAME_TEXT_SIZE];

    scan_activate(plant, node);
    scan_stop(plant, node);
    for (unsigned i = 0; i < 20; i++)
        ck_assert_int_eq(set_error((unsigned short)(0x1000 + i)), SCANOPEN_OK);
    scan_expect_note("log node 5: 1 emergencies not sent: too many wait already");
    scan_preoperational(plant, node);
    for (unsigned i = 0; i < 16; i++) {
        snprintf(frame, sizeof frame, "085#%02X10010000000000", i < 15 ? i : 19);
        scan_expect(plant, frame);
    }
    scan_expect_note("log node 5: 3 emergencies not sent: too many wait already");
    scan_expect_nothing_more(plant, node);
}
END_TEST

/* --- errors that the library finds --- */

static void define(unsigned type)
{
    const uint16_t mapping[] = { 0x2000, 0, 0, 0 };
    HPDO pdo;

    scan_number(node, 0x2000, TYP_UINT8, WRITE_ACCESS | MAPPABLE, 1, NULL);
    ck_assert_int_eq(canOpenDefinePDO(node, NULL, DEFAULT_PDO1, (uint16_t)(RECEIVE_PDO | type), 0,
                                      0, 0, 0, mapping, &pdo),
                     SCANOPEN_OK);
    scan_activate(plant, node);
}

/* Their last bytes, with the part of the application, and its loss. */
START_TEST(the_applications_bits)
{
    static const unsigned char its[5] = { 0x81, 0x41, 0, 0, 0 }, less[5] = { 0 };

    define(255);
    scan_operational(plant, node);
    ck_assert_int_eq(canOpenSetError(node, EMCY_DEVICE_SPECIFIC, 0, 0, its), SCANOPEN_OK);
    scan_expect(plant, "085#00FF018141000000");
    ck_assert_int_eq(set_error(EMCY_DEVICE_SPECIFIC), SCANOPEN_OK);
    scan_expect(plant, "085#00FF010000000000");
    scan_send(plant, "205#");
    scan_expect(plant, "085#1082118044010001");
    ck_assert_int_eq(canOpenResetError(node, 0, less), SCANOPEN_OK);
    scan_expect(plant, "085#0000110000000000");
    scan_send(plant, "205#01");
    scan_expect(plant, "085#0000010044000000");
    ck_assert_int_eq(canOpenResetError(node, 0, less), SCANOPEN_OK);
    scan_expect(plant, "085#0000000000000000");
}
END_TEST

START_TEST(an_rpdo_that_is_late)
{
    define(255);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1400, 5, 2, 20), 0);
    scan_operational(plant, node);
    scan_send(plant, "205#01");
    scan_expect(plant, "085#5082110000010000");
    ck_assert_int_eq(last_error(), EMCY_RPDO_TIMEOUT);
    scan_send(plant, "205#01");
    scan_expect(plant, "085#0000000000000000");
}
END_TEST

START_TEST(a_sync_that_is_too_long)
{
    define(1);
    scan_send(plant, "080#01");
    scan_expect(plant, "085#4082110000000100");
    ck_assert_int_eq(last_error(), EMCY_SYNC_LENGTH);
    scan_send(plant, "080#");
    scan_expect(plant, "085#0000000000000000");
}
END_TEST

/* --- emergencies of others --- */

static void listen_to(unsigned sub, uint32_t cob_id)
{
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1028, sub, 4, cob_id), 0);
}

START_TEST(an_emergency_is_told)
{
    scan_activate(plant, node);
    listen_to(9, 0x87);
    listen_to(10, 0x123 + 0x100);
    scan_send(plant, "087#3081110102030405");
    scan_expect_note("event 0/5 EMCY 87 7 3081110102030405");
    scan_send(plant, "223#0000000000000000");
    scan_expect_note("event 0/5 EMCY 223 10 0000000000000000");
    listen_to(9, 0x80000087);
    scan_send(plant, "087#3081110102030405");
    scan_send(plant, "223#30811101020304"); /* too short */
    scan_send(plant, "088#3081110102030405");
    scan_send(plant, "223#FFFF800000000000");
    scan_expect_note("event 0/5 EMCY 223 10 FFFF800000000000");
}
END_TEST

/* Of a node of the same process. */
START_TEST(an_emergency_of_a_neighbour)
{
    HNODE other = scan_node(plant, 6, NULL);

    scan_activate(plant, node);
    scan_activate(plant, other);
    listen_to(6, 0x86);
    ck_assert_int_eq(canOpenSetError(other, EMCY_VOLTAGE, 0, ERROR_VOLTAGE, field), SCANOPEN_OK);
    scan_await_note("event 0/5 EMCY 86 6 0030050102030405");
}
END_TEST

static SLAVE_EMCY seen;
static pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;

static int on_emcy(SLAVE_EVENT *event)
{
    if (event->ulEvent != EV_EMCY)
        return SCANOPEN_OK;
    seen = *(SLAVE_EMCY *)event->arg.pArg2;
    scan_note("emcy of %lu", event->ulArg1);
    pthread_mutex_lock(&gate);
    pthread_mutex_unlock(&gate);
    return SCANOPEN_OK;
}

static HNODE make_listener(void)
{
    SLAVE_NODE_INFO info = scan_info();
    HNODE other = NULL;

    info.ulOptions |= EMCY_CONSUMER;
    ck_assert_int_eq(canOpenCreateNodeEx(0, 6, on_emcy, &info, &other), SCANOPEN_OK);
    scan_plant_keep(plant, other, 6);
    scan_activate(plant, other);
    ck_assert_uint_eq(scan_sdo_write(plant, 6, 0x1028, 7, 4, 0x87), 0);
    return other;
}

START_TEST(what_an_emergency_consists_of)
{
    const co_us_t before = clock_now();

    make_listener();
    scan_send(plant, "087#3081110102030405");
    scan_expect_note("emcy of 7");
    ck_assert_uint_eq(seen.ulCobId, 0x87);
    ck_assert_uint_eq(seen.usNodeId, 7);
    ck_assert_mem_eq(seen.ucData, "\x30\x81\x11\x01\x02\x03\x04\x05", 8);
    ck_assert_uint_ge(seen.ullTimestamp, before * 1000);
    ck_assert_uint_le(seen.ullTimestamp, clock_now() * 1000);
}
END_TEST

/* One is with the handler, 256 wait; the others are counted. */
START_TEST(more_emergencies_than_the_handler_takes)
{
    HNODE other = make_listener();

    pthread_mutex_lock(&gate);
    scan_send(plant, "087#3081110102030405");
    scan_expect_note("emcy of 7");
    for (unsigned i = 0; i < 256 + 3; i++)
        scan_send(plant, "087#0000000000000000");
    scan_expect_nothing_more(plant, other);
    pthread_mutex_unlock(&gate);
    scan_await_note("log network 0: 3 received emergencies lost: the event handler is too slow");
    ck_assert_uint_eq(scan_count_notes("emcy of 7"), 257);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("emcy");

    tcase_set_timeout(tcase, SCAN_LIMIT);
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    tcase_add_test(tcase, an_error_and_its_end);
    tcase_add_test(tcase, all_error_codes);
    tcase_add_test(tcase, all_bits_of_the_register);
    tcase_add_test(tcase, errors_without_a_node);
    tcase_add_test(tcase, arguments_of_errors);
    tcase_add_test(tcase, states_without_errors);
    tcase_add_test(tcase, a_reset_ends_errors);
    tcase_add_test(tcase, kept_back_when_stopped);
    tcase_add_test(tcase, kept_back_in_the_inhibit_time);
    tcase_add_test(tcase, more_than_can_wait);
    tcase_add_test(tcase, the_applications_bits);
    tcase_add_test(tcase, an_rpdo_that_is_late);
    tcase_add_test(tcase, a_sync_that_is_too_long);
    tcase_add_test(tcase, an_emergency_is_told);
    tcase_add_test(tcase, an_emergency_of_a_neighbour);
    tcase_add_test(tcase, what_an_emergency_consists_of);
    tcase_add_test(tcase, more_emergencies_than_the_handler_takes);
    return suite_run("scan_emcy", tcase);
}
