/*
 * The verbs of the program mcanopen; each in a file mcanopen_<verb>.c.
 */
#ifndef TOOLS_VERBS_H
#define TOOLS_VERBS_H

enum exit_code {
    EXIT_UP = 0,     /* done, the network is up */
    EXIT_NOT_UP = 1, /* not all nodes that are needed are up */
    EXIT_USAGE = 2,  /* usage, or a fault in a file */
    EXIT_BUS = 3     /* the bus cannot be used */
};

/* argv[0] is the verb. */
int verb_check(int argc, char **argv);
int verb_boot(int argc, char **argv);
int verb_sim(int argc, char **argv);
int verb_dump(int argc, char **argv);
int verb_conform(int argc, char **argv);

/*
 * SIGINT and SIGTERM as a file descriptor to poll; blocked in this and all later threads.
 * -1: not possible.
 */
int stop_signals(void);

#endif
