/* The command `object`: a marker of all that is connected to a seed within a range of intensities.
 */
#include "command/act.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "engine/components.h"
#include "engine/roi.h"
#include "image/levels.h"
#include "render/cut.h"
#include "session/markers.h"

/* What is looked through: which voxels may belong to the object, and their pieces. */
struct search {
    const struct act *act;
    int16_t label;
    struct planting planting;
    size_t unsure; /* voxels of the scene, of levels that the range splits */
    uint8_t *may;  /* [grid.cells], 0 or 1 */
    struct components found;
    bool *is_taken; /* by component */
    struct voxels voxels;
};

static void search_release(struct search *s)
{
    free(s->may);
    free(s->is_taken);
    components_release(&s->found);
    voxels_release(&s->voxels);
}

/* ---- which voxels may ---- */

/* In the range, in the region of interest, and without a seed of another label. */
static bool may_belong(const struct search *s, uint32_t cell)
{
    const struct cell *at = session_scene(s->act->session)->cell + cell;
    if (!interval_holds(&s->planting.within, at->intensity) || at->flags & CELL_OUTSIDE)
        return false;
    const int16_t seed = markers_seed(session_markers(s->act->session), cell);
    return seed == EDIT_ERASE || seed == s->label;
}

static enum err find_pieces(struct search *s)
{
    const struct session *session = s->act->session;
    const struct grid *grid = &session_scene(session)->grid;
    struct task task = task_begin(session_watch(session), "voxels in the range", grid->voxels);
    memset(s->may, 0, grid->cells);
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1] && task_advance(&task, grid->size[0]); y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++) {
                s->may[c] = may_belong(s, c);
                s->unsure +=
                    interval_splits(&s->planting.within, session_scene(session)->cell[c].intensity);
            }
        }
    const enum err err = watch_fault(session_watch(session), s->act->fault);
    return err ? err
               : components_find(&s->found, grid, s->may, session_watch(session), s->act->fault);
}

/* ---- which pieces are taken ---- */

static bool begins_in(const struct search *s, const struct component_run *run)
{
    const struct value *from = act_value(s->act, "from");
    const struct grid *grid = &session_scene(s->act->session)->grid;
    if (from->given) {
        const uint32_t cell = grid_cell(grid, from->place[0], from->place[1], from->place[2]);
        return run->first <= cell && cell < run->end;
    }
    for (uint32_t c = run->first; c < run->end; c++)
        if (markers_seed(session_markers(s->act->session), c) == s->label)
            return true;
    return false;
}

static enum err take_pieces(struct search *s)
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

/* ---- the command ---- */

/* The voxel that was named does not belong to it. */
static enum err refuse_place(const struct search *s)
{
    const struct session *session = s->act->session;
    const uint32_t *place = act_place(s->act, "from");
    const uint32_t cell = grid_cell(&session_scene(session)->grid, place[0], place[1], place[2]);
    const struct cell *at = session_scene(session)->cell + cell;
    const char *why = "a seed of another label";
    struct buf intensity = {0};
    if (!interval_holds(&s->planting.within, at->intensity)) {
        buf_add_text(&intensity, "the intensity ");
        levels_write(&intensity, session_geometry(session), session_levels(session), at->intensity);
        buf_add_text(&intensity, ", beyond the range");
        why = buf_text(&intensity);
    } else if (at->flags & CELL_OUTSIDE) {
        why = "no part in the region of interest";
    }
    fault_set(s->act->fault, ERR_INPUT, "from: voxel %u,%u,%u has %s; nothing was planted",
              place[0], place[1], place[2], why);
    buf_release(&intensity);
    return ERR_INPUT;
}

static enum err refuse_nothing(const struct search *s)
{
    if (act_has(s->act, "from"))
        return refuse_place(s);
    return fault_set(
        s->act->fault, ERR_INPUT,
        "no seed of label %d lies in a voxel of this range; plant one there, or name a "
        "voxel by from=X,Y,Z (`why X,Y,Z` prints its intensity); nothing was planted",
        s->label);
}

/* An object ends where trees of another label begin, and nowhere else. */
static void warn_of_no_other(const struct search *s)
{
    const struct session *session = s->act->session;
    const struct markers *markers = session_markers(session);
    struct buf *out = &s->act->reply->text;
    for (size_t i = 0; i < markers->count; i++)
        if (markers->marker[i].stands && markers->marker[i].label != EDIT_ERASE &&
            markers->marker[i].label != s->label)
            return;
    buf_add_text(out, "no other label has a seed: nothing holds label ");
    label_report_write_name(out, session, (unsigned)s->label);
    buf_printf(out,
               " back, and a run gives it all of the %s\nthat its trees reach; seeds of the "
               "background hold it, as `seed X,Y,Z 0`, or a shell or a box around it\n",
               roi_is_none(session_roi(session)) ? "scene" : "region of interest");
}

static enum err plant(struct search *s)
{
    const struct act *act = s->act;
    enum err err = s->voxels.count
                       ? act_plant(act, &s->planting, s->voxels.cell, s->voxels.count, s->label)
                       : refuse_nothing(s);
    if (err)
        return err;
    buf_printf(&act->reply->text, "%zu voxel%s of label ", s->planting.planted,
               plural(s->planting.planted));
    label_report_write_name(&act->reply->text, act->session, (unsigned)s->label);
    buf_add_char(&act->reply->text, '\n');
    warn_of_no_other(s);
    act_write_unsure(act, s->unsure);
    buf_printf(&act->reply->words, "added=%zu", s->planting.planted);
    act_add_markers(act);
    return OK;
}

enum err act_object(const struct act *act)
{
    const struct grid *grid = &session_scene(act->session)->grid;
    struct search search = {.act = act,
                            .label = (int16_t)act_number(act, "LABEL"),
                            .planting = act_begin_planting(act->session, act_value(act, "RANGE")),
                            .may = mem_array(grid->cells, 1)};
    enum err err = search.may ? find_pieces(&search) : fault_memory(act->fault, "an object");
    if (!err) {
        search.is_taken = mem_new(search.found.count * sizeof *search.is_taken);
        err = search.is_taken ? take_pieces(&search) : fault_memory(act->fault, "an object");
    }
    if (!err)
        err = plant(&search);
    search_release(&search);
    return err;
}
