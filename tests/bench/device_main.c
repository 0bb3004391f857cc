/* bench_device: one device that does one thing, see usage. */
#include "device.h"

#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct verb {
    const char *name;
    int (*run)(unsigned long number);
    const char *text;
} verbs[] = {
    { "serve", device_serve, "an SDO server" },
    { "serve-domains", device_serve_domains, "the same with 1 KiB, 64 KiB and 1 MiB" },
    { "write-pdo", device_write_pdo, "N TPDOs by canOpenWritePDO, as fast as it can" },
    { "write-dictionary", device_write_dictionary, "the same by canOpenWriteDictionaryHnd" },
    { "count-pdos", device_count_pdos,
      "RPDOs with a counter: how many were received, how many not" },
    { "time-pdos", device_time_pdos,
      "RPDOs with the time they were sent: how long until the handler" },
    { "answer-sync", device_answer_sync, "a TPDO for each SYNC" },
    { "produce-sync", device_produce_sync, "a SYNC each N us" },
    { "idle", device_idle, "how often its threads wake up in the time of N heartbeats" },
    { "read-by-handle", device_read_by_handle, "10,000 reads of one of N objects" },
    { "read-by-index", device_read_by_index, "the same by index" },
    { "memory", device_memory, "bytes that N more nodes take" },
};

static int explain(void)
{
    puts("usage: bench_device VERB [N]; until SIGTERM, where nothing else ends it");
    for (size_t i = 0; i < sizeof verbs / sizeof verbs[0]; i++)
        printf("  %-18s %s\n", verbs[i].name, verbs[i].text);
    return 2;
}

int main(int argc, char **argv)
{
    sigset_t signals;

    sigemptyset(&signals);
    sigaddset(&signals, SIGTERM);
    sigaddset(&signals, SIGINT);
    pthread_sigmask(SIG_BLOCK, &signals, NULL);
    for (size_t i = 0; argc > 1 && i < sizeof verbs / sizeof verbs[0]; i++)
        if (strcmp(argv[1], verbs[i].name) == 0)
            return verbs[i].run(argc > 2 ? strtoul(argv[2], NULL, 0) : 0);
    return explain();
}
