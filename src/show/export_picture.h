/* SPDX-License-Identifier: MIT */
/*
 * Pictures of a session that leave it: colours, depths, labels, voxels and normals of its
 * rendition, and what a picture says of itself.
 *
 * Here integers become floating point, and nothing of it finds its way back. The camera is far
 * enough in front of the scene that all of it has a depth above 0, by the same distance at every
 * angle. The world is that of the scene's geometry, millimetres towards Right, Anterior, Superior,
 * be its axes oblique or sheared; it is not known where that has no place.
 */
#ifndef SHOW_EXPORT_PICTURE_H
#define SHOW_EXPORT_PICTURE_H

#include "base/buf.h"
#include "image/picture.h"
#include "image/strips.h"
#include "render/rendition.h"
#include "session/session.h"
#include "show/draw.h"

/* What every picture says of itself: program, scene, view; and the labels shown, or NULL. */
enum err export_notes(struct picture *picture, const struct session *session, const bool shown[256],
                      struct fault *fault);

/* Adds a note of these words, which are released in any case. */
enum err export_note(struct picture *picture, const char *name, struct buf *words,
                     struct fault *fault);

/* "100 %, 30 % of label 1": the usual opacity, and that of others; nothing where all are opaque. */
void export_opacity(struct buf *out, const struct kept *kept);

/* All planes of the rendition but normals, which must be rendered, and notes: version, scene (its
 * name and digest), view. Depth is in millimetres along the view direction, 0 in the middle of the
 * scene. The caller releases the picture. */
enum err export_picture(struct picture *picture, const struct session *session,
                        struct fault *fault);

/* The same for files that hold colours alone: `rgba` is what they show, over what is behind it. */
enum err export_colours(struct picture *picture, const struct session *session,
                        struct fault *fault);

/* ---- of the same, a picture that is not stored (show/export_picture.h) ---- */

/* What is known of it before it is drawn: sizes, where it is seen from, how files hold it. */
void export_form(struct picture *picture, const struct session *session);

/* ---- more of those that are ---- */

/* What is behind a picture of all planes, for those who look at it: as `shown`. */
enum err export_background(struct picture *picture, const struct session *session,
                           struct fault *fault);

/* The normals as well, for files that hold them. */
enum err export_normals(struct picture *picture, const struct session *session,
                        struct fault *fault);

/* Normals along the axes of voxels (unit vectors times 2^14, [pixels][4], the fourth unused), as
 * unit vectors towards Right, Anterior, Superior ([pixels][3]); zeros stay zeros. */
void seen_normals(float *out, const int16_t *normal, size_t pixels,
                  const struct geometry *geometry);

/* The length of a pixel in the scene. */
double seen_mm_per_pixel(const struct session *session);

/*
 * Pictures that leave a session while they are drawn, and are not stored: the rendition, a few rows
 * at a time (render/bands.h), goes into a file of its own format (image/strips.h), or as colours
 * into memory.
 *
 * Nobody will ask for the depth or the voxel of one of these pixels. So a picture takes the rows at
 * hand, whatever its size; with the context behind it a byte a pixel more (render/mip.h). Letters,
 * scale and legend are drawn over each of the rows. The file, the notes in it and the digest are
 * those of the same picture when it is stored, byte for byte.
 */

/* Whether a picture of the view's size is too large to be stored for its file alone. */
bool export_is_large(const struct session *session);

/* Draws labels as session_draw_labels does in that mode, from nothing, and gives the digest of what
 * is drawn; not where session_decorates_rows says no. The rows go into `file`, whose picture is
 * that of export_form, or where that is NULL, over what is behind them, into picture->rgba, or
 * where that is NULL, nowhere. `picture` gets its notes, and is released after an error. No
 * rendition is stored afterwards. ERR_MEMORY, ERR_CANCELLED. */
enum err export_rows(struct picture *picture, struct strips *file, struct session *session,
                     const struct labels *labels, enum render_mode mode, uint64_t *digest,
                     struct fault *fault);

#endif
