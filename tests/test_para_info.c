#include "paraInfo.h"

#include "mcanopen.h"

#include <check.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static const struct {
    const char *name;
    const char *const *texts;
} tables[] = {
    { "c", cParaInfo },     { "uc", ucParaInfo },   { "s", sParaInfo }, { "us", usParaInfo },
    { "i", iParaInfo },     { "ui", uiParaInfo },   { "l", lParaInfo }, { "ul", ulParaInfo },
    { "w", writeParaInfo }, { "str", strParaInfo },
};

START_TEST(every_entry_is_plain_text)
{
    for (size_t i = 0; i < PARA_INFO_SIZE; i++) {
        const char *text = tables[_i].texts[i];

        ck_assert_msg(text && text[0], "%s %zu is empty", tables[_i].name, i);
        ck_assert_msg(!strpbrk(text, "%\n\r\t"), "%s %zu: \"%s\"", tables[_i].name, i, text);
        ck_assert_msg(strlen(text) < 64, "%s %zu is long", tables[_i].name, i);
    }
}
END_TEST

/* Each message of the header has a text of its own at its number, and nothing else has. */
START_TEST(known_messages_are_at_their_numbers)
{
    static const struct {
        const char *const *texts;
        size_t last;
        size_t other;
    } known[] = {
        { cParaInfo, MCANOPEN_MSG_BOOT_ERROR, 0 },
        { ucParaInfo, MCANOPEN_MSG_BUS_BUSY, 0 },
        { sParaInfo, 0, 0 },
        { usParaInfo, MCANOPEN_MSG_GUARDING_BACK, 0 },
        { iParaInfo, MCANOPEN_MSG_BUS_STATE, MCANOPEN_MSG_GUARDING_TOGGLE },
        { uiParaInfo, 0, 0 },
        { lParaInfo, 0, 0 },
        { ulParaInfo, MCANOPEN_MSG_CONFIGURED, 0 },
        { writeParaInfo, MCANOPEN_MSG_OBJECT_WRITTEN, 0 },
        { strParaInfo, MCANOPEN_MSG_TEXT, 0 },
    };

    for (size_t i = 0; i < PARA_INFO_SIZE; i++) {
        bool is_known = (i > 0 && i <= known[_i].last) || (i > 0 && i == known[_i].other);
        bool has_text = strcmp(known[_i].texts[i], "unknown message") != 0;

        ck_assert_msg(is_known == has_text, "table %d, message %zu: %s", _i, i, known[_i].texts[i]);
    }
}
END_TEST

/* ---- mcanOpenEventText --------------------------------------------------------------------- */

/* An event of node 5 on net 1; the value of para follows. */
#define EVENT(flags, message, ...)                                                                 \
    {                                                                                              \
        (long)((flags) | (message)), 1, 5,                                                         \
        {                                                                                          \
            __VA_ARGS__                                                                            \
        }                                                                                          \
    }

static const struct {
    EVENT_T event;
    const char *text;
} lines[] = {
    /* the example of the manual, 0x00001022 */
    { { 0x1022, 1, 5, { .i = 2 } }, "Net: 1 Node: 5 guarding toggle error no 2" },
    { EVENT(PARA_C, MCANOPEN_MSG_BOOT_ERROR, .c = 'D'),
      "Net: 1 Node: 5 boot error D: vendor-ID differs" },
    { EVENT(PARA_C, MCANOPEN_MSG_BOOT_ERROR, .c = 'A'),
      "Net: 1 Node: 5 boot error A: not in the network list" },
    { EVENT(PARA_C, MCANOPEN_MSG_BOOT_ERROR, .c = 'O'),
      "Net: 1 Node: 5 boot error O: serial number differs" },
    { EVENT(PARA_C, MCANOPEN_MSG_BOOT_ERROR, .c = 'P'),
      "Net: 1 Node: 5 boot error P: unknown letter" },
    { EVENT(PARA_C, MCANOPEN_MSG_BOOT_ERROR, .c = '\n'),
      "Net: 1 Node: 5 boot error 10: unknown letter" },
    { EVENT(PARA_UC, MCANOPEN_MSG_NODE_STATE, .uc = 0), "Net: 1 Node: 5 NMT state 0 (offline)" },
    { EVENT(PARA_UC, MCANOPEN_MSG_NODE_STATE, .uc = 4), "Net: 1 Node: 5 NMT state 4 (stopped)" },
    { EVENT(PARA_UC, MCANOPEN_MSG_NODE_STARTED, .uc = 5),
      "Net: 1 Node: 5 started, state 5 (operational)" },
    { EVENT(PARA_UC, MCANOPEN_MSG_MANAGER_STATE, .uc = 127),
      "Net: 1 Node: 5 manager, state 127 (pre-operational)" },
    { EVENT(PARA_UC, MCANOPEN_MSG_NODE_STATE, .uc = 6),
      "Net: 1 Node: 5 NMT state 6 (not of CiA 301)" },
    { EVENT(PARA_UC, MCANOPEN_MSG_BOOT_UP, .uc = 0), "Net: 1 Node: 5 boot-up message" },
    { EVENT(PARA_UC | NOD_NOT_VAL, MCANOPEN_MSG_NETWORK_UP, .uc = 12),
      "Net: 1 network is up, booted nodes: 12" },
    { EVENT(PARA_UC, MCANOPEN_MSG_NODE_BOOTED, .uc = 0), "Net: 1 Node: 5 booted" },
    { EVENT(PARA_UC, MCANOPEN_MSG_NODE_BOOTED, .uc = 'L'),
      "Net: 1 Node: 5 booted, was operational already" },
    { EVENT(PARA_UC, 255, .uc = 255), "Net: 1 Node: 5 unknown message 255" },
    { EVENT(PARA_S, 7, .s = -32768), "Net: 1 Node: 5 unknown message -32768" },
    { EVENT(PARA_US, MCANOPEN_MSG_HEARTBEAT_LOST, .us = 65535),
      "Net: 1 Node: 5 heartbeat lost, consumer time in ms: 65535" },
    { EVENT(PARA_US, MCANOPEN_MSG_HEARTBEAT_BACK, .us = 300),
      "Net: 1 Node: 5 heartbeat is back, consumer time in ms: 300" },
    { EVENT(PARA_US | NOD_NOT_VAL, MCANOPEN_MSG_BOOT_TIME_OVER, .us = 20000),
      "Net: 1 mandatory nodes are missing, Boot_Time over, ms: 20000" },
    { EVENT(PARA_I | NOD_NOT_VAL, MCANOPEN_MSG_BUS_STATE, .i = MCANOPEN_BUS_OFF),
      "Net: 1 CAN bus state 3 (bus-off)" },
    { EVENT(PARA_I | NOD_NOT_VAL, MCANOPEN_MSG_BUS_STATE, .i = MCANOPEN_BUS_DOWN),
      "Net: 1 CAN bus state 4 (interface down)" },
    { EVENT(PARA_I | NOD_NOT_VAL, MCANOPEN_MSG_BUS_STATE, .i = 5),
      "Net: 1 CAN bus state 5 (unknown)" },
    { EVENT(PARA_I | NOD_NOT_VAL, MCANOPEN_MSG_BUS_STATE, .i = -1),
      "Net: 1 CAN bus state -1 (unknown)" },
    { EVENT(PARA_UI, 0, .ui = 4294967295U), "Net: 1 Node: 5 unknown message 4294967295" },
    { EVENT(PARA_L, 1, .l = -5), "Net: 1 Node: 5 unknown message -5" },
    { EVENT(PARA_UL, MCANOPEN_MSG_EMERGENCY, .ul = 0x118130),
      "Net: 1 Node: 5 emergency: error code 8130h, error register 11h" },
    { EVENT(PARA_UL | NET_NOT_VAL | NOD_NOT_VAL, MCANOPEN_MSG_EVENTS_LOST, .ul = 4294967295U),
      "events lost, not fetched in time: 4294967295" },
    { EVENT(PARA_UL | NOD_NOT_VAL, MCANOPEN_MSG_FRAMES_LOST, .ul = 3),
      "Net: 1 CAN frames lost: 3" },
    { EVENT(PARA_UL | NOD_NOT_VAL, MCANOPEN_MSG_FRAMES_UNSENT, .ul = 1024),
      "Net: 1 CAN frames not sent in time: 1024" },
    { EVENT(PARA_WRITE, MCANOPEN_MSG_CONFIGURATION_ABORTED, .write = { 0x1017, 0, { 6, 1, 0, 2 } }),
      "Net: 1 Node: 5 configuration aborted at 1017h:00, abort code 06010002h"
      " (object is read-only)" },
    { EVENT(PARA_WRITE, MCANOPEN_MSG_BOOT_READ_ABORTED,
            .write = { 0xFFFF, 0xFF, { 0xFF, 0xFF, 0xFF, 0xFF } }),
      "Net: 1 Node: 5 read during boot aborted at FFFFh:FF, abort code FFFFFFFFh"
      " (unknown abort code)" },
    { EVENT(PARA_WRITE, MCANOPEN_MSG_SOFTWARE_UPDATE_ABORTED,
            .write = { 0x1F51, 1, { 6, 6, 0, 0 } }),
      "Net: 1 Node: 5 software update aborted at 1F51h:01, abort code 06060000h"
      " (access failed because of a hardware error)" },
    { EVENT(PARA_STR | NOD_NOT_VAL, MCANOPEN_MSG_TEXT, .str = "two\nlines"),
      "Net: 1 message: two lines" },
};

START_TEST(event_is_one_line)
{
    char text[MCANOPEN_EVENT_TEXT_SIZE];

    ck_assert_int_eq(mcanOpenEventText(&lines[_i].event, text, sizeof text), MCANOPEN_OK);
    ck_assert_str_eq(text, lines[_i].text);
}
END_TEST

/* With any size: the beginning of the text, its end, and nothing behind it. */
START_TEST(event_is_cut_to_the_buffer)
{
    const char *whole = lines[_i].text;
    int needed = (int)strlen(whole) + 1;

    for (int size = 1; size <= needed; size++) {
        char *text = malloc((size_t)size); /* to the byte, so that sanitizers see one more */

        ck_assert_ptr_nonnull(text);
        memset(text, 'x', (size_t)size);
        ck_assert_int_eq(mcanOpenEventText(&lines[_i].event, text, size),
                         size < needed ? MCAL_BUFFER_OVERFLOW : MCANOPEN_OK);
        ck_assert_uint_eq(strlen(text), (size_t)size - 1);
        ck_assert_int_eq(strncmp(text, whole, (size_t)size - 1), 0);
        free(text);
    }
}
END_TEST

START_TEST(string_without_end_stays_within_the_event)
{
    EVENT_T event = { .event = (long)(PARA_STR | MCANOPEN_MSG_TEXT), .net = 1, .node = 5 };
    char text[MCANOPEN_EVENT_TEXT_SIZE];

    memset(event.para.str, 'y', sizeof event.para.str);
    ck_assert_int_eq(mcanOpenEventText(&event, text, sizeof text), MCANOPEN_OK);
    ck_assert_uint_eq(strspn(text + strlen("Net: 1 Node: 5 message: "), "y"), 64);
    ck_assert_uint_eq(strlen(text), strlen("Net: 1 Node: 5 message: ") + 64);
}
END_TEST

START_TEST(longest_event_fits_the_size_of_the_header)
{
    static const unsigned long kinds[] = { PARA_C,  PARA_UC, PARA_S,  PARA_US,    PARA_I,
                                           PARA_UI, PARA_L,  PARA_UL, PARA_WRITE, PARA_STR };
    EVENT_T event = { .net = -2147483647 - 1, .node = -2147483647 - 1 };
    char text[MCANOPEN_EVENT_TEXT_SIZE];

    memset(&event.para, 0xC7, sizeof event.para);
    for (unsigned message = 0; message < PARA_INFO_SIZE; message++) {
        event.event = (long)(kinds[_i] | message);
        ck_assert_int_eq(mcanOpenEventText(&event, text, sizeof text), MCANOPEN_OK);
    }
}
END_TEST

START_TEST(wrong_arguments)
{
    EVENT_T event = { .event = (long)PARA_I };
    char text[8] = "before";

    ck_assert_int_eq(mcanOpenEventText(&event, NULL, 8), MCAL_PARA_ERROR);
    ck_assert_int_eq(mcanOpenEventText(&event, text, 0), MCAL_PARA_ERROR);
    ck_assert_int_eq(mcanOpenEventText(&event, text, -1), MCAL_PARA_ERROR);
    ck_assert_str_eq(text, "before");
    ck_assert_int_eq(mcanOpenEventText(NULL, text, sizeof text), MCAL_PARA_ERROR);
    ck_assert_str_eq(text, "");
}
END_TEST

/* No member, two members, bits of PARA without a member. */
START_TEST(wrong_flags)
{
    static const unsigned long flags[] = {
        0,          NET_NOT_VAL | NOD_NOT_VAL, PARA_C | PARA_UC, PARA, PARA_STR << 1,
        0x20000000, PARA_I | 0x20000000
    };
    char text[MCANOPEN_EVENT_TEXT_SIZE] = "before";

    for (size_t i = 0; i < COUNT(flags); i++) {
        EVENT_T event = { .event = (long)flags[i] };

        text[0] = 'b';
        ck_assert_int_eq(mcanOpenEventText(&event, text, sizeof text), MCAL_PARA_ERROR);
        ck_assert_str_eq(text, "");
    }
}
END_TEST

/* A long of 64 bits may come sign-extended from a program that went through an int. */
START_TEST(sign_extended_event)
{
    EVENT_T event = { .event = -2147483647L - 1, .node = 3, .para = { .i = 7 } };
    char text[MCANOPEN_EVENT_TEXT_SIZE];

    event.event += (long)PARA_I;
    ck_assert_int_eq(mcanOpenEventText(&event, text, sizeof text), MCANOPEN_OK);
    ck_assert_str_eq(text, "Node: 3 unknown message 7");
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("para_info");
    TCase *texts = tcase_create("tables");
    TCase *events = tcase_create("events");
    SRunner *runner = srunner_create(suite);
    int failed;

    tcase_add_loop_test(texts, every_entry_is_plain_text, 0, (int)COUNT(tables));
    tcase_add_loop_test(texts, known_messages_are_at_their_numbers, 0, (int)COUNT(tables));
    suite_add_tcase(suite, texts);
    tcase_add_loop_test(events, event_is_one_line, 0, (int)COUNT(lines));
    tcase_add_loop_test(events, event_is_cut_to_the_buffer, 0, (int)COUNT(lines));
    tcase_add_loop_test(events, longest_event_fits_the_size_of_the_header, 0, 10);
    tcase_add_test(events, string_without_end_stays_within_the_event);
    tcase_add_test(events, wrong_arguments);
    tcase_add_test(events, wrong_flags);
    tcase_add_test(events, sign_extended_event);
    suite_add_tcase(suite, events);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}
