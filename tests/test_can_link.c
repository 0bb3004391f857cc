/* Messages of rtnetlink: real ones from records, hand-made ones, damaged ones. */
#include "port/can_link.h"

#include "support/guard.h"
#include "support/link_message.h"
#include "support/suite.h"

#include <errno.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <stdio.h>
#include <string.h>

#define LENGTH(array) ((int)(sizeof(array) / sizeof((array)[0])))

static uint8_t data[CAN_LINK_MESSAGE_MAX];

/* "is NAME INDEX up|down can|vcan|other BITRATE RESTART QUEUE STATE", one after the other. */
static const char *news_text(const uint8_t *bytes, size_t size, char *text, size_t room)
{
    static const char *const types[] = { "is", "gone", "refused" };
    struct can_link_reader reader = { bytes, size };
    struct can_link_news news;
    size_t used = 0;

    text[0] = '\0';
    while (can_link_next(&reader, &news) && used < room) {
        const struct can_link *link = &news.link;

        used += (size_t)snprintf(text + used, room - used, "%s%s", used > 0 ? "; " : "",
                                 types[news.type]);
        if (news.type == CAN_LINK_REFUSED)
            used += (size_t)snprintf(text + used, room - used, " %d", news.error);
        else
            used += (size_t)snprintf(text + used, room - used, " %s %d %s %s %u %u %u %d",
                                     link->name, link->index, link->is_up ? "up" : "down",
                                     !link->is_can         ? "other"
                                     : link->is_controller ? "can"
                                                           : "vcan",
                                     link->bitrate, link->restart_ms, link->queue_length,
                                     (int)link->controller);
    }
    return text;
}

/* --- records --- */

static const struct {
    const char *file, *title, *news;
} records[] = {
    { "vcan.txt", "request for vcan9", "refused 19" },
    { "vcan.txt", "ip link add vcan9 type vcan", "is vcan9 3 down vcan 0 0 1000 0" },
    { "vcan.txt", "ip link set vcan9 up", "is vcan9 3 up vcan 0 0 1000 0" },
    { "vcan.txt", "ip link set vcan9 down", "is vcan9 3 down vcan 0 0 1000 0" },
    { "vcan.txt", "ip link set vcan9 txqueuelen 10", "is vcan9 3 down vcan 0 0 10 0" },
    { "vcan.txt", "ip link set vcan9 name vcan8", "is vcan8 3 down vcan 0 0 10 0" },
    { "vcan.txt", "ip link set vcan8 name vcan9", "is vcan9 3 down vcan 0 0 10 0" },
    { "vcan.txt", "ip link set vcan9 up", "is vcan9 3 up vcan 0 0 10 0" },
    { "vcan.txt", "ip link set lo down", "is lo 1 down other 0 0 1000 0" },
    { "vcan.txt", "ip link del vcan9",
      "is vcan9 3 down vcan 0 0 10 0; gone vcan9 3 down vcan 0 0 10 0" },
    { "vcan.txt", "ip link add vcan9 type vcan && ip link set vcan9 up",
      "is vcan9 4 down vcan 0 0 1000 0; is vcan9 4 up vcan 0 0 1000 0" },
    { "vcan.txt", "request for vcan9", "is vcan9 4 up vcan 0 0 1000 0" },
    { "slcan.txt", "ip link set can0 up",
      "is can0 3 up can 500000 0 10 0; is can0 3 up can 500000 0 10 0" },
    { "slcan.txt", "the controller goes bus-off", "is can0 3 up can 500000 0 10 3" },
    { "slcan.txt", "ip link set can0 down", "is can0 3 down can 500000 0 10 0" },
    { "slcan.txt", "ip link set can0 up",
      "is can0 3 up can 500000 0 10 0; is can0 3 up can 500000 0 10 0" },
    { "slcan.txt", "request for can0", "is can0 3 up can 500000 0 10 0" },
};

START_TEST(test_records)
{
    unsigned number = 0;
    char title[80], text[1000];
    size_t size;

    for (int i = _i; i > 0 && strcmp(records[i - 1].file, records[_i].file) == 0; i--)
        number++;
    size = link_record(records[_i].file, number, title, data);
    ck_assert_uint_ne(size, SIZE_MAX);
    ck_assert_str_eq(title, records[_i].title);
    ck_assert_str_eq(news_text(data, size, text, sizeof text), records[_i].news);
}
END_TEST

START_TEST(test_all_records_are_looked_at)
{
    const char *files[] = { "vcan.txt", "slcan.txt" };
    char title[80];
    int count = 0;

    for (unsigned i = 0; i < 2; i++) {
        for (unsigned n = 0; link_record(files[i], n, title, data) != SIZE_MAX; n++)
            count++;
    }
    ck_assert_int_eq(count, LENGTH(records));
}
END_TEST

/* --- hand-made ones: what slcan and vcan do not have --- */

static const struct {
    struct can_link link;
    const char *news;
} states[] = {
    { { "can0", 3, true, true, true, 125000, 100, 10, BUS_ACTIVE }, "125000 100 10 0" },
    { { "can0", 3, true, true, true, 125000, 100, 10, BUS_WARNING }, "125000 100 10 1" },
    { { "can0", 3, true, true, true, 125000, 100, 10, BUS_PASSIVE }, "125000 100 10 2" },
    { { "can0", 3, true, true, true, 1000000, 0, 1000, BUS_OFF }, "1000000 0 1000 3" },
    { { "can0", 3, true, true, false, 0, 0, 10, BUS_ACTIVE }, "is can0 3 down can 0 0 10 0" },
    { { "abcdefghijklmno", 2147483647, true, true, true, 10000, 1, 1, BUS_ACTIVE },
      "is abcdefghijklmno 2147483647 up can" },
    { { "eth0", 2, false, false, true, 0, 0, 1000, BUS_ACTIVE }, "is eth0 2 up other" },
};

START_TEST(test_states)
{
    const struct can_link_news news = { .type = CAN_LINK_IS, .link = states[_i].link };
    size_t size = link_message_add(data, 0, &news);
    char text[1000];

    ck_assert_ptr_nonnull(strstr(news_text(data, size, text, sizeof text), states[_i].news));
}
END_TEST

static const struct can_link_news three[] = {
    { .type = CAN_LINK_IS, .link = { "can0", 3, true, true, true, 125000, 100, 10, BUS_OFF } },
    { .type = CAN_LINK_REFUSED, .error = EPERM },
    { .type = CAN_LINK_GONE, .link = { .name = "vcan1", .index = 4, .is_can = true } },
};

static size_t add_three(void)
{
    size_t size = 0;

    for (unsigned i = 0; i < 3; i++)
        size = link_message_add(data, size, &three[i]);
    return size;
}

START_TEST(test_several_in_one)
{
    char text[1000];

    ck_assert_str_eq(news_text(data, add_three(), text, sizeof text),
                     "is can0 3 up can 125000 100 10 3; refused 1; gone vcan1 4 down vcan 0 0 0 0");
}
END_TEST

/* --- what is left out --- */

static void set_byte(size_t offset, uint8_t value)
{
    data[offset] = value;
}

static const struct {
    const char *what;
    size_t offset;
    uint8_t value;
} others[] = {
    { "another message", 4, RTM_NEWADDR },
    { "a bridge", sizeof(struct nlmsghdr), AF_BRIDGE },
    { "no index", sizeof(struct nlmsghdr) + 4, 0 },
    { "the name is another attribute", 34, 99 },
    { "the name is empty", 36, 0 },
    { "the name has no end", 40, 'x' },
    { "the name has another length", 32, 40 },
    { "the name is longer than the message", 33, 40 },
    { "an attribute shorter than its head", 32, 3 },
    { "a message shorter than its head", 0, 15 },
    { "a message longer than all", 1, 40 },
};

START_TEST(test_left_out)
{
    size_t size = link_message_add(data, 0, &three[0]);
    char text[1000];

    ck_assert_str_ne(news_text(data, size, text, sizeof text), "");
    set_byte(others[_i].offset, others[_i].value);
    if (_i >= LENGTH(others) - 2)
        set_byte(others[_i].offset == 0 ? 1 : 0, 0);
    ck_assert_msg(news_text(data, size, text, sizeof text)[0] == '\0', "%s: %s", others[_i].what,
                  text);
}
END_TEST

/* An acknowledgement, and no errno at all (found by the fuzzer). */
START_TEST(test_an_acknowledgement_is_no_refusal)
{
    struct can_link_news news = { .type = CAN_LINK_REFUSED, .error = 0 };
    const int32_t least = INT32_MIN;
    char text[1000];

    ck_assert_str_eq(news_text(data, link_message_add(data, 0, &news), text, sizeof text), "");
    memcpy(data + sizeof(struct nlmsghdr), &least, sizeof least);
    ck_assert_str_eq(news_text(data, 36, text, sizeof text), "");
    news.error = ENODEV;
    ck_assert_str_eq(news_text(data, link_message_add(data, 0, &news), text, sizeof text),
                     "refused 19");
}
END_TEST

/* Cut off anywhere, read up to the last byte and no further; what is complete is told. */
START_TEST(test_cut_off)
{
    size_t size = add_three(), first = link_message_add(data, 0, &three[0]);
    char text[1000];

    add_three();
    for (size_t cut = 0; cut <= size; cut++) {
        struct guard guard;

        guard_init(&guard, data, cut);
        news_text((const uint8_t *)guard.bytes, cut, text, sizeof text);
        ck_assert((text[0] != '\0') == (cut >= first));
        guard_done(&guard);
    }
}
END_TEST

/* --- requests, bit rates --- */

START_TEST(test_request)
{
    uint8_t bytes[CAN_LINK_REQUEST_MAX];
    uint8_t expected[52] = { 52, 0, 0, 0, RTM_GETLINK, 0, NLM_F_REQUEST };

    expected[32] = 20; /* length and type of the attribute */
    expected[34] = IFLA_IFNAME;
    memcpy(expected + 36, "abcdefghijklmno", 16);
    ck_assert_uint_eq(can_link_request("abcdefghijklmno", bytes), sizeof expected);
    ck_assert_mem_eq(bytes, expected, sizeof expected);
    ck_assert_uint_eq(can_link_request("can0", bytes), 44);
    ck_assert_uint_eq(bytes[32], 9);
}
END_TEST

static const struct {
    uint32_t actual;
    unsigned kbit;
    bool other;
} rates[] = {
    { 500000, 500, false },      { 500000, 250, true },  { 0, 250, false },
    { 500000, 0, false },        { 505000, 500, false }, { 505001, 500, true },
    { 495000, 500, false },      { 494999, 500, true },  { 1000000, 1000, false },
    { 999000, 1000, false },     { 800000, 1000, true }, { 10000, 10, false },
    { 4294967295u, 1000, true },
};

START_TEST(test_bitrates)
{
    const struct can_link link = { .bitrate = rates[_i].actual };

    ck_assert(can_link_has_other_bitrate(&link, rates[_i].kbit) == rates[_i].other);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("rtnetlink");

    tcase_add_loop_test(tests, test_records, 0, LENGTH(records));
    tcase_add_test(tests, test_all_records_are_looked_at);
    tcase_add_loop_test(tests, test_states, 0, LENGTH(states));
    tcase_add_test(tests, test_several_in_one);
    tcase_add_loop_test(tests, test_left_out, 0, LENGTH(others));
    tcase_add_test(tests, test_an_acknowledgement_is_no_refusal);
    tcase_add_test(tests, test_cut_off);
    tcase_add_test(tests, test_request);
    tcase_add_loop_test(tests, test_bitrates, 0, LENGTH(rates));
    return suite_run("can_link", tests);
}
