/* SPDX-License-Identifier: MIT */
/* Commands that show or write pictures: renditions, slices and mosaics; and how slices look. */
#include "command/act.h"

#include <string.h>

#include "base/choice.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/least.h"
#include "base/mem.h"
#include "image/exr.h"
#include "image/image_helper.h"
#include "image/picture_writer.h"
#include "journal/golden.h"
#include "journal/journal.h"
#include "render/fit.h"
#include "session/session.h"
#include "show/decorating.h"
#include "show/draw.h"
#include "show/export_picture.h"
#include "show/slicing.h"

/* ---- pictures that are not stored ---- */

/* A file of image_strips, into which a picture is drawn directly. `path` comes from
 * interpreter_output_path; if it is empty, only the digest is computed. */
struct drawn_file {
    const char *path;
    enum file_mode mode;
    enum render_mode render;
    bool tiled;
};

/* Draw a rendition, with its digest, row by row into the file. */
static enum err draw_file(const struct act *act, const struct drawn_file *file,
                          const struct labels *labels, uint64_t *digest)
{
    const bool is_written = *file->path;
    const unsigned planes = file_is_named(file->path, EXR_NAMES) ? PICTURE_EVERY : 0;
    OWNED(picture_release) struct picture picture = {0};
    struct strips *strips = NULL;
    enum err err = OK;
    export_form(&picture, act->session);
    picture.tiled = file->tiled;
    if (is_written)
        err = interpreter_will_write(act->interp, file->path, file->mode, act->fault);
    if (!err && is_written)
        err = strips_begin(&strips, image_strips(file->path), file->path, file->mode, &picture,
                           planes, act->fault);
    if (!err)
        err = export_rows(&picture, strips, act->session, labels, file->render, digest, act->fault);
    if (!err && is_written)
        err = act_note_picture(act, labels, &picture);
    if (err)
        strips_abandon(strips);
    else if (is_written)
        err = strips_end(strips, &picture, act->fault);
    return err;
}

/* Draw a rendition (show/export_picture.h) as colours, with its digest. */
static enum err draw_picture(const struct act *act, const struct labels *labels,
                             enum render_mode mode, struct picture *picture, uint64_t *digest)
{
    export_form(picture, act->session);
    picture->rgba = mem_array((size_t)picture->width * picture->height, 4);
    TRY(picture->rgba ? export_rows(picture, NULL, act->session, labels, mode, digest, act->fault)
                      : fault_memory(act->fault, "a picture"));
    return act_note_picture(act, labels, picture);
}

/* The turntable: pictures of full turns about one axis or several, as files or as one animated
 * file. */

/* A name like "turn%03d.png": the part before the number, the number of digits, and the rest. */
struct pattern {
    const char *name, *rest;
    size_t before;
    int digits;
    bool counts; /* else it is one file for all pictures */
};

static bool read_pattern(struct pattern *pattern, const char *name)
{
    const char *percent = strchr(name, '%'), *at;
    *pattern = (struct pattern){.name = name, .rest = "", .before = strlen(name)};
    if (!percent)
        return file_is_named(name, IMAGE_MOVIES);
    at = percent + 1;
    if (at[0] == '0' && at[1] >= '1' && at[1] <= '9') {
        pattern->digits = at[1] - '0';
        at += 2;
    }
    pattern->counts = *at == 'd';
    if (!pattern->counts || strpbrk(at, "%/"))
        return false;
    pattern->before = (size_t)(percent - name);
    pattern->rest = at + 1;
    return true;
}

struct spin {
    const struct act *act;
    struct labels labels; /* labels shown */
    struct pattern pattern;
    bool takes_rows,
        is_streamed;        /* pictures are not stored; rows are written directly into files */
    unsigned axis[3], axes; /* angles of a view, with one turn about each */
    unsigned count, total, delay_ms; /* pictures of one turn, and of all turns */
    enum file_mode mode;
    struct image_movie movie; /* the unfinished file of the image helper */
    struct buf *name, *path, *first;
    uint64_t digest;
};

/* ---- files ---- */

/* True if the image helper writes the files. */
static bool is_helped(const struct spin *spin)
{
    return !image_strips(spin->pattern.name);
}

/* Wait until the image helper has finished its file. */
static enum err finish_file(struct spin *spin)
{
    return spin->movie.helper ? image_movie_end(&spin->movie, spin->act->fault) : OK;
}

/* Find the path of picture `number`; empty if a replay does not write it. */
static enum err find_path(struct spin *spin, unsigned number)
{
    const struct act *act = spin->act;
    const struct pattern *pattern = &spin->pattern;
    buf_clear(spin->name);
    buf_add(spin->name, pattern->name, pattern->before);
    if (pattern->counts)
        buf_printf(spin->name, "%0*u%s", pattern->digits, number, pattern->rest);
    if (spin->name->failed) /* the next function would clear it */
        return fault_memory(act->fault, "a file name");
    return interpreter_output_path(act->interp, buf_text(spin->name), spin->path, act->fault);
}

/* Write a picture as a file or a part of one. The image helper compresses it while the next one is
 * drawn. */
static enum err write_picture(struct spin *spin, unsigned number, const struct picture *picture)
{
    const struct act *act = spin->act;
    const bool begins = number == 0 || spin->pattern.counts;
    if (begins) {
        TRY(finish_file(spin));
        TRY(find_path(spin, number));
    }
    if (!spin->path->length)
        return OK;
    const char *path = buf_text(spin->path);
    if (!is_helped(spin))
        return act_write_now(act->interp, path, spin->mode, picture, act->fault);
    if (begins) { /* the next file, or the only one */
        TRY(interpreter_will_write(act->interp, path, spin->mode, act->fault));
        spin->movie =
            (struct image_movie){.helper = act->interp->helper, .path = path, .mode = spin->mode};
        TRY(image_movie_begin(&spin->movie, picture, spin->pattern.counts ? 1 : spin->total,
                              spin->pattern.counts ? 0 : spin->delay_ms, act->fault));
    }
    return image_movie_add(&spin->movie, picture, act->fault);
}

/* ---- pictures ---- */

/* Return the view of picture `number`: its angle is rounded to the nearest thousandth of a
 * degree. */
static struct view view_of(const struct spin *spin, const struct view *from, unsigned number)
{
    struct view view = *from;
    int32_t *angle = &view.angle[spin->axis[number / spin->count]];
    const int64_t part = ((int64_t)2 * VIEW_TURN * (number % spin->count) + spin->count) /
                         ((int64_t)2 * spin->count);
    *angle = (int32_t)((*angle + part) % VIEW_TURN);
    return view;
}

/* Find the zoom at which the shown objects fit in all pictures, around their middle in the first
 * one. */
static enum err fit_turns(const struct spin *spin, struct view *from)
{
    const struct session *session = spin->act->session;
    const struct view first = *from;
    OWNED(fit_release) struct fit fit = {0};
    uint32_t place[3];
    TRY(fit_init(&fit, &session->border, spin->act->fault));
    fit_place(&fit, &first, place);
    from->zoom = VIEW_ZOOM_MOST;
    for (unsigned i = 0; i < spin->total; i++) {
        const struct view view = view_of(spin, &first, i);
        from->zoom =
            least(from->zoom, fit_zoom(&fit, &view, place, session->now.outlook.look.samples));
        watch_poll(session->watch, "turntable", 0, spin->total);
    }
    view_focus_on(from, session->scene, place);
    return watch_fault(session->watch, spin->act->fault);
}

/* Draw a rendition with all its planes. */
static enum err draw_whole(struct spin *spin, struct picture *picture, uint64_t *digest)
{
    struct session *session = spin->act->session;
    struct fault *fault = spin->act->fault;
    TRY(session_draw_labels(session, &spin->labels, RENDER_ONCE, fault));
    TRY(session_decorate(session, &spin->labels, fault));
    const struct rendition drawn = session_picture(session);
    *digest = rendition_digest(&drawn);
    return act_take_picture(spin->act, &spin->labels, spin->pattern.name, picture);
}

static enum err draw_turned(struct spin *spin, const struct view *from, unsigned number)
{
    struct session *session = spin->act->session;
    const struct view view = view_of(spin, from, number);
    OWNED(picture_release) struct picture picture = {0};
    uint64_t digest = 0;
    TRY(session_set_view(session, &view, spin->act->fault));
    if (spin->is_streamed) { /* directly into a file */
        TRY(find_path(spin, number));
        const struct drawn_file file = {buf_text(spin->path), spin->mode, RENDER_ONCE, false};
        TRY(draw_file(spin->act, &file, &spin->labels, &digest));
    } else {
        TRY(spin->takes_rows
                ? draw_picture(spin->act, &spin->labels, RENDER_ONCE, &picture, &digest)
                : draw_whole(spin, &picture, &digest));
        TRY(write_picture(spin, number, &picture));
    }
    if (spin->path->length && (spin->pattern.counts || number + 1 == spin->total))
        act_note_file(buf_text(spin->path), spin->act->reply);
    spin->digest += hash_mix_at(number, digest);
    return OK;
}

static enum err draw_turns(struct spin *spin)
{
    struct session *session = spin->act->session;
    struct fault *fault = spin->act->fault;
    const struct view before = session->now.outlook.view;
    struct view from = before;
    const bool rendered = session_rendered(session) == RENDERED_FOREST;
    TRY(act_take_shown(spin->act, &spin->labels));
    if (act_is_yes(spin->act, "fit"))
        TRY(fit_turns(spin, &from));
    TRY(find_path(spin, 0));
    buf_add_text(spin->first, buf_text(spin->path));
    if (spin->path->length && is_helped(spin)) /* it loads its libraries meanwhile */
        TRY(image_helper_start(spin->act->interp->helper, fault));
    for (unsigned i = 0; i < spin->total; i++) {
        watch_poll(session->watch, "turntable", i, spin->total);
        TRY(draw_turned(spin, &from, i));
    }
    TRY(finish_file(spin));
    TRY(session_set_view(session, &before, fault));
    if (rendered)
        TRY(session_render(session, RENDER_AS_KEPT, fault));
    return OK;
}

/* Read "yaw,roll": one turn after the other, about each axis once. */
static enum err read_axes(struct spin *spin)
{
    static const char axes[] = "yaw|pitch|roll";
    const char *given = act_text(spin->act, "axis"), *whole = given ? given : "yaw", *at = whole;
    bool taken[3] = {false};
    int axis = 0;
    for (spin->axes = 0; *at && spin->axes < 3 && axis >= 0; at += *at == ',') {
        char word[8] = "";
        const size_t length = strcspn(at, ",");
        memcpy(word, at, length < sizeof word ? length : 0);
        axis = choice_find(axes, word);
        if (axis < 0 || taken[axis])
            break;
        taken[axis] = true;
        spin->axis[spin->axes++] = (unsigned)axis;
        at += length;
    }
    if (*at || !spin->axes || at[-1] == ',')
        return fault_set(spin->act->fault, ERR_USAGE,
                         "axis: expected yaw, pitch or roll, or several of them with commas "
                         "between, each once, not %s",
                         whole);
    return OK;
}

enum err act_spin(const struct act *act)
{
    struct buf *out = &act->reply->text;
    struct spin spin = {.act = act,
                        .count = (unsigned)act_number(act, "N"),
                        .delay_ms = (unsigned)act_number_or(act, "delay", 100),
                        .mode = act_file_mode(act),
                        .name = act_buf(act),
                        .path = act_buf(act),
                        .first = act_buf(act)};
    if (!read_pattern(&spin.pattern, act_text(act, "FILE")))
        return fault_set(act->fault, ERR_USAGE,
                         "FILE: expected one %%d or %%0Nd in its name, as in turn%%03d.png, or a "
                         "name that ends in .gif or .tif; not %s",
                         act_text(act, "FILE"));
    TRY(read_axes(&spin));
    spin.takes_rows = session_decorates_rows(act->session);
    spin.is_streamed = spin.takes_rows && !is_helped(&spin);
    spin.total = spin.count * spin.axes;
    if (spin.total > IMAGE_FRAMES_MOST)
        return fault_set(act->fault, ERR_USAGE,
                         "%u turns of %u pictures: at most %d pictures in all", spin.axes,
                         spin.count, IMAGE_FRAMES_MOST);
    if (act->interp->mode == MODE_SKIM)
        return OK;
    const enum err err = draw_turns(&spin);
    image_movie_abandon(&spin.movie);
    TRY(err);
    act_add_digest(act, "spin", spin.digest);
    if (!spin.path->length)
        return OK;
    buf_add_text(out, "wrote ");
    buf_add_safe_text(out, buf_text(spin.first));
    if (spin.pattern.counts) {
        buf_add_text(out, " to ");
        buf_add_safe_text(out, buf_text(spin.path));
        buf_add_char(out, '\n');
    } else {
        buf_printf(out, ", %u pictures\n", spin.total);
    }
    return OK;
}

/* ---- pictures ---- */

enum err act_note_picture(const struct act *act, const struct labels *labels,
                          struct picture *picture)
{
    const struct journal *journal = act->interp->journal;
    struct buf *steps = act_buf(act), *name = act_buf(act);
    numbering_write_finish(steps, &act->session->now.kept);
    if (journal)
        golden_journal_name(name, journal_path(journal));
    if (labels->finished)
        TRY(picture_note(picture, "iftty:finish", buf_text(steps), act->fault));
    if (journal && !act->session->is_private)
        TRY(picture_note(picture, "iftty:journal", buf_text(name), act->fault));
    if (journal)
        TRY(picture_note(picture, "iftty:chain", journal_chain(journal), act->fault));
    return OK;
}

enum err act_take_picture(const struct act *act, const struct labels *labels, const char *name,
                          struct picture *picture)
{
    const bool has_all = !name || file_is_named(name, EXR_NAMES);
    TRY(export_picture(picture, act->session, has_all ? PICTURE_BUT_NORMAL : 0, act->fault));
    if (!name) /* goldens are an OpenEXR file and a PNG */
        TRY(export_background(picture, act->session, act->fault));
    else if (has_all)
        TRY(export_normals(picture, act->session, act->fault));
    return act_note_picture(act, labels, picture);
}

void act_add_picture_digest(const struct act *act)
{
    const struct rendition picture = session_picture(act->session);
    act_add_digest(act, "picture", rendition_digest(&picture));
}

enum err act_write_now(struct interpreter *interp, const char *path, enum file_mode mode,
                       const struct picture *picture, struct fault *fault)
{
    TRY(interpreter_will_write(interp, path, mode, fault));
    return image_write(interp->helper, path, mode, picture, fault);
}

enum err act_write_picture(const struct act *act, const char *path, enum file_mode mode,
                           struct picture *picture)
{
    struct interpreter *interp = act->interp;
    const bool is_beside =
        interp->writer && interp->mode == MODE_LIVE && picture_writer_takes(path);
    if (is_beside) { /* a job for the picture writer, queued once the command is recorded */
        if (picture_writer_holds(interp->writer, path))
            picture_writer_wait(interp->writer, NULL); /* so that its file exists */
        interpreter_note_existing(interp, path, mode);
        TRY(picture_job_new(&interp->job, path, mode, picture, act->fault));
    } else {
        TRY(act_write_now(interp, path, mode, picture, act->fault));
    }
    act_write_file_line(is_beside ? "writing " : "wrote ", path, act->reply);
    return OK;
}

enum err act_render_labels(const struct act *act, enum render_mode mode, struct labels *labels)
{
    TRY(act_take_shown(act, labels));
    TRY(session_draw_labels(act->session, labels, mode, act->fault));
    return session_decorate(act->session, labels, act->fault);
}

/* Write a picture that is too large to store directly into a file. */
static enum err render_large(const struct act *act, const char *name, enum render_mode mode)
{
    struct labels labels;
    struct buf *path = act_buf(act);
    uint64_t digest = 0;
    TRY(act_take_shown(act, &labels));
    TRY(interpreter_output_path(act->interp, name, path, act->fault));
    const char *to = buf_text(path);
    if (!*to || image_strips(to)) {
        const struct drawn_file file = {to, act_file_mode(act), mode,
                                        act_number(act, "layout") == 1};
        TRY(draw_file(act, &file, &labels, &digest));
        if (*to)
            act_write_file_line("wrote ", to, act->reply);
    } else {
        OWNED(picture_release) struct picture picture = {0};
        TRY(draw_picture(act, &labels, mode, &picture, &digest));
        TRY(act_write_picture(act, to, act_file_mode(act), &picture));
    }
    act_add_digest(act, "picture", digest);
    return OK;
}

static enum err render_whole(const struct act *act, enum render_mode mode)
{
    struct labels labels;
    enum err err = act_render_labels(act, mode, &labels);
    if (err || act->interp->mode == MODE_SKIM)
        return err;
    act_add_picture_digest(act);
    if (act_has(act, "FILE")) {
        OWNED(picture_release) struct picture picture = {0};
        struct buf *path = act_buf(act);
        TRY(interpreter_output_path(act->interp, act_text(act, "FILE"), path, act->fault));
        if (!path->length)
            return OK;
        TRY(act_take_picture(act, &labels, act_text(act, "FILE"), &picture));
        picture.tiled = act_number(act, "layout") == 1;
        return act_write_picture(act, buf_text(path), act_file_mode(act), &picture);
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
    if (act_has(act, "layout") && !(has_file && file_is_named(act_text(act, "FILE"), EXR_NAMES)))
        return fault_set(act->fault, ERR_USAGE, "layout: only an .exr has lines or tiles");
    if (has_file && act->interp->mode != MODE_SKIM && export_is_large(act->session) &&
        session_decorates_rows(act->session))
        return render_large(act, act_text(act, "FILE"), wanted);
    return render_whole(act, wanted);
}

/* ---- how slices are shown ---- */

/* Apply the next state, and describe the slices. */
static enum err go_and_describe(const struct act *act)
{
    TRY(act_go(act));
    act_write_slices(&act->reply->text, act->session);
    return OK;
}

enum err act_cross(const struct act *act)
{
    for (int a = 0; a < 3; a++)
        act->next->outlook.slices.cross[a] = act_place(act, "PLACE")[a];
    return go_and_describe(act);
}

/* Set the magnification in place of `slice zoom=`. */
static void set_magnification(struct slice_settings *slices, uint32_t times, const uint32_t *middle)
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
                         "at: only for magnified slices; nothing has changed");
    set_magnification(&act->next->outlook.slices,
                      is_whole ? SLICE_TIMES_ONE : (uint32_t)times->number,
                      at->given ? at->place : NULL);
    return go_and_describe(act);
}

enum err act_window(const struct act *act)
{
    struct slice_settings *slices = &act->next->outlook.slices;
    const unsigned slot = session_shown_slot(act->session);
    const bool is_auto = act_text(act, "LOW") != NULL;
    const struct decimal window[2] = {act_value(act, "LOW")->real[0],
                                      act_value(act, "HIGH")->real[0]};
    if (is_auto == act_has(act, "HIGH"))
        return fault_set(act->fault, ERR_USAGE,
                         "expected LOW and HIGH, or auto alone; nothing has changed");
    if (!is_auto && decimal_value(&window[1]) <= decimal_value(&window[0]))
        return fault_set(act->fault, ERR_USAGE, "HIGH is not above LOW; nothing has changed");
    slices->window_of[slot] = is_auto ? 0 : session_shown_digest(act->session);
    for (int i = 0; i < 2; i++)
        slices->window[slot][i] = is_auto ? (struct decimal){0, 0, 0} : window[i];
    return go_and_describe(act);
}

/* ---- pictures of slices ---- */

/* Draw a picture of slices, and add its digest to the words of the record; the caller releases the
 * canvas. `with_cells` also finds the voxel of each pixel. */
static enum err draw_slices(const struct act *act, enum slice_kind kind,
                            const struct labels *labels, bool with_cells, struct canvas *canvas)
{
    TRY(slicing_draw(canvas, act->session, kind, labels, with_cells, act->fault));
    act_add_digest(act, "picture", canvas_digest(canvas));
    return OK;
}

enum err act_take_slices(const struct act *act, enum slice_kind kind, const struct labels *labels,
                         struct picture *picture)
{
    OWNED(canvas_release) struct canvas canvas = {0};
    TRY(draw_slices(act, kind, labels, true, &canvas));
    TRY(slicing_export(picture, act->session, kind, labels, &canvas, act->fault));
    return act_note_picture(act, labels, picture);
}

/* Write to FILE, or show inline. */
static enum err show_or_write(const struct act *act, enum slice_kind kind)
{
    OWNED(picture_release) struct picture picture = {0};
    struct labels labels;
    struct buf *path = act_buf(act);
    if (act->interp->mode == MODE_SKIM)
        return OK;
    act_write_slices(&act->reply->text, act->session);
    TRY(act_take_shown(act, &labels));
    if (!act_has(act, "FILE")) {
        canvas_release(&act->interp->shown);
        TRY(draw_slices(act, kind, &labels, false, &act->interp->shown));
        act->interp->shows_picture = true;
        return OK;
    }
    TRY(act_take_slices(act, kind, &labels, &picture));
    TRY(interpreter_output_path(act->interp, act_text(act, "FILE"), path, act->fault));
    if (!path->length)
        return OK;
    return act_write_picture(act, buf_text(path), act_file_mode(act), &picture);
}

enum err act_slice(const struct act *act)
{
    const struct scene *scene = act->session->scene;
    struct slice_settings *slices = &act->next->outlook.slices;
    const enum slice_plane plane = (enum slice_plane)act_number(act, "PLANE");
    const uint32_t count = slice_count(scene, plane);
    if (act_has(act, "N") && act_number(act, "N") >= count)
        return fault_set(act->fault, ERR_INPUT,
                         "N: expected one of the %s slices 0..%u, not %lld; nothing has changed",
                         act_text(act, "PLANE"), count - 1, (long long)act_number(act, "N"));
    if (act_has(act, "N"))
        slices->cross[slice_axis(act->session->scene, plane)] = (uint32_t)act_number(act, "N");
    if (act_has(act, "zoom")) {
        set_magnification(slices, SLICE_TIMES_ONE, NULL);
        slices->zoom = act_text(act, "zoom") ? 0 : (uint32_t)act_number(act, "zoom");
    }
    TRY(act_go(act));
    return show_or_write(act, (enum slice_kind)plane);
}

enum err act_mosaic(const struct act *act)
{
    return show_or_write(act, SLICE_KIND_MOSAIC);
}
