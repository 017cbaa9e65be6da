/* SPDX-License-Identifier: MIT */
/*
 * What is drawn over the rendition of a session (render/decoration.h): in files, golden images and
 * on the screen, but not in mosaics, whose slices have notes of their own.
 *
 * The frame itself stays as it is, so that the next one can be made of it: colours are copied.
 */
#ifndef SHOW_DECORATING_H
#define SHOW_DECORATING_H

#include "render/canvas.h"
#include "render/decoration.h"
#include "render/rendition.h"
#include "session/session.h"

/* Draws what the outlook asks for over the frame that shows these labels, for session_picture.
 * Does nothing for a session that skims. ERR_MEMORY, ERR_CANCELLED. */
enum err session_decorate(struct session *session, const struct labels *labels,
                          struct fault *fault);

/* The same over some rows of a picture, as they are drawn, by any thread: what is drawn over all of
 * it is found once. Not marks of seeds, nor the cross-hair: which voxels are seen no row knows. */
struct decorating {
    struct decoration of; /* without a frame */
    struct camera camera; /* the caller says which */
    struct legend_line line[255];
    uint32_t *eliminator;
};
bool session_decorates_rows(const struct session *session);
enum err decorating_begin(struct decorating **decorating, struct session *session,
                          const struct labels *labels, struct fault *fault);
void decorating_end(struct decorating *decorating); /* NULL is fine */

/* The frame with what was drawn over it last; all maps but `rgba` are the frame's. */
struct rendition session_picture(const struct session *session);

/* The same as it is shown: over its background, which is black where that is clear. ERR_MEMORY. */
enum err session_show_frame(struct canvas *canvas, const struct session *session,
                            struct fault *fault);

#endif
