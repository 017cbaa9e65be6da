/* SPDX-License-Identifier: MIT */
/*
 * Registration: the affine map from a subject's world to a procedure's, found in both scenes'
 * intensities by ITK in a process of its own (iftty-register), and refused where it is not to be
 * believed.
 *
 * The same two scenes give the same twelve numbers, bit for bit, on one build of one machine: it
 * works with one thread, on a regular grid of samples. Nothing says that of another machine; so the
 * numbers go into the journal, and no replay finds them anew.
 */
#ifndef REGISTER_REGISTRATION_H
#define REGISTER_REGISTRATION_H

#include "base/err.h"
#include "base/hash.h"
#include "base/watch.h"
#include "engine/scene.h"
#include "image/geometry.h"
#include "apply/affine.h"

/* A scene and where it lies. */
struct placed_scene {
    const struct scene *scene;
    const struct geometry *geometry;
};

struct registration {
    struct affine affine; /* subject's world -> procedure's world, millimetres, RAS+ */
    char subject[SHA256_HEX], procedure[SHA256_HEX]; /* what scene_proof says of them */
    /* Mutual information in nats, more is better: with the map, with the scenes as they lie in
     * their worlds, and with the best map of the subject's mirror image. */
    double metric, identity_metric, mirrored_metric;
    bool tells_sides;    /* whether the mirror image is well below; else, as with most other heads,
                            which side is left rests on what the files say, and nothing proves it */
    double overlap;      /* 0..1: of either scene's content what lies in the other; the lesser */
    double agreement_mm; /* how far to go there, and back by the map found from the procedure to
                            the subject, leads away at most, in the box of the subject's content */
    double length_mm;    /* the longest side of that box */
    double stretch[3];   /* singular values, largest first */
    double seconds;      /* of the processor */
};

/*
 * What is believed. Bounds lie between what was measured of scenes that a map was found for (heads
 * bent by 5 mm, with noise, bias, turns of 30 degrees, sizes of 0.8; other heads) and of those that
 * have none (`bench register` of tests/bench measures both).
 */
#define REGISTRATION_METRIC_LEAST   0.15 /* found: 0.6 and more; a solid: 0.08, noise: 0.01 */
#define REGISTRATION_WORSE_MOST     0.05 /* than the identity; a scene onto itself: 0.025 */
#define REGISTRATION_MIRRORED_MOST  1.03 /* times the metric; other heads: 1.01; mirrored: 1.07 */
#define REGISTRATION_OVERLAP_LEAST  0.5  /* found: 0.57 and more; a third of a head: 0.40 */
#define REGISTRATION_AGREEMENT_MOST 0.03 /* parts of the length; other heads: 0.019; else 0.09 */
#define REGISTRATION_STRETCH_LEAST  0.6  /* of all singular values */
#define REGISTRATION_STRETCH_MOST   1.67
#define REGISTRATION_VOLUME_MOST    2.5 /* of the determinant, which is 1/2.5 or more */

/*
 * Finds it. ERR_CHECK where it found one that is not to be used: then `out` holds it all the same,
 * for its figures, and `fault` says which of them is wrong and what can be done. ERR_INPUT for
 * scenes whose axes or spacing are unknown, or without contrast; ERR_IO where the helper is missing
 * (with what to type), or ended; ERR_CANCELLED.
 */
enum err registration_find(struct registration *out, const struct placed_scene *subject,
                           const struct placed_scene *procedure, struct watch *watch,
                           struct fault *fault);

#endif
