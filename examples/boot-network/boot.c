/* Boots the network that an XML file describes and tells what happens until it is up. */
#include <mcanopen.h>

#include <stdio.h>

int main(int argc, char **argv)
{
    EVENT_T event = { 0 };
    char text[MCANOPEN_EVENT_TEXT_SIZE];
    const long up = (long)(NOD_NOT_VAL | PARA_UC | MCANOPEN_MSG_NETWORK_UP);

    mcanOpenInitialize();
    if (mcanOpenConfig(argc > 1 ? argv[1] : "network.xml") != MCANOPEN_OK)
        return 2; /* what is wrong stands on stderr, and in mcanOpenGetErrorText() */
    mcanOpenStart();
    while (event.event != up && mcanOpenEvent(&event, 1) == MCANOPEN_OK) {
        mcanOpenEventText(&event, text, sizeof text);
        puts(text);
    }
    mcanOpenCleanup();
    return event.event == up ? 0 : 1;
}
