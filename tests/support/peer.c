#include "support/peer.h"

#include <check.h>
#include <errno.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define ARGUMENTS_MAX 8

pid_t peer_start(const char *const arguments[])
{
    char copies[ARGUMENTS_MAX][64];
    char *argv[ARGUMENTS_MAX + 2] = { 0 };
    char self[] = "peer";
    pid_t pid;

    argv[0] = self;
    for (unsigned i = 0; i < ARGUMENTS_MAX && arguments[i]; i++) {
        strncpy(copies[i], arguments[i], sizeof copies[i] - 1);
        copies[i][sizeof copies[i] - 1] = '\0';
        argv[i + 1] = copies[i];
    }
    pid = fork();
    ck_assert_int_ge(pid, 0);
    if (pid == 0) {
        execv("/proc/self/exe", argv);
        _exit(127);
    }
    return pid;
}

static int wait_for(pid_t pid, int options)
{
    int status = 0;
    pid_t got;

    do
        got = waitpid(pid, &status, options);
    while (got < 0 && errno == EINTR);
    ck_assert_int_eq(got, pid);
    return status;
}

int peer_wait(pid_t pid)
{
    return wait_for(pid, 0);
}

void peer_wait_stopped(pid_t pid)
{
    ck_assert(WIFSTOPPED(wait_for(pid, WUNTRACED)));
}
