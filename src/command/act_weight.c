/* SPDX-License-Identifier: MIT */
/* Commands that say what a forest grows by: arc weights, and the region of interest. */
#include "command/act.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/choice.h"
#include "command/files.h"
#include "command/near.h"
#include "engine/roi.h"
#include "session/map.h"

/* ---- arc weights ---- */

/* After a command that may have changed weights. */
static enum err add_weights(const struct act *act, enum err err)
{
    if (!err)
        act_add_weights(act);
    return err;
}

static enum err weigh_by_file(const struct act *act, const char *name)
{
    struct session *session = act->session;
    struct fault *fault = act->fault;
    const struct map_place place = act_map_place(act);
    struct volume map = {0};
    struct buf path = {0};
    enum err err = interpreter_find_file(act->interp, name, &path, fault);
    if (err) {
        struct near near = near_to(name);
        near_try_choices(&near, WEIGHT_KINDS);
        fault_prefix(fault, err, "expected " WEIGHT_KINDS " or a file");
        near_append(&near, "", fault);
    }
    if (!err)
        err = map_read(&map, buf_text(&path), &place, session_watch(session), fault);
    if (!err)
        err = act_naming(name, map_to_weights(&map, session_watch(session), fault), fault);
    if (!err)
        err = session_set_weight_map(session, name, map.intensity, fault);
    if (!err)
        buf_add_text(&act->reply->text, map.notes);
    volume_release(&map);
    buf_release(&path);
    return err;
}

#define ARGUMENT_NAME(name, type, least, most) name

/* What is given beside the name: what the row takes, and nothing else. */
static enum err take_argument(struct weight_choice *choice, const struct act *act)
{
    static const char *const name[] = {WEIGHT_ARGUMENTS(ARGUMENT_NAME, ARGUMENT_NAME)};
    const struct weight_row *row = &weight_table[choice->kind];
    for (unsigned i = 0; i < WEIGHT_ARGUMENT_COUNT; i++)
        if (act_has(act, name[i]) && row->takes != i)
            return fault_set(act->fault, ERR_USAGE, "%s: `weight %s` has none", name[i], row->name);
    static const char *const of_map[] = {"resample", "volume", "data"};
    for (unsigned i = 0; i < sizeof of_map / sizeof *of_map; i++)
        if (act_has(act, of_map[i]) && choice->kind != WEIGHT_FILE)
            return fault_set(act->fault, ERR_USAGE, "%s: `weight %s` has none", of_map[i],
                             row->name);
    if (row->takes == WEIGHT_TAKES_NOTHING)
        return OK;
    if (!act_has(act, name[row->takes]) && !row->usual)
        return fault_set(act->fault, ERR_USAGE, "%s: `weight %s` needs one", name[row->takes],
                         row->name);
    choice->argument = (uint32_t)act_number_or(act, name[row->takes], row->usual);
    return OK;
}

enum err act_weight(const struct act *act)
{
    const bool is_file = act_number(act, "FILE") < 0;
    struct kept *kept = &act->next->kept;
    kept->weight = (struct weight_choice){
        is_file ? WEIGHT_FILE : (enum weight_kind)act_number(act, "FILE"), 0};
    const enum err err = take_argument(&kept->weight, act);
    if (err)
        return err;
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

/* After a command that may have changed it: what is inside now. */
static enum err add_roi(const struct act *act, enum err err)
{
    const struct session *session = act->session;
    const struct roi_tally *tally = session_roi_tally(session);
    struct reply *reply = act->reply;
    if (err)
        return err;
    act_add_digest(act, "fence", tally->digest);
    buf_printf(&reply->words, " inside=%zu", tally->inside);
    buf_printf(&reply->text, "%zu of %zu voxels %s inside the region of interest\n", tally->inside,
               session_scene(session)->grid.voxels, tally->inside == 1 ? "is" : "are");
    return OK;
}

static void fill_mask(uint64_t *mask, const struct volume *map, const struct scene *scene)
{
    const struct grid *grid = &scene->grid;
    struct task task = task_begin(scene->watch, "voxels of the mask", grid->voxels);
    const uint16_t *region = map->intensity;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++)
                mask[c >> 6] |= (uint64_t)(*region++ != REGION_NONE) << (c & 63);
            if (!task_advance(&task, grid->size[0]))
                return;
        }
}

static enum err mask_by_file(const struct act *act)
{
    struct session *session = act->session;
    const char *name = act_text(act, "FILE");
    const struct value *given = act_value(act, "regions");
    const uint32_t regions[2] = {given->given ? given->place[0] : 1,
                                 given->given ? given->place[1] : (uint32_t)REGION_MOST};
    struct volume map = {0};
    uint64_t *mask = NULL;
    enum err err = act_read_map(act, &map);
    if (!err)
        err = act_naming(
            name, map_to_regions(&map, regions[0], regions[1], session_watch(session), act->fault),
            act->fault);
    if (!err && !(mask = mask_new(&session_scene(session)->grid)))
        err = fault_memory(act->fault, "a mask");
    if (!err) {
        fill_mask(mask, &map, session_scene(session));
        buf_add_text(&act->reply->text, map.notes);
        const struct roi alone = {mask, 0, UINT16_MAX}; /* without the range */
        act_add_digest(act, "file", roi_tally(&alone, session_scene(session)).digest);
        err = act_naming(name, session_set_mask(session, mask, name, regions, act->fault),
                         act->fault);
    }
    volume_release(&map);
    free(mask);
    return err;
}

enum err act_mask(const struct act *act)
{
    const bool is_file = act_number(act, "FILE") < 0;
    static const char *const of_map[] = {"regions", "resample", "volume", "data"};
    for (unsigned i = 0; i < sizeof of_map / sizeof *of_map; i++)
        if (!is_file && act_has(act, of_map[i]))
            return fault_set(act->fault, ERR_USAGE,
                             "%s: `mask none` has no %s; nothing has changed", of_map[i],
                             i ? "map" : "regions");
    return add_roi(act, is_file ? mask_by_file(act)
                                : session_set_mask(act->session, NULL, NULL, NULL, act->fault));
}

/* Of all voxels of the scene. */
static size_t count_unsure(const struct session *session, const struct decimal range[2])
{
    const struct grid *grid = &session_scene(session)->grid;
    const struct interval interval =
        levels_within(session_geometry(session), session_levels(session), range);
    size_t voxels = 0;
    for (uint32_t z = 0; interval.split[0] >= 0 && z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++)
                voxels += interval_splits(&interval, session_scene(session)->cell[c].intensity);
        }
    return voxels;
}

enum err act_range(const struct act *act)
{
    const bool is_range = !act_text(act, "LOW");
    const struct decimal range[2] = {act_value(act, "LOW")->real[0],
                                     act_value(act, "HIGH")->real[0]};
    if (is_range != act_has(act, "HIGH"))
        return fault_set(act->fault, ERR_USAGE,
                         "expected LOW and HIGH, or none alone; nothing has changed");
    if (is_range && decimal_value(&range[1]) < decimal_value(&range[0]))
        return fault_set(act->fault, ERR_USAGE, "HIGH is below LOW; nothing has changed");
    enum err err = session_set_range(act->session, is_range ? range : NULL, act->fault);
    err = add_roi(act, err);
    if (!err && is_range)
        act_write_unsure(act, count_unsure(act->session, range));
    return err;
}
