/* SPDX-License-Identifier: MIT */
#include "show/label_report.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "session/map.h"
#include "session/tally.h"
#include "show/comparison.h"

enum {
    NORMALS_A_SIDE = 8, /* directions along each side of a face of a cube */
    TURNS = 4,          /* edges across each normal */
};

static const double edge_voxels = 10; /* as many edges as a box of this many steps has */
static const double axis_share = 0.1; /* share of planes and edges along each axis */
static const double ridge = 1e-4;     /* keeps the solution stable for all spacings */

/* The normal equations of the least squares, of kinds 1 and more. */
struct squares {
    double pair_mm[PAIR_KINDS][4][3]; /* pairs of a kind; one of each two opposite ones */
    unsigned pairs[PAIR_KINDS];
    double voxel_mm3, step_mm;
    double matrix[PAIR_KINDS][PAIR_KINDS], right[PAIR_KINDS];
};

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(double out[3], const double a[3], const double b[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static void make_unit(double v[3])
{
    const double factor = 1 / sqrt(dot(v, v));
    for (int i = 0; i < 3; i++)
        v[i] *= factor;
}

/* List steps 0..2 along each axis, with each choice of signs for a different pair. */
static void list_pairs(struct squares *s, double step_mm[3][3])
{
    for (int kind = 1; kind < PAIR_KINDS; kind++) {
        const int steps[3] = {kind % 3, kind / 3 % 3, kind / 9};
        const int last = steps[2] ? 2 : steps[1] ? 1 : 0;
        for (int signs = 0; signs < 8; signs++) {
            bool is_new = !(signs >> last);
            for (int a = 0; a < 3; a++)
                is_new &= steps[a] || !(signs >> a & 1);
            double *pair = s->pair_mm[kind][s->pairs[kind]];
            for (int a = 0; a < 3 && is_new; a++)
                for (int w = 0; w < 3; w++)
                    pair[w] += (signs >> a & 1 ? -1 : 1) * steps[a] * step_mm[a][w];
            s->pairs[kind] += is_new;
        }
    }
}

/* Add an equation: the weighted sum of `row` equals `right`. */
static void add_equation(struct squares *s, const double row[PAIR_KINDS], double right,
                         double share)
{
    for (int i = 1; i < PAIR_KINDS; i++) {
        s->right[i] += share * row[i] * right;
        for (int j = 1; j < PAIR_KINDS; j++)
            s->matrix[i][j] += share * row[i] * row[j];
    }
}

/* Equation of a plane of 1 mm2. */
static void add_plane(struct squares *s, const double normal[3], double share)
{
    double row[PAIR_KINDS] = {0};
    for (int kind = 1; kind < PAIR_KINDS; kind++)
        for (unsigned i = 0; i < s->pairs[kind]; i++)
            row[kind] += fabs(dot(normal, s->pair_mm[kind][i])) / s->voxel_mm3;
    add_equation(s, row, 1, share);
}

/* Equation of edges between two perpendicular planes, for each mm2 of a cube: of four parallel
 * edges, each pair misses two. */
static void add_edge(struct squares *s, const double n[3], const double m[3], double share)
{
    const double edge_mm = 1 / (edge_voxels * s->step_mm);
    double row[PAIR_KINDS] = {0};
    for (int kind = 1; kind < PAIR_KINDS; kind++)
        for (unsigned i = 0; i < s->pairs[kind]; i++)
            row[kind] += fabs(dot(n, s->pair_mm[kind][i]) * dot(m, s->pair_mm[kind][i])) * edge_mm /
                         s->voxel_mm3;
    add_equation(s, row, 0, share);
}

/* Equations of a normal, and of edges along it. */
static void add_normal(struct squares *s, const double normal[3], double share)
{
    double across[3] = {-normal[1], normal[0], 0}, third[3];
    make_unit(across);
    cross(third, normal, across);
    add_plane(s, normal, share);
    for (int turn = 0; turn < TURNS; turn++) {
        const double t = (turn + 0.5) / TURNS;
        double n[3], m[3];
        for (int a = 0; a < 3; a++)
            n[a] = (1 - t) * across[a] + t * third[a];
        make_unit(n);
        cross(m, normal, n);
        add_edge(s, n, m, share / TURNS);
    }
}

/* Add normals in all directions, weighted by solid angle, in as many octants as kinds differ in: 1,
 * or 4 for sheared axes. Returns the sum of the shares. */
static double add_normals(struct squares *s, int octants)
{
    double sum = 0;
    for (int n = 0; n < octants * 3 * NORMALS_A_SIDE * NORMALS_A_SIDE; n++) {
        const int octant = n % octants, a = n / octants % 3, side = n / octants / 3;
        double normal[3];
        normal[a] = 1;
        normal[(a + 1) % 3] = (side / NORMALS_A_SIDE + 0.5) / NORMALS_A_SIDE;
        normal[(a + 2) % 3] = (side % NORMALS_A_SIDE + 0.5) / NORMALS_A_SIDE;
        const double share = pow(dot(normal, normal), -1.5);
        normal[0] *= octant & 1 ? -1 : 1;
        normal[1] *= octant & 2 ? -1 : 1;
        make_unit(normal);
        add_normal(s, normal, share);
        sum += share;
    }
    return sum;
}

/* Gaussian elimination; the matrix is positive definite, so it needs no pivoting. */
static void solve(struct squares *s, double weight[PAIR_KINDS])
{
    for (int i = 1; i < PAIR_KINDS; i++)
        s->matrix[i][i] *= 1 + ridge;
    for (int i = 1; i < PAIR_KINDS; i++)
        for (int k = i + 1; k < PAIR_KINDS; k++) {
            const double factor = s->matrix[k][i] / s->matrix[i][i];
            for (int j = i; j < PAIR_KINDS; j++)
                s->matrix[k][j] -= factor * s->matrix[i][j];
            s->right[k] -= factor * s->right[i];
        }
    for (int i = PAIR_KINDS - 1; i > 0; i--) {
        double rest = s->right[i];
        for (int j = i + 1; j < PAIR_KINDS; j++)
            rest -= s->matrix[i][j] * weight[j];
        weight[i] = rest / s->matrix[i][i];
    }
    weight[0] = 0;
}

void area_weights_init(struct area_weights *weights, const struct geometry *geometry)
{
    const double fill = geometry_fill(geometry);
    struct squares s = {.voxel_mm3 = fill, .step_mm = 1};
    uint32_t step[3];
    double step_mm[3][3];
    label_pairs_step(step, geometry->spacing_nm);
    geometry_steps(geometry, step_mm);
    for (int a = 0; a < 3; a++) {
        for (int w = 0; w < 3; w++)
            step_mm[a][w] *= step[a];
        s.voxel_mm3 *= geometry->spacing_nm[a] / 1e6;
        s.step_mm *= step[a] * (geometry->spacing_nm[a] / 1e6);
    }
    s.step_mm = cbrt(s.step_mm);
    list_pairs(&s, step_mm);
    /* The planes through two axes. */
    const double share = axis_share * add_normals(&s, fill < 1 ? 4 : 1);
    double normal[3][3];
    for (int a = 0; a < 3; a++) {
        cross(normal[a], step_mm[(a + 1) % 3], step_mm[(a + 2) % 3]);
        make_unit(normal[a]);
    }
    for (int a = 0; a < 3; a++) {
        add_plane(&s, normal[a], share);
        add_edge(&s, normal[a], normal[(a + 1) % 3], share);
    }
    solve(&s, weights->mm2);
}

/* Count pairs of different labels from both ends: pairs[0] voxels have `ways` neighbours of a
 * kind. */
double label_area_mm2(const struct area_weights *weights, const uint64_t pairs[PAIR_KINDS])
{
    double mm2 = 0;
    for (int kind = 1; kind < PAIR_KINDS; kind++) {
        const int axes = (kind % 3 > 0) + (kind / 3 % 3 > 0) + (kind / 9 > 0);
        const uint64_t ways = UINT64_C(1) << axes;
        mm2 += weights->mm2[kind] * (double)(ways * pairs[0] - 2 * pairs[kind]);
    }
    return mm2;
}

/* ---- names and volumes ---- */

void label_report_write_label(struct buf *out, const struct kept *kept, unsigned label)
{
    const char *name = kept->label_name[label];
    buf_printf(out, "%u%s%s", numbering_of(kept, label), *name ? " " : "", name);
}

void label_report_write_name(struct buf *out, const struct session *session, unsigned label)
{
    label_report_write_label(out, &session->now.kept, label);
}

void label_report_write_extent(struct buf *out, const struct session *session, uint64_t voxels)
{
    if (session->geometry.spacing_unknown)
        buf_printf(out, "%llu voxel%s", (unsigned long long)voxels, plural(voxels));
    else if (voxels)
        tally_write_volume(out, &session->geometry, voxels);
    else
        buf_add_text(out, "0 ml");
}

void label_report_write_change(struct buf *out, const struct session *session, uint64_t voxels,
                               uint64_t former)
{
    if (former == 0 || former == voxels)
        return;
    buf_add_text(out, voxels > former ? " (+" : " (-");
    label_report_write_extent(out, session, voxels > former ? voxels - former : former - voxels);
    buf_add_char(out, ')');
}

enum slice_plane label_report_write_doubt(struct buf *out, const struct session *session,
                                          const struct doubtful_slice *slice)
{
    const struct scene *scene = session->scene;
    const uint64_t voxels = (slice->doubt + DOUBT_VOXEL / 2) / DOUBT_VOXEL;
    enum slice_plane plane = SLICE_AXIAL;
    while (slice_axis(scene, plane) != (int)slice->axis)
        plane++;
    if (!scene->sides_unknown)
        buf_printf(out, "%s ", slice_name(scene, plane));
    buf_printf(out, "%c=%u: ", "xyz"[slice->axis], slice -> at);
    label_report_write_extent(out, session, voxels);
    buf_add_text(out, " in doubt");
    return plane;
}

/* ---- measures ---- */

static double surface_mm2(const struct label_report *report, unsigned label)
{
    return report->geometry->spacing_unknown
               ? NAN
               : label_area_mm2(report->area, report->stats[label].pairs);
}

static double mean(const struct label_sums *s)
{
    return s->voxels == 0 ? NAN : (double)s->intensity / (double)s->voxels;
}

/* Standard deviation of a sample of intensities. The squares are taken about the whole number below
 * the mean, exactly: modulo 2^64, which their sum does not reach. */
static double deviation(const struct label_sums *s)
{
    if (s->voxels == 0)
        return NAN;
    const uint64_t about = s->intensity / s->voxels, rest = s->intensity - s->voxels * about;
    const uint64_t squares =
        s->intensity_squares - 2 * about * s->intensity + s->voxels * about * about;
    const double n = (double)s->voxels, beyond = (double)rest;
    return s->voxels > 1 ? sqrt(((double)squares - beyond * beyond / n) / (n - 1)) : NAN;
}

static void find_centre(double centre[3], const struct label_sums *s)
{
    for (int a = 0; a < 3; a++)
        centre[a] = s->voxels ? (double)s->sum[a] / (double)s->voxels : NAN;
}

/* World coordinates of a place between voxels. */
static void find_place(double mm[3], const struct geometry *geometry, const double at[3])
{
    for (int a = 0; a < 3; a++) {
        const double *row = geometry->to_mm[a];
        mm[a] = geometry_has_place(geometry)
                    ? row[0] * at[0] + row[1] * at[1] + row[2] * at[2] + row[3]
                    : NAN;
    }
}

/* The lowest and the highest real value; they swap if values fall as intensities rise. */
static void find_range(double range[2], const struct label_report *report, unsigned label)
{
    const struct label_sums *s = &report->stats[label].sums;
    const bool falls = report->geometry->slope < 0;
    range[0] = range[1] = NAN;
    if (s->voxels == 0)
        return;
    range[0] = levels_value(report->geometry, report->levels, falls ? s->most : s->least);
    range[1] = levels_value(report->geometry, report->levels, falls ? s->least : s->most);
}

static double median(const struct label_report *report, unsigned label)
{
    const uint16_t *middle = report->stats[label].sums.middle;
    if (report->stats[label].sums.voxels == 0)
        return NAN;
    if (middle[0] == middle[1])
        return levels_value(report->geometry, report->levels, middle[0]);
    return geometry_value(report->geometry, ((double)middle[0] + middle[1]) / 2);
}

/* Change of the voxel count by the last edit, or NAN. */
static double change(const struct label_report *report, unsigned label)
{
    if (report->gained)
        return (double)report->gained[label] - (double)report->lost[label];
    return report->before ? (double)report->stats[label].sums.voxels - (double)report->before[label]
                          : NAN;
}

/* ---- JSON and CSV ---- */

static bool has_row(const struct label_report *report, unsigned label)
{
    return report->stats[label].sums.voxels || (report->listed && report->listed[label]);
}

static struct figures figures_of(const struct label_report *report, unsigned label)
{
    enum { CENTRE, PLACE, FIRST, LAST, POINTS };
    static const char *const name[POINTS][3] = {
        [CENTRE] = {"centre_x", "centre_y", "centre_z"},
        [PLACE] = {"centre_x_mm", "centre_y_mm", "centre_z_mm"},
        [FIRST] = {"first_x", "first_y", "first_z"},
        [LAST] = {"last_x", "last_y", "last_z"}};
    const struct label_sums *s = &report->stats[label].sums;
    const double mm3 = report->geometry->spacing_unknown ? NAN : tally_voxel_mm3(report->geometry);
    struct figures f = {.count = 0};
    double point[POINTS][3], range[2];
    find_centre(point[CENTRE], s);
    find_place(point[PLACE], report->geometry, point[CENTRE]);
    for (int a = 0; a < 3; a++) {
        point[FIRST][a] = s->voxels ? (double)s->first[a] : NAN;
        point[LAST][a] = s->voxels ? (double)s->last[a] : NAN;
    }
    find_range(range, report, label);
    figures_add(&f, "voxels", (double)s->voxels);
    figures_add(&f, "volume_mm3", (double)s->voxels * mm3);
    figures_add(&f, "surface_mm2", surface_mm2(report, label));
    figures_add(&f, "components", report->stats[label].components);
    figures_add(&f, "holes", report->stats[label].holes);
    figures_add(&f, "mean", geometry_value(report->geometry, mean(s)));
    figures_add(&f, "deviation", fabs(report->geometry->slope) * deviation(s));
    figures_add(&f, "minimum", range[0]);
    figures_add(&f, "median", median(report, label));
    figures_add(&f, "maximum", range[1]);
    for (int i = 0; i < POINTS * 3; i++)
        figures_add(&f, name[i / 3][i % 3], point[i / 3][i % 3]);
    figures_add(&f, "gained", report->gained ? (double)report->gained[label] : NAN);
    figures_add(&f, "lost", report->lost ? (double)report->lost[label] : NAN);
    figures_add(&f, "change", change(report, label));
    return f;
}

/* Add the facts about intensities of the scene. */
static struct figures add_facts(struct figures f, const struct label_report *report)
{
    if (report->channel)
        figures_add(&f, "intensity_channel", report->channel);
    if (report->levels) {
        figures_add(&f, "intensity_step", report->levels->step);
        figures_add(&f, "voxels_below_scale", (double)report->levels->beyond[0]);
        figures_add(&f, "voxels_above_scale", (double)report->levels->beyond[1]);
    }
    return f;
}

void label_report_write_json(struct buf *out, const struct label_report *report)
{
    struct json json = {.out = out};
    const struct figures facts = add_facts((struct figures){.count = 0}, report);
    uint8_t order[256];
    json_object(&json, NULL);
    if (geometry_fill(report->geometry) < 1) /* surfaces are approximate there */
        json_real(&json, "shear_degrees", geometry_shear(report->geometry), 4);
    json_array(&json, "by_label");
    numbering_order(order, report->label_number);
    for (unsigned i = 1; i < 256; i++) {
        const unsigned label = order[i];
        if (!has_row(report, label))
            continue;
        const struct figures f = figures_of(report, label);
        json_object(&json, NULL);
        json_count(&json, "number", report->label_number[label]);
        json_text(&json, "name", report->label_name[label]);
        json_text(&json, "code", report->label_code[label]);
        figures_write_json(&json, &f);
        json_end(&json);
    }
    json_end(&json);
    figures_write_json(&json, &facts);
    json_end(&json);
}

/* Facts of the scene are in every row of the table. */
void label_report_write_csv(struct buf *out, const struct label_report *report)
{
    const struct figures names = add_facts(figures_of(report, 0), report);
    uint8_t order[256];
    figures_write_csv_names(out, &names);
    numbering_order(order, report->label_number);
    for (unsigned i = 1; i < 256; i++) {
        const unsigned label = order[i];
        if (!has_row(report, label))
            continue;
        const struct figures f = add_facts(figures_of(report, label), report);
        buf_printf(out, "%u", report->label_number[label]);
        figures_write_csv(out, report->label_name[label], &f);
    }
}

/* ---- text ---- */

void label_report_write_sums(struct buf *out, const struct label_sums *sums,
                             const struct geometry *geometry)
{
    const double spread = fabs(geometry->slope) * deviation(sums);
    buf_printf(out, "mean %.4g", geometry_value(geometry, mean(sums)));
    if (!isnan(spread))
        buf_printf(out, ", SD %.3g", spread);
    for (int a = 0; a < 3; a++)
        buf_printf(out, "%s%.3g", a ? " x " : ", ",
                   (sums->last[a] - sums->first[a] + 1) *
                       (geometry->spacing_unknown ? 1 : geometry->spacing_nm[a] / 1e6));
    buf_add_text(out, geometry->spacing_unknown ? " voxels" : " mm");
}

static void write_last_edit(struct buf *out, const struct label_report *report, unsigned label)
{
    const bool has_moves = report->gained && report->gained[label] + report->lost[label] > 0;
    if (!has_moves && (report->gained || !report->before || change(report, label) == 0))
        return;
    if (has_moves)
        buf_printf(out,
                   "    the last edit added %" PRIu64 " voxel%s to it and removed %" PRIu64 ": ",
                   report->gained[label], plural(report->gained[label]), report->lost[label]);
    else
        buf_add_text(out, "    the last edit changed it by ");
    const double voxels = change(report, label);
    buf_add_text(out, voxels < 0 ? "-" : "+");
    if (report->geometry->spacing_unknown)
        buf_printf(out, "%.0f voxel%s", fabs(voxels), fabs(voxels) == 1 ? "" : "s");
    else
        tally_write_volume(out, report->geometry, (uint64_t)fabs(voxels));
    buf_add_char(out, '\n');
}

void label_report_write_text(struct buf *out, const struct label_report *report, unsigned label)
{
    const struct label_stats *s = &report->stats[label];
    const struct label_sums *sums = &s->sums;
    const double mm2 = surface_mm2(report, label);
    buf_printf(out, "    %u component%s, %u hole%s", s->components, plural(s->components), s->holes,
               plural(s->holes));
    if (!isnan(mm2))
        buf_printf(out, ", surface %.4g %s%s", mm2 < 1e4 ? mm2 : mm2 / 100,
                   mm2 < 1e4 ? "mm2" : "cm2",
                   geometry_fill(report->geometry) < 1 ? " roughly, of sheared axes" : "");
    double centre[3], mm[3];
    find_centre(centre, sums);
    find_place(mm, report->geometry, centre);
    buf_printf(out, "\n    centre %.1f,%.1f,%.1f", centre[0], centre[1], centre[2]);
    if (!isnan(mm[0]))
        buf_printf(out, " at %.1f,%.1f,%.1f mm", mm[0], mm[1], mm[2]);
    buf_printf(out, ", box %u,%u,%u to %u,%u,%u\n", sums->first[0], sums->first[1], sums->first[2],
               sums->last[0], sums->last[1], sums->last[2]);
    const double spread = fabs(report->geometry->slope) * deviation(sums);
    double range[2];
    find_range(range, report, label);
    const int more = geometry_digits(report->geometry) - 6; /* digits beyond those of most scenes */
    buf_printf(out, "    intensity %.*g", 5 + more, geometry_value(report->geometry, mean(sums)));
    if (!isnan(spread))
        buf_printf(out, ", deviation %.4g", spread);
    buf_printf(out, ", median %.*g, %.*g..%.*g\n", 5 + more, median(report, label), 6 + more,
               range[0], 6 + more, range[1]);
    write_last_edit(out, report, label);
}
