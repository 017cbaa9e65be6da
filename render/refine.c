#include "render/refine.h"

#include "engine/gradient.h"

enum {
    STEP_BITS = 16,
    RATIO_BITS = 15,
    FINER = STEP_BITS - LOCATOR_POINT_BITS,
    FULL = 2,
    NEARLY = 64 * FIELD_INSIDE_UNIT, /* inside */
};

/* Half a voxel is half of the length, in voxels along all axes, that the ray goes in one along the
 * axis of which it crosses the most planes. */
static int64_t pace_of(const struct camera *camera)
{
    int64_t least = camera->T[0];
    uint64_t squares = 0;
    for (int a = 1; a < 3; a++)
        least = camera->T[a] < least ? camera->T[a] : least;
    for (int a = 0; a < 3; a++) {
        const uint64_t ratio = (uint64_t)((least << RATIO_BITS) / camera->T[a]);
        squares += ratio * ratio;
    }
    const int64_t pace = (least << RATIO_BITS) / (2 * (int64_t)square_root(squares));
    return pace > 0 ? pace : 1;
}

void refiner_init(struct refiner *refiner, const struct camera *camera, const struct border *border)
{
    *refiner = (struct refiner){.camera = camera,
                                .border = border,
                                .pace = pace_of(camera),
                                .cuts = !cut_is_none(&border->cut)};
    for (int a = 0; a < 3; a++) {
        const int64_t step = (refiner->pace << STEP_BITS) / camera->T[a];
        refiner->locator[a] = locator_of(camera, a);
        refiner->step[a] = camera->flip[a] ? -step : step;
    }
}

/* ---- along a ray ---- */

/* A point on a ray, in 2^-16 voxels, and what is there. */
struct sample {
    int64_t depth, at[3];
    int32_t inside;
};

static void look(struct sample *sample, struct refiner *refiner)
{
    int32_t point[3];
    for (int a = 0; a < 3; a++)
        point[a] = (int32_t)(sample->at[a] >> FINER);
    sample->inside = field_at(&refiner->shown, point).along[3];
}

static struct sample sample_at(struct refiner *refiner, uint32_t x, uint32_t y, int64_t depth)
{
    struct sample sample = {.depth = depth};
    for (int a = 0; a < 3; a++)
        sample.at[a] = (int64_t)locator_point(&refiner->locator[a], depth, x, y) * (1 << FINER);
    look(&sample, refiner);
    return sample;
}

/* The cell of the voxel in whose cube a point lies, or CELL_NONE outside the scene. */
static uint32_t cell_at(const struct grid *grid, const int64_t at[3])
{
    uint32_t place[3];
    for (int a = 0; a < 3; a++) {
        const int64_t p = (at[a] + (1 << (STEP_BITS - 1))) >> STEP_BITS;
        if (p < 0 || p >= grid->size[a])
            return CELL_NONE;
        place[a] = (uint32_t)p;
    }
    return grid_cell(grid, place[0], place[1], place[2]);
}

/* The shown voxel that a point in a solid one belongs to: it, or its shown neighbour whose centre
 * is nearest to the point. */
static uint32_t owner_of(const struct refiner *refiner, uint32_t cell, const int64_t at[3])
{
    const struct grid *grid = &refiner->camera->scene->grid;
    if (border_shows(refiner->border, cell))
        return cell;
    const struct place p = grid_place(grid, cell);
    const int64_t centre[3] = {p.x, p.y, p.z};
    uint32_t owner = cell;
    int64_t nearest = INT64_MIN;
    for (int i = 0; i < 6; i++) {
        const int a = i / 2, sign = i % 2 ? 1 : -1;
        const int64_t toward = sign * (at[a] - (centre[a] << STEP_BITS));
        const uint32_t beside = cell + (uint32_t)(sign * grid->step[a]);
        if (toward > nearest && border_shows(refiner->border, beside)) {
            nearest = toward;
            owner = beside;
        }
    }
    return owner;
}

/* What is found on a ray; the low bits of its depth are those of a crossing, or REFINE_WITHIN. */
struct found {
    int64_t depth;
    uint32_t cell;
};

/* Where the ray comes inside between two samples of which the latter is. */
static struct found found_between(const struct refiner *refiner, const struct sample *before,
                                  const struct sample *after, uint32_t cell_after)
{
    const int32_t rise = after->inside - before->inside;
    const int32_t share = before->inside < 0 ? -before->inside : 0;
    struct sample surface = {.depth =
                                 before->depth + (after->depth - before->depth) * share / rise};
    for (int a = 0; a < 3; a++)
        surface.at[a] = before->at[a] + (after->at[a] - before->at[a]) * share / rise;
    const uint32_t cell = cell_at(&refiner->camera->scene->grid, surface.at);
    const bool is_solid = cell != CELL_NONE && border_is_solid(refiner->border, cell);
    return (struct found){surface.depth | REFINE_WITHIN,
                          owner_of(refiner, is_solid ? cell : cell_after, surface.at)};
}

/* `share` of FULL of the way to the next sample. */
static struct sample sample_after(const struct refiner *refiner, const struct sample *before,
                                  int share)
{
    struct sample after = {.depth = before->depth + refiner->pace * share / FULL};
    for (int a = 0; a < 3; a++)
        after.at[a] = before->at[a] + refiner->step[a] * share / FULL;
    return after;
}

/* What is thinner than a step may lie between two samples that are both nearly inside. */
static bool lies_between(struct sample *middle, struct refiner *refiner,
                         const struct sample *before, const struct sample *after)
{
    if (before->inside < -NEARLY || after->inside < -NEARLY)
        return false;
    *middle = sample_after(refiner, before, FULL / 2);
    look(middle, refiner);
    return middle->inside > 0;
}

/* Follows a ray from a solid cube on as long as it is in solid voxels. True where it comes inside;
 * otherwise `found` is where it has left them. */
static bool follow(struct found *found, struct refiner *refiner, uint32_t x, uint32_t y)
{
    const struct grid *grid = &refiner->camera->scene->grid;
    struct sample before = sample_at(refiner, x, y, found->depth), after, middle;
    if (before.inside > 0) {
        found->cell = owner_of(refiner, found->cell, before.at);
        return true;
    }
    for (;; before = after) {
        after = sample_after(refiner, &before, FULL);
        const uint32_t cell = cell_at(grid, after.at);
        found->depth = after.depth | REFINE_WITHIN;
        if (cell == CELL_NONE || !border_is_solid(refiner->border, cell))
            return false;
        look(&after, refiner);
        if (after.inside <= 0 && !lies_between(&middle, refiner, &before, &after))
            continue;
        *found = found_between(refiner, &before, after.inside > 0 ? &after : &middle, cell);
        return true;
    }
}

/* Whether a ray comes into a voxel through a face that is cut open. */
static bool is_cut_open(const struct refiner *refiner, const struct found *found)
{
    return refiner->cuts && (found->depth & 3) != REFINE_WITHIN &&
           border_shows(refiner->border, found->cell) &&
           border_is_cut(refiner->border,
                         found->cell + (uint32_t)refiner->camera->toward[found->depth & 3]);
}

void refine_pixel(struct rendition *r, struct refiner *refiner, uint32_t x, uint32_t y)
{
    const size_t pixel = (size_t)y * r->width + x;
    struct found found = {r->cube.depth[pixel], r->cube.cell[pixel]};
    while (found.cell != CELL_NONE && !is_cut_open(refiner, &found) &&
           !follow(&found, refiner, x, y))
        if (!raycast_pixel(refiner->camera, refiner->border, x, y, found.depth, &found.depth,
                           &found.cell))
            found = (struct found){DEPTH_NONE, CELL_NONE};
    r->depth[pixel] = found.depth;
    r->cell[pixel] = found.cell;
}
