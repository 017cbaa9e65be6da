/* SPDX-License-Identifier: MIT */
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
#ifndef SHOW_EXPORT_ROWS_H
#define SHOW_EXPORT_ROWS_H

#include "image/picture.h"
#include "image/strips.h"
#include "session/session.h"
#include "show/draw.h"

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
