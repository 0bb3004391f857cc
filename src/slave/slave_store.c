#include "slave/slave_internal.h"

#include <stdlib.h>
#include <string.h>

#define STORE_PARAMETERS     0x1010u
#define RESTORE_DEFAULTS     0x1011u
#define VERIFY_CONFIGURATION 0x1020u

enum group { GROUP_ALL = 1, GROUP_COMMUNICATION, GROUP_APPLICATION, GROUP_MANUFACTURER };

static const struct {
    uint16_t first, last;
} groups[] = { [GROUP_ALL] = { 0x1000, 0xFFFF },
               [GROUP_COMMUNICATION] = { 0x1000, LAST_COMMUNICATION_OBJECT },
               [GROUP_APPLICATION] = { 0x6000, 0x9FFF },
               [GROUP_MANUFACTURER] = { 0x2000, 0x5FFF } };

/* The DefaultValue of an entry: what was its power-on value before the first "save". */
struct default_value {
    struct od_entry *entry;
    uint32_t size;
    uint8_t *bytes;
};

struct slave_factory {
    size_t count;
    struct default_value *values;
    uint8_t *bytes;
};

void slave_free_factory(struct slave *self)
{
    if (self->factory == NULL)
        return;
    free(self->factory->values);
    free(self->factory->bytes);
    free(self->factory);
    self->factory = NULL;
}

/* Of bytes in the application's memory some have no copy: they are what they are. */
static uint32_t kept_size(const struct od_entry *entry)
{
    return entry->initial != NULL ? entry->initial_size : 0;
}

static size_t initial_bytes(const struct od *od)
{
    size_t bytes = 0;

    for (size_t i = 0; i < od->count; i++)
        bytes += kept_size(od->entries[i]);
    return bytes;
}

static void copy_defaults(struct slave_factory *factory, const struct od *od)
{
    uint8_t *bytes = factory->bytes;

    for (size_t i = 0; i < od->count; i++) {
        struct od_entry *entry = od->entries[i];

        factory->values[i] = (struct default_value){ entry, entry->initial_size, bytes };
        if (kept_size(entry) > 0)
            memcpy(bytes, entry->initial, entry->initial_size);
        bytes += kept_size(entry);
    }
    factory->count = od->count;
}

static enum co_err keep_factory_values(struct slave *self)
{
    if (self->factory != NULL)
        return CO_OK;
    self->factory = calloc(1, sizeof *self->factory);
    if (self->factory == NULL)
        return CO_ERR_MEMORY;
    self->factory->values = calloc(self->od->count, sizeof *self->factory->values);
    self->factory->bytes = malloc(initial_bytes(self->od) + 1);
    if (self->factory->values == NULL || self->factory->bytes == NULL) {
        slave_free_factory(self);
        return CO_ERR_MEMORY;
    }
    copy_defaults(self->factory, self->od);
    return CO_OK;
}

static enum group group_of(uint8_t sub)
{
    return sub < GROUP_MANUFACTURER ? (enum group)sub : GROUP_MANUFACTURER;
}

/* A later "save" takes the place of a "load" that waits for the reset. */
static void withdraw_load(struct slave *self, enum group group)
{
    if (group == GROUP_ALL)
        self->load = 0;
    else if (self->load & 1u << GROUP_ALL)
        self->load = 1u << GROUP_COMMUNICATION | 1u << GROUP_APPLICATION | 1u << GROUP_MANUFACTURER;
    self->load &= (uint8_t) ~(1u << group);
}

static void set_verification(struct slave *self, uint64_t date, uint64_t time)
{
    od_set_number(self->od, VERIFY_CONFIGURATION, 1, date);
    od_set_number(self->od, VERIFY_CONFIGURATION, 2, time);
}

/* Only a part was stored, or only a part loaded: not the configuration that 1020h tells. */
static enum co_err store_unverified(struct slave *self)
{
    const uint64_t date = od_number(self->od, VERIFY_CONFIGURATION, 1, 0);
    const uint64_t time = od_number(self->od, VERIFY_CONFIGURATION, 2, 0);
    enum co_err err;

    set_verification(self, 0, 0);
    err = od_store(self->od, VERIFY_CONFIGURATION, VERIFY_CONFIGURATION);
    set_verification(self, date, time);
    return err;
}

static sdo_abort_t save(struct slave *self, enum group group)
{
    enum co_err err = keep_factory_values(self);

    if (err == CO_OK)
        err = od_store(self->od, groups[group].first, groups[group].last);
    if (err == CO_OK && group != GROUP_ALL && self->application_changed)
        err = store_unverified(self);
    if (err != CO_OK)
        return SDO_HARDWARE;
    withdraw_load(self, group);
    if (group == GROUP_ALL)
        self->application_changed = false;
    return SDO_OK;
}

bool slave_is_store_command(const struct slave_write *write)
{
    return write->entry->sub != 0 &&
           (write->entry->index == STORE_PARAMETERS || write->entry->index == RESTORE_DEFAULTS);
}

sdo_abort_t slave_execute_store(struct slave *self, const struct slave_write *write)
{
    const enum group group = group_of(write->entry->sub);

    if (write->entry->index == STORE_PARAMETERS)
        return save(self, group);
    self->load |= (uint8_t)(1u << group);
    return SDO_OK;
}

static bool is_configuration(uint16_t index)
{
    return index != 0x1003 && index != VERIFY_CONFIGURATION;
}

void slave_note_change(struct slave *self, const struct slave_write *write)
{
    const struct od_entry *entry = write->entry;

    if (!is_configuration(entry->index) ||
        (entry->size == write->size && memcmp(entry->value, write->value, write->size) == 0))
        return;
    set_verification(self, 0, 0);
    if (entry->index > LAST_COMMUNICATION_OBJECT)
        self->application_changed = true;
}

/* A group's DefaultValues become the present values, and these the power-on values. */
static void load(struct slave *self, enum group group)
{
    const uint16_t first = groups[group].first, last = groups[group].last;

    od_reset(self->od, first, last);
    for (size_t i = 0; self->factory != NULL && i < self->factory->count; i++) {
        const struct default_value *value = &self->factory->values[i];

        if (value->entry->index < first || value->entry->index > last)
            continue;
        if (value->entry->initial != NULL && value->size > 0)
            memcpy(value->entry->value, value->bytes, value->size);
        value->entry->size = value->size;
    }
    if (self->factory == NULL)
        return;
    od_store(self->od, first, last);
    if (first > VERIFY_CONFIGURATION)
        store_unverified(self);
}

static void load_what_waits(struct slave *self, bool application)
{
    static const enum group all[] = { GROUP_ALL, GROUP_COMMUNICATION, GROUP_APPLICATION,
                                      GROUP_MANUFACTURER };

    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        const unsigned bit = 1u << all[i];

        if ((self->load & bit) != 0 && (application || all[i] == GROUP_COMMUNICATION)) {
            load(self, all[i]);
            self->load &= (uint8_t)~bit;
        }
    }
}

void slave_reset_objects(struct slave *self, bool application)
{
    load_what_waits(self, application);
    if (application) {
        od_reset(self->od, LAST_COMMUNICATION_OBJECT + 1, 0xFFFF);
        self->application_changed = false;
    }
    od_reset(self->od, 0x1000, LAST_COMMUNICATION_OBJECT);
    if (self->application_changed)
        set_verification(self, 0, 0);
}
