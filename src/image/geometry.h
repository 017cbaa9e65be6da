/* SPDX-License-Identifier: MIT */
/*
 * Geometry: the place of a scene in the world, as far as it is known, and the real values of its
 * intensities.
 *
 * It is here, and not in the engine, because it is floating point, which is never used between a
 * seed and a pixel. The facts that the engine needs (spacing, the nearest anatomical axes) are also
 * stored as integers.
 *
 * The world is that of NIfTI: millimetres, +x towards the patient's right, +y towards the front
 * (anterior), +z towards the head (superior).
 *
 * Nothing is guessed. A file may state neither the orientation of its voxels in the patient nor
 * their distance, or two that contradict each other. Axes and distances are then set all the same,
 * since pictures need some, but `orientation` and `spacing_unknown` mark them as meaningless. No
 * caller may print a side of the patient, a place in the world, or a length from such a geometry.
 */
#ifndef IMAGE_GEOMETRY_H
#define IMAGE_GEOMETRY_H

#include <stdbool.h>
#include <stdint.h>

/* The source of the orientation: unknown; the sform or the qform of a NIfTI; another format's
 * matrix, or the definition of a synthetic scene; the user, who names the axes but no place.
 * Records use the same words. */
#define ORIENTATIONS "unknown|sform|qform|file|told"
enum orientation {
    ORIENTATION_UNKNOWN,
    ORIENTATION_SFORM,
    ORIENTATION_QFORM,
    ORIENTATION_FILE,
    ORIENTATION_TOLD
};

/* One of the two ways to the world that a NIfTI may hold. */
struct geometry_form {
    double to_mm[3][4];
    int16_t code; /* as read; 0 if the file has no usable one */
};

/* The fields of a NIfTI that define its geometry, as stored in the file: a saved map has the same
 * fields, bit for bit, and so coincides with the scene in every program. */
struct geometry_fields {
    bool given; /* false for other formats, and for a derived grid */
    int64_t xyzt_units, qform_code, sform_code;
    double pixdim[4], quatern[3], qoffset[3], srow[3][4];
};

struct geometry {
    double to_mm[3][4];      /* world = to_mm * (i, j, k, 1), voxel centres at whole i, j, k */
    double slope, intercept; /* real value = slope * intensity + intercept, intensity 0..65535 */
    uint32_t spacing_nm[3];  /* distance of voxel centres along i, j, k, nanometres, 1.. */
    uint32_t frame;          /* hash of the frame of reference in DICOM; 0: unknown */
    bool spacing_unknown;    /* the file does not state it along every axis; it is set to 1 mm */
    enum orientation orientation;
    int8_t world_axis[3]; /* the world axis (0, 1, 2) nearest to each voxel axis; a permutation */
    int8_t world_sign[3]; /* +1 or -1: in its direction or against it */
    struct geometry_form sform, qform;
    struct geometry_fields fields;
};

/* Return true if the sides of the patient and the distances are known; the origin may not be. */
static inline bool geometry_has_sides(const struct geometry *geometry)
{
    return geometry->orientation != ORIENTATION_UNKNOWN && !geometry->spacing_unknown;
}

/* Return true if to_mm is a place in the world. The user states a direction of axes, no place. */
static inline bool geometry_has_place(const struct geometry *geometry)
{
    return geometry_has_sides(geometry) && geometry->orientation != ORIENTATION_TOLD;
}

/* The real value of an intensity, or of a mean of intensities. */
static inline double geometry_value(const struct geometry *geometry, double intensity)
{
    return geometry->slope * intensity + geometry->intercept;
}

/* Number of significant digits that distinguish the real values of neighbouring intensities, at
 * least 6. */
int geometry_digits(const struct geometry *geometry);

/* Set to_mm, with its source, and compute world_axis and world_sign: the permutation of the axes
 * that is nearest to the matrix (the first one in order, if several are). Returns false, without a
 * change, if the matrix is not finite or cannot be inverted. */
bool geometry_place(struct geometry *geometry, const double to_mm[3][4],
                    enum orientation orientation);

/* Set an unknown orientation: voxel axes equal world axes, with this spacing, voxel 0,0,0 at the
 * origin. The second uses spacing_nm. */
void geometry_place_plain(struct geometry *geometry, const double spacing_mm[3]);
void geometry_place_spaced(struct geometry *geometry);

/* Convert a distance of voxels to whole nanometres; false, and *nm is 1 mm, if it is not a number
 * from 1 nm to 4 m. */
bool geometry_spacing(uint32_t *nm, double mm);

/* The side of the patient towards which each voxel axis runs, for a known orientation: "RAS" for
 * the axes of the world. */
void geometry_axes(char letters[4], const struct geometry *geometry);

/* The matrix to the world of NRRD, MetaImage and DICOM: +x to the left, +y to the back. */
void geometry_to_lps(const struct geometry *geometry, double to_lps_mm[3][4]);

/* Apply `orient`: "sform" or "qform", which the file must have; or letters such as "RAS", which set
 * the axes, keep the spacing and put voxel 0,0,0 at the origin. False for anything else: the
 * letters are one each of R or L, A or P, S or I. */
bool geometry_orient(struct geometry *geometry, const char *how);

/* Set the geometry by the sform or the qform, which must have a code. */
void geometry_take_form(struct geometry *geometry, enum orientation form);

/* Return true if the axes of both have the same directions: the same nearest axes of the world, or
 * within a degree; never if one is the mirror image of the other. */
bool geometry_same_directions(const struct geometry *a, const struct geometry *b);

/* Return true if the axes are left-handed in the world. */
bool geometry_is_mirrored(const struct geometry *geometry);

/* The greatest distance, in millimetres, between the two positions of a voxel of a grid of that
 * size; it occurs in a corner. */
double geometry_apart(const struct geometry *a, const struct geometry *b, const uint32_t size[3]);

/* The distance of voxels along an axis by to_mm, and half of the shortest one, in millimetres. */
double geometry_step_mm(const struct geometry *geometry, int axis);
double geometry_half_voxel(const struct geometry *geometry);

/* The largest deviation of two axes from a right angle, in degrees. */
double geometry_shear(const struct geometry *geometry);

/* Volume of a voxel, relative to a box with the spacings as sides: 1, or less if axes are sheared
 * (by a millionth, 0.08 degrees, and more). */
double geometry_fill(const struct geometry *geometry);

/* The vector between two neighbours along each axis, in millimetres. Axes that are not sheared
 * count as axes of the world. */
void geometry_steps(const struct geometry *geometry, double step_mm[3][3]);

/* Project a step along each voxel axis on a direction of the world, whose components are below
 * 2^30: nanometres times the direction's length. Steps are rounded to nanometres first, so that the
 * result is computed in integers. */
void geometry_along(const struct geometry *geometry, const int64_t direction[3], int64_t along[3]);

/* The largest angle, in degrees, between an axis and the side of the patient that names it; 0 for
 * an unknown orientation. Words and letters for sides are inexact by this angle. */
double geometry_tilt(const struct geometry *geometry);

/* Change to the geometry of a cropped, reduced or interpolated grid: its voxel i, j, k is at voxel
 * first + step * (i, j, k) of this one. False, without a change, if the new spacing is no valid
 * distance. */
bool geometry_derive(struct geometry *geometry, const double first[3], const double step[3]);

/* The position of the middle of a voxel. */
void geometry_point(const struct geometry *geometry, const uint32_t place[3], double point_mm[3]);

/* Convert a vector of the world to steps of voxels, in fractions. */
void geometry_solve(const struct geometry *geometry, const double along_mm[3], double steps[3]);

/* The voxel nearest to a point of the world, inside the scene or not. False if it is a billion
 * voxels away. */
bool geometry_voxel(const struct geometry *geometry, const double point_mm[3], int64_t place[3]);

#endif
