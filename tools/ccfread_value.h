/*
 * The values of a concise DCF as text.
 */
#ifndef TOOLS_CCFREAD_VALUE_H
#define TOOLS_CCFREAD_VALUE_H

#include "ccfread_text.h"
#include "dcf/ccf.h"

/* The value has the size of the type of CiA 301, or the type has no size of its own. */
bool value_fits(const struct ccf_entry *entry, uint8_t type);

/*
 * As its type has it: 500 (01F4h), "text", 2026-11-26 05:01:26.123, the first bytes of a domain.
 * Type 0, and one that it does not fit: what the bytes look like.
 */
void value_add(struct text *text, const struct ccf_entry *entry, uint8_t type);

/* INTEGERn that fits. */
int64_t value_signed(const struct ccf_entry *entry);
/* REAL32 or REAL64 that fits. */
double value_real(const struct ccf_entry *entry);
/* TIME_OF_DAY or TIME_DIFFERENCE that fits. */
void value_add_time(struct text *text, const struct ccf_entry *entry, uint8_t type);

/*
 * ": off, CAN-ID 205h" for objects of CiA 301 whose numbers have parts: COB-IDs, PDO mapping,
 * heartbeat consumers, date and time of the configuration; else nothing.
 */
void value_add_meaning(struct text *text, const struct ccf_entry *entry);

/* A name from an EDS to stdout: nothing of it commands the terminal. */
void value_put_name(const char *name);

#endif
