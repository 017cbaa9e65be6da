/* SPDX-License-Identifier: MIT */
#include "show/label_loss.h"

#include <stdlib.h>

#include "base/mem.h"
#include "engine/components.h"
#include "engine/label_stats.h"
#include "engine/roi.h"
#include "engine/way.h"
#include "session/markers.h"
#include "session/tally.h"
#include "show/label_report.h"

/* Count the labels with voxels that a seed reached: of label 0, voxels inside the region of
 * interest count. */
static unsigned labels_before(const struct session *session)
{
    const uint64_t *voxels = session->former_tally.voxels;
    const size_t outside = session->scene->grid.voxels - session->roi_tally.inside;
    unsigned count = voxels[0] > outside;
    for (unsigned label = 1; label < 256; label++)
        count += voxels[label] > 0;
    return count;
}

/* The label with the largest increase from `in` to `than`. */
static unsigned find_most(const uint64_t *in, const uint64_t *than)
{
    unsigned found = 0;
    int64_t most = INT64_MIN;
    for (unsigned label = 0; label < 256; label++) {
        const int64_t more = (int64_t)than[label] - (int64_t)in[label];
        found = more > most ? label : found;
        most = more > most ? more : most;
    }
    return found;
}

/* Count the seeds of a label that the edit planted. */
static uint64_t planted_of(const struct seed_changes *seeds, unsigned label)
{
    uint64_t count = 0;
    for (size_t i = 0; i < seeds->count; i++)
        count += seeds->after[i].label == (int16_t)label;
    return count;
}

/* Count the seeds of its markers before the edit, at least one. */
static uint64_t seeds_before(const struct session *session, unsigned label, uint64_t planted)
{
    const struct markers *markers = &session->markers;
    uint64_t count = 0;
    for (size_t m = 0; m < markers->count; m++)
        if (markers->marker[m].is_valid && markers->marker[m].label == (int16_t)label)
            count += markers->marker[m].voxels;
    return count > planted ? count - planted : 1;
}

/* True if new and old voxels of a label have similar intensities in the first channel: means within
 * half a standard deviation. False if that is unknown. */
static bool is_alike(struct session *session, unsigned label)
{
    const struct changes changes = forest_changes(session->forest);
    struct scene *scene = session->scene;
    struct label_sums sums;
    uint64_t count = 0, intensity = 0, squares = 0;
    if (changes.everything || label == 0 || session_sum_label(session, label, &sums, NULL))
        return false;
    if (scene->shown)
        sums.intensity = sums.intensity_squares = 0;
    for (struct grid_walk w = scene_walk(scene, "intensities", NULL, 0);
         scene->shown && grid_walk_next(&w);)
        for (uint32_t c = w.row.first; c < w.row.end; c++) {
            const uint64_t is = scene->cell[c].label == label ? scene_intensity(scene, 0, c) : 0;
            sums.intensity += is, sums.intensity_squares += is * is;
        }
    for (size_t i = 0; i < changes.count; i++)
        if (changes.item[i].label == label) {
            const uint64_t is = scene_intensity(scene, 0, changes.item[i].cell);
            count++, intensity += is, squares += is * is;
        }
    if (count == 0 || sums.voxels <= count)
        return false;
    const double rest = (double)(sums.voxels - count);
    const double mean = (double)(sums.intensity - intensity) / rest;
    const double variance = (double)(sums.intensity_squares - squares) / rest - mean * mean;
    const double away = (double)intensity / (double)count - mean;
    return 4 * away * away <= (variance > 0 ? variance : 0);
}

bool session_find_surprise(struct surprise *surprise, struct session *session)
{
    const struct tally *before = &session->former_tally, *now = &session->tally;
    const unsigned loser = find_most(now->voxels, before->voxels);
    const unsigned winner = find_most(before->voxels, now->voxels);
    const uint64_t lost = before->voxels[loser] - now->voxels[loser];
    const uint64_t had = before->voxels[winner];
    uint32_t cell;
    if (!session->has_edited || before->stale || now->stale || lost <= SURPRISE_VOXELS ||
        labels_before(session) <= 1)
        return false;
    const struct seed_changes seeds = forest_seed_changes(session->forest);
    const uint64_t planted = planted_of(&seeds, winner), count = seeds.count;
    if (had == 0 ? lost / SURPRISE_TIMES <= count || lost < before->voxels[loser] / SURPRISE_SHARE
                 : SURPRISE_TIMES * lost <= had * count)
        return false;
    if (had && planted && 2 * lost * seeds_before(session, winner, planted) < 3 * had * count &&
        is_alike(session, winner))
        return false;
    *surprise = (struct surprise){.label = (uint8_t)loser, .voxels = lost};
    surprise->has_passage = passage_find(&cell, session->forest, loser);
    if (surprise->has_passage)
        grid_find(&session->scene->grid, cell, surprise->passage);
    return true;
}

static enum err find_extents(struct label_extent extent[256], const struct grid *grid,
                             const uint8_t *label, struct watch *watch, struct fault *fault)
{
    OWNED(components_release) struct components components = {0};
    TRY(components_find(&components, grid, label, watch, fault));
    for (size_t i = 0; i < components.count; i++) {
        extent[components.item[i].label].voxels += components.item[i].voxels;
        extent[components.item[i].label].pieces++;
    }
    return OK;
}

/* True if all voxels within LABEL_LOSS_FAR steps have the same label. */
static bool is_far(const struct grid *grid, const uint8_t *label, uint32_t cell)
{
    const struct place p = grid_place(grid, cell);
    for (int z = -LABEL_LOSS_FAR; z <= LABEL_LOSS_FAR; z++)
        for (int y = abs(z) - LABEL_LOSS_FAR; y <= LABEL_LOSS_FAR - abs(z); y++)
            for (int x = abs(z) + abs(y) - LABEL_LOSS_FAR; x <= LABEL_LOSS_FAR - abs(z) - abs(y);
                 x++)
                if (grid_contains(grid, (int64_t)p.x + x, (int64_t)p.y + y, (int64_t)p.z + z) &&
                    label[cell + (uint32_t)(x + y * grid->step[1] + z * grid->step[2])] !=
                        label[cell])
                    return false;
    return true;
}

enum err label_loss_find(struct label_loss *loss, const struct labels *finished, struct team *team,
                         struct watch *watch, struct fault *fault)
{
    const struct grid *grid = &finished->scene->grid;
    const struct labels forest = labels_of_forest(finished->scene);
    OWNED(mem_release) uint8_t *label = mem_array(grid->cells, 1);
    *loss = (struct label_loss){.labels = 0};
    if (!label)
        return fault_memory(fault, "labels before the finish");
    labels_copy(&forest, label, team);
    TRY(watch_fault(watch, fault));
    TRY(find_extents(loss->before, grid, label, watch, fault));
    TRY(find_extents(loss->after, grid, finished->finished, watch, fault));
    for (uint32_t c = 0; c < grid->cells; c++)
        loss->far += label[c] != finished->finished[c] && is_far(grid, label, c);
    for (unsigned l = 1; l < 256; l++) {
        const struct label_extent *before = &loss->before[l], *after = &loss->after[l];
        loss->is_lost[l] = before->voxels &&
                           (2 * after->voxels < before->voxels || after->pieces > before->pieces);
        loss->labels += loss->is_lost[l];
    }
    return OK;
}

static void write_extent(struct buf *out, const struct label_extent *extent)
{
    buf_printf(out, "%llu voxel%s", (unsigned long long)extent->voxels, plural(extent->voxels));
    if (extent->voxels)
        buf_printf(out, " in %u piece%s", extent->pieces, plural(extent->pieces));
}

/* Write "deletes label 3 wall", up to the name. */
static void write_verb(struct buf *out, const struct session *session,
                       const struct label_loss *loss, unsigned label)
{
    const struct label_extent *before = &loss->before[label], *after = &loss->after[label];
    buf_add_text(out, !after->voxels                       ? "deletes label "
                      : 2 * after->voxels < before->voxels ? "reduces label "
                                                           : "breaks label ");
    label_report_write_name(out, session, label);
}

void label_loss_write_line(struct buf *out, const struct session *session,
                           const struct label_loss *loss)
{
    const char *between = "the finish ";
    for (unsigned l = 1; l < 256; l++) {
        if (!loss->is_lost[l])
            continue;
        buf_add_text(out, between);
        write_verb(out, session, loss, l);
        between = ", ";
        if (loss->after[l].voxels) {
            buf_add_text(out, " to ");
            write_extent(out, &loss->after[l]);
        }
    }
    if (loss->labels)
        buf_add_text(out, "; see `stats`\n");
}

void label_loss_write(struct buf *out, const struct session *session, const struct label_loss *loss)
{
    for (unsigned l = 1; l < 256; l++) {
        if (!loss->is_lost[l])
            continue;
        buf_add_text(out, "the finish ");
        write_verb(out, session, loss, l);
        buf_add_text(out, ": ");
        write_extent(out, &loss->before[l]);
        buf_add_text(out, " before, ");
        write_extent(out, &loss->after[l]);
        buf_add_text(out, " after\n");
    }
    if (loss->far)
        buf_printf(out, "the finish changes %llu voxel%s more than %d voxels from any border\n",
                   (unsigned long long)loss->far, plural(loss->far), LABEL_LOSS_FAR);
    if (loss->labels || loss->far)
        buf_add_text(out, "`finish` lists the steps; `finish none` removes them, and `finish STEP "
                          "label=LABEL` adds one for a single label\n");
}
