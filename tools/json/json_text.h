/*
 * Texts and whole values for tools that write JSON with jansson.
 *
 * Names in EDS files are Latin-1 as often as UTF-8, JSON is UTF-8 only: what is no UTF-8 is taken
 * for Latin-1.
 */
#ifndef TOOLS_JSON_TEXT_H
#define TOOLS_JSON_TEXT_H

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>

/* A string of these bytes, or NULL: no memory. */
json_t *json_text(const char *text);
json_t *json_text_of(const char *bytes, size_t size);

/* The object with one more member; takes both. NULL: one of them was NULL, or no memory. */
json_t *json_with(json_t *object, const char *key, json_t *value);

/* Writes the value and releases it. False: it is NULL, no memory, or not written. */
bool json_write(json_t *value, size_t flags, FILE *file);

#endif
