/* SPDX-License-Identifier: MIT */
/* Pictures of the session, as commands show and store them (act_picture.c). */
#ifndef COMMAND_ACT_PICTURE_H
#define COMMAND_ACT_PICTURE_H

#include "command/act.h"
#include "image/picture.h"
#include "show/draw.h"
#include "show/slicing.h"

/* Adds to the notes of a picture the journal, where its chain stands, and how the labels that it
 * shows were finished. */
enum err act_note_picture(const struct act *act, const struct labels *labels,
                          struct picture *picture);

/* The rendition, which shows these labels, as a picture with all notes, for a file of that name,
 * which says what of it the file holds; or NULL, for a golden image. */
enum err act_take_picture(const struct act *act, const struct labels *labels, const char *name,
                          struct picture *picture);

/* The same of one that is yet to be drawn (show/export_rows.h), as colours, and its digest. */
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

#endif
