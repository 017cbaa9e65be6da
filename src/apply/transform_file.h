/* SPDX-License-Identifier: MIT */
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
#ifndef REGISTER_TRANSFORM_FILE_H
#define REGISTER_TRANSFORM_FILE_H

#include <stdint.h>

#include "base/buf.h"
#include "base/err.h"
#include "image/geometry.h"
#include "apply/affine.h"

/* A scene's grid and where it lies. */
struct placed_grid {
    uint32_t size[3]; /* voxels along i, j, k */
    const struct geometry *geometry;
};

/* Which scene was the fixed one (FSL: -ref) when the other program was run. What its tools do to
 * bring a procedure's labels onto a subject is TRANSFORM_SUBJECT_FIXED. */
enum transform_fixed { TRANSFORM_SUBJECT_FIXED, TRANSFORM_PROCEDURE_FIXED };

/*
 * Reads the file at `path` ("fsl:PATH": FLIRT's) as the way from the subject's world to the
 * procedure's, both RAS+, whichever way the file has it. `words` (may be NULL) gets what was taken,
 * in one line: the format, and which scene was taken for fixed.
 *
 * ERR_INPUT, and `out` is left alone, for what is not affine (a warp field), has no inverse, makes
 * mirror images, is neither format, or could be either; and where a scene has no place in the
 * world, as nothing says then what the numbers mean.
 */
enum err transform_read(struct affine *out, struct buf *words, const char *path,
                        enum transform_fixed fixed, const struct placed_grid *procedure,
                        const struct placed_grid *subject, struct fault *fault);

#endif
