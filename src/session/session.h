/* SPDX-License-Identifier: MIT */
/*
 * The session: one user's work on one scene.
 *
 * The state (session/state.h) is one value with all data that a command can change. Weights, region
 * of interest, forest, border, tally and pictures are computed from it. Only session_go goes to
 * another state: it sets the state and recomputes the data that differs. If arcs or region changed,
 * it recomputes the forest; otherwise it updates the forest by the difference of the two sets of
 * seeds. A command copies the present state, changes the copy, and passes it to session_go.
 * Rollback, undo, redo and goto also set states in this way.
 *
 * Functions that plant or erase only add markers and pending edits to the present state.
 * session_run applies all pending edits together. Since the forest depends only on the set of
 * seeds, it does not matter which run applies an edit.
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
 *   S5 `stale` has the parts that do not match the state, because a command was cancelled, there
 *      was not enough memory for a rollback, or the session skims; the next session_go or
 *      session_complete recomputes them;
 *   S6 the planted seeds, with the pending edits applied, are the seeds of the valid markers;
 *   S7 a session that `waits` has a large plain scene (engine/scene.h) without cells, and no seed:
 *      before any access to voxels, call session_complete, which makes the cells.
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
 * Public members of a session. All other folders may read them; only src/session writes them
 * (tests/test_layout.sh). Pointers are borrowed: they are valid until the next command.
 */
struct session {
    unsigned semantics; /* semantics of the present journal */
    struct state now;
    struct markers markers; /* markers of all states; the valid ones are those of `now` */
    struct team *team;      /* threads for computations; NULL for the caller's thread only */
    struct watch *watch;    /* watch of long computations, or NULL */

    bool has_scene;  /* the following members describe the scene */
    bool skims;      /* between session_skim and session_catch_up */
    bool is_private; /* pictures show neither the scene's name nor the journal's */
    char scene_name[FILE_WORDS_BYTES];   /* name in pictures: without folder, cut if long; ""
                                            for none */
    char open_notes[VOLUME_NOTES_BYTES]; /* warnings about the file, for the answer of `open` */
    uint32_t series;                     /* number of the DICOM series, from 1; 0 for none */
    struct map_part part;                /* if the scene is a part of its file; otherwise {0} */
    struct geometry said;                /* geometry in the file */
    struct geometry geometry;            /* geometry after corrections by `orient` */
    struct levels *levels;               /* levels of inexact intensities; NULL if all are exact */
    struct scene *scene;
    char proof[SHA256_HEX]; /* digest of the scene as it was opened (scene_proof) */
    uint64_t scene_digest, weight_digest;
    struct roi roi;
    struct roi_tally roi_tally;
    struct forest *forest;
    struct border border;
    struct tally tally;        /* voxels of each label, after session_count_labels */
    struct pictures *pictures; /* NULL until one is requested */
    bool is_shown;             /* while a command runs (session_show) */

    /* State before the present command. `has_edited`: the command has edited seeds
     * (forest_seed_changes); `has_regrown`: it has recomputed the forest. */
    struct state former;
    size_t former_markers;
    struct tally former_tally; /* valid if session_count_before preceded the command */
    bool has_edited, has_regrown;

    struct session_inside *inside; /* for src/session only */
};

/* Make a session without a scene; the caller frees the session. ERR_MEMORY. */
enum err session_new(struct session **session, struct fault *fault);
void session_free(struct session *session);

/* Reset a session to its initial state; only its watch and the limit of session_let_wait remain. */
void session_reset(struct session *session);

/*
 * Semantics: the version of the meaning of commands and of their results.
 *
 * A journal has its number in line 1 (journal/FORMAT.md), a session has the number of its journal,
 * and new journals have SEMANTICS. Each change of meaning increments SEMANTICS and is a row of a
 * table in FORMAT.md. The affected code tests session->semantics, and keeps the former meaning for
 * older journals; src/README.md has an example.
 *
 * Number 12 is that of version 1.0, and final. Numbers below SEMANTICS_LEAST are those of
 * development versions and are rejected.
 */
enum { SEMANTICS = 12, SEMANTICS_LEAST = 12 };

/* Set the semantics of a session that has not run a command yet. ERR_INPUT for an unknown number;
 * the message states how to continue. */
enum err session_set_semantics(struct session *session, unsigned semantics, struct fault *fault);

/* ---- other properties ---- */

void session_name_scene(struct session *session, const char *name, bool is_private);

/* Compute the camera of an outlook. Width, height and zoom are multiplied by the samples along each
 * side of a pixel. ERR_LIMIT if no camera is possible. */
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
 * Callbacks of the pictures of a session (src/show), which exist from the first request until the
 * scene is closed. The session calls them for each change. They cannot fail.
 */
struct follower {
    /* mark: a command begins. take_back: the command was rolled back. settle: the command is
     * complete; memory of former pictures may be released. */
    void (*mark)(struct pictures *pictures);
    void (*take_back)(struct pictures *pictures);
    void (*settle)(struct pictures *pictures);

    /* follow: labels of the forest and the border changed as listed. forget_labels: labels and
     * border changed, extent unknown. */
    void (*follow)(struct pictures *pictures, const struct changes *changes);
    void (*forget_labels)(struct pictures *pictures);

    /* take_camera: the camera changed. forget: pictures are invalid for another reason. */
    void (*take_camera)(struct pictures *pictures, const struct camera *camera);
    void (*forget)(struct pictures *pictures);

    /* leave_scene: another scene replaces this one. release: the scene is closed; free the
     * pictures. */
    void (*leave_scene)(struct pictures *pictures);
    void (*release)(struct pictures *pictures);

    /* Add the bytes in use to the members `pictures` and `answers`. */
    void (*count_memory)(const struct pictures *pictures, struct session_memory *memory);
};

/* Set the pictures; the session then owns them. The session must have a scene and no pictures. */
void session_set_pictures(struct session *session, struct pictures *pictures,
                          const struct follower *follower);

/* Find the default intensities of black and white, the smaller first: the quantiles WINDOW_BLACK
 * and WINDOW_WHITE, in thousandths, of all intensities (engine/scene.h). White is below the
 * maximum, so that a few bright voxels, of vessels and fat, do not darken all others. Computed
 * once. */
enum { WINDOW_BLACK = 10, WINDOW_WHITE = 995 };
void session_find_window(struct session *session, int32_t window[2]);

/* ---- atomic commands ---- */

/* Mark the beginning of a command. If it fails or the watch stops it, session_rollback restores the
 * former state. The rollback reports progress to the watch, but cannot be stopped. */
void session_mark(struct session *session);
void session_rollback(struct session *session);
/* Settle the command: release the memory that only session_rollback needs. The next session_mark
 * also does this. */
void session_settle(struct session *session);

/* The grid on which a command reads maps. */
struct map_place session_map_place(const struct session *session, bool resample);

/* ---- the only way to another state ---- */

/* Set the state, which is borrowed, and apply `seeds` edits, which change the present set of seeds
 * into that of the state; the last edit of a voxel counts. ERR_LIMIT, without a change, for a view
 * without a camera (render/view.h). On other errors, session_rollback restores the former state. */
enum err session_go(struct session *session, const struct state *state, const struct edit *seed,
                    size_t seeds, struct fault *fault);

/* Skim a series of commands if only the last state is needed: session_go changes only seeds
 * and settings, without computing or drawing, until session_catch_up computes the last state.
 * session_catch_up does nothing in a session that does not skim. */
void session_skim(struct session *session);
enum err session_catch_up(struct session *session, struct fault *fault);

/* Call this from `show` of the watch (base/watch.h), while a command runs. `draw` may read the
 * session and make pictures of its present state, in which slices have the labels of the forest and
 * the rendition is the last one: the border is that of the former labels. It must not run a
 * command. Data that `draw` updates, such as counts, is restored afterwards, so that the command
 * does not depend on it. */
void session_show(struct session *session, void (*draw)(void *context), void *context);

/* Move the cross-hair within `draw`. The caller restores it, so that no command uses the temporary
 * place. */
void session_show_cross(struct session *session, const uint32_t place[3]);

/* ---- the scene (open.c) ---- */

/* Open "synth:geom", "synth:geom:XYZ" (each of X, Y, Z 1 or 2), "synth:geom:NXxNYxNZ" (a size in
 * voxels) or the part of a file selected by `choice` (may be NULL); `path` is the final path of the
 * file. Weights are those of the state, initially `morph` over 6 neighbours. */
enum err session_open(struct session *session, const char *path, const struct volume_choice *choice,
                      struct fault *fault);

/* Read the series of the scene again, and describe it for a segmentation; the caller releases
 * out->words in any case. ERR_INPUT if the scene is no DICOM series, or its files have changed. */
struct dicom_source;
enum err session_find_source(const struct session *session, struct dicom_source *out,
                             bool keeps_identity, struct fault *fault);

/* Interpolate each axis a for which bit a of `doubled` is set, from n to 2n - 1 voxels
 * (engine/scene.h). The angles and the size of the view do not change; the zoom is that of a new
 * scene of this size. ERR_USAGE if there is a seed, planted or pending, a mask, a further channel,
 * a cut, a landmark or weights from a file, since all of these belong to the grid; ERR_LIMIT if the
 * machine lacks the memory. On error, session_rollback restores the former scene. */
enum err session_interpolate(struct session *session, unsigned doubled, struct fault *fault);

/* Lazy opening: do not make the cells of a scene for which session_bytes_for returns `least` or
 * more (S7); all facts about the scene are known nevertheless. session_complete makes missing cells
 * and recomputes stale parts (S5). After ERR_CANCELLED or ERR_MEMORY cells are still missing. */
void session_let_wait(struct session *session, uint64_t least);
enum err session_complete(struct session *session, struct fault *fault);

/* Total bytes for a scene of this size, saturated at 2^64 - 1. session_open rejects a scene that
 * does not fit into the memory of the machine (ERR_LIMIT), and announces a large one to the watch
 * before loading it. */
uint64_t session_bytes_for(const uint32_t size[3]);

/* ---- seeds (seeds.c) ---- */

/* Number of pending edits. */
size_t session_pendings(const struct session *session);

/* Remove all markers after the first `count`, as if they had never existed. */
void session_truncate_markers(struct session *session, size_t count);

/* Set *number to the number of a reach, for session_plant (forest_add_reach). ERR_MEMORY,
 * ERR_LIMIT. */
enum err session_add_reach(struct session *session, const struct reach *reach, uint16_t *number,
                           struct fault *fault);

/* Add a marker of pending seeds of a label; with EDIT_ERASE, of pending removals. `reach` is the
 * number of their reach, or 0. ERR_INPUT for a seed outside the region of interest, and the errors
 * of markers_add. */
enum err session_plant(struct session *session, const uint32_t *cell, size_t count, int16_t label,
                       uint16_t reach, struct fault *fault);

/* Make the last marker yield (session/markers.h): it is a piece of a segmentation. `run` has all
 * voxels of the piece; pass no runs if all of its voxels are planted. */
enum err session_yield(struct session *session, const struct marker_run *run, size_t runs,
                       struct fault *fault);

/* Compute the tree that would grow from the seeds into the voxels of `within` whose label is in
 * `takes`; the session does not change. The tree ends at seeds of users in such voxels, and at
 * voxels outside `within` with a label of `takes`, which act as seeds of their label. `grown`
 * receives the voxels whose label would change, and the seeds in voxels with a label of `takes`.
 * All lists are in the order of cells; the caller releases `grown`. */
struct label_set;
struct voxels;
enum err session_grow_confined(const struct session *session, const struct label_set *takes,
                               int16_t label, const struct voxels *seeds,
                               const struct voxels *within, struct voxels *grown,
                               struct fault *fault);

/* Make the last marker free the voxels `cell` (session/markers.h): the seeds that yielding markers
 * have there are removed as long as the last marker is valid. */
enum err session_free_voxels(struct session *session, const uint32_t *cell, size_t count,
                             struct fault *fault);

/* Join the last marker to the previous one, which must be valid. */
void session_join(struct session *session);

/* Remove the markers with these numbers, and the markers joined to them: remove their seeds, and
 * restore the seeds that they replaced. ERR_CHECK if a number belongs to no valid marker, or to a
 * joined marker or an eraser. */
enum err session_remove_markers(struct session *session, const uint32_t *number, size_t count,
                                struct fault *fault);

/* Find the markers whose trees contained any of the voxels after the last run, or that have pending
 * seeds there. Each is listed once; of joined markers, only the first. The caller frees *number,
 * also on error. ERR_INPUT if no marker is found. */
enum err session_find_markers(const struct session *session, const uint32_t *cell, size_t count,
                              uint32_t **number, size_t *numbers, struct fault *fault);

/* Add an eraser of single trees: for each voxel, it removes the seed whose tree held the voxel
 * after the last run, or the pending seed there. ERR_INPUT if no voxel has such a seed. */
enum err session_erase_trees(struct session *session, const uint32_t *cell, size_t count,
                             struct fault *fault);

/* Add an eraser of these seeds. ERR_CHECK for a voxel without a planted or pending seed. */
enum err session_erase_seeds(struct session *session, const uint32_t *seed, size_t count,
                             struct fault *fault);

/* The effect of an eliminator at a voxel: it removes the marker whose trees hold the voxel, or a
 * single tree. Counting starts at the roots of the trees and stops after HELD_MOST voxels, so that
 * the time depends on the size of the trees and not on that of the scene. */
enum { HELD_MOST = 2000000 }; /* voxels counted, about 80 ms */

struct held {
    uint32_t marker; /* number of the marker, the first of joined ones; 0 for a single tree */
    uint32_t seed;   /* seed of the single tree */
    uint8_t label;
    size_t trees;  /* trees of planted seeds */
    size_t waits;  /* pending seeds */
    size_t voxels; /* voxels of the trees, except those of an outline's ring */
    bool has_more; /* more than HELD_MOST voxels: the three numbers are lower bounds */
};

/* Find the marker that holds a voxel, or with `tree` the single tree. ERR_INPUT if no tree and no
 * pending seed holds the voxel; ERR_MEMORY. */
enum err session_find_held(struct held *held, const struct session *session, uint32_t cell,
                           bool tree, struct fault *fault);

/* True if the marker or tree of `held` holds a voxel. Valid until the next command. */
bool session_is_held(const struct session *session, const struct held *held, uint32_t cell);

/* Store the place of an eliminator: slices mark it as pending until the next run, and as applied
 * until the run after it. */
enum err session_note_eliminator(struct session *session, uint32_t cell, struct fault *fault);

/* Apply the pending edits, and update the border. Does nothing without pending edits. */
enum err session_run(struct session *session, struct fault *fault);

/* ---- answers about labels: not for a session that skims ---- */

/* Update `tally`: by a scan of the scene after a rebuild, otherwise from the list of changes.
 * ERR_CANCELLED. */
enum err session_count_labels(struct session *session, struct fault *fault);

/* Call this before a command whose changes will be counted. Updates `tally` and copies it to
 * `former_tally`. */
enum err session_count_before(struct session *session, struct fault *fault);

/* Compute the statistics of these labels (session_labels), by label: stats[256]. From the first
 * call on, the statistics of the forest are updated by each edit (engine/label_stats.h), so that a
 * replay without questions does not compute them. ERR_MEMORY, ERR_CANCELLED. */
enum err session_find_stats(struct session *session, const struct labels *labels,
                            struct label_stats *stats, struct fault *fault);

/* Compute the sums (engine/label_stats.h) of one label of the forest, from the same statistics. */
enum err session_sum_label(struct session *session, unsigned label, struct label_sums *sums,
                           struct fault *fault);

/* Number of voxels of each label before the last edit; NULL if these numbers or the present ones
 * are unknown. */
const uint64_t *session_voxels_before_edit(const struct session *session);

/* Find the labels for output: the forest's labels, or with `finished` the result of the steps of
 * kept.finish. They are borrowed and valid until the next command. Pending edits are not included:
 * call session_run first. ERR_LIMIT if a step extends too far for the scene (finish_check),
 * ERR_MEMORY, ERR_CANCELLED. */
enum err session_labels(struct session *session, bool finished, struct labels *labels,
                        struct fault *fault);

/* Digest of the last finished labels that session_labels has computed. */
uint64_t session_finished_digest(const struct session *session);

/* Finished labels of the present state, [grid.cells]; NULL if they are not computed yet. The second
 * function returns a digest, never 0, of their inputs: labels and steps, and seeds if a step uses
 * them. */
const uint8_t *session_finished(const struct session *session);
uint64_t session_finish_source(const struct session *session);

/* Propose the next step of a new session. PROPOSE_SPHERE if one object has seeds and the background
 * has none: its label fills the scene, so a sphere of background should enclose it.
 * PROPOSE_OUTLINE if there is one marker of an object and one of the background. Otherwise, and
 * with an eraser or pieces of a segmentation, PROPOSE_NOTHING. */
enum proposal { PROPOSE_NOTHING, PROPOSE_SPHERE, PROPOSE_OUTLINE };
enum proposal session_find_proposal(const struct session *session);

/* After `origin` (a journal of `iftty apply`), find the label whose volume differs most from its
 * volume in the procedure, and the ratio of the two volumes. Label 0 without `origin`.
 * ERR_CANCELLED. */
enum err session_find_worst(struct session *session, unsigned *label, double *share,
                            struct fault *fault);

/* Find the hints (engine/hints.h), beginning with the label of session_find_worst, and, if
 * requested, a heat map, one byte per voxel. Needs about the time of a run. Both are borrowed and
 * valid until the next edit. ERR_USAGE under `weight polarity`, ERR_MEMORY, ERR_CANCELLED. */
enum err session_find_hints(struct session *session, const struct hint_list **hints,
                            const uint8_t **heat, struct fault *fault);

/* True if the heat map of the present forest is stored. */
bool session_has_heat(const struct session *session);

/* ---- channels (channel.c) ---- */

/* Make the intensities of a channel from a volume on the scene's grid, whose levels are taken. One
 * holder: the caller. ERR_MEMORY, ERR_CANCELLED. */
enum err channel_values_new(struct channel_values **values, const struct session *session,
                            struct volume *volume, struct fault *fault);
uint64_t channel_values_digest(const struct channel_values *values);

/* ERR_USAGE if there is no such channel, from 0. */
enum err kept_has_channel(const struct kept *kept, unsigned channel, struct fault *fault);

/* The channel in the cells, 0 for the first: the outlook's, if it exists; and its slot. */
unsigned session_shown_channel(const struct session *session);
unsigned session_shown_slot(const struct session *session);

/* An odd digest of its intensities, 1 for the first channel. */
uint64_t session_shown_digest(const struct session *session);

/* Replace slope and intercept in *geometry, a copy of the session's, by those of a channel, and
 * return its levels, which are borrowed; NULL if all its intensities are exact. */
const struct levels *session_scale(struct geometry *geometry, const struct session *session,
                                   unsigned channel);

/* Intensities of a channel whose real values are in a range. */
struct interval session_within(const struct session *session, unsigned channel,
                               const struct decimal range[2]);

/* "channel 2 FLAIR": the channel that is shown; and "in channel 2 FLAIR: " if there are several. */
void channel_write(struct buf *out, const struct session *session);
void channel_write_in(struct buf *out, const struct session *session);

/* ---- settings that must be checked first (go.c) ---- */

/* Set weights [z][y][x] from a file called `name`. */
enum err session_set_weight_map(struct session *session, const char *name, const uint16_t *weight,
                                struct fault *fault);

/* Set the two parts of the region of interest, mask and range; NULL removes one. ERR_INPUT, without
 * a change, if no voxel would be inside or if a planted or pending seed would be outside. `rest`:
 * the regions that the mask excludes and that maps of labels keep, [z][y][x], or NULL. */
enum err session_set_mask(struct session *session, const uint64_t *mask, const char *name,
                          const uint32_t regions[2], const uint16_t *rest, struct fault *fault);
enum err session_set_range(struct session *session, unsigned channel, const struct decimal range[2],
                           struct fault *fault);

/* Unpack the regions `rest` of session_set_mask into a new array *rest, which the caller frees,
 * also on error; NULL if it has no region. ERR_MEMORY, ERR_CANCELLED. */
enum err session_take_rest(const struct session *session, uint16_t **rest, struct fault *fault);

enum err session_set_view(struct session *session, const struct view *view, struct fault *fault);

#endif
