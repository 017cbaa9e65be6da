/* SPDX-License-Identifier: MIT */
/*
 * Pictures of a session: the rendition, which is stored and updated by the edits since it was drawn
 * when it is wanted again, with the scene behind it if the outlook has a context.
 *
 * Finished labels, which pictures show after `finished on`, need time. So after an edit panels show
 * *rough* labels: the forest's in voxels that the edit changed, the former finished ones elsewhere,
 * and the forest's everywhere if no finished ones are known. session_refine computes the exact ones
 * when there is time. Only panels show rough labels: records, files, comparisons and counts use
 * exact ones (session_labels).
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
    RENDER_ONCE, /* as RENDER_AS_KEPT, for a picture that is not updated later: stores no samples */
};

/* Update the rendition to the present state. RENDER_AS_KEPT, RENDER_INCREMENTAL and RENDER_ONCE
 * update it, the others draw it from scratch. All give the same pixels. Here and below: ERR_MEMORY,
 * ERR_CANCELLED; a session that skims draws nothing, and neither does one within session_show. */
enum err session_render(struct session *session, enum render_mode mode, struct fault *fault);

/* The same without applying the edits that wait. */
enum err session_draw(struct session *session, enum render_mode mode, struct fault *fault);

/* The same for other labels (session_labels): from scratch, for one picture, unless pictures show
 * finished labels (session_shows_finished). */
enum err session_draw_labels(struct session *session, const struct labels *labels,
                             enum render_mode mode, struct fault *fault);

/* A rendition for a panel. If it is wanted within a time and the last one took longer, it may be a
 * coarse one: a quarter of the pixels; or, if much of its surface must be computed first, the one
 * shown last, which may be empty. */
struct glance {
    const struct rendition *rendition;
    uint32_t coarse; /* width of a pixel in pixels of the full rendition */
    bool is_hasty;   /* it is less than the full rendition */
};

/* Draw for a panel: in the view of session_fitting_view, valid until the next of these calls.
 * `within_ns` 0: no limit. *labels are those shown: the forest's, or finished ones, which may be
 * rough. The rendition is that of session_view_in_room; within session_show, the one that a panel
 * showed last, which may be coarse. */
enum err session_draw_fitting(struct session *session, const uint32_t room[2], uint64_t within_ns,
                              struct glance *glance, struct labels *labels, struct fault *fault);

/* The view as panels have it: while zoom and focus are those of a newly opened scene, a view that
 * fits the objects shown last in any direction; its middle is then pictures.own.place. */
struct view session_fitting_view(const struct session *session);

/* The same for a room of {width, height} pixels: if that is larger than the view in both
 * directions, the view has as many pixels as fit there and shows the same part. */
struct view session_view_in_room(const struct session *session, const uint32_t room[2]);

/* Which labels the rendition shows, once session_draw has updated it by the edits that wait;
 * RENDERED_NOT if it is out of date. */
enum rendered { RENDERED_NOT, RENDERED_FOREST, RENDERED_FINISHED };
enum rendered session_rendered(const struct session *session);

/* The rendition at the size of the view; without maps if none was drawn. */
const struct rendition *session_frame(const struct session *session);

/* ---- finished labels in panels ---- */

/* True if pictures show finished labels. False in a session that skims. */
bool session_shows_finished(const struct session *session);

/* The label of a cell as panels show it. */
uint8_t session_shown_label(const struct session *session, uint32_t cell);

/* Voxel counts of the labels that panels show, and counts `before` the last edit; NULL if unknown.
 * And the sums of one of these labels. */
const uint64_t *session_shown_voxels(const struct session *session, const uint64_t **before);
enum err session_sum_shown(struct session *session, unsigned label, struct label_sums *sums,
                           struct fault *fault);

/* True if the labels that a panel would show now are rough. */
bool session_is_rough(const struct session *session);

/* Make it exact under a watch of its own, whose `show` draws with scene->watch = NULL: it must not
 * stop pictures. ERR_CANCELLED, ERR_LIMIT, ERR_MEMORY: nothing has changed. */
enum err session_refine(struct session *session, struct watch *watch, struct fault *fault);

/* ---- the window of greys ---- */

/* Intensities that slices and cut faces show as black and white; they differ. The first is the
 * greater one in a scene whose values fall as intensities rise. */
void window_of(int32_t window[2], struct session *session);

/* The real values that are black and white; and in words: "0" and "142.5". */
void window_values(double value[2], struct session *session);
enum { WINDOW_WORDS_BYTES = 32 };
void window_words(char least[WINDOW_WORDS_BYTES], char most[WINDOW_WORDS_BYTES],
                  struct session *session);

/* ---- for the files of this room ---- */

/* The pictures of the session; created by the first call. ERR_MEMORY. */
enum err pictures_begin(struct pictures **pictures, struct session *session, struct fault *fault);

/* Release the rendition. */
void pictures_release_rendition(struct pictures *pictures);

#endif
