/* SPDX-License-Identifier: MIT */
/*
 * Arc weights: the cost of a step into a voxel.
 *
 * Under most kinds the weight of an arc (s, t) is a gradient at t, or the value of a file at t, so
 * it is stored once per voxel (ARC_TARGET). `difference` and `polarity` depend on both ends and are
 * computed on demand; cell.weight is then unused. All weights are integers 0..65535 and a pure
 * function of the intensities, the choice and (morph) the adjacency.
 */
#ifndef ENGINE_WEIGHT_H
#define ENGINE_WEIGHT_H

#include "base/team.h"
#include "engine/scene.h"

/*
 * Arcs: the weight w of a step from a voxel s to its neighbour t.
 *
 *     ARC_TARGET      the weight stored at t                    gradients, weights from a file
 *     ARC_DIFFERENCE  |v(s) - v(t)|                             v: intensity
 *     ARC_POLARITY    |v(s) - v(t)| * (100 + a) / 100, rounded down, where v(s) > v(t)
 *                     |v(s) - v(t)| * (100 - a) / 100, likewise, where v(s) < v(t)
 *
 * Polarity is the oriented IFT (Miranda, Mansilla: Oriented image foresting transform segmentation
 * by seed competition, IEEE TIP 23(1), 2014): an object whose boundary is known to lead from bright
 * to dark has a > 0, so that such steps cost its paths more than steps back, and its trees stop
 * there. a, in percent, belongs to the label of the path's root. Weights above 65535 are 65535.
 *
 * A weight may depend on the arc's direction and on the label of its root, because the forest is
 * unique for any w, as long as an offer is above the key that makes it (engine/forest.h), and the
 * label of a root never changes: relabelling a seed is a removal and a planting.
 */
enum arc_kind { ARC_TARGET, ARC_DIFFERENCE, ARC_POLARITY };

enum { POLARITY_MOST = 100, WEIGHT_MOST = 65535 };

/* {0} is ARC_TARGET. */
struct arc_rule {
    enum arc_kind kind;
    int8_t polarity[256]; /* a of each label, -POLARITY_MOST..POLARITY_MOST */
};

/* Weight of the arc (s, t) in a tree whose root has this label. `kind` is that of the rule, passed
 * separately so that a loop can be compiled for one kind. */
static inline __attribute__((always_inline)) uint32_t
arc_weight(const struct arc_rule *rule, const enum arc_kind kind, const struct cell *s,
           const struct cell *t, uint8_t label)
{
    if (kind == ARC_TARGET)
        return t->weight;
    const int32_t rise = t->intensity - s->intensity;
    const int32_t difference = rise < 0 ? -rise : rise;
    if (kind == ARC_DIFFERENCE)
        return (uint32_t)difference;
    const int32_t a = rule->polarity[label];
    const uint32_t percent = (uint32_t)(POLARITY_MOST + (rise < 0 ? a : -a));
    const uint32_t weight = (uint32_t)difference * percent / POLARITY_MOST;
    return weight < WEIGHT_MOST ? weight : WEIGHT_MOST;
}

/* Weight of the arc from a voxel with its current label, outside hot loops. */
static inline uint32_t arc_weight_now(const struct arc_rule *rule, const struct cell *s,
                                      const struct cell *t)
{
    return arc_weight(rule, rule->kind, s, t, s->label);
}

/* ---- sources of weights ---- */

enum { SIGMA_LEAST = 500, SIGMA_MOST = 8000, RADIUS_MOST = 3 };

/* Arguments of a weight, as parameters of a command: NAME, TYPE (thousandths if DECIMAL), least and
 * most. */
#define WEIGHT_ARGUMENTS(PLAIN, KEYED)                                                             \
    PLAIN("SIGMA", DECIMAL, SIGMA_LEAST, SIGMA_MOST), KEYED("radius", NUMBER, 1, RADIUS_MOST)
enum weight_argument {
    WEIGHT_TAKES_SIGMA,
    WEIGHT_TAKES_RADIUS,
    WEIGHT_ARGUMENT_COUNT,
    WEIGHT_TAKES_NOTHING = WEIGHT_ARGUMENT_COUNT,
};

/*
 * The weights, one row each: KIND, name, argument, its default (0: required), and a line of help. A
 * row names a `struct weight_method`, which one file defines: NAME_weight.
 */
#define WEIGHT_LIST(FIRST, NEXT)                                                                   \
    FIRST(MORPH, morph, RADIUS, 1,                                                                 \
          "morph, the default: dilation minus erosion, over a voxel and its neighbours, or over "  \
          "all voxels within `radius` steps.\n")                                                   \
    NEXT(SOBEL, sobel, NOTHING, 0, "sobel: the 3-D Sobel operator.\n")                             \
    NEXT(GAUSS, gauss, SIGMA, 0,                                                                   \
         "gauss: the gradient after smoothing by a Gaussian of SIGMA 0.5..8 voxels, required.\n")  \
    NEXT(DIFFERENCE, difference, NOTHING, 0,                                                       \
         "difference: the absolute difference of intensity between the two voxels of a step.\n")   \
    NEXT(POLARITY, polarity, NOTHING, 0,                                                           \
         "polarity: this difference, with different factors for steps to brighter and to darker "  \
         "voxels (`help polarity`).\n")

#define WEIGHT_FIRST_NAME(kind, name, argument, usual, help) #name
#define WEIGHT_NEXT_NAME(kind, name, argument, usual, help)  "|" #name

enum weight_kind {
#define WEIGHT_KIND(kind, name, argument, usual, help) WEIGHT_##kind,
    WEIGHT_LIST(WEIGHT_KIND, WEIGHT_KIND) WEIGHT_FILE,
};

/* The names, in their order; weights from a file have no name. */
#define WEIGHT_KINDS WEIGHT_LIST(WEIGHT_FIRST_NAME, WEIGHT_NEXT_NAME)

struct weight_method {
    enum arc_kind arcs;
    /* Working memory of `weigh` in bytes; NULL for none. */
    uint64_t (*bytes)(const struct grid *grid, uint32_t argument);
    /* Write only cell.weight of a slab of planes, under the scene's watch; slabs may be
     * processed in parallel. NULL for weights from a file or not stored in cells. */
    void (*weigh)(struct scene *scene, const struct adjacency *adjacency, uint32_t argument,
                  struct slab slab, void *work);
    /* Compute the weights of a row of a plain scene, for one argument; NULL if rows cannot be
     * computed separately. */
    void (*weigh_row)(uint16_t *weight, const struct scene *scene,
                      const struct adjacency *adjacency, uint32_t y, uint32_t z);
    uint32_t row_argument; /* that argument */
};
#define WEIGHT_METHOD(kind, name, argument, usual, help)                                           \
    extern const struct weight_method name##_weight;
WEIGHT_LIST(WEIGHT_METHOD, WEIGHT_METHOD)

struct weight_row {
    const char *name;
    enum weight_argument takes;
    uint32_t usual; /* 0: required */
    const struct weight_method *method;
};
extern const struct weight_row weight_table[]; /* by enum weight_kind */

struct weight_choice {
    enum weight_kind kind;
    uint32_t argument; /* within the range of its row's argument; 0 for none */
};

enum arc_kind weight_arcs(enum weight_kind kind);

/* Working memory for computing weights; it only grows, so that a computation that succeeded once
 * can be repeated. Starts as {0}. The team is not owned and must be set before memory is reserved;
 * all teams compute the same weights. */
struct weight_work {
    void *bytes;
    size_t capacity;
    uint16_t *best; /* [cells], for a scene of several channels; owned */
    struct team
        *team; /* computes a slab of the scene per thread, in its own memory; NULL: the caller */
};
void weight_work_release(struct weight_work *work);

/* Reserve memory for a scene of this grid and this choice: a few rows, for gauss some planes. On
 * ERR_MEMORY the memory is unchanged. */
enum err weight_work_reserve(struct weight_work *work, const struct grid *grid,
                             const struct weight_choice *choice, struct fault *fault);

/*
 * Write cell.weight of every voxel, if the choice is a gradient, under the scene's watch; memory
 * was reserved. With further channels the weight is the greatest of w * percent / 100, at most
 * WEIGHT_MOST, over all of them. Forest keys computed with other weights become invalid; the
 * caller clears them.
 */
void weight_compute(struct scene *scene, const struct adjacency *adjacency,
                    const struct weight_choice *choice, struct weight_work *work);

/* True if the weights of a plain scene (engine/scene.h) can be computed by rows.
 * weight_plain_digest then returns the digest that weight_digest would return; weight_make_cells
 * initialises the cells with their weights. Both use a team under the scene's watch: if stopped,
 * the digest is undefined and the scene stays plain. */
bool weight_is_by_rows(const struct weight_choice *choice);
uint64_t weight_plain_digest(const struct scene *scene, const struct adjacency *adjacency,
                             const struct weight_choice *choice, struct team *team);
uint64_t weight_make_cells(struct scene *scene, const struct adjacency *adjacency,
                           const struct weight_choice *choice, struct team *team);

/* Digest of the arc weights, for known intensities: under ARC_TARGET a sum over the weights of all
 * voxels, by a thread team; else of the kind, and under ARC_POLARITY of every label's polarity. */
uint64_t weight_digest(const struct scene *scene, const struct arc_rule *arcs, struct team *team);

#endif
