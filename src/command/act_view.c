/* SPDX-License-Identifier: MIT */
/* Commands about arc weights and the region of interest, the view, shown objects and cuts; and all
 * settings. */
#include "command/act.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/choice.h"
#include "base/least.h"
#include "base/mem.h"
#include "base/scan.h"
#include "command/near.h"
#include "engine/roi.h"
#include "image/geometry.h"
#include "render/fit.h"
#include "session/map.h"
#include "show/slicing.h"

/* ---- arc weights ---- */

/* Add the digest of the weights after a command that may have changed them. */
static enum err add_weights(const struct act *act, enum err err)
{
    if (!err)
        act_add_digest(act, "weights", act->session->weight_digest);
    return err;
}

static enum err weigh_by_file(const struct act *act, const char *name)
{
    struct session *session = act->session;
    struct fault *fault = act->fault;
    const struct map_place place = act_map_place(act);
    OWNED(volume_release) struct volume map = {0};
    struct buf *path = act_buf(act);
    const enum err err = interpreter_find_file(act->interp, name, path, fault);
    if (err) {
        fault_prefix(fault, err, "expected " WEIGHT_KINDS " or a file");
        return near_append_choices(name, WEIGHT_KINDS, fault);
    }
    TRY(map_read(&map, buf_text(path), &place, session->watch, fault));
    TRY(act_prefix_file(act, map_to_weights(&map, session->watch, fault)));
    TRY(session_set_weight_map(session, name, map.intensity, fault));
    buf_add_text(&act->reply->text, map.notes);
    return OK;
}

/* Read the parameters of a weight: those of its row, and no others. */
static enum err take_argument(struct weight_choice *choice, const struct act *act)
{
    const struct weight_row *row = &weight_table[choice->kind];
    const char *other =
        choice->kind == WEIGHT_FILE ? NULL : call_given(act->call, "resample|volume|data");
    for (unsigned i = WEIGHT_ARGUMENT_COUNT; i-- > 0;)
        if (act_has(act, weight_parameter[i].name) && row->takes != i)
            other = weight_parameter[i].name;
    if (other)
        return fault_set(act->fault, ERR_USAGE, "%s: `weight %s` has none", other, row->name);
    if (row->takes == WEIGHT_TAKES_NOTHING)
        return OK;
    const char *name = weight_parameter[row->takes].name;
    if (!act_has(act, name) && !row->usual)
        return fault_set(act->fault, ERR_USAGE, "%s: `weight %s` needs one", name, row->name);
    choice->argument = (uint32_t)act_number_or(act, name, row->usual);
    return OK;
}

static enum err check_channels(const struct act *act, enum weight_kind kind)
{
    const bool fits = kind != WEIGHT_FILE && weight_arcs(kind) == ARC_TARGET;
    return fits || !kept_channels(&act->next->kept)
               ? OK
               : fault_set(act->fault, ERR_USAGE,
                           "several channels need gradients as weights: `weight morph`, sobel or "
                           "gauss; nothing has changed");
}

/* Read a channel; its proof is that of a scene with these voxels. */
static enum err read_volume(struct volume *volume, char proof[SHA256_HEX], const struct act *act,
                            const char *recorded, const char *path, struct fault *fault)
{
    struct watch *watch = act->session->watch;
    struct scene scene = *act->session->scene;
    struct map_place place = act_map_place(act);
    place.is_channel = true;
    place.choice.proof = recorded;
    TRY(map_read(volume, path, &place, watch, fault));
    scene.plain = volume->intensity;
    scene_proof(proof, &scene);
    return watch_fault(watch, fault);
}

/* Read a file outside of the allowed folders if it has the voxels of the record's proof. Otherwise
 * report nothing, and *volume is empty; only a stop is an error. */
static enum err read_outside(struct volume *volume, const struct act *act, const char *recorded)
{
    struct watch *watch = act->session->watch;
    struct buf *path = act_buf(act);
    struct fault unsaid = {0};
    char proof[SHA256_HEX] = "";
    if (watch)
        watch->is_quiet = true;
    if (!interpreter_find_outside(act->interp, true, act_text(act, "FILE"), path) ||
        read_volume(volume, proof, act, recorded, buf_text(path), &unsaid) != OK ||
        strcmp(proof, recorded) != 0)
        volume_release(volume);
    if (watch)
        watch->is_quiet = false;
    return watch_fault(watch, act->fault);
}

/* Read the file of the next channel; add its digest and its proof. */
static enum err read_channel(struct channel_values **values, const struct act *act)
{
    struct session *session = act->session;
    struct interpreter *interp = act->interp;
    OWNED(volume_release) struct volume volume = {0};
    struct buf *path = act_buf(act);
    char proof[SHA256_HEX];
    /* only for whole files on the grid of a whole file (T1) */
    const bool by_proof = !session->part.whole[0] && !call_has(act->call, "resample|data") &&
                          act_find_proof(act, proof);
    if (by_proof)
        TRY(read_outside(&volume, act, proof));
    if (!volume.intensity) {
        TRY(interpreter_find_scene(interp, true, act_text(act, "FILE"), by_proof, path,
                                   act->fault));
        TRY(read_volume(&volume, proof, act, NULL, buf_text(path), act->fault));
    }
    if (interp->mode != MODE_LIVE && interp->channel_path && *interp->channel_path)
        interp->channel_path++;
    act_add_levels(act, volume.levels);
    TRY(channel_values_new(values, session, &volume, act->fault));
    act_add_digest(act, "channel", channel_values_digest(*values));
    buf_printf(&act->reply->words, " sha256=%s", proof);
    buf_add_text(&act->reply->text, volume.notes);
    return OK;
}

enum err act_show_channel(const struct act *act)
{
    const struct kept *kept = &act->next->kept;
    const unsigned was = session_shown_channel(act->session), count = kept_channels(kept) + 1;
    const unsigned number = (unsigned)act_number(act, "N");
    const unsigned channel = number == CHANNELS_MOST + 1 ? (was + 1) % count : number;
    if (count == 1)
        return fault_set(act->fault, ERR_USAGE,
                         "the scene has one channel; `channel FILE` adds another");
    TRY(kept_has_channel(kept, channel, act->fault));
    act->next->outlook.slices.channel = channel ? kept->channel[channel - 1].slot : 0;
    TRY(act_go(act));
    channel_write(&act->reply->text, act->session);
    buf_add_text(&act->reply->text, " is shown\n");
    return OK;
}

/* Find a slot for a new channel; if possible, one without the window of a removed channel, which
 * undo restores. */
static uint32_t take_slot(struct state *next)
{
    struct slice_settings *slices = &next->outlook.slices;
    unsigned used = 1, avoided = 0;
    for (unsigned i = 0; i < CHANNELS_MOST; i++) {
        used |= 1u << next->kept.channel[i].slot;
        avoided |= slices->window_of[i + 1] ? 2u << i : 0;
    }
    avoided |= used;
    const unsigned slot = (unsigned)__builtin_ctz(~(avoided < 255 ? avoided : used));
    slices->window_of[slot] = 0;
    slices->channel = slices->channel == slot ? 0 : slices->channel;
    return slot;
}

enum err act_channel(const struct act *act)
{
    struct kept *kept = &act->next->kept;
    const unsigned count = kept_channels(kept);
    const int64_t number = act_number(act, "FILE");
    const unsigned channel = number < 0 ? count + 1 : (unsigned)number;
    const char *const of_file = number < 0 ? NULL : call_given(act->call, "resample|volume|data");
    OWNED(channel_values_release) struct channel_values *values = NULL;
    struct kept_channel *of = channel ? kept->channel + channel - 1 : NULL;
    if (of_file)
        return fault_set(act->fault, ERR_USAGE, "%s: only a file has one; nothing has changed",
                         of_file);
    if (number < 0 && count == CHANNELS_MOST)
        return fault_set(act->fault, ERR_LIMIT, "a scene has at most %d channels",
                         CHANNELS_MOST + 1);
    if (number < 0) {
        TRY(read_channel(&values, act));
        *of = (struct kept_channel){values, 100, take_slot(act->next), ""};
    }
    TRY(kept_has_channel(kept, channel, act->fault));
    TRY(check_channels(act, kept->weight.kind));
    if (act_has(act, "percent"))
        *(of ? &of->percent : &kept->percent) = (uint32_t)act_number(act, "percent");
    if (act_has(act, "name") && !of)
        return fault_set(act->fault, ERR_USAGE, "name: the first channel is the scene itself");
    if (act_has(act, "name")) {
        memset(of->name, 0, sizeof of->name);
        memcpy(of->name, act_text(act, "name"),
               strnlen(act_text(act, "name"), sizeof of->name - 1));
    }
    if (act_is_yes(act, "remove")) {
        if (!of)
            return fault_set(act->fault, ERR_USAGE,
                             "the first channel cannot be removed; nothing has changed");
        if (kept->has_range && kept->range_channel == channel)
            return fault_set(act->fault, ERR_USAGE,
                             "a `range` of channel %u restricts trees; `range none` removes it; "
                             "nothing has changed",
                             channel + 1);
        memmove(of, of + 1, (CHANNELS_MOST - channel) * sizeof *of);
        kept->channel[CHANNELS_MOST - 1] = (struct kept_channel){.values = NULL};
        kept->range_channel -= kept->range_channel > channel;
    }
    return add_weights(act, act_go(act));
}

enum err act_weight(const struct act *act)
{
    const bool is_file = act_number(act, "FILE") < 0;
    struct kept *kept = &act->next->kept;
    TRY(check_channels(act, is_file ? WEIGHT_FILE : (enum weight_kind)act_number(act, "FILE")));
    kept->weight = (struct weight_choice){
        is_file ? WEIGHT_FILE : (enum weight_kind)act_number(act, "FILE"), 0};
    TRY(take_argument(&kept->weight, act));
    if (is_file)
        return add_weights(act, weigh_by_file(act, act_text(act, "FILE")));
    kept->weight_map = NULL;
    memset(kept->weight_file, 0, sizeof kept->weight_file);
    return add_weights(act, act_go(act));
}

enum err act_polarity(const struct act *act)
{
    act->next->kept.polarity[act_number(act, "LABEL")] = (int8_t)act_number(act, "PERCENT");
    if (act->next->kept.weight.kind != WEIGHT_POLARITY)
        buf_add_text(&act->reply->text, "used only under `weight polarity`\n");
    return add_weights(act, act_go(act));
}

/* ---- the region of interest ---- */

/* Report the region of interest after a command that may have changed it. */
static enum err add_roi(const struct act *act, enum err err)
{
    const struct session *session = act->session;
    const struct roi_tally *tally = &session->roi_tally;
    struct reply *reply = act->reply;
    TRY(err);
    act_add_digest(act, "fence", tally->digest);
    buf_printf(&reply->words, " inside=%zu", tally->inside);
    buf_printf(&reply->text, "%zu of %zu voxels %s inside the region of interest\n", tally->inside,
               session->scene->grid.voxels, tally->inside == 1 ? "is" : "are");
    return OK;
}

static enum err mask_by_file(const struct act *act)
{
    struct session *session = act->session;
    const char *name = act_text(act, "FILE");
    static const uint32_t all[2] = {1, REGION_MOST};
    const uint32_t *regions = act_has(act, "regions") ? act_place(act, "regions") : all;
    OWNED(volume_release) struct volume map = {0};
    OWNED(mem_release) uint64_t *mask = mem_new(mask_bytes(&session->scene->grid));
    TRY(act_read_map(act, &map, regions[0], regions[1] < REGION_MOST ? regions[1] : UINT32_MAX));
    if (!mask)
        return fault_memory(act->fault, "a mask");
    struct grid_walk walk = scene_walk(session->scene, "voxels of the mask", NULL, 0);
    const uint16_t *region = map.intensity;
    while (grid_walk_next(&walk))
        for (uint32_t c = walk.row.first; c < walk.row.end; c++)
            mask[c >> 6] |= (uint64_t)(*region++ != REGION_NONE) << (c & 63);
    const struct roi alone = {mask, 0, UINT16_MAX, 0}; /* without the range */
    act_add_digest(act, "file", roi_tally(&alone, session->scene).digest);
    return act_prefix_file(act, session_set_mask(session, mask, name, regions, NULL, act->fault));
}

enum err act_mask(const struct act *act)
{
    const bool is_file = act_number(act, "FILE") < 0;
    const char *of_file = call_given(act->call, "regions|resample|volume|data");
    if (!is_file && of_file)
        return fault_set(act->fault, ERR_USAGE, "%s: `mask none` has no %s; nothing has changed",
                         of_file, strcmp(of_file, "regions") == 0 ? "regions" : "map");
    if (act->session->now.kept.rest)
        return fault_set(act->fault, ERR_USAGE,
                         "a mask would change regions that `labels rest=keep` has kept; give the "
                         "mask before that command; nothing has changed");
    return add_roi(act, is_file
                            ? mask_by_file(act)
                            : session_set_mask(act->session, NULL, NULL, NULL, NULL, act->fault));
}

enum err act_range(const struct act *act)
{
    struct session *session = act->session;
    const bool is_range = !act_text(act, "LOW");
    const struct value *low = act_value(act, "LOW");
    const bool is_low = is_range && low->number < 0;
    const unsigned channel = is_range && !is_low ? (unsigned)low->number : 0;
    const struct decimal range[2] = {low->real[0],
                                     is_low ? act_value(act, "HIGH")->real[0] : low->real[1]};
    if (is_low != act_has(act, "HIGH"))
        return fault_set(act->fault, ERR_USAGE,
                         "expected LOW and HIGH, 2:LOW..HIGH, or none alone; nothing has changed");
    if (is_range && decimal_value(&range[1]) < decimal_value(&range[0]))
        return fault_set(act->fault, ERR_USAGE, "HIGH is below LOW; nothing has changed");
    TRY(add_roi(act, session_set_range(session, channel, is_range ? range : NULL, act->fault)));
    if (!is_range)
        return OK;
    const struct interval interval = session_within(session, channel, range);
    size_t unsure = 0;
    struct grid_walk walk = scene_walk(session->scene, "levels", NULL, 0);
    while (interval.split[0] >= 0 && grid_walk_next(&walk))
        for (uint32_t c = walk.row.first; c < walk.row.end; c++)
            unsure += interval_splits(&interval, scene_intensity(session->scene, channel, c));
    act_write_unsure(act, channel, unsure);
    return OK;
}

static int32_t whole_turn(int64_t angle)
{
    int64_t turned = angle % VIEW_TURN;
    return (int32_t)(turned < 0 ? turned + VIEW_TURN : turned);
}

static const char *const angle_name[3] = {"YAW", "PITCH", "ROLL"}; /* the angles of a view */

enum err act_view(const struct act *act)
{
    struct view *view = &act->next->outlook.view;
    if (act_text(act, "YAW")) {
        if (act_has(act, "PITCH|ROLL"))
            return fault_set(act->fault, ERR_USAGE, "a named view has no angles");
        view_by_name(act_text(act, "YAW"), view->angle);
    } else {
        for (int i = 0; i < 3; i++)
            view->angle[i] = whole_turn(act_number(act, angle_name[i]));
    }
    return act_go(act);
}

enum err act_turn(const struct act *act)
{
    int32_t *angle = act->next->outlook.view.angle;
    for (int i = 0; i < 3; i++)
        if (act_has(act, angle_name[i]))
            angle[i] = whole_turn(angle[i] + act_number(act, angle_name[i]));
    return act_go(act);
}

/* Fit the shown objects at the current angles. The resulting zoom and place are recorded, so that a
 * replay does not depend on the objects. */
static enum err fit_shown(const struct act *act)
{
    struct view *view = &act->next->outlook.view;
    OWNED(fit_release) struct fit fit = {0};
    uint32_t place[3];
    TRY(fit_init(&fit, &act->session->border, act->fault));
    fit_place(&fit, view, place);
    view->zoom = fit_zoom(&fit, view, place, act->next->outlook.look.samples);
    view_focus_on(view, act->session->scene, place);
    if (fit.is_scene)
        buf_add_text(&act->reply->text, "no object is shown: the scene fits\n");
    act_write_waiting(act);
    buf_clear(&act->reply->canonical);
    buf_printf(&act->reply->canonical, "zoom %g at=%u,%u,%u", view->zoom / 1000.0, place[0],
               place[1], place[2]);
    return act_go(act);
}

enum err act_zoom(const struct act *act)
{
    struct view *view = &act->next->outlook.view;
    const struct value *zoom = act_value(act, "FACTOR"), *at = act_value(act, "at");
    if (zoom->text && at->given)
        return fault_set(act->fault, ERR_USAGE, "fit finds the place in the centre: without at=");
    if (zoom->text)
        return fit_shown(act);
    view->zoom = (uint32_t)zoom->number;
    if (at->given)
        view_focus_on(view, act->session->scene, at->place);
    return act_go(act);
}

enum err act_pan(const struct act *act)
{
    struct camera camera;
    TRY(session_aim(act->session, &act->session->now.outlook, &camera, act->fault));
    view_pan(&act->next->outlook.view, &camera, act_number(act, "RIGHT"), act_number(act, "DOWN"));
    return act_go(act);
}

enum err act_focus(const struct act *act)
{
    struct view *view = &act->next->outlook.view;
    memset(view->focus, 0, sizeof view->focus);
    if (!act_text(act, "PLACE"))
        view_focus_on(view, act->session->scene, act_place(act, "PLACE"));
    return act_go(act);
}

/* Set one label, or all of them if a word is given. */
static enum err set_visible(const struct act *act, bool is_visible)
{
    const struct value *label = act_value(act, "LABEL");
    const int first = label->text ? 1 : (int)label->number;
    for (int i = first; i <= (label->text ? 255 : first); i++)
        act->next->kept.visible[i] = is_visible;
    return act_go(act);
}

enum err act_hide(const struct act *act)
{
    return set_visible(act, false);
}

enum err act_opacity(const struct act *act)
{
    uint8_t *opacity = act->next->kept.opacity;
    const struct value *label = act_value(act, "LABEL");
    if (label->text)
        memset(opacity, (int)act_number(act, "PERCENT"), sizeof act->next->kept.opacity);
    else
        opacity[label->number] = (uint8_t)act_number(act, "PERCENT");
    return act_go(act);
}

enum err act_show(const struct act *act)
{
    return set_visible(act, true);
}

/* ---- slabs ---- */

static const char *const side[3][2] = {
    [SLICE_AXIAL] = {"feet", "head"},
    [SLICE_CORONAL] = {"back", "front"},
    [SLICE_SAGITTAL] = {"left", "right"},
};
enum { SLAB_NONE = 3 }; /* the choice after these */

enum err act_clip(const struct act *act)
{
    struct cut *cut = &act->next->kept.cut;
    const struct scene *scene = act->session->scene;
    if (act_number(act, "PLANE") == SLAB_NONE) {
        const struct cut whole = cut_none();
        if (act_has(act, "SLICES"))
            return fault_set(act->fault, ERR_USAGE,
                             "`clip none` has no slices; the view is unchanged");
        memcpy(cut->first, whole.first, sizeof cut->first);
        memcpy(cut->last, whole.last, sizeof cut->last);
        return act_go(act);
    }
    const enum slice_plane plane = (enum slice_plane)act_number(act, "PLANE");
    const uint32_t count = slice_count(scene, plane), *range = act_place(act, "SLICES");
    const char *name = slice_name(scene, plane);
    const bool turned = slice_index(scene, plane, (const uint32_t[3]){0}) > 0;
    char sides[24] = ""; /* the patient's, from slice 0 on: ", feet to head" */
    if (!scene->sides_unknown)
        snprintf(sides, sizeof sides, ", %s to %s", side[plane][turned], side[plane][!turned]);
    if (!act_has(act, "SLICES"))
        return fault_set(act->fault, ERR_USAGE, "expected %s slices A-B within 0-%u%s", name,
                         count - 1, sides);
    if (range[1] >= count)
        return fault_set(act->fault, ERR_INPUT,
                         "there are %s slices 0-%u%s, not %u; the view is unchanged", name,
                         count - 1, sides, range[1]);
    const int axis = slice_axis(scene, plane);
    cut->first[axis] = range[0] < range[1] ? range[0] : range[1];
    cut->last[axis] = range[0] < range[1] ? range[1] : range[0];
    if (cut->first[axis] == 0 && cut->last[axis] == scene->grid.size[axis] - 1)
        cut->last[axis] = UINT32_MAX;
    return act_go(act);
}

/* ---- planes and boxes ---- */

/* Read "A,B,C": a direction whose longest component has 30 bits; false for anything else. */
static bool scan_direction(const char *text, int64_t direction[3])
{
    int64_t longest = 0;
    if (!scan_three(&text, 6, -1000000000, 1000000000, direction))
        return false;
    for (int a = 0; a < 3; a++)
        longest = llabs(direction[a]) > longest ? llabs(direction[a]) : longest;
    for (; longest && longest < 1 << 29; longest *= 2)
        for (int a = 0; a < 3; a++)
            direction[a] *= 2;
    return longest && !*text;
}

/* Read `normal`: the direction out of the part that stays. */
static enum err read_normal(const struct act *act, int64_t normal[3])
{
    const char *word = act_text(act, "normal");
    const bool is_side = act_number(act, "normal") >= 0;
    if (is_side && act->session->scene->sides_unknown)
        return fault_set(act->fault, ERR_INPUT,
                         "normal=%s: orientation is unknown; expected A,B,C along the voxel axes, "
                         "or use `orient` first; the view is unchanged",
                         word);
    if (is_side) {
        int32_t angle[3], right[3], up[3], ahead[3];
        view_by_name(word, angle);
        view_look(&(struct view){.angle = {angle[0], angle[1], angle[2]}}, right, up, ahead);
        for (int a = 0; a < 3; a++)
            normal[a] = -ahead[a] / 2; /* 30 bits */
    } else if (!scan_direction(word, normal)) {
        return fault_set(act->fault, ERR_USAGE,
                         "normal: expected " VIEW_NAMES
                         " or A,B,C, not all 0, as in normal=-1,0,0.5, each within -1000..1000 "
                         "with at most six decimals, not %s; the view is unchanged",
                         word);
    }
    return OK;
}

/* Compute the plane through the voxel, perpendicular to `normal` or to the current view. */
static enum err make_plane(const struct act *act, struct cut_plane *plane)
{
    const struct scene *scene = act->session->scene;
    const int64_t offset_nm = 1000 * act_number(act, "offset");
    const uint32_t *place = act_place(act, "PLACE");
    int64_t normal[3], into[3], length = INT64_C(1) << 30;
    struct camera camera;
    enum err err;
    if (scene->spacing_unknown && offset_nm)
        return fault_set(act->fault, ERR_INPUT,
                         "offset: voxel spacing is unknown, so there are no millimetres; expected "
                         "another voxel; the view is unchanged");
    if (!act_has(act, "normal")) {
        err = session_aim(act->session, &act->session->now.outlook, &camera, act->fault);
        for (int a = 0; a < 3 && !err; a++)
            into[a] = (int64_t)camera.ahead[a] * scene->spacing_nm[a];
    } else if (!(err = read_normal(act, normal))) {
        length = 0;
        for (int a = 0; a < 3; a++)
            length += normal[a] * normal[a];
        length = square_root((uint64_t)length);
        geometry_along(&act->session->geometry, normal, into);
        for (int a = 0; a < 3; a++)
            into[a] = -into[a];
    }
    *plane = err ? (struct cut_plane){{0, 0, 0}, 0} : cut_plane_at(into, place, offset_nm * length);
    return err;
}

enum err act_plane(const struct act *act)
{
    struct cut *cut = &act->next->kept.cut;
    if (act_text(act, "PLACE")) {
        if (act_has(act, "normal|offset"))
            return fault_set(act->fault, ERR_USAGE,
                             "`plane none` has no normal and no offset; the view is unchanged");
        memset(cut->plane, 0, sizeof cut->plane);
        cut->planes = 0;
    } else if (cut->planes == CUT_PLANES_MOST) {
        return fault_set(act->fault, ERR_LIMIT,
                         "there are %d planes already, the most; `plane none` removes them; the "
                         "view is unchanged",
                         CUT_PLANES_MOST);
    } else {
        TRY(make_plane(act, &cut->plane[cut->planes++]));
    }
    return act_go(act);
}

enum err act_cut(const struct act *act)
{
    struct cut *cut = &act->next->kept.cut;
    if ((act_text(act, "CORNER") != NULL) == act_has(act, "OPPOSITE"))
        return fault_set(act->fault, ERR_USAGE,
                         "expected two corners X,Y,Z X,Y,Z, or none alone; the view is unchanged");
    if (act_text(act, "CORNER")) {
        memset(cut->box, 0, sizeof cut->box);
        cut->boxes = 0;
    } else if (cut->boxes == CUT_BOXES_MOST) {
        return fault_set(
            act->fault, ERR_LIMIT,
            "there are %d boxes already, the most; `cut none` removes them; the view is unchanged",
            CUT_BOXES_MOST);
    } else {
        const uint32_t *corner = act_place(act, "CORNER"), *opposite = act_place(act, "OPPOSITE");
        struct cut_box *box = &cut->box[cut->boxes++];
        for (int a = 0; a < 3; a++) {
            box->first[a] = least(corner[a], opposite[a]);
            box->last[a] = corner[a] < opposite[a] ? opposite[a] : corner[a];
        }
    }
    return act_go(act);
}

/* ---- settings: commands that do no more than set something (session/setting.h) ---- */

/* Return a value in the representation of the member. */
static int64_t member_value(const struct setting_member *member, const struct value *value)
{
    static const uint32_t background[] = {BACKGROUND_PLAIN, BACKGROUND_WHITE, BACKGROUND_GRADIENT,
                                          BACKGROUND_CLEAR};
    if (member->as == HELD_AS_SWITCH)
        return value->number == 0;
    if (member->as == HELD_AS_COUNT)
        return strtol(value->text, NULL, 10);
    if (member->as == HELD_AS_BACKGROUND)
        return value->text ? background[value->number] : BACKGROUND_PLAIN | (uint32_t)value->number;
    return value->number;
}

static void report_setting(const struct act *act, enum setting_says what)
{
    struct buf *out = &act->reply->text;
    const struct outlook *outlook = &act->session->now.outlook;
    const size_t waits = session_pendings(act->session);
    if (what == SAYS_WEIGHTS)
        act_add_digest(act, "weights", act->session->weight_digest);
    else if (what == SAYS_SLICES)
        act_write_slices(out, act->session);
    else if (what == SAYS_WAITING && outlook->runs_by_itself && waits)
        buf_printf(out, "%zu edit%s pending until `run` or the next edit\n", waits, plural(waits));
    else if (what == SAYS_FINISH && !outlook->shows_finished)
        buf_add_text(out, "pictures show the labels of the forest\n");
    else if (what == SAYS_FINISH && !act->session->now.kept.finish.count)
        buf_add_text(out, "the finish has no step yet; `finish relax` adds one, and pictures "
                          "show it\n");
    else if (what == SAYS_FINISH)
        act_write_finish(out, act->session);
}

enum err act_set(const struct act *act)
{
    const struct parameter *parameter = act->call->command->parameter;
    unsigned given = 0;
    for (int i = 0; parameter[i].type; i++) {
        const struct setting_member *member = &parameter[i].sets;
        const struct value *value = act_value(act, parameter[i].name);
        given += value->given;
        if (value->given)
            setting_put(act->next, member, member_value(member, value));
        else if (!member->stays)
            setting_put(act->next, member, member->usual);
    }
    if (!given)
        return fault_set(act->fault, ERR_USAGE, "expected what to change, as in `%s`",
                         act->call->command->example);
    TRY(act_go(act));
    report_setting(act, parameter->sets.says);
    return OK;
}
