/* Pictures of a session: its camera and its rendition. */
#include "session/session_inside.h"

#include <string.h>

#include "base/err.h"
#include "render/bands.h"
#include "render/border.h"
#include "render/normal.h"
#include "render/projection.h"
#include "render/view.h"
#include "show/draw.h"
#include "show/drawn_colours.h"
#include "show/decorating.h"
#include "show/window.h"

/* ---- the camera ---- */

enum err session_aim(const struct session *session, const struct outlook *outlook,
                     struct camera *camera, struct fault *fault)
{
    const struct view *view = &outlook->view;
    const uint32_t samples = outlook->look.samples;
    struct view fine = *view; /* with `samples` pixels for each of its own, along both sides */
    fine.width *= samples;
    fine.height *= samples;
    fine.zoom *= samples;
    return camera_init(camera, session->scene, &fine, fault);
}

/* Whether there is nothing of another size. */
static bool suits(const struct rendition *rendition, uint32_t width, uint32_t height)
{
    return !rendition->depth || (rendition->width == width && rendition->height == height);
}

void session_take_camera(struct session *session, const struct camera *camera)
{
    const struct view *view = &session->now.outlook.view, *fine = &camera->view;
    if (!suits(&session->rendition, fine->width, fine->height) ||
        !suits(&session->reduced, view->width, view->height))
        session_release_rendition(session);
    session->camera = *camera;
    session->rendered = RENDERED_NOT;
}

/* ---- the rendition ---- */

/* Of objects alone. */
static const struct rendition *objects_of(const struct session *session)
{
    return session->now.outlook.look.samples > 1 ? &session->reduced : &session->rendition;
}

const struct rendition *session_frame(const struct session *session)
{
    const struct rendition *frame = &session->context.frame;
    return session->now.outlook.context && frame->rgba ? frame : objects_of(session);
}

enum err session_show_frame(struct canvas *canvas, const struct session *session,
                            struct fault *fault)
{
    const struct rendition r = session_picture(session);
    const uint32_t background = background_opaque(session->now.outlook.background);
    const enum err err = canvas_init(canvas, r.width, r.height, false, fault);
    if (err)
        return err;
    memcpy(canvas->rgba, r.rgba, (size_t)4 * r.width * r.height);
    background_put(canvas->rgba, r.width, r.height, background);
    return OK;
}

static void prepare_shader(struct session *session)
{
    session->shader.team = session->team;
    if (!cut_is_none(&session->now.kept.cut))
        window_of(session->shader.window, session);
}

enum err session_colour(struct session *session, const struct border *border, struct fault *fault)
{
    const struct kept *kept = &session->now.kept;
    const struct look *look = &session->now.outlook.look;
    prepare_shader(session);
    enum err err = shade(&session->rendition, &session->camera, border, &kept->palette, look,
                         &session->shader, fault);
    if (!err && look->samples > 1)
        rendition_reduce(&session->reduced, &session->rendition, look->samples, session->team);
    return err;
}

/* Samples of so many pixels are stored, so that an edit is seen at once: 210 MB of them. */
enum { SAMPLES_STORED_MOST = 1 << 23 };

/* Whether the maps of camera.view's size are stored; else the picture is drawn in bands. */
static bool stores_samples(const struct session *session, enum render_mode mode)
{
    const struct view *fine = &session->camera.view;
    return session->now.outlook.look.samples == 1 ||
           (mode != RENDER_ONCE && (uint64_t)fine->width * fine->height <= SAMPLES_STORED_MOST);
}

static enum err make_rendition(struct session *session, struct rendition *rendition, uint32_t width,
                               uint32_t height, struct fault *fault)
{
    if (rendition->depth)
        return OK;
    session->rendered = RENDERED_NOT;
    return rendition_init(rendition, width, height, fault);
}

/* Memory for the rendition. */
static enum err make_room(struct session *session, enum render_mode mode, struct fault *fault)
{
    const struct view *view = &session->now.outlook.view, *fine = &session->camera.view;
    enum err err = OK;
    if (session->drawn)
        return OK;
    if (stores_samples(session, mode))
        err = make_rendition(session, &session->rendition, fine->width, fine->height, fault);
    else
        rendition_release(&session->rendition);
    if (session->now.outlook.look.samples == 1)
        rendition_release(&session->reduced);
    else if (!err)
        err = make_rendition(session, &session->reduced, view->width, view->height, fault);
    if (err)
        session_release_rendition(session);
    return err;
}

/* Has the camera look at this zoom. */
static enum err take_zoom(struct session *session, uint32_t zoom, struct fault *fault)
{
    struct outlook outlook = session->now.outlook;
    struct camera camera;
    if (session->camera.view.zoom == zoom * outlook.look.samples)
        return OK;
    outlook.view.zoom = zoom;
    const enum err err = session_aim(session, &outlook, &camera, fault);
    if (!err)
        session_take_camera(session, &camera);
    return err;
}

static projection *projection_of(enum render_mode mode)
{
    return mode == RENDER_SCENE ? splat_scene : mode == RENDER_RAY ? raycast : splat_border;
}

static enum err draw_bands(struct session *session, const struct border *border,
                           projection *project, struct fault *fault)
{
    const struct state *now = &session->now;
    const struct bands bands = {.project = project,
                                .camera = &session->camera,
                                .border = border,
                                .palette = &now->kept.palette,
                                .look = &now->outlook.look,
                                .shader = &session->shader,
                                .take = session->drawn ? drawn_colours_take : NULL,
                                .context = session->drawn};
    prepare_shader(session);
    return bands_draw(session->drawn ? NULL : &session->reduced, &bands, fault);
}

/* Of the voxels that a border shows, from nothing, into memory that is there. */
static enum err draw_border(struct session *session, struct border *border, enum render_mode mode,
                            struct fault *fault)
{
    projection *project = projection_of(mode);
    enum err err = OK;
    session->rendered = RENDERED_NOT;
    err = border_set_skin(border, look_is_refined(&session->now.outlook.look), fault);
    if (err)
        return err;
    if (session->rendition.depth) {
        err = shade_take_layers(&session->shader, &session->layers, &session->rendition,
                                &session->camera, border, &session->now.outlook.look, fault);
        if (err)
            return err;
        if (project == splat_border)
            splat_border_shared(&session->rendition, &session->camera, border, session->team);
        else
            project(&session->rendition, &session->camera, border);
        err = session_colour(session, border, fault);
        if (!err && session->drawn)
            drawn_colours_take(session->drawn, &session->rendition, 0);
    } else {
        err = draw_bands(session, border, project, fault);
    }
    if (!err)
        err = context_put(session, objects_of(session), fault);
    return err ? err : watch_fault(session->watch, fault);
}

static struct border *border_of(struct session *session, enum rendered as)
{
    return as == RENDERED_FINISHED ? &session->live.border : &session->border;
}

static enum err draw_at(struct session *session, uint32_t zoom, enum rendered as,
                        enum render_mode mode, struct fault *fault)
{
    if (session->skims)
        return OK;
    enum err err = take_zoom(session, zoom, fault);
    if (!err)
        err = make_room(session, mode, fault);
    const bool draws_anew = mode == RENDER_SCENE || mode == RENDER_BORDER || mode == RENDER_RAY;
    if (err || (session->rendered == as && !draws_anew))
        return err;
    err = draw_border(session, border_of(session, as), mode, fault);
    session->rendered = err ? RENDERED_NOT : as;
    return err;
}

void session_follow_rendition(struct session *session, enum rendered as,
                              const struct changes *changes)
{
    const struct border *border = border_of(session, as);
    if (session->rendered != as)
        return;
    session->rendered = RENDERED_NOT;
    if (!session->rendition.depth)
        return;
    if (session->now.outlook.look.creases && !session->rendition.layers)
        shade_follow(&session->shader, border, changes);
    incremental_image(&session->rendition, &session->camera, border, changes,
                      shade_reach(&session->now.outlook.look, &session->camera));
    enum err err = session_colour(session, border, NULL);
    if (!err)
        err = context_put(session, objects_of(session), NULL);
    session->rendered = err ? RENDERED_NOT : as;
}

/* The shader's fields are those of the forest's border, or of this one, which goes. */
static enum err draw_finished(struct session *session, const struct labels *labels,
                              enum render_mode mode, struct fault *fault)
{
    struct border border;
    enum err err = border_init(&border, session->scene, fault);
    if (err)
        return err;
    border.labels = *labels;
    kept_show(&session->now.kept, &border);
    border_recount(&border);
    err = watch_fault(session->watch, fault);
    if (!err)
        err = draw_border(session, &border, mode, fault);
    shader_release(&session->shader);
    border_release(&border);
    return err;
}

/* Labels that are to stay have a border that stays. */
static enum err draw_live(struct session *session, const struct labels *labels,
                          enum render_mode mode, struct fault *fault)
{
    const enum err err = live_finish_take(session, labels, fault);
    return err ? err
               : draw_at(session, session->now.outlook.view.zoom, RENDERED_FINISHED, mode, fault);
}

enum err session_draw_labels(struct session *session, const struct labels *labels,
                             enum render_mode mode, struct fault *fault)
{
    if (session->skims || !labels->finished)
        return session_draw(session, mode, fault);
    if (session_shows_finished(session))
        return draw_live(session, labels, mode, fault);
    enum err err = take_zoom(session, session->now.outlook.view.zoom, fault);
    if (!err)
        err = make_room(session, mode, fault);
    return err ? err : draw_finished(session, labels, mode, fault);
}

enum err session_draw(struct session *session, enum render_mode mode, struct fault *fault)
{
    return draw_at(session, session->now.outlook.view.zoom, RENDERED_FOREST, mode, fault);
}

enum err session_draw_fitting(struct session *session, struct labels *labels, struct fault *fault)
{
    const bool finished = session_shows_finished(session);
    *labels = labels_of_forest(session->scene);
    const enum err err = finished ? live_finish_begin(session, fault) : OK;
    if (err)
        return err;
    labels->finished = finished ? session->live.label : NULL;
    return draw_at(session, session_fitting_zoom(session),
                   finished ? RENDERED_FINISHED : RENDERED_FOREST, RENDER_AS_KEPT, fault);
}

uint32_t session_fitting_zoom(const struct session *session)
{
    const struct view *view = &session->now.outlook.view;
    const uint32_t first = view_default(session->scene).zoom;
    const uint32_t fitting = view_fitting_zoom(session->scene, view->width, view->height,
                                               session->now.outlook.look.samples);
    return view->zoom == first && view->zoom < fitting ? fitting : view->zoom;
}

enum err session_render(struct session *session, enum render_mode mode, struct fault *fault)
{
    enum err err = session_run(session, fault);
    return err ? err : session_draw(session, mode, fault);
}

/* ---- while a command is carried out ---- */

/* The border is that of the labels as they are, and made anew once they are final: the forest's,
 * of which nothing is finished. Tally and measures are those from which the command's changes will
 * be counted. */
void session_show(struct session *session, void (*draw)(void *context), void *context)
{
    const struct tally tally = session->tally, former = session->former_tally;
    const struct label_measures measures = session->measures;
    const bool shows_finished = session->now.outlook.shows_finished;
    session->now.outlook.shows_finished = false;
    session->measures = (struct label_measures){0};
    border_recount(&session->border);
    session->stale |= MADE_BORDER;
    session->rendered = RENDERED_NOT;
    draw(context);
    session->rendered = RENDERED_NOT;
    session->tally = tally;
    session->former_tally = former;
    label_measures_release(&session->measures);
    session->measures = measures;
    session->now.outlook.shows_finished = shows_finished;
}

void session_show_cross(struct session *session, const uint32_t place[3])
{
    memcpy(session->now.outlook.slices.cross, place, sizeof session->now.outlook.slices.cross);
}
