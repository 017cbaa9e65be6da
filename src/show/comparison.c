/* SPDX-License-Identifier: MIT */
#include "show/comparison.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/sort.h"
#include "engine/distance.h"
#include "session/map.h"
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

/* NAN for an empty set. */
static double figures_ratio(double part, double whole)
{
    return whole > 0 ? part / whole : NAN;
}

double figures_dice(const struct overlap *overlap, unsigned label)
{
    const struct overlap_counts counts = overlap_counts_of(overlap, label);
    return figures_ratio(2.0 * (double)counts.both, (double)counts.a + (double)counts.b);
}

/* Cells of the text table, right-aligned after a blank: "-" for NAN; a volume with its sign, or
 * "0". */
static void figures_add_cell(struct buf *out, int columns, int decimals, double value)
{
    if (isnan(value))
        buf_printf(out, " %*s", columns, "-");
    else
        buf_printf(out, " %*.*f", columns, decimals, value);
}

static void figures_add_volume(struct buf *out, const char *sign, const struct geometry *geometry,
                               uint64_t voxels)
{
    OWNED(buf_release) struct buf words = {0};
    buf_add_text(&words, voxels ? sign : "");
    if (voxels)
        tally_write_volume(&words, geometry, voxels);
    else
        buf_add_char(&words, '0');
    buf_printf(out, " %9s", buf_text(&words));
    out->failed |= words.failed;
}

bool comparison_has(const struct comparison *comparison, unsigned label)
{
    return !label || comparison->overlap.a[label] || comparison->overlap.b[label];
}

const uint32_t *comparison_farthest(const struct comparison *comparison,
                                    const uint32_t else_place[3])
{
    const struct label_distances *d = &comparison->distance[0];
    return d->has_hausdorff && d->hausdorff_mm > 0 ? d->farthest : else_place;
}

/* ---- boxes around labels ---- */

struct box {
    uint32_t first[3], last[3];
};

static void widen_box(struct box *box, const uint32_t place[3])
{
    for (int a = 0; a < 3; a++) {
        box->first[a] = place[a] < box->first[a] ? place[a] : box->first[a];
        box->last[a] = place[a] > box->last[a] ? place[a] : box->last[a];
    }
}

/* Count labels, and find the box around each label in A or B; box[0] is around all objects. */
static enum err look_through(struct overlap *overlap, struct box box[256], const struct compared *c,
                             struct watch *watch, struct fault *fault)
{
    const uint8_t *a = c->label[0], *b = c->label[1];
    const size_t voxels = (size_t)c->size[0] * c->size[1] * c->size[2];
    struct task task = task_begin(watch, "comparing labels", voxels);
    for (unsigned l = 0; l < 256; l++)
        box[l] = (struct box){{UINT32_MAX, UINT32_MAX, UINT32_MAX}, {0, 0, 0}};
    for (uint32_t z = 0; z < c->size[2]; z++)
        for (uint32_t y = 0; y < c->size[1] && task_advance(&task, c->size[0]); y++) {
            overlap_add(overlap, a, b, c->size[0]);
            for (uint32_t x = 0; x < c->size[0]; x++, a++, b++) {
                const uint32_t place[3] = {x, y, z};
                if (!(*a | *b))
                    continue;
                widen_box(&box[0], place);
                if (*a)
                    widen_box(&box[*a], place);
                if (*b && *b != *a)
                    widen_box(&box[*b], place);
            }
        }
    return watch_fault(watch, fault);
}

/* ---- one label ---- */

/* Bits of a voxel in `set` and `contour`. */
enum { IN_A = 1, IN_B = 2 };
static const uint8_t in_set[2] = {IN_A, IN_B};

/* Arrays of the box around one label. */
struct work {
    const struct compared *compared;
    const struct distance_scale *scale;
    uint32_t first[3];
    struct contour_box box;
    size_t voxels;
    uint8_t *set, *contour;
    uint64_t *squared; /* distance to the nearest voxel of the other contour, squared; */
    uint64_t *found;   /* [voxels of a contour], of that contour alone */
    size_t count[2];   /* voxels of the contours of A and B, and the sum of their distances */
    double sum_mm[2];
    struct team *team;
    struct watch *watch;
};

/* Mark the voxels of a label in both sets; label 0: of all objects. */
static void mark_sets(struct work *w, unsigned label)
{
    const struct compared *c = w->compared;
    uint8_t *set = w->set;
    struct task task = task_begin(w->watch, "voxels of a label", w->voxels);
    for (uint32_t z = 0; z < w->box.size[2]; z++)
        for (uint32_t y = 0; y < w->box.size[1] && task_advance(&task, w->box.size[0]); y++) {
            const size_t row =
                w->first[0] +
                (size_t)c->size[0] * (w->first[1] + y + (size_t)c->size[1] * (w->first[2] + z));
            const uint8_t *a = c->label[0] + row, *b = c->label[1] + row;
            for (uint32_t x = 0; x < w->box.size[0]; x++)
                *set++ = (uint8_t)((label ? a[x] == label : a[x] > 0) * IN_A |
                                   (label ? b[x] == label : b[x] > 0) * IN_B);
        }
}

static enum err work_init(struct work *w, const struct box *box, unsigned label,
                          struct fault *fault)
{
    w->voxels = 1;
    for (int a = 0; a < 3; a++) {
        w->first[a] = box->first[a];
        w->box.size[a] = box->last[a] - box->first[a] + 1;
        w->box.ends[a][0] = box->first[a] == 0;
        w->box.ends[a][1] = box->last[a] + 1 == w->compared->size[a];
        w->voxels *= w->box.size[a];
    }
    w->set = mem_array(w->voxels, 1);
    w->contour = mem_array(w->voxels, 1);
    w->squared = mem_array(w->voxels, sizeof *w->squared);
    if (!w->set || !w->contour || !w->squared)
        return fault_memory(fault, "a comparison");
    mark_sets(w, label);
    contour_find(w->contour, w->set, (uint8_t *)w->squared, &w->box, w->watch);
    return watch_fault(w->watch, fault);
}

static void work_release(struct work *w)
{
    free(w->set);
    free(w->contour);
    free(w->squared);
    free(w->found);
}

static double in_mm(const struct work *w, uint64_t squared)
{
    return sqrt((double)squared) * ((double)w->scale->unit_nm / 1e6);
}

/* Find the voxel of `from` that is farthest from the other set. Voxels of both sets have distance
 * 0. */
static void take_farthest(struct label_distances *d, const struct work *w, uint8_t from)
{
    uint64_t most = 0;
    size_t where = 0;
    struct task task = task_begin(w->watch, "distances", w->voxels);
    for (size_t i = 0; i < w->voxels && task_advance(&task, 1); i++)
        if (w->set[i] == from && w->squared[i] > most) {
            most = w->squared[i];
            where = i;
        }
    const double mm = in_mm(w, most);
    if (d->has_hausdorff && mm <= d->hausdorff_mm)
        return;
    d->has_hausdorff = true;
    d->hausdorff_mm = mm;
    d->farthest[0] = w->first[0] + (uint32_t)(where % w->box.size[0]);
    d->farthest[1] = w->first[1] + (uint32_t)(where / w->box.size[0] % w->box.size[1]);
    d->farthest[2] = w->first[2] + (uint32_t)(where / w->box.size[0] / w->box.size[1]);
}

/* Distances from one contour to the other; direction 0 is A to B. */
static enum err take_surface(struct label_distances *d, struct work *w, int direction,
                             struct fault *fault)
{
    const uint8_t from = in_set[direction];
    size_t count = 0, n = 0;
    struct task task = task_begin(w->watch, "distances of surfaces", 2 * (uint64_t)w->voxels);
    for (size_t i = 0; i < w->voxels && task_advance(&task, 1); i++)
        count += (w->contour[i] & from) != 0;
    w->count[direction] = count;
    if (!count)
        return OK;
    free(w->found);
    w->found = mem_array(count, sizeof *w->found);
    if (!w->found)
        return fault_memory(fault, "a comparison");
    for (size_t i = 0; i < w->voxels && task_advance(&task, 1); i++)
        if (w->contour[i] & from)
            w->found[n++] = w->squared[i];
    if (watch_stops(w->watch))
        return watch_fault(w->watch, fault);
    qsort(w->found, n, sizeof *w->found, sort_compare);
    for (size_t i = 0; i < n; i++)
        w->sum_mm[direction] += in_mm(w, w->found[i]);
    d->directed_mean_mm[direction] = w->sum_mm[direction] / (double)n;
    /* The percentile is interpolated between two ranks of the sorted distances. */
    const size_t hundredths = 95 * (n - 1), rank = hundredths / 100;
    const double low = in_mm(w, w->found[rank]);
    const double high = in_mm(w, w->found[rank + (rank + 1 < n)]);
    d->directed_percentile_95_mm[direction] = low + (high - low) * (double)(hundredths % 100) / 100;
    d->most_mm = fmax(d->most_mm, in_mm(w, w->found[n - 1]));
    return OK;
}

/* Squared distance from each voxel to the nearest voxel of a contour. */
static enum err spread_from(struct work *w, uint8_t contour, struct fault *fault)
{
    for (size_t i = 0; i < w->voxels; i++)
        w->squared[i] = w->contour[i] & contour ? 0 : DISTANCE_NONE;
    return distance_spread(w->squared, w->box.size, w->scale, w->team, w->watch, fault);
}

static enum err measure_surfaces(struct label_distances *d, struct work *w, struct fault *fault)
{
    enum err err = OK;
    for (int direction = 0; !err && direction < 2; direction++) {
        err = spread_from(w, in_set[!direction], fault);
        if (err)
            break;
        take_farthest(d, w, in_set[direction]);
        err = take_surface(d, w, direction, fault);
    }
    d->has_surfaces = !err && w->count[0] && w->count[1];
    if (!d->has_surfaces)
        return err;
    d->mean_mm = (w->sum_mm[0] + w->sum_mm[1]) / (double)(w->count[0] + w->count[1]);
    d->percentile_95_mm = fmax(d->directed_percentile_95_mm[0], d->directed_percentile_95_mm[1]);
    return OK;
}

static enum err measure_label(struct comparison *comparison, struct work work,
                              const struct box *box, unsigned label, struct fault *fault)
{
    const struct overlap_counts counts = overlap_counts_of(&comparison->overlap, label);
    if (!counts.a || !counts.b)
        return OK;
    enum err err = work_init(&work, box, label, fault);
    if (!err)
        err = measure_surfaces(&comparison->distance[label], &work, fault);
    work_release(&work);
    return err;
}

/* ---- all ---- */

enum err comparison_make(struct comparison *comparison, const struct compared *compared,
                         struct team *team, struct watch *watch, struct fault *fault)
{
    const struct distance_scale scale = distance_scale_of(compared->spacing_nm, compared->size);
    const struct work work = {.compared = compared, .scale = &scale, .team = team, .watch = watch};
    struct box box[256];
    unsigned only = 0;
    *comparison = (struct comparison){.of = compared};
    TRY(look_through(&comparison->overlap, box, compared, watch, fault));
    for (unsigned label = 1; label < 256; label++)
        if (comparison_has(comparison, label)) {
            comparison->labels++;
            only = label;
            TRY(measure_label(comparison, work, &box[label], label, fault));
        }
    if (comparison->labels > 1)
        return measure_label(comparison, work, &box[0], 0, fault);
    comparison->distance[0] = comparison->distance[only];
    return OK;
}

/* ---- classes ---- */

enum err comparison_classify(uint8_t *class, const struct grid *grid,
                             const struct compared *compared, double most_mm, struct team *team,
                             struct watch *watch, struct fault *fault)
{
    const struct distance_scale scale = distance_scale_of(compared->spacing_nm, compared->size);
    OWNED(work_release)
    struct work w = {.compared = compared, .scale = &scale, .team = team, .watch = watch};
    struct overlap overlap = {0};
    struct box box[256];
    size_t voxel = 0;
    TRY(look_through(&overlap, box, compared, watch, fault));
    TRY(work_init(&w, &box[0], 0, fault));
    TRY(spread_from(&w, IN_B, fault));
    for (uint32_t z = 0; z < w.box.size[2]; z++)
        for (uint32_t y = 0; y < w.box.size[1]; y++) {
            uint8_t *row = class + grid_cell(grid, w.first[0], w.first[1] + y, w.first[2] + z);
            for (uint32_t x = 0; x < w.box.size[0]; x++, voxel++) {
                row[x] = 0;
                if (!(w.set[voxel] & IN_A))
                    continue;
                const double part = fmin(in_mm(&w, w.squared[voxel]) / most_mm, 1);
                const int steps = (int)lround(part * COMPARISON_CLASS_STEPS);
                row[x] = (uint8_t)(COMPARISON_CLASS_ON + (w.set[voxel] & IN_B ? -steps : steps));
            }
        }
    return OK;
}

/* ---- figures of a label ---- */

static bool has_row(const struct comparison_report *report, unsigned label)
{
    return comparison_has(report->comparison, label) || (report->listed && report->listed[label]);
}

static double jaccard(const struct overlap_counts *n)
{
    return figures_ratio((double)n->both, (double)n->a + (double)n->b - (double)n->both);
}

static struct figures figures_of(const struct comparison_report *report, unsigned label)
{
    const struct overlap_counts n = overlap_counts_of(&report->comparison->overlap, label);
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
    figures_add(&f, "volume_similarity", figures_ratio(2 * difference, (double)n.a + (double)n.b));
    figures_add(&f, "dice", figures_dice(&report->comparison->overlap, label));
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

/* Order the rows by the numbers of the labels. */
static void order_rows(uint8_t order[256], const struct comparison_report *report)
{
    uint32_t number[256];
    numbering_fill(number, report->kept);
    numbering_order(order, number);
}

/* ---- JSON ---- */

static void add_figures(struct json *json, const struct comparison_report *report, unsigned label)
{
    const struct label_distances *d = &report->comparison->distance[label];
    const struct figures f = figures_of(report, label);
    figures_write_json(json, &f);
    if (d->has_hausdorff && d->hausdorff_mm != 0)
        json_counts(json, "farthest", d->farthest, 3);
}

void comparison_write_json(struct buf *out, const struct comparison_report *report)
{
    const struct comparison *c = report->comparison;
    struct json json = {.out = out};
    uint8_t order[256];
    json_object(&json, NULL);
    json_text(&json, "a", report->name[0]);
    json_text(&json, "b", report->name[1]);
    json_count(&json, "voxels", c->overlap.voxels);
    json_count(&json, "differing", c->overlap.differing);
    if (geometry_fill(report->geometry) < 1) /* distances ignore it */
        json_real(&json, "shear_degrees", geometry_shear(report->geometry), 4);
    json_object(&json, "all");
    add_figures(&json, report, 0);
    json_end(&json);
    json_array(&json, "labels");
    order_rows(order, report);
    for (unsigned i = 1; i < 256; i++) {
        const unsigned label = order[i];
        if (!has_row(report, label))
            continue;
        json_object(&json, NULL);
        json_count(&json, "label", numbering_of(report->kept, label));
        json_text(&json, "name", report->kept->label_name[label]);
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
        buf_printf(out, "%u", numbering_of(report->kept, label));
    else
        buf_add_text(out, "all");
    figures_write_csv(out, label ? report->kept->label_name[label] : "", &f);
}

void comparison_write_csv(struct buf *out, const struct comparison_report *report)
{
    const struct figures f = figures_of(report, 0);
    uint8_t order[256];
    figures_write_csv_names(out, &f);
    order_rows(order, report);
    for (unsigned i = 1; i < 256; i++)
        if (has_row(report, order[i]))
            write_csv_row(out, report, order[i]);
    write_csv_row(out, report, 0);
}

/* ---- a table ---- */

static void write_row(struct buf *out, const struct comparison_report *report, unsigned label)
{
    const struct overlap_counts n = overlap_counts_of(&report->comparison->overlap, label);
    const struct label_distances *d = &report->comparison->distance[label];
    OWNED(buf_release) struct buf name = {0};
    if (label)
        buf_printf(&name, "%u ", numbering_of(report->kept, label));
    buf_add_safe_text(&name, label ? report->kept->label_name[label] : "all");
    buf_printf(out, "%-16s", buf_text(&name));
    figures_add_cell(out, 6, 4, figures_dice(&report->comparison->overlap, label));
    figures_add_cell(out, 7, 4, jaccard(&n));
    figures_add_volume(out, "", report->geometry, n.a);
    figures_add_volume(out, n.a > n.b ? "+" : "-", report->geometry,
                       n.a > n.b ? n.a - n.b : n.b - n.a);
    figures_add_cell(out, 9, 2, d->has_hausdorff ? d->hausdorff_mm : NAN);
    figures_add_cell(out, 6, 2, d->has_surfaces ? d->percentile_95_mm : NAN);
    figures_add_cell(out, 6, 2, d->has_surfaces ? d->mean_mm : NAN);
    buf_add_char(out, '\n');
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
    uint8_t order[256];
    order_rows(order, report);
    for (unsigned i = 1; i < 256; i++)
        if (has_row(report, order[i]))
            write_row(out, report, order[i]);
    if (c->labels != 1)
        write_row(out, report, 0);
    /* The surface of a cavity can be far from the other object's surface although all voxels are
     * near. */
    bool is_odd = false;
    for (unsigned label = 0; label < 256; label++)
        is_odd |= c->distance[label].has_surfaces &&
                  c->distance[label].percentile_95_mm > c->distance[label].hausdorff_mm;
    buf_printf(out,
               "%" PRIu64 " of %" PRIu64 " voxels differ; distances in mm: Hausdorff between "
               "voxels, others between surfaces\n",
               c->overlap.differing, c->overlap.voxels);
    if (is_odd)
        buf_add_text(out, "surfaces inside of an object, around cavities, are further apart than "
                          "its voxels\n");
    if (report->geometry->spacing_unknown)
        buf_add_text(out, "the size of voxels is unknown; 1 mm is assumed\n");
    if (geometry_fill(report->geometry) < 1)
        buf_printf(out, "axes are sheared by %.2g degrees; distances ignore that\n",
                   geometry_shear(report->geometry));
    const struct label_distances *d = &c->distance[0];
    if (d->has_hausdorff && d->hausdorff_mm > 0)
        buf_printf(out, "farthest  voxel %u,%u,%u, %.2f mm from the other\n", d->farthest[0],
                   d->farthest[1], d->farthest[2], d->hausdorff_mm);
}
