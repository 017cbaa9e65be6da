/* SPDX-License-Identifier: MIT */
/* A command that is being carried out, and what all acts have in common. */
#ifndef COMMAND_ACT_H
#define COMMAND_ACT_H

#include "base/buf.h"
#include "base/file.h"
#include "command/command.h"
#include "command/interpreter.h"
#include "command/table.h"
#include "image/geometry.h"
#include "image/levels.h"
#include "image/picture.h"
#include "session/paint.h"
#include "show/draw.h"
#include "show/label_table.h"
#include "show/slicing.h"

struct labels;
struct volume;

/* A command that is being carried out: by whom, with which values, and where its answer goes. */
struct act {
    struct interpreter *interp;
    struct session *session; /* the interpreter's */
    const struct call *call; /* NULL where no command is carried out */
    struct state *next;      /* a copy of the session's state, to be changed; act_go goes there */
    struct reply *reply;
    struct fault *fault;
};

/* An empty buffer that lives as long as the command. */
static inline struct buf *act_buf(const struct act *act)
{
    return arena_buf(&act->interp->arena);
}

/* What the command was given for the parameter of this name, which it has in the table. */
static inline const struct value *act_value(const struct act *act, const char *name)
{
    return call_value(act->call, name);
}

/* Whether one of these parameters, "a|b|c", is given. */
static inline bool act_has(const struct act *act, const char *names)
{
    return call_has(act->call, names);
}

/* The word that it is given as (struct value); NULL where it is not given, or no word. */
static inline const char *act_text(const struct act *act, const char *name)
{
    return act_value(act, name)->text;
}

/* The number; where it is not given, 0, or `usual`. */
static inline int64_t act_number(const struct act *act, const char *name)
{
    return act_value(act, name)->number;
}

static inline int64_t act_number_or(const struct act *act, const char *name, int64_t usual)
{
    return act_has(act, name) ? act_number(act, name) : usual;
}

/* The place X,Y,Z, or the first and last of a range. */
static inline const uint32_t *act_place(const struct act *act, const char *name)
{
    return act_value(act, name)->place;
}

/* Of the choices yes|no; "no" where it is not given. */
static inline bool act_is_yes(const struct act *act, const char *name)
{
    return act_has(act, name) && act_number(act, name) == 0;
}

/* ---- what they have in common ---- */

/* Has the session take on the state act->next. */
enum err act_go(const struct act *act);

/* `err`, with the name of a file before its words. */
enum err act_naming(const char *file, enum err err, struct fault *fault);

/* A name is a word of less than `room` bytes that no number, colour or option can be mistaken for;
 * ERR_USAGE for another. */
enum err act_check_name(const char *name, size_t room, struct fault *fault);

/* What `replace=yes|no` says. */
enum file_mode act_file_mode(const struct act *act);

/* A line of the answer: what was done with the file at `path`, as "wrote "; and the file among
 * those that the command has written, which is all that act_note_file does. */
void act_write_file_line(const char *doing, const char *path, struct reply *reply);
void act_note_file(const char *path, struct reply *reply);

/* ERR_USAGE where `report`, if it is given, ends in neither .json nor .csv. */
enum err act_check_report(const struct act *act);

/* Writes the text to the file that `report` names, if it is given and replay writes it, and says
 * so. */
enum err act_write_report(const struct act *act, const struct buf *text);

/* The labels that a command saves or counts, once the edits that wait have been run: with
 * `finished=yes`, the finished ones, whose digest is added to the words of the record. Where
 * somebody sits at a prompt and does not give `finished=`, it is as pictures show them, and the
 * record says which. In a session that skims they are of no meaning. */
enum err act_take_labels(const struct act *act, struct labels *labels);

/* Adds a line for each label that the finished labels delete, halve or break
 * (report/label_loss.h). `only_new`: one short line, of the labels that the call before has not
 * named. ERR_MEMORY, ERR_CANCELLED. */
enum err act_write_losses(struct interpreter *interp, const struct labels *labels, bool only_new,
                          struct watch *watch, struct buf *out, struct fault *fault);

/* The same for a picture: where `finished=` is not given, as `finished on|off` has it. */
enum err act_take_shown(const struct act *act, struct labels *labels);

/* Adds "KEY=DIGEST" to the words of the record; and that of the weights. */
void act_add_digest(const struct act *act, const char *key, uint64_t digest);
void act_add_weights(const struct act *act);

/* Where a map has to be, by `resample`, and which volume of its file is meant. */
struct map_place act_map_place(const struct act *act);

/* Reads the map FILE, in the place of the scene or, with `resample=yes`, wherever it lies. The
 * caller releases it, also on error. */
enum err act_read_map(const struct act *act, struct volume *map);

/* Where a journal comes from: landmarks, by which scenes are matched, and the procedure that it was
 * made by (act_ask.c). */

struct session;

/* Adds the lines of `info` about both; none where there is nothing. */
void act_write_origin(struct buf *out, const struct session *session);

/* What regions of an atlas become, and what they are called (act.c). */

/* regions_new of `regions` and `as`, by the own numbers of labels (session/map.h); ERR_USAGE
 * where a label for all is given too, which may be NULL. */
enum err act_choose_regions(uint16_t **as, const struct act *act, const struct value *label);

/*
 * The table that lies beside an atlas, "aal.nii.txt" beside "aal.nii.gz": what its regions are
 * called. It is looked at for advice alone, and not where a journal of somebody else is replayed.
 */

/* Empty where there is none that can be read; the caller releases it. */
struct label_table atlas_table(const struct act *act, const char *path);

/* After labels were planted out of FILE, of `regions` and `as`: a line with the command that names
 * them, where one of them (`has`, but for the background) has no name, and the table is there. */
void atlas_advise_names(const struct act *act, const bool has[256]);

/* Pictures of the session, as commands show and store them (act_picture.c). */

/* Adds to the notes of a picture the journal, where its chain stands, and how the labels that it
 * shows were finished. */
enum err act_note_picture(const struct act *act, const struct labels *labels,
                          struct picture *picture);

/* The rendition, which shows these labels, as a picture with all notes, for a file of that name,
 * which says what of it the file holds; or NULL, for a golden image. */
enum err act_take_picture(const struct act *act, const struct labels *labels, const char *name,
                          struct picture *picture);

/* The same of one that is yet to be drawn (show/export_picture.h), as colours, and its digest. */
enum err act_draw_picture(const struct act *act, const struct labels *labels, enum render_mode mode,
                          struct picture *picture, uint64_t *digest);

/* Draws one right into a file, which is there when this returns: of image_strips, at a path that
 * interpreter_output_path gave; where that is empty, for its digest alone. */
struct drawn_file {
    const char *path;
    enum file_mode mode;
    enum render_mode render;
    bool tiled;
};
enum err act_draw_file(const struct act *act, const struct drawn_file *file,
                       const struct labels *labels, uint64_t *digest);

/* Runs the edits that wait, and makes the rendition, finished where that is asked for, of whose
 * labels *labels is. */
enum err act_render_labels(const struct act *act, enum render_mode mode, struct labels *labels);

/* Adds the digest of the rendition to the words of the record. */
void act_add_picture_digest(const struct act *act);

/* A picture as a file that is there when this returns. */
enum err act_write_now(struct interpreter *interp, const char *path, enum file_mode mode,
                       const struct picture *picture, struct fault *fault);

/* Writes a picture to `path`, which interpreter_output_path gave, or has the picture writer do it,
 * and says so. The picture is released, also on error. */
enum err act_write_picture(const struct act *act, const char *path, enum file_mode mode,
                           struct picture *picture);

/* A slice or mosaic as a picture with notes, and its digest among the words. The caller releases
 * the picture. */
enum err act_take_slices(const struct act *act, enum slice_kind kind, const struct labels *labels,
                         struct picture *picture);

/* Planting, as all commands that plant do it (planting.c). */

/* What a command plants: how many voxels it was, and how many not, for being outside the region of
 * interest, or beyond the intensities `within`, or, for a shell, of an object that is neither the
 * one inside nor the shell's own label. */
struct planting {
    struct interval within;
    uint16_t reach; /* of the seeds (forest_add_reach), or 0 */
    bool is_shell;
    uint8_t inside; /* the label of the object inside a shell */
    bool yields;    /* it is the piece of a segmentation (session_plant_piece), of these runs: */
    const struct marker_run *run;
    size_t runs;
    size_t planted, outside, beyond, others;
    size_t unsure; /* taken or not, of levels that the range splits */
};

/* `range` is the parameter of that name, given or not, or NULL. */
struct planting act_begin_planting(const struct session *session, const struct value *range);

/* Plants one more marker, of those of the cells that may be planted, which come to the front. */
enum err act_plant(const struct act *act, struct planting *planting, uint32_t *cell, size_t count,
                   int16_t label);

/* Says what was left out; ERR_INPUT where that was all. */
enum err act_write_planting(const struct act *act, const struct planting *planting);

/* Of so many voxels, the level stands for values on both sides of an end of a range: says so, and
 * how large a level is; nothing of none. */
void act_write_unsure(const struct act *act, size_t voxels);

/* The voxels of a ball of `radius` at PLACE, or, where `to` is not NULL and given, of a stroke. */
enum err act_find_voxels(const struct act *act, const struct value *to, struct voxels *voxels);

/* The word of a record that says what a command found in the forest, so that a session which
 * continues the journal needs none to know it. */
struct record_word;
bool act_find_recorded(const struct act *act, const char *key, struct record_word *word);

/* Adds to the words of the record the numbers of the markers that the command has put up. */
void act_add_markers(const struct act *act);

/* Counts of labels (act_figures.c). */

/* A line for each label that has voxels: its seeds, voxels and volume. */
enum err act_write_counts(const struct act *act);

/* What is said of a session: the lines of `info`, and the words of them that other answers have
 * (answers.c). */

/* A line: where a voxel is, its intensity, its label, and the seed of its tree. */
void act_write_voxel(struct buf *out, const struct session *session, uint32_t cell);

/* A line where edits wait for `run`: what was answered of the labels is without them. */
void act_write_waiting(const struct act *act);

/* A line where there is nothing to answer about. */
void act_write_no_seeds(const struct act *act);

/* Adds "1234 voxels changed, label 3 brain: 1.24 l (+12 ml), label 2: 142 ml, 12.3 ms": the voxels
 * that have another label; the volumes of the labels that became larger or smaller, the largest
 * first, at most six of them and never that of label 0; and the time. For a command that has edited
 * the forest, after session_count_before and session_count_labels. Where finished labels are shown,
 * "1234 voxels changed before finishing" since the volumes are those of the forest. */
void volumes_write(struct buf *out, const struct session *session, bool is_finished,
                   uint64_t took_ns);

/* After it, for a surprise (show/label_loss.h): "this `seed` took 1.2 l of label 1 brain through
 * 93,40,61; undo takes it back". NULL: what waited has. */
void surprise_write(struct buf *out, struct session *session, const char *command);

/* A line about the seed that would take a voxel, but ends before it (`seed within=`). */
void act_write_refusal(struct buf *out, const struct session *session, uint32_t cell);

/* " of 1x1x1.5 mm" or " of unknown size"; "axes towards RAS". */
void act_write_spacing(struct buf *out, const struct session *session);
void act_write_axes(struct buf *out, const struct geometry *geometry);

/* "gauss 1.5", "polarity 1:50 2:-20", "of edges.nii" */
void act_write_weight(struct buf *out, const struct kept *kept);

/* A line: the region of interest, and how many voxels are inside; nothing where there is none. */
void act_write_region(struct buf *out, const struct session *session);

/* "finish    majority radius=1, largest" as a line, and whether pictures show it; nothing where
 * there are no steps. */
void act_write_finish(struct buf *out, const struct session *session);

/* What slices show: "through 90,108,90: axial 90, ...; window 0 142, overlay contour". */
void act_write_slices(struct buf *out, struct session *session);

#endif
