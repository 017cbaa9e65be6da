/* SPDX-License-Identifier: MIT */
/*
 * Registration: find the affine map from a subject's world to a procedure's, from the intensities
 * of both scenes, by ITK in a process of its own (iftty-register), and reject implausible results.
 *
 * The same two scenes give the same twelve numbers, bit for bit, with one build on one machine: it
 * runs in one thread, on a regular lattice of samples. Other machines may differ, so the numbers
 * are recorded in the journal, and no replay recomputes them.
 */
#ifndef APPLY_REGISTRATION_H
#define APPLY_REGISTRATION_H

#include <stdint.h>

#include "apply/affine.h"
#include "base/buf.h"
#include "base/err.h"
#include "base/watch.h"
#include "engine/scene.h"
#include "image/coprocess.h"
#include "image/geometry.h"

/* A scene and its place in the world. */
struct placed_scene {
    const struct scene *scene;
    const struct geometry *geometry;
};

struct registration {
    struct affine affine; /* subject's world -> procedure's world, millimetres, RAS+ */
    /* Mutual information in nats, more is better: of the map, of the identity, and of the best map
     * of the subject's mirror image. */
    double metric, identity_metric, mirrored_metric;
    /* The mirror image fits clearly worse. Otherwise, as between most heads, only the files prove
     * left and right. */
    bool tells_sides;
    double overlap; /* 0..1: share of either scene's content inside the other; the smaller one */
    /* Largest error of the map followed by the map found from the procedure to the subject, at the
     * corners of the subject's content. */
    double agreement_mm;
    double length_mm;  /* longest side of that content */
    double stretch[3]; /* singular values, largest first */
};

/* Bounds of plausible results, between measurements of scenes with a known map (heads bent
 * by 5 mm, with noise, bias, turns of 30 degrees, sizes of 0.8; other heads) and of scenes without
 * one (`bench register` of tests/bench measures both). */
#define REGISTRATION_METRIC_LEAST  0.15 /* with a map: 0.6 or more; a solid: 0.08, noise: 0.01 */
#define REGISTRATION_WORSE_MOST    0.05 /* than the identity; a scene to itself: 0.025 */
#define REGISTRATION_MIRRORED_MOST 1.03 /* times the metric; other heads: 1.01; mirrored: 1.07 */
#define REGISTRATION_OVERLAP_LEAST 0.5  /* with a map: 0.57 or more; a third of a head: 0.40 */
#define REGISTRATION_AGREEMENT_MOST                                                                \
    0.03 /* relative to the length; other heads: 0.019; no map: 0.09 */
#define REGISTRATION_STRETCH_LEAST 0.6 /* singular values */
#define REGISTRATION_STRETCH_MOST  1.67
#define REGISTRATION_VOLUME_MOST   2.5 /* determinant, and its inverse */

/* Register two scenes. ERR_CHECK for an implausible result: `out` has its figures, and `fault`
 * names the wrong one and a remedy. ERR_INPUT if axes or spacing are unknown, or without contrast;
 * ERR_IO if the helper is missing (with the command to install it) or ended; ERR_CANCELLED. */
enum err registration_find(struct registration *out, const struct placed_scene *subject,
                           const struct placed_scene *procedure, struct watch *watch,
                           struct fault *fault);

/*
 * The register helper: registration by ITK, and transform files, in a process of its own.
 *
 * iftty-register is started for one request. Before the first voxel arrives it drops access to all
 * files and nearly all calls of the kernel (Landlock, seccomp, limits); it ends after its answer.
 * It opens no file: it receives decoded voxels of bounded number, or the bytes of a transform file.
 * Lengths and numbers of its answers are checked.
 *
 * The protocol, as in coprocess.h:
 *
 *     request   register NX NY NZ NX NY NZ\n      the subject's scene, and the procedure's
 *                 12 numbers  voxels              of the subject
 *                 12 numbers  voxels              of the procedure
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
 * Numbers are doubles of this machine. Numbers of a request are the three rows of the matrix from
 * voxels to the world (right, anterior, superior; millimetres); voxels have 16 bits, x fastest. The
 * result has the three rows of the map from the subject's world to the procedure's; the metric of
 * the map, of the identity and of the mirror image; the share of the subject's content inside the
 * procedure's scene, and the reverse; agreement and length, in millimetres.
 */

#define REGISTER_HELPER "iftty-register" /* program name (coprocess_find) */

/* For tests: another program instead of iftty-register next to the running one, or NULL; and the
 * longest silence. */
extern const char *register_helper_program;
extern int register_helper_patience_ms;

/*
 * Transform files: maps between scenes, found by other programs.
 *
 * Readable files are affine transforms of ITK (ANTs, 3D Slicer, elastix through ITK), as text
 * (.txt, .tfm) and as MATLAB's version 4 (.mat, ANTs' 0GenericAffine.mat), and matrices of FSL's
 * FLIRT, 4 x 4 numbers. The interpretation is printed, because no such file names its scenes.
 *
 *     ITK   maps places of the fixed scene to the moving one, both in LPS+ millimetres:
 *           y = M (x - c) + t + c. A composite's last transform is applied first.
 *     FSL   maps places of -in (moving) to -ref (fixed), each in millimetres along the voxel axes
 *           of its own scene, from the centre of the first voxel; x is counted from the other end
 *           if the voxel axes are right-handed. Both scenes' geometries are needed.
 *
 * FLIRT's numbers are not a matrix between worlds, and a file of sixteen numbers does not say which
 * it has: it is read as FLIRT's only if the caller says so by "fsl:PATH".
 */

/* A scene's grid and its place in the world. */
struct placed_grid {
    uint32_t size[3]; /* voxels along i, j, k */
    const struct geometry *geometry;
};

/*
 * Read the file at `path` ("fsl:PATH": FLIRT's) as the map from the subject's world to the
 * procedure's, both RAS+. The subject's scene is the fixed one (FSL: -ref), as in tools that bring
 * labels to a subject. `words` gets the interpretation, in one line.
 *
 * ERR_INPUT, with `out` unchanged, for a transform that is not affine (a warp field), has no
 * inverse or makes mirror images; for other and for ambiguous formats; and if a scene has no place
 * in the world, so that the numbers have no meaning.
 */
enum err transform_read(struct affine *out, struct buf *words, const char *path,
                        const struct placed_grid *procedure, const struct placed_grid *subject,
                        struct fault *fault);

#endif
