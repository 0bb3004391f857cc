/*
 * bench_manager: SDO transfers by mcanOpenReadSDO or mcanOpenWriteSDO, or a network that is booted,
 * see usage. Network 0 of the configuration; MCANOPEN_NET_0 says where. What is read has to be the
 * yardsticks' test pattern.
 *
 *   out  one line of JSON: how long the transfers took, without the time of the start; how long the
 *        boot took, and how much of the processor, without reading the configuration
 */
#include "mcanopen.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

struct job {
    bool write, block, check;
    int node, index, size;
    unsigned long count;
    uint8_t *data;
};

static uint64_t now_ns(void)
{
    struct timespec now;

    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

static uint8_t pattern(unsigned long i)
{
    return (uint8_t)(0x5A + i * 7 + (i >> 8) * 13 + (i >> 16) * 29);
}

static int fail(const char *what, int result)
{
    fprintf(stderr, "%s: error %d\n", what, result);
    return 1;
}

static int transfer(const struct job *self)
{
    const unsigned short node = (unsigned short)self->node;
    const int block = self->block ? TYP_BLOCK : 0;
    int size = self->size;
    int result;

    if (self->write)
        return mcanOpenWriteSDO(0, node, self->index, 0, TYP_DOMAIN | TYP_INDICATE_SIZE | block,
                                self->data, size, NULL);
    result = mcanOpenReadSDO(0, node, self->index, block, self->data, &size, NULL);
    return result == MCANOPEN_OK && size != self->size ? MCAL_WRONG_SERVER_ANSWER : result;
}

static bool is_right(const struct job *self)
{
    for (int i = 0; self->check && i < self->size; i++)
        if (self->data[i] != pattern((unsigned long)i))
            return false;
    return true;
}

static int run(const struct job *self)
{
    const uint64_t start = now_ns();
    double seconds;

    for (unsigned long i = 0; i < self->count; i++) {
        const int result = transfer(self);

        if (result != MCANOPEN_OK)
            return fail(self->write ? "mcanOpenWriteSDO" : "mcanOpenReadSDO", result);
    }
    seconds = (double)(now_ns() - start) / 1e9;
    if (!is_right(self))
        return fail("what was read is wrong", 0);
    printf("{\"seconds\":%.4f,\"ops_s\":%.1f,\"kB_s\":%.2f}\n", seconds,
           (double)self->count / seconds, (double)self->count * self->size / seconds / 1e3);
    return 0;
}

static int configure(const char *config)
{
    int result = mcanOpenInitialize();

    if (result == MCANOPEN_OK)
        result = mcanOpenConfig(config);
    return result == MCANOPEN_OK ? 0 : fail(mcanOpenGetErrorText(), result);
}

static double seconds_of(struct timeval time)
{
    return (double)time.tv_sec + (double)time.tv_usec / 1e6;
}

/* Of this process, the kernel's work for it included. */
static double processor_seconds(void)
{
    struct rusage usage;

    getrusage(RUSAGE_SELF, &usage);
    return seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
}

static int boot(void)
{
    const long up = (long)(NOD_NOT_VAL | PARA_UC | MCANOPEN_MSG_NETWORK_UP);
    const uint64_t start = now_ns();
    const double used = processor_seconds();
    EVENT_T event = { 0 };
    int result = MCANOPEN_OK;

    mcanOpenStart();
    while (event.event != up && result == MCANOPEN_OK)
        result = mcanOpenEvent(&event, 1);
    if (result != MCANOPEN_OK)
        return fail("mcanOpenEvent", result);
    printf("{\"nodes\":%d,\"seconds\":%.4f,\"cpu_s\":%.6f}\n", event.para.uc,
           (double)(now_ns() - start) / 1e9, processor_seconds() - used);
    return 0;
}

static int explain(void)
{
    puts("usage: bench_manager CONFIG read|write|read-block|write-block NODE INDEX BYTES TIMES\n"
         "  up to 4 bytes go expedited, and are not looked at; more in segments, or in blocks\n"
         "       bench_manager CONFIG boot\n"
         "  until all mandatory nodes are operational");
    return 2;
}

static int transfer_all(char **arguments)
{
    struct job job = { .write = strncmp(arguments[0], "write", 5) == 0,
                       .block = strstr(arguments[0], "-block") != NULL,
                       .node = atoi(arguments[1]),
                       .index = (int)strtoul(arguments[2], NULL, 0),
                       .size = atoi(arguments[3]),
                       .count = strtoul(arguments[4], NULL, 0) };
    int result;

    job.check = job.size > 4;
    job.data = malloc((size_t)job.size);
    if (!job.data)
        return 1;
    mcanOpenStart();
    for (int i = 0; i < job.size; i++)
        job.data[i] = job.write ? pattern((unsigned long)i) : 0;
    result = run(&job);
    free(job.data);
    return result;
}

int main(int argc, char **argv)
{
    const bool boots = argc == 3 && strcmp(argv[2], "boot") == 0;
    int result;

    if (argc != 7 && !boots)
        return explain();
    result = configure(argv[1]);
    if (result == 0)
        result = boots ? boot() : transfer_all(&argv[2]);
    mcanOpenCleanup();
    return result;
}
