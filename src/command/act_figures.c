/* SPDX-License-Identifier: MIT */
/* Statistics of labels, and their comparison with a file. */
#include "command/act.h"

#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "engine/forest.h"
#include "show/comparison_picture.h"
#include "show/label_report.h"
#include "session/map.h"
#include "session/session.h"
#include "session/tally.h"

/* ---- counts ---- */

/* Seeds and reached voxels of the forest, by label. */
struct counts {
    size_t seeds[256], voxels[256];
};

static enum err count_labels(struct counts *counts, const struct act *act)
{
    const struct session *session = act->session;
    struct grid_walk walk = scene_walk(session->scene, "counting", NULL, 0);
    *counts = (struct counts){.seeds = {0}};
    while (grid_walk_next(&walk))
        for (uint32_t c = walk.row.first; c < walk.row.end; c++) {
            const struct cell *cell = session->scene->cell + c;
            counts->voxels[cell->label] += cell_is_reached(cell);
            counts->seeds[cell->label] += cell->flags & CELL_SEED;
        }
    return watch_fault(session->watch, act->fault);
}

static void write_counts(const struct act *act, const struct counts *counts, unsigned label)
{
    const struct session *session = act->session;
    const double ml = tally_voxel_mm3(&session->geometry) / 1000.0;
    struct buf *out = &act->reply->text;
    buf_add_text(out, "label ");
    label_report_write_name(out, session, label);
    buf_printf(out, ": %zu seed%s, %zu voxel%s", counts->seeds[label], plural(counts->seeds[label]),
               counts->voxels[label], plural(counts->voxels[label]));
    if (!session->geometry.spacing_unknown)
        buf_printf(out, ", %.1f ml", (double)counts->voxels[label] * ml);
    const struct kept *kept = &session->now.kept;
    if (label && kept->opacity[label] < BORDER_OPAQUE)
        buf_printf(out, ", opacity %u %%", kept->opacity[label]);
    buf_add_text(out, label && !kept->visible[label] ? ", hidden\n" : "\n");
}

enum err act_write_counts(const struct act *act)
{
    struct counts counts;
    uint32_t number[256];
    uint8_t order[256];
    TRY(count_labels(&counts, act));
    numbering_fill(number, &act->session->now.kept);
    numbering_order(order, number);
    for (unsigned i = 0; i < 256; i++)
        if (counts.voxels[order[i]])
            write_counts(act, &counts, order[i]);
    return OK;
}

/* ---- the answer ---- */

static enum err answer_stats(const struct act *act, const struct label_stats *stats,
                             const struct labels *labels)
{
    const struct session *session = act->session;
    const char *file = act_text(act, "report");
    struct buf *text = act_buf(act), *out = &act->reply->text;
    struct counts counts;
    bool listed[256] = {false};
    uint32_t number[256];
    uint8_t order[256];
    const struct tally *tally = &session->tally;
    const bool knows_moves = tally->knows_moves && !labels->finished;
    struct area_weights area;
    area_weights_init(&area, &session->geometry);
    numbering_fill(number, &session->now.kept);
    numbering_order(order, number);
    const struct label_report report = {
        .stats = stats,
        .area = &area,
        .gained = knows_moves ? tally->gained : NULL,
        .lost = knows_moves ? tally->lost : NULL,
        .before = labels->finished ? NULL : session_voxels_before_edit(session),
        .label_name = session->now.kept.label_name,
        .label_code = session->now.kept.label_code,
        .label_number = number,
        .geometry = &session->geometry,
        .levels = session->levels,
        .channel = kept_channels(&session->now.kept) ? session_shown_channel(session) + 1 : 0,
        .listed = listed};
    TRY(count_labels(&counts, act));
    for (unsigned label = 1; label < 256; label++)
        listed[label] = counts.voxels[label] || counts.seeds[label] || *report.label_name[label];
    if (file && file_is_named(file, ".json"))
        label_report_write_json(text, &report);
    else if (file)
        label_report_write_csv(text, &report);
    TRY(act_write_report(act, text));
    for (unsigned i = 0; i < 256; i++) {
        const unsigned label = order[i];
        if (labels->finished)
            counts.voxels[label] = (size_t)stats[label].sums.voxels;
        if (!counts.voxels[label] && !listed[label])
            continue;
        write_counts(act, &counts, label);
        if (label && stats[label].sums.voxels)
            label_report_write_text(out, &report, label);
    }
    act_write_no_seeds(act);
    buf_add_text(out, "weight ");
    act_write_weight(out, &session->now.kept);
    buf_add_char(out, '\n');
    if (report.channel) {
        buf_add_text(out, "intensities of ");
        channel_write(out, session);
        buf_add_char(out, '\n');
    }
    levels_write_scale(out, session->levels, "");
    act_write_region(out, session);
    act_write_finish(out, session);
    if (!labels->finished && session_shows_finished(session))
        buf_add_text(out, "labels here are those of the forest; `stats finished=yes` counts those "
                          "shown\n");
    const size_t border = border_count(&session->border);
    buf_printf(out, "%zu border voxel%s; forest %016llx, labels %016llx\n", border, plural(border),
               (unsigned long long)forest_digest(session->forest),
               (unsigned long long)forest_label_digest(session->forest));
    return OK;
}

enum err act_stats(const struct act *act)
{
    struct labels labels;
    OWNED(mem_release) struct label_stats *stats = mem_array(256, sizeof *stats);
    TRY(stats ? act_check_report(act) : fault_memory(act->fault, "counts of labels"));
    TRY(act_take_labels(act, &labels));
    TRY(session_find_stats(act->session, &labels, stats, act->fault));
    return answer_stats(act, stats, &labels);
}

/* ---- `compare` ---- */

/* Get the session's labels; with `label`, only that one. */
static enum err get_own_labels(uint8_t **own, const struct act *act, struct labels *labels)
{
    const struct grid *grid = &act->session->scene->grid;
    const struct value *only = act_value(act, "label");
    uint8_t *label = *own = mem_array(grid->voxels, 1);
    struct grid_walk walk = scene_walk(act->session->scene, "present labels", NULL, 0);
    TRY(label ? act_take_labels(act, labels) : fault_memory(act->fault, "the labels"));
    while (grid_walk_next(&walk)) {
        labels_copy_row(labels, walk.row, label);
        for (const uint8_t *end = label + grid->size[0]; label < end; label++)
            *label = only->given && *label != only->number ? 0 : *label;
    }
    return watch_fault(act->session->watch, act->fault);
}

/* Get the labels of the map; labels of the map alone are made in `kept`. */
static enum err get_map_labels(uint8_t **labels, struct kept *kept, bool listed[256],
                               const struct act *act)
{
    const struct session *session = act->session;
    OWNED(volume_release) struct volume map = {0};
    OWNED(regions_release) struct regions regions = {0};
    OWNED(mem_release) uint16_t *as = NULL;
    TRY(act_choose_regions(&regions, act, act_value(act, "label")));
    TRY(act_read_map(act, &map, 0, UINT32_MAX));
    if (!act_has(act, "label"))
        TRY(act_prefix_file(act,
                            numbering_admit(kept, &map, &regions, &session->markers, act->fault)));
    TRY(regions_table(&as, &regions, &map, kept, act->fault));
    if (act_has(act, "label"))
        listed[act_number(act, "label")] = true;
    else if (act_has(act, "regions"))
        regions_list(listed, &regions, kept);
    const struct map_labels choice = {as, (int)act_number_or(act, "label", LABEL_OWN)};
    return act_prefix_file(act, map_to_labels(labels, &map, &choice, session->watch, act->fault));
}

/* Write "picture", slices through the given place, or the voxel with the largest distance, or the
 * cross-hair; or "surface". Nothing if the parameter is not given. */
static enum err write_picture(const struct act *act, const char *which, const struct labels *labels,
                              const struct comparison_report *report)
{
    const uint32_t *cross = act->session->now.outlook.slices.cross;
    const uint32_t *place =
        act_has(act, "at") ? act_place(act, "at") : comparison_farthest(report->comparison, cross);
    OWNED(picture_release) struct picture picture = {0};
    struct buf *path = act_buf(act);
    if (!act_has(act, which))
        return OK;
    TRY(interpreter_output_path(act->interp, act_text(act, which), path, act->fault));
    if (!path->length)
        return OK;
    TRY(strcmp(which, "picture") == 0
            ? comparison_picture_draw(&picture, act->session, report, place, act->fault)
            : distance_picture_draw(&picture, act->session, report, false, act->fault));
    TRY(act_note_picture(act, labels, &picture));
    return act_write_picture(act, buf_text(path), act_file_mode(act), &picture);
}

static enum err answer_comparison(const struct act *act, const struct labels *labels,
                                  const struct comparison *comparison, const struct kept *kept,
                                  const bool *listed)
{
    const struct session *session = act->session;
    const char *name = labels->finished ? "the labels here, finished" : "the labels here";
    const struct comparison_report report = {
        comparison, {name, act_text(act, "FILE")}, kept, &session->geometry, listed};
    const char *file = act_text(act, "report");
    struct buf *text = act_buf(act);
    if (file && file_is_named(file, ".json"))
        comparison_write_json(text, &report);
    else if (file)
        comparison_write_csv(text, &report);
    TRY(act_write_report(act, text));
    TRY(write_picture(act, "picture", labels, &report));
    TRY(write_picture(act, "surface", labels, &report));
    comparison_write_text(&act->reply->text, &report);
    act_write_no_seeds(act);
    return OK;
}

enum err act_compare(const struct act *act)
{
    struct session *session = act->session;
    struct labels labels = {0};
    bool listed[256] = {false};           /* labels with a name or requested */
    struct kept *kept = &act->next->kept; /* and the labels of the map, which are not applied */
    OWNED(mem_release) struct comparison *comparison = mem_new(sizeof *comparison);
    OWNED(mem_release) uint8_t *own = NULL, *other = NULL;
    TRY(comparison ? act_check_report(act) : fault_memory(act->fault, "a comparison"));
    if (act_has(act, "at") && !act_has(act, "picture"))
        return fault_set(act->fault, ERR_USAGE,
                         "at: the place of the picture's slices; expected picture=FILE too");
    for (unsigned label = 1; label < 256 && !act_has(act, "label"); label++)
        listed[label] = *session->now.kept.label_name[label];
    TRY(get_map_labels(&other, kept, listed, act));
    TRY(get_own_labels(&own, act, &labels));
    struct compared compared = {.label = {own, other}};
    memcpy(compared.size, session->scene->grid.size, sizeof compared.size);
    memcpy(compared.spacing_nm, session->scene->spacing_nm, sizeof compared.spacing_nm);
    TRY(comparison_make(comparison, &compared, session->team, session->watch, act->fault));
    return answer_comparison(act, &labels, comparison, kept, listed);
}
