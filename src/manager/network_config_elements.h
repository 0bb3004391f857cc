/*
 * The elements of the configuration file, one row each, and how the text of one becomes a value.
 *
 * Internal to network_config.
 */
#ifndef CO_MANAGER_NETWORK_CONFIG_ELEMENTS_H
#define CO_MANAGER_NETWORK_CONFIG_ELEMENTS_H

#include "manager/network_config_faults.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The manual's data types. */
enum element_kind {
    ELEMENT_NUMBER, /* UCHAR, USHORT, ULONG: by the range */
    ELEMENT_BITRATE,
    ELEMENT_INT16, /* several, separated by colons */
    ELEMENT_BOOL,
    ELEMENT_ASCII,
    ELEMENT_ACTION /* the only ENUM */
};

struct element {
    const char *name;
    enum element_kind kind;
    uint32_t low, high, preset; /* the preset is always valid, also outside low..high */
    size_t offset, size;        /* of the member */
    size_t given;               /* offset of a bool that tells that it is there; 0: none */
    bool mandatory;
    const char *alias;        /* another name of it */
    enum co_err out_of_range; /* kind of that error; 0: CO_ERR_VALUE */
};

#define ELEMENTS_MAX 32u /* most rows of a table */

struct element_lines { /* where each row of a table stands; 0: nowhere */
    unsigned any[ELEMENTS_MAX];
    unsigned valid[ELEMENTS_MAX]; /* only those with a valid value */
};

struct element_table {
    const char *parent; /* the element that holds these */
    const struct element *rows;
    size_t count;
};

extern const struct element_table network_elements; /* in <Manager_Instance> */
extern const struct element_table node_elements;    /* in <Node_Instance> */

/* By name or alias; NULL: none. */
const struct element *element_find(const struct element_table *table, const char *name);

/* The name most like this one; NULL: nothing is like it. */
const char *element_nearest(const struct element_table *table, const char *name);

/* Puts the defaults into a structure of zeros. */
void elements_preset(const struct element_table *table, void *base);
void elements_free(const struct element_table *table, void *base);

/* Puts a number, in the size of the member. */
void element_put(const struct element *self, void *base, uint32_t value);

/* Puts the value of the text there, or tells what is wrong with it and leaves the default. */
void element_set(const struct element *self, const char *text, unsigned line, void *base,
                 struct faults *faults);

#endif
