/* Messages of rtnetlink as the kernel builds them, and records of real ones. */
#ifndef TEST_SUPPORT_LINK_MESSAGE_H
#define TEST_SUPPORT_LINK_MESSAGE_H

#include "port/can_link.h"

/* Writes one message at the end of what is there already; returns the new size. */
size_t link_message_add(uint8_t data[CAN_LINK_MESSAGE_MAX], size_t size,
                        const struct can_link_news *news);

/*
 * A file of TEST_DATA_DIR/link: "# what was done" before the datagrams it has brought, one line of
 * hexadecimal digits each. The datagrams of the n-th such line, one behind the other; SIZE_MAX: no
 * more of them.
 */
size_t link_record(const char *file, unsigned number, char title[80],
                   uint8_t ret_data[CAN_LINK_MESSAGE_MAX]);

#endif
