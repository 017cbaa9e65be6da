/* SPDX-License-Identifier: MIT */
#include "show/figures.h"

#include <assert.h>
#include <math.h>

#include "session/tally.h"

enum { DIGITS = 12 };

void figures_add(struct figures *figures, const char *name, double value)
{
    assert(figures->count < FIGURES_MOST);
    figures->of[figures->count].name = name;
    figures->of[figures->count++].value = value;
}

void figures_write_json(struct json *json, const struct figures *figures)
{
    for (int i = 0; i < figures->count; i++)
        json_real(json, figures->of[i].name, figures->of[i].value, DIGITS);
}

void figures_write_csv_names(struct buf *out, const struct figures *figures)
{
    buf_add_text(out, "label,name");
    for (int i = 0; i < figures->count; i++)
        buf_printf(out, ",%s", figures->of[i].name);
    buf_add_char(out, '\n');
}

void figures_write_csv(struct buf *out, const char *label_name, const struct figures *figures)
{
    buf_add_char(out, ',');
    buf_add_csv(out, label_name);
    for (int i = 0; i < figures->count; i++) {
        buf_add_char(out, ',');
        if (!isnan(figures->of[i].value))
            buf_printf(out, "%.*g", DIGITS, figures->of[i].value);
    }
    buf_add_char(out, '\n');
}

double figures_ratio(double part, double whole)
{
    return whole > 0 ? part / whole : NAN;
}

double figures_dice(const struct overlap *overlap, unsigned label)
{
    const struct overlap_counts counts = overlap_counts_of(overlap, label);
    return figures_ratio(2.0 * (double)counts.both, (double)counts.a + (double)counts.b);
}

void figures_add_cell(struct buf *out, int columns, int decimals, double value)
{
    if (isnan(value))
        buf_printf(out, " %*s", columns, "-");
    else
        buf_printf(out, " %*.*f", columns, decimals, value);
}

void figures_add_volume(struct buf *out, int columns, const char *sign,
                        const struct geometry *geometry, uint64_t voxels)
{
    struct buf words = {0};
    buf_add_text(&words, voxels ? sign : "");
    if (voxels)
        tally_write_volume(&words, geometry, voxels);
    else
        buf_add_char(&words, '0');
    buf_printf(out, " %*s", columns, buf_text(&words));
    out->failed |= words.failed;
    buf_release(&words);
}

void figures_add_spacing(struct buf *out, bool is_unknown)
{
    if (is_unknown)
        buf_add_text(out, "the file does not say how large voxels are; 1 mm is assumed\n");
}
