/*
 * The session: one person's work on one scene.
 *
 * What a command can change is a value, the state (session/state.h). All else follows from it:
 * weights, region of interest, forest, border, tally, camera and rendition. There is one way to
 * change anything: session_go, which takes on a state and makes anew what differs, seeds by the
 * difference of the two sets where the forest can be updated, and by a rebuild where arcs or the
 * region are others. A command copies the present state, changes the copy, and goes there. Taking
 * a command back, undo, redo, goto, and the end of skimming are the same: going to a state.
 *
 * Edits of seeds wait in a list until session_run applies them as one; because the forest is a
 * function of the set of seeds, it does not matter how they are split over runs.
 *
 * Invariants
 *   S1 a command is all or nothing: session_mark before it, and session_rollback takes back
 *      whatever it did, exactly;
 *   S2 the border fits the forest, the visible labels and the cut; the rendition, where `rendered`,
 *      is that of those labels, their border and the camera, pixel for pixel, whichever mode made
 *      it;
 *   S3 without a scene only session_open does anything, and settings can be made; all else asks
 *      has_scene first;
 *   S4 a scene that was interpolated is kept, with what hangs on it, until the command stands;
 *   S5 what does not fit the state, because a command was cancelled, memory did not suffice to take
 *      one back, or the session skims, is in `stale`, and made anew by the next session_go or
 *      session_complete;
 *   S6 the seeds that are planted, once the edits that wait have been made, are those of the
 *      markers that stand;
 *   S7 a session that `waits` has a large scene that is plain (engine/scene.h), and no seed: the
 *      cells are made by session_complete, which comes before all else that looks at voxels.
 */
#ifndef SESSION_SESSION_H
#define SESSION_SESSION_H

#include "base/err.h"
#include "base/team.h"
#include "engine/forest.h"
#include "engine/label_stats.h"
#include "engine/roi.h"
#include "engine/scene.h"
#include "image/volume.h"
#include "render/border.h"
#include "render/layers.h"
#include "render/rendition.h"
#include "render/shader.h"
#include "show/context.h"
#include "session/map.h"
#include "session/finished.h"
#include "session/hinting.h"
#include "show/live_finish.h"
#include "session/markers.h"
#include "session/semantics.h"
#include "session/state.h"
#include "session/tally.h"

/* Whose labels the rendition shows. */
enum rendered { RENDERED_NOT, RENDERED_FOREST, RENDERED_FINISHED };

/* What interpolating a scene replaces. */
struct former_scene {
    struct scene *scene; /* NULL where there is none */
    struct geometry said;
    bool is_blended; /* its levels */
    uint64_t scene_digest, weight_digest;
    struct forest *forest;
    struct border border;
    struct roi_tally roi_tally;
    unsigned stale;
};

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
    struct finished finished; /* session_labels */
    struct hinting hinting;   /* session_find_hints */
    struct live_finish live;  /* what panels show of finished labels */
    struct tally tally;       /* voxels of each label, once session_count_labels has been called */
    struct label_measures measures; /* of the forest's labels, once somebody has asked for them */
    struct camera camera; /* of the view, `look.samples` times as large; see session_draw_fitting */
    struct rendition rendition;  /* of camera.view's size; no maps where its samples are too many to
                                   be stored */
    struct context context;      /* what is behind it */
    struct layers layers;        /* the rendition's, where objects are translucent */
    struct rendition reduced;    /* to the view's size, where look.samples is above 1 */
    struct drawn_colours *drawn; /* that are being drawn instead (show/drawn_colours.h), or NULL */
    enum rendered rendered;      /* S2: what session_frame gives shows the present state */
    uint8_t *decorated;          /* colours of the frame with what is drawn over them */
    size_t decorated_pixels;
    struct shader shader;
    bool knows_window; /* what follows from the scene, once somebody has asked: */
    int32_t window[2]; /* intensities, black and white */

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
    enum rendered former_rendered;
    bool edited, regrown;
    struct tally tally_before_edit; /* of the last command before it that edited */
};

void session_init(struct session *session);
/* For a session that has done nothing yet: it goes by these from now on. */
void session_take_semantics(struct session *session, unsigned semantics);
void session_release(struct session *session);
size_t session_memory(const struct session *session); /* bytes held now */

/* The same by what holds them: the scene with its forest, border, masks and weights; seeds and
 * markers, and the state that they are in; renditions, and what shading stores; finished labels,
 * statistics and hints. */
struct session_memory {
    size_t scene, seeds, pictures, answers;
};
struct session_memory session_memory_parts(const struct session *session);

/* ---- all or nothing ---- */

/* A command that the watch stopped leaves what it was about unfinished, until session_rollback has
 * taken it back; so does an error. Taking back is watched, and not to be stopped. */
void session_mark(struct session *session);
void session_rollback(struct session *session);
/* The command stands: lets go of what only session_rollback needs and much memory is spent on. The
 * next session_mark does so too. */
void session_settle(struct session *session);

/* Where maps have to lie that a command reads. */
struct map_place session_map_place(const struct session *session, bool resample);

/* ---- the one way to change anything ---- */

/* Takes on the state, which is borrowed, and plants and erases `seeds` seeds (a later edit of a
 * voxel wins), which lead from the present set of seeds to that state's. ERR_LIMIT, and nothing has
 * changed, for a view that no camera has (render/view.h). On other errors, session_rollback gives
 * back the former state. */
enum err session_go(struct session *session, const struct state *state, const struct edit *seed,
                    size_t seeds, struct fault *fault);

/* From now on session_go changes seeds and settings alone, and nothing is computed or drawn, until
 * session_catch_up has computed what all of it would have come to. For the caller who carries out
 * many commands and looks at the last state only. */
void session_skim(struct session *session);
enum err session_catch_up(struct session *session, struct fault *fault);

/* ---- the scene (open.c) ---- */

/* Opens "synth:geom", "synth:geom:XYZ" (each of X, Y, Z 1 or 2), "synth:geom:NXxNYxNZ" (a size in
 * voxels) or what the choice (or NULL) takes of a file. The name is only looked at here; where a
 * file is found is the caller's business. Weights are those of the state, which begins with `morph`
 * over 6 neighbours. */
enum err session_open(struct session *session, const char *path, const struct volume_choice *choice,
                      struct fault *fault);

/* Interpolates the axes a with bit a set in `doubled` to 2n - 1 voxels (engine/scene.h); an axis of
 * one voxel has nothing between and stays as it is. Angles and size of the view stay, the zoom is
 * what opening such a scene gives. ERR_USAGE once a seed is planted or waits to be, and where a
 * mask or weights came out of a file or something is cut away, since those lie on the grid. On
 * error, session_rollback gives back the former scene. */
enum err session_interpolate(struct session *session, unsigned doubled, struct fault *fault);

/* For the caller who opens a scene and may never look at it: a file of `least` bytes or more, of
 * memory as below, is opened without making its cells. All else of the scene is what it will be, as
 * are the answers about it. Then session_complete makes them, and whatever else is to be made anew
 * (S5); it does nothing where nothing waits. ERR_CANCELLED, ERR_MEMORY, and it waits still. */
void session_let_wait(struct session *session, uint64_t least);
enum err session_complete(struct session *session, struct fault *fault);

/* Bytes that a scene of this size takes, all told, or 2^64 - 1 for more than that; session_open
 * refuses one that the machine has not the memory for (ERR_LIMIT), and announces a large one to
 * the watch before it loads it. */
uint64_t session_bytes_for(const uint32_t size[3]);

/* ---- seeds (seeds.c) ---- */

/* How many edits wait for a run. */
static inline size_t session_pendings(const struct session *session)
{
    return edits_count(&session->now.lists.pending);
}

/* Those from the `first` on wait in the order of their voxels. */
static inline void session_sort_pendings(struct session *session, size_t first)
{
    edits_sort_from(&session->now.lists.pending, first);
}

/* Puts up a marker: seeds of a label, that wait for a run; or, for EDIT_ERASE, that are to go. */
enum err session_plant(struct session *session, const uint32_t *cell, size_t count, int16_t label,
                       struct fault *fault);

/* The same of seeds that have a reach: the number of one (forest_add_reach), or 0. */
enum err session_plant_within(struct session *session, const uint32_t *cell, size_t count,
                              int16_t label, uint16_t reach, struct fault *fault);

/* The same of a piece of a segmentation, which yields (session/markers.h): its runs, none where all
 * of it is planted. */
enum err session_plant_piece(struct session *session, const uint32_t *cell, size_t count,
                             int16_t label, const struct marker_run *run, size_t runs,
                             struct fault *fault);

/* The marker that was just put up frees those of these voxels whose markers give way to it: their
 * seeds go, while it stands. */
enum err session_free(struct session *session, const uint32_t *cell, size_t count,
                      struct fault *fault);

/* The marker that was just put up goes on with the one before, which stands. */
void session_join(struct session *session);

/* Takes markers away, by their numbers, with those that are joined to them: their seeds, and the
 * seeds of the markers below come back. ERR_CHECK for a number that no marker which stands has, or
 * that a joined one or an eraser has. */
enum err session_take_away(struct session *session, const uint32_t *number, size_t count,
                           struct fault *fault);

/* The markers, each once, whose trees hold one of the voxels (as of the last run), or that wait to
 * be planted there, or the first ones of their strokes; the caller frees *number. ERR_INPUT where
 * there are none. */
enum err session_find_markers(const struct session *session, const uint32_t *cell, size_t count,
                              uint32_t **number, size_t *numbers, struct fault *fault);

/* An eraser of single trees: it takes away the seed whose tree holds the voxel (as of the last
 * run), or the seed that waits to be planted there. ERR_INPUT where neither is for any of them. */
enum err session_erase_trees(struct session *session, const uint32_t *cell, size_t count,
                             struct fault *fault);

/* The same where it is known which seeds go: those that are not planted and do not wait are
 * ERR_CHECK. */
enum err session_erase_seeds(struct session *session, const uint32_t *seed, size_t count,
                             struct fault *fault);

/* Remembers where the user has put an eliminator, until the run after the next: for slices. */
enum err session_note_eliminator(struct session *session, uint32_t cell, struct fault *fault);

/* Applies the edits that wait; brings border and rendition up to date (the rendition as an
 * incremental image). Fine when none wait. */
enum err session_run(struct session *session, struct fault *fault);

/* Brings `tally` up to date, which takes a walk through the scene after a run from nothing and else
 * no time. ERR_CANCELLED. Not for a session that skims. */
enum err session_count_labels(struct session *session, struct fault *fault);

/* The same before a command whose changes are to be counted: it sets `former_tally` too, and from
 * now on a forest that grows anew notes its labels before, by a walk through the scene. */
enum err session_count_before(struct session *session, struct fault *fault);

/* To be asked for after the command: voxels that it has given another label; CHANGES_UNKNOWN where
 * memory did not suffice to count them. session_count_before comes before the command, and
 * session_count_labels after it. */
uint64_t session_changed_voxels(const struct session *session);

/* ---- what labels have (measures.c) ---- */

/* All that is known of each of these labels (session_labels). Of the forest's, what can follow
 * edits does so from now on (engine/label_stats.h): a replay that never asks never pays.
 * ERR_MEMORY, ERR_CANCELLED. Not for a session that skims. */
enum err session_find_stats(struct session *session, const struct labels *labels,
                            struct label_stats stats[256], struct fault *fault);

/* The sums of a label of the forest, in the same way. */
enum err session_sum_label(struct session *session, unsigned label, struct label_sums *sums,
                           struct fault *fault);

/* How many voxels each label had before the last edit; NULL where that, or how many it has now, is
 * not known. */
const uint64_t *session_voxels_before_edit(const struct session *session);

/* ---- settings that take more than a change of the state (settings.c) ---- */

/* Weights [z][y][x] out of a file called `name`. */
enum err session_set_weight_map(struct session *session, const char *name, const uint16_t *weight,
                                struct fault *fault);

/* The two parts of the region of interest; NULL for none. ERR_INPUT, and nothing has changed, where
 * no voxel would be inside, or a seed that is planted or waits would be outside. */
enum err session_set_mask(struct session *session, const uint64_t *mask, const char *name,
                          const uint32_t regions[2], struct fault *fault);
enum err session_set_range(struct session *session, const struct decimal range[2],
                           struct fault *fault);

enum err session_set_view(struct session *session, const struct view *view, struct fault *fault);

/* ---- pictures (draw.c) ---- */

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

/* What was rendered, at the size of the view. */
const struct rendition *session_frame(const struct session *session);

/* The same as it is shown: over its background, which is black where that is clear. ERR_MEMORY. */
enum err session_show_frame(struct canvas *canvas, const struct session *session,
                            struct fault *fault);

#endif
