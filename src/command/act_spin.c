/* SPDX-License-Identifier: MIT */
/* The turntable: pictures all the way around, about one axis after the other, as files or as one
 * that is animated. */
#include "command/act.h"

#include <string.h>

#include "base/choice.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/least.h"
#include "command/act_picture.h"
#include "command/files.h"
#include "image/image_helper.h"
#include "render/fit.h"
#include "session/session.h"
#include "show/decorating.h"
#include "show/export_rows.h"
#include "show/draw.h"

/* "turn%03d.png": what stands before the number of a picture, how many digits it has at least, and
 * what follows it. */
struct pattern {
    const char *name, *rest;
    size_t before;
    int digits;
    bool counts; /* else the name is of one file for all pictures */
};

static bool read_pattern(struct pattern *pattern, const char *name)
{
    const char *percent = strchr(name, '%'), *at;
    *pattern = (struct pattern){.name = name, .rest = "", .before = strlen(name)};
    if (!percent)
        return image_movie_is_named(name);
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
    struct labels labels; /* that are shown */
    struct pattern pattern;
    bool takes_rows, is_streamed;    /* pictures are not stored; they go right into files */
    unsigned axis[3], axes;          /* one turn about each of these angles of a view */
    unsigned count, total, delay_ms; /* pictures of a turn, and of all */
    enum file_mode mode;
    struct image_movie movie; /* the file that the image helper has not finished */
    struct buf name, path, first;
    uint64_t digest;
};

/* ---- files ---- */

/* Whether the image helper writes the files. */
static bool is_helped(const struct spin *spin)
{
    return !image_strips(spin->pattern.name);
}

/* Waits until the image helper has finished its file. */
static enum err finish_file(struct spin *spin)
{
    return spin->movie.helper ? image_movie_end(&spin->movie, spin->act->fault) : OK;
}

/* The next file, or the only one. */
static enum err begin_file(struct spin *spin, const struct picture *like)
{
    const char *path = buf_text(&spin->path);
    struct interpreter *interp = spin->act->interp;
    struct fault *fault = spin->act->fault;
    const bool counts = spin->pattern.counts;
    const enum err err = interpreter_will_write(interp, path, spin->mode, fault);
    if (err)
        return err;
    spin->movie = (struct image_movie){.helper = interp->helper, .path = path, .mode = spin->mode};
    return image_movie_begin(&spin->movie, like, counts ? 1 : spin->total,
                             counts ? 0 : spin->delay_ms, fault);
}

/* Where picture `number` goes; nowhere, where replay writes none. */
static enum err find_path(struct spin *spin, unsigned number)
{
    const struct act *act = spin->act;
    const struct pattern *pattern = &spin->pattern;
    buf_clear(&spin->name);
    buf_add(&spin->name, pattern->name, pattern->before);
    if (pattern->counts)
        buf_printf(&spin->name, "%0*u%s", pattern->digits, number, pattern->rest);
    if (spin->name.failed)
        return fault_memory(act->fault, "a file name");
    return interpreter_output_path(act->interp, buf_text(&spin->name), &spin->path, act->fault);
}

/* A picture as the file, or part of one, that it is to be. The image helper compresses it while the
 * next one is drawn. */
static enum err write_picture(struct spin *spin, unsigned number, const struct picture *picture)
{
    const struct act *act = spin->act;
    const bool begins = number == 0 || spin->pattern.counts;
    enum err err = begins ? finish_file(spin) : OK;
    if (!err && begins)
        err = find_path(spin, number);
    if (err || !spin->path.length)
        return err;
    if (!is_helped(spin))
        return act_write_now(act->interp, buf_text(&spin->path), spin->mode, picture, act->fault);
    err = begins ? begin_file(spin, picture) : OK;
    return err ? err : image_movie_add(&spin->movie, picture, act->fault);
}

/* ---- pictures ---- */

/* Of picture `number`: the angle of its turn is a part of one beyond where it was, to the nearest
 * thousandth. */
static struct view view_of(const struct spin *spin, const struct view *from, unsigned number)
{
    struct view view = *from;
    int32_t *angle = &view.angle[spin->axis[number / spin->count]];
    const int64_t part = ((int64_t)2 * VIEW_TURN * (number % spin->count) + spin->count) /
                         ((int64_t)2 * spin->count);
    *angle = (int32_t)((*angle + part) % VIEW_TURN);
    return view;
}

/* The zoom at which what is shown fits all pictures, around its middle as the first one has it. */
static enum err fit_turns(const struct spin *spin, struct view *from)
{
    const struct session *session = spin->act->session;
    const struct view first = *from;
    struct fit fit;
    uint32_t place[3];
    enum err err = fit_init(&fit, session_border(session), spin->act->fault);
    if (err)
        return err;
    fit_place(&fit, &first, place);
    from->zoom = VIEW_ZOOM_MOST;
    for (unsigned i = 0; i < spin->total; i++) {
        const struct view view = view_of(spin, &first, i);
        from->zoom =
            least(from->zoom, fit_zoom(&fit, &view, place, session_outlook(session)->look.samples));
        watch_poll(session_watch(session), "turntable", 0, spin->total);
    }
    view_focus_on(from, session_scene(session), place);
    fit_release(&fit);
    return watch_fault(session_watch(session), spin->act->fault);
}

/* With all maps of the rendition, for what looks at them. */
static enum err draw_whole(struct spin *spin, struct picture *picture, uint64_t *digest)
{
    struct session *session = spin->act->session;
    struct fault *fault = spin->act->fault;
    enum err err = session_draw_labels(session, &spin->labels, RENDER_ONCE, fault);
    if (!err)
        err = session_decorate(session, &spin->labels, fault);
    if (err)
        return err;
    const struct rendition drawn = session_picture(session);
    *digest = rendition_digest(&drawn);
    return act_take_picture(spin->act, &spin->labels, spin->pattern.name, picture);
}

/* Right into a file. */
static enum err draw_file(struct spin *spin, unsigned number, uint64_t *digest)
{
    enum err err = find_path(spin, number);
    const struct drawn_file file = {buf_text(&spin->path), spin->mode, RENDER_ONCE, false};
    return err ? err : act_draw_file(spin->act, &file, &spin->labels, digest);
}

static enum err show_turned(struct spin *spin, const struct view *from, unsigned number)
{
    struct session *session = spin->act->session;
    const struct view view = view_of(spin, from, number);
    struct picture picture = {0};
    uint64_t digest = 0;
    enum err err = session_set_view(session, &view, spin->act->fault);
    if (!err && spin->is_streamed)
        err = draw_file(spin, number, &digest);
    else if (!err && spin->takes_rows)
        err = act_draw_picture(spin->act, &spin->labels, RENDER_ONCE, &picture, &digest);
    else if (!err)
        err = draw_whole(spin, &picture, &digest);
    if (!err && !spin->is_streamed)
        err = write_picture(spin, number, &picture);
    if (!err && spin->path.length && (spin->pattern.counts || number + 1 == spin->total))
        act_note_file(buf_text(&spin->path), spin->act->reply);
    spin->digest += hash_mix_at(number, digest);
    picture_release(&picture);
    return err;
}

static enum err turn_around(struct spin *spin)
{
    struct session *session = spin->act->session;
    struct fault *fault = spin->act->fault;
    const struct view before = session_outlook(session)->view;
    struct view from = before;
    const bool rendered = session_rendered(session) == RENDERED_FOREST;
    enum err err = session_run(session, fault);
    if (!err)
        err = act_take_shown(spin->act, &spin->labels);
    if (!err && act_is_yes(spin->act, "fit"))
        err = fit_turns(spin, &from);
    if (!err)
        err = find_path(spin, 0);
    buf_add_text(&spin->first, buf_text(&spin->path));
    if (!err && spin->path.length &&
        is_helped(spin)) /* it loads its libraries while one is drawn */
        err = image_helper_start(spin->act->interp->helper, fault);
    for (unsigned i = 0; i < spin->total && !err; i++) {
        watch_poll(session_watch(session), "turntable", i, spin->total);
        err = show_turned(spin, &from, i);
    }
    if (!err)
        err = finish_file(spin);
    if (!err)
        err = session_set_view(session, &before, fault);
    if (!err && rendered)
        err = session_render(session, RENDER_AS_KEPT, fault);
    return err;
}

static void write_outcome(const struct spin *spin, struct reply *reply)
{
    act_add_digest(spin->act, "spin", spin->digest);
    if (!spin->path.length)
        return;
    buf_add_text(&reply->text, "wrote ");
    buf_add_safe(&reply->text, buf_text(&spin->first), spin->first.length);
    if (spin->pattern.counts) {
        buf_add_text(&reply->text, " to ");
        buf_add_safe(&reply->text, buf_text(&spin->path), spin->path.length);
        buf_add_char(&reply->text, '\n');
    } else {
        buf_printf(&reply->text, ", %u pictures\n", spin->total);
    }
}

/* "yaw,roll": one turn after the other, about each axis once. */
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

static enum err prepare(struct spin *spin)
{
    struct fault *fault = spin->act->fault;
    if (!read_pattern(&spin->pattern, act_text(spin->act, "FILE")))
        return fault_set(fault, ERR_USAGE,
                         "FILE: expected one %%d or %%0Nd in its name, as in turn%%03d.png, or a "
                         "name that ends in .gif or .tif; not %s",
                         act_text(spin->act, "FILE"));
    const enum err err = read_axes(spin);
    spin->takes_rows = session_decorates_rows(spin->act->session);
    spin->is_streamed = spin->takes_rows && !is_helped(spin);
    spin->total = spin->count * spin->axes;
    if (!err && spin->total > IMAGE_FRAMES_MOST)
        return fault_set(fault, ERR_USAGE, "%u turns of %u pictures: at most %d pictures in all",
                         spin->axes, spin->count, IMAGE_FRAMES_MOST);
    return err;
}

enum err act_spin(const struct act *act)
{
    struct spin spin = {.act = act,
                        .count = (unsigned)act_number(act, "N"),
                        .delay_ms = (unsigned)act_number_or(act, "delay", 100),
                        .mode = act_file_mode(act)};
    enum err err = prepare(&spin);
    if (err)
        return err;
    if (act->interp->mode == MODE_SKIM)
        return session_run(act->session, act->fault);
    err = turn_around(&spin);
    if (!err)
        write_outcome(&spin, act->reply);
    image_movie_abandon(&spin.movie);
    buf_release(&spin.name);
    buf_release(&spin.path);
    buf_release(&spin.first);
    return err;
}
