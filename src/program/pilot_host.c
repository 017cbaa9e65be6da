/* SPDX-License-Identifier: MIT */
#include "program/programs.h"

#include <stdio.h>
#include <string.h>

#include "command/execute.h"
#include "render/rendition.h"
#include "show/label_report.h"
#include "show/voxel_facts.h"
#include "session/session.h"
#include "session/state.h"
#include "show/draw.h"
#include "show/panes.h"
#include "show/window.h"
#include "tui/pilot/pilot_keys.h"

_Static_assert((int)PILOT_AXIAL == (int)PANE_AXIAL && (int)PILOT_CORONAL == (int)PANE_CORONAL &&
                   (int)PILOT_SAGITTAL == (int)PANE_SAGITTAL &&
                   (int)PILOT_RENDITION == (int)PANE_RENDITION,
               "the pilot's panes are those that are shown");
_Static_assert((int)PILOT_KNOWN == (int)VOXEL_FACTS && (int)PILOT_SUMS == (int)FACT_SUMS &&
                   (int)PILOT_INTENSITY == (int)FACT_INTENSITY,
               "what is known of a voxel are its facts");

static struct session *session_of(void *context)
{
    return ((struct pilot_interpreter *)context)->interp->session;
}

/* ---- facts ---- */

static enum pilot_labels shown_labels(const struct session *session)
{
    if (!session_shows_finished(session))
        return PILOT_FOREST;
    return session_is_rough(session) ? PILOT_ROUGH : PILOT_FINISHED;
}

static bool facts(void *context, struct pilot_facts *out)
{
    const struct pilot_interpreter *pilot = context;
    struct session *session = session_of(context);
    struct buf fact[VOXEL_FACTS] = {{0}};
    if (!session_has_scene(session))
        return false;
    const struct outlook *outlook = session_outlook(session);
    const struct slice_settings *s = &outlook->slices;
    const struct rendition *frame = session_frame(session); /* the panel's (session_draw_fitting) */
    *out = (struct pilot_facts){.waiting = session_pendings(session),
                                .intensity = voxel_facts_intensity(session, s->cross),
                                .zoom = session_fitting_view(session).zoom,
                                .times = s->times,
                                .frame_width = frame->depth ? frame->width : outlook->view.width,
                                .frame_height = frame->depth ? frame->height : outlook->view.height,
                                .overlay = s->overlay,
                                .has_object = panes_have_object(session),
                                .takes_all = panes_have_one_label(session),
                                .shows = shown_labels(session),
                                .has_finish = session_kept(session)->finish.count > 0};
    out->fits_itself = session_fits_itself(session, out->middle);
    window_values(out->window, session);
    for (enum pane pane = PANE_AXIAL; pane < PANE_RENDITION; pane++) {
        const struct pane_slice slice = panes_slice(session, pane);
        out->size[pane] = session_scene(session)->grid.size[pane];
        out->place[pane] = s->cross[pane];
        out->axis[pane] = slice.axis;
        out->index[pane] = slice.number;
        out->counts_down[pane] = slice.counts_down;
        out->plane[pane] = slice.plane;
    }
    voxel_facts_write(fact, session, s->cross, !pilot->onlooker);
    for (enum voxel_fact i = FACT_HERE; i < VOXEL_FACTS; i++) {
        snprintf(out->known[i], PILOT_KNOWN_BYTES, "%s", buf_text(fact + i));
        buf_release(fact + i);
    }
    return true;
}

static void move(void *context, const int64_t by[3], uint32_t place[3])
{
    panes_move(session_of(context), by, place);
}

static void label(void *context, unsigned number, struct buf *out)
{
    label_report_write_name(out, session_of(context), number);
}

static bool is_hidden(void *context, unsigned number)
{
    return !session_kept(session_of(context))->visible[number];
}

static bool seed(void *context, unsigned number, int64_t by, uint32_t place[3])
{
    return voxel_facts_next_seed(session_of(context), number, by, place);
}

static bool centre(void *context, unsigned number, uint32_t place[3])
{
    return voxel_facts_centre(session_of(context), number, place);
}

static bool why(void *context, const uint32_t place[3], struct pilot_way *way, struct buf *out)
{
    struct voxel_why *found = &((struct pilot_interpreter *)context)->why;
    if (!voxel_why_find(found, session_of(context), place, out))
        return false;
    *way =
        (struct pilot_way){.label = found->label, .next = found->next, .has_edge = found->has_edge};
    memcpy(way->root, found->root, sizeof way->root);
    memcpy(way->edge, found->edge, sizeof way->edge);
    return true;
}

static unsigned hints(void *context)
{
    return voxel_facts_hints(session_of(context));
}

static bool outline(void *context, unsigned number, enum pilot_pane pane, const uint32_t place[3],
                    struct polyline *line, uint32_t *marker, struct buf *out)
{
    struct session *session = session_of(context);
    return outline_facts_find(line, marker, session, number,
                              panes_slice(session, (enum pane)pane).axis, place, out);
}

static bool doubt(void *context, unsigned number, unsigned rank, enum pilot_pane *pane,
                  uint32_t place[3], struct buf *out)
{
    struct session *session = session_of(context);
    unsigned axis;
    if (!outline_facts_next(&axis, place, session, number, rank, out))
        return false;
    *pane = PILOT_AXIAL;
    while (panes_slice(session, (enum pane) * pane).axis != axis)
        ++*pane;
    return true;
}

static bool held(void *context, const uint32_t place[3], bool tree, struct buf *out)
{
    struct pilot_interpreter *pilot = context;
    return voxel_facts_find_held(&pilot->held, session_of(context), place, tree, out);
}

/* ---- the picture ---- */

/* An onlooker would see margins of half a forest: no heat for him. */
static enum err draw(struct pilot_interpreter *pilot, const struct pilot_wish *wish,
                     struct fault *fault)
{
    const struct pilot_setup *setup = wish->setup ? wish->setup : &pilot_setup_default;
    struct outline_mark outline = {.corner = wish->corner, .corners = wish->corners};
    struct buf line[PANES_LINES] = {{0}};
    struct panes_wish panes = {.width = wish->width,
                               .height = wish->height,
                               .cell_width = wish->cell_width,
                               .cell_height = wish->cell_height,
                               .pane = (enum pane)wish->pane,
                               .is_alone = wish->is_alone,
                               .words = wish->words,
                               .heat = wish->heat && !pilot->onlooker,
                               .within_ns = wish->within_ns,
                               .held = wish->marks_held ? &pilot->held : NULL,
                               .way = wish->marks_way ? &pilot->why.way : NULL,
                               .former = pilot->former,
                               .pixel = wish->marks_pixel ? wish->pixel : NULL,
                               .corner = wish->corner,
                               .corners = wish->marks_corners ? wish->corners : 0,
                               .outline = wish->marks_outline ? &outline : NULL};
    memcpy(outline.rgb, session_kept(session_of(pilot))->palette.rgb[wish->label],
           sizeof outline.rgb);
    buf_add_text(line, "nothing to show yet"); /* what stands in an empty rendition */
    if (!pilot->watches) {
        setup_say_key(line + 1, setup, "plant", " plants a seed of the label");
        setup_say_key_to(line + 2, setup, "plant-label", '0', " one of the background");
    }
    setup_say_key(line + 3, setup, "keys", " shows the keys");
    for (int i = 0; i < PANES_LINES; i++)
        panes.line[i] = buf_text(line + i);
    const enum err err = panes_draw(&pilot->panes, session_of(pilot), &panes, fault);
    for (int i = 0; i < PANES_LINES; i++)
        buf_release(line + i);
    return err;
}

static enum err picture(void *context, const struct pilot_wish *wish, struct image_view *view,
                        struct fault *fault)
{
    struct pilot_interpreter *pilot = context;
    const struct panes *panes = &pilot->panes;
    const enum err err = draw(pilot, wish, fault);
    if (err)
        return err;
    for (enum pane pane = PANE_AXIAL; pane < PANE_RENDITION; pane++)
        pilot->slice[pane] = panes_box(panes, pane);
    *view = (struct image_view){.width = wish->width,
                                .height = wish->height,
                                .rgba = panes->canvas.rgba,
                                .focus = panes_box(panes, (enum pane)wish->pane),
                                .words = panes->canvas.words,
                                .note = panes->note,
                                .notes = panes->notes,
                                .below = panes->canvas.below,
                                .slice = pilot->slice,
                                .slices = PANES_SLICES,
                                .smooth = pilot->smooth,
                                .is_hasty = panes->panel.is_hasty,
                                .hue = pilot->hue,
                                .hues = shown_hues(pilot->hue, session_of(context))};
    if (wish->heat && view->hues < 256)
        pilot->hue[view->hues++] = PANES_HEAT_HUE;
    if (wish->marks_outline && view->hues < 256) { /* no voxel may have the label yet */
        const uint8_t *rgb = session_kept(session_of(context))->palette.rgb[wish->label];
        pilot->hue[view->hues++] = (uint32_t)rgb[0] << 16 | (uint32_t)rgb[1] << 8 | rgb[2];
    }
    return OK;
}

/* Those of the pane where one moves come first. */
static enum pane first_of(const struct pilot_wish *wish)
{
    return wish->pane < PILOT_RENDITION ? (enum pane)wish->pane : PANE_AXIAL;
}

static uint64_t name_ahead(void *context, const struct pilot_wish *wish, unsigned number)
{
    const struct pilot_interpreter *pilot = context;
    return panes_name_beyond(&pilot->panes, session_of(context), first_of(wish), number);
}

static bool ahead(void *context, const struct pilot_wish *wish, unsigned number,
                  struct image_view *view)
{
    struct pilot_interpreter *pilot = context;
    const struct canvas *beyond = &pilot->panes.beyond;
    if (!panes_draw_beyond(&pilot->panes, session_of(context), first_of(wish), number))
        return false;
    pilot->beyond = (struct raster_box){0, 0, beyond->width, beyond->height};
    *view = (struct image_view){.width = beyond->width,
                                .height = beyond->height,
                                .hue = pilot->hue,
                                .below = beyond->below,
                                .slice = &pilot->beyond,
                                .slices = 1};
    return true;
}

static bool voxel_at(void *context, uint32_t column, uint32_t row, uint32_t place[3],
                     enum pilot_pane *pane)
{
    const struct pilot_interpreter *pilot = context;
    enum pane found;
    const bool shows =
        panes_voxel_at(&pilot->panes, session_of(context), column, row, place, &found);
    *pane = (enum pilot_pane)found;
    return shows;
}

static bool pan(void *context, enum pilot_pane pane, int right, int down, uint32_t middle[3],
                uint32_t place[3])
{
    const struct pilot_interpreter *pilot = context;
    return panes_pan(&pilot->panes, session_of(context), (enum pane)pane, (int[]){right, down},
                     middle, place);
}

static void frame_pixel(void *context, uint32_t column, uint32_t row, uint32_t pixel[2])
{
    const struct pilot_interpreter *pilot = context;
    panes_frame_pixel(&pilot->panes, session_of(context), column, row, pixel);
}

static bool voxel_of_frame(void *context, uint32_t column, uint32_t row, uint32_t place[3])
{
    return panes_voxel_of_frame(session_of(context), column, row, place);
}

/* ---- while a command is carried out ---- */

static bool onlooker_wants(void *context)
{
    const struct pilot_interpreter *pilot = context;
    return session_has_scene(session_of(context)) &&
           pilot->onlooker->wants(pilot->onlooker->context);
}

static void onlooker_draws(void *context)
{
    const struct pilot_interpreter *pilot = context;
    pilot->onlooker->draw(pilot->onlooker->context);
}

static void show_to_onlooker(void *context)
{
    session_show(session_of(context), onlooker_draws, context);
}

static void look_on(void *context, const struct pilot_onlooker *onlooker)
{
    struct pilot_interpreter *pilot = context;
    pilot->onlooker = onlooker;
    pilot->looks_on = (struct console_onlooker){pilot, onlooker_wants, show_to_onlooker};
    console_look_on(onlooker ? &pilot->looks_on : NULL);
}

/* ---- while nobody waits ---- */

struct finishing {
    struct session *session;
    const struct pilot_onlooker *onlooker;
    struct watch watch;
};

static bool poll_finishing(void *context, const char *what, uint64_t done, uint64_t total)
{
    struct finishing *f = context;
    (void)what, (void)done, (void)total;
    f->watch.wants_show |= f->onlooker->wants(f->onlooker->context);
    return f->onlooker->stops(f->onlooker->context);
}

static void show_finishing(void *context)
{
    struct finishing *f = context;
    session_show_refining(f->session, f->onlooker->draw, f->onlooker->context);
}

static enum err finish(void *context, const struct pilot_onlooker *onlooker, struct buf *news,
                       struct fault *fault)
{
    struct pilot_interpreter *pilot = context;
    struct finishing f = {session_of(context),
                          onlooker,
                          {.context = &f, .poll = poll_finishing, .show = show_finishing}};
    const enum err err = session_refine(f.session, &f.watch, fault);
    return err ? err : interpreter_write_losses(pilot->interp, NULL, news, fault);
}

static void peek(void *context, const uint32_t place[3])
{
    struct pilot_interpreter *pilot = context;
    struct session *session = session_of(context);
    if (place && !pilot->peeks)
        memcpy(pilot->cross, session_outlook(session)->slices.cross, sizeof pilot->cross);
    if (place || pilot->peeks)
        session_show_cross(session, place ? place : pilot->cross);
    pilot->peeks = place != NULL;
}

/* ---- the whole ---- */

void pilot_host_fill(struct pilot_host *host)
{
    host->facts = facts;
    host->move = move;
    host->picture = picture;
    host->pan = pan;
    host->name_ahead = name_ahead;
    host->ahead = ahead;
    host->voxel_at = voxel_at;
    host->voxel_of_frame = voxel_of_frame;
    host->frame_pixel = frame_pixel;
    host->label = label;
    host->held = held;
    host->why = why;
    host->hints = hints;
    host->look_on = look_on;
    host->finish = finish;
    host->peek = peek;
    host->outline = outline;
    host->doubt = doubt;
    host->seed = seed;
    host->centre = centre;
    host->is_hidden = is_hidden;
}

void pilot_interpreter_release(struct pilot_interpreter *pilot)
{
    panes_release(&pilot->panes);
    voxel_why_release(&pilot->why);
}
