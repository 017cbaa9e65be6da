/* SPDX-License-Identifier: MIT */
/*
 * Pictures of a session: the rendition, which is stored and follows edits, with the scene behind it
 * where the outlook has it so.
 *
 * Finished labels, where pictures show them (`finished on`), take time to be made, and nobody is to
 * wait for that. So right after an edit those that panels show are *rough*: the forest's where
 * these have changed, as they were elsewhere, and all the forest's where nothing better is known.
 * session_refine makes them exact, when there is time for it. Rough labels are seen in panels and
 * nowhere else: what is recorded, written, compared or counted is exact (session_labels).
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
 * left to do, RENDER_ONCE too; the others start from nothing. All give the same pixels. Here and
 * below ERR_MEMORY, ERR_CANCELLED; nothing is drawn of a session that skims. */
enum err session_render(struct session *session, enum render_mode mode, struct fault *fault);

/* The same with the forest as it stands, whatever edits wait. */
enum err session_draw(struct session *session, enum render_mode mode, struct fault *fault);

/* The same of other labels (session_labels): from nothing, for this one picture, unless pictures
 * show finished labels (session_shows_finished). */
enum err session_draw_labels(struct session *session, const struct labels *labels,
                             enum render_mode mode, struct fault *fault);

/* A rendition to be looked at. In a hurry, where it is wanted within so many nanoseconds (0: in
 * none) and the last one took longer, it may be what is drawn at once: a quarter of its pixels, or,
 * where its surface is to be made first, what was drawn last, which may be nothing. */
struct glance {
    const struct rendition *rendition;
    uint32_t coarse; /* a pixel of it stands for so many a side */
    bool is_hasty;   /* it is not what it is without a hurry */
};

/* The same to be looked at alone, in the view below, until another of these is called, of labels
 * that are given back: the forest's, or finished ones, which may be rough. In a room that is larger
 * than the view, both ways, it has as many pixels as fit there, and shows the same. */
enum err session_draw_fitting(struct session *session, const uint32_t room[2], uint64_t within_ns,
                              struct glance *glance, struct labels *labels, struct fault *fault);

/* The view as panels have it: while zoom and focus are those of a newly opened scene, a view that
 * fits the objects shown last in any direction; its middle is then pictures.own.place. */
struct view session_fitting_view(const struct session *session);

/* Whose labels the rendition shows, as they are now. */
enum rendered { RENDERED_NOT, RENDERED_FOREST, RENDERED_FINISHED };
enum rendered session_rendered(const struct session *session);

/* What was rendered, at the size of the view; without maps where nothing was. */
const struct rendition *session_frame(const struct session *session);

/* ---- finished labels in panels ---- */

/* Whether pictures show finished labels; not those of a session that skims. */
bool session_shows_finished(const struct session *session);

/* The label of a cell as panels show it. */
uint8_t session_shown_label(const struct session *session, uint32_t cell);

/* How many voxels each label has as panels show it, and had `before` the last edit; NULL for what
 * is not known. And the sums of one, which session_sum_label has of the forest's. */
const uint64_t *session_shown_voxels(const struct session *session, const uint64_t **before);
enum err session_sum_shown(struct session *session, unsigned label, struct label_sums *sums,
                           struct fault *fault);

/* Whether what a panel would show now is rough. */
bool session_is_rough(const struct session *session);

/* Make it exact under a watch of its own, whose `show` draws with scene->watch = NULL: it must not
 * stop pictures. ERR_CANCELLED, ERR_LIMIT, ERR_MEMORY: nothing has changed. */
enum err session_refine(struct session *session, struct watch *watch, struct fault *fault);

/* ---- the window of greys ---- */

/* Intensities that slices, and faces that are cut open, show as black and white; they differ. A
 * scene whose values fall as intensities rise has the greater one first. */
void window_of(int32_t window[2], struct session *session);

/* The real values that are black and white; and in words: "0" and "142.5". */
void window_values(double value[2], struct session *session);
enum { WINDOW_WORDS_BYTES = 32 };
void window_words(char least[WINDOW_WORDS_BYTES], char most[WINDOW_WORDS_BYTES],
                  struct session *session);

/* ---- for the files of this room ---- */

/* The pictures of the session, which are made where there are none. ERR_MEMORY. */
enum err pictures_begin(struct pictures **pictures, struct session *session, struct fault *fault);

/* Lets go of what was rendered. */
void pictures_release_rendition(struct pictures *pictures);

#endif
