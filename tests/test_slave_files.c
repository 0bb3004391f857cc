/* Devices simulated from their EDS or DCF file alone, and configured by what the file says. */
#include "slave/slave.h"

#include "base/bytes.h"
#include "dcf/dcf.h"
#include "proto/event.h"
#include "proto/sdo_client.h"

#include <check.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TEXT_MAX (1u << 20)

static const char eds[] = "[DeviceInfo]\nVendorName=test\n"
                          "[DeviceComissioning]\nNodeID=9\nBaudrate=125\n"
                          "[MandatoryObjects]\nSupportedObjects=3\n1=0x1000\n2=0x1001\n3=0x1018\n"
                          "[1000]\nParameterName=type\nDataType=7\nAccessType=ro\n"
                          "DefaultValue=0x191\n"
                          "[1001]\nParameterName=error\nDataType=5\nAccessType=ro\n"
                          "[1018]\nParameterName=identity\nObjectType=9\nSubNumber=2\n"
                          "[1018sub0]\nParameterName=count\nDataType=5\nAccessType=ro\n"
                          "DefaultValue=1\n"
                          "[1018sub1]\nParameterName=vendor\nDataType=7\nAccessType=ro\n"
                          "DefaultValue=0x17F\n"
                          "[OptionalObjects]\nSupportedObjects=4\n"
                          "1=0x1014\n2=0x1017\n3=0x1400\n4=0x1600\n"
                          "[1014]\nParameterName=emcy\nDataType=7\nAccessType=rw\n"
                          "DefaultValue=$NODEID+0x80\n"
                          "[1017]\nParameterName=heartbeat\nDataType=6\nAccessType=rw\n"
                          "DefaultValue=500\nParameterValue=200\n"
                          "[1400]\nParameterName=RPDO\nObjectType=9\nSubNumber=3\n"
                          "[1400sub0]\nParameterName=count\nDataType=5\nAccessType=ro\n"
                          "DefaultValue=2\n"
                          "[1400sub1]\nParameterName=id\nDataType=7\nAccessType=rw\n"
                          "DefaultValue=$NODEID+0x200\nParameterValue=0x309\n"
                          "[1400sub2]\nParameterName=type\nDataType=5\nAccessType=rw\n"
                          "DefaultValue=255\nParameterValue=1\n"
                          "[1600]\nParameterName=mapping\nObjectType=9\nSubNumber=3\n"
                          "[1600sub0]\nParameterName=count\nDataType=5\nAccessType=rw\n"
                          "DefaultValue=1\nParameterValue=2\n"
                          "[1600sub1]\nParameterName=first\nDataType=7\nAccessType=rw\n"
                          "DefaultValue=0x20000010\nParameterValue=0x20010010\n"
                          "[1600sub2]\nParameterName=second\nDataType=7\nAccessType=rw\n"
                          "ParameterValue=0x20000010\n"
                          "[ManufacturerObjects]\nSupportedObjects=2\n1=0x2000\n2=0x2001\n"
                          "[2000]\nParameterName=a\nDataType=6\nAccessType=rww\nPDOMapping=1\n"
                          "[2001]\nParameterName=b\nDataType=6\nAccessType=rww\nPDOMapping=1\n";

static struct dcf dcf;
static struct co_report messages;
static struct od od;
static struct slave slave;
static struct sdo_client client;
static struct co_outbox from_slave, from_client;
static struct co_frame slave_frames[8], client_frames[8];
static struct co_event slave_events[8], client_events[8];
static uint8_t buffer[TEXT_MAX];
static co_us_t now;

static uint8_t node_of(const struct dcf *file)
{
    return file->has_node_id && file->node_id >= 1 && file->node_id <= 127 ? file->node_id : 5;
}

/* False where the file is refused. */
static bool power_up(const char *text, size_t size)
{
    messages = (struct co_report){ .file = "test" };
    now = 0;
    if (dcf_parse(text, size, &messages, &dcf) != CO_OK)
        return false;
    od_init(&od);
    ck_assert_int_eq(dcf_make_od(&dcf, node_of(&dcf), &messages, &od), CO_OK);
    ck_assert_int_eq(slave_init(&slave, node_of(&dcf), &od), CO_OK);
    slave.assume_sync = true;
    sdo_client_init(&client, node_of(&dcf));
    co_outbox_init(&from_slave, slave_frames, 8, slave_events, 8);
    co_outbox_init(&from_client, client_frames, 8, client_events, 8);
    slave_start(&slave, now, &from_slave);
    return true;
}

static void power_down(void)
{
    slave_done(&slave);
    od_done(&od);
    dcf_done(&dcf);
}

static void move_frames(void)
{
    struct co_frame frame;
    struct co_event event;

    while (co_outbox_take_frame(&from_client, &frame)) {
        struct co_frame own = frame;

        own.flags |= CO_FRAME_OWN;
        sdo_client_on_frame(&client, &own, now, &from_client);
        slave_on_frame(&slave, &frame, now, &from_slave);
    }
    while (co_outbox_take_frame(&from_slave, &frame))
        sdo_client_on_frame(&client, &frame, now, &from_client);
    while (co_outbox_take_event(&from_slave, &event))
        continue;
}

static struct co_event transfer(const struct sdo_transfer *transfer)
{
    struct co_event event = { .type = PROTO_NONE };

    sdo_client_start(&client, transfer, now, &from_client);
    while (event.type != PROTO_SDO_DONE) {
        move_frames();
        sdo_client_on_time(&client, now, &from_client);
        co_outbox_take_event(&from_client, &event);
        now += 100;
        slave_on_time(&slave, now, &from_slave);
    }
    return event;
}

static struct co_event write_entry(uint16_t index, uint8_t sub, const uint8_t *value, uint32_t size)
{
    return transfer(&(struct sdo_transfer){ .download = true,
                                            .indicate_size = true,
                                            .index = index,
                                            .sub = sub,
                                            .source = value,
                                            .size = size,
                                            .timeout = CO_MS(500) });
}

static struct co_event read_entry(uint16_t index, uint8_t sub)
{
    return transfer(&(struct sdo_transfer){ .index = index,
                                            .sub = sub,
                                            .buffer = buffer,
                                            .size = sizeof buffer,
                                            .timeout = CO_MS(500) });
}

static uint32_t number(uint16_t index, uint8_t sub)
{
    const struct co_event event = read_entry(index, sub);

    ck_assert_uint_eq(event.detail, SDO_OUTCOME_OK);
    return (uint32_t)get_le(buffer, (size_t)event.actual);
}

/* Writes that the device refuses, of those the file's parameter values need. */
static unsigned configure(const char *name, unsigned *refused)
{
    const struct dcf_ccf_options options = { .node_id = node_of(&dcf) };
    struct ccf_reader reader;
    struct ccf_entry entry;
    struct ccf ccf;
    unsigned count = 0;

    *refused = 0;
    ccf_init(&ccf);
    if (dcf_make_ccf(&dcf, &options, &messages, &ccf) == CO_OK) {
        ccf_reader_init(&reader, &ccf);
        for (; ccf_read(&reader, &entry); count++) {
            const struct co_event event = write_entry(entry.index, entry.sub, entry.value,
                                                      entry.size);

            if (event.detail == SDO_OUTCOME_OK)
                continue;
            ++*refused;
            printf("%s: %04X:%02X: %08X\n", name, entry.index, entry.sub, event.code);
        }
    }
    ccf_done(&ccf);
    return count;
}

START_TEST(defaults_and_configuration)
{
    unsigned refused;

    ck_assert_msg(power_up(eds, sizeof eds - 1), "%s", messages.first_error);
    ck_assert_uint_eq(slave.node, 9);
    ck_assert_uint_eq(number(0x1000, 0), 0x191);
    ck_assert_uint_eq(number(0x1018, 1), 0x17F);
    ck_assert_uint_eq(number(0x1014, 0), 0x89);
    ck_assert_uint_eq(number(0x1400, 1), 0x209);
    ck_assert_uint_eq(slave.heartbeat.period, CO_MS(500));
    ck_assert_uint_gt(configure("test", &refused), 5);
    ck_assert_uint_eq(refused, 0);
    ck_assert_uint_eq(number(0x1400, 1), 0x309);
    ck_assert_uint_eq(number(0x1400, 2), 1);
    ck_assert_uint_eq(number(0x1600, 0), 2);
    ck_assert_uint_eq(number(0x1600, 1), 0x20010010);
    ck_assert_uint_eq(number(0x1600, 2), 0x20000010);
    ck_assert_uint_eq(slave.heartbeat.period, CO_MS(200));
    slave_command(&slave, NMT_RESET_NODE, now, &from_slave);
    ck_assert_uint_eq(number(0x1400, 1), 0x209);
    ck_assert_uint_eq(slave.heartbeat.period, CO_MS(500));
    power_down();
}
END_TEST

/* Every entry of a file as the dictionary promises it: size, access right. */
static void try_all_entries(const char *name)
{
    for (size_t i = 0; i < od.count; i++) {
        const struct od_entry *entry = od.entries[i];
        const struct co_event read = read_entry(entry->index, entry->sub);
        const bool is_empty = entry->index == 0x1003 && entry->sub > 0;
        const sdo_abort_t code = is_empty                 ? SDO_NO_DATA
                                 : entry->access == OD_WO ? SDO_WRITE_ONLY
                                                          : SDO_OK;

        ck_assert_msg(read.code == code, "%s: read %04X:%02X: %08X", name, entry->index, entry->sub,
                      read.code);
        ck_assert_msg(code != SDO_OK || read.actual == entry->size, "%s: %04X:%02X: %u bytes", name,
                      entry->index, entry->sub, (unsigned)read.actual);
        if (entry->access != OD_RO && entry->access != OD_CONST)
            continue;
        ck_assert_uint_eq(write_entry(entry->index, entry->sub, buffer, 4).code, SDO_READ_ONLY);
    }
}

/* Refused by rule: these files map a part of an object. */
static bool is_known_refusal(const char *path)
{
    static const char *const names[] = { "co-pdo-transmit", "co-pdo-receive" };

    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (strstr(path, names[i]) != NULL)
            return true;
    return false;
}

static unsigned files, devices, configured;

static void try_file(const char *path, const char *text, size_t size)
{
    unsigned refused;

    files++;
    if (!power_up(text, size))
        return;
    devices++;
    ck_assert_msg(slave.state == NMT_PREOPERATIONAL || slave.state == NMT_OPERATIONAL, "%s", path);
    try_all_entries(path);
    if (dcf.is_dcf) {
        configured += configure(path, &refused) > 0;
        ck_assert_msg(refused == 0 || is_known_refusal(path), "%s: %u refused", path, refused);
    }
    power_down();
}

static int on_path(const char *path, const struct stat *status, int flag, struct FTW *ftw)
{
    static char text[TEXT_MAX];
    const char *end = strrchr(path, '.');
    FILE *file;
    size_t size;

    (void)status;
    (void)ftw;
    if (flag != FTW_F || end == NULL || (strcmp(end, ".eds") != 0 && strcmp(end, ".dcf") != 0))
        return 0;
    file = fopen(path, "rb");
    ck_assert_ptr_nonnull(file);
    size = fread(text, 1, sizeof text, file);
    fclose(file);
    try_file(path, text, size);
    return 0;
}

START_TEST(real_files)
{
    if (nftw(TEST_CORPUS_DIR, on_path, 16, FTW_PHYS) != 0) {
        printf("real_files cannot run: no files in " TEST_CORPUS_DIR "\n");
        return;
    }
    printf("%u files, %u devices, %u of them configured\n", files, devices, configured);
    ck_assert_uint_gt(devices, 9 * files / 10);
    ck_assert_uint_gt(configured, 0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("slave_files");
    TCase *tcase = tcase_create("slave_files");
    SRunner *runner = srunner_create(suite);
    int failed;

    suite_add_tcase(suite, tcase);
    tcase_set_timeout(tcase, 100);
    tcase_add_test(tcase, defaults_and_configuration);
    tcase_add_test(tcase, real_files);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
