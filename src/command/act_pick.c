/* What is under a pixel. */
#include "command/act.h"

#include <math.h>

#include "engine/measure.h"
#include "image/geometry.h"
#include "session/session.h"
#include "show/draw.h"

/* The voxel that a pixel of the rendition shows, or CELL_NONE. What the pilot has drawn may be at a
 * zoom of its own. */
static enum err voxel_of_rendition(struct session *session, const struct labels *labels,
                                   uint32_t column, uint32_t row, uint32_t *cell,
                                   struct fault *fault)
{
    const struct rendition *r = session_frame(session);
    if (!session_rendered(session))
        return fault_set(fault, ERR_USAGE, "the rendition is not up to date; `render` first");
    const enum err err = session_draw_labels(session, labels, RENDER_AS_KEPT, fault);
    if (err)
        return err;
    if (column >= r->width || row >= r->height)
        return fault_set(fault, ERR_INPUT, "pixel %u,%u lies outside the picture of %ux%u", column,
                         row, r->width, r->height);
    *cell = r->cell[(size_t)row * r->width + column];
    return OK;
}

/* The same of a slice or mosaic, as it would be drawn now. */
static enum err voxel_of_slices(struct session *session, enum slice_kind kind,
                                const struct labels *labels, uint32_t column, uint32_t row,
                                uint32_t *cell, struct fault *fault)
{
    const struct view *view = &session_outlook(session)->view;
    if (column >= view->width || row >= view->height)
        return fault_set(fault, ERR_INPUT, "pixel %u,%u lies outside the picture of %ux%u", column,
                         row, view->width, view->height);
    return slicing_cell_at(cell, session, kind, labels, column, row, fault);
}

/* "3.61 mm from the border of label 1 brain, at 70,101,95" */
static void write_distance(struct buf *out, const struct session *session, uint32_t cell)
{
    const struct scene *scene = session_scene(session);
    const struct border_distance border = measure_border_distance(scene, cell);
    const struct place at = grid_place(&scene->grid, border.cell);
    const char *unit = session_geometry(session)->spacing_unknown ? "voxels" : "mm";
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
    if (border.squared && geometry_fill(session_geometry(session)) < 1)
        buf_add_text(out, ", as if axes were not sheared");
    buf_add_char(out, '\n');
}

enum err act_pick(const struct act *act)
{
    struct session *session = act->session;
    const uint32_t column = (uint32_t)act->value[0].number, row = (uint32_t)act->value[1].number;
    const bool is_slice = act->value[2].given && act->value[2].number > 0;
    uint32_t cell = CELL_NONE;
    struct labels labels;
    enum err err = session_labels(session, session_shows_finished(session), &labels, act->fault);
    if (!err)
        err = is_slice ? voxel_of_slices(session, (enum slice_kind)(act->value[2].number - 1),
                                         &labels, column, row, &cell, act->fault)
                       : voxel_of_rendition(session, &labels, column, row, &cell, act->fault);
    if (err)
        return err;
    if (cell == CELL_NONE) {
        buf_printf(&act->reply->text, "pixel %u,%u shows %s\n", column, row,
                   is_slice ? "no voxel" : "no object");
        act_write_waiting(act);
        return OK;
    }
    act_write_voxel(&act->reply->text, session, cell);
    if (cell_is_reached(session_scene(session)->cell + cell))
        write_distance(&act->reply->text, session, cell);
    if (labels_at(&labels, cell) != session_scene(session)->cell[cell].label) {
        buf_add_text(&act->reply->text, "finished: label ");
        label_report_write_name(&act->reply->text, session, labels_at(&labels, cell));
        buf_add_char(&act->reply->text, '\n');
    }
    act_write_waiting(act);
    return watch_fault(session_watch(session), act->fault);
}
