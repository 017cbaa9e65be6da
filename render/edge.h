/* SPDX-License-Identifier: MIT */
/*
 * Edges: lines that show where one object hides another, where it hides a part of itself, and where
 * its surface is folded.
 *
 * A line lies on what is in front, and is as wide as one pixel of the picture, however many samples
 * that is made of. Where nothing is behind, it is light, with a dark one within, so that one of
 * them shows against any background.
 *
 * Surfaces that are only steep have no lines: their slope explains how far depths differ. Objects
 * that touch have one, on the one with the lower label.
 *
 * Which line a pixel has depends on labels, depths and normals at most edge_reach pixels away.
 */
#ifndef RENDER_EDGE_H
#define RENDER_EDGE_H

#include "render/rendition.h"

/* Pixels of a row or column from one to another that lie on one surface of one object. What has
 * been looked at is known for the next pixel: a fold is looked for three voxels to either side,
 * and those may have sixty-four pixels each. */
struct edge_run {
    int64_t line; /* the row or column; -1 for none */
    int64_t first, last;
    bool begins, ends; /* the pixel before the first, or after the last, is of another surface */
};

struct edges {
    const struct rendition *rendition; /* labels, depths and normals are there */
    const struct camera *camera;
    int64_t width;                /* of a line, in pixels of the rendition */
    int64_t voxel;                /* its longest side, in 256ths of those */
    int64_t fold;                 /* how far to either side normals are compared, in pixels */
    struct edge_run run[2][TILE]; /* along rows, along columns */
};

/* For a rendition in which `samples` pixels a side are one of the picture. */
void edges_init(struct edges *edges, const struct rendition *rendition, const struct camera *camera,
                uint32_t samples);

enum edge { EDGE_NONE, EDGE_DARK, EDGE_LIGHT };

/* Of a pixel that shows something; those of a tile after each other are fastest. */
enum edge edge_at(struct edges *edges, uint32_t x, uint32_t y);

int edge_reach(const struct camera *camera, uint32_t samples);

#endif
