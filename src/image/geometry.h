/*
 * Geometry: where a scene lies in the world and what its intensities mean.
 *
 * Here, and not in the engine, because it is floating point: nothing of it lies on the way from a
 * seed to a pixel. What the engine needs of it (spacing, the nearest anatomical axes) is in
 * integers beside it.
 *
 * The world is that of NIfTI: millimetres, +x to the patient's right... see `to_mm`.
 */
#ifndef IMAGE_GEOMETRY_H
#define IMAGE_GEOMETRY_H

#include <stdint.h>

struct geometry {
    double to_mm[3][4];      /* world = to_mm * (i, j, k, 1): +x Right, +y Anterior, +z Superior */
    double slope, intercept; /* real value = slope * intensity + intercept, intensity 0..65535 */
    uint32_t spacing_nm[3];  /* distance of voxel centres along i, j, k, nanometres, 1.. */
    int8_t world_axis[3];    /* which world axis (0, 1, 2) each voxel axis runs along; a permutation */
    int8_t world_sign[3];    /* +1 or -1: with or against it */
    int16_t sform_code, qform_code; /* as read; both 0 when the file gave neither */
};

#endif
