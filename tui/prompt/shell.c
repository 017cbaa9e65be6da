/* SPDX-License-Identifier: MIT */
#include "tui/prompt/shell.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdint.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tui/term.h"

enum { NOT_FOUND = 127, NOT_RUNNABLE = 126 }; /* the shell's exit status */

/* Signals are as a program expects to find them; its input is `in`, or ours for -1. */
static int spawn(pid_t *process, char *const *word, int in)
{
    posix_spawnattr_t attributes;
    posix_spawn_file_actions_t files;
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawn_file_actions_init(&files);
    if (in >= 0)
        posix_spawn_file_actions_adddup2(&files, in, STDIN_FILENO);
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    const int number = posix_spawn(process, "/bin/sh", &files, &attributes, word, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    return number;
}

enum err shell_run(const char *command, const char *argument, const struct buf *input, int *status,
                   struct fault *fault)
{
    struct sigaction ignore = {.sa_handler = SIG_IGN}, before[3];
    static const int ignored[] = {SIGINT, SIGQUIT, SIGPIPE};
    char *const word[] = {(char[]){"sh"},
                          (char[]){"-c"},
                          (char *)(uintptr_t)command,
                          (char[]){"sh"},
                          (char *)(uintptr_t)argument,
                          NULL};
    int end[2] = {-1, -1};
    pid_t process;
    if (input && pipe2(end, O_CLOEXEC) != 0)
        return fault_errno(fault, "start", command);
    for (int i = 0; i < 3; i++)
        sigaction(ignored[i], &ignore, before + i);
    errno = spawn(&process, word, end[0]);
    enum err err = errno ? fault_errno(fault, "start", command) : OK;
    if (input) {
        close(end[0]);
        if (!err)
            term_write_to(end[1], buf_text(input), input->length, NULL); /* it may end before */
        close(end[1]);
    }
    while (!err && waitpid(process, status, 0) < 0)
        if (errno != EINTR)
            err = fault_errno(fault, "wait for", command);
    for (int i = 0; i < 3; i++)
        sigaction(ignored[i], before + i, NULL);
    return err;
}

bool shell_has_none(int status)
{
    return WIFEXITED(status) &&
           (WEXITSTATUS(status) == NOT_FOUND || WEXITSTATUS(status) == NOT_RUNNABLE);
}
