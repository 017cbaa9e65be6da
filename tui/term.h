/* SPDX-License-Identifier: MIT */
/*
 * The terminal of this process: its modes, its size, reading and writing.
 *
 * There is one, because signals and exits belong to the process, so there is no object to pass.
 * Whatever way the process ends, the terminal is as it was found:
 *
 *   T1 modes are saved before they are first changed;
 *   T2 they come back at term_close, exit(), SIGTERM, SIGHUP, SIGINT, SIGQUIT and a crash (SIGSEGV,
 *      SIGABRT, SIGBUS, SIGILL, SIGFPE), after which the signal takes its usual course;
 *   T3 they come back while the process is stopped (SIGTSTP), and ours when it goes on (SIGCONT);
 *   T4 a signal that the program handles or ignores itself is left alone, crashes apart;
 *   T5 what a handler writes is one write that begins with what ends a picture cut in two;
 *   T6 a child gives it back after SIGKILL (tui/term.h);
 *   T7 nothing that we do cuts what term_write writes in two: Ctrl-C does not make the terminal
 *      drop its output, and stopping waits until the write is done;
 *   T8 answers to our questions are not left to the shell: those that are due when a signal ends
 *      the process are read for up to 0.2 s. (When it ends by itself: probe_leave in tui/probe.h.)
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
    TERM_QUIET, /* a command runs: no echo, what is typed waits, Ctrl-C and Ctrl-Z are signals */
    TERM_RAW    /* every key is a byte for us, every byte of ours as it is */
};

struct term_size {
    unsigned columns, rows;       /* at least 1 each; 80x24 where the terminal does not say */
    unsigned width_px, height_px; /* 0 where it does not say */
};

/* Takes the terminal that `in` reads and `out` writes (not closed by us). Refused with ERR_IO when
 * one of them is none. */
enum err term_open(int in, int out, struct fault *fault);
void term_close(void);

/* What is written when our modes begin and when they end (bracketed paste on and off, say). Less
 * than TERM_WORDS bytes each, or none is; needed before the first term_set_mode. `recover` is
 * that of T5, ESC \ by default; `answers` is set if the terminal answers ESC[c, for T8. */
enum { TERM_WORDS = 128 };
void term_set_sequences(const char *begin, const char *end);
void term_set_recovery(const char *recover, bool answers);

/* The same while our modes are on, as for a full screen: what ends the former is written, then what
 * begins the new. */
enum err term_change_sequences(const char *begin, const char *end, struct fault *fault);

/* The sequences of a prompt: bracketed paste. */
#define TERM_PROMPT_BEGINS "\033[?2004h"
#define TERM_PROMPT_ENDS   "\033[?2004l"

/* Writes what ends our modes while they are on still, so that answers to what is asked after it
 * are read and not echoed. The next term_set_mode or term_close does not write it again. */
enum err term_write_end(struct fault *fault);

enum err term_set_mode(enum term_mode mode, struct fault *fault);

/* The size as of now. */
struct term_size term_size(void);

/* The columns of the terminal that `fd` is; 0 where it is none, or does not say. */
unsigned term_columns(int fd);

/* Writes everything, through interruptions and short writes; a frame is one call. */
enum err term_write(const void *bytes, size_t length, struct fault *fault);

/* The same of a text, which is released; ERR_MEMORY, by the name of what it was to show, where it
 * has failed. */
enum err term_write_text(struct buf *text, const char *what, struct fault *fault);

/* The same to any descriptor. */
enum err term_write_to(int fd, const void *bytes, size_t length, struct fault *fault);

/* Waits for input, at most `timeout_ms` (-1: without limit), and adds what is there to `out`; or
 * until the descriptor `other` (-1: none) is readable, of which nothing is read: TERM_OTHER, where
 * the terminal has nothing. */
enum term_input { TERM_BYTES, TERM_TIMEOUT, TERM_SIGNAL, TERM_CLOSED, TERM_OTHER };
enum term_input term_read(struct buf *out, int timeout_ms, int other);

/* True once after the window changed size; true once after the process was stopped and went on. */
bool term_was_resized(void);
bool term_was_continued(void);

/* Stops the process group as Ctrl-Z does; returns when it goes on. `before` is called first: a
 * process that is stopped keeps no promise that takes time. NULL calls nobody. */
void term_on_suspend(void (*before)(void *context), void *context);
void term_suspend(void);

/*
 * A child that gives the terminal back when its parent cannot: after SIGKILL, or when the machine
 * ran out of memory and the parent was what it took.
 *
 *   G1 it sees the parent's end by a pipe whose other end nobody writes to, and by a pidfd, since a
 *      child of the parent may hold the pipe open;
 *   G2 it does nothing unless `on` says that modes are to be given back, and nothing when the
 *      terminal belongs to another job by then: only to ours, or to the shell that started it,
 *      whose own modes, if it has set some already, it leaves alone;
 *   G3 it holds the terminal, the pipe and nothing else: no file, no lock, no folder;
 *   G4 it is a process group of its own and ignores all signals but SIGKILL, so that neither Ctrl-C
 *      nor what kills the job ends it;
 *   G5 it does not outlive guardian_end, and no zombie stays.
 *
 * It is a fork, not a program of its own: started before there is a scene, it shares with its
 * parent what that had then, and touches a few pages. What it needs to know lies in memory that
 * both see, so nothing has to be sent, and signal handlers may change it.
 */

enum { GUARDIAN_WORDS = 512 };

struct guarded {
    volatile sig_atomic_t on;    /* `ours` are the modes now */
    struct termios found, ours;  /* before `on` is set */
    volatile sig_atomic_t which; /* of the words: the other ones may be half written */
    struct {
        char text[GUARDIAN_WORDS];
        size_t length;
    } words[2]; /* written to the terminal; at the end of a line */
};

struct guardian {
    struct guarded *guarded; /* never NULL after guardian_start */
    pid_t process;           /* 0: none, for want of memory or processes */
    int pipe;
};

#endif
