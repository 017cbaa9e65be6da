#include "command/bench.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"

enum { PATIENCE_MS = 5000 };

static void become_program(int terminal, const char *scene)
{
    char folder[] = "/tmp/iftty-bench-XXXXXX";
    setsid();
    ioctl(terminal, TIOCSCTTY, 0);
    for (int fd = 0; fd < 3; fd++)
        dup2(terminal, fd);
    if (mkdtemp(folder) && chdir(folder) == 0) /* its journal is thrown away */
        rmdir(folder);
    setenv("TERM", "xterm-256color", 1);
    execl("/proc/self/exe", "iftty", scene, (char *)NULL);
    _exit(127);
}

/* Answers the question every terminal answers, and waits for the prompt's end, "> ". */
static bool await_prompt(int terminal, uint64_t begin)
{
    char seen[4096];
    size_t length = 0;
    bool answered = false;
    while ((clock_ns() - begin) / 1000000 < PATIENCE_MS && length < sizeof seen - 1) {
        struct pollfd ready = {terminal, POLLIN, 0};
        if (poll(&ready, 1, 100) <= 0)
            continue;
        ssize_t n = read(terminal, seen + length, sizeof seen - 1 - length);
        if (n <= 0)
            return false;
        length += (size_t)n;
        seen[length] = '\0';
        if (!answered && memmem(seen, length, "\033[c", 3)) {
            static const char reply[] = "\033[?64;1;2c";
            answered = write(terminal, reply, sizeof reply - 1) > 0;
        }
        if (memmem(seen, length, "> ", 2))
            return true;
    }
    return false;
}

double bench_prompt_ms(const char *scene)
{
    int outer = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (outer < 0 || grantpt(outer) != 0 || unlockpt(outer) != 0) {
        if (outer >= 0)
            close(outer);
        return -1;
    }
    int inner = open(ptsname(outer), O_RDWR | O_NOCTTY | O_CLOEXEC);
    uint64_t begin = clock_ns();
    pid_t child = inner < 0 ? -1 : fork();
    if (child == 0)
        become_program(inner, scene);
    bool there = child > 0 && await_prompt(outer, begin);
    double ms = there ? (double)(clock_ns() - begin) / 1e6 : -1;
    if (child > 0) {
        kill(child, SIGKILL);
        waitpid(child, NULL, 0);
    }
    if (inner >= 0)
        close(inner);
    close(outer);
    return ms;
}
