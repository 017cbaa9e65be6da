/* SPDX-License-Identifier: MIT */
#include "tui/progress.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "tui/cells.h"
#include "tui/term.h"

enum { BAR = 24, LEFT_AFTER_MS = 200 };

void progress_line(struct buf *out, const struct progress_step *step, bool has_blocks,
                   unsigned columns)
{
    OWNED(buf_release) struct buf line = {0};
    const uint64_t done = step->done < step->total ? step->done : step->total;
    buf_printf(&line, "%-21s ", step->what);
    if (step->total) {
        const double part = (double)done / (double)step->total;
        const unsigned percent = (unsigned)((double)done * 100.0 / (double)step->total);
        /* A bar of blocks: whole cells, then one with as many eighths as remain. */
        static const char *const eighths[] = {" ", "▏", "▎", "▍", "▌", "▋", "▊", "▉", "█"};
        const unsigned all = (unsigned)(part * BAR * 8);
        buf_add_text(&line, has_blocks ? "▕" : "[");
        for (unsigned i = 0; i < BAR; i++) {
            const unsigned left = all > 8 * i ? all - 8 * i : 0;
            buf_add_text(&line, has_blocks                ? eighths[left < 8 ? left : 8]
                                : i * 100 < percent * BAR ? "#"
                                                          : "-");
        }
        buf_add_text(&line, has_blocks ? "▏" : "]");
        buf_printf(&line, " %3u %%, ", percent);
    } else if (step->done) {
        buf_printf(&line, "%llu voxels, ", (unsigned long long)step->done);
    }
    if (step->knows_left)
        buf_printf(&line, "%llu s left", (unsigned long long)step->seconds_left);
    else
        buf_printf(&line, "%llu s", (unsigned long long)step->seconds);
    if (columns > 0)
        cells_crop(out, buf_text(&line), columns);
    out->failed |= line.failed;
}

/* Overwrite the line, and add blanks if it was longer. */
static void put_line(struct progress *progress, const struct buf *line)
{
    OWNED(buf_release) struct buf out = {0};
    const unsigned width = (unsigned)cells_width(buf_text(line), line->length);
    buf_add_char(&out, '\r');
    buf_add(&out, buf_text(line), line->length);
    for (unsigned i = width; i < progress->drawn; i++)
        buf_add_char(&out, ' ');
    buf_add_text(&out, progress->owns_row ? "\033[K" : "");
    if (width < progress->drawn)
        buf_add_char(&out, '\r');
    if (!out.failed)
        term_write_to(progress->fd, out.data, out.length, NULL);
    progress->drawn = width;
}

void progress_show(struct progress *progress, const char *what, uint64_t done, uint64_t total,
                   uint64_t now_ns)
{
    const uint64_t ms = 1000000;
    OWNED(buf_release) struct buf line = {0};
    if (!progress->shows)
        return;
    if (!progress->begun_ns)
        progress->begun_ns = now_ns;
    /* Another step begins, or the same step again. */
    if (done < progress->step_seen || strncmp(progress->step, what, PROGRESS_WORDS - 1) != 0) {
        snprintf(progress->step, sizeof progress->step, "%s", what);
        progress->step_ns = now_ns;
        progress->step_done = done;
    }
    progress->step_seen = done;
    if (now_ns - progress->begun_ns < PROGRESS_AFTER_MS * ms ||
        now_ns - progress->drawn_ns < 1000 / PROGRESS_A_SECOND * ms)
        return;
    progress->drawn_ns = now_ns;
    const unsigned columns = term_columns(progress->fd);
    const pid_t front = tcgetpgrp(progress->fd);
    if (columns > 1)
        progress->columns = columns;
    if (front >= 0 && front != getpgrp()) /* the line would be mixed with the output of others */
        return;
    struct progress_step step = {.what = what, .done = done, .total = total};
    step.seconds = (now_ns - progress->begun_ns) / (1000 * ms);
    const uint64_t took_ns = now_ns - progress->step_ns;
    step.knows_left =
        step.total > step.done && step.done > progress->step_done && took_ns >= LEFT_AFTER_MS * ms;
    if (step.knows_left) {
        const double rate = (double)(step.done - progress->step_done) / (double)took_ns;
        const double left_s = (double)(step.total - step.done) / rate / 1e9;
        step.seconds_left = left_s < 1e9 ? (uint64_t)(left_s + 0.5) : 1000000000;
    }
    progress_line(&line, &step, progress->has_blocks, progress->columns - 1);
    put_line(progress, &line);
}

void progress_erase(struct progress *progress)
{
    const struct buf nothing = {0};
    if (progress->drawn)
        put_line(progress, &nothing);
    progress->begun_ns = 0;
    progress->step[0] = '\0';
}
