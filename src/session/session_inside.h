/* SPDX-License-Identifier: MIT */
/* What of a session is for the files of this room alone. */
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
#include "render/border.h"
#include "session/state.h"
#include "session/tally.h"

/* What interpolating a scene replaces. */
struct former_scene {
    struct scene *scene; /* NULL where there is none */
    struct geometry said;
    bool is_blended; /* its levels */
    uint64_t scene_digest, weight_digest;
    struct forest *forest;
    struct border border;
    struct roi_tally roi_tally;
    size_t former_markers;
    unsigned stale;
};

/* The finished labels that were made last, what of, and the digest of what came of it. */
struct finished {
    uint8_t *label; /* [cells], or NULL */
    size_t cells;
    uint64_t of, digest; /* session_finish_source; labels_digest */
};
void finished_release(struct finished *finished);

/* Hints that were made last, and what of. */
struct hinting {
    bool has_hints;
    struct hint_list hints;
    uint8_t *heat; /* [cells], or NULL */
    size_t cells;
    uint64_t forest, labels, weights, origin; /* digests */
    unsigned adjacency;
};

/* Doubt that was found last, and a digest of what of. */
struct doubting {
    struct doubt doubt;
    uint64_t of;
};
void doubting_release(struct doubting *doubting);

struct follower;
struct levels;
struct session;

struct session_inside {
    unsigned stale;      /* of what follows from the state, MADE_... of what does not fit it (S5) */
    bool waits;          /* S7 */
    uint64_t waits_from; /* session_let_wait; 2^64 - 1: never */
    struct finished finished;       /* session_labels */
    struct relax_kept relaxed;      /* to make them again sooner */
    struct hinting hinting;         /* session_find_hints */
    struct doubting doubting;       /* doubtful_find */
    struct label_measures measures; /* of the forest's labels, once somebody has asked for them */

    bool knows_window; /* session_find_window */
    int32_t window[2];

    const struct follower *follower; /* of pictures */

    /* Room for what is now and for what was, so that going back cannot fail. */
    struct weight_work weight_work;
    uint64_t *mask_room;

    /* What the command at hand began with. */
    struct former_scene former_scene;
    bool former_has_scene;
    struct tally tally_before_edit; /* of the last command before it that edited */
};

/* ---- what the files of a session share ---- */

/* Back to no scene, whatever there is of one. */
void session_close_scene(struct session *session);

/* Makes roi->low..high the intensities whose real values lie in a range (image/levels.h); low is
 * above high where there are none. */
void roi_range(struct roi *roi, const struct geometry *geometry, const struct levels *levels,
               const struct decimal range[2]);

/* Has the geometry and the scene's axes follow from what the file says, and `orient`. */
void session_place(struct session *session, const struct kept *kept);

/* Whether the cells of a plain scene may wait, since all that opening it has to say can be said
 * without them; and says it: `weight_digest`. */
bool session_may_wait(const struct session *session);
enum err session_foretell(struct session *session, struct fault *fault);

/* Pictures of it do not fit any more. */
void session_forget_pictures(struct session *session);

#endif
