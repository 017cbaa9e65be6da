/*
 * Geometry: where a scene lies in the world and what its intensities mean.
 *
 * Here, and not in the engine, because it is floating point: nothing of it lies on the way from a
 * seed to a pixel. What the engine needs of it (spacing, the nearest anatomical axes) is in
 * integers beside it.
 *
 * The world is that of NIfTI: millimetres, +x towards the patient's right, +y towards the front
 * (anterior), +z towards the head (superior).
 */
#ifndef IMAGE_GEOMETRY_H
#define IMAGE_GEOMETRY_H

#include <stdbool.h>
#include <stdint.h>

struct geometry {
    double to_mm[3][4];      /* world = to_mm * (i, j, k, 1), voxel centres at whole i, j, k */
    double slope, intercept; /* real value = slope * intensity + intercept, intensity 0..65535 */
    uint32_t spacing_nm[3];  /* distance of voxel centres along i, j, k, nanometres, 1.. */
    bool spacing_assumed;    /* the file does not say it along every axis: 1 mm was taken for it */
    int8_t world_axis[3]; /* the world axis (0, 1, 2) nearest to each voxel axis; a permutation */
    int8_t world_sign[3]; /* +1 or -1: with or against it */
    int16_t sform_code, qform_code; /* as read; 0 where the file gave none that can be used */
};

static inline bool geometry_has_place(const struct geometry *geometry)
{
    return geometry->sform_code || geometry->qform_code;
}

/* The real value of an intensity. */
static inline double geometry_value(const struct geometry *geometry, int32_t intensity)
{
    return geometry->slope * intensity + geometry->intercept;
}

/* Takes `to_mm` as the way to the world and works out world_axis and world_sign: the permutation of
 * the axes that lies nearest to the matrix (the first one in order, where several are). Returns
 * false, and leaves the geometry alone, where the matrix is not finite or cannot be inverted. */
bool geometry_place(struct geometry *geometry, const double to_mm[3][4]);

/* The plain way: voxel axes are world axes, `spacing_mm` apart, voxel 0,0,0 at the origin. */
void geometry_place_plain(struct geometry *geometry, const double spacing_mm[3]);

/* Which side of the patient each voxel axis runs towards: "RAS" where they are the world's. */
void geometry_axes(char letters[4], const struct geometry *geometry);

/* The way to the world as NRRD, MetaImage and DICOM have it: +x to the left, +y to the back. */
void geometry_to_lps(const struct geometry *geometry, double to_lps_mm[3][4]);

/* Where the middle of a voxel is. */
void geometry_point(const struct geometry *geometry, const uint32_t place[3], double point_mm[3]);

/* The voxel nearest to a point of the world, be it in the scene or not. False where it is out of
 * all proportion: a billion voxels off. */
bool geometry_voxel(const struct geometry *geometry, const double point_mm[3], int64_t place[3]);

#endif
