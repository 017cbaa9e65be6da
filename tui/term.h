/* SPDX-License-Identifier: MIT */
/*
 * The terminal of this process: its modes, its size, reading and writing.
 *
 * There is only one, because signals and exits belong to the process, so no object is passed.
 * However the process ends, the terminal is restored:
 *
 *   T1 modes are saved before they are first changed;
 *   T2 they are restored at term_close, exit(), SIGTERM, SIGHUP, SIGINT, SIGQUIT and a crash
 *      (SIGSEGV, SIGABRT, SIGBUS, SIGILL, SIGFPE), after which the signal has its usual effect;
 *   T3 they are restored while the process is stopped (SIGTSTP), and ours are set again when it
 *      continues (SIGCONT);
 *   T4 a signal that the program handles or ignores itself is left alone, except crashes;
 *   T5 a handler makes one write, which begins with the recovery sequence of a picture cut in two;
 *   T6 a child restores the terminal after SIGKILL (below);
 *   T7 a term_write is never cut in two by us: Ctrl-C does not make the terminal drop its output,
 *      and stopping waits until the write is done;
 *   T8 answers to our questions are not left to the shell: when a signal ends the process, due
 *      answers are read for up to 0.2 s. (For a normal end: probe_leave in tui/probe.h.)
 */
#ifndef TUI_TERM_H
#define TUI_TERM_H

#include <signal.h>
#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>
#include <termios.h>

#include "base/buf.h"
#include "base/err.h"

enum term_mode {
    TERM_AS_FOUND,
    TERM_QUIET, /* during a command: no echo, typed keys wait, Ctrl-C and Ctrl-Z are signals */
    TERM_RAW    /* every key is read as bytes; output is sent unchanged */
};

struct term_size {
    unsigned columns, rows;       /* at least 1 each; 80x24 if the terminal does not report them */
    unsigned width_px, height_px; /* 0 if it does not report them */
};

/* Use the terminal that `in` reads and `out` writes; both stay open. ERR_IO if either is no
 * terminal. */
enum err term_open(int in, int out, struct fault *fault);
void term_close(void);

/* Sequences written when our modes begin and end (bracketed paste on and off, for example). Less
 * than TERM_WORDS bytes each, or they are ignored; call before the first term_set_mode. `recover`
 * is the sequence of T5, ESC \ by default; `question` is one that the terminal answers, as it does
 * ESC[c, or NULL, for T8. */
enum { TERM_WORDS = 128 };
void term_set_sequences(const char *begin, const char *end);
void term_set_recovery(const char *recover, const char *question);

/* Change these sequences while our modes are on, for a full screen for example: the former end is
 * written, then the new beginning. */
enum err term_change_sequences(const char *begin, const char *end, struct fault *fault);

/* The sequences of a prompt: bracketed paste. */
#define TERM_PROMPT_BEGINS "\033[?2004h"
#define TERM_PROMPT_ENDS   "\033[?2004l"

/* Write the sequence that ends our modes while they are still on, so that later answers are read
 * and not echoed. The next term_set_mode or term_close does not write it again. */
enum err term_write_end(struct fault *fault);

enum err term_set_mode(enum term_mode mode, struct fault *fault);

/* Return the present size. */
struct term_size term_size(void);

/* Columns of the terminal `fd`; 0 if it is no terminal or does not report them. */
unsigned term_columns(int fd);

/* Write everything, despite interruptions and short writes; a frame is one call. */
enum err term_write(const void *bytes, size_t length, struct fault *fault);

/* Write a text and release it; ERR_MEMORY, naming the content by `what`, if it has failed. */
enum err term_write_text(struct buf *text, const char *what, struct fault *fault);

/* Write everything to any descriptor. */
enum err term_write_to(int fd, const void *bytes, size_t length, struct fault *fault);

/* Wait for input, at most `timeout_ms` (-1: without limit), and add it to `out`; or until the
 * descriptor `other` (-1: none) is readable, from which nothing is read: TERM_OTHER, if the
 * terminal has no input. */
enum term_input { TERM_BYTES, TERM_TIMEOUT, TERM_SIGNAL, TERM_CLOSED, TERM_OTHER };
enum term_input term_read(struct buf *out, int timeout_ms, int other);

/* Return true once after a change of the window size, and once after the process has continued. */
bool term_was_resized(void);
bool term_was_continued(void);

/* Stop the process group as Ctrl-Z does; return when it continues. `before`, or NULL, is called
 * first: a stopped process keeps no promise that depends on time. */
void term_on_suspend(void (*before)(void *context), void *context);
void term_suspend(void);

/*
 * A child that restores the terminal when its parent cannot: after SIGKILL, or when the kernel
 * killed the parent for lack of memory.
 *
 *   G1 it detects the end of the parent by a pipe that is never written, and by a pidfd, since a
 *      child of the parent may hold the pipe open;
 *   G2 it does nothing unless `on` is set, and nothing if the terminal belongs to another job by
 *      then: only to ours, or to the shell that started it, whose own modes, if it has set some
 *      already, it leaves alone;
 *   G3 it holds the terminal, the pipe and nothing else: no file, no lock, no folder;
 *   G4 it is a process group of its own and ignores all signals but SIGKILL, so that neither Ctrl-C
 *      nor a signal to the job ends it;
 *   G5 it does not outlive guardian_end, and no zombie remains.
 *
 * It is a fork, not a separate program: started before there is a scene, it shares the pages that
 * its parent had then, and touches few. Its data is in shared memory, so nothing has to be sent,
 * and signal handlers may change it.
 */

enum { GUARDIAN_WORDS = 640 };

struct guarded {
    volatile sig_atomic_t on;    /* `ours` are set now */
    struct termios found, ours;  /* before `on` is set */
    volatile sig_atomic_t which; /* index of the valid words: the others may be half written */
    struct {
        char text[GUARDIAN_WORDS];
        size_t length;
    } words[2]; /* sequences for the terminal; at the end of a line */
};

struct guardian {
    struct guarded *guarded; /* never NULL after guardian_start */
    pid_t process;           /* 0: none, for lack of memory or processes */
    int pipe;
};

#endif
