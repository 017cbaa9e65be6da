/* Commands that bring pictures, golden images and maps out. */
#include "command/act.h"

#include <string.h>

#include "base/file.h"
#include "verify/golden_accept.h"
#include "verify/verdict.h"
#include "image/exr.h"
#include "journal/golden.h"
#include "session/export.h"

/* ---- pictures ---- */

enum err act_note_picture(const struct act *act, struct picture *picture)
{
    const struct journal *journal = act->interp->journal;
    if (!journal)
        return OK;
    const char *name = file_name(journal_path(journal));
    enum err err = picture_note(picture, "iftty:journal", name, act->fault);
    return err ? err : picture_note(picture, "iftty:chain", journal_chain(journal), act->fault);
}

enum err act_take_picture(const struct act *act, const char *name, struct picture *picture)
{
    enum err err = export_picture(picture, act->session, act->fault);
    if (!err && name && exr_is_named(name))
        err = export_normals(picture, act->session, act->fault);
    if (!err)
        err = act_note_picture(act, picture);
    if (err)
        picture_release(picture);
    return err;
}

static void add_picture_digest(const struct act *act)
{
    buf_printf(&act->reply->words, "picture=%016llx",
               (unsigned long long)rendition_digest(session_frame(act->session)));
}

enum file_mode act_file_mode(const struct value *replace)
{
    return replace->given && replace->number == 0 ? FILE_REPLACE : FILE_KEEP;
}

static void write_file_line(const char *doing, const char *path, struct reply *reply)
{
    buf_add_text(&reply->text, doing);
    buf_add_safe(&reply->text, path, strlen(path));
    buf_add_char(&reply->text, '\n');
}

static void write_seen(const struct rendition *r, struct reply *reply)
{
    size_t seen = 0, pixels = (size_t)r->width * r->height;
    for (size_t i = 0; i < pixels; i++)
        seen += r->cell[i] != CELL_NONE;
    buf_printf(&reply->text, "%ux%u pixels, of which %zu show an object\n", r->width, r->height,
               seen);
}

/* An order for the picture writer, which gets it once the command is recorded. */
static enum err order_picture(const struct act *act, const char *path, enum file_mode mode,
                              struct picture *picture)
{
    struct interpreter *interp = act->interp;
    if (picture_writer_holds(interp->writer, path))
        picture_writer_wait(interp->writer, NULL, NULL); /* for what it finds there */
    enum err err = picture_job_new(&interp->job, path, mode, picture, act->fault);
    if (!err)
        write_file_line("writing ", path, act->reply);
    return err;
}

/* A picture as a file that is there when this returns. */
static enum err write_now(struct interpreter *interp, const char *path, enum file_mode mode,
                          const struct picture *picture, struct fault *fault)
{
    enum err err = interpreter_will_write(interp, path, mode, fault);
    return err ? err : image_write(interp->helper, path, mode, picture, fault);
}

enum err act_write_picture(const struct act *act, const char *path, enum file_mode mode,
                           struct picture *picture)
{
    struct interpreter *interp = act->interp;
    enum err err;
    if (interp->writer && !interp->replays && picture_writer_takes(path)) {
        err = order_picture(act, path, mode, picture);
    } else {
        err = write_now(interp, path, mode, picture, act->fault);
        if (!err)
            write_file_line("wrote ", path, act->reply);
    }
    picture_release(picture);
    return err;
}

static enum err render_file(const struct act *act)
{
    const struct value *value = act->value;
    struct picture picture;
    struct buf path = {0};
    enum err err = interpreter_output_path(act->interp, value[0].text, &path, act->fault);
    if (!err && path.length) {
        err = act_take_picture(act, value[0].text, &picture);
        if (!err) {
            picture.tiled = value[3].given && value[3].number == 1;
            err = act_write_picture(act, buf_text(&path), act_file_mode(&value[2]), &picture);
        }
    }
    buf_release(&path);
    return err;
}

enum err act_render(const struct act *act)
{
    static const enum render_mode mode[] = {RENDER_SCENE, RENDER_BORDER, RENDER_INCREMENTAL,
                                            RENDER_RAY};
    if (act->value[3].given && !(act->value[0].given && exr_is_named(act->value[0].text)))
        return fault_set(act->fault, ERR_USAGE, "layout: only an .exr has lines or tiles");
    enum err err = session_render(act->session,
                                  act->value[1].given ? mode[act->value[1].number] : RENDER_AS_KEPT,
                                  act->fault);
    if (err || act->interp->skims)
        return err;
    add_picture_digest(act);
    if (act->value[0].given)
        return render_file(act);
    act->interp->shows_picture = true;
    write_seen(session_frame(act->session), act->reply);
    return OK;
}

/* ---- golden images ---- */

static struct golden_planes planes_of(const struct picture *p)
{
    return (struct golden_planes){p->width, p->height, p->rgba, p->depth_mm, p->label, p->voxel};
}

/* Expected, actual and difference beside each other, for whoever looks into a failure. */
static void leave_evidence(struct interpreter *interp, const char *name,
                           const struct picture *actual, const struct golden_difference *difference)
{
    struct buf path = {0};
    struct picture image = {
        .width = difference->width, .height = difference->height, .rgba = difference->image};
    if (!interp->evidence_folder || file_make_folder(interp->evidence_folder, NULL))
        return;
    const char *journal = file_name(buf_text(&interp->home));
    buf_printf(&path, "%s/%s.%s.actual.exr", interp->evidence_folder, journal, name);
    image_write(interp->helper, buf_text(&path), FILE_REPLACE, actual, NULL);
    if (difference->image) {
        buf_clear(&path);
        buf_printf(&path, "%s/%s.%s.difference.png", interp->evidence_folder, journal, name);
        image_write(interp->helper, buf_text(&path), FILE_REPLACE, &image, NULL);
    }
    buf_release(&path);
}

/* The same for a report; colours lie over black, as they are seen. */
static void keep_for_report(struct interpreter *interp, const char *name,
                            const struct picture *expected, const struct picture *actual,
                            const struct golden_difference *difference)
{
    struct gallery *gallery = interp->gallery;
    struct buf words = {0};
    if (!gallery)
        return;
    buf_printf(&words, "expected: golden image %s", name);
    gallery_add(gallery, buf_text(&words), expected->width, expected->height, expected->rgba);
    gallery_add(gallery, "actual", actual->width, actual->height, actual->rgba);
    if (difference->image)
        gallery_add(gallery, "difference, in red", difference->width, difference->height,
                    difference->image);
    buf_release(&words);
}

static enum err compare_golden(struct interpreter *interp, const char *name, const char *path,
                               const struct picture *actual, struct fault *fault)
{
    struct picture expected = {0};
    struct golden_difference difference = {0};
    struct buf words = {0};
    if (!file_exists(path)) {
        if (interp->gallery)
            gallery_add(interp->gallery, "actual; there is no golden image", actual->width,
                        actual->height, actual->rgba);
        return fault_set(fault, ERR_CHECK, "golden image %s is missing: there is no %s", name,
                         path);
    }
    enum err err = interpreter_may_read(interp, path, fault);
    if (!err)
        err = exr_read(&expected, path, fault);
    if (err) {
        fault_prefix(fault, err, "golden image %s", name);
        return fault ? fault_set(fault, ERR_CHECK, "%s", fault->text) : ERR_CHECK;
    }
    struct golden_planes e = planes_of(&expected), a = planes_of(actual);
    err = golden_compare(&e, &a, &difference, fault);
    if (!err && !difference.is_same) {
        golden_tell(&words, &difference);
        err = fault_set(fault, ERR_CHECK, "golden image %s: %s", name, buf_text(&words));
        leave_evidence(interp, name, actual, &difference);
        keep_for_report(interp, name, &expected, actual, &difference);
    }
    golden_difference_release(&difference);
    picture_release(&expected);
    buf_release(&words);
    return err;
}

/* The same for one that is drawn up anew where it differs. */
static enum err accept_golden(struct interpreter *interp, const char *name, const char *path,
                              struct picture *picture, struct fault *fault)
{
    const enum err err = compare_golden(
        interp, name, golden_accept_source(interp->golden_accept, path), picture, fault);
    if (err != ERR_CHECK)
        return err;
    return golden_accept_take(interp->golden_accept, interp, name, path, picture, fault);
}

/* The EXR is the golden image; the PNG beside it is for people. */
static enum err write_golden(struct interpreter *interp, const char *name, const char *path,
                             const struct picture *picture, struct fault *fault)
{
    struct buf other = {0};
    enum err err = golden_folder(&other, buf_text(&interp->home), fault);
    if (!err)
        err = file_make_folder(buf_text(&other), fault);
    if (!err && file_exists(path)) {
        err = compare_golden(interp, name, path, picture, fault);
        if (err)
            fault_prefix(fault, err, "it exists already and was left alone");
    } else if (!err) {
        buf_printf(&other, "/%s.png", name);
        err = write_now(interp, path, FILE_KEEP, picture, fault);
        if (!err)
            err = write_now(interp, buf_text(&other), FILE_KEEP, picture, fault);
    }
    buf_release(&other);
    return err;
}

/* The rendition, which takes in the edits that wait, or a slice or mosaic; and its digest. */
static enum err take_golden(const struct act *act, const struct value *of, struct picture *picture)
{
    const bool is_slice = of->given && of->number > 0;
    if (act->interp->skims)
        return is_slice ? OK : session_run(act->session, act->fault);
    if (is_slice)
        return act_take_slices(act, (enum slice_kind)(of->number - 1), picture);
    enum err err = session_render(act->session, RENDER_AS_KEPT, act->fault);
    if (err)
        return err;
    add_picture_digest(act);
    return act_take_picture(act, NULL, picture);
}

/* For orphan_check. A name that there was no memory for leaves room for the next. */
static enum err note_name(struct interpreter *interp, const char *name, struct fault *fault)
{
    buf_add(&interp->goldens, name, strlen(name) + 1);
    if (!interp->goldens.failed)
        return OK;
    interp->goldens.failed = false;
    return fault_memory(fault, "a name");
}

enum err act_golden(const struct act *act)
{
    struct picture picture = {0};
    struct buf path = {0};
    const char *name = act->value[0].text;
    if (!golden_name_is_valid(name))
        return fault_set(act->fault, ERR_USAGE,
                         "NAME: expected small letters, digits, - and _ (at most 64), not %s",
                         name);
    if (act->interp->looks && act->interp->journal && journal_only_looks(act->interp->journal))
        return fault_set(act->fault, ERR_USAGE,
                         "the journal is only looked at, and its golden images with it; `journal "
                         "FILE` goes on in a file of your own");
    enum err err = note_name(act->interp, name, act->fault);
    if (!err)
        err = take_golden(act, &act->value[1], &picture);
    if (err)
        return err;
    if (!act->interp->home.length && !act->interp->replays)
        buf_add_text(&act->reply->text, "not kept: there is no journal that it could belong to\n");
    else if (!act->interp->replays || act->interp->compares_goldens)
        err = golden_path(&path, buf_text(&act->interp->home), name, act->fault);
    if (!err && path.length && act->interp->golden_accept)
        err = accept_golden(act->interp, name, buf_text(&path), &picture, act->fault);
    else if (!err && path.length && act->interp->replays)
        err = compare_golden(act->interp, name, buf_text(&path), &picture, act->fault);
    else if (!err && path.length)
        err = write_golden(act->interp, name, buf_text(&path), &picture, act->fault);
    if (!err && path.length && !act->interp->replays)
        write_file_line("kept as ", buf_text(&path), act->reply);
    picture_release(&picture);
    buf_release(&path);
    return err;
}

/* ---- maps ---- */

enum err act_save(const struct act *act)
{
    static const enum map map[] = {MAP_LABELS, MAP_COST, MAP_ROOT, MAP_BORDER};
    struct buf path = {0};
    enum err err = session_run(act->session, act->fault);
    if (!err)
        err = interpreter_output_path(act->interp, act->value[1].text, &path, act->fault);
    if (!err && path.length) {
        const enum file_mode how = act_file_mode(&act->value[2]);
        err = interpreter_will_write(act->interp, buf_text(&path), how, act->fault);
        if (!err)
            err = export_map(act->session, map[act->value[0].number], buf_text(&path), how,
                             act->fault);
        if (!err)
            write_file_line("wrote ", buf_text(&path), act->reply);
    }
    buf_release(&path);
    return err;
}
