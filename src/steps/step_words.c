/* SPDX-License-Identifier: MIT */
#include "steps/step_words.h"

#include <string.h>

#include "command/command.h"
#include "show/label_report.h"
#include "session/tally.h"

void step_words_title(struct buf *out, const struct walkthrough *w, size_t step)
{
    const struct step *s = walkthrough_step(w, step);
    if (!s) {
        buf_printf(out, "the beginning, before step 1 of %zu", w->list.count);
        return;
    }
    const char *command = w->list.text.data + s->command;
    buf_printf(out, "step %zu of %zu, record %zu: ", step, w->list.count, s->record);
    buf_add_safe_excerpt(out, command, strlen(command));
    if (s->fate == STEP_UNDONE)
        buf_add_text(out, "  (undone later)");
    else if (s->fate == STEP_ELSEWHERE)
        buf_add_text(out, "  (on another alternative)");
}

void step_words_volume(struct buf *out, const struct walkthrough *w, uint64_t voxels)
{
    const struct session *session = w->interp->session;
    if (session_scene(session)->spacing_unknown)
        buf_printf(out, "%llu voxel%s", (unsigned long long)voxels, plural(voxels));
    else
        tally_write_volume(out, session_geometry(session), voxels);
}

void step_words_change(struct buf *out, const struct walkthrough *w, size_t step)
{
    enum { LABELS_MOST = 6 };
    const struct step_seen *seen = walkthrough_seen(w, step);
    if (!seen)
        return;
    const struct history *history = &w->interp->history;
    const bool is_there = seen->after < history->points;
    const size_t waits = is_there ? edits_count(&history->point[seen->after].lists.pending) : 0;
    for (size_t i = 0; i < seen->changes && i < LABELS_MOST; i++) {
        const struct step_change *change = w->change + seen->change + i;
        buf_add_text(out, i ? ", " : "");
        label_report_write_name(out, w->interp->session, change->label);
        buf_add_text(out, change->voxels > 0 ? " +" : " -");
        step_words_volume(out, w,
                          (uint64_t)(change->voxels > 0 ? change->voxels : -change->voxels));
    }
    if (seen->changes > LABELS_MOST)
        buf_printf(out, ", and %zu labels more", seen->changes - LABELS_MOST);
    if (seen->changed)
        buf_printf(out, "%s%llu voxel%s changed", seen->changes ? "; " : "",
                   (unsigned long long)seen->changed, plural(seen->changed));
    else if (!waits)
        buf_add_text(out, "no voxel has another label");
    if (waits)
        buf_printf(out, "%s%zu edit%s for a run", seen->changed ? "; " : "", waits,
                   waits == 1 ? " waits" : "s wait");
}

void step_words_comments(struct buf *out, const struct walkthrough *w, size_t step)
{
    const struct step *s = walkthrough_step(w, step);
    const char *at = s ? w->list.text.data + s->comments : "";
    while (*at) {
        const size_t n = strcspn(at, "\n");
        buf_add_safe(out, at, n);
        buf_add_char(out, '\n');
        at += n + (at[n] == '\n');
    }
}

void step_words_verdict(struct buf *out, const struct walkthrough *w)
{
    const struct replay_report *r = &w->report;
    if (!w->has_ended) {
        buf_printf(out, "not verified yet: %zu of %zu records carried out", r->executed,
                   w->list.records);
        return;
    }
    if (w->ended) {
        buf_add_text(out, "NOT verified: ");
        buf_add_text(out, w->why.text);
        return;
    }
    buf_printf(out, "verified: %zu command%s carried out again, %zu result%s the same", r->executed,
               plural(r->executed), r->compared, plural(r->compared));
    if (r->is_torn)
        buf_add_text(out, "; an unfinished record at the end was left alone");
}
