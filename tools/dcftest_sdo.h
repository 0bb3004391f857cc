/*
 * Reads objects of a device on a bus. Nothing is ever sent but SDO upload requests to this device
 * (and aborts of such a transfer): what runs on the bus is not disturbed.
 */
#ifndef TOOLS_DCFTEST_SDO_H
#define TOOLS_DCFTEST_SDO_H

#include "port/bus.h"
#include "proto/sdo_client.h"

struct sdo_reader {
    struct bus *bus;
    struct sdo_client client;
    struct co_outbox outbox;
    struct co_frame frames[4];
    struct co_event events[2];
    co_us_t timeout;
    unsigned foreign;  /* requests of others to this device's SDO server */
    char message[512]; /* what is wrong with the bus */
};

/* False: the message tells why. timeout: for each answer of the device. */
bool sdo_reader_open(struct sdo_reader *self, const char *bus, uint8_t node, co_us_t timeout);
void sdo_reader_close(struct sdo_reader *self);

/*
 * One transfer; ret_done is the event of its end (PROTO_SDO_DONE). False: the bus is lost, or did
 * not take the request; the message tells.
 */
bool sdo_reader_read(struct sdo_reader *self, uint16_t index, uint8_t sub, uint8_t *buffer,
                     uint32_t size, struct co_event *ret_done);

#endif
