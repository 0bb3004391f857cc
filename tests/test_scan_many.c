/*
 * 255 nodes on 16 networks in one process: each SYNC sends the value of each node, and brings it to
 * its neighbour with the next one.
 */
#include "support/scan_plant.h"
#include "support/suite.h"

#define NETS       16
#define NODES_MAX  16
#define ROUNDS     5
#define INPUT      0x2000 /* sent */
#define NEIGHBOUR  0x2001 /* received */
#define SPARE_NODE (NETS * NODES_MAX - 255)

static struct net {
    struct scan_plant *plant;
    HNODE nodes[NODES_MAX];
    int count; /* nodes 1..count, in a ring */
} nets[NETS];

static HPDO define(HNODE node, uint32_t cob_id, uint16_t direction, const uint16_t *mapping)
{
    HPDO pdo = NULL;

    ck_assert_int_eq(canOpenDefinePDO(node, NULL, cob_id, (uint16_t)(direction | SYNCHRON_PDO | 1),
                                      0, 0, 0, 0, mapping, &pdo),
                     SCANOPEN_OK);
    return pdo;
}

static HNODE make_node(const struct net *net, int id)
{
    const uint16_t sent[] = { INPUT, 0, 0, 0 }, received[] = { NEIGHBOUR, 0, 0, 0 };
    SLAVE_NODE_INFO info = scan_info();
    HNODE node;

    info.ulEventMask = 0;
    node = scan_node(net->plant, id, &info);
    scan_number(node, INPUT, TYP_UINT16, READ_ACCESS | MAPPABLE, 0, NULL);
    scan_number(node, NEIGHBOUR, TYP_UINT16, READ_ACCESS | WRITE_ACCESS | MAPPABLE, 0, NULL);
    define(node, DEFAULT_PDO1, TRANSMIT_PDO, sent);
    define(node, 0x180u + (uint32_t)(id == 1 ? net->count : id - 1), RECEIVE_PDO, received);
    return node;
}

static void set_up(void)
{
    for (int n = 0; n < NETS; n++) {
        nets[n].plant = scan_plant_new(n);
        nets[n].count = NODES_MAX - (n < SPARE_NODE);
        for (int i = 0; i < nets[n].count; i++)
            nets[n].nodes[i] = make_node(&nets[n], i + 1);
    }
    for (int n = 0; n < NETS; n++)
        for (int i = 0; i < nets[n].count; i++)
            ck_assert_int_eq(canOpenActivateNode(nets[n].nodes[i]), SCANOPEN_OK);
}

static void tear_down(void)
{
    for (int n = 0; n < NETS; n++)
        scan_plant_free(nets[n].plant);
}

static uint16_t value_of(int net, int node, int round)
{
    return (uint16_t)(round << 8 | net << 4 | node);
}

static void set_values(int round)
{
    for (int n = 0; n < NETS; n++)
        for (int i = 0; i < nets[n].count; i++)
            ck_assert_int_eq(scan_set(nets[n].nodes[i], INPUT, 0, value_of(n, i, round)),
                             SCANOPEN_OK);
}

/* All networks, then each waits until the frames of all its nodes are there, in any order. */
static void sync_and_expect(int round)
{
    for (int n = 0; n < NETS; n++) {
        scan_forget(nets[n].plant);
        scan_send(nets[n].plant, "080#");
    }
    for (int n = 0; n < NETS; n++) {
        unsigned sum = 0, expected = 0;

        for (int i = 0; i < nets[n].count; i++) {
            sum += scan_next_number(nets[n].plant);
            expected += value_of(n, i, round);
        }
        ck_assert_uint_eq(sum, expected);
    }
}

static void expect_neighbours(int round)
{
    for (int n = 0; n < NETS; n++)
        for (int i = 0; i < nets[n].count; i++) {
            const int from = (i == 0 ? nets[n].count : i) - 1;
            uint32_t value = 0;

            ck_assert_uint_eq(scan_sdo_read(nets[n].plant, i + 1, NEIGHBOUR, 0, &value), 0);
            ck_assert_uint_eq(value, value_of(n, from, round));
        }
}

START_TEST(process_data_of_255_nodes)
{
    for (int n = 0; n < NETS; n++) {
        scan_send(nets[n].plant, "000#0100");
        for (int i = 0; i < nets[n].count; i++)
            ck_assert_int_eq(canOpenWaitForNodeState(nets[n].nodes[i], WFNS_OPERATIONAL),
                             NodeOperational);
    }
    for (int round = 1; round <= ROUNDS; round++) {
        set_values(round);
        sync_and_expect(round);
        sync_and_expect(round);
        expect_neighbours(round);
    }
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("many");

    tcase_set_timeout(tcase, SCAN_LIMIT);
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    tcase_add_test(tcase, process_data_of_255_nodes);
    return suite_run("scan_many", tcase);
}
