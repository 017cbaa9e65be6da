/* SPDX-License-Identifier: MIT */
/* The command `golden`: stores a picture beside the journal, and compares it in a replay. */
#include "command/act.h"

#include <string.h>

#include "base/file.h"
#include "command/files.h"
#include "command/golden_files.h"
#include "command/golden_judge.h"
#include "image/exr.h"
#include "journal/journal.h"
#include "journal/record.h"
#include "show/export_picture.h"
#include "show/draw.h"

/* ---- comparing ---- */

static struct golden_planes planes_of(const struct picture *p)
{
    return (struct golden_planes){p->width, p->height, {p->rgba, p->depth_mm, p->label, p->voxel}};
}

/* The image is gone: which file is to be restored, where its PNG shows that it was there. */
static enum err refuse_missing(const char *name, const char *path, struct fault *fault)
{
    struct buf png = {0};
    buf_add(&png, path, strlen(path) - strlen("exr"));
    buf_add_text(&png, "png");
    const bool has_png = !png.failed && file_exists(buf_text(&png));
    buf_release(&png);
    return has_png
               ? fault_set(fault, ERR_CHECK,
                           "golden image %s is missing: its PNG is there, but %s, which is what is "
                           "compared, is not; restore that file from a copy",
                           name, path)
               : fault_set(fault, ERR_CHECK, "golden image %s is missing: there is no %s", name,
                           path);
}

static enum err read_golden(struct interpreter *interp, struct picture *expected,
                            const struct picture *actual, const char *path, bool *leads_out,
                            struct fault *fault)
{
    const enum err err = interpreter_may_read(interp, path, leads_out, fault);
    return err ? err
               : exr_read_golden(expected, path, actual, session_watch(interp->session), fault);
}

/* And what they say of themselves, where that has a meaning. */
static enum err compare_pictures(const struct picture *expected, const struct picture *actual,
                                 const struct interpreter *interp,
                                 struct golden_difference *difference, struct fault *fault)
{
    struct buf words = {0};
    const struct golden_planes e = planes_of(expected), a = planes_of(actual);
    enum err err = golden_compare(&e, &a, difference, fault);
    if (!err && !difference->is_same) {
        golden_describe(&words, difference);
        err = fault_set(fault, ERR_CHECK, "%s", buf_text(&words));
    } else if (!err) {
        err = golden_compare_notes(expected, actual, !interp->scene_path, fault);
    }
    buf_release(&words);
    return err;
}

static enum err compare_golden(struct interpreter *interp, const char *name, const char *path,
                               struct picture *actual, struct fault *fault)
{
    const struct golden_judge *judge = interp->judge;
    struct picture expected = {0};
    struct golden_difference difference = {0};
    const bool has_source = judge && judge->source;
    const char *source = has_source ? judge->source(judge->context, path) : path;
    bool leads_out = false;
    enum err err = file_exists(source)
                       ? read_golden(interp, &expected, actual, source, &leads_out, fault)
                       : refuse_missing(name, source, fault);
    bool is_read = !err;
    if (is_read)
        err = compare_pictures(&expected, actual, interp, &difference, fault);
    if (err == ERR_MEMORY || err == ERR_CANCELLED) {
        picture_release(&expected);
        return err;
    }
    if (err) { /* any of these is a failure of the image */
        is_read = is_read && !leads_out;
        if (leads_out)
            golden_refuse_link(source, fault);
        if (file_exists(source))
            fault_prefix(fault, err, "golden image %s", name);
        err = fault ? fault_set(fault, ERR_CHECK, "%s", fault->text) : ERR_CHECK;
    }
    if (is_read && err) /* for people, who look at both */
        export_background(&expected, interp->session, NULL);
    const struct golden_finding finding = {name, path, actual, is_read ? &expected : NULL,
                                           is_read ? &difference : NULL};
    if (err && judge && judge->differs)
        err = judge->differs(judge->context, interp, &finding, fault);
    else if (!err && judge && judge->is_same)
        err = judge->is_same(judge->context, interp, &finding, fault);
    golden_difference_release(&difference);
    picture_release(&expected);
    return err;
}

/* ---- storing ---- */

/* A golden image that is there already has to be the same; a PNG that is missing beside it comes
 * again. In this order nobody else's PNG is ever beside an image of ours. */
static enum err write_both(struct interpreter *interp, const char *name, const char *path,
                           const char *png, struct picture *picture, struct fault *fault)
{
    const bool is_there = file_exists(path), has_png = file_exists(png);
    enum err err = is_there ? compare_golden(interp, name, path, picture, fault) : OK;
    if (err)
        return fault_prefix(fault, err, "it exists already and was left alone");
    if (!is_there)
        err = file_may_write(png, FILE_KEEP, fault);
    if (!err && !is_there)
        err = act_write_now(interp, path, FILE_KEEP, picture, fault);
    return err || has_png ? err : act_write_now(interp, png, FILE_KEEP, picture, fault);
}

/* The EXR is the golden image; the PNG beside it is for people. Both are on the disk before the
 * record is, and after the records that they name (command/golden_judge.h). */
static enum err write_golden(struct interpreter *interp, const char *name, const char *path,
                             struct picture *picture, struct fault *fault)
{
    struct golden_files files = {.folder = -1};
    enum err err = interp->journal ? journal_sync(interp->journal, fault) : OK;
    if (!err)
        err = golden_files_make(&files, buf_text(&interp->home), fault);
    buf_printf(&files.path, "/%s.png", name);
    if (!err)
        err = files.path.failed
                  ? fault_memory(fault, "a path")
                  : write_both(interp, name, path, buf_text(&files.path), picture, fault);
    golden_files_close(&files);
    return err;
}

/* ---- the command ---- */

/* The rendition, which takes in the edits that wait, or a slice or mosaic; and its digest. */
static enum err take_golden(const struct act *act, struct picture *picture)
{
    struct labels labels;
    const int64_t of = act_number(act, "of"); /* 0: the rendition */
    if (act->interp->mode == MODE_SKIM)
        return of ? OK : session_run(act->session, act->fault);
    enum err err =
        of ? act_take_shown(act, &labels) : act_render_labels(act, RENDER_AS_KEPT, &labels);
    if (err)
        return err;
    if (of)
        return act_take_slices(act, (enum slice_kind)(of - 1), &labels, picture);
    act_add_picture_digest(act);
    return act_take_picture(act, &labels, NULL, picture);
}

/* Compares it in a replay, or writes it. */
static enum err settle_golden(const struct act *act, const char *name, struct picture *picture)
{
    struct interpreter *interp = act->interp;
    struct buf path = {0};
    enum err err = golden_path(&path, buf_text(&interp->home), name, act->fault);
    if (!err && interp->mode != MODE_LIVE)
        err = compare_golden(interp, name, buf_text(&path), picture, act->fault);
    else if (!err)
        err = write_golden(interp, name, buf_text(&path), picture, act->fault);
    if (!err && interp->mode == MODE_LIVE)
        act_write_file_line("stored as ", buf_text(&path), act->reply);
    buf_release(&path);
    return err;
}

enum err act_golden(const struct act *act)
{
    const struct interpreter *interp = act->interp;
    struct picture picture = {0};
    const char *name = act_text(act, "NAME");
    if (!golden_name_is_valid(name))
        return fault_set(act->fault, ERR_USAGE,
                         "NAME: expected at most 64 lower-case letters, digits, - and _, not %s",
                         name);
    if (interp->is_read_only && interp->journal && journal_only_looks(interp->journal))
        return fault_set(
            act->fault, ERR_USAGE,
            "the journal was opened read-only, and so were its golden images; `journal "
            "FILE` continues in a file of your own");
    enum err err = take_golden(act, &picture);
    if (err)
        return err;
    if (!interp->home.length && interp->mode == MODE_LIVE)
        buf_add_text(&act->reply->text,
                     "not stored: there is no journal that it could belong to; `--journal FILE` "
                     "records one from the beginning\n");
    else if (interp->mode == MODE_LIVE || interp->judge)
        err = settle_golden(act, name, &picture);
    picture_release(&picture);
    return err;
}
