/* Commands that show slices and mosaics, and say how. */
#include "command/act.h"

#include <string.h>

#include "session/slicing.h"

/* The places of the parameters in the table. */
enum { SLICE_PLANE, SLICE_NUMBER, SLICE_FILE, SLICE_ZOOM, SLICE_REPLACE };
enum { MOSAIC_FILE, MOSAIC_REPLACE };
enum { WINDOW_LOW, WINDOW_HIGH };
enum { OVERLAY_LABELS, OVERLAY_CROSS, OVERLAY_MARKS, OVERLAY_WORDS };

/* ---- how ---- */

void act_write_slices(struct buf *out, struct session *session)
{
    static const char *const overlay[] = {"none", "tint", "contour"};
    const struct slice_settings *s = &session->settings.slices;
    char least[WINDOW_WORDS_BYTES], most[WINDOW_WORDS_BYTES];
    slicing_window_words(least, most, session);
    buf_printf(out, "through %u,%u,%u: axial %u, coronal %u, sagittal %u; window %s%s %s, ",
               s->cross[0], s->cross[1], s->cross[2],
               slice_index(session->scene, SLICE_AXIAL, s->cross),
               slice_index(session->scene, SLICE_CORONAL, s->cross),
               slice_index(session->scene, SLICE_SAGITTAL, s->cross),
               s->has_window ? "" : "auto: ", least, most);
    buf_printf(out, "overlay %s%s%s%s\n", overlay[s->overlay], s->crosses ? "" : " cross=off",
               s->marks ? "" : " marks=off", s->words ? "" : " words=off");
}

ACT(cross)
{
    uint32_t *cross = interp->session.settings.slices.cross;
    (void)fault;
    for (int a = 0; a < 3; a++)
        cross[a] = value[0].place[a];
    act_write_slices(&reply->text, &interp->session);
    return OK;
}

ACT(window)
{
    const bool is_auto = value[WINDOW_LOW].text != NULL;
    const int64_t window[2] = {value[WINDOW_LOW].number, value[WINDOW_HIGH].number};
    if (is_auto == value[WINDOW_HIGH].given)
        return fault_set(fault, ERR_USAGE,
                         "expected LOW and HIGH, or auto alone; nothing has changed");
    if (!is_auto && window[1] <= window[0])
        return fault_set(fault, ERR_USAGE, "HIGH is not above LOW; nothing has changed");
    session_set_window(&interp->session, is_auto ? NULL : window);
    act_write_slices(&reply->text, &interp->session);
    return OK;
}

ACT(overlay)
{
    struct slice_settings *s = &interp->session.settings.slices;
    bool *const what[] = {
        [OVERLAY_CROSS] = &s->crosses, [OVERLAY_MARKS] = &s->marks, [OVERLAY_WORDS] = &s->words};
    bool any = value[OVERLAY_LABELS].given;
    for (int i = OVERLAY_CROSS; i <= OVERLAY_WORDS; i++) {
        if (value[i].given)
            *what[i] = value[i].number == 0;
        any |= value[i].given;
    }
    if (!any)
        return fault_set(fault, ERR_USAGE, "expected what to change, as in `overlay tint`");
    if (value[OVERLAY_LABELS].given)
        s->overlay = (enum slice_overlay)value[OVERLAY_LABELS].number;
    act_write_slices(&reply->text, &interp->session);
    return OK;
}

/* ---- pictures ---- */

enum err act_take_slices(struct interpreter *interp, enum slice_kind kind, struct picture *picture,
                         struct reply *reply, struct fault *fault)
{
    struct canvas canvas;
    enum err err = slicing_draw(&canvas, &interp->session, kind, true, fault);
    if (err)
        return err;
    buf_printf(&reply->words, "picture=%016llx", (unsigned long long)canvas_digest(&canvas));
    err = slicing_export(picture, &interp->session, kind, &canvas, fault);
    canvas_release(&canvas);
    if (!err)
        err = act_note_picture(interp, picture, fault);
    if (err)
        picture_release(picture);
    return err;
}

static enum err show_inline(struct interpreter *interp, enum slice_kind kind, struct reply *reply,
                            struct fault *fault)
{
    struct canvas canvas;
    enum err err = slicing_draw(&canvas, &interp->session, kind, false, fault);
    if (err)
        return err;
    buf_printf(&reply->words, "picture=%016llx", (unsigned long long)canvas_digest(&canvas));
    interpreter_show(interp, &canvas);
    return OK;
}

/* To the file that is named, or inline. */
static enum err bring_out(struct interpreter *interp, enum slice_kind kind,
                          const struct value *file, const struct value *replace,
                          struct reply *reply, struct fault *fault)
{
    struct picture picture = {0};
    struct buf path = {0};
    if (interp->skims)
        return OK;
    act_write_slices(&reply->text, &interp->session);
    if (!file->given)
        return show_inline(interp, kind, reply, fault);
    enum err err = act_take_slices(interp, kind, &picture, reply, fault);
    if (!err)
        err = interpreter_output_path(interp, file->text, &path, fault);
    if (!err && path.length)
        err = act_write_picture(interp, buf_text(&path), act_file_mode(replace), &picture, reply,
                                fault);
    else
        picture_release(&picture);
    buf_release(&path);
    return err;
}

ACT(slice)
{
    struct session *session = &interp->session;
    struct slice_settings *s = &session->settings.slices;
    const enum slice_plane plane = (enum slice_plane)value[SLICE_PLANE].number;
    const uint32_t count = slice_count(session->scene, plane);
    if (value[SLICE_NUMBER].given && value[SLICE_NUMBER].number >= count)
        return fault_set(fault, ERR_INPUT,
                         "N: expected one of the %s slices 0..%u, not %lld; nothing has changed",
                         value[SLICE_PLANE].text, count - 1, (long long)value[SLICE_NUMBER].number);
    if (value[SLICE_NUMBER].given)
        slice_move(session->scene, plane, (uint32_t)value[SLICE_NUMBER].number, s->cross);
    if (value[SLICE_ZOOM].given)
        s->zoom = value[SLICE_ZOOM].text ? 0 : (uint32_t)value[SLICE_ZOOM].number;
    return bring_out(interp, (enum slice_kind)plane, &value[SLICE_FILE], &value[SLICE_REPLACE],
                     reply, fault);
}

ACT(mosaic)
{
    return bring_out(interp, SLICE_KIND_MOSAIC, &value[MOSAIC_FILE], &value[MOSAIC_REPLACE], reply,
                     fault);
}
