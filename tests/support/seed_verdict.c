#include "support/seed.h"

#include "support/watch.h"

#include <stdio.h>
#include <string.h>

static const char *text_of(const struct boot_failure *failure, char *buffer, size_t size)
{
    snprintf(buffer, size, "%c step %u outcome %u %04X:%02X code %08X entry %u %X/%X",
             failure->letter ? failure->letter : '-', failure->step, failure->outcome,
             failure->index, failure->sub, (unsigned)failure->abort_code, (unsigned)failure->entry,
             (unsigned)failure->expected, (unsigned)failure->actual);
    return buffer;
}

static void judge(const struct seed *self, const struct seed_node *node, bool ok, const char *what)
{
    char text[500], last[100];

    if (ok)
        return;
    text_of(&plant_node(self->plant, node->id)->history.last, last, sizeof last);
    snprintf(text, sizeof text, "%s (%s): %s; last failure: %s", seed_fault_name(node->fault),
             node->mandatory ? "mandatory" : "optional", what, last);
    watch_check(self->plant, false, node->id, text);
}

/* --- records --- */

static bool is_cause(const struct boot_failure *failure, const struct boot_failure *cause)
{
    return failure->letter == cause->letter && failure->step == cause->step &&
           failure->outcome == cause->outcome && failure->index == cause->index &&
           failure->sub == cause->sub && failure->abort_code == cause->abort_code &&
           failure->entry >= cause->entry &&
           (cause->outcome != SDO_OUTCOME_OK ||
            (failure->expected == cause->expected && failure->actual == cause->actual));
}

static void judge_cause(const struct seed *self, const struct seed_node *node,
                        const struct boot_failure *failure)
{
    char has[100], wanted[100], text[300];
    bool died = node->fault == SEED_DIES && failure->letter == 'K'; /* while it was waited for */

    if (is_cause(failure, &node->cause) || died)
        return;
    snprintf(text, sizeof text, "its record says %s, not %s", text_of(failure, has, sizeof has),
             text_of(&node->cause, wanted, sizeof wanted));
    judge(self, node, false, text);
}

/* Nothing but its own fault can have made boots fail. */
static bool is_calm(const struct seed *self)
{
    return !self->has[SEED_LOSS] && !self->has[SEED_MANAGER] && !self->has[SEED_ORDERS];
}

/*
 * While all boot at once the bus is full, and frames of low priority wait: life signs, and answers
 * behind them. Nothing else may have kept a node from booting to which nothing has happened.
 */
static bool may_be_of_full_bus(const struct seed *self, const struct boot_failure *failure)
{
    return self->plant->sim.bitrate != 0 &&
           (failure->outcome == SDO_OUTCOME_NO_ANSWER || failure->letter == 'E' ||
            failure->letter == 'F' || failure->letter == 'K' || failure->abort_code == SDO_TIMEOUT);
}

static void judge_record(const struct seed *self, const struct seed_node *node)
{
    const struct boot_node *boot = plant_node(self->plant, node->id);

    if (seed_is_permanent(node->fault)) {
        judge_cause(self, node, &boot->failure);
        judge_cause(self, node, &boot->history.last);
        return;
    }
    judge(self, node, boot->failure.letter == 0, "its record has a failure left");
    if (!node->hit || (node->fault == SEED_RESETS_ONCE && is_calm(self)))
        judge(self, node,
              boot->history.failures == 0 || may_be_of_full_bus(self, &boot->history.last),
              "a boot has failed, without a fault");
    if (node->fault == SEED_BUSY && is_calm(self)) {
        judge(self, node, boot->history.failures > 0, "its fault is not recorded");
        judge_cause(self, node, &boot->history.last);
    }
}

/* --- states --- */

static void judge_healthy(const struct seed *self, const struct seed_node *node)
{
    const struct plant_device *device = self->plant->devices[node->id];
    const struct boot_node *boot = plant_node(self->plant, node->id);
    bool operational = device->slave.state == NMT_OPERATIONAL;

    judge(self, node, boot->booted, "not booted");
    judge(self, node, watch_is_configured(self->plant, node->id), "not configured");
    judge(self, node, boot->nmt_state == device->slave.state,
          "the manager takes it to be in another state");
    if (self->starts)
        judge(self, node, operational, "not operational");
}

static void judge_start(const struct seed *self)
{
    const struct plant *plant = self->plant;
    bool operational = plant->manager->state == NETWORK_OPERATIONAL;
    bool started = false;

    for (size_t i = 0; i < plant->sim.trace_count; i++)
        started |= plant->sim.trace[i].frame.id == NMT_CAN_ID &&
                   plant->sim.trace[i].frame.data[0] == NMT_START;
    watch_check(plant, operational == self->starts, 0,
                self->starts ? "the network is not operational"
                             : "operational without a mandatory node");
    watch_check(plant, self->starts || !started, 0, "started without a mandatory node");
}

static void judge_device(const struct seed *self, const struct seed_node *node)
{
    bool operational = self->plant->devices[node->id]->slave.state == NMT_OPERATIONAL;

    if (!self->starts && !node->kept_alive)
        judge(self, node, !operational, "operational without a mandatory node");
    if (seed_is_healthy(node))
        judge_healthy(self, node);
    judge_record(self, node);
}

void seed_judge(struct seed *self)
{
    const unsigned ended = self->done + self->cancelled + self->lost;

    judge_start(self);
    for (unsigned id = 1; id <= self->node_count; id++)
        judge_device(self, &self->nodes[id]);
    watch_check(self->plant, self->submitted == ended && self->done > 0, 0,
                "requests have not ended, or twice");
    watch_check(self->plant, self->plant->manager->dropped == 0, 0, "frames were dropped");
}

/* --- sums --- */

static const char *const names[SEED_KINDS] = {
    [SEED_OFF] = "without power",
    [SEED_MUTE] = "answers get lost",
    [SEED_TYPE] = "wrong device type",
    [SEED_VENDOR] = "wrong vendor",
    [SEED_PRODUCT] = "wrong product",
    [SEED_REVISION] = "wrong revision",
    [SEED_SERIAL] = "wrong serial number",
    [SEED_NO_IDENTITY] = "refuses its identity",
    [SEED_REFUSES] = "refuses a write",
    [SEED_RESETS] = "resets itself, always",
    [SEED_HANGS] = "hangs in mid boot",
    [SEED_NO_HEARTBEAT] = "no heartbeat",
    [SEED_NO_STATE] = "does not tell its state",
    [SEED_NO_SOFTWARE] = "does not tell its software",
    [SEED_OLD_SOFTWARE] = "old software",
    [SEED_BAD_UPDATE] = "update fails",
    [SEED_DIES] = "dies",
    [SEED_BUSY] = "busy",
    [SEED_LATE] = "late answers",
    [SEED_RESETS_ONCE] = "resets itself, once",
    [SEED_POWER] = "power fails",
    [SEED_CABLE] = "unplugged",
    [SEED_UPDATE] = "update",
    [SEED_LOSS] = "frames get lost",
    [SEED_MANAGER] = "manager's power fails",
    [SEED_ORDERS] = "orders",
};

const char *seed_fault_name(unsigned kind)
{
    return kind < SEED_KINDS ? names[kind] : "no fault";
}

void seed_add_up(const struct seed *self, struct seed_totals *totals)
{
    totals->seeds++;
    totals->nodes += self->node_count;
    totals->clean += self->clean;
    totals->never_started += !self->starts;
    totals->virtual_us += self->plant->sim.now;
    totals->frames += self->plant->sim.trace_count;
    totals->requests += self->done;
    for (unsigned id = 1; id <= self->node_count; id++)
        if (self->nodes[id].fault < SEED_FAULTS)
            totals->faults[self->nodes[id].fault]++;
    for (unsigned kind = SEED_FAULTS; kind < SEED_KINDS; kind++)
        totals->faults[kind] += self->has[kind];
}

static void add_totals(struct seed_totals *sum, const struct seed_totals *part)
{
    sum->seeds += part->seeds;
    sum->nodes += part->nodes;
    sum->clean += part->clean;
    sum->never_started += part->never_started;
    sum->virtual_us += part->virtual_us;
    sum->frames += part->frames;
    sum->requests += part->requests;
    for (unsigned kind = 0; kind < SEED_KINDS; kind++)
        sum->faults[kind] += part->faults[kind];
}

void seed_print(const struct seed_totals *parts, unsigned count)
{
    struct seed_totals sum = { .seeds = 0 };

    for (unsigned i = 0; i < count; i++)
        add_totals(&sum, &parts[i]);
    printf("%u seeds, %u nodes, %.1f virtual hours, %.1f million frames, %u requests\n", sum.seeds,
           sum.nodes, (double)sum.virtual_us / 3.6e9, (double)sum.frames / 1e6,
           (unsigned)sum.requests);
    printf("%6u plants without a fault\n%6u plants with a faulty mandatory node: not started\n",
           sum.clean, sum.never_started);
    for (unsigned kind = 0; kind < SEED_KINDS; kind++)
        printf("%6u %s: %s\n", sum.faults[kind], kind < SEED_FAULTS ? "nodes" : "plants",
               names[kind]);
}
