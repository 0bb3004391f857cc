/*
 * bench_network NODES: a manager boots so many simulated nodes, with 20 writes each, and watches
 * their heartbeats for 10 s; for callgrind. Virtual time, no bus, no threads.
 */
#include "support/plant.h"
#include "support/suite.h"

#include <stdio.h>
#include <stdlib.h>

#define WRITES   20u
#define BEAT     1000u /* ms */
#define BOOT_MS  5000u
#define AFTER_MS 10000u

static struct plant *make_plant(unsigned nodes)
{
    char *xml = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&xml, &size);
    struct plant *plant;

    if (!stream)
        exit(1);
    for (unsigned id = 1; id <= nodes; id++)
        fprintf(stream,
                "<Node_Instance><Node_Id>%u</Node_Id>"
                "<Consumer_Heartbeat_Time>%u</Consumer_Heartbeat_Time></Node_Instance>",
                id, 3 * BEAT);
    fclose(stream);
    plant = plant_new(xml, 1000000);
    free(xml);
    return plant;
}

static void add_node(struct plant *plant, uint8_t id)
{
    struct plant_device *device = plant_add_device(plant, id);

    for (uint8_t i = 1; i < WRITES; i++) {
        plant_add_object(device, 0x6200, i, 4, 0);
        plant_configure(plant, id, 0x6200, i, 4, i);
    }
    plant_configure(plant, id, 0x1017, 0, 2, BEAT);
}

static unsigned nodes;

START_TEST(test_boot)
{
    struct plant *plant = make_plant(nodes);

    for (unsigned id = 1; id <= nodes; id++)
        add_node(plant, (uint8_t)id);
    plant_power_on(plant);
    plant_run_ms(plant, BOOT_MS + AFTER_MS);
    ck_assert(manager_is_up(plant->manager, true));
    plant_free(plant);
}
END_TEST

/* What it is made of asserts with Check. */
int main(int argc, char **argv)
{
    TCase *tcase = tcase_create("boot");

    nodes = argc == 2 ? (unsigned)strtoul(argv[1], NULL, 10) : 0;
    if (nodes < 1 || nodes > 126)
        return 2;
    setenv("CK_FORK", "no", 1);
    tcase_add_test(tcase, test_boot);
    return suite_run("network", tcase);
}
