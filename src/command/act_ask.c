/* SPDX-License-Identifier: MIT */
/* Questions about places: they change and record nothing, except for `hint`. */
#include "show/histogram.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/hash.h"
#include "base/json.h"
#include "base/mem.h"
#include "base/scan.h"
#include "command/act.h"
#include "engine/hints.h"
#include "engine/margin.h"
#include "engine/measure.h"
#include "engine/way.h"
#include "image/geometry.h"
#include "image/levels.h"
#include "session/doubtful.h"
#include "session/paint.h"
#include "session/session.h"
#include "session/tally.h"
#include "show/draw.h"
#include "show/label_report.h"
#include "show/slicing.h"

/* ---- landmarks ---- */

enum err act_landmark(const struct act *act)
{
    struct landmark *mark = act->next->kept.landmark;
    const char *name = act_text(act, "NAME");
    const bool goes = act_has(act, "PLACE") && act_text(act, "PLACE");
    TRY(act_check_name(name, LANDMARK_NAME_BYTES, act->fault));
    size_t at = 0;
    while (at < LANDMARKS && *mark[at].name && strcmp(mark[at].name, name) != 0)
        at++;
    if (goes && (at == LANDMARKS || !*mark[at].name))
        return fault_set(act->fault, ERR_USAGE,
                         "there is no landmark %s; `info` lists them; nothing has changed", name);
    if (at == LANDMARKS)
        return fault_set(act->fault, ERR_LIMIT, "there are %d landmarks, and no more are taken",
                         LANDMARKS);
    memset(mark[at].name, 0, sizeof mark[at].name);
    memset(mark[at].place, 0, sizeof mark[at].place);
    if (goes) {
        const struct landmark none = mark[at];
        memmove(mark + at, mark + at + 1, (LANDMARKS - 1 - at) * sizeof *mark);
        mark[LANDMARKS - 1] = none;
    } else {
        memcpy(mark[at].name, name, strlen(name));
        memcpy(mark[at].place, act_place(act, "PLACE"), sizeof mark[at].place);
    }
    return act_go(act);
}

/* ---- the origin ---- */

static enum err check_pull(const struct act *act)
{
    const char *at = act_text(act, "pull");
    struct decimal number;
    unsigned count = 0;
    if (!at)
        return OK;
    while (decimal_scan(&at, &number) && ++count < 12 && scan_text(&at, ","))
        ;
    return count == 12 && !*at ? OK
                               : fault_set(act->fault, ERR_USAGE,
                                           "pull: expected twelve numbers with commas between");
}

/* Read "1:1200000,2:150000" into volume[256], or check "1:12/3400,.." if it is NULL. */
static enum err read_pairs(const struct act *act, const char *key, uint32_t *volume)
{
    const char *at = act_text(act, key);
    const struct kept *kept = &act->session->now.kept;
    int64_t label, number, of, before = -1;
    bool fine = true;
    while (fine && at && *at) {
        fine = scan_integer(&at, 0, UINT32_MAX, &label) && label > before &&
               numbering_find(kept, (uint32_t)label) != NUMBER_UNKNOWN && scan_text(&at, ":") &&
               scan_integer(&at, 0, UINT32_MAX, &number) &&
               (volume ||
                (scan_text(&at, "/") && scan_integer(&at, 0, UINT32_MAX, &of) && number <= of)) &&
               (!*at || (scan_text(&at, ",") && *at));
        if (fine && volume)
            volume[numbering_find(kept, (uint32_t)label)] = (uint32_t)number;
        before = label;
    }
    return fine ? OK
                : fault_set(act->fault, ERR_USAGE, "%s: expected %s, by rising labels, not %s", key,
                            volume ? "LABEL:MM3,.." : "LABEL:N/OF,..", act_text(act, key));
}

enum err act_origin(const struct act *act)
{
    struct kept *kept = &act->next->kept;
    const char *procedure = act_text(act, "PROCEDURE");
    const bool is_none = strcmp(procedure, "none") == 0;
    static const char *const digest[] = {"digest", "scene", "from"};
    struct buf *words = act_buf(act);
    if (!is_none && !scan_is_hex(procedure, 32))
        return fault_set(act->fault, ERR_USAGE,
                         "PROCEDURE: expected the 32 digits of a chain, or none, not %s",
                         procedure);
    for (int i = 0; i < 3; i++) {
        const char *text = act_text(act, digest[i]);
        if (text && !scan_is_hex(text, SHA256_HEX - 1))
            return fault_set(act->fault, ERR_USAGE,
                             "%s: expected the 64 digits of a SHA-256, not %s", digest[i], text);
    }
    TRY(check_pull(act));
    memset(kept->origin_mm3, 0, sizeof kept->origin_mm3);
    TRY(read_pairs(act, "volumes", kept->origin_mm3));
    TRY(read_pairs(act, "dropped", NULL));
    if (!is_none)
        buf_printf(words, "procedure %s", procedure);
    if (act_has(act, "by"))
        buf_printf(words, ", by %s", act_text(act, "by"));
    if (act_has(act, "as"))
        buf_printf(words, ", as %s", act_text(act, "as"));
    memset(kept->origin, 0, sizeof kept->origin);
    if (words->length < sizeof kept->origin)
        memcpy(kept->origin, buf_text(words), words->length);
    return act_go(act);
}

/* ---- in words ---- */

void act_write_origin(struct buf *out, const struct session *session)
{
    const struct kept *kept = &session->now.kept;
    for (size_t i = 0; i < LANDMARKS && *kept->landmark[i].name; i++) {
        const struct landmark *mark = &kept->landmark[i];
        buf_add_text(out, i ? ", " : "landmarks ");
        buf_add_safe_text(out, mark->name);
        buf_printf(out, " %u,%u,%u", mark->place[0], mark->place[1], mark->place[2]);
    }
    buf_add_text(out, *kept->landmark[0].name ? "\n" : "");
    if (*kept->origin)
        buf_printf(out, "origin    %s\n", kept->origin);
}

/* ---- the voxel under a pixel ---- */

/* Add "3.61 mm from the border of label 1 brain, at 70,101,95". */
static void write_border_distance(struct buf *out, const struct session *session, uint32_t cell)
{
    const struct scene *scene = session->scene;
    const struct border_distance border = measure_border_distance(scene, cell);
    const struct place at = grid_place(&scene->grid, border.cell);
    const char *unit = session->geometry.spacing_unknown ? "voxels" : "mm";
    if (!border.found && border.reach_nm == UINT64_MAX)
        buf_add_text(out, "the scene holds no border of label ");
    else if (!border.found)
        buf_printf(out, "more than %g %s from the border of label ", (double)border.reach_nm / 1e6,
                   unit);
    else if (border.squared == 0)
        buf_add_text(out, "on the border of label ");
    else
        buf_printf(out, "%.2f %s from the border of label ", sqrt((double)border.squared) / 1e6,
                   unit);
    label_report_write_name(out, session, scene->cell[cell].label);
    if (border.found && border.squared)
        buf_printf(out, ", at %u,%u,%u", at.x, at.y, at.z);
    if (border.squared && geometry_fill(&session->geometry) < 1)
        buf_add_text(out, ", as if axes were not sheared");
    buf_add_char(out, '\n');
}

enum err act_pick(const struct act *act)
{
    struct session *session = act->session;
    const uint32_t column = (uint32_t)act_number(act, "COLUMN"),
                   row = (uint32_t)act_number(act, "ROW");
    const int64_t of = act_number(act, "of"); /* 0: the rendition */
    uint32_t cell = CELL_NONE;
    struct labels labels;
    TRY(session_labels(session, session_shows_finished(session), &labels, act->fault));
    if (!of && !session_rendered(session))
        return fault_set(act->fault, ERR_USAGE, "the rendition is not up to date; `render` first");
    if (!of) /* the pilot's rendition may have another zoom */
        TRY(session_draw_labels(session, &labels, RENDER_AS_KEPT, act->fault));
    const struct rendition *r = session_frame(session);
    const struct view *view = &session->now.outlook.view;
    const uint32_t width = of ? view->width : r->width, height = of ? view->height : r->height;
    if (column >= width || row >= height)
        return fault_set(act->fault, ERR_INPUT, "pixel %u,%u is outside the picture of %ux%u",
                         column, row, width, height);
    if (of) /* by the picture that would be drawn now */
        TRY(slicing_cell_at(&cell, session, (enum slice_kind)(of - 1), &labels, column, row,
                            act->fault));
    cell = of ? cell : r->cell[(size_t)row * width + column];
    if (cell == CELL_NONE) {
        buf_printf(&act->reply->text, "pixel %u,%u shows %s\n", column, row,
                   of ? "no voxel" : "no object");
        act_write_waiting(act);
        return OK;
    }
    act_write_voxel(&act->reply->text, session, cell);
    if (cell_is_reached(session->scene->cell + cell))
        write_border_distance(&act->reply->text, session, cell);
    if (labels_at(&labels, cell) != session->scene->cell[cell].label) {
        buf_add_text(&act->reply->text, "finished: label ");
        label_report_write_name(&act->reply->text, session, labels_at(&labels, cell));
        buf_add_char(&act->reply->text, '\n');
    }
    act_write_waiting(act);
    return watch_fault(session->watch, act->fault);
}

enum { PROFILE_ROWS = 8, MARGIN = 9 };

/* ---- distances and angles ---- */

/* Offset between the centres of two voxels, in voxels and in millimetres. */
struct offset {
    double voxels[3], mm[3];
};

static struct offset offset_between(const struct session *session, const uint32_t from[3],
                                    const uint32_t to[3])
{
    struct offset offset;
    double a[3], b[3];
    geometry_point(&session->geometry, from, a);
    geometry_point(&session->geometry, to, b);
    for (int i = 0; i < 3; i++) {
        offset.voxels[i] = (double)to[i] - (double)from[i];
        offset.mm[i] = b[i] - a[i];
    }
    return offset;
}

static double product(const double u[3], const double v[3])
{
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

/* Add a line "25.50 mm, 17.00 voxels from 10,20,30 to 27,20,30"; in voxels only if their size is
 * unknown. */
static void write_distance(const struct act *act, const uint32_t from[3], const uint32_t to[3])
{
    struct buf *out = &act->reply->text;
    const struct offset offset = offset_between(act->session, from, to);
    if (!act->session->geometry.spacing_unknown)
        buf_printf(out, "%.2f mm, ", sqrt(product(offset.mm, offset.mm)));
    buf_printf(out, "%.2f voxels from %u,%u,%u to %u,%u,%u\n",
               sqrt(product(offset.voxels, offset.voxels)), from[0], from[1], from[2], to[0], to[1],
               to[2]);
}

/* Compute an angle in degrees; neither vector may be 0. */
static double angle_between(const double u[3], const double v[3])
{
    const double cross[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                             u[0] * v[1] - u[1] * v[0]};
    return atan2(sqrt(product(cross, cross)), product(u, v)) * 180 / 3.14159265358979323846;
}

enum err act_measure(const struct act *act)
{
    const uint32_t *other = act_place(act, "OTHER");
    write_distance(act, act_place(act, "PLACE"), other);
    if (!act_has(act, "THIRD"))
        return OK;
    write_distance(act, other, act_place(act, "THIRD"));
    const struct session *session = act->session;
    const struct offset a = offset_between(session, other, act_place(act, "PLACE"));
    const struct offset b = offset_between(session, other, act_place(act, "THIRD"));
    const bool measures = !session->geometry.spacing_unknown;
    if (product(a.voxels, a.voxels) == 0 || product(b.voxels, b.voxels) == 0)
        return fault_set(act->fault, ERR_INPUT,
                         "there is no angle at %u,%u,%u: expected two other voxels", other[0],
                         other[1], other[2]);
    buf_printf(&act->reply->text, "%.1f degrees at %u,%u,%u%s\n",
               measures ? angle_between(a.mm, b.mm) : angle_between(a.voxels, b.voxels), other[0],
               other[1], other[2], measures ? "" : ", as if voxels were cubes");
    return OK;
}

/* ---- profiles ---- */

struct profile {
    const struct session *session;
    const uint32_t *from, *to;
    int64_t steps;
    unsigned columns;
    double mean[CHART_COLUMNS]; /* column by column */
    char label[CHART_COLUMNS + 1];
    double least, most, sum; /* over all voxels */
};

static const struct cell *cell_at(const struct profile *p, int64_t step, uint32_t at[3])
{
    int64_t place[3];
    paint_step(place, p->from, p->to, step, p->steps);
    for (int a = 0; a < 3; a++)
        at[a] = (uint32_t)place[a];
    return p->session->scene->cell + grid_cell(&p->session->scene->grid, at[0], at[1], at[2]);
}

/* Average the voxels of a column, from count * c / columns on. */
static void take_column(struct profile *p, unsigned column)
{
    const int64_t count = p->steps + 1, first = count * column / p->columns;
    const int64_t end = count * (column + 1) / p->columns;
    double sum = 0;
    for (int64_t i = first; i < end; i++) {
        uint32_t at[3];
        const struct cell *cell = cell_at(p, i, at);
        const double value =
            levels_value(&p->session->geometry, p->session->levels, cell->intensity);
        sum += value;
        p->least = i == 0 || value < p->least ? value : p->least;
        p->most = i == 0 || value > p->most ? value : p->most;
        const uint32_t label = numbering_of(&p->session->now.kept, cell->label);
        p->label[column] = !cell_is_reached(cell) ? '.' : label > 9 ? '+' : (char)('0' + label);
    }
    p->sum += sum;
    p->mean[column] = sum / (double)(end - first);
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
    uint16_t eighths[CHART_COLUMNS];
    char top[16], bottom[16];
    const double wide = p.most > p.least ? p.most - p.least : 1;
    for (unsigned c = 0; c < p.columns; c++) /* the least value has height 1 */
        eighths[c] = (uint16_t)(1 + (p.mean[c] - p.least) / wide * (8 * PROFILE_ROWS - 1));
    snprintf(top, sizeof top, "%.6g", p.most);
    snprintf(bottom, sizeof bottom, "%.6g", p.least);
    chart_write(out, &(struct chart){eighths, p.columns, PROFILE_ROWS, top, bottom, MARGIN,
                                     act->interp->has_blocks});
    buf_printf(out, "%*slabels |%s\n", MARGIN - 6, "", p.label);
    buf_printf(out, "%lld voxel%s", (long long)p.steps + 1, plural((uint64_t)p.steps + 1));
    if (p.steps >= p.columns)
        buf_printf(out, ", %.2g in a column", (double)(p.steps + 1) / p.columns);
    const int digits = geometry_digits(&p.session->geometry);
    buf_add_text(out, "; values ");
    channel_write_in(out, p.session);
    buf_printf(out, "%.*g to %.*g, mean %.*g\n", digits, p.least, digits, p.most, digits,
               p.sum / (double)(p.steps + 1));
    levels_write_scale(out, p.session->levels, "");
    if (act_is_yes(act, "values")) {
        const bool measures = !p.session->geometry.spacing_unknown;
        for (int64_t i = 0; i <= p.steps; i++) {
            uint32_t at[3];
            const struct cell *cell = cell_at(&p, i, at);
            const struct offset offset = offset_between(p.session, p.from, at);
            buf_printf(out, "%8.2f %s  %u,%u,%u  ",
                       sqrt(measures ? product(offset.mm, offset.mm)
                                     : product(offset.voxels, offset.voxels)),
                       measures ? "mm" : "voxels", at[0], at[1], at[2]);
            levels_write(out, &p.session->geometry, p.session->levels, cell->intensity);
            buf_add_text(out, "  ");
            if (cell_is_reached(cell))
                label_report_write_name(out, p.session, cell->label);
            buf_add_text(out, cell_is_reached(cell) ? "\n" : "no seed reaches it\n");
        }
    }
    return OK;
}

/* ---- why a voxel has its label ---- */

enum { RISES_MOST = 8 }; /* number of rises of the cost listed by `why` */

/* Report the label that would own the voxel without the seeds of its own label. */
static enum err write_rival(const struct act *act, uint32_t at)
{
    const struct session *session = act->session;
    struct rival rival;
    TRY(rival_find(&rival, session->forest, at, act->fault));
    if (!rival.exists)
        return OK;
    buf_add_text(&act->reply->text, "next is label ");
    label_report_write_name(&act->reply->text, session, rival.label);
    if (rival.cost == key_cost(session->scene->cell[at].key))
        buf_add_text(&act->reply->text, ", at the same cost\n");
    else
        buf_printf(&act->reply->text, ", at a cost of %u\n", rival.cost);
    return OK;
}

/* Answer `why`: the path of a voxel to its seed, and the rises of the cost along it. */
enum err act_why(const struct act *act)
{
    const struct session *session = act->session;
    const uint32_t *p = act_place(act, "PLACE");
    const uint32_t place = grid_cell(&session->scene->grid, p[0], p[1], p[2]);
    const struct cell *cell = session->scene->cell + place;
    OWNED(way_release) struct way way = {0};
    act_write_voxel(&act->reply->text, session, place);
    act_write_refusal(&act->reply->text, session, place);
    if (!cell_is_reached(cell))
        return OK;
    buf_printf(&act->reply->text, "cost %u, %u step%s since it last rose\n", key_cost(cell->key),
               key_hops(cell->key), plural(key_hops(cell->key)));
    TRY(way_find(&way, session->forest, place, act->fault));
    size_t rises = 0;
    for (size_t i = 0; i + 1 < way.count && rises < RISES_MOST; i++) {
        const uint64_t key = session->scene->cell[way.cell[i]].key;
        const struct place rise = grid_place(&session->scene->grid, way.cell[i]);
        if (key_hops(key) > 0)
            continue;
        buf_printf(&act->reply->text, "    the cost rises to %u at %u,%u,%u%s\n", key_cost(key),
                   rise.x, rise.y, rise.z, rises++ == 0 ? ": its strongest edge" : "");
    }
    buf_printf(&act->reply->text, "%zu step%s from the seed in all\n", way.count - 1,
               plural(way.count - 1));
    return write_rival(act, place);
}

/* ---- the least certain places of the border ---- */

enum { LISTED = 10 }; /* default of COUNT */

/* Find the hints of the current forest. A skimming session computes it first, which only happens
 * for a journal edited by hand. */
static enum err find_hints(const struct act *act, const struct hint_list **hints)
{
    struct session *session = act->session;
    TRY(session_catch_up(session, act->fault));
    return session_find_hints(session, hints, NULL, act->fault);
}

/* ---- in words ---- */

/* Add "3 at 93,40,61: 812 voxels, 0.81 ml; label 1 brain at a cost of 12, label 0 at 12, an edge of
 * 2 between them; strongest edge into 90,41,60". */
static enum err write_hint(const struct act *act, const struct hint *hint, size_t number)
{
    const struct session *session = act->session;
    const unsigned cost = key_cost(session->scene->cell[hint->cell].key);
    const struct place p = grid_place(&session->scene->grid, hint->cell);
    struct buf *out = &act->reply->text;
    OWNED(way_release) struct way way = {0};
    TRY(way_find(&way, session->forest, hint->cell, act->fault));
    buf_printf(out, "%zu  at %u,%u,%u: %u voxel%s", number, p.x, p.y, p.z, hint->voxels,
               plural(hint->voxels));
    if (!session->geometry.spacing_unknown) {
        buf_add_text(out, ", ");
        tally_write_volume(out, &session->geometry, hint->voxels);
    }
    buf_add_text(out, "; label ");
    label_report_write_name(out, session, hint->label);
    buf_printf(out, " at a cost of %u, label ", cost);
    label_report_write_name(out, session, hint->other);
    buf_printf(out, " at %u, an edge of %u between them", cost + hint->margin, hint->edge);
    if (way.edge != CELL_NONE) {
        const struct place edge = grid_place(&session->scene->grid, way.edge);
        buf_printf(out, "; strongest edge into %u,%u,%u", edge.x, edge.y, edge.z);
    }
    buf_add_char(out, '\n');
    return OK;
}

/* ---- for programs ---- */

static enum err add_hint(struct json *json, const struct act *act, const struct hint *hint,
                         size_t number)
{
    const struct session *session = act->session;
    const struct kept *kept = &session->now.kept;
    const unsigned cost = key_cost(session->scene->cell[hint->cell].key);
    OWNED(way_release) struct way way = {0};
    const enum err err = way_find(&way, session->forest, hint->cell, act->fault);
    const struct place p = grid_place(&session->scene->grid, hint->cell);
    json_object(json, NULL);
    json_count(json, "number", number);
    json_format(json, "place", "%u,%u,%u", p.x, p.y, p.z);
    json_count(json, "voxels", hint->voxels);
    if (!session->geometry.spacing_unknown)
        json_real(json, "volume_mm3", hint->voxels * tally_voxel_mm3(&session->geometry), 9);
    json_count(json, "label", numbering_of(kept, hint->label));
    json_count(json, "cost", cost);
    json_count(json, "next_label", numbering_of(kept, hint->other));
    json_count(json, "next_cost", cost + hint->margin);
    json_count(json, "edge_between", hint->edge);
    json_fixed(json, "certainty", hint->certainty, 0);
    json_count(json, "doubt", hint->doubt);
    if (!err && way.edge != CELL_NONE) {
        const struct place edge = grid_place(&session->scene->grid, way.edge);
        json_format(json, "strongest_edge", "%u,%u,%u", edge.x, edge.y, edge.z);
    }
    json_end(json);
    return err;
}

static bool is_wanted(const struct act *act, const struct hint *hint)
{
    const struct value *label = act_value(act, "label");
    return !label->given || hint->label == label->number || hint->other == label->number;
}

/* Write all hints to the report. */
static enum err write_report(const struct act *act, const struct hint_list *hints)
{
    struct buf *text = act_buf(act);
    struct json json = {.out = text, .lines = 2};
    enum err err = OK;
    if (!act_has(act, "report"))
        return OK;
    json_object(&json, NULL);
    json_count(&json, "border_voxels", hints->border);
    json_count(&json, "weak_voxels", hints->weak);
    json_fixed(&json, "certainty_most", hints->limit, 0);
    json_array(&json, "hints");
    for (size_t i = 0; !err && i < hints->count; i++)
        if (is_wanted(act, hints->item + i))
            err = add_hint(&json, act, hints->item + i, i + 1);
    json_end(&json);
    json_end(&json);
    return err ? err : act_write_report(act, text);
}

/* ---- the commands ---- */

/* Add lines "1 coronal y=108: 1.2 ml in doubt, at 90,108,72". */
static enum err hint_slices(const struct act *act)
{
    struct session *session = act->session;
    struct buf *out = &act->reply->text;
    const unsigned label = (unsigned)act_number_or(act, "label", FINISH_ALL_LABELS);
    struct doubtful_slice slice[DOUBTFUL_MOST];
    struct labels labels;
    size_t count = 0;
    if (!label || act_has(act, "report"))
        return fault_set(act->fault, ERR_USAGE,
                         label ? "report: only for places, not for slices"
                               : "label: expected an object, not the background");
    TRY(session_catch_up(session, act->fault));
    TRY(session_labels(session, session_shows_finished(session), &labels, act->fault));
    TRY(doubtful_find(slice, &count, session, label, act->fault));
    for (size_t i = 0; i < count; i++) {
        uint32_t at[3] = {0};
        buf_printf(out, "%zu  ", i + 1);
        label_report_write_doubt(out, session, &slice[i]);
        if (doubtful_place(at, &labels, label, &slice[i]))
            buf_printf(out, ", at %u,%u,%u", at[0], at[1], at[2]);
        buf_add_char(out, '\n');
    }
    buf_add_text(out, count ? "`cross X,Y,Z` goes there; `outline` marks the object in that slice\n"
                            : "no slice: there is no border, or its place is certain\n");
    return OK;
}

enum err act_hints(const struct act *act)
{
    if (act_text(act, "COUNT"))
        return hint_slices(act);
    const size_t most = (size_t)act_number_or(act, "COUNT", LISTED);
    const char *report = act_text(act, "report");
    const struct hint_list *hints;
    struct buf *out = &act->reply->text;
    size_t wanted = 0;
    if (report && !file_is_named(report, ".json"))
        return fault_set(act->fault, ERR_USAGE,
                         "report: expected a name that ends in .json, not %s", report);
    TRY(find_hints(act, &hints));
    unsigned worst = 0;
    double share = 1;
    TRY(session_find_worst(act->session, &worst, &share, act->fault));
    if (worst && !act_has(act, "label")) {
        buf_add_text(out, "first label ");
        label_report_write_name(out, act->session, worst);
        buf_printf(out, ", which has %.0f %% of the procedure's volume\n", 100 * share);
    }
    TRY(write_report(act, hints));
    for (size_t i = 0; i < hints->count; i++) {
        if (!is_wanted(act, hints->item + i))
            continue;
        if (wanted++ < most)
            TRY(write_hint(act, hints->item + i, i + 1));
    }
    if (!wanted)
        buf_add_text(out, hints->count ? "none at the border of that label\n"
                                       : "no labels meet: there is no border to be uncertain of\n");
    else
        buf_printf(out, "%zu place%s in all; `hint N` leads to one\n", wanted, plural(wanted));
    return OK;
}

/* Record the resulting `cross`, so that a replay does not search again. */
enum err act_hint(const struct act *act)
{
    const size_t number = (size_t)act_number(act, "N");
    const struct hint_list *hints;
    TRY(find_hints(act, &hints));
    if (!hints->count)
        return fault_set(act->fault, ERR_INPUT,
                         "no labels meet: there is no border to be uncertain of; nothing has "
                         "changed");
    if (number > hints->count)
        return fault_set(act->fault, ERR_INPUT,
                         "N: expected one of the %zu places that `hints` lists, not %zu; nothing "
                         "has changed",
                         hints->count, number);
    const struct hint *hint = hints->item + number - 1;
    uint32_t *cross = act->next->outlook.slices.cross;
    TRY(write_hint(act, hint, number));
    act_write_waiting(act);
    grid_find(&act->session->scene->grid, hint->cell, cross);
    buf_clear(&act->reply->canonical);
    buf_printf(&act->reply->canonical, "cross %u,%u,%u", cross[0], cross[1], cross[2]);
    return act_go(act);
}
