/* SPDX-License-Identifier: MIT */
#include "show/outline_facts.h"

#include "show/label_report.h"
#include "show/voxel_facts.h"
#include "session/doubtful.h"
#include "show/draw.h"

enum { CORNERS_LEAST = 3 };

/* In the slice, and around the place or near it. */
static bool is_near(const struct polyline *line, unsigned axis, const uint32_t place[3])
{
    for (unsigned a = 0; a < 3; a++) {
        int64_t first = INT64_MAX, last = -1;
        const int64_t near = a == axis ? 0 : OUTLINE_FACTS_NEAR;
        for (size_t i = 0; i < line->count; i++) {
            first = line->corner[i][a] < first ? line->corner[i][a] : first;
            last = line->corner[i][a] > last ? line->corner[i][a] : last;
        }
        if (place[a] < first - near || place[a] > last + near)
            return false;
    }
    return line->count >= CORNERS_LEAST;
}

/* Whether a voxel of a marker lies in the slice: else no contour of it does. */
static bool begins_in(const struct session *session, const struct marker *marker, unsigned axis,
                      const uint32_t place[3])
{
    uint32_t first[3];
    grid_find(&session_scene(session)->grid, session_markers(session)->cover[marker->first].cell,
              first);
    return first[axis] == place[axis];
}

/* The latest marker's, or 0. */
static uint32_t find_marker(struct polyline *line, const struct session *session, unsigned label,
                            unsigned axis, const uint32_t place[3])
{
    const struct markers *markers = session_markers(session);
    for (uint32_t number = (uint32_t)markers->count; number > 0; number--) {
        const struct marker *marker = markers->marker + number - 1;
        line->count = 0;
        if (marker->stands && !marker->joined && marker->label == (int)label && marker->voxels &&
            begins_in(session, marker, axis, place) &&
            contour_of_marker(line, &session_scene(session)->grid, markers, number, NULL) == OK &&
            is_near(line, axis, place))
            return number;
    }
    line->count = 0;
    return 0;
}

bool outline_facts_find(struct polyline *line, uint32_t *marker, struct session *session,
                        unsigned label, unsigned axis, const uint32_t place[3], struct buf *out)
{
    struct labels labels;
    *marker = find_marker(line, session, label, axis, place);
    if (*marker) {
        buf_printf(out, "the outline of marker %u", *marker);
        return true;
    }
    const bool found =
        session_labels(session, session_shows_finished(session), &labels, NULL) == OK &&
        contour_of_label(line, &labels, label, axis, place, NULL) == OK &&
        line->count >= CORNERS_LEAST;
    buf_add_text(out, found ? "the border of label " : "in this slice there is nothing of label ");
    label_report_write_name(out, session, label);
    return found;
}

bool outline_facts_next(unsigned *axis, uint32_t place[3], struct session *session, unsigned label,
                        size_t rank, struct buf *out)
{
    struct doubtful_slice slice[DOUBTFUL_MOST];
    struct labels labels;
    struct fault why;
    size_t count = 0;
    if (label == 0) {
        buf_add_text(out, "the background has no outline: choose a label first");
        return false;
    }
    enum err err = doubtful_find(slice, &count, session, label, &why);
    if (!err)
        err = session_labels(session, session_shows_finished(session), &labels, &why);
    if (err) {
        buf_add_text(out, why.text);
        return false;
    }
    if (rank > count || !doubtful_place(place, &labels, label, &slice[rank - 1])) {
        buf_printf(out, "no%s slice has anything in doubt of label ", rank > 1 ? " further" : "");
        label_report_write_name(out, session, label);
        return false;
    }
    *axis = slice[rank - 1].axis;
    voxel_facts_write_doubt(out, session, &slice[rank - 1]);
    return true;
}
