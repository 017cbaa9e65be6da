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

#include <stdint.h>

#include "apply/affine.h"
#include "base/buf.h"
#include "base/err.h"
#include "base/watch.h"
#include "engine/scene.h"
#include "image/coprocess.h"
#include "image/geometry.h"

/* A scene and where it lies. */
struct placed_scene {
    const struct scene *scene;
    const struct geometry *geometry;
};

struct registration {
    struct affine affine; /* subject's world -> procedure's world, millimetres, RAS+ */
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

/*
 * The register helper: registration by ITK, and transform files, in a process of its own.
 *
 * The program iftty-register is started for one request, takes all files and nearly all calls of
 * the kernel from itself before the first voxel comes (Landlock, seccomp, limits), and ends with
 * its answer. It opens no file: it gets voxels, decoded and bounded, or the bytes of a transform.
 * Its answers are checked: lengths and numbers.
 *
 * The protocol, as in coprocess.h:
 *
 *     request   register NX NY NZ NX NY NZ\n      the subject's scene, and the procedure's
 *                 12 numbers  voxels              of the one, and
 *                 12 numbers  voxels              of the other
 *     answer    any number of
 *                 progress DONE TOTAL\n
 *               and then
 *                 found\n  19 numbers
 *               or
 *                 error LENGTH\n  words
 *
 *     request   transform BYTES\n                of a file of ITK's transforms
 *                 bytes
 *     answer    transform LENGTH\n  kind  12 numbers
 *               or an error
 *
 * Numbers are doubles of this machine. Those of a request are the three rows of the matrix from
 * voxels to the world (right, anterior, superior; millimetres), its voxels are of 16 bits, x
 * fastest. Those found are the three rows of the map from the subject's world to the procedure's;
 * the metric of the map, of the identity, of the mirror image; what part of the subject's content
 * and of the procedure's lies in the other; agreement and length, in millimetres.
 */

#define REGISTER_HELPER "iftty-register" /* the program (coprocess_find) */

/* For tests: another program, NULL for iftty-register beside the running one; and how long it may
 * stay silent. */
extern const char *register_helper_program;
extern int register_helper_patience_ms;

/*
 * Transform files: what other programs found to be the way from one scene to another.
 *
 * Read are affine transforms of ITK (ANTs, 3D Slicer, elastix by way of ITK), as text (.txt, .tfm)
 * and as MATLAB's version 4 (.mat, ANTs' 0GenericAffine.mat), and matrices of FSL's FLIRT, which
 * is 4 x 4 numbers. What was taken is said in words, since nothing in such a file names a scene.
 *
 *     ITK   maps the places of the fixed scene to those of the moving one, both in LPS+
 *           millimetres; y = M (x - c) + t + c. A composite's last transform is carried out first.
 *     FSL   maps places of -in (moving) to those of -ref (fixed), each in millimetres along the
 *           voxel axes of its own scene from the middle of the first voxel, x counted from the
 *           other end where the voxel axes are right-handed; so both scenes' geometries are needed.
 *
 * FLIRT's numbers are not those of a 4 x 4 matrix between worlds, and nothing in a file of sixteen
 * numbers says which it is: so it is taken as FLIRT's only where the caller says so by "fsl:PATH".
 */

/* A scene's grid and where it lies. */
struct placed_grid {
    uint32_t size[3]; /* voxels along i, j, k */
    const struct geometry *geometry;
};

/*
 * Reads the file at `path` ("fsl:PATH": FLIRT's) as the way from the subject's world to the
 * procedure's, both RAS+: the subject's scene was the fixed one (FSL: -ref) when the other program
 * was run, as its tools have it that bring a procedure's labels onto a subject. `words` gets
 * what was taken, in one line.
 *
 * ERR_INPUT, and `out` is left alone, for what is not affine (a warp field), has no inverse, makes
 * mirror images, is neither format, or could be either; and where a scene has no place in the
 * world, as nothing says then what the numbers mean.
 */
enum err transform_read(struct affine *out, struct buf *words, const char *path,
                        const struct placed_grid *procedure, const struct placed_grid *subject,
                        struct fault *fault);

#endif
