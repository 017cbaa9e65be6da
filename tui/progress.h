/* SPDX-License-Identifier: MIT */
/*
 * The progress line: what is being done, and how far it is, on a terminal and nowhere else.
 *
 *     weights               [########----------------]  34 %, 12 s left
 *     weights               ▕████████▏               ▏  34 %, 12 s left     where text is UTF-8
 *     forest                3250000 voxels, 2 s
 *
 * It appears when something takes longer than PROGRESS_AFTER_MS, is drawn PROGRESS_A_SECOND times a
 * second at most, always over itself, and is gone before anything else is written: the
 * writer erases it first. Without escape sequences or colours, so that any terminal will do.
 *
 * Time left is what the present step will take if it goes on as it began; until that can be
 * estimated, and where nobody knows how much there is to do, the time that has passed stands there.
 */
#ifndef TUI_PROGRESS_H
#define TUI_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

#include "base/buf.h"

enum { PROGRESS_AFTER_MS = 500, PROGRESS_A_SECOND = 10, PROGRESS_WORDS = 64 };

/* What the line says. */
struct progress_step {
    const char *what;
    uint64_t done, total; /* units; total 0: nobody knows how many */
    uint64_t seconds;     /* of the whole work, so far */
    bool knows_left;
    uint64_t seconds_left; /* of this step */
};

struct progress {
    int fd;
    bool shows;        /* fd is a terminal */
    bool has_blocks;   /* text is UTF-8: the bar has eighths of a cell */
    uint64_t begun_ns; /* of the work at hand; 0 while there is none */
    uint64_t drawn_ns; /* the last time; 0 draws what comes next without delay */
    unsigned drawn;    /* cells of the line; 0 where there is none */
    unsigned columns;  /* of the terminal */

    char step[PROGRESS_WORDS]; /* what is being done, since when, and what was done by then */
    uint64_t step_ns, step_done;
    uint64_t step_seen; /* what was done of it when it was asked about last */
};

void progress_init(struct progress *progress, int fd);

/* `done` of `total` units of `what`, at a time by base/clock.h; total 0: nobody knows how many. */
void progress_show(struct progress *progress, const char *what, uint64_t done, uint64_t total,
                   uint64_t now_ns);

/* The work is over: the line goes. */
void progress_erase(struct progress *progress);

/* The line, cut to `columns` cells. */
void progress_line(struct buf *out, const struct progress_step *step, bool has_blocks,
                   unsigned columns);

#endif
