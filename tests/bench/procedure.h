/* SPDX-License-Identifier: MIT */
/* The procedure of a benchmark: seeds as an automatic user inserts them, in eight steps.
 *
 * The paper's procedures insert seeds automatically and its table gives how many there are after
 * each step; the places are this program's own. They are voxels of a base scene, drawn from the
 * regions of a label map by session/seed_file.h, away from the borders of regions, in an order that
 * mixes the kinds evenly: so the seeds of a step are the first N of one list, and each step adds to
 * the one before.
 *
 *     brain   the AAL atlas on ch2's grid: regions 1-90 are label 1 (brain), 91-116 label 2
 *             (cerebellum); dark voxels outside of all regions are background. The paper also
 *             has medulla and ventricles; AAL has neither.
 *     geom    bands of intensity, one for each of its solids, and the background.
 *
 * Places are kept in the world, so one procedure serves every scene of the same head: interpolated
 * ones get the very same voxels at twice the index. */
#ifndef TESTS_BENCH_PROCEDURE_H
#define TESTS_BENCH_PROCEDURE_H

#include "command/interpreter.h"
#include "image/volume.h"
#include "session/seed_file.h"
#include "session/session_inside.h"

enum { PROCEDURE_STEPS = 8, PROCEDURE_SEEDS = 2105 };

/* Seeds after each step, from the paper. */
extern const unsigned procedure_count[PROCEDURE_STEPS];

struct procedure_place {
    double mm[3];
    uint64_t order; /* within its kind */
    unsigned kind;
};

struct procedure {
    struct procedure_place *place; /* by kind, each kind in the order of insertion */
    size_t places, capacity;
    bool has_atlas;
};
void procedure_release(struct procedure *procedure);

/* Make the procedure for the scene of `base`: by `atlas`, on the same grid, or as geom if it is
 * NULL. */
enum err procedure_make(struct procedure *procedure, const struct session *base,
                        const struct volume *atlas, struct fault *fault);

/* Open a scene by name in the interpreter's session. */
void procedure_open(struct interpreter *interp, const char *name);

/* Open `base` and make its procedure, by the atlas of that name, or as geom if it is NULL. */
void procedure_load(struct procedure *procedure, struct interpreter *interp, const char *base,
                    const char *atlas);

/* The first PROCEDURE_SEEDS seeds inside the scene of `session`, in the order of insertion.
 * ERR_INPUT if there are too few of a kind. */
enum err procedure_seeds(struct seeds *seeds, const struct procedure *procedure,
                         const struct session *session, struct fault *fault);

#endif
