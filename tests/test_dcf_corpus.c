/*
 * Real files of TEST_CORPUS_DIR: each is read, or refused for a reason that is listed here, and
 * those that are read give a dictionary and a concise DCF. Without the directory none is run.
 */
#include "dcf/dcf.h"
#include "support/guard.h"
#include "support/guarded.h"
#include "support/hex.h"
#include "support/messages.h"

#include <check.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CUTS      7 /* places where each file is cut */
#define PATH_SIZE 2000

/* ParameterValues of 65535 where the same section has limits of 0 and 1000. */
static const char *const out_of_limits[] = { "Esclavo.dcf", "Maestro.dcf", "base_line_5.dcf" };

static struct messages messages;
static unsigned read_count, refused_count, ccf_count_of_files;

static char *read_file(const char *path, size_t *ret_size)
{
    FILE *stream = fopen(path, "rb");
    char *bytes = malloc((size_t)4 << 20);

    ck_assert_msg(stream != NULL, "%s", path);
    ck_assert_ptr_nonnull(bytes);
    *ret_size = fread(bytes, 1, (size_t)4 << 20, stream);
    fclose(stream);
    return bytes;
}

static enum dcf_error expected_error(const char *path)
{
    const char *name = strrchr(path, '/') + 1;

    for (size_t i = 0; i < sizeof out_of_limits / sizeof out_of_limits[0]; i++) {
        if (strcmp(name, out_of_limits[i]) == 0)
            return DCF_ERROR_OUT_OF_LIMITS;
    }
    return DCF_ERROR_NONE;
}

static enum co_err give_file(void *context, const char *name, uint8_t **ret_bytes, size_t *ret_size)
{
    (void)context;
    *ret_size = strlen(name);
    *ret_bytes = (uint8_t *)strdup(name);
    return CO_OK;
}

static void check_use(const char *path, const struct dcf *dcf)
{
    struct dcf_ccf_options options = { .node_id = 5, .read_file = give_file };
    struct ccf ccf;
    struct od od;

    ck_assert_msg(dcf->count > 0, "%s", path);
    od_init(&od);
    ck_assert_msg(dcf_make_od(dcf, 5, &messages.report, &od) == CO_OK, "%s: %s", path,
                  messages.report.first_error);
    od_done(&od);
    ck_assert_msg(dcf_make_ccf(dcf, &options, &messages.report, &ccf) == CO_OK, "%s: %s", path,
                  messages.report.first_error);
    ccf_done(&ccf);
}

static void check_text(const char *path, const char *bytes, size_t size)
{
    struct dcf dcf;
    enum co_err err;

    messages_init(&messages);
    err = guarded_dcf_parse(bytes, size, &messages.report, &dcf);
    ck_assert_msg(messages.report.error_kind == (int)expected_error(path), "%s: %s", path,
                  messages.report.first_error);
    if (expected_error(path) != DCF_ERROR_NONE) {
        ck_assert_int_eq(err, CO_ERR_FORMAT);
        refused_count++;
        return;
    }
    ck_assert_int_eq(err, CO_OK);
    check_use(path, &dcf);
    dcf_done(&dcf);
    read_count++;
}

/* Cut anywhere it is read or refused, and not a byte behind its end is looked at. */
static void check_cut(const char *bytes, size_t size)
{
    for (size_t i = 1; i < CUTS; i++) {
        size_t cut = size * i / CUTS;
        struct guard guard;
        struct dcf dcf;

        guard_init(&guard, bytes, cut);
        messages_init(&messages);
        if (dcf_parse(guard.bytes, cut, &messages.report, &dcf) == CO_OK)
            dcf_done(&dcf);
        guard_done(&guard);
    }
}

/* The text with this end of lines; returns its size. */
static size_t end_lines(const char *bytes, size_t size, char end, char *text)
{
    char *at = text;

    for (size_t i = 0; i < size; i++)
        if (bytes[i] == '\n')
            *at++ = end;
        else if (bytes[i] != '\r')
            *at++ = bytes[i];
    return (size_t)(at - text);
}

/* A file tells the same with whatever ends of lines, and one thing more with CR alone. */
static void check_line_ends(const char *path, const char *bytes, size_t size)
{
    static const char ends[] = { '\n', '\r' };
    char *text = malloc(size + 1);
    struct dcf dcf;
    unsigned warnings;
    size_t entries;

    ck_assert_ptr_nonnull(text);
    messages_init(&messages);
    dcf_parse(bytes, size, &messages.report, &dcf);
    warnings = messages.report.warnings;
    entries = dcf.count;
    for (size_t i = 0; i < sizeof ends / sizeof ends[0]; i++) {
        dcf_done(&dcf);
        messages_init(&messages);
        dcf_parse(text, end_lines(bytes, size, ends[i], text), &messages.report, &dcf);
        ck_assert_msg(dcf.count == entries &&
                          messages.report.warnings == warnings + (ends[i] == '\r'),
                      "%s: with lines that end otherwise", path);
    }
    dcf_done(&dcf);
    free(text);
}

static void check_ccf(const char *path, const char *bytes, size_t size)
{
    struct ccf_reader reader;
    struct ccf_entry entry;
    struct ccf ccf;
    size_t total = 4;

    messages_init(&messages);
    ck_assert_msg(guarded_ccf_parse((const uint8_t *)bytes, size, &messages.report, &ccf) == CO_OK,
                  "%s: %s", path, messages.report.first_error);
    ccf_reader_init(&reader, &ccf);
    while (ccf_read(&reader, &entry))
        total += 7 + entry.size;
    ck_assert_uint_eq(total, size);
    ck_assert_int_eq(guarded_ccf_parse((const uint8_t *)bytes, size - 1, &messages.report, &ccf),
                     CO_ERR_FORMAT);
    ccf_done(&ccf);
    ccf_count_of_files++;
}

static void check_file(const char *path)
{
    const char *end = strrchr(path, '.');
    size_t size;
    char *bytes = read_file(path, &size);

    if (end && (strcmp(end, ".eds") == 0 || strcmp(end, ".dcf") == 0)) {
        check_text(path, bytes, size);
        check_cut(bytes, size);
        check_line_ends(path, bytes, size);
    } else if (end && strcmp(end, ".bin") == 0) {
        check_ccf(path, bytes, size);
    }
    free(bytes);
}

static void check_folder(const char *folder)
{
    DIR *entries = opendir(folder);
    struct dirent *entry;
    char path[PATH_SIZE];

    while (entries && (entry = readdir(entries)) != NULL) {
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        if (entry->d_name[0] != '.')
            check_file(path);
    }
    if (entries)
        closedir(entries);
}

START_TEST(test_all_files)
{
    DIR *sources = opendir(TEST_CORPUS_DIR);
    struct dirent *entry;
    char path[PATH_SIZE / 2];

    ck_assert_ptr_nonnull(sources);
    while ((entry = readdir(sources)) != NULL) {
        snprintf(path, sizeof path, "%s/%s", TEST_CORPUS_DIR, entry->d_name);
        if (entry->d_name[0] != '.')
            check_folder(path);
    }
    closedir(sources);
    printf("%u EDS and DCF files read, %u refused, %u concise DCFs read\n", read_count,
           refused_count, ccf_count_of_files);
    ck_assert_uint_gt(read_count, 0);
    ck_assert_uint_le(100 * refused_count, 3 * (read_count + refused_count));
    ck_assert_uint_gt(ccf_count_of_files, 0);
}
END_TEST

/* Values as a person reads them in the files. */
static const struct {
    const char *path;
    uint16_t index;
    uint8_t sub;
    const char *initial; /* "-": not given, "N...": with the node-ID to add */
    const char *parameter;
} known[] = {
    { "PilzDE+pilz_robots/prbt_0_1~5d404304.dcf", 0x1017, 0, "0000", "6400" },
    { "PilzDE+pilz_robots/prbt_0_1~5d404304.dcf", 0x1014, 0, "N80000000", "-" },
    { "lely-industries+lely-core/co-sdev.dcf", 0x2002, 0, "-", "81" },
    { "lely-industries+lely-core/co-sdev.dcf", 0x2008, 0, "-", "DB0F4940" },
    { "lely-industries+lely-core/co-sdev.dcf", 0x200C, 0, "-", "002E93026D01" },
    { "lely-industries+lely-core/co-sdev.dcf", 0x2012, 0, "-", "0100000080" },
    { "lely-industries+lely-core/co-pdo-receive.dcf", 0x1600, 2, "-", "20000120" },
    { "lely-industries+lely-core/co-pdo-transmit.dcf", 0x1800, 1, "N80010000", "-" },
    { "lely-industries+lely-core/sdo-server.dcf", 0x1018, 0, "-", "-" },
    { "ros-industrial+ros_canopen/Elmo~483cbfb9.dcf", 0x6502, 0, "ED030000", "-" },
    { "ros-industrial+ros_canopen/Elmo~483cbfb9.dcf", 0x1400, 1, "N00020000", "N00020000" },
    { "CANopenNode+CANopenNode/IO~4697e55b.eds", 0x2120, 1, "EFCDAB9078563412", "-" },
    { "christiansandberg+canopen/cog.eds", 0x607D, 1, "00000080", "-" },
    { "CANopenNode+CANopenDemo/demoDevice~63b7116b.eds", 0x1014, 0, "N80000000", "-" },
};

static const char *value_of(const struct dcf_value *value)
{
    static char text[2][200];
    static unsigned turn;
    char *shown = text[turn++ % 2];

    if (!value->given)
        return "-";
    shown[0] = 'N';
    hex_format(value->bytes, value->size, shown + value->has_node_id, sizeof text[0] - 1);
    return shown;
}

START_TEST(test_known_values)
{
    const struct dcf_entry *entry;
    struct dcf dcf;
    char path[1000];
    size_t size;
    char *bytes;

    snprintf(path, sizeof path, "%s/%s", TEST_CORPUS_DIR, known[_i].path);
    bytes = read_file(path, &size);
    messages_init(&messages);
    ck_assert_int_eq(guarded_dcf_parse(bytes, size, &messages.report, &dcf), CO_OK);
    entry = dcf_find(&dcf, known[_i].index, known[_i].sub);
    ck_assert_ptr_nonnull(entry);
    ck_assert_msg(strcmp(value_of(&entry->initial), known[_i].initial) == 0 &&
                      strcmp(value_of(&entry->parameter), known[_i].parameter) == 0,
                  "%s %04X:%02X: %s, %s", known[_i].path, known[_i].index, known[_i].sub,
                  value_of(&entry->initial), value_of(&entry->parameter));
    dcf_done(&dcf);
    free(bytes);
}
END_TEST

static Suite *corpus_suite(void)
{
    Suite *suite = suite_create("dcf_corpus");
    TCase *tests = tcase_create("dcf_corpus");

    tcase_set_timeout(tests, 100);
    tcase_add_test(tests, test_all_files);
    tcase_add_loop_test(tests, test_known_values, 0, sizeof known / sizeof known[0]);
    suite_add_tcase(suite, tests);
    return suite;
}

static bool corpus_is_there(void)
{
    DIR *folder = opendir(TEST_CORPUS_DIR);

    if (folder)
        closedir(folder);
    return folder != NULL;
}

int main(void)
{
    SRunner *runner;
    int failed;

    if (!corpus_is_there()) {
        printf("    NOT RUN: there is no corpus of real files in %s\n", TEST_CORPUS_DIR);
        return 0;
    }
    runner = srunner_create(corpus_suite());
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}
