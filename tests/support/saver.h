/*
 * A local device with 1010h, 1011h and 1020h, one for a test program: 1006h, 2000h and 6000h are
 * the values of its three groups.
 */
#ifndef TEST_SUPPORT_SAVER_H
#define TEST_SUPPORT_SAVER_H

#include "support/device.h"

#define SAVE                0x65766173u
#define LOAD                0x64616F6Cu
#define RESET_NODE          "000#8105"
#define RESET_COMMUNICATION "000#8205"

extern const struct device_entry saver_entries[];
extern struct device saver_device;

/* A checked fixture: the device is on the bus. */
void saver_setup(void);
void saver_teardown(void);
/* Writes that must be accepted. */
void saver_put(uint16_t index, uint8_t sub, uint8_t size, uint32_t value);
/* 1006h to 1111, 2000h to 2222, 6000h to 6666. */
void saver_change_all(void);
/* One of the two commands above; what the device sends and tells is forgotten. */
void saver_reset(const char *command);
/* The values of the three groups. */
void saver_expect(const char *what, uint32_t communication, uint32_t manufacturer,
                  uint32_t application);

#endif
