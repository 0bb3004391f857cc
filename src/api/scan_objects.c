/* The communication objects that SLAVE_NODE_INFO asks for (CiA 301, 7.5.2). */
#include "api/scan.h"

#include <string.h>

#define MAX_ERRORS     127u
#define MAX_CONSUMERS  127u
#define MAX_SERVERS    127u
#define MAX_IDENTITY   4u
#define MAX_INHIBIT    6553u /* ms; more does not fit into 1015h */
#define COB_ID_INVALID 0x80000000u
#define FRAME_29_BIT   0x20000000u
#define STORE_GROUPS   4u
#define GUARD_CAN_ID   0x700u

/* One object, or a part of one; the first failure ends it. */
struct maker {
    const struct scan_profile *profile;
    const SLAVE_NODE_INFO *info;
    struct od *od;
    enum co_err err;
};

static void add(struct maker *self, uint16_t index, uint8_t sub, uint8_t type,
                enum od_access access, uint64_t value)
{
    if (self->err == CO_OK)
        self->err = od_add_number(self->od, index, sub, type, access, value);
}

static void add_u32(struct maker *self, uint16_t index, uint8_t sub, enum od_access access,
                    uint64_t value)
{
    add(self, index, sub, OD_UNSIGNED32, access, value);
}

static void add_count(struct maker *self, uint16_t index, unsigned count)
{
    add(self, index, 0, OD_UNSIGNED8, OD_CONST, count);
}

static void add_array(struct maker *self, uint16_t index, unsigned count, enum od_access access,
                      uint64_t value)
{
    add_count(self, index, count);
    for (unsigned sub = 1; sub <= count; sub++)
        add_u32(self, index, (uint8_t)sub, access, value);
}

static void add_text(struct maker *self, uint16_t index, const char *text)
{
    const uint8_t *bytes = (const uint8_t *)text;
    const struct od_spec spec = { .index = index,
                                  .type = OD_VISIBLE_STRING,
                                  .access = OD_CONST,
                                  .value = bytes,
                                  .size = (uint32_t)strlen(text),
                                  .capacity = (uint32_t)strlen(text) + 1 };

    if (self->err == CO_OK)
        self->err = od_add(self->od, &spec, NULL);
}

static bool wants(const struct maker *self, unsigned long options)
{
    return (self->info->ulOptions & options) != 0;
}

static void make_mappable(struct maker *self, uint16_t index)
{
    if (self->err == CO_OK)
        od_find(self->od, index, 0)->mappable = true;
}

static void make_state_objects(struct maker *self)
{
    add_u32(self, 0x1000, 0, OD_RO, self->info->ulDeviceType);
    add(self, 0x1001, 0, OD_UNSIGNED8, OD_RO, 0);
    make_mappable(self, 0x1001);
    if (wants(self, STATE_REGISTER)) {
        add_u32(self, 0x1002, 0, OD_RO, 0);
        make_mappable(self, 0x1002);
    }
    if (wants(self, ERROR_REGISTER)) {
        add(self, 0x1003, 0, OD_UNSIGNED8, OD_RW, 0);
        for (unsigned sub = 1; sub <= self->info->ucMaxErrors; sub++)
            add_u32(self, 0x1003, (uint8_t)sub, OD_RO, 0);
    }
    if (self->profile->old && wants(self, ADDITIONAL_PDOS)) {
        add_count(self, 0x1004, 2);
        add_u32(self, 0x1004, 1, OD_RO, (uint64_t)self->info->usRxPDO << 16 | self->info->usTxPDO);
        add_u32(self, 0x1004, 2, OD_RO, (uint64_t)self->info->usRxPDO << 16 | self->info->usTxPDO);
    }
}

static void make_sync(struct maker *self)
{
    const bool produces = wants(self, SYNC_GENERATION);
    uint32_t cob_id = (uint32_t)self->info->ulSyncCobID;

    if (!wants(self, SYNCHRON_PDOS | SYNC_GENERATION))
        return;
    if (!produces)
        cob_id &= (uint32_t)~SYNC_PRODUCE;
    add_u32(self, 0x1005, 0, OD_RW, cob_id);
    add_u32(self, 0x1006, 0, OD_RW, produces ? self->info->ulCyclePeriod : 0);
    add_u32(self, 0x1007, 0, OD_RW, 0);
    add(self, 0x1019, 0, OD_UNSIGNED8, OD_RW, 0);
}

static void make_manufacturer_info(struct maker *self)
{
    if (!wants(self, MANUFACTURER_INFO))
        return;
    add_text(self, 0x1008, self->info->pszDeviceName);
    add_text(self, 0x1009, self->info->pszHwVersion);
    add_text(self, 0x100A, self->info->pszSwVersion);
}

static void make_guarding(struct maker *self)
{
    if (self->profile->old) /* CiA 301 has given it up */
        add_u32(self, 0x100B, 0, OD_RO, self->profile->id);
    if (!wants(self, GUARDING))
        return;
    add(self, 0x100C, 0, OD_UNSIGNED16, OD_RW, self->info->usGuardTime);
    add(self, 0x100D, 0, OD_UNSIGNED8, OD_RW, self->info->ucLifeTime);
    if (self->profile->old)
        add_u32(self, 0x100E, 0, OD_RO, GUARD_CAN_ID + self->profile->id);
}

static void make_time(struct maker *self)
{
    uint64_t cob_id = self->info->ulTimestampCobId;

    if (cob_id == 0)
        cob_id = TIME_CONSUME | DEFAULT_TIME_COBID;
    if (wants(self, TIME_STAMP))
        add_u32(self, 0x1012, 0, OD_RW, cob_id);
}

static void make_store(struct maker *self)
{
    if (wants(self, PARAMETER_STORE))
        add_array(self, 0x1010, STORE_GROUPS, OD_RW, 1); /* stores on command */
    if (wants(self, PARAMETER_RESET))
        add_array(self, 0x1011, STORE_GROUPS, OD_RW, 1);
    if (wants(self, PARAMETER_STORE))
        add_array(self, 0x1020, 2, OD_RW, 0);
}

static void make_emergency(struct maker *self)
{
    uint64_t cob_id = self->info->ulEmcyCobId;

    if (cob_id == DEFAULT_EMCY_COBID)
        cob_id = EMCY_CAN_ID + self->profile->id;
    add_u32(self, 0x1014, 0, OD_RW, cob_id);
    add(self, 0x1015, 0, OD_UNSIGNED16, OD_RW, self->info->usEmcyInhibit * UINT64_C(10));
    if (wants(self, EMCY_CONSUMER))
        add_array(self, 0x1028, MAX_CONSUMERS, OD_RW, COB_ID_INVALID);
}

static void make_heartbeat(struct maker *self)
{
    const unsigned long *list = self->info->pulListCHBT;
    bool end = list == NULL;

    if (wants(self, CONSUMER_HEARTBEAT)) {
        add_count(self, 0x1016, self->info->ucMaxConsumerHB);
        for (unsigned i = 0; i < self->info->ucMaxConsumerHB; i++) {
            end = end || list[i] == END_OF_CHBT_LIST;
            add_u32(self, 0x1016, (uint8_t)(i + 1), OD_RW, end ? 0 : list[i]);
        }
    }
    if (wants(self, PRODUCER_HEARTBEAT))
        add(self, 0x1017, 0, OD_UNSIGNED16, OD_RW, self->info->usProducerHbTime);
}

static void make_identity(struct maker *self)
{
    const uint32_t identity[] = { (uint32_t)self->info->ulVendorId,
                                  (uint32_t)self->info->ulProductCode,
                                  (uint32_t)self->info->ulRevisionNumber,
                                  (uint32_t)self->info->ulSerialNumber };

    add_count(self, 0x1018, self->info->ucMaxIdentityObject);
    for (unsigned i = 0; i < self->info->ucMaxIdentityObject; i++)
        add_u32(self, 0x1018, (uint8_t)(i + 1), OD_RO, identity[i]);
}

/* The default channel, and others that a client has to open. */
static void make_servers(struct maker *self)
{
    const unsigned count = wants(self, ADDITIONAL_SDOS) ? self->info->ucServerSDO : 1;

    add_count(self, 0x1200, 2);
    add_u32(self, 0x1200, 1, OD_RO, 0x600u + self->profile->id);
    add_u32(self, 0x1200, 2, OD_RO, 0x580u + self->profile->id);
    for (uint16_t index = 0x1201; index < 0x1200 + count; index++) {
        add_count(self, index, 3);
        add_u32(self, index, 1, OD_RW, COB_ID_INVALID);
        add_u32(self, index, 2, OD_RW, COB_ID_INVALID);
        add(self, index, 3, OD_UNSIGNED8, OD_RW, 0);
    }
}

static void make_behaviour(struct maker *self)
{
    if (wants(self, ERROR_BEHAVIOUR_OBJECT)) {
        add_count(self, 0x1029, 1);
        add(self, 0x1029, 1, OD_UNSIGNED8, OD_RW, self->info->ucErrorBehaviour);
    }
    if (wants(self, AUTO_START)) /* operational by itself: bit 2 is 0 */
        add_u32(self, 0x1F80, 0, OD_RO, 0);
}

/* ---- what SLAVE_NODE_INFO may say ---- */

static bool is_can_id(unsigned long cob_id, unsigned long flags)
{
    const struct od nothing = { .count = 0 };

    return cob_id <= UINT32_MAX && slave_may_use(&nothing, (uint32_t)(cob_id & ~flags), true);
}

static bool is_list_good(const SLAVE_NODE_INFO *info)
{
    bool seen[NMT_NODE_MAX + 1] = { false };
    unsigned i = 0;

    if (!info->pulListCHBT)
        return true;
    for (; info->pulListCHBT[i] != END_OF_CHBT_LIST; i++) {
        const unsigned long node = info->pulListCHBT[i] >> 16;

        if (i >= info->ucMaxConsumerHB || node < 1 || node > NMT_NODE_MAX || seen[node] ||
            (info->pulListCHBT[i] & 0xFFFF) == 0)
            return false;
        seen[node] = true;
    }
    return true;
}

static bool is_in(unsigned value, unsigned least, unsigned most)
{
    return value >= least && value <= most;
}

/* Members whose flag is not set are not looked at. */
static bool are_counts_good(const SLAVE_NODE_INFO *info)
{
    const unsigned long options = info->ulOptions;

    if (info->usRxPDO > SCAN_PDOS || info->usTxPDO > SCAN_PDOS ||
        !is_in(info->ucMaxIdentityObject, 1, MAX_IDENTITY))
        return false;
    if ((options & ADDITIONAL_SDOS) && !is_in(info->ucServerSDO, 1, MAX_SERVERS))
        return false;
    if ((options & ERROR_REGISTER) && !is_in(info->ucMaxErrors, 1, MAX_ERRORS))
        return false;
    if ((options & CONSUMER_HEARTBEAT) &&
        (!is_in(info->ucMaxConsumerHB, 1, MAX_CONSUMERS) || !is_list_good(info)))
        return false;
    return !(options & ERROR_BEHAVIOUR_OBJECT) || info->ucErrorBehaviour <= ERROR_BEHAVIOUR_STOP;
}

static bool are_ids_good(const SLAVE_NODE_INFO *info)
{
    const unsigned long options = info->ulOptions;

    if ((options & (SYNCHRON_PDOS | SYNC_GENERATION)) &&
        !is_can_id(info->ulSyncCobID, SYNC_PRODUCE | COB_ID_INVALID))
        return false;
    if ((options & SYNC_GENERATION) && info->ulCyclePeriod > UINT32_MAX)
        return false;
    if ((options & TIME_STAMP) && info->ulTimestampCobId != 0 &&
        ((info->ulTimestampCobId & FRAME_29_BIT) ||
         !is_can_id(info->ulTimestampCobId, TIME_CONSUME | TIME_PRODUCE)))
        return false;
    if (info->ulEmcyCobId != DEFAULT_EMCY_COBID &&
        ((info->ulEmcyCobId & FRAME_29_BIT) || !is_can_id(info->ulEmcyCobId, 0)))
        return false;
    return info->usEmcyInhibit <= MAX_INHIBIT;
}

static bool are_texts_good(const SLAVE_NODE_INFO *info)
{
    return !(info->ulOptions & MANUFACTURER_INFO) ||
           (info->pszDeviceName && info->pszHwVersion && info->pszSwVersion);
}

static bool is_profile_good(const struct scan_profile *profile)
{
    const unsigned long known = BLOCK_TRANSFER | STATE_REGISTER | ERROR_REGISTER | SYNCHRON_PDOS |
                                MANUFACTURER_INFO | GUARDING | PARAMETER_STORE | PARAMETER_RESET |
                                ADDITIONAL_SDOS | SYNC_GENERATION | CONSUMER_HEARTBEAT |
                                PRODUCER_HEARTBEAT | EMCY_CONSUMER | ERROR_BEHAVIOUR_OBJECT |
                                PDO_ACCEPT_LONG | AUTO_START | TIME_STAMP;
    const SLAVE_NODE_INFO *info = profile->info;

    return (info->ulOptions & ~(known | (profile->old ? ADDITIONAL_PDOS : 0ul))) == 0 &&
           are_counts_good(info) && are_ids_good(info) && are_texts_good(info);
}

int scan_make_objects(const struct scan_profile *profile, struct od *od)
{
    struct maker maker = { .profile = profile, .info = profile->info, .od = od, .err = CO_OK };

    if (!is_profile_good(profile))
        return SCANOPEN_WRONG_PARAMETER;
    make_state_objects(&maker);
    make_sync(&maker);
    make_manufacturer_info(&maker);
    make_guarding(&maker);
    make_store(&maker);
    make_time(&maker);
    make_emergency(&maker);
    make_heartbeat(&maker);
    make_identity(&maker);
    make_behaviour(&maker);
    make_servers(&maker);
    return maker.err == CO_OK ? SCANOPEN_OK : SCANOPEN_OUT_OF_MEMORY;
}
