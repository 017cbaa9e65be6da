/* SPDX-License-Identifier: MIT */
#include "show/label_report.h"

#include <inttypes.h>
#include <math.h>

#include "show/figures.h"
#include "session/tally.h"

/* ---- names and volumes ---- */

void label_report_write_name(struct buf *out, const struct session *session, unsigned label)
{
    const char *name = session_kept(session)->label_name[label];
    buf_printf(out, "%u%s%s", label, *name ? " " : "", name);
    if (session_kept(session)->label_number[label])
        buf_printf(out, " (%u)", session_kept(session)->label_number[label]);
}

void label_report_write_extent(struct buf *out, const struct session *session, uint64_t voxels)
{
    if (session_geometry(session)->spacing_unknown)
        buf_printf(out, "%llu voxel%s", (unsigned long long)voxels, plural(voxels));
    else if (voxels)
        tally_write_volume(out, session_geometry(session), voxels);
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

static void add_three(struct figures *figures, const char *const name[3], const double value[3])
{
    for (int a = 0; a < 3; a++)
        figures_add(figures, name[a], value[a]);
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

/* Of intensities, as of a sample: by one less than the number of voxels. The squares are taken
 * about the whole number below the mean, so that nothing is lost: modulo 2^64, which their sum is
 * below. */
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

/* Of a place between voxels. */
static void find_place(double mm[3], const struct geometry *geometry, const double at[3])
{
    for (int a = 0; a < 3; a++) {
        const double *row = geometry->to_mm[a];
        mm[a] = geometry_has_place(geometry)
                    ? row[0] * at[0] + row[1] * at[1] + row[2] * at[2] + row[3]
                    : NAN;
    }
}

/* The lowest and the highest real value: they swap where real values fall as intensities rise. */
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

/* How many more voxels it has since the last edit, or NAN. */
static double change(const struct label_report *report, unsigned label)
{
    if (report->gained)
        return (double)report->gained[label] - (double)report->lost[label];
    return report->before ? (double)report->stats[label].sums.voxels - (double)report->before[label]
                          : NAN;
}

/* ---- for programs ---- */

static bool has_row(const struct label_report *report, unsigned label)
{
    return report->stats[label].sums.voxels || (report->listed && report->listed[label]);
}

static struct figures figures_of(const struct label_report *report, unsigned label)
{
    static const char *const centre_name[] = {"centre_x", "centre_y", "centre_z"};
    static const char *const place_name[] = {"centre_x_mm", "centre_y_mm", "centre_z_mm"};
    static const char *const first_name[] = {"first_x", "first_y", "first_z"};
    static const char *const last_name[] = {"last_x", "last_y", "last_z"};
    const struct label_sums *s = &report->stats[label].sums;
    struct figures f = {.count = 0};
    double centre[3], place[3], range[2];
    find_centre(centre, s);
    find_place(place, report->geometry, centre);
    find_range(range, report, label);
    figures_add(&f, "voxels", (double)s->voxels);
    figures_add(&f, "volume_mm3",
                (double)s->voxels *
                    (report->geometry->spacing_unknown ? NAN : tally_voxel_mm3(report->geometry)));
    figures_add(&f, "surface_mm2", surface_mm2(report, label));
    figures_add(&f, "components", report->stats[label].components);
    figures_add(&f, "holes", report->stats[label].holes);
    figures_add(&f, "mean", geometry_value(report->geometry, mean(s)));
    figures_add(&f, "deviation", fabs(report->geometry->slope) * deviation(s));
    figures_add(&f, "minimum", range[0]);
    figures_add(&f, "median", median(report, label));
    figures_add(&f, "maximum", range[1]);
    add_three(&f, centre_name, centre);
    add_three(&f, place_name, place);
    const bool has = s->voxels > 0;
    for (int a = 0; a < 3; a++)
        figures_add(&f, first_name[a], has ? (double)s->first[a] : NAN);
    for (int a = 0; a < 3; a++)
        figures_add(&f, last_name[a], has ? (double)s->last[a] : NAN);
    figures_add(&f, "gained", report->gained ? (double)report->gained[label] : NAN);
    figures_add(&f, "lost", report->lost ? (double)report->lost[label] : NAN);
    figures_add(&f, "change", change(report, label));
    if (report->label_number)
        figures_add(&f, "number_in_files",
                    report->label_number[label] ? report->label_number[label] : label);
    return f;
}

void label_report_write_json(struct buf *out, const struct label_report *report)
{
    struct json json = {.out = out};
    json_object(&json, NULL);
    if (geometry_fill(report->geometry) < 1) /* surfaces are rough there */
        json_real(&json, "shear_degrees", geometry_shear(report->geometry), 4);
    json_array(&json, "by_label");
    for (unsigned label = 1; label < 256; label++) {
        if (!has_row(report, label))
            continue;
        const struct figures f = figures_of(report, label);
        json_object(&json, NULL);
        json_count(&json, "number", label);
        json_text(&json, "name", report->label_name[label]);
        figures_write_json(&json, &f);
        json_end(&json);
    }
    json_end(&json);
    if (report->levels) {
        json_real(&json, "intensity_step", report->levels->step, 6);
        json_count(&json, "voxels_below_scale", report->levels->beyond[0]);
        json_count(&json, "voxels_above_scale", report->levels->beyond[1]);
    }
    json_end(&json);
}

/* A table has no place for what is said of the scene: each row has it. */
static struct figures csv_figures_of(const struct label_report *report, unsigned label)
{
    struct figures f = figures_of(report, label);
    if (report->levels) {
        figures_add(&f, "intensity_step", report->levels->step);
        figures_add(&f, "voxels_below_scale", (double)report->levels->beyond[0]);
        figures_add(&f, "voxels_above_scale", (double)report->levels->beyond[1]);
    }
    return f;
}

void label_report_write_csv(struct buf *out, const struct label_report *report)
{
    static const struct label_stats one[1] = {{.sums.voxels = 1}};
    static const struct area_weights none;
    const struct label_report any = {.stats = one,
                                     .area = &none,
                                     .label_number = report->label_number,
                                     .geometry = report->geometry,
                                     .levels = report->levels};
    const struct figures names = csv_figures_of(&any, 0);
    figures_write_csv_names(out, &names);
    for (unsigned label = 1; label < 256; label++) {
        if (!has_row(report, label))
            continue;
        const struct figures f = csv_figures_of(report, label);
        buf_printf(out, "%u", label);
        figures_write_csv(out, report->label_name[label], &f);
    }
}

/* ---- for people ---- */

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

static void write_last_edit(struct buf *out, const struct label_report *report, unsigned label,
                            int blanks)
{
    const bool has_moves = report->gained && report->gained[label] + report->lost[label] > 0;
    if (!has_moves && (report->gained || !report->before || change(report, label) == 0))
        return;
    buf_printf(out, "%*sthe last edit ", blanks, "");
    if (has_moves)
        buf_printf(out, "gave it %" PRIu64 " voxel%s, and took %" PRIu64 ": ",
                   report->gained[label], plural(report->gained[label]), report->lost[label]);
    else
        buf_add_text(out, "changed it by ");
    const double voxels = change(report, label);
    buf_add_text(out, voxels < 0 ? "-" : "+");
    if (report->geometry->spacing_unknown)
        buf_printf(out, "%.0f voxel%s", fabs(voxels), fabs(voxels) == 1 ? "" : "s");
    else
        tally_write_volume(out, report->geometry, (uint64_t)fabs(voxels));
    buf_add_char(out, '\n');
}

void label_report_write_text(struct buf *out, const struct label_report *report, unsigned label,
                             int blanks)
{
    const struct label_stats *s = &report->stats[label];
    const struct label_sums *sums = &s->sums;
    const double mm2 = surface_mm2(report, label);
    buf_printf(out, "%*s%u component%s, %u hole%s", blanks, "", s->components,
               plural(s->components), s->holes, plural(s->holes));
    if (!isnan(mm2))
        buf_printf(out, ", surface %.4g %s%s", mm2 < 1e4 ? mm2 : mm2 / 100,
                   mm2 < 1e4 ? "mm2" : "cm2",
                   geometry_fill(report->geometry) < 1 ? " roughly, of sheared axes" : "");
    buf_printf(out, "\n%*s", blanks, "");
    double centre[3], mm[3];
    find_centre(centre, sums);
    find_place(mm, report->geometry, centre);
    buf_printf(out, "centre %.1f,%.1f,%.1f", centre[0], centre[1], centre[2]);
    if (!isnan(mm[0]))
        buf_printf(out, " at %.1f,%.1f,%.1f mm", mm[0], mm[1], mm[2]);
    buf_printf(out, ", box %u,%u,%u to %u,%u,%u\n", sums->first[0], sums->first[1], sums->first[2],
               sums->last[0], sums->last[1], sums->last[2]);
    buf_printf(out, "%*s", blanks, "");
    const double spread = fabs(report->geometry->slope) * deviation(sums);
    double range[2];
    find_range(range, report, label);
    const int more = geometry_digits(report->geometry) - 6; /* than most scenes need */
    buf_printf(out, "intensity %.*g", 5 + more, geometry_value(report->geometry, mean(sums)));
    if (!isnan(spread))
        buf_printf(out, ", deviation %.4g", spread);
    buf_printf(out, ", median %.*g, %.*g..%.*g\n", 5 + more, median(report, label), 6 + more,
               range[0], 6 + more, range[1]);
    write_last_edit(out, report, label, blanks);
}
