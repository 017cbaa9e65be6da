/* SPDX-License-Identifier: MIT */
#include "show/label_loss.h"

#include <stdlib.h>

#include "base/mem.h"
#include "engine/components.h"
#include "show/label_report.h"

static enum err find_extents(struct label_extent extent[256], const struct grid *grid,
                             const uint8_t *label, struct watch *watch, struct fault *fault)
{
    struct components components = {0};
    const enum err err = components_find(&components, grid, label, watch, fault);
    for (size_t i = 0; !err && i < components.count; i++) {
        extent[components.item[i].label].voxels += components.item[i].voxels;
        extent[components.item[i].label].pieces++;
    }
    components_release(&components);
    return err;
}

/* All voxels within LABEL_LOSS_FAR steps of this one have the same label. */
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
    uint8_t *label = mem_array(grid->cells, 1);
    *loss = (struct label_loss){.labels = 0};
    if (!label)
        return fault_memory(fault, "labels before the finish");
    labels_copy(&forest, label, team);
    enum err err = watch_fault(watch, fault);
    if (!err)
        err = find_extents(loss->before, grid, label, watch, fault);
    if (!err)
        err = find_extents(loss->after, grid, finished->finished, watch, fault);
    for (uint32_t c = 0; !err && c < grid->cells; c++)
        loss->far += label[c] != finished->finished[c] && is_far(grid, label, c);
    for (unsigned l = 1; !err && l < 256; l++) {
        const struct label_extent *before = &loss->before[l], *after = &loss->after[l];
        loss->is_lost[l] = before->voxels &&
                           (2 * after->voxels < before->voxels || after->pieces > before->pieces);
        loss->labels += loss->is_lost[l];
    }
    free(label);
    return err;
}

static void write_extent(struct buf *out, const struct label_extent *extent)
{
    buf_printf(out, "%llu voxel%s", (unsigned long long)extent->voxels, plural(extent->voxels));
    if (extent->voxels)
        buf_printf(out, " in %u piece%s", extent->pieces, plural(extent->pieces));
}

/* "deletes label 3 wall", up to the name. */
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
        if (loss->after[l].voxels)
            buf_printf(out, " to %llu voxels in %u piece%s",
                       (unsigned long long)loss->after[l].voxels, loss->after[l].pieces,
                       plural(loss->after[l].pieces));
    }
    if (loss->labels)
        buf_add_text(out, "; `stats` counts the voxels\n");
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
