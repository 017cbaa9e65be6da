/*
 * Pictures of a session: the rendition, which is stored and follows edits.
 */
#ifndef SHOW_DRAW_H
#define SHOW_DRAW_H

#include "base/err.h"
#include "render/canvas.h"
#include "render/rendition.h"
#include "session/session.h"

enum render_mode {
    RENDER_AS_KEPT,
    RENDER_SCENE,
    RENDER_BORDER,
    RENDER_INCREMENTAL,
    RENDER_RAY,
    RENDER_ONCE, /* as RENDER_AS_KEPT, for a picture that no edit will follow: stores no samples */
};

/* Makes the rendition show the present state. RENDER_AS_KEPT and RENDER_INCREMENTAL do what is
 * left to do, RENDER_ONCE too; the others start from nothing. All give the same pixels. */
enum err session_render(struct session *session, enum render_mode mode, struct fault *fault);

/* The same with the forest as it stands, whatever edits wait. */
enum err session_draw(struct session *session, enum render_mode mode, struct fault *fault);

/* The same of other labels (session_labels): from nothing, for this one picture, unless pictures
 * show finished labels (session_shows_finished). */
enum err session_draw_labels(struct session *session, const struct labels *labels,
                             enum render_mode mode, struct fault *fault);

/* The same to be looked at alone, at the zoom below, until another of these is called, of labels
 * that are given back: the forest's, or finished ones, which may be rough (show/live_finish.h).
 */
enum err session_draw_fitting(struct session *session, struct labels *labels, struct fault *fault);

/* That of the view, thousandths; while it is the one that a scene is opened with, which nobody has
 * chosen, the one at which the scene fits. */
uint32_t session_fitting_zoom(const struct session *session);

/* To be called from `show` of the watch (base/watch.h), while a command is carried out: `draw` may
 * read the session and make pictures of it, as they are so far, and must carry out no command. What
 * the command itself goes by is put back afterwards. */
void session_show(struct session *session, void (*draw)(void *context), void *context);

/* Within `draw`: the cross-hair is shown at another place. The caller puts the former one back, so
 * that no command finds this one. */
void session_show_cross(struct session *session, const uint32_t place[3]);

/* What was rendered, at the size of the view. */
const struct rendition *session_frame(const struct session *session);

/* The same as it is shown: over its background, which is black where that is clear. ERR_MEMORY. */
enum err session_show_frame(struct canvas *canvas, const struct session *session,
                            struct fault *fault);

#endif
