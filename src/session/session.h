/* SPDX-License-Identifier: MIT */
/*
 * The session: one person's work on one scene.
 *
 * What a command can change is a value, the state (session/state.h). All else follows from it:
 * weights, region of interest, forest, border, tally and pictures. There is one way to
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
 *   S2 the border fits the forest, the visible labels and the cut, and pictures of the session hear
 *      of all that changes (session/session.h);
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
 * All that a session knows. Every room reads it, and only this one writes it
 * (tests/test_layout.sh). Pointers are borrowed: they are valid until the next command.
 */
struct session {
    unsigned semantics; /* of the journal at hand */
    struct state now;
    struct markers markers; /* of all states; those of `now` are the ones that stand */
    struct team *team;      /* the threads that compute; NULL for one */
    struct watch *watch;    /* of all that takes long, or NULL */

    bool has_scene;  /* the rest is of the scene */
    bool skims;      /* since session_skim */
    bool is_private; /* pictures say neither the scene's name nor that of its journal */
    char scene_name[FILE_WORDS_BYTES];   /* in pictures: without its folder, "" for nothing; a long
                                          name is cut */
    char open_notes[VOLUME_NOTES_BYTES]; /* what the file left open, for the answer of `open` */
    uint32_t series;          /* of a folder of DICOM that was opened, counted from 1; 0: of none */
    struct map_part part;     /* of its file, where it is no more than that; or {0} */
    struct geometry said;     /* what the file says of its geometry, */
    struct geometry geometry; /* and what follows from it and from what `orient` says */
    struct levels *levels;    /* where intensities are not exact; else NULL */
    struct scene *scene;
    char proof[SHA256_HEX]; /* of the scene as it was opened (scene_proof) */
    uint64_t scene_digest, weight_digest;
    struct roi roi;
    struct roi_tally roi_tally;
    struct forest *forest;
    struct border border;
    struct tally tally;        /* voxels of each label, once session_count_labels has been called */
    struct pictures *pictures; /* NULL until one is asked for */

    /* What the command at hand began with, and whether it has edited the seeds (then
     * forest_seed_changes says how) or had the forest computed again. */
    struct state former;
    size_t former_markers;
    struct tally former_tally; /* where session_count_before came before the command */
    bool has_edited, has_regrown;

    struct session_inside *inside; /* of this room alone */
};

/* One without a scene, which the caller frees. ERR_MEMORY. */
enum err session_new(struct session **session, struct fault *fault);
void session_free(struct session *session);

/* As it was when it was new, but for its watch and session_let_wait. */
void session_begin_again(struct session *session);

/*
 * Semantics: the version of the meaning of commands and of their results.
 *
 * A journal has the number in line 1 (journal/FORMAT.md), a session has the number of its journal,
 * and new journals have SEMANTICS. Each change of meaning raises SEMANTICS and is described in
 * FORMAT.md; code that such a change is about compares session->semantics and keeps the former
 * meaning for older journals.
 *
 * 12 is the number of version 1.0, and stays open until 1.0 is frozen. Numbers below
 * SEMANTICS_LEAST belong to builds before 1.0 and are refused.
 */
enum { SEMANTICS = 12, SEMANTICS_LEAST = 12 };

/* Sets the semantics of a session that has carried out no command yet. ERR_INPUT for a number that
 * is not known, with the command to use instead. */
enum err session_take_semantics(struct session *session, unsigned semantics, struct fault *fault);

/* ---- what it knows besides ---- */

void session_name_scene(struct session *session, const char *name, bool is_private);

/* The camera of an outlook, finer by as many times as it has samples; ERR_LIMIT for none. */
enum err session_aim(const struct session *session, const struct outlook *outlook,
                     struct camera *camera, struct fault *fault);

void session_set_watch(struct session *session, struct watch *watch);

size_t session_memory(const struct session *session); /* bytes held now */

/* The same by what holds them: the scene with its forest, border, masks and weights; seeds and
 * markers, and the state that they are in; renditions, and what shading stores; finished labels,
 * statistics and hints. */
struct session_memory {
    size_t scene, seeds, pictures, answers;
};
struct session_memory session_memory_parts(const struct session *session);

/* ---- pictures of it ---- */

/*
 * Who follows a session: the pictures of it (src/show), which are there from the first one on that
 * somebody asks for until the scene is closed. A session that nobody looks at has none, and no
 * session knows what they are: it says what happens to it. None of that can fail.
 */
struct follower {
    /* A command begins; it is taken back, and the session is as it was then; it stands, and what
     * nobody will ask for any more goes. */
    void (*mark)(struct pictures *pictures);
    void (*take_back)(struct pictures *pictures);
    void (*settle)(struct pictures *pictures);

    /* The forest's labels have changed like this, and the session's border with them; or have in a
     * way that no list says. */
    void (*follow)(struct pictures *pictures, const struct changes *changes);
    void (*forget_labels)(struct pictures *pictures);

    /* The view has another camera; or what was drawn fits no more, for another reason. */
    void (*take_camera)(struct pictures *pictures, const struct camera *camera);
    void (*forget)(struct pictures *pictures);

    /* Another scene takes the place of this one; or there is none any more, and all of it goes. */
    void (*leave_scene)(struct pictures *pictures);
    void (*release)(struct pictures *pictures);

    /* Adds the bytes held: `pictures`, and `answers` for labels. */
    void (*count_memory)(const struct pictures *pictures, struct session_memory *memory);
};

/* From now on these hear of it, and the session releases them. It has a scene, and none yet. */
void session_take_pictures(struct session *session, struct pictures *pictures,
                           const struct follower *follower);

/* The intensities that are black and white where nobody has chosen, the smaller first: few voxels
 * are as bright as vessels and fat, so of a thousand voxels WINDOW_BLACK are no brighter, and
 * 1000 - WINDOW_WHITE brighter (engine/scene.h). Found once. */
enum { WINDOW_BLACK = 10, WINDOW_WHITE = 995 };
void session_find_window(struct session *session, int32_t window[2]);

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
 * many commands and looks at the last state only. session_catch_up does nothing in a session that
 * does not skim. */
void session_skim(struct session *session);
enum err session_catch_up(struct session *session, struct fault *fault);

/* To be called from `show` of the watch (base/watch.h), while a command is carried out: `draw` may
 * read the session and make pictures of it, as they are so far, and must carry out no command. What
 * the command itself goes by is put back afterwards. */
void session_show(struct session *session, void (*draw)(void *context), void *context);

/* Within `draw`: the cross-hair is shown at another place. The caller puts the former one back, so
 * that no command finds this one. */
void session_show_cross(struct session *session, const uint32_t place[3]);

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
size_t session_pendings(const struct session *session);

/* As if the markers after the first `count` had never been put up. */
void session_drop_markers(struct session *session, size_t count);

/* The number of a reach, for session_plant (forest_add_reach). ERR_MEMORY, ERR_LIMIT. */
enum err session_add_reach(struct session *session, const struct reach *reach, uint16_t *number,
                           struct fault *fault);

/* Puts up a marker: seeds of a label, that wait for a run; or, for EDIT_ERASE, that are to go.
 * `reach` is the number of theirs, or 0. */
enum err session_plant(struct session *session, const uint32_t *cell, size_t count, int16_t label,
                       uint16_t reach, struct fault *fault);

/* The same of a piece of a segmentation, which yields (session/markers.h): its runs, none where all
 * of it is planted. */
enum err session_plant_piece(struct session *session, const uint32_t *cell, size_t count,
                             int16_t label, const struct marker_run *run, size_t runs,
                             struct fault *fault);

/* The marker that was just put up frees those of these voxels whose markers give way to it: their
 * seeds go, while it stands. */
enum err session_free_voxels(struct session *session, const uint32_t *cell, size_t count,
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

/* What an eliminator at a voxel would take away: the marker whose trees hold it, or the single
 * tree. Trees are counted from their roots, so this takes time by what is held, up to a bound, and
 * never by the scene. */
enum { HELD_MOST = 2000000 }; /* voxels that are counted: some 80 ms */

struct held {
    uint32_t marker; /* its number, the first of a stroke's; 0 for a single tree, */
    uint32_t seed;   /* which is this one's */
    uint8_t label;
    size_t trees;  /* of seeds that are planted */
    size_t waits;  /* seeds of it that wait to be */
    size_t voxels; /* of the trees; what an outline's ring has is not counted */
    bool has_more; /* than HELD_MOST: these three are the least that there are */
};

/* Of `tree`, or where the semantics know no markers, the single tree. ERR_INPUT where nothing holds
 * the voxel; ERR_MEMORY. */
enum err session_find_held(struct held *held, const struct session *session, uint32_t cell,
                           bool tree, struct fault *fault);

/* Whether it holds a voxel, until the next command. */
bool session_is_held(const struct session *session, const struct held *held, uint32_t cell);

/* Remembers where the user has put an eliminator, until the run after the next: for slices. */
enum err session_note_eliminator(struct session *session, uint32_t cell, struct fault *fault);

/* Applies the edits that wait; brings border and rendition up to date (the rendition as an
 * incremental image). Fine when none wait. */
enum err session_run(struct session *session, struct fault *fault);

/* ---- what labels have (answers.c): not for a session that skims ---- */

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

/* All that is known of each of these labels (session_labels): stats[256]. Of the forest's, what can
 * follow edits does so from now on (engine/label_stats.h): a replay that never asks never pays.
 * ERR_MEMORY, ERR_CANCELLED. Not for a session that skims. */
enum err session_find_stats(struct session *session, const struct labels *labels,
                            struct label_stats *stats, struct fault *fault);

/* The sums of a label of the forest, in the same way. */
enum err session_sum_label(struct session *session, unsigned label, struct label_sums *sums,
                           struct fault *fault);

/* How many voxels each label had before the last edit; NULL where that, or how many it has now, is
 * not known. */
const uint64_t *session_voxels_before_edit(const struct session *session);

/* Labels as they are to be handed out: the forest's, or, where `finished`, what the steps of the
 * state's kept.finish make of them. Borrowed: of use until the next command. Edits that wait count
 * for nothing, so session_run comes before. ERR_LIMIT where a step reaches too far for the scene
 * (finish_check), ERR_MEMORY, ERR_CANCELLED. */
enum err session_labels(struct session *session, bool finished, struct labels *labels,
                        struct fault *fault);

/* The digest of the finished labels that session_labels gave last. */
uint64_t session_finished_digest(const struct session *session);

/* Finished labels of the present state, [grid.cells], where they are made already; else NULL. And a
 * digest, not 0, of all that they follow from: labels and steps, and seeds where a step heeds them.
 */
const uint8_t *session_finished(const struct session *session);
uint64_t session_finish_source(const struct session *session);

/* In a session that has the origin of a procedure: the label whose volume is farthest from what it
 * was there, and so many times that; 0 where there is none. ERR_CANCELLED. */
enum err session_find_worst(struct session *session, unsigned *label, double *share,
                            struct fault *fault);

/* Hints (engine/hints.h), those of the worst label first, made in about the time of a run; and
 * their heat where it is asked for, a byte a voxel until the next edit. Borrowed, as above.
 * ERR_USAGE under `weight polarity`, ERR_MEMORY, ERR_CANCELLED. */
enum err session_find_hints(struct session *session, const struct hint_list **hints,
                            const uint8_t **heat, struct fault *fault);

/* ---- settings that take more than a change of the state (go.c) ---- */

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

#endif
