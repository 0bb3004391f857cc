/* PDOs of a local node: canOpenDefinePDO. What they do by themselves is in slave/, what the
 * application does with them in scan_pdo_io.c. */
#include "api/scan.h"

#define COB_ID_INVALID 0x80000000u
#define COB_ID_NO_RTR  0x40000000u
#define FRAME_29_BIT   0x20000000u
#define CAN_ID_11      0x7FFu
#define CAN_ID_29      0x1FFFFFFFu
#define UNITS_PER_MS   10 /* of the inhibit time in 1800h:03 */
#define INHIBIT_MAX    6553
#define LAST_DUMMY     7u
#define FIELDS_MAX     64u
#define BITS_MAX       64u

#define TYPE_OF(mode) ((mode)&0xFFu)
#define MODES                                                                                      \
    (RECEIVE_PDO | TRANSMIT_PDO | SYNCHRON_PDO | ASYNCHRON_PDO | AUTO_NOTIFY_PDO | TX_DONE_PDO |   \
     TIMER_DRIVEN_PDO)

struct scan_pdo *scan_pdo(const struct scan_node *node, bool transmit, uint16_t number)
{
    const uint16_t count = transmit ? node->tpdo_count : node->rpdo_count;

    if (number < 1 || number > count)
        return NULL;
    return &(transmit ? node->tpdos : node->rpdos)[number - 1];
}

/* ---- canOpenDefinePDO ---- */

struct definition {
    uint32_t cob_id;
    uint16_t mode;
    int32_t inhibit, event_timer;
    uint16_t tx_timeout, rx_timeout;
    const uint16_t *mapping;
    bool transmit;
    bool requests; /* by remote frames */
    uint16_t number;
    uint32_t mapped[FIELDS_MAX]; /* as 1600h has them */
    unsigned count;
};

static bool is_synchronous(unsigned type)
{
    return type <= 240 || type == 252;
}

static bool is_type_good(const struct definition *self)
{
    const unsigned type = TYPE_OF(self->mode);

    if (type > 240 && type < (self->transmit ? 252u : 254u))
        return false;
    if ((type == 252 || type == 253) && (self->cob_id & COB_ID_NO_RTR))
        return false;
    if ((self->mode & SYNCHRON_PDO) && !is_synchronous(type))
        return false;
    return !(self->mode & ASYNCHRON_PDO) || !is_synchronous(type);
}

static bool is_mode_good(const struct definition *self)
{
    const bool receive = (self->mode & RECEIVE_PDO) != 0;

    if ((self->mode & ~(unsigned)(MODES | 0xFF)) != 0 || receive == self->transmit)
        return false;
    if (receive && (self->mode & (TX_DONE_PDO | TIMER_DRIVEN_PDO)))
        return false;
    return is_type_good(self);
}

/* The first four CAN-IDs of the pre-defined connection set (CiA 301, 7.3.3). */
static uint32_t default_id(uint32_t which, bool transmit, uint8_t node)
{
    return (transmit ? 0x180u : 0x200u) + (which - DEFAULT_PDO1) * 0x100u + node;
}

static bool is_can_id_good(uint32_t cob_id)
{
    const uint32_t id = cob_id & CAN_ID_29;

    if (cob_id & COB_ID_INVALID)
        return true;
    return (cob_id & FRAME_29_BIT) || id <= CAN_ID_11;
}

static bool complete_cob_id(const struct scan_node *node, struct definition *self)
{
    const uint32_t which = self->cob_id & CAN_ID_29;

    if (!(self->cob_id & FRAME_29_BIT) && which >= DEFAULT_PDO1 && which <= DEFAULT_PDO4)
        self->cob_id = (self->cob_id & ~CAN_ID_29) | default_id(which, self->transmit, node->id);
    if (!self->transmit)
        self->cob_id &= ~COB_ID_NO_RTR; /* says nothing of a received PDO, and 1400h has no bit */
    if (!is_can_id_good(self->cob_id))
        return false;
    return slave_may_use(&node->od, self->cob_id, self->transmit);
}

static int check_parameters(const struct scan_node *node, struct definition *self)
{
    if (!is_mode_good(self) || !complete_cob_id(node, self))
        return SCANOPEN_PDO_PARAMETER_ERROR;
    if (self->inhibit < 0 || self->inhibit > INHIBIT_MAX || self->event_timer < 0 ||
        self->event_timer > UINT16_MAX)
        return SCANOPEN_PDO_PARAMETER_ERROR;
    if (is_synchronous(TYPE_OF(self->mode)) && !od_has_object(&node->od, 0x1005))
        return SCANOPEN_PDO_PARAMETER_ERROR;
    return SCANOPEN_OK;
}

static uint32_t bits_of(uint8_t type)
{
    return type == OD_BOOLEAN ? 1 : 8 * od_type_size(type);
}

/* How often the object is in this PDO before. */
static unsigned times_before(const struct definition *self, uint32_t mapped)
{
    unsigned times = 0;

    for (unsigned i = 0; i < self->count; i++)
        times += self->mapped[i] == mapped;
    return times;
}

static int check_times(const struct definition *self, const struct od_entry *entry, uint32_t mapped)
{
    const bool here = times_before(self, mapped) > 0;

    if (here || entry->map_max == 0 || entry->map_count < entry->map_max)
        return SCANOPEN_OK;
    return entry->map_max == 1 ? SCANOPEN_PDO_MAPPING_ERROR : SCANOPEN_TOO_MANY_OBJECTS;
}

static int map_object(const struct scan_node *node, struct definition *self, uint16_t index,
                      uint16_t sub)
{
    const struct od_entry *entry = sub <= UINT8_MAX ? od_find(&node->od, index, (uint8_t)sub)
                                                    : NULL;
    const bool dummy = index <= LAST_DUMMY && sub == 0;
    const uint8_t type = dummy ? (uint8_t)index : entry ? entry->type : 0;
    const uint32_t mapped = (uint32_t)index << 16 | (uint32_t)(sub & 0xFFu) << 8 | bits_of(type);
    int result;

    if ((!dummy && !entry) || slave_check_mapped(&node->od, mapped, self->transmit) != SDO_OK)
        return SCANOPEN_PDO_MAPPING_ERROR;
    result = dummy ? SCANOPEN_OK : check_times(self, entry, mapped);
    if (result == SCANOPEN_OK)
        self->mapped[self->count++] = mapped;
    return result;
}

static int read_mapping(const struct scan_node *node, struct definition *self)
{
    const uint16_t *pair = self->mapping;
    unsigned bits = 0;
    int result = SCANOPEN_OK;

    for (; pair && (pair[0] != 0 || pair[1] != 0) && result == SCANOPEN_OK; pair += 2) {
        if (self->count == FIELDS_MAX)
            return SCANOPEN_PDO_MAPPING_ERROR;
        result = map_object(node, self, pair[0], pair[1]);
        if (result == SCANOPEN_OK)
            bits += self->mapped[self->count - 1] & 0xFFu;
    }
    if (result == SCANOPEN_OK && bits > BITS_MAX)
        return SCANOPEN_PDO_MAPPING_ERROR;
    return result;
}

/* One object after the other; the first failure ends it. */
struct adder {
    struct od *od;
    enum co_err err;
};

static void add(struct adder *self, uint16_t index, unsigned sub, uint8_t type,
                enum od_access access, uint64_t value)
{
    if (self->err == CO_OK)
        self->err = od_add_number(self->od, index, (uint8_t)sub, type, access, value);
}

static void add_parameters(struct adder *self, const struct definition *pdo)
{
    const uint16_t index = (uint16_t)((pdo->transmit ? 0x1800u : 0x1400u) + pdo->number - 1);
    const uint64_t inhibit = (uint64_t)pdo->inhibit * UNITS_PER_MS;

    add(self, index, 0, OD_UNSIGNED8, OD_CONST, pdo->transmit ? 6 : 5);
    add(self, index, 1, OD_UNSIGNED32, OD_RW, pdo->cob_id);
    add(self, index, 2, OD_UNSIGNED8, OD_RW, TYPE_OF(pdo->mode));
    add(self, index, 3, OD_UNSIGNED16, OD_RW, inhibit);
    add(self, index, 5, OD_UNSIGNED16, OD_RW, (uint64_t)pdo->event_timer);
    if (pdo->transmit)
        add(self, index, 6, OD_UNSIGNED8, OD_RW, 0);
    if (self->err == CO_OK && pdo->transmit)
        od_find(self->od, index, 1)->frozen = COB_ID_NO_RTR;
}

static void add_mapping(struct adder *self, const struct definition *pdo)
{
    const uint16_t index = (uint16_t)((pdo->transmit ? 0x1A00u : 0x1600u) + pdo->number - 1);

    add(self, index, 0, OD_UNSIGNED8, OD_RW, pdo->count);
    for (unsigned i = 0; i < FIELDS_MAX; i++)
        add(self, index, i + 1, OD_UNSIGNED32, OD_RW, i < pdo->count ? pdo->mapped[i] : 0);
}

static int add_objects(struct scan_node *node, const struct definition *pdo)
{
    const uint16_t number = (uint16_t)(pdo->number - 1);
    struct adder adder = { .od = &node->od, .err = CO_OK };

    add_parameters(&adder, pdo);
    add_mapping(&adder, pdo);
    if (adder.err == CO_OK)
        return SCANOPEN_OK;
    od_remove_object(&node->od, (uint16_t)((pdo->transmit ? 0x1800u : 0x1400u) + number), NULL);
    od_remove_object(&node->od, (uint16_t)((pdo->transmit ? 0x1A00u : 0x1600u) + number), NULL);
    return SCANOPEN_OUT_OF_MEMORY;
}

static void count_map(struct scan_node *node, uint16_t index)
{
    const uint64_t count = od_number(&node->od, index, 0, 0);

    for (unsigned sub = 1; sub <= count; sub++) {
        const uint64_t mapped = od_number(&node->od, index, (uint8_t)sub, 0);
        struct od_entry *entry = od_find(&node->od, (uint16_t)(mapped >> 16),
                                         (uint8_t)(mapped >> 8));

        if (entry)
            entry->map_count++;
    }
}

static int define(struct scan_node *node, struct definition *pdo, HPDO *ret_handle)
{
    uint16_t *count = pdo->transmit ? &node->tpdo_count : &node->rpdo_count;
    int result = check_parameters(node, pdo);

    if (node->active)
        return SCANOPEN_WRONG_NODESTATE;
    if (result != SCANOPEN_OK)
        return result;
    if (*count >= (pdo->transmit ? node->tpdo_max : node->rpdo_max))
        return SCANOPEN_TOO_MANY_OBJECTS;
    pdo->number = (uint16_t)(*count + 1);
    result = read_mapping(node, pdo);
    if (result == SCANOPEN_OK)
        result = add_objects(node, pdo);
    if (result != SCANOPEN_OK)
        return result;
    (*count)++;
    *scan_pdo(node, pdo->transmit,
              pdo->number) = (struct scan_pdo){ .mode = pdo->mode,
                                                .requests = pdo->requests,
                                                .tx_timeout = pdo->tx_timeout,
                                                .rx_timeout = pdo->rx_timeout };
    count_map(node, (uint16_t)((pdo->transmit ? 0x1A00u : 0x1600u) + pdo->number - 1));
    *ret_handle = scan_pdo_handle(node, pdo->transmit, pdo->number);
    return SCANOPEN_OK;
}

int canOpenDefinePDO(HNODE HNode, const char *Name, uint32_t COBid, uint16_t TransMode,
                     int32_t InhibitTime, uint16_t TxTout, uint16_t RxTout, int32_t iEventTimer,
                     const uint16_t *Mapping, HPDO *Hpdo)
{
    struct definition pdo = { .cob_id = COBid,
                              .mode = TransMode,
                              .inhibit = InhibitTime,
                              .event_timer = iEventTimer,
                              .tx_timeout = TxTout,
                              .rx_timeout = RxTout,
                              .mapping = Mapping,
                              .transmit = (TransMode & TRANSMIT_PDO) != 0,
                              .requests = (COBid & RTR_DISALLOW) == 0 };
    struct scan_node *node;
    int result = scan_enter(HNode, &node);
    co_us_t now;

    (void)Name;
    if (result != SCANOPEN_OK)
        return result;
    scan_lock(node, &now);
    result = Hpdo ? define(node, &pdo, Hpdo) : SCANOPEN_WRONG_PARAMETER;
    scan_unlock(node);
    scan_leave(node);
    return result;
}

/* ---- what the slave has to know of them ---- */

static uint8_t flags_of(const struct scan_pdo *pdo, bool transmit)
{
    uint8_t flags = 0;

    if ((pdo->mode & AUTO_NOTIFY_PDO) || !transmit) /* of received ones all is looked at */
        flags |= SLAVE_PDO_NOTIFY;
    if (pdo->mode & TX_DONE_PDO)
        flags |= SLAVE_PDO_CONFIRM;
    if (pdo->mode & TIMER_DRIVEN_PDO)
        flags |= SLAVE_PDO_TIMER_ASKS;
    return flags;
}

void scan_set_pdo_flags(struct scan_node *node)
{
    for (uint16_t i = 1; i <= node->rpdo_count; i++)
        slave_pdo_set_flags(&node->slave, PDO_RECEIVE, i, flags_of(&node->rpdos[i - 1], false));
    for (uint16_t i = 1; i <= node->tpdo_count; i++) {
        node->tpdos[i - 1].confirmed = 0;
        slave_pdo_set_flags(&node->slave, PDO_TRANSMIT, i, flags_of(&node->tpdos[i - 1], true));
    }
}

void scan_count_maps(struct scan_node *node)
{
    for (size_t i = 0; i < node->od.count; i++)
        node->od.entries[i]->map_count = 0;
    for (uint16_t i = 0; i < node->rpdo_count; i++)
        count_map(node, (uint16_t)(0x1600 + i));
    for (uint16_t i = 0; i < node->tpdo_count; i++)
        count_map(node, (uint16_t)(0x1A00 + i));
}
