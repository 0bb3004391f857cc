/*
 * Concise DCF: what is accepted reads back to exactly its bytes; and as the stored values of a
 * device: what fits is what the device has, and what it would store.
 */
#include "slave/slave_store.h"

#include <stdlib.h>
#include <string.h>

#define NODE   5u
#define FRAMES 64u
#define EVENTS 64u

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check(bool good)
{
    if (!good)
        abort();
}

static void check_copy(const struct ccf *ccf, const uint8_t *data, size_t size)
{
    struct ccf copy;
    struct ccf_reader reader;
    struct ccf_entry entry;

    ccf_init(&copy);
    ccf_reader_init(&reader, ccf);
    while (ccf_read(&reader, &entry))
        check(ccf_append(&copy, entry.index, entry.sub, entry.value, entry.size) == CO_OK);
    check(ccf_count(ccf) == 0 || (copy.size == size && memcmp(copy.bytes, data, size) == 0));
    ccf_done(&copy);
}

/* ---- a device ---- */

static const struct {
    uint16_t index;
    uint8_t sub, type, access;
} objects[] = {
    { 0x1005, 0, OD_UNSIGNED32, OD_RW },     { 0x1006, 0, OD_UNSIGNED32, OD_RW },
    { 0x1010, 1, OD_UNSIGNED32, OD_RW },     { 0x1012, 0, OD_UNSIGNED32, OD_RW },
    { 0x1016, 1, OD_UNSIGNED32, OD_RW },     { 0x1017, 0, OD_UNSIGNED16, OD_RW },
    { 0x1020, 1, OD_UNSIGNED32, OD_RW },     { 0x1400, 1, OD_UNSIGNED32, OD_RW },
    { 0x1400, 2, OD_UNSIGNED8, OD_RW },      { 0x1600, 0, OD_UNSIGNED8, OD_RW },
    { 0x1600, 1, OD_UNSIGNED32, OD_RW },     { 0x1800, 1, OD_UNSIGNED32, OD_RW },
    { 0x1800, 2, OD_UNSIGNED8, OD_RW },      { 0x1A00, 0, OD_UNSIGNED8, OD_RW },
    { 0x1A00, 1, OD_UNSIGNED32, OD_RW },     { 0x2000, 0, OD_UNSIGNED16, OD_RW },
    { 0x2001, 0, OD_VISIBLE_STRING, OD_RW }, { 0x2002, 0, OD_UNSIGNED8, OD_RO },
    { 0x2003, 0, OD_DOMAIN, OD_RW },         { 0x2004, 0, OD_REAL32, OD_WO },
};

static void make_objects(struct od *od)
{
    od_init(od);
    for (size_t i = 0; i < sizeof objects / sizeof objects[0]; i++) {
        const struct od_spec spec = { .index = objects[i].index,
                                      .sub = objects[i].sub,
                                      .type = objects[i].type,
                                      .access = objects[i].access,
                                      .mappable = objects[i].index >= 0x2000 };

        check(od_add(od, &spec, NULL) == CO_OK);
    }
}

static void check_values(const struct od *od)
{
    for (size_t i = 0; i < od->count; i++) {
        const struct od_entry *entry = od->entries[i];

        check(entry->size <= entry->capacity);
        if (od_is_parameter(entry))
            check(od_check_value(entry, entry->value, entry->size) == SDO_OK);
    }
}

/* It lives with these values, whatever they are. */
static void run_device(struct od *od)
{
    struct co_frame frames[FRAMES];
    struct co_event events[EVENTS];
    struct co_outbox out;
    struct slave slave;

    check(slave_init(&slave, NODE, od) == CO_OK);
    co_outbox_init(&out, frames, FRAMES, events, EVENTS);
    slave_switch_on(&slave, 0, &out);
    slave_command(&slave, NMT_START, 1, &out);
    for (unsigned i = 0; i < 20 && slave_deadline(&slave) < CO_MS(10000); i++) {
        co_outbox_init(&out, frames, FRAMES, events, EVENTS);
        slave_on_time(&slave, slave_deadline(&slave), &out);
    }
    slave_done(&slave);
}

static void check_recall(const struct ccf *ccf)
{
    struct co_report report = { .file = "fuzz" };
    struct od od;

    make_objects(&od);
    check(slave_recall_image(&od, ccf, &report) == CO_OK);
    check_values(&od);
    run_device(&od);
    check(slave_recall_image(&od, NULL, NULL) == CO_OK);
    for (size_t i = 0; i < od.count; i++)
        if (od_is_parameter(od.entries[i]))
            check(od_same(od_power_on(od.entries[i]), od_default(od.entries[i])));
    od_done(&od);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct co_report report = { .file = "fuzz" };
    struct ccf ccf;

    if (ccf_parse(data, size, &report, &ccf) != CO_OK) {
        check(report.errors > 0);
        return 0;
    }
    check_copy(&ccf, data, size);
    check_recall(&ccf);
    ccf_done(&ccf);
    return 0;
}
