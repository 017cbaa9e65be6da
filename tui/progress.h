/* SPDX-License-Identifier: MIT */
/*
 * The progress line: the present step and how far it is, on a terminal only.
 *
 *     weights               [########----------------]  34 %, 12 s left
 *     weights               ▕████████▏               ▏  34 %, 12 s left     where text is UTF-8
 *     forest                3250000 voxels, 2 s
 *
 * It appears when the work lasts longer than PROGRESS_AFTER_MS, is drawn at most PROGRESS_A_SECOND
 * times a second, always over itself, and is erased before other output. It has no colours,
 * and escape sequences only in the row of a whole screen, so that any terminal will do.
 *
 * The time left is an estimate for the present step at its present rate; until it can be estimated,
 * and where the total is unknown, the elapsed time is shown.
 */
#ifndef TUI_PROGRESS_H
#define TUI_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

#include "base/buf.h"

enum { PROGRESS_AFTER_MS = 500, PROGRESS_A_SECOND = 10, PROGRESS_WORDS = 64 };

/* Contents of the line. */
struct progress_step {
    const char *what;
    uint64_t done, total; /* units; total 0: unknown */
    uint64_t seconds;     /* since the work began */
    bool knows_left;
    uint64_t seconds_left; /* until the step ends */
};

/* Begins with the first four members and `columns`, 80. */
struct progress {
    int fd;
    bool shows;        /* fd is a terminal */
    bool has_blocks;   /* text is UTF-8: the bar has eighths of a cell */
    uint64_t begun_ns; /* start of the work; 0 while idle */
    uint64_t drawn_ns; /* time of the last drawing; 0: draw without delay */
    unsigned drawn;    /* cells of the line; 0 if none is shown */
    unsigned columns;  /* width of the terminal */
    bool owns_row;     /* on a whole screen: erase older text to the end of the row */

    char step[PROGRESS_WORDS]; /* the present step, its start, and the units done before it */
    uint64_t step_ns, step_done;
    uint64_t step_seen; /* units done at the last call */
};

/* Report `done` of `total` units (0: unknown) of the step `what`, at a time by base/clock.h. */
void progress_show(struct progress *progress, const char *what, uint64_t done, uint64_t total,
                   uint64_t now_ns);

/* Erase the line: the work is done. */
void progress_erase(struct progress *progress);

/* Add the line, cut to `columns` cells. */
void progress_line(struct buf *out, const struct progress_step *step, bool has_blocks,
                   unsigned columns);

#endif
