/* What is measured of the labels of a session: asked for, and kept from then on. */
#include "session/session_inside.h"

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

/* ---- what the last edit changed ---- */

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
