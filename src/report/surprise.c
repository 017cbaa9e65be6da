#include "report/surprise.h"

#include "engine/roi.h"
#include "engine/way.h"
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

bool session_find_surprise(struct surprise *surprise, const struct session *session)
{
    const struct tally *before = session_former_tally(session), *now = session_tally(session);
    const unsigned loser = find_most(now->voxels, before->voxels);
    const uint64_t had = before->voxels[loser], lost = had - now->voxels[loser];
    const uint64_t gained_by = before->voxels[find_most(before->voxels, now->voxels)];
    const uint64_t least = gained_by && gained_by < had ? gained_by : had;
    uint32_t cell;
    if (!session_has_edited(session) || before->stale || now->stale)
        return false;
    const uint64_t seeds = forest_seed_changes(session_forest(session)).count;
    if (lost <= SURPRISE_VOXELS || lost / SURPRISE_TIMES <= seeds ||
        lost < least / SURPRISE_SHARE || labels_before(session) <= 1)
        return false;
    *surprise = (struct surprise){.label = (uint8_t)loser, .voxels = lost};
    surprise->has_passage = passage_find(&cell, session_forest(session), loser);
    if (surprise->has_passage)
        grid_find(&session_scene(session)->grid, cell, surprise->passage);
    return true;
}
