/* SPDX-License-Identifier: MIT */
/* Members of a session for this room only. */
#ifndef SESSION_SESSION_INSIDE_H
#define SESSION_SESSION_INSIDE_H

#include "base/team.h"
#include "engine/doubt.h"
#include "engine/forest.h"
#include "engine/hints.h"
#include "engine/label_stats.h"
#include "engine/relax.h"
#include "engine/roi.h"
#include "engine/scene.h"
#include "image/geometry.h"
#include "image/volume_format.h"
#include "render/border.h"
#include "session/state.h"
#include "session/tally.h"

/* Objects that interpolating a scene replaces. */
struct former_scene {
    struct scene *scene; /* NULL if not interpolated */
    struct geometry said;
    bool is_blended; /* levels->is_blended */
    uint64_t scene_digest, weight_digest;
    struct forest *forest;
    struct border border;
    struct roi_tally roi_tally;
    size_t former_markers;
    unsigned stale;
};

/* The last finished labels, a digest of their inputs, and their own digest. */
struct finished {
    uint8_t *label; /* [cells], or NULL */
    size_t cells;
    uint64_t of, digest; /* session_finish_source; labels_digest */
};
void finished_release(struct finished *finished);

/* The last hints, and a digest of their inputs. */
struct hinting {
    bool has_hints;
    struct hint_list hints;
    uint8_t *heat; /* [cells], or NULL */
    size_t cells;
    uint64_t of;
};

/* The last doubt, and a digest of its inputs. */
struct doubting {
    struct doubt doubt;
    uint64_t of;
};
void doubting_release(struct doubting *doubting);

struct follower;
struct levels;
struct session;

struct session_inside {
    unsigned stale;                  /* parts that do not fit the state, MADE_... (S5) */
    bool waits;                      /* S7 */
    uint64_t waits_from;             /* session_let_wait; 2^64 - 1: never */
    struct finished finished;        /* session_labels */
    struct finished former_finished; /* another state, for undo and redo */
    struct relax_kept relaxed;       /* for faster recomputation */
    struct hinting hinting;          /* session_find_hints */
    struct doubting doubting;        /* doubtful_find */
    struct label_measures measures;  /* measures of the forest's labels, after the first request */

    struct channel_values *channel[CHANNELS_MOST]; /* those of the scene, held */

    bool knows_window; /* session_find_window */
    int32_t window[2];

    const struct follower *follower; /* functions of the pictures */

    /* Memory for the present and the former data, so that going back cannot fail. */
    struct weight_work weight_work;
    uint64_t *mask_room;

    /* The DICOM series of the scene: its path, and the options of `open`. path NULL: none. */
    struct opened_series {
        char *path, *skip;
        struct volume_choice choice;
        uint32_t size[3]; /* size of the scene, as opened */
    } series;

    /* State before the present command. */
    struct former_scene former_scene;
    bool former_has_scene;
    struct tally tally_before_edit; /* tally of the last edit before the command */
};

/* ---- shared by the files of this room ---- */

/* Close the scene, complete or not. */
void session_close_scene(struct session *session);

/* Set the range of a region to the intensities of a channel whose real values are in `range`
 * (image/levels.h); low is above high for an empty range. */
void roi_range(struct roi *roi, const struct session *session, unsigned channel,
               const struct decimal range[2]);

/* Compute the geometry and the scene's axes from the file and `orient`. */
void session_place(struct session *session, const struct kept *kept);

/* True if the cells of a plain scene may wait, because the answer of `open` does not need them;
 * and compute that answer: `weight_digest`. */
bool session_may_wait(const struct session *session);
enum err session_foretell(struct session *session, struct fault *fault);

/* Restore the first channel and remove the others from the scene, before the state changes; and set
 * the channels of the present state (channel.c). Neither can fail. */
void session_take_channels_out(struct session *session);
void session_put_channels_in(struct session *session);
enum err session_reserve_channels(struct session *session, const struct kept *kept,
                                  struct fault *fault);

/* Invalidate pictures. */
void session_forget_pictures(struct session *session);

#endif
