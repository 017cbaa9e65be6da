/* What each command does. The table (command/table.c) names them; nobody else calls them. */
#ifndef COMMAND_ACT_H
#define COMMAND_ACT_H

#include "command/interpreter.h"
#include "session/slicing.h"

#define ACT(name)                                                                                  \
    enum err act_##name(struct interpreter *interp, const struct value *value,                     \
                        struct reply *reply, struct fault *fault)

/* act_scene.c */
ACT(open);
ACT(interpolate);
ACT(weight);
ACT(polarity);
ACT(adjacency);
ACT(label);
ACT(seed);
ACT(remove);
ACT(run);
ACT(auto);

/* act_fence.c */
ACT(mask);
ACT(range);

/* act_seed_file.c */
ACT(seed_file);

/* act_view.c */
ACT(view);
ACT(turn);
ACT(zoom);
ACT(pan);
ACT(focus);
ACT(size);
ACT(hide);
ACT(show);

/* act_look.c */
ACT(shade);
ACT(light);
ACT(cue);
ACT(edges);
ACT(samples);

/* act_picture.c */
ACT(render);
ACT(golden);
ACT(save);

/* act_clip.c */
ACT(clip);
ACT(plane);
ACT(cut);

/* act_slice.c */
ACT(cross);
ACT(window);
ACT(overlay);
ACT(slice);
ACT(mosaic);

/* act_spin.c */
ACT(spin);

/* act_history.c */
ACT(undo);
ACT(redo);
ACT(goto);
ACT(branch);
ACT(history);

/* act_pick.c */
ACT(pick);

/* act_journal.c */
ACT(journal);
ACT(sync);

/* act_ask.c */
ACT(why);
ACT(info);
ACT(stats);
ACT(pilot);
ACT(help);
ACT(quit);

/* `err`, with the name of a file before its words. */
enum err act_naming(const char *file, enum err err, struct fault *fault);

/* A name is a word of less than `room` bytes that no number, colour or option can be mistaken for.
 */
bool act_name_is_fit(const char *name, size_t room);

/* Whether no seed may be planted here. */
bool act_is_outside(const struct session *session, uint32_t cell);

/* Of seeds to be planted, how many were, and how many were left out by the region of interest: says so, and
 * refuses where all were. */
enum err act_tell_outside(struct reply *reply, size_t inside, size_t outside, struct fault *fault);

/* What the region of interest is: "mask brain.nii regions 1-90, range 40..1200"; false where there is none. */
bool act_write_roi(struct buf *out, const struct session *session);

/* What is cut away: "axial slices 10-60 kept, 1 plane, 2 boxes taken out"; false where nothing is.
 */
bool act_write_cut(struct buf *out, const struct session *session);

/* Adds to the notes of a picture what the interpreter knows: the journal and where its chain stands. */
enum err act_note_picture(struct interpreter *interp, struct picture *picture, struct fault *fault);

/* The rendition as a picture with all notes, for a file of that name (or NULL), which says whether
 * it holds normals. */
enum err act_take_picture(struct interpreter *interp, const char *name, struct picture *picture,
                          struct fault *fault);

/* What `replace=yes|no` says. */
enum file_mode act_file_mode(const struct value *replace);

/* Writes a picture to `path`, which interpreter_output_path gave, or has the picture writer do it, and says so. The
 * picture is released, whatever comes of it. */
enum err act_write_picture(struct interpreter *interp, const char *path, enum file_mode mode,
                           struct picture *picture, struct reply *reply, struct fault *fault);

/* A line: where a voxel is, its intensity, its label and the seed it has that from. */
void act_tell_voxel(struct buf *out, const struct session *session, uint32_t cell);

/* Lines: the view, and how the patient lies in the picture. */
void act_tell_view(struct buf *out, const struct session *session);

/* What slices show: "through 90,108,90: axial 90, ...; window 0 142, overlay contour". */
void act_write_slices(struct buf *out, struct session *session);

/* A slice or mosaic as a picture with notes, and its digest among the words. The caller releases
 * the picture. */
enum err act_take_slices(struct interpreter *interp, enum slice_kind kind, struct picture *picture,
                         struct reply *reply, struct fault *fault);

/* "2 cerebellum", or "2" where the label has no name. */
void act_write_label(struct buf *out, const struct session *session, unsigned label);

#endif
