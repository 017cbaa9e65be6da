/* SPDX-License-Identifier: MIT */
/* A command during its execution, and helpers shared by all acts. */
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

/* A command during its execution: its caller, its values and the destination of its answer. */
struct act {
    struct interpreter *interp;
    struct session *session; /* the interpreter's */
    const struct call *call; /* NULL where no command is carried out */
    struct state *next; /* a copy of the session's state for the act to change; act_go applies it */
    struct reply *reply;
    struct fault *fault;
};

/* Return an empty buffer that is released at the end of the command. */
static inline struct buf *act_buf(const struct act *act)
{
    return arena_buf(&act->interp->arena);
}

/* Return the value given for the parameter of this name, which the command has in the table. */
static inline const struct value *act_value(const struct act *act, const char *name)
{
    return call_value(act->call, name);
}

/* True if one of these parameters, "a|b|c", is given. */
static inline bool act_has(const struct act *act, const char *names)
{
    return call_has(act->call, names);
}

/* Return the word given (struct value); NULL if none is given or the value is no word. */
static inline const char *act_text(const struct act *act, const char *name)
{
    return act_value(act, name)->text;
}

/* Return the number given; else 0, or `usual`. */
static inline int64_t act_number(const struct act *act, const char *name)
{
    return act_value(act, name)->number;
}

static inline int64_t act_number_or(const struct act *act, const char *name, int64_t usual)
{
    return act_has(act, name) ? act_number(act, name) : usual;
}

/* Return the place X,Y,Z, or the first and last of a range. */
static inline const uint32_t *act_place(const struct act *act, const char *name)
{
    return act_value(act, name)->place;
}

/* True for "yes" of the choices yes|no; "no" unless given. */
static inline bool act_is_yes(const struct act *act, const char *name)
{
    return act_has(act, name) && act_number(act, name) == 0;
}

/* ---- shared by acts ---- */

/* Apply act->next, the new state, to the session. */
enum err act_go(const struct act *act);

/* Put the name of the command's FILE before the words of an error; return `err`. */
enum err act_prefix_file(const struct act *act, enum err err);

/* Check a name: a word of less than `room` bytes that cannot be mistaken for a number, a colour or
 * an option. ERR_USAGE. */
enum err act_check_name(const char *name, size_t room, struct fault *fault);

/* The mode given by `replace=yes|no`. */
enum file_mode act_file_mode(const struct act *act);

/* Add a line to the answer: "wrote ", say, and the path; and add the path to the files written by
 * the command. act_note_file only does the latter. */
void act_write_file_line(const char *doing, const char *path, struct reply *reply);
void act_note_file(const char *path, struct reply *reply);

/* ERR_USAGE if `report` is given and ends in neither .json nor .csv. */
enum err act_check_report(const struct act *act);

/* Write the text to the file of `report=`, if it is given and the mode allows it, and add a line to
 * the answer. */
enum err act_write_report(const struct act *act, const struct buf *text);

/* Return the labels that a command saves or counts; its pending edits were applied before
 * (COMMAND_ANSWERS). With `finished=yes` these are the finished labels, and their digest is added
 * to the words of the record. At a prompt, without `finished=`, the labels are those of the
 * pictures, and the record contains the choice. The labels of a skimming session are undefined. */
enum err act_take_labels(const struct act *act, struct labels *labels);

/* The same for a picture: without `finished=`, use the setting `finished on|off`. */
enum err act_take_shown(const struct act *act, struct labels *labels);

/* Add a line for each label that the finish deletes, halves or breaks (show/label_loss.h).
 * `only_new`: a single short line that names only labels not named by the previous call.
 * ERR_MEMORY, ERR_CANCELLED. */
enum err act_write_losses(struct interpreter *interp, const struct labels *labels, bool only_new,
                          struct watch *watch, struct buf *out, struct fault *fault);

/* Add "KEY=DIGEST" to the words of the record. */
void act_add_digest(const struct act *act, const char *key, uint64_t digest);

/* Return the position required of a map (`resample`), and the volume chosen in its file. */
struct map_place act_map_place(const struct act *act);

/* Read the map FILE, add its notes to the answer, and convert it by map_to_regions. It must fit the
 * scene's grid unless `resample=yes`. The caller releases the map, also on error. */
enum err act_read_map(const struct act *act, struct volume *map, uint32_t first, uint32_t last);

/* Origin of a journal: landmarks, which match scenes, and the procedure that made the journal
 * (act_ask.c). */

/* Add the lines of `info` about both; nothing without them. */
void act_write_origin(struct buf *out, const struct session *session);

/* Regions of an atlas: their labels and their names (act.c). */

/* Read `regions` and `as` by regions_read. ERR_USAGE if a single label for all is given too;
 * `label` may be NULL. The caller releases the regions, also on error. */
struct regions;
enum err act_choose_regions(struct regions *regions, const struct act *act,
                            const struct value *label);

/*
 * The table next to an atlas, "aal.nii.txt" for "aal.nii.gz", with the names of its regions. It is
 * used for advice only, and never in the replay of a stranger's journal.
 */

/* Read the table; empty if it cannot be read. The caller releases it. */
struct label_table atlas_table(const struct act *act, const char *path);

/* Report names that had to be changed. */
void act_write_changed_names(const struct act *act, const struct label_tally *tally);

/* After seeds were planted from FILE with `regions` and `as`: add a line with the command that
 * names the labels, if the table exists and one of the labels in `has`, other than the background,
 * has no name. */
void atlas_advise_names(const struct act *act, const bool has[256]);

/* Pictures of the session, as commands show and store them (act_picture.c). */

/* Add notes to a picture: the journal, its current chain, and how the shown labels were
 * finished. */
enum err act_note_picture(const struct act *act, const struct labels *labels,
                          struct picture *picture);

/* The caller releases the pictures below, also on error. */

/* Make a picture of the current rendition, which shows these labels, with all notes. `name` is the
 * file name, which determines the planes; NULL for a golden image. */
enum err act_take_picture(const struct act *act, const struct labels *labels, const char *name,
                          struct picture *picture);

/* Make the rendition of *labels, finished if requested. ERR_LIMIT (finish_check), ERR_MEMORY,
 * ERR_CANCELLED. */
enum err act_render_labels(const struct act *act, enum render_mode mode, struct labels *labels);

/* Add the digest of the rendition to the words of the record. */
void act_add_picture_digest(const struct act *act);

/* Write a picture before returning. */
enum err act_write_now(struct interpreter *interp, const char *path, enum file_mode mode,
                       const struct picture *picture, struct fault *fault);

/* Write a picture to `path`, which comes from interpreter_output_path, or move it to the queue of
 * the picture writer, and add a line to the answer. */
enum err act_write_picture(const struct act *act, const char *path, enum file_mode mode,
                           struct picture *picture);

/* Make a picture of a slice or mosaic with notes, and add its digest to the words of the record. */
enum err act_take_slices(const struct act *act, enum slice_kind kind, const struct labels *labels,
                         struct picture *picture);

/* Planting, shared by all commands that plant (planting.c). */

/* Counts of a planting: voxels planted, and voxels left out because they are outside the region of
 * interest, beyond the intensities `within`, or, for a shell, in an object that is neither enclosed
 * nor of the shell's own label. */
struct planting {
    struct interval within;
    unsigned channel; /* channel of the interval, 0 for the first */
    uint16_t reach;   /* the seeds' reach (forest_add_reach), or 0 */
    bool is_shell;
    uint8_t inside;            /* label of the object in the middle of a shell, */
    struct label_set encloses; /* and of all objects that it encloses */
    bool yields; /* it is a piece of a segmentation (session_yield) with these runs: */
    const struct marker_run *run;
    size_t runs;
    size_t planted, outside, beyond, others;
    size_t spared; /* by `over` and `keep` */
    size_t unsure; /* voxels of levels that contain an end of the range */
};

/* `range` is the value of that parameter, or NULL. */
struct planting act_begin_planting(const struct session *session, const struct value *range);

/* Give the planting the reach that holds no voxel if the command has within=0. */
enum err act_find_exact(struct planting *planting, const struct act *act);

/* The same; and leave out voxels by `over` and `keep`, by their labels once the pending edits are
 * applied. With the voxels of several markers, those before end[i] stay before it, for each of
 * `ends`. ERR_USAGE for `over` or `keep` without within=0. */
struct voxels;
enum err act_begin_exact(struct planting *planting, const struct act *act, struct voxels *voxels,
                         size_t *end, size_t ends);

/* Plant one marker in the cells that are allowed, which are moved to the front of `cell`; none if
 * no cell is allowed. ERR_MEMORY, ERR_CANCELLED. */
enum err act_plant(const struct act *act, struct planting *planting, uint32_t *cell, size_t count,
                   int16_t label);

/* Report the voxels left out; ERR_INPUT if all were left out. */
enum err act_write_planting(const struct act *act, const struct planting *planting);

/* Report voxels whose level contains values on both sides of an end of the range, and the step
 * between levels; nothing for 0 voxels. */
void act_write_unsure(const struct act *act, unsigned channel, size_t voxels);

/* Find the voxels of a ball of `radius` at PLACE, or of a stroke if `to` is given; `to` may be
 * NULL. ERR_INPUT for millimetres of voxels of unknown size, ERR_LIMIT (brush_init), ERR_MEMORY,
 * ERR_CANCELLED. The caller releases the voxels, also on error. */
enum err act_find_voxels(const struct act *act, const struct value *to, struct voxels *voxels);

/* Find the word of a record with a result that was computed from the forest, so that resuming a
 * journal does not need the forest. */
struct record_word;
bool act_find_recorded(const struct act *act, const char *key, struct record_word *word);

/* Find the proof of the voxels that the command read, in its record (T1 of command/trust.h). */
bool act_find_proof(const struct act *act, char proof[SHA256_HEX]);

/* Add the words about levels: the ends of the scale, the number of voxels beyond each, and a digest
 * of the file's values; nothing for NULL. */
void act_add_levels(const struct act *act, const struct levels *levels);

/* Add the numbers of the command's new markers to the words of the record. */
void act_add_markers(const struct act *act);

/* Counts of labels (act_figures.c). */

/* Add a line for each label that has voxels: its seeds, voxels and volume. ERR_CANCELLED. */
enum err act_write_counts(const struct act *act);

/* Parts of the answers about a session, shared by `info` and others (answers.c). */

/* Add a line about a voxel: its position, intensity and label, and the seed of its tree. */
void act_write_voxel(struct buf *out, const struct session *session, uint32_t cell);

/* Add a line if edits are pending, which the answer does not include. */
void act_write_waiting(const struct act *act);

/* Add a line if no seed is planted. */
void act_write_no_seeds(const struct act *act);

/* Add "1234 voxels changed, label 3 brain: 1.24 l (+12 ml), label 2: 142 ml, 12.3 ms": the number
 * of voxels with another label; the volumes of changed labels, the largest first, at most six,
 * without label 0; and the time. Call it after session_count_before, an edit of the forest and
 * session_count_labels. If finished labels are shown, whose volumes are not known yet, the text is
 * "1234 voxels changed before finishing, label 3 brain: +12 ml": changes of the forest alone. */
void volumes_write(struct buf *out, const struct session *session, bool is_finished,
                   uint64_t took_ns);

/* Add a line about a surprise (show/label_loss.h): "this `seed` took 1.2 l of label 1 through
 * 93,40,61; undo reverts it". `command` is NULL for pending edits. */
void surprise_write(struct buf *out, struct session *session, const char *command);

/* Add a line about the seed that would own the voxel if its reach (`seed within=`) were larger. */
void act_write_refusal(struct buf *out, const struct session *session, uint32_t cell);

/* " of 1x1x1.5 mm" or " of unknown size"; "axes towards RAS". */
void act_write_spacing(struct buf *out, const struct session *session);
void act_write_axes(struct buf *out, const struct geometry *geometry);

/* "gauss 1.5", "polarity 1:50 2:-20", "of edges.nii" */
void act_write_weight(struct buf *out, const struct kept *kept);

/* Add a line: the region of interest and its number of voxels; nothing without a
 * region. */
void act_write_region(struct buf *out, const struct session *session);

/* Add the line "finish majority radius=1, largest", and whether pictures show finished labels;
 * nothing if there are no steps. */
void act_write_finish(struct buf *out, const struct session *session);

/* Describe the slices: "through 90,108,90: axial 90, ...; window 0 142, overlay contour". */
void act_write_slices(struct buf *out, struct session *session);

#endif
