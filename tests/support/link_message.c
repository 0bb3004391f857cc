#include "support/link_message.h"

#include <check.h>
#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if_arp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct writer {
    uint8_t *data;
    size_t size;
};

static void put(struct writer *self, const void *data, size_t size)
{
    ck_assert_uint_le(self->size + size + 3, CAN_LINK_MESSAGE_MAX);
    memcpy(self->data + self->size, data, size);
    self->size += size;
    while (self->size % 4 != 0)
        self->data[self->size++] = 0;
}

/* Returns where its length stands, for end(). */
static size_t begin(struct writer *self, unsigned short type)
{
    const struct rtattr head = { .rta_len = sizeof head, .rta_type = type };

    put(self, &head, sizeof head);
    return self->size - sizeof head;
}

static void end(struct writer *self, size_t start)
{
    const unsigned short length = (unsigned short)(self->size - start);

    memcpy(self->data + start, &length, sizeof length);
}

static void put_attribute(struct writer *self, unsigned short type, const void *value, size_t size)
{
    const struct rtattr head = { .rta_len = (unsigned short)(sizeof head + size),
                                 .rta_type = type };

    put(self, &head, sizeof head);
    put(self, value, size);
}

static void put_number(struct writer *self, unsigned short type, uint32_t value)
{
    put_attribute(self, type, &value, sizeof value);
}

static void put_controller(struct writer *self, const struct can_link *link)
{
    const struct can_bittiming timing = { .bitrate = link->bitrate, .sample_point = 875 };
    const uint32_t state = link->is_up ? (uint32_t)link->controller : CAN_STATE_STOPPED;
    size_t data = begin(self, IFLA_INFO_DATA | NLA_F_NESTED);

    if (link->bitrate != 0)
        put_attribute(self, IFLA_CAN_BITTIMING, &timing, sizeof timing);
    put_number(self, IFLA_CAN_CLOCK, 8000000);
    put_number(self, IFLA_CAN_STATE, state);
    put_number(self, IFLA_CAN_RESTART_MS, link->restart_ms);
    end(self, data);
}

static void put_link(struct writer *self, const struct can_link *link)
{
    const struct ifinfomsg head = { .ifi_family = AF_UNSPEC,
                                    .ifi_type = link->is_can ? ARPHRD_CAN : ARPHRD_ETHER,
                                    .ifi_index = link->index,
                                    .ifi_flags = IFF_NOARP | (link->is_up ? IFF_UP : 0u) };
    const char *kind = link->is_controller ? "can" : "vcan";
    size_t info;

    put(self, &head, sizeof head);
    put_attribute(self, IFLA_IFNAME, link->name, strlen(link->name) + 1);
    put_number(self, IFLA_TXQLEN, link->queue_length);
    put_number(self, IFLA_MTU, 16);
    info = begin(self, IFLA_LINKINFO);
    put_attribute(self, IFLA_INFO_KIND, kind, strlen(kind));
    if (link->is_controller)
        put_controller(self, link);
    end(self, info);
}

static void put_refusal(struct writer *self, int error)
{
    const struct nlmsgerr refusal = { .error = -error };

    put(self, &refusal, sizeof refusal);
}

size_t link_message_add(uint8_t data[CAN_LINK_MESSAGE_MAX], size_t size,
                        const struct can_link_news *news)
{
    static const uint16_t types[] = {
        [CAN_LINK_IS] = RTM_NEWLINK, [CAN_LINK_GONE] = RTM_DELLINK, [CAN_LINK_REFUSED] = NLMSG_ERROR
    };
    struct writer writer = { data, size };
    struct nlmsghdr head = { .nlmsg_type = types[news->type] };

    put(&writer, &head, sizeof head);
    if (news->type == CAN_LINK_REFUSED)
        put_refusal(&writer, news->error);
    else
        put_link(&writer, &news->link);
    head.nlmsg_len = (uint32_t)(writer.size - size);
    memcpy(data + size, &head, sizeof head);
    return writer.size;
}

static size_t add_hex(const char *line, uint8_t *data, size_t size)
{
    char digits[3] = "";

    for (; line[0] != '\0' && line[0] != '\n'; line += 2) {
        memcpy(digits, line, 2);
        ck_assert_uint_lt(size, CAN_LINK_MESSAGE_MAX);
        data[size++] = (uint8_t)strtoul(digits, NULL, 16);
    }
    return size;
}

size_t link_record(const char *file, unsigned number, char title[80],
                   uint8_t ret_data[CAN_LINK_MESSAGE_MAX])
{
    static char line[2 * CAN_LINK_MESSAGE_MAX + 2];
    size_t size = 0;
    unsigned titles = 0;
    FILE *stream;

    snprintf(line, sizeof line, "%s/link/%s", TEST_DATA_DIR, file);
    stream = fopen(line, "r");
    ck_assert_msg(stream != NULL, "%s", line);
    while (titles <= number + 1 && fgets(line, sizeof line, stream)) {
        if (line[0] == '#' && ++titles == number + 1)
            snprintf(title, 80, "%.*s", (int)strcspn(line + 2, "\n"), line + 2);
        else if (line[0] != '#' && titles == number + 1)
            size = add_hex(line, ret_data, size);
    }
    fclose(stream);
    return titles > number ? size : SIZE_MAX;
}
