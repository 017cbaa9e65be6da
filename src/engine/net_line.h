/* SPDX-License-Identifier: MIT */
/*
 * Where borders between labels run along a surface net (net.h).
 *
 * The parabola of least squares through a vertex of a border and those before and after it, as
 * many on either side, as they lie before anything is smoothed, says where the border is. It
 * neither moves what is straight nor shrinks what is round, and half of a wave of 12 voxels stays.
 * (Savitzky & Golay, Smoothing and differentiation of data, 1964.) It takes the most vertices, up
 * to eight on either side, between which it turns by some 60 degrees at most, so that patches of
 * few voxels keep their area; what lies between yes and no is weighed, or there are hooks.
 *
 * Off the line, root of the mean square, in voxels: on a flat surface .08, in any direction .24, at
 * slopes of 1 in 8, 12, 20 .05, .12, .21. Patches of one voxel keep their area, those of radius 2,
 * 3, 5, 8 .99, .97, .98, 1.00 of it, squares of 3 to 21 voxels 1.00 to 1.01. Eight vertices see too
 * little of a wave of 20: .8 of it stays.
 */
#ifndef ENGINE_NET_LINE_H
#define ENGINE_NET_LINE_H

#include "engine/net_graph.h"

/* Finds `border` of the graph, from the places where vertices begin. False: no memory. */
bool net_line_find(struct net_graph *graph);

/* Whether a border of two labels runs through a vertex. Where it ends, or meets others, that is
 * held. */
static inline bool net_line_is_at(const struct net_graph *graph, int32_t v)
{
    return graph->has_labels && graph->lines[v] == 2;
}

#endif
