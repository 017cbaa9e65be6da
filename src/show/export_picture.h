/* SPDX-License-Identifier: MIT */
/*
 * Export of pictures: colours, depths, labels, voxels and normals of a session's rendition, and
 * notes about it.
 *
 * Integers become floating point here, and never the reverse. The camera is far enough in front of
 * the scene that all depths are above 0, at the same distance for every angle. World coordinates
 * are those of the scene's geometry, in millimetres towards Right, Anterior, Superior, also for
 * oblique and sheared axes; a geometry without a place in the world has none.
 */
#ifndef SHOW_EXPORT_PICTURE_H
#define SHOW_EXPORT_PICTURE_H

#include "base/buf.h"
#include "image/picture.h"
#include "image/strips.h"
#include "render/rendition.h"
#include "session/session.h"
#include "show/draw.h"

/* Notes of every picture: program, scene, view, and the labels shown, unless NULL. */
enum err export_notes(struct picture *picture, const struct session *session, const bool shown[256],
                      struct fault *fault);

/* Add a note; `words` are released in any case. */
enum err export_note(struct picture *picture, const char *name, struct buf *words,
                     struct fault *fault);

/* "100 %, 30 % of label 1": the default opacity and that of other labels; nothing if all are
 * opaque. */
void export_opacity(struct buf *out, const struct kept *kept);

/* Planes of the rendition, which must be drawn, and notes: PICTURE_BUT_NORMAL, or 0 for a file with
 * colours alone, which are over its background. Depth is in millimetres along the view direction, 0
 * in the middle of the scene. The caller releases the picture, also on error. */
enum err export_picture(struct picture *picture, const struct session *session, unsigned planes,
                        struct fault *fault);

/* Properties of a picture before it is drawn: size, camera, background. */
void export_form(struct picture *picture, const struct session *session);

/* Add the colours over the background to a picture of all planes, as `shown`. */
enum err export_background(struct picture *picture, const struct session *session,
                           struct fault *fault);

/* Add the normals, for files that hold them. */
enum err export_normals(struct picture *picture, const struct session *session,
                        struct fault *fault);

/* Convert normals along voxel axes (unit vectors times 2^14, [pixels][4], the fourth unused) to
 * unit vectors towards Right, Anterior, Superior ([pixels][3]). Zeros stay zeros. */
void seen_normals(float *out, const int16_t *normal, size_t pixels,
                  const struct geometry *geometry);

/* Side of a pixel in the scene. */
double seen_mm_per_pixel(const struct session *session);

/*
 * Export of a picture that is not stored: a few rows of the rendition at a time (render/bands.h) go
 * into a file of its own format (image/strips.h), or as colours into memory.
 *
 * Depth and voxel of its pixels cannot be queried later, so the memory does not depend on the size
 * of the picture, but for a byte a pixel of context (render/mip.h). Letters, scale and legend are
 * drawn over each part. File, notes and digest are those of the stored picture, byte for byte.
 */

/* True if a picture of the view's size is too large to be stored for its file alone. */
bool export_is_large(const struct session *session);

/* Draw labels as session_draw_labels does in that mode, from scratch, and compute the digest of the
 * picture. Requires session_decorates_rows. The rows go into `file`, whose picture is that of
 * export_form; without a file, over their background into picture->rgba, if that is not NULL.
 * `picture` gets its notes; the caller releases it, also on error. No rendition is stored
 * afterwards. ERR_MEMORY, ERR_CANCELLED. */
enum err export_rows(struct picture *picture, struct strips *file, struct session *session,
                     const struct labels *labels, enum render_mode mode, uint64_t *digest,
                     struct fault *fault);

#endif
