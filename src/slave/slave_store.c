#include "slave/slave_store.h"

#include "base/bytes.h"
#include "slave/slave_internal.h"

#define ERROR_HISTORY        0x1003u /* what clients write there is an order */
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

#define BIT(group)         (1u << (group))
#define APPLICATION_GROUPS (BIT(GROUP_APPLICATION) | BIT(GROUP_MANUFACTURER))
#define ALL_GROUPS         (BIT(GROUP_COMMUNICATION) | APPLICATION_GROUPS)

static enum group group_of(uint8_t sub)
{
    return sub < GROUP_MANUFACTURER ? (enum group)sub : GROUP_MANUFACTURER;
}

static bool is_in(unsigned group, uint16_t index)
{
    return index >= groups[group].first && index <= groups[group].last;
}

static bool is_in_any(unsigned bits, uint16_t index)
{
    for (unsigned group = GROUP_ALL; group <= GROUP_MANUFACTURER; group++)
        if ((bits & BIT(group)) != 0 && is_in(group, index))
            return true;
    return false;
}

static bool is_parameter(const struct od_entry *entry)
{
    return od_is_parameter(entry) && entry->index != ERROR_HISTORY;
}

/* ---- what a command does ---- */

/* A later "save" takes the place of a "load" that waits for the reset. */
static unsigned load_after(const struct slave *self, bool save, enum group group)
{
    unsigned load = self->load;

    if (!save)
        return load | BIT(group);
    if (group == GROUP_ALL)
        return 0;
    if ((load & BIT(GROUP_ALL)) != 0)
        load = (load & ~BIT(GROUP_ALL)) | ALL_GROUPS;
    return load & ~BIT(group);
}

/* Some parameter of these groups has another power-on value than its DefaultValue. */
static bool has_stored(const struct slave *self, unsigned bits)
{
    for (size_t i = 0; i < self->od->count; i++) {
        const struct od_entry *entry = self->od->entries[i];

        if (is_in_any(bits, entry->index) && is_parameter(entry) &&
            !od_same(od_power_on(entry), od_default(entry)))
            return true;
    }
    return false;
}

/* What the power-on values are after a command, and the loads that wait then. */
struct effect {
    bool save;
    enum group group;
    unsigned load;
    bool unverified; /* only a part is stored or loaded: not the configuration that 1020h tells */
};

static struct effect effect_of(const struct slave *self, bool save, enum group group)
{
    const unsigned load = load_after(self, save, group);

    return (
        struct effect){ .save = save,
                        .group = group,
                        .load = load,
                        .unverified = has_stored(self, load & APPLICATION_GROUPS) ||
                                      (save && group != GROUP_ALL && self->application_changed) };
}

static bool becomes_unverified(const struct effect *effect, const struct od_entry *entry)
{
    return effect->unverified && entry->index == VERIFY_CONFIGURATION && entry->sub != 0 &&
           od_type_size(entry->type) != 0;
}

static struct od_value value_after(const struct effect *effect, const struct od_entry *entry)
{
    static const uint8_t nought[OD_SMALL];

    if (becomes_unverified(effect, entry))
        return (struct od_value){ nought, entry->size };
    if (effect->save && is_in(effect->group, entry->index))
        return (struct od_value){ entry->value, entry->size };
    return is_in_any(effect->load, entry->index) ? od_default(entry) : od_power_on(entry);
}

/* Of a "save": its whole group, as a reset meanwhile may change the power-on values. */
static bool is_planned(const struct effect *effect, const struct od_entry *entry)
{
    return effect->save && is_parameter(entry) &&
           (is_in(effect->group, entry->index) || becomes_unverified(effect, entry));
}

static enum co_err make_plan(const struct slave *self, const struct effect *effect,
                             struct od_plan *plan)
{
    enum co_err err = CO_OK;

    for (size_t i = 0; i < self->od->count && err == CO_OK; i++) {
        struct od_entry *entry = self->od->entries[i];

        if (is_planned(effect, entry))
            err = od_plan_add(plan, entry, value_after(effect, entry));
    }
    return err;
}

static enum co_err make_image(const struct slave *self, const struct effect *effect,
                              struct ccf *image)
{
    enum co_err err = CO_OK;

    for (size_t i = 0; i < self->od->count && err == CO_OK; i++) {
        const struct od_entry *entry = self->od->entries[i];
        struct od_value value;

        if (!is_parameter(entry))
            continue;
        value = value_after(effect, entry);
        if (!od_same(value, od_default(entry)))
            err = ccf_append(image, entry->index, entry->sub, value.bytes, value.size);
    }
    return err;
}

static enum co_err prepare(const struct slave *self, bool save, enum group group,
                           struct slave_store *ret_store)
{
    const struct effect effect = effect_of(self, save, group);

    *ret_store = (struct slave_store){ .save = save,
                                       .group = (uint8_t)group,
                                       .changes = self->changes };
    od_plan_init(&ret_store->plan);
    ccf_init(&ret_store->image);
    return make_plan(self, &effect, &ret_store->plan);
}

void slave_free_store(struct slave_store *store)
{
    od_plan_done(&store->plan);
    ccf_done(&store->image);
}

/* What is there now need not be what was stored: it may have changed since it was prepared. */
static void note_stored(struct slave *self, const struct slave_store *store)
{
    if (store->changes != self->changes)
        self->application_changed = true;
    else if (store->group == GROUP_ALL)
        self->application_changed = false;
}

void slave_end_store(struct slave *self, struct slave_store *store)
{
    self->load = (uint8_t)load_after(self, store->save, (enum group)store->group);
    od_plan_commit(&store->plan);
    if (store->save)
        note_stored(self, store);
}

/* ---- commands ---- */

bool slave_is_store_entry(const struct od_entry *entry)
{
    return entry->sub != 0 &&
           (entry->index == STORE_PARAMETERS || entry->index == RESTORE_DEFAULTS);
}

bool slave_is_store_command(const struct slave_write *write)
{
    return slave_is_store_entry(write->entry);
}

sdo_abort_t slave_execute_store(struct slave *self, const struct slave_write *write)
{
    struct slave_store store;
    const enum co_err err = prepare(self, write->entry->index == STORE_PARAMETERS,
                                    group_of(write->entry->sub), &store);

    if (err == CO_OK)
        slave_end_store(self, &store);
    slave_free_store(&store);
    return err == CO_OK ? SDO_OK : SDO_HARDWARE;
}

enum co_err slave_begin_store(struct slave *self, struct slave_transfer transfer, co_us_t now,
                              struct slave_store *ret_store)
{
    struct sdo_server *server;
    struct effect effect;
    enum co_err err;

    if (!slave_waits_for(self, transfer))
        return CO_ERR_STATE;
    server = &self->channels[transfer.channel].server;
    effect = effect_of(self, server->index == STORE_PARAMETERS, group_of(server->sub));
    err = prepare(self, effect.save, effect.group, ret_store);
    if (err == CO_OK)
        err = make_image(self, &effect, &ret_store->image);
    if (err != CO_OK)
        slave_free_store(ret_store);
    else
        server->deadline = now + SLAVE_STORE_TIME;
    return err;
}

/* ---- 1020h ---- */

static bool is_configuration(uint16_t index)
{
    return index != ERROR_HISTORY && index != VERIFY_CONFIGURATION;
}

static void end_verification(struct slave *self)
{
    od_set_number(self->od, VERIFY_CONFIGURATION, 1, 0);
    od_set_number(self->od, VERIFY_CONFIGURATION, 2, 0);
}

void slave_note_change(struct slave *self, const struct slave_write *write)
{
    const struct od_entry *entry = write->entry;

    if (!is_configuration(entry->index) || od_same((struct od_value){ entry->value, entry->size },
                                                   (struct od_value){ write->value, write->size }))
        return;
    end_verification(self);
    if (entry->index <= LAST_COMMUNICATION_OBJECT)
        return;
    self->application_changed = true;
    self->changes++;
}

/* ---- resets ---- */

static void store_unverified(struct slave *self)
{
    for (uint8_t sub = 1; sub <= 2; sub++) {
        struct od_entry *entry = od_find(self->od, VERIFY_CONFIGURATION, sub);

        if (entry != NULL && is_parameter(entry) && od_type_size(entry->type) != 0)
            od_store_number(entry, 0);
    }
}

/* The DefaultValues of some groups become the power-on values. */
static void load(struct slave *self, unsigned bits)
{
    const bool part = has_stored(self, bits & APPLICATION_GROUPS);

    for (size_t i = 0; i < self->od->count; i++)
        if (is_in_any(bits, self->od->entries[i]->index) && is_parameter(self->od->entries[i]))
            od_restore_default(self->od->entries[i]);
    if (part)
        store_unverified(self);
    self->load &= (uint8_t)~bits;
}

void slave_reset_objects(struct slave *self, bool application)
{
    load(self, self->load & (application ? UINT8_MAX : BIT(GROUP_COMMUNICATION)));
    if (application) {
        od_reset(self->od, LAST_COMMUNICATION_OBJECT + 1, 0xFFFF);
        self->application_changed = false;
        self->changes++;
    }
    od_reset(self->od, 0x1000, LAST_COMMUNICATION_OBJECT);
    if (self->application_changed)
        end_verification(self);
}

void slave_execute_loads(struct slave *self)
{
    load(self, self->load);
}

/* ---- images ---- */

static void tell_length(const struct ccf_entry *value, const struct od_entry *entry,
                        struct co_report *report)
{
    if (od_type_size(entry->type) != 0)
        co_report_add(report, CO_WARNING, 0,
                      "%04Xh:%02X has %lu bytes, the device expects %lu; it gets its default value",
                      value->index, value->sub, (unsigned long)value->size,
                      (unsigned long)entry->capacity);
    else
        co_report_add(report, CO_WARNING, 0,
                      "%04Xh:%02X has %lu bytes, the device has room for %lu; it gets its default "
                      "value",
                      value->index, value->sub, (unsigned long)value->size,
                      (unsigned long)entry->capacity);
}

/* No client could have stored such a CAN-ID, unless the device came with it. */
static bool is_usable(const struct od_entry *entry, const struct ccf_entry *value)
{
    const uint64_t number = get_le(value->value, value->size < 8 ? value->size : 8);

    return od_same((struct od_value){ value->value, value->size }, od_default(entry)) ||
           slave_is_permitted(entry, (uint32_t)number);
}

/* NULL, and told why: there is no such parameter, or not with this value. */
static struct od_entry *entry_for(const struct od *od, const struct ccf_entry *value,
                                  struct co_report *report)
{
    struct od_entry *entry = od_find(od, value->index, value->sub);

    if (entry == NULL || !is_parameter(entry)) {
        co_report_add(report, CO_WARNING, 0,
                      "%04Xh:%02X is stored, but the device has no such %s; it is left out",
                      value->index, value->sub, entry == NULL ? "object" : "parameter");
        return NULL;
    }
    if (od_check_size(entry, value->size) != SDO_OK) {
        tell_length(value, entry, report);
        return NULL;
    }
    if (od_check_value(entry, value->value, value->size) != SDO_OK) {
        co_report_add(report, CO_WARNING, 0,
                      "%04Xh:%02X is outside the limits of the device; it gets its default value",
                      value->index, value->sub);
        return NULL;
    }
    if (!is_usable(entry, value)) {
        co_report_add(
            report, CO_WARNING, 0,
            "%04Xh:%02X has a CAN-ID that belongs to another service; it gets its default "
            "value",
            value->index, value->sub);
        return NULL;
    }
    return entry;
}

static enum co_err plan_image(const struct od *od, const struct ccf *image,
                              struct co_report *report, struct od_plan *plan)
{
    enum co_err err = CO_OK;
    struct ccf_reader reader;
    struct ccf_entry value;

    ccf_reader_init(&reader, image);
    while (err == CO_OK && ccf_read(&reader, &value)) {
        struct od_entry *entry = entry_for(od, &value, report);

        if (entry != NULL)
            err = od_plan_add(plan, entry, (struct od_value){ value.value, value.size });
    }
    return err;
}

static void forget_stored(struct od *od)
{
    for (size_t i = 0; i < od->count; i++) {
        struct od_entry *entry = od->entries[i];

        if (!is_parameter(entry) || od_same(od_power_on(entry), od_default(entry)))
            continue;
        od_restore_default(entry);
        od_reset_entry(entry);
    }
}

/* The others keep what the application has given them. */
static void take_stored(struct od *od)
{
    for (size_t i = 0; i < od->count; i++) {
        struct od_entry *entry = od->entries[i];

        if (is_parameter(entry) && !od_same(od_power_on(entry), od_default(entry)))
            od_reset_entry(entry);
    }
}

enum co_err slave_recall_image(struct od *od, const struct ccf *image, struct co_report *report)
{
    struct od_plan plan;
    enum co_err err = CO_OK;

    od_plan_init(&plan);
    if (image != NULL)
        err = plan_image(od, image, report, &plan);
    if (err == CO_OK) {
        forget_stored(od);
        od_plan_commit(&plan);
        take_stored(od);
    }
    od_plan_done(&plan);
    return err;
}
