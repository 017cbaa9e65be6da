#include "program/bench_pty.h"

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

bool bench_pty_open(struct bench_pty *pty, const struct winsize *size)
{
    *pty = (struct bench_pty){.terminal = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)};
    return pty->terminal >= 0 && grantpt(pty->terminal) == 0 && unlockpt(pty->terminal) == 0 &&
           (!size || ioctl(pty->terminal, TIOCSWINSZ, size) == 0);
}

static _Noreturn void become_program(int inner, char *const *argument, const char *term,
                                     const char *home)
{
    setsid();
    ioctl(inner, TIOCSCTTY, 0);
    for (int fd = 0; fd < 3; fd++)
        dup2(inner, fd);
    setenv("TERM", term, 1);
    setenv("HOME", home, 1);
    setenv("IFTTY_HISTORY", "", 1);
    unsetenv("NO_COLOR");
    unsetenv("TMUX");
    execv("/proc/self/exe", argument);
    _exit(127);
}

bool bench_pty_start(struct bench_pty *pty, char *const *argument, const char *term,
                     const char *home)
{
    const int inner = open(ptsname(pty->terminal), O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (inner < 0)
        return false;
    pty->child = fork();
    if (pty->child == 0)
        become_program(inner, argument, term, home);
    close(inner);
    return pty->child > 0;
}

void bench_pty_close(struct bench_pty *pty)
{
    if (pty->child > 0) {
        kill(pty->child, SIGKILL);
        waitpid(pty->child, NULL, 0);
    }
    if (pty->terminal >= 0)
        close(pty->terminal);
}
