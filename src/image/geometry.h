/* SPDX-License-Identifier: MIT */
/*
 * Geometry: where a scene lies in the world, as far as that is known, and what its intensities
 * mean.
 *
 * Here, and not in the engine, because it is floating point: nothing of it lies on the way from a
 * seed to a pixel. What the engine needs of it (spacing, the nearest anatomical axes) is in
 * integers beside it.
 *
 * The world is that of NIfTI: millimetres, +x towards the patient's right, +y towards the front
 * (anterior), +z towards the head (superior).
 *
 * Nothing is guessed. A file may say neither how its voxels lie in the patient nor how far apart
 * they are, or say two things that contradict each other: then there are axes and distances all
 * the same, for pictures need some, but `orientation` and `spacing_unknown` say that they mean
 * nothing. Nobody may print a side of the patient, a place in the world, or a length from such.
 */
#ifndef IMAGE_GEOMETRY_H
#define IMAGE_GEOMETRY_H

#include <stdbool.h>
#include <stdint.h>

/* Who says how the voxels lie in the patient: nobody; the sform or the qform of a NIfTI; what other
 * formats have for it, or the definition of a synthetic scene; the user, who names the axes but no
 * place. The words are those of records. */
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
    int16_t code; /* as read; 0 where the file gave none that can be used */
};

/* The fields of a NIfTI that say its geometry, as they stand in the file: a map that is saved has
 * the same, bit for bit, and lies on the scene in every program, whatever that makes of them. */
struct geometry_fields {
    bool given; /* false for other formats, and for a derived grid */
    int64_t xyzt_units, qform_code, sform_code;
    double pixdim[4], quatern[3], qoffset[3], srow[3][4];
};

struct geometry {
    double to_mm[3][4];      /* world = to_mm * (i, j, k, 1), voxel centres at whole i, j, k */
    double slope, intercept; /* real value = slope * intensity + intercept, intensity 0..65535 */
    uint32_t spacing_nm[3];  /* distance of voxel centres along i, j, k, nanometres, 1.. */
    bool spacing_unknown;    /* the file does not say it along every axis: it is 1 mm then */
    enum orientation orientation;
    int8_t world_axis[3]; /* the world axis (0, 1, 2) nearest to each voxel axis; a permutation */
    int8_t world_sign[3]; /* +1 or -1: with or against it */
    struct geometry_form sform, qform;
    struct geometry_fields fields;
};

/* Whether to_mm is a place in the world. What the user says is a direction of axes, no place. */
static inline bool geometry_has_place(const struct geometry *geometry)
{
    return geometry->orientation != ORIENTATION_UNKNOWN &&
           geometry->orientation != ORIENTATION_TOLD && !geometry->spacing_unknown;
}

/* The real value of an intensity, or of a mean of some. */
static inline double geometry_value(const struct geometry *geometry, double intensity)
{
    return geometry->slope * intensity + geometry->intercept;
}

/* How many significant digits tell the real value of one intensity from that of the next; 6 at
 * least. */
int geometry_digits(const struct geometry *geometry);

/* Takes `to_mm`, which `orientation` says, as the way to the world and works out world_axis and
 * world_sign: the permutation of the axes that lies nearest to the matrix (the first one in order,
 * where several are). Returns false, and leaves the geometry alone, where the matrix is not finite
 * or cannot be inverted. */
bool geometry_place(struct geometry *geometry, const double to_mm[3][4],
                    enum orientation orientation);

/* Of unknown orientation: voxel axes as if they were world axes, `spacing_mm` apart, voxel 0,0,0 at
 * the origin. */
void geometry_place_plain(struct geometry *geometry, const double spacing_mm[3]);
void geometry_place_spaced(struct geometry *geometry); /* as far apart as spacing_nm says */

/* A distance of voxels in whole nanometres; false, and *nm is 1 mm, where it is none: not a number
 * from 1 nm to 4 m. */
bool geometry_spacing(uint32_t *nm, double mm);

/* Which side of the patient each voxel axis runs towards, of an orientation that is known: "RAS"
 * where they are the world's. */
void geometry_axes(char letters[4], const struct geometry *geometry);

/* The way to the world as NRRD, MetaImage and DICOM have it: +x to the left, +y to the back. */
void geometry_to_lps(const struct geometry *geometry, double to_lps_mm[3][4]);

/* What `orient` says of a scene: "sform" or "qform", which it has to have; or the axes that letters
 * such as "RAS" say, in place of what was: voxels as far apart, and voxel 0,0,0 at the origin.
 * False where that cannot be: the letters are one each of R or L, A or P, S or I. */
bool geometry_orient(struct geometry *geometry, const char *how);

/* Takes the way to the world that the sform or the qform says, which has a code. */
void geometry_take_form(struct geometry *geometry, enum orientation form);

/* Whether the axes of both run the same ways: the same nearest axes of the world, or within a
 * degree; never where one is the mirror image of the other. */
bool geometry_same_directions(const struct geometry *a, const struct geometry *b);

/* Whether the axes are left-handed in the world. */
bool geometry_is_mirrored(const struct geometry *geometry);

/* How far apart, in millimetres, a voxel of a grid of that size lies by the two at most: in one of
 * its corners. */
double geometry_apart(const struct geometry *a, const struct geometry *b, const uint32_t size[3]);

/* The distance of voxels along an axis by to_mm, and half of the shortest, in millimetres. */
double geometry_step_mm(const struct geometry *geometry, int axis);
double geometry_half_voxel(const struct geometry *geometry);

/* The largest angle, in degrees, by which two axes are off a right angle. */
double geometry_shear(const struct geometry *geometry);

/* What part of a box with the spacings for sides a voxel takes: 1, or less where axes are sheared
 * (by a millionth, 0.08 degrees, and more). */
double geometry_fill(const struct geometry *geometry);

/* How far apart in the world two neighbours along an axis are, in millimetres. Voxel axes are world
 * axes where none are sheared. */
void geometry_steps(const struct geometry *geometry, double step_mm[3][3]);

/* How far each step along a voxel axis leads along a direction of the world: in nanometres, times
 * the direction's length, whose components are below 2^30. Steps are rounded to nanometres before,
 * so that this is of integers. */
void geometry_along(const struct geometry *geometry, const int64_t direction[3], int64_t along[3]);

/* The largest angle, in degrees, of an axis and the side of the patient that names it; 0 where no
 * side does. Words and letters for sides are off by as much. */
double geometry_tilt(const struct geometry *geometry);

/* The geometry of a grid whose voxel i, j, k lies where voxel first + step * (i, j, k) of this one
 * does: cropped, reduced or interpolated. False, and nothing changes, where its voxels would be no
 * such distance apart. */
bool geometry_derive(struct geometry *geometry, const double first[3], const double step[3]);

/* Where the middle of a voxel is. */
void geometry_point(const struct geometry *geometry, const uint32_t place[3], double point_mm[3]);

/* The steps of voxels, in fractions, that lead so far in the world. */
void geometry_solve(const struct geometry *geometry, const double along_mm[3], double steps[3]);

/* The voxel nearest to a point of the world, be it in the scene or not. False where it is out of
 * all proportion: a billion voxels off. */
bool geometry_voxel(const struct geometry *geometry, const double point_mm[3], int64_t place[3]);

#endif
