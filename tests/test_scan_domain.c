/*
 * Large values: domains in the application's memory, read and written by clients: by the manager of
 * the same process, and frame by frame.
 */
#include "support/scan_client.h"
#include "support/scan_plant.h"
#include "support/suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))
#define BOTH         (READ_ACCESS | WRITE_ACCESS)
#define NODE         5

#ifdef __SANITIZE_THREAD__
#define MOST 20000u /* each access takes its time there */
#else
#define MOST 1000000u
#endif

#define MEMORY 0x2000

static struct scan_plant *plant;
static HNODE node;
static char folder[SUITE_PATH_SIZE];
static uint8_t memory[MOST], sent[MOST + 40];

static void make_domain(unsigned size, unsigned room, PFN_COS_DATA_HANDLER handler)
{
    DictionaryData data = { .domain = { room > 0 ? memory : NULL, room, size } };

    ck_assert_int_eq(canOpenExtendDictionary(node, MEMORY, 0, OBJ_VAR, MAP_DOMAIN), SCANOPEN_OK);
    ck_assert_int_eq(canOpenInitDictionary(node, MEMORY, 0, "a domain", BOTH, &data, handler),
                     SCANOPEN_OK);
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

static const unsigned sizes[] = { 1, 4, 5, 7, 8, 889, 890, MOST / 10, MOST };
static const int forms[] = { TYP_BLOCK, TYP_INDICATE_SIZE, 0 };

static bool is_tried(unsigned size, int form)
{
    return size < MOST || form != TYP_INDICATE_SIZE;
}

/* Each time other bytes. */
START_TEST(any_size_in_memory)
{
    make_domain(0, MOST, NULL);
    scan_activate(plant, node);
    scan_client_start(NODE);
    for (unsigned i = 0; i < COUNT(sizes) * COUNT(forms); i++) {
        const int form = forms[i % COUNT(forms)];
        const unsigned size = sizes[i / COUNT(forms)];

        if (!is_tried(size, form))
            continue;
        ck_assert_uint_eq(scan_client_write(NODE, MEMORY, sent + i, size, form), 0);
        ck_assert_mem_eq(memory, sent + i, size);
        scan_client_expect(NODE, MEMORY, sent + i, size, form & TYP_BLOCK);
    }
}
END_TEST

/* Nobody falls back to segments. */
START_TEST(blocks_are_blocks)
{
    make_domain(0, MOST, NULL);
    scan_activate(plant, node);
    scan_client_start(NODE);
    scan_forget(plant);
    ck_assert_uint_eq(scan_client_write(NODE, MEMORY, sent, 1000, TYP_BLOCK), 0);
    scan_expect(plant, "605#C6002000E8030000");
    scan_expect(plant, "585#A40020007F000000");
    scan_client_expect(NODE, MEMORY, sent, 1000, TYP_BLOCK);
    scan_await(plant, "605#A40020007F*");
    scan_expect(plant, "585#C6002000E8030000");
}
END_TEST

/* --- frame by frame --- */

#define WRITE_NOTHING                                                                              \
    "605#2100200000000000", "585#6000200000000000", "605#0F00000000000000", "585#2000000000000000"
#define READ_NOTHING                                                                               \
    "605#4000200000000000", "585#4100200000000000", "605#6000000000000000", "585#0F00000000000000"

/* The entry's memory, when the device is through with it. */
static uint8_t *memory_of_entry(void)
{
    uint8_t *bytes = NULL;

    ck_assert_int_eq(canOpenReadDictionary(node, MEMORY, 0, &bytes), SCANOPEN_OK);
    ck_assert_ptr_eq(bytes, memory);
    return bytes;
}

START_TEST(no_bytes_in_memory)
{
    static const char *const frames[] = { WRITE_NOTHING, READ_NOTHING };

    make_domain(10, 10, NULL);
    scan_activate(plant, node);
    scan_talk(plant, frames, COUNT(frames));
}
END_TEST

/* Told in advance, and not; what is there stays. */
START_TEST(more_than_memory_has)
{
    static const char *const frames[] = {
        "605#210020000B000000", "585#8000200012000706", /* 11 bytes */
        "605#2000200000000000", "585#6000200000000000", "605#0001020304050607",
        "585#2000000000000000", "605#1701020304000000", "585#8000200012000706",
        "605#2000200000000000", "585#6000200000000000", "605#0001020304050607",
        "585#2000000000000000", "605#1901020300000000", "585#3000000000000000"
    };

    memcpy(memory, "abc", 3);
    make_domain(3, 10, NULL);
    scan_activate(plant, node);
    scan_talk(plant, frames, 8);
    scan_expect_text(plant, NODE, MEMORY, "abc");
    scan_talk(plant, frames + 8, COUNT(frames) - 8);
    ck_assert_mem_eq(memory_of_entry(), "\1\2\3\4\5\6\7\1\2\3", 10);
}
END_TEST

static int on_domain(int net, int id, int index, int sub, void *data)
{
    const RecDomain *domain = data;
    const bool good = memcmp(domain->pData, sent, domain->ulLength) == 0;

    scan_note("%d/%d %04X:%02X %lu %s, %02X there", net, id, (unsigned)index, (unsigned)sub,
              (unsigned long)domain->ulLength, good ? "good" : "other", memory[0]);
    return domain->ulLength == 8 ? SCANOPEN_WRONG_PARAMETER : SCANOPEN_OK;
}

/* It gets the bytes before they are in memory, however many they are. */
START_TEST(a_handler_of_a_domain)
{
    make_domain(1, MOST, on_domain);
    memory[0] = 0xEE;
    sent[0] = 0x11;
    scan_activate(plant, node);
    scan_client_start(NODE);
    ck_assert_uint_eq(scan_client_write(NODE, MEMORY, sent, 8, 0), 0x06090030);
    ck_assert_uint_eq(memory[0], 0xEE);
    ck_assert_uint_eq(scan_client_write(NODE, MEMORY, sent, 10000, 0), 0);
    ck_assert_mem_eq(memory, sent, 10000);
    scan_await_note("0/5 2000:00 8 good, EE there");
    scan_await_note("0/5 2000:00 10000 good, EE there");
}
END_TEST

/* What the application changes meanwhile does not get into it. */
START_TEST(reading_gets_what_was_there_when_it_began)
{
    static const char *const begin[] = { "605#4000200000000000", "585#4100200008000000",
                                         "605#6000000000000000", "585#0061626364656667" };
    static const char *const end[] = { "605#7000000000000000", "585#1D68000000000000" };
    static uint8_t other[] = "ABCDEFGH";
    const RecDomain now = { other, 8, 8 };

    memcpy(memory, "abcdefgh", 8);
    make_domain(8, 8, NULL);
    scan_activate(plant, node);
    scan_talk(plant, begin, COUNT(begin));
    memory_of_entry()[7] = 'x';
    ck_assert_int_eq(canOpenWriteDictionary(node, MEMORY, 0, &now), SCANOPEN_OK);
    scan_talk(plant, end, COUNT(end));
    scan_expect_text(plant, NODE, MEMORY, "ABCDEFGH");
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("scan_domain");

    tcase_add_checked_fixture(tcase, set_up, tear_down);
    tcase_set_timeout(tcase, SCAN_LIMIT);
    tcase_add_test(tcase, any_size_in_memory);
    tcase_add_test(tcase, blocks_are_blocks);
    tcase_add_test(tcase, no_bytes_in_memory);
    tcase_add_test(tcase, more_than_memory_has);
    tcase_add_test(tcase, a_handler_of_a_domain);
    tcase_add_test(tcase, reading_gets_what_was_there_when_it_began);
    return suite_run("scan_domain", tcase);
}
