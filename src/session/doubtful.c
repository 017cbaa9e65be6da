/* SPDX-License-Identifier: MIT */
#include "session/doubtful.h"
#include "session/session_inside.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/mem.h"
#include "session/contour.h"

void doubting_release(struct doubting *doubting)
{
    doubt_release(&doubting->doubt);
    *doubting = (struct doubting){0};
}

/* Doubt of the present labels, as it was or made anew. */
static enum err keep_up(struct session *session, unsigned label, struct fault *fault)
{
    struct doubting *d = &session->doubting;
    const uint64_t of = hash_mix_at(hash_mix_at(session_finish_source(session), label),
                                    forest_digest(session->forest) ^ session->roi_tally.digest);
    if (d->doubt.all && d->of == of)
        return OK;
    doubting_release(d);
    d->of = of;
    return doubt_find(&d->doubt, &session->now.kept.finish, session->scene, session->team, label,
                      fault);
}

/* ---- the slices ---- */

/* Slices from..to of an axis are left out. */
static void leave_out(struct doubt *doubt, unsigned axis, int64_t from, int64_t to)
{
    for (int64_t at = from < 0 ? 0 : from; at <= to && at < doubt->size[axis]; at++)
        doubt->slice[axis][at] = 0;
}

static void leave_out_outlined(struct doubt *doubt, const struct session *session, unsigned label)
{
    const struct markers *markers = &session->markers;
    for (uint32_t n = 1, at; n <= markers->count; n++) {
        const struct marker *marker = &markers->marker[n - 1];
        unsigned axis;
        if (marker->stands && marker->label > 0 &&
            (marker->label == (int)label || label == FINISH_ALL_LABELS) &&
            contour_is_area(&axis, &at, &session->scene->grid, markers, n))
            leave_out(doubt, axis, (int64_t)at - 1, (int64_t)at + 1);
    }
}

/* Sums of its own, to be crossed out. */
static enum err copy_doubt(struct doubt *copy, const struct doubt *doubt, struct fault *fault)
{
    const size_t slices = (size_t)doubt->size[0] + doubt->size[1] + doubt->size[2];
    *copy = *doubt;
    copy->slice[0] = mem_array(slices, sizeof *copy->slice[0]);
    if (!copy->slice[0])
        return fault_memory(fault, "doubt");
    memcpy(copy->slice[0], doubt->slice[0], slices * sizeof *copy->slice[0]);
    copy->slice[1] = copy->slice[0] + copy->size[0];
    copy->slice[2] = copy->slice[1] + copy->size[1];
    return OK;
}

enum err doubtful_find(struct doubtful_slice slice[DOUBTFUL_MOST], size_t *count,
                       struct session *session, unsigned label, struct fault *fault)
{
    struct doubt left = {.all = 0};
    enum err err = keep_up(session, label, fault);
    *count = 0;
    err = err ? err : copy_doubt(&left, &session->doubting.doubt, fault);
    if (err)
        return err;
    leave_out_outlined(&left, session, label);
    for (unsigned axis; *count < DOUBTFUL_MOST; (*count)++) {
        uint32_t at;
        if (!doubt_worst(&left, &axis, &at))
            break;
        slice[*count] = (struct doubtful_slice){axis, at, left.slice[axis][at]};
        leave_out(&left, axis, (int64_t)at - DOUBTFUL_APART + 1, (int64_t)at + DOUBTFUL_APART - 1);
    }
    doubt_release(&left);
    return OK;
}

/* ---- a place in one ---- */

static int64_t distance_2(const uint32_t place[3], const uint64_t sum[3], uint64_t count)
{
    int64_t squared = 0;
    for (int a = 0; a < 3; a++) {
        const int64_t way = (int64_t)place[a] - (int64_t)(sum[a] / count);
        squared += way * way;
    }
    return squared;
}

/* Of the voxels of a label in a slice, the one nearest to the mean of all; the first of several. */
static bool find_middle(uint32_t middle[3], const struct labels *labels, unsigned label,
                        unsigned axis, uint32_t at)
{
    const struct grid *grid = &labels->scene->grid;
    const unsigned u = axis == 0, v = axis == 2 ? 1 : 2;
    uint64_t count = 0, sum[3] = {0};
    int64_t nearest = INT64_MAX;
    uint32_t place[3];
    place[axis] = at;
    for (int pass = 0; pass < 2; pass++)
        for (place[v] = 0; place[v] < grid->size[v]; place[v]++)
            for (place[u] = 0; place[u] < grid->size[u]; place[u]++) {
                const unsigned has =
                    labels_at(labels, grid_cell(grid, place[0], place[1], place[2]));
                if (label == FINISH_ALL_LABELS ? !has : has != label)
                    continue;
                if (pass == 0) {
                    for (int a = 0; a < 3; a++)
                        sum[a] += place[a];
                    count++;
                } else if (distance_2(place, sum, count) < nearest) {
                    nearest = distance_2(place, sum, count);
                    memcpy(middle, place, sizeof place);
                }
            }
    return count > 0;
}

bool doubtful_place(uint32_t place[3], const struct labels *labels, unsigned label,
                    const struct doubtful_slice *slice)
{
    const uint32_t size = labels->scene->grid.size[slice->axis];
    bool found = false;
    for (uint32_t away = 0; !found && away < size; away++)
        found =
            (slice->at + away < size &&
             find_middle(place, labels, label, slice->axis, slice->at + away)) ||
            (away <= slice->at && find_middle(place, labels, label, slice->axis, slice->at - away));
    place[slice->axis] = slice->at;
    return found;
}
