/* SPDX-License-Identifier: MIT */
#include "show/surprise.h"

#include "engine/label_stats.h"
#include "engine/roi.h"
#include "engine/way.h"
#include "session/markers.h"
#include "session/tally.h"

/* How many labels had voxels that a seed reached: of label 0 these are more than what lies outside
 * the region of interest. */
static unsigned labels_before(const struct session *session)
{
    const uint64_t *voxels = session_former_tally(session)->voxels;
    const size_t outside = session_scene(session)->grid.voxels - session_roi_tally(session)->inside;
    unsigned count = voxels[0] > outside;
    for (unsigned label = 1; label < 256; label++)
        count += voxels[label] > 0;
    return count;
}

/* The label of which there are most voxels more in `than`. */
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

/* How many seeds an edit has planted of a label. */
static uint64_t planted_of(const struct seed_changes *seeds, unsigned label)
{
    uint64_t count = 0;
    for (size_t i = 0; i < seeds->count; i++)
        count += seeds->after[i].label == (int16_t)label;
    return count;
}

/* How many its markers had before, one at least. */
static uint64_t seeds_before(const struct session *session, unsigned label, uint64_t planted)
{
    const struct markers *markers = session_markers(session);
    uint64_t count = 0;
    for (size_t m = 0; m < markers->count; m++)
        if (markers->marker[m].stands && markers->marker[m].label == (int16_t)label)
            count += markers->marker[m].voxels;
    return count > planted ? count - planted : 1;
}

/* Whether the intensities that a label has come to are like those that it had: their means are no
 * more than half a deviation apart. Where that is not known, they are not. */
static bool is_alike(struct session *session, unsigned label)
{
    const struct changes changes = forest_changes(session_forest(session));
    const struct cell *cell = session_scene(session)->cell;
    struct label_sums sums;
    uint64_t count = 0, intensity = 0, squares = 0;
    if (changes.everything || label == 0 || session_sum_label(session, label, &sums, NULL))
        return false;
    for (size_t i = 0; i < changes.count; i++)
        if (changes.item[i].label == label) {
            const uint64_t is = cell[changes.item[i].cell].intensity;
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
    const struct tally *before = session_former_tally(session), *now = session_tally(session);
    const unsigned loser = find_most(now->voxels, before->voxels);
    const unsigned winner = find_most(before->voxels, now->voxels);
    const uint64_t lost = before->voxels[loser] - now->voxels[loser];
    const uint64_t had = before->voxels[winner];
    uint32_t cell;
    if (!session_has_edited(session) || before->stale || now->stale || lost <= SURPRISE_VOXELS ||
        labels_before(session) <= 1)
        return false;
    const struct seed_changes seeds = forest_seed_changes(session_forest(session));
    const uint64_t planted = planted_of(&seeds, winner), count = seeds.count;
    if (had == 0 ? lost / SURPRISE_TIMES <= count || lost < before->voxels[loser] / SURPRISE_SHARE
                 : SURPRISE_TIMES * lost <= had * count)
        return false;
    if (had && planted && 2 * lost * seeds_before(session, winner, planted) < 3 * had * count &&
        is_alike(session, winner))
        return false;
    *surprise = (struct surprise){.label = (uint8_t)loser, .voxels = lost};
    surprise->has_passage = passage_find(&cell, session_forest(session), loser);
    if (surprise->has_passage)
        grid_find(&session_scene(session)->grid, cell, surprise->passage);
    return true;
}
