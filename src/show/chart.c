/* SPDX-License-Identifier: MIT */
#include "show/chart.h"

static const char *const blocks[] = {" ", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
static const char *const ascii[] = {" ", ".", ".", ".", ":", ":", ":", "#", "#"};

/* How much of a cell of the row a column fills, in eighths. */
static unsigned part_of_cell(const struct chart *chart, unsigned column, unsigned row)
{
    const unsigned tall = chart->eighths[column], below = 8 * row;
    return tall <= below ? 0 : tall - below >= 8 ? 8 : tall - below;
}

void chart_write(struct buf *out, const struct chart *chart)
{
    for (unsigned row = chart->rows; row-- > 0;) {
        const char *before = row == chart->rows - 1 ? chart->top : row == 0 ? chart->bottom : "";
        buf_printf(out, "%*s |", chart->margin, before);
        unsigned columns = chart->columns;
        while (columns && part_of_cell(chart, columns - 1, row) == 0)
            columns--;
        for (unsigned c = 0; c < columns; c++)
            buf_add_text(out, (chart->has_blocks ? blocks : ascii)[part_of_cell(chart, c, row)]);
        buf_add_char(out, '\n');
    }
}
