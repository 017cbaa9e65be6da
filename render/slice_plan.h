/*
 * Where the pixels of a slice lie among the voxels; the inside of render/slice.h.
 *
 * Each side of the picture, columns and rows, runs along one axis of the scene. Lengths are counted
 * in picometres from the edge of the scene where the picture's side begins, and doubled, so that
 * centres of pixels and voxels are whole: voxel n has its centre at (2n + 1) * spacing_pm, pixel p
 * at origin2 + (2p + 1) * pixel_pm. Voxels are counted in the picture's direction here.
 */
#ifndef RENDER_SLICE_PLAN_H
#define RENDER_SLICE_PLAN_H

#include "render/slice.h"

struct slice_side {
    int axis;       /* of the scene */
    bool backwards; /* the axis runs against the picture */
    int64_t voxels, pixels;
    int64_t spacing_pm, pixel_pm;
    int64_t origin2;
    int64_t first, end; /* the pixels that show voxels */
};

struct slice_plan {
    struct slice_side side[2]; /* columns, rows */
    size_t corner;             /* the cell of the voxel that both sides begin with */
    ptrdiff_t step[2];         /* cells from a voxel to the next in the picture's direction */
    int across;                /* the axis that the slice cuts */
    uint32_t unit;             /* how many pixels a thin line is wide */
};

void slice_plan_init(struct slice_plan *plan, const struct scene *scene,
                     const struct slice_choice *choice, uint32_t width, uint32_t height);

/* The voxel under the centre of a pixel, and the pixel that holds the centre of a voxel; either may
 * lie outside. */
int64_t slice_side_voxel(const struct slice_side *side, int64_t pixel);
int64_t slice_side_pixel(const struct slice_side *side, int64_t voxel);

/* The last voxel whose centre does not lie beyond that of a pixel, and how far on the pixel's lies
 * towards the next one's, in 256ths. */
int64_t slice_side_between(const struct slice_side *side, int64_t pixel, uint32_t *part);

/* A voxel of the scene as counted in the picture. */
static inline int64_t slice_side_counted(const struct slice_side *side, const uint32_t place[3])
{
    return side->backwards ? side->voxels - 1 - place[side->axis] : place[side->axis];
}

#endif
