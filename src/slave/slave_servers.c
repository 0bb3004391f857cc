/* The SDO channels that a device serves: 1200h, which is fixed, and 1201h..127Fh. */
#include "slave/slave_internal.h"

#include <stdlib.h>

#define DEFAULT_SERVER 0x1200u
#define LAST_SERVER    0x127Fu
#define BUFFER_MIN     1024u

static bool is_additional(const struct od *od, uint16_t index)
{
    return index > DEFAULT_SERVER && index <= LAST_SERVER && od_has_object(od, index);
}

static unsigned count_channels(const struct od *od)
{
    unsigned count = 1;

    for (uint16_t index = DEFAULT_SERVER + 1; index <= LAST_SERVER; index++)
        count += is_additional(od, index);
    return count;
}

static uint32_t largest_capacity(const struct od *od)
{
    uint32_t largest = BUFFER_MIN;

    for (size_t i = 0; i < od->count; i++)
        if (od->entries[i]->capacity > largest)
            largest = od->entries[i]->capacity;
    return largest;
}

/* Additional ones are closed until they are configured. */
static void make_channel(struct slave *self, uint16_t index)
{
    struct slave_channel *channel = &self->channels[self->channel_count++];

    channel->index = index;
    sdo_server_init(&channel->server, self->od, index == DEFAULT_SERVER ? self->node : 0, NULL, 0);
    sdo_server_enable(&channel->server, false);
    channel->server.block = true;
}

void slave_serve_blocks(struct slave *self, bool served)
{
    for (unsigned i = 0; i < self->channel_count; i++)
        self->channels[i].server.block = served;
}

enum co_err slave_make_channels(struct slave *self)
{
    self->channels = calloc(count_channels(self->od), sizeof *self->channels);
    if (self->channels == NULL)
        return CO_ERR_MEMORY;
    self->buffer_size = largest_capacity(self->od);
    make_channel(self, DEFAULT_SERVER);
    for (uint16_t index = DEFAULT_SERVER + 1; index <= LAST_SERVER; index++)
        if (is_additional(self->od, index))
            make_channel(self, index);
    return slave_give_buffer(self, &self->channels[0]) ? CO_OK : CO_ERR_MEMORY;
}

void slave_free_channels(struct slave *self)
{
    for (unsigned i = 0; i < self->channel_count; i++)
        free(self->channels[i].server.buffer);
    free(self->channels);
    self->channels = NULL;
    self->channel_count = 0;
}

bool slave_give_buffer(const struct slave *self, struct slave_channel *channel)
{
    struct sdo_server *server = &channel->server;

    if (server->buffer == NULL)
        server->buffer = malloc(self->buffer_size);
    server->capacity = server->buffer != NULL ? self->buffer_size : 0;
    return server->buffer != NULL;
}

static void take_buffer(struct slave_channel *channel)
{
    free(channel->server.buffer);
    channel->server.buffer = NULL;
    channel->server.capacity = 0;
}

/* The CAN-ID of one direction; 0: none. Descriptions may say anything. */
static uint32_t can_id(const struct slave *self, uint16_t index, uint8_t sub)
{
    const uint64_t cob_id = od_number(self->od, index, sub, COB_ID_INVALID);
    const bool none = (cob_id & (COB_ID_INVALID | COB_ID_EXT)) != 0;

    return none ? 0 : (uint32_t)(cob_id & 0x7FF);
}

static void configure(struct slave *self, struct slave_channel *channel)
{
    uint32_t request = can_id(self, channel->index, 1);
    uint32_t response = can_id(self, channel->index, 2);

    if (request == 0 || response == 0)
        request = response = 0;
    if (request == channel->server.request_id && response == channel->server.response_id)
        return;
    sdo_server_set_channel(&channel->server, request, response);
    if (request == 0)
        take_buffer(channel);
    self->listen_generation++;
}

void slave_configure_channels(struct slave *self)
{
    for (unsigned i = 1; i < self->channel_count; i++)
        configure(self, &self->channels[i]);
}

bool slave_is_additional_server(uint16_t index)
{
    return index > DEFAULT_SERVER && index <= LAST_SERVER;
}

void slave_configure_channel(struct slave *self, uint16_t index)
{
    for (unsigned i = 1; i < self->channel_count; i++)
        if (self->channels[i].index == index)
            configure(self, &self->channels[i]);
}

void slave_enable_channels(struct slave *self, bool enabled)
{
    for (unsigned i = 0; i < self->channel_count; i++)
        sdo_server_enable(&self->channels[i].server, enabled);
}

struct slave_channel *slave_channel_of(const struct slave *self, uint32_t can_id)
{
    for (unsigned i = 0; i < self->channel_count && can_id != 0; i++)
        if (self->channels[i].server.request_id == can_id)
            return &self->channels[i];
    return NULL;
}
