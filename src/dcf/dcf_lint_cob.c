/* CAN-IDs: none of those that CiA 301 keeps for itself, and none for two things. */
#include "dcf/dcf_lint_parts.h"

#include <stdlib.h>

#define COB_INVALID  0x80000000u
#define COB_BIT_30   0x40000000u
#define COB_EXTENDED 0x20000000u
#define ID_STANDARD  0x7FFu
#define ID_EXTENDED  0x1FFFFFFFu

enum service { SYNC, TIME, EMCY, EMCY_CONSUMER, SDO_SERVER, SDO_CLIENT, RPDO, TPDO };

static const struct users { /* objects with COB-IDs */
    uint16_t first, last;
    uint8_t first_sub, last_sub;
    enum service service;
    bool sent; /* by the device; of SYNC and TIME, which are once, it makes no difference */
} users[] = {
    { 0x1005, 0x1005, 0, 0, SYNC, false },       { 0x1012, 0x1012, 0, 0, TIME, false },
    { 0x1014, 0x1014, 0, 0, EMCY, true },        { 0x1028, 0x1028, 1, 127, EMCY_CONSUMER, false },
    { 0x1200, 0x127F, 1, 1, SDO_SERVER, false }, { 0x1200, 0x127F, 2, 2, SDO_SERVER, true },
    { 0x1280, 0x12FF, 1, 1, SDO_CLIENT, true },  { 0x1280, 0x12FF, 2, 2, SDO_CLIENT, false },
    { 0x1400, 0x15FF, 1, 1, RPDO, false },       { 0x1800, 0x19FF, 1, 1, TPDO, true },
};

static const struct range {
    uint16_t first, last;
} restricted[] = {
    { 0x000, 0x07F }, { 0x101, 0x180 }, { 0x581, 0x5FF },
    { 0x601, 0x67F }, { 0x6E0, 0x6FF }, { 0x701, 0x7FF },
};

struct user {
    const struct dcf_entry *entry;
    const struct dcf_value *value;
    enum service service;
    bool sent;
    uint32_t id; /* with COB_EXTENDED */
};

struct cob_lint {
    const struct dcf_lint *lint;
    uint16_t zero_of; /* the object of the last CAN-ID 0 */
    struct user *users;
    size_t count, room;
};

/* --- one by one --- */

static bool is_restricted(uint32_t id, enum service service)
{
    if (id & COB_EXTENDED)
        return false;
    for (size_t i = 0; i < sizeof restricted / sizeof restricted[0]; i++) {
        if (id < restricted[i].first || id > restricted[i].last)
            continue;
        return service != SDO_CLIENT || id < 0x581 || id > 0x67F; /* a server's own */
    }
    return false;
}

static uint32_t cob_id_of(const struct dcf_entry *entry, const struct dcf_value *value,
                          uint8_t node_id)
{
    return (uint32_t)dcf_value_number(value, entry->type, node_id);
}

static uint32_t id_of(uint32_t cob_id)
{
    return cob_id & COB_EXTENDED ? cob_id & (COB_EXTENDED | ID_EXTENDED) : cob_id & ID_STANDARD;
}

/* Also with the last node-ID, where the file leaves it open. */
static bool is_restricted_for(const struct cob_lint *self, const struct user *user, uint8_t node_id)
{
    uint32_t cob_id = cob_id_of(user->entry, user->value, node_id);

    return is_restricted(id_of(cob_id), user->service) &&
           (node_id == self->lint->node_id || !self->lint->dcf->has_node_id);
}

/* True for one that is told. An object full of zeros, meant as not used, is one fault. */
static bool check_restricted(struct cob_lint *self, const struct user *user)
{
    uint8_t node_id = self->lint->node_id;
    uint16_t index = user->entry->index;

    if (index == 0x1200)
        return false;
    if (!is_restricted_for(self, user, node_id))
        node_id = 127;
    if (!is_restricted_for(self, user, node_id))
        return false;
    if (user->id != 0 || self->zero_of != index)
        dcf_tell(self->lint->report, DCF_RULE_COB_ID_RESTRICTED, user->value->line,
                 "%04Xh:%02X: a CAN-ID that CiA 301 does not keep for other services expected, "
                 "there is %03Xh%s",
                 index, user->entry->sub,
                 (unsigned)id_of(cob_id_of(user->entry, user->value, node_id)),
                 user->id == 0 ? ": without use it is 80000000h" : "");
    if (user->id == 0)
        self->zero_of = index;
    return true;
}

static void check_bits(const struct cob_lint *self, const struct user *user, uint32_t cob_id)
{
    if ((cob_id & COB_EXTENDED) || (cob_id & ID_EXTENDED) <= ID_STANDARD)
        return;
    dcf_tell(self->lint->report, DCF_RULE_COB_ID_BITS, user->value->line,
             "%04Xh:%02X: a CAN-ID of 11 bits expected, or bit 29 set, there is %08lXh",
             user->entry->index, user->entry->sub, (unsigned long)cob_id);
}

/* --- collecting --- */

static bool is_valid(const struct dcf_lint_object *object, uint32_t cob_id, enum service service,
                     uint8_t node_id)
{
    if (service == SYNC)
        return true;
    if (service == TIME)
        return (cob_id & (COB_INVALID | COB_BIT_30)) != 0;
    if (service == SDO_SERVER || service == SDO_CLIENT) { /* both of them make a channel */
        for (unsigned sub = 1; sub <= 2; sub++) {
            const struct dcf_entry *entry = dcf_lint_sub(object, sub);
            const struct dcf_value *value = entry ? dcf_lint_effective(entry) : NULL;

            if (!value || (cob_id_of(entry, value, node_id) & COB_INVALID))
                return false;
        }
    }
    return !(cob_id & COB_INVALID);
}

static bool add(struct cob_lint *self, const struct user *user)
{
    size_t room = self->room ? 2 * self->room : 64;
    struct user *grown;

    if (self->count == self->room) {
        grown = realloc(self->users, room * sizeof *grown);
        if (!grown)
            return false;
        self->users = grown;
        self->room = room;
    }
    self->users[self->count++] = *user;
    return true;
}

static bool collect_entry(struct cob_lint *self, const struct dcf_lint_object *object,
                          const struct dcf_entry *entry, const struct users *kind)
{
    const struct dcf_value *value = dcf_lint_effective(entry);
    struct user user = {
        .entry = entry, .value = value, .service = kind->service, .sent = kind->sent
    };
    uint32_t cob_id;

    if (!value || entry->type != OD_UNSIGNED32 || entry->sub < kind->first_sub ||
        entry->sub > kind->last_sub)
        return true;
    cob_id = cob_id_of(entry, value, self->lint->node_id);
    if (!is_valid(object, cob_id, kind->service, self->lint->node_id))
        return true;
    user.id = id_of(cob_id);
    check_bits(self, &user, cob_id);
    return check_restricted(self, &user) || add(self, &user);
}

static bool collect_object(struct cob_lint *self, const struct dcf_lint_object *object)
{
    uint16_t index = object->entries->index;

    for (size_t k = 0; k < sizeof users / sizeof users[0]; k++) {
        if (index < users[k].first || index > users[k].last)
            continue;
        for (size_t i = 0; i < object->count; i++) {
            if (!collect_entry(self, object, &object->entries[i], &users[k]))
                return false;
        }
    }
    return true;
}

/* --- against each other --- */

static int compare_users(const void *left, const void *right)
{
    const struct user *a = left, *b = right;

    if (a->id != b->id)
        return a->id < b->id ? -1 : 1;
    return (a->entry > b->entry) - (a->entry < b->entry);
}

/* What two of a kind receive they may have from the same sender. */
static bool can_share(const struct user *a, const struct user *b)
{
    return (!a->sent && !b->sent && a->service == b->service) ||
           (a->service == EMCY && b->service == EMCY_CONSUMER);
}

static void check_pair(const struct cob_lint *self, const struct user *first,
                       const struct user *user)
{
    bool depends = first->value->has_node_id != user->value->has_node_id;

    if (first->id != user->id || can_share(first, user) ||
        (depends && !self->lint->dcf->has_node_id))
        return;
    dcf_tell(self->lint->report, DCF_RULE_COB_ID_TWICE, user->value->line,
             "%04Xh:%02X: a CAN-ID of its own expected, %03lXh is that of %04Xh:%02X as well",
             user->entry->index, user->entry->sub, (unsigned long)(user->id & ID_EXTENDED),
             first->entry->index, first->entry->sub);
}

static bool collect(struct cob_lint *self)
{
    struct dcf_lint_object object;

    for (bool more = dcf_lint_first(self->lint, &object, 0x1000); more;
         more = dcf_lint_next(self->lint, &object)) {
        if (object.entries->index > 0x1FFF)
            break;
        if (!collect_object(self, &object))
            return false;
    }
    return true;
}

bool dcf_lint_cob_ids(const struct dcf_lint *self)
{
    struct cob_lint lint = { .lint = self };
    bool done = collect(&lint);

    if (lint.count > 0)
        qsort(lint.users, lint.count, sizeof *lint.users, compare_users);
    for (size_t i = 1; done && i < lint.count; i++)
        check_pair(&lint, &lint.users[i - 1], &lint.users[i]);
    free(lint.users);
    return done;
}
