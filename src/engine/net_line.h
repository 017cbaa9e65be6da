/*
 * Where borders between labels run along a surface net (net.h).
 *
 * The parabola of least squares through a vertex of a border and those before and after it, as many
 * on either side, as they lie before anything is smoothed: it says where the border is. It neither
 * moves what is straight nor shrinks what is round, and half of a wave of 12 voxels stays. (Savitzky
 * & Golay, Smoothing and differentiation of data, 1964.) It takes the most vertices, up to eight on
 * either side, between which it turns by 45 degrees at most: so corners stay near corners, and
 * patches of few voxels keep their area.
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
