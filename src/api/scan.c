#include "api/scan.h"

#include "api/log.h"

#include <stdlib.h>
#include <string.h>

/*
 * A handle is a number in the clothes of a pointer: the node's slot in the low byte, above it the
 * generation, the number of a PDO or an entry in the node, and on top what it is. 0 is no handle.
 */
#define SLOT_BITS       8u
#define WIDE            (sizeof(uintptr_t) > sizeof(uint32_t))
#define NUMBER_BITS     (WIDE ? 30u : 14u)
#define GENERATION_BITS (WIDE ? 24u : 8u)
#define GENERATION_MASK ((1u << GENERATION_BITS) - 1)
#define NUMBER_MASK     ((1u << NUMBER_BITS) - 1)

enum kind { NODE, RECEIVED, TRANSMITTED, ENTRY };

static struct {
    pthread_mutex_t lock; /* of nodes, generations, and the users of nodes */
    pthread_cond_t left;  /* a node has been left */
    struct scan_node *nodes[SCAN_NODES];
    uint32_t generations[SCAN_NODES]; /* of the last node in this slot */
    pthread_mutex_t change;           /* of nets; before all other locks */
    struct scan_net *nets[SCAN_NETWORKS];
} scan = { .lock = PTHREAD_MUTEX_INITIALIZER,
           .left = PTHREAD_COND_INITIALIZER,
           .change = PTHREAD_MUTEX_INITIALIZER };

/* ---- handles ---- */

struct parts {
    unsigned slot;
    uint32_t generation;
    uint32_t number;
    unsigned kind; /* enum kind */
};

/* A pointer that nobody dereferences. */
static void *make_handle(const struct scan_node *node, enum kind kind, uint32_t number)
{
    uintptr_t value = (uintptr_t)kind << NUMBER_BITS | number;
    void *handle;

    value = value << GENERATION_BITS | (node->generation & GENERATION_MASK);
    value = value << SLOT_BITS | node->slot;
    memcpy(&handle, &value, sizeof handle);
    return handle;
}

static struct parts take_apart(uintptr_t handle)
{
    const uintptr_t above = handle >> SLOT_BITS;

    return (struct parts){ .slot = (unsigned)(handle & ((1u << SLOT_BITS) - 1)),
                           .generation = (uint32_t)(above & GENERATION_MASK),
                           .number = (uint32_t)(above >> GENERATION_BITS & NUMBER_MASK),
                           .kind = (unsigned)(above >> GENERATION_BITS >> NUMBER_BITS) };
}

HNODE scan_node_handle(const struct scan_node *node)
{
    return make_handle(node, NODE, 0);
}

HPDO scan_pdo_handle(const struct scan_node *node, bool transmit, uint16_t number)
{
    const enum kind kind = transmit ? TRANSMITTED : RECEIVED;

    return make_handle(node, kind, number);
}

static bool make_handle_room(struct scan_node *node)
{
    const uint32_t room = node->handle_room ? 2 * node->handle_room : 32;
    struct od_entry **handles;

    if (node->handle_count < node->handle_room)
        return true;
    if (node->handle_count >= NUMBER_MASK)
        return false;
    handles = realloc(node->handles, room * sizeof(struct od_entry *));
    if (!handles)
        return false;
    node->handles = handles;
    node->handle_room = room;
    return true;
}

int scan_entry_handle(struct scan_node *node, struct od_entry *entry, HDICT *ret_handle)
{
    if (entry->handle == 0) {
        if (!make_handle_room(node))
            return SCANOPEN_OUT_OF_MEMORY;
        node->handles[node->handle_count++] = entry;
        entry->handle = node->handle_count;
    }
    *ret_handle = (HDICT)make_handle(node, ENTRY,
                                     entry->handle); // NOLINT(performance-no-int-to-ptr)
    return SCANOPEN_OK;
}

/* ---- nodes ---- */

static unsigned free_slot(void)
{
    unsigned slot = 0;

    while (slot < SCAN_NODES && scan.nodes[slot])
        slot++;
    return slot;
}

/* A generation in which a handle is never 0, and not that of the node before. */
static uint32_t next_generation(unsigned slot)
{
    uint32_t next = (scan.generations[slot] + 1) & GENERATION_MASK;

    if (next == 0)
        next = 1;
    scan.generations[slot] = next;
    return next;
}

int scan_new_node(struct scan_node **ret_node)
{
    struct scan_node *node = calloc(1, sizeof *node);
    unsigned slot;

    if (!node)
        return SCANOPEN_OUT_OF_MEMORY;
    pthread_mutex_lock(&scan.lock);
    slot = free_slot();
    if (slot < SCAN_NODES) {
        node->slot = slot;
        node->generation = next_generation(slot);
        node->closing = true; /* until it is opened */
        scan.nodes[slot] = node;
    }
    pthread_mutex_unlock(&scan.lock);
    if (slot == SCAN_NODES) {
        free(node);
        return SCANOPEN_TOO_MANY_OBJECTS;
    }
    od_init(&node->od);
    *ret_node = node;
    return SCANOPEN_OK;
}

void scan_open_node(struct scan_node *node)
{
    pthread_mutex_lock(&scan.lock);
    node->closing = false;
    pthread_mutex_unlock(&scan.lock);
}

void scan_free_entry(void *owner)
{
    struct scan_entry *entry = owner;

    if (entry)
        free(entry->domain);
    free(entry);
}

static void free_owners(const struct od *od)
{
    for (size_t i = 0; i < od->count; i++)
        scan_free_entry(od->entries[i]->owner);
}

void scan_free_node(struct scan_node *node)
{
    pthread_mutex_lock(&scan.lock);
    scan.nodes[node->slot] = NULL;
    pthread_mutex_unlock(&scan.lock);
    free_owners(&node->od);
    od_done(&node->od);
    free(node->handles);
    free(node->rpdos);
    free(node->tpdos);
    free(node->received);
    free(node->store_file);
    free(node->questions);
    free(node);
}

/* Under the lock. */
static struct scan_node *find(unsigned slot, uint32_t generation)
{
    struct scan_node *node = slot < SCAN_NODES ? scan.nodes[slot] : NULL;

    return node && !node->closing && (node->generation & GENERATION_MASK) == generation ? node
                                                                                        : NULL;
}

static int enter(const struct parts *parts, struct scan_node **ret_node)
{
    struct scan_node *node;

    pthread_mutex_lock(&scan.lock);
    node = find(parts->slot, parts->generation);
    if (node)
        node->users++;
    pthread_mutex_unlock(&scan.lock);
    *ret_node = node;
    return node ? SCANOPEN_OK : SCANOPEN_INVALID_HANDLE;
}

int scan_enter(HNODE handle, struct scan_node **ret_node)
{
    const struct parts parts = take_apart((uintptr_t)handle);

    return parts.kind == NODE && parts.number == 0 ? enter(&parts, ret_node)
                                                   : SCANOPEN_INVALID_HANDLE;
}

int scan_enter_token(const struct scan_token *token, struct scan_node **ret_node)
{
    const struct parts parts = { .slot = token->slot, .generation = token->generation };

    return enter(&parts, ret_node);
}

int scan_enter_pdo(HPDO handle, struct scan_node **ret_node, bool *ret_transmit,
                   uint16_t *ret_number)
{
    const struct parts parts = take_apart((uintptr_t)handle);

    *ret_transmit = parts.kind == TRANSMITTED;
    *ret_number = (uint16_t)parts.number;
    if ((parts.kind != TRANSMITTED && parts.kind != RECEIVED) || parts.number < 1 ||
        parts.number > SCAN_PDOS)
        return SCANOPEN_INVALID_HANDLE;
    return enter(&parts, ret_node);
}

int scan_enter_entry(HDICT handle, struct scan_node **ret_node, uint32_t *ret_number)
{
    const struct parts parts = take_apart((uintptr_t)handle);

    *ret_number = parts.number;
    return parts.kind == ENTRY && parts.number > 0 ? enter(&parts, ret_node)
                                                   : SCANOPEN_INVALID_HANDLE;
}

void scan_leave(struct scan_node *node)
{
    pthread_mutex_lock(&scan.lock);
    if (--node->users <= 1 && node->closing) /* the one who closes it is inside */
        pthread_cond_broadcast(&scan.left);
    pthread_mutex_unlock(&scan.lock);
}

bool scan_close_node(struct scan_node *node, void (*wake)(struct scan_node *node))
{
    bool first;

    pthread_mutex_lock(&scan.lock);
    first = !node->closing;
    node->closing = true;
    pthread_mutex_unlock(&scan.lock);
    if (!first)
        return false;
    wake(node);
    pthread_mutex_lock(&scan.lock);
    while (node->users > 1) /* the one who closes it is inside */
        pthread_cond_wait(&scan.left, &scan.lock);
    pthread_mutex_unlock(&scan.lock);
    return true;
}

void scan_each_node(const struct scan_net *net,
                    void (*visit)(struct scan_node *node, const void *context), const void *context)
{
    pthread_mutex_lock(&scan.lock);
    for (unsigned i = 0; i < SCAN_NODES; i++)
        if (scan.nodes[i] && !scan.nodes[i]->closing && scan.nodes[i]->net == net)
            visit(scan.nodes[i], context);
    pthread_mutex_unlock(&scan.lock);
}

struct scan_token scan_token(const struct scan_node *node)
{
    return (struct scan_token){ .slot = node->slot,
                                .generation = node->generation & GENERATION_MASK };
}

struct co_outbox *scan_lock(struct scan_node *node, co_us_t *ret_now)
{
    return network_enter(node->net->network, ret_now);
}

struct co_outbox *scan_lock_untimed(struct scan_node *node, co_us_t *ret_now)
{
    return network_enter_untimed(node->net->network, ret_now);
}

void scan_unlock(struct scan_node *node)
{
    network_leave(node->net->network, node->id);
}

/* ---- networks ---- */

struct scan_net *scan_net(int number)
{
    return number >= 0 && number < (int)SCAN_NETWORKS ? scan.nets[number] : NULL;
}

void scan_set_net(int number, struct scan_net *net)
{
    scan.nets[number] = net;
}

void scan_begin_change(void)
{
    pthread_mutex_lock(&scan.change);
    log_keep();
}

void scan_end_change(void)
{
    pthread_mutex_unlock(&scan.change);
    log_release();
}
