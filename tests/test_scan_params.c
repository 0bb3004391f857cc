/* canOpenSetParameter and canOpenGetParameter: sending held back, and the clock. */
#include "port/clock.h"
#include "support/scan_plant.h"
#include "support/suite.h"

static struct scan_plant *plant;
static HNODE node;

/* Two PDOs that send what changes; 2002h is in both. */
static void set_up(void)
{
    const uint16_t first[] = { 0x2000, 0, 0x2002, 0, 0, 0 };
    const uint16_t second[] = { 0x2001, 0, 0x2002, 0, 0, 0 };
    const uint16_t mode = TRANSMIT_PDO | AUTO_NOTIFY | ASYNCHRON_PDO | 255;
    HPDO pdo;

    plant = scan_plant_new(0);
    node = scan_node(plant, 5, NULL);
    scan_number(node, 0x2000, TYP_UINT8, READ_ACCESS | MAPPABLE, 1, NULL);
    scan_number(node, 0x2001, TYP_UINT8, READ_ACCESS | MAPPABLE, 2, NULL);
    scan_number(node, 0x2002, TYP_UINT8, READ_ACCESS | MAPPABLE | MULTI_MAP, 3, NULL);
    ck_assert_int_eq(canOpenDefinePDO(node, NULL, DEFAULT_PDO1, mode, 0, 0, 0, 0, first, &pdo),
                     SCANOPEN_OK);
    ck_assert_int_eq(canOpenDefinePDO(node, NULL, DEFAULT_PDO2, mode, 0, 0, 0, 0, second, &pdo),
                     SCANOPEN_OK);
}

static void tear_down(void)
{
    scan_plant_free(plant);
}

static void go(void)
{
    scan_activate(plant, node);
    scan_operational(plant, node);
    scan_forget(plant);
}

START_TEST(sending_is_held_back)
{
    go();
    ck_assert_int_eq(canOpenSetParameter(node, PARAM_DISABLE_AUTO_TRANSMISSION, NULL), SCANOPEN_OK);
    ck_assert_int_eq(scan_set(node, 0x2000, 0, 0x11), SCANOPEN_OK);
    ck_assert_int_eq(scan_set(node, 0x2000, 0, 0x22), SCANOPEN_OK);
    ck_assert_int_eq(scan_set(node, 0x2002, 0, 0x33), SCANOPEN_OK);
    scan_expect_nothing_more(plant, node);
    ck_assert_int_eq(canOpenSetParameter(node, PARAM_ENABLE_AUTO_TRANSMISSION, NULL), SCANOPEN_OK);
    scan_expect(plant, "185#2233");
    scan_expect(plant, "285#0233");
    scan_expect_nothing_more(plant, node);
    ck_assert_int_eq(scan_set(node, 0x2000, 0, 0x44), SCANOPEN_OK); /* as before */
    scan_expect(plant, "185#4433");
    scan_expect_nothing_more(plant, node);
}
END_TEST

START_TEST(only_what_has_changed_is_sent)
{
    go();
    ck_assert_int_eq(canOpenSetParameter(node, PARAM_DISABLE_AUTO_TRANSMISSION, NULL), SCANOPEN_OK);
    ck_assert_int_eq(scan_set(node, 0x2001, 0, 0x11), SCANOPEN_OK);
    ck_assert_int_eq(canOpenSetParameter(node, PARAM_ENABLE_AUTO_TRANSMISSION, NULL), SCANOPEN_OK);
    scan_expect(plant, "285#1103");
    scan_expect_nothing_more(plant, node);
    ck_assert_int_eq(canOpenSetParameter(node, PARAM_DISABLE_AUTO_TRANSMISSION, NULL), SCANOPEN_OK);
    ck_assert_int_eq(canOpenSetParameter(node, PARAM_ENABLE_AUTO_TRANSMISSION, NULL), SCANOPEN_OK);
    ck_assert_int_eq(canOpenSetParameter(node, PARAM_ENABLE_AUTO_TRANSMISSION, NULL), SCANOPEN_OK);
    scan_expect_nothing_more(plant, node);
}
END_TEST

START_TEST(nothing_is_sent_when_not_operational)
{
    ck_assert_int_eq(canOpenSetParameter(node, PARAM_DISABLE_AUTO_TRANSMISSION, NULL), SCANOPEN_OK);
    scan_activate(plant, node);
    ck_assert_int_eq(scan_set(node, 0x2000, 0, 0x11), SCANOPEN_OK);
    ck_assert_int_eq(canOpenSetParameter(node, PARAM_ENABLE_AUTO_TRANSMISSION, NULL), SCANOPEN_OK);
    scan_expect_nothing_more(plant, node);
}
END_TEST

START_TEST(the_clock)
{
    uint64_t frequency = 0, now = 0, later = 0;
    co_us_t before = clock_now();

    ck_assert_int_eq(canOpenGetParameter(node, PARA_GET_TIMESTAMP_FREQUENCY, &frequency),
                     SCANOPEN_OK);
    ck_assert_uint_eq(frequency, 1000000000);
    ck_assert_int_eq(canOpenGetParameter(node, PARA_GET_TIMESTAMP, &now), SCANOPEN_OK);
    ck_assert_int_eq(canOpenGetParameter(node, PARAM_GET_TIMESTAMP, &later), SCANOPEN_OK);
    ck_assert_uint_ge(now / 1000, before);
    ck_assert_uint_ge(later, now);
    ck_assert_uint_le(later / 1000, clock_now());
    ck_assert_int_eq(PARAM_GET_TIMESTAMP_FREQUENCY, PARA_GET_TIMESTAMP_FREQUENCY);
    go(); /* in any state */
    ck_assert_int_eq(canOpenGetParameter(node, PARA_GET_TIMESTAMP, &now), SCANOPEN_OK);
    ck_assert_uint_gt(now, later);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("params");

    tcase_set_timeout(tcase, SCAN_LIMIT);
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    tcase_add_test(tcase, sending_is_held_back);
    tcase_add_test(tcase, only_what_has_changed_is_sent);
    tcase_add_test(tcase, nothing_is_sent_when_not_operational);
    tcase_add_test(tcase, the_clock);
    return suite_run("scan_params", tcase);
}
