/* SPDX-License-Identifier: MIT */
/*
 * Projection: four ways to compute the voxel of each pixel (render/rendition.h), with one result.
 *
 *     scene projection    draws every quad of every brick of the mesh, in the order of the scene
 *     border projection   draws bricks from the nearest to the furthest, and skips bricks hidden
 *                         by those drawn before
 *     ray walk            examines, pixel by pixel, the bricks along its ray
 *     incremental image   redraws the pixels that are out of date (render/incremental.h)
 *
 * They differ only in the bricks they examine, and their order. A quad is two triangles. Corners
 * are rounded to 256ths of pixels, independently of their brick; a front-facing triangle covers a
 * pixel by the signs of three edge functions, and an edge through the pixel's centre belongs to one
 * of its two triangles; the depth is interpolated. A pixel keeps the least key: depth, whose last
 * bits are face * 2 + triangle, then the voxel.
 *
 * With translucent objects, each pixel keeps the layers of render/layers.h in the same ways.
 */
#ifndef RENDER_PROJECTION_H
#define RENDER_PROJECTION_H

#include "render/mesh.h"
#include "render/rendition.h"

enum {
    POINT_BITS = 8,  /* fraction bits of corners' positions, in pixels */
    NUMBER_BITS = 4, /* low bits of a depth: face * 2 + triangle */
    NUMBER_MASK = (1 << NUMBER_BITS) - 1,
};

typedef void projection(struct rendition *rendition, const struct camera *camera,
                        const struct mesh *mesh);

/* The rendition has the camera's size, the mesh is up to date. They and shading run under the
 * scene's watch: if it stops them, the picture is undefined. */
projection project_scene, project_border, project_rays;

/* Border projection as part of the work of several threads: all but thread 0 end early if the watch
 * has stopped, without polling it. */
void project_border_part(struct rendition *rendition, const struct camera *camera,
                         const struct mesh *mesh, unsigned thread);

/* Border projection by a team, each thread with its own rows. */
void project_border_shared(struct rendition *rendition, const struct camera *camera,
                           const struct mesh *mesh, struct team *team);

/* Redraw the pixels of stale tiles. */
void project_stale(struct rendition *rendition, const struct camera *camera,
                   const struct mesh *mesh);

/* Return the position of a voxel's centre: column, row and depth, in pixels times 2^30. */
void project_place(const struct camera *camera, struct place place, int64_t centre[3]);

/* Return the pixels that a voxel and those up to `around` steps away may cover. */
struct footprint project_around(const struct camera *camera, uint32_t cell, int around);

/* ---- triangles under pixels ---- */

/* The camera's view of the mesh. */
struct drawer {
    const struct camera *camera;
    const struct mesh *mesh;
    int64_t step[3][3]; /* columns, rows, depth: the change for one voxel along each axis */
    bool is_mirrored;   /* corners run the other way round in the picture */
};
void drawer_init(struct drawer *drawer, const struct camera *camera, const struct mesh *mesh);

/* The pixels that something may cover, and a lower limit of its depth. */
struct sight {
    struct footprint pixels;
    int64_t near;
};
struct sight project_quad(const struct drawer *drawer, uint32_t number,
                          const struct mesh_brick *brick, const struct mesh_quad *quad);

/* Return true if all these pixels show something nearer and opaque. */
bool project_is_hidden(const struct rendition *rendition, const struct sight *sight);

/* The signed distance of a pixel from an edge: twice the area between the two. */
struct edge_function {
    int64_t at, right, down; /* value at a pixel, and its change for one pixel to the right and one
                                down */
};

/* A triangle of a voxel, by its number in depths. */
struct seen {
    uint32_t cell;
    unsigned number;
    uint8_t open;                  /* 0, or its face if that is closed, counted from 1 */
    int16_t normal[3][4];          /* normals of its corners */
    struct edge_function share[2]; /* weights of the first two corners, at pixel 0, 0 */
    int64_t all;                   /* sum of all three weights, positive */
};
void drawer_triangle(const struct drawer *drawer, struct seen *seen, unsigned number,
                     uint32_t cell);

#endif
