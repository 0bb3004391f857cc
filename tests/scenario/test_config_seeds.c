/*
 * Tools write whatever they like to the manager's dictionary, at any moment, while devices come and
 * go: in the end the network is what was written last. CONFIG_SEEDS tells how many plants.
 */
#include "base/bytes.h"
#include "support/suite.h"
#include "support/tool.h"

#include <stdio.h>
#include <stdlib.h>

#define FIRST   5u
#define LAST    10u
#define ACTIONS 60u

static uint32_t state;

static uint32_t below(uint32_t limit)
{
    state ^= state << 13;
    state ^= state >> 17;
    state ^= state << 5;
    return state % limit;
}

static uint8_t any_node(void)
{
    return (uint8_t)(FIRST + below(LAST - FIRST + 2u)); /* one of them is no device */
}

static uint8_t any_node_or_all(void)
{
    return below(4) == 0 ? 0x80 : any_node();
}

#define PICK(...)                                                                                  \
    ((const uint32_t[]){                                                                           \
        __VA_ARGS__ })[below(sizeof((uint32_t[]){ __VA_ARGS__ }) / sizeof(uint32_t))]

/* --- what may happen --- */

/* One or two values, nothing, something that the device refuses, something that is wrong. */
static void write_concise(struct plant *plant)
{
    uint8_t bytes[20] = { 2, 0, 0, 0, 0x00, 0x62, 1, 1, 0, 0, 0, 0, 0x01, 0x62, 1, 1, 0, 0, 0, 0 };
    const uint32_t size = PICK(20, 20, 12, 4, 15);

    bytes[0] = size == 4 ? 0 : size == 12 ? 1 : 2;
    bytes[11] = (uint8_t)below(256);
    bytes[6] = (uint8_t)PICK(1, 1, 1, 9);
    tool_write(plant, 0x1F22, any_node(), bytes, size);
}

static void write_node(struct plant *plant)
{
    const uint8_t node = any_node();

    switch (below(4)) {
    case 0: tool_put(plant, 0x1F88, node, 4, PICK(0, node, 99)); break;
    case 1: tool_put(plant, 0x1016, node, 4, PICK(0, (uint32_t)node << 16 | 500)); break;
    case 2: tool_put(plant, 0x1F8A, node, 1, PICK(0, 1, 2, 3)); break;
    default:
        tool_put(plant, 0x1F81, node, 4, PICK(0, 1, 5, 5, 5, 0xD, 0x00640315, 0x85, 0x00640305));
    }
}

static void write_network(struct plant *plant)
{
    if (below(2) == 0)
        tool_put(plant, 0x1F80, 0, 4, PICK(1, 3, 9, 0x11));
    else
        tool_put(plant, 0x1F89, 0, 4, PICK(0, 500, 5000));
}

static void switch_device(struct plant *plant)
{
    const uint8_t node = (uint8_t)(FIRST + below(LAST - FIRST + 1u));

    plant_power(plant, node, below(3) > 0);
}

static void act(struct plant *plant)
{
    switch (below(8)) {
    case 0:
    case 1: write_concise(plant); break;
    case 2:
    case 3: write_node(plant); break;
    case 4: write_network(plant); break;
    case 5: tool_put(plant, 0x1F25, any_node_or_all(), 4, 0x666E6F63); break;
    case 6: tool_put(plant, 0x1F82, any_node_or_all(), 1, PICK(5, 6, 7, 0x7F)); break;
    default: switch_device(plant);
    }
    plant_run_ms(plant, PICK(0, 1, 20, 100, 300, 1500));
}

/* --- the plant --- */

static struct plant *make_plant(void)
{
    struct plant *plant = plant_new("", 1000000);

    for (uint8_t node = FIRST; node <= LAST; node++) {
        struct plant_device *device = plant_add_device(plant, node);

        plant_add_object(device, 0x1011, 1, 4, 1);
        plant_add_object(device, 0x1011, 2, 4, 1);
        plant_add_object(device, 0x6200, 1, 1, 0);
        plant_add_object(device, 0x6201, 1, 1, 0);
    }
    tool_attach(plant);
    plant_power_on(plant);
    return plant;
}

static void configure_node(struct plant *plant, uint8_t node)
{
    uint8_t bytes[] = { 1, 0, 0, 0, 0x00, 0x62, 1, 1, 0, 0, 0, node };

    ck_assert_uint_eq(tool_write(plant, 0x1F22, node, bytes, sizeof bytes), 0);
    ck_assert_uint_eq(tool_put(plant, 0x1016, node, 4, 0), 0);
    ck_assert_uint_eq(tool_put(plant, 0x1F88, node, 4, node), 0);
    ck_assert_uint_eq(tool_put(plant, 0x1F81, node, 4, 0xD), 0);
}

static void mend(struct plant *plant)
{
    for (uint8_t node = FIRST; node <= LAST; node++)
        plant_power(plant, node, true);
    plant_run_ms(plant, 5000);
    ck_assert_uint_eq(tool_put(plant, 0x1F81, LAST + 1, 4, 0), 0);
    ck_assert_uint_eq(tool_put(plant, 0x1F80, 0, 4, 1), 0);
    ck_assert_uint_eq(tool_put(plant, 0x1F89, 0, 4, 0), 0);
    for (uint8_t node = FIRST; node <= LAST; node++)
        configure_node(plant, node);
    tool_boot_all(plant);
    plant_run_ms(plant, 3000);
}

static void run(unsigned seed)
{
    struct plant *plant = make_plant();

    snprintf(plant->name, sizeof plant->name, "seed %u", seed);
    state = seed * 2654435761u | 1u;
    for (unsigned i = 0; i < ACTIONS; i++)
        act(plant);
    mend(plant);
    for (uint8_t node = FIRST; node <= LAST; node++) {
        const struct plant_device *device = plant->devices[node];

        ck_assert_msg(device->slave.state == NMT_OPERATIONAL &&
                          od_number(&device->od, 0x6200, 1, 0) == node,
                      "seed %u: node %u is %d, %lu\n%s", seed, node, device->slave.state,
                      (unsigned long)od_number(&device->od, 0x6200, 1, 0), plant->events);
    }
    plant_free(plant);
}

START_TEST(test_seeds)
{
    const char *wanted = getenv("CONFIG_SEEDS");
    const unsigned count = wanted ? (unsigned)strtoul(wanted, NULL, 10) : 40;

    for (unsigned seed = (unsigned)_i + 1; seed <= count; seed += 4)
        run(seed);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("config_seeds");

    tcase_add_loop_test(tcase, test_seeds, 0, 4);
    tcase_set_timeout(tcase, 600);
    return suite_run("config_seeds", tcase);
}
