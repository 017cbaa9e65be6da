/* Commands that region of interest the forest in, and what others say of the region of interest. */
#include "command/act.h"

#include <string.h>

#include "session/map.h"

/* The places of the parameters in the table. */
enum { MASK_FILE, MASK_REGIONS };
enum { RANGE_LOW, RANGE_HIGH };

bool act_is_outside(const struct session *session, uint32_t cell)
{
    return session->scene->cell[cell].flags & CELL_OUTSIDE;
}

enum err act_naming(const char *file, enum err err, struct fault *fault)
{
    return err ? fault_prefix(fault, err, "%s", file) : OK;
}

enum err act_tell_outside(struct reply *reply, size_t inside, size_t outside, struct fault *fault)
{
    if (outside && !inside)
        return fault_set(
            fault, ERR_INPUT,
            "all of it lies outside the fence, where no tree grows; plant elsewhere, or widen "
            "the fence with `mask` or `range` (`info` tells it); nothing was planted");
    if (outside)
        buf_printf(&reply->text, "left out, being outside the fence: %zu\n", outside);
    return OK;
}

bool act_write_roi(struct buf *out, const struct session *session)
{
    const struct settings *settings = &session->settings;
    if (session->roi.mask) {
        buf_add_text(out, "mask ");
        buf_add_safe(out, settings->mask_file, strlen(settings->mask_file));
        buf_printf(out, " regions %u-%u", settings->mask_regions[0], settings->mask_regions[1]);
    }
    if (settings->has_range)
        buf_printf(out, "%srange %g..%g", session->roi.mask ? ", " : "",
                   (double)settings->range_thousandths[0] / 1000,
                   (double)settings->range_thousandths[1] / 1000);
    return session->roi.mask || settings->has_range;
}

static void add_roi(struct reply *reply, const struct session *session)
{
    const struct roi_tally *tally = &session->roi_tally;
    buf_printf(&reply->words, "%sfence=%016llx inside=%zu", reply->words.length ? " " : "",
               (unsigned long long)tally->digest, tally->inside);
    buf_printf(&reply->text, "%zu of %zu voxels are inside the fence\n", tally->inside,
               session->scene->grid.voxels);
}

/* Of the mask alone: the digest of the region of interest does not see what the range leaves out. */
static uint64_t mask_digest(uint64_t *mask, const struct scene *scene)
{
    const struct roi alone = {mask, 0, UINT16_MAX};
    return roi_tally(&alone, scene).digest;
}

static void fill_mask(uint64_t *mask, const struct volume *map, const struct grid *grid)
{
    const uint16_t *region = map->intensity;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++)
                mask[c >> 6] |= (uint64_t)(*region++ != REGION_NONE) << (c & 63);
        }
}

/* The mask in a file; freed by free(). */
static enum err read_mask(uint64_t **mask, const struct session *session, const char *name,
                          const char *path, const uint32_t regions[2], struct fault *fault)
{
    const struct grid *grid = &session->scene->grid;
    struct volume map = {0};
    *mask = NULL;
    enum err err = map_read(&map, path, grid, &session->geometry, session->watch, fault);
    if (!err)
        err = act_naming(name, map_to_regions(&map, regions[0], regions[1], fault), fault);
    if (!err && !(*mask = mask_new(grid)))
        err = fault_memory(fault, "a mask");
    if (!err)
        fill_mask(*mask, &map, grid);
    volume_release(&map);
    return err;
}

static enum err mask_by_file(struct interpreter *interp, const struct value *value,
                             struct reply *reply, struct fault *fault)
{
    struct session *session = &interp->session;
    const char *name = value[MASK_FILE].text;
    const bool given = value[MASK_REGIONS].given;
    const uint32_t regions[2] = {given ? value[MASK_REGIONS].place[0] : 1,
                                 given ? value[MASK_REGIONS].place[1] : (uint32_t)REGION_MOST};
    struct buf path = {0};
    uint64_t *mask = NULL;
    enum err err = interpreter_find_file(interp, name, &path, fault);
    if (!err)
        err = read_mask(&mask, session, name, buf_text(&path), regions, fault);
    buf_release(&path);
    if (err)
        return err;
    buf_printf(&reply->words, "file=%016llx",
               (unsigned long long)mask_digest(mask, session->scene));
    return act_naming(name, session_set_mask(session, mask, name, regions, fault), fault);
}

ACT(mask)
{
    struct session *session = &interp->session;
    const bool is_file = value[MASK_FILE].number < 0;
    if (!is_file && value[MASK_REGIONS].given)
        return fault_set(fault, ERR_USAGE, "regions: no mask has none; nothing has changed");
    enum err err = is_file ? mask_by_file(interp, value, reply, fault)
                           : session_set_mask(session, NULL, NULL, NULL, fault);
    if (!err)
        add_roi(reply, session);
    return err;
}

ACT(range)
{
    struct session *session = &interp->session;
    const bool is_range = !value[RANGE_LOW].text;
    const int64_t thousandths[2] = {value[RANGE_LOW].number, value[RANGE_HIGH].number};
    if (is_range != value[RANGE_HIGH].given)
        return fault_set(fault, ERR_USAGE,
                         "expected LOW and HIGH, or none alone; nothing has changed");
    if (is_range && thousandths[1] < thousandths[0])
        return fault_set(fault, ERR_USAGE, "HIGH is below LOW; nothing has changed");
    enum err err = session_set_range(session, is_range ? thousandths : NULL, fault);
    if (!err)
        add_roi(reply, session);
    return err;
}
