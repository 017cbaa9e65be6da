#include "tui/progress.h"

#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "tui/term.h"

enum { BAR = 24 };

void progress_init(struct progress *progress, int fd)
{
    *progress = (struct progress){.fd = fd, .shows = isatty(fd) == 1, .columns = 80};
}

void progress_line(struct buf *out, const char *what, uint64_t done, uint64_t total,
                   uint64_t seconds, unsigned columns)
{
    buf_printf(out, "%-21s ", what);
    if (total) {
        const uint64_t part = done < total ? done : total;
        const unsigned percent = (unsigned)((double)part * 100.0 / (double)total);
        char bar[BAR + 1] = {0};
        for (unsigned i = 0; i < BAR; i++)
            bar[i] = i * 100 < percent * BAR ? '#' : '-';
        buf_printf(out, "[%s] %3u %%", bar, percent);
        buf_add_text(out, ", ");
    } else if (done) {
        buf_printf(out, "%llu voxels, ", (unsigned long long)done);
    }
    buf_printf(out, "%llu s", (unsigned long long)seconds);
    if (!out->failed && out->length > columns)
        out->data[out->length = columns] = '\0';
}

/* Over the line that is there, and blanks where that was longer. */
static void put(struct progress *progress, const struct buf *line)
{
    struct buf out = {0};
    const unsigned length = (unsigned)line->length;
    buf_add_char(&out, '\r');
    buf_add(&out, buf_text(line), length);
    for (unsigned i = length; i < progress->drawn; i++)
        buf_add_char(&out, ' ');
    if (length < progress->drawn)
        buf_add_char(&out, '\r');
    if (!out.failed)
        term_write_to(progress->fd, out.data, out.length, NULL);
    progress->drawn = length;
    buf_release(&out);
}

/* In the background a line would run into what others write. */
static bool is_in_front(struct progress *progress)
{
    struct winsize size;
    if (ioctl(progress->fd, TIOCGWINSZ, &size) == 0 && size.ws_col > 1)
        progress->columns = size.ws_col;
    const pid_t front = tcgetpgrp(progress->fd);
    return front < 0 || front == getpgrp();
}

void progress_show(struct progress *progress, const char *what, uint64_t done, uint64_t total,
                   uint64_t now_ns)
{
    const uint64_t ms = 1000000;
    struct buf line = {0};
    if (!progress->shows)
        return;
    if (!progress->begun_ns)
        progress->begun_ns = now_ns;
    if (now_ns - progress->begun_ns < PROGRESS_AFTER_MS * ms ||
        now_ns - progress->drawn_ns < 1000 / PROGRESS_A_SECOND * ms)
        return;
    progress->drawn_ns = now_ns;
    if (!is_in_front(progress))
        return;
    const uint64_t seconds = (now_ns - progress->begun_ns) / (1000 * ms);
    progress_line(&line, what, done, total, seconds, progress->columns - 1);
    put(progress, &line);
    buf_release(&line);
}

void progress_erase(struct progress *progress)
{
    const struct buf nothing = {0};
    if (progress->drawn)
        put(progress, &nothing);
    progress->begun_ns = 0;
}
