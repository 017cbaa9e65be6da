/* SPDX-License-Identifier: MIT */
/*
 * Finish: smooth the labels for display and output; the forest is not changed.
 *
 * A finish is an ordered list of steps; each step computes new labels from labels. The result
 * is a pure function of the list, the forest's labels, and the scene's intensities, seeds and
 * region of interest (finish_uses_seeds), in integers only: the same bits on every machine, for any
 * number of threads.
 *
 * Rules for all steps
 *   N1 a voxel that no seed reaches, or outside the region of interest, has label 0, like the
 *      background, and steps do not distinguish them: they may assign a label to such a voxel;
 *   N2 nothing exists outside the scene: steps count and test voxels only. So the edge of the scene
 *      is not a border of an object;
 *   N3 a step reads the result of the step before and writes new labels: within a step nothing
 *      depends on an order of voxels or labels;
 *   N4 a step for one label, 1..255, changes a subset of the voxels that it would change for all
 *      labels, or works on that label alone, as described for each step;
 *   N5 components are connected by faces (engine/components.h).
 *
 * Steps
 *   majority    Each voxel is assigned the most frequent label of the voxels within `radius` along
 *               every axis (a cube, including the voxel). On a tie it keeps its own label if that
 *               is one of the most frequent, else the smallest of them is assigned. For one label:
 *               only changes from or to that label.
 *   largest     Keep the largest component of each label except 0; on a tie the one with the lowest
 *               cell. The others are reassigned (see below). For one label: of that label.
 *   components  The same, but keep each component of at least `voxels` voxels.
 *   holes       Reassign holes: components of label 0 with no voxel at the edge of the scene. Other
 *               objects inside an object stay. For one label: only holes that are assigned to that
 *               label.
 *   open        Keep a voxel of a label except 0 if a ball of `radius` that contains it fits into
 *               the label. The others are reassigned, by connected components of voxels that are
 *               not kept. For one label: of that label.
 *   relax       Move borders to edges of the scene: each label has a field that is 1 inside and 0
 *               outside, and every voxel within `reach` steps of a border moves `sweeps` times
 *               towards the mean of its neighbours, where neighbours across an edge count little;
 *               then the label of the greatest field is assigned (engine/relax.h). Seeds and voxels
 *               outside the region of interest keep their labels. For one label: only changes from
 *               or to that label.
 *   close       Assign a label to a voxel of label 0 if every ball of `radius` that contains it has
 *               a voxel of that label; the smallest of several. For one label: of that label.
 *
 * Balls are those of engine/brush.h, around any voxel, in voxels or in nanometres by the spacing.
 *
 * Reassignment works in rounds. In each round, a pending component is assigned the label with which
 * it shares the most faces, the smallest on a tie. Only faces to voxels outside pending components
 * count, and not those of the component's own former label. All assignments of a round are
 * simultaneous. A component without such a face stays pending, and keeps its label if a round
 * assigns no component.
 */
#ifndef ENGINE_FINISH_H
#define ENGINE_FINISH_H

#include "base/buf.h"
#include "base/team.h"
#include "engine/components.h"
#include "engine/scene.h"

enum {
    FINISH_STEPS_MOST = 16,
    FINISH_RADIUS_MOST = 16,
    FINISH_ALL_LABELS = 256,
    FINISH_SWEEPS_MOST = 1000,
    FINISH_BAND = 2, /* default steps of `relax` from a border */
    FINISH_BAND_MOST = 16
};

/* Argument of a step, apart from its label. */
enum finish_argument {
    FINISH_TAKES_NOTHING,
    FINISH_TAKES_RADIUS,
    FINISH_TAKES_VOXELS,
    FINISH_TAKES_SWEEPS
};

/* Inputs of a step: labels and intensities only, or also seeds and the region of interest. */
enum finish_inputs { FINISH_USES_LABELS, FINISH_USES_SEEDS };

/* The steps, one row each: KIND, name, function, argument, its default (0: required), inputs, and a
 * line of help. A row names a function of one file: finish_FUNCTION. */
#define FINISH_LIST(FIRST, NEXT)                                                                   \
    FIRST(RELAX, relax, relax, SWEEPS, 20, SEEDS,                                                  \
          "relax: move the borders of labels to intensity edges.\n")                               \
    NEXT(MAJORITY, majority, majority, RADIUS, 1, LABELS,                                          \
         "majority: assign to each voxel the most frequent label within a cube of `radius`.\n")    \
    NEXT(LARGEST, largest, pieces, NOTHING, 0, LABELS,                                             \
         "largest: keep the largest connected piece of each label, and assign other pieces to "    \
         "the label around them.\n")                                                               \
    NEXT(COMPONENTS, components, pieces, VOXELS, 0, LABELS,                                        \
         "components: the same, but keep all pieces of at least `voxels` voxels.\n")               \
    NEXT(HOLES, holes, pieces, NOTHING, 0, LABELS,                                                 \
         "holes: assign enclosed background to the label around it.\n")                            \
    NEXT(OPEN, open, open, RADIUS, 1, LABELS,                                                      \
         "open: remove parts that are thinner than a ball of `radius`, and assign them to the "    \
         "label around them.\n")                                                                   \
    NEXT(CLOSE, close, close, RADIUS, 1, LABELS,                                                   \
         "close: fill gaps of background that are narrower than a ball of `radius`.\n")

#define FINISH_FIRST_NAME(kind, name, by, takes, usual, uses, help) #name
#define FINISH_NEXT_NAME(kind, name, by, takes, usual, uses, help)  "|" #name

enum finish_kind {
#define FINISH_KIND(kind, name, by, takes, usual, uses, help) FINISH_##kind,
    FINISH_LIST(FINISH_KIND, FINISH_KIND) FINISH_KIND_COUNT
};

struct finish_step {
    uint32_t kind;
    uint32_t label;    /* 1..255, or FINISH_ALL_LABELS */
    uint32_t argument; /* radius in voxels or nanometres; voxels; sweeps; 0 for none */
    uint32_t in_nm;    /* 0 or 1, for a radius */
    uint32_t reach;    /* for `relax`: steps from a border, 1..FINISH_BAND_MOST; else 0 */
};

/* Plain data, compared as a whole: zeros after the last step. */
struct finish_list {
    uint32_t count;
    struct finish_step step[FINISH_STEPS_MOST];
};

struct relax_kept;

/* State of a step. Both arrays of labels are [grid.cells], 0 in the rim. */
struct finish_work {
    const struct scene *scene;
    struct team *team;
    uint8_t *label;          /* input; after the step its result, perhaps by a swap with `next` */
    uint8_t *next;           /* output buffer; undefined before and after a step, except its rim */
    struct relax_kept *kept; /* stored fields of the last time (engine/relax.h), or NULL */
};

/* The names, in their order. */
#define FINISH_KINDS FINISH_LIST(FINISH_FIRST_NAME, FINISH_NEXT_NAME)

/* Perform a step. ERR_MEMORY, ERR_CANCELLED by the scene's watch; the labels are then undefined. */
typedef enum err finish_apply(struct finish_work *work, const struct finish_step *step,
                              struct fault *fault);
#define FINISH_METHOD(kind, name, by, takes, usual, uses, help) finish_apply finish_##by;
FINISH_LIST(FINISH_METHOD, FINISH_METHOD)

struct finish_row {
    const char *name;
    enum finish_argument takes;
    uint32_t usual; /* 0: required */
    enum finish_inputs uses;
    finish_apply *apply;
};
extern const struct finish_row finish_table[]; /* by enum finish_kind */

/* ERR_LIMIT if a step would extend further than FINISH_RADIUS_MOST voxels along an axis. */
enum err finish_check(const struct finish_list *list, const struct scene *scene,
                      struct fault *fault);

/* Apply the list to the labels of the forest: (*label)[grid.cells], 0 in the rim, which the caller
 * frees by mem_pages_free; NULL on error: ERR_LIMIT, ERR_MEMORY, ERR_CANCELLED. `kept` makes it
 * faster if an edit has changed little since the last time: stored fields of this scene, or
 * NULL. */
enum err finish_make(uint8_t **label, const struct finish_list *list, const struct scene *scene,
                     struct team *team, struct relax_kept *kept, struct fault *fault);

/* True if the result may change although labels and intensities do not, because seeds or the region
 * of interest change. */
bool finish_uses_seeds(const struct finish_list *list);

/* Append "majority radius=1, largest label=2", or "none"; `number` has the numbers of labels. */
void finish_write(struct buf *out, const struct finish_list *list, const uint32_t number[256]);

/* ---- for the files of steps ---- */

/* True if the step applies to the label. */
static inline bool finish_is_for(const struct finish_step *step, unsigned label)
{
    return step->label == FINISH_ALL_LABELS || step->label == label;
}

/* Clear work->next. Undefined if the scene's watch has stopped it. */
void finish_clear(struct finish_work *work);

/* Number of voxels over which a step with a radius extends along each axis. */
void finish_reach(uint32_t reach[3], const struct finish_step *step, const struct scene *scene);

/* Voxels of the scene between two corners, both included; empty if the first is above the last. */
struct finish_box {
    uint32_t first[3], last[3];
};

static inline bool finish_box_is_empty(const struct finish_box *box)
{
    return box->first[0] > box->last[0];
}

/* The empty box, to which others are added. */
static inline struct finish_box finish_box_none(void)
{
    return (struct finish_box){{UINT32_MAX, UINT32_MAX, UINT32_MAX}, {0, 0, 0}};
}

/* Extend a box to include another. */
void finish_box_include(struct finish_box *box, const struct finish_box *other);

/* The box that is `by` voxels larger on each side, within another, which it meets. */
struct finish_box finish_box_widen(const struct finish_box *box, uint32_t by,
                                   const struct finish_box *within);

/* True if `other` is inside the box. */
bool finish_box_contains(const struct finish_box *box, const struct finish_box *other);

/* Find the bounding box of each label of work->label. `what` is the name of the work. ERR_MEMORY;
 * undefined if the scene's watch has stopped it. */
enum err finish_find_boxes(struct finish_box box[256], const struct finish_work *work,
                           const char *what, struct fault *fault);

/* Reassign the components of `of` that the step removes. `of` is work->label, or work->next, which
 * then has the label of work->label in voxels to be reassigned, and 0 elsewhere. */
enum err finish_reassign(struct finish_work *work, const uint8_t *of,
                         const struct finish_step *step, struct fault *fault);

#endif
