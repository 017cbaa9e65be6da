#include "program/bench_chafa.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "program/bench_times.h"

enum { ROUNDS = 7 };

static _Noreturn void become_chafa(const char *format, uint32_t side, const char *path, int output)
{
    char size[32];
    const bool blocks = strcmp(format, "symbols") == 0;
    const int nowhere = open("/dev/null", O_RDWR);
    /* where there are pixels, chafa takes cells for squares of 8x8 */
    snprintf(size, sizeof size, "%ux%u", side / 8, blocks ? side / 16 : side / 8);
    dup2(nowhere, 0);
    dup2(output, 1);
    dup2(nowhere, 2);
    execlp("chafa", "chafa", "-f", format, "-c", "full", "--font-ratio", blocks ? "1/2" : "1/1",
           "-s", size, path, (char *)NULL);
    _exit(127);
}

/* Its bytes; 0 where it cannot be run. */
static size_t run_chafa(const char *format, uint32_t side, const char *path)
{
    char taken[4096];
    int ends[2], status = 1;
    size_t bytes = 0;
    ssize_t n;
    if (pipe2(ends, O_CLOEXEC) != 0)
        return 0;
    const pid_t child = fork();
    if (child == 0)
        become_chafa(format, side, path, ends[1]);
    close(ends[1]);
    while ((n = read(ends[0], taken, sizeof taken)) > 0 || (n < 0 && errno == EINTR))
        bytes += n > 0 ? (size_t)n : 0;
    close(ends[0]);
    if (child > 0)
        waitpid(child, &status, 0);
    return status == 0 ? bytes : 0;
}

bool bench_chafa(const char *format, uint32_t side, const char *path, double *bytes, double *ms)
{
    double round_ms[ROUNDS];
    for (int i = 0; i < ROUNDS; i++) {
        const uint64_t begin = clock_ns();
        *bytes = (double)run_chafa(format, side, path);
        round_ms[i] = times_since(begin);
        if (*bytes <= 0)
            return false;
    }
    *ms = times_median(round_ms, ROUNDS);
    return true;
}
