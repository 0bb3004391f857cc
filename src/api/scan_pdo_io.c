/* PDOs sent, received and requested by the application: canOpenWritePDO, ReadPDO, RequestPDO. */
#include "api/callback.h"
#include "api/scan.h"

#include <string.h>

/* ---- sending ---- */

int scan_error_of_send(enum co_err err)
{
    if (err == CO_OK || err == CO_ERR_AGAIN) /* it waits for room, which comes at once */
        return SCANOPEN_OK;
    if (err == CO_ERR_INHIBITED)
        return SCANOPEN_INHIBITED;
    return err == CO_ERR_STATE ? SCANOPEN_WRONG_NODESTATE : SCANOPEN_SERVICE_NOT_ALLOWED;
}

/* Under the lock, after it was put out: until its frame has been on the bus. */
static int wait_confirmed(struct scan_node *node, struct scan_pdo *pdo, unsigned before)
{
    const co_us_t limit = pdo->tx_timeout
                              ? network_time(node->net->network) + CO_MS(pdo->tx_timeout)
                              : CO_NEVER;
    enum co_err err = CO_OK;

    while (pdo->confirmed == before) {
        if (err == CO_ERR_TIMEOUT)
            return SCANOPEN_TX_TIMEOUT;
        if (err == CO_ERR_STATE)
            return SCANOPEN_INVALID_HANDLE;
        if (scan_node_state(node) != NodeOperational)
            return SCANOPEN_WRONG_NODESTATE;
        err = network_wait(node->net->network, node->id, limit);
    }
    return SCANOPEN_OK;
}

int scan_wait_sent(struct scan_node *node, const struct od_entry *entry, int result)
{
    if (result != SCANOPEN_OK || callback_running() || node->held)
        return result;
    for (uint16_t i = 1; i <= node->tpdo_count && node->active; i++) {
        struct scan_pdo *pdo = &node->tpdos[i - 1];

        if (!(pdo->mode & TX_DONE_PDO) || !(pdo->mode & AUTO_NOTIFY_PDO) ||
            !pdo_map_contains(&slave_tpdo(&node->slave, i)->map, entry))
            continue;
        result = wait_confirmed(node, pdo, pdo->confirmed);
        if (result != SCANOPEN_OK)
            return result;
    }
    return SCANOPEN_OK;
}

/* All of it, or nothing: a value that its entry does not allow changes none. */
static int take_buffer(const struct tpdo *tpdo, const uint8_t *buffer)
{
    for (unsigned pass = 0; pass < 2; pass++)
        for (unsigned i = 0; i < tpdo->map.count; i++) {
            struct od_entry *entry = tpdo->map.fields[i].entry;
            const sdo_abort_t code = scan_take_field(&tpdo->map.fields[i], buffer, pass == 1);

            if (entry && code != SDO_OK)
                return scan_error_of_value(code);
        }
    return SCANOPEN_OK;
}

static int write_pdo(struct scan_node *node, uint16_t number, const uint8_t *buffer, co_us_t now,
                     struct co_outbox *out)
{
    struct scan_pdo *pdo = scan_pdo(node, true, number);
    const struct tpdo *tpdo = node->active ? slave_tpdo(&node->slave, number) : NULL;
    const unsigned before = pdo->confirmed;
    int result;

    if ((pdo->mode & TX_DONE_PDO) && callback_running())
        return SCANOPEN_SERVICE_NOT_ALLOWED;
    if (scan_node_state(node) != NodeOperational || !tpdo)
        return SCANOPEN_WRONG_NODESTATE;
    if (tpdo->type < TPDO_EVENT || !tpdo_is_valid(tpdo))
        return SCANOPEN_SERVICE_NOT_ALLOWED;
    result = buffer ? take_buffer(tpdo, buffer) : SCANOPEN_OK;
    if (result != SCANOPEN_OK)
        return result;
    result = scan_error_of_send(slave_pdo_send(&node->slave, number, now, out));
    if (result == SCANOPEN_OK && (pdo->mode & TX_DONE_PDO))
        return wait_confirmed(node, pdo, before);
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
    out = scan_lock(node, &now);
    if (transmit)
        result = write_pdo(node, number, buffer, now, out);
    else
        result = SCANOPEN_SERVICE_NOT_ALLOWED;
    scan_unlock(node);
    scan_leave(node);
    return result;
}

/* ---- receiving ---- */

/* Until data has come that was not there before; the PDO may go away meanwhile. */
static int wait_received(struct scan_node *node, uint16_t number, co_us_t limit,
                         const struct rpdo *before)
{
    enum co_err err = CO_OK;

    for (;;) {
        const struct rpdo *rpdo = node->active ? slave_rpdo(&node->slave, number) : NULL;

        if (err == CO_ERR_STATE)
            return SCANOPEN_INVALID_HANDLE;
        if (!rpdo || scan_node_state(node) != NodeOperational)
            return SCANOPEN_WRONG_NODESTATE;
        if (rpdo->received != before->received)
            return SCANOPEN_OK;
        if (rpdo->errors != before->errors)
            return SCANOPEN_LENGTH_MISMATCH;
        if (err == CO_ERR_TIMEOUT)
            return SCANOPEN_RX_TIMEOUT;
        err = network_wait(node->net->network, node->id, limit);
    }
}

/* Who waits takes the data instead of the handlers, or lets them be called. */
static int read_pdo(struct scan_node *node, uint16_t number, void *buffer, co_us_t limit)
{
    struct scan_pdo *pdo = scan_pdo(node, false, number);
    struct rpdo *rpdo = slave_rpdo(&node->slave, number);
    const struct rpdo before = *rpdo;
    int result;

    rpdo->waiters++;
    pdo->takers += buffer != NULL;
    pdo->callers += buffer == NULL;
    result = wait_received(node, number, limit, &before);
    pdo->takers -= buffer != NULL;
    pdo->callers -= buffer == NULL;
    rpdo = node->active ? slave_rpdo(&node->slave, number) : NULL;
    if (rpdo && rpdo->waiters > 0)
        rpdo->waiters--;
    if (result == SCANOPEN_OK && buffer)
        memcpy(buffer, rpdo->data, sizeof rpdo->data);
    return result;
}

static int check_readable(const struct scan_node *node, uint16_t number)
{
    const struct rpdo *rpdo;

    if (scan_node_state(node) != NodeOperational)
        return SCANOPEN_WRONG_NODESTATE;
    rpdo = slave_rpdo(&node->slave, number);
    return rpdo && rpdo_is_valid(rpdo) ? SCANOPEN_OK : SCANOPEN_SERVICE_NOT_ALLOWED;
}

static co_us_t rx_limit(const struct scan_node *node, uint16_t number, co_us_t now)
{
    return now + CO_MS(scan_pdo(node, false, number)->rx_timeout);
}

static int receive(HPDO handle, void *buffer,
                   int (*begin)(struct scan_node *node, uint16_t number, co_us_t now,
                                struct co_outbox *out))
{
    struct co_outbox *out;
    struct scan_node *node;
    uint16_t number;
    bool transmit;
    co_us_t now;
    int result = SCANOPEN_SERVICE_NOT_ALLOWED;

    if (callback_running())
        return result;
    result = scan_enter_pdo(handle, &node, &transmit, &number);
    if (result != SCANOPEN_OK)
        return result;
    out = scan_lock(node, &now);
    result = transmit ? SCANOPEN_SERVICE_NOT_ALLOWED : check_readable(node, number);
    if (result == SCANOPEN_OK && begin)
        result = begin(node, number, now, out);
    if (result == SCANOPEN_OK)
        result = read_pdo(node, number, buffer, rx_limit(node, number, now));
    scan_unlock(node);
    scan_leave(node);
    return result;
}

int canOpenReadPDO(HPDO Hpdo, void *buffer)
{
    return receive(Hpdo, buffer, NULL);
}

static int request(struct scan_node *node, uint16_t number, co_us_t now, struct co_outbox *out)
{
    const struct scan_pdo *pdo = scan_pdo(node, false, number);

    if (!pdo->requests)
        return SCANOPEN_SERVICE_NOT_ALLOWED;
    if (slave_rpdo_request(&node->slave, number, now, out) != CO_OK)
        return SCANOPEN_TX_TIMEOUT;
    return SCANOPEN_OK;
}

int canOpenRequestPDO(HPDO Hpdo, void *buffer)
{
    return receive(Hpdo, buffer, request);
}
