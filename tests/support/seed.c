#include "support/seed.h"

#include "base/bytes.h"
#include "od/od_store.h"
#include "support/watch.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STRING_MAX 200u

unsigned seed_below(struct seed *self, unsigned limit)
{
    self->random ^= self->random >> 12;
    self->random ^= self->random << 25;
    self->random ^= self->random >> 27;
    return (unsigned)((self->random * 0x2545F4914F6CDD1Du) >> 33) % limit;
}

bool seed_one_in(struct seed *self, unsigned n)
{
    return seed_below(self, n) == 0;
}

static unsigned between(struct seed *self, unsigned first, unsigned last)
{
    return first + seed_below(self, last - first + 1);
}

bool seed_is_permanent(unsigned fault)
{
    return fault <= SEED_DIES;
}

static bool is_of_software(unsigned fault)
{
    return (fault >= SEED_NO_SOFTWARE && fault <= SEED_BAD_UPDATE) || fault == SEED_UPDATE;
}

bool seed_is_healthy(const struct seed_node *node)
{
    return !seed_is_permanent(node->fault);
}

/* --- the plan --- */

static unsigned plan_size(struct seed *self)
{
    switch (seed_below(self, 10)) {
    case 0: return between(self, 61, 126);
    case 1:
    case 2: return between(self, 21, 60);
    default: return between(self, 5, 20);
    }
}

/* What a reset, or a lost frame, would make another fault of. */
static bool fits(const struct seed *self, unsigned fault)
{
    bool calm = !self->has[SEED_ORDERS] && !self->has[SEED_LOSS];

    if (is_of_software(fault) || fault == SEED_NO_STATE)
        return calm;
    return true;
}

static unsigned choose_fault(struct seed *self, unsigned first, unsigned last)
{
    unsigned fault;

    do
        fault = between(self, first, last);
    while (!fits(self, fault));
    return fault;
}

static void plan_supervision(struct seed *self, struct seed_node *node)
{
    bool needs_one = node->fault == SEED_DIES || node->fault == SEED_NO_STATE;

    node->beats = node->fault == SEED_NO_HEARTBEAT || node->fault == SEED_CABLE ||
                  !seed_one_in(self, 3);
    node->guarded = !node->beats && (needs_one || seed_one_in(self, 2));
    node->kept_alive = node->fault == SEED_NO_STATE ||
                       (node->fault == SEED_NONE && (node->beats || node->guarded) &&
                        seed_one_in(self, 8));
}

static void plan_node(struct seed *self, struct seed_node *node, bool mandatory)
{
    node->mandatory = mandatory || (!seed_is_permanent(node->fault) && seed_one_in(self, 3));
    plan_supervision(self, node);
    node->verified = seed_one_in(self, 3);
    node->strikes = between(self, 1, 3);
    node->late_ms = between(self, 20, 450);
    node->at_time = CO_MS(1000 + seed_below(self, SEED_FAULTY_MS - 1000));
    node->hit = node->fault != SEED_NONE || self->has[SEED_ORDERS];
    if (node->fault != SEED_NONE)
        self->has[node->fault] = true;
}

/* So many other nodes get a fault, that any may have. */
static void plan_faults(struct seed *self)
{
    unsigned count = self->clean ? 0 : 1 + seed_below(self, self->node_count / 4 + 1);
    unsigned bad = self->starts ? 0 : between(self, 1, self->node_count);

    for (unsigned id = 1; id <= self->node_count; id++) {
        self->nodes[id].id = (uint8_t)id;
        self->nodes[id].fault = SEED_NONE;
    }
    for (unsigned i = 0; i < count; i++)
        self->nodes[between(self, 1, self->node_count)].fault = (uint8_t)choose_fault(
            self, 0, SEED_FAULTS - 1);
    if (bad != 0)
        self->nodes[bad].fault = (uint8_t)choose_fault(self, 0, SEED_BAD_UPDATE);
    for (unsigned id = 1; id <= self->node_count; id++)
        plan_node(self, &self->nodes[id], id == bad);
}

static void plan(struct seed *self)
{
    unsigned kind = seed_below(self, 100);

    self->node_count = plan_size(self);
    self->clean = kind < 8;
    self->starts = self->clean || kind >= 25;
    self->has[SEED_LOSS] = !self->clean && seed_one_in(self, 4);
    self->has[SEED_MANAGER] = !self->clean && seed_one_in(self, 6);
    self->has[SEED_ORDERS] = !self->clean && seed_one_in(self, 5);
    self->loss = between(self, 20, 420);
    self->manager_off = CO_MS(1000 + seed_below(self, 12000));
    self->manager_on = self->manager_off + CO_MS(seed_below(self, 4000));
    self->faulty = true;
    plan_faults(self);
}

/* --- the network's file --- */

struct identity {
    unsigned fault;
    const char *element;
    uint8_t sub;
    uint32_t value;
    char letter;
};

static const struct identity identities[] = {
    { SEED_TYPE, "Device_Type_Identification", 0, 0x00020192, 'C' },
    { SEED_VENDOR, "Vendor_Identification", 1, 0x29A, 'D' },
    { SEED_PRODUCT, "Product_Code", 2, 1, 'M' },
    { SEED_REVISION, "Revision_Number", 3, 0x10001, 'N' },
    { SEED_SERIAL, "Serial_Number", 4, 0, 'O' },
};

#define IDENTITIES (sizeof identities / sizeof identities[0])

static uint32_t identity_value(const struct identity *identity, const struct seed_node *node)
{
    return identity->value ? identity->value : node->id;
}

static void expect_refusal(struct seed_node *node, char letter, enum boot_step step)
{
    node->cause = (struct boot_failure){ .letter = letter,
                                         .step = (uint8_t)step,
                                         .outcome = SDO_OUTCOME_ABORTED,
                                         .index = node->index,
                                         .sub = node->sub,
                                         .abort_code = node->code };
}

static void refuse_identity(struct seed *self, struct seed_node *node,
                            const struct identity *identity)
{
    node->index = 0x1018;
    node->sub = identity->sub;
    node->code = seed_one_in(self, 2) ? SDO_NO_SUB : SDO_NO_OBJECT;
    expect_refusal(node, identity->letter, BOOT_IDENTITY);
}

static void add_identity(struct seed *self, struct seed_node *node, FILE *xml)
{
    unsigned refused = node->fault == SEED_NO_IDENTITY ? between(self, 1, 4) : IDENTITIES;

    for (unsigned i = 0; i < IDENTITIES; i++) {
        const struct identity *identity = &identities[i];
        bool wanted = node->fault == identity->fault || i == refused || seed_one_in(self, 2);

        if (i == refused)
            refuse_identity(self, node, identity);
        if (wanted)
            fprintf(xml, "<%s>%u</%s>", identity->element, identity_value(identity, node),
                    identity->element);
    }
}

static void add_flag(FILE *xml, bool set, const char *element)
{
    if (set)
        fprintf(xml, "<%s>TRUE</%s>", element, element);
}

static void add_supervision(struct seed *self, const struct seed_node *node, FILE *xml)
{
    if (node->beats)
        fprintf(xml, "<Consumer_Heartbeat_Time>%u</Consumer_Heartbeat_Time>",
                3 * SEED_BEAT(self->node_count));
    if (node->guarded)
        fprintf(xml, "<Guard_Time>%u</Guard_Time><Life_Time_Factor>4</Life_Time_Factor>",
                SEED_BEAT(self->node_count));
}

static void add_software(const struct seed_node *node, FILE *xml)
{
    if (is_of_software(node->fault))
        fprintf(xml, "%s", node->fault == SEED_OLD_SOFTWARE ? LOADER_VERIFY : LOADER_UPDATE);
}

static void add_node_xml(struct seed *self, struct seed_node *node, FILE *xml)
{
    fprintf(xml, "<Node_Instance><Node_Id>%u</Node_Id>", node->id);
    add_flag(xml, node->mandatory, "NMT_Mandatory_Slave");
    add_flag(xml, node->verified, "Verify_Configuration");
    add_flag(xml, node->kept_alive, "NMT_Check_Nodestate");
    add_flag(xml, seed_one_in(self, 3), "NMT_Reset_Node");
    add_flag(xml, seed_one_in(self, 3), "SDO_Segmented_Size_Indication");
    if (seed_one_in(self, 4))
        fprintf(xml, "<SDO_Block_Size>%u</SDO_Block_Size>", between(self, 1, 127));
    if (seed_one_in(self, 4))
        fprintf(xml, "<Boot_Delay>%u</Boot_Delay>", seed_below(self, 500));
    if (seed_one_in(self, 4))
        fprintf(xml, "<SDO_Timeout>%u</SDO_Timeout>", between(self, 100, 500));
    add_identity(self, node, xml);
    add_supervision(self, node, xml);
    add_software(node, xml);
    fprintf(xml, "</Node_Instance>");
}

static void add_network(struct seed *self, FILE *xml)
{
    static const char *const actions[] = { "RESET_SLAVE", "RESET_ALL", "STOP_ALL" };
    unsigned action = self->has[SEED_NO_STATE] ? 0 : seed_below(self, 3);
    bool waits = seed_one_in(self, 12), starts_none = seed_one_in(self, 12);

    add_flag(xml, seed_one_in(self, 2), "NMT_Start_All");
    add_flag(xml, seed_one_in(self, 2), "NMT_Reset_All");
    if (waits)
        fprintf(xml, "<NMT_Auto_Operational>FALSE</NMT_Auto_Operational>");
    if (starts_none)
        fprintf(xml, "<NMT_Auto_Start>FALSE</NMT_Auto_Start>");
    fprintf(xml, "<NMT_Action_On_Error>%s</NMT_Action_On_Error>", actions[action]);
    if (seed_one_in(self, 2))
        fprintf(xml, "<Boot_Time>%u</Boot_Time>", between(self, 100, 4100));
    self->needs_start = waits || starts_none || self->has[SEED_ORDERS] ||
                        (action == 2 && !self->clean);
}

static char *make_xml(struct seed *self)
{
    char *text = NULL;
    size_t size = 0;
    FILE *xml = open_memstream(&text, &size);

    ck_assert_ptr_nonnull(xml);
    add_network(self, xml);
    for (unsigned id = 1; id <= self->node_count; id++)
        add_node_xml(self, &self->nodes[id], xml);
    fclose(xml);
    return text;
}

/* --- the devices --- */

static struct ccf *ccf_of(struct seed *self, uint8_t node)
{
    return &self->plant->config->nodes[node - 1].ccf;
}

static void add_number(struct seed *self, struct seed_node *node, uint8_t sub)
{
    static const uint8_t sizes[] = { 1, 2, 4 };
    uint8_t size = sizes[seed_below(self, 3)];

    plant_add_object(self->plant->devices[node->id], 0x6200, sub, size, 0);
    plant_configure(self->plant, node->id, 0x6200, sub, size,
                    1 + seed_below(self, size == 1   ? 255
                                         : size == 2 ? 65535
                                                     : 100000000));
}

static void add_string(struct seed *self, const struct seed_node *node, uint8_t sub)
{
    const struct od_spec spec = { .index = 0x6200,
                                  .sub = sub,
                                  .type = OD_OCTET_STRING,
                                  .access = OD_RW,
                                  .capacity = STRING_MAX };
    uint8_t bytes[STRING_MAX];
    unsigned size = between(self, 5, STRING_MAX);

    for (unsigned i = 0; i < size; i++)
        bytes[i] = (uint8_t)seed_below(self, 256);
    ck_assert_int_eq(od_add(&self->plant->devices[node->id]->od, &spec, NULL), CO_OK);
    ck_assert_int_eq(ccf_append(ccf_of(self, node->id), 0x6200, sub, bytes, size), CO_OK);
}

/* The device keeps what it is told to, and knows then when it was configured. */
static void add_saving(struct seed *self, const struct seed_node *node)
{
    struct plant_device *device = self->plant->devices[node->id];
    struct node_config *config = &self->plant->config->nodes[node->id - 1];

    plant_add_object(device, 0x1010, 0, 1, 1);
    plant_add_object(device, 0x1010, 1, 4, 1);
    plant_add_object(device, 0x1020, 0, 1, 2);
    plant_add_object(device, 0x1020, 1, 4, 0);
    plant_add_object(device, 0x1020, 2, 4, 0);
    config->save_configuration = true;
    plant_configure(self->plant, node->id, 0x1020, 1, 4, between(self, 1, 20000));
    plant_configure(self->plant, node->id, 0x1020, 2, 4, between(self, 1, 86400000));
}

/* It is as it was left: configured ... */
static void store_configuration(struct seed *self, const struct seed_node *node)
{
    struct plant_device *device = self->plant->devices[node->id];
    struct ccf_reader reader;
    struct ccf_entry entry;

    ccf_reader_init(&reader, ccf_of(self, node->id));
    while (ccf_read(&reader, &entry))
        od_set(od_find(&device->od, entry.index, entry.sub), entry.value, entry.size);
    ck_assert_int_eq(od_store(&device->od, 0x1000, 0x9FFF), CO_OK);
}

/* ... and operational. */
static void make_operational(struct seed *self, const struct seed_node *node)
{
    struct plant_device *device = self->plant->devices[node->id];

    device->nmt_state = NMT_OPERATIONAL;
    slave_command(&device->slave, NMT_START, self->plant->sim.now, &device->sim->box);
    sim_touch(&self->plant->sim, device->sim);
}

static void falsify(struct seed *self, struct seed_node *node, unsigned entries)
{
    struct od *od = &self->plant->devices[node->id]->od;

    (void)entries;
    for (unsigned i = 0; i < IDENTITIES; i++) {
        const struct identity *identity = &identities[i];
        uint16_t index = identity->sub ? 0x1018 : 0x1000;
        uint32_t value = identity_value(identity, node);

        if (identity->fault != node->fault)
            continue;
        od_store_number(od_find(od, index, identity->sub), value + 1);
        od_set_number(od, index, identity->sub, value + 1);
        node->cause = (struct boot_failure){ .letter = identity->letter,
                                             .step = identity->sub ? BOOT_IDENTITY
                                                                   : BOOT_DEVICE_TYPE,
                                             .index = index,
                                             .sub = identity->sub,
                                             .expected = value,
                                             .actual = value + 1 };
    }
}

/* A write, of one of so many entries, that is refused, or answered by a reset. */
static void refuse_entry(struct seed *self, struct seed_node *node, unsigned entries)
{
    static const uint32_t codes[] = { SDO_READ_ONLY,  SDO_NO_OBJECT, SDO_NO_SUB, SDO_INVALID_VALUE,
                                      SDO_VALUE_HIGH, SDO_VALUE_LOW, SDO_GENERAL };

    node->index = 0x6200;
    node->sub = (uint8_t)between(self, 1, entries);
    node->code = codes[seed_below(self, sizeof codes / sizeof codes[0])];
    expect_refusal(node, 'J', BOOT_CONFIGURE);
    node->cause.entry = node->sub;
}

static void be_busy(struct seed *self, struct seed_node *node, unsigned entries)
{
    refuse_entry(self, node, entries);
    node->code = seed_one_in(self, 2) ? SDO_DEVICE_STATE : SDO_NO_CONNECTION;
    expect_refusal(node, 'J', BOOT_CONFIGURE);
    node->cause.entry = node->sub;
    if (seed_one_in(self, 2))
        return;
    node->index = 0x1000;
    node->sub = 0;
    expect_refusal(node, 'B', BOOT_DEVICE_TYPE);
}

static void expect_no_answer(struct seed *self, struct seed_node *node, unsigned entries)
{
    (void)self;
    (void)entries;
    node->cause = (struct boot_failure){ .letter = 'B',
                                         .step = BOOT_DEVICE_TYPE,
                                         .outcome = SDO_OUTCOME_NO_ANSWER,
                                         .index = 0x1000,
                                         .abort_code = SDO_TIMEOUT };
}

static void expect_silence(struct seed *self, struct seed_node *node, unsigned entries)
{
    bool checks = node->fault == SEED_NO_STATE;

    (void)entries;
    node->cause = (struct boot_failure){
        .letter = !checks       ? 'K'
                  : node->beats ? 'E'
                                : 'F',
        .step = checks ? BOOT_CHECK_STATE : BOOT_ERROR_CONTROL,
        .expected = node->beats ? 3 * SEED_BEAT(self->node_count) : 0,
    };
}

static void add_loader(struct seed *self, struct seed_node *node, unsigned entries)
{
    struct loader *loader = calloc(1, sizeof *loader);
    struct boot_failure cause = { .letter = 'G', .step = BOOT_CHECK_SOFTWARE };

    (void)entries;
    ck_assert_ptr_nonnull(loader);
    loader_attach(loader, self->plant, node->id);
    node->loader = loader;
    loader->off_at_stop = seed_one_in(self, 2) ? between(self, 10, 900) : 0;
    loader->off_at_start = seed_one_in(self, 2) ? between(self, 10, 900) : 0;
    node->index = 0x1F56;
    node->sub = 1;
    node->code = SDO_NO_OBJECT;
    cause.index = node->index;
    cause.sub = node->sub;
    if (node->fault == SEED_NO_SOFTWARE) {
        expect_refusal(node, 'G', BOOT_CHECK_SOFTWARE);
        return;
    }
    cause.expected = LOADER_NEW;
    cause.letter = node->fault == SEED_OLD_SOFTWARE ? 'H' : 'I';
    cause.actual = node->fault == SEED_OLD_SOFTWARE ? LOADER_OLD : 0x33;
    cause.step = node->fault == SEED_OLD_SOFTWARE ? BOOT_CHECK_SOFTWARE : BOOT_UPDATE_SOFTWARE;
    loader->written_id = node->fault == SEED_BAD_UPDATE ? 0x33 : 0;
    if (node->fault != SEED_UPDATE)
        node->cause = cause;
}

static void reset_at_entry(struct seed *self, struct seed_node *node, unsigned entries)
{
    refuse_entry(self, node, entries);
    node->cause.outcome = SDO_OUTCOME_CANCELLED;
    node->cause.abort_code = 0;
}

static void prepare_fault(struct seed *self, struct seed_node *node, unsigned entries)
{
    static void (*const prepare[SEED_KINDS + 1])(struct seed *, struct seed_node *, unsigned) = {
        [SEED_OFF] = expect_no_answer,
        [SEED_MUTE] = expect_no_answer,
        [SEED_TYPE] = falsify,
        [SEED_VENDOR] = falsify,
        [SEED_PRODUCT] = falsify,
        [SEED_REVISION] = falsify,
        [SEED_SERIAL] = falsify,
        [SEED_REFUSES] = refuse_entry,
        [SEED_RESETS] = reset_at_entry,
        [SEED_HANGS] = expect_no_answer,
        [SEED_NO_HEARTBEAT] = expect_silence,
        [SEED_NO_STATE] = expect_silence,
        [SEED_NO_SOFTWARE] = add_loader,
        [SEED_OLD_SOFTWARE] = add_loader,
        [SEED_BAD_UPDATE] = add_loader,
        [SEED_DIES] = expect_no_answer,
        [SEED_BUSY] = be_busy,
        [SEED_UPDATE] = add_loader,
    };

    node->at = between(self, 1, 1 + entries);
    if (node->fault < SEED_FAULTS && prepare[node->fault])
        prepare[node->fault](self, node, entries);
}

static void add_device(struct seed *self, struct seed_node *node)
{
    unsigned entries = between(self, 1, SEED_ENTRIES);
    bool saves = !node->kept_alive && node->fault != SEED_RESETS && seed_one_in(self, 6);

    plant_add_device(self->plant, node->id);
    for (uint8_t i = 1; i <= entries; i++)
        if (seed_one_in(self, 6))
            add_string(self, node, i);
        else
            add_number(self, node, i);
    if (node->beats)
        plant_configure(self->plant, node->id, 0x1017, 0, 2, SEED_BEAT(self->node_count));
    if (saves)
        add_saving(self, node);
    seed_add_request_objects(self, node->id, !saves);
    if (node->kept_alive)
        store_configuration(self, node);
    prepare_fault(self, node, entries);
}

/* --- all of it --- */

static void open_log(struct seed *self)
{
    const char *name = getenv("SCENARIO_LOG");

    if (name)
        self->plant->sim.log = fopen(name, "w");
}

static void make_plant(struct seed *self)
{
    static const unsigned bitrates[] = { 1000000, 500000, 125000, 0 };
    static const unsigned boxes[] = { SIM_BOX, SIM_BOX, 4, 7 };
    unsigned rates = self->node_count > 30 ? 2 : 4;
    char *xml = make_xml(self);

    self->plant = plant_new(xml, bitrates[seed_below(self, rates)]);
    self->plant->sim.box_size = boxes[seed_below(self, 4)];
    free(xml);
    for (unsigned id = 1; id <= self->node_count; id++)
        add_device(self, &self->nodes[id]);
    self->plant->fault_context = self;
    self->plant->on_event = seed_on_event;
    watch_start(self->plant);
}

struct seed *seed_new(unsigned number)
{
    struct seed *self = calloc(1, sizeof *self);

    ck_assert_ptr_nonnull(self);
    self->number = number;
    self->random = 0x9E3779B97F4A7C15u * (number + 1u);
    plan(self);
    make_plant(self);
    snprintf(self->plant->name, sizeof self->plant->name, "seed %u (%u nodes, %u bit/s)", number,
             self->node_count, self->plant->sim.bitrate);
    plant_power_on(self->plant);
    open_log(self);
    seed_play_faults(self);
    for (unsigned id = 1; id <= self->node_count; id++)
        if (self->nodes[id].kept_alive)
            make_operational(self, &self->nodes[id]);
    return self;
}

void seed_free(struct seed *self)
{
    for (unsigned id = 1; id <= self->node_count; id++)
        free(self->nodes[id].loader);
    if (self->plant->sim.log)
        fclose(self->plant->sim.log);
    plant_free(self->plant);
    free(self);
}
