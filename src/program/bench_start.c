#include "program/bench_start.h"

#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/folder.h"
#include "program/bench_pty.h"
#include "program/bench_times.h"

enum { PATIENCE_MS = 5000 };

/* What the program has written so far, and how far it has been looked at. */
struct screen {
    int terminal;
    uint64_t begin_ns;
    char seen[8192];
    size_t length, looked;
    bool answered;
};

/* Reads what has come, and answers the question that every terminal answers. */
static bool read_more(struct screen *screen)
{
    static const char reply[] = "\033[?64;1;2c";
    const size_t room = sizeof screen->seen - screen->length;
    const ssize_t n = room ? read(screen->terminal, screen->seen + screen->length, room) : 0;
    if (n <= 0)
        return false;
    screen->length += (size_t)n;
    if (!screen->answered && memmem(screen->seen, screen->length, "\033[c", 3))
        screen->answered = write(screen->terminal, reply, sizeof reply - 1) > 0;
    return true;
}

/* Reads on until `text` comes; false when it does not come in time. */
static bool await(struct screen *screen, const char *text)
{
    while (times_since(screen->begin_ns) < PATIENCE_MS) {
        const char *found = memmem(screen->seen + screen->looked, screen->length - screen->looked,
                                   text, strlen(text));
        if (found) {
            screen->looked = (size_t)(found - screen->seen) + strlen(text);
            return true;
        }
        struct pollfd ready = {screen->terminal, POLLIN, 0};
        if (poll(&ready, 1, 100) > 0 && !read_more(screen))
            return false;
    }
    return false;
}

/* The journal of this session goes with the folder. */
static bool time_start(struct bench_pty *pty, const char *folder, const char *scene,
                       double *prompt_ms, double *loaded_ms)
{
    char journal[4096];
    snprintf(journal, sizeof journal, "%s/bench.iftty", folder);
    char *const argument[] = {"iftty", "--journal", journal, (char *)(uintptr_t)scene, NULL};
    struct screen screen = {.terminal = pty->terminal, .begin_ns = clock_ns()};
    if (!bench_pty_start(pty, argument, "xterm-256color", folder) || !await(&screen, "> "))
        return false;
    *prompt_ms = times_since(screen.begin_ns);
    const bool loads = await(&screen, "voxels of") && await(&screen, "> ");
    *loaded_ms = times_since(screen.begin_ns);
    return loads;
}

bool bench_start(const char *scene, double *prompt_ms, double *loaded_ms)
{
    struct buf folder = {0};
    struct bench_pty pty;
    const bool timed = bench_pty_open(&pty, NULL) && folder_fresh(&folder, NULL, NULL) == OK &&
                       time_start(&pty, buf_text(&folder), scene, prompt_ms, loaded_ms);
    bench_pty_close(&pty);
    if (folder.length)
        folder_discard(buf_text(&folder));
    buf_release(&folder);
    return timed;
}
