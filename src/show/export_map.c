/* SPDX-License-Identifier: MIT */
#include "show/export_map.h"

#include <string.h>

#include "base/mem.h"
#include "engine/finish.h"
#include "engine/forest.h"
#include "engine/labels.h"
#include "engine/margin.h"
#include "engine/scene.h"
#include "render/border.h"
#include "session/map.h"
#include "session/state.h"

struct map_source {
    const struct session *session;
    const struct labels *labels;
    enum map map;
    uint16_t *margin;     /* by cell, for MAP_MARGIN */
    uint32_t number[256]; /* numbers of labels */
    bool used[256];       /* labels of voxels */
    uint16_t *rest;       /* regions that are kept; or NULL */
    enum voxel_type wide; /* the smallest type of these numbers */
};

static void fill_row(void *context, uint32_t y, uint32_t z, void *values)
{
    const struct map_source *source = context;
    const struct session *session = source->session;
    struct span row = grid_row(&session->scene->grid, y, z);
    const size_t first = ((size_t)z * session->scene->grid.size[1] + y) * (row.end - row.first);
    uint8_t *byte = values;
    uint16_t *pair = values;
    uint32_t *root = values;
    float *real = values;
    for (uint32_t c = row.first; c < row.end; c++) {
        const struct cell *cell = session->scene->cell + c;
        bool reached = cell_is_reached(cell);
        uint32_t number;
        switch (source->map) {
        case MAP_LABELS:
            number = source->rest ? source->rest[first + c - row.first] : 0;
            number = number ? number : source->number[labels_at(source->labels, c)];
            if (source->wide == VOXEL_UINT32)
                *root++ = number;
            else if (source->wide == VOXEL_UINT16)
                *pair++ = (uint16_t)number;
            else
                *byte++ = (uint8_t)number;
            break;
        case MAP_BORDER:
            *byte++ = border_holds(&session->border, c);
            break;
        case MAP_COST:
            *pair++ = reached ? (uint16_t)key_cost(cell->key) : UINT16_MAX;
            break;
        case MAP_DISTANCE:
            *pair++ = reached ? (uint16_t)key_hops(cell->key) : UINT16_MAX;
            break;
        case MAP_MARGIN:
            *pair++ = source->margin[c];
            break;
        case MAP_ROOT:
            *root++ = reached ? grid_voxel(&session->scene->grid, key_root(cell->key)) : CELL_NONE;
            break;
        case MAP_INTENSITY:
            *real++ = (float)levels_value(&session->geometry, session->levels, cell->intensity);
            break;
        }
    }
}

void export_labels(struct volume_label label[256], const struct kept *kept)
{
    uint32_t number[256];
    numbering_fill(number, kept);
    for (int l = 0; l < 256; l++) {
        label[l].name = kept->label_name[l];
        label[l].code = kept->label_code[l];
        label[l].number = number[l];
        label[l].used = false;
        memcpy(label[l].rgb, kept->palette.rgb[l], sizeof label[l].rgb);
    }
}

/* Find the greatest number of a region that is kept. Reject a label with such a number: files could
 * not tell them apart. */
static enum err check_rest(const struct map_source *source, uint32_t *most, struct fault *fault)
{
    const size_t voxels = source->session->scene->grid.voxels;
    OWNED(mem_release) bool *has = mem_new((REGION_NONE + 1) * sizeof *has);
    unsigned label = 1;
    if (!has)
        return fault_memory(fault, "the regions that are kept");
    for (size_t i = 0; i < voxels; i++) {
        has[source->rest[i]] = true;
        *most = source->rest[i] > *most ? source->rest[i] : *most;
    }
    while (label < 256 && !(source->used[label] && source->number[label] <= REGION_MOST &&
                            has[source->number[label]]))
        label++;
    if (label == 256)
        return OK;
    return fault_set(fault, ERR_INPUT,
                     "label %u has the number of a region that is kept, so that the file could not "
                     "tell them apart; `label %u NAME number=N` sets another number; nothing was "
                     "written",
                     source->number[label], source->number[label]);
}

/* Find the labels of voxels, and the smallest type that holds the numbers of the map. */
static enum err find_type(struct map_source *source, struct fault *fault)
{
    const struct grid *grid = &source->session->scene->grid;
    bool *used = source->used;
    for (struct grid_walk w = grid_rows(grid, NULL, NULL); grid_walk_next(&w);)
        for (uint32_t c = w.row.first; c < w.row.end; c++)
            used[labels_at(source->labels, c)] = true;
    uint32_t most = 0;
    TRY(source->rest ? check_rest(source, &most, fault) : OK);
    for (unsigned l = 0; l < 256; l++)
        most = used[l] && source->number[l] > most ? source->number[l] : most;
    source->wide = most > UINT16_MAX ? VOXEL_UINT32 : most > UINT8_MAX ? VOXEL_UINT16 : VOXEL_UINT8;
    return OK;
}

enum err export_map(const struct session *session, enum map map, const struct labels *labels,
                    const char *path, enum file_mode mode, const struct dicom_source *source_series,
                    struct fault *fault)
{
    static const struct {
        enum voxel_type type;
        const char *description;
    } form[] = {[MAP_LABELS] = {VOXEL_UINT8, "iftty labels"},
                [MAP_COST] = {VOXEL_UINT16, "iftty path cost"},
                [MAP_ROOT] = {VOXEL_UINT32, "iftty root: voxel index of the seed"},
                [MAP_BORDER] = {VOXEL_UINT8, "iftty border"},
                [MAP_DISTANCE] = {VOXEL_UINT16, "iftty plateau distance: steps since a rise"},
                [MAP_MARGIN] = {VOXEL_UINT16, "iftty margin: cost of the next best label, less"},
                [MAP_INTENSITY] = {VOXEL_FLOAT32, "iftty intensity"}};
    OWNED(mem_release) uint16_t *margin = NULL, *rest = NULL;
    struct volume_label label[256];
    OWNED(buf_release) struct buf description = {0};
    TRY(map == MAP_MARGIN   ? margin_new(&margin, session->forest, fault)
        : map == MAP_LABELS ? session_take_rest(session, &rest, fault)
                            : OK);
    struct map_source source = {
        .session = session, .labels = labels, .map = map, .margin = margin, .rest = rest};
    numbering_fill(source.number, &session->now.kept);
    if (map == MAP_LABELS)
        TRY(find_type(&source, fault));
    export_labels(label, &session->now.kept);
    for (int l = 0; l < 256; l++)
        label[l].used = source.used[l];
    buf_add_text(&description, form[map].description);
    if (map == MAP_LABELS && labels->finished) {
        buf_add_text(&description, ", finished: ");
        numbering_write_finish(&description, &session->now.kept);
    }
    const struct volume_map written = {session->scene->grid.size,
                                       &session->geometry,
                                       map == MAP_LABELS ? source.wide : form[map].type,
                                       buf_text(&description),
                                       fill_row,
                                       &source,
                                       map == MAP_LABELS ? label : NULL,
                                       source_series,
                                       NULL};
    return description.failed ? fault_memory(fault, "a map")
                              : volume_write(path, mode, &written, session->watch, fault);
}

enum err export_seeds(struct buf *out, const struct session *session, struct fault *fault)
{
    const struct grid *grid = &session->scene->grid;
    uint32_t number[256];
    numbering_fill(number, &session->now.kept);
    buf_add_text(out, forest_limited_seeds(session->forest) ? "x,y,z,label,within,of x,of y,of z\n"
                                                            : "x,y,z,label\n");
    for (struct grid_walk w = grid_rows(grid, session->watch, "seeds"); grid_walk_next(&w);)
        for (uint32_t c = w.row.first; c < w.row.end; c++) {
            if (!(session->scene->cell[c].flags & CELL_SEED))
                continue;
            const struct reach *reach = forest_reach(session->forest, c);
            buf_printf(out, "%u,%u,%u,%u", c - w.row.first, w.y, w.z,
                       number[session->scene->cell[c].label]);
            if (reach && reach->unit[0] == 1)
                buf_printf(out, ",%lld",
                           reach->radius == REACH_EXACT ? 0 : (long long)reach->radius);
            else if (reach)
                buf_printf(out, ",%lld.%06lldmm", (long long)(reach->radius / 1000000),
                           (long long)(reach->radius % 1000000));
            if (reach)
                buf_printf(out, ",%u,%u,%u", reach->centre[0], reach->centre[1], reach->centre[2]);
            buf_add_char(out, '\n');
        }
    return out->failed ? fault_memory(fault, "a list of seeds")
                       : watch_fault(session->watch, fault);
}
