/*
 * An application linked with the static library that has functions named like internal ones of it:
 * its own are called, the library's still work.
 */
#include <mcanopen.h>

#include <stdio.h>

int nmt_start(void);
int sync_on_frame(void);
int bus_open(void);
int co_err_text(void);

int nmt_start(void)
{
    return 1;
}

int sync_on_frame(void)
{
    return 2;
}

int bus_open(void)
{
    return 4;
}

int co_err_text(void)
{
    return 8;
}

int main(void)
{
    int own = nmt_start() + sync_on_frame() + bus_open() + co_err_text();
    int config = mcanOpenConfig("/nonexistent/network.xml");

    printf("own functions: %d, configuration: %d, %s\n", own, config, mcanOpenGetErrorText());
    return own == 15 && config == MCAL_SYS_ERROR ? 0 : 1;
}
