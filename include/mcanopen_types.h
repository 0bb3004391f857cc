/*
 * What mcanopen.h and scanopen.h share: symbol visibility, short integer types, data type codes.
 * Do not include this file yourself; either of the two brings it.
 */
#ifndef MCANOPEN_TYPES_H
#define MCANOPEN_TYPES_H

#include <stdint.h>

#if defined(__GNUC__)
#define MCANOPEN_API          __attribute__((visibility("default")))
#define MCANOPEN_MAYBE_UNUSED __attribute__((unused))
#define MCANOPEN_INLINE       static __inline__ MCANOPEN_MAYBE_UNUSED
#else
#define MCANOPEN_API
#define MCANOPEN_MAYBE_UNUSED
#define MCANOPEN_INLINE static inline
#endif

#ifdef __cplusplus
#define MCANOPEN_CAST(type, value) static_cast<type>(value)
#else
#define MCANOPEN_CAST(type, value) ((type)(value))
#endif

/*
 * Short names of the integer types. Define MCANOPEN_NO_SHORT_TYPES before the first of the headers
 * where another library brings the same names with other meanings.
 */
#ifndef MCANOPEN_NO_SHORT_TYPES
typedef uint8_t UINT8;
typedef uint16_t UINT16;
typedef uint32_t UINT32;
typedef uint64_t UINT64;
typedef int8_t INT8;
typedef int16_t INT16;
typedef int32_t INT32;
typedef int64_t INT64;
typedef void VOID;
#endif

/*
 * Data types. A code is a number 1..127, so that it fits a char of a type descriptor; where CiA 301
 * (7.1.6 and 7.4.7) has the type, the code is the index of the object that stands for it.
 *
 *                                         bytes on the bus
 */
#define TYP_BOOL            0x01 /* 1 */
#define TYP_INT8            0x02 /* 1 */
#define TYP_INT16           0x03 /* 2 */
#define TYP_INT32           0x04 /* 4 */
#define TYP_UINT8           0x05 /* 1 */
#define TYP_UINT16          0x06 /* 2 */
#define TYP_UINT32          0x07 /* 4 */
#define TYP_FLOAT           0x08 /* 4, IEEE 754 */
#define TYP_VIS_STRING      0x09 /* as given */
#define TYP_OCT_STRING      0x0A /* as given */
#define TYP_TIME_OF_DAY     0x0C /* 6 */
#define TYP_TIME_DIFFERENCE 0x0D /* 6 */
#define TYP_DOMAIN          0x0F /* as given */
#define TYP_CHAR            0x41 /* 1 */
#define TYP_DATE            0x42 /* 6; manager only */

/* Ours: the other types of CiA 301. */
#define TYP_UNICODE_STRING 0x0B /* as given; manager only */
#define TYP_INT24          0x10 /* 3; manager only, as all below of 3, 5, 6 or 7 bytes */
#define TYP_DOUBLE         0x11 /* 8, IEEE 754 */
#define TYP_INT40          0x12 /* 5 */
#define TYP_INT48          0x13 /* 6 */
#define TYP_INT56          0x14 /* 7 */
#define TYP_INT64          0x15 /* 8 */
#define TYP_UINT24         0x16 /* 3 */
#define TYP_UINT40         0x18 /* 5 */
#define TYP_UINT48         0x19 /* 6 */
#define TYP_UINT56         0x1A /* 7 */
#define TYP_UINT64         0x1B /* 8 */

/* Flags of mcanOpenWriteSDO, above the type. The first two exclude each other; the third one is also
 * for mcanOpenReadSDO, above the sub-index. */
#define TYP_INDICATE_SIZE    0x0100 /* tell the server the size when the transfer begins */
#define TYP_INDICATE_NO_SIZE 0x0200 /* leave the size out */
#define TYP_BLOCK            0x0400 /* ours: try a block transfer first (CiA 301, 7.2.4) */

#endif
