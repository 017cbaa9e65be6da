/*
 * Finished labels while one works (`finished on`): what panels show of them.
 *
 * Finishing takes time, and nobody is to wait for it. So right after an edit these labels are
 * *rough*: the forest's where those have changed, as they were elsewhere, and all the forest's
 * where nothing better is known. session_refine makes them exact, when there is time for it. Border
 * and rendition follow by what differs.
 *
 * Rough labels are seen in panels and nowhere else: what is recorded, written, compared or counted
 * is exact (session_labels).
 *
 * Invariants
 *   V1 where `of` fits the session (finish_source_is_present), the labels are those that
 *      session_labels gives;
 *   V2 the border is that of the labels, and of `visible` and `cut` as they were when it was last
 *      drawn.
 */
#ifndef SHOW_LIVE_FINISH_H
#define SHOW_LIVE_FINISH_H

#include "render/border.h"
#include "session/finished.h"

/* {0} is none yet. */
struct live_finish {
    uint8_t *label; /* [border.scene->grid.cells], or NULL */
    size_t cells;
    struct finish_source of; /* {0} while they are rough */
    struct border border;
};
size_t live_finish_memory(const struct live_finish *live); /* bytes */

/* Whether pictures show finished labels; not those of a session that skims. */
bool session_shows_finished(const struct session *session);

/* Whether what a panel would show now is rough. */
bool session_is_rough(const struct session *session);

/* The label that panels show at a voxel: the finished one where they show such and have them, else
 * the forest's. */
uint8_t live_finish_label(const struct session *session, uint32_t cell);

/* Makes it exact, under a watch of its own. ERR_CANCELLED where that has stopped it, ERR_LIMIT,
 * ERR_MEMORY: nothing has changed then. */
enum err session_refine(struct session *session, struct watch *watch, struct fault *fault);

/* To be called from `show` of that watch: `draw` makes pictures, which the watch does not stop. */
void session_show_refining(struct session *session, void (*draw)(void *context), void *context);

/* ---- for the files of the session ---- */

/* Has them there to be shown. ERR_MEMORY, ERR_CANCELLED. */
enum err live_finish_begin(struct session *session, struct fault *fault);

/* The same where these exact ones are known. */
enum err live_finish_take(struct session *session, const struct labels *exact, struct fault *fault);

/* After an edit of the forest. */
void live_finish_follow(struct session *session, const struct changes *changes);

/* Nothing is known of them any more. */
void live_finish_drop(struct session *session);

#endif
