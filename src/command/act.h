/* What each command does: act_NAME carries it out. The table (command/table.c) names them. */
#ifndef COMMAND_ACT_H
#define COMMAND_ACT_H

#include "command/interpreter.h"
#include "image/levels.h"
#include "report/label_report.h"
#include "session/paint.h"
#include "show/draw.h"
#include "show/slicing.h"

/* act_scene.c */
enum err act_open(const struct act *act);
enum err act_interpolate(const struct act *act);
enum err act_orient(const struct act *act);
enum err act_weight(const struct act *act);
enum err act_polarity(const struct act *act);
enum err act_label(const struct act *act);

/* act_paint.c */
enum err act_seed(const struct act *act);
enum err act_box(const struct act *act);
enum err act_fill(const struct act *act);

/* act_seed.c */
enum err act_remove(const struct act *act);
enum err act_run(const struct act *act);

/* act_roi.c */
enum err act_mask(const struct act *act);
enum err act_range(const struct act *act);

/* act_seed_file.c */
enum err act_seed_file(const struct act *act);

/* act_label_file.c */
enum err act_label_file(const struct act *act);

/* act_view.c */
enum err act_view(const struct act *act);
enum err act_turn(const struct act *act);
enum err act_zoom(const struct act *act);
enum err act_pan(const struct act *act);
enum err act_focus(const struct act *act);
enum err act_hide(const struct act *act);
enum err act_show(const struct act *act);
enum err act_opacity(const struct act *act);

/* act_set.c: all settings */
enum err act_set(const struct act *act);

/* act_picture.c */
enum err act_render(const struct act *act);

/* act_save.c */
enum err act_save(const struct act *act);

/* act_stats.c */
enum err act_stats(const struct act *act);

/* act_finish.c */
enum err act_finish(const struct act *act);

/* act_surface.c: the part of act_save that is about surfaces */
enum err act_save_surface(const struct act *act, const struct labels *labels, const char *path,
                          enum file_mode how);

/* act_golden.c */
enum err act_golden(const struct act *act);

/* act_clip.c */
enum err act_clip(const struct act *act);
enum err act_plane(const struct act *act);
enum err act_cut(const struct act *act);

/* act_slice.c */
enum err act_cross(const struct act *act);
enum err act_window(const struct act *act);
enum err act_magnify(const struct act *act);
enum err act_slice(const struct act *act);
enum err act_mosaic(const struct act *act);

/* act_labels.c */
enum err act_labels(const struct act *act);

/* act_object.c */
enum err act_object(const struct act *act);

/* act_compare.c */
enum err act_compare(const struct act *act);

/* act_spin.c */
enum err act_spin(const struct act *act);

/* act_history.c */
enum err act_undo(const struct act *act);
enum err act_redo(const struct act *act);
enum err act_goto(const struct act *act);
enum err act_branch(const struct act *act);
enum err act_history(const struct act *act);

/* act_measure.c */
enum err act_measure(const struct act *act);
enum err act_profile(const struct act *act);

/* act_pick.c */
enum err act_pick(const struct act *act);

/* act_journal.c */
enum err act_journal(const struct act *act);
enum err act_sync(const struct act *act);

/* act_hints.c */
enum err act_hints(const struct act *act);
enum err act_hint(const struct act *act);

/* act_ask.c */
enum err act_why(const struct act *act);
enum err act_info(const struct act *act);
enum err act_pilot(const struct act *act);
enum err act_help(const struct act *act);
enum err act_quit(const struct act *act);

/* Adds "1234 voxels changed, label 3 brain: 1.24 l (+12 ml), label 2: 142 ml, 12.3 ms": the voxels
 * that have another label; the volumes of the labels that became larger or smaller, the largest
 * first, at most six of them and never that of label 0; and the time. For a command that has edited
 * the forest, after session_count_before and session_count_labels. */
void volumes_write(struct buf *out, const struct session *session, uint64_t took_ns);

/* After it, for a surprise (report/surprise.h): "this `seed` took 1.2 l of label 1 brain through
 * 93,40,61; undo takes it back". NULL: what waited has. */
void surprise_write(struct buf *out, const struct session *session, const char *command);

/* The labels that a command shows, saves or counts, once the edits that wait have been run: with
 * `finished=yes`, the finished ones, whose digest is added to the words of the record. In a session
 * that skims they are of no meaning. */
enum err act_take_labels(const struct act *act, const struct value *finished,
                         struct labels *labels);

/* The same for a picture: where `finished=` is not given, as `finished on|off` has it. */
enum err act_take_shown(const struct act *act, const struct value *finished, struct labels *labels);

/* "finish    majority radius=1, largest" as a line, and whether pictures show it; nothing where
 * there are no steps. */
void act_write_finish(struct buf *out, const struct session *session);

/* Has the session take on the state act->next. */
enum err act_go(const struct act *act);

/* `err`, with the name of a file before its words. */
enum err act_naming(const char *file, enum err err, struct fault *fault);

/* A name is a word of less than `room` bytes that no number, colour or option can be mistaken for,
 * or several where `blanks` are allowed; ERR_USAGE for another. */
enum err act_check_name(const char *name, size_t room, bool blanks, struct fault *fault);

/* Adds to the words of the record the numbers of the markers that the command has put up. */
void act_add_markers(const struct act *act);

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

/* `range` is the parameter of that name, given or not. */
struct planting act_begin_planting(const struct session *session, const struct value *range);

/* Plants one more marker, of those of the cells that may be planted, which come to the front. */
enum err act_plant(const struct act *act, struct planting *planting, uint32_t *cell, size_t count,
                   int16_t label);

/* Of so many voxels, the level stands for values on both sides of an end of a range: says so, and
 * how large a level is; nothing of none. */
void act_write_unsure(const struct act *act, size_t voxels);

/* Says what was left out; ERR_INPUT where that was all. */
enum err act_write_planting(const struct act *act, const struct planting *planting);

/* The voxels of a ball of the radius, or, where `to` is not NULL and given, of a stroke. */
enum err act_find_voxels(const struct act *act, const struct value *place,
                         const struct value *radius, const struct value *to, struct voxels *voxels);

/* The region of interest: "mask brain.nii regions 1-90, range 40..1200"; false where there is none.
 */
bool act_write_roi(struct buf *out, const struct session *session);

/* The same as a line of `info` and `stats`, with how many voxels are inside. */
void act_write_region(struct buf *out, const struct session *session);

/* "gauss 1.5", "polarity 1:50 2:-20", "of edges.nii" */
void act_write_weight(struct buf *out, const struct kept *kept);

/* A line for each label that has voxels: its seeds, voxels and volume. */
enum err act_write_counts(const struct act *act);

/* ERR_USAGE where the name of a report, if one is given, ends in neither .json nor .csv. */
enum err act_check_report(const struct value *file, struct fault *fault);

/* Writes the text to the file that a parameter names, unless replay writes none, and says so. */
enum err act_write_text(const struct act *act, const struct value *file,
                        const struct value *replace, const struct buf *text);

/* What is cut away: "all but axial slices 10-60, 1 plane, 2 boxes"; false where nothing is. */
bool act_write_cut(struct buf *out, const struct session *session);

/* Adds to the notes of a picture the journal, where its chain stands, and how the labels that it
 * shows were finished. */
enum err act_note_picture(const struct act *act, const struct labels *labels,
                          struct picture *picture);

/* The rendition, which shows these labels, as a picture with all notes, for a file of that name,
 * which says what of it the file holds; or NULL, for a golden image. */
enum err act_take_picture(const struct act *act, const struct labels *labels, const char *name,
                          struct picture *picture);

/* The same of one that is yet to be drawn, for a file that holds colours alone, and its digest
 * (export_drawn). */
enum err act_draw_picture(const struct act *act, const struct labels *labels,
                          struct picture *picture, uint64_t *digest);

/* Runs the edits that wait, and makes the rendition, finished where that is asked for, of whose
 * labels *labels is. */
enum err act_render_labels(const struct act *act, const struct value *finished,
                           enum render_mode mode, struct labels *labels);

/* Adds the digest of the rendition to the words of the record. */
void act_add_picture_digest(const struct act *act);

/* A line of the answer: what was done with the file at `path`, as "wrote ". */
void act_write_file_line(const char *doing, const char *path, struct reply *reply);

/* What a parameter of the choices yes|no says, "no" where it is not given. */
static inline bool act_is_yes(const struct value *value)
{
    return value->given && value->number == 0;
}

/* regions_new of the parameters regions and as, by the own numbers of labels
 * (session/numbering.h); ERR_USAGE where a label for all is given too, which may be NULL. */
enum err act_choose_regions(uint16_t **as, const struct act *act, const struct value *regions,
                            const struct value *labels, const struct value *label);

/* What `replace=yes|no` says. */
enum file_mode act_file_mode(const struct value *replace);

/* A picture as a file that is there when this returns. */
enum err act_write_now(struct interpreter *interp, const char *path, enum file_mode mode,
                       const struct picture *picture, struct fault *fault);

/* Writes a picture to `path`, which interpreter_output_path gave, or has the picture writer do it,
 * and says so. The picture is released, also on error. */
enum err act_write_picture(const struct act *act, const char *path, enum file_mode mode,
                           struct picture *picture);

/* ", within 12 voxels of 10,14,9" for a seed that has a reach; a line about the seed that would
 * take a voxel, but ends before it; and one about all of the session, for `info`. */
void act_write_reach(struct buf *out, const struct session *session, uint32_t seed);
void act_write_refusal(struct buf *out, const struct session *session, uint32_t cell);
enum err act_write_reaches(const struct act *act);

/* A line: where a voxel is, its intensity, its label, and the seed of its tree. */
void act_write_voxel(struct buf *out, const struct session *session, uint32_t cell);

/* Lines: the view, and how the patient lies in the picture. */
void act_write_view(struct buf *out, const struct session *session);

/* What slices show: "through 90,108,90: axial 90, ...; window 0 142, overlay contour". */
void act_write_slices(struct buf *out, struct session *session);

/* Adds the digest of the weights to the words of the record. */
void act_add_weights(const struct act *act);

/* A slice or mosaic as a picture with notes, and its digest among the words. The caller releases
 * the picture. */
enum err act_take_slices(const struct act *act, enum slice_kind kind, const struct labels *labels,
                         struct picture *picture);

/* A line where edits wait for `run`: what was answered of the labels is without them. */
void act_write_waiting(const struct act *act);

/* A line where there is nothing to answer about. */
void act_write_no_seeds(const struct act *act);

/* " of 1x1x1.5 mm" or " of unknown size"; "axes towards RAS". */
void act_write_spacing(struct buf *out, const struct session *session);
void act_write_axes(struct buf *out, const struct geometry *geometry);

#endif
