#include "api/callback.h"

static _Thread_local unsigned depth;

void callback_begin(void)
{
    depth++;
}

void callback_end(void)
{
    depth--;
}

bool callback_running(void)
{
    return depth > 0;
}
