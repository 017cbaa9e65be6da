/* SPDX-License-Identifier: MIT */
/*
 * Affine transforms as ITK writes them, in two forms.
 *
 * Text (.txt, .tfm):
 *
 *     #Insight Transform File V1.0
 *     #Transform 0
 *     Transform: AffineTransform_double_3_3
 *     Parameters: 1 0 0 0 1 0 0 0 1 10 20 30
 *     FixedParameters: 0 0 0
 *
 * and MATLAB's version 4 (.mat), where each transform has two matrices of one column: its
 * parameters, named after the transform, and "fixed". A matrix is five 32-bit numbers (1000 for
 * big-endian plus 10 for single precision; rows; columns; 0; bytes of the name with its NUL), its
 * name, and its numbers.
 *
 * All transforms are y = M (x - c) + c + t, with c in the fixed parameters and M and t in the
 * others:
 *
 *     AffineTransform, MatrixOffsetTransformBase   M by rows, t
 *     Euler3DTransform            angles about x, y and z, t; M = Z X Y, or Z Y X if a fourth fixed
 *                                 parameter is not 0
 *     VersorRigid3DTransform      the vector part of a unit quaternion, t
 *     Similarity3DTransform       the same, and a scale
 *     TranslationTransform        t; no c
 *     CompositeTransform          of the others, in text: the last is applied first
 */
#ifndef REGISTER_ITK_TRANSFORM_H
#define REGISTER_ITK_TRANSFORM_H

#include <stddef.h>

#include "base/buf.h"
#include "base/err.h"
#include "apply/affine.h"

/* Parse the map from the fixed scene's world to the moving one's, both LPS+. `kind` gets the name
 * of the transform ("AffineTransform"). A NUL follows the bytes. On ERR_INPUT `out` is unchanged.
 */
enum err itk_transform_read(struct affine *out, struct buf *kind, const char *bytes, size_t length,
                            struct fault *fault);

#endif
