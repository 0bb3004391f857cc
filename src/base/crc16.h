/*
 * The checksum of SDO block transfers (CiA 301, 7.2.4.3.16): polynomial 1021h, from 0, most
 * significant bit first, nothing inverted.
 */
#ifndef CO_BASE_CRC16_H
#define CO_BASE_CRC16_H

#include <stddef.h>
#include <stdint.h>

/* The checksum of all bytes so far, to begin with 0, with some more behind them. */
uint16_t crc16_add(uint16_t crc, const uint8_t *bytes, size_t count);

#endif
