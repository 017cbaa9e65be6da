/*
 * Where a rendition was seen from, in the world: for files that other programs make use of.
 *
 * The camera is far enough in front of the scene that all of it has a depth above 0, by the same
 * distance at every angle. The world is that of the scene's geometry, millimetres towards Right,
 * Anterior, Superior, be its axes oblique or sheared; it is not known where that has no place.
 */
#ifndef SHOW_SEEN_FROM_H
#define SHOW_SEEN_FROM_H

#include "image/picture.h"
#include "session/session.h"

void seen_from(struct picture_space *space, const struct session *session);

/* The length of a pixel in the scene. */
double seen_mm_per_pixel(const struct session *session);

/* Normals along the axes of voxels ([pixels][4], the fourth unused) as unit vectors in the world
 * ([pixels][3]); zeros stay zeros. */
void seen_normals(float *out, const int16_t *normal, size_t pixels,
                  const struct geometry *geometry);

#endif
