/* PDOs sent, received and requested by the application: canOpenWritePDO, ReadPDO, RequestPDO. */
#include "api/callback.h"
#include "api/scan.h"
#include "runtime/tx_queue.h"

#include <string.h>

/* ---- sending ---- */

/* Without a limit of its own a frame is waited for until the network has surely given it up. */
static co_us_t sent_by(unsigned timeout_ms, co_us_t now)
{
    return now + (timeout_ms > 0 ? CO_MS(timeout_ms) : TX_QUEUE_GIVE_UP + CO_MS(1000));
}

/* Operational, and has been since that activation. */
static bool goes_on(const struct scan_node *node, unsigned activation)
{
    return scan_node_state(node) == NodeOperational && node->activations == activation;
}

int scan_error_of_send(enum co_err err)
{
    if (err == CO_OK || err == CO_ERR_AGAIN) /* it waits for room, which comes at once */
        return SCANOPEN_OK;
    if (err == CO_ERR_INHIBITED)
        return SCANOPEN_INHIBITED;
    return err == CO_ERR_STATE ? SCANOPEN_WRONG_NODESTATE : SCANOPEN_SERVICE_NOT_ALLOWED;
}

/* Under the lock: until all frames of it that were put out have been on the bus. */
static int wait_confirmed(struct scan_node *node, uint16_t number)
{
    struct scan_pdo *pdo = scan_pdo(node, true, number);
    const unsigned sent = slave_tpdo(&node->slave, number)->sent;
    const co_us_t limit = sent_by(pdo->tx_timeout, network_clock(node->net->network));
    const unsigned activation = node->activations;
    enum co_err err = CO_OK;

    while ((int)(sent - pdo->confirmed) > 0) {
        if (err == CO_ERR_STATE)
            return SCANOPEN_INVALID_HANDLE;
        if (!goes_on(node, activation))
            return SCANOPEN_WRONG_NODESTATE;
        if (err == CO_ERR_TIMEOUT) {
            pdo->confirmed = sent; /* given up */
            return SCANOPEN_TX_TIMEOUT;
        }
        err = network_wait(node->net->network, node->id, limit);
    }
    /* Its time on the bus counts, not when this thread had its turn. */
    return pdo->confirmed_at <= limit ? SCANOPEN_OK : SCANOPEN_TX_TIMEOUT;
}

/* It is mapped by the n-th TPDO, which is sent when it changes. */
static bool is_notified(const struct scan_node *node, uint16_t number, const struct od_entry *entry)
{
    const uint16_t mapping = (uint16_t)(0x1A00u + number - 1);
    const uint64_t count = od_number(&node->od, mapping, 0, 0);
    const uint64_t type = od_number(&node->od, (uint16_t)(mapping - 0x200u), 2, 0);

    if (!(node->tpdos[number - 1].mode & AUTO_NOTIFY_PDO) || type < TPDO_EVENT)
        return false;
    for (unsigned sub = 1; sub <= count; sub++)
        if (od_number(&node->od, mapping, (uint8_t)sub, 0) >> 8 ==
            ((uint32_t)entry->index << 8 | entry->sub))
            return true;
    return false;
}

bool scan_is_sent(const struct scan_node *node, const struct od_entry *entry)
{
    for (uint16_t i = 1; i <= node->tpdo_count && entry->map_count > 0; i++)
        if (is_notified(node, i, entry))
            return true;
    return false;
}

int scan_wait_sent(struct scan_node *node, const struct od_entry *entry, int result)
{
    if (result != SCANOPEN_OK || entry->map_count == 0 || node->held || callback_running() ||
        !slave_wants_own_frames(&node->slave))
        return result;
    for (uint16_t i = 1; i <= node->tpdo_count; i++)
        if ((node->tpdos[i - 1].mode & TX_DONE_PDO) && is_notified(node, i, entry))
            return wait_confirmed(node, i);
    return result;
}

/* All of it, or nothing: a value that its entry does not allow changes none. */
static int take_buffer(const struct tpdo *tpdo, const uint8_t *buffer)
{
    uint8_t data[8] = { 0 };

    memcpy(data, buffer, pdo_map_size(&tpdo->map)); /* there are no more */
    for (unsigned pass = 0; pass < 2; pass++)
        for (unsigned i = 0; i < tpdo->map.count; i++) {
            struct od_entry *entry = tpdo->map.fields[i].entry;
            const sdo_abort_t code = scan_take_field(&tpdo->map.fields[i], data, pass == 1);

            if (entry && code != SDO_OK)
                return scan_error_of_value(code);
        }
    return SCANOPEN_OK;
}

static int check_sendable(const struct scan_node *node, const struct scan_pdo *pdo,
                          const struct tpdo *tpdo)
{
    if ((pdo->mode & TX_DONE_PDO) && callback_running())
        return SCANOPEN_SERVICE_NOT_ALLOWED;
    if (scan_node_state(node) != NodeOperational || !tpdo)
        return SCANOPEN_WRONG_NODESTATE;
    return tpdo->type >= TPDO_EVENT && tpdo_is_valid(tpdo) ? SCANOPEN_OK
                                                           : SCANOPEN_SERVICE_NOT_ALLOWED;
}

static int write_pdo(struct scan_node *node, uint16_t number, const uint8_t *buffer, co_us_t now,
                     struct co_outbox *out)
{
    struct scan_pdo *pdo = scan_pdo(node, true, number);
    const struct tpdo *tpdo = node->active ? slave_tpdo(&node->slave, number) : NULL;
    int result = check_sendable(node, pdo, tpdo);

    if (result != SCANOPEN_OK)
        return result;
    result = buffer ? take_buffer(tpdo, buffer) : SCANOPEN_OK;
    if (result != SCANOPEN_OK)
        return result;
    if (tpdo_is_timed(tpdo))
        now = network_clock(node->net->network);
    result = scan_error_of_send(slave_pdo_send(&node->slave, number, now, out));
    if (result == SCANOPEN_OK && (pdo->mode & TX_DONE_PDO))
        return wait_confirmed(node, number);
    return result;
}

int canOpenWritePDO(HPDO Hpdo, const void *buffer)
{
    struct co_outbox *out;
    struct scan_node *node;
    uint16_t number;
    bool transmit;
    co_us_t now;
    int result = scan_enter_pdo(Hpdo, &node, &transmit, &number);

    if (result != SCANOPEN_OK)
        return result;
    out = scan_lock_untimed(node, &now);
    if (transmit)
        result = write_pdo(node, number, buffer, now, out);
    else
        result = SCANOPEN_SERVICE_NOT_ALLOWED;
    scan_unlock(node);
    scan_leave(node);
    return result;
}

/* ---- receiving ---- */

/* A call that waits for data. */
struct reception {
    uint16_t number;
    void *buffer; /* NULL: the handlers get the data */
    bool asks;    /* by a remote frame */
    unsigned activation;
    unsigned asked; /* rpdo.asked, received and errors when it began */
    unsigned received, errors;
    co_us_t asked_limit; /* for the remote frame to be on the bus */
    co_us_t limit;
};

static bool is_asking(const struct reception *self, const struct rpdo *rpdo)
{
    return self->asks && rpdo->asked == self->asked;
}

/* Its time on the bus counts, not when this thread has its turn. */
static bool has_asked_late(const struct reception *self, const struct rpdo *rpdo)
{
    return self->asks && rpdo->asked != self->asked && rpdo->asked_at > self->asked_limit;
}

/* SCANOPEN_OK, or why nothing comes any more; 1: not yet. */
static int look(const struct scan_node *node, const struct reception *self, enum co_err err,
                co_us_t *ret_limit)
{
    const struct rpdo *rpdo = node->active ? slave_rpdo(&node->slave, self->number) : NULL;

    if (err == CO_ERR_STATE)
        return SCANOPEN_INVALID_HANDLE;
    if (!rpdo || !goes_on(node, self->activation))
        return SCANOPEN_WRONG_NODESTATE;
    if (has_asked_late(self, rpdo))
        return SCANOPEN_TX_TIMEOUT;
    if (rpdo->received != self->received)
        return SCANOPEN_OK;
    if (rpdo->errors != self->errors)
        return SCANOPEN_LENGTH_MISMATCH;
    if (err == CO_ERR_TIMEOUT)
        return is_asking(self, rpdo) ? SCANOPEN_TX_TIMEOUT : SCANOPEN_RX_TIMEOUT;
    *ret_limit = is_asking(self, rpdo) ? self->asked_limit : self->limit;
    return 1;
}

/* The PDO may go away meanwhile. */
static int wait_received(struct scan_node *node, const struct reception *self)
{
    co_us_t limit = self->limit;
    enum co_err err = CO_OK;
    int result = look(node, self, err, &limit);

    while (result > 0) {
        err = network_wait(node->net->network, node->id, limit);
        result = look(node, self, err, &limit);
    }
    return result;
}

static int ask(struct scan_node *node, const struct reception *self, co_us_t now,
               struct co_outbox *out)
{
    if (!self->asks)
        return SCANOPEN_OK;
    slave_expect_request(&node->slave, self->number, true);
    return slave_rpdo_request(&node->slave, self->number, now, out) == CO_OK
               ? SCANOPEN_OK
               : SCANOPEN_SERVICE_NOT_ALLOWED; /* nothing is mapped */
}

/* Who waits takes the data instead of the handlers, or lets them be called. */
static void count_waiting(struct scan_node *node, const struct reception *self, bool begin)
{
    struct scan_pdo *pdo = scan_pdo(node, false, self->number);
    struct rpdo *rpdo = node->active ? slave_rpdo(&node->slave, self->number) : NULL;
    unsigned *const count = self->buffer ? &pdo->takers : &pdo->callers;

    *count = begin ? *count + 1 : *count - 1;
    if (rpdo && begin)
        rpdo->waiters++;
    else if (rpdo && rpdo->waiters > 0) /* it may have been made anew */
        rpdo->waiters--;
    if (rpdo && !begin && self->asks)
        slave_expect_request(&node->slave, self->number, false);
}

static int read_pdo(struct scan_node *node, struct reception *self, co_us_t now,
                    struct co_outbox *out)
{
    const struct scan_pdo *pdo = scan_pdo(node, false, self->number);
    const struct rpdo *rpdo = slave_rpdo(&node->slave, self->number);
    int result;

    self->activation = node->activations;
    self->asked = rpdo->asked;
    self->received = rpdo->received;
    self->errors = rpdo->errors;
    self->limit = now + CO_MS(pdo->rx_timeout);
    self->asked_limit = sent_by(pdo->tx_timeout, now);
    count_waiting(node, self, true);
    result = ask(node, self, now, out);
    if (result == SCANOPEN_OK)
        result = wait_received(node, self);
    count_waiting(node, self, false);
    if (result == SCANOPEN_OK && self->buffer) {
        rpdo = slave_rpdo(&node->slave, self->number);
        memcpy(self->buffer, rpdo->data, rpdo->dlc);
    }
    return result;
}

static int check_readable(const struct scan_node *node, const struct reception *self)
{
    const struct rpdo *rpdo;

    if (scan_node_state(node) != NodeOperational)
        return SCANOPEN_WRONG_NODESTATE;
    rpdo = slave_rpdo(&node->slave, self->number);
    if (!rpdo || !rpdo_is_valid(rpdo))
        return SCANOPEN_SERVICE_NOT_ALLOWED;
    return self->asks && !scan_pdo(node, false, self->number)->requests
               ? SCANOPEN_SERVICE_NOT_ALLOWED
               : SCANOPEN_OK;
}

static int receive(HPDO handle, struct reception *self)
{
    struct co_outbox *out;
    struct scan_node *node;
    bool transmit;
    co_us_t now;
    int result = SCANOPEN_SERVICE_NOT_ALLOWED;

    if (callback_running())
        return result;
    result = scan_enter_pdo(handle, &node, &transmit, &self->number);
    if (result != SCANOPEN_OK)
        return result;
    out = scan_lock(node, &now);
    result = transmit ? SCANOPEN_SERVICE_NOT_ALLOWED : check_readable(node, self);
    if (result == SCANOPEN_OK)
        result = read_pdo(node, self, now, out);
    scan_unlock(node);
    scan_leave(node);
    return result;
}

int canOpenReadPDO(HPDO Hpdo, void *buffer)
{
    struct reception reception = { .buffer = buffer };

    return receive(Hpdo, &reception);
}

int canOpenRequestPDO(HPDO Hpdo, void *buffer)
{
    struct reception reception = { .buffer = buffer, .asks = true };

    return receive(Hpdo, &reception);
}
