/* Calls from the log hook: those that wait are refused at once, the others work. */
#include "support/api_plant.h"
#include "support/suite.h"

#include <stdio.h>
#include <string.h>

#define ROWS(table) (int)(sizeof(table) / sizeof *(table))

static struct api_plant *plant;

/* What the hook does with one line, and what came of it. */
static struct {
    struct co_lock lock;
    struct co_condition changed;
    const char *line; /* the one it waits for */
    int (*call)(void);
    int result;
    unsigned calls;
} act;

static void on_line(void *context, int level, const char *text)
{
    int result;

    (void)context;
    (void)level;
    if (!strstr(text, act.line))
        return;
    result = act.call();
    lock_take(&act.lock);
    act.result = result;
    act.calls++;
    condition_signal(&act.changed);
    lock_give(&act.lock);
}

static void set_up(void)
{
    plant = api_plant_new();
    api_add_device(plant, 5);
    api_devices_start(plant);
    act.calls = 0;
    ck_assert_int_eq(lock_init(&act.lock), CO_OK);
    ck_assert_int_eq(condition_init(&act.changed), CO_OK);
}

static void tear_down(void)
{
    api_plant_free(plant);
    condition_done(&act.changed);
    lock_done(&act.lock);
}

static int wait_for_result(void)
{
    int result;

    lock_take(&act.lock);
    while (act.calls == 0)
        condition_wait(&act.changed, &act.lock, CO_NEVER);
    result = act.result;
    lock_give(&act.lock);
    return result;
}

/* --- what is refused --- */

static int call_config(void)
{
    return mcanOpenConfig("network.xml");
}

static int call_read(void)
{
    char buffer[8];
    int len = sizeof buffer;

    return mcanOpenReadSDO(0, 5, 0x1000, 0, buffer, &len, NULL);
}

static int call_write(void)
{
    return mcanOpenWriteSDO(0, 5, 0x1017, 0, TYP_UINT16, "\0\0", 0, NULL);
}

static int call_wait(void)
{
    EVENT_T event;

    return mcanOpenEvent(&event, 1);
}

/* --- what works --- */

static int call_poll(void)
{
    EVENT_T event;
    int result = mcanOpenEvent(&event, 0);

    return result == MCAL_NO_EVENT ? MCANOPEN_OK : result;
}

static int call_state(void)
{
    int state = -1, result = mcanOpenGetNodeState(0, 5, &state);

    return state == MCANOPEN_STATE_OPERATIONAL ? result : -1000;
}

static int call_record(void)
{
    BOOT_RECORD_T record = { .size = sizeof record };

    return mcanOpenGetBootRecord(0, 5, &record);
}

static int call_start(void)
{
    return mcanOpenStartNode(0, 5);
}

static int call_stop(void)
{
    return mcanOpenStopNode(0, 5);
}

static int call_preop(void)
{
    return mcanOpenEnterPreop(0, 5);
}

static int call_reset(void)
{
    return mcanOpenResetNode(0, 5);
}

static int call_control(void)
{
    return mcanOpenNodeControl(0, 5, 0);
}

static int call_version(void)
{
    unsigned short version;

    return mcanOpenGetVersion(&version);
}

static int call_error_text(void)
{
    return strcmp(mcanOpenGetErrorText(), "");
}

static int call_set_log(void)
{
    return mcanOpenSetLog(NULL, NULL);
}

static const struct row {
    int (*call)(void);
    int result;
} rows[] = {
    { mcanOpenInitialize, MCAL_UNSUPPORTED },
    { mcanOpenCleanup, MCAL_UNSUPPORTED },
    { mcanOpenShutDown, MCAL_UNSUPPORTED },
    { call_config, MCAL_UNSUPPORTED },
    { call_read, MCAL_UNSUPPORTED },
    { call_write, MCAL_UNSUPPORTED },
    { call_wait, MCAL_UNSUPPORTED },
    { call_poll, MCANOPEN_OK },
    { call_state, MCANOPEN_OK },
    { call_record, MCANOPEN_OK },
    { call_start, MCANOPEN_OK },
    { call_stop, MCANOPEN_OK },
    { call_preop, MCANOPEN_OK },
    { call_reset, MCANOPEN_OK },
    { call_control, MCANOPEN_OK },
    { call_version, MCANOPEN_OK },
    { call_error_text, 0 },
    { call_set_log, MCANOPEN_OK },
};

START_TEST(a_call_from_the_daemon)
{
    act.line = "network is up";
    act.call = rows[_i].call;
    ck_assert_int_eq(mcanOpenSetLog(on_line, NULL), MCANOPEN_OK);
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config(plant, API_NODE(5)), MCANOPEN_OK);
    mcanOpenStart();
    ck_assert_int_eq(wait_for_result(), rows[_i].result);
    ck_assert_int_eq(mcanOpenShutDown(), MCANOPEN_OK);
    if (rows[_i].result == MCAL_UNSUPPORTED) /* that was the hook's fault */
        ck_assert_int_ne(rows[_i].call(), MCAL_UNSUPPORTED);
}
END_TEST

static const struct row in_config[] = {
    { mcanOpenInitialize, MCAL_UNSUPPORTED },
    { mcanOpenCleanup, MCAL_UNSUPPORTED },
    { mcanOpenShutDown, MCAL_UNSUPPORTED },
    { call_config, MCAL_UNSUPPORTED },
    { call_wait, MCAL_UNSUPPORTED },
    { call_read, MCAL_UNSUPPORTED },
    { call_write, MCAL_UNSUPPORTED },
    { call_poll, MCAL_NO_NET },
    { call_record, MCAL_NO_NET },
    { call_start, MCAL_NO_NET },
    { call_set_log, MCANOPEN_OK },
};

/* In the thread that configures. */
START_TEST(a_call_from_within_config)
{
    act.line = "unknown element";
    act.call = in_config[_i].call;
    ck_assert_int_eq(mcanOpenSetLog(on_line, NULL), MCANOPEN_OK);
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config(plant, "<Nonsense>1</Nonsense>"), MCAL_PARA_ERROR);
    ck_assert_uint_eq(act.calls, 1);
    ck_assert_int_eq(act.result, in_config[_i].result);
    ck_assert_int_eq(api_config(plant, API_NODE(5)), MCANOPEN_OK);
}
END_TEST

static int call_start_all(void)
{
    mcanOpenStart();
    return 0;
}

/* What a hook causes does not come back to it, but to stderr. */
START_TEST(start_from_a_hook_logs_an_error)
{
    char text[200] = "";
    FILE *file;

    ck_assert_ptr_nonnull(freopen(api_path(plant, "stderr"), "w", stderr));
    act.line = "unknown element";
    act.call = call_start_all;
    ck_assert_int_eq(mcanOpenSetLog(on_line, NULL), MCANOPEN_OK);
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config(plant, "<Nonsense>1</Nonsense>"), MCAL_PARA_ERROR);
    ck_assert_uint_eq(act.calls, 1);
    fflush(stderr);
    file = fopen(api_path(plant, "stderr"), "r");
    ck_assert_ptr_nonnull(file);
    ck_assert_ptr_nonnull(fgets(text, sizeof text, file));
    fclose(file);
    ck_assert_str_eq(text, "mcanOpenStart: not possible now\n");
}
END_TEST

/* Shut down ends while the hook is at work: its calls find nothing any more. */
START_TEST(shut_down_waits_for_the_hook)
{
    act.line = "node 5";
    act.call = call_record;
    ck_assert_int_eq(mcanOpenSetLog(on_line, NULL), MCANOPEN_OK);
    for (int i = 0; i < 10; i++) {
        ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
        ck_assert_int_eq(mcanOpenSetLog(on_line, NULL), MCANOPEN_OK);
        ck_assert_int_eq(api_config(plant, API_NODE(5)), MCANOPEN_OK);
        mcanOpenStart();
        api_wait_event(API_NETWORK_UP, -1);
        ck_assert_int_eq(mcanOpenCleanup(), MCANOPEN_OK);
        ck_assert(act.result == MCANOPEN_OK || act.result == MCAL_NO_NET);
    }
    ck_assert_uint_gt(act.calls, 10);
}
END_TEST

/* --- from another thread while one works --- */

static int (*const changes[])(void) = { mcanOpenInitialize, mcanOpenCleanup, mcanOpenShutDown,
                                        call_config };

static void *change(void *context)
{
    int *results = context;

    for (int i = 0; i < ROWS(changes); i++)
        results[i] = changes[i]();
    return NULL;
}

/* The hook, in the midst of mcanOpenConfig, waits for it. */
static int change_beside(void)
{
    int results[ROWS(changes)] = { 0 };
    struct co_thread thread;
    int refused = 0;

    if (thread_start(&thread, "beside", change, results) != CO_OK)
        return -1;
    thread_join(&thread);
    for (int i = 0; i < ROWS(changes); i++)
        refused += results[i] == MCAL_SYS_ERROR;
    return refused;
}

START_TEST(changes_come_one_at_a_time)
{
    act.line = "without any Node_Instance";
    act.call = change_beside;
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(mcanOpenSetLog(on_line, NULL), MCANOPEN_OK);
    ck_assert_int_eq(api_config(plant, ""), MCANOPEN_OK);
    ck_assert_uint_eq(act.calls, 1);
    ck_assert_int_eq(act.result, ROWS(changes));
    ck_assert_int_eq(mcanOpenShutDown(), MCANOPEN_OK);
}
END_TEST

/* --- levels --- */

struct counts {
    unsigned lines[MCANOPEN_LOG_INFO + 1];
};

static void on_level(void *context, int level, const char *text)
{
    struct counts *self = context;

    ck_assert_ptr_null(strchr(text, '\n'));
    ck_assert_int_ge(level, MCANOPEN_LOG_ERROR);
    ck_assert_int_le(level, MCANOPEN_LOG_INFO);
    lock_take(&act.lock);
    self->lines[level]++;
    condition_signal(&act.changed);
    lock_give(&act.lock);
}

static unsigned count_of(const struct counts *self, int level)
{
    unsigned count;

    lock_take(&act.lock);
    count = self->lines[level];
    lock_give(&act.lock);
    return count;
}

START_TEST(levels_of_the_log)
{
    struct counts counts = { { 0 } };
    MCANOPEN_LOG_T hook = on_level;

    ck_assert_int_eq(mcanOpenSetLog(hook, &counts), MCANOPEN_OK);
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config(plant, "<Nonsense>1</Nonsense>" API_NODE(5)), MCAL_PARA_ERROR);
    ck_assert_uint_eq(count_of(&counts, MCANOPEN_LOG_ERROR), 1);
    ck_assert_uint_eq(count_of(&counts, MCANOPEN_LOG_WARNING), 0);
    ck_assert_int_eq(api_config(plant, ""), MCANOPEN_OK);
    ck_assert_uint_eq(count_of(&counts, MCANOPEN_LOG_ERROR), 1);
    ck_assert_uint_eq(count_of(&counts, MCANOPEN_LOG_WARNING), 1);
    ck_assert_uint_eq(count_of(&counts, MCANOPEN_LOG_INFO), 0);
    mcanOpenStart();
    lock_take(&act.lock);
    while (counts.lines[MCANOPEN_LOG_INFO] == 0)
        condition_wait(&act.changed, &act.lock, CO_NEVER);
    lock_give(&act.lock);
    ck_assert_int_eq(mcanOpenShutDown(), MCANOPEN_OK);
    ck_assert_uint_eq(count_of(&counts, MCANOPEN_LOG_ERROR), 1);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("hook");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_set_timeout(tests, API_LIMIT);
    tcase_add_loop_test(tests, a_call_from_the_daemon, 0, ROWS(rows));
    tcase_add_loop_test(tests, a_call_from_within_config, 0, ROWS(in_config));
    tcase_add_test(tests, start_from_a_hook_logs_an_error);
    tcase_add_test(tests, shut_down_waits_for_the_hook);
    tcase_add_test(tests, changes_come_one_at_a_time);
    tcase_add_test(tests, levels_of_the_log);
    return suite_run("api_hook", tests);
}
