/* The inside of a session, shared by open.c (scenes), restore.c (states of before) and
 * session.c (all else). */
#ifndef SESSION_SESSION_PARTS_H
#define SESSION_SESSION_PARTS_H

#include "session/roi_check.h"
#include "session/session.h"

/* ---- session.c ---- */

/* Weights by the choice, the polarities and the adjacency of the settings. */
enum err session_weigh(struct session *session, struct fault *fault);

/* What commands that touch the forest have in common: an edit of it, which border and rendition
 * follow; and computing it again where it has seeds, or catching up with a suspended one. */
enum err session_edit(struct session *session, const struct edit *edit, size_t count,
                      struct fault *fault);
enum err session_rebuild(struct session *session, bool catches_up, struct fault *fault);

/* Before weights out of a file are written over. */
enum err session_keep_weights(struct session *session, struct fault *fault);

/* The border after `visible` or `cut` has changed. */
void session_recount(struct session *session);

/* Back to no scene, whatever there is of one. */
void session_close_scene(struct session *session);

/* ---- restore.c ---- */

/* The lists of before the command, and no need of them any more. */
void session_take_back_lists(struct session *session);
void session_settle_lists(struct session *session);

/* ---- open.c ---- */

/* The scene from before an interpolation again, with its forest; the caller sets the view. */
void session_take_back_scene(struct session *session);

#endif
