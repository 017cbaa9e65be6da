#include "report/comparison_report.h"

#include <inttypes.h>
#include <math.h>

#include "report/figures.h"
#include "session/tally.h"

/* ---- the measures of a label, for programs ---- */

static double ratio(double part, double whole)
{
    return whole > 0 ? part / whole : NAN;
}

static double dice(const struct overlap_counts *n)
{
    return ratio(2.0 * (double)n->both, (double)n->a + (double)n->b);
}

static double jaccard(const struct overlap_counts *n)
{
    return ratio((double)n->both, (double)n->a + (double)n->b - (double)n->both);
}

static struct figures figures_of(const struct comparison_report *report, unsigned label)
{
    const struct overlap_counts n = comparison_counts(report->comparison, label);
    const struct label_distances *d = &report->comparison->distance[label];
    const double mm3 = tally_voxel_mm3(report->geometry);
    const double difference = (double)n.a - (double)n.b;
    struct figures f = {.count = 0};
    figures_add(&f, "voxels_a", (double)n.a);
    figures_add(&f, "voxels_b", (double)n.b);
    figures_add(&f, "voxels_both", (double)n.both);
    figures_add(&f, "volume_a_mm3", (double)n.a * mm3);
    figures_add(&f, "volume_b_mm3", (double)n.b * mm3);
    figures_add(&f, "volume_difference_mm3", difference * mm3);
    figures_add(&f, "volume_similarity", ratio(2 * difference, (double)n.a + (double)n.b));
    figures_add(&f, "dice", dice(&n));
    figures_add(&f, "jaccard", jaccard(&n));
    figures_add(&f, "hausdorff_mm", d->has_hausdorff ? d->hausdorff_mm : NAN);
    figures_add(&f, "surface_95_mm", d->has_surfaces ? d->percentile_95_mm : NAN);
    figures_add(&f, "surface_mean_mm", d->has_surfaces ? d->mean_mm : NAN);
    figures_add(&f, "surface_most_mm", d->has_surfaces ? d->most_mm : NAN);
    figures_add(&f, "surface_95_a_to_b_mm",
                d->has_surfaces ? d->directed_percentile_95_mm[0] : NAN);
    figures_add(&f, "surface_95_b_to_a_mm",
                d->has_surfaces ? d->directed_percentile_95_mm[1] : NAN);
    figures_add(&f, "surface_mean_a_to_b_mm", d->has_surfaces ? d->directed_mean_mm[0] : NAN);
    figures_add(&f, "surface_mean_b_to_a_mm", d->has_surfaces ? d->directed_mean_mm[1] : NAN);
    return f;
}

/* ---- JSON ---- */

static void add_figures(struct json *json, const struct comparison_report *report, unsigned label)
{
    const struct label_distances *d = &report->comparison->distance[label];
    const struct figures f = figures_of(report, label);
    figures_write_json(json, &f);
    if (!d->has_hausdorff || d->hausdorff_mm == 0)
        return;
    json_array(json, "farthest");
    for (int a = 0; a < 3; a++)
        json_count(json, NULL, d->farthest[a]);
    json_end(json);
}

void comparison_write_json(struct buf *out, const struct comparison_report *report)
{
    const struct comparison *c = report->comparison;
    struct json json = {.out = out};
    json_object(&json, NULL);
    json_text(&json, "a", report->name[0]);
    json_text(&json, "b", report->name[1]);
    json_count(&json, "voxels", c->overlap.voxels);
    json_count(&json, "differing", c->overlap.differing);
    if (geometry_fill(report->geometry) < 1) /* for which distances do not allow */
        json_real(&json, "shear_degrees", geometry_shear(report->geometry), 4);
    json_object(&json, "all");
    add_figures(&json, report, 0);
    json_end(&json);
    json_array(&json, "labels");
    for (unsigned label = 1; label < 256; label++) {
        if (!comparison_has(c, label))
            continue;
        json_object(&json, NULL);
        json_count(&json, "label", label);
        json_text(&json, "name", report->label_name[label]);
        add_figures(&json, report, label);
        json_end(&json);
    }
    json_end(&json);
    json_end(&json);
}

/* ---- CSV ---- */

static void write_csv_row(struct buf *out, const struct comparison_report *report, unsigned label)
{
    const struct figures f = figures_of(report, label);
    if (label)
        buf_printf(out, "%u", label);
    else
        buf_add_text(out, "all");
    figures_write_csv(out, label ? report->label_name[label] : "", &f);
}

void comparison_write_csv(struct buf *out, const struct comparison_report *report)
{
    const struct figures f = figures_of(report, 0);
    figures_write_csv_names(out, &f);
    for (unsigned label = 1; label < 256; label++)
        if (comparison_has(report->comparison, label))
            write_csv_row(out, report, label);
    write_csv_row(out, report, 0);
}

/* ---- a table ---- */

/* Right in a field of so many columns; "-" for what is not known. */
static void add_number(struct buf *out, int columns, int decimals, double value)
{
    if (isnan(value))
        buf_printf(out, " %*s", columns, "-");
    else
        buf_printf(out, " %*.*f", columns, decimals, value);
}

static void add_volume(struct buf *out, int columns, const char *sign,
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

static void write_row(struct buf *out, const struct comparison_report *report, unsigned label)
{
    const struct overlap_counts n = comparison_counts(report->comparison, label);
    const struct label_distances *d = &report->comparison->distance[label];
    struct buf name = {0};
    if (label)
        buf_printf(&name, "%u ", label);
    buf_add_safe_text(&name, label ? report->label_name[label] : "all");
    buf_printf(out, "%-16s", buf_text(&name));
    buf_release(&name);
    add_number(out, 6, 4, dice(&n));
    add_number(out, 7, 4, jaccard(&n));
    add_volume(out, 9, "", report->geometry, n.a);
    add_volume(out, 9, n.a > n.b ? "+" : "-", report->geometry, n.a > n.b ? n.a - n.b : n.b - n.a);
    add_number(out, 9, 2, d->has_hausdorff ? d->hausdorff_mm : NAN);
    add_number(out, 6, 2, d->has_surfaces ? d->percentile_95_mm : NAN);
    add_number(out, 6, 2, d->has_surfaces ? d->mean_mm : NAN);
    buf_add_char(out, '\n');
}

/* Surfaces around cavities belong to an object whose voxels are all near the other's. */
static void write_notes(struct buf *out, const struct comparison *c)
{
    bool is_odd = false;
    for (unsigned label = 0; label < 256; label++)
        is_odd |= c->distance[label].has_surfaces &&
                  c->distance[label].percentile_95_mm > c->distance[label].hausdorff_mm;
    buf_printf(out,
               "%" PRIu64 " of %" PRIu64 " voxels differ; distances in mm: Hausdorff between "
               "voxels, others between surfaces\n",
               c->overlap.differing, c->overlap.voxels);
    if (is_odd)
        buf_add_text(out, "surfaces inside of an object, around cavities, lie further apart than "
                          "its voxels\n");
}

static void write_farthest(struct buf *out, const struct comparison *c)
{
    const struct label_distances *d = &c->distance[0];
    if (d->has_hausdorff && d->hausdorff_mm > 0)
        buf_printf(out, "farthest  voxel %u,%u,%u, %.2f mm from the other\n", d->farthest[0],
                   d->farthest[1], d->farthest[2], d->hausdorff_mm);
}

void comparison_write_text(struct buf *out, const struct comparison_report *report)
{
    const struct comparison *c = report->comparison;
    for (int i = 0; i < 2; i++) {
        buf_printf(out, "%-9s ", i ? "B" : "A");
        buf_add_safe_text(out, report->name[i]);
        buf_add_char(out, '\n');
    }
    buf_add_text(out,
                 "label              Dice Jaccard  volume A     A - B Hausdorff   95 %   mean\n");
    for (unsigned label = 1; label < 256; label++)
        if (comparison_has(c, label))
            write_row(out, report, label);
    if (c->labels != 1)
        write_row(out, report, 0);
    write_notes(out, c);
    if (report->geometry->spacing_unknown)
        buf_add_text(out, "the file does not say how large voxels are; 1 mm is assumed\n");
    if (geometry_fill(report->geometry) < 1)
        buf_printf(out, "axes are sheared by %.2g degrees: distances are as if they were not\n",
                   geometry_shear(report->geometry));
    write_farthest(out, c);
}
