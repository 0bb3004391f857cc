/*
 * What the elements about the configuration of a node do: node 5 is a device, node 7 answers what
 * the test lets it.
 */
#include "support/api_plant.h"
#include "support/api_wire.h"
#include "support/dcf_file.h"
#include "support/suite.h"

#include <stdio.h>

#define NUMBER OBJECT("2000", VAR("2000", "5", "rw") "ParameterValue=7\n")
#define TEXT   OBJECT("2000", VAR("2000", "9", "rw") "ParameterValue=7 bytes\n")
#define DCF    "<DCF_File>a.dcf</DCF_File>" API_PATIENT

static struct api_plant *plant;
static struct api_wire *wire;

static void set_up(void)
{
    plant = api_plant_new();
    wire = api_wire_open(plant->bus);
    api_add_device(plant, 5);
    api_add_number(plant, 5, 0x2000, 1, 0);
    api_devices_start(plant);
    api_wire_answer(wire, "607#40001000", "587#4300100092010200");
}

static void tear_down(void)
{
    api_plant_free(plant);
    api_wire_close(wire);
}

/* Node 7 with this file, and nothing of its own that it would refuse. */
static void boot_with(const char *dcf, const char *inner)
{
    api_write(plant, "a.dcf", dcf);
    api_start(plant, inner);
    ck_assert_int_eq(api_wait_boot(7), 0);
    api_wire_settle(wire);
}

static void expect_value(void)
{
    uint8_t value = 0;

    ck_assert_int_eq(api_wait_boot(5), 0);
    ck_assert_uint_eq(api_get(plant, 5, 0x2000, &value, 1), 1);
    ck_assert_uint_eq(value, 7);
}

START_TEST(dcf_file)
{
    api_write(plant, "a.dcf", NUMBER);
    api_start(plant, API_NODE_WITH(5, DCF));
    expect_value();
}
END_TEST

START_TEST(ccf_file)
{
    static const unsigned char ccf[] = { 1, 0, 0, 0, 0x00, 0x20, 0, 1, 0, 0, 0, 7 };
    FILE *file = fopen(api_path(plant, "a.ccf"), "wb");

    ck_assert_ptr_nonnull(file);
    ck_assert_uint_eq(fwrite(ccf, 1, sizeof ccf, file), sizeof ccf);
    ck_assert_int_eq(fclose(file), 0);
    api_start(plant, API_NODE_WITH(5, "<CCF_File>a.ccf</CCF_File>" API_PATIENT));
    expect_value();
}
END_TEST

#define MAPPING                                                                                    \
    FILE_INFO DEVICE_INFO LISTS                                                                    \
        "[OptionalObjects]\nSupportedObjects=1\n1=0x1600\n" MANDATORY                              \
        "[1600]\nParameterName=Mapping\nObjectType=9\nSubNumber=2\n" VAR(                          \
            "1600sub0", "5", "rw") "ParameterValue=1\n" VAR("1600sub1", "7",                       \
                                                            "rw") "ParameterValue=0x20000008\n"

/* The number of mapped objects goes first, and is not 0 before. */
START_TEST(old_config_style)
{
    api_wire_answer(wire, "607#2F001600", "587#6000160000000000");
    api_wire_answer(wire, "607#23001601", "587#6000160100000000");
    boot_with(MAPPING, API_NODE_WITH(7, DCF "<Old_Config_Style>TRUE</Old_Config_Style>"));
    ck_assert_uint_eq(api_wire_count(wire, "607#2F001600"), 1);
    ck_assert_uint_eq(api_wire_count(wire, "607#2F00160001"), 1);
    ck_assert_uint_le(api_wire_time(wire, "607#2F001600", 1),
                      api_wire_time(wire, "607#23001601", 1));
}
END_TEST

/* --- how values of more than four bytes are written --- */

START_TEST(sdo_segmented_size_indication)
{
    api_wire_answer(wire, "607#20002000", "587#6000200000000000");
    api_wire_answer(wire, "607#01", "587#2000000000000000");
    boot_with(TEXT, API_NODE_WITH(7, DCF "<SDO_Segmented_Size_Indication>FALSE"
                                         "</SDO_Segmented_Size_Indication>"));
    ck_assert_uint_eq(api_wire_count(wire, "607#2000200000000000"), 1);
    ck_assert_uint_eq(api_wire_count(wire, "607#0137206279746573"), 1);
}
END_TEST

/* Node 7 wants 9 segments in a block. */
START_TEST(sdo_block_size)
{
    api_wire_answer(wire, "607#C", "587#A000200009000000");
    api_wire_answer(wire, "607#81", "587#A201090000000000");
    api_wire_answer(wire, "607#C1", "587#A100000000000000");
    boot_with(TEXT, API_NODE_WITH(7, DCF "<SDO_Block_Size>9</SDO_Block_Size>"));
    ck_assert_uint_eq(api_wire_count(wire, "607#8137206279746573"), 1);
    ck_assert_uint_eq(api_wire_count(wire, "607#2"), 0);
}
END_TEST

/* --- whether they are written, and kept --- */

START_TEST(save_configuration)
{
    api_wire_answer(wire, "607#2F002000", "587#6000200000000000");
    api_wire_answer(wire, "607#23101001", "587#6010100100000000");
    boot_with(NUMBER, API_NODE_WITH(7, DCF "<Save_Configuration>TRUE</Save_Configuration>"));
    ck_assert_uint_eq(api_wire_count(wire, "607#2310100173617665"), 1);
}
END_TEST

/* The device restores its values, and starts anew for that. */
START_TEST(restore_configuration)
{
    api_wire_answer(wire, "607#23111001", "587#6011100100000000");
    api_wire_answer(wire, "000#8107", "707#00");
    api_wire_answer(wire, "607#2F002000", "587#6000200000000000");
    boot_with(NUMBER, API_NODE_WITH(7, DCF "<Restore_Configuration>1</Restore_Configuration>"));
    ck_assert_uint_eq(api_wire_count(wire, "607#231110016C6F6164"), 1);
    ck_assert_uint_eq(api_wire_count(wire, "000#8107"), 1);
}
END_TEST

/* The device has the value already. */
START_TEST(verify_configuration)
{
    api_wire_answer(wire, "607#40002000", "587#4F00200007000000");
    boot_with(NUMBER, API_NODE_WITH(7, DCF "<Verify_Configuration>TRUE</Verify_Configuration>"));
    ck_assert_uint_eq(api_wire_count(wire, "607#2"), 0);
}
END_TEST

/* The device tells that it has this configuration. */
START_TEST(configuration_date_and_time)
{
    api_wire_answer(wire, "607#40201001", "587#4320100105000000");
    api_wire_answer(wire, "607#40201002", "587#4320100206000000");
    boot_with(NUMBER, API_NODE_WITH(7, DCF "<Configuration_Date>5</Configuration_Date>"
                                           "<Configuration_Time>6</Configuration_Time>"));
    ck_assert_uint_eq(api_wire_count(wire, "607#2"), 0);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("elements about files");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_set_timeout(tests, API_LIMIT);
    tcase_add_test(tests, dcf_file);
    tcase_add_test(tests, ccf_file);
    tcase_add_test(tests, old_config_style);
    tcase_add_test(tests, sdo_segmented_size_indication);
    tcase_add_test(tests, sdo_block_size);
    tcase_add_test(tests, save_configuration);
    tcase_add_test(tests, restore_configuration);
    tcase_add_test(tests, verify_configuration);
    tcase_add_test(tests, configuration_date_and_time);
    return suite_run("api_elements_file", tests);
}
