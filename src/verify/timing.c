#include "verify/timing.h"

#include <inttypes.h>
#include <string.h>

void timing_add(struct timing *timing, size_t number, uint64_t ns, const char *command)
{
    struct timing_row fresh = {.ns = ns, .number = number};
    size_t at = timing->rows;
    while (at && timing->row[at - 1].ns < ns)
        at--;
    if (at == TIMING_MOST)
        return;
    buf_add_safe_excerpt(&fresh.command, command, strlen(command));
    if (timing->rows == TIMING_MOST)
        buf_release(&timing->row[--timing->rows].command);
    memmove(timing->row + at + 1, timing->row + at, (timing->rows - at) * sizeof fresh);
    timing->row[at] = fresh;
    timing->rows++;
}

void timing_tell(struct buf *lines, const struct timing *timing)
{
    for (size_t i = 0; i < timing->rows; i++) {
        const struct timing_row *row = timing->row + i;
        buf_printf(lines, "%" PRIu64 ".%03u ms, record %zu: %s\n", row->ns / 1000000,
                   (unsigned)(row->ns / 1000 % 1000), row->number, buf_text(&row->command));
    }
}

void timing_release(struct timing *timing)
{
    for (size_t i = 0; i < timing->rows; i++)
        buf_release(&timing->row[i].command);
    timing->rows = 0;
}
