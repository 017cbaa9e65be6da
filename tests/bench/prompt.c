#include "program/bench.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/folder.h"
#include "program/bench_times.h"

enum { PATIENCE_MS = 5000 };

static void become_program(int terminal, const char *scene, const char *journal)
{
    setsid();
    ioctl(terminal, TIOCSCTTY, 0);
    for (int fd = 0; fd < 3; fd++)
        dup2(terminal, fd);
    setenv("TERM", "xterm-256color", 1);
    setenv("IFTTY_HISTORY", "", 1);
    execl("/proc/self/exe", "iftty", "--journal", journal, scene, (char *)NULL);
    _exit(127);
}

/* What the program has written so far, and how far it has been looked at. */
struct screen {
    int terminal;
    uint64_t begin;
    char seen[8192];
    size_t length, looked;
    bool answered;
};

/* Reads on until `text` comes, answering the question that every terminal answers. False when it
 * does not come in time. */
static bool await(struct screen *screen, const char *text)
{
    while ((clock_ns() - screen->begin) / 1000000 < PATIENCE_MS) {
        char *found = memmem(screen->seen + screen->looked, screen->length - screen->looked, text,
                             strlen(text));
        if (found) {
            screen->looked = (size_t)(found - screen->seen) + strlen(text);
            return true;
        }
        struct pollfd ready = {screen->terminal, POLLIN, 0};
        size_t room = sizeof screen->seen - screen->length;
        if (poll(&ready, 1, 100) <= 0)
            continue;
        ssize_t n = room ? read(screen->terminal, screen->seen + screen->length, room) : 0;
        if (n <= 0)
            return false;
        screen->length += (size_t)n;
        if (!screen->answered && memmem(screen->seen, screen->length, "\033[c", 3)) {
            static const char reply[] = "\033[?64;1;2c";
            screen->answered = write(screen->terminal, reply, sizeof reply - 1) > 0;
        }
    }
    return false;
}

/* Starts the program in a terminal and watches it; the journal is thrown away. */
static bool time_start(struct screen *screen, int inner, const char *scene, const char *journal,
                       double *prompt_ms, double *loaded_ms)
{
    screen->begin = clock_ns();
    pid_t child = fork();
    if (child == 0)
        become_program(inner, scene, journal);
    bool there = child > 0 && await(screen, "> ");
    *prompt_ms = times_since(screen->begin);
    if (there && scene)
        there = await(screen, "voxels of") && await(screen, "> ");
    *loaded_ms = times_since(screen->begin);
    if (child > 0) {
        kill(child, SIGKILL);
        waitpid(child, NULL, 0);
    }
    return there;
}

bool bench_prompt(const char *scene, double *prompt_ms, double *loaded_ms)
{
    struct buf folder = {0}, journal = {0};
    struct screen screen = {.terminal = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)};
    int inner = -1;
    bool timed = false;
    if (screen.terminal >= 0 && grantpt(screen.terminal) == 0 && unlockpt(screen.terminal) == 0)
        inner = open(ptsname(screen.terminal), O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (inner >= 0 && folder_fresh(&folder, NULL, NULL) == OK) {
        buf_printf(&journal, "%s/bench.iftty", buf_text(&folder));
        timed = !journal.failed &&
                time_start(&screen, inner, scene, buf_text(&journal), prompt_ms, loaded_ms);
        folder_discard(buf_text(&folder));
    }
    buf_release(&folder);
    buf_release(&journal);
    if (inner >= 0)
        close(inner);
    if (screen.terminal >= 0)
        close(screen.terminal);
    return timed;
}
