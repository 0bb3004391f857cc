/*
 * Configuration by comparing: which entries of a concise DCF are to be written, after what the
 * device says of them.
 *
 *   in   the entries one after the other, the values that the device holds
 *   out  for each entry: read this object first, write the entry, or leave it out
 *
 * An entry that stands alone is written if the device's value differs, or if the device does not
 * tell it. Some are written in any case: commands ("save", "load", program control), values of more
 * than VERIFY_SIZE bytes (domains), and objects that are written several times, which only together
 * mean something.
 *
 * The parameters of a PDO, of SYNC, of an SDO channel, and the heartbeat consumers may only be
 * written in their order: PDO off, mapping off, mapping, on. Such a sequence is written whole or
 * not at all; of an object that occurs in it several times the last value is the one to be found.
 *
 *   owner    boot_node
 *   locking  none; the owner's
 */
#ifndef CO_MANAGER_VERIFY_H
#define CO_MANAGER_VERIFY_H

#include "dcf/ccf.h"

#define VERIFY_SIZE      64u   /* most bytes of a value that is compared */
#define VERIFY_SEQUENCES 1282u /* numbers of sequences are below this */

enum verify_order {
    VERIFY_SKIP, /* it is there, or stands in a sequence that is */
    VERIFY_WRITE,
    VERIFY_READ /* verify.wanted, into verify.value */
};

struct verify {
    const struct ccf *ccf;
    struct ccf_entry wanted;                       /* what is being read */
    struct ccf_reader ahead;                       /* behind it, where a sequence is compared */
    uint16_t sequence;                             /* to which it belongs */
    uint8_t differs[(VERIFY_SEQUENCES + 7u) / 8u]; /* a bit for each sequence met */
    uint8_t value[VERIFY_SIZE];
};

void verify_begin(struct verify *self, const struct ccf *ccf);
/* The next entry. After READ verify_on_value() says what becomes of it. */
enum verify_order verify_on_entry(struct verify *self, const struct ccf_entry *entry);
/* What is wanted was read: size bytes of value; known false: the device does not tell. */
enum verify_order verify_on_value(struct verify *self, bool known, size_t size);

#endif
