#include "engine/surface_nodes.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum {
    NODE_MARGIN = SURFACE_ONE / 16,
    ROUNDS = 8,         /* of setting the volume, at most */
    CLOSE_ENOUGH = 4096 /* the part of the volume that may be wrong */
};

static uint16_t within_line(int64_t along)
{
    const int64_t most = SURFACE_ONE - NODE_MARGIN;
    return (uint16_t)(along < NODE_MARGIN ? NODE_MARGIN : along > most ? most : along);
}

/* ---- passes ---- */

struct neighbours {
    int32_t sum; /* of where they are along the node's axis, from where the node's line begins */
    uint32_t count;
};

static void look_at(struct neighbours *all, const struct surface_node *node, uint32_t of,
                    uint32_t neighbour)
{
    const struct surface_node *n = &node[of];
    all[of].sum += (int32_t)(surface_node_at(&node[neighbour], n->axis) -
                             n->low[n->axis] * (uint32_t)SURFACE_ONE);
    all[of].count++;
}

/* The nodes go half the way to the means of their neighbours. */
static void pass(struct surface_nodes *nodes, struct neighbours *all, struct task *task)
{
    memset(all, 0, nodes->nodes * sizeof *all);
    for (size_t i = 0; i < nodes->segments && task_advance(task, 1); i++) {
        look_at(all, nodes->node, nodes->segment[i][0], nodes->segment[i][1]);
        look_at(all, nodes->node, nodes->segment[i][1], nodes->segment[i][0]);
    }
    if (watch_stops(task->watch))
        return;
    for (size_t i = 0; i < nodes->nodes; i++) {
        struct surface_node *node = &nodes->node[i];
        const int64_t count = all[i].count, way = all[i].sum - count * node->along;
        node->along = within_line(node->along + way / (2 * count));
    }
}

/* ---- volumes ---- */

/* By labels, six times as much, in 2^-24 voxels; sums mod 2^64, which hold what they come to. */
struct volumes {
    uint64_t is[256];
    int64_t grows[256]; /* by each 1/256 voxel that all its nodes go outwards */
};

static void add_triangle(struct volumes *volumes, const struct surface_nodes *nodes,
                         const struct surface_corners *triangle)
{
    const struct surface_node *node[3];
    int64_t at[3][3];
    const uint8_t label = surface_label_of(nodes, triangle);
    for (int i = 0; i < 3; i++) {
        node[i] = &nodes->node[triangle->corner[i] / 2];
        for (unsigned a = 0; a < 3; a++)
            at[i][a] = surface_node_at(node[i], a) >> 8;
    }
    int64_t normal[3];
    for (int a = 0; a < 3; a++) {
        const int u = (a + 1) % 3, v = (a + 2) % 3;
        normal[a] = (at[1][u] - at[0][u]) * (at[2][v] - at[0][v]) -
                    (at[1][v] - at[0][v]) * (at[2][u] - at[0][u]);
    }
    volumes->is[label] += (uint64_t)(normal[2] * (at[0][2] + at[1][2] + at[2][2]));
    for (int i = 0; i < 3; i++)
        volumes->grows[label] +=
            triangle->corner[i] % 2 ? -normal[node[i]->axis] : normal[node[i]->axis];
}

/* How far the nodes of each label are to go outwards, in SURFACE_ONE; false where no label has to
 * go any further. */
static bool find_growth(int64_t outward[256], const struct surface_nodes *nodes,
                        struct volumes *volumes, struct task *task)
{
    bool grows = false;
    memset(volumes, 0, sizeof *volumes);
    for (size_t i = 0; i < nodes->triangles && task_advance(task, 1); i++)
        add_triangle(volumes, nodes, &nodes->triangle[i]);
    for (unsigned label = 1; label < 256; label++) {
        const int64_t wanted = (int64_t)(nodes->voxels[label] * 6) << 24;
        const int64_t lacks = wanted - (int64_t)volumes->is[label];
        const int64_t each = volumes->grows[label] > 0 ? volumes->grows[label] : 1;
        const int64_t way = lacks / each < -64 ? -64 : lacks / each > 64 ? 64 : lacks / each;
        outward[label] = way * 256 + (way > -64 && way < 64 ? lacks % each * 256 / each : 0);
        grows |= lacks > wanted / CLOSE_ENOUGH || -lacks > wanted / CLOSE_ENOUGH;
    }
    return grows;
}

static void set_volumes(struct surface_nodes *nodes, struct task *task)
{
    int64_t outward[256] = {0};
    struct volumes volumes;
    for (int round = 0; round < ROUNDS && find_growth(outward, nodes, &volumes, task); round++)
        for (size_t i = 0; i < nodes->nodes; i++) {
            struct surface_node *node = &nodes->node[i];
            node->along =
                within_line(node->along + outward[node->label[0]] - outward[node->label[1]]);
        }
}

enum err surface_smooth(struct surface_nodes *nodes, unsigned passes, struct watch *watch,
                        struct fault *fault)
{
    struct neighbours *all = mem_array(nodes->nodes + 1, sizeof *all);
    if (!all)
        return fault_memory(fault, "a surface");
    struct task task =
        task_begin(watch, "smoothing",
                   (uint64_t)passes * nodes->segments + ROUNDS * (uint64_t)nodes->triangles);
    for (unsigned i = 0; i < passes && !watch_stops(watch); i++)
        pass(nodes, all, &task);
    set_volumes(nodes, &task);
    free(all);
    return watch_fault(watch, fault);
}
