/* Errors of the application, canOpenSetError and canOpenResetError, and emergencies of others. */
#include "api/log.h"
#include "api/scan.h"

#include <stdio.h>
#include <string.h>

#define REGISTER_BITS 0xBFu /* of 1001h; bit 6 is reserved */

/* ---- errors of the application ---- */

static bool is_register(unsigned short bits)
{
    return (bits & ~REGISTER_BITS) == 0;
}

/* Under the lock, where the outbox always has room. */
static int raise_error(struct scan_node *node, const struct slave_error *error, co_us_t now,
                       struct co_outbox *out)
{
    if (!node->active)
        return SCANOPEN_WRONG_NODESTATE;
    slave_raise_error(&node->slave, error, now, out);
    return SCANOPEN_OK;
}

int canOpenSetError(HNODE Hnode, unsigned short ErrorCode, unsigned short ErrorInformation,
                    unsigned short ErrorRegister, const unsigned char *ErrorField)
{
    struct slave_error error = { .code = ErrorCode,
                                 .info = ErrorInformation,
                                 .error_register = (uint8_t)ErrorRegister };
    struct scan_node *node;
    struct co_outbox *out;
    co_us_t now;
    int result = scan_enter(Hnode, &node);

    if (result != SCANOPEN_OK)
        return result;
    if (ErrorField)
        memcpy(error.field, ErrorField, sizeof error.field);
    if (ErrorCode == EMCY_ERROR_RESET || !is_register(ErrorRegister)) {
        result = SCANOPEN_WRONG_PARAMETER;
    } else {
        out = scan_lock(node, &now);
        result = raise_error(node, &error, now, out);
        scan_unlock(node);
    }
    scan_leave(node);
    return result;
}

static int clear_error(struct scan_node *node, unsigned short bits, const unsigned char *field,
                       co_us_t now, struct co_outbox *out)
{
    static const uint8_t none[5] = { 0 };

    if (!node->active || slave_clear_error(&node->slave, (uint8_t)bits, field ? field : none, now,
                                           out) == CO_ERR_STATE)
        return SCANOPEN_WRONG_NODESTATE;
    return SCANOPEN_OK;
}

int canOpenResetError(HNODE Hnode, unsigned short ErrorRegister, const unsigned char *ErrorField)
{
    struct scan_node *node;
    struct co_outbox *out;
    co_us_t now;
    int result = scan_enter(Hnode, &node);

    if (result != SCANOPEN_OK)
        return result;
    if (!is_register(ErrorRegister)) {
        result = SCANOPEN_WRONG_PARAMETER;
    } else {
        out = scan_lock(node, &now);
        result = clear_error(node, ErrorRegister, ErrorField, now, out);
        scan_unlock(node);
    }
    scan_leave(node);
    return result;
}

/* ---- the EMCY daemon ---- */

void scan_on_emcy(struct scan_node *node, const struct co_event *event)
{
    struct scan_emcy_token token = { .node = scan_token(node),
                                     .event = { .usNetNo = (unsigned short)node->net->number,
                                                .usModId = node->id,
                                                .ulEvent = EV_EMCY,
                                                .ulArg1 = event->detail },
                                     .emcy = { .ulCobId = event->code,
                                               .usNodeId = event->detail,
                                               .ullTimestamp = scan_time_for_handlers(
                                                   node, event->actual) } };

    memcpy(token.emcy.ucData, event->data, sizeof token.emcy.ucData);
    if (scan_wants(node, EV_EMCY))
        network_put(node->net->network, &node->net->emcy, &token);
}

void scan_emcy_work(void *context, const void *element)
{
    struct scan_emcy_token token = *(const struct scan_emcy_token *)element;

    (void)context;
    token.event.arg.pArg2 = &token.emcy;
    scan_call_handler(&token.node, &token.event);
}

void scan_emcy_lost(void *context, unsigned count)
{
    const struct scan_net *net = context;
    char text[96];

    snprintf(text, sizeof text,
             "network %d: %u received emergencies lost: the event handler is too slow", net->number,
             count);
    log_put(CO_WARNING, text);
}
