/* SPDX-License-Identifier: MIT */
/* A turntable of large pictures, by the program itself, in a process of its own. */
#include "tests/bench/bench.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "tests/bench/times.h"

/* The commands of a journal, and what comes after them. */
static bool write_script(const char *path, const char *journal, const char *more)
{
    OWNED(mem_release) char *line = NULL;
    size_t room = 0;
    FILE *in = fopen(journal, "r"), *out = fopen(path, "w");
    while (in && out && getline(&line, &room, in) >= 0)
        if (strncmp(line, "= ", 2) != 0 && strncmp(line, "golden", 6) != 0 &&
            strncmp(line, "save", 4) != 0)
            fputs(line, out);
    if (out)
        fputs(more, out);
    if (in)
        fclose(in);
    return in && out && fclose(out) == 0;
}

static double seconds_of(struct timeval t)
{
    return (double)t.tv_sec + (double)t.tv_usec * 1e-6;
}

/* Runs `iftty run script` in a folder. */
static bool run(struct bench_process *out, const char *program, const char *folder)
{
    struct rusage used;
    int status = -1;
    fflush(NULL);
    const uint64_t begin = clock_ns();
    const pid_t child = fork();
    if (child == 0) {
        if (chdir(folder) == 0 && freopen("/dev/null", "w", stdout))
            execl(program, program, "run", "script", (char *)NULL);
        _exit(127);
    }
    if (child < 0 || wait4(child, &status, 0, &used) != child)
        return false;
    *out = (struct bench_process){.seconds = (double)(clock_ns() - begin) * 1e-9,
                                  .of_processors =
                                      seconds_of(used.ru_utime) + seconds_of(used.ru_stime),
                                  .megabytes = (double)used.ru_maxrss / 1024};
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

struct bench_process bench_turntable(const char *commands)
{
    OWNED(buf_release) struct buf journal = {0}, program = {0}, script = {0};
    struct bench_process process;
    const char *folder = bench_folder(NULL);
    buf_printf(&script, "%s/script", folder);
    if (!bench_find_in_tree(&journal, "examples/brain.iftty") ||
        !bench_find_in_tree(&program, "iftty") ||
        !write_script(buf_text(&script), buf_text(&journal), commands) ||
        !run(&process, buf_text(&program), folder))
        must(fault_set(&bench_fault, ERR_IO,
                       "the turntable of examples/brain.iftty cannot be made: expected iftty and "
                       "its image helper above this program; `make` builds them"));
    return process;
}
