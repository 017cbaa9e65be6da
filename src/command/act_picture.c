/* SPDX-License-Identifier: MIT */
/* Commands that show or write pictures: renditions, slices and mosaics; and how slices look. */
#include "command/act_picture.h"

#include "command/answers.h"
#include "base/mem.h"
#include "command/files.h"
#include "image/exr.h"
#include "image/image_helper.h"
#include "image/picture_writer.h"
#include "journal/golden.h"
#include "journal/journal.h"
#include "session/session.h"
#include "show/decorating.h"
#include "show/export_picture.h"
#include "show/export_rows.h"
#include "show/draw.h"
#include "show/slicing.h"

/* ---- pictures ---- */

enum err act_note_picture(const struct act *act, const struct labels *labels,
                          struct picture *picture)
{
    const struct journal *journal = act->interp->journal;
    struct buf steps = {0}, name = {0};
    enum err err = OK;
    finish_write(&steps, &session_kept(act->session)->finish);
    if (journal)
        golden_journal_name(&name, journal_path(journal));
    if (steps.failed || name.failed)
        err = fault_memory(act->fault, "a note on a picture");
    if (!err && labels->finished)
        err = picture_note(picture, "iftty:finish", buf_text(&steps), act->fault);
    if (!err && journal && !session_is_private(act->session))
        err = picture_note(picture, "iftty:journal", buf_text(&name), act->fault);
    if (!err && journal)
        err = picture_note(picture, "iftty:chain", journal_chain(journal), act->fault);
    buf_release(&steps);
    buf_release(&name);
    return err;
}

enum err act_take_picture(const struct act *act, const struct labels *labels, const char *name,
                          struct picture *picture)
{
    const bool has_all = !name || exr_is_named(name);
    enum err err = has_all ? export_picture(picture, act->session, act->fault)
                           : export_colours(picture, act->session, act->fault);
    if (!err && !name) /* goldens are both: an OpenEXR file, and a picture for people */
        err = export_background(picture, act->session, act->fault);
    else if (!err && has_all)
        err = export_normals(picture, act->session, act->fault);
    if (!err)
        err = act_note_picture(act, labels, picture);
    if (err)
        picture_release(picture);
    return err;
}

/* Into the file of that name, which is not empty, or into memory. */
static enum err draw_into(const struct act *act, const struct drawn_file *file,
                          const struct labels *labels, struct picture *picture, uint64_t *digest)
{
    const struct strips_format *format = image_strips(file->path);
    const unsigned planes = exr_is_named(file->path) ? PICTURE_EVERY : 0;
    struct strips *strips = NULL;
    enum err err = interpreter_will_write(act->interp, file->path, file->mode, act->fault);
    if (!err)
        err = strips_begin(&strips, format, file->path, file->mode, picture, planes, act->fault);
    if (!err)
        err = export_rows(picture, strips, act->session, labels, file->render, digest, act->fault);
    if (!err)
        err = act_note_picture(act, labels, picture);
    if (err)
        strips_abandon(strips);
    return err ? err : strips_end(strips, picture, act->fault);
}

enum err act_draw_file(const struct act *act, const struct drawn_file *file,
                       const struct labels *labels, uint64_t *digest)
{
    struct picture picture;
    export_form(&picture, act->session);
    picture.tiled = file->tiled;
    const enum err err = *file->path ? draw_into(act, file, labels, &picture, digest)
                                     : export_rows(&picture, NULL, act->session, labels,
                                                   file->render, digest, act->fault);
    picture_release(&picture);
    return err;
}

enum err act_draw_picture(const struct act *act, const struct labels *labels, enum render_mode mode,
                          struct picture *picture, uint64_t *digest)
{
    export_form(picture, act->session);
    picture->rgba = mem_array((size_t)picture->width * picture->height, 4);
    enum err err = picture->rgba
                       ? export_rows(picture, NULL, act->session, labels, mode, digest, act->fault)
                       : fault_memory(act->fault, "a picture");
    if (!err)
        err = act_note_picture(act, labels, picture);
    if (err)
        picture_release(picture);
    return err;
}

void act_add_picture_digest(const struct act *act)
{
    const struct rendition picture = session_picture(act->session);
    act_add_digest(act, "picture", rendition_digest(&picture));
}

enum err act_write_now(struct interpreter *interp, const char *path, enum file_mode mode,
                       const struct picture *picture, struct fault *fault)
{
    enum err err = interpreter_will_write(interp, path, mode, fault);
    return err ? err : image_write(interp->helper, path, mode, picture, fault);
}

enum err act_write_picture(const struct act *act, const char *path, enum file_mode mode,
                           struct picture *picture)
{
    struct interpreter *interp = act->interp;
    const bool is_beside =
        interp->writer && interp->mode == MODE_LIVE && picture_writer_takes(path);
    enum err err;
    if (is_beside) { /* a job for the picture writer, which gets it once the command is recorded */
        if (picture_writer_holds(interp->writer, path))
            picture_writer_wait(interp->writer, NULL, NULL); /* for what it finds there */
        interpreter_note_kept(interp, path, mode);
        err = picture_job_new(&interp->job, path, mode, picture, act->fault);
    } else {
        err = act_write_now(interp, path, mode, picture, act->fault);
    }
    if (!err)
        act_write_file_line(is_beside ? "writing " : "wrote ", path, act->reply);
    picture_release(picture);
    return err;
}

enum err act_render_labels(const struct act *act, enum render_mode mode, struct labels *labels)
{
    enum err err = session_run(act->session, act->fault);
    if (!err)
        err = act_take_shown(act, labels);
    if (!err)
        err = session_draw_labels(act->session, labels, mode, act->fault);
    return err ? err : session_decorate(act->session, labels, act->fault);
}

/* Into a file of which so much is drawn that none of it is to be stored. */
static enum err render_large(const struct act *act, const char *name, enum render_mode mode)
{
    struct labels labels;
    struct buf path = {0};
    uint64_t digest = 0;
    enum err err = session_run(act->session, act->fault);
    if (!err)
        err = act_take_shown(act, &labels);
    if (!err)
        err = interpreter_output_path(act->interp, name, &path, act->fault);
    const char *to = buf_text(&path);
    if (!err && (!*to || image_strips(to))) {
        const struct drawn_file file = {to, act_file_mode(act), mode,
                                        act_number(act, "layout") == 1};
        err = act_draw_file(act, &file, &labels, &digest);
        if (!err && *to)
            act_write_file_line("wrote ", to, act->reply);
    } else if (!err) {
        struct picture picture;
        err = act_draw_picture(act, &labels, mode, &picture, &digest);
        if (!err)
            err = act_write_picture(act, to, act_file_mode(act), &picture);
    }
    if (!err)
        act_add_digest(act, "picture", digest);
    buf_release(&path);
    return err;
}

static enum err render_whole(const struct act *act, enum render_mode mode)
{
    struct labels labels;
    enum err err = act_render_labels(act, mode, &labels);
    if (err || act->interp->mode == MODE_SKIM)
        return err;
    act_add_picture_digest(act);
    if (act_has(act, "FILE")) {
        struct picture picture;
        struct buf path = {0};
        err = interpreter_output_path(act->interp, act_text(act, "FILE"), &path, act->fault);
        if (!err && path.length)
            err = act_take_picture(act, &labels, act_text(act, "FILE"), &picture);
        if (!err && path.length) {
            picture.tiled = act_number(act, "layout") == 1;
            err = act_write_picture(act, buf_text(&path), act_file_mode(act), &picture);
        }
        buf_release(&path);
        return err;
    }
    act->interp->shows_picture = true;
    const struct rendition *r = session_frame(act->session);
    size_t seen = 0, pixels = (size_t)r->width * r->height;
    for (size_t i = 0; i < pixels; i++)
        seen += r->cell[i] != CELL_NONE;
    buf_printf(&act->reply->text, "%ux%u pixels, %zu of them with an object\n", r->width, r->height,
               seen);
    return OK;
}

enum err act_render(const struct act *act)
{
    static const enum render_mode mode[] = {RENDER_SCENE, RENDER_BORDER, RENDER_INCREMENTAL,
                                            RENDER_RAY};
    const bool has_mode = act_has(act, "mode"), has_file = act_has(act, "FILE");
    const enum render_mode wanted = has_mode ? mode[act_number(act, "mode")] : RENDER_AS_KEPT;
    if (act_has(act, "layout") && !(has_file && exr_is_named(act_text(act, "FILE"))))
        return fault_set(act->fault, ERR_USAGE, "layout: only an .exr has lines or tiles");
    if (has_file && act->interp->mode != MODE_SKIM && export_is_large(act->session) &&
        session_decorates_rows(act->session))
        return render_large(act, act_text(act, "FILE"), wanted);
    return render_whole(act, wanted);
}

/* ---- how slices are shown ---- */

/* Goes to the next state, and says how slices are shown now. */
static enum err go_and_say(const struct act *act)
{
    enum err err = act_go(act);
    if (!err)
        act_write_slices(&act->reply->text, act->session);
    return err;
}

enum err act_cross(const struct act *act)
{
    for (int a = 0; a < 3; a++)
        act->next->outlook.slices.cross[a] = act_place(act, "PLACE")[a];
    return go_and_say(act);
}

/* In place of what `slice zoom=` had them be. */
static void magnify(struct slice_settings *slices, uint32_t times, const uint32_t *middle)
{
    slices->zoom = 0;
    slices->times = times;
    slices->has_middle = middle != NULL;
    for (int a = 0; a < 3; a++)
        slices->middle[a] = middle ? middle[a] : 0;
}

enum err act_magnify(const struct act *act)
{
    const struct value *times = act_value(act, "TIMES"), *at = act_value(act, "at");
    const bool is_whole = times->text || times->number == SLICE_TIMES_ONE;
    if (is_whole && at->given)
        return fault_set(act->fault, ERR_USAGE,
                         "what is shown whole has no voxel in its middle; nothing has changed");
    magnify(&act->next->outlook.slices, is_whole ? SLICE_TIMES_ONE : (uint32_t)times->number,
            at->given ? at->place : NULL);
    return go_and_say(act);
}

enum err act_window(const struct act *act)
{
    struct slice_settings *slices = &act->next->outlook.slices;
    const bool is_auto = act_text(act, "LOW") != NULL;
    const struct decimal window[2] = {act_value(act, "LOW")->real[0],
                                      act_value(act, "HIGH")->real[0]};
    if (is_auto == act_has(act, "HIGH"))
        return fault_set(act->fault, ERR_USAGE,
                         "expected LOW and HIGH, or auto alone; nothing has changed");
    if (!is_auto && decimal_value(&window[1]) <= decimal_value(&window[0]))
        return fault_set(act->fault, ERR_USAGE, "HIGH is not above LOW; nothing has changed");
    slices->has_window = !is_auto;
    for (int i = 0; i < 2; i++)
        slices->window[i] = is_auto ? (struct decimal){0, 0, 0} : window[i];
    return go_and_say(act);
}

/* ---- pictures of slices ---- */

/* Draws it, and adds its digest to the words; the caller releases the canvas. `with_cells` also
 * finds which voxel each pixel shows. */
static enum err draw(const struct act *act, enum slice_kind kind, const struct labels *labels,
                     bool with_cells, struct canvas *canvas)
{
    const enum err err = slicing_draw(canvas, act->session, kind, labels, with_cells, act->fault);
    if (!err)
        act_add_digest(act, "picture", canvas_digest(canvas));
    return err;
}

enum err act_take_slices(const struct act *act, enum slice_kind kind, const struct labels *labels,
                         struct picture *picture)
{
    struct canvas canvas;
    enum err err = draw(act, kind, labels, true, &canvas);
    if (err)
        return err;
    err = slicing_export(picture, act->session, kind, labels, &canvas, act->fault);
    canvas_release(&canvas);
    if (!err)
        err = act_note_picture(act, labels, picture);
    if (err)
        picture_release(picture);
    return err;
}

/* To the file that is named, or inline. */
static enum err show_or_write(const struct act *act, enum slice_kind kind)
{
    struct picture picture = {0};
    struct labels labels;
    struct buf path = {0};
    if (act->interp->mode == MODE_SKIM)
        return OK;
    act_write_slices(&act->reply->text, act->session);
    enum err err = act_take_shown(act, &labels);
    if (!err && !act_has(act, "FILE")) {
        struct canvas canvas;
        err = draw(act, kind, &labels, false, &canvas);
        if (!err)
            interpreter_show(act->interp, &canvas);
        return err;
    }
    if (!err)
        err = act_take_slices(act, kind, &labels, &picture);
    if (!err)
        err = interpreter_output_path(act->interp, act_text(act, "FILE"), &path, act->fault);
    if (!err && path.length)
        err = act_write_picture(act, buf_text(&path), act_file_mode(act), &picture);
    else
        picture_release(&picture);
    buf_release(&path);
    return err;
}

enum err act_slice(const struct act *act)
{
    const struct scene *scene = session_scene(act->session);
    struct slice_settings *slices = &act->next->outlook.slices;
    const enum slice_plane plane = (enum slice_plane)act_number(act, "PLANE");
    const uint32_t count = slice_count(scene, plane);
    if (act_has(act, "N") && act_number(act, "N") >= count)
        return fault_set(act->fault, ERR_INPUT,
                         "N: expected one of the %s slices 0..%u, not %lld; nothing has changed",
                         act_text(act, "PLANE"), count - 1, (long long)act_number(act, "N"));
    if (act_has(act, "N"))
        slicing_move(act->session, plane, (uint32_t)act_number(act, "N"), slices->cross);
    if (act_has(act, "zoom")) {
        magnify(slices, SLICE_TIMES_ONE, NULL);
        slices->zoom = act_text(act, "zoom") ? 0 : (uint32_t)act_number(act, "zoom");
    }
    enum err err = act_go(act);
    return err ? err : show_or_write(act, (enum slice_kind)plane);
}

enum err act_mosaic(const struct act *act)
{
    return show_or_write(act, SLICE_KIND_MOSAIC);
}
