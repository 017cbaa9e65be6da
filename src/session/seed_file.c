/* SPDX-License-Identifier: MIT */
#include "session/seed_file.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/mem.h"
#include "base/scan.h"
#include "base/sort.h"
#include "engine/components.h"

void seeds_release(struct seeds *seeds)
{
    free(seeds->edit);
    free(seeds->region);
    free(seeds->group);
    *seeds = (struct seeds){0};
}

uint64_t seeds_digest(const struct seeds *seeds)
{
    uint64_t sum = 0;
    for (size_t i = 0; i < seeds->count; i++)
        sum += hash_mix_at(seeds->edit[i].cell, (uint64_t)seeds->edit[i].label);
    for (size_t i = 0; i < seeds->count && seeds->groups; i++)
        if (seeds->region[i] >= SEED_GROUPS_FROM) {
            const struct reach *reach = &seeds->group[seeds->region[i] - SEED_GROUPS_FROM].reach;
            uint64_t mix =
                hash_mix_at(seeds->edit[i].cell, (uint64_t)reach->radius * 2 + reach->unit[0]);
            for (int a = 0; a < 3; a++)
                mix = hash_mix_at(mix, reach->centre[a]);
            sum += mix;
        }
    return sum;
}

static bool reserve_seeds(struct seeds *seeds, size_t count)
{
    seeds->edit = mem_array(count, sizeof *seeds->edit);
    seeds->region = mem_array(count, sizeof *seeds->region);
    return seeds->edit && seeds->region;
}

static void add_seed(struct seeds *seeds, uint32_t cell, int label, uint16_t region)
{
    seeds->edit[seeds->count] = (struct edit){cell, (int16_t)label, 0};
    seeds->region[seeds->count++] = region;
}

/* Counting sort. */
enum err seeds_by_region(const struct seeds *seeds, uint32_t **cell, size_t *end,
                         struct watch *watch, struct fault *fault)
{
    struct task task = task_begin(watch, "seeds of regions", 2 * (uint64_t)seeds->count);
    *cell = mem_array(seeds->count, sizeof **cell);
    if (!*cell)
        return fault_memory(fault, "the seeds of regions");
    memset(end, 0, (REGION_MOST + 1) * sizeof *end);
    for (size_t i = 0; i < seeds->count && task_advance(&task, 1); i++)
        end[seeds->region[i]]++;
    for (size_t r = 0, before = 0; r <= REGION_MOST; r++) {
        const size_t here = end[r];
        end[r] = before; /* the beginning of region r; later, its next free place */
        before += here;
    }
    for (size_t i = 0; i < seeds->count && task_advance(&task, 1); i++)
        (*cell)[end[seeds->region[i]]++] = seeds->edit[i].cell;
    return watch_fault(watch, fault);
}

/* ---- a list ---- */

struct row {
    uint32_t cell, line;
    int16_t label;
    uint16_t region; /* region of the seeds from this row */
    struct reach reach;
};

struct list {
    const struct grid *grid;
    const struct kept *kept; /* names and numbers of labels */
    int label;
    struct row *row;
    size_t rows, capacity;
    struct watch *watch;
};

static bool scan_comma(const char **at)
{
    const char *from = *at;
    scan_blanks(&from);
    if (*from != ',')
        return false;
    *at = from + 1;
    scan_blanks(at);
    return true;
}

/* True for names of columns: four fields or eight; none of the first three begins like a number.
 * */
static bool is_header(const char *at, const char *end)
{
    int fields = 0;
    for (; at; fields++) {
        scan_blanks(&at);
        const unsigned char c = (unsigned char)*at;
        if (at == end || c == ',' || (fields < 3 && (c < 'A' || c > 'z') && c != '"'))
            return false;
        at = memchr(at, ',', (size_t)(end - at));
        at = at ? at + 1 : NULL;
    }
    return fields == 4 || fields == 8;
}

/* ",12,70,110,95", ",2.5mm,70,110,95", or ",0,0,0,0" for an exact seed. */
static bool scan_reach(const char **at, struct reach *reach)
{
    static const int64_t most_nm = 1000000000;
    const char *from = *at;
    struct reach found = {.unit = {1, 1, 1}};
    if (!scan_comma(&from))
        return false;
    const char *number = from;
    if (scan_decimal(&from, 6, 1, most_nm, &found.radius) && scan_text(&from, "mm"))
        found.unit[0] = found.unit[1] = found.unit[2] = 0;
    else if (from = number, !scan_integer(&from, 0, REACH_MOST, &found.radius))
        return false;
    for (int a = 0; a < 3; a++) {
        int64_t place;
        if (!scan_comma(&from) || !scan_integer(&from, 0, GRID_SIDE_MOST, &place))
            return false;
        found.centre[a] = (uint32_t)place;
    }
    if (from != *at + strcspn(*at, " \t\r\n"))
        return false;
    if (found.radius == 0 && (found.centre[0] || found.centre[1] || found.centre[2]))
        return false;
    if (found.radius == 0)
        found = (struct reach){.unit = {1, 1, 1}, .radius = REACH_EXACT};
    *reach = found;
    *at = from;
    return true;
}

/* A reach may follow a number. */
static bool scan_label(const char **at, const struct list *list, int64_t *label,
                       struct reach *reach)
{
    const char *number = *at;
    *reach = (struct reach){.radius = 0};
    if (scan_integer(&number, 0, UINT32_MAX, label) &&
        (number == *at + strcspn(*at, " \t\r\n") || scan_reach(&number, reach))) {
        *label = numbering_find(list->kept, (uint32_t)*label);
        *at = *label == NUMBER_UNKNOWN ? *at : number;
        return *label != NUMBER_UNKNOWN;
    }
    size_t length = strcspn(*at, "\r\n"); /* a name may contain blanks; a comment may follow it */
    for (size_t i = 0; i < length; i++)
        if ((*at)[i] == '#' && (i == 0 || (*at)[i - 1] == ' ' || (*at)[i - 1] == '\t'))
            length = i;
    while (length > 0 && ((*at)[length - 1] == ' ' || (*at)[length - 1] == '\t'))
        length--;
    for (int i = 0; i < 256; i++)
        if (length && strlen(list->kept->label_name[i]) == length &&
            memcmp(list->kept->label_name[i], *at, length) == 0) {
            *label = i;
            *at += length;
            return true;
        }
    return false;
}

static enum err read_row(struct list *list, const char *at, const char *end, uint32_t line,
                         struct fault *fault)
{
    const uint32_t *size = list->grid->size;
    int64_t place[3], label;
    struct reach reach;
    const char *begin = at;
    for (int a = 0; a < 3; a++)
        if (!scan_integer(&at, INT32_MIN, INT32_MAX, &place[a]) || !scan_comma(&at))
            goto malformed;
    if (!scan_label(&at, list, &label, &reach))
        return fault_set(fault, ERR_INPUT,
                         "line %u: expected a label %sor the name of one, not %.*s; nothing was "
                         "planted",
                         line, numbering_is_used(list->kept) ? "" : "0..255 ",
                         (int)(end - at < 40 ? end - at : 40), at);
    scan_blanks(&at);
    if (at != end && *at != '#')
        goto malformed;
    if (!grid_contains(list->grid, place[0], place[1], place[2]))
        return fault_set(fault, ERR_INPUT,
                         "line %u: %lld,%lld,%lld is outside the scene, whose voxels are 0,0,0 "
                         "to %u,%u,%u; nothing was planted",
                         line, (long long)place[0], (long long)place[1], (long long)place[2],
                         size[0] - 1, size[1] - 1, size[2] - 1);
    if (!mem_grow(&list->row, &list->capacity, list->rows + 1, sizeof *list->row))
        return fault_memory(fault, "a list of seeds");
    const int own = (int)(list->label == LABEL_OWN ? label : list->label);
    list->row[list->rows++] = (struct row){
        grid_cell(list->grid, (uint32_t)place[0], (uint32_t)place[1], (uint32_t)place[2]), line,
        (int16_t)own, (uint16_t)own, reach};
    return OK;
malformed:
    return fault_set(fault, ERR_INPUT,
                     "line %u: expected x,y,z,label with whole voxel indices, not %.*s; nothing "
                     "was planted",
                     line, (int)(end - begin < 60 ? end - begin : 60), begin);
}

static enum err read_rows(struct list *list, const char *text, const char *end, struct fault *fault)
{
    struct task task = task_begin(list->watch, "reading seeds", (uint64_t)(end - text));
    bool may_be_header = true;
    scan_text(&text, "\xef\xbb\xbf"); /* byte order mark, as spreadsheets write it */
    for (uint32_t line = 1; text < end; line++) {
        const char *stop = memchr(text, '\n', (size_t)(end - text));
        stop = stop ? stop : end;
        const char *at = text, *last = stop;
        text = stop + (stop < end);
        if (!task_advance(&task, (uint64_t)(text - at)))
            return watch_fault(list->watch, fault);
        last -= last > at && last[-1] == '\r';
        scan_blanks(&at);
        if (at == last || *at == '#')
            continue;
        if (!may_be_header || !is_header(at, last))
            TRY(read_row(list, at, last, line, fault));
        may_be_header = false;
    }
    return OK;
}

/* ---- markers with a reach ---- */

static int compare_groups(const void *a, const void *b)
{
    const struct row *x = *(struct row *const *)a, *y = *(struct row *const *)b;
    const int64_t of_x[] = {x->reach.radius,    x->reach.unit[0],   x->label,
                            x->reach.centre[0], x->reach.centre[1], x->reach.centre[2]},
                  of_y[] = {y->reach.radius,    y->reach.unit[0],   y->label,
                            y->reach.centre[0], y->reach.centre[1], y->reach.centre[2]};
    for (size_t i = 0; i < sizeof of_x / sizeof *of_x; i++)
        if (of_x[i] != of_y[i])
            return of_x[i] < of_y[i] ? -1 : 1;
    return 0;
}

/* Make one region of all rows with the same label and reach; rows without a reach keep the
 * region of their label. */
static enum err group_rows(struct seeds *seeds, struct list *list, struct fault *fault)
{
    size_t capacity = 0, limited = 0;
    for (size_t i = 0; i < list->rows; i++)
        limited += list->row[i].reach.radius != 0;
    if (limited == 0)
        return OK;
    OWNED(mem_release) struct row **row = mem_array(limited, sizeof(struct row *));
    if (!row)
        return fault_memory(fault, "a list of seeds");
    for (size_t i = 0, n = 0; i < list->rows; i++)
        if (list->row[i].reach.radius != 0)
            row[n++] = &list->row[i];
    qsort(row, limited, sizeof *row, compare_groups);
    for (size_t i = 0; i < limited; i++) {
        const bool begins = i == 0 || compare_groups(&row[i - 1], &row[i]) != 0;
        if (begins && seeds->groups == REGION_MOST + 1 - SEED_GROUPS_FROM)
            return fault_set(fault, ERR_LIMIT,
                             "line %u: more than %d markers end within a distance; nothing was "
                             "planted",
                             row[i]->line, REGION_MOST + 1 - SEED_GROUPS_FROM);
        if (begins && !mem_grow(&seeds->group, &capacity, seeds->groups + 1, sizeof *seeds->group))
            return fault_memory(fault, "a list of seeds");
        if (begins)
            seeds->group[seeds->groups++] = (struct seed_group){row[i]->label, row[i]->reach};
        row[i]->region = (uint16_t)(SEED_GROUPS_FROM + seeds->groups - 1);
    }
    return OK;
}

/* Add the rows in order of cells, each cell once. Two lines with different labels for one voxel
 * are an error, since the result would depend on their order. `order` has the cell in the upper
 * half, the row in the lower. */
static enum err add_rows(struct seeds *seeds, const struct list *list, const uint64_t *order,
                         struct fault *fault)
{
    const struct row *before = NULL;
    for (size_t i = 0; i < list->rows; i++) {
        const struct row *row = &list->row[(uint32_t)order[i]];
        if (!before || row->cell != before->cell)
            add_seed(seeds, row->cell, row->label, row->region);
        else if (row->label != before->label)
            return fault_set(fault, ERR_INPUT,
                             "line %u: the voxel of line %u again, with label %u instead of %u; "
                             "nothing was planted",
                             row->line, before->line,
                             numbering_of(list->kept, (unsigned)row->label),
                             numbering_of(list->kept, (unsigned)before->label));
        else if (row->region != before->region)
            return fault_set(fault, ERR_INPUT,
                             "line %u: the voxel of line %u again, within another distance; "
                             "nothing was planted",
                             row->line, before->line);
        before = row;
    }
    return OK;
}

static enum err settle_rows(struct seeds *seeds, struct list *list, struct fault *fault)
{
    if (list->rows == 0)
        return fault_set(fault, ERR_INPUT,
                         "there is no seed in it; expected lines x,y,z,label; nothing was planted");
    TRY(group_rows(seeds, list, fault));
    OWNED(mem_release) uint64_t *order = mem_array(list->rows, sizeof *order);
    if (!order || !reserve_seeds(seeds, list->rows))
        return fault_memory(fault, "a list of seeds");
    for (size_t i = 0; i < list->rows; i++)
        order[i] = (uint64_t)list->row[i].cell << 32 | i;
    TRY(sort_by_upper_half(order, list->rows, list->watch, fault));
    return add_rows(seeds, list, order, fault);
}

enum err seeds_from_list(struct seeds *seeds, const char *text, size_t length,
                         const struct grid *grid, const struct kept *kept, int label,
                         struct watch *watch, struct fault *fault)
{
    struct list list = {.grid = grid, .kept = kept, .label = label, .watch = watch};
    *seeds = (struct seeds){0};
    enum err err = read_rows(&list, text, text + length, fault);
    if (!err)
        err = settle_rows(seeds, &list, fault);
    if (err)
        seeds_release(seeds);
    free(list.row);
    return err;
}

/* ---- a map ---- */

enum { VALUES = 65536 };

/* Mark the voxels of plane z that lose their region. The outside of the scene is outside every
 * region. */
static void judge_plane(bool *goes, const uint16_t *region, const uint32_t size[3], uint32_t z)
{
    const size_t row = size[0], plane = row * size[1];
    size_t i = plane * z;
    for (uint32_t y = 0; y < size[1]; y++) {
        const bool rim = z == 0 || z + 1 == size[2] || y == 0 || y + 1 == size[1];
        for (uint32_t x = 0; x < size[0]; x++, i++) {
            const uint16_t r = region[i];
            *goes++ = r != REGION_NONE &&
                      (rim || x == 0 || x + 1 == size[0] || region[i - 1] != r ||
                       region[i + 1] != r || region[i - row] != r || region[i + row] != r ||
                       region[i - plane] != r || region[i + plane] != r);
        }
    }
}

/* Erode one round. A plane is changed after the next one has been judged. `goes` has room for
 * two planes. */
static void erode_once(uint16_t *region, bool *goes, const uint32_t size[3], struct watch *watch)
{
    const size_t plane = (size_t)size[0] * size[1];
    struct task task = task_begin(watch, "erosion", plane * size[2]);
    for (uint32_t z = 0; z <= size[2] && task_advance(&task, z ? plane : 0); z++) {
        if (z < size[2])
            judge_plane(goes + z % 2 * plane, region, size, z);
        const bool *former = goes + (z + 1) % 2 * plane;
        uint16_t *at = z ? region + plane * (z - 1) : region;
        for (size_t i = 0; z > 0 && i < plane; i++)
            at[i] = former[i] ? REGION_NONE : at[i];
    }
}

static enum err erode_map(struct volume *map, unsigned rounds, struct watch *watch,
                          struct fault *fault)
{
    if (rounds == 0)
        return OK;
    OWNED(mem_release)
    bool *goes = mem_array(2 * (size_t)map->size[0] * map->size[1], sizeof *goes);
    if (!goes)
        return fault_memory(fault, "the erosion of a label map");
    for (unsigned i = 0; i < rounds; i++)
        erode_once(map->intensity, goes, map->size, watch);
    return watch_fault(watch, fault);
}

unsigned region_label(const struct region_choice *choice, uint32_t region)
{
    return choice->label != LABEL_OWN ? (unsigned)choice->label
           : choice->as               ? choice->as[region]
                                      : region;
}

/* Counts of one region. */
struct stock {
    uint32_t before; /* voxels before erosion */
    uint32_t left;   /* voxels after erosion; while drawing, those still to come */
    uint32_t wanted; /* seeds still to be drawn */
};

static enum err check_stock(const struct stock *stock, const struct region_choice *choice,
                            const struct volume *map, struct region_tally *tally,
                            struct fault *fault)
{
    *tally = (struct region_tally){0};
    for (uint32_t r = choice->first; r <= choice->last; r++) {
        tally->regions += stock[r].left > 0;
        if (!stock[r].before)
            continue;
        if (region_label(choice, r) > 255)
            return map_refuse_region(map_number(map, r), fault);
        if (!stock[r].left && tally->eroded_away++ == 0)
            tally->first_eroded_away = r;
    }
    if (tally->regions)
        return OK;
    if (tally->eroded_away)
        return fault_set(fault, ERR_INPUT,
                         "erode=%u leaves no voxel of regions %u-%u; nothing was planted",
                         choice->erode, choice->first, choice->last);
    return fault_set(fault, ERR_INPUT, "the map has no voxel of regions %u-%u; nothing was planted",
                     choice->first, choice->last);
}

/* True if the next voxel of a region is drawn. */
static bool is_drawn(struct stock *stock, uint32_t region, uint64_t generator)
{
    uint64_t random = hash_mix_at(hash_mix_at(generator, region), stock->left);
    bool drawn = ((random >> 32) * stock->left >> 32) < stock->wanted;
    stock->left--;
    stock->wanted -= drawn;
    return drawn;
}

static enum err draw_all(struct seeds *seeds, struct stock *stock, const struct volume *map,
                         const struct grid *grid, const struct region_choice *choice,
                         struct watch *watch, struct fault *fault)
{
    size_t total = 0;
    for (uint32_t r = choice->first; r <= choice->last; r++) {
        bool all = choice->each == 0 || choice->each > stock[r].left;
        stock[r].wanted = all ? stock[r].left : choice->each;
        total += stock[r].wanted;
    }
    if (!reserve_seeds(seeds, total))
        return fault_memory(fault, "the seeds of a label map");
    const uint16_t *at = map->intensity;
    struct grid_walk w = grid_rows(grid, watch, "drawing seeds");
    while (grid_walk_next(&w))
        for (uint32_t c = w.row.first; c < w.row.end; c++, at++)
            if (*at != REGION_NONE &&
                is_drawn(&stock[*at], map_number(map, *at), choice->generator))
                add_seed(seeds, c, (int)region_label(choice, *at), *at);
    return watch_fault(watch, fault);
}

enum err seeds_from_map(struct seeds *seeds, struct region_tally *tally, struct volume *map,
                        const struct grid *grid, const struct region_choice *choice,
                        struct watch *watch, struct fault *fault)
{
    *seeds = (struct seeds){0};
    OWNED(mem_release) struct stock *stock = mem_new(VALUES * sizeof *stock);
    TRY(stock ? map_to_regions(map, choice->first, choice->last, watch, fault)
              : fault_memory(fault, "the regions of a label map"));
    struct task task = task_begin(watch, "counting regions", 2 * (uint64_t)grid->voxels);
    for (size_t i = 0; i < grid->voxels && task_advance(&task, 1); i++) {
        uint16_t *region = &map->intensity[i];
        if (choice->as && *region != REGION_NONE && choice->as[*region] == REGION_NONE)
            *region = REGION_NONE;
        stock[*region].before++;
    }
    TRY(erode_map(map, choice->erode, watch, fault));
    for (size_t i = 0; i < grid->voxels && task_advance(&task, 1); i++)
        stock[map->intensity[i]].left++;
    TRY(watch_fault(watch, fault));
    TRY(check_stock(stock, choice, map, tally, fault));
    const enum err err = draw_all(seeds, stock, map, grid, choice, watch, fault);
    if (err)
        seeds_release(seeds);
    return err;
}

/* ---- pieces of a segmentation ---- */

void piece_seeds_release(struct piece_seeds *seeds)
{
    free(seeds->cell);
    free(seeds->run);
    free(seeds->piece);
    *seeds = (struct piece_seeds){0};
}

struct work {
    const struct grid *grid;
    const struct piece_choice *choice;
    uint8_t *label; /* [grid->cells], 0 in the rim */
    unsigned spare; /* label used for REGION_NONE; 256: not needed */
    uint8_t *depth; /* [grid->cells], rounds until a voxel is removed, up to `most`; and LEFT */
    uint8_t most;
    uint8_t *least; /* by component: the least depth of the remaining voxels */
    struct components found;
    struct watch *watch;
};

enum {
    LEFT = 128, /* bit of a voxel that remains after erosion */
    INSIDE = 3, /* steps to a corner neighbour: a voxel this much deeper has no other neighbours */
};

/* ---- labels ---- */

static enum err take_labels(struct work *w, const uint16_t *region, struct fault *fault)
{
    const struct grid *grid = w->grid;
    const bool needs_spare = w->choice->rest == REGION_NONE;
    bool is_there[256] = {false};
    struct task task = task_begin(w->watch, "labels of the map", grid->voxels);
    for (size_t i = 0; needs_spare && i < grid->voxels && task_advance(&task, 1); i++)
        if (region[i] != REGION_NONE)
            is_there[region[i]] = true;
    w->spare = needs_spare ? 0 : 256; /* a label that the map does not have; 256 if it has all */
    while (w->spare < 256 && is_there[w->spare])
        w->spare++;
    memset(w->label, 0, grid->cells);
    struct grid_walk rows = grid_rows(grid, w->watch, "labels of the map");
    while (grid_walk_next(&rows))
        for (uint32_t c = rows.row.first; c < rows.row.end; c++, region++) {
            const uint16_t label = *region == REGION_NONE ? w->choice->rest : *region;
            if (label == REGION_NONE && w->spare > 255)
                return fault_set(fault, ERR_INPUT,
                                 "the map has all labels 0..255 and further regions; "
                                 "choose fewer with regions=; nothing was planted");
            w->label[c] = (uint8_t)(label == REGION_NONE ? w->spare : label);
        }
    return OK;
}

/* ---- erosion ---- */

/* Depth allowed by the neighbour at `step`. */
static unsigned depth_beside(const struct work *w, uint32_t cell, ptrdiff_t step, bool is_in_scene)
{
    const uint32_t beside = cell + (uint32_t)step;
    if (!is_in_scene)
        return w->most;
    return w->label[beside] == w->label[cell] ? w->depth[beside] + 1U : 1;
}

/* Update a row whose neighbours on one side are done: forwards (way -1) or backwards (1). */
static void deepen_row(const struct work *w, uint32_t y, uint32_t z, int way)
{
    const struct grid *grid = w->grid;
    const struct span row = grid_row(grid, y, z);
    const uint32_t length = row.end - row.first;
    const bool has_y = way < 0 ? y > 0 : y + 1 < grid->size[1];
    const bool has_z = way < 0 ? z > 0 : z + 1 < grid->size[2];
    for (uint32_t i = 0; i < length; i++) {
        const uint32_t c = way < 0 ? row.first + i : row.end - 1 - i;
        const unsigned x = depth_beside(w, c, way, i > 0);
        const unsigned v = depth_beside(w, c, way * grid->step[1], has_y);
        const unsigned u = depth_beside(w, c, way * grid->step[2], has_z);
        unsigned least = w->depth[c];
        least = x < least ? x : least;
        least = v < least ? v : least;
        w->depth[c] = (uint8_t)(u < least ? u : least);
    }
}

/* City-block distance to another label, by a forward and a backward pass (Rosenfeld, Pfaltz
 * 1966). */
static enum err find_depths(struct work *w, struct fault *fault)
{
    const uint32_t *size = w->grid->size;
    const uint32_t rows = size[1] * size[2];
    struct task task = task_begin(w->watch, "erosion", 2 * (uint64_t)w->grid->voxels);
    memset(w->depth, w->most, w->grid->cells);
    for (uint32_t r = 0; r < rows && task_advance(&task, size[0]); r++)
        deepen_row(w, r % size[1], r / size[1], -1);
    for (uint32_t r = rows; r-- > 0 && task_advance(&task, size[0]);)
        deepen_row(w, r % size[1], r / size[1], 1);
    return watch_fault(w->watch, fault);
}

/* Find the remaining part of each component by the depth of its deepest voxel. */
static void erode_pieces(struct work *w, size_t *small)
{
    const uint8_t wanted = (uint8_t)(w->choice->erode + 1);
    struct task task = task_begin(w->watch, "erosion", 2 * (uint64_t)w->found.runs);
    memset(w->least, 0, w->found.count);
    for (size_t i = 0; i < w->found.runs && task_advance(&task, 1); i++) {
        const struct component_run *run = w->found.run + i;
        uint8_t *least = &w->least[run->component];
        for (uint32_t c = run->first; c < run->end && *least < wanted; c++)
            *least = w->depth[c] > *least ? w->depth[c] : *least;
    }
    for (size_t i = 0; i < w->found.count; i++) {
        *small += w->least[i] < wanted && w->found.item[i].label != w->spare &&
                  w->found.item[i].voxels >= w->choice->least;
        w->least[i] = w->least[i] < wanted ? w->least[i] : wanted;
    }
    for (size_t i = 0; i < w->found.runs && task_advance(&task, 1); i++) {
        const struct component_run *run = w->found.run + i;
        for (uint32_t c = run->first; c < run->end; c++)
            w->depth[c] |= w->depth[c] >= w->least[run->component] ? LEFT : 0;
    }
}

/* ---- contours ---- */

/* True if a remaining voxel is on the contour. */
static bool on_contour(const struct work *w, uint32_t cell, struct place p, uint8_t least)
{
    const struct grid *grid = w->grid;
    if ((w->depth[cell] & ~LEFT) >= least + INSIDE)
        return false;
    for (int z = p.z > 0 ? -1 : 0; z <= (p.z + 1 < grid->size[2]); z++)
        for (int y = p.y > 0 ? -1 : 0; y <= (p.y + 1 < grid->size[1]); y++)
            for (int x = p.x > 0 ? -1 : 0; x <= (p.x + 1 < grid->size[0]); x++) {
                const ptrdiff_t step = x + y * grid->step[1] + z * grid->step[2];
                const uint32_t beside = cell + (uint32_t)step;
                if (w->label[beside] != w->label[cell] || !(w->depth[beside] & LEFT))
                    return true;
            }
    return false;
}

static bool add_cell(struct piece_seeds *seeds, uint32_t cell)
{
    if (!mem_grow(&seeds->cell, &seeds->capacity, seeds->count + 1, sizeof *seeds->cell))
        return false;
    seeds->cell[seeds->count++] = cell;
    return true;
}

/* A piece that is the whole scene has no contour: one seed suffices. */
static bool add_piece(struct piece_seeds *seeds, const struct work *w,
                      const struct component *component, struct task *task)
{
    const size_t before = seeds->count;
    for (uint32_t r = component->run; r != RUN_NONE && task_advance(task, 1);
         r = w->found.run[r].next) {
        const struct component_run *run = w->found.run + r;
        struct place p = grid_place(w->grid, run->first);
        for (uint32_t c = run->first; c < run->end; c++, p.x++)
            if (w->depth[c] & LEFT && on_contour(w, c, p, w->least[run->component]) &&
                !add_cell(seeds, c))
                return false;
    }
    if (seeds->count == before && !add_cell(seeds, w->found.run[component->run].first))
        return false;
    const bool has_runs = seeds->count - before < component->voxels;
    for (uint32_t r = component->run; has_runs && r != RUN_NONE; r = w->found.run[r].next) {
        const struct component_run *run = w->found.run + r;
        if (!mem_grow(&seeds->run, &seeds->run_capacity, seeds->runs + 1, sizeof *seeds->run))
            return false;
        seeds->run[seeds->runs++] = (struct marker_run){run->first, run->end};
    }
    if (!mem_grow(&seeds->piece, &seeds->piece_capacity, seeds->pieces + 1, sizeof *seeds->piece))
        return false;
    seeds->piece[seeds->pieces++] = (struct piece){seeds->count, seeds->runs, component->label};
    seeds->labels[component->label]++;
    return true;
}

/* ---- all pieces ---- */

static enum err make_pieces(struct piece_seeds *seeds, struct work *w, const uint16_t *region,
                            struct fault *fault)
{
    w->label = mem_array(w->grid->cells, 1);
    w->depth = mem_array(w->grid->cells, 1);
    TRY(w->label && w->depth ? take_labels(w, region, fault)
                             : fault_memory(fault, "the pieces of a label map"));
    TRY(components_find(&w->found, w->grid, w->label, w->watch, fault));
    TRY(find_depths(w, fault));
    w->least = mem_array(w->found.count, 1);
    if (!w->least)
        return fault_memory(fault, "the pieces of a label map");
    erode_pieces(w, &seeds->small);
    struct task task = task_begin(w->watch, "seeds of pieces", w->found.runs);
    for (size_t i = 0; i < w->found.count; i++) {
        const struct component *item = w->found.item + i;
        if (item->label == w->spare)
            continue;
        if (item->voxels < w->choice->least)
            seeds->left_out++;
        else if (!add_piece(seeds, w, item, &task))
            return fault_memory(fault, "seeds of pieces");
    }
    return watch_fault(w->watch, fault);
}

enum err piece_seeds_make(struct piece_seeds *seeds, const uint16_t *region,
                          const struct grid *grid, const struct piece_choice *choice,
                          struct watch *watch, struct fault *fault)
{
    struct work work = {.grid = grid,
                        .choice = choice,
                        .most = (uint8_t)(choice->erode + 1 + INSIDE),
                        .watch = watch};
    *seeds = (struct piece_seeds){0};
    const enum err err = make_pieces(seeds, &work, region, fault);
    free(work.label);
    free(work.depth);
    free(work.least);
    components_release(&work.found);
    if (err)
        piece_seeds_release(seeds);
    return err;
}
