/*
 * Boots the network of an XML file, and has functions named like those inside the library: its own
 * are called from here, the library calls its own.
 */
#include <mcanopen.h>

#include <stdio.h>

int nmt_start(void);
int sync_on_frame(void);
int bus_open(void);

static int own_calls;

int nmt_start(void)
{
    return ++own_calls;
}

int sync_on_frame(void)
{
    return ++own_calls;
}

int bus_open(void)
{
    return ++own_calls;
}

static int boot(const char *file)
{
    EVENT_T event = { 0 };
    const long up = (long)(NOD_NOT_VAL | PARA_UC | MCANOPEN_MSG_NETWORK_UP);

    if (mcanOpenInitialize() != MCANOPEN_OK || mcanOpenConfig(file) != MCANOPEN_OK)
        return 0;
    mcanOpenStart();
    while (event.event != up && mcanOpenEvent(&event, 1) == MCANOPEN_OK)
        continue;
    mcanOpenCleanup();
    return event.event == up ? event.para.uc : 0;
}

int main(int argc, char **argv)
{
    int booted = argc > 1 ? boot(argv[1]) : 0;
    int calls_of_library = own_calls;
    int sum = nmt_start() + sync_on_frame() + bus_open();

    printf("booted: %d, own functions called: %d by the library, %d here\n", booted,
           calls_of_library, own_calls - calls_of_library);
    return booted > 0 && calls_of_library == 0 && sum == 6 ? 0 : 1;
}
