/*
 * Checks of the NMT slave: commands, states, boot-up.
 */
#include "conform_families.h"
#include "conform_services.h"

#include "od/abort.h"
#include "od/od.h"

static size_t command(struct conform *self, uint8_t command, uint8_t node, uint8_t dlc)
{
    return conform_send_data(self, 0x000, (uint8_t[]){ command, node, 0 }, dlc);
}

/* A device may be told to start by itself (1F80h, bit 2). */
static uint8_t state_after_boot_up(struct conform *self)
{
    const uint64_t start_up = conform_number(self, 0x1F80, 0, 0x4);

    return (start_up & 0x5) == 0 ? STATE_OPERATIONAL : STATE_PREOP;
}

/* Boot-up, once, and then pre-operational. */
static bool check_reset(struct conform *self, uint8_t reset)
{
    const uint32_t id = conform_control_id(self);
    size_t from, at;

    from = conform_nmt(self, CONFORM_START);
    if (!conform_reset(self, reset))
        return false;
    at = conform_await_byte(self, from, id, 0x00, 0);
    if (conform_frame(self, at)->dlc != 1)
        return conform_fail(self, "the boot-up message has %u bytes, expected 1",
                            conform_frame(self, at)->dlc);
    if (conform_await_byte(self, at + 1, id, 0x00, CONFORM_QUIET) != CONFORM_NOTHING)
        return conform_fail(self, "expected one boot-up message, received two");
    from = conform_mark(self);
    return conform_watch_state(self) &&
           conform_expect_state(self, from, state_after_boot_up(self), "after the boot-up message");
}

static bool check_reset_node(struct conform *self)
{
    return check_reset(self, CONFORM_RESET_NODE);
}

static bool check_reset_communication(struct conform *self)
{
    return check_reset(self, CONFORM_RESET_COMM);
}

static bool check_restored(struct conform *self, uint8_t reset)
{
    const struct conform_object *object = conform_writable(self, 2);
    uint64_t before, after;

    if (!object || object->index >= 0x2000)
        return conform_skip(self, "no communication parameter of 2 bytes can be written");
    if (!conform_must_read_number(self, object->index, object->sub, &before) ||
        !conform_set(self, object->index, object->sub, 2, before + 1000) ||
        !conform_reset(self, reset) ||
        !conform_must_read_number(self, object->index, object->sub, &after))
        return false;
    if (after != before)
        return conform_fail(self,
                            "%04Xh:%02X was %u after the last reset, and is %u after this one",
                            object->index, object->sub, (unsigned)before, (unsigned)after);
    return true;
}

static bool check_restore_node(struct conform *self)
{
    return check_restored(self, CONFORM_RESET_NODE);
}

static bool check_restore_communication(struct conform *self)
{
    return check_restored(self, CONFORM_RESET_COMM);
}

/* A parameter of the application, of so many bytes: one bit of it is changed. */
static const struct conform_object *change_application(struct conform *self, uint64_t *ret_value)
{
    for (size_t i = 0; i < self->object_count; i++) {
        const struct conform_object *object = &self->objects[i];
        const uint32_t size = od_type_size(object->type);

        if (object->index < 0x2000 || object->access != OD_RW || size == 0 || size > 4 ||
            !object->entry || (object->entry->flags & 1u) != 0)
            continue;
        *ret_value = conform_number(self, object->index, object->sub, 0) ^ 1;
        if (conform_write_number(self, object->index, object->sub, size, *ret_value) == SDO_OK)
            return object;
    }
    return NULL;
}

static bool check_application_kept(struct conform *self)
{
    uint64_t written, found;
    const struct conform_object *object = change_application(self, &written);

    if (!object)
        return conform_skip(self, "no application object of the device can be written");
    if (!conform_reset(self, CONFORM_RESET_COMM) ||
        !conform_must_read_number(self, object->index, object->sub, &found))
        return false;
    return found == written ||
           conform_fail(self, "%04Xh:%02X: wrote %u, read %u after reset communication",
                        object->index, object->sub, (unsigned)written, (unsigned)found);
}

/* The command after each of two others, which other checks judge. */
static bool check_from(struct conform *self, uint8_t command, uint8_t state,
                       const uint8_t others[2])
{
    if (!conform_watch_state(self))
        return false;
    for (unsigned i = 0; i < 2; i++) {
        conform_nmt(self, others[i]);
        if (!conform_go(self, command, state))
            return false;
    }
    return true;
}

static bool check_start(struct conform *self)
{
    return check_from(self, CONFORM_START, STATE_OPERATIONAL,
                      (const uint8_t[]){ CONFORM_PREOP, CONFORM_STOP });
}

static bool check_stop(struct conform *self)
{
    return check_from(self, CONFORM_STOP, STATE_STOPPED,
                      (const uint8_t[]){ CONFORM_PREOP, CONFORM_START });
}

static bool check_preoperational(struct conform *self)
{
    return check_from(self, CONFORM_PREOP, STATE_PREOP,
                      (const uint8_t[]){ CONFORM_START, CONFORM_STOP });
}

static bool check_all_nodes(struct conform *self)
{
    size_t from;

    if (!conform_watch_state(self))
        return false;
    from = command(self, CONFORM_STOP, 0, 2);
    if (!conform_expect_state(self, from, STATE_STOPPED, "after NMT stop to all nodes"))
        return false;
    from = command(self, CONFORM_PREOP, 0, 2);
    return conform_expect_state(self, from, STATE_PREOP,
                                "after NMT enter pre-operational to all nodes");
}

static bool check_other_node(struct conform *self)
{
    const uint8_t node = self->options.node;
    const uint8_t others[] = { node > 1 ? (uint8_t)(node - 1) : 2,
                               node < 127 ? (uint8_t)(node + 1) : 126, (uint8_t)(node | 0x80) };

    if (!conform_watch_state(self))
        return false;
    for (size_t i = 0; i < sizeof others; i++) {
        size_t from = command(self, CONFORM_START, others[i], 2);

        if (!conform_expect_still(self, from, STATE_PREOP, "after NMT start to another node"))
            return false;
    }
    return true;
}

static bool check_length(struct conform *self)
{
    size_t from;

    if (!conform_watch_state(self))
        return false;
    from = command(self, CONFORM_START, self->options.node, 3);
    if (!conform_expect_still(self, from, STATE_PREOP, "after NMT start with 3 bytes"))
        return false;
    from = command(self, CONFORM_STOP, self->options.node, 1);
    return conform_expect_still(self, from, STATE_PREOP, "after NMT stop with 1 byte");
}

static bool check_unknown(struct conform *self)
{
    static const uint8_t unknown[] = { 0x00, 0x03, 0x7F, 0x83, 0xFF };

    if (!conform_watch_state(self))
        return false;
    for (size_t i = 0; i < sizeof unknown; i++) {
        const size_t from = command(self, unknown[i], self->options.node, 2);

        if (!conform_expect_still(self, from, STATE_PREOP, "after an unknown NMT command"))
            return false;
    }
    return true;
}

static bool check_burst(struct conform *self)
{
    static const uint8_t commands[] = { CONFORM_PREOP, CONFORM_START, CONFORM_STOP };
    size_t from;

    if (!conform_watch_state(self))
        return false;
    for (size_t i = 0; i < sizeof commands; i++)
        conform_nmt(self, commands[i]);
    from = conform_nmt(self, CONFORM_START);
    return conform_expect_state(self, from, STATE_OPERATIONAL,
                                "after pre-operational, start, stop, start at once");
}

static bool check_no_boot_up(struct conform *self)
{
    static const uint8_t commands[] = { CONFORM_START, CONFORM_START, CONFORM_PREOP, CONFORM_PREOP,
                                        CONFORM_STOP,  CONFORM_STOP,  CONFORM_PREOP };
    const size_t from = conform_mark(self);
    size_t at;

    for (size_t i = 0; i < sizeof commands; i++)
        conform_nmt(self, commands[i]);
    at = conform_await_byte(self, from, conform_control_id(self), 0x00, CONFORM_QUIET);
    return at == CONFORM_NOTHING ||
           conform_fail(self, "received a boot-up message without a reset");
}

static const struct conform_check checks[] = {
    { "nmt-reset-node", "reset node: boot-up once, then pre-operational", "CiA 301, 7.3.2",
      CONFORM_RESET, 0, check_reset_node },
    { "nmt-reset-communication", "reset communication: boot-up once, then pre-operational",
      "CiA 301, 7.3.2", CONFORM_RESET, 0, check_reset_communication },
    { "nmt-restore-node", "reset node restores communication parameters", "CiA 301, 7.3.2",
      CONFORM_RESET, 0, check_restore_node },
    { "nmt-restore-communication", "reset communication restores communication parameters",
      "CiA 301, 7.3.2", CONFORM_RESET, 0, check_restore_communication },
    { "nmt-application-kept", "reset communication leaves application objects as they are",
      "CiA 301, 7.3.2", CONFORM_EDS | CONFORM_RESET, 0, check_application_kept },
    { "nmt-start", "start: from pre-operational and from stopped", "CiA 301, 7.3.2", CONFORM_RESET,
      0, check_start },
    { "nmt-stop", "stop: from pre-operational and from operational", "CiA 301, 7.3.2",
      CONFORM_RESET, 0, check_stop },
    { "nmt-preoperational", "enter pre-operational: from operational and from stopped",
      "CiA 301, 7.3.2", CONFORM_RESET, 0, check_preoperational },
    { "nmt-all-nodes", "commands to all nodes (0) are obeyed", "CiA 301, 7.2.8", CONFORM_RESET, 0,
      check_all_nodes },
    { "nmt-other-node", "commands to other nodes are ignored", "CiA 301, 7.2.8", CONFORM_RESET, 0,
      check_other_node },
    { "nmt-length", "commands that have not 2 bytes are ignored", "CiA 301, 7.2.8", CONFORM_RESET,
      0, check_length },
    { "nmt-unknown", "unknown commands are ignored", "CiA 301, 7.2.8", CONFORM_RESET, 0,
      check_unknown },
    { "nmt-burst", "commands without a pause: the last one counts", "CiA 301, 7.3.2", CONFORM_RESET,
      0, check_burst },
    { "nmt-no-boot-up", "no boot-up message without a reset", "CiA 301, 7.3.2", CONFORM_RESET, 0,
      check_no_boot_up },
};

const struct conform_family conform_nmt_slave = { "nmt", "NMT", checks,
                                                  sizeof checks / sizeof checks[0] };
