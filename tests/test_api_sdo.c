/* mcanOpenReadSDO and mcanOpenWriteSDO: transfers, refusals, time-outs and arguments. */
#include "port/clock.h"
#include "support/api_plant.h"
#include "support/api_wire.h"
#include "support/suite.h"

#include <string.h>

#define TEXT "a text that needs more than one segment"

static struct api_plant *plant;
static struct api_wire *wire;
static const ERROR_T no_error = { 0, 0, 0, 0 };

/* Node 5 is configured and there, 6 is there but not configured, 7 is configured and never there,
 * 8 is neither. */
static void set_up(void)
{
    plant = api_plant_new();
    wire = api_wire_open(plant->bus);
    api_add_device(plant, 5);
    api_add_number(plant, 5, 0x2001, 1, 0x11);
    api_add_number(plant, 5, 0x2002, 2, 0x2211);
    api_add_number(plant, 5, 0x2004, 4, 0x44332211);
    api_add_domain(plant, 5, 0x2010, TEXT, sizeof TEXT - 1, 65536);
    api_add_domain(plant, 5, 0x2011, NULL, 0, 100);
    api_add_device(plant, 6);
    api_devices_start(plant);
    api_boot(plant, API_NODE(5) API_NODE_WITH(7, "<SDO_Timeout>50</SDO_Timeout>"
                                                 "<SDO_Block_Size>9</SDO_Block_Size>"
                                                 "<NMT_Auto_Start_Slave>FALSE"
                                                 "</NMT_Auto_Start_Slave>"));
}

static void tear_down(void)
{
    api_plant_free(plant);
    api_wire_close(wire);
}

static void expect_error(const ERROR_T *error, unsigned long code)
{
    ck_assert_uint_eq(error->eclass, code >> 24 & 0xFF);
    ck_assert_uint_eq(error->code, code >> 16 & 0xFF);
    ck_assert_uint_eq(error->spec, code >> 8 & 0xFF);
    ck_assert_uint_eq(error->global, code & 0xFF);
}

static const struct small {
    int index, size;
    const char *bytes;
} smalls[] = {
    { 0x2001, 1, "\x11" },
    { 0x2002, 2, "\x11\x22" },
    { 0x2004, 4, "\x11\x22\x33\x44" },
    { 0x1000, 4, "\x92\x01\x02\x00" },
};

START_TEST(small_values_are_read_expedited)
{
    const struct small *row = &smalls[_i];
    unsigned char buffer[8];
    int len = sizeof buffer;
    ERROR_T error = { 1, 2, 3, 4 };

    memset(buffer, 0xEE, sizeof buffer);
    ck_assert_int_eq(mcanOpenReadSDO(0, 5, row->index, 0, buffer, &len, &error), MCANOPEN_OK);
    ck_assert_int_eq(len, row->size);
    ck_assert_mem_eq(buffer, row->bytes, (size_t)row->size);
    ck_assert_uint_eq(buffer[row->size], 0xEE);
    ck_assert_mem_eq(&error, &no_error, sizeof error);
    ck_assert_uint_eq(api_wire_count(wire, "605#60"), 0);
}
END_TEST

START_TEST(large_values_are_read_in_segments)
{
    char buffer[100] = "";
    int len = sizeof buffer;

    ck_assert_int_eq(mcanOpenReadSDO(0, 5, 0x2010, 0, buffer, &len, NULL), MCANOPEN_OK);
    ck_assert_int_eq(len, sizeof TEXT - 1);
    ck_assert_str_eq(buffer, TEXT);
    len = sizeof TEXT - 1; /* exactly enough */
    ck_assert_int_eq(mcanOpenReadSDO(0, 5, 0x2010, 0, buffer, &len, NULL), MCANOPEN_OK);
}
END_TEST

START_TEST(an_empty_value_is_read)
{
    char buffer[4] = "old";
    int len = 0;

    ck_assert_int_eq(mcanOpenReadSDO(0, 5, 0x2011, 0, buffer, &len, NULL), MCANOPEN_OK);
    ck_assert_int_eq(len, 0);
    ck_assert_str_eq(buffer, "old");
}
END_TEST

START_TEST(a_node_outside_the_configuration_is_read_and_written)
{
    unsigned char buffer[4] = { 0x64, 0 };
    int len = sizeof buffer;

    ck_assert_int_eq(mcanOpenWriteSDO(0, 6, 0x1017, 0, TYP_UINT16, buffer, 0, NULL), MCANOPEN_OK);
    ck_assert_int_eq(mcanOpenReadSDO(0, 6, 0x1017, 0, buffer, &len, NULL), MCANOPEN_OK);
    ck_assert_int_eq(len, 2);
    ck_assert_uint_eq(buffer[0], 0x64);
}
END_TEST

START_TEST(an_overflow_leaves_the_buffer)
{
    char buffer[40] = "old";
    int len = 10;
    ERROR_T error = { 1, 2, 3, 4 };

    ck_assert_int_eq(mcanOpenReadSDO(0, 5, 0x2010, 0, buffer, &len, &error), MCAL_BUFFER_OVERFLOW);
    ck_assert_int_eq(len, sizeof TEXT - 1);
    ck_assert_str_eq(buffer, "old");
    ck_assert_mem_eq(&error, &no_error, sizeof error);
    api_wire_wait(wire, "605#8010200005000405", 1);
    len = 2;
    ck_assert_int_eq(mcanOpenReadSDO(0, 5, 0x2004, 0, buffer, &len, &error), MCAL_BUFFER_OVERFLOW);
    ck_assert_int_eq(len, 4);
    ck_assert_str_eq(buffer, "old");
    ck_assert_int_eq(mcanOpenReadSDO(0, 5, 0x2010, 0, buffer, &len, NULL), MCAL_BUFFER_OVERFLOW);
}
END_TEST

START_TEST(an_overflow_of_unknown_size_leaves_the_length)
{
    char buffer[40] = "old";
    int len = 10;

    api_wire_answer(wire, "607#401020", "587#4010200000000000");
    api_wire_answer(wire, "607#60", "587#0041424344454647");
    api_wire_answer(wire, "607#70", "587#1041424344454647");
    ck_assert_int_eq(mcanOpenReadSDO(0, 7, 0x2010, 0, buffer, &len, NULL), MCAL_BUFFER_OVERFLOW);
    ck_assert_int_eq(len, 10);
    ck_assert_str_eq(buffer, "old");
    api_wire_wait(wire, "607#8010200005000405", 1);
}
END_TEST

static const struct broken {
    const char *request, *answer;
    int result;
} broken[] = {
    { "607#60", "587#1041424344454647", MCAL_TOGGLE_ERROR },
    { "607#60", "587#6010200000000000", MCAL_WRONG_SERVER_ANSWER },
    { "607#60", "587#8010200011000906", MCAL_ABORT_DOMAIN },
    { "607#60", "", MCAL_CAN_RX_TIMEOUT },
};

START_TEST(a_node_that_breaks_the_protocol)
{
    const struct broken *row = &broken[_i];
    char buffer[40] = "old";
    int len = sizeof buffer;
    ERROR_T error;

    api_wire_answer(wire, "607#401020", "587#4110200010000000");
    api_wire_answer(wire, row->request, row->answer);
    ck_assert_int_eq(mcanOpenReadSDO(0, 7, 0x2010, 0, buffer, &len, &error), row->result);
    expect_error(&error, row->result == MCAL_ABORT_DOMAIN ? 0x06090011 : 0);
    ck_assert_int_eq(len, sizeof buffer);
    ck_assert_str_eq(buffer, "old");
}
END_TEST

/* The answer to the first segment of two. */
static const struct broken broken_writes[] = {
    { "607#00", "587#3000000000000000", MCAL_TOGGLE_ERROR },
    { "607#00", "587#0041424344454647", MCAL_WRONG_SERVER_ANSWER },
};

START_TEST(a_node_that_breaks_the_protocol_when_written)
{
    const struct broken *row = &broken_writes[_i];

    api_wire_answer(wire, "607#20102000", "587#6010200000000000");
    api_wire_answer(wire, row->request, row->answer);
    ck_assert_int_eq(mcanOpenWriteSDO(0, 7, 0x2010, 0, TYP_DOMAIN, "ABCDEFGHI", 9, NULL),
                     row->result);
}
END_TEST

START_TEST(aborts_come_with_their_code)
{
    unsigned char buffer[4] = { 1, 2, 3, 4 };
    int len = sizeof buffer;
    ERROR_T error;

    ck_assert_int_eq(mcanOpenReadSDO(0, 5, 0x5000, 0, buffer, &len, &error), MCAL_ABORT_DOMAIN);
    expect_error(&error, 0x06020000);
    ck_assert_int_eq(mcanOpenReadSDO(0, 5, 0x1018, 9, buffer, &len, &error), MCAL_ABORT_DOMAIN);
    expect_error(&error, 0x06090011);
    ck_assert_int_eq(mcanOpenWriteSDO(0, 5, 0x1000, 0, TYP_UINT32, buffer, 0, &error),
                     MCAL_ABORT_DOMAIN);
    expect_error(&error, 0x06010002);
    ck_assert_int_eq(mcanOpenWriteSDO(0, 5, 0x2001, 0, TYP_UINT16, buffer, 0, &error),
                     MCAL_ABORT_DOMAIN);
    expect_error(&error, 0x06070012);
    ck_assert_int_eq(mcanOpenReadSDO(0, 5, 0x5000, 0, buffer, &len, NULL), MCAL_ABORT_DOMAIN);
    ck_assert_int_eq(len, sizeof buffer);
}
END_TEST

static const struct silence {
    unsigned short node;
    bool write;
    unsigned ms;
} silences[] = { { 7, false, 50 }, { 7, true, 50 }, { 8, false, 200 }, { 8, true, 2000 } };

START_TEST(a_node_that_is_not_there_costs_its_time_out)
{
    const struct silence *row = &silences[_i];
    unsigned char buffer[4] = { 0 };
    int len = sizeof buffer, result;
    ERROR_T error = { 1, 2, 3, 4 };
    co_us_t start = clock_now(), took;

    if (row->write)
        result = mcanOpenWriteSDO(0, row->node, 0x2000, 0, TYP_UINT8, buffer, 0, &error);
    else
        result = mcanOpenReadSDO(0, row->node, 0x2000, 0, buffer, &len, &error);
    took = clock_now() - start;
    ck_assert_int_eq(result, MCAL_CAN_RX_TIMEOUT);
    ck_assert_mem_eq(&error, &no_error, sizeof error);
    ck_assert_uint_ge(took, CO_MS(row->ms));
    ck_assert_uint_lt(took, CO_MS(row->ms + 1500)); /* a busy machine; not the next longer one */
    api_wire_wait(wire, row->node == 7 ? "607#8000200000000405" : "608#8000200000000405", 1);
}
END_TEST

/* --- writing: types, flags and lengths --- */

static const struct write {
    int type, len;
    const char *frame; /* of the request, its beginning */
} writes[] = {
    { TYP_CHAR, 0, "607#2F002000" },
    { TYP_BOOL, 0, "607#2F002000" },
    { TYP_INT8, 0, "607#2F002000" },
    { TYP_UINT8, 0, "607#2F00200041000000" },
    { TYP_INT16, 0, "607#2B002000" },
    { TYP_UINT16, 0, "607#2B00200041420000" },
    { TYP_INT24, 0, "607#27002000" },
    { TYP_UINT24, 0, "607#2700200041424300" },
    { TYP_INT32, 0, "607#23002000" },
    { TYP_UINT32, 0, "607#2300200041424344" },
    { TYP_FLOAT, 0, "607#23002000" },
    { TYP_UINT32, 2, "607#2B00200041420000" }, /* a length wins over the type's */
    { TYP_UINT8, 3, "607#2700200041424300" },
    { TYP_VIS_STRING, 1, "607#2F00200041000000" },
    { TYP_OCT_STRING, 4, "607#2300200041424344" },
    { TYP_DOMAIN, 3, "607#2700200041424300" },
    { TYP_UINT16 | TYP_INDICATE_SIZE, 0, "607#2B002000" },
    { TYP_UINT16 | TYP_INDICATE_NO_SIZE, 0, "607#2200200041420000" },
    { TYP_DATE, 0, "607#2000200000000000" }, /* 6: in segments, without the size */
    { TYP_TIME_OF_DAY, 0, "607#2000200000000000" },
    { TYP_TIME_DIFFERENCE | TYP_INDICATE_SIZE, 0, "607#2100200006000000" },
    { TYP_DOUBLE, 0, "607#2000200000000000" },
    { TYP_INT40 | TYP_INDICATE_SIZE, 0, "607#2100200005000000" },
    { TYP_UINT40 | TYP_INDICATE_SIZE, 0, "607#2100200005000000" },
    { TYP_INT48 | TYP_INDICATE_SIZE, 0, "607#2100200006000000" },
    { TYP_UINT48 | TYP_INDICATE_SIZE, 0, "607#2100200006000000" },
    { TYP_INT56 | TYP_INDICATE_SIZE, 0, "607#2100200007000000" },
    { TYP_UINT56 | TYP_INDICATE_SIZE, 0, "607#2100200007000000" },
    { TYP_INT64 | TYP_INDICATE_SIZE, 0, "607#2100200008000000" },
    { TYP_UINT64 | TYP_INDICATE_SIZE, 0, "607#2100200008000000" },
    { TYP_DOMAIN, 5, "607#2000200000000000" },
    { TYP_VIS_STRING | TYP_INDICATE_NO_SIZE, 5, "607#2000200000000000" },
    { TYP_UNICODE_STRING | TYP_INDICATE_SIZE, 9, "607#2100200009000000" },
};

START_TEST(a_type_has_its_length_and_flags)
{
    const struct write *row = &writes[_i];

    api_wire_answer(wire, "607#2", "587#6000200000000000");
    api_wire_answer(wire, "607#0", "587#2000000000000000");
    api_wire_answer(wire, "607#1", "587#3000000000000000");
    ck_assert_int_eq(mcanOpenWriteSDO(0, 7, 0x2000, 0, row->type, "ABCDEFGHI", row->len, NULL),
                     MCANOPEN_OK);
    ck_assert_uint_eq(api_wire_count(wire, row->frame), 1);
}
END_TEST

static const struct write refused[] = {
    { 0, 1, NULL },
    { 0x0E, 1, NULL },
    { 0x17, 1, NULL },
    { 0x7F, 1, NULL },
    { TYP_UINT8 | 0x80, 1, NULL },
    { TYP_UINT8 | 0x800, 1, NULL },
    { -1, 1, NULL },
    { TYP_UINT8 | TYP_INDICATE_SIZE | TYP_INDICATE_NO_SIZE, 1, NULL },
    { TYP_UINT8, -1, NULL },
    { TYP_DOMAIN, 0, NULL },
    { TYP_VIS_STRING, 0, NULL },
    { TYP_OCT_STRING, 0, NULL },
    { TYP_UNICODE_STRING, 0, NULL },
};

START_TEST(wrong_types_and_lengths_are_refused)
{
    const struct write *row = &refused[_i];
    ERROR_T error = { 1, 2, 3, 4 };

    ck_assert_int_eq(mcanOpenWriteSDO(0, 7, 0x2000, 0, row->type, "ABCD", row->len, &error),
                     MCAL_PARA_ERROR);
    ck_assert_mem_eq(&error, &no_error, sizeof error);
    ck_assert_uint_eq(api_wire_count(wire, "607#"), 0);
}
END_TEST

START_TEST(what_was_written_is_there)
{
    char large[30000], value[30000];

    for (size_t i = 0; i < sizeof large; i++)
        large[i] = (char)(i * 7);
    ck_assert_int_eq(mcanOpenWriteSDO(0, 5, 0x2010, 0, TYP_DOMAIN, large, sizeof large, NULL),
                     MCANOPEN_OK);
    ck_assert_uint_eq(api_get(plant, 5, 0x2010, value, sizeof value), sizeof value);
    ck_assert_mem_eq(value, large, sizeof value);
    ck_assert_int_eq(mcanOpenWriteSDO(0, 5, 0x2002, 0, TYP_UINT16, "\x34\x12", 0, NULL),
                     MCANOPEN_OK);
    ck_assert_uint_eq(api_get(plant, 5, 0x2002, value, sizeof value), 2);
    ck_assert_mem_eq(value, "\x34\x12", 2);
}
END_TEST

/* --- in blocks --- */

START_TEST(a_block_is_written)
{
    api_wire_answer(wire, "607#C600200008", "587#A40020007F000000");
    api_wire_answer(wire, "607#8248", "587#A2027F0000000000");
    api_wire_answer(wire, "607#D9D110", "587#A100000000000000");
    ck_assert_int_eq(mcanOpenWriteSDO(0, 7, 0x2000, 0, TYP_UINT64 | TYP_BLOCK, "ABCDEFGH", 0, NULL),
                     MCANOPEN_OK);
    ck_assert_uint_eq(api_wire_count(wire, "607#0141424344454647"), 1);
    api_wire_answer(wire, "607#C400200000", "587#A40020007F000000");
    ck_assert_int_eq(mcanOpenWriteSDO(0, 7, 0x2000, 0,
                                      TYP_UINT64 | TYP_BLOCK | TYP_INDICATE_NO_SIZE, "ABCDEFGH", 0,
                                      NULL),
                     MCANOPEN_OK);
}
END_TEST

START_TEST(what_was_written_in_blocks_is_there)
{
    static char large[65536], value[65536];
    int len = sizeof value;

    for (size_t i = 0; i < sizeof large; i++)
        large[i] = (char)(i * 7 + i / 256);
    ck_assert_int_eq(
        mcanOpenWriteSDO(0, 5, 0x2010, 0, TYP_DOMAIN | TYP_BLOCK, large, sizeof large, NULL),
        MCANOPEN_OK);
    ck_assert_uint_eq(api_get(plant, 5, 0x2010, value, sizeof value), sizeof value);
    ck_assert_mem_eq(value, large, sizeof value);
    memset(value, 0, sizeof value);
    ck_assert_int_eq(mcanOpenReadSDO(0, 5, 0x2010, TYP_BLOCK, value, &len, NULL), MCANOPEN_OK);
    ck_assert_int_eq(len, sizeof value);
    ck_assert_mem_eq(value, large, sizeof value);
    len = sizeof value;
    ck_assert_int_eq(mcanOpenReadSDO(0, 5, 0x2002, TYP_BLOCK, value, &len, NULL), MCANOPEN_OK);
    ck_assert_int_eq(len, 2);
    api_wire_wait(wire, "605#A100", 2);
    ck_assert_uint_eq(api_wire_count(wire, "605#C610200000000100"), 1);
    ck_assert_uint_eq(api_wire_count(wire, "605#20102000"), 0);
    ck_assert_uint_eq(api_wire_count(wire, "605#40102000"), 0);
}
END_TEST

/* Of the size in the configuration, and without one of the largest. */
START_TEST(a_block_is_read)
{
    char buffer[10] = "";
    int len = sizeof buffer;

    api_wire_answer(wire, "607#A410200009", "587#C610200007000000");
    api_wire_answer(wire, "607#A300", "587#8141424344454647");
    api_wire_answer(wire, "607#A20109", "587#C11EB60000000000");
    ck_assert_int_eq(mcanOpenReadSDO(0, 7, 0x2010, 0 | TYP_BLOCK, buffer, &len, NULL), MCANOPEN_OK);
    ck_assert_int_eq(len, 7);
    ck_assert_str_eq(buffer, "ABCDEFG");
    api_wire_wait(wire, "607#A100", 1);
    api_wire_answer(wire, "608#A41020037F", "588#8010200311000906");
    ck_assert_int_eq(mcanOpenReadSDO(0, 8, 0x2010, 3 | TYP_BLOCK, buffer, &len, NULL),
                     MCAL_ABORT_DOMAIN);
}
END_TEST

/* Asked for once, and again when the node has booted. */
START_TEST(a_node_without_blocks_is_remembered)
{
    unsigned char buffer[8];
    int len = sizeof buffer;
    const int type = TYP_UINT16 | TYP_BLOCK;

    api_wire_answer(wire, "608#C600200002", "588#8000200001000405");
    api_wire_answer(wire, "608#2B002000", "588#6000200000000000");
    api_wire_answer(wire, "608#40002000", "588#4B00200041420000");
    ck_assert_int_eq(mcanOpenWriteSDO(0, 8, 0x2000, 0, type, "AB", 0, NULL), MCANOPEN_OK);
    ck_assert_int_eq(mcanOpenWriteSDO(0, 8, 0x2000, 0, type, "AB", 0, NULL), MCANOPEN_OK);
    ck_assert_int_eq(mcanOpenReadSDO(0, 8, 0x2000, TYP_BLOCK, buffer, &len, NULL), MCANOPEN_OK);
    ck_assert_uint_eq(api_wire_count(wire, "608#C6"), 1);
    ck_assert_uint_eq(api_wire_count(wire, "608#A4"), 0);
    api_wire_say(wire, "708#00");
    len = sizeof buffer; /* an answer behind that message */
    ck_assert_int_eq(mcanOpenReadSDO(0, 5, 0x1000, 0, buffer, &len, NULL), MCANOPEN_OK);
    ck_assert_int_eq(mcanOpenWriteSDO(0, 8, 0x2000, 0, type, "AB", 0, NULL), MCANOPEN_OK);
    ck_assert_uint_eq(api_wire_count(wire, "608#C6"), 2);
}
END_TEST

START_TEST(the_managers_own_dictionary_answers)
{
    unsigned char buffer[4];
    int len = sizeof buffer;
    ERROR_T error;

    ck_assert_int_eq(mcanOpenReadSDO(0, 127, 0x1F80, 0, buffer, &len, NULL), MCANOPEN_OK);
    ck_assert_int_eq(len, 4);
    ck_assert_uint_eq(buffer[0] & 1, 1);
    ck_assert_int_eq(mcanOpenReadSDO(0, 127, 0x1F80, TYP_BLOCK, buffer, &len, NULL), MCANOPEN_OK);
    ck_assert_uint_eq(buffer[0] & 1, 1);
    api_wire_wait(wire, "67F#A300", 1);
    ck_assert_int_eq(mcanOpenReadSDO(0, 127, 0x5000, 0, buffer, &len, &error), MCAL_ABORT_DOMAIN);
    expect_error(&error, 0x06020000);
    ck_assert_int_eq(mcanOpenWriteSDO(0, 127, 0x1001, 0, TYP_UINT8, "\x64", 0, &error),
                     MCAL_ABORT_DOMAIN);
    expect_error(&error, 0x06010002);
}
END_TEST

/* --- arguments that both have --- */

static const struct arguments {
    unsigned short net, node;
    int index, sub, result;
} arguments[] = {
    { 1, 5, 0x1000, 0, MCAL_NO_NET },         { 255, 5, 0x1000, 0, MCAL_NO_NET },
    { 256, 5, 0x1000, 0, MCAL_PARA_ERROR },   { 65535, 5, 0x1000, 0, MCAL_PARA_ERROR },
    { 0, 0, 0x1000, 0, MCAL_PARA_ERROR },     { 0, 128, 0x1000, 0, MCAL_PARA_ERROR },
    { 0, 65535, 0x1000, 0, MCAL_PARA_ERROR }, { 0, 5, -1, 0, MCAL_PARA_ERROR },
    { 0, 5, 0x10000, 0, MCAL_PARA_ERROR },    { 0, 5, 0x1000, -1, MCAL_PARA_ERROR },
    { 0, 5, 0x1000, 0x100, MCAL_PARA_ERROR }, { 0, 5, 0x1000, 0x500, MCAL_PARA_ERROR },
    { 0, 5, 0, 0, MCAL_ABORT_DOMAIN },        { 0, 5, 0xFFFF, 0xFF, MCAL_ABORT_DOMAIN },
};

START_TEST(arguments_out_of_range)
{
    const struct arguments *row = &arguments[_i];
    unsigned char buffer[4] = { 0 };
    int len = sizeof buffer;
    ERROR_T error = { 1, 2, 3, 4 };

    ck_assert_int_eq(
        mcanOpenReadSDO(row->net, row->node, row->index, row->sub, buffer, &len, &error),
        row->result);
    ck_assert_int_eq(len, sizeof buffer);
    if (row->result != MCAL_ABORT_DOMAIN)
        ck_assert_mem_eq(&error, &no_error, sizeof error);
    ck_assert_int_eq(
        mcanOpenWriteSDO(row->net, row->node, row->index, row->sub, TYP_UINT8, buffer, 0, &error),
        row->result);
}
END_TEST

START_TEST(missing_buffers)
{
    unsigned char buffer[4] = { 0 };
    int len = 4, negative = -1;

    ck_assert_int_eq(mcanOpenReadSDO(0, 5, 0x1000, 0, NULL, &len, NULL), MCAL_PARA_ERROR);
    ck_assert_int_eq(mcanOpenReadSDO(0, 5, 0x1000, 0, buffer, NULL, NULL), MCAL_PARA_ERROR);
    ck_assert_int_eq(mcanOpenReadSDO(0, 5, 0x1000, 0, buffer, &negative, NULL), MCAL_PARA_ERROR);
    ck_assert_int_eq(mcanOpenWriteSDO(0, 5, 0x1000, 0, TYP_UINT8, NULL, 0, NULL), MCAL_PARA_ERROR);
}
END_TEST

#define ROWS(table) (int)(sizeof(table) / sizeof *(table))

int main(void)
{
    TCase *tests = tcase_create("sdo");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_set_timeout(tests, API_LIMIT);
    tcase_add_loop_test(tests, small_values_are_read_expedited, 0, ROWS(smalls));
    tcase_add_test(tests, large_values_are_read_in_segments);
    tcase_add_test(tests, an_empty_value_is_read);
    tcase_add_test(tests, a_node_outside_the_configuration_is_read_and_written);
    tcase_add_test(tests, an_overflow_leaves_the_buffer);
    tcase_add_test(tests, an_overflow_of_unknown_size_leaves_the_length);
    tcase_add_loop_test(tests, a_node_that_breaks_the_protocol, 0, ROWS(broken));
    tcase_add_loop_test(tests, a_node_that_breaks_the_protocol_when_written, 0,
                        ROWS(broken_writes));
    tcase_add_test(tests, aborts_come_with_their_code);
    tcase_add_loop_test(tests, a_node_that_is_not_there_costs_its_time_out, 0, ROWS(silences));
    tcase_add_loop_test(tests, a_type_has_its_length_and_flags, 0, ROWS(writes));
    tcase_add_loop_test(tests, wrong_types_and_lengths_are_refused, 0, ROWS(refused));
    tcase_add_test(tests, what_was_written_is_there);
    tcase_add_test(tests, a_block_is_written);
    tcase_add_test(tests, what_was_written_in_blocks_is_there);
    tcase_add_test(tests, a_block_is_read);
    tcase_add_test(tests, a_node_without_blocks_is_remembered);
    tcase_add_test(tests, the_managers_own_dictionary_answers);
    tcase_add_loop_test(tests, arguments_out_of_range, 0, ROWS(arguments));
    tcase_add_test(tests, missing_buffers);
    return suite_run("api_sdo", tests);
}
