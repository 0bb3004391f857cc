#include "support/loader.h"

#include "base/bytes.h"
#include "support/watch.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint8_t program[LOADER_SIZE];

static struct od *od_of(const struct loader *self)
{
    return &self->plant->devices[self->node]->od;
}

void loader_restart(struct loader *self, unsigned ms)
{
    if (ms == 0)
        return;
    plant_power(self->plant, self->node, false);
    self->back_at = self->plant->sim.now + CO_MS(ms);
}

static void keep_flash_busy(struct loader *self, unsigned ms, uint32_t then)
{
    self->flash = 1;
    self->next_flash = then;
    self->busy_until = self->plant->sim.now + CO_MS(ms);
}

static void follow(struct loader *self, uint8_t command)
{
    if (command == 3) {
        self->id = 0;
        keep_flash_busy(self, self->clear_ms, self->cleared);
        return;
    }
    self->running = command == 1;
    loader_restart(self, command == 1 ? self->off_at_start : self->off_at_stop);
}

static void take_program(struct loader *self)
{
    struct od_entry *entry = od_find(od_of(self), 0x1F50, 1);

    if (entry->size == 0)
        return;
    ck_assert_uint_eq(entry->size, LOADER_SIZE);
    ck_assert_mem_eq(entry->value, program, LOADER_SIZE);
    entry->size = 0;
    self->programs++;
    self->id = self->written_id ? self->written_id : get_le32(program);
    keep_flash_busy(self, self->write_ms, self->written);
}

void loader_step(struct loader *self)
{
    co_us_t now = self->plant->sim.now;

    if (self->back_at && now >= self->back_at) {
        self->back_at = 0;
        plant_power(self->plant, self->node, true);
    }
    for (unsigned i = 0; i < self->command_count; i++)
        follow(self, self->commands[i]);
    self->command_count = 0;
    take_program(self);
    if (self->flash == 1 && now >= self->busy_until)
        self->flash = self->next_flash;
    od_set_number(od_of(self), 0x1F51, 1, self->running);
    od_set_number(od_of(self), 0x1F56, 1, self->id);
    od_set_number(od_of(self), 0x1F57, 1, self->flash);
}

void loader_run(struct loader *self, unsigned ms)
{
    const unsigned stride = ms > 5000 ? 10 : 1; /* long ones are for time to pass */

    for (unsigned i = 0; i < ms; i += stride) {
        loader_step(self);
        plant_run_ms(self->plant, stride);
    }
}

void loader_run_until(struct loader *self, const char *said, unsigned ms)
{
    for (unsigned i = 0; i < ms && !plant_said(self->plant, said); i++)
        loader_run(self, 1);
    ck_assert_msg(plant_said(self->plant, said), "\"%s\" expected:\n%s", said, self->plant->events);
}

void loader_hear(struct loader *self, const struct co_frame *frame)
{
    const bool has_room = self->command_count < sizeof self->commands;

    if (frame->id != SDO_REQUEST_ID + self->node)
        return;
    if (frame->data[0] == 0x2F && get_le16(frame->data + 1) == 0x1F51 && !self->deaf && has_room)
        self->commands[self->command_count++] = frame->data[4];
    if (frame->data[0] == 0xC6)
        self->segments = 0;
    else if (++self->segments == self->die_in_write)
        loader_restart(self, 300);
}

static void on_delivered(struct plant *plant, const struct co_frame *frame, uint8_t sender)
{
    (void)sender;
    loader_hear(plant->fault_context, frame);
}

static void add_domain(struct plant_device *device)
{
    const struct od_spec spec = {
        .index = 0x1F50, .sub = 1, .type = OD_DOMAIN, .access = OD_RW, .capacity = LOADER_SIZE
    };
    struct sdo_server *server = &device->slave.channels[0].server;

    ck_assert_int_eq(od_add(&device->od, &spec, NULL), CO_OK);
    server->buffer = realloc(server->buffer, LOADER_SIZE);
    ck_assert_ptr_nonnull(server->buffer);
    server->block = true;
    device->slave.buffer_size = LOADER_SIZE;
}

static void give_program(struct node_config *node)
{
    for (unsigned i = 0; i < LOADER_SIZE; i++)
        program[i] = (uint8_t)(i % 251u + 1u);
    put_le32(program, LOADER_NEW);
    node->software = malloc(LOADER_SIZE);
    ck_assert_ptr_nonnull(node->software);
    memcpy(node->software, program, LOADER_SIZE);
    node->software_size = LOADER_SIZE;
    node->software_file = strdup("pump.bin");
}

static struct node_config *config_of(struct plant *plant, uint8_t node)
{
    for (size_t i = 0; i < plant->config->node_count; i++)
        if (plant->config->nodes[i].node_id == node)
            return &plant->config->nodes[i];
    ck_abort_msg("node %u is not configured", node);
}

void loader_attach(struct loader *self, struct plant *plant, uint8_t node)
{
    *self = (struct loader){ .plant = plant,
                             .node = node,
                             .clear_ms = 50,
                             .write_ms = 50,
                             .cleared = 2, /* no valid program */
                             .running = true,
                             .id = LOADER_OLD };
    add_domain(plant->devices[node]);
    plant_add_object(plant->devices[node], 0x1F51, 1, 1, 1);
    plant_add_object(plant->devices[node], 0x1F56, 1, 4, LOADER_OLD);
    plant_add_object(plant->devices[node], 0x1F57, 1, 4, 0);
    give_program(config_of(plant, node));
}

void loader_make(struct loader *self, const char *node)
{
    char xml[1024];
    struct plant *plant;

    snprintf(xml, sizeof xml, "<Node_Instance><Node_Id>5</Node_Id>%s</Node_Instance>", node);
    plant = plant_new(xml, 1000000);
    plant_add_object(plant_add_device(plant, 5), 0x6200, 1, 1, 0);
    plant_configure(plant, 5, 0x6200, 1, 1, 0x55);
    loader_attach(self, plant, 5);
    plant->fault_context = self;
    plant->on_delivered = on_delivered;
    plant_power_on(plant);
}

void loader_follow(struct loader *self, uint8_t command)
{
    self->commands[self->command_count++] = command;
}

void loader_expect_updated(struct loader *self, const char *what)
{
    watch_expect_up(self->plant, what);
    ck_assert_msg(self->running && self->id == LOADER_NEW, "%s: %s", what, self->plant->events);
}

void loader_expect_failed(struct loader *self, const char *said)
{
    ck_assert_msg(plant_said_times(self->plant, said) == 1, "\"%s\" expected:\n%s", said,
                  self->plant->events);
    ck_assert_int_eq(plant_node(self->plant, 5)->step, BOOT_FAILED);
    ck_assert(!plant_node(self->plant, 5)->booted);
}
