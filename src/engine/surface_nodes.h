/*
 * Nodes: the points that the surfaces of all labels share, and how smoothing moves them. A part of
 * engine/surface.h, for surface.c and surface_smooth.c alone.
 */
#ifndef ENGINE_SURFACE_NODES_H
#define ENGINE_SURFACE_NODES_H

#include "engine/surface.h"

/* Between two voxels that are neighbours along an axis. */
struct surface_node {
    uint16_t low[3]; /* the first of them, counted from 1 voxel before the scene */
    uint8_t axis;
    uint8_t label[2]; /* of the first and the second one; they differ */
    uint16_t along;   /* how far from the first to the second, 1..SURFACE_ONE - 1 */
};

/* A corner of a triangle: 2 * node + 1 where the label of the surface is that of the second voxel,
 * else 2 * node. */
struct surface_corners {
    uint32_t corner[3];
};

struct surface_nodes {
    struct surface_node *node;
    struct surface_corners *triangle; /* of all labels, as the cubes come */
    uint32_t (*segment)[2];           /* pairs of nodes that are neighbours on a surface */
    size_t nodes, triangles, segments;
    size_t node_room, triangle_room, segment_room;
    uint64_t voxels[256];
};

/* Where a node is, along one axis. */
static inline uint32_t surface_node_at(const struct surface_node *node, unsigned axis)
{
    return node->low[axis] * (uint32_t)SURFACE_ONE + (axis == node->axis ? node->along : 0);
}

/* The label whose surface a triangle belongs to. */
static inline uint8_t surface_label_of(const struct surface_nodes *nodes,
                                       const struct surface_corners *triangle)
{
    return nodes->node[triangle->corner[0] / 2].label[triangle->corner[0] % 2];
}

/*
 * Smooths: in each pass, every node goes half the way to the mean of its neighbours, along its line
 * and no further than to NODE_MARGIN before its ends. Then every label grows or shrinks, each node
 * by as much, until it encloses what its voxels do.
 *
 * ERR_MEMORY, ERR_CANCELLED by the watch, or NULL.
 */
enum err surface_smooth(struct surface_nodes *nodes, unsigned passes, struct watch *watch,
                        struct fault *fault);

#endif
