/*
 * Memory runs out at each moment of a manager's beginning: it says so, and nothing is left behind.
 */
#include "support/config_text.h"
#include "support/dcf_file.h"
#include "support/scarce.h"
#include "support/suite.h"

#include "manager/config_domains.h"
#include "manager/manager.h"

#include <stdlib.h>
#include <string.h>

static const char text[] = NET("<Name>plant</Name>"
                               "<Sync_Interval>1000</Sync_Interval>"
                               "<Node_Instance><Node_Id>5</Node_Id><Name>pump</Name>"
                               "<Software_Identification>1</Software_Identification>"
                               "</Node_Instance>");

START_TEST(test_file_is_read)
{
    struct config_result *result = config_parse("<a/>");
    unsigned n;

    for (n = 1; n < 100; n++) {
        memory_left = n;
        result = config_parse(text);
        memory_left = 0;
        if (result->err == CO_OK)
            break;
        ck_assert_int_eq(result->err, CO_ERR_MEMORY);
    }
    ck_assert_int_eq(result->err, CO_OK);
    ck_assert_uint_gt(n, 3);
    network_config_free(result->networks, result->count);
}
END_TEST

START_TEST(test_manager_is_made)
{
    static struct manager manager;
    struct network_config *config = config_parse_one(text);
    enum co_err err = CO_ERR_MEMORY;
    unsigned n;

    for (n = 1; err != CO_OK && n < 100000; n += n < 40 ? 1 : 29) { /* of an object some fail */
        memory_left = n;
        err = manager_init(&manager, config);
        memory_left = 0;
        ck_assert(err == CO_OK || err == CO_ERR_MEMORY);
    }
    ck_assert_int_eq(err, CO_OK);
    ck_assert_uint_gt(n, 100);
    manager_done(&manager);
    network_config_free(config, 1);
}
END_TEST

/* It takes the place of what was there, or that stays. */
static void write_domain(uint16_t index, const void *bytes, size_t size)
{
    const struct slave_value value = { SDO_OK, bytes, (uint32_t)size };
    struct network_config *config = config_parse_one(text);
    const struct node_config before = config->nodes[0];
    sdo_abort_t code = SDO_NO_MEMORY;

    for (unsigned n = 1; code != SDO_OK && n < 10000; n++) {
        struct node_config changed = before;
        struct co_report report = { .file = NULL };

        memory_left = n;
        code = config_domain_set_node(index, config, &changed, &value, &report);
        memory_left = 0;
        ck_assert(code == SDO_OK || code == SDO_NO_MEMORY);
        if (code == SDO_OK)
            config->nodes[0] = changed;
    }
    ck_assert_uint_eq(code, SDO_OK);
    ck_assert_uint_gt(config_domain_of_node(index, &config->nodes[0]).size, 4);
    config_domain_free(index, &before);
    network_config_free(config, 1);
}

START_TEST(test_domains_are_written)
{
    static const uint8_t concise[] = { 1, 0, 0, 0, 0x00, 0x62, 1, 1, 0, 0, 0, 0x55 };
    static const char dcf[] = OBJECT("2000", VAR("2000", "5", "rw") "ParameterValue=7\n");

    write_domain(0x1F22, concise, sizeof concise);
    write_domain(0x1F20, dcf, sizeof dcf - 1);
    write_domain(0x1F58, concise, sizeof concise);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("out_of_memory");

    tcase_add_test(tcase, test_file_is_read);
    tcase_add_test(tcase, test_manager_is_made);
    tcase_add_test(tcase, test_domains_are_written);
    return suite_run("out_of_memory", tcase);
}
