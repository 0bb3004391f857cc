/*
 * What the texts of the manager are made of: parts of boot_text; nobody else includes it.
 */
#ifndef CO_MANAGER_BOOT_TEXT_PARTS_H
#define CO_MANAGER_BOOT_TEXT_PARTS_H

#include "manager/boot_text.h"

struct text { /* appends, never beyond the end */
    char *at;
    size_t room;
};

__attribute__((format(printf, 2, 3))) void text_add(struct text *self, const char *format, ...);

/* "1018h:01 vendor-ID" */
void text_add_object(struct text *text, uint16_t index, uint8_t sub);
/* "boot error D: ..." */
void text_add_failure(struct text *text, const struct node_config *config,
                      const struct boot_failure *failure);
/* What is compared with the network's file, and the element there: NULL: not this object. */
const char *text_element_of(uint16_t index, uint8_t sub);
/* ": what to do about it", where something can be said of it. */
void text_add_advice(struct text *text, const struct boot_failure *failure);
/* What the configuration says of the heartbeat that did not come. */
void text_add_heartbeat_advice(struct text *text, const struct node_config *config,
                               const struct boot_failure *failure);
/* The file that a node's configuration comes from. */
const char *text_file_of(const struct node_config *config);

#endif
