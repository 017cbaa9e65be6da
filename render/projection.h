/* SPDX-License-Identifier: MIT */
/*
 * Projection: the ways to what each pixel shows (render/rendition.h). All give the same.
 *
 *     scene projection    draws every quad of every brick of the mesh, in the order of the scene
 *     border projection   takes bricks from the nearest to the furthest, and passes over those
 *                         that lie behind what has been drawn
 *     ray walk            looks, pixel by pixel, at the bricks along its ray
 *     incremental image   draws the pixels anew that are out of date (render/incremental.h)
 *
 * They differ in which bricks they look at, and in what order, and in nothing else. A quad is two
 * triangles. Corners fall on 256ths of pixels, wherever their brick begins; a triangle that faces
 * us covers a pixel by the signs of three edge functions, where an edge through the pixel's centre
 * belongs to one of the two triangles beside it; its depth there follows from its corners. A pixel
 * takes the least key: depth, and in its last bits face * 2 + triangle, then the voxel.
 *
 * Where objects are translucent, each pixel takes the layers of render/layers.h in these ways.
 */
#ifndef RENDER_PROJECTION_H
#define RENDER_PROJECTION_H

#include "render/mesh.h"
#include "render/rendition.h"

enum {
    POINT_BITS = 8,  /* of a pixel, in places of corners in a picture */
    NUMBER_BITS = 4, /* of a depth: face * 2 + triangle */
    NUMBER_MASK = (1 << NUMBER_BITS) - 1,
};

typedef void projection(struct rendition *rendition, const struct camera *camera,
                        const struct mesh *mesh);

/* The rendition has the camera's size, the mesh is up to date. These and shading are done under the
 * scene's watch: what ends early is of no use. */
projection project_scene, project_border, project_rays;

/* Border projection as part of one of several threads: others than thread 0 end early where the
 * watch has stopped, but do not poll it. */
void project_border_part(struct rendition *rendition, const struct camera *camera,
                         const struct mesh *mesh, unsigned thread);

/* Border projection by a team, each thread with rows of its own. */
void project_border_shared(struct rendition *rendition, const struct camera *camera,
                           const struct mesh *mesh, struct team *team);

/* Makes the pixels of stale tiles anew. */
void project_stale(struct rendition *rendition, const struct camera *camera,
                   const struct mesh *mesh);

/* Where the centre of a voxel falls: column and row, in pixels times 2^30, and depth likewise. */
void project_place(const struct camera *camera, struct place place, int64_t centre[3]);

/* The pixels that a voxel and those up to `around` steps away may cover. */
struct footprint project_around(const struct camera *camera, uint32_t cell, int around);

/* ---- what is under a pixel ---- */

/* How the camera sees the mesh. */
struct drawer {
    const struct camera *camera;
    const struct mesh *mesh;
    int64_t step[3][3]; /* columns, rows, depth: what a voxel's step along each axis adds */
    bool is_mirrored;   /* corners go round the other way in the picture */
};
void drawer_init(struct drawer *drawer, const struct camera *camera, const struct mesh *mesh);

/* What something may cover of a picture, and a depth that it does not come nearer than. */
struct sight {
    struct footprint pixels;
    int64_t near;
};
struct sight project_quad(const struct drawer *drawer, uint32_t number,
                          const struct mesh_brick *brick, const struct mesh_quad *quad);

/* Whether each of these pixels shows something nearer, which is opaque. */
bool project_is_hidden(const struct rendition *rendition, const struct sight *sight);

/* On which side of an edge a pixel lies: twice the area between the two. */
struct edge_function {
    int64_t at, right, down; /* at a pixel; what one to the right and one down adds */
};

/* A triangle of a voxel, by the number in depths. */
struct seen {
    uint32_t cell;
    unsigned number;
    uint8_t open;                  /* 0, or its face where that is closed, counted from 1 */
    int16_t normal[3][4];          /* of its corners */
    struct edge_function share[2]; /* from pixel 0, 0 on: how near the first two corners are; */
    int64_t all;                   /* and what those of all three come to, above 0 */
};
void drawer_see(const struct drawer *drawer, struct seen *seen, unsigned number, uint32_t cell);

#endif
