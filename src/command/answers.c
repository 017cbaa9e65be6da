/* SPDX-License-Identifier: MIT */
#include "command/act.h"

#include <stdio.h>
#include <string.h>

#include "base/choice.h"
#include "base/mem.h"
#include "engine/roi.h"
#include "image/geometry.h"
#include "journal/journal.h"
#include "show/histogram.h"
#include "show/label_report.h"
#include "show/label_loss.h"
#include "session/map.h"
#include "session/tally.h"
#include "show/export_picture.h"
#include "show/slicing.h"
#include "show/draw.h"

/* ---- labels ---- */

void act_write_waiting(const struct act *act)
{
    const size_t waits = session_pendings(act->session);
    if (waits == 1)
        buf_add_text(&act->reply->text, "not included: the pending edit (`run` applies it)\n");
    else if (waits > 1)
        buf_printf(&act->reply->text, "not included: the %zu pending edits (`run` applies them)\n",
                   waits);
}

void act_write_no_seeds(const struct act *act)
{
    if (!forest_seeds(act->session->forest))
        buf_add_text(&act->reply->text, "no seed is planted: no voxel has a label\n");
}

/* ---- seeds that end within a distance (`seed within=`) ---- */

/* Add ", within 12 voxels of 10,14,9" for a seed that has a reach. */
static void write_reach(struct buf *out, const struct session *session, uint32_t seed)
{
    const struct reach *reach = forest_reach(session->forest, seed);
    if (!reach)
        return;
    if (reach->radius == REACH_EXACT) {
        buf_add_text(out, ", within=0");
        return;
    }
    if (reach->unit[0] == 1)
        buf_printf(out, ", within %lld voxel%s of ", (long long)reach->radius,
                   plural((uint64_t)reach->radius));
    else
        buf_printf(out, ", within %g mm of ", (double)reach->radius / 1e6);
    buf_printf(out, "%u,%u,%u", reach->centre[0], reach->centre[1], reach->centre[2]);
}

void act_write_refusal(struct buf *out, const struct session *session, uint32_t cell)
{
    const struct scene *scene = session->scene;
    const uint64_t refused = forest_refused_offer(session->forest, cell);
    if (refused >= scene->cell[cell].key)
        return;
    const uint32_t root = key_root(refused);
    const struct place p = grid_place(&scene->grid, root);
    buf_printf(out, "it is out of reach of the seed at %u,%u,%u", p.x, p.y, p.z);
    write_reach(out, session, root);
    buf_add_text(out, ", of label ");
    label_report_write_name(out, session, scene->cell[root].label);
    buf_printf(out, ", whose path would cost %u\n", key_cost(refused));
}

static enum err write_reaches(const struct act *act)
{
    const struct forest *forest = act->session->forest;
    const size_t seeds = forest_limited_seeds(forest);
    struct buf *out = &act->reply->text;
    size_t voxels;
    if (seeds == 0)
        return OK;
    TRY(forest_count_refused(forest, &voxels, act->fault));
    buf_printf(out, "reach     %zu seed%s with `within`; ", seeds, plural(seeds));
    if (voxels)
        buf_printf(out, "%zu voxel%s without a tree, since all seeds around end before them\n",
                   voxels, plural(voxels));
    else
        buf_add_text(out, "no voxel is left without a tree by it\n");
    return OK;
}

/* ---- voxels ---- */

/* Add the weight of the voxel, or, for weights of steps, of the step from its predecessor. */
static void write_voxel_weight(struct buf *out, const struct session *session,
                               const struct cell *cell)
{
    const struct arc_rule *arcs = forest_arcs(session->forest);
    if (arcs->kind == ARC_TARGET) {
        buf_printf(out, "weight %u, ", cell->weight);
        return;
    }
    const struct cell *cells = session->scene->cell;
    const uint32_t before = cell_is_reached(cell)
                                ? forest_predecessor(session->forest, (uint32_t)(cell - cells))
                                : CELL_NONE;
    if (before != CELL_NONE)
        buf_printf(out, "a step of weight %u, ", arc_weight_now(arcs, cells + before, cell));
}

void act_write_voxel(struct buf *out, const struct session *session, uint32_t at)
{
    const struct grid *grid = &session->scene->grid;
    const struct cell *cell = session->scene->cell + at;
    struct place p = grid_place(grid, at);
    double mm[3];
    geometry_point(&session->geometry, (const uint32_t[]){p.x, p.y, p.z}, mm);
    buf_printf(out, "voxel %u,%u,%u", p.x, p.y, p.z);
    if (geometry_has_place(&session->geometry))
        buf_printf(out, " at %.1f,%.1f,%.1f mm", mm[0], mm[1], mm[2]);
    buf_add_text(out, ": intensity ");
    channel_write_in(out, session);
    levels_write(out, &session->geometry, session->levels, cell->intensity);
    buf_add_text(out, ", ");
    write_voxel_weight(out, session, cell);
    if (!cell_is_reached(cell)) {
        buf_add_text(out, cell->flags & CELL_OUTSIDE ? "outside the region of interest\n"
                                                     : "no seed reaches it\n");
        return;
    }
    struct place root = grid_place(grid, key_root(cell->key));
    buf_add_text(out, "label ");
    label_report_write_name(out, session, cell->label);
    buf_printf(out, ", of the seed at %u,%u,%u", root.x, root.y, root.z);
    write_reach(out, session, key_root(cell->key));
    buf_add_char(out, '\n');
}

/* ---- changes of labels by an edit ---- */

enum { LISTED_MOST = 6 };

/* Find the labels whose number of voxels has changed, the largest first, then the lowest number. */
static unsigned changed_labels(const struct session *session, uint8_t label[255])
{
    unsigned count = 0;
    for (unsigned l = 1; l < 256; l++) {
        const uint64_t voxels = session->tally.voxels[l];
        if (voxels == session->former_tally.voxels[l])
            continue;
        unsigned at = count++;
        for (; at > 0 && session->tally.voxels[label[at - 1]] < voxels; at--)
            label[at] = label[at - 1];
        label[at] = (uint8_t)l;
    }
    return count;
}

void volumes_write(struct buf *out, const struct session *session, bool is_finished,
                   uint64_t took_ns)
{
    uint8_t label[255];
    const unsigned count = changed_labels(session, label);
    const double ms = (double)took_ns / 1e6;
    const uint64_t changed = forest_changes(session->forest).voxels;
    if (changed == 0)
        buf_add_text(out, "no label has changed");
    else
        buf_printf(out, "%llu voxel%s changed", (unsigned long long)changed, plural(changed));
    if (is_finished && changed != 0)
        buf_add_text(out, " before finishing");
    for (unsigned i = 0; i < count && i < LISTED_MOST; i++) {
        buf_add_text(out, ", label ");
        const bool is_there = session->tally.voxels[label[i]] > 0;
        label_report_write_label(out, is_there ? &session->now.kept : &session->former.kept,
                                 label[i]);
        buf_add_text(out, ": ");
        const uint64_t voxels = session->tally.voxels[label[i]];
        const uint64_t former = session->former_tally.voxels[label[i]];
        const bool is_more = voxels > former;
        if (is_finished) { /* the volume is that of finished labels */
            buf_add_char(out, is_more ? '+' : '-');
            label_report_write_extent(out, session, is_more ? voxels - former : former - voxels);
        } else {
            label_report_write_extent(out, session, voxels);
            label_report_write_change(out, session, voxels, former);
        }
    }
    if (count > LISTED_MOST)
        buf_printf(out, ", %u more label%s", count - LISTED_MOST, plural(count - LISTED_MOST));
    if (ms < 1000)
        buf_printf(out, ", %.1f ms\n", ms);
    else
        buf_printf(out, ", %.1f s\n", ms / 1000);
}

void surprise_write(struct buf *out, struct session *session, const char *command)
{
    struct surprise surprise;
    if (!session_find_surprise(&surprise, session))
        return;
    if (command)
        buf_printf(out, "this `%s` took ", command);
    else
        buf_add_text(out, "the pending edits took  ");
    label_report_write_extent(out, session, surprise.voxels);
    buf_add_text(out, " of label ");
    label_report_write_name(out, session, surprise.label);
    if (surprise.has_passage)
        buf_printf(out, " through %u,%u,%u", surprise.passage[0], surprise.passage[1],
                   surprise.passage[2]);
    buf_add_text(out, "; undo reverts it\n");
}

/* ---- the scene, weights and the region of interest ---- */

void act_write_spacing(struct buf *out, const struct session *session)
{
    const uint32_t *nm = session->scene->spacing_nm;
    if (session->geometry.spacing_unknown)
        buf_add_text(out, " of unknown size");
    else
        buf_printf(out, " of %gx%gx%g mm", nm[0] / 1e6, nm[1] / 1e6, nm[2] / 1e6);
}

void act_write_axes(struct buf *out, const struct geometry *geometry)
{
    char towards[4];
    geometry_axes(towards, geometry);
    if (geometry->orientation == ORIENTATION_UNKNOWN)
        buf_add_text(out, "orientation unknown");
    else
        buf_printf(out, "axes towards %s%s", towards,
                   geometry->orientation == ORIENTATION_TOLD ? " set by the user" : "");
}

/* Add "part 4-19,2-17,3-12 of the file's 24x20x16 voxels, the mean of each 2x2x2". */
static void write_part(struct buf *out, const struct map_part *part)
{
    const struct volume_choice *choice = &part->choice;
    const uint32_t *whole = part->whole, n = choice->reduce;
    if (!whole[0])
        return;
    buf_add_text(out, "part      ");
    for (int a = 0; a < 3 && choice->has_crop; a++)
        buf_printf(out, "%s%u-%u", a ? "," : "", choice->first[a], choice->last[a]);
    buf_printf(out, "%s of the file's %ux%ux%u voxels", choice->has_crop ? "" : "all", whole[0],
               whole[1], whole[2]);
    if (n > 1)
        buf_printf(out, ", the mean of each %ux%ux%u", n, n, n);
    buf_add_text(out, choice->straightens ? ", straightened\n" : "\n");
}

/* "gauss 1.5", "polarity 1:50 2:-20", "of edges.nii" */
void act_write_weight(struct buf *out, const struct kept *kept)
{
    const struct weight_choice *choice = &kept->weight;
    const struct weight_row *row = &weight_table[choice->kind];
    const struct parameter *p = weight_parameter + row->takes;
    if (choice->kind == WEIGHT_FILE) {
        buf_add_text(out, "of ");
        buf_add_safe_text(out, kept->weight_file);
        return;
    }
    buf_add_text(out, row->name);
    if (choice->argument != row->usual) {
        buf_printf(out, p->keyed ? " %s=" : " ", p->name);
        buf_printf(out, "%g", choice->argument / (p->type == VALUE_DECIMAL ? 1000.0 : 1.0));
    }
    for (unsigned label = 0; choice->kind == WEIGHT_POLARITY && label < 256; label++)
        if (kept->polarity[label])
            buf_printf(out, " %u:%d", numbering_of(kept, label), kept->polarity[label]);
}

/* "region    mask brain.nii regions 1-90, range 40..1200: 880 of 1320 voxels inside" */
void act_write_region(struct buf *out, const struct session *session)
{
    const struct kept *kept = &session->now.kept;
    if (!kept->mask && !kept->has_range)
        return;
    buf_add_text(out, "region    ");
    if (kept->rest) {
        buf_add_text(out, "without the regions that are kept of ");
        buf_add_safe_text(out, kept->mask_file);
    } else if (kept->mask) {
        buf_add_text(out, "mask ");
        buf_add_safe_text(out, kept->mask_file);
        buf_printf(out, " regions %u-%u", kept->mask_regions[0], kept->mask_regions[1]);
    }
    if (kept->has_range) {
        buf_add_text(out, kept->mask ? ", range " : "range ");
        interval_write(out, kept->range_channel, kept->range);
    }
    buf_printf(out, ": %zu of %zu voxels inside\n", session->roi_tally.inside,
               session->scene->grid.voxels);
}

/* ---- view and slices ---- */

void act_write_finish(struct buf *out, const struct session *session)
{
    if (!session->now.kept.finish.count)
        return;
    buf_add_text(out, "finish    ");
    numbering_write_finish(out, &session->now.kept);
    buf_add_text(out, session->now.outlook.shows_finished ? "; pictures show it\n" : "\n");
}

/* Add the patient's sides in a direction of the picture, "front and left", or the axes, "+y and
 * -x", if the orientation is unknown: those within about 67 degrees. */
static void write_sides(struct buf *out, const int32_t direction[3], bool sides_unknown)
{
    static const struct {
        int axis;
        const char *side[2]; /* for a positive and a negative component */
    } row[2][3] = {{{1, {"front", "back"}}, {0, {"right", "left"}}, {2, {"head", "feet"}}},
                   {{1, {"+y", "-y"}}, {0, {"+x", "-x"}}, {2, {"+z", "-z"}}}};
    const int32_t least = view_sine(22500);
    const char *between = "";
    for (int i = 0; i < 3; i++) {
        const int32_t along = direction[row[sides_unknown][i].axis];
        if (along > -least && along < least)
            continue;
        buf_printf(out, "%s%s", between, row[sides_unknown][i].side[along < 0]);
        between = " and ";
    }
}

/* Add lines about the view and the orientation of the patient in the picture. */
static void write_view(struct buf *out, const struct session *session)
{
    const struct view *view = &session->now.outlook.view;
    const bool unknown = session->scene->sides_unknown;
    const char *name = unknown ? NULL : view_name(view->angle);
    int32_t right[3], up[3], ahead[3], towards[3];
    double middle[3];
    view_look(view, right, up, ahead);
    for (int i = 0; i < 3; i++) {
        towards[i] = -ahead[i];
        middle[i] = (session->scene->grid.size[i] - 1) / 2.0 +
                    (double)view->focus[i] / (1 << VIEW_FOCUS_BITS);
    }
    buf_printf(out,
               "view      %g %g %g degrees%s%s, zoom %g, %ux%u pixels, %.5g,%.5g,%.5g in the "
               "middle\n",
               view->angle[0] / 1000.0, view->angle[1] / 1000.0, view->angle[2] / 1000.0,
               name ? ", " : "", name ? name : "", view->zoom / 1000.0, view->width, view->height,
               middle[0], middle[1], middle[2]);
    const char *his = unknown ? "" : "his ";
    buf_add_text(out, unknown ? "          " : "          the patient's ");
    write_sides(out, towards, unknown);
    buf_printf(out, " towards you, %s", his);
    write_sides(out, right, unknown);
    buf_printf(out, " on the right, %s", his);
    write_sides(out, up, unknown);
    buf_add_text(out, unknown ? " up; orientation unknown\n" : " up\n");
}

/* Add "cut away all but axial slices 10-60, 1 plane, 2 boxes"; nothing without cuts. */
static void write_cut(struct buf *out, const struct session *session)
{
    const struct cut *cut = &session->now.kept.cut;
    const struct scene *scene = session->scene;
    const char *between = "";
    if (cut_is_none(cut))
        return;
    buf_add_text(out, "cut away  ");
    for (enum slice_plane plane = SLICE_AXIAL; plane <= SLICE_SAGITTAL; plane++) {
        const int axis = slice_axis(scene, plane);
        if (cut->first[axis] == 0 && cut->last[axis] == UINT32_MAX)
            continue;
        const uint32_t end = scene->grid.size[axis] - 1;
        buf_printf(out, "%sall but %s slices %u-%u", between, slice_name(scene, plane),
                   cut->first[axis], cut->last[axis] < end ? cut->last[axis] : end);
        between = ", ";
    }
    if (cut->planes) {
        buf_printf(out, "%s%u plane%s", between, cut->planes, plural(cut->planes));
        between = ", ";
    }
    if (cut->boxes)
        buf_printf(out, "%s%u box%s", between, cut->boxes, cut->boxes == 1 ? "" : "es");
    buf_add_char(out, '\n');
}

void act_write_slices(struct buf *out, struct session *session)
{
    const struct slice_settings *s = &session->now.outlook.slices;
    char least[WINDOW_WORDS_BYTES], most[WINDOW_WORDS_BYTES];
    window_words(least, most, session);
    buf_printf(out, "through %u,%u,%u: ", s->cross[0], s->cross[1], s->cross[2]);
    for (enum slice_plane plane = SLICE_AXIAL; plane <= SLICE_SAGITTAL; plane++)
        buf_printf(out, "%s %u%s", slice_name(session->scene, plane),
                   s->cross[slice_axis(session->scene, plane)],
                   plane < SLICE_SAGITTAL ? ", " : "; ");
    buf_printf(
        out, "window %s%s %s, ",
        s->window_of[session_shown_slot(session)] == session_shown_digest(session) ? "" : "auto: ",
        least, most);
    if (s->times != SLICE_TIMES_ONE)
        buf_printf(out, "magnified %g, ", s->times / 1000.0);
    if (s->has_middle)
        buf_printf(out, "around %u,%u,%u, ", s->middle[0], s->middle[1], s->middle[2]);
    settings_write(out, GROUP_SLICES, &session->now);
    buf_add_char(out, '\n');
}

/* ---- the commands ---- */

/* Add a line about the labels that exist, if they are numbered. */
static void write_numbers(struct buf *out, const struct kept *kept)
{
    unsigned count = 0;
    uint32_t least = UINT32_MAX, most = 0;
    for (unsigned label = 1; label < 256; label++) {
        const uint32_t number = kept->label_number[label];
        least = number && number < least ? number : least;
        most = number > most ? number : most;
        count += number > 0;
    }
    if (count)
        buf_printf(out, "numbers   %u label%s, %u to %u, of 255; `stats` lists them\n", count,
                   plural(count), least, most);
}

/* Add the scene, its part of the file, and the values of the file. */
static void write_scene(struct buf *out, const struct session *session)
{
    const struct geometry *geometry = &session->geometry;
    const uint32_t *size = session->scene->grid.size;
    buf_printf(out, "scene     %ux%ux%u voxels", size[0], size[1], size[2]);
    act_write_spacing(out, session);
    buf_add_text(out, ", ");
    act_write_axes(out, geometry);
    buf_printf(out, ", digest %016llx\n", (unsigned long long)session->scene_digest);
    write_part(out, &session->part);
    const struct kept *kept = &session->now.kept;
    for (unsigned i = 0; i < kept_channels(kept); i++) {
        buf_printf(out, "channel   %u ", i + 2);
        buf_add_safe_text(out, kept->channel[i].name);
        buf_printf(out, "%sdigest %016llx, %u %%\n", *kept->channel[i].name ? ", " : "",
                   (unsigned long long)channel_values_digest(kept->channel[i].values),
                   kept->channel[i].percent);
    }
    buf_printf(out, "values    %g * intensity %+.*g\n", geometry->slope, geometry_digits(geometry),
               geometry->intercept);
    levels_write_scale(out, session->levels, "          ");
}

/* Add the look of the rendition, and the slices. */
static void write_look(struct buf *out, struct session *session)
{
    OWNED(buf_release) struct buf opacity = {0};
    write_view(out, session);
    buf_add_text(out, "look      ");
    settings_write(out, GROUP_LOOK, &session->now);
    buf_add_char(out, '\n');
    export_opacity(&opacity, &session->now.kept);
    if (opacity.length)
        buf_printf(out, "opacity   %s\n", buf_text(&opacity));
    write_cut(out, session);
    buf_add_text(out, "slices    ");
    act_write_slices(out, session);
}

enum err act_info(const struct act *act)
{
    struct session *session = act->session;
    struct buf *out = &act->reply->text;
    struct histogram histogram;
    if (act->interp->journal) {
        const struct journal *journal = act->interp->journal;
        buf_add_text(out, "journal   ");
        buf_add_safe_text(out, journal_path(journal));
        buf_printf(out, ", %zu record%s\n", journal_count(journal), plural(journal_count(journal)));
    }
    if (act->interp->add_terminal)
        act->interp->add_terminal(act->interp->terminal, out);
    if (!session->has_scene) {
        buf_add_text(out, "no scene is open\n");
        return OK;
    }
    TRY(session_complete(session, act->fault));
    write_scene(out, session);
    const size_t seeds = forest_seeds(session->forest), waits = session_pendings(session);
    buf_printf(out, "forest    %zu seed%s, %zu edit%s pending, adjacency %u, weight ", seeds,
               plural(seeds), waits, plural(waits), session->now.kept.adjacency);
    act_write_weight(out, &session->now.kept);
    buf_add_char(out, '\n');
    histogram_of_session(&histogram, session);
    histogram_write(out, &histogram, act->interp->has_blocks);
    act_write_region(out, session);
    TRY(write_reaches(act));
    act_write_finish(out, session);
    write_numbers(out, &session->now.kept);
    act_write_origin(out, session);
    write_look(out, session);
    /* README promises the bytes per voxel of the scene; the rest does not depend on its size,
     * except for answers, which are computed on request. */
    const struct session_memory parts = session_memory_parts(act->session);
    buf_printf(out, "memory    %.1f MB: scene %.1f, %.1f bytes a voxel; seeds %.1f; pictures %.1f",
               (double)session_memory(act->session) / 1e6, (double)parts.scene / 1e6,
               (double)parts.scene / (double)act->session->scene->grid.voxels,
               (double)parts.seeds / 1e6, (double)parts.pictures / 1e6);
    if (parts.answers)
        buf_printf(out, "; answers %.1f", (double)parts.answers / 1e6);
    buf_printf(out, "; and %.1f MB for undo\n",
               (double)history_memory(&act->interp->history) / 1e6);
    return OK;
}

enum err act_help(const struct act *act)
{
    const char *about = act_text(act, "COMMAND");
    const struct command *command = about ? command_find(about) : NULL;
    if (command || (about && strcmp(about, "all") == 0))
        command_help(&act->reply->text, command);
    else if (command_page(about))
        buf_add_text(&act->reply->text, command_page(about));
    else if (act->interp->add_keys)
        act->interp->add_keys(&act->reply->text);
    else
        buf_add_text(&act->reply->text, "keys are those of the prompt: see `iftty help keys`\n");
    return OK;
}

enum err act_pilot(const struct act *act)
{
    if (!act->interp->has_pilot)
        return fault_set(act->fault, ERR_USAGE, "the pilot needs the prompt of a terminal");
    act->interp->wish = WISH_PILOT;
    return OK;
}

enum err act_quit(const struct act *act)
{
    act->interp->wish = WISH_QUIT;
    return OK;
}
