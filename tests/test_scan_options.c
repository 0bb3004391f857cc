/*
 * SLAVE_NODE_INFO and the arguments of canOpenCreateNode: which objects of the communication
 * profile a node gets, with which values, as an SDO client sees them.
 */
#include "support/scan_plant.h"
#include "support/suite.h"

#include <stdio.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))
#define NO_OBJECT    0x06020000u
#define NO_SUBINDEX  0x06090011u
#define NODE         5

static struct scan_plant *plant;

static void set_up(void)
{
    plant = scan_plant_new(0);
}

static void tear_down(void)
{
    scan_plant_free(plant);
}

static uint32_t value_at(unsigned index, unsigned sub)
{
    uint32_t value = 0;
    uint32_t abort_code = scan_sdo_read(plant, NODE, index, sub, &value);

    ck_assert_msg(abort_code == 0, "%04X:%02X: %08X", index, sub, abort_code);
    return value;
}

static void expect_text(unsigned index, const char *text)
{
    char got[64] = "";
    unsigned size = sizeof got;

    ck_assert_uint_eq(scan_sdo_upload(plant, NODE, index, 0, got, &size), 0);
    ck_assert_uint_eq(size, strlen(text));
    ck_assert_str_eq(got, text);
}

/* All members have a value, so that each flag has what it needs. */
static const unsigned long producers[] = { CHBT_ENTRY(7, 1500), CHBT_ENTRY(0x7F, 0xFFFF),
                                           END_OF_CHBT_LIST };

static SLAVE_NODE_INFO full_info(unsigned long options)
{
    return (SLAVE_NODE_INFO){ .ulOptions = options,
                              .ulDeviceType = 0x00020192,
                              .usRxPDO = 2,
                              .usTxPDO = 3,
                              .ucServerSDO = 3,
                              .ucMaxErrors = 6,
                              .ucMaxIdentityObject = 4,
                              .ulVendorId = 0x29A,
                              .ulProductCode = 0x11223344,
                              .ulRevisionNumber = 0x00010002,
                              .ulSerialNumber = 0xFFFFFFFFUL,
                              .pszDeviceName = "a device with a name",
                              .pszHwVersion = "hw",
                              .pszSwVersion = "1.2.3",
                              .ulSyncCobID = DEFAULT_SYNC_COBID,
                              .ulCyclePeriod = 0,
                              .pulListCHBT = producers,
                              .usGuardTime = 500,
                              .usProducerHbTime = 1000,
                              .ucLifeTime = 3,
                              .ucMaxConsumerHB = 4,
                              .ucErrorBehaviour = ERROR_BEHAVIOUR_STOP };
}

static HNODE make(const SLAVE_NODE_INFO *info)
{
    HNODE node = scan_node(plant, NODE, info);

    scan_activate(plant, node);
    return node;
}

/* --- flags --- */

static const struct presence {
    unsigned index;
    unsigned long flags; /* any of them; 0: always there */
} presences[] = {
    { 0x1000, 0 },
    { 0x1001, 0 },
    { 0x1002, STATE_REGISTER },
    { 0x1003, ERROR_REGISTER },
    { 0x1005, SYNCHRON_PDOS | SYNC_GENERATION },
    { 0x1006, SYNCHRON_PDOS | SYNC_GENERATION },
    { 0x1007, SYNCHRON_PDOS | SYNC_GENERATION },
    { 0x1008, MANUFACTURER_INFO },
    { 0x1009, MANUFACTURER_INFO },
    { 0x100A, MANUFACTURER_INFO },
    { 0x100C, GUARDING },
    { 0x100D, GUARDING },
    { 0x1010, PARAMETER_STORE },
    { 0x1011, PARAMETER_RESET },
    { 0x1012, TIME_STAMP },
    { 0x1014, 0 },
    { 0x1015, 0 },
    { 0x1016, CONSUMER_HEARTBEAT },
    { 0x1017, PRODUCER_HEARTBEAT },
    { 0x1018, 0 },
    { 0x1020, PARAMETER_STORE },
    { 0x1028, EMCY_CONSUMER },
    { 0x1029, ERROR_BEHAVIOUR_OBJECT },
    { 0x1200, 0 },
    { 0x1201, ADDITIONAL_SDOS },
    { 0x1202, ADDITIONAL_SDOS },
};

static const unsigned long option_sets[] = {
    0,
    BLOCK_TRANSFER,
    STATE_REGISTER,
    ERROR_REGISTER,
    SYNCHRON_PDOS,
    MANUFACTURER_INFO,
    GUARDING,
    PARAMETER_STORE,
    PARAMETER_RESET,
    ADDITIONAL_SDOS,
    SYNC_GENERATION,
    CONSUMER_HEARTBEAT,
    PRODUCER_HERTBEAT,
    EMCY_CONSUMER,
    ERROR_BEHAVIOUR_OBJECT,
    PDO_ACCEPT_LONG,
    TIME_STAMP,
    STATE_REGISTER | ERROR_REGISTER | SYNCHRON_PDOS | MANUFACTURER_INFO | GUARDING |
        PARAMETER_STORE | PARAMETER_RESET | ADDITIONAL_SDOS | SYNC_GENERATION | EMCY_CONSUMER |
        ERROR_BEHAVIOUR_OBJECT | CONSUMER_HEARTBEAT,
};

START_TEST(which_objects_a_node_has)
{
    unsigned long options = option_sets[_i];
    const SLAVE_NODE_INFO info = full_info(options);

    make(&info);
    for (unsigned i = 0; i < COUNT(presences); i++) {
        bool there = presences[i].flags == 0 || (presences[i].flags & options) != 0;
        uint8_t bytes[64];
        unsigned size = sizeof bytes;
        uint32_t abort_code = scan_sdo_upload(plant, NODE, presences[i].index, 0, bytes, &size);

        ck_assert_msg(abort_code == (there ? 0 : NO_OBJECT), "%04X with options %lX: %08X",
                      presences[i].index, options, abort_code);
    }
}
END_TEST

/* --- members --- */

START_TEST(values_of_the_members)
{
    SLAVE_NODE_INFO info = full_info(option_sets[COUNT(option_sets) - 1]);

    info.ulEmcyCobId = 0x181;
    info.usEmcyInhibit = 6553;
    info.ulSyncCobID = 0x90;
    make(&info);
    ck_assert_uint_eq(value_at(0x1000, 0), 0x00020192);
    ck_assert_uint_eq(value_at(0x1001, 0), 0);
    ck_assert_uint_eq(value_at(0x1003, 0), 0);
    ck_assert_uint_eq(value_at(0x1005, 0), 0x90);
    ck_assert_uint_eq(value_at(0x1006, 0), 0);
    expect_text(0x1008, "a device with a name");
    expect_text(0x1009, "hw");
    expect_text(0x100A, "1.2.3");
    ck_assert_uint_eq(value_at(0x100C, 0), 500);
    ck_assert_uint_eq(value_at(0x100D, 0), 3);
    ck_assert_uint_eq(value_at(0x1014, 0), 0x181);
    ck_assert_uint_eq(value_at(0x1015, 0), 65530);
    ck_assert_uint_eq(value_at(0x1029, 0), 1);
    ck_assert_uint_eq(value_at(0x1029, 1), ERROR_BEHAVIOUR_STOP);
}
END_TEST

static const struct count_row {
    unsigned index, highest;
} count_rows[] = {
    { 0x1016, 4 }, /* ucMaxConsumerHB */
    { 0x1018, 4 }, /* ucMaxIdentityObject */
    { 0x1020, 2 }, { 0x1200, 2 }, { 0x1202, 3 },
};

START_TEST(numbers_of_entries)
{
    const SLAVE_NODE_INFO info = full_info(option_sets[COUNT(option_sets) - 1]);
    uint32_t value;

    make(&info);
    for (unsigned i = 0; i < COUNT(count_rows); i++) {
        const struct count_row *row = &count_rows[i];

        ck_assert_uint_eq(value_at(row->index, 0), row->highest);
        value_at(row->index, row->highest);
        ck_assert_uint_eq(scan_sdo_read(plant, NODE, row->index, row->highest + 1, &value),
                          NO_SUBINDEX);
    }
    ck_assert_uint_eq(scan_sdo_read(plant, NODE, 0x1003, 7, &value), NO_SUBINDEX);
    ck_assert_uint_ne(scan_sdo_read(plant, NODE, 0x1003, 6, &value), NO_SUBINDEX);
    ck_assert_uint_eq(scan_sdo_read(plant, NODE, 0x1203, 0, &value), NO_OBJECT);
}
END_TEST

START_TEST(heartbeats_to_watch)
{
    const SLAVE_NODE_INFO info = full_info(CONSUMER_HEARTBEAT);

    make(&info);
    ck_assert_uint_eq(value_at(0x1016, 1), 0x000705DC);
    ck_assert_uint_eq(value_at(0x1016, 2), 0x007FFFFF);
    ck_assert_uint_eq(value_at(0x1016, 3), 0);
}
END_TEST

START_TEST(the_own_heartbeat)
{
    SLAVE_NODE_INFO info = full_info(PRODUCER_HEARTBEAT);
    HNODE node;

    info.usProducerHBTime = 20;
    node = make(&info);
    ck_assert_uint_eq(value_at(0x1017, 0), 20);
    scan_await(plant, "705#7F");
    scan_await(plant, "705#7F");
    scan_operational(plant, node);
    scan_await(plant, "705#05");
}
END_TEST

static const struct identity_row {
    unsigned char count;
    uint32_t values[4];
} identity_rows[] = {
    { 1, { 0x29A } },
    { 2, { 0x29A, 0x11223344 } },
    { 3, { 0x29A, 0x11223344, 0x00010002 } },
    { 4, { 0x29A, 0x11223344, 0x00010002, 0xFFFFFFFF } },
};

START_TEST(identities)
{
    const struct identity_row *row = &identity_rows[_i];
    SLAVE_NODE_INFO info = full_info(0);
    uint32_t value;

    info.ucMaxIdentityObject = row->count;
    make(&info);
    ck_assert_uint_eq(value_at(0x1018, 0), row->count);
    for (unsigned i = 0; i < row->count; i++)
        ck_assert_uint_eq(value_at(0x1018, i + 1), row->values[i]);
    ck_assert_uint_eq(scan_sdo_read(plant, NODE, 0x1018, row->count + 1u, &value), NO_SUBINDEX);
}
END_TEST

START_TEST(defaults_of_the_members)
{
    SLAVE_NODE_INFO info = full_info(SYNCHRON_PDOS | PRODUCER_HEARTBEAT | ERROR_BEHAVIOUR_OBJECT);

    info.ulEmcyCobId = DEFAULT_EMCY_COBID;
    info.usEmcyInhibit = DEFAULT_EMCY_INHIBIT_TIME;
    info.usProducerHbTime = DEFAULT_PRODUCER_HEARTBEAT_TIME;
    info.ulSyncCobID = DEFAULT_SYNC_COBID;
    info.ucErrorBehaviour = ERROR_BEHAVIOUR_DEFAULT;
    make(&info);
    ck_assert_uint_eq(value_at(0x1005, 0), 0x80);
    ck_assert_uint_eq(value_at(0x1014, 0), 0x80 + NODE);
    ck_assert_uint_eq(value_at(0x1015, 0), 0);
    ck_assert_uint_eq(value_at(0x1017, 0), 0);
    ck_assert_uint_eq(value_at(0x1029, 1), ERROR_BEHAVIOUR_DEFAULT);
}
END_TEST

/* Members that are kept for later, and those that only the flag makes valid. */
START_TEST(members_that_are_not_looked_at)
{
    SLAVE_NODE_INFO info = full_info(0);
    uint32_t value;

    info.ucServerSDO = 0;
    info.ucClientSDO = 200;
    info.ucMaxErrors = 255;
    info.ulSyncWindowLen = 77;
    info.ulTimestampCobId = 0x100;
    info.ulCyclePeriod = 1000;
    info.pszDevicename = NULL;
    info.pszHwVersion = NULL;
    info.pszSwVersion = NULL;
    info.pulListCHBT = NULL;
    info.ucMaxConsumerHB = 255;
    info.ucErrorBehaviour = 200;
    info.ucLifetime = 0;
    make(&info);
    ck_assert_uint_eq(scan_sdo_read(plant, NODE, 0x1017, 0, &value), NO_OBJECT);
}
END_TEST

/* Strings are copied. */
START_TEST(names_are_copied)
{
    char name[] = "first";
    SLAVE_NODE_INFO info = full_info(MANUFACTURER_INFO);

    info.pszDevicename = name;
    make(&info);
    memset(name, 'x', sizeof name);
    expect_text(0x1008, "first");
}
END_TEST

/* --- members that are refused --- */

struct change {
    const char *name;
    unsigned long options;
    void (*make)(SLAVE_NODE_INFO *info);
};

#define CHANGE(name, statement)                                                                    \
    static void name(SLAVE_NODE_INFO *info)                                                        \
    {                                                                                              \
        info->statement;                                                                           \
    }

static const unsigned long node_0[] = { CHBT_ENTRY(0, 100), END_OF_CHBT_LIST };
static const unsigned long node_128[] = { CHBT_ENTRY(128, 100), END_OF_CHBT_LIST };
static const unsigned long twice[] = { CHBT_ENTRY(7, 100), CHBT_ENTRY(7, 200), END_OF_CHBT_LIST };
static const unsigned long five[] = { CHBT_ENTRY(1, 1), CHBT_ENTRY(2, 1), CHBT_ENTRY(3, 1),
                                      CHBT_ENTRY(4, 1), CHBT_ENTRY(6, 1), END_OF_CHBT_LIST };

CHANGE(rx_pdos, usRxPDO = 513)
CHANGE(tx_pdos, usTxPDO = 513)
CHANGE(no_servers, ucServerSDO = 0)
CHANGE(many_servers, ucServerSDO = 128)
CHANGE(no_errors, ucMaxErrors = 0)
CHANGE(many_errors, ucMaxErrors = 128)
CHANGE(no_identity, ucMaxIdentityObject = 0)
CHANGE(large_identity, ucMaxIdentityObject = 5)
CHANGE(no_device_name, pszDeviceName = NULL)
CHANGE(no_hardware, pszHwVersion = NULL)
CHANGE(no_software, pszSwVersion = NULL)
CHANGE(sync_of_nmt, ulSyncCobID = 0)
CHANGE(sync_of_sdo, ulSyncCobID = 0x601)
CHANGE(emcy_of_sdo, ulEmcyCobId = 0x581)
CHANGE(emcy_inhibit, usEmcyInhibit = 6554)
CHANGE(no_consumers, ucMaxConsumerHB = 0)
CHANGE(many_consumers, ucMaxConsumerHB = 128)
CHANGE(list_node_0, pulListCHBT = node_0)
CHANGE(list_node_128, pulListCHBT = node_128)
CHANGE(list_twice, pulListCHBT = twice)
CHANGE(list_long, pulListCHBT = five)
CHANGE(behaviour, ucErrorBehaviour = ERROR_BEHAVIOUR_STOP + 1)
CHANGE(unknown_option, ulOptions |= 0x40000000UL)
CHANGE(highest_option, ulOptions |= 0x80000000UL)

static const struct change changes[] = {
    { "usRxPDO 513", 0, rx_pdos },
    { "usTxPDO 513", 0, tx_pdos },
    { "ucServerSDO 0", ADDITIONAL_SDOS, no_servers },
    { "ucServerSDO 128", ADDITIONAL_SDOS, many_servers },
    { "ucMaxErrors 0", ERROR_REGISTER, no_errors },
    { "ucMaxErrors 128", ERROR_REGISTER, many_errors },
    { "ucMaxIdentityObject 0", 0, no_identity },
    { "ucMaxIdentityObject 5", 0, large_identity },
    { "pszDeviceName NULL", MANUFACTURER_INFO, no_device_name },
    { "pszHwVersion NULL", MANUFACTURER_INFO, no_hardware },
    { "pszSwVersion NULL", MANUFACTURER_INFO, no_software },
    { "ulSyncCobID 0", SYNCHRON_PDOS, sync_of_nmt },
    { "ulSyncCobID 601", SYNC_GENERATION, sync_of_sdo },
    { "ulEmcyCobId 581", 0, emcy_of_sdo },
    { "usEmcyInhibit 6554", 0, emcy_inhibit },
    { "ucMaxConsumerHB 0", CONSUMER_HEARTBEAT, no_consumers },
    { "ucMaxConsumerHB 128", CONSUMER_HEARTBEAT, many_consumers },
    { "pulListCHBT node 0", CONSUMER_HEARTBEAT, list_node_0 },
    { "pulListCHBT node 128", CONSUMER_HEARTBEAT, list_node_128 },
    { "pulListCHBT a node twice", CONSUMER_HEARTBEAT, list_twice },
    { "pulListCHBT longer than ucMaxConsumerHB", CONSUMER_HEARTBEAT, list_long },
    { "ucErrorBehaviour 3", ERROR_BEHAVIOUR_OBJECT, behaviour },
    { "ulOptions 40000000", 0, unknown_option },
    { "ulOptions 80000000", 0, highest_option },
};

START_TEST(members_out_of_range)
{
    const struct change *row = &changes[_i];
    SLAVE_NODE_INFO info = full_info(row->options);
    HNODE node = NULL;
    int result;

    row->make(&info);
    result = canOpenCreateNodeEx(0, NODE, NULL, &info, &node);
    ck_assert_msg(result == SCANOPEN_WRONG_PARAMETER, "%s: %d", row->name, result);
    ck_assert_ptr_null(node);
    info = full_info(row->options);
    make(&info); /* the node-ID is still free */
}
END_TEST

/* --- the older form --- */

static HNODE make_old(int options)
{
    HNODE node = NULL;

    ck_assert_int_eq(canOpenCreateNode(0, "old", NODE, 0x191, options, 5, "old device", "h", "s",
                                       700, 4, 1, 0, NULL, &node),
                     SCANOPEN_OK);
    return node;
}

static void delete_node(HNODE node)
{
    ck_assert_int_eq(canOpenResetNode(node), SCANOPEN_OK);
    ck_assert_int_eq(canOpenDeleteNode(node), SCANOPEN_OK);
}

START_TEST(a_node_of_the_older_form)
{
    HNODE node = make_old(STATE_REGISTER | ERROR_REGISTER | ADDITIONAL_PDOS | SYNCHRON_PDOS |
                          MANUFACTURER_INFO | GUARDING | PARAMETER_STORE | PARAMETER_RESET);

    ck_assert_int_eq(canOpenActivateNode(node), SCANOPEN_OK);
    scan_await(plant, "705#00");
    ck_assert_uint_eq(value_at(0x1000, 0), 0x191);
    ck_assert_uint_eq(value_at(0x1001, 0), 0);
    ck_assert_uint_eq(value_at(0x1002, 0), 0);
    ck_assert_uint_eq(value_at(0x1003, 0), 0);
    value_at(0x1004, 0);
    ck_assert_uint_eq(value_at(0x1005, 0), 0x80);
    expect_text(0x1008, "old device");
    expect_text(0x1009, "h");
    expect_text(0x100A, "s");
    ck_assert_uint_eq(value_at(0x100B, 0), NODE);
    ck_assert_uint_eq(value_at(0x100C, 0), 700);
    ck_assert_uint_eq(value_at(0x100D, 0), 4);
    ck_assert_uint_eq(value_at(0x100E, 0), 0x700 + NODE);
    value_at(0x1010, 0);
    value_at(0x1011, 0);
    delete_node(node);
}
END_TEST

START_TEST(an_older_node_without_options)
{
    const unsigned absent[] = { 0x1002, 0x1003, 0x1004, 0x1005, 0x1008, 0x100C, 0x100E, 0x1010 };
    HNODE node = make_old(0);
    uint32_t value;

    ck_assert_int_eq(canOpenActivateNode(node), SCANOPEN_OK);
    scan_await(plant, "705#00");
    for (unsigned i = 0; i < COUNT(absent); i++)
        ck_assert_uint_eq(scan_sdo_read(plant, NODE, absent[i], 0, &value), NO_OBJECT);
    ck_assert_uint_eq(value_at(0x100B, 0), NODE);
    delete_node(node);
}
END_TEST

static void add_tests(TCase *tcase)
{
    tcase_add_loop_test(tcase, which_objects_a_node_has, 0, COUNT(option_sets));
    tcase_add_test(tcase, values_of_the_members);
    tcase_add_test(tcase, numbers_of_entries);
    tcase_add_test(tcase, heartbeats_to_watch);
    tcase_add_test(tcase, the_own_heartbeat);
    tcase_add_loop_test(tcase, identities, 0, COUNT(identity_rows));
    tcase_add_test(tcase, defaults_of_the_members);
    tcase_add_test(tcase, members_that_are_not_looked_at);
    tcase_add_test(tcase, names_are_copied);
    tcase_add_loop_test(tcase, members_out_of_range, 0, COUNT(changes));
    tcase_add_test(tcase, a_node_of_the_older_form);
    tcase_add_test(tcase, an_older_node_without_options);
}

int main(void)
{
    TCase *tcase = tcase_create("options");

    tcase_set_timeout(tcase, SCAN_LIMIT);
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    add_tests(tcase);
    return suite_run("scan_options", tcase);
}
