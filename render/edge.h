/* SPDX-License-Identifier: MIT */
/*
 * Edges: lines where one object hides another or a part of itself, and where its surface is folded.
 *
 * A line is drawn on the front surface, as wide as one pixel of the picture, whatever the number of
 * samples. In front of the background it is light, with a dark line inside, so that one of them
 * shows against any background.
 *
 * Surfaces that are merely steep have no lines: their slope explains the difference of depths.
 * Objects that touch have one, on the object with the lower label.
 *
 * The line of a pixel depends on labels, depths and normals at most edge_reach pixels away.
 */
#ifndef RENDER_EDGE_H
#define RENDER_EDGE_H

#include "render/rendition.h"

/* A run of pixels of a row or column on one surface of one object. It is cached for the next pixel:
 * a fold compares normals three voxels to either side, and each may cover sixty-four pixels. */
struct edge_run {
    int64_t line; /* the row or column; -1 for none */
    int64_t first, last;
    bool begins, ends; /* the pixel before the first, or after the last, shows another surface */
};

struct edges {
    const struct rendition *rendition; /* its labels, depths and normals are complete */
    const struct camera *camera;
    int64_t width;                /* width of a line, in pixels of the rendition */
    int64_t voxel;                /* longest side of a voxel, in 256ths of those */
    int64_t fold;                 /* distance to either side at which normals are compared, in
                                     pixels */
    struct edge_run run[2][TILE]; /* along rows, along columns */
};

/* Initialise for a rendition in which `samples` pixels a side form one of the picture. */
void edges_init(struct edges *edges, const struct rendition *rendition, const struct camera *camera,
                uint32_t samples);

enum edge { EDGE_NONE, EDGE_DARK, EDGE_LIGHT };

/* Return the edge of a pixel that shows something; fastest for the pixels of one tile in
 * succession. */
enum edge edge_at(struct edges *edges, uint32_t x, uint32_t y);

int edge_reach(const struct camera *camera, uint32_t samples);

#endif
