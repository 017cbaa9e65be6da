/* Commands that plant seeds by hand: balls and strokes, boxes, polygons. */
#include "command/act.h"

#include "session/paint.h"
#include "session/roi_check.h"

/* ---- what may be planted ---- */

struct planting act_begin_planting(const struct session *session, const struct value *range)
{
    struct roi values = roi_none();
    if (range->given)
        roi_range(&values, &session->geometry, (int64_t[]){range->number, range->high});
    return (struct planting){.low = values.low, .high = values.high};
}

enum err act_plant(const struct act *act, struct planting *planting, uint32_t *cell, size_t count,
                   int16_t label)
{
    const struct cell *cells = act->session->scene->cell;
    struct task task = task_begin(act->session->watch, "seeds", count);
    size_t kept = 0;
    for (size_t i = 0; i < count && task_advance(&task, 1); i++) {
        const struct cell *at = cells + cell[i];
        if (at->intensity < planting->low || at->intensity > planting->high)
            planting->beyond++;
        else if (at->flags & CELL_OUTSIDE)
            planting->outside++;
        else
            cell[kept++] = cell[i];
    }
    planting->planted += kept;
    return kept ? session_plant(act->session, cell, kept, label, act->fault) : OK;
}

static void write_left_out(struct buf *out, const char *why, size_t count)
{
    if (count)
        buf_printf(out, "left out, %s: %zu voxel%s\n", why, count, plural(count));
}

enum err act_write_planting(const struct act *act, const struct planting *planting)
{
    if (!planting->planted && planting->outside)
        return fault_set(
            act->fault, ERR_INPUT,
            "all of it lies outside the region of interest, where no tree grows; plant elsewhere, "
            "or widen the region with `mask` or `range` (`info` shows it); nothing was planted");
    if (!planting->planted && planting->beyond)
        return fault_set(act->fault, ERR_INPUT,
                         "range: no voxel of it has such an intensity (`why X,Y,Z` prints that of "
                         "one); nothing was planted");
    write_left_out(&act->reply->text, "outside the region of interest", planting->outside);
    write_left_out(&act->reply->text, "intensities beyond the range", planting->beyond);
    return OK;
}

void act_add_markers(const struct act *act)
{
    const struct session *session = act->session;
    struct buf *words = &act->reply->words;
    const size_t first = session->former_markers + 1, last = session->markers.count;
    if (!semantics_has(session->semantics, MEANING_MARKERS) || last < first)
        return;
    buf_add_blank(words);
    buf_printf(words, "marker=%zu", first);
    if (last > first)
        buf_printf(words, "-%zu", last);
}

/* One marker of the voxels, which are let go of. */
static enum err plant(const struct act *act, struct voxels *voxels, int16_t label,
                      const struct value *range)
{
    struct planting planting = act_begin_planting(act->session, range);
    enum err err = act_plant(act, &planting, voxels->cell, voxels->count, label);
    voxels_release(voxels);
    if (!err)
        act_add_markers(act);
    return err ? err : act_write_planting(act, &planting);
}

/* ---- balls and strokes ---- */

static enum err make_brush(struct brush *brush, const struct act *act, const struct value *radius)
{
    const struct session *session = act->session;
    if (radius->in_mm && session->geometry.spacing_unknown)
        return fault_set(act->fault, ERR_INPUT,
                         "radius: the scene's file does not say how large voxels are; expected a "
                         "number of voxels, not millimetres; nothing has changed");
    return brush_init(brush,
                      radius->in_mm ? session->scene->spacing_nm : (const uint32_t[]){1, 1, 1},
                      radius->number, act->fault);
}

enum err act_find_voxels(const struct act *act, const struct value *place,
                         const struct value *radius, const struct value *to, struct voxels *voxels)
{
    const struct session *session = act->session;
    const struct grid *grid = &session->scene->grid;
    const bool goes_on = to && to->given;
    const uint32_t(*corner)[3] =
        goes_on ? (const uint32_t(*)[3])to->line->corner : (const uint32_t(*)[3]) & place->place;
    const size_t corners = goes_on ? to->line->count : 1;
    const bool was_before =
        !semantics_has(session->semantics, MEANING_STROKES) && corners <= 2 && !radius->in_mm;
    struct brush brush = {0};
    enum err err = make_brush(&brush, act, radius);
    if (!err && was_before)
        err = paint_stroke_as_before(voxels, grid, &brush, corner, corners, act->fault);
    else if (!err)
        err = paint_stroke(voxels, grid, &brush, corner, corners, session->watch, act->fault);
    brush_release(&brush);
    return err;
}

/* The command before has planted, as its one marker, seeds of the label. */
static bool can_join(const struct act *act, int64_t label)
{
    const struct history *history = &act->interp->history;
    const struct point *point = history->point + history->present;
    const struct markers *markers = &act->session->markers;
    return point->plants && markers->count > 0 && markers->marker[markers->count - 1].stands &&
           markers->marker[markers->count - 1].label == label;
}

enum err act_seed(const struct act *act)
{
    enum { PLACE, LABEL, RADIUS, RANGE, TO, JOINED };
    const struct value *value = act->value;
    struct voxels voxels = {0};
    if (value[JOINED].given && !can_join(act, value[LABEL].number))
        return fault_set(act->fault, ERR_USAGE,
                         "joined: the command before has not planted seeds of label %lld; nothing "
                         "was planted",
                         (long long)value[LABEL].number);
    enum err err = act_find_voxels(act, &value[PLACE], &value[RADIUS], &value[TO], &voxels);
    if (!err)
        err = plant(act, &voxels, (int16_t)value[LABEL].number, &value[RANGE]);
    if (!err && value[JOINED].given)
        session_join(act->session);
    return err;
}

/* ---- boxes and polygons ---- */

enum err act_box(const struct act *act)
{
    enum { CORNER, OPPOSITE, LABEL, RANGE };
    const struct value *value = act->value;
    struct voxels voxels = {0};
    enum err err = paint_box(&voxels, &act->session->scene->grid, value[CORNER].place,
                             value[OPPOSITE].place, act->session->watch, act->fault);
    return err ? err : plant(act, &voxels, (int16_t)value[LABEL].number, &value[RANGE]);
}

enum err act_fill(const struct act *act)
{
    enum { PLACE, LABEL, RANGE, TO };
    const struct value *value = act->value;
    const struct polyline *line = value[TO].line;
    struct voxels voxels = {0};
    if (!line || line->count < 3)
        return fault_set(act->fault, ERR_USAGE,
                         "a polygon has three corners or more, not all ahead on one line (`box` "
                         "fills a rectangle); nothing was planted");
    enum err err =
        paint_polygon(&voxels, &act->session->scene->grid, (const uint32_t(*)[3])line->corner,
                      line->count, act->session->watch, act->fault);
    return err ? err : plant(act, &voxels, (int16_t)value[LABEL].number, &value[RANGE]);
}
