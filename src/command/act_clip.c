/* Commands that cut away what hides the inside: slabs, planes, boxes. */
#include "command/act.h"

#include <stdio.h>
#include <string.h>

#include "show/slicing.h"

/* ---- slabs ---- */

static const char *const side[3][2] = {
    [SLICE_AXIAL] = {"feet", "head"},
    [SLICE_CORONAL] = {"back", "front"},
    [SLICE_SAGITTAL] = {"left", "right"},
};
enum { SLAB_NONE = 3 }; /* the choice after these */

/* ", feet to head": the patient's sides, from slice 0 of a plane on; nothing where nobody knows. */
static void write_sides(char out[24], const struct session *session, enum slice_plane plane)
{
    uint32_t first[3] = {0};
    slicing_move(session, plane, 0, first);
    const bool turned = slice_index(session_scene(session), plane, first) > 0;
    if (session_scene(session)->sides_unknown)
        *out = '\0';
    else
        snprintf(out, 24, ", %s to %s", side[plane][turned], side[plane][!turned]);
}

static void set_slab(struct cut *cut, const struct session *session, enum slice_plane plane,
                     const uint32_t range[2])
{
    const struct scene *scene = session_scene(session);
    const int axis = slice_axis(scene, plane);
    uint32_t a[3] = {0}, b[3] = {0};
    slicing_move(session, plane, range[0], a);
    slicing_move(session, plane, range[1], b);
    cut->first[axis] = a[axis] < b[axis] ? a[axis] : b[axis];
    cut->last[axis] = a[axis] < b[axis] ? b[axis] : a[axis];
    if (cut->first[axis] == 0 && cut->last[axis] == scene->grid.size[axis] - 1)
        cut->last[axis] = UINT32_MAX;
}

enum err act_clip(const struct act *act)
{
    struct cut *cut = &act->next->kept.cut;
    const struct scene *scene = session_scene(act->session);
    const int64_t plane = act->value[0].number;
    if (plane == SLAB_NONE) {
        const struct cut whole = cut_none();
        if (act->value[1].given)
            return fault_set(act->fault, ERR_USAGE,
                             "`clip none` takes no slices; the view is unchanged");
        memcpy(cut->first, whole.first, sizeof cut->first);
        memcpy(cut->last, whole.last, sizeof cut->last);
        return act_go(act);
    }
    const uint32_t count = slice_count(scene, (enum slice_plane)plane);
    const char *name = slice_name(scene, (enum slice_plane)plane);
    char sides[24];
    write_sides(sides, act->session, (enum slice_plane)plane);
    if (!act->value[1].given)
        return fault_set(act->fault, ERR_USAGE, "expected %s slices A-B within 0-%u%s", name,
                         count - 1, sides);
    if (act->value[1].place[1] >= count)
        return fault_set(act->fault, ERR_INPUT,
                         "there are %s slices 0-%u%s, not %u; the view is unchanged", name,
                         count - 1, sides, act->value[1].place[1]);
    set_slab(cut, act->session, (enum slice_plane)plane, act->value[1].place);
    return act_go(act);
}

/* ---- planes and boxes ---- */

enum err act_plane(const struct act *act)
{
    struct cut *cut = &act->next->kept.cut;
    if (act->value[0].text) {
        memset(cut->plane, 0, sizeof cut->plane);
        cut->planes = 0;
    } else if (cut->planes == CUT_PLANES_MOST) {
        return fault_set(act->fault, ERR_LIMIT,
                         "there are %d planes already, the most; `plane none` removes them; the "
                         "view is unchanged",
                         CUT_PLANES_MOST);
    } else {
        struct camera camera;
        const enum err err =
            session_aim(act->session, session_outlook(act->session), &camera, act->fault);
        if (err)
            return err;
        cut->plane[cut->planes++] =
            cut_plane_through(session_scene(act->session), act->value[0].place, camera.ahead);
    }
    return act_go(act);
}

static struct cut_box box_between(const uint32_t corner[3], const uint32_t opposite[3])
{
    struct cut_box box;
    for (int a = 0; a < 3; a++) {
        box.first[a] = corner[a] < opposite[a] ? corner[a] : opposite[a];
        box.last[a] = corner[a] < opposite[a] ? opposite[a] : corner[a];
    }
    return box;
}

enum err act_cut(const struct act *act)
{
    struct cut *cut = &act->next->kept.cut;
    if ((act->value[0].text != NULL) == act->value[1].given)
        return fault_set(act->fault, ERR_USAGE,
                         "expected two corners X,Y,Z X,Y,Z, or none alone; the view is unchanged");
    if (act->value[0].text) {
        memset(cut->box, 0, sizeof cut->box);
        cut->boxes = 0;
    } else if (cut->boxes == CUT_BOXES_MOST) {
        return fault_set(
            act->fault, ERR_LIMIT,
            "there are %d boxes already, the most; `cut none` removes them; the view is unchanged",
            CUT_BOXES_MOST);
    } else {
        cut->box[cut->boxes++] = box_between(act->value[0].place, act->value[1].place);
    }
    return act_go(act);
}

/* ---- in words ---- */

bool act_write_cut(struct buf *out, const struct session *session)
{
    const struct cut *cut = &session_kept(session)->cut;
    const struct scene *scene = session_scene(session);
    const char *between = "";
    for (enum slice_plane plane = SLICE_AXIAL; plane <= SLICE_SAGITTAL; plane++) {
        const int axis = slice_axis(scene, plane);
        uint32_t last[3] = {0};
        if (cut->first[axis] == 0 && cut->last[axis] == UINT32_MAX)
            continue;
        const uint32_t end = scene->grid.size[axis] - 1;
        last[axis] = cut->last[axis] < end ? cut->last[axis] : end;
        const uint32_t a = slicing_number(session, plane, cut->first),
                       b = slicing_number(session, plane, last);
        buf_printf(out, "%sall but %s slices %u-%u", between, slice_name(scene, plane),
                   a < b ? a : b, a < b ? b : a);
        between = ", ";
    }
    if (cut->planes) {
        buf_printf(out, "%s%u plane%s", between, cut->planes, plural(cut->planes));
        between = ", ";
    }
    if (cut->boxes)
        buf_printf(out, "%s%u box%s", between, cut->boxes, cut->boxes == 1 ? "" : "es");
    return !cut_is_none(cut);
}
