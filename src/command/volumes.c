/* What an edit has done to the labels, in a line for the user. */
#include "command/act.h"

#include "image/geometry.h"
#include "report/surprise.h"
#include "session/tally.h"

enum { LISTED_MOST = 6 };

/* The labels whose number of voxels has changed, the largest first; of equals, the lower number. */
static unsigned changed_labels(const struct session *session, uint8_t label[255])
{
    unsigned count = 0;
    for (unsigned l = 1; l < 256; l++) {
        const uint64_t voxels = session_tally(session)->voxels[l];
        if (voxels == session_former_tally(session)->voxels[l])
            continue;
        unsigned at = count++;
        for (; at > 0 && session_tally(session)->voxels[label[at - 1]] < voxels; at--)
            label[at] = label[at - 1];
        label[at] = (uint8_t)l;
    }
    return count;
}

void volumes_write(struct buf *out, const struct session *session, uint64_t took_ns)
{
    uint8_t label[255];
    const unsigned count = changed_labels(session, label);
    const double ms = (double)took_ns / 1e6;
    const uint64_t changed = session_changed_voxels(session);
    if (changed == CHANGES_UNKNOWN)
        buf_add_text(out, "computed anew");
    else if (changed == 0)
        buf_add_text(out, "no label has changed");
    else
        buf_printf(out, "%llu voxel%s changed", (unsigned long long)changed, plural(changed));
    for (unsigned i = 0; i < count && i < LISTED_MOST; i++) {
        buf_add_text(out, ", label ");
        label_report_write_name(out, session, label[i]);
        buf_add_text(out, ": ");
        label_report_write_volume(out, session, label[i],
                                  session_former_tally(session)->voxels[label[i]]);
    }
    if (count > LISTED_MOST)
        buf_printf(out, ", %u more label%s", count - LISTED_MOST, plural(count - LISTED_MOST));
    if (ms < 10000)
        buf_printf(out, ", %.1f ms\n", ms);
    else
        buf_printf(out, ", %.1f s\n", ms / 1000);
}

void surprise_write(struct buf *out, const struct session *session, const char *command)
{
    struct surprise surprise;
    if (!session_find_surprise(&surprise, session))
        return;
    if (command)
        buf_printf(out, "this `%s` took ", command);
    else
        buf_add_text(out, "what waited took ");
    label_report_write_extent(out, session, surprise.voxels);
    buf_add_text(out, " of label ");
    label_report_write_name(out, session, surprise.label);
    if (surprise.has_passage)
        buf_printf(out, " through %u,%u,%u", surprise.passage[0], surprise.passage[1],
                   surprise.passage[2]);
    buf_add_text(out, "; undo takes it back\n");
}
