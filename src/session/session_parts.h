/* What the files of a session share: session.c (its life), go.c (the one way to change it), open.c
 * (scenes), draw.c (pictures). */
#ifndef SESSION_SESSION_PARTS_H
#define SESSION_SESSION_PARTS_H

#include "session/session.h"

/* Back to no scene, whatever there is of one. */
void session_close_scene(struct session *session);

void session_release_rendition(struct session *session);

/* The camera of an outlook; ERR_LIMIT where there is none. */
enum err session_aim(const struct session *session, const struct outlook *outlook,
                     struct camera *camera, struct fault *fault);
void session_take_camera(struct session *session, const struct camera *camera);

/* Colours of what the maps of the rendition show, and the picture at the size of the view. */
enum err session_colour(struct session *session, struct fault *fault);

#endif
