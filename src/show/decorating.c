/* SPDX-License-Identifier: MIT */
#include "show/decorating.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/choice.h"
#include "base/mem.h"
#include "render/decoration.h"
#include "engine/labels.h"
#include "session/session.h"
#include "session/markers.h"
#include "session/state.h"
#include "session/tally.h"
#include "show/draw.h"
#include "show/label_report.h"
#include "show/pictures.h"

_Static_assert(sizeof((struct legend_line *)0)->name == LABEL_NAME_BYTES, "a name fits a line");

/* ---- the legend ---- */

static enum err list_labels(struct legend_line line[255], size_t *lines, struct session *session,
                            const struct labels *labels, struct fault *fault)
{
    TRY(session_count_labels(session, fault));
    struct tally shown = session->tally;
    if (labels->finished)
        tally_forget(&shown);
    if (!tally_refresh(&shown, labels, session->team))
        TRY(watch_fault(session->scene->watch, fault));
    for (unsigned label = 1; label < 256; label++) {
        if (!shown.voxels[label] || !session->now.kept.visible[label])
            continue;
        struct legend_line *next = &line[(*lines)++];
        next->label = (uint8_t)label;
        const char *name = session->now.kept.label_name[label];
        if (*name)
            memcpy(next->name, name, sizeof next->name);
        else
            snprintf(next->name, sizeof next->name, "label %u",
                     numbering_of(&session->now.kept, label));
        OWNED(buf_release) struct buf words = {0};
        label_report_write_extent(&words, session, shown.voxels[label]);
        snprintf(next->amount, 32, "%s", words.failed ? "" : buf_text(&words));
    }
    return OK;
}

/* ---- the picture ---- */

static size_t pixels_of(const struct session *session)
{
    const struct rendition *frame = session_frame(session);
    return (size_t)frame->width * frame->height;
}

struct rendition session_picture(const struct session *session)
{
    const struct pictures *p = session->pictures;
    struct rendition picture = *session_frame(session);
    if (p && session->now.outlook.decorations && p->decorated_pixels == pixels_of(session))
        picture.rgba = p->decorated;
    return picture;
}

enum err session_show_frame(struct canvas *canvas, const struct session *session,
                            struct fault *fault)
{
    const struct rendition r = session_picture(session);
    const uint32_t background = background_opaque(session->now.outlook.background);
    TRY(canvas_init(canvas, r.width, r.height, 0, fault));
    memcpy(canvas->rgba, r.rgba, (size_t)4 * r.width * r.height);
    background_put(canvas->rgba, r.width, r.height, background);
    return OK;
}

/* Brightness of the background in the middle of the picture. */
static bool is_bright(const struct session *session)
{
    uint8_t rgb[3];
    background_at(rgb, background_opaque(session->now.outlook.background), 1, 2);
    return 2 * rgb[0] + 5 * rgb[1] + rgb[2] > 8 * 128;
}

void decorating_end(struct decorating *d)
{
    if (d)
        free(d->eliminator);
    free(d);
}

enum err decorating_begin(struct decorating **out, struct session *session,
                          const struct labels *labels, struct fault *fault)
{
    const struct outlook *outlook = &session->now.outlook;
    const uint32_t *cross = outlook->slices.cross;
    const struct edits *list = &session->now.lists.eliminators;
    const size_t eliminators = edits_count(list);
    struct decorating *d = *out = mem_new(sizeof *d);
    if (!d)
        return fault_memory(fault, "the marks of a rendition");
    d->eliminator = mem_array(eliminators + 1, sizeof *d->eliminator);
    enum err err = d->eliminator ? OK : fault_memory(fault, "the marks of a rendition");
    for (size_t i = 0; !err && i < eliminators; i++)
        d->eliminator[i] = edits_first(list)[i].cell;
    d->of = (struct decoration){.parts = outlook->decorations,
                                .samples = outlook->look.samples,
                                .palette = &session->now.kept.palette,
                                .marked = {markers_show, &session->markers},
                                .is_bright = is_bright(session),
                                .line = d->line,
                                .eliminator = d->eliminator,
                                .eliminators = eliminators,
                                .cross =
                                    grid_cell(&session->scene->grid, cross[0], cross[1], cross[2])};
    if (!err && outlook->decorations & DECORATE_LEGEND)
        err = list_labels(d->line, &d->of.lines, session, labels, fault);
    d->of.camera = &d->camera;
    if (err) {
        decorating_end(d);
        *out = NULL;
    }
    return err;
}

enum err session_decorate(struct session *session, const struct labels *labels, struct fault *fault)
{
    const struct rendition *frame = session_frame(session);
    struct pictures *p;
    if (!session->now.outlook.decorations || session->skims)
        return OK;
    TRY(pictures_begin(&p, session, fault));
    const size_t pixels = pixels_of(session);
    if (p->decorated_pixels != pixels) {
        free(p->decorated);
        p->decorated = mem_array(pixels, 4);
        p->decorated_pixels = p->decorated ? pixels : 0;
    }
    if (!p->decorated)
        return fault_memory(fault, "a picture");
    memset(p->decorated, 0, 4 * pixels);
    const struct canvas canvas = {.width = frame->width,
                                  .height = frame->height,
                                  .stride = frame->width,
                                  .rgba = p->decorated};
    struct decorating *d;
    TRY(decorating_begin(&d, session, labels, fault));
    d->of.frame = frame;
    d->camera = p->camera;
    enum err err = decoration_draw(&canvas, &d->of, fault);
    decorating_end(d);
    canvas_lay_over(p->decorated, frame->rgba, pixels);
    return err;
}

bool session_decorates_rows(const struct session *session)
{
    return !(session->now.outlook.decorations & (DECORATE_SEEDS | DECORATE_CROSS));
}
