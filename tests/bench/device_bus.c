/* What bench_device does on a bus. */
#include "device.h"

#include <dirent.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define SAMPLES      1000000u
#define IDLE_PERIOD  50u /* ms */
#define WITHOUT_PDO  (-1)
#define ASYNCHRONOUS (ASYNCHRON_PDO | 255)

/* Handlers are given no context. */
static struct {
    unsigned long count, missing;
    uint32_t next;
    uint64_t *latencies;
} received;

static uint64_t now_ns(void)
{
    struct timespec now;

    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

static void wait_for_end(void)
{
    sigset_t signals;
    int number;

    sigemptyset(&signals);
    sigaddset(&signals, SIGTERM);
    sigaddset(&signals, SIGINT);
    sigwait(&signals, &number);
}

static int run_created(const struct device *device)
{
    device_run(device);
    wait_for_end();
    device_remove(device);
    return 0;
}

static int run_until_end(struct device *device)
{
    device_create(device);
    return run_created(device);
}

int device_serve(unsigned long number)
{
    struct device device = { .transmission = WITHOUT_PDO };

    (void)number;
    return run_until_end(&device);
}

/* The yardsticks' test pattern. */
static void fill(uint8_t *memory)
{
    for (unsigned i = 0; i < DEVICE_LARGE_SIZE; i++)
        memory[i] = (uint8_t)(0x5A + i * 7 + (i >> 8) * 13 + (i >> 16) * 29);
}

int device_serve_domains(unsigned long number)
{
    static uint8_t memory[DEVICE_LARGE_SIZE];
    struct device device = { .info = { .ulOptions = BLOCK_TRANSFER }, .transmission = WITHOUT_PDO };

    (void)number;
    fill(memory);
    device_create(&device);
    device_add_domain(device.node, DEVICE_TINY, memory, DEVICE_TINY_SIZE);
    device_add_domain(device.node, DEVICE_SMALL, memory, DEVICE_SMALL_SIZE);
    device_add_domain(device.node, DEVICE_LARGE, memory, DEVICE_LARGE_SIZE);
    return run_created(&device);
}

int device_answer_sync(unsigned long number)
{
    struct device device = { .info = { .ulOptions = SYNCHRON_PDOS,
                                       .ulSyncCobID = DEFAULT_SYNC_COBID },
                             .transmission = SYNCHRON_PDO | 1 };

    (void)number;
    return run_until_end(&device);
}

int device_produce_sync(unsigned long period_us)
{
    struct device device = { .info = { .ulOptions = SYNC_GENERATION,
                                       .ulSyncCobID = DEFAULT_SYNC_COBID | SYNC_PRODUCE,
                                       .ulCyclePeriod = period_us },
                             .transmission = WITHOUT_PDO };

    return run_until_end(&device);
}

/* --- TPDOs --- */

/* The counter is in the first four bytes; the machine is little-endian, as the frames are. */
static int send_pdos(unsigned long count, int mode, bool by_dictionary)
{
    struct device device = { .transmission = mode };
    HDICT input = NULL;

    device_create(&device);
    device_need("canOpenGetDictionaryHnd",
                canOpenGetDictionaryHnd(device.node, DEVICE_INPUT, 0, &input));
    device_run(&device);
    for (uint64_t i = 0; i < count; i++) {
        if (by_dictionary)
            device_need("canOpenWriteDictionaryHnd", canOpenWriteDictionaryHnd(input, &i));
        else
            device_need("canOpenWritePDO", canOpenWritePDO(device.sent, &i));
    }
    printf("{\"sent\":%lu}\n", count);
    device_remove(&device);
    return 0;
}

int device_write_pdo(unsigned long count)
{
    return send_pdos(count, ASYNCHRONOUS, false);
}

int device_write_dictionary(unsigned long count)
{
    return send_pdos(count, ASYNCHRONOUS | AUTO_NOTIFY_PDO, true);
}

/* --- RPDOs --- */

static int on_counter(int net, int node, int index, int sub, void *data)
{
    uint32_t counter;

    (void)net, (void)node, (void)index, (void)sub;
    memcpy(&counter, data, sizeof counter);
    received.missing += counter - received.next;
    received.next = counter + 1;
    received.count++;
    return SCANOPEN_OK;
}

static int on_time(int net, int node, int index, int sub, void *data)
{
    const uint64_t now = now_ns();
    uint64_t sent;

    (void)net, (void)node, (void)index, (void)sub;
    memcpy(&sent, data, sizeof sent);
    if (received.count < SAMPLES)
        received.latencies[received.count++] = now - sent;
    return SCANOPEN_OK;
}

int device_count_pdos(unsigned long number)
{
    struct device device = { .told = on_counter, .transmission = WITHOUT_PDO };

    (void)number;
    run_until_end(&device);
    printf("{\"received\":%lu,\"missing\":%lu}\n", received.count, received.missing);
    return 0;
}

static int compare(const void *left, const void *right)
{
    const uint64_t a = *(const uint64_t *)left, b = *(const uint64_t *)right;

    return (a > b) - (a < b);
}

int device_time_pdos(unsigned long number)
{
    struct device device = { .told = on_time, .transmission = WITHOUT_PDO };
    const unsigned long *const count = &received.count;

    (void)number;
    received.latencies = calloc(SAMPLES, sizeof *received.latencies);
    if (!received.latencies)
        return 1;
    run_until_end(&device);
    qsort(received.latencies, *count, sizeof *received.latencies, compare);
    printf("{\"received\":%lu,\"p50_us\":%.1f,\"p99_us\":%.1f}\n", *count,
           *count ? (double)received.latencies[*count / 2] / 1e3 : 0.0,
           *count ? (double)received.latencies[*count * 99 / 100] / 1e3 : 0.0);
    free(received.latencies);
    return 0;
}

/* --- idling --- */

static unsigned long switches_of(const char *thread)
{
    char path[300], line[200];
    unsigned long switches = 0;
    FILE *file;

    snprintf(path, sizeof path, "/proc/self/task/%s/status", thread);
    file = fopen(path, "r");
    while (file && fgets(line, sizeof line, file))
        sscanf(line, "voluntary_ctxt_switches: %lu", &switches);
    if (file)
        fclose(file);
    return switches;
}

/* How often the library's threads have gone to sleep: all threads but this one. */
static unsigned long count_wake_ups(void)
{
    DIR *threads = opendir("/proc/self/task");
    const struct dirent *thread;
    unsigned long sum = 0;

    while (threads && (thread = readdir(threads)) != NULL)
        if (thread->d_name[0] != '.' && strtol(thread->d_name, NULL, 10) != getpid())
            sum += switches_of(thread->d_name);
    if (threads)
        closedir(threads);
    return sum;
}

static void sleep_until(uint64_t ns)
{
    const struct timespec time = { .tv_sec = (time_t)(ns / 1000000000u),
                                   .tv_nsec = (long)(ns % 1000000000u) };

    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, NULL) != 0)
        continue;
}

/* Counted from the middle between two heartbeats to the middle between two others. */
int device_idle(unsigned long heartbeats)
{
    const uint64_t period = IDLE_PERIOD * UINT64_C(1000000);
    struct device device = { .info = { .ulOptions = PRODUCER_HEARTBEAT | CONSUMER_HEARTBEAT |
                                                    EMCY_CONSUMER | SYNCHRON_PDOS,
                                       .ulSyncCobID = DEFAULT_SYNC_COBID,
                                       .ucMaxConsumerHB = 4,
                                       .usProducerHbTime = IDLE_PERIOD },
                             .told = on_counter,
                             .transmission = ASYNCHRONOUS };
    unsigned long before;
    uint64_t start;

    device_create(&device);
    start = now_ns();
    device_run(&device);
    sleep_until(start + period * 5 / 2);
    before = count_wake_ups();
    sleep_until(start + period * 5 / 2 + heartbeats * period);
    printf("{\"heartbeats\":%lu,\"wake_ups\":%lu}\n", heartbeats, count_wake_ups() - before);
    device_remove(&device);
    return 0;
}
