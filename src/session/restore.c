#include "session/session_parts.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

/* ---- lists ---- */

void session_settle_lists(struct session *session)
{
    struct former_lists *former = &session->former_lists;
    free(former->pending);
    eliminators_release(&former->eliminators);
    *former = (struct former_lists){0};
}

void session_take_back_lists(struct session *session)
{
    const struct former_lists former = session->former_lists;
    if (!former.replaced)
        return;
    free(session->pending);
    eliminators_release(&session->eliminators);
    session->pending = former.pending;
    session->pendings = former.pendings;
    session->pending_capacity = former.pending_capacity;
    session->eliminators = former.eliminators;
    session->former_lists = (struct former_lists){0};
}

static void take_lists(struct session *session, struct state *state)
{
    session_settle_lists(session);
    session->former_lists = (struct former_lists){true, session->pending, session->pendings,
                                                  session->pending_capacity, session->eliminators};
    session->pending = state->pending;
    session->pendings = session->pending_capacity = state->pendings;
    session->eliminators = (struct eliminators){.cell = state->eliminator,
                                                .capacity = state->eliminators,
                                                .waiting = state->waiting,
                                                .end = state->eliminators};
    state->pending = NULL;
    state->eliminator = NULL;
}

/* ---- what the forest grows under ---- */

/* Whether arcs weigh otherwise under `a` than under `b`, files apart. */
static bool weighs_otherwise(const struct settings *a, const struct settings *b)
{
    return a->adjacency != b->adjacency || !weight_choice_equals(&a->weight, &b->weight) ||
           (a->weight.kind == WEIGHT_POLARITY &&
            memcmp(a->polarity, b->polarity, sizeof a->polarity) != 0);
}

static bool roi_differs(const struct settings *a, const struct settings *b)
{
    return a->has_range != b->has_range ||
           memcmp(a->range_thousandths, b->range_thousandths, sizeof a->range_thousandths) != 0;
}

static struct roi roi_of(const struct session *session, const struct settings *settings,
                         const struct state *state)
{
    struct roi roi = roi_none();
    roi.mask = state->has_mask ? state->mask : session->roi.mask;
    if (settings->has_range)
        roi_range(&roi, &session->geometry, settings->range_thousandths);
    return roi;
}

/* The weights that the settings say, which are the session's by now. */
static enum err weigh_again(struct session *session, const struct state *state, struct fault *fault)
{
    session->weighed_again = true;
    forest_set_adjacency(session->forest, session->settings.adjacency);
    if (state->has_weights) {
        session->read_weights = true;
        weight_fill(session->scene, state->weight);
    }
    return session_weigh(session, fault);
}

/* Seeds and what they grow under, both at once: the forest is computed again, once. The seeds are
 * changed while there is no region of interest, since those that go may lie outside the coming one, and those
 * that come outside the present one. */
static enum err replant(struct session *session, struct state *state, bool weighs,
                        struct fault *fault)
{
    const struct roi open = roi_none();
    const struct roi roi = roi_of(session, &session->settings, state);
    state->mask = NULL;
    session->replanted = session->rebuilt_forest = session->roi_changed = true;
    forest_suspend(session->forest);
    roi_apply(&open, session->scene);
    session->roi = roi;
    enum err err = session_edit(session, state->seed, state->seeds, fault);
    if (err)
        return err;
    session->roi_tally = roi_tally(&roi, session->scene);
    roi_apply(&roi, session->scene);
    if (weighs)
        err = weigh_again(session, state, fault);
    return err || session->skims ? err : session_rebuild(session, true, fault);
}

/* ---- the whole ---- */

/* Room and copies first: from then on only the watch or the forest can stop it. */
static enum err make_ready(struct session *session, const struct settings *settings,
                           const struct state *state, bool weighs, struct fault *fault)
{
    enum err err = OK;
    if (weighs && !state->has_weights)
        err = weight_work_reserve(&session->weight_work, &session->scene->grid, &settings->weight,
                                  fault);
    if (!err && weighs && (state->has_weights || weight_is_gradient(settings->weight.kind)))
        err = session_keep_weights(session, fault);
    return err;
}

static enum err restore(struct session *session, struct state *state, struct fault *fault)
{
    const struct settings *settings = state->settings, former = session->settings;
    const bool weighs = state->has_weights || weighs_otherwise(settings, &former);
    enum err err = make_ready(session, settings, state, weighs, fault);
    if (err)
        return err;
    memcpy((char *)&session->settings + SETTINGS_KEPT, (const char *)settings + SETTINGS_KEPT,
           sizeof *settings - SETTINGS_KEPT);
    take_lists(session, state);
    if (weighs || state->has_mask || roi_differs(settings, &former))
        err = replant(session, state, weighs, fault);
    else if (state->seeds)
        err = session_edit(session, state->seed, state->seeds, fault);
    if (err)
        return err;
    if (memcmp(settings->visible, former.visible, sizeof former.visible) != 0 ||
        memcmp(&settings->cut, &former.cut, sizeof former.cut) != 0) {
        memcpy(session->border.visible, settings->visible, sizeof settings->visible);
        session->border.cut = settings->cut;
        session_recount(session);
    }
    if (memcmp(&settings->palette, &former.palette, sizeof former.palette) != 0)
        session->rendered = false;
    return watch_fault(session->watch, fault);
}

enum err session_restore(struct session *session, struct state *state, struct fault *fault)
{
    const enum err err = restore(session, state, fault);
    free(state->pending); /* those that the session has not taken */
    free(state->eliminator);
    free(state->mask);
    return err;
}

/* ---- many at once ---- */

void session_skim(struct session *session)
{
    session->skims = true;
    session->rendered = false;
    forest_suspend(session->forest);
}

enum err session_catch_up(struct session *session, struct fault *fault)
{
    enum err err = OK;
    session->skims = false;
    if (session->weighs_later)
        err = session_weigh(session, fault);
    return err ? err : session_rebuild(session, true, fault);
}
