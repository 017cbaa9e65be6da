/* Commands that restrict the forest to a region of interest, and what others say of it. */
#include "command/act.h"

#include <stdlib.h>

#include "engine/roi.h"
#include "session/map.h"

enum err act_naming(const char *file, enum err err, struct fault *fault)
{
    return err ? fault_prefix(fault, err, "%s", file) : OK;
}

static void write_interval(struct buf *out, const char *before, const struct decimal range[2])
{
    buf_add_text(out, before);
    decimal_write(out, &range[0]);
    buf_add_text(out, "..");
    decimal_write(out, &range[1]);
}

void act_write_unsure(const struct act *act, size_t voxels)
{
    if (voxels)
        buf_printf(&act->reply->text,
                   "%zu voxel%s a level that an end of the range cuts: a level is %.3g, and values "
                   "are known to half of it\n",
                   voxels, voxels == 1 ? " has" : "s have", session_levels(act->session)->step);
}

bool act_write_roi(struct buf *out, const struct session *session)
{
    const struct kept *kept = session_kept(session);
    if (kept->mask) {
        buf_add_text(out, "mask ");
        buf_add_safe_text(out, kept->mask_file);
        buf_printf(out, " regions %u-%u", kept->mask_regions[0], kept->mask_regions[1]);
    }
    if (kept->has_range)
        write_interval(out, kept->mask ? ", range " : "range ", kept->range);
    return kept->mask || kept->has_range;
}

/* After a command that may have changed it: what is inside now. */
static enum err add_roi(const struct act *act, enum err err)
{
    const struct session *session = act->session;
    const struct roi_tally *tally = session_roi_tally(session);
    struct reply *reply = act->reply;
    if (err)
        return err;
    buf_add_blank(&reply->words);
    buf_printf(&reply->words, "fence=%016llx inside=%zu", (unsigned long long)tally->digest,
               tally->inside);
    buf_printf(&reply->text, "%zu of %zu voxels %s inside the region of interest\n", tally->inside,
               session_scene(session)->grid.voxels, tally->inside == 1 ? "is" : "are");
    return OK;
}

/* Of the mask alone: the region of interest is what mask and range both leave. */
static uint64_t mask_digest(const uint64_t *mask, const struct scene *scene)
{
    const struct roi alone = {mask, 0, UINT16_MAX};
    return roi_tally(&alone, scene).digest;
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

/* The mask in a file; freed by free(). */
static enum err read_mask(uint64_t **mask, const struct act *act, const char *path,
                          const uint32_t regions[2])
{
    const struct session *session = act->session;
    const char *name = act_text(act, "FILE");
    struct fault *fault = act->fault;
    const struct grid *grid = &session_scene(session)->grid;
    struct volume map = {0};
    *mask = NULL;
    const struct map_place place = session_map_place(session, act_is_yes(act, "resample"));
    enum err err = map_read(&map, path, &place, session_watch(session), fault);
    if (!err)
        err = act_naming(
            name, map_to_regions(&map, regions[0], regions[1], session_watch(session), fault),
            fault);
    if (!err && !(*mask = mask_new(grid)))
        err = fault_memory(fault, "a mask");
    if (!err)
        fill_mask(*mask, &map, session_scene(session));
    if (!err)
        buf_add_text(&act->reply->text, map.notes);
    volume_release(&map);
    return err;
}

static enum err mask_by_file(const struct act *act)
{
    struct session *session = act->session;
    const char *name = act_text(act, "FILE");
    const struct value *given = act_value(act, "regions");
    const uint32_t regions[2] = {given->given ? given->place[0] : 1,
                                 given->given ? given->place[1] : (uint32_t)REGION_MOST};
    struct buf path = {0};
    uint64_t *mask = NULL;
    enum err err = interpreter_find_file(act->interp, name, &path, act->fault);
    if (!err)
        err = read_mask(&mask, act, buf_text(&path), regions);
    buf_release(&path);
    if (err)
        return err;
    buf_printf(&act->reply->words, "file=%016llx",
               (unsigned long long)mask_digest(mask, session_scene(session)));
    err = act_naming(name, session_set_mask(session, mask, name, regions, act->fault), act->fault);
    free(mask);
    return err;
}

enum err act_mask(const struct act *act)
{
    const bool is_file = act_number(act, "FILE") < 0;
    if (!is_file && act_has(act, "regions"))
        return fault_set(act->fault, ERR_USAGE,
                         "regions: `mask none` has no regions; nothing has changed");
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
