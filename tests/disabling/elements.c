/*
 * Takes the effect of one element of the manager's XML file away: the environment's
 * MCANOPEN_DISABLE names it, "Node_Instance/Guard_Time". The reader finds it and then keeps the
 * default. The linker leads the reader's calls here (--wrap).
 */
#include "manager/network_config_elements.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char last[80]; /* the one that was looked for last, by this name or its other one */

const struct element *__real_element_find(const struct element_table *table, const char *name);
const struct element *__wrap_element_find(const struct element_table *table, const char *name);
void __real_element_set(const struct element *self, const char *text, unsigned line, void *base,
                        struct faults *faults);
void __wrap_element_set(const struct element *self, const char *text, unsigned line, void *base,
                        struct faults *faults);

const struct element *__wrap_element_find(const struct element_table *table, const char *name)
{
    snprintf(last, sizeof last, "%s/%s", table->parent, name);
    return __real_element_find(table, name);
}

void __wrap_element_set(const struct element *self, const char *text, unsigned line, void *base,
                        struct faults *faults)
{
    const char *name = getenv("MCANOPEN_DISABLE");

    if (!name || strcmp(name, last) != 0)
        __real_element_set(self, text, line, base, faults);
}
