/* SPDX-License-Identifier: MIT */
/*
 * Decorations over the rendition of a session (render/decoration.h): in files, golden images and on
 * the screen, but not in mosaics, whose slices have notes of their own.
 *
 * Colours are copied before they are drawn over: the next frame is computed from the frame itself.
 */
#ifndef SHOW_DECORATING_H
#define SHOW_DECORATING_H

#include "render/canvas.h"
#include "render/decoration.h"
#include "render/rendition.h"
#include "session/session.h"

/* Draw the decorations of the outlook over the frame of these labels, for session_picture. Does
 * nothing in a session that skims. ERR_MEMORY, ERR_CANCELLED. */
enum err session_decorate(struct session *session, const struct labels *labels,
                          struct fault *fault);

/* The same for some rows of a picture at a time, by any thread; all that does not depend on the row
 * is computed once. Marks of seeds and the cross-hair cannot be drawn this way: they depend on the
 * visibility of voxels elsewhere. */
struct decorating {
    struct decoration of; /* without a frame */
    struct camera camera; /* set by the caller */
    struct legend_line line[255];
    uint32_t *eliminator;
};
bool session_decorates_rows(const struct session *session);
enum err decorating_begin(struct decorating **decorating, struct session *session,
                          const struct labels *labels, struct fault *fault);
void decorating_end(struct decorating *decorating); /* accepts NULL */

/* The frame with its latest decorations; all maps but `rgba` are the frame's own. */
struct rendition session_picture(const struct session *session);

/* The same over its background, black for a clear one, as a screen shows it. ERR_MEMORY. */
enum err session_show_frame(struct canvas *canvas, const struct session *session,
                            struct fault *fault);

#endif
