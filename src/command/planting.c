/* SPDX-License-Identifier: MIT */
/* Commands that plant seeds: balls and strokes, shells, boxes, polygons, and objects by their
 * intensities. */
#include "command/act.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/choice.h"
#include "base/mem.h"
#include "base/scan.h"
#include "base/least.h"
#include "engine/components.h"
#include "engine/roi.h"
#include "image/levels.h"
#include "journal/record.h"
#include "show/label_report.h"
#include "session/between.h"
#include "session/markers.h"
#include "session/paint.h"

/* ---- seeds of a command ---- */

struct planting act_begin_planting(const struct session *session, const struct value *range)
{
    static const struct interval all = {0, UINT16_MAX, {-1, -1}};
    const bool is_given = range && range->given;
    const unsigned channel = is_given ? (unsigned)range->number : 0;
    return (struct planting){.within =
                                 is_given ? session_within(session, channel, range->real) : all,
                             .channel = channel};
}

/* Give the planting the reach that holds no voxel. */
static enum err make_exact(struct planting *planting, const struct act *act)
{
    static const struct reach none = {.unit = {1, 1, 1}, .radius = REACH_EXACT};
    return session_add_reach(act->session, &none, &planting->reach, act->fault);
}

enum err act_find_exact(struct planting *planting, const struct act *act)
{
    const struct value *within = act_value(act, "within");
    return within->given && within->number == 0 ? make_exact(planting, act) : OK;
}

static bool is_exact(const struct act *act, const struct planting *planting)
{
    return forest_is_exact(act->session->forest, planting->reach);
}

/* A shell cuts no object other than the enclosed ones. Letting shells cross other objects, with
 * trees refused by label, did not reduce the corrections in scenes of three and four objects. */
static bool is_of_another(const struct planting *planting, const struct cell *at, int16_t label)
{
    return planting->is_shell && at->label && at->label != label &&
           !label_set_has(&planting->encloses, at->label);
}

/* Move the cells that are allowed to the front, and return their number. */
static size_t keep_allowed(const struct act *act, struct planting *planting, uint32_t *cell,
                           size_t count, int16_t label)
{
    const struct cell *cells = act->session->scene->cell;
    struct task task = task_begin(act->session->watch, "seeds", count);
    size_t kept = 0;
    for (size_t i = 0; i < count && task_advance(&task, 1); i++) {
        const struct cell *at = cells + cell[i];
        const uint16_t intensity = scene_intensity(act->session->scene, planting->channel, cell[i]);
        planting->unsure += interval_splits(&planting->within, intensity);
        if (!interval_holds(&planting->within, intensity))
            planting->beyond++;
        else if (at->flags & CELL_OUTSIDE)
            planting->outside++;
        else if (is_of_another(planting, at, label))
            planting->others++;
        else
            cell[kept++] = cell[i];
    }
    return kept;
}

static enum err plant_cells(const struct act *act, struct planting *planting, const uint32_t *cell,
                            size_t count, int16_t label)
{
    struct session *session = act->session;
    if (!count)
        return OK;
    planting->planted += count;
    TRY(session_plant(session, cell, count, label, planting->reach, act->fault));
    if (planting->yields)
        TRY(session_yield(session, planting->run, planting->runs, act->fault));
    return is_exact(act, planting) ? session_free_voxels(session, cell, count, act->fault) : OK;
}

enum err act_plant(const struct act *act, struct planting *planting, uint32_t *cell, size_t count,
                   int16_t label)
{
    return plant_cells(act, planting, cell, keep_allowed(act, planting, cell, count, label), label);
}

static void write_left_out(struct buf *out, const char *why, size_t count)
{
    if (count)
        buf_printf(out, "left out, %s: %zu voxel%s\n", why, count, plural(count));
}

/* Warn at the first exact gesture among objects that were grown. */
static void warn_of_grown(const struct act *act)
{
    const struct session *session = act->session;
    const struct marker_kinds kinds = markers_kinds(&session->markers, session->former_markers);
    if (kinds.has_grown && !kinds.has_exact)
        buf_add_text(&act->reply->text,
                     "objects of this session were grown from seeds: voxels whose trees passed "
                     "through these can change too; `undo`, then `labels here` keeps them as they "
                     "are\n");
}

enum err act_write_planting(const struct act *act, const struct planting *planting)
{
    const struct kept *kept = &act->session->now.kept;
    if (!planting->planted && planting->outside)
        return fault_set(
            act->fault, ERR_INPUT,
            "all of it is outside the region of interest, where no tree grows; plant elsewhere, "
            "or widen the region with `mask` or `range` (`info` shows it); nothing was planted");
    if (!planting->planted && planting->beyond) {
        struct buf *where = act_buf(act);
        if (kept_channels(kept))
            buf_printf(where, " in channel %u", planting->channel + 1);
        return fault_set(act->fault, ERR_INPUT,
                         "range: no voxel of it has such an intensity%s (`why X,Y,Z` prints that "
                         "of one%s); nothing was planted",
                         buf_text(where), where->length ? ", in the channel that is shown" : "");
    }
    if (!planting->planted && planting->others)
        return fault_set(act->fault, ERR_INPUT,
                         "all of the shell is in objects other than the one inside, label %u; "
                         "around=LABEL names the object; nothing was planted",
                         numbering_of(kept, planting->inside));
    if (!planting->planted && planting->spared)
        return fault_set(act->fault, ERR_INPUT,
                         "over, keep: no voxel of it has a label that may change; nothing was "
                         "planted");
    if (is_exact(act, planting))
        warn_of_grown(act);
    write_left_out(&act->reply->text, "in another object", planting->others);
    write_left_out(&act->reply->text, "of labels that stay", planting->spared);
    write_left_out(&act->reply->text, "outside the region of interest", planting->outside);
    write_left_out(&act->reply->text, "intensities beyond the range", planting->beyond);
    act_write_unsure(act, planting->channel, planting->unsure);
    return OK;
}

void act_write_unsure(const struct act *act, unsigned channel, size_t voxels)
{
    struct geometry geometry;
    if (voxels)
        buf_printf(
            &act->reply->text,
            "%zu voxel%s a level that contains an end of the range: its width is %.3g, and values "
            "are known to half of it\n",
            voxels, voxels == 1 ? " has" : "s have",
            session_scale(&geometry, act->session, channel)->step);
}

void act_add_markers(const struct act *act)
{
    const struct session *session = act->session;
    struct buf *words = &act->reply->words;
    const size_t first = session->former_markers + 1, last = session->markers.count;
    if (last < first)
        return;
    buf_add_blank(words);
    buf_printf(words, "marker=%zu", first);
    if (last > first)
        buf_printf(words, "-%zu", last);
}

bool act_find_recorded(const struct act *act, const char *key, struct record_word *word)
{
    const char *recorded = act->interp->recorded_words;
    return act->session->skims && recorded && record_word_find(recorded, key, strlen(key), word);
}

/* ---- voxels that a gesture leaves alone ---- */

/* Runs in the word of a record; with more, nothing is recorded. */
enum { SPARED_MOST = 256 };

/* The runs of a record, "spared=1-7,12", by the order of the voxels from 1; "0" for none. */
struct spared_runs {
    const char *at, *end;
    int64_t first, last; /* the current one */
    bool fits;
};

static bool is_in_runs(struct spared_runs *runs, int64_t number, int64_t all)
{
    while (runs->fits && runs->last < number && runs->at < runs->end) {
        const int64_t before = runs->last;
        runs->fits = (!before || scan_text(&runs->at, ",")) &&
                     scan_range(&runs->at, 0, all, &runs->first, &runs->last) &&
                     (runs->first > before || (!runs->last && runs->at == runs->end));
    }
    return runs->fits && runs->first <= number && number <= runs->last;
}

/* Label of a voxel, of its seed if one waits for the next run. */
static uint8_t label_now(const struct session *session, uint32_t cell)
{
    const int16_t seed = markers_seed(&session->markers, cell);
    return seed == EDIT_ERASE ? session->scene->cell[cell].label : (uint8_t)seed;
}

/* Leave out voxels, and record their runs: voxels that are not among `grown`, or if that is NULL,
 * voxels whose label is not in the set. The voxels before `end[i]` stay before it, for each of
 * `ends`. */
static enum err leave_out(const struct act *act, struct planting *planting, struct voxels *voxels,
                          const struct label_set *takes, const struct voxels *grown, size_t *end,
                          size_t ends)
{
    struct session *session = act->session;
    const size_t all = voxels->count;
    struct record_word word = {0};
    struct buf *spared = act_buf(act);
    size_t kept = 0, count = 0, begin = 0, next = 0, e = 0;
    const bool is_recorded = act_find_recorded(act, "spared", &word);
    struct spared_runs runs = {word.value, word.value + word.value_length, 0, 0, true};
    TRY(is_recorded ? OK : session_catch_up(session, act->fault));
    for (size_t i = 0; i <= all; i++) {
        for (; e < ends && end[e] == i; e++)
            end[e] = kept;
        bool is_spared = false;
        if (i < all && is_recorded)
            is_spared = is_in_runs(&runs, (int64_t)i + 1, (int64_t)all);
        else if (i < all && grown)
            is_spared = next == grown->count || voxels->cell[i] != grown->cell[next];
        else if (i < all)
            is_spared = !label_set_has(takes, label_now(session, voxels->cell[i]));
        if (is_spared)
            continue;
        if (begin < i && count++ < SPARED_MOST)
            buf_printf(spared, begin + 1 < i ? "%s%zu-%zu" : "%s%zu", count > 1 ? "," : "",
                       begin + 1, i);
        begin = i + 1;
        next += grown != NULL;
        if (i < all)
            voxels->cell[kept++] = voxels->cell[i];
    }
    voxels->count = kept;
    planting->spared = all - kept;
    if (is_recorded && (!runs.fits || runs.at != runs.end))
        return fault_set(act->fault, ERR_CHECK, "spared: expected N,N-N");
    if (count <= SPARED_MOST) {
        buf_add_blank(&act->reply->words);
        buf_printf(&act->reply->words, "spared=%s", count ? buf_text(spared) : "0");
    }
    return OK;
}

enum err act_begin_exact(struct planting *planting, const struct act *act, struct voxels *voxels,
                         size_t *end, size_t ends)
{
    const struct label_set takes = call_takes(act->call);
    TRY(act_find_exact(planting, act));
    if (!act_has(act, "over|keep"))
        return OK;
    if (!is_exact(act, planting))
        return fault_set(act->fault, ERR_USAGE,
                         "over, keep: only with within=0, or for one ball of radius 1 or more or "
                         "with `within`; nothing was planted");
    TRY(session_run(act->session, act->fault));
    return leave_out(act, planting, voxels, &takes, NULL, end, ends);
}

/* Record the new markers, and report the voxels left out. */
static enum err end_planting(const struct act *act, const struct planting *planting)
{
    act_add_markers(act);
    return act_write_planting(act, planting);
}

/* Plant one marker on the voxels, and release them, before others are found around them. */
static enum err plant_all(const struct act *act, struct planting *planting, struct voxels *voxels,
                          int16_t label)
{
    const enum err err = act_plant(act, planting, voxels->cell, voxels->count, label);
    voxels_release(voxels);
    return err ? err : end_planting(act, planting);
}

/* ---- voxels freed by a gesture ---- */

/*
 * A gesture frees the pieces of a file around it (session/markers.h): up to its `within`, or three
 * times its radius around its middle. The radius of a box is half its thinnest side, that of a
 * polygon 0. The distance is at least FREES_LEAST voxels, at most FREES_MORE voxels beyond the
 * planted ones, and at most FREES_MOST in all; for a radius in millimetres a voxel is as long as
 * its shortest side. tests/bench/README.md has the figures.
 */
enum { FREES_TIMES = 3, FREES_LEAST = 2, FREES_MORE = 10, FREES_MOST = 160 };

/* Free voxels for the marker that the command has planted. */
static enum err free_voxels(const struct act *act, const struct voxels *voxels)
{
    struct session *session = act->session;
    return session->markers.count > session->former_markers
               ? session_free_voxels(session, voxels->cell, voxels->count, act->fault)
               : OK;
}

static int64_t shortest(const uint32_t unit[3])
{
    const uint32_t least = unit[0] < unit[1] ? unit[0] : unit[1];
    return least < unit[2] ? least : unit[2];
}

static int64_t freed_radius(int64_t radius, int64_t voxel)
{
    const int64_t times = FREES_TIMES * radius, least = FREES_LEAST * voxel,
                  most = radius + FREES_MORE * voxel;
    return times < least ? least : times > most ? most : times;
}

static const uint32_t ones[3] = {1, 1, 1};

/* Find the voxels of a ball at PLACE, or with `to`, of one at each step of the line. */
static enum err paint_way(struct voxels *voxels, const struct act *act, const struct value *to,
                          const uint32_t unit[3], int64_t radius, int most)
{
    const struct session *session = act->session;
    const bool goes_on = to && to->given;
    const uint32_t(*corner)[3] =
        (const uint32_t(*)[3])(goes_on ? to->line->corner[0] : act_place(act, "PLACE"));
    OWNED(brush_release) struct brush brush = {0};
    TRY(brush_init(&brush, unit, radius, most, act->fault));
    return paint_stroke(voxels, &session->scene->grid, &brush, corner,
                        goes_on ? to->line->count : 1, session->watch, act->fault);
}

/* Find the balls at each step of a way in which a gesture frees voxels. */
static enum err find_around_way(struct voxels *voxels, const struct act *act)
{
    const struct value *radius = act_value(act, "radius"), *within = act_value(act, "within");
    const bool in_mm = within->given ? within->in_mm : radius->in_mm;
    const uint32_t *unit = in_mm ? act->session->scene->spacing_nm : ones;
    const int64_t freed =
        within->given ? within->number : freed_radius(radius->number, shortest(unit));
    const int64_t most = FREES_MOST * shortest(unit);
    return paint_way(voxels, act, act_value(act, "to"), unit, freed < most ? freed : most,
                     FREES_MOST);
}

static enum err free_around_way(const struct act *act)
{
    OWNED(voxels_release) struct voxels voxels = {0};
    if (!act->session->markers.yields)
        return OK;
    TRY(find_around_way(&voxels, act));
    return free_voxels(act, &voxels);
}

static enum err free_around_box(const struct act *act)
{
    const uint32_t *corner = act_place(act, "CORNER"), *opposite = act_place(act, "OPPOSITE");
    const struct session *session = act->session;
    const struct grid *grid = &session->scene->grid;
    uint32_t first[3], last[3], thin = UINT32_MAX;
    OWNED(voxels_release) struct voxels voxels = {0};
    if (!session->markers.yields)
        return OK;
    for (int a = 0; a < 3; a++) {
        first[a] = corner[a] < opposite[a] ? corner[a] : opposite[a];
        last[a] = corner[a] < opposite[a] ? opposite[a] : corner[a];
        thin = last[a] - first[a] < thin ? last[a] - first[a] : thin;
    }
    const uint32_t more = (uint32_t)freed_radius(thin / 2, 1) - thin / 2;
    for (int a = 0; a < 3; a++) {
        first[a] = first[a] > more ? first[a] - more : 0;
        last[a] = last[a] + more < grid->size[a] ? last[a] + more : grid->size[a] - 1;
    }
    TRY(paint_box(&voxels, grid, first, last, false, session->watch, act->fault));
    return free_voxels(act, &voxels);
}

/* Add the balls around the voxels first..last of a row. */
static enum err add_around(struct voxels *out, const struct act *act, const struct brush *brush,
                           uint32_t first, uint32_t last)
{
    const struct grid *grid = &act->session->scene->grid;
    const struct place a = grid_place(grid, first), b = grid_place(grid, last);
    const uint32_t corner[2][3] = {{a.x, a.y, a.z}, {b.x, b.y, b.z}};
    OWNED(voxels_release) struct voxels around = {0};
    TRY(paint_stroke(&around, grid, brush, corner, 2, act->session->watch, act->fault));
    if (!mem_grow(&out->cell, &out->capacity, out->count + around.count, sizeof *out->cell))
        return fault_memory(act->fault, "seeds");
    for (size_t i = 0; i < around.count; i++)
        out->cell[out->count++] = around.cell[i];
    return OK;
}

/* Plant one marker on voxels in a slice, and free their neighbourhood. */
static enum err plant_in_slice(const struct act *act, struct planting *planting,
                               const struct voxels *voxels, int16_t label)
{
    OWNED(brush_release) struct brush brush = {0};
    OWNED(voxels_release) struct voxels around = {0};
    if (act->session->markers.yields && !is_exact(act, planting))
        TRY(brush_init(&brush, ones, FREES_LEAST, BRUSH_REACH_MOST, act->fault));
    for (size_t i = 0, next; brush.rows && i < voxels->count; i = next) {
        for (next = i + 1;
             next < voxels->count && voxels->cell[next] == voxels->cell[next - 1] + 1;)
            next++;
        TRY(add_around(&around, act, &brush, voxels->cell[i], voxels->cell[next - 1]));
    }
    TRY(act_plant(act, planting, voxels->cell, voxels->count, label));
    if (planting->planted && around.count)
        TRY(session_free_voxels(act->session, around.cell, around.count, act->fault));
    return OK;
}

/* ---- balls and strokes ---- */

/* Find the unit of a distance: voxels, or nanometres of their spacing. */
static enum err find_unit(const uint32_t **unit, const struct act *act, const char *name,
                          const struct value *distance)
{
    const struct session *session = act->session;
    *unit = distance->in_mm ? session->scene->spacing_nm : ones;
    return !distance->in_mm || !session->geometry.spacing_unknown
               ? OK
               : fault_set(act->fault, ERR_INPUT,
                           "%s: voxel size is unknown; expected a "
                           "number of voxels, not millimetres; nothing has changed",
                           name);
}

enum err act_find_voxels(const struct act *act, const struct value *to, struct voxels *voxels)
{
    const struct value *radius = act_value(act, "radius");
    const uint32_t *unit;
    TRY(find_unit(&unit, act, "radius", radius));
    return paint_way(voxels, act, to, unit, radius->number, BRUSH_REACH_MOST);
}

/* True if the last command has planted a marker of this label, and no other one. */
static bool can_join(const struct act *act)
{
    const int64_t label = act_number(act, "LABEL");
    const struct history *history = &act->interp->history;
    const struct point *point = history->point + history->present;
    const struct markers *markers = &act->session->markers;
    return point->plants && markers->count > 0 && markers->marker[markers->count - 1].is_valid &&
           markers->marker[markers->count - 1].label == label;
}

/* ---- shells ---- */

/* A ball, or a box between two corners. */
struct body {
    struct reach ball;                 /* its centre is the middle of the box too */
    const uint32_t *corner, *opposite; /* NULL for a ball */
};

static bool body_holds(const struct body *body, struct place p)
{
    const uint32_t at[3] = {p.x, p.y, p.z};
    bool holds = true;
    if (!body->corner)
        return reach_holds(&body->ball, p.x, p.y, p.z);
    for (int a = 0; a < 3; a++)
        holds &= (at[a] >= body->corner[a] || at[a] >= body->opposite[a]) &&
                 (at[a] <= body->corner[a] || at[a] <= body->opposite[a]);
    return holds;
}

/* Find the objects of other labels whose seeds are all in the body and not in its shell: a shell
 * that was planted before these seeds would have the same voxels. */
static bool find_enclosed(struct planting *planting, const struct act *act, const struct body *body,
                          const struct voxels *shell, int16_t label)
{
    const struct markers *markers = &act->session->markers;
    struct label_set inside = {{0}}, outside = {{0}};
    bool has_one = false;
    for (size_t i = 0; i < shell->count; i++) {
        const int16_t seed = markers_seed(markers, shell->cell[i]);
        if (seed != EDIT_ERASE)
            label_set_add(&outside, (uint8_t)seed);
    }
    for (size_t m = 0; m < markers->count; m++) {
        const struct marker *marker = &markers->marker[m];
        const uint8_t object = (uint8_t)marker->label;
        if (!marker->is_valid || marker->label <= 0 || marker->label == label)
            continue;
        if (m < markers->former)
            label_set_add(&outside, object);
        for (size_t i = 0; i < marker->voxels && !label_set_has(&outside, object); i++) {
            const uint32_t cell = markers->cover[marker->first + i].cell;
            const struct place place = grid_place(&act->session->scene->grid, cell);
            if (markers_at(markers, cell) == m + 1)
                label_set_add(body_holds(body, place) ? &inside : &outside, object);
        }
    }
    for (int i = 0; i < 4; i++) {
        planting->encloses.word[i] = inside.word[i] & ~outside.word[i];
        has_one |= planting->encloses.word[i] != 0;
    }
    return has_one;
}

/* Plant a shell around the object `around`, by default the one in its middle, and around objects
 * that are planted only inside. */
static enum err plant_shell(const struct act *act, struct voxels *voxels, const struct body *body)
{
    const int16_t label = (int16_t)act_number(act, "LABEL");
    const struct scene *scene = act->session->scene;
    const uint32_t *p = body->ball.centre;
    struct planting planting = act_begin_planting(act->session, act_value(act, "range"));
    TRY(session_catch_up(act->session, act->fault));
    const struct cell *middle = &scene->cell[grid_cell(&scene->grid, p[0], p[1], p[2])];
    const uint8_t inside = middle->label;
    const bool is_reached = cell_is_reached(middle);
    const bool encloses = find_enclosed(&planting, act, body, voxels, label);
    TRY(act_begin_exact(&planting, act, voxels, NULL, 0));
    planting.is_shell = true;
    planting.inside = (uint8_t)act_number_or(act, "around", inside);
    label_set_add(&planting.encloses, planting.inside);
    if (!voxels->count)
        return fault_set(act->fault, ERR_INPUT,
                         "shell: no voxel of it is in the scene; nothing was planted");
    if (planting.inside == label && (act_has(act, "around") || (is_reached && !encloses)))
        return fault_set(act->fault, ERR_INPUT,
                         "shell: label %u is also the label of the object inside; expected the "
                         "label of the surroundings, or around=LABEL for another object; nothing "
                         "was planted",
                         numbering_of(&act->session->now.kept, planting.inside));
    return plant_all(act, &planting, voxels, label);
}

static enum err refuse_shell(const struct act *act, const char *why)
{
    return fault_set(act->fault, ERR_USAGE, "shell: %s; nothing was planted", why);
}

/* Compute the radius of the ball through the voxel `through`: in millimetres, or in voxels if their
 * size is unknown; rounded up, so that the voxel is inside. */
static enum err find_radius(struct value *radius, const struct act *act)
{
    const uint32_t *middle = act_place(act, "PLACE"), *through = act_place(act, "through");
    static const int64_t most_nm = 1000000000;
    const struct scene *scene = act->session->scene;
    uint64_t sum = 0;
    radius->in_mm = !scene->spacing_unknown;
    for (int a = 0; a < 3; a++) {
        const int64_t voxels = llabs((int64_t)through[a] - middle[a]);
        const int64_t way = voxels * (radius->in_mm ? scene->spacing_nm[a] : 1);
        if (way > most_nm)
            return refuse_shell(act, "the voxel `through` is more than a metre away");
        sum += (uint64_t)(way * way);
    }
    radius->number = square_root(sum);
    radius->number += (uint64_t)(radius->number * radius->number) < sum;
    return OK;
}

static enum err plant_hollow_ball(const struct act *act)
{
    const struct session *session = act->session;
    const uint32_t *middle = act_place(act, "PLACE");
    const bool is_through = act_has(act, "through");
    struct value radius = *act_value(act, "radius");
    struct body body = {.corner = NULL};
    OWNED(voxels_release) struct voxels voxels = {0};
    OWNED(brush_release) struct brush brush = {0};
    const uint32_t *unit;
    if (radius.given && is_through)
        return refuse_shell(act, "`radius` or `through`, not both");
    TRY(is_through ? find_radius(&radius, act) : OK);
    if (radius.number == 0)
        return refuse_shell(act, "a ball of radius 0 has nothing inside; give a radius");
    TRY(find_unit(&unit, act, "radius", &radius));
    TRY(brush_init(&brush, unit, radius.number, BRUSH_HOLLOW_REACH_MOST, act->fault));
    TRY(brush_hollow(&brush, session->now.kept.adjacency, act->fault));
    TRY(paint_shell(&voxels, &session->scene->grid, &brush, middle, session->watch, act->fault));
    body.ball.radius = radius.number;
    memcpy(body.ball.centre, middle, sizeof body.ball.centre);
    memcpy(body.ball.unit, unit, sizeof body.ball.unit);
    return plant_shell(act, &voxels, &body);
}

static enum err plant_hollow_box(const struct act *act)
{
    const uint32_t *corner = act_place(act, "CORNER"), *opposite = act_place(act, "OPPOSITE");
    OWNED(voxels_release) struct voxels voxels = {0};
    struct body body = {.corner = corner, .opposite = opposite};
    uint32_t *middle = body.ball.centre;
    for (int a = 0; a < 3; a++) {
        middle[a] = (corner[a] + opposite[a]) / 2;
        if (middle[a] == corner[a] || middle[a] == opposite[a])
            return refuse_shell(act, "a box less than 3 voxels thick has nothing inside");
    }
    TRY(paint_box(&voxels, &act->session->scene->grid, corner, opposite, true, act->session->watch,
                  act->fault));
    return plant_shell(act, &voxels, &body);
}

/* ---- `seed` ---- */

/* Find the number of the reach of a ball's seeds, if not NULL; all of them must be inside. */
static enum err find_reach(uint16_t *number, const struct act *act, const struct voxels *voxels)
{
    struct session *session = act->session;
    const struct value *within = act_value(act, "within");
    const uint32_t *unit;
    struct reach reach = {.radius = within->number};
    TRY(find_unit(&unit, act, "within", within));
    for (int a = 0; a < 3; a++) {
        reach.centre[a] = act_place(act, "PLACE")[a];
        reach.unit[a] = unit[a];
    }
    for (size_t i = 0; i < voxels->count; i++) {
        const struct place p = grid_place(&session->scene->grid, voxels->cell[i]);
        if (!reach_holds(&reach, p.x, p.y, p.z))
            return fault_set(act->fault, ERR_USAGE,
                             "within: less than the radius; expected at least the radius; "
                             "nothing was planted");
    }
    return number ? session_add_reach(session, &reach, number, act->fault) : OK;
}

/* Plant a ball, and the voxels that its tree changes of the labels allowed by `over` and `keep`, as
 * two exact markers; the second one yields to later growth. */
static enum err plant_confined(const struct act *act, struct planting *planting,
                               struct voxels *seeds)
{
    const int16_t label = (int16_t)act_number(act, "LABEL");
    const struct label_set takes = call_takes(act->call);
    struct session *session = act->session;
    OWNED(voxels_release) struct voxels around = {0}, grown = {0};
    struct record_word word;
    size_t taken = 0, others = 0;
    TRY(session_run(session, act->fault));
    seeds->count = keep_allowed(act, planting, seeds->cell, seeds->count, label);
    TRY(find_around_way(&around, act));
    if (!act_find_recorded(act, "spared", &word)) {
        TRY(session_catch_up(session, act->fault));
        TRY(session_grow_confined(session, &takes, label, seeds, &around, &grown, act->fault));
    }
    TRY(leave_out(act, planting, &around, NULL, &grown, NULL, 0));
    TRY(make_exact(planting, act));
    for (size_t i = 0, next = 0; i < around.count; i++) {
        for (; next < seeds->count && seeds->cell[next] < around.cell[i]; next++)
            ;
        if (next < seeds->count && seeds->cell[next] == around.cell[i])
            seeds->cell[taken++] = around.cell[i];
        else
            around.cell[others++] = around.cell[i];
    }
    planting->spared = seeds->count - taken;
    TRY(plant_cells(act, planting, seeds->cell, taken, label));
    if (taken && others) {
        planting->yields = true;
        TRY(plant_cells(act, planting, around.cell, others, label));
        session_join(session);
        buf_printf(&act->reply->text, "grown: %zu voxel%s\n", others, plural(others));
    }
    return end_planting(act, planting);
}

enum err act_seed(const struct act *act)
{
    const bool is_shell = act_is_yes(act, "shell");
    struct planting planting = act_begin_planting(act->session, act_value(act, "range"));
    OWNED(voxels_release) struct voxels voxels = {0};
    const bool is_confined = act_number(act, "within") > 0;
    if (is_confined && (is_shell || act_has(act, "to|joined")))
        return fault_set(act->fault, ERR_USAGE,
                         "within: above 0 only for one ball, not for strokes and shells; nothing "
                         "was planted");
    if (is_shell && act_has(act, "to|joined"))
        return refuse_shell(act, "only for one ball, not for strokes");
    if (act_has(act, "around|through") && !is_shell)
        return fault_set(act->fault, ERR_USAGE, "%s: only with shell=yes; nothing was planted",
                         call_given(act->call, "around|through"));
    if (is_shell)
        return plant_hollow_ball(act);
    if (act_has(act, "joined") && !can_join(act))
        return fault_set(act->fault, ERR_USAGE,
                         "joined: the previous command did not plant seeds of label %u; nothing "
                         "was planted",
                         act_place(act, "LABEL")[0]);
    const bool is_ball = !act_has(act, "to|joined") && act_number(act, "radius") > 0;
    const bool grows =
        act_has(act, "over|keep") && (is_confined || (is_ball && !act_has(act, "within")));
    TRY(act_find_voxels(act, act_value(act, "to"), &voxels));
    if (is_confined)
        TRY(find_reach(grows ? NULL : &planting.reach, act, &voxels));
    if (!is_confined && !grows)
        TRY(act_begin_exact(&planting, act, &voxels, NULL, 0));
    if (grows)
        TRY(plant_confined(act, &planting, &voxels));
    else
        TRY(plant_all(act, &planting, &voxels, (int16_t)act_number(act, "LABEL")));
    if (act_has(act, "joined"))
        session_join(act->session);
    return is_exact(act, &planting) ? OK : free_around_way(act);
}

/* ---- `box` ---- */

enum err act_box(const struct act *act)
{
    struct planting planting = act_begin_planting(act->session, act_value(act, "range"));
    OWNED(voxels_release) struct voxels voxels = {0};
    if (act_has(act, "around") && !act_is_yes(act, "shell"))
        return fault_set(act->fault, ERR_USAGE, "around: only with shell=yes; nothing was planted");
    if (act_is_yes(act, "shell"))
        return plant_hollow_box(act);
    TRY(paint_box(&voxels, &act->session->scene->grid, act_place(act, "CORNER"),
                  act_place(act, "OPPOSITE"), false, act->session->watch, act->fault));
    TRY(act_begin_exact(&planting, act, &voxels, NULL, 0));
    TRY(plant_all(act, &planting, &voxels, (int16_t)act_number(act, "LABEL")));
    return is_exact(act, &planting) ? OK : free_around_box(act);
}

/* ---- `fill`, `outline` ---- */

enum { OUTLINE_RING = 3 }; /* as good as the whole outside in the effort benchmark */

/* Add a ring of background to the marker of the inside, without voxels of other objects, by their
 * seeds or the last run: their own seeds hold the label back, and a ring of background would cut
 * into them. */
static enum err plant_ring(const struct act *act, struct voxels *ring, int16_t label,
                           size_t *others)
{
    struct planting planting = act_begin_planting(act->session, NULL);
    const struct markers *markers = &act->session->markers;
    struct label_set takes = {{1}};
    bool has_another = false;
    for (size_t m = 0; m < markers->count; m++)
        has_another |= markers->marker[m].label > 0 && markers->marker[m].label != label;
    label_set_add(&takes, (uint8_t)label);
    TRY(has_another ? leave_out(act, &planting, ring, &takes, NULL, NULL, 0) : OK);
    *others = planting.spared;
    TRY(act_find_exact(&planting, act));
    TRY(plant_in_slice(act, &planting, ring, 0));
    if (planting.planted)
        session_join(act->session);
    return OK;
}

static enum err plant_polygon(const struct act *act, int ring)
{
    const struct grid *grid = &act->session->scene->grid;
    const struct polyline *line = act_value(act, "to")->line;
    const int16_t label = (int16_t)act_number(act, "LABEL");
    struct planting planting = act_begin_planting(act->session, act_value(act, "range"));
    struct watch *watch = act->session->watch;
    OWNED(voxels_release) struct voxels inside = {0}, around = {0};
    if (!line || line->count < 3)
        return fault_set(act->fault, ERR_USAGE,
                         "a polygon has three corners or more, not all on one line (`box` "
                         "fills a rectangle); nothing was planted");
    const uint32_t(*corner)[3] = (const uint32_t(*)[3])line->corner;
    TRY(paint_polygon(&inside, grid, corner, line->count, watch, act->fault));
    if (ring)
        TRY(paint_ring(&around, grid, &inside, corner, line->count, ring, watch, act->fault));
    TRY(act_begin_exact(&planting, act, &inside, NULL, 0));
    TRY(plant_in_slice(act, &planting, &inside, label));
    if (planting.planted && ring)
        TRY(plant_ring(act, &around, label, &planting.others));
    return end_planting(act, &planting);
}

enum err act_fill(const struct act *act)
{
    return plant_polygon(act, 0);
}

/* Remove the marker `instead`, given by any of its parts. */
static enum err remove_former(const struct act *act)
{
    const struct markers *markers = &act->session->markers;
    const int64_t number = act_number(act, "instead");
    const uint32_t first =
        number <= (int64_t)markers->count ? markers_stroke(markers, (uint32_t)number) : 0;
    const enum err err = session_remove_markers(act->session, &first, 1, act->fault);
    if (err == ERR_CHECK)
        return fault_set(
            act->fault, ERR_INPUT,
            "instead: there is no marker %lld; expected the number of one, as in `marker=` "
            "of its record; nothing has changed",
            (long long)number);
    buf_printf(&act->reply->words, "removed=%u", first);
    return err;
}

enum err act_outline(const struct act *act)
{
    const bool is_object = act_number(act, "LABEL") != 0;
    const int64_t ring =
        act_number_or(act, "ring", is_object && !act_has(act, "within") ? OUTLINE_RING : 0);
    if (ring && (!is_object || act_has(act, "over|keep")))
        return fault_set(act->fault, ERR_USAGE,
                         "ring: a ring of background is only for objects, without `over` and "
                         "`keep`; nothing was planted");
    TRY(act_has(act, "instead") ? remove_former(act) : OK);
    return plant_polygon(act, (int)ring);
}

/* ---- `between` ---- */

static enum err refuse_between(const struct act *act, const char *why, const char *other)
{
    struct buf *name = act_buf(act);
    label_report_write_name(name, act->session, (unsigned)act_number(act, "LABEL"));
    return fault_set(act->fault, ERR_INPUT, "between: label %s %s%s; nothing was planted",
                     buf_text(name), why, other);
}

/* Find the axis at right angles to the outlines. */
static enum err find_outlines(int *axis, const struct act *act)
{
    const struct session *session = act->session;
    const struct scene *scene = session->scene;
    struct buf *planes = act_buf(act);
    unsigned axes;
    TRY(between_find(&axes, NULL, &session->markers, &scene->grid,
                     (int16_t)act_number(act, "LABEL"), 0, session->watch, act->fault));
    if (act_has(act, "plane"))
        axes &= 1u << slice_axis(scene, (enum slice_plane)act_number(act, "plane"));
    *axis = axes ? __builtin_ctz(axes) : 0;
    for (unsigned plane = SLICE_AXIAL; plane <= SLICE_SAGITTAL; plane++) {
        const struct choice word = choice_at(SLICE_WORDS, plane);
        if (axes >> slice_axis(scene, (enum slice_plane)plane) & 1)
            buf_printf(planes, "%s%.*s", planes->length ? "|" : "", (int)word.length, word.word);
    }
    if (!axes)
        return refuse_between(act,
                              act_has(act, "plane")
                                  ? "has no exact outlines in slices of this plane"
                                  : "has no exact outlines",
                              "; draw them by `outline ... within=0` in slices of one plane");
    return axes == 1u << *axis
               ? OK
               : refuse_between(
                     act, "has outlines in several planes; expected plane=", buf_text(planes));
}

/* Collect the filled voxels of a map. */
static enum err collect_filled(struct voxels *out, const struct act *act, const uint8_t *map,
                               size_t count)
{
    struct grid_walk walk = scene_walk(act->session->scene, "slices", NULL, 0);
    out->cell = mem_array(count, sizeof *out->cell);
    if (!out->cell)
        return fault_memory(act->fault, "seeds");
    while (grid_walk_next(&walk))
        for (uint32_t c = walk.row.first; c < walk.row.end; c++)
            if (map[c] == BETWEEN_FILLED)
                out->cell[out->count++] = c;
    return watch_fault(act->session->watch, act->fault);
}

static enum err find_between(struct voxels *out, struct between_tally *tally, const struct act *act,
                             int axis)
{
    struct session *session = act->session;
    const struct scene *scene = session->scene;
    OWNED(mem_release) uint8_t *map = mem_array(scene->grid.cells, 1);
    unsigned axes;
    if (!map)
        return fault_memory(act->fault, "outlines");
    memset(map, 0, scene->grid.cells);
    TRY(between_find(&axes, map, &session->markers, &scene->grid, (int16_t)act_number(act, "LABEL"),
                     axis, session->watch, act->fault));
    TRY(between_fill(map, tally, &scene->grid, scene->spacing_nm, axis, session->team,
                     session->watch, act->fault));
    TRY(collect_filled(out, act, map, tally->voxels));
    if (tally->sections < 2)
        return refuse_between(act, "has exact outlines in one slice alone",
                              "; outline it in another slice too");
    return tally->voxels ? OK : refuse_between(act, "has no voxels between its outlines", "");
}

enum err act_between(const struct act *act)
{
    const struct scene *scene = act->session->scene;
    struct planting planting = act_begin_planting(act->session, NULL);
    struct label_set takes = {{1}}; /* over=0 */
    struct between_tally tally;
    OWNED(voxels_release) struct voxels voxels = {0};
    uint32_t from[3] = {0}, to[3] = {0};
    int axis;
    if (act_has(act, "over|keep"))
        takes = call_takes(act->call);
    else
        buf_add_text(&act->reply->canonical, " over=0");
    TRY(find_outlines(&axis, act));
    TRY(find_between(&voxels, &tally, act, axis));
    TRY(session_run(act->session, act->fault));
    TRY(make_exact(&planting, act));
    TRY(leave_out(act, &planting, &voxels, &takes, NULL, NULL, 0));
    TRY(plant_all(act, &planting, &voxels, (int16_t)act_number(act, "LABEL")));
    enum slice_plane plane = SLICE_AXIAL;
    while (slice_axis(scene, plane) != axis)
        plane++;
    from[axis] = tally.first;
    to[axis] = tally.last;
    buf_printf(&act->reply->text,
               "%zu voxel%s planted in %u slice%s between %u outlines, %s %u to %u\n",
               planting.planted, plural(planting.planted), tally.slices, plural(tally.slices),
               tally.sections, slice_name(scene, plane), slice_index(scene, plane, from),
               slice_index(scene, plane, to));
    return OK;
}

/* ---- `object`: components within a range that contain a seed ---- */

/* The search: voxels that may belong to the object, and their components. */
struct search {
    const struct act *act;
    int16_t label;
    struct planting planting;
    size_t unsure; /* voxels of levels that contain an end of the range */
    uint8_t *may;  /* [grid.cells], 0 or 1 */
    struct components found;
    bool *is_taken; /* by component */
    struct voxels voxels;
};

/* True in the range, in the region of interest, and without a seed of another label. */
static bool may_belong(const struct search *s, uint32_t cell)
{
    const struct cell *at = s->act->session->scene->cell + cell;
    const uint16_t is = scene_intensity(s->act->session->scene, s->planting.channel, cell);
    if (!interval_holds(&s->planting.within, is) || at->flags & CELL_OUTSIDE)
        return false;
    const int16_t seed = markers_seed(&s->act->session->markers, cell);
    return seed == EDIT_ERASE || seed == s->label;
}

static enum err find_pieces(struct search *s)
{
    const struct session *session = s->act->session;
    const struct grid *grid = &session->scene->grid;
    struct grid_walk walk = scene_walk(session->scene, "voxels in the range", NULL, 0);
    memset(s->may, 0, grid->cells);
    while (grid_walk_next(&walk))
        for (uint32_t c = walk.row.first; c < walk.row.end; c++) {
            s->may[c] = may_belong(s, c);
            s->unsure += interval_splits(&s->planting.within,
                                         scene_intensity(session->scene, s->planting.channel, c));
        }
    TRY(watch_fault(session->watch, s->act->fault));
    return components_find(&s->found, grid, s->may, session->watch, s->act->fault);
}

static bool begins_in(const struct search *s, const struct component_run *run)
{
    const struct value *from = act_value(s->act, "from");
    const struct grid *grid = &s->act->session->scene->grid;
    if (from->given) {
        const uint32_t cell = grid_cell(grid, from->place[0], from->place[1], from->place[2]);
        return run->first <= cell && cell < run->end;
    }
    for (uint32_t c = run->first; c < run->end; c++)
        if (markers_seed(&s->act->session->markers, c) == s->label)
            return true;
    return false;
}

static enum err collect_voxels(struct search *s)
{
    size_t voxels = 0;
    for (size_t i = 0; i < s->found.runs; i++) {
        const struct component_run *run = s->found.run + i;
        bool *is_taken = &s->is_taken[run->component];
        if (s->found.item[run->component].label && !*is_taken && begins_in(s, run)) {
            *is_taken = true;
            voxels += s->found.item[run->component].voxels;
        }
    }
    s->voxels.cell = mem_array(voxels, sizeof *s->voxels.cell);
    if (voxels && !s->voxels.cell)
        return fault_memory(s->act->fault, "an object");
    for (size_t i = 0; i < s->found.runs; i++) {
        const struct component_run *run = s->found.run + i;
        for (uint32_t c = run->first; s->is_taken[run->component] && c < run->end; c++)
            s->voxels.cell[s->voxels.count++] = c;
    }
    return OK;
}

/* Report why the voxel `from` does not belong to the object. */
static enum err refuse_place(const struct search *s)
{
    const struct session *session = s->act->session;
    const uint32_t *place = act_place(s->act, "from");
    const uint32_t cell = grid_cell(&session->scene->grid, place[0], place[1], place[2]);
    const struct cell *at = session->scene->cell + cell;
    struct buf *why = act_buf(s->act);
    const uint16_t is = scene_intensity(session->scene, s->planting.channel, cell);
    struct geometry geometry = session->geometry;
    const struct levels *levels = session_scale(&geometry, session, s->planting.channel);
    if (!interval_holds(&s->planting.within, is)) {
        buf_add_text(why, "the intensity ");
        levels_write(why, &geometry, levels, is);
        buf_add_text(why, ", beyond the range");
    } else {
        buf_add_text(why, at->flags & CELL_OUTSIDE ? "no part in the region of interest"
                                                   : "a seed of another label");
    }
    return fault_set(s->act->fault, ERR_INPUT, "from: voxel %u,%u,%u has %s; nothing was planted",
                     place[0], place[1], place[2], buf_text(why));
}

/* Warn if no other label has a seed: only trees of another label end an object. */
static void warn_of_no_other(const struct search *s)
{
    const struct session *session = s->act->session;
    const struct markers *markers = &session->markers;
    struct buf *out = &s->act->reply->text;
    for (size_t i = 0; i < markers->count; i++)
        if (markers->marker[i].is_valid && markers->marker[i].label != EDIT_ERASE &&
            markers->marker[i].label != s->label)
            return;
    buf_add_text(out, "no other label has a seed: nothing holds label ");
    label_report_write_name(out, session, (unsigned)s->label);
    buf_printf(out,
               " back, and a run grows it over all of the %s\nthat its trees reach; seeds of the "
               "background hold it, as `seed X,Y,Z 0`, or a shell or a box around it\n",
               roi_is_none(&session->roi) ? "scene" : "region of interest");
}

static enum err plant_object(struct search *s)
{
    const struct act *act = s->act;
    if (!s->voxels.count)
        return act_has(act, "from")
                   ? refuse_place(s)
                   : fault_set(act->fault, ERR_INPUT,
                               "no seed of label %u is in a voxel of this range; plant one there, "
                               "or name one by from=X,Y,Z (see `why X,Y,Z`); nothing was planted",
                               act_place(act, "LABEL")[0]);
    TRY(act_begin_exact(&s->planting, act, &s->voxels, NULL, 0));
    TRY(act_plant(act, &s->planting, s->voxels.cell, s->voxels.count, s->label));
    s->planting.unsure = 0; /* s->unsure counts them */
    TRY(act_write_planting(act, &s->planting));
    buf_printf(&act->reply->text, "%zu voxel%s of label ", s->planting.planted,
               plural(s->planting.planted));
    label_report_write_name(&act->reply->text, act->session, (unsigned)s->label);
    buf_add_char(&act->reply->text, '\n');
    warn_of_no_other(s);
    act_write_unsure(act, s->planting.channel, s->unsure);
    buf_add_blank(&act->reply->words);
    buf_printf(&act->reply->words, "added=%zu", s->planting.planted);
    act_add_markers(act);
    return OK;
}

enum err act_object(const struct act *act)
{
    const struct grid *grid = &act->session->scene->grid;
    struct search search = {.act = act,
                            .label = (int16_t)act_number(act, "LABEL"),
                            .planting = act_begin_planting(act->session, act_value(act, "RANGE")),
                            .may = mem_array(grid->cells, 1)};
    enum err err = search.may ? find_pieces(&search) : fault_memory(act->fault, "an object");
    if (!err) {
        search.is_taken = mem_new(search.found.count * sizeof *search.is_taken);
        err = search.is_taken ? collect_voxels(&search) : fault_memory(act->fault, "an object");
    }
    if (!err)
        err = plant_object(&search);
    free(search.may);
    free(search.is_taken);
    components_release(&search.found);
    voxels_release(&search.voxels);
    return err;
}
