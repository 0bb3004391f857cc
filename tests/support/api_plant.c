#include "support/api_plant.h"

#include "port/clock.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define PATHS     4u
#define LOG_SHOWN 2000u
#define TEXT_SIZE 16384u

static void on_line(void *context, int level, const char *text)
{
    struct api_plant *self = context;
    size_t room;
    int length;

    lock_take(&self->lock);
    room = sizeof self->log - self->log_size;
    length = snprintf(self->log + self->log_size, room, "%d %s\n", level, text);
    if (length > 0 && (size_t)length < room)
        self->log_size += (size_t)length;
    condition_signal(&self->changed);
    lock_give(&self->lock);
}

static void open_network(struct api_plant *self)
{
    struct network_options options = { .bus = self->bus, .bitrate = 500 };
    char message[200] = "";
    enum co_err err = network_open(&options, &self->network, message, sizeof message);

    ck_assert_msg(err == CO_OK, "%s: %s", self->bus, message);
}

struct api_plant *api_plant_new(void)
{
    static unsigned number;
    struct api_plant *self = calloc(1, sizeof *self);

    ck_assert_ptr_nonnull(self);
    snprintf(self->bus, sizeof self->bus, "virtual:api-%d-%u", (int)getpid(), number++);
    suite_temporary("api", self->folder);
    ck_assert_ptr_nonnull(mkdtemp(self->folder));
    ck_assert_int_eq(lock_init(&self->lock), CO_OK);
    ck_assert_int_eq(condition_init(&self->changed), CO_OK);
    open_network(self);
    ck_assert_int_eq(mcanOpenSetLog(on_line, self), MCANOPEN_OK);
    return self;
}

static void remove_folder(const struct api_plant *self)
{
    char command[sizeof self->folder + 16];

    snprintf(command, sizeof command, "rm -r %s", self->folder);
    ck_assert_int_eq(system(command), 0);
}

void api_plant_free(struct api_plant *self)
{
    mcanOpenCleanup();
    mcanOpenSetLog(NULL, NULL);
    network_close(self->network);
    for (unsigned node = 1; node <= NMT_NODE_MAX; node++) {
        if (self->devices[node].running)
            slave_done(&self->devices[node].slave);
        if (self->devices[node].made)
            od_done(&self->devices[node].od);
    }
    condition_done(&self->changed);
    lock_done(&self->lock);
    remove_folder(self);
    free(self);
}

/* --- devices --- */

void api_add_device(struct api_plant *self, uint8_t node)
{
    struct api_device *device = &self->devices[node];
    struct od *od = &device->od;

    od_init(od);
    ck_assert_int_eq(od_add_number(od, 0x1000, 0, OD_UNSIGNED32, OD_RO, 0x00020192), CO_OK);
    ck_assert_int_eq(od_add_number(od, 0x1017, 0, OD_UNSIGNED16, OD_RW, 0), CO_OK);
    ck_assert_int_eq(od_add_number(od, 0x1018, 0, OD_UNSIGNED8, OD_RO, 1), CO_OK);
    ck_assert_int_eq(od_add_number(od, 0x1018, 1, OD_UNSIGNED32, OD_RO, 0x29A), CO_OK);
    device->made = true;
}

void api_add_number(struct api_plant *self, uint8_t node, uint16_t index, uint8_t size,
                    uint32_t value)
{
    uint8_t type = size == 1 ? OD_UNSIGNED8 : size == 2 ? OD_UNSIGNED16 : OD_UNSIGNED32;

    ck_assert_int_eq(od_add_number(&self->devices[node].od, index, 0, type, OD_RW, value), CO_OK);
}

void api_add_domain(struct api_plant *self, uint8_t node, uint16_t index, const void *value,
                    uint32_t size, uint32_t capacity)
{
    const struct od_spec spec = { .index = index,
                                  .type = OD_DOMAIN,
                                  .access = OD_RW,
                                  .value = value,
                                  .size = size,
                                  .capacity = capacity };

    ck_assert_int_eq(od_add(&self->devices[node].od, &spec, NULL), CO_OK);
}

/* With a complete dictionary: the device's buffer is as large as the largest entry. */
static void add_to_network(struct api_plant *self, uint8_t node)
{
    struct api_device *device = &self->devices[node];

    ck_assert_int_eq(slave_init(&device->slave, node, &device->od), CO_OK);
    ck_assert_int_eq(network_add_slave(self->network, &device->slave), CO_OK);
    device->running = true;
}

void api_devices_start(struct api_plant *self)
{
    for (uint8_t node = 1; node <= NMT_NODE_MAX; node++)
        if (self->devices[node].made)
            add_to_network(self, node);
    ck_assert_int_eq(network_start(self->network), CO_OK);
}

uint32_t api_get(struct api_plant *self, uint8_t node, uint16_t index, void *value, uint32_t room)
{
    const struct od_entry *entry;
    uint32_t size = 0;
    co_us_t now;

    network_enter(self->network, &now);
    entry = od_find(&self->devices[node].od, index, 0);
    if (entry && entry->size <= room) {
        memcpy(value, entry->value, entry->size);
        size = entry->size;
    }
    network_leave(self->network, node);
    return size;
}

/* --- files --- */

const char *api_path(const struct api_plant *self, const char *name)
{
    static char paths[PATHS][SUITE_PATH_SIZE + 64];
    static unsigned next;
    char *path = paths[next++ % PATHS];

    snprintf(path, sizeof paths[0], "%s/%s", self->folder, name);
    return path;
}

void api_write(const struct api_plant *self, const char *name, const char *text)
{
    FILE *file = fopen(api_path(self, name), "w");

    ck_assert_ptr_nonnull(file);
    ck_assert_int_ge(fputs(text, file), 0);
    ck_assert_int_eq(fclose(file), 0);
}

const char *api_network(const struct api_plant *self, int net, const char *inner)
{
    static char text[TEXT_SIZE];
    int length = snprintf(text, sizeof text,
                          "<Manager_Instance>\n<Net_No>%d</Net_No>\n<Baudrate>500</Baudrate>\n"
                          "<Interface>%s</Interface>\n<Boot_Delay>20</Boot_Delay>\n%s"
                          "</Manager_Instance>\n",
                          net, self->bus, inner);

    ck_assert_int_lt(length, (int)sizeof text);
    return text;
}

int api_config_text(const struct api_plant *self, const char *text)
{
    api_write(self, "network.xml", text);
    return mcanOpenConfig(api_path(self, "network.xml"));
}

int api_config(const struct api_plant *self, const char *inner)
{
    char text[TEXT_SIZE + 64];

    snprintf(text, sizeof text, "<CANopen_Manager>\n%s</CANopen_Manager>\n",
             api_network(self, 0, inner));
    return api_config_text(self, text);
}

void api_start(const struct api_plant *self, const char *inner)
{
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_msg(api_config(self, inner) == MCANOPEN_OK, "%s", mcanOpenGetErrorText());
    mcanOpenStart();
}

void api_boot(const struct api_plant *self, const char *inner)
{
    api_start(self, inner);
    api_wait_event(API_NETWORK_UP, -1);
}

/* --- waiting --- */

EVENT_T api_wait_event(unsigned long kind, int node)
{
    EVENT_T event;

    do
        ck_assert_int_eq(mcanOpenEvent(&event, 1), MCANOPEN_OK);
    while (((unsigned long)event.event & ~(NET_NOT_VAL | NOD_NOT_VAL)) != kind ||
           (node >= 0 && event.node != node));
    return event;
}

int api_wait_boot(int node)
{
    const unsigned long booted = API_EVENT(PARA_UC, MCANOPEN_MSG_NODE_BOOTED);
    const unsigned long failed = API_EVENT(PARA_C, MCANOPEN_MSG_BOOT_ERROR);
    EVENT_T event;

    do
        ck_assert_int_eq(mcanOpenEvent(&event, 1), MCANOPEN_OK);
    while (event.node != node ||
           ((unsigned long)event.event != booted && (unsigned long)event.event != failed));
    return (unsigned long)event.event == booted ? 0 : event.para.c;
}

void api_wait_state(int net, int node, int state)
{
    EVENT_T event;
    int is = -1;

    for (;;) {
        ck_assert_int_eq(mcanOpenGetNodeState(net, node, &is), MCANOPEN_OK);
        if (is == state)
            return;
        ck_assert_int_eq(mcanOpenEvent(&event, 1), MCANOPEN_OK);
    }
}

static unsigned count(const char *text, const char *part)
{
    unsigned times = 0;

    for (const char *at = strstr(text, part); at; at = strstr(at + 1, part))
        times++;
    return times;
}

unsigned api_log_count(struct api_plant *self, const char *text)
{
    unsigned times;

    lock_take(&self->lock);
    times = count(self->log, text);
    lock_give(&self->lock);
    return times;
}

void api_wait_log(struct api_plant *self, const char *text)
{
    co_us_t limit = clock_now() + API_PATIENCE;
    enum co_err err = CO_OK;

    lock_take(&self->lock);
    while (!strstr(self->log, text) && err != CO_ERR_TIMEOUT)
        err = condition_wait(&self->changed, &self->lock, limit);
    lock_give(&self->lock);
    ck_assert_msg(err != CO_ERR_TIMEOUT, "not in the log: '%s', but:\n...%s", text,
                  self->log + (self->log_size > LOG_SHOWN ? self->log_size - LOG_SHOWN : 0));
}

void api_forget_log(struct api_plant *self)
{
    lock_take(&self->lock);
    self->log_size = 0;
    self->log[0] = '\0';
    lock_give(&self->lock);
}
