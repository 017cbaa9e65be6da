/* SPDX-License-Identifier: MIT */
#include "program/programs.h"

#include "image/image_helper.h"
#include "session/session.h"
#include "session/tally.h"
#include "show/decorating.h"
#include "show/draw.h"
#include "tui/prompt/repl.h"

unsigned shown_hues(uint32_t hue[256], const struct session *session)
{
    unsigned count = 0;
    uint8_t lightest[3];
    background_at(lightest, session_outlook(session)->background, 0, 1);
    if (lightest[0] | lightest[1] | lightest[2])
        hue[count++] = (uint32_t)lightest[0] << 16 | (uint32_t)lightest[1] << 8 | lightest[2];
    for (unsigned label = 1; label < 256; label++) {
        const uint8_t *rgb = session_kept(session)->palette.rgb[label];
        if (session_kept(session)->visible[label] && session_tally(session)->voxels[label])
            hue[count++] = (uint32_t)rgb[0] << 16 | (uint32_t)rgb[1] << 8 | rgb[2];
    }
    return count;
}

struct image_view shown_picture(struct interpreter *interp, bool smooth)
{
    static uint32_t hue[256];
    const struct canvas *shown = &interp->shown;
    const struct rendition *r = session_frame(interp->session);
    struct image_view view = {.width = r->width, .height = r->height, .rgba = r->rgba};
    if (!shown->rgba && r->rgba) /* without memory for it, over black */
        session_show_frame(&interp->shown, interp->session, NULL);
    if (shown->rgba)
        view = (struct image_view){
            .width = shown->width, .height = shown->height, .rgba = shown->rgba};
    if (session_has_scene(interp->session) && session_count_labels(interp->session, NULL) == OK) {
        view.hue = hue;
        view.hues = shown_hues(hue, interp->session);
    }
    view.smooth = smooth;
    return view;
}

/* ---- iftty show ---- */

/* Fine, and silent, where standard output is no terminal. */
enum err run_show(const struct options *o, struct fault *fault)
{
    struct image_helper *helper;
    struct picture picture = {0};
    enum err err = image_helper_new(&helper, NULL, fault);
    if (!err)
        err = image_helper_read(helper, o->word[0], &picture, fault);
    if (!err) {
        const struct image_view view = {.width = picture.width,
                                        .height = picture.height,
                                        .rgba = picture.rgba,
                                        .smooth = o->smooth};
        show_picture_once(o->graphics, &view);
    }
    picture_release(&picture);
    image_helper_free(helper);
    return err;
}
