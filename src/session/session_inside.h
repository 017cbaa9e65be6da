/* SPDX-License-Identifier: MIT */
/* What a session is made of, for the files of this room alone, after session.h. All others ask. */
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
#include "image/volume.h"
#include "render/border.h"
#include "render/layers.h"
#include "render/rendition.h"
#include "render/look.h"
#include "session/follower.h"
#include "session/map.h"
#include "session/markers.h"
#include "session/semantics.h"
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
void hinting_release(struct hinting *hinting);

/* Doubt that was found last, and a digest of what of. */
struct doubting {
    struct doubt doubt;
    uint64_t of;
};
void doubting_release(struct doubting *doubting);

struct session {
    unsigned semantics; /* of the journal at hand (session/semantics.h) */
    struct state now;
    struct markers markers; /* of all states; those of `now` are the ones that stand */

    bool has_scene;
    struct scene *scene;
    char scene_file[FILE_WORDS_BYTES]; /* what pictures call it: without its folder, "" for nothing;
                                          a long name is cut */
    bool is_private;                   /* they say neither that nor of which journal they are */
    struct geometry said;              /* what the file says of its geometry, */
    struct geometry geometry;          /* and what follows from it and from what `orient` says */
    struct levels *levels;             /* where intensities are not exact; else NULL */
    struct map_part part;              /* of its file, where it is no more than that */
    uint32_t series; /* of a folder of DICOM that was opened, counted from 1; 0: of none */
    char open_notes[VOLUME_NOTES_BYTES]; /* what the file left open, for the answer of `open` */
    uint64_t scene_digest;
    char proof[SHA256_HEX]; /* of the scene as it was opened (scene_proof) */
    struct team *team;      /* the threads that compute; NULL for one */

    /* What follows from the state; MADE_... of what does not fit it (S5). */
    unsigned stale;
    bool skims; /* session_skim */
    bool waits; /* S7 */
    struct forest *forest;
    uint64_t weight_digest;
    struct roi roi;
    struct roi_tally roi_tally;
    struct border border;
    struct finished finished;  /* session_labels */
    struct relax_kept relaxed; /* to make them again sooner */
    struct hinting hinting;    /* session_find_hints */
    struct doubting doubting;  /* doubtful_find */
    struct tally tally;        /* voxels of each label, once session_count_labels has been called */
    struct label_measures measures; /* of the forest's labels, once somebody has asked for them */

    bool knows_window; /* session_find_window */
    int32_t window[2];

    struct pictures *pictures; /* NULL until one is asked for */
    const struct follower *follower;

    /* Room for what is now and for what was, so that going back cannot fail. */
    struct weight_work weight_work;
    uint64_t *mask_room;

    struct watch *watch; /* of all that takes long, or NULL */
    uint64_t waits_from; /* session_let_wait; 2^64 - 1: never */

    /* What the command at hand began with, and whether it has edited the seeds (then
     * forest_seed_changes says how) or had the forest computed again. */
    struct state former;
    size_t former_markers;
    struct former_scene former_scene;
    struct tally former_tally; /* where session_count_before came before the command */
    bool former_has_scene;
    bool edited, regrown;
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

/* Before the next command: what the tally was before the last one that edited. */
void session_note_edit(struct session *session);

/* Pictures of it do not fit any more. */
static inline void session_forget_pictures(struct session *session)
{
    if (session->pictures)
        session->follower->forget(session->pictures);
}

#endif
