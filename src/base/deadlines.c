#include "base/deadlines.h"

void co_deadlines_init(struct co_deadlines *self)
{
    for (unsigned i = 0; i < 2 * CO_DEADLINES; i++)
        self->earliest[i] = CO_NEVER;
}

void co_deadlines_set(struct co_deadlines *self, unsigned i, co_us_t deadline)
{
    unsigned at = CO_DEADLINES + i;

    if (self->earliest[at] == deadline)
        return;
    self->earliest[at] = deadline;
    for (at /= 2; at > 0; at /= 2)
        self->earliest[at] = co_earlier(self->earliest[2 * at], self->earliest[2 * at + 1]);
}

co_us_t co_deadlines_first(const struct co_deadlines *self)
{
    return self->earliest[1];
}

/* Up to where something at or behind 'from' is due, then down to the first of that. */
unsigned co_deadlines_due(const struct co_deadlines *self, unsigned from, co_us_t now)
{
    unsigned at = CO_DEADLINES + from;

    if (from >= CO_DEADLINES)
        return CO_DEADLINES;
    while (self->earliest[at] > now) {
        while (at % 2 != 0)
            at /= 2;
        if (at == 0)
            return CO_DEADLINES;
        at++;
    }
    while (at < CO_DEADLINES)
        at = self->earliest[2 * at] <= now ? 2 * at : 2 * at + 1;
    return at - CO_DEADLINES;
}
