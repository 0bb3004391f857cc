#include "support/wire_log.h"

#include "support/suite.h"

#include <string.h>

static const struct pair {
    const char *name;
    const char *expected, *actual;
    const char *difference; /* part of it; NULL: the same */
} pairs[] = {
    { "both empty", "", "", NULL },
    { "comments, time stamps and the interface do not count",
      "# a comment 605#40\n605#4000100000000000\n", "(12.000001) can0 605#4000100000000000\r\n\n",
      NULL },
    { "nodes may interleave as they like", "605#40\n606#40\n585#43\n586#43\n",
      "606#40\n586#43\n605#40\n585#43\n", NULL },
    { "the order of a node counts", "605#40\n585#43\n", "585#43\n605#40\n",
      "node 5: expected 605#40 (line 1), is 585#43 (line 1)" },
    { "so does each byte", "605#4000100000000000\n", "605#4000100000000001\n", "node 5" },
    { "and the length", "605#4000\n", "605#40\n", "node 5" },
    { "a frame more", "605#40\n", "605#40\n605#40\n",
      "node 5: expected the end (line 1), is 605#40 (line 2)" },
    { "a frame less", "605#40\n705#00\n", "605#40\n", "expected 705#00 (line 2), is the end" },
    { "the order of commands counts", "000#0105\n000#0106\n", "000#0106\n000#0105\n",
      "network 0: expected 000#0105" },
    { "a command has its place among the node's frames", "000#8205\n705#00\n", "705#00\n000#8205\n",
      "node 5" },
    { "one to all, among the frames of each", "000#8200\n705#00\n", "705#00\n000#8200\n",
      "node 5" },
    { "but none among those of other nodes", "000#8206\n705#00\n", "705#00\n000#8206\n", NULL },
    { "heartbeats that tell nothing new do not count", "705#7F\n705#05\n",
      "705#7F\n705#7F\n705#05\n705#05\n", NULL },
    { "a state told does", "705#7F\n705#05\n", "705#05\n", "heartbeats of node 5" },
    { "a state told twice, with another in between", "705#05\n705#7F\n705#05\n", "705#05\n705#7F\n",
      "heartbeats of node 5" },
    { "heartbeats may come anywhere between the other frames", "605#40\n705#7F\n585#43\n",
      "705#7F\n605#40\n585#43\n", NULL },
    { "boot-ups may not", "605#40\n705#00\n585#43\n", "705#00\n605#40\n585#43\n", "node 5" },
    { "each boot-up counts", "705#00\n", "705#00\n705#00\n", "node 5" },
    { "remote frames are no heartbeats", "705#R1\n", "", "node 5" },
    { "SYNC counts as the network's", "080#\n", "", "network 0" },
    { "a foreign frame", "", "18FF0005#01\n", "is 18FF0005#01" },
};

START_TEST(test_pair)
{
    const struct pair *pair = &pairs[_i];
    char difference[WIRE_LOG_DIFFERENCE_SIZE] = "";
    bool same = wire_log_same(pair->expected, pair->actual, difference, sizeof difference);

    ck_assert_msg(same == !pair->difference, "%s: %s", pair->name, difference);
    if (pair->difference)
        ck_assert_msg(strstr(difference, pair->difference) != NULL, "%s: %s", pair->name,
                      difference);
}
END_TEST

START_TEST(test_missing_file)
{
    ck_assert_ptr_null(wire_log_read("wire/no_such.log"));
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("wire_log");

    tcase_add_loop_test(tcase, test_pair, 0, sizeof pairs / sizeof pairs[0]);
    tcase_add_test(tcase, test_missing_file);
    return suite_run("wire_log", tcase);
}
