/* SPDX-License-Identifier: MIT */
/*
 * What labels come to have: counted, finished, measured and hinted when somebody asks, and stored
 * until the labels are others. An edit does nothing for them that takes time worth mentioning.
 */
#include "session/session.h"
#include "session/session_inside.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/mem.h"
#include "engine/margin.h"

/* ---- voxels ---- */

enum err session_count_labels(struct session *session, struct fault *fault)
{
    const struct labels labels = labels_of_forest(session->scene);
    return tally_refresh(&session->tally, &labels, session->team)
               ? OK
               : watch_fault(session->scene->watch, fault);
}

enum err session_count_before(struct session *session, struct fault *fault)
{
    forest_count_anew(session->forest);
    enum err err = session_count_labels(session, fault);
    session->former_tally = session->tally;
    return err;
}

/* A forest that grew from nothing had label 0 everywhere. */
uint64_t session_changed_voxels(const struct session *session)
{
    const uint64_t background = session->tally.voxels[0], all = session->scene->grid.voxels;
    const uint64_t changed = forest_changes(session->forest).voxels;
    const bool had_none = session->former_tally.voxels[0] == all;
    return changed == CHANGES_UNKNOWN && had_none ? all - background : changed;
}

static bool has_edited(const struct session *session)
{
    return session->edited || session->regrown;
}

void session_note_edit(struct session *session)
{
    if (has_edited(session))
        session->tally_before_edit = session->former_tally;
}

const uint64_t *session_voxels_before_edit(const struct session *session)
{
    const struct tally *before =
        has_edited(session) ? &session->former_tally : &session->tally_before_edit;
    return before->stale || session->tally.stale ? NULL : before->voxels;
}

/* ---- intensities ---- */

void session_find_window(struct session *session, int32_t window[2])
{
    static uint32_t count[UINT16_MAX + 1];
    if (!session->knows_window) {
        intensities_count(count, session->scene, session->team);
        intensities_range(session->window, count, WINDOW_BLACK, WINDOW_WHITE);
    }
    session->knows_window = true;
    memcpy(window, session->window, sizeof session->window);
}

/* ---- finished labels ---- */

void finished_release(struct finished *finished)
{
    mem_pages_free(finished->label, finished->cells);
    *finished = (struct finished){0};
}

uint64_t session_finish_source(const struct session *session)
{
    const uint32_t *size = session->scene->grid.size;
    const struct finish_list *by = &session->now.kept.finish;
    const uint64_t keys = finish_heeds_seeds(by) ? forest_digest(session->forest) : 0;
    const uint64_t roi = finish_heeds_seeds(by) ? session->roi_tally.digest : 0;
    uint64_t mix = hash_mix_at(forest_label_digest(session->forest), keys);
    mix = hash_mix_at(hash_mix_at(mix, roi), (uint64_t)size[0] << 32 | size[1]);
    mix = hash_mix_at(mix, size[2]);
    for (size_t i = 0; i < sizeof *by; i++)
        mix = hash_mix_at(mix, ((const uint8_t *)by)[i]);
    return mix | 1;
}

const uint8_t *session_finished(const struct session *session)
{
    const struct finished *made = &session->finished;
    return made->label && made->of == session_finish_source(session) ? made->label : NULL;
}

static enum err make_finished(struct session *session, struct fault *fault)
{
    struct finished made = {.cells = session->scene->grid.cells,
                            .of = session_finish_source(session)};
    enum err err = finish_make_again(&made.label, &session->now.kept.finish, session->scene,
                                     session->team, &session->relaxed, fault);
    if (err)
        return err;
    made.digest = labels_digest(&(struct labels){session->scene, made.label}, session->team);
    err = watch_fault(session->scene->watch, fault);
    if (err) {
        finished_release(&made);
        return err;
    }
    finished_release(&session->finished);
    session->finished = made;
    return OK;
}

enum err session_labels(struct session *session, bool finished, struct labels *labels,
                        struct fault *fault)
{
    *labels = labels_of_forest(session->scene);
    if (!finished || !session->now.kept.finish.count)
        return OK;
    const enum err err = session_finished(session) ? OK : make_finished(session, fault);
    labels->finished = session->finished.label;
    return err;
}

uint64_t session_finished_digest(const struct session *session)
{
    return session->now.kept.finish.count ? session->finished.digest
                                          : forest_label_digest(session->forest);
}

/* ---- measures ---- */

enum err session_find_stats(struct session *session, const struct labels *labels,
                            struct label_stats *stats, struct fault *fault)
{
    struct label_measures once = {0};
    struct label_measures *measures = labels->finished ? &once : &session->measures;
    const enum err err = label_stats_find(stats, measures, labels, session->team, fault);
    label_measures_release(&once);
    return err;
}

enum err session_sum_label(struct session *session, unsigned label, struct label_sums *sums,
                           struct fault *fault)
{
    const struct labels labels = labels_of_forest(session->scene);
    return label_measures_sum(&session->measures, &labels, label, session->team, sums, fault);
}

/* ---- against a procedure ---- */

enum err session_find_worst(struct session *session, unsigned *label, double *share,
                            struct fault *fault)
{
    const uint32_t *expected = session->now.kept.origin_mm3;
    const double voxel_mm3 = tally_voxel_mm3(session_geometry(session));
    const enum err err = session_count_labels(session, fault);
    double worst = 0;
    *label = 0;
    *share = 1;
    for (unsigned l = 1; !err && l < 256; l++) {
        const double now = (double)session->tally.voxels[l] * voxel_mm3 / (expected[l] + 1.0);
        const double off = now > 1 ? now : 1 / (now + 1e-9);
        if (!expected[l] || off <= worst)
            continue;
        *label = l;
        *share = now;
        worst = off;
    }
    return err;
}

/* Places at the border of the worst label come before others; each kind in its order. */
static enum err put_worst_first(struct hint_list *hints, struct session *session,
                                struct fault *fault)
{
    unsigned worst;
    double share;
    const enum err err = session_find_worst(session, &worst, &share, fault);
    size_t first = 0;
    for (size_t i = 0; !err && worst && i < hints->count; i++) {
        const struct hint hint = hints->item[i];
        if (hint.label != worst && hint.other != worst)
            continue;
        memmove(hints->item + first + 1, hints->item + first, (i - first) * sizeof hint);
        hints->item[first++] = hint;
    }
    return err;
}

/* ---- hints ---- */

void hinting_release(struct hinting *hinting)
{
    hints_release(&hinting->hints);
    free(hinting->heat);
    *hinting = (struct hinting){0};
}

static uint64_t digest_of_origin(const uint32_t mm3[256])
{
    uint64_t mix = 0;
    for (unsigned l = 0; l < 256; l++)
        mix = hash_mix_at(mix, mm3[l]);
    return mix;
}

/* Lets go of what is of another forest. */
static void keep_up_hints(struct session *session)
{
    struct hinting *h = &session->hinting;
    const struct hinting now = {.cells = session->scene->grid.cells,
                                .forest = forest_digest(session->forest),
                                .labels = forest_label_digest(session->forest),
                                .weights = session->weight_digest,
                                .adjacency = session->now.kept.adjacency,
                                .origin = digest_of_origin(session->now.kept.origin_mm3)};
    if (h->cells == now.cells && h->forest == now.forest && h->labels == now.labels &&
        h->weights == now.weights && h->adjacency == now.adjacency && h->origin == now.origin)
        return;
    hinting_release(h);
    *h = now;
}

static enum err make_hints(struct session *session, bool with_heat, struct fault *fault)
{
    struct hinting *h = &session->hinting;
    uint16_t *margin;
    enum err err = margin_new(&margin, session->forest, fault);
    if (!err && with_heat && !(h->heat = mem_new(h->cells)))
        err = fault_memory(fault, "the heat");
    if (!err)
        err = hints_find(&h->hints, session->forest, margin, h->heat, fault);
    if (!err)
        err = put_worst_first(&h->hints, session, fault);
    free(margin);
    h->has_hints = err == OK;
    if (err)
        hinting_release(h);
    return err;
}

enum err session_find_hints(struct session *session, const struct hint_list **hints,
                            const uint8_t **heat, struct fault *fault)
{
    struct hinting *h = &session->hinting;
    keep_up_hints(session);
    const bool is_made = h->has_hints && (!heat || h->heat);
    const enum err err = is_made ? OK : make_hints(session, heat != NULL, fault);
    *hints = &h->hints;
    if (heat)
        *heat = h->heat;
    return err;
}
