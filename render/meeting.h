/*
 * Meeting: which voxel a point of a surface shows, where several objects meet.
 *
 * By its own voxel alone, the line along which two objects meet runs along faces of voxels, and is
 * stairs where voxels are large. So shown voxels up to two steps away speak for their objects, the
 * more the nearer they are; the object that most is said for has the point, and of its voxels the
 * nearest is shown. A point between eight voxels of one object is that object's.
 *
 * The weight is that of two tents along the axes, of one step and of two, of which the former
 * counts three times as much: at the centre of a voxel its own object has the point, and what is as
 * small as a voxel stays.
 */
#ifndef RENDER_MEETING_H
#define RENDER_MEETING_H

#include "render/border.h"

enum {
    MEETING_BITS = 12, /* points are in 2^-12 voxels from the centre of voxel 0 */
    MEETING_REACH =
        2, /* voxels whose labels count are at most so many steps away along each axis */
};

/* Whether the shown ones of the eight voxels around a point are of several objects. Points lie in
 * the scene. */
bool meeting_is_at(const struct border *border, const int32_t point[3]);

/* `own` is the point's own voxel, which is shown, and is given back where no other object has the
 * point. */
uint32_t meeting_voxel(const struct border *border, const int32_t point[3], uint32_t own);

#endif
