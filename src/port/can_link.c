#include "port/can_link.h"

#include <limits.h>
#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if_arp.h>
#include <string.h>

#define BITRATE_TOLERANCE 100u /* one part of so many */

/* --- attributes: length, type, value, at multiples of 4 bytes --- */

struct piece {
    const uint8_t *data;
    size_t size;
};

static struct piece rest_of(struct piece self, size_t used)
{
    return used < self.size ? (struct piece){ self.data + used, self.size - used }
                            : (struct piece){ self.data, 0 };
}

static bool next_attribute(struct piece *self, unsigned *ret_type, struct piece *ret_value)
{
    struct rtattr head;

    if (self->size < sizeof head)
        return false;
    memcpy(&head, self->data, sizeof head);
    if (head.rta_len < sizeof head || head.rta_len > self->size)
        return false;
    *ret_type = head.rta_type & (unsigned)NLA_TYPE_MASK;
    *ret_value = (struct piece){ self->data + sizeof head, head.rta_len - sizeof head };
    *self = rest_of(*self, RTA_ALIGN((size_t)head.rta_len));
    return true;
}

/* Empty where there is none. */
static struct piece find_attribute(struct piece attributes, unsigned type)
{
    struct piece value;
    unsigned found;

    while (next_attribute(&attributes, &found, &value)) {
        if (found == type)
            return value;
    }
    return (struct piece){ attributes.data, 0 };
}

static uint32_t number_of(struct piece value, uint32_t otherwise)
{
    uint32_t number;

    if (value.size < sizeof number)
        return otherwise;
    memcpy(&number, value.data, sizeof number);
    return number;
}

static bool is_text(struct piece value, const char *text)
{
    size_t size = strlen(text);

    return value.size >= size && memcmp(value.data, text, size) == 0 &&
           (value.size == size || value.data[size] == '\0');
}

/* --- one interface --- */

static void read_controller(struct piece attributes, struct can_link *link)
{
    static const enum bus_state states[] = { [CAN_STATE_ERROR_ACTIVE] = BUS_ACTIVE,
                                             [CAN_STATE_ERROR_WARNING] = BUS_WARNING,
                                             [CAN_STATE_ERROR_PASSIVE] = BUS_PASSIVE,
                                             [CAN_STATE_BUS_OFF] = BUS_OFF };
    uint32_t state = number_of(find_attribute(attributes, IFLA_CAN_STATE), 0);

    link->is_controller = true;
    link->bitrate = number_of(find_attribute(attributes, IFLA_CAN_BITTIMING), 0);
    link->restart_ms = number_of(find_attribute(attributes, IFLA_CAN_RESTART_MS), 0);
    if (state < sizeof states / sizeof states[0])
        link->controller = states[state];
}

static bool read_name(struct piece value, struct can_link *link)
{
    if (value.size == 0 || value.size > sizeof link->name || value.data[value.size - 1] != '\0')
        return false;
    memcpy(link->name, value.data, value.size);
    return link->name[0] != '\0';
}

static bool read_link(struct piece body, struct can_link *ret_link)
{
    struct can_link link = { .controller = BUS_ACTIVE };
    struct piece attributes, info;
    struct ifinfomsg head;

    if (body.size < sizeof head)
        return false;
    memcpy(&head, body.data, sizeof head);
    attributes = rest_of(body, NLMSG_ALIGN(sizeof head));
    if (head.ifi_family != AF_UNSPEC || head.ifi_index <= 0 || /* news of bridges look the same */
        !read_name(find_attribute(attributes, IFLA_IFNAME), &link))
        return false;
    link.index = head.ifi_index;
    link.is_can = head.ifi_type == ARPHRD_CAN;
    link.is_up = (head.ifi_flags & IFF_UP) != 0;
    link.queue_length = number_of(find_attribute(attributes, IFLA_TXQLEN), 0);
    info = find_attribute(attributes, IFLA_LINKINFO);
    if (is_text(find_attribute(info, IFLA_INFO_KIND), "can"))
        read_controller(find_attribute(info, IFLA_INFO_DATA), &link);
    *ret_link = link;
    return true;
}

/* --- messages --- */

/* 0 is no refusal but an acknowledgement. */
static bool read_refusal(struct piece body, int *ret_error)
{
    int error = (int)number_of(body, 0);

    if (error >= 0 || error == INT_MIN)
        return false;
    *ret_error = -error;
    return true;
}

static bool read_message(unsigned type, struct piece body, struct can_link_news *ret_news)
{
    struct can_link_news news = { .type = CAN_LINK_IS };
    bool is_of_interest = false;

    if (type == RTM_NEWLINK || type == RTM_DELLINK) {
        news.type = type == RTM_NEWLINK ? CAN_LINK_IS : CAN_LINK_GONE;
        is_of_interest = read_link(body, &news.link);
    } else if (type == NLMSG_ERROR) {
        news.type = CAN_LINK_REFUSED;
        is_of_interest = read_refusal(body, &news.error);
    }
    if (is_of_interest)
        *ret_news = news;
    return is_of_interest;
}

static bool next_message(struct can_link_reader *self, unsigned *ret_type, struct piece *ret_body)
{
    struct piece all = { self->data, self->size };
    struct nlmsghdr head;

    if (all.size < sizeof head)
        return false;
    memcpy(&head, all.data, sizeof head);
    if (head.nlmsg_len < sizeof head || head.nlmsg_len > all.size)
        return false;
    *ret_type = head.nlmsg_type;
    *ret_body = (struct piece){ all.data + sizeof head, head.nlmsg_len - sizeof head };
    all = rest_of(all, NLMSG_ALIGN((size_t)head.nlmsg_len));
    self->data = all.data;
    self->size = all.size;
    return true;
}

bool can_link_next(struct can_link_reader *self, struct can_link_news *ret_news)
{
    struct piece body;
    unsigned type;

    while (next_message(self, &type, &body)) {
        if (read_message(type, body, ret_news))
            return true;
    }
    return false;
}

size_t can_link_request(const char *name, uint8_t ret_data[CAN_LINK_REQUEST_MAX])
{
    const size_t name_size = strlen(name) + 1;
    const struct rtattr attribute = { .rta_len = (unsigned short)(sizeof attribute + name_size),
                                      .rta_type = IFLA_IFNAME };
    const struct ifinfomsg body = { .ifi_family = AF_UNSPEC };
    const struct nlmsghdr head = { .nlmsg_len = (uint32_t)(sizeof head + sizeof body +
                                                           RTA_ALIGN(attribute.rta_len)),
                                   .nlmsg_type = RTM_GETLINK,
                                   .nlmsg_flags = NLM_F_REQUEST };

    memset(ret_data, 0, CAN_LINK_REQUEST_MAX);
    memcpy(ret_data, &head, sizeof head);
    memcpy(ret_data + sizeof head, &body, sizeof body);
    memcpy(ret_data + sizeof head + sizeof body, &attribute, sizeof attribute);
    memcpy(ret_data + sizeof head + sizeof body + sizeof attribute, name, name_size);
    return head.nlmsg_len;
}

bool can_link_has_other_bitrate(const struct can_link *self, unsigned kbit)
{
    const uint64_t expected = (uint64_t)kbit * 1000u;
    const uint64_t actual = self->bitrate;
    const uint64_t off = actual > expected ? actual - expected : expected - actual;

    return actual > 0 && expected > 0 && off > expected / BITRATE_TOLERANCE;
}
