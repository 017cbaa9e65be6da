/* Distances, angles, and intensities along a way. */
#include "command/act.h"

#include <math.h>
#include <stdio.h>

#include "image/geometry.h"
#include "image/levels.h"
#include "report/chart.h"

enum { PROFILE_ROWS = 8, MARGIN = 9 };

/* ---- distances and angles ---- */

/* From the centre of a voxel to that of another: in voxels, and in millimetres. */
struct way {
    double voxels[3], mm[3];
};

static struct way way_between(const struct session *session, const uint32_t from[3],
                              const uint32_t to[3])
{
    struct way way;
    double a[3], b[3];
    geometry_point(session_geometry(session), from, a);
    geometry_point(session_geometry(session), to, b);
    for (int i = 0; i < 3; i++) {
        way.voxels[i] = (double)to[i] - (double)from[i];
        way.mm[i] = b[i] - a[i];
    }
    return way;
}

static double product(const double u[3], const double v[3])
{
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

/* "25.50 mm, 17.00 voxels"; in voxels alone where their distances are unknown. */
static void write_length(struct buf *out, const struct session *session, const struct way *way)
{
    if (!session_geometry(session)->spacing_unknown)
        buf_printf(out, "%.2f mm, ", sqrt(product(way->mm, way->mm)));
    buf_printf(out, "%.2f voxels", sqrt(product(way->voxels, way->voxels)));
}

/* A line: "25.50 mm, 17.00 voxels from 10,20,30 to 27,20,30". */
static void write_distance(const struct act *act, const uint32_t from[3], const uint32_t to[3])
{
    struct buf *out = &act->reply->text;
    const struct way way = way_between(act->session, from, to);
    write_length(out, act->session, &way);
    buf_printf(out, " from %u,%u,%u to %u,%u,%u\n", from[0], from[1], from[2], to[0], to[1], to[2]);
}

/* In degrees; never where one of both goes nowhere. */
static double angle_between(const double u[3], const double v[3])
{
    const double cross[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                             u[0] * v[1] - u[1] * v[0]};
    return atan2(sqrt(product(cross, cross)), product(u, v)) * 180 / 3.14159265358979323846;
}

static enum err write_angle(const struct act *act)
{
    const struct session *session = act->session;
    const uint32_t *at = act_place(act, "OTHER");
    const struct way a = way_between(session, at, act_place(act, "PLACE"));
    const struct way b = way_between(session, at, act_place(act, "THIRD"));
    const bool measures = !session_geometry(session)->spacing_unknown;
    if (product(a.voxels, a.voxels) == 0 || product(b.voxels, b.voxels) == 0)
        return fault_set(act->fault, ERR_INPUT,
                         "there is no angle at %u,%u,%u: expected two other voxels beside it",
                         at[0], at[1], at[2]);
    buf_printf(&act->reply->text, "%.1f degrees at %u,%u,%u%s\n",
               measures ? angle_between(a.mm, b.mm) : angle_between(a.voxels, b.voxels), at[0],
               at[1], at[2], measures ? "" : ", as if voxels were cubes");
    return OK;
}

enum err act_measure(const struct act *act)
{
    const uint32_t *other = act_place(act, "OTHER");
    write_distance(act, act_place(act, "PLACE"), other);
    if (!act_has(act, "THIRD"))
        return OK;
    write_distance(act, other, act_place(act, "THIRD"));
    return write_angle(act);
}

/* ---- profiles ---- */

struct profile {
    const struct session *session;
    const uint32_t *from, *to;
    int64_t steps;
    unsigned columns;
    double mean[CHART_COLUMNS]; /* of each column */
    char label[CHART_COLUMNS + 1];
    double least, most, sum; /* of all voxels */
};

static const struct cell *cell_at(const struct profile *p, int64_t step, uint32_t at[3])
{
    int64_t place[3];
    paint_step(place, p->from, p->to, step, p->steps);
    for (int a = 0; a < 3; a++)
        at[a] = (uint32_t)place[a];
    return session_scene(p->session)->cell +
           grid_cell(&session_scene(p->session)->grid, at[0], at[1], at[2]);
}

static char letter_of_label(const struct cell *cell)
{
    return !cell_is_reached(cell) ? '.' : cell->label > 9 ? '+' : (char)('0' + cell->label);
}

/* Column c has the voxels from count * c / columns on. */
static void take_column(struct profile *p, unsigned column)
{
    const int64_t count = p->steps + 1, first = count * column / p->columns;
    const int64_t end = count * (column + 1) / p->columns;
    double sum = 0;
    for (int64_t i = first; i < end; i++) {
        uint32_t at[3];
        const struct cell *cell = cell_at(p, i, at);
        const double value =
            levels_value(session_geometry(p->session), session_levels(p->session), cell->intensity);
        sum += value;
        p->least = i == 0 || value < p->least ? value : p->least;
        p->most = i == 0 || value > p->most ? value : p->most;
        p->label[column] = letter_of_label(cell);
    }
    p->sum += sum;
    p->mean[column] = sum / (double)(end - first);
}

static void draw(struct buf *out, const struct profile *p, bool has_blocks)
{
    uint16_t eighths[CHART_COLUMNS];
    char top[16], bottom[16];
    const double wide = p->most > p->least ? p->most - p->least : 1;
    for (unsigned c = 0; c < p->columns; c++) /* the least value has one eighth */
        eighths[c] = (uint16_t)(1 + (p->mean[c] - p->least) / wide * (8 * PROFILE_ROWS - 1));
    snprintf(top, sizeof top, "%.6g", p->most);
    snprintf(bottom, sizeof bottom, "%.6g", p->least);
    chart_write(
        out, &(struct chart){eighths, p->columns, PROFILE_ROWS, top, bottom, MARGIN, has_blocks});
    buf_printf(out, "%*slabels |%s\n", MARGIN - 6, "", p->label);
}

static void list(struct buf *out, const struct profile *p)
{
    const bool measures = !session_geometry(p->session)->spacing_unknown;
    for (int64_t i = 0; i <= p->steps; i++) {
        uint32_t at[3];
        const struct cell *cell = cell_at(p, i, at);
        const struct way way = way_between(p->session, p->from, at);
        buf_printf(out, "%8.2f %s  %u,%u,%u  ",
                   sqrt(measures ? product(way.mm, way.mm) : product(way.voxels, way.voxels)),
                   measures ? "mm" : "voxels", at[0], at[1], at[2]);
        levels_write(out, session_geometry(p->session), session_levels(p->session),
                     cell->intensity);
        buf_add_text(out, "  ");
        if (cell_is_reached(cell))
            label_report_write_name(out, p->session, cell->label);
        buf_add_text(out, cell_is_reached(cell) ? "\n" : "no seed reaches it\n");
    }
}

enum err act_profile(const struct act *act)
{
    struct buf *out = &act->reply->text;
    struct profile p = {
        .session = act->session, .from = act_place(act, "PLACE"), .to = act_place(act, "OTHER")};
    p.steps = paint_steps(p.from, p.to);
    p.columns = p.steps < CHART_COLUMNS ? (unsigned)p.steps + 1 : CHART_COLUMNS;
    for (unsigned c = 0; c < p.columns; c++)
        take_column(&p, c);
    write_distance(act, p.from, p.to);
    draw(out, &p, act->interp->has_blocks);
    buf_printf(out, "%lld voxel%s", (long long)p.steps + 1, plural((uint64_t)p.steps + 1));
    if (p.steps >= p.columns)
        buf_printf(out, ", %.2g in a column", (double)(p.steps + 1) / p.columns);
    const int digits = geometry_digits(session_geometry(p.session));
    buf_printf(out, "; values %.*g to %.*g, mean %.*g\n", digits, p.least, digits, p.most, digits,
               p.sum / (double)(p.steps + 1));
    levels_write_scale(out, session_levels(p.session), "");
    if (act_is_yes(act, "values"))
        list(out, &p);
    return OK;
}
