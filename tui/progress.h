/*
 * The progress line: what is being done, and how far it is, on a terminal and nowhere else.
 *
 *     weights               [########----------------]  34 %, 12 s
 *     forest                3250000 voxels, 2 s
 *
 * It appears when something takes longer than PROGRESS_AFTER_MS, is drawn PROGRESS_A_SECOND times a
 * second at most, always over itself, and is gone before anything else is written: whoever
 * writes erases it first. Without escape sequences, so that any terminal will do.
 */
#ifndef TUI_PROGRESS_H
#define TUI_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

#include "base/buf.h"

enum { PROGRESS_AFTER_MS = 300, PROGRESS_A_SECOND = 10 };

struct progress {
    int fd;
    bool shows;        /* fd is a terminal */
    uint64_t begun_ns; /* of the work at hand; 0 while there is none */
    uint64_t drawn_ns; /* the last time; 0 draws what comes next without delay */
    unsigned drawn;    /* characters on the line; 0 where there is none */
    unsigned columns;  /* of the terminal */
};

void progress_init(struct progress *progress, int fd);

/* `done` of `total` units of `what`, at a time by base/clock.h; total 0: nobody knows how many. */
void progress_show(struct progress *progress, const char *what, uint64_t done, uint64_t total,
                   uint64_t now_ns);

/* The work is over: the line goes. */
void progress_erase(struct progress *progress);

/* The line, cut to `columns`. */
void progress_line(struct buf *out, const char *what, uint64_t done, uint64_t total,
                   uint64_t seconds, unsigned columns);

#endif
