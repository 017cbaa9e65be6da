/* This program once more, in a pseudo-terminal of the benchmark's own. */
#ifndef PROGRAM_BENCH_PTY_H
#define PROGRAM_BENCH_PTY_H

#include <stdbool.h>
#include <sys/ioctl.h>
#include <sys/types.h>

struct bench_pty {
    int terminal; /* what the program writes is read here, what is written here it reads; or -1 */
    pid_t child;  /* or 0 */
};

/* Opens the terminal; `size` may be NULL. False where there is none. To be closed in any case. */
bool bench_pty_open(struct bench_pty *pty, const struct winsize *size);

/* Starts the program in it, with `argument`, ended by NULL, with `home` as its home and without a
 * history of lines. `term` is what $TERM says. */
bool bench_pty_start(struct bench_pty *pty, char *const *argument, const char *term,
                     const char *home);

/* Ends the program, as nothing can prevent, and closes the terminal. */
void bench_pty_close(struct bench_pty *pty);

#endif
