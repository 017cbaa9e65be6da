/* The inside of a session, shared by open.c (scenes) and session.c (all else). */
#ifndef SESSION_SESSION_PARTS_H
#define SESSION_SESSION_PARTS_H

#include "session/fencing.h"
#include "session/session.h"

/* ---- session.c ---- */

/* Weights by the choice, the polarities and the adjacency of the settings. */
enum err session_weigh(struct session *session, struct fault *fault);

/* Back to no scene, whatever there is of one. */
void session_close_scene(struct session *session);

/* ---- open.c ---- */

/* The scene from before an interpolation again, with its forest; the caller sets the view. */
void session_take_back_scene(struct session *session);

#endif
