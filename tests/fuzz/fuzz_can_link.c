/* Messages of rtnetlink: whatever the bytes are, names end, and each message is told once. */
#include "port/can_link.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check(bool condition)
{
    if (!condition)
        abort();
}

static void check_link(const struct can_link *link)
{
    check(memchr(link->name, '\0', sizeof link->name) != NULL && link->name[0] != '\0');
    check(link->index > 0 && link->controller <= BUS_OFF);
    check(link->is_controller || (link->bitrate == 0 && link->restart_ms == 0));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct can_link_reader reader = { data, size };
    struct can_link_news news;

    while (can_link_next(&reader, &news)) {
        check(reader.size < size);
        size = reader.size;
        if (news.type == CAN_LINK_REFUSED)
            check(news.error > 0);
        else
            check_link(&news.link);
    }
    return 0;
}
