/* SPDX-License-Identifier: MIT */
#include "show/export_rows.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "render/background.h"
#include "session/follower.h"
#include "session/state.h"
#include "show/decorating.h"
#include "show/export_picture.h"
#include "show/pictures.h"

struct exporting {
    const struct session *session;
    const struct picture *picture;
    struct strips *file;           /* or NULL */
    struct decorating *decorating; /* or NULL */
    const struct context *context; /* or NULL */
    pthread_mutex_t lock;          /* of all below */
    struct label_set labels;       /* that are shown */
    uint64_t digest;               /* rendition_digest */
    enum err err;
    struct fault fault;
};

bool export_is_large(const struct session *session)
{
    const struct view *view = &session_outlook(session)->view;
    return (uint64_t)view->width * view->height > SAMPLES_STORED_MOST;
}

/* What is around the objects, and over them: they are seen as the file will show them. */
static enum err finish_colours(const struct exporting *e, const struct rendition *rows,
                               uint32_t top, struct fault *fault)
{
    const uint32_t width = rows->width;
    if (e->context)
        mip_put_behind(rows->rgba, rows->rgba, e->context->mip.brightness + (size_t)top * width,
                       (size_t)rows->height * width);
    if (e->context || e->decorating)
        memset(rows->blank, 0, (size_t)rows->tiles_x * rows->tiles_y * sizeof *rows->blank);
    if (!e->decorating)
        return OK;
    const size_t pixels = (size_t)rows->height * width;
    uint8_t *layer = mem_new(4 * pixels);
    const struct canvas canvas = {.width = width,
                                  .height = e->picture->height,
                                  .stride = width,
                                  .rgba = layer,
                                  .from = top,
                                  .rows = rows->height};
    if (!layer)
        return fault_memory(fault, "what is drawn over a picture");
    const enum err err = decoration_draw(&canvas, &e->decorating->of, fault);
    canvas_lay_over(layer, rows->rgba, pixels);
    memcpy(rows->rgba, layer, 4 * pixels);
    free(layer);
    return err;
}

/* The memory of row `top` of the picture and of those after it; false where there is none. */
static bool lend(const struct exporting *e, uint32_t top, uint32_t most, struct picture *to)
{
    if (e->file)
        return strips_lend(e->file, top, most, to) > 0;
    if (e->picture->rgba)
        *to = picture_rows(e->picture, top, most);
    return e->picture->rgba;
}

static void take(void *context, const struct rendition *rows, uint32_t top)
{
    struct exporting *e = context;
    const uint32_t height = e->picture->height, width = rows->width;
    struct label_set labels = {{0}};
    struct fault fault = {0};
    struct picture to;
    const enum err err = finish_colours(e, rows, top, &fault);
    const uint64_t digest = rendition_digest_rows(rows, top);
    label_set_add(&labels, rows);
    pthread_mutex_lock(&e->lock);
    for (int i = 0; i < 4; i++)
        e->labels.bits[i] |= labels.bits[i];
    e->digest += digest;
    if (err && !e->err) {
        e->err = err;
        e->fault = fault;
    }
    pthread_mutex_unlock(&e->lock);
    for (uint32_t y = 0; y < rows->height && lend(e, top + y, rows->height - y, &to);
         y += to.height) {
        export_fill(&to, e->session, rows, (size_t)y * width);
        if (!to.depth_mm)
            background_put_rows(to.rgba, width, top + y, to.height, height,
                                session_outlook(e->session)->background);
        if (e->file)
            strips_give(e->file, top + y, to.height);
    }
}

/* A rendition of one sample a pixel that is there is left alone, so that going back needs no
 * memory; others, and large ones, are let go of. */
static enum err draw(struct exporting *e, struct session *session, const struct labels *labels,
                     enum render_mode mode, struct fault *fault)
{
    const struct outlook *outlook = session_outlook(session);
    struct pictures *p;
    enum err err = pictures_begin(&p, session, fault);
    if (!err && outlook->decorations) {
        err = decorating_begin(&e->decorating, session, labels, fault);
        if (!err)
            err = session_aim(session, outlook, &e->decorating->camera, fault);
    }
    if (err)
        return err;
    if (outlook->look.samples > 1 || export_is_large(session))
        pictures_release_rendition(p);
    e->context = outlook->context ? &p->context : NULL;
    e->digest = rendition_digest_begin(outlook->view.width, outlook->view.height);
    p->rendered = RENDERED_NOT;
    p->take = take;
    p->take_context = e;
    err = session_draw_labels(session, labels, mode, fault);
    p->take = NULL;
    p->rendered = RENDERED_NOT;
    return !err && e->err ? fault_set(fault, e->err, "%s", e->fault.text) : err;
}

enum err export_rows(struct picture *picture, struct strips *file, struct session *session,
                     const struct labels *labels, enum render_mode mode, uint64_t *digest,
                     struct fault *fault)
{
    struct exporting e = {.session = session, .picture = picture, .file = file};
    pthread_mutex_init(&e.lock, NULL);
    const enum err err = draw(&e, session, labels, mode, fault);
    pthread_mutex_destroy(&e.lock);
    decorating_end(e.decorating);
    *digest = e.digest;
    if (!err)
        return export_rendition_notes(picture, session, &e.labels, fault);
    picture_release(picture);
    return err;
}
