/* SPDX-License-Identifier: MIT */
#include "apply/apply.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "engine/distance.h"
#include "engine/finish.h"
#include "engine/scene.h"
#include "image/geometry.h"
#include "session/tally.h"

/* An object keeps at least one of this many voxels. */
enum { KEEPS_ONE_OF = 10, BINS = 4096, FAR_MM = 5 };

void warped_release(struct warped *warped)
{
    free(warped->label);
    warped->label = NULL;
}

/* ---- warped ---- */

/* Label at a place, in voxels of the procedure. */
static uint16_t label_at(const struct procedure *p, const double at[3])
{
    size_t index = 0;
    for (int a = 2; a >= 0; a--) {
        const double nearest = floor(at[a] + 0.5);
        if (!(nearest >= 0 && nearest < p->size[a]))
            return WARP_NONE;
        index = index * p->size[a] + (size_t)nearest;
    }
    return p->voxel[index];
}

enum err warp_labels(struct warped *warped, const struct procedure *p,
                     const struct session *session, const struct affine *pull, struct fault *fault)
{
    const struct grid *grid = &session->scene->grid;
    struct affine way, mm;
    *warped = (struct warped){.voxels = grid->voxels};
    memcpy(mm.m, session->geometry.to_mm, sizeof mm.m);
    affine_invert(&way, &p->to_mm);
    affine_compose(&mm, pull, &mm);
    affine_compose(&way, &way, &mm);
    warped->label = mem_array(grid->voxels, sizeof *warped->label);
    if (!warped->label)
        return fault_memory(fault, "the labels of a procedure");
    struct task task = task_begin(session->watch, "labels carried over", grid->size[2]);
    uint16_t *to = warped->label;
    size_t common = 0;
    for (uint32_t z = 0; z < grid->size[2] && task_advance(&task, 1); z++)
        for (uint32_t y = 0; y < grid->size[1]; y++)
            for (uint32_t x = 0; x < grid->size[0]; x++) {
                double at[3];
                affine_apply(&way, (const double[]){x, y, z}, at);
                *to = label_at(p, at);
                common += *to++ != WARP_NONE;
            }
    TRY(watch_fault(session->watch, fault));
    if (!common)
        return fault_set(
            fault, ERR_INPUT,
            "no voxel of it is inside the procedure's scene: the scenes do not overlap");
    return percentiles_find(&warped->percentiles, session, warped->label, fault);
}

/* ---- gated ---- */

void warp_find_gates(struct warped *warped, const struct procedure *p, double gate)
{
    for (unsigned l = 0; l < 256; l++) {
        const double spread = p->label[l].high - p->label[l].low,
                     here = warped->percentiles.high[l] - warped->percentiles.low[l];
        const bool is_open = l == 0 || gate <= 0 || !warped->percentiles.voxels[l] || spread <= 0;
        warped->within[l][0] = is_open ? 1 : warped->percentiles.low[l] - gate * here;
        warped->within[l][1] = is_open ? 0 : warped->percentiles.high[l] + gate * here;
    }
}

/* ---- eroded ---- */

static bool differs(const uint16_t *label, const struct grid *grid, uint32_t x, uint32_t y,
                    uint32_t z, size_t i)
{
    const size_t step[3] = {1, grid->size[0], (size_t)grid->size[0] * grid->size[1]};
    const uint32_t at[3] = {x, y, z};
    for (int a = 0; a < 3; a++)
        if ((at[a] > 0 && label[i - step[a]] != label[i]) ||
            (at[a] + 1 < grid->size[a] && label[i + step[a]] != label[i]))
            return true;
    return false;
}

/* Compute the distance of each voxel to the nearest voxel at a border of labels, in bins of
 * `bin_mm`. */
static enum err find_depths(uint16_t *depth, const struct warped *warped,
                            const struct session *session, double bin_mm, struct fault *fault)
{
    const struct scene *scene = session->scene;
    const struct grid *grid = &scene->grid;
    const struct distance_scale scale = distance_scale_of(scene->spacing_nm, grid->size);
    OWNED(mem_release) uint64_t *squared = mem_array(grid->voxels, sizeof *squared);
    if (!squared)
        return fault_memory(fault, "the depth of labels");
    size_t i = 0;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++)
            for (uint32_t x = 0; x < grid->size[0]; x++, i++)
                squared[i] = differs(warped->label, grid, x, y, z, i) ? 0 : DISTANCE_NONE;
    TRY(distance_spread(squared, grid->size, &scale, session->team, session->watch, fault));
    for (i = 0; i < grid->voxels; i++) {
        const double mm = sqrt((double)squared[i]) * ((double)scale.unit_nm / 1e6);
        depth[i] = squared[i] == DISTANCE_NONE || mm >= (BINS - 1) * bin_mm
                       ? BINS - 1
                       : (uint16_t)(mm / bin_mm + 1e-9);
    }
    return OK;
}

/* Deepest bin up to `most` that leaves a tenth of the voxels. */
static unsigned find_least(const uint64_t *count, uint64_t voxels, unsigned most)
{
    uint64_t left = voxels;
    unsigned at = 0;
    while (at < most && (left - count[at]) * KEEPS_ONE_OF >= voxels)
        left -= count[at++];
    return at;
}

enum err warp_seeds(struct warped *warped, const struct session *session, double depth_mm,
                    struct fault *fault)
{
    const struct scene *scene = session->scene;
    const struct grid *grid = &scene->grid;
    const unsigned most = BINS / 4;
    const double bin_mm = depth_mm / most;
    OWNED(mem_release) uint16_t *depth = mem_array(grid->voxels, sizeof *depth);
    OWNED(mem_release) uint64_t(*count)[BINS] = mem_new(256 * sizeof *count);
    unsigned least[256];
    if (!depth || !count)
        return fault_memory(fault, "the depth of labels");
    TRY(find_depths(depth, warped, session, bin_mm, fault));
    for (size_t i = 0; i < grid->voxels; i++)
        if (warped->label[i] < 256)
            count[warped->label[i]][depth[i]]++;
    for (unsigned l = 0; l < 256; l++) {
        least[l] = find_least(count[l], warped->percentiles.voxels[l], most);
        warped->depth_mm[l] = least[l] * bin_mm;
    }
    uint16_t *label = warped->label;
    for (struct grid_walk w = grid_rows(grid, NULL, NULL); grid_walk_next(&w);)
        for (uint32_t c = w.row.first; c < w.row.end; c++, label++) {
            const unsigned l = *label;
            if (l == WARP_NONE || depth[label - warped->label] < least[l]) {
                *label = 0;
                continue;
            }
            const bool fits = warp_may_have(warped->within[l], percentiles_value(session, c));
            warped->eroded[l]++;
            warped->dropped[l] += !fits;
            *label = (uint16_t)(l == 0 ? SEEDS_BACKGROUND : fits ? l : l + SEEDS_DROPPED);
        }
    return watch_fault(session->watch, fault);
}

/* ---- far from the warped label ---- */

/* Box around a label, warped and in the session. */
struct extent {
    struct finish_box box;
    uint64_t warped;
};

static void find_extents(struct extent extent[256], const struct warped *warped,
                         const struct scene *scene)
{
    const uint16_t *from = warped->label;
    for (unsigned l = 0; l < 256; l++)
        extent[l] = (struct extent){.box = finish_box_none()};
    for (struct grid_walk w = grid_rows(&scene->grid, NULL, NULL); grid_walk_next(&w);)
        for (uint32_t x = 0; x < scene->grid.size[0]; x++, from++) {
            const struct finish_box voxel = {{x, w.y, w.z}, {x, w.y, w.z}};
            finish_box_include(&extent[scene->cell[w.row.first + x].label].box, &voxel);
            if (*from < 256 && ++extent[*from].warped)
                finish_box_include(&extent[*from].box, &voxel);
        }
}

/* The square of the distance beyond which a voxel is far, in units of the scale. A ball of radius
 * 3 d has a volume of 36 pi d^3, about 113 d^3. */
static uint64_t find_far(double mm3, const struct distance_scale *scale)
{
    uint64_t mm = FAR_MM;
    while (mm < 1000 && 113 * (mm + 1) * (mm + 1) * (mm + 1) <= (uint64_t)mm3)
        mm++;
    return mm * 1000000 * mm * 1000000 / (scale->unit_nm * scale->unit_nm);
}

/* Count the far voxels of one label, with room for its box. */
static enum err count_far(uint64_t *far, uint64_t *squared, const struct extent *extent,
                          unsigned label, const struct warped *warped,
                          const struct session *session, struct fault *fault)
{
    const struct scene *scene = session->scene;
    const struct grid *grid = &scene->grid;
    const struct distance_scale scale = distance_scale_of(scene->spacing_nm, grid->size);
    const uint64_t most =
        find_far((double)extent->warped * tally_voxel_mm3(&session->geometry), &scale);
    const uint32_t *low = extent->box.first, *high = extent->box.last;
    const uint32_t size[3] = {high[0] - low[0] + 1, high[1] - low[1] + 1, high[2] - low[2] + 1};
    for (int pass = 0; pass < 2; pass++) {
        size_t i = 0;
        for (uint32_t z = low[2]; z <= high[2]; z++)
            for (uint32_t y = low[1]; y <= high[1]; y++) {
                const uint16_t *from =
                    warped->label + ((size_t)z * grid->size[1] + y) * grid->size[0];
                const struct cell *cell = scene->cell + grid_row(grid, y, z).first;
                for (uint32_t x = low[0]; x <= high[0]; x++, i++)
                    if (pass == 0)
                        squared[i] = from[x] == label ? 0 : DISTANCE_NONE;
                    else
                        *far += cell[x].label == label && squared[i] > most;
            }
        TRY(pass ? OK
                 : distance_spread(squared, size, &scale, session->team, session->watch, fault));
    }
    return OK;
}

enum err warp_count_far(uint64_t far[256], const struct warped *warped,
                        const struct session *session, struct fault *fault)
{
    OWNED(mem_release) struct extent *extent = mem_new(256 * sizeof *extent);
    OWNED(mem_release)
    uint64_t *squared = mem_array(session->scene->grid.voxels, sizeof *squared);
    if (!extent || !squared)
        return fault_memory(fault, "the distance of labels");
    find_extents(extent, warped, session->scene);
    for (unsigned l = 1; l < 256; l++) {
        far[l] = 0;
        if (!finish_box_is_empty(&extent[l].box) && session->tally.voxels[l])
            TRY(count_far(&far[l], squared, &extent[l], l, warped, session, fault));
    }
    return OK;
}
