#include "support/saver.h"

#include <check.h>

const struct device_entry saver_entries[] = {
    { 0x1005, 0, OD_UNSIGNED32, OD_RW, 0x80, false },
    { 0x1006, 0, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1010, 0, OD_UNSIGNED8, OD_CONST, 4, false },
    { 0x1010, 1, OD_UNSIGNED32, OD_RW, 1, false },
    { 0x1010, 2, OD_UNSIGNED32, OD_RW, 1, false },
    { 0x1010, 3, OD_UNSIGNED32, OD_RW, 1, false },
    { 0x1010, 4, OD_UNSIGNED32, OD_RW, 1, false },
    { 0x1011, 0, OD_UNSIGNED8, OD_CONST, 4, false },
    { 0x1011, 1, OD_UNSIGNED32, OD_RW, 1, false },
    { 0x1011, 2, OD_UNSIGNED32, OD_RW, 1, false },
    { 0x1011, 3, OD_UNSIGNED32, OD_RW, 1, false },
    { 0x1011, 4, OD_UNSIGNED32, OD_RW, 1, false },
    { 0x1003, 0, OD_UNSIGNED8, OD_RW, 0, false },
    { 0x1003, 1, OD_UNSIGNED32, OD_RO, 0, false },
    { 0x1017, 0, OD_UNSIGNED16, OD_RW, 0, false },
    { 0x1020, 0, OD_UNSIGNED8, OD_CONST, 2, false },
    { 0x1020, 1, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1020, 2, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x2000, 0, OD_UNSIGNED16, OD_RW, 20, false },
    { 0x2001, 0, OD_VISIBLE_STRING, OD_RW, 0, false },
    { 0x2002, 0, OD_UNSIGNED16, OD_RO, 1, false },
    { 0x2003, 0, OD_DOMAIN, OD_RW, 0, false },
    { 0x6000, 0, OD_UNSIGNED16, OD_RW, 60, false },
    { 0 },
};

struct device saver_device;

void saver_setup(void)
{
    device_init(&saver_device, saver_entries);
    device_start(&saver_device);
}

void saver_teardown(void)
{
    device_done(&saver_device);
}

void saver_put(uint16_t index, uint8_t sub, uint8_t size, uint32_t value)
{
    ck_assert_uint_eq(device_write(&saver_device, index, sub, size, value), SDO_OK);
}

void saver_change_all(void)
{
    saver_put(0x1006, 0, 4, 1111);
    saver_put(0x2000, 0, 2, 2222);
    saver_put(0x6000, 0, 2, 6666);
}

void saver_reset(const char *command)
{
    device_hear(&saver_device, command);
    device_drain(&saver_device);
    device_forget(&saver_device);
}

void saver_expect(const char *what, uint32_t communication, uint32_t manufacturer,
                  uint32_t application)
{
    const uint32_t got[] = { device_value(&saver_device, 0x1006, 0),
                             device_value(&saver_device, 0x2000, 0),
                             device_value(&saver_device, 0x6000, 0) };

    ck_assert_msg(got[0] == communication && got[1] == manufacturer && got[2] == application,
                  "%s: %u %u %u", what, got[0], got[1], got[2]);
}
