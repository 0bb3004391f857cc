/* SDO channels of a device besides the default one: 1201h..127Fh, and transfers on several. */
#include "slave/slave.h"

#include "support/device.h"
#include "support/suite.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>

#define OFF 0x80000000u

static const struct device_entry entries[] = {
    { 0x1003, 0, OD_UNSIGNED8, OD_RW, 0, false },
    { 0x1003, 1, OD_UNSIGNED32, OD_RO, 0, false },
    { 0x1010, 1, OD_UNSIGNED32, OD_RW, 1, false },
    { 0x1201, 0, OD_UNSIGNED8, OD_CONST, 3, false },
    { 0x1201, 1, OD_UNSIGNED32, OD_RW, OFF, false },
    { 0x1201, 2, OD_UNSIGNED32, OD_RW, OFF, false },
    { 0x1201, 3, OD_UNSIGNED8, OD_RW, 0, false },
    { 0x1203, 1, OD_UNSIGNED32, OD_RW, 0x6A0, false }, /* numbers may have gaps */
    { 0x1203, 2, OD_UNSIGNED32, OD_RW, 0x6A1, false },
    { 0x1204, 1, OD_UNSIGNED32, OD_RW, 0x200006B0, false }, /* 29 bits */
    { 0x1204, 2, OD_UNSIGNED32, OD_RW, 0x6B1, false },
    { 0x1205, 1, OD_UNSIGNED32, OD_RW, 0x6C0, false },
    { 0x1205, 2, OD_UNSIGNED32, OD_RW, 0, false }, /* would be NMT */
    { 0x1206, 1, OD_UNSIGNED32, OD_RW, 0x6D0, false },
    { 0x2000, 0, OD_UNSIGNED16, OD_RW, 0, false },
    { 0x2001, 0, OD_UNSIGNED8, OD_RW, 0, false },
    { 0x2004, 0, OD_UNSIGNED64, OD_RW, 0x33323130, false },
    { 0 },
};

static struct device device;

/* --- the linker's part: the library's allocations come here --- */

static bool no_memory; /* for much at once */

void *__real_malloc(size_t size);
void *__wrap_malloc(size_t size);

void *__wrap_malloc(size_t size)
{
    return no_memory && size >= 1024 ? NULL : __real_malloc(size);
}

/* 2010h: up to 20 bytes that the owner has. */
static void add_domain(void)
{
    const struct od_spec spec = {
        .index = 0x2010, .type = OD_DOMAIN, .access = OD_RW, .capacity = 8
    };
    struct od_entry *entry = NULL;

    ck_assert_int_eq(od_add(&device.od, &spec, &entry), CO_OK);
    od_fetch(entry, 20);
}

static void setup(void)
{
    device_init(&device, entries);
    od_find(&device.od, 0x2000, 0)->watched = true;
    add_domain();
    device_start(&device);
}

static void teardown(void)
{
    no_memory = false;
    device_done(&device);
}

/* clang-format off */
#define BOOT { 0, SENDS, "705#00" }, { 0, TELLS, "state 0" }, { 0, TELLS, "state 127" }
#define SET(at, bytes, id) { at, HEARS, "605#230112" bytes }, \
                           { at, SENDS, "585#600112" id "00000000" }
#define OPEN(at) SET(at, "01A2060000", "01"), SET(at, "02A3060000", "02"), \
                 { at, TELLS, "written 1201:01 = 1698" }, { at, TELLS, "written 1201:02 = 1699" }
#define CLOSE(at) SET(at, "01A2060080", "01"), { at, TELLS, "written 1201:01 = 2147485346" }
#define READ(at) { at, HEARS, "6A2#4001200000000000" }, { at, SENDS, "6A3#4F01200000000000" }
#define REFUSED(at, bytes, id) { at, HEARS, "605#230112" bytes }, \
                               { at, SENDS, "585#800112" id "30000906" }

static const struct device_talk talks[] = {
    { "one that its description has",
      { BOOT, { 1, HEARS, "6A0#4001200000000000" }, { 1, SENDS, "6A1#4F01200000000000" },
        { 2, HEARS, "6A0#2F01200007000000" }, { 2, SENDS, "6A1#6001200000000000" },
        { 2, TELLS, "written 2001:00 = 7" },
        { 3, HEARS, "605#4001200000000000" }, { 3, SENDS, "585#4F01200007000000" } } },
    { "descriptions that make none",
      { BOOT, { 1, HEARS, "6B0#4001200000000000" }, { 1, HEARS, "000006B0#4001200000000000" },
        { 1, HEARS, "6C0#4001200000000000" }, { 1, HEARS, "6D0#4001200000000000" },
        { 2, HEARS, "600#4001200000000000" }, { 2000, QUIET, "-" } } },
    { "there when both directions are, gone when one is",
      { BOOT, { 1, HEARS, "6A2#4001200000000000" }, SET(2, "01A2060000", "01"),
        { 3, HEARS, "6A2#4001200000000000" }, { 3, QUIET, "-" }, SET(4, "02A3060000", "02"),
        READ(4), SET(5, "02A3060080", "02"), { 6, HEARS, "6A2#4001200000000000" },
        { 7, QUIET, "-" }, SET(8, "02A4060000", "02"),
        { 9, HEARS, "6A2#4001200000000000" }, { 9, SENDS, "6A4#4F01200000000000" } } },
    { "no change while it is there, no CAN-ID of others",
      { BOOT, OPEN(1), REFUSED(2, "01A5060000", "01"), REFUSED(2, "02A5060000", "02"), READ(2),
        CLOSE(3), REFUSED(4, "0105060000", "01"), REFUSED(4, "01A0060000", "01"),
        REFUSED(4, "01A3060000", "01"), REFUSED(4, "01A5060020", "01"),
        REFUSED(4, "0100000000", "01"), REFUSED(4, "01A5160000", "01"), OPEN(5), READ(5) } },
    { "the client's node-ID is only kept",
      { BOOT, OPEN(1), { 2, HEARS, "605#2F01120309000000" }, { 2, SENDS, "585#6001120300000000" },
        READ(3) } },
    { "closing it ends its transfer silently",
      { BOOT, OPEN(1), { 2, HEARS, "6A2#4004200000000000" }, { 2, SENDS, "6A3#4104200008000000" },
        CLOSE(3), { 3, HEARS, "6A2#6000000000000000" }, { 3, QUIET, "-" }, OPEN(4),
        { 4, HEARS, "6A2#6000000000000000" }, { 4, SENDS, "6A3#8004200001000405" },
        { 3000, QUIET, "-" } } },
    { "it may close itself",
      { BOOT, OPEN(1), { 2, HEARS, "6A2#23011201A2060080" }, { 2, SENDS, "6A3#6001120100000000" },
        { 2, TELLS, "written 1201:01 = 2147485346" },
        { 3, HEARS, "6A2#4001200000000000" }, { 3000, QUIET, "-" } } },
    { "closing one does nothing to another",
      { BOOT, OPEN(1), { 2, HEARS, "6A0#4004200000000000" }, { 2, SENDS, "6A1#4104200008000000" },
        CLOSE(3), { 4, HEARS, "6A0#6000000000000000" }, { 4, SENDS, "6A1#0030313233000000" },
        { 5, HEARS, "6A0#7000000000000000" }, { 5, SENDS, "6A1#1D00000000000000" } } },
    { "transfers of three clients at a time",
      { BOOT, OPEN(1), { 2, HEARS, "6A0#4004200000000000" }, { 2, SENDS, "6A1#4104200008000000" },
        { 3, HEARS, "605#2104200008000000" }, { 3, SENDS, "585#6004200000000000" },
        { 4, HEARS, "6A2#4004200000000000" }, { 4, SENDS, "6A3#4104200008000000" },
        { 5, HEARS, "6A0#6000000000000000" }, { 5, SENDS, "6A1#0030313233000000" },
        { 6, HEARS, "605#0041424344454647" },
        { 6, SENDS, "585#2000000000000000" },
        { 7, HEARS, "605#1D48000000000000" }, { 7, SENDS, "585#3000000000000000" },
        { 7, TELLS, "written 2004:00 = 5208208757389214273" },
        { 8, HEARS, "6A2#6000000000000000" }, { 8, SENDS, "6A3#0030313233000000" }, /* as it was */
        { 9, HEARS, "6A2#7000000000000000" }, { 9, SENDS, "6A3#1D00000000000000" },
        { 10, HEARS, "6A0#7000000000000000" }, { 10, SENDS, "6A1#1D00000000000000" },
        { 11, HEARS, "6A0#4004200000000000" }, { 11, SENDS, "6A1#4104200008000000" },
        { 12, HEARS, "6A0#6000000000000000" }, { 12, SENDS, "6A1#0041424344454647" },
        { 13, HEARS, "6A0#8004200000000405" } } },
    { "each has its own time",
      { BOOT, { 1, HEARS, "6A0#4004200000000000" }, { 1, SENDS, "6A1#4104200008000000" },
        { 500, HEARS, "605#4004200000000000" }, { 500, SENDS, "585#4104200008000000" },
        { 1001, SENDS, "6A1#8004200000000405" },
        { 1500, SENDS, "585#8004200000000405" }, { 3000, QUIET, "-" } } },
    { "two values of one entry wait for verdicts, the last one counts",
      { BOOT, { 1, HEARS, "605#2B00200011110000" }, { 1, TELLS, "verdict 1 on 2000:00, 2 bytes" },
        { 2, HEARS, "6A0#2B00200022220000" },
        { 2, TELLS, "verdict 1 on 2000:00, 2 bytes, channel 2" },
        { 3, DOES, "verdict 2 0 at 2" }, { 3, DOES, "verdict 1 0 at 1" },
        { 3, DOES, "verdict 1 0 at 6" }, { 3, DOES, "verdict 1 0 at 255" }, { 3, QUIET, "-" },
        { 4, DOES, "verdict 1 0 at 2" }, { 4, SENDS, "6A1#6000200000000000" },
        { 4, TELLS, "written 2000:00 = 8738" },
        { 5, HEARS, "605#4001200000000000" }, { 5, SENDS, "585#4F01200000000000" },
        { 6, HEARS, "605#2B00200033330000" }, { 6, TELLS, "verdict 2 on 2000:00, 2 bytes" },
        { 7, DOES, "verdict 2 0" }, { 7, SENDS, "585#6000200000000000" },
        { 7, TELLS, "written 2000:00 = 13107" },
        { 8, HEARS, "6A0#4000200000000000" }, { 8, SENDS, "6A1#4B00200033330000" } } },
    { "one verdict is late, the other one is not",
      { BOOT, { 1, HEARS, "6A0#2B00200022220000" },
        { 1, TELLS, "verdict 1 on 2000:00, 2 bytes, channel 2" },
        { 500, HEARS, "605#2B00200011110000" }, { 500, TELLS, "verdict 1 on 2000:00, 2 bytes" },
        { 1001, SENDS, "6A1#8000200020000008" }, { 1001, TELLS, "no verdict on 2000:00" },
        { 1002, DOES, "verdict 1 0 at 2" }, { 1003, DOES, "verdict 1 06090031" },
        { 1003, SENDS, "585#8000200031000906" } } },
    { "closed while it waits for a verdict",
      { BOOT, OPEN(1), { 2, HEARS, "6A2#2B00200022220000" },
        { 2, TELLS, "verdict 1 on 2000:00, 2 bytes, channel 1" }, CLOSE(3),
        { 4, DOES, "verdict 1 0 at 1" }, OPEN(5), { 6, DOES, "verdict 1 0 at 1" },
        { 6, HEARS, "6A2#4000200000000000" }, { 6, SENDS, "6A3#4B00200000000000" },
        { 3000, QUIET, "-" } } },
    { "a value that the owner has",
      { BOOT, { 1, HEARS, "6A0#4010200000000000" },
        { 1, TELLS, "fetch 1 of 2010:00, channel 2" }, { 2, QUIET, "-" },
        { 2, DOES, "give 2 9 at 2" }, { 2, DOES, "give 1 9" }, { 2, DOES, "verdict 1 0 at 2" },
        { 2, QUIET, "-" }, { 3, DOES, "give 1 9 at 2" }, { 3, SENDS, "6A1#4110200009000000" },
        { 3, DOES, "give 1 8 at 2" }, { 4, HEARS, "6A0#6000000000000000" },
        { 4, SENDS, "6A1#0041424344454647" }, { 5, HEARS, "6A0#7000000000000000" },
        { 5, SENDS, "6A1#1B48490000000000" }, { 5, DOES, "give 1 9 at 2" } } },
    { "few bytes, none, and too many",
      { BOOT, { 1, HEARS, "605#4010200000000000" }, { 1, DOES, "give 1 3" },
        { 1, SENDS, "585#4710200041424300" },
        { 2, HEARS, "605#4010200000000000" }, { 2, DOES, "give 2 0" },
        { 2, SENDS, "585#4110200000000000" }, { 3, HEARS, "605#6000000000000000" },
        { 3, SENDS, "585#0F00000000000000" },
        { 4, HEARS, "605#4010200000000000" }, { 4, DOES, "refuse 3 08000024" },
        { 4, SENDS, "585#8010200024000008" },
        { 5, HEARS, "605#4010200000000000" }, { 5, DOES, "give 4 1388" },
        { 5, SENDS, "585#8010200005000405" } } },
    { "the owner comes too late with it",
      { BOOT, { 1, HEARS, "605#4010200000000000" }, { 1, TELLS, "fetch 1 of 2010:00, channel 0" },
        { 1001, SENDS, "585#8010200020000008" }, { 1001, TELLS, "no verdict on 2010:00" },
        { 1002, DOES, "give 1 9" }, { 3000, QUIET, "-" } } },
    { "the client has gone on",
      { BOOT, { 1, HEARS, "605#4010200000000000" }, { 2, HEARS, "605#4001200000000000" },
        { 2, SENDS, "585#4F01200000000000" }, { 3, DOES, "give 1 9" },
        { 4, HEARS, "605#4010200000000000" }, { 5, HEARS, "605#4010200000000000" },
        { 6, DOES, "give 2 9" }, { 6, QUIET, "-" }, { 7, DOES, "give 3 1" },
        { 7, SENDS, "585#4F10200041000000" } } },
    { "a value for the owner to store",
      { BOOT, { 1, HEARS, "605#2310200041424344" }, { 1, TELLS, "verdict 1 on 2010:00, 4 bytes" },
        { 2, DOES, "give 1 4" }, { 2, QUIET, "-" }, { 2, DOES, "verdict 1 0" },
        { 2, SENDS, "585#6010200000000000" }, { 2, TELLS, "written 2010:00 = 1145258561" },
        { 3, HEARS, "605#2310200041424344" }, { 3, TELLS, "verdict 2 on 2010:00, 4 bytes" },
        { 4, DOES, "verdict 2 06060000" }, { 4, SENDS, "585#8010200000000606" },
        { 5, HEARS, "605#2110200015000000" }, { 5, SENDS, "585#8010200012000706" },
        { 6, HEARS, "605#4010200000000000" }, { 6, TELLS, "fetch 3 of 2010:00, channel 0" },
        { 6, DOES, "refuse 3 06060000" }, { 6, SENDS, "585#8010200000000606" } } },
    { "stopped",
      { BOOT, OPEN(1), { 2, HEARS, "6A2#4004200000000000" }, { 2, SENDS, "6A3#4104200008000000" },
        { 3, HEARS, "000#0205" }, { 3, TELLS, "state 4" },
        { 4, HEARS, "6A2#4001200000000000" }, { 4, HEARS, "6A0#4001200000000000" },
        { 2000, QUIET, "-" }, { 2000, HEARS, "000#8005" },
        { 2001, HEARS, "6A2#6000000000000000" }, { 2001, SENDS, "6A3#8004200001000405" } } },
    { "a reset of the communication brings the power-on values back",
      { BOOT, OPEN(1), { 2, HEARS, "000#8205" }, { 2, SENDS, "705#00" },
        { 3, HEARS, "6A2#4001200000000000" }, { 4, QUIET, "-" },
        { 4, HEARS, "6A0#4001200000000000" }, { 4, SENDS, "6A1#4F01200000000000" } } },
    { "what is stored stays",
      { BOOT, OPEN(1), { 2, HEARS, "605#2310100173617665" }, { 2, SENDS, "585#6010100100000000" },
        { 2, HEARS, "000#8105" }, { 2, SENDS, "705#00" }, READ(3) } },
    { "frames that are no requests",
      { BOOT, { 1, HEARS, "6A0#40012000" }, { 1, HEARS, "6A0#R8" },
        { 1, HEARS, "000006A0#4001200000000000" }, { 1, ECHOES, "6A0#4001200000000000" },
        { 1, HEARS, "6A1#4001200000000000" }, { 3000, QUIET, "-" } } },
    { "block transfers on two channels",
      { BOOT, { 1, HEARS, "6A0#A404200004000000" }, { 1, SENDS, "6A1#C604200008000000" },
        { 2, HEARS, "605#C604200008000000" }, { 2, SENDS, "585#A40420007F000000" },
        { 3, HEARS, "6A0#A300000000000000" }, { 3, SENDS, "6A1#0130313233000000" },
        { 3, SENDS, "6A1#8200000000000000" }, { 4, HEARS, "605#0141424344454647" },
        { 5, HEARS, "6A0#A202040000000000" }, { 5, SENDS, "6A1#D9C0E10000000000" },
        { 6, HEARS, "605#8248000000000000" }, { 6, SENDS, "585#A2027F0000000000" },
        { 7, HEARS, "6A0#A100000000000000" },
        { 8, HEARS, "605#D9D1100000000000" }, { 8, SENDS, "585#A100000000000000" },
        { 8, TELLS, "written 2004:00 = 5208208757389214273" } } },
    { "a segment that looks like a request for an error",
      { BOOT, { 1, HEARS, "605#C010200000000000" }, { 1, SENDS, "585#A41020007F000000" },
        { 2, HEARS, "605#4003100100000000" }, { 3, QUIET, "-" },
        { 3, HEARS, "605#8010200000000000" } } },
    { "errors that there are not",
      { BOOT, { 1, HEARS, "6A0#4003100100000000" }, { 1, SENDS, "6A1#8003100124000008" },
        { 2, HEARS, "6A0#A403100104000000" }, { 2, SENDS, "6A1#8003100124000008" },
        { 3, HEARS, "6A0#4003100000000000" }, { 3, SENDS, "6A1#4F03100000000000" } } },
};
/* clang-format on */

#define TALKS ((int)(sizeof talks / sizeof talks[0]))

START_TEST(conversation)
{
    device_talk(&device, &talks[_i]);
}
END_TEST

static unsigned count_filter(uint32_t id)
{
    struct slave_filter filters[16];
    const unsigned count = slave_listens(&device.slave, filters, 16);
    unsigned found = 0;

    ck_assert_uint_le(count, 16);
    for (unsigned i = 0; i < count; i++)
        found += filters[i].id == id && !filters[i].ext && !filters[i].rtr;
    return found;
}

START_TEST(what_it_listens_to)
{
    unsigned generation = device.slave.listen_generation;

    ck_assert_uint_eq(count_filter(0x605), 1);
    ck_assert_uint_eq(count_filter(0x6A0), 1);
    ck_assert_uint_eq(slave_listens(&device.slave, NULL, 0), 4); /* NMT and guarding besides */
    ck_assert_uint_eq(device_write(&device, 0x1201, 1, 4, 0x6A2), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x1201, 3, 1, 9), SDO_OK);
    ck_assert_uint_eq(device.slave.listen_generation, generation);
    ck_assert_uint_eq(device_write(&device, 0x1201, 2, 4, 0x6A3), SDO_OK);
    ck_assert_uint_ne(device.slave.listen_generation, generation);
    ck_assert_uint_eq(count_filter(0x6A2), 1);
    generation = device.slave.listen_generation;
    ck_assert_uint_eq(device_write(&device, 0x1203, 1, 4, OFF | 0x6A0), SDO_OK);
    ck_assert_uint_ne(device.slave.listen_generation, generation);
    ck_assert_uint_eq(count_filter(0x6A0), 0);
    generation = device.slave.listen_generation;
    device_hear(&device, "000#8205");
    ck_assert_uint_ne(device.slave.listen_generation, generation);
    ck_assert_uint_eq(count_filter(0x6A0), 1);
    ck_assert_uint_eq(count_filter(0x6A2), 0);
}
END_TEST

static const struct sdo_server *server(unsigned channel)
{
    ck_assert_uint_lt(channel, device.slave.channel_count);
    return &device.slave.channels[channel].server;
}

static void expect_answer(const char *request, const char *answer)
{
    device_forget(&device);
    device_hear(&device, request);
    device_drain(&device);
    ck_assert_str_eq(device_next_frame(&device, NULL), answer);
    ck_assert_str_eq(device_next_frame(&device, NULL), "");
}

/* What nobody uses costs nothing. */
START_TEST(a_buffer_comes_with_the_first_request)
{
    ck_assert_ptr_nonnull(server(0)->buffer);
    ck_assert_ptr_null(server(1)->buffer);
    ck_assert_ptr_null(server(2)->buffer);
    expect_answer("6A0#4001200000000000", "6A1#4F01200000000000");
    ck_assert_ptr_nonnull(server(2)->buffer);
    ck_assert_uint_eq(server(2)->capacity, device.slave.buffer_size);
    ck_assert_uint_eq(device_write(&device, 0x1203, 1, 4, OFF), SDO_OK);
    ck_assert_ptr_null(server(2)->buffer);
}
END_TEST

START_TEST(a_buffer_that_there_is_not)
{
    no_memory = true;
    expect_answer("6A0#4001200000000000", "6A1#8001200005000405");
    expect_answer("6A0#4004200000000000", "6A1#8004200005000405");
    expect_answer("6A0#2F01200007000000", "6A1#8001200005000405");
    expect_answer("6A0#2104200008000000", "6A1#8004200005000405");
    expect_answer("605#4004200000000000", "585#4104200008000000");
    no_memory = false;
    expect_answer("6A0#4004200000000000", "6A1#4104200008000000");
}
END_TEST

START_TEST(blocks_can_be_left_to_others)
{
    slave_serve_blocks(&device.slave, false);
    expect_answer("6A0#A404200004000000", "6A1#8004200001000405");
    expect_answer("605#C604200008000000", "585#8004200001000405");
    slave_serve_blocks(&device.slave, true);
    expect_answer("6A0#A404200004000000", "6A1#C604200008000000");
}
END_TEST

/* As many segments as there is room for, and the rest when there is again. */
START_TEST(a_block_with_little_room)
{
    device_hear(&device, "605#A410200020000000");
    device_do(&device, "give 1 14");
    device_drain(&device);
    device_fill(&device, 2, 2);
    device_hear(&device, "605#A300000000000000");
    ck_assert_uint_eq(slave_deadline(&device.slave), 0);
    device_drain(&device);
    device_forget(&device);
    device_run(&device, device.now);
    ck_assert_str_eq(device_next_frame(&device, NULL), "585#834F505152535400");
    ck_assert_str_eq(device_next_frame(&device, NULL), "");
}
END_TEST

/* Whatever asks: a full outbox is told with a counter, and the transfer goes on. */
START_TEST(without_room)
{
    expect_answer("6A0#4004200000000000", "6A1#4104200008000000");
    device_fill(&device, 0, 4);
    device_hear(&device, "6A0#6000000000000000");
    device_drain(&device);
    ck_assert_uint_eq(server(2)->dropped, 1);
    ck_assert_uint_eq(server(0)->dropped, 0);
    expect_answer("6A0#6000000000000000", "6A1#0030313233000000");
}
END_TEST

/* No reset, and no 1010h, does anything to what the owner has. */
START_TEST(resets_leave_the_owner_its_value)
{
    const struct od_entry *entry = od_find(&device.od, 0x2010, 0);
    uint8_t memory[4] = { 1, 2, 3, 4 };

    ck_assert_uint_eq(device_write(&device, 0x1010, 1, 4, 0x65766173), SDO_OK);
    device_hear(&device, "000#8105");
    device_drain(&device);
    ck_assert(entry->fetched);
    ck_assert_uint_eq(entry->capacity, 20);
    ck_assert_uint_eq(entry->size, 0);
    ck_assert_int_eq(od_refer(od_find(&device.od, 0x2010, 0), memory, 3, 4, true), CO_OK);
    expect_answer("6A0#4010200000000000", "6A1#4710200001020300");
}
END_TEST

/* The owner's answer finds no room in the outbox: it comes later. */
START_TEST(a_value_without_room)
{
    device_hear(&device, "605#4010200000000000");
    device_drain(&device);
    device_forget(&device);
    device_fill(&device, 0, 0);
    device_do(&device, "give 1 3");
    ck_assert_uint_eq(slave_deadline(&device.slave), 0);
    device_run(&device, device.now);
    ck_assert_str_eq(device_next_frame(&device, NULL), "585#4710200041424300");
}
END_TEST

/* A device with all of them. */
START_TEST(as_many_as_there_can_be)
{
    struct device other;
    struct od od;

    od_init(&od);
    for (uint16_t i = 1; i <= 0x7F; i++)
        for (uint8_t sub = 1; sub <= 2; sub++)
            ck_assert_int_eq(od_add_number(&od, (uint16_t)(0x1200 + i), sub, OD_UNSIGNED32, OD_RW,
                                           (sub == 1 ? 0x200u : 0x280u) + i),
                             CO_OK);
    device_init_od(&other, &od);
    device_start(&other);
    ck_assert_uint_eq(other.slave.channel_count, 128);
    for (unsigned i = 1; i <= 0x7F; i++) {
        char request[32], answer[32];

        snprintf(request, sizeof request, "%03X#4000100000000000", 0x200 + i);
        snprintf(answer, sizeof answer, "%03X#4300100000000000", 0x280 + i);
        device_forget(&other);
        device_hear(&other, request);
        device_drain(&other);
        ck_assert_str_eq(device_next_frame(&other, NULL), answer);
    }
    device_done(&other);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("slave_servers");

    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_loop_test(tcase, conversation, 0, TALKS);
    tcase_add_test(tcase, what_it_listens_to);
    tcase_add_test(tcase, a_buffer_comes_with_the_first_request);
    tcase_add_test(tcase, a_buffer_that_there_is_not);
    tcase_add_test(tcase, blocks_can_be_left_to_others);
    tcase_add_test(tcase, a_block_with_little_room);
    tcase_add_test(tcase, without_room);
    tcase_add_test(tcase, resets_leave_the_owner_its_value);
    tcase_add_test(tcase, a_value_without_room);
    tcase_add_test(tcase, as_many_as_there_can_be);
    return suite_run("slave_servers", tcase);
}
