/* Commands that show slices and mosaics, and say how. */
#include "command/act.h"

#include "base/choice.h"
#include "show/slicing.h"
#include "show/window.h"

/* ---- how ---- */

void act_write_slices(struct buf *out, struct session *session)
{
    const struct slice_settings *s = &session_outlook(session)->slices;
    char least[WINDOW_WORDS_BYTES], most[WINDOW_WORDS_BYTES];
    window_words(least, most, session);
    buf_printf(out, "through %u,%u,%u: ", s->cross[0], s->cross[1], s->cross[2]);
    for (enum slice_plane plane = SLICE_AXIAL; plane <= SLICE_SAGITTAL; plane++)
        buf_printf(out, "%s %u%s", slice_name(session_scene(session), plane),
                   slicing_number(session, plane, s->cross), plane < SLICE_SAGITTAL ? ", " : "; ");
    buf_printf(out, "window %s%s %s, ", s->has_window ? "" : "auto: ", least, most);
    if (s->times != SLICE_TIMES_ONE)
        buf_printf(out, "magnified %g, ", s->times / 1000.0);
    if (s->has_middle)
        buf_printf(out, "around %u,%u,%u, ", s->middle[0], s->middle[1], s->middle[2]);
    settings_write(out, GROUP_SLICES, session_state(session));
    buf_add_char(out, '\n');
}

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

/* ---- pictures ---- */

/* Draws it, and adds its digest to the words; the caller releases the canvas. `with_cells` also
 * finds which voxel each pixel shows. */
static enum err draw(const struct act *act, enum slice_kind kind, const struct labels *labels,
                     bool with_cells, struct canvas *canvas)
{
    enum err err = slicing_draw(canvas, act->session, kind, labels, with_cells, act->fault);
    if (!err) {
        buf_add_blank(&act->reply->words);
        buf_printf(&act->reply->words, "picture=%016llx",
                   (unsigned long long)canvas_digest(canvas));
    }
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

static enum err show_inline(const struct act *act, enum slice_kind kind,
                            const struct labels *labels)
{
    struct canvas canvas;
    enum err err = draw(act, kind, labels, false, &canvas);
    if (!err)
        interpreter_show(act->interp, &canvas);
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
    if (!err && !act_has(act, "FILE"))
        return show_inline(act, kind, &labels);
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
