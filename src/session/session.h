/* SPDX-License-Identifier: MIT */
/*
 * The session: one user's work on one scene.
 *
 * All data that a command can change is one value, the state (session/state.h). Weights, region of
 * interest, forest, border, tally and pictures are computed from it. Only session_go changes a
 * session: it sets a state and recomputes the data that differs. It edits the seeds by the
 * difference of the two sets if the forest can be updated, and recomputes the forest if arcs or the
 * region changed. A command copies the present state, changes the copy, and passes it to
 * session_go. Rollback, undo, redo, goto and the end of skimming also set a state.
 *
 * Edits of seeds wait in a list until session_run applies them as one. Because the forest is a
 * function of the set of seeds, their distribution over runs does not matter.
 *
 * Invariants
 *   S1 a command is atomic: session_mark precedes it, and session_rollback restores the former
 *      state exactly;
 *   S2 the border matches the forest, the visible labels and the cut, and pictures of the session
 *      receive all changes (struct follower);
 *   S3 without a scene only session_open and settings are allowed; all other functions require
 *      has_scene;
 *   S4 the scene before interpolation is kept, with its forest and border, until the command is
 *      settled;
 *   S5 `stale` has the parts that do not match the state, because a command was cancelled, memory
 *      did not suffice to roll one back, or the session skims; the next session_go or
 *      session_complete recomputes them;
 *   S6 the planted seeds, after the pending edits, are those of the valid markers;
 *   S7 a session that `waits` has a large plain scene (engine/scene.h), and no seed: call
 *      session_complete, which makes the cells, before any access to voxels.
 */
#ifndef SESSION_SESSION_H
#define SESSION_SESSION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"
#include "base/hash.h"
#include "base/scan.h"
#include "engine/roi.h"
#include "image/geometry.h"
#include "image/volume.h"
#include "render/border.h"
#include "session/map.h"
#include "session/markers.h"
#include "session/state.h"
#include "session/tally.h"

struct camera;
struct changes;
struct edit;
struct hint_list;
struct label_stats;
struct label_sums;
struct labels;
struct map_place;
struct pictures;
struct reach;
struct team;
struct volume_choice;
struct watch;

/*
 * Public members of a session. All rooms may read them, only this room writes them
 * (tests/test_layout.sh). Pointers are borrowed: they are valid until the next command.
 */
struct session {
    unsigned semantics; /* version of the present journal */
    struct state now;
    struct markers markers; /* markers of all states; the valid ones are those of `now` */
    struct team *team;      /* threads for computations; NULL for one */
    struct watch *watch;    /* watch of long computations, or NULL */

    bool has_scene;  /* the following members describe the scene */
    bool skims;      /* between session_skim and session_catch_up */
    bool is_private; /* pictures show neither the scene's name nor the journal's */
    char scene_name[FILE_WORDS_BYTES];   /* name in pictures: without folder, cut if long; ""
                                            for none */
    char open_notes[VOLUME_NOTES_BYTES]; /* doubts about the file, for the answer of `open` */
    uint32_t series;                     /* series of a folder of DICOM, from 1; 0 for none */
    struct map_part part;                /* if the scene is a part of its file; otherwise {0} */
    struct geometry said;                /* geometry in the file, */
    struct geometry geometry;            /* and with the corrections of `orient` */
    struct levels *levels;               /* if intensities are not exact; otherwise NULL */
    struct scene *scene;
    char proof[SHA256_HEX]; /* digest of the scene as it was opened (scene_proof) */
    uint64_t scene_digest, weight_digest;
    struct roi roi;
    struct roi_tally roi_tally;
    struct forest *forest;
    struct border border;
    struct tally tally;        /* voxels of each label, after session_count_labels */
    struct pictures *pictures; /* NULL until one is requested */

    /* State before the present command. `has_edited`: it has edited the seeds (see
     * forest_seed_changes); `has_regrown`: the forest was recomputed. */
    struct state former;
    size_t former_markers;
    struct tally former_tally; /* valid if session_count_before preceded the command */
    bool has_edited, has_regrown;

    struct session_inside *inside; /* for this room only */
};

/* Make a session without a scene; the caller frees the session. ERR_MEMORY. */
enum err session_new(struct session **session, struct fault *fault);
void session_free(struct session *session);

/* Reset a session to its first state, except for its watch and session_let_wait. */
void session_reset(struct session *session);

/*
 * Semantics: the version of the meaning of commands and of their results.
 *
 * A journal has the number in line 1 (journal/FORMAT.md), a session has the number of its journal,
 * and new journals have SEMANTICS. Each change of meaning raises SEMANTICS and is described in
 * FORMAT.md. The affected code compares session->semantics, and keeps the former meaning for older
 * journals.
 *
 * 12 is the number of version 1.0, and may change until 1.0 is frozen. Numbers below
 * SEMANTICS_LEAST belong to builds before 1.0 and are rejected.
 */
enum { SEMANTICS = 12, SEMANTICS_LEAST = 12 };

/* Set the semantics of a session that has carried out no command yet. ERR_INPUT for an unknown
 * number, naming the command to use instead. */
enum err session_set_semantics(struct session *session, unsigned semantics, struct fault *fault);

/* ---- further facts ---- */

void session_name_scene(struct session *session, const char *name, bool is_private);

/* Make the camera of an outlook, with its resolution multiplied by its samples; ERR_LIMIT if no
 * camera is possible. */
enum err session_aim(const struct session *session, const struct outlook *outlook,
                     struct camera *camera, struct fault *fault);

void session_set_watch(struct session *session, struct watch *watch);

size_t session_memory(const struct session *session); /* bytes in use */

/* Memory by owner: the scene with its forest, border, masks and weights; seeds, markers and the
 * state; renditions and data for shading; finished labels, statistics and hints. */
struct session_memory {
    size_t scene, seeds, pictures, answers;
};
struct session_memory session_memory_parts(const struct session *session);

/* ---- pictures ---- */

/*
 * Functions of the pictures of a session (src/show), which exist from the first request until the
 * scene is closed. The session reports its changes to them. No function may fail.
 */
struct follower {
    /* mark: a command begins. take_back: it was rolled back and the session is restored. settle: it
     * is complete; memory of former pictures may be released. */
    void (*mark)(struct pictures *pictures);
    void (*take_back)(struct pictures *pictures);
    void (*settle)(struct pictures *pictures);

    /* follow: labels of the forest and the border changed as listed. forget_labels: they changed in
     * an unknown way. */
    void (*follow)(struct pictures *pictures, const struct changes *changes);
    void (*forget_labels)(struct pictures *pictures);

    /* take_camera: the view has another camera. forget: pictures are invalid for another reason. */
    void (*take_camera)(struct pictures *pictures, const struct camera *camera);
    void (*forget)(struct pictures *pictures);

    /* leave_scene: another scene replaces this one. release: the scene is closed; free the
     * pictures. */
    void (*leave_scene)(struct pictures *pictures);
    void (*release)(struct pictures *pictures);

    /* Add the bytes in use: `pictures`, and `answers` for labels. */
    void (*count_memory)(const struct pictures *pictures, struct session_memory *memory);
};

/* Set the pictures, which the session releases. The session must have a scene and no pictures. */
void session_set_pictures(struct session *session, struct pictures *pictures,
                          const struct follower *follower);

/* Find the default intensities of black and white, the smaller first. Few voxels are as bright
 * as vessels and fat, so WINDOW_BLACK of a thousand voxels are no brighter than black, and 1000 -
 * WINDOW_WHITE are brighter than white (engine/scene.h). Computed once. */
enum { WINDOW_BLACK = 10, WINDOW_WHITE = 995 };
void session_find_window(struct session *session, int32_t window[2]);

/* ---- atomic commands ---- */

/* Mark the beginning of a command. If the watch stops it or it fails, session_rollback restores
 * the former state; the rollback is watched, but cannot be stopped. */
void session_mark(struct session *session);
void session_rollback(struct session *session);
/* Settle the command: release the large memory that only session_rollback needs. The next
 * session_mark also does this. */
void session_settle(struct session *session);

/* The grid for maps that a command reads. */
struct map_place session_map_place(const struct session *session, bool resample);

/* ---- the only way to change a session ---- */

/* Set the state, which is borrowed, and apply `seeds` edits (a later edit of a voxel wins),
 * which lead from the present set of seeds to that of the state. ERR_LIMIT, without a change, for a
 * view without a camera (render/view.h). On other errors, session_rollback restores the former
 * state. */
enum err session_go(struct session *session, const struct state *state, const struct edit *seed,
                    size_t seeds, struct fault *fault);

/* Skim: session_go changes only seeds and settings, without computing or drawing, until
 * session_catch_up computes the last state. Use it for a series of commands if only the last state
 * is needed. session_catch_up does nothing in a session that does not skim. */
void session_skim(struct session *session);
enum err session_catch_up(struct session *session, struct fault *fault);

/* Call from `show` of the watch (base/watch.h), while a command runs: `draw` may read the session
 * and make pictures of its present state, and must not run a command. The data of the command is
 * restored afterwards. */
void session_show(struct session *session, void (*draw)(void *context), void *context);

/* Within `draw`: move the cross-hair. The caller restores it, so that no command uses the
 * temporary one. */
void session_show_cross(struct session *session, const uint32_t place[3]);

/* ---- the scene (open.c) ---- */

/* Open "synth:geom", "synth:geom:XYZ" (each of X, Y, Z 1 or 2), "synth:geom:NXxNYxNZ" (a size in
 * voxels) or the part of a file selected by the choice (may be NULL). The caller has located the
 * file. Weights are those of the state, which begins with `morph` over 6 neighbours. */
enum err session_open(struct session *session, const char *path, const struct volume_choice *choice,
                      struct fault *fault);

/* Interpolate each axis a with bit a set in `doubled` to 2n - 1 voxels (engine/scene.h); an axis
 * of one voxel is unchanged. Angles and size of the view are unchanged, the zoom is that of a new
 * scene of this size. ERR_USAGE after the first seed, planted or pending, and with a mask or
 * weights from a file or a cut, since those belong to the grid. On error, session_rollback restores
 * the former scene. */
enum err session_interpolate(struct session *session, unsigned doubled, struct fault *fault);

/* Lazy opening: a file of `least` bytes or more, in memory as below, is opened without making
 * its cells. All facts about the scene are known. session_complete makes the cells and recomputes
 * stale parts (S5); without either it does nothing. ERR_CANCELLED, ERR_MEMORY: the cells are still
 * missing. */
void session_let_wait(struct session *session, uint64_t least);
enum err session_complete(struct session *session, struct fault *fault);

/* Bytes for a scene of this size, in total, saturated at 2^64 - 1. session_open rejects a scene
 * that does not fit the memory of the machine (ERR_LIMIT), and announces a large one to the watch
 * before loading it. */
uint64_t session_bytes_for(const uint32_t size[3]);

/* ---- seeds (seeds.c) ---- */

/* Number of pending edits. */
size_t session_pendings(const struct session *session);

/* Remove all markers after the first `count`, without a trace in the session. */
void session_truncate_markers(struct session *session, size_t count);

/* Return the number of a reach, for session_plant (forest_add_reach). ERR_MEMORY, ERR_LIMIT. */
enum err session_add_reach(struct session *session, const struct reach *reach, uint16_t *number,
                           struct fault *fault);

/* Add a marker: pending seeds of a label; for EDIT_ERASE, their removal. `reach` is the number
 * of their reach, or 0. */
enum err session_plant(struct session *session, const uint32_t *cell, size_t count, int16_t label,
                       uint16_t reach, struct fault *fault);

/* The same for a piece of a segmentation, which yields (session/markers.h), with its runs; no
 * runs if all of it is planted. */
enum err session_plant_piece(struct session *session, const uint32_t *cell, size_t count,
                             int16_t label, uint16_t reach, const struct marker_run *run,
                             size_t runs, struct fault *fault);

/* Grow a tree from the seeds into voxels of `within` that have a label of the set `takes`, and no
 * others. `grown` gets the seeds that have such labels, and the voxels whose label changes. The
 * tree ends at seeds that users planted in such voxels, and at such voxels around `within`; the
 * session is unchanged. All lists are in the order of cells; the caller releases `grown`. */
struct label_set;
struct voxels;
enum err session_grow_confined(const struct session *session, const struct label_set *takes,
                               int16_t label, const struct voxels *seeds,
                               const struct voxels *within, struct voxels *grown,
                               struct fault *fault);

/* Make the last marker free the voxels `cell`: the seeds of older markers there are removed while
 * it is valid. */
enum err session_free_voxels(struct session *session, const uint32_t *cell, size_t count,
                             struct fault *fault);

/* Join the last marker to the one before, which is valid. */
void session_join(struct session *session);

/* Remove markers by their numbers, with those joined to them: their seeds are removed, and the
 * seeds of the markers below are restored. ERR_CHECK for a number of no valid marker, of a joined
 * one or of an eraser. */
enum err session_remove_markers(struct session *session, const uint32_t *number, size_t count,
                                struct fault *fault);

/* Find the markers, each once, whose trees hold one of the voxels (as of the last run), or that
 * have pending seeds there; a stroke is found as its first part. The caller frees *number.
 * ERR_INPUT if no marker is found. */
enum err session_find_markers(const struct session *session, const uint32_t *cell, size_t count,
                              uint32_t **number, size_t *numbers, struct fault *fault);

/* Add an eraser of single trees: it removes the seed whose tree holds the voxel (as of the last
 * run), or the pending seed there. ERR_INPUT if none of the voxels has either. */
enum err session_erase_trees(struct session *session, const uint32_t *cell, size_t count,
                             struct fault *fault);

/* The same for known seeds: ERR_CHECK for one that is neither planted nor pending. */
enum err session_erase_seeds(struct session *session, const uint32_t *seed, size_t count,
                             struct fault *fault);

/* The effect of an eliminator at a voxel: the marker whose trees hold it, or the single tree.
 * Trees are counted from their roots, so the time depends on their voxels, up to a bound, and not
 * on the size of the scene. */
enum { HELD_MOST = 2000000 }; /* voxels counted, about 80 ms */

struct held {
    uint32_t marker; /* number of the marker, the first of its stroke; 0 for a single tree, */
    uint32_t seed;   /* and then its seed */
    uint8_t label;
    size_t trees;  /* trees of planted seeds */
    size_t waits;  /* its pending seeds */
    size_t voxels; /* voxels of the trees; those of an outline's ring are not counted */
    bool has_more; /* more than HELD_MOST: the three numbers are lower bounds */
};

/* Find the single tree if `tree`, or if the semantics have no markers. ERR_INPUT if nothing
 * holds the voxel; ERR_MEMORY. */
enum err session_find_held(struct held *held, const struct session *session, uint32_t cell,
                           bool tree, struct fault *fault);

/* True if the marker or tree of `held` holds a voxel. Valid until the next command. */
bool session_is_held(const struct session *session, const struct held *held, uint32_t cell);

/* Store the place of an eliminator; slices show it until the run after the next. */
enum err session_note_eliminator(struct session *session, uint32_t cell, struct fault *fault);

/* Apply the pending edits, and update border and rendition (as an incremental image). Does
 * nothing without pending edits. */
enum err session_run(struct session *session, struct fault *fault);

/* ---- answers about labels: not for a session that skims ---- */

/* Update `tally`: by a scan of the scene after a rebuild, otherwise at once. ERR_CANCELLED. Not for
 * a session that skims. */
enum err session_count_labels(struct session *session, struct fault *fault);

/* The same before a command whose changes will be counted: also sets `former_tally`, and makes a
 * forest that is recomputed store its former labels, by a scan of the scene. */
enum err session_count_before(struct session *session, struct fault *fault);

/* Voxels with another label after the command; CHANGES_UNKNOWN if memory did not suffice to
 * count them. Call session_count_before before the command, and session_count_labels after it. */
uint64_t session_changed_voxels(const struct session *session);

/* Compute the statistics of each of these labels (session_labels): stats[256]. Those of the
 * forest are kept up to date from the first call on (engine/label_stats.h), so a replay without
 * questions does not compute them. ERR_MEMORY, ERR_CANCELLED. Not for a session that skims. */
enum err session_find_stats(struct session *session, const struct labels *labels,
                            struct label_stats *stats, struct fault *fault);

/* Compute the sums of a label of the forest, in the same way. */
enum err session_sum_label(struct session *session, unsigned label, struct label_sums *sums,
                           struct fault *fault);

/* Voxels of each label before the last edit; NULL if they, or the present ones, are unknown. */
const uint64_t *session_voxels_before_edit(const struct session *session);

/* Labels for output: the forest's, or if `finished`, after the steps of kept.finish. Borrowed,
 * valid until the next command. Pending edits are ignored: call session_run before. ERR_LIMIT if a
 * step reaches too far for the scene (finish_check), ERR_MEMORY, ERR_CANCELLED. */
enum err session_labels(struct session *session, bool finished, struct labels *labels,
                        struct fault *fault);

/* Digest of the last finished labels of session_labels. */
uint64_t session_finished_digest(const struct session *session);

/* Finished labels of the present state, [grid.cells], if already computed; otherwise NULL. And a
 * digest, not 0, of their inputs: labels and steps, and seeds if a step uses them. */
const uint8_t *session_finished(const struct session *session);
uint64_t session_finish_source(const struct session *session);

/* The next step of a new session. Seeds of one object alone label all of the scene: they need a
 * sphere of background around it. The object with the first background is outlined next. */
enum proposal { PROPOSE_NOTHING, PROPOSE_SPHERE, PROPOSE_OUTLINE };
enum proposal session_find_proposal(const struct session *session);

/* In a session with the origin of a procedure: find the label whose volume differs most from
 * that in the procedure, and the ratio; 0 for no label. ERR_CANCELLED. */
enum err session_find_worst(struct session *session, unsigned *label, double *share,
                            struct fault *fault);

/* Find hints (engine/hints.h), those of the worst label first, in about the time of a run; and
 * their heat if requested, a byte per voxel until the next edit. Borrowed, as above. ERR_USAGE
 * under `weight polarity`, ERR_MEMORY, ERR_CANCELLED. */
enum err session_find_hints(struct session *session, const struct hint_list **hints,
                            const uint8_t **heat, struct fault *fault);

/* ---- settings that need more than a change of the state (go.c) ---- */

/* Set weights [z][y][x] from a file called `name`. */
enum err session_set_weight_map(struct session *session, const char *name, const uint16_t *weight,
                                struct fault *fault);

/* Set the two parts of the region of interest; NULL for none. ERR_INPUT, without a change, if no
 * voxel would be inside, or a planted or pending seed outside. `rest`: the regions that the mask
 * excludes and that maps of labels keep, [z][y][x], or NULL. */
enum err session_set_mask(struct session *session, const uint64_t *mask, const char *name,
                          const uint32_t regions[2], const uint16_t *rest, struct fault *fault);

/* Take out these regions, an array that the caller frees; NULL for none. */
enum err session_take_rest(const struct session *session, uint16_t **rest, struct fault *fault);
enum err session_set_range(struct session *session, const struct decimal range[2],
                           struct fault *fault);

enum err session_set_view(struct session *session, const struct view *view, struct fault *fault);

#endif
