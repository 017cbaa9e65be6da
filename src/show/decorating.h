/*
 * What is drawn over the rendition of a session (render/decoration.h): in files, golden images and
 * on the screen, but not in mosaics, whose slices have notes of their own.
 *
 * The frame itself stays as it is, so that the next one can be made of it: colours are copied.
 */
#ifndef SHOW_DECORATING_H
#define SHOW_DECORATING_H

#include "render/canvas.h"
#include "render/rendition.h"
#include "session/session.h"

/* Draws what the outlook asks for over the frame that shows these labels, for session_picture.
 * Does nothing for a session that skims. ERR_MEMORY, ERR_CANCELLED. */
enum err session_decorate(struct session *session, const struct labels *labels,
                          struct fault *fault);

/* The same into a picture [height][width][4] that is yet to be drawn, and clear, alpha 0: it is a
 * layer over what is drawn (canvas_lay_over). Not where a part asks which voxels are seen. */
bool session_decorates_ahead(const struct session *session);
enum err session_decorate_ahead(struct session *session, const struct labels *labels, uint8_t *rgba,
                                struct fault *fault);

/* The frame with what was drawn over it last; all maps but `rgba` are the frame's. */
struct rendition session_picture(const struct session *session);

/* The same as it is shown: over its background, which is black where that is clear. ERR_MEMORY. */
enum err session_show_frame(struct canvas *canvas, const struct session *session,
                            struct fault *fault);

#endif
