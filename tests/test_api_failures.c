/*
 * What the system refuses the manager: memory. The linker leads the library's allocations here
 * (--wrap), where each of a call fails once: the call says so, and works when it is tried again.
 */
#include "support/api_plant.h"
#include "support/dcf_file.h"
#include "support/suite.h"

#include <stdio.h>
#include <stdlib.h>

#define MOST 20000u /* allocations of one call, far more than there are */
#define EACH 300u   /* the first ones are refused one by one, of the others each 41st */

static _Thread_local unsigned left; /* allocations until one fails; 0: none does */

static bool fails(void)
{
    return left > 0 && --left == 0;
}

void *__real_malloc(size_t size);
void *__wrap_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__wrap_calloc(size_t count, size_t size);

void *__wrap_malloc(size_t size)
{
    return fails() ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size)
{
    return fails() ? NULL : __real_calloc(count, size);
}

static struct api_plant *plant;

static void set_up(void)
{
    plant = api_plant_new();
    api_write(plant, "a.dcf", OBJECT("2000", VAR("2000", "5", "rw") "ParameterValue=7\n"));
    api_write(plant, "network.xml", "<CANopen_Manager/>");
    api_add_device(plant, 5);
    api_devices_start(plant);
}

static void tear_down(void)
{
    api_plant_free(plant);
}

static int call_initialize(void)
{
    return mcanOpenInitialize();
}

static int call_config(void)
{
    return mcanOpenConfig(api_path(plant, "network.xml"));
}

static int call_read(void)
{
    unsigned char buffer[4];
    int len = sizeof buffer;

    return mcanOpenReadSDO(0, 5, 0x1000, 0, buffer, &len, NULL);
}

static void ignore_end(void *context, const SDO_RESULT_T *result)
{
    (void)context;
    (void)result;
}

static int call_async(bool write)
{
    const SDO_REQUEST_T request = { .size = sizeof request,
                                    .node = 5,
                                    .index = 0x1000,
                                    .type = TYP_UINT32,
                                    .data = "ABCD",
                                    .len = 4,
                                    .done = ignore_end };

    return write ? mcanOpenWriteSDOAsync(&request, NULL) : mcanOpenReadSDOAsync(&request, NULL);
}

static int call_read_async(void)
{
    return call_async(false);
}

static int call_write_async(void)
{
    return call_async(true);
}

/* How often each result came, when one allocation after the other has failed, until none does. */
static void fail_each(int (*call)(void), int expected, int other)
{
    unsigned expected_count = 0, other_count = 0;
    int result;

    for (unsigned n = 1;; n += n < EACH ? 1 : 41) {
        ck_assert_uint_lt(n, MOST);
        left = n;
        result = call();
        if (left > 0)
            break;
        expected_count += result == expected;
        other_count += other != 0 && result == other;
        if (result == MCANOPEN_OK) /* one that can be done without */
            break;
        ck_assert_msg(result == expected || result == other, "allocation %u: %d", n, result);
    }
    left = 0;
    ck_assert_int_eq(result, MCANOPEN_OK);
    ck_assert_uint_gt(expected_count, 0);
    ck_assert(other == 0 || other_count > 0);
}

START_TEST(no_memory_to_initialize)
{
    fail_each(call_initialize, MCAL_OBJ_NO_MEMORY, 0);
}
END_TEST

START_TEST(no_memory_to_configure)
{
    const char *network = api_network(plant, 0, API_NODE_WITH(5, "<DCF_File>a.dcf</DCF_File>"));
    char text[2000];

    snprintf(text, sizeof text, "<CANopen_Manager>\n%s</CANopen_Manager>\n", network);
    api_write(plant, "network.xml", text);
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    fail_each(call_config, MCAL_OBJ_NO_MEMORY, CANOPEN_DCF_OUT_OF_MEMORY);
    mcanOpenStart();
    api_wait_event(API_NETWORK_UP, -1);
}
END_TEST

START_TEST(no_memory_for_what_is_read)
{
    api_boot(plant, API_NODE(5));
    fail_each(call_read, MCAL_OBJ_NO_MEMORY, 0);
}
END_TEST

START_TEST(no_memory_for_a_request)
{
    api_boot(plant, API_NODE(5));
    fail_each(_i ? call_write_async : call_read_async, MCAL_OBJ_NO_MEMORY, 0);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("failures");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_set_timeout(tests, API_LIMIT);
    tcase_add_test(tests, no_memory_to_initialize);
    tcase_add_test(tests, no_memory_to_configure);
    tcase_add_test(tests, no_memory_for_what_is_read);
    tcase_add_loop_test(tests, no_memory_for_a_request, 0, 2);
    return suite_run("api_failures", tests);
}
