/* SPDX-License-Identifier: MIT */
/*
 * Finish: what is handed on is smoothed; the forest is not touched.
 *
 * An ordered list of steps, each of which makes labels out of labels. The outcome is a pure
 * function of the list, the forest's labels, and the scene's intensities, seeds and region of
 * interest (finish_heeds_seeds), in integers alone: the same bits on every machine, for any number
 * of threads.
 *
 * What holds for all steps
 *   N1 a voxel that no seed reaches, or that lies outside the region of interest, has label 0, as
 *      the background has, and steps do not distinguish them: they may give such a voxel a label;
 *   N2 nothing lies beyond the scene: what a step counts or asks, it counts and asks of voxels. So
 *      the edge of the scene is no border of an object;
 *   N3 a step reads labels as the step before has left them, all of them, and writes others: within
 *      a step nothing depends on an order of voxels or labels;
 *   N4 a step for one label, 1..255, changes those voxels alone that it would change were it for
 *      all labels, or for that one; each step says which;
 *   N5 components hang together by faces (engine/components.h).
 *
 * Steps
 *   majority    A voxel takes the label that most voxels have of those at most `radius` away along
 *               every axis (a cube, itself in it). Where several labels are as frequent, it keeps
 *               its own if that is one of them, and takes the smallest if not. For one label: where
 *               a voxel would lose or get that label.
 *   largest     Of each label but 0, the component of most voxels stays, of several the one of the
 *               lowest cell. The others are given away (below). For one label: of that one.
 *   components  The same, but each component of `voxels` voxels or more stays.
 *   holes       A hole is a component of label 0 with no voxel at the edge of the scene. It is
 *               given away. Other objects in an object stay. For one label: the holes which that
 *               label gets, were it for all.
 *   open        A voxel of a label but 0 stays where a ball of `radius` can be placed over it, all
 *               of whose voxels have its label. The others are given away, component by component
 *               of what is to be given away. For one label: of that one.
 *   relax       Labels settle on the edges of the scene: each has a field that is 1 in it and 0
 *               elsewhere, and every voxel at most `reach` steps from a border moves `sweeps`
 *               times towards the mean of its neighbours, those across an edge counting little;
 *               then the greatest field wins (engine/relax.h). Seeds and voxels outside the
 *               region of interest keep their labels. For one label: where a voxel would lose or
 *               get that label.
 *   close       A voxel of label 0 takes a label but 0 where every ball of `radius` over it has a
 *               voxel of that label; of several labels, the smallest. For one label: of that one.
 *
 * Balls are those of engine/brush.h, around any voxel, in voxels or in nanometres by the spacing.
 *
 * To give components away is done in rounds. In each, a component that still waits takes the label
 * with which it has most faces in common, of several the smallest: of the voxels beside it that are
 * not in a component which waits, by the labels they have, but for the component's own former
 * label. All of a round take theirs at once. One that has no such face waits, and keeps its label
 * where no other one was given away in the round.
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
    FINISH_BAND = 2, /* usual steps of `relax` from a border */
    FINISH_BAND_MOST = 16
};

/* What a step may take beside its label. */
enum finish_argument {
    FINISH_TAKES_NOTHING,
    FINISH_TAKES_RADIUS,
    FINISH_TAKES_VOXELS,
    FINISH_TAKES_SWEEPS
};

/* What the outcome of a step follows from: labels and intensities alone, or seeds and the region of
 * interest as well. */
enum finish_heed { FINISH_HEEDS_LABELS, FINISH_HEEDS_SEEDS };

/* The steps, one row each: KIND, name, what it takes, that where none is given (0: it must be),
 * what it heeds, and a line of help. A row names a function of one file: finish_NAME. */
#define FINISH_LIST(FIRST, NEXT)                                                                   \
    FIRST(RELAX, relax, SWEEPS, 60, SEEDS, "relax: labels settle on the edges of the scene.\n")    \
    NEXT(MAJORITY, majority, RADIUS, 1, LABELS,                                                    \
         "majority: a voxel takes the label that most voxels have in the cube of the radius "      \
         "around it.\n")                                                                           \
    NEXT(LARGEST, largest, NOTHING, 0, LABELS,                                                     \
         "largest: the largest piece of each label stays; others go to the label around them.\n")  \
    NEXT(COMPONENTS, components, VOXELS, 0, LABELS,                                                \
         "components: the same, but each piece of so many `voxels` stays.\n")                      \
    NEXT(HOLES, holes, NOTHING, 0, LABELS,                                                         \
         "holes: background that is enclosed goes to the label around it.\n")                      \
    NEXT(OPEN, open, RADIUS, 1, LABELS,                                                            \
         "open: takes away what is thinner than a ball of the radius, and gives it to the label "  \
         "around it.\n")                                                                           \
    NEXT(CLOSE, close, RADIUS, 1, LABELS,                                                          \
         "close: fills clefts of background that are narrower than such a ball.\n")

#define FINISH_FIRST_NAME(kind, name, takes, usual, heeds, help) #name
#define FINISH_NEXT_NAME(kind, name, takes, usual, heeds, help)  "|" #name

enum finish_kind {
#define FINISH_KIND(kind, name, takes, usual, heeds, help) FINISH_##kind,
    FINISH_LIST(FINISH_KIND, FINISH_KIND) FINISH_KIND_COUNT
};

struct finish_step {
    uint32_t kind;
    uint32_t label;    /* 1..255, or FINISH_ALL_LABELS */
    uint32_t argument; /* radius: voxels, or nanometres; voxels; sweeps; 0 for nothing */
    uint32_t in_nm;    /* 0 or 1, of a radius */
    uint32_t reach;    /* of `relax`: steps from a border, 1..FINISH_BAND_MOST; else 0 */
};

/* Plain data, compared whole: zeros after the last step. */
struct finish_list {
    uint32_t count;
    struct finish_step step[FINISH_STEPS_MOST];
};

struct relax_kept;

/* What a step works on. Labels are [grid.cells], 0 in the rim of both. */
struct finish_work {
    const struct scene *scene;
    struct team *team;
    uint8_t *label; /* read, and in the end what the step has made of it (finish_take_next) */
    uint8_t *next;  /* to write into; of no meaning before and after a step, but for its rim */
    struct relax_kept *kept; /* fields of the last time (engine/relax.h), or NULL */
};

/* Their names, in their order. */
#define FINISH_KINDS FINISH_LIST(FINISH_FIRST_NAME, FINISH_NEXT_NAME)

/* Does a step. ERR_MEMORY, ERR_CANCELLED by the scene's watch; labels are of no use then. */
typedef enum err finish_apply(struct finish_work *work, const struct finish_step *step,
                              struct fault *fault);
#define FINISH_METHOD(kind, name, takes, usual, heeds, help) finish_apply finish_##name;
FINISH_LIST(FINISH_METHOD, FINISH_METHOD)

struct finish_row {
    const char *name;
    enum finish_argument takes;
    uint32_t usual; /* 0: one must be given */
    enum finish_heed heeds;
    finish_apply *apply;
};
extern const struct finish_row finish_table[]; /* by enum finish_kind */

/* ERR_LIMIT where a step would reach further than FINISH_RADIUS_MOST voxels along an axis. */
enum err finish_check(const struct finish_list *list, const struct scene *scene,
                      struct fault *fault);

/* Applies the list to the labels of the forest: (*label)[grid.cells], 0 in the rim, which the
 * caller frees by mem_pages_free; NULL on error: ERR_LIMIT, ERR_MEMORY, ERR_CANCELLED. `kept` makes
 * it faster where an edit has changed little since the last time: fields of this scene, or NULL. */
enum err finish_make(uint8_t **label, const struct finish_list *list, const struct scene *scene,
                     struct team *team, struct relax_kept *kept, struct fault *fault);

/* Whether what comes of the list may be another where the labels and intensities are the same, but
 * not the seeds or the region of interest. */
bool finish_heeds_seeds(const struct finish_list *list);

/* Adds "majority radius=1, largest label=2", or "none". */
void finish_write(struct buf *out, const struct finish_list *list);

/* ---- for the files of steps ---- */

/* Whether the step is for the label. */
static inline bool finish_is_for(const struct finish_step *step, unsigned label)
{
    return step->label == FINISH_ALL_LABELS || step->label == label;
}

/* work->next is what the step has made. */
void finish_take_next(struct finish_work *work);

/* Writes 0 into work->next. Of no use where the scene's watch has stopped it. */
void finish_clear(struct finish_work *work);

/* How many voxels a step reaches along each axis. */
void finish_reach(uint32_t reach[3], const struct finish_step *step, const struct scene *scene);

/* Voxels of the scene between two corners, both included; none where the first is above the
 * last. */
struct finish_box {
    uint32_t first[3], last[3];
};

static inline bool finish_box_is_empty(const struct finish_box *box)
{
    return box->first[0] > box->last[0];
}

/* No voxels: what others are included in. */
static inline struct finish_box finish_box_none(void)
{
    return (struct finish_box){{UINT32_MAX, UINT32_MAX, UINT32_MAX}, {0, 0, 0}};
}

/* Makes a box hold another too. */
void finish_box_include(struct finish_box *box, const struct finish_box *other);

/* Where each label of work->label lies. ERR_MEMORY; of no use where the scene's watch has stopped
 * it, of which it speaks as `what`. */
enum err finish_find_boxes(struct finish_box box[256], const struct finish_work *work,
                           const char *what, struct fault *fault);

/* Gives away those components of `of` that the step removes. `of` is work->label, or work->next:
 * 0, or the label of work->label in voxels to be given away. */
enum err finish_give_away(struct finish_work *work, const uint8_t *of,
                          const struct finish_step *step, struct fault *fault);

#endif
