#include "show/live_finish.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "session/session_inside.h"

size_t live_finish_memory(const struct live_finish *live)
{
    return live->cells + border_memory(&live->border);
}

void live_finish_drop(struct session *session)
{
    struct live_finish *live = &session->live;
    if (!live->label)
        return;
    shader_release(&session->shader); /* its fields may be of this border */
    mem_pages_free(live->label, live->cells);
    border_release(&live->border);
    *live = (struct live_finish){0};
    if (session->rendered == RENDERED_FINISHED)
        session->rendered = RENDERED_NOT;
}

bool session_shows_finished(const struct session *session)
{
    return session->now.outlook.shows_finished && session->now.kept.finish.count > 0 &&
           session->has_scene && !session->skims;
}

/* ---- what is there to be shown ---- */

/* Exact where such are stored, else the forest's. */
static enum err make(struct session *session, struct fault *fault)
{
    struct live_finish *live = &session->live;
    const struct finished *made = &session->finished;
    const bool is_exact = made->label && finish_source_is_present(&made->of, session);
    const struct labels from = {session->scene, is_exact ? made->label : NULL};
    live->cells = session->scene->grid.cells;
    live->label = mem_pages(live->cells);
    if (!live->label)
        return fault_memory(fault, "finished labels");
    const enum err err = border_init(&live->border, session->scene, fault);
    if (err) {
        live_finish_drop(session);
        return err;
    }
    labels_copy(&from, live->label, session->team);
    live->of = is_exact ? made->of : (struct finish_source){0};
    live->border.labels.finished = live->label;
    return OK;
}

/* Whether the border shows what the session does. */
static bool border_fits(const struct live_finish *live, const struct kept *kept)
{
    for (int label = 0; label < 256; label++)
        if (live->border.visible[label] != kept_shows(kept, label))
            return false;
    return memcmp(&live->border.cut, &kept->cut, sizeof kept->cut) == 0;
}

static enum err fit_border(struct session *session, struct fault *fault)
{
    struct live_finish *live = &session->live;
    border_recount(&live->border);
    if (session->rendered == RENDERED_FINISHED)
        session->rendered = RENDERED_NOT;
    const enum err err = watch_fault(session->scene->watch, fault);
    if (err)
        live_finish_drop(session);
    return err;
}

enum err live_finish_begin(struct session *session, struct fault *fault)
{
    struct live_finish *live = &session->live;
    const bool is_new = !live->label;
    const enum err err = is_new ? make(session, fault) : OK;
    if (err)
        return err;
    const bool fits = !is_new && border_fits(live, &session->now.kept);
    kept_show(&session->now.kept, &live->border);
    return fits ? OK : fit_border(session, fault);
}

/* ---- what changes ---- */

/* The labels are these now. What cannot be listed, or is too much, is everything. */
static void follow(struct session *session, struct change *change, size_t count, bool everything)
{
    struct live_finish *live = &session->live;
    const struct changes changes = {.everything = everything,
                                    .count = everything ? 0 : count,
                                    .item = change,
                                    .listed = everything ? 0 : count,
                                    .voxels = count};
    border_update(&live->border, &changes);
    session_follow_rendition(session, RENDERED_FINISHED, &changes);
    free(change);
    if (watch_stops(session->scene->watch))
        live_finish_drop(session);
}

void live_finish_follow(struct session *session, const struct changes *changes)
{
    struct live_finish *live = &session->live;
    struct change *change = NULL;
    size_t count = 0;
    live->of = (struct finish_source){0};
    if (live->label && !changes->everything && session_shows_finished(session))
        change = mem_array(changes->count + 1, sizeof *change);
    if (!change) {
        live_finish_drop(session);
        return;
    }
    for (size_t i = 0; i < changes->count; i++) {
        const struct change *of_forest = changes->item + i;
        uint8_t *label = live->label + of_forest->cell;
        if (*label == of_forest->label)
            continue;
        change[count++] = (struct change){of_forest->cell, *label, of_forest->label};
        *label = of_forest->label;
    }
    follow(session, change, count, false);
}

/* Cells whose labels differ, and how many: at most `most` of them; more are not listed. */
static size_t list_differences(const struct live_finish *live, const uint8_t *label,
                               struct change *change, size_t most)
{
    enum { STEP = 256 };
    size_t count = 0;
    for (size_t at = 0; at < live->cells && count <= most; at += STEP) {
        const size_t end = at + STEP < live->cells ? at + STEP : live->cells;
        if (memcmp(live->label + at, label + at, end - at) == 0)
            continue;
        for (size_t c = at; c < end && count <= most; c++)
            if (live->label[c] != label[c] && count++ < most)
                change[count - 1] = (struct change){(uint32_t)c, live->label[c], label[c]};
    }
    return count;
}

enum err live_finish_take(struct session *session, const struct labels *exact, struct fault *fault)
{
    struct live_finish *live = &session->live;
    const enum err err = live_finish_begin(session, fault);
    if (err || finish_source_is_present(&live->of, session))
        return err;
    const size_t most = live->cells / 16;
    struct change *change = mem_array(most + 1, sizeof *change);
    const size_t count = change ? list_differences(live, exact->finished, change, most) : most + 1;
    memcpy(live->label, exact->finished, live->cells);
    follow(session, change, count, count > most);
    live->of = session->finished.of;
    return watch_fault(session->scene->watch, fault);
}

/* ---- made exact ---- */

bool session_is_rough(const struct session *session)
{
    return session_shows_finished(session) && !finish_source_is_present(&session->live.of, session);
}

uint8_t live_finish_label(const struct session *session, uint32_t cell)
{
    return session_shows_finished(session) && session->live.label
               ? session->live.label[cell]
               : session->scene->cell[cell].label;
}

enum err session_refine(struct session *session, struct watch *watch, struct fault *fault)
{
    struct labels exact;
    struct watch *const former = session->scene->watch;
    session->scene->watch = watch;
    enum err err = session_labels(session, true, &exact, fault);
    session->scene->watch = NULL; /* what is begun now is done in no time, and not to be stopped */
    if (!err)
        err = live_finish_take(session, &exact, fault);
    session->scene->watch = former;
    return err;
}

void session_show_refining(struct session *session, void (*draw)(void *context), void *context)
{
    struct watch *const watch = session->scene->watch;
    session->scene->watch = NULL;
    draw(context);
    session->scene->watch = watch;
}
