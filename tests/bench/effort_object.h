/* SPDX-License-Identifier: MIT */
/* The objects that a robot segments (tests/bench/effort_robot.h): a crop of a scene, and its truth,
 * the largest component of an atlas's regions.
 *
 * Groups: tuned, the objects that weights and steps were tuned on (regions of AAL in ch2, of
 * NeuroMaps in the macaque's head, and three phantoms of effort_phantom.c); other, objects of other
 * regions, atlases and scans, and two more phantoms; ct, a phantom in Hounsfield units. The label
 * of a scene's voxel is that of the atlas's voxel nearest to it in the world.
 *
 * Steps from file to object, in this order: regions, closed by the six faces as often as the row
 * says; scene and truth are reduced, where the row says so, by means and by majorities of blocks of
 * 2x2x2; the largest component stays; the box around it and a margin are cut out; where that is
 * longer than 80 voxels along an axis, once more from a reduced scene, except for tuned objects;
 * intensities are stretched to 8 bits between their 0.1 and 99.9 percentiles. */
#ifndef TESTS_BENCH_EFFORT_OBJECT_H
#define TESTS_BENCH_EFFORT_OBJECT_H

#include "command/interpreter.h"

enum effort_group { GROUP_TUNED, GROUP_OTHER, GROUP_CT, EFFORT_GROUPS };
extern const char *const effort_group_name[EFFORT_GROUPS];

struct effort_object {
    const char *name;
    enum effort_group group;
    uint32_t size[3];
    size_t voxels;
    uint8_t *image, *truth; /* [z][y][x]: grey; 1 in the object, and 0 */
    uint16_t *hounsfield;   /* [z][y][x]: HU + HOUNSFIELD_ZERO, for a CT; or NULL */
};

/* Rows of the table by number; NULL after the last. */
const char *effort_object_name(size_t number);
enum effort_group effort_object_group(size_t number);

/* The program ends if one of its files is not installed. */
void effort_object_load(struct effort_object *object, size_t number,
                        const struct interpreter *interp);
void effort_object_release(struct effort_object *object);

/* Write the object as a NIfTI file for `open`. */
enum err effort_object_save(const struct effort_object *object, const char *path,
                            struct fault *fault);

/* ---- effort_phantom.c ---- */

enum { PHANTOM_SIDE = 72 };
enum phantom {
    PHANTOM_TUBE,
    PHANTOM_TEXTURES,
    PHANTOM_SHELLS,
    PHANTOM_NECK,
    PHANTOM_FADING,
    PHANTOM_CT, /* of several objects: liver, kidney, spleen, aorta, lesion, vessel */
    PHANTOMS
};

/* Both are [PHANTOM_SIDE]^3. `object` is an object of PHANTOM_CT, otherwise 0. */
enum { HOUNSFIELD_ZERO = 1024 };
void phantom_fill(enum phantom phantom, int object, uint16_t *image, uint8_t *truth);

#endif
