#include "manager/roll_call.h"

enum answer { MISSING = 1, FAILED = 2, IN_PROGRESS = 4, DOWN = 8 };

bool roll_call_is_missing(const struct boot_node *node)
{
    return boot_node_is_booted_by_master(node) && node->config->mandatory && !node->booted;
}

static unsigned answer_of(const struct boot_node *node, bool up)
{
    unsigned answer = 0;

    if (!boot_node_is_booted_by_master(node))
        return 0;
    if (roll_call_is_missing(node))
        answer |= node->step == BOOT_FAILED ? MISSING | FAILED : MISSING;
    if (!node->tried)
        answer |= IN_PROGRESS;
    if (node->config->mandatory && !up)
        answer |= DOWN;
    return answer;
}

static void move(unsigned *count, unsigned before, unsigned after)
{
    *count += (after != 0) - (unsigned)(before != 0);
}

void roll_call_count(struct roll_call *self, const struct boot_node *node, bool up)
{
    uint8_t *told = &self->answers[node->config->node_id];
    unsigned answer = answer_of(node, up);

    move(&self->missing, *told & MISSING, answer & MISSING);
    move(&self->failed, *told & FAILED, answer & FAILED);
    move(&self->in_progress, *told & IN_PROGRESS, answer & IN_PROGRESS);
    move(&self->down, *told & DOWN, answer & DOWN);
    *told = (uint8_t)answer;
}
