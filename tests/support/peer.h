/*
 * Other processes for a test: the test program itself, started again with arguments that tell it to
 * play a part. A new program, not a forked copy, so that threads and sanitizers are fine with it.
 */
#ifndef CO_TESTS_SUPPORT_PEER_H
#define CO_TESTS_SUPPORT_PEER_H

#include <sys/types.h>

/* arguments: from argv[1] on, closed by NULL. Fails the test if it cannot. */
pid_t peer_start(const char *const arguments[]);
/* The status of waitpid(), when it has ended. */
int peer_wait(pid_t pid);
/* Until it has stopped itself. Fails the test if it ends instead. */
void peer_wait_stopped(pid_t pid);

#endif
