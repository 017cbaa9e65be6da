/* Commands that show or write pictures. */
#include "command/act.h"

#include "base/file.h"
#include "image/exr.h"
#include "render/border.h"
#include "render/normal.h"
#include "session/semantics.h"
#include "session/session.h"
#include "show/decorating.h"
#include "show/export_picture.h"
#include "show/draw.h"

/* ---- pictures ---- */

static enum err note_finish(const struct act *act, struct picture *picture)
{
    struct buf steps = {0};
    finish_write(&steps, &session_kept(act->session)->finish);
    const enum err err = steps.failed
                             ? fault_memory(act->fault, "a note on a picture")
                             : picture_note(picture, "iftty:finish", buf_text(&steps), act->fault);
    buf_release(&steps);
    return err;
}

static enum err note_journal(const struct act *act, struct picture *picture)
{
    struct buf path = {0};
    file_real(&path, journal_path(act->interp->journal));
    const enum err err = path.failed ? fault_memory(act->fault, "a note on a picture")
                                     : picture_note(picture, "iftty:journal",
                                                    file_name(buf_text(&path)), act->fault);
    buf_release(&path);
    return err;
}

enum err act_note_picture(const struct act *act, const struct labels *labels,
                          struct picture *picture)
{
    const struct journal *journal = act->interp->journal;
    enum err err = labels->finished ? note_finish(act, picture) : OK;
    if (!err && journal && !session_is_private(act->session))
        err = note_journal(act, picture);
    return err || !journal
               ? err
               : picture_note(picture, "iftty:chain", journal_chain(journal), act->fault);
}

/* Goldens are both: an OpenEXR file, and a picture for people. */
static enum err take_all(const struct act *act, bool is_golden, struct picture *picture)
{
    enum err err = export_picture(picture, act->session, act->fault);
    if (!err && is_golden)
        err = export_background(picture, act->session, act->fault);
    else if (!err)
        err = export_normals(picture, act->session, act->fault);
    return err;
}

enum err act_take_picture(const struct act *act, const struct labels *labels, const char *name,
                          struct picture *picture)
{
    enum err err = name && !exr_is_named(name) ? export_colours(picture, act->session, act->fault)
                                               : take_all(act, !name, picture);
    if (!err)
        err = act_note_picture(act, labels, picture);
    if (err)
        picture_release(picture);
    return err;
}

enum err act_draw_picture(const struct act *act, const struct labels *labels,
                          struct picture *picture, uint64_t *digest)
{
    enum err err = export_drawn(picture, act->session, labels, digest, act->fault);
    if (!err)
        err = act_note_picture(act, labels, picture);
    if (err)
        picture_release(picture);
    return err;
}

void act_add_picture_digest(const struct act *act)
{
    if (!semantics_has(session_semantics(act->session), MEANING_SMOOTH_SURFACES))
        return;
    buf_add_blank(&act->reply->words);
    const struct rendition picture = session_picture(act->session);
    buf_printf(&act->reply->words, "picture=%016llx",
               (unsigned long long)rendition_digest(&picture));
}

enum file_mode act_file_mode(const struct value *replace)
{
    return act_is_yes(replace) ? FILE_REPLACE : FILE_KEEP;
}

void act_write_file_line(const char *doing, const char *path, struct reply *reply)
{
    buf_add_text(&reply->text, doing);
    buf_add_safe_text(&reply->text, path);
    buf_add_char(&reply->text, '\n');
}

static void write_seen(const struct rendition *r, struct reply *reply)
{
    size_t seen = 0, pixels = (size_t)r->width * r->height;
    for (size_t i = 0; i < pixels; i++)
        seen += r->cell[i] != CELL_NONE;
    buf_printf(&reply->text, "%ux%u pixels, %zu of them with an object\n", r->width, r->height,
               seen);
}

/* A job for the picture writer, which gets it once the command is recorded. */
static enum err prepare_job(const struct act *act, const char *path, enum file_mode mode,
                            struct picture *picture)
{
    struct interpreter *interp = act->interp;
    if (picture_writer_holds(interp->writer, path))
        picture_writer_wait(interp->writer, NULL, NULL); /* for what it finds there */
    interpreter_note_kept(interp, path, mode);
    const enum err err = picture_job_new(&interp->job, path, mode, picture, act->fault);
    if (!err)
        act_write_file_line("writing ", path, act->reply);
    return err;
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
    enum err err;
    if (interp->writer && interp->mode == MODE_LIVE && picture_writer_takes(path)) {
        err = prepare_job(act, path, mode, picture);
    } else {
        err = act_write_now(interp, path, mode, picture, act->fault);
        if (!err)
            act_write_file_line("wrote ", path, act->reply);
    }
    picture_release(picture);
    return err;
}

static enum err render_file(const struct act *act, const struct labels *labels)
{
    const struct value *value = act->value;
    struct picture picture;
    struct buf path = {0};
    enum err err = interpreter_output_path(act->interp, value[0].text, &path, act->fault);
    if (!err && path.length) {
        err = act_take_picture(act, labels, value[0].text, &picture);
        if (!err) {
            picture.tiled = value[3].given && value[3].number == 1;
            err = act_write_picture(act, buf_text(&path), act_file_mode(&value[2]), &picture);
        }
    }
    buf_release(&path);
    return err;
}

enum err act_render_labels(const struct act *act, const struct value *finished,
                           enum render_mode mode, struct labels *labels)
{
    enum err err = session_run(act->session, act->fault);
    if (!err)
        err = act_take_shown(act, finished, labels);
    if (!err)
        err = session_draw_labels(act->session, labels, mode, act->fault);
    return err ? err : session_decorate(act->session, labels, act->fault);
}

enum err act_render(const struct act *act)
{
    static const enum render_mode mode[] = {RENDER_SCENE, RENDER_BORDER, RENDER_INCREMENTAL,
                                            RENDER_RAY};
    if (act->value[3].given && !(act->value[0].given && exr_is_named(act->value[0].text)))
        return fault_set(act->fault, ERR_USAGE, "layout: only an .exr has lines or tiles");
    struct labels labels;
    const enum err err = act_render_labels(
        act, &act->value[4], act->value[1].given ? mode[act->value[1].number] : RENDER_AS_KEPT,
        &labels);
    if (err || act->interp->mode == MODE_SKIM)
        return err;
    act_add_picture_digest(act);
    if (act->value[0].given)
        return render_file(act, &labels);
    act->interp->shows_picture = true;
    write_seen(session_frame(act->session), act->reply);
    return OK;
}
