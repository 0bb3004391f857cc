/*
 * Plants of 5 to 126 nodes, each with its faults and its application made from a seed: lost
 * frames, devices that are silent, slow, wrong, busy, that reset themselves or hang, power lost at
 * any moment, the manager's too, software updates. Most faults of a seed end after 15 s, others
 * are there for good; 60 s later
 *
 *   - where no mandatory node has a fault for good, all that have none are booted, OPERATIONAL, and
 *     have what their configuration says, value by value; else no node was ever started
 *   - each fault that is there for good stands in the boot record of its node, with its letter,
 *     step, object, abort code, or the value expected and the actual one; no other record has a
 *     failure left; records of nodes to which nothing has happened have never had one
 *   - each request of the application has ended once, and with its own data
 *
 * What must hold at every moment support/watch.h tells.
 *
 *   SCENARIO_SEEDS=2000 SCENARIO_JOBS=2   tries so many seeds, in so many processes
 *   SCENARIO_FIRST_SEED=4711              ... from this one on
 *   SCENARIO_LOG=seed.log                 keeps the wire of the last one as a candump log, and,
 *                                         where it fails, the manager's events
 *   SCENARIO_SABOTAGE=4711                lets this one fail
 *
 * A seed that fails is told with the command that plays it again.
 */
#include "support/seed.h"
#include "support/suite.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#define SEEDS     60
#define SEEDS_MAX 100000
#define JOBS_MAX  64
#define REPLAYS   10u /* told, of many that fail */

/* Of all processes: Check runs each test in one of its own. */
static struct outcome {
    struct seed_totals totals[JOBS_MAX];
    bool passed[SEEDS_MAX];
} * outcome;

static int first, job;

static int number_from(const char *variable, int preset)
{
    const char *text = getenv(variable);

    return text ? (int)strtol(text, NULL, 10) : preset;
}

/* A node does what nobody has told it to. */
static void sabotage(struct seed *seed)
{
    struct plant_device *device = seed->plant->devices[1];

    slave_command(&device->slave, NMT_STOP, seed->plant->sim.now, &device->sim->box);
    plant_run_ms(seed->plant, 1);
}

START_TEST(test_seed)
{
    struct seed *seed = seed_new((unsigned)_i);

    seed_run(seed);
    if (number_from("SCENARIO_SABOTAGE", -1) == _i)
        sabotage(seed);
    seed_judge(seed);
    seed_add_up(seed, &outcome->totals[job]);
    outcome->passed[_i - first] = true;
    seed_free(seed);
}
END_TEST

static int run_from(int begin, int end)
{
    TCase *tcase = tcase_create("seeds");

    tcase_set_timeout(tcase, 60);
    tcase_add_loop_test(tcase, test_seed, begin, end);
    return suite_run("seeds", tcase);
}

/* Each gets as many; what has become of them is in 'outcome'. */
static void run_in_processes(int count, int jobs)
{
    for (job = 0; job < jobs; job++) {
        if (fork() == 0)
            _exit(run_from(first + count * job / jobs, first + count * (job + 1) / jobs));
    }
    while (wait(NULL) > 0)
        ;
}

static unsigned tell_failed(int count)
{
    unsigned failed = 0;

    for (int i = 0; i < count; i++) {
        if (outcome->passed[i])
            continue;
        if (++failed <= REPLAYS)
            printf("seed %d has failed; replay: SCENARIO_FIRST_SEED=%d SCENARIO_SEEDS=1 "
                   "SCENARIO_LOG=seed-%d.log %s\n",
                   first + i, first + i, first + i, program_invocation_name);
    }
    return failed;
}

int main(void)
{
    int count = number_from("SCENARIO_SEEDS", SEEDS), jobs = number_from("SCENARIO_JOBS", 1);
    unsigned failed;

    first = number_from("SCENARIO_FIRST_SEED", 0);
    outcome = mmap(NULL, sizeof *outcome, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1,
                   0);
    if (outcome == MAP_FAILED || count < 1 || count > SEEDS_MAX || jobs < 1 || jobs > JOBS_MAX)
        return 1;
    if (jobs == 1)
        run_from(first, first + count);
    else
        run_in_processes(count, jobs);
    failed = tell_failed(count);
    seed_print(outcome->totals, (unsigned)jobs);
    if (jobs > 1)
        printf("%u passed, %u failed\n", (unsigned)count - failed, failed);
    return failed > 0;
}
