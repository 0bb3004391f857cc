/*
 * mcanopen: check and boot a CANopen network, simulate its devices, watch its bus, test a device.
 */
#include "common_tool.h"
#include "verbs.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/signalfd.h>

static const char usage[] =
    "Usage: mcanopen VERB [OPTION]...\n"
    "\n"
    "  check NETWORK.xml          check whether the network will boot, without a bus\n"
    "  boot NETWORK.xml           boot the network that the file describes, and watch it\n"
    "  sim NETWORK.xml            simulate the devices of a network from their EDS/DCF files\n"
    "  sim -n 5 DEVICE.eds        simulate single devices\n"
    "  dump BUS                   print the frames of a bus, as candump -L does\n"
    "  conform -n 5               test whether a device conforms to CiA 301\n"
    "\n"
    "  -h, --help                 shows this\n"
    "      --version              shows the version\n"
    "\n"
    "'mcanopen VERB --help' tells the options of a verb.\n"
    "A bus is a SocketCAN interface (can0, vcan0) or \"virtual:NAME\", a bus of this machine\n"
    "without hardware and without privileges. On \"virtual:NAME?bitrate=500000\" frames take the\n"
    "time of a real bus; all programs on it have to give the same bit rate.\n";

static const struct verb {
    const char *name;
    int (*run)(int argc, char **argv);
} verbs[] = {
    { "check", verb_check }, { "boot", verb_boot },       { "sim", verb_sim },
    { "dump", verb_dump },   { "conform", verb_conform },
};

/* Who reads the output later must not take a part for the whole. */
static int check_output(int result)
{
    if (fflush(stdout) == 0 && !ferror(stdout))
        return result;
    perror("mcanopen: standard output");
    return result == EXIT_UP ? EXIT_USAGE : result;
}

/* getopt begins its messages with argv[0]. */
static int run_verb(const struct verb *verb, int argc, char **argv)
{
    char name[32];

    if (argc >= 2 && strcmp(argv[1], "--version") == 0)
        return check_output(tool_print_version("mcanopen") ? EXIT_UP : EXIT_USAGE);
    snprintf(name, sizeof name, "mcanopen %s", verb->name);
    argv[0] = name;
    return check_output(verb->run(argc, argv));
}

int stop_signals(void)
{
    sigset_t signals;

    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    if (sigprocmask(SIG_BLOCK, &signals, NULL) != 0)
        return -1;
    return signalfd(-1, &signals, SFD_CLOEXEC);
}

int main(int argc, char **argv)
{
    if (argc >= 2 && strcmp(argv[1], "--version") == 0)
        return check_output(tool_print_version("mcanopen") ? EXIT_UP : EXIT_USAGE);
    if (argc >= 2 && (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0)) {
        fputs(usage, stdout);
        return EXIT_UP;
    }
    for (size_t i = 0; argc >= 2 && i < sizeof verbs / sizeof verbs[0]; i++)
        if (strcmp(argv[1], verbs[i].name) == 0)
            return run_verb(&verbs[i], argc - 1, argv + 1);
    if (argc >= 2)
        fprintf(stderr, "mcanopen: no verb \"%s\"\n", argv[1]);
    fputs(usage, stderr);
    return EXIT_USAGE;
}
