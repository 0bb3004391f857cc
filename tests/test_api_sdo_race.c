/* Requests for which no call waits, cancelled by several threads while their answers come. */
#include "support/api_plant.h"
#include "support/suite.h"

#include <sched.h>

#define RACERS 3u
#define RACES  200u

struct race {
    int cancelled; /* what the call has said */
    int result;
    unsigned ends;
};

struct racer {
    struct co_thread thread;
    struct race races[RACES];
};

static struct api_plant *plant;

static void set_up(void)
{
    plant = api_plant_new();
    api_add_device(plant, 5);
    api_devices_start(plant);
    api_boot(plant, API_NODE_WITH(5, API_PATIENT));
}

static void tear_down(void)
{
    api_plant_free(plant);
}

static void note_end(void *context, const SDO_RESULT_T *result)
{
    struct race *race = context;

    race->result = result->result;
    race->ends++;
}

/* Sometimes at once, sometimes when the answer may be there. */
static void run_race(struct race *race, unsigned patience)
{
    const SDO_REQUEST_T request = { .size = sizeof request,
                                    .node = 5,
                                    .index = 0x1000,
                                    .len = 4,
                                    .done = note_end,
                                    .context = race };
    unsigned number = 0;

    while (mcanOpenReadSDOAsync(&request, &number) == MCAL_SDO_QUEUE_FULL)
        sched_yield();
    while (patience-- > 0)
        sched_yield();
    race->cancelled = mcanOpenCancelSDO(0, number);
}

static void *run_races(void *context)
{
    struct racer *self = context;

    for (unsigned i = 0; i < RACES; i++)
        run_race(&self->races[i], i % 64);
    return NULL;
}

/* Whichever comes first: one end, and the one that the call has told. */
START_TEST(an_answer_and_a_cancel_make_one_end)
{
    static struct racer racers[RACERS];

    for (unsigned i = 0; i < RACERS; i++)
        ck_assert_int_eq(thread_start(&racers[i].thread, "racer", run_races, &racers[i]), CO_OK);
    for (unsigned i = 0; i < RACERS; i++)
        thread_join(&racers[i].thread);
    ck_assert_int_eq(mcanOpenShutDown(), MCANOPEN_OK);
    for (unsigned i = 0; i < RACERS * RACES; i++) {
        const struct race *race = &racers[i / RACES].races[i % RACES];

        ck_assert_uint_eq(race->ends, 1);
        if (race->cancelled == MCANOPEN_OK) {
            ck_assert_int_eq(race->result, MCAL_SDO_CANCELLED);
        } else {
            ck_assert_int_eq(race->cancelled, MCAL_NO_EVENT);
            ck_assert_int_eq(race->result, MCANOPEN_OK);
        }
    }
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("races");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_set_timeout(tests, API_LIMIT);
    tcase_add_test(tests, an_answer_and_a_cancel_make_one_end);
    return suite_run("api_sdo_race", tests);
}
