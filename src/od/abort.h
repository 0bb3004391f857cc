/*
 * SDO abort codes (CiA 301, 7.2.4.3.17). 0 means: not aborted.
 */
#ifndef CO_OD_ABORT_H
#define CO_OD_ABORT_H

#include <stdint.h>

typedef uint32_t sdo_abort_t;

#define SDO_OK             0x00000000u
#define SDO_TOGGLE         0x05030000u
#define SDO_TIMEOUT        0x05040000u
#define SDO_COMMAND        0x05040001u
#define SDO_BLOCK_SIZE     0x05040002u
#define SDO_BLOCK_SEQUENCE 0x05040003u
#define SDO_BLOCK_CRC      0x05040004u
#define SDO_NO_MEMORY      0x05040005u
#define SDO_ACCESS         0x06010000u
#define SDO_WRITE_ONLY     0x06010001u
#define SDO_READ_ONLY      0x06010002u
#define SDO_NO_OBJECT      0x06020000u
#define SDO_NOT_MAPPABLE   0x06040041u
#define SDO_PDO_LENGTH     0x06040042u
#define SDO_PARAMETER      0x06040043u
#define SDO_INTERNAL       0x06040047u
#define SDO_HARDWARE       0x06060000u
#define SDO_TYPE_LENGTH    0x06070010u
#define SDO_TOO_LONG       0x06070012u
#define SDO_TOO_SHORT      0x06070013u
#define SDO_NO_SUB         0x06090011u
#define SDO_INVALID_VALUE  0x06090030u
#define SDO_VALUE_HIGH     0x06090031u
#define SDO_VALUE_LOW      0x06090032u
#define SDO_MAX_BELOW_MIN  0x06090036u
#define SDO_NO_CONNECTION  0x060A0023u
#define SDO_GENERAL        0x08000000u
#define SDO_NOT_STORED     0x08000020u
#define SDO_LOCAL_CONTROL  0x08000021u
#define SDO_DEVICE_STATE   0x08000022u
#define SDO_NO_DICTIONARY  0x08000023u
#define SDO_NO_DATA        0x08000024u

/* What the code means; "unknown abort code" for a code that is not in CiA 301. */
const char *sdo_abort_text(sdo_abort_t code);

#endif
