/*
 * The walk of a pixel's ray through the scene, from cube to cube.
 *
 * It goes from crossing to crossing in the order of (t, axis). At crossing `at` the ray is in the
 * cube whose flipped position along axis b is the number of planes of b, after plane 0, that have
 * been crossed by then.
 */
#ifndef RENDER_WALK_H
#define RENDER_WALK_H

#include "render/view.h"

struct walk {
    const struct camera *camera;
    int64_t at;      /* the crossing by which the ray has come into the cube, */
    uint32_t cell;   /* and that cube's voxel */
    int64_t next[3]; /* crossings of the planes ahead */
    int64_t left[3]; /* planes of each axis still ahead before the ray leaves the scene */
};

/* To the cube in which the ray is at `from`, or is first where it comes into the scene later;
 * INT64_MIN starts before the scene. False where it is in none. */
static inline bool walk_begin(struct walk *walk, const struct camera *camera, uint32_t column,
                              uint32_t row, int64_t from)
{
    const struct grid *grid = &camera->scene->grid;
    int64_t first[3], at = from;
    for (int a = 0; a < 3; a++) {
        first[a] = camera_crossing(camera, a, 0, column, row);
        at = first[a] > at ? first[a] : at;
    }
    walk->camera = camera;
    walk->at = at;
    walk->cell = grid_cell(grid, 0, 0, 0);
    for (int a = 0; a < 3; a++) {
        const int64_t n = (at - first[a]) / camera->T[a];
        walk->left[a] = (int64_t)grid->size[a] - n;
        if (walk->left[a] <= 0)
            return false;
        walk->next[a] = first[a] + (n + 1) * camera->T[a];
        const int64_t along = camera->flip[a] ? walk->left[a] - 1 : n;
        walk->cell = (uint32_t)(walk->cell + along * grid->step[a]);
    }
    return true;
}

/* To the next cube; false where the ray leaves the scene. */
static inline bool walk_on(struct walk *walk)
{
    int a = walk->next[0] < walk->next[1] ? 0 : 1;
    a = walk->next[a] < walk->next[2] ? a : 2;
    if (--walk->left[a] == 0)
        return false;
    walk->at = walk->next[a];
    walk->next[a] += walk->camera->T[a];
    walk->cell -= (uint32_t)walk->camera->toward[a];
    return true;
}

#endif
