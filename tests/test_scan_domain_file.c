/*
 * Domains in files, read and written by clients: by the manager of the same process, and frame by
 * frame; and a disk that takes its time.
 */
#include "support/scan_client.h"
#include "support/scan_plant.h"
#include "support/suite.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))
#define BOTH         (READ_ACCESS | WRITE_ACCESS)
#define NODE         5
#define FILED        0x2001

#ifdef __SANITIZE_THREAD__
#define MOST 20000u /* each access takes its time there */
#else
#define MOST 1000000u
#endif

static struct scan_plant *plant;
static HNODE node;
static char folder[SUITE_PATH_SIZE];
static uint8_t memory[10], sent[MOST + 40];

static void put_file(const char *name, const void *bytes, size_t size)
{
    FILE *file = fopen(name, "w");

    ck_assert_ptr_nonnull(file);
    ck_assert_uint_eq(fwrite(bytes, 1, size, file), size);
    ck_assert_int_eq(fclose(file), 0);
}

static void expect_file(const char *name, const void *bytes, size_t size)
{
    static uint8_t content[MOST + 1];
    FILE *file = fopen(name, "r");

    ck_assert_ptr_nonnull(file);
    ck_assert_uint_eq(fread(content, 1, sizeof content, file), size);
    ck_assert_mem_eq(content, bytes, size);
    fclose(file);
}

static void set_up(void)
{
    SLAVE_NODE_INFO info = scan_info();

    suite_temporary("domain", folder);
    ck_assert_ptr_nonnull(mkdtemp(folder));
    ck_assert_int_eq(chdir(folder), 0);
    info.ulOptions |= BLOCK_TRANSFER;
    plant = scan_plant_new(0);
    node = scan_node(plant, NODE, &info);
    for (unsigned i = 0; i < sizeof sent; i++)
        sent[i] = (uint8_t)(i * 7 + i / 251);
}

static void tear_down(void)
{
    char command[sizeof folder + 16];

    scan_client_end();
    scan_plant_free(plant);
    snprintf(command, sizeof command, "rm -rf %s", folder);
    ck_assert_int_eq(system(command), 0);
}

static void make_filed(const char *name, unsigned long max, PFN_COS_DATA_HANDLER handler)
{
    DictionaryData data = { .domain = { NULL, 0, 0 } };

    ck_assert_int_eq(canOpenExtendDictionary(node, FILED, 0, OBJ_VAR, MAP_DOMAIN), SCANOPEN_OK);
    ck_assert_int_eq(canOpenInitDictionary(node, FILED, 0, "a domain", BOTH, &data, handler),
                     SCANOPEN_OK);
    ck_assert_int_eq(canOpenSetDomainFile(node, FILED, 0, name, max), SCANOPEN_OK);
}

/* Why a client cannot read it. */
static uint32_t read_code(void)
{
    uint32_t value;

    return scan_sdo_read(plant, NODE, FILED, 0, &value);
}

static const unsigned sizes[] = { 1, 4, 5, 7, 8, 889, 890, MOST / 10, MOST };
static const int forms[] = { TYP_BLOCK, TYP_INDICATE_SIZE, 0 };

/* The longest in blocks only, which are faster. */
START_TEST(any_size_in_a_file)
{
    make_filed("data", MOST, NULL);
    scan_activate(plant, node);
    scan_client_start(NODE);
    for (unsigned i = 0; i < COUNT(sizes); i++) {
        const int form = sizes[i] < MOST ? forms[i % COUNT(forms)] : TYP_BLOCK;

        ck_assert_uint_eq(scan_client_write(NODE, FILED, sent + i, sizes[i], form), 0);
        expect_file("data", sent + i, sizes[i]);
        scan_client_expect(NODE, FILED, sent + i, sizes[i], form & TYP_BLOCK);
        ck_assert_int_ne(access("data~", F_OK), 0);
    }
}
END_TEST

#define WRITE_NOTHING                                                                              \
    "605#2101200000000000", "585#6001200000000000", "605#0F00000000000000", "585#2000000000000000"
#define READ_NOTHING                                                                               \
    "605#4001200000000000", "585#4101200000000000", "605#6000000000000000", "585#0F00000000000000"

START_TEST(no_bytes_in_a_file)
{
    static const char *const frames[] = { WRITE_NOTHING, READ_NOTHING };

    make_filed("data", 10, NULL);
    put_file("data", "old", 3);
    scan_activate(plant, node);
    scan_talk(plant, frames, COUNT(frames));
    expect_file("data", "", 0);
}
END_TEST

START_TEST(a_file_that_somebody_else_writes)
{
    make_filed("data", 10, NULL);
    scan_activate(plant, node);
    put_file("data", "first", 5);
    scan_expect_text(plant, NODE, FILED, "first");
    put_file("data", "second one", 10);
    scan_expect_text(plant, NODE, FILED, "second one");
    scan_await_note("event 0/5 STATE_CHANGE 127 0");
    ck_assert_uint_eq(scan_write_text(plant, NODE, FILED, "last"), 0);
    expect_file("data", "last", 4);
    scan_expect_note("event 0/5 WRITE_DICTIONARY 8193 0");
}
END_TEST

START_TEST(files_that_cannot_be_read)
{
    make_filed("data", 10, NULL);
    scan_activate(plant, node);
    ck_assert_uint_eq(read_code(), 0x08000024);
    put_file("data", "eleven byte", 11);
    ck_assert_uint_eq(read_code(), 0x06070012);
    ck_assert_int_eq(unlink("data"), 0);
    ck_assert_int_eq(mkdir("data", 0777), 0);
    ck_assert_uint_eq(read_code(), 0x06060000);
    ck_assert_int_eq(rmdir("data"), 0);
    ck_assert_int_eq(mkfifo("data", 0666), 0);
    ck_assert_uint_eq(read_code(), 0x06060000);
    ck_assert_int_eq(unlink("data"), 0);
    ck_assert_int_eq(symlink("data", "data"), 0);
    ck_assert_uint_eq(read_code(), 0x06060000);
}
END_TEST

START_TEST(files_that_cannot_be_written)
{
    make_filed("folder/data", 3, NULL);
    scan_activate(plant, node);
    ck_assert_uint_eq(scan_write_text(plant, NODE, FILED, "abc"), 0x06060000);
    ck_assert_uint_eq(scan_write_text(plant, NODE, FILED, "abcd"), 0x06070012);
    ck_assert_int_eq(mkdir("folder", 0777), 0);
    ck_assert_uint_eq(scan_write_text(plant, NODE, FILED, "abc"), 0);
    expect_file("folder/data", "abc", 3);
    ck_assert_int_eq(unlink("folder/data"), 0);
    ck_assert_int_eq(mkdir("folder/data", 0777), 0);
    ck_assert_uint_eq(scan_write_text(plant, NODE, FILED, "abc"), 0x06060000);
}
END_TEST

static int on_filed(int net, int id, int index, int sub, void *data)
{
    const RecDomain *domain = data;

    scan_note("%d/%d %04X:%02X '%.*s'", net, id, (unsigned)index, (unsigned)sub,
              (int)domain->ulLength, (const char *)domain->pData);
    expect_file("data", "old", 3);
    return domain->ulLength == 2 ? SCANOPEN_VALUE_TOO_LOW : SCANOPEN_OK;
}

START_TEST(the_handler_is_asked_before_the_file)
{
    put_file("data", "old", 3);
    make_filed("data", 10, on_filed);
    scan_activate(plant, node);
    scan_await_note("event 0/5 STATE_CHANGE 127 0");
    ck_assert_uint_eq(scan_write_text(plant, NODE, FILED, "ab"), 0x06090032);
    scan_expect_note("0/5 2001:00 'ab'");
    expect_file("data", "old", 3);
    ck_assert_uint_eq(scan_write_text(plant, NODE, FILED, "abc"), 0);
    scan_expect_note("0/5 2001:00 'abc'");
    expect_file("data", "abc", 3);
}
END_TEST

START_TEST(reading_gets_one_file_whole)
{
    static const char *const begin[] = { "605#4001200000000000", "585#4101200008000000",
                                         "605#6000000000000000", "585#0061626364656667" };
    static const char *const end[] = { "605#7000000000000000", "585#1D68000000000000" };

    make_filed("data", 10, NULL);
    put_file("data", "abcdefgh", 8);
    scan_activate(plant, node);
    scan_talk(plant, begin, COUNT(begin));
    put_file("data", "other", 5);
    scan_talk(plant, end, COUNT(end));
    scan_expect_text(plant, NODE, FILED, "other");
}
END_TEST

/* Of the application's own calls, none is about it; until it is in memory again. */
START_TEST(the_application_has_no_value_of_a_file)
{
    const RecDomain now = { memory, 3, 3 };
    void *bytes = NULL;
    HDICT entry = NULL;
    DictionaryData data = { .domain = { memory, 10, 3 } };

    put_file("data", "old", 3);
    memcpy(memory, "mem", 3);
    make_filed("data", 10, NULL);
    ck_assert_int_eq(canOpenReadDictionary(node, FILED, 0, &bytes), SCANOPEN_WRONG_TYPE);
    ck_assert_int_eq(canOpenWriteDictionary(node, FILED, 0, &now), SCANOPEN_WRONG_TYPE);
    ck_assert_int_eq(canOpenGetDictionaryHnd(node, FILED, 0, &entry), SCANOPEN_OK);
    ck_assert_int_eq(canOpenReadDictionaryHnd(entry, &bytes), SCANOPEN_WRONG_TYPE);
    ck_assert_int_eq(canOpenWriteDictionaryHnd(entry, &now), SCANOPEN_WRONG_TYPE);
    scan_activate(plant, node);
    scan_expect_text(plant, NODE, FILED, "old");
    ck_assert_int_eq(canOpenResetNode(node), SCANOPEN_OK);
    ck_assert_int_eq(canOpenInitDictionary(node, FILED, 0, NULL, BOTH, &data, NULL), SCANOPEN_OK);
    scan_activate(plant, node);
    scan_expect_text(plant, NODE, FILED, "mem");
    ck_assert_uint_eq(scan_write_text(plant, NODE, FILED, "abc"), 0);
    expect_file("data", "old", 3);
    ck_assert_int_eq(canOpenReadDictionary(node, FILED, 0, &bytes), SCANOPEN_OK);
    ck_assert_mem_eq(bytes, "abc", 3);
}
END_TEST

START_TEST(arguments_about_a_file)
{
    make_filed("f", 1, NULL);
    scan_number(node, 0x2002, TYP_UINT8, BOTH, 0, NULL);
    ck_assert_int_eq(canOpenExtendDictionary(node, 0x2003, 0, OBJ_VAR, MAP_DOMAIN), SCANOPEN_OK);
    ck_assert_int_eq(canOpenSetDomainFile(node, FILED, 0, NULL, 1), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenSetDomainFile(node, FILED, 0, "", 1), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenSetDomainFile(node, FILED, 0, "f", 0), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenSetDomainFile(node, FILED, 0, "f", 0x80000000UL),
                     SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenSetDomainFile(node, 0x2004, 0, "f", 1), SCANOPEN_WRONG_INDEX);
    ck_assert_int_eq(canOpenSetDomainFile(node, 0x1000, 0, "f", 1), SCANOPEN_WRONG_INDEX);
    ck_assert_int_eq(canOpenSetDomainFile(node, FILED, 1, "f", 1), SCANOPEN_WRONG_SUBINDEX);
    ck_assert_int_eq(canOpenSetDomainFile(node, FILED, 0xFF, "f", 1), SCANOPEN_WRONG_SUBINDEX);
    ck_assert_int_eq(canOpenSetDomainFile(node, FILED, 0x100, "f", 1), SCANOPEN_WRONG_SUBINDEX);
    ck_assert_int_eq(canOpenSetDomainFile(node, 0x2002, 0, "f", 1), SCANOPEN_WRONG_TYPE);
    ck_assert_int_eq(canOpenSetDomainFile(node, 0x2003, 0, "f", 1), SCANOPEN_WRONG_TYPE);
    ck_assert_int_eq(canOpenSetDomainFile(node, FILED, 0, "f", 0x7FFFFFFFUL), SCANOPEN_OK);
    ck_assert_int_eq(canOpenSetDomainFile(node, FILED, 0, "f", 1), SCANOPEN_OK);
    scan_activate(plant, node);
    ck_assert_int_eq(canOpenSetDomainFile(node, FILED, 0, "f", 1), SCANOPEN_WRONG_NODESTATE);
}
END_TEST

/* A reset does not change it, nor does storing. */
START_TEST(a_file_outlives_a_reset)
{
    make_filed("data", 10, NULL);
    put_file("data", "old", 3);
    scan_activate(plant, node);
    ck_assert_uint_eq(scan_write_text(plant, NODE, FILED, "new"), 0);
    scan_send(plant, "000#8105");
    scan_await(plant, "705#00");
    scan_expect_text(plant, NODE, FILED, "new");
    ck_assert_int_eq(canOpenResetNode(node), SCANOPEN_OK);
    scan_activate(plant, node);
    scan_expect_text(plant, NODE, FILED, "new");
}
END_TEST

/* --- a disk that takes its time: the linker leads fsync() here (--wrap) --- */

static struct {
    pthread_mutex_t lock;
    pthread_cond_t changed;
    bool slow, inside;
} disk = { .lock = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER };

int __real_fsync(int file);
int __wrap_fsync(int file);

int __wrap_fsync(int file)
{
    pthread_mutex_lock(&disk.lock);
    disk.inside = true;
    pthread_cond_broadcast(&disk.changed);
    while (disk.slow)
        pthread_cond_wait(&disk.changed, &disk.lock);
    disk.inside = false;
    pthread_mutex_unlock(&disk.lock);
    return __real_fsync(file);
}

static void set_slow(bool slow)
{
    pthread_mutex_lock(&disk.lock);
    disk.slow = slow;
    pthread_cond_broadcast(&disk.changed);
    pthread_mutex_unlock(&disk.lock);
}

static void begin_write(void)
{
    put_file("data", "old", 3);
    make_filed("data", 10, NULL);
    scan_activate(plant, node);
    set_slow(true);
    scan_send(plant, "605#2701200061626300");
    pthread_mutex_lock(&disk.lock);
    while (!disk.inside)
        pthread_cond_wait(&disk.changed, &disk.lock);
    pthread_mutex_unlock(&disk.lock);
}

/* The daemon has come to its end with this file: it serves the next one. */
static void expect_old_file(void)
{
    set_slow(false);
    scan_expect_text(plant, NODE, FILED, "old");
    expect_file("data", "old", 3);
    ck_assert_int_ne(access("data~", F_OK), 0);
}

START_TEST(nobody_else_waits_for_the_disk)
{
    begin_write();
    ck_assert_int_eq(scan_state(node), NodePreOperational);
    ck_assert_uint_eq(scan_get(node, 0x1001, 0), 0);
    scan_send(plant, "000#0105");
    ck_assert_int_eq(canOpenWaitForNodeState(node, WFNS_OPERATIONAL), NodeOperational);
    set_slow(false);
    scan_expect(plant, "585#6001200000000000");
    expect_file("data", "abc", 3);
}
END_TEST

/* He was told 08000020h, so the file is the old one. */
START_TEST(a_client_that_waits_too_long)
{
    begin_write();
    scan_await_note("event 0/5 HANDLER 3 2097408");
    scan_expect(plant, "585#8001200020000008");
    expect_old_file();
}
END_TEST

START_TEST(a_client_that_goes_on)
{
    begin_write();
    ck_assert_uint_eq(scan_sdo_write(plant, NODE, 0x1000, 0, 4, 0), 0x06010002);
    expect_old_file();
}
END_TEST

START_TEST(a_node_that_goes_offline)
{
    begin_write();
    ck_assert_int_eq(canOpenResetNode(node), SCANOPEN_OK);
    scan_activate(plant, node);
    expect_old_file();
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("scan_domain_file");

    tcase_add_checked_fixture(tcase, set_up, tear_down);
    tcase_set_timeout(tcase, SCAN_LIMIT);
    tcase_add_test(tcase, any_size_in_a_file);
    tcase_add_test(tcase, no_bytes_in_a_file);
    tcase_add_test(tcase, a_file_that_somebody_else_writes);
    tcase_add_test(tcase, files_that_cannot_be_read);
    tcase_add_test(tcase, files_that_cannot_be_written);
    tcase_add_test(tcase, the_handler_is_asked_before_the_file);
    tcase_add_test(tcase, reading_gets_one_file_whole);
    tcase_add_test(tcase, the_application_has_no_value_of_a_file);
    tcase_add_test(tcase, arguments_about_a_file);
    tcase_add_test(tcase, a_file_outlives_a_reset);
    tcase_add_test(tcase, nobody_else_waits_for_the_disk);
    tcase_add_test(tcase, a_client_that_waits_too_long);
    tcase_add_test(tcase, a_client_that_goes_on);
    tcase_add_test(tcase, a_node_that_goes_offline);
    return suite_run("scan_domain_file", tcase);
}
