#include "manager/boot_network.h"

#define BOOT_UPS_PAUSE CO_MS(50)   /* so long after the last boot-up message they have all come */
#define BOOT_UPS_LIMIT CO_MS(3000) /* ... and after this it is not the bus that keeps them */
#define FIRST_REMINDER CO_MS(5000)
#define LAST_REMINDER  CO_MS(60000)

static void put_event(struct manager *self, struct co_event event)
{
    co_outbox_put_event(&self->inner, &event);
}

/* --- begin: reset all, wait, boot each --- */

void boot_network_take_back(struct manager *self, struct boot_node *node, co_us_t now)
{
    manager_touch(self, node->config->node_id);
    node->request_due = false;
    if (node->request.state == REQUEST_QUEUED || node->request.state == REQUEST_RUNNING)
        sdo_channel_cancel(&self->channels[node->config->node_id], &node->request, SDO_OK, now,
                           &self->inner);
}

static void forget_nodes(struct manager *self, co_us_t now)
{
    FOR_EACH_NODE(self, node) {
        boot_network_take_back(self, node, now);
        boot_node_stop(node);
    }
    self->complete = false;
    self->up_told = false;
    self->start_all_due = false;
    self->stop_all_due = false;
}

void boot_network_suspend(struct manager *self, co_us_t now)
{
    forget_nodes(self, now);
    if (self->state != NETWORK_STOPPED)
        self->state = NETWORK_OFF;
}

static void take_rules(struct manager *self)
{
    const struct network_config *config = self->config;

    self->rules = (struct boot_rules){ .start_all = config->start_all,
                                       .auto_operational = config->auto_operational,
                                       .auto_start = config->auto_start,
                                       .action_on_error = config->action_on_error,
                                       .boot_time = config->boot_time };
}

/* each: one command for each node that may be reset, none for all. */
static void begin(struct manager *self, enum nmt_command command, bool each, co_us_t now)
{
    take_rules(self);
    forget_nodes(self, now);
    FOR_EACH_NODE(self, node)
        node->reset_due = each && boot_node_is_booted_by_master(node) &&
                          !node->config->check_node_state;
    self->state = NETWORK_RESETTING;
    self->reset_command = (uint8_t)command;
    self->reset_each = each;
    self->reset_due = true;
    self->boot_limit = CO_NEVER;
    self->deadline = now;
    boot_network_on_time(self, now);
}

void boot_network_begin(struct manager *self, enum nmt_command command, co_us_t now)
{
    begin(self, command, false, now);
}

static bool keeps_nodes_alive(const struct manager *self)
{
    LOOK_AT_EACH_NODE(self, node)
    {
        if (boot_node_is_booted_by_master(node) && node->config->check_node_state)
            return true;
    }
    return false;
}

static enum nmt_command first_command(const struct manager *self)
{
    return self->config->reset_all ? NMT_RESET_NODE : NMT_RESET_COMMUNICATION;
}

void boot_network_start(struct manager *self, co_us_t now)
{
    begin(self, first_command(self), keeps_nodes_alive(self), now);
}

static void boot_all(struct manager *self, co_us_t now)
{
    self->state = NETWORK_BOOTING;
    self->deadline = CO_NEVER;
    if (self->rules.boot_time != 0)
        self->boot_limit = now + CO_MS(self->rules.boot_time);
    self->reminder_interval = FIRST_REMINDER;
    self->reminder = now + FIRST_REMINDER;
    FOR_EACH_NODE(self, node) {
        if (boot_node_is_booted_by_master(node))
            boot_network_reboot(self, node, now);
    }
}

static void submit(struct manager *self, struct boot_node *node, co_us_t now)
{
    if (!node->request_due)
        return;
    node->request_due = false;
    sdo_channel_submit_first(&self->channels[node->config->node_id], &node->request, now,
                             &self->inner);
}

void boot_network_reboot(struct manager *self, struct boot_node *node, co_us_t now)
{
    boot_network_take_back(self, node, now);
    boot_node_begin(node, now, &self->inner);
    submit(self, node, now);
}

void boot_network_configure(struct manager *self, struct boot_node *node, co_us_t now)
{
    manager_touch(self, node->config->node_id);
    boot_network_take_back(self, node, now);
    boot_node_configure(node, now, &self->inner);
    submit(self, node, now);
}

void boot_network_boot_again(struct manager *self, struct boot_node *node, co_us_t now)
{
    boot_network_take_back(self, node, now);
    if (!boot_node_may_begin_anew(node, now, &self->inner))
        return;
    if (node->config->auto_start_slave)
        boot_network_reboot(self, node, now);
    else
        boot_network_configure(self, node, now); /* it has no other boot than by 1F25h */
}

void boot_network_go_on_updating(struct manager *self, struct boot_node *node, co_us_t now)
{
    boot_network_take_back(self, node, now);
    software_on_boot_up(node, now, &self->inner);
    submit(self, node, now);
}

void boot_network_reset_node(struct manager *self, struct boot_node *node, enum nmt_command command,
                             co_us_t now)
{
    boot_network_take_back(self, node, now);
    boot_node_reset(node, command, now, &self->inner);
}

void boot_network_renew_node(struct manager *self, struct boot_node *node, enum nmt_command command,
                             co_us_t now)
{
    node->restoring = RESTORE_TO_COME;
    boot_network_reset_node(self, node, command, now);
}

/* --- the way to operational --- */

/* It must not hear a start command: not configured, or nobody knows. */
static bool is_unready(const struct boot_node *node)
{
    return boot_node_is_booted_by_master(node) && node->config->auto_start_slave &&
           (!node->booted || node->lost);
}

bool boot_network_is_ready(const struct manager *self)
{
    LOOK_AT_EACH_NODE(self, node)
    {
        if (is_unready(node))
            return false;
    }
    return true;
}

/* A broadcast starts whoever hears it: only right when that is right for each node. */
static bool all_may_be_started(const struct manager *self)
{
    LOOK_AT_EACH_NODE(self, node)
    {
        if (!boot_node_is_booted_by_master(node) || !node->config->auto_start_slave)
            return false;
    }
    return boot_network_is_ready(self);
}

static bool may_be_started(const struct boot_node *node)
{
    return node->step == BOOT_READY && node->config->auto_start_slave;
}

void boot_network_start_each(struct manager *self, co_us_t now)
{
    FOR_EACH_NODE(self, node) {
        if (may_be_started(node) && !node->start_due)
            boot_node_start(node, now, &self->inner);
    }
}

/* Lost while all were stopped: whatever has become of them, they are booted anew. */
static void reset_lost_nodes(struct manager *self, co_us_t now)
{
    FOR_EACH_NODE(self, node) {
        if (node->lost && is_unready(node))
            boot_network_reset_node(self, node, boot_node_reset_command(node), now);
    }
}

/* What has been as it is now means something else. */
static void touch_all(struct manager *self)
{
    for (size_t i = 0; i < self->config->node_count; i++)
        manager_touch(self, self->config->nodes[i].node_id);
}

void boot_network_operate(struct manager *self, co_us_t now)
{
    self->state = NETWORK_OPERATIONAL;
    touch_all(self);
    slave_command(&self->device, NMT_START, now, &self->inner);
    reset_lost_nodes(self, now);
}

/* No device state of its own: it is one that the master commands itself. */
void boot_network_go_on_booting(struct manager *self, co_us_t now)
{
    self->state = NETWORK_BOOTING;
    touch_all(self);
    slave_command(&self->device, NMT_ENTER_PREOPERATIONAL, now, &self->inner);
    reset_lost_nodes(self, now);
}

void boot_network_go(struct manager *self, co_us_t now)
{
    boot_network_operate(self, now);
    if (!self->rules.auto_start)
        return;
    if (self->rules.start_all && all_may_be_started(self))
        self->start_all_due = true;
    else
        boot_network_start_each(self, now);
}

/* A mandatory node that is missing; there is one. */
static uint8_t first_missing(const struct manager *self)
{
    LOOK_AT_EACH_NODE(self, node)
    {
        if (roll_call_is_missing(node))
            return node->config->node_id;
    }
    return 0;
}

static void halt(struct manager *self, bool time_over)
{
    self->state = NETWORK_HALTED;
    put_event(self, (struct co_event){ .type = MANAGER_HALTED,
                                       .node = first_missing(self),
                                       .actual = self->roll.missing,
                                       .expected = time_over ? self->rules.boot_time : 0 });
}

/* Who waits for a plant to start wants to know for whom it waits. */
static void remind(struct manager *self, co_us_t now)
{
    if (now < self->reminder)
        return;
    self->reminder_interval *= 2;
    if (self->reminder_interval > LAST_REMINDER)
        self->reminder_interval = LAST_REMINDER;
    self->reminder = now + self->reminder_interval;
    if (self->roll.missing > 0)
        put_event(self, (struct co_event){ .type = MANAGER_WAITING,
                                           .node = first_missing(self),
                                           .actual = self->roll.missing });
}

static void check_booting(struct manager *self, co_us_t now)
{
    const struct roll_call *roll = &self->roll;
    bool time_over = now >= self->boot_limit;

    if (roll->missing == 0)
        self->boot_limit = CO_NEVER; /* kept: the limit is for mandatory nodes */
    if (roll->missing == 0 && roll->in_progress == 0) {
        self->complete = true;
        if (self->rules.auto_operational)
            boot_network_go(self, now);
        else
            self->state = NETWORK_WAITING;
    } else if (self->state == NETWORK_BOOTING && roll->missing > 0 &&
               (time_over || (roll->failed > 0 && roll->in_progress == 0))) {
        halt(self, time_over);
    } else if (self->state == NETWORK_BOOTING) {
        remind(self, now);
    }
}

/* A node that boots after the others, or was started when it was to be configured. */
static void start_late_node(struct manager *self, struct boot_node *node, co_us_t now)
{
    const bool is_due = self->rules.auto_start && may_be_started(node) && !node->held;

    if (!self->start_all_due && !node->start_due && node->step == BOOT_READY &&
        (is_due || node->start_again))
        boot_node_start(node, now, &self->inner);
}

bool boot_network_is_node_up(const struct manager *self, const struct boot_node *node)
{
    bool started_by_master = self->rules.auto_operational && self->rules.auto_start &&
                             node->config->auto_start_slave;

    if (!boot_node_is_booted_by_master(node))
        return true;
    return node->booted && (!started_by_master || node->nmt_state == NMT_OPERATIONAL);
}

static void tell_up(struct manager *self)
{
    unsigned booted = 0, listed = 0;

    if (self->up_told || self->roll.down > 0 || !manager_is_up(self, false))
        return;
    LOOK_AT_EACH_NODE(self, node)
    {
        booted += node->booted;
        listed += node->config->nmt_slave;
    }
    self->up_told = true;
    put_event(self, (struct co_event){
                        .type = MANAGER_NETWORK_UP, .actual = booted, .expected = listed });
}

static void look_at_touched(struct manager *self, co_us_t now)
{
    struct co_set touched = self->touched;

    self->touched = (struct co_set){ { 0 } };
    CO_SET_EACH(&touched, i)
    {
        struct boot_node *node = &self->nodes[i];

        if (!node->config)
            continue;
        submit(self, node, now);
        if (self->state == NETWORK_OPERATIONAL)
            start_late_node(self, node, now);
        roll_call_count(&self->roll, node, boot_network_is_node_up(self, node));
    }
}

void boot_network_check(struct manager *self, co_us_t now)
{
    look_at_touched(self, now);
    if (self->state == NETWORK_BOOTING || self->state == NETWORK_HALTED) {
        check_booting(self, now);
        look_at_touched(self, now); /* it may have started all of them */
    }
    tell_up(self);
}

/* --- time: what waits for room, and the two limits --- */

static bool send_all(struct manager *self, enum nmt_command command)
{
    struct co_frame frame = nmt_command_frame(command, NMT_ALL_NODES);

    if (!co_outbox_room(&self->inner, 1, 0))
        return false;
    co_outbox_put_frame(&self->inner, &frame);
    FOR_EACH_NODE(self, node) {
        boot_node_commanded(node, command);
        if (command == NMT_START)
            put_event(self, (struct co_event){ .type = MANAGER_NODE_STARTED,
                                               .node = node->config->node_id });
    }
    return true;
}

/* Each with its own command; false while there is no room for all of them. */
static bool send_resets(struct manager *self)
{
    FOR_EACH_NODE(self, node) {
        struct co_frame frame = nmt_command_frame(boot_node_reset_command(node),
                                                  node->config->node_id);

        if (!node->reset_due)
            continue;
        if (!co_outbox_room(&self->inner, 1, 0))
            return false;
        co_outbox_put_frame(&self->inner, &frame);
        node->reset_due = false;
    }
    return true;
}

static void on_resetting(struct manager *self, co_us_t now)
{
    if (!self->reset_due) {
        boot_all(self, now);
    } else if (self->reset_each ? send_resets(self)
                                : send_all(self, (enum nmt_command)self->reset_command)) {
        self->reset_due = false;
        self->deadline = now + CO_MS(self->config->boot_delay);
        self->deadline_max = self->deadline + BOOT_UPS_LIMIT;
    }
}

/*
 * On a slow bus many boot-up messages take longer than the boot delay. They have the lowest
 * priority: with SDO requests on the bus a node could send neither its own nor, behind it,
 * an answer.
 */
void boot_network_on_boot_up(struct manager *self, co_us_t now)
{
    if (!self->reset_due && self->deadline < now + BOOT_UPS_PAUSE)
        self->deadline = co_earlier(now + BOOT_UPS_PAUSE, self->deadline_max);
}

/* It has waited for room: all may be different now. */
static void send_start_all(struct manager *self, co_us_t now)
{
    if (boot_network_is_ready(self)) {
        self->start_all_due = !send_all(self, NMT_START);
    } else {
        self->start_all_due = false;
        boot_network_start_each(self, now);
    }
}

void boot_network_stop(struct manager *self, co_us_t now)
{
    self->state = NETWORK_STOPPED;
    self->start_all_due = false;
    self->stop_all_due = true;
    FOR_EACH_NODE(self, node)
        node->start_due = false;
    slave_command(&self->device, NMT_STOP, now, &self->inner);
    boot_network_on_time(self, now);
}

/* Nobody knows what has become of them: the start that the application orders boots them anew. */
static void resume_stopped(struct manager *self, co_us_t now)
{
    FOR_EACH_NODE(self, node) {
        if (!boot_node_is_booted_by_master(node))
            continue;
        if (node->config->auto_start_slave)
            node->lost = true;
        else
            boot_network_reboot(self, node, now); /* only its error control */
    }
    boot_network_stop(self, now);
}

void boot_network_resume(struct manager *self, co_us_t now)
{
    if (self->state == NETWORK_STOPPED) {
        resume_stopped(self, now);
        return;
    }
    slave_command(&self->device, first_command(self), now, &self->inner);
    boot_network_start(self, now);
    FOR_EACH_NODE(self, node)
        node->absent = true; /* one that is back a moment after us has missed the reset */
}

void boot_network_on_time(struct manager *self, co_us_t now)
{
    if (self->start_all_due)
        send_start_all(self, now);
    if (self->stop_all_due)
        self->stop_all_due = !send_all(self, NMT_STOP);
    if (self->state == NETWORK_RESETTING && now >= self->deadline)
        on_resetting(self, now);
}

co_us_t boot_network_deadline(const struct manager *self)
{
    if (self->start_all_due || self->stop_all_due)
        return 0;
    if (self->state == NETWORK_BOOTING)
        return co_earlier(self->boot_limit, self->reminder);
    return self->state == NETWORK_RESETTING ? self->deadline : CO_NEVER;
}
