/* SPDX-License-Identifier: MIT */
#include "show/histogram.h"

#include "base/least.h"
#include "engine/scene.h"
#include "image/geometry.h"
#include "show/draw.h"

static const char *const blocks[] = {" ", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
static const char *const ascii[] = {" ", ".", ".", ".", ":", ":", ":", "#", "#"};

/* The part of a cell that a column fills, in eighths. */
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

enum { ROWS = 4 };

/* Count between two intensities; the first is the greater one if values fall as intensities
 * rise. */
static void fill_bins(struct histogram *h, const uint32_t count[UINT16_MAX + 1],
                      const int32_t window[2], const struct geometry *geometry)
{
    const bool falls = window[0] > window[1];
    const int64_t low = falls ? window[1] : window[0], high = falls ? window[0] : window[1];
    const int64_t wide = high - low + 1;
    *h = (struct histogram){.digits = geometry_digits(geometry),
                            .least = geometry_value(geometry, window[0]),
                            .most = geometry_value(geometry, window[1])};
    h->each = (unsigned)((wide + HISTOGRAM_BINS - 1) / HISTOGRAM_BINS);
    h->bins = (unsigned)((wide + h->each - 1) / h->each);
    for (int64_t i = 0; i <= UINT16_MAX; i++) {
        const int64_t at = falls ? high - i : i - low;
        uint64_t *where = at < 0 ? &h->below : at >= wide ? &h->above : &h->bin[at / h->each];
        *where += count[i];
        h->voxels += count[i];
    }
}

void histogram_of_session(struct histogram *histogram, struct session *session)
{
    static uint32_t count[UINT16_MAX + 1];
    int32_t window[2];
    window_of(window, session);
    intensities_count(count, session->scene, session->team);
    fill_bins(histogram, count, window, &session->geometry);
}

void histogram_of_counts(struct histogram *histogram, const uint32_t count[UINT16_MAX + 1],
                         const struct geometry *geometry)
{
    int32_t window[2];
    intensities_range(window, count, WINDOW_BLACK, WINDOW_WHITE);
    fill_bins(histogram, count, geometry->slope < 0 ? (int32_t[]){window[1], window[0]} : window,
              geometry);
}

static double percent(const struct histogram *h, uint64_t voxels)
{
    return h->voxels ? 100.0 * (double)voxels / (double)h->voxels : 0;
}

void histogram_write(struct buf *out, const struct histogram *h, bool has_blocks)
{
    uint16_t eighths[HISTOGRAM_BINS];
    /* The count of a full column. One value, that of air, is often so frequent that all others
     * would be invisible: its column may be cut. */
    uint64_t most = 1, second = 1;
    for (unsigned i = 0; i < h->bins; i++) {
        second = h->bin[i] > most ? most : h->bin[i] > second ? h->bin[i] : second;
        most = h->bin[i] > most ? h->bin[i] : most;
    }
    const bool is_cut = most / 4 > second;
    const uint64_t full = square_root(is_cut ? second : most);
    for (unsigned i = 0; i < h->bins; i++) { /* at least one eighth for one voxel */
        const uint64_t tall = (square_root(h->bin[i]) * UINT64_C(8) * ROWS + full - 1) / full;
        eighths[i] = (uint16_t)(tall > 8 * ROWS ? 8 * ROWS : tall);
    }
    chart_write(out, &(struct chart){eighths, h->bins, ROWS, "histogram", "", 9, has_blocks});
    buf_printf(out, "          values %.*g to %.*g; %.2g %% are below, %.2g %% above\n", h->digits,
               h->least, h->digits, h->most, percent(h, h->below), percent(h, h->above));
    buf_printf(out, "          heights are square roots of counts%s\n",
               is_cut ? "; the highest column is cut" : "");
}
