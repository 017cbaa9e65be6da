/* SPDX-License-Identifier: MIT */
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
#ifndef TUI_GUARDIAN_H
#define TUI_GUARDIAN_H

#include <signal.h>
#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>
#include <termios.h>

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

/* Starts the child for the terminal that `in` reads and `out` writes. Where no child can be had
 * there is no guardian, and all else works. */
void guardian_start(struct guardian *g, int in, int out);

/* To be called when `on` is 0. */
void guardian_end(struct guardian *g);

void guardian_set_words(struct guardian *g, const char *text, size_t length);

#endif
