#include "support/messages.h"

#include <stdio.h>
#include <string.h>

#define FILE_NAME "f"

static void collect(void *context, const struct co_message *message)
{
    struct messages *self = context;
    size_t used = strlen(self->text);

    snprintf(self->text + used, sizeof self->text - used, "%s\n",
             message->text + strlen(FILE_NAME ":"));
}

void messages_init(struct messages *self)
{
    self->text[0] = '\0';
    self->report = (struct co_report){ .file = FILE_NAME, .sink = collect, .context = self };
}
