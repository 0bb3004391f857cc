/* The messages of a parser as one text, a line each, without the file's name. */
#ifndef TEST_SUPPORT_MESSAGES_H
#define TEST_SUPPORT_MESSAGES_H

#include "base/report.h"

struct messages {
    struct co_report report;
    char text[20000];
};

void messages_init(struct messages *self);

#endif
