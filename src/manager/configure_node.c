#include "manager/boot_steps.h"

#include "base/bytes.h"

static const uint8_t save_signature[4] = { 's', 'a', 'v', 'e' };
static const uint8_t load_signature[4] = { 'l', 'o', 'a', 'd' };

#define RESTORE_PARAMETERS 0x1011u
#define COMMUNICATION      2u /* sub-index of it: only 1000h..1FFFh, which a reset of them loads */

co_us_t configure_node_timeout(const struct node_config *config, uint16_t index)
{
    bool flash = index == 0x1010 || index == 0x1011 || (index >= 0x1F50 && index <= 0x1F57);
    co_us_t timeout = CO_MS(config->sdo_timeout);

    return flash && timeout < BOOT_FLASH_TIMEOUT ? BOOT_FLASH_TIMEOUT : timeout;
}

/* What fits into one frame goes without. */
static uint8_t blocks_for(const struct node_config *config, uint32_t size)
{
    return size > 4 ? config->sdo_block_size : 0;
}

static void write_object(struct boot_node *self, const struct ccf_entry *entry)
{
    struct sdo_transfer transfer = { .download = true,
                                     .indicate_size = self->config->indicate_size,
                                     .block = blocks_for(self->config, entry->size),
                                     .index = entry->index,
                                     .sub = entry->sub,
                                     .source = entry->value,
                                     .size = entry->size,
                                     .timeout = configure_node_timeout(self->config,
                                                                       entry->index) };

    boot_node_want(self, &transfer);
}

static void enter_save(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    const struct ccf_entry save = {
        .index = 0x1010, .sub = 1, .size = sizeof save_signature, .value = save_signature
    };

    if (!self->config->save_configuration ||
        (self->config->verify_configuration && !self->unsaved)) {
        boot_node_enter_error_control(self, now, out);
        return;
    }
    boot_node_enter(self, BOOT_SAVE, out);
    write_object(self, &save);
}

static void end_configure(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    const bool compared = self->config->verify_configuration;

    boot_node_put_event(
        self,
        (struct co_event){ .type = compared ? MANAGER_NODE_COMPARED : MANAGER_NODE_CONFIGURED,
                           .expected = self->entry_number,
                           .actual = self->written },
        out);
    enter_save(self, now, out);
}

/* Of a number no more than is expected: an answer that does not tell its size has four bytes. */
static uint32_t room_for(const struct ccf_entry *wanted)
{
    return wanted->size > 0 && wanted->size < 4 ? wanted->size : VERIFY_SIZE;
}

/* True if there is something to wait for. */
static bool follow(struct boot_node *self, enum verify_order order)
{
    const struct ccf_entry *wanted = &self->verify.wanted;

    if (order == VERIFY_READ) {
        boot_node_read_into(self, wanted->index, wanted->sub, self->verify.value, room_for(wanted));
    } else if (order == VERIFY_WRITE) {
        self->written++;
        self->unsaved = true;
        write_object(self, &self->entry);
    }
    return order != VERIFY_SKIP;
}

static void do_next_entry(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    enum verify_order order;

    do {
        if (!ccf_read(&self->reader, &self->entry)) {
            end_configure(self, now, out);
            return;
        }
        self->entry_number++;
        order = self->config->verify_configuration ? verify_on_entry(&self->verify, &self->entry)
                                                   : VERIFY_WRITE;
    } while (!follow(self, order));
}

static void enter_configure(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    ccf_reader_init(&self->reader, &self->config->ccf);
    self->entry_number = 0;
    self->written = 0;
    if (self->reader.left == 0) {
        boot_node_enter_error_control(self, now, out);
        return;
    }
    boot_node_enter(self, BOOT_CONFIGURE, out);
    verify_begin(&self->verify, &self->config->ccf);
    do_next_entry(self, now, out);
}

/* --- its default values first --- */

/* One that is to be restored is, unless it just was, or nobody boots it behind its reset. */
static void enter_restore(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    const struct ccf_entry load = { .index = RESTORE_PARAMETERS,
                                    .sub = self->config->restore_sub,
                                    .size = sizeof load_signature,
                                    .value = load_signature };

    if (!self->config->restore || load.sub == 0 || !self->config->auto_start_slave ||
        self->restoring != RESTORE_TO_COME) {
        enter_configure(self, now, out);
        return;
    }
    boot_node_enter(self, BOOT_RESTORE, out);
    write_object(self, &load);
}

/* The default values come with a reset. */
static void on_load_ordered(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    const bool communication = self->config->restore_sub == COMMUNICATION;

    self->restoring = RESTORE_ORDERED;
    boot_node_reset(self, communication ? NMT_RESET_COMMUNICATION : NMT_RESET_NODE, now, out);
}

static void fail_restore(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    const struct boot_failure silent = { .letter = 'J',
                                         .step = BOOT_RESTORE,
                                         .outcome = SDO_OUTCOME_NO_ANSWER,
                                         .index = RESTORE_PARAMETERS,
                                         .sub = self->config->restore_sub,
                                         .expected = (uint32_t)(BOOT_RESTORE_LIMIT / CO_MS(1)) };

    boot_node_fail(self, &silent, now, out);
}

static bool is_restored(const struct boot_node *self)
{
    return self->restoring == RESTORE_ORDERED || self->restoring == RESTORE_LATE;
}

/* A device that restores its values may take longer than the boot delay. */
void configure_node_on_restart(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    const bool awaited = is_restored(self) && !self->reset_heard;

    if (awaited && self->restoring == RESTORE_ORDERED) {
        self->restoring = RESTORE_LATE;
        self->deadline = now + BOOT_RESTORE_LIMIT;
        return;
    }
    if (is_restored(self))
        self->restoring = RESTORE_DONE;
    if (awaited)
        fail_restore(self, now, out);
    else
        boot_node_begin(self, now, out);
}

/* --- only if it is not there yet --- */

/*
 * What 1020h should say: from the network's file, else what the configuration itself writes there.
 */
static uint32_t expected_1020(const struct boot_node *self, uint8_t sub)
{
    uint32_t expected = sub == 1 ? self->config->configuration_date
                                 : self->config->configuration_time;
    struct ccf_reader reader;
    struct ccf_entry entry;

    ccf_reader_init(&reader, &self->config->ccf);
    while (expected == 0 && ccf_read(&reader, &entry))
        if (entry.index == 0x1020 && entry.sub == sub && entry.size == 4)
            return get_le32(entry.value);
    return expected;
}

void configure_node_enter(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    if (expected_1020(self, 1) == 0 || expected_1020(self, 2) == 0) {
        enter_restore(self, now, out);
        return;
    }
    boot_node_enter(self, BOOT_CHECK_CONFIGURATION, out);
    self->part = 1;
    boot_node_read(self, 0x1020, self->part);
}

/* A device without 1020h, or one that does not tell, is configured: that is always right. */
void configure_node_on_check(struct boot_node *self, bool ok, co_us_t now, struct co_outbox *out)
{
    if (ok)
        boot_node_tell_read(self, out);
    if (!ok || boot_node_number_read(self) != expected_1020(self, self->part)) {
        enter_restore(self, now, out);
        return;
    }
    if (self->part == 1) {
        self->part = 2;
        boot_node_read(self, 0x1020, self->part);
        return;
    }
    boot_node_put_event(self, (struct co_event){ .type = MANAGER_NODE_UP_TO_DATE }, out);
    boot_node_enter_error_control(self, now, out);
}

void boot_node_configure(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    const struct co_frame preop = nmt_command_frame(NMT_ENTER_PREOPERATIONAL,
                                                    self->config->node_id);
    const bool runs = self->step == BOOT_STARTED || self->nmt_state == NMT_OPERATIONAL;

    if (runs)
        co_outbox_put_frame(out, &preop);
    self->nmt_state = NMT_PREOPERATIONAL;
    self->booted = false;
    self->start_due = false;
    self->start_again |= runs;
    self->kept_alive = false;
    self->attempts = 0;
    supervision_stop(&self->supervision);
    enter_restore(self, now, out);
}

static void on_compared(struct boot_node *self, bool ok, co_us_t now, struct co_outbox *out)
{
    size_t size = (size_t)self->request.result.actual;

    if (!follow(self, verify_on_value(&self->verify, ok, size)))
        do_next_entry(self, now, out);
}

static void on_saved(struct boot_node *self, co_us_t now, struct co_outbox *out)
{
    self->unsaved = false;
    boot_node_enter_error_control(self, now, out);
}

void configure_node_on_done(struct boot_node *self, bool ok, co_us_t now, struct co_outbox *out)
{
    if (!self->request.transfer.download)
        on_compared(self, ok, now, out);
    else if (!ok)
        boot_node_fail_request(self, 'J', now, out);
    else if (self->step == BOOT_RESTORE)
        on_load_ordered(self, now, out);
    else if (self->step == BOOT_CONFIGURE)
        do_next_entry(self, now, out);
    else
        on_saved(self, now, out);
}
