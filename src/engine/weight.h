/*
 * Arc weights: how dear it is to step into a voxel.
 *
 * The weight of an arc (s, t) is the gradient at t, so it is held once per voxel. All weights are
 * integers 0..65535 and a pure function of the intensities, the choice and (morph) the adjacency.
 */
#ifndef ENGINE_WEIGHT_H
#define ENGINE_WEIGHT_H

#include "engine/gradient.h"
#include "engine/scene.h"

/* The names of the kinds, in their order. */
#define WEIGHT_KINDS "morph|sobel|gauss"
enum weight_kind { WEIGHT_MORPH, WEIGHT_SOBEL, WEIGHT_GAUSS };

enum { MORPH_RADIUS_MOST = 3 };

struct weight_choice {
    enum weight_kind kind;
    uint32_t radius;            /* of morph, 1..3; else 0 */
    uint32_t sigma_thousandths; /* of gauss, 500..8000, in voxels; else 0 */
};

bool weight_choice_equals(const struct weight_choice *a, const struct weight_choice *b);

/* Memory that computing weights takes; it only grows, so that what was computed once can be
 * computed again. Begins as {0}. */
struct weight_work {
    void *bytes;
    size_t capacity;
};
void weight_work_release(struct weight_work *work);

/* Room for weighing a scene of this grid by this choice: a few rows, for gauss some planes. On
 * ERR_MEMORY the room is what it was. */
enum err weight_work_reserve(struct weight_work *work, const struct grid *grid,
                             const struct weight_choice *choice, struct fault *fault);

/*
 * Writes cell.weight of every voxel; room was reserved. Forest keys that were made under other
 * weights no longer hold; the caller clears them.
 */
void weight_compute(struct scene *scene, const struct adjacency *adjacency,
                    const struct weight_choice *choice, struct weight_work *work);

/*
 * The morphological gradient of radius 1: dilation minus erosion over the voxel and its neighbours
 * (6 or 26), where what lies outside the scene is ignored. Takes no memory. Of radius R: over what
 * R steps reach inside the scene, which is what R rounds of dilation and erosion give.
 */
void weight_morph(struct scene *scene, const struct adjacency *adjacency);

/* A digest (sum over voxels) of the weights. */
uint64_t weight_digest(const struct scene *scene);

#endif
