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
#include "register/affine.h"

/* A scene and where it lies. */
struct placed_scene {
    const struct scene *scene;
    const struct geometry *geometry;
};

struct registration {
    struct affine affine; /* subject's world -> procedure's world, millimetres, RAS+ */
    char subject[SHA256_HEX], procedure[SHA256_HEX]; /* what scene_proof says of them */
    double metric, identity_metric; /* mutual information of the two, in nats: more is better; with
                                       the map, and with the scenes as they lie in their worlds */
    double overlap;      /* 0..1: of the smaller scene's content that lies in the other's */
    double agreement_mm; /* how far forward and then backward leads away, at most, over the content
                            of the subject's scene */
    double stretch[3];   /* singular values, largest first */
    double seconds;      /* of the processor */
};

/*
 * Finds it. ERR_CHECK where it found one that is not to be used: then `out` holds it all the same,
 * for its figures, and `fault` says which of them is wrong and what can be done. ERR_INPUT for
 * scenes without a place in the world, or without contrast; ERR_IO where the helper is missing
 * (with what to type), or ended; ERR_CANCELLED.
 */
enum err registration_find(struct registration *out, const struct placed_scene *subject,
                           const struct placed_scene *procedure, struct watch *watch,
                           struct fault *fault);

#endif
