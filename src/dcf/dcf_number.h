/*
 * Numbers of EDS and DCF files: decimal, hexadecimal, formulas with $NODEID, decimal fractions.
 */
#ifndef CO_DCF_DCF_NUMBER_H
#define CO_DCF_DCF_NUMBER_H

#include "dcf/dcf_slice.h"

#include <stdbool.h>
#include <stdint.h>

enum dcf_fit { DCF_FITS, DCF_NO_VALUE, DCF_OUT_OF_RANGE, DCF_NO_MEMORY };

/* What was tolerated; bits. */
#define DCF_QUIRK_COMMENT      0x01u /* a comment behind the number */
#define DCF_QUIRK_LEADING_ZERO 0x02u /* read as decimal, where C would read octal */
#define DCF_QUIRK_SUFFIX       0x04u /* 1LL */
#define DCF_QUIRK_TEXT         0x08u /* plain text where hexadecimal digits are expected */
#define DCF_QUIRK_QUOTES       0x10u /* they count as characters */
#define DCF_QUIRK_DOMAIN       0x20u /* a DOMAIN has no value in the file */
#define DCF_QUIRK_FORM         0x40u /* clear, but not as the standard writes it: 1Ah, 5.0 */
#define DCF_QUIRK_WIDE         0x80u /* hexadecimal digits of a wider type */

struct dcf_number {
    uint64_t magnitude;
    bool negative;
    bool hex;
    bool too_large; /* for 64 bits */
    bool has_node_id;
    unsigned quirks;
};

/* False and *ret_number untouched: no number. */
bool dcf_number_parse(struct dcf_slice text, struct dcf_number *ret_number);

/* The same of what is on or off: "true", "No". */
bool dcf_number_parse_flag(struct dcf_slice text, struct dcf_number *ret_number);

/* As the standard would write it: "-26", "$NODEID+512". */
struct dcf_shown dcf_number_show(const struct dcf_number *self);

/* Takes 0xFFFFFFFE for the INTEGER8 0xFE: of a negative number, as more bits than it has. */
void dcf_number_narrow(struct dcf_number *self, uint8_t type);

/*
 * The number as a BOOLEAN, INTEGERn or UNSIGNEDn, little endian, in 'bytes' of at least 8. A
 * hexadecimal number is the bit pattern of signed types, as CiA 306 has it.
 */
enum dcf_fit dcf_number_store(const struct dcf_number *self, uint8_t type, uint8_t *bytes);

/*
 * REAL32 or REAL64: the bit pattern as a hexadecimal number, or a decimal fraction, with a point
 * whatever the locale.
 */
enum dcf_fit dcf_real_parse(struct dcf_slice text, uint8_t type, uint8_t *bytes,
                            unsigned *ret_quirks);

/* Cuts a comment behind a number off. */
struct dcf_slice dcf_number_uncomment(struct dcf_slice text, unsigned *ret_quirks);

#endif
