/*
 * All files, several at a time.
 *
 * Workers take the files in order and leave the results in a ring; the main thread writes them in
 * order. Nobody is further ahead than the ring is long, so many results are never kept.
 */
#include "dcftest.h"

#include <pthread.h>
#include <stdlib.h>
#include <unistd.h>

#define JOBS_MAX 64u
#define RING     (2u * JOBS_MAX)

struct run {
    const struct settings *settings;
    const struct files *files;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    size_t taken, written; /* files */
    bool stop;
    bool ready[RING];
    struct result results[RING];
};

/* The next file; files->count: there is none, or nobody wants it any more. */
static size_t take(struct run *self)
{
    size_t number;

    pthread_mutex_lock(&self->lock);
    while (!self->stop && self->taken < self->files->count && self->taken >= self->written + RING)
        pthread_cond_wait(&self->changed, &self->lock);
    number = self->stop ? self->files->count : self->taken;
    if (number < self->files->count)
        self->taken++;
    pthread_mutex_unlock(&self->lock);
    return number;
}

static void *work(void *context)
{
    struct run *self = context;
    size_t number;

    while ((number = take(self)) < self->files->count) {
        check_file(self->settings, &self->files->list[number], &self->results[number % RING]);
        pthread_mutex_lock(&self->lock);
        self->ready[number % RING] = true;
        pthread_cond_broadcast(&self->changed);
        pthread_mutex_unlock(&self->lock);
    }
    return NULL;
}

static void await(struct run *self, size_t number)
{
    pthread_mutex_lock(&self->lock);
    while (!self->ready[number % RING])
        pthread_cond_wait(&self->changed, &self->lock);
    pthread_mutex_unlock(&self->lock);
}

static void release(struct run *self, size_t number, bool stop)
{
    pthread_mutex_lock(&self->lock);
    self->ready[number % RING] = false;
    self->written = number + 1;
    self->stop = stop;
    pthread_cond_broadcast(&self->changed);
    pthread_mutex_unlock(&self->lock);
}

static bool write_result(struct output *output, const struct writer *writer, struct result *result)
{
    const bool good = writer->result(output, result);

    output->totals.files++;
    output->totals.errors += result->errors;
    output->totals.warnings += result->warnings;
    result_done(result);
    return good;
}

/* What is left when the output has failed. */
static void drop_results(struct run *self)
{
    for (size_t i = 0; i < RING; i++)
        if (self->ready[i])
            result_done(&self->results[i]);
}

static unsigned wanted_jobs(const struct settings *settings, const struct files *files)
{
    const long processors = sysconf(_SC_NPROCESSORS_ONLN);
    size_t jobs = settings->jobs ? settings->jobs : processors > 0 ? (size_t)processors : 1;

    if (jobs > files->count)
        jobs = files->count;
    return jobs > JOBS_MAX ? JOBS_MAX : (unsigned)jobs;
}

static bool write_all(struct run *self, const struct writer *writer, struct output *output)
{
    bool good = true;

    for (size_t i = 0; good && i < self->files->count; i++) {
        await(self, i);
        good = write_result(output, writer, &self->results[i % RING]);
        release(self, i, !good);
    }
    return good;
}

static bool run_alone(const struct run *self, const struct writer *writer, struct output *output)
{
    struct result result;
    bool good = true;

    for (size_t i = 0; good && i < self->files->count; i++) {
        check_file(self->settings, &self->files->list[i], &result);
        good = write_result(output, writer, &result);
    }
    return good;
}

static bool run_all(struct run *self, const struct writer *writer, struct output *output)
{
    const unsigned jobs = wanted_jobs(self->settings, self->files);
    pthread_t workers[JOBS_MAX];
    unsigned started = 0;
    bool good;

    while (jobs > 1 && started < jobs && pthread_create(&workers[started], NULL, work, self) == 0)
        started++;
    if (started == 0)
        return run_alone(self, writer, output);
    good = write_all(self, writer, output);
    for (unsigned i = 0; i < started; i++)
        pthread_join(workers[i], NULL);
    drop_results(self);
    return good;
}

bool write_one(const struct settings *settings, const struct writer *writer, struct result *result,
               struct totals *ret_totals)
{
    struct output output = { .settings = settings };
    bool good = writer->begin(&output) && write_result(&output, writer, result);

    good = good && writer->end(&output);
    *ret_totals = output.totals;
    return good;
}

bool run_checks(const struct settings *settings, const struct files *files,
                const struct writer *writer, struct totals *ret_totals)
{
    struct run *self = calloc(1, sizeof *self);
    struct output output = { .settings = settings };
    bool good;

    if (!self)
        return false;
    self->settings = settings;
    self->files = files;
    pthread_mutex_init(&self->lock, NULL);
    pthread_cond_init(&self->changed, NULL);
    good = writer->begin(&output) && run_all(self, writer, &output) && writer->end(&output);
    pthread_cond_destroy(&self->changed);
    pthread_mutex_destroy(&self->lock);
    free(self);
    *ret_totals = output.totals;
    return good;
}

int exit_code(const struct settings *settings, const struct totals *totals)
{
    const bool bad = totals->errors > 0 || (settings->strict && totals->warnings > 0);

    return bad ? DCFTEST_ERRORS : DCFTEST_CLEAN;
}
