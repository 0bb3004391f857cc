/* What bench_device does without traffic: its costs are counted. */
#include "device.h"

#include <malloc.h>
#include <stdio.h>
#include <string.h>

#define READS 10000u

static HNODE create_with_objects(unsigned long objects)
{
    const SLAVE_NODE_INFO info = { .ucMaxIdentityObject = 1 };
    HNODE node;

    device_open_network();
    node = device_create_node(DEVICE_NODE, &info);
    for (unsigned long i = 0; i < objects; i++)
        device_add_number(node, (unsigned short)(DEVICE_MANY + i));
    return node;
}

/* An object in the last third; reads_0 for the difference. */
static unsigned short pick(unsigned long objects)
{
    return (unsigned short)(DEVICE_MANY + objects * 2 / 3);
}

int device_read_by_handle(unsigned long objects)
{
    HNODE node = create_with_objects(objects);
    HDICT entry = NULL;
    uint32_t value = 0;

    device_need("canOpenGetDictionaryHnd", canOpenGetDictionaryHnd(node, pick(objects), 0, &entry));
    for (unsigned i = 0; i < READS; i++)
        device_need("canOpenReadDictionaryHnd", canOpenReadDictionaryHnd(entry, &value));
    return 0;
}

int device_read_by_index(unsigned long objects)
{
    HNODE node = create_with_objects(objects);
    uint32_t value = 0;

    for (unsigned i = 0; i < READS; i++)
        device_need("canOpenReadDictionary", canOpenReadDictionary(node, pick(objects), 0, &value));
    return 0;
}

/* --- memory --- */

static size_t allocated(void)
{
    const struct mallinfo2 info = mallinfo2();

    return info.uordblks + info.hblkhd;
}

static unsigned long threads(void)
{
    FILE *file = fopen("/proc/self/status", "r");
    unsigned long count = 0;
    char line[200];

    while (file && fgets(line, sizeof line, file))
        sscanf(line, "Threads: %lu", &count);
    if (file)
        fclose(file);
    return count;
}

int device_memory(unsigned long nodes)
{
    const SLAVE_NODE_INFO info = { .ulDeviceType = 0x00020192, .ucMaxIdentityObject = 1 };
    size_t before = 0;
    unsigned long threads_before = 0;

    device_open_network();
    for (unsigned long i = 0; i < nodes + 2; i++) {
        if (i == 2) {
            before = allocated();
            threads_before = threads();
        }
        device_need("canOpenActivateNode",
                    canOpenActivateNode(device_create_node((int)i + 1, &info)));
    }
    printf("{\"nodes\":%lu,\"bytes\":%zu,\"threads\":%lu}\n", nodes, allocated() - before,
           threads() - threads_before);
    return 0;
}
