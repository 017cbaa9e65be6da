/*
 * Arc weights: how dear it is to step into a voxel.
 *
 * Under most kinds the weight of an arc (s, t) is a gradient at t, or what a file says of t, so it
 * is held once per voxel (ARC_TARGET of engine/arc.h). `difference` and `polarity` follow from both
 * ends and are worked out on the way; cell.weight then is of no meaning. All weights are integers
 * 0..65535 and a pure function of the intensities, the choice and (morph) the adjacency.
 */
#ifndef ENGINE_WEIGHT_H
#define ENGINE_WEIGHT_H

#include "base/team.h"
#include "engine/arc.h"
#include "engine/gradient.h"
#include "engine/scene.h"

/* The names of the kinds, in their order; what comes out of a file has no name of its own. */
#define WEIGHT_KINDS "morph|sobel|gauss|difference|polarity"
enum weight_kind {
    WEIGHT_MORPH,
    WEIGHT_SOBEL,
    WEIGHT_GAUSS,
    WEIGHT_DIFFERENCE,
    WEIGHT_POLARITY,
    WEIGHT_FILE,
};

enum arc_kind weight_arcs(enum weight_kind kind);

/* Whether weight_compute writes cell.weight. */
bool weight_is_gradient(enum weight_kind kind);

enum { MORPH_RADIUS_MOST = 3 };

struct weight_choice {
    enum weight_kind kind;
    uint32_t radius;            /* of morph, 1..3; else 0 */
    uint32_t sigma_thousandths; /* of gauss, 500..8000, in voxels; else 0 */
};

bool weight_choice_equals(const struct weight_choice *a, const struct weight_choice *b);

/* Memory that computing weights takes; it only grows, so that what was computed once can be
 * computed again. Begins as {0}. The team is not owned, and is set before room is reserved: all
 * crews give the same weights. */
struct weight_work {
    void *bytes;
    size_t capacity;
    struct team *team; /* weighs a slab of the scene each, in room of its own; NULL: the caller */
};
void weight_work_release(struct weight_work *work);

/* Room for weighing a scene of this grid by this choice: a few rows, for gauss some planes. On
 * ERR_MEMORY the room is what it was. */
enum err weight_work_reserve(struct weight_work *work, const struct grid *grid,
                             const struct weight_choice *choice, struct fault *fault);

/*
 * Writes cell.weight of every voxel, where the choice is a gradient, under the scene's watch; room
 * was reserved. Forest keys that were made under other weights no longer hold; the caller clears
 * them.
 */
void weight_compute(struct scene *scene, const struct adjacency *adjacency,
                    const struct weight_choice *choice, struct weight_work *work);

/*
 * The morphological gradient of radius 1: dilation minus erosion over the voxel and its neighbours
 * (6 or 26), where what lies outside the scene is ignored. Takes no memory. Of radius R: over what
 * R steps reach inside the scene, which is what R rounds of dilation and erosion give.
 */
void weight_morph(struct scene *scene, const struct adjacency *adjacency);

/* A digest of what arcs weigh, given the intensities: for ARC_TARGET a sum over voxels of their
 * weights, which a thread team shares, else of the kind, and under ARC_POLARITY of every label's. */
uint64_t weight_digest(const struct scene *scene, const struct arc_rule *arcs, struct team *team);

#endif
