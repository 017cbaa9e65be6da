/*
 * The session: one person's work on one scene. Scene, forest, border, labels, view and rendition,
 * kept consistent with each other.
 *
 * Edits of seeds wait in a list until session_run applies them as one; because the forest is a
 * function of the set of seeds, it does not matter how they are split over runs.
 *
 * Invariants
 *   S1 a command is all or nothing: session_mark before it, and session_rollback takes back
 *      whatever it did, exactly;
 *   S2 the border fits the forest, the visible labels and the cut; the rendition, where `rendered`,
 * is that of forest, border and view, pixel for pixel, whichever mode made it; S3 without a scene
 * only session_open does anything; all else asks has_scene first; S4 a scene that was interpolated
 * is kept, with what hangs on it, until the command stands.
 */
#ifndef SESSION_SESSION_H
#define SESSION_SESSION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/team.h"
#include "base/err.h"
#include "render/border.h"
#include "engine/roi.h"
#include "engine/forest.h"
#include "engine/scene.h"
#include "engine/weight.h"
#include "image/geometry.h"
#include "render/rendition.h"
#include "render/shade.h"
#include "render/slice.h"
#include "render/view.h"
#include "session/eliminators.h"
#include "session/tally.h"

enum { LABEL_NAME_BYTES = 32, FILE_WORDS_BYTES = 128 };

/* How slices and mosaics are shown. */
struct slice_settings {
    uint32_t cross[3]; /* the voxel that they go through */
    uint32_t zoom;     /* of slices, thousandths of a pixel per smallest spacing; 0 for what fits */
    bool has_window;   /* else it follows from the scene */
    int64_t window_thousandths[2]; /* real values: black and white */
    enum slice_overlay overlay;
    bool crosses, marks, words; /* the cross-hair; seeds and eliminators; letters and bars */
};

/* Everything but seeds that a command can change: small enough to copy whole. */
struct settings {
    struct view view;
    struct look look;
    struct slice_settings slices;
    bool runs_by_itself; /* "auto": each edit is run at once */

    /* What to call the scene, and region of interest and weights that came out of files; a long name is cut. */
    char scene_file[FILE_WORDS_BYTES]; /* without its folder */

    /* From here on, what belongs to the segmentation and is undone: see SETTINGS_KEPT. */
    struct palette palette;
    char label_name[256][LABEL_NAME_BYTES]; /* "" for none */
    bool visible[256];
    struct cut cut;     /* what is cut away of what is visible */
    unsigned adjacency; /* 6 or 26 */
    struct weight_choice weight;
    int8_t polarity[256]; /* of each label, in percent; heeded while the weight is `polarity` */
    char weight_file[FILE_WORDS_BYTES], mask_file[FILE_WORDS_BYTES]; /* "" for none */
    uint32_t mask_regions[2];                                        /* first and last */
    bool has_range;               /* and if so, in real values: */
    int64_t range_thousandths[2]; /* lowest and highest inside */
};

/* Settings from this byte on belong to the segmentation; those before say where one looks from. */
#define SETTINGS_KEPT offsetof(struct settings, palette)

/* What interpolating a scene replaces. */
struct former_scene {
    struct scene *scene; /* NULL where there is none */
    struct geometry geometry;
    uint64_t scene_digest, weight_digest;
    struct forest *forest;
    struct border border;
};

/* The lists that a restored state replaces. */
struct former_lists {
    bool replaced;
    struct edit *pending;
    size_t pendings, pending_capacity;
    struct eliminators eliminators;
};

struct session {
    bool has_scene;
    struct scene *scene;
    struct geometry geometry;
    uint64_t scene_digest, weight_digest;
    char proof[SCENE_PROOF_HEX]; /* of the scene as it was opened (scene_proof) */
    struct team *team;           /* the threads that compute; NULL for one */
    struct forest *forest;
    struct border border;
    struct tally tally; /* voxels of each label: session_label_voxels */
    struct settings settings;

    /* Room for the present weights and for those before, so that taking them back cannot fail. */
    struct weight_work weight_work;

    struct roi roi; /* as applied */
    struct roi_tally roi_tally;

    struct edit *pending; /* seeds and eliminators that wait for a run, in order */
    size_t pendings, pending_capacity;
    struct eliminators eliminators; /* where the user has put them, to be shown */

    bool knows_window; /* what follows from the scene, once somebody has asked: */
    int32_t window[2]; /* intensities, black and white */

    struct camera camera; /* of the view, `look.samples` times as large */
    struct rendition rendition;
    bool has_rendition;       /* the rendition has memory, of camera.view's size */
    bool rendered;            /* S2: it shows the present state */
    struct rendition reduced; /* to the view's size, where look.samples is above 1 */
    struct shader shader;

    struct watch *watch; /* of all that takes long, or NULL */

    bool skims;        /* session_skim */
    bool weighs_later; /* weights are not those of the settings yet */

    /* For session_rollback: what the command at hand began with, and what it has done since. */
    struct settings mark;
    struct tally mark_tally;
    size_t mark_pendings;
    bool mark_has_scene, mark_rendered;
    bool edited_forest;  /* forest_revert takes it back */
    size_t applied;      /* where edited by session_run: how many edits waited for it */
    bool rebuilt_forest; /* under another adjacency or region of interest, or other weights */
    bool weighed_again, roi_changed;
    bool read_weights;   /* out of a file, or as session_restore was given them */
    bool replanted;      /* session_restore changed seeds, and what they grow under */
    struct roi mark_roi; /* its mask is freed by the next mark, where it is not in use again */
    struct roi_tally mark_roi_tally;
    uint16_t *former_weights; /* out of a file, where the command wrote over them, or NULL */
    struct former_scene former;
    struct former_lists former_lists;
};

void session_init(struct session *session);
void session_release(struct session *session);

/* Opens "synth:geom", "synth:geom:XYZ" (each of X, Y, Z 1 or 2), "synth:geom:NXxNYxNZ" (a size in
 * voxels) or a NIfTI file. The name is only looked at
 * here; where a file is found is the caller's business. Weights are `morph` over 6 neighbours. */
enum err session_open(struct session *session, const char *path, struct fault *fault);

/* Interpolates the axes a with bit a set in `doubled` to 2n - 1 voxels (engine/scene.h); an axis of
 * one voxel has nothing between and stays as it is. Angles and size of the view stay, the zoom is
 * what opening such a scene gives. ERR_USAGE once a seed is planted or waits to be, and where a
 * mask or weights came out of a file or something is cut away, since those lie on the grid. On
 * error, session_rollback gives
 * back the former scene. */
enum err session_interpolate(struct session *session, unsigned doubled, struct fault *fault);

/* Bytes that a scene of this size takes, all told, or 2^64 - 1 for more than that; session_open
 * refuses one that the machine has not the memory for (ERR_LIMIT), and tells the watch before it
 * loads a large one. */
uint64_t session_bytes_for(const uint32_t size[3]);
/* Bytes held now. */
size_t session_memory(const struct session *session);

/* ---- edits ---- */

/* Adds an edit to those that wait. */
enum err session_plant(struct session *session, uint32_t cell, uint8_t label, struct fault *fault);

/* Eliminators: each takes away the seed whose tree holds the voxel (as of the last run), or the
 * seed that waits to be planted there. ERR_INPUT where neither is for any of them. */
enum err session_eliminate(struct session *session, const uint32_t *cell, size_t count,
                           struct fault *fault);

/* Applies the edits that wait; brings border and rendition up to date (the rendition as an
 * incremental image). Fine when none wait. */
enum err session_run(struct session *session, struct fault *fault);

/* Both compute weights and forest again. On error, session_rollback gives back the former ones. */
enum err session_set_adjacency(struct session *session, unsigned count, struct fault *fault);
enum err session_set_weight(struct session *session, const struct weight_choice *choice,
                            struct fault *fault);

/* The same with weights [z][y][x] out of a file called `name`. */
enum err session_set_weight_map(struct session *session, const char *name, const uint16_t *weight,
                                struct fault *fault);

/* -100..100 percent; computes the forest again where the weight is `polarity`. */
enum err session_set_polarity(struct session *session, uint8_t label, int8_t percent,
                              struct fault *fault);

/* The two parts of the region of interest. ERR_INPUT where nothing would be inside, or a seed that is planted or
 * waits would be outside. The mask is the session's from now on, also on error; NULL for none, as
 * is a NULL range. Both compute the forest again. */
enum err session_set_mask(struct session *session, uint64_t *mask, const char *name,
                          const uint32_t regions[2], struct fault *fault);
enum err session_set_range(struct session *session, const int64_t thousandths[2],
                           struct fault *fault);

/* ---- a state of before, or beside ---- */

/* A state of the segmentation, as src/session/history.h has it: all of it but the seeds, which are
 * told by what is to be done to those that are planted. */
struct state {
    const struct settings *settings; /* from SETTINGS_KEPT on */
    const struct edit *seed;         /* in order; a later one of a voxel wins */
    size_t seeds;
    struct edit *pending; /* the session's from now on, also on error; as is: */
    size_t pendings;
    uint32_t *eliminator; /* those of the last run, and from `waiting` on those that wait */
    size_t eliminators, waiting;
    bool has_mask, has_weights; /* the mask is another, or none; weights come out of a file: */
    uint64_t *mask;             /* the session's from now on, also on error */
    const uint16_t *weight;     /* [z][y][x] */
};

/* Makes it the session's; what says where one looks from stays. On error, session_rollback gives
 * back the former state. */
enum err session_restore(struct session *session, struct state *state, struct fault *fault);

/* From now on commands change seeds and settings alone, and nothing is computed or drawn: weights,
 * forest, border and rendition are out of date until session_catch_up has computed what they would
 * have come to. For whoever carries out many commands and looks at the last state only. */
void session_skim(struct session *session);
enum err session_catch_up(struct session *session, struct fault *fault);

/* session_eliminate, where it is known which seeds go: those that are not planted and do not wait
 * are ERR_CHECK. */
enum err session_eliminate_seeds(struct session *session, const uint32_t *seed, size_t count,
                                 struct fault *fault);

/* ---- what labels have ---- */

/* Has session_label_voxels know, which takes a walk through the scene after a run from nothing and
 * else no time. ERR_CANCELLED. Not for a session that skims. */
enum err session_count_labels(struct session *session, struct fault *fault);

/* How many voxels have the label now; `former`, when the command at hand began. Of 0, the
 * background and what no seed reaches. session_count_labels comes before; for `former`, before the
 * command did anything. */
uint64_t session_label_voxels(const struct session *session, uint8_t label);
uint64_t session_label_former_voxels(const struct session *session, uint8_t label);

/* ---- what is seen ---- */

/* ERR_LIMIT, and nothing changes, for a view that no camera has (render/view.h), or of more than
 * VIEW_SIDE_MOST samples a side. */
enum err session_set_view(struct session *session, const struct view *view, struct fault *fault);
enum err session_set_look(struct session *session, const struct look *look, struct fault *fault);
void session_set_visible(struct session *session, uint8_t label, bool visible);
/* The boxes and slabs of the cut lie in the scene. */
enum err session_set_cut(struct session *session, const struct cut *cut, struct fault *fault);

enum render_mode { RENDER_AS_KEPT, RENDER_SCENE, RENDER_BORDER, RENDER_INCREMENTAL, RENDER_RAY };

/* Makes the rendition show the present state. RENDER_AS_KEPT and RENDER_INCREMENTAL do what is
 * left to do; the others start from nothing. All give the same pixels. */
enum err session_render(struct session *session, enum render_mode mode, struct fault *fault);

/* The same with the forest as it stands, whatever edits wait. */
enum err session_draw(struct session *session, enum render_mode mode, struct fault *fault);

/* The real values, in thousandths, that are black and white; NULL for what follows from the scene.
 */
void session_set_window(struct session *session, const int64_t thousandths[2]);

/* What was rendered, at the size of the view. */
const struct rendition *session_frame(const struct session *session);

/* ---- all or nothing ---- */

/* A command that the watch stopped leaves what it was about unfinished, until session_rollback has
 * taken it back; so does an error. Taking back is watched, and not to be stopped. */
void session_mark(struct session *session);
void session_rollback(struct session *session);
/* The command stands: lets go of what only session_rollback needs and much memory is spent on. The
 * next session_mark does so too. */
void session_settle(struct session *session);

#endif
