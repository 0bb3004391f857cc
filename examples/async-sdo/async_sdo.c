/*
 * Asks all nodes of a network side by side, without a thread for each: who are you, how often is
 * your heartbeat? Boots the network first.
 */
#include <mcanopen.h>

#include <semaphore.h>
#include <stdio.h>

#define NET 0

static struct question {
    int index, subindex;
    const char *name;
} questions[] = {
    { 0x1000, 0, "device type" },
    { 0x1018, 1, "vendor-ID" },
    { 0x1008, 0, "name" },
    { 0x1017, 0, "heartbeat in ms" },
};

static sem_t answers;

static unsigned long number_of(const unsigned char *bytes, int len)
{
    unsigned long number = 0;

    while (len-- > 0)
        number = number << 8 | bytes[len];
    return number;
}

/* Called by a thread of the library, one after the other; the data is valid until it returns. */
static void on_answer(void *context, const SDO_RESULT_T *result)
{
    const struct question *question = context;

    printf("node %d: %s ", result->node, question->name);
    if (result->result != MCANOPEN_OK)
        printf("not known, result %d\n", result->result);
    else if (result->len > 4)
        printf("\"%.*s\"\n", result->len, (const char *)result->data);
    else
        printf("%lu\n", number_of(result->data, result->len));
    sem_post(&answers);
}

/* How many questions there is an answer to come for: one that is not taken gets none. */
static int ask(int node)
{
    int asked = 0;

    for (size_t i = 0; i < sizeof questions / sizeof questions[0]; i++) {
        const SDO_REQUEST_T request = { .size = sizeof request,
                                        .net = NET,
                                        .node = node,
                                        .index = questions[i].index,
                                        .subindex = questions[i].subindex,
                                        .len = 64,
                                        .done = on_answer,
                                        .context = &questions[i] };

        if (mcanOpenReadSDOAsync(&request, NULL) == MCANOPEN_OK)
            asked++;
    }
    return asked;
}

static int wait_until_up(void)
{
    const long up = (long)(NOD_NOT_VAL | PARA_UC | MCANOPEN_MSG_NETWORK_UP);
    EVENT_T event = { 0 };

    while (event.event != up)
        if (mcanOpenEvent(&event, 1) != MCANOPEN_OK)
            return -1;
    return 0;
}

int main(int argc, char **argv)
{
    BOOT_RECORD_T record = { .size = sizeof record };
    int asked = 0;

    sem_init(&answers, 0, 0);
    mcanOpenInitialize();
    if (mcanOpenConfig(argc > 1 ? argv[1] : "network.xml") != MCANOPEN_OK)
        return 2;
    mcanOpenStart();
    if (wait_until_up() != 0)
        return 1;
    for (int node = 1; node <= 127; node++)
        if (mcanOpenGetBootRecord(NET, node, &record) == MCANOPEN_OK && record.booted)
            asked += ask(node);
    /* Here a program would do its work; this one has no other. */
    while (asked > 0)
        if (sem_wait(&answers) == 0)
            asked--;
    mcanOpenCleanup(); /* would end those that are still under way, with MCAL_NO_NET */
    return 0;
}
