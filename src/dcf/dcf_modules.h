/*
 * Modular devices: what the modules in use add to a device. Only for src/dcf/.
 */
#ifndef CO_DCF_DCF_MODULES_H
#define CO_DCF_DCF_MODULES_H

#include "dcf/dcf_build.h"

#define DCF_SLOTS_MAX 254u /* sub-indices of the module list 1027h */

struct dcf_extension { /* [M1SubExt6000] */
    uint16_t module;
    struct dcf_entry pattern; /* of the sub-indices */
    uint32_t count;           /* that each module adds; 0: it adds bits to them */
    uint32_t bits;
    uint32_t most; /* the highest sub-index, then comes the next object; 0: there is none */
};

struct dcf_modules {
    struct dcf_builder *builder;
    uint32_t supported;                /* modules are 1 to this */
    uint16_t slots[DCF_SLOTS_MAX + 1]; /* the module in each slot, 0: none */
    bool is_any;                       /* there is a module in a slot */
    size_t described;                  /* entries of the file itself */
    bool *is_taken;                    /* by index: a module in use has such a fixed object */
    struct dcf_extension *extensions;  /* in the order of modules */
    size_t count, room;
};

struct dcf_range { /* sections of one module */
    struct dcf_section *first, *end;
};

bool dcf_module_is_used(const struct dcf_modules *self, uint16_t module);

/* dcf_module_fixed.c: objects that are there once, however many such modules there are */
void dcf_module_build_fixed(struct dcf_modules *self, struct dcf_range range);

/* dcf_module_extend.c: sub-indices that each module adds */
void dcf_module_read_extensions(struct dcf_modules *self, struct dcf_range range);
void dcf_module_extend(struct dcf_modules *self);

#endif
