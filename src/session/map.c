/* SPDX-License-Identifier: MIT */
#include "session/map.h"

#include <endian.h>
#include <inttypes.h>
#include <math.h>
#include <nettle/sha2.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/hash.h"
#include "base/mem.h"
#include "base/scan.h"
#include "base/sort.h"

enum { LABELS = 256 };

/* ---- numbers of labels ---- */

bool numbering_is_used(const struct kept *kept)
{
    bool is_used = false;
    for (unsigned label = 1; label < LABELS; label++)
        is_used |= kept->label_number[label] > 0;
    return is_used;
}

uint32_t numbering_of(const struct kept *kept, unsigned label)
{
    return kept->label_number[label] || numbering_is_used(kept) ? kept->label_number[label] : label;
}

int numbering_find(const struct kept *kept, uint32_t number)
{
    if (number == 0)
        return 0;
    for (int label = 1; label < LABELS; label++)
        if (kept->label_number[label] == number)
            return label;
    return number < LABELS && !numbering_is_used(kept) ? (int)number : NUMBER_UNKNOWN;
}

uint32_t numbering_nearest(const struct kept *kept, uint32_t number, uint32_t least)
{
    uint32_t nearest = least, most = UINT32_MAX;
    for (unsigned label = least > 0; label < LABELS; label++) {
        const uint32_t is = numbering_of(kept, label),
                       far = is > number ? is - number : number - is;
        if ((is || !label) && is >= least && far < most) {
            nearest = is;
            most = far;
        }
    }
    return nearest;
}

void numbering_fill(uint32_t number[LABELS], const struct kept *kept)
{
    const bool is_used = numbering_is_used(kept);
    for (unsigned label = 0; label < LABELS; label++)
        number[label] = is_used ? kept->label_number[label] : label;
}

void numbering_order(uint8_t order[LABELS], const uint32_t number[LABELS])
{
    order[0] = 0;
    for (unsigned label = 1; label < LABELS; label++) {
        unsigned at = label; /* a label without a number is behind all others */
        for (; at > 1 && number[order[at - 1]] - 1 > number[label] - 1; at--)
            order[at] = order[at - 1];
        order[at] = (uint8_t)label;
    }
}

void numbering_write_set(struct buf *out, const uint32_t number[LABELS],
                         const struct label_set *set)
{
    uint8_t order[LABELS];
    const char *comma = "";
    numbering_order(order, number);
    for (unsigned i = 0, end; i < LABELS; i = end) {
        end = i + 1;
        if (!label_set_has(set, order[i]) || (i && !number[order[i]]))
            continue;
        while (end < LABELS && label_set_has(set, order[end]) &&
               number[order[end]] == number[order[end - 1]] + 1)
            end++;
        buf_printf(out, "%s%u", comma, number[order[i]]);
        if (end > i + 1)
            buf_printf(out, "-%u", number[order[end - 1]]);
        comma = ",";
    }
}

void numbering_write_finish(struct buf *out, const struct kept *kept)
{
    uint32_t number[LABELS];
    numbering_fill(number, kept);
    finish_write(out, &kept->finish, number);
}

/* Find the labels that are planted. */
static void find_planted(bool planted[LABELS], const struct markers *markers)
{
    memset(planted, 0, LABELS * sizeof *planted);
    for (size_t i = 0; markers && i < markers->count; i++)
        if (markers->marker[i].is_valid && markers->marker[i].label > 0)
            planted[markers->marker[i].label] = true;
}

/* Begin numbered labels: labels exist if they are planted, have a name or came with a file. */
static void begin_numbers(struct kept *kept, const struct markers *markers)
{
    bool planted[LABELS];
    if (numbering_is_used(kept))
        return;
    find_planted(planted, markers);
    for (unsigned label = 1; label < LABELS; label++)
        if (planted[label] || *kept->label_name[label] || kept->label_is_region[label])
            kept->label_number[label] = label;
}

int numbering_add(struct kept *kept, uint32_t number, const struct markers *markers)
{
    int label = 1;
    begin_numbers(kept, markers);
    if (number < LABELS && !kept->label_number[number])
        label = (int)number;
    while (label < LABELS && kept->label_number[label])
        label++;
    if (label == LABELS)
        return NUMBER_UNKNOWN;
    kept->label_number[label] = number;
    return label;
}

bool numbering_change(struct kept *kept, int label, uint32_t number, const struct markers *markers)
{
    const uint32_t former = numbering_of(kept, (unsigned)label);
    begin_numbers(kept, markers);
    kept->label_number[label] = former;
    const int other = numbering_find(kept, number);
    kept->label_number[label] = number;
    return other == label || other == NUMBER_UNKNOWN;
}

static bool is_chosen(const uint16_t *as, const bool *has, uint32_t r)
{
    return has[r] && as[r] != REGION_NONE;
}

void numbering_list(struct buf *list, const uint16_t *as, const struct volume *map,
                    const bool has[REGION_MOST + 1], const struct kept *kept)
{
    bool is_needed = numbering_is_used(kept);
    for (uint32_t r = 1; r <= REGION_MOST; r++)
        is_needed |= is_chosen(as, has, r) && as[r] == REGION_UNKNOWN;
    for (uint32_t r = 1, next; is_needed && r <= REGION_MOST; r = next) {
        next = r + 1;
        if (!is_chosen(as, has, r))
            continue;
        while (next <= REGION_MOST && is_chosen(as, has, next) &&
               map_number(map, next) == map_number(map, next - 1) + 1)
            next++;
        buf_printf(list, list->length ? ",%u" : "%u", map_number(map, r));
        if (next > r + 1)
            buf_printf(list, "-%u", map_number(map, next - 1));
    }
}

bool *map_regions(const struct volume *map)
{
    const size_t voxels = (size_t)map->size[0] * map->size[1] * map->size[2];
    bool *has = mem_new((REGION_MOST + 1) * sizeof *has);
    for (size_t i = 0; has && i < voxels; i++)
        if (map->intensity[i] <= REGION_MOST)
            has[map->intensity[i]] = true;
    return has;
}

/* ---- numbering by a list ---- */

/* The numbers of a list, in order. At the beginning: {list, 1, 0}. */
struct numbers {
    const char *at;
    int64_t next, last;
};

static bool take_number(struct numbers *numbers, uint32_t *number)
{
    if (numbers->next > numbers->last &&
        !scan_list_range(&numbers->at, 0, UINT32_MAX, &numbers->next, &numbers->last))
        return false;
    *number = (uint32_t)numbers->next++;
    return true;
}

/* The list has more new regions than labels are free. */
static enum err refuse_list(const struct kept *kept, const char *list, unsigned fits,
                            struct fault *fault)
{
    struct numbers numbers = {list, 1, 0};
    unsigned count = 0;
    uint32_t low = 0, high = 0;
    for (uint32_t r; take_number(&numbers, &r); count++)
        if (numbering_find(kept, r) != NUMBER_UNKNOWN && count == (high ? count : 0)) {
            low = low ? low : r;
            high = r;
        }
    if (fits == 0)
        return fault_set(fault, ERR_INPUT,
                         "it has %u regions, and some are no labels yet, but no label is "
                         "free; nothing was planted",
                         count);
    return fault_set(fault, ERR_INPUT,
                     "it has %u regions, and labels for %u are free; choose some, as in "
                     "regions=%u-%u, or make all one label with label=1; nothing was planted",
                     count, fits, low, high);
}

/* Take a label that only has a name. */
static int take_named(struct kept *kept, uint32_t number, const bool planted[LABELS])
{
    int label = 1;
    while (label < LABELS && (planted[label] || kept->label_is_region[label]))
        label++;
    if (label == LABELS)
        return NUMBER_UNKNOWN;
    memset(kept->label_name[label], 0, LABEL_NAME_BYTES);
    memset(kept->label_code[label], 0, LABEL_CODE_BYTES);
    kept->label_number[label] = number;
    return label;
}

enum err numbering_take(struct kept *kept, struct numbering_tally *tally, const char *list,
                        const struct markers *markers, struct fault *fault)
{
    bool planted[LABELS];
    struct numbers numbers = {list, 1, 0};
    find_planted(planted, markers);
    *tally = (struct numbering_tally){0};
    for (uint32_t r; take_number(&numbers, &r);) {
        const int label = numbering_find(kept, r);
        if (label > 0 && planted[label] && !kept->label_is_region[label])
            return fault_set(fault, ERR_INPUT,
                             "its region %u has the number of a label that was planted here: "
                             "`label %u NAME number=N` changes the number of that one, or choose "
                             "regions and their labels, as in regions=%u as=%u; nothing was "
                             "planted",
                             r, r, r, r);
        if (label == NUMBER_UNKNOWN)
            continue;
        tally->added += !kept->label_is_region[label];
        kept->label_is_region[label] = true;
    }
    numbers = (struct numbers){list, 1, 0};
    for (uint32_t r; take_number(&numbers, &r);) {
        int label = numbering_find(kept, r);
        if (label != NUMBER_UNKNOWN)
            continue;
        label = numbering_add(kept, r, markers);
        if (label == NUMBER_UNKNOWN) {
            label = take_named(kept, r, planted);
            tally->names += label != NUMBER_UNKNOWN;
        }
        if (label == NUMBER_UNKNOWN)
            return refuse_list(kept, list, tally->added, fault);
        kept->label_is_region[label] = true;
        tally->added++;
    }
    return OK;
}

enum err map_check_size(const uint32_t is[3], const struct grid *grid, struct fault *fault)
{
    const uint32_t *size = grid->size;
    if (same_size(is, size))
        return OK;
    return fault_set(fault, ERR_INPUT,
                     "the map has %ux%ux%u voxels and the scene %ux%ux%u; a map must be on the "
                     "scene's grid; nothing has changed",
                     is[0], is[1], is[2], size[0], size[1], size[2]);
}

enum err map_check_axes(const struct volume *map, const struct geometry *place, struct fault *fault)
{
    const struct geometry *own = &map->geometry;
    if (own->orientation != ORIENTATION_UNKNOWN && place->orientation != ORIENTATION_UNKNOWN)
        for (int a = 0; a < 3; a++)
            if (own->world_axis[a] != place->world_axis[a] ||
                own->world_sign[a] != place->world_sign[a])
                return fault_set(fault, ERR_INPUT,
                                 "the voxels of the map run along other axes of the world than the "
                                 "scene's; bring it to the scene's grid; nothing has changed");
    return OK;
}

/* Voxels of the file in one voxel of the part, along an axis. */
static uint32_t part_step(const struct map_part *part, int a)
{
    const struct volume_choice *choice = &part->choice;
    const uint32_t count =
        choice->has_crop ? choice->last[a] - choice->first[a] + 1 : part->whole[a];
    return choice->reduce > 1 && count >= choice->reduce ? choice->reduce : 1;
}

/* Find the order of axes in which a map has the voxels of the scene's file; the map's own order
 * if they cannot be compared. False if the map has other voxels. */
static bool find_order(struct regrid_order *order, const struct map_place *place,
                       const struct volume_header *header)
{
    const struct map_part *part = place->part;
    struct geometry whole = *place->geometry;
    double first[3], step[3];
    for (int a = 0; a < 3; a++) { /* from the part's voxels to those of the file */
        const uint32_t blocks = part_step(part, a);
        step[a] = 1.0 / blocks;
        first[a] = -(part->choice.first[a] + (blocks - 1) / 2.0) * step[a];
    }
    if (geometry_derive(&whole, first, step) &&
        regrid_find_order(order, header->size, &header->geometry, part->whole, &whole))
        return true;
    *order = (struct regrid_order){.axis = {0, 1, 2}};
    return same_size(header->size, part->whole);
}

/* Choose the scene's part of such a map, in that order of axes. */
static enum err choose_part(struct volume_choice *choice, const struct map_part *part,
                            const struct regrid_order *order, struct fault *fault)
{
    choice->has_crop = true;
    choice->reduce = part->choice.reduce;
    for (int a = 0; a < 3; a++) {
        const uint32_t step = part_step(part, a), begin = part->choice.first[a];
        const uint32_t end = begin + part->size[a] * step;
        const bool turned = order->is_reversed[a];
        if (turned && step % 2 == 0)
            return fault_set(fault, ERR_INPUT,
                             "its axes are reversed to those of the scene, where each voxel is "
                             "%u along an axis of the file, so that the middle voxel differs; "
                             "use a map with the axes of the scene's file; nothing has changed",
                             step);
        choice->first[order->axis[a]] = turned ? part->whole[a] - end : begin;
        choice->last[order->axis[a]] = (turned ? part->whole[a] - begin : end) - 1;
    }
    return OK;
}

/* Choose the voxels of a map to read: all, or the scene's part of its file. No other option of
 * the scene's file applies to the map. */
static enum err choose_voxels(struct volume_reader *reader, const struct map_place *place,
                              struct fault *fault)
{
    const struct volume_header *header = &reader->header;
    const struct map_part *part = place->part;
    const uint32_t *size = place->grid->size;
    const bool is_shifted = place->resample == REGRID_RESAMPLE &&
                            geometry_has_place(&header->geometry) &&
                            geometry_has_place(place->geometry); /* then all of it is needed */
    struct volume_choice choice = place->choice;
    choice.nearest = choice.by_extremes = !place->is_channel;
    struct regrid_order order;
    if (part && !is_shifted && same_size(size, part->size) &&
        regrid_check(header->size, &header->geometry, size, place->geometry, false, NULL) &&
        find_order(&order, place, header))
        TRY(choose_part(&choice, part, &order, fault));
    const uint64_t voxels = (uint64_t)size[0] * size[1] * size[2]; /* the scene needs more memory */
    choice.huge = (uint64_t)header->size[0] * header->size[1] * header->size[2] <= voxels;
    return volume_choose(reader, &choice, fault);
}

/* Planes without a segment are missing in DICOM SEG: they are background. Not by a proof, which
 * is for whole files (T1 of command/trust.h). */
static enum regrid_how how_of(const struct map_place *place, const struct volume_header *header)
{
    return header->is_segments && !place->choice.proof && place->resample != REGRID_RESAMPLE &&
                   regrid_is_aligned(header->size, &header->geometry, place->grid->size,
                                     place->geometry)
               ? REGRID_FILL
               : place->resample;
}

static enum err check_grid(const struct map_place *place, const struct volume_header *header,
                           struct fault *fault)
{
    const uint32_t *is = header->size, *size = place->grid->size;
    if (how_of(place, header) == REGRID_FILL)
        return OK;
    const uint32_t *whole = place->part ? place->part->whole : NULL;
    const bool names_file =
        place->resample != REGRID_RESAMPLE && whole && whole[0] && !same_size(is, size);
    struct fault *own = names_file ? NULL : fault;
    const enum err err = place->is_copy ? map_check_size(is, place->grid, own)
                                        : regrid_check(is, &header->geometry, size, place->geometry,
                                                       place->resample, own);
    if (!err || !names_file)
        return err;
    return fault_set(fault, ERR_INPUT,
                     "the map has %ux%ux%u voxels, the scene %ux%ux%u, and its file %ux%ux%u; a "
                     "map must be on the grid of the scene or of its file%s; otherwise use "
                     "resample=yes, for its nearest voxels; nothing has changed",
                     is[0], is[1], is[2], size[0], size[1], size[2], whole[0], whole[1], whole[2],
                     header->is_segments ? ", and DICOM SEG lacks planes without segments" : "");
}

static enum err prefix_file(const char *path, enum err err, struct fault *fault)
{
    return fault_prefix(fault, err, "%s", file_name(path));
}

/* The distance of slices of the scene's file, in nanometres. */
static uint32_t find_depth(const struct map_place *place)
{
    const double nm = geometry_step_mm(place->geometry, 2) * geometry_fill(place->geometry) * 1e6 /
                      (place->part ? part_step(place->part, 2) : 1);
    return nm < UINT32_MAX ? (uint32_t)(nm + 0.5) : 0;
}

enum err map_read(struct volume *map, const char *path, const struct map_place *place,
                  struct watch *watch, struct fault *fault)
{
    OWNED(volume_close) struct volume_reader reader;
    struct volume_choice choice = place->choice;
    choice.names = place->names;
    choice.step_nm = place->is_copy ? 0 : find_depth(place);
    TRY(volume_begin(&reader, path, &choice, watch, fault));
    TRY(choose_voxels(&reader, place, fault));
    TRY(prefix_file(path, check_grid(place, &reader.header, fault), fault));
    reader.header.notes[0] = '\0'; /* notes are for scenes */
    TRY(volume_take(map, &reader, fault));
    if (place->names)
        TRY(volume_read_names(place->names, &reader, map->notes, fault));
    if (*reader.header.contents)
        volume_note(map->notes, "volume %" PRIu32 " of %" PRIu32 ": %s", place->choice.volume,
                    reader.header.volumes, reader.header.contents);
    if (map->geometry.frame && place->geometry->frame &&
        map->geometry.frame != place->geometry->frame)
        volume_note(map->notes, "another DICOM frame of reference than the scene's: its positions "
                                "may be those of another examination; check them in slices");
    const enum err err =
        place->is_copy
            ? map_check_axes(map, place->geometry, fault)
            : regrid(map, place->grid->size, place->geometry, how_of(place, &reader.header),
                     reader.header.is_segments ? NULL : place->beyond, watch, fault);
    return prefix_file(path, err, fault);
}

/* ---- numbers ---- */

enum { VALUES = 65536, ODD = VALUES };

static double value_at(const struct volume *map, uint32_t intensity)
{
    return !map->value               ? geometry_value(&map->geometry, intensity)
           : intensity < map->values ? map->value[intensity]
                                     : NAN;
}

/* Replace intensities by entries of the table, unless those are ODD; `holds` is for the message.
 * */
static enum err translate(struct volume *map, const uint32_t *table, const char *holds,
                          struct watch *watch, struct fault *fault)
{
    const size_t row = map->size[0], plane = row * map->size[1], voxels = plane * map->size[2];
    struct task task = task_begin(watch, "numbers of the map", voxels);
    for (size_t i = 0; i < voxels && task_advance(&task, 1); i++) {
        const uint16_t is = map->intensity[i];
        if (table[is] == ODD)
            return fault_set(fault, ERR_INPUT,
                             "voxel %zu,%zu,%zu of the map holds %.10g; %s; nothing has changed",
                             i % row, i % plane / row, i / plane, value_at(map, is), holds);
        map->intensity[i] = (uint16_t)table[is];
    }
    return watch_fault(watch, fault);
}

/* Get the whole number of an intensity; false for a fraction. An intensity represents it to within
 * half a step, which the conversion from float32 to 16 bits loses. */
static bool take_whole(double *number, const struct volume *map, uint32_t intensity)
{
    const double value = value_at(map, intensity), step = fabs(map->geometry.slope);
    *number = floor(value + 0.5);
    return fabs(value - *number) <= (step < 0.2 ? step / 2 : 0.1) + 1e-6;
}

/* Replace numbers above REGION_MOST in the table of intensities by the ranks of all numbers, and 0,
 * that the map has. */
static enum err rank_numbers(uint32_t *table, struct volume *map, uint32_t first, uint32_t last,
                             struct fault *fault)
{
    const size_t voxels = (size_t)map->size[0] * map->size[1] * map->size[2];
    OWNED(mem_release) bool *has = mem_new(VALUES * sizeof *has);
    OWNED(mem_release) uint32_t *number = mem_new(VALUES * sizeof *number);
    uint32_t count = 1;
    bool is_wide = false;
    if (!has || !number)
        return fault_memory(fault, "a map");
    for (size_t i = 0; i < voxels; i++)
        has[map->intensity[i]] = true;
    for (uint32_t k = 0; k < VALUES; k++) {
        const uint32_t i = map->geometry.slope < 0 ? VALUES - 1 - k : k; /* by rising numbers */
        double n;
        if (!has[i] || table[i] == ODD || !take_whole(&n, map, i) || n < first || n > last)
            continue;
        if ((uint32_t)n > number[count - 1] && count < VALUES)
            number[count++] = (uint32_t)n;
        is_wide |= n > REGION_MOST;
        has[i] = false;
    }
    if (count > REGION_MOST + 1)
        return fault_set(fault, ERR_LIMIT, "it has more than %d regions", REGION_MOST);
    for (uint32_t k = 0, rank = 0; is_wide && k < VALUES; k++) {
        const uint32_t i = map->geometry.slope < 0 ? VALUES - 1 - k : k;
        double n;
        if (table[i] == ODD || !take_whole(&n, map, i) || n < first || n > last)
            continue;
        while (rank + 1 < count && number[rank] < (uint32_t)n)
            rank++;
        table[i] = number[rank] == (uint32_t)n ? rank : REGION_NONE;
    }
    if (is_wide) {
        map->number = number;
        number = NULL;
    }
    return OK;
}

/* Replace intensities by the whole numbers they represent: those in first..last unchanged, but for
 * rank_numbers, others by `beyond`, which may be ODD. */
static enum err convert(struct volume *map, uint32_t first, uint32_t last, uint32_t beyond,
                        const char *holds, struct watch *watch, struct fault *fault)
{
    OWNED(mem_release) uint32_t *table = mem_array(VALUES, sizeof *table);
    if (map->is_coarse)
        return fault_set(fault, ERR_INPUT,
                         "its whole numbers span more than the 65536 that a map can hold; %s; "
                         "nothing has changed",
                         holds);
    if (!table)
        return fault_memory(fault, "a map");
    bool is_wide = false;
    for (uint32_t i = 0; i < VALUES; i++) {
        double n;
        const bool is_whole = take_whole(&n, map, i), is_in = is_whole && n >= first && n <= last;
        is_wide |= is_in && n > REGION_MOST && beyond != ODD;
        table[i] = !is_whole ? (uint32_t)ODD : is_in && n < ODD ? (uint32_t)n : beyond;
    }
    TRY(is_wide ? rank_numbers(table, map, first, last, fault) : OK);
    return translate(map, table, holds, watch, fault);
}

enum err map_to_regions(struct volume *map, uint32_t first, uint32_t last, struct watch *watch,
                        struct fault *fault)
{
    if (map->has_regions)
        return OK;
    map->has_regions = true;
    return convert(map, first, last, REGION_NONE, "regions are whole numbers", watch, fault);
}

enum err map_refuse_region(uint32_t region, struct fault *fault)
{
    return fault_set(fault, ERR_INPUT,
                     "region %u of the map is no label; `label %u NAME` makes it one; or choose "
                     "regions and their labels, as in regions=%u,%u as=1,2, or give all one label "
                     "with label=; nothing has changed",
                     region, region, region, region + 1);
}

/* REGION_NONE if it is not chosen; the result may exceed a label. */
static uint32_t label_of(const struct map_labels *choice, uint16_t region)
{
    const uint32_t as = region > REGION_MOST ? REGION_NONE
                        : choice->as         ? choice->as[region]
                        : region             ? region
                                             : REGION_NONE;
    return as == REGION_NONE || !region || choice->label == LABEL_OWN ? as
                                                                      : (uint32_t)choice->label;
}

enum err map_label(struct volume *map, const struct map_labels *choice, struct watch *watch,
                   struct fault *fault)
{
    const size_t voxels = (size_t)map->size[0] * map->size[1] * map->size[2];
    struct task task = task_begin(watch, "labels of the map", voxels);
    for (size_t i = 0; i < voxels && task_advance(&task, 1); i++) {
        const uint32_t label = label_of(choice, map->intensity[i]);
        if (label > 255 && label != REGION_NONE)
            return map_refuse_region(map_number(map, map->intensity[i]), fault);
        map->intensity[i] = (uint16_t)label;
    }
    return watch_fault(watch, fault);
}

uint64_t map_count_beyond(const struct volume *map, struct watch *watch)
{
    const size_t voxels = (size_t)map->size[0] * map->size[1] * map->size[2];
    struct task task = task_begin(watch, "numbers of the map", voxels);
    uint64_t count = 0;
    for (size_t i = 0; i < voxels && task_advance(&task, 1); i++) {
        const double value = value_at(map, map->intensity[i]);
        count += value < -0.5 || value > UINT32_MAX + 0.5;
    }
    return count;
}

enum err map_to_labels(uint8_t **label, struct volume *map, const struct map_labels *choice,
                       struct watch *watch, struct fault *fault)
{
    const size_t voxels = (size_t)map->size[0] * map->size[1] * map->size[2];
    *label = NULL;
    TRY(map_label(map, choice, watch, fault));
    uint8_t *made = *label = mem_array(voxels, 1);
    if (!made)
        return fault_memory(fault, "a map");
    for (size_t i = 0; i < voxels; i++)
        made[i] = map->intensity[i] == REGION_NONE ? 0 : (uint8_t)map->intensity[i];
    return OK;
}

enum err map_to_weights(struct volume *map, struct watch *watch, struct fault *fault)
{
    return convert(map, 0, UINT16_MAX, ODD, "weights are whole numbers 0..65535", watch, fault);
}

/* ---- chosen regions ---- */

void regions_release(struct regions *regions)
{
    free(regions->range);
    *regions = (struct regions){0};
}

/* Take as many regions as have labels one after another. */
static enum err pair_up(struct regions *regions, const char *list, const char *as,
                        struct fault *fault)
{
    int64_t first = 1, last = 0, label = 1, last_label = 0;
    size_t capacity = 0;
    while (first <= last || scan_list_range(&list, 0, UINT32_MAX, &first, &last)) {
        if (!as)
            label = first, last_label = last;
        else if (label > last_label && !scan_list_range(&as, 0, UINT32_MAX, &label, &last_label))
            return fault_set(fault, ERR_USAGE,
                             "as: expected a label for each of `regions`; labels are missing from "
                             "region %lld on",
                             (long long)first);
        const int64_t more = last - first < last_label - label ? last - first : last_label - label;
        if (!mem_grow(&regions->range, &capacity, regions->count + 1, sizeof *regions->range))
            return fault_memory(fault, "the regions");
        regions->range[regions->count++] =
            (struct region_range){(uint32_t)first, (uint32_t)(first + more), (uint32_t)label};
        first += more + 1;
        label += more + 1;
    }
    if (as && (label <= last_label || scan_list_range(&as, 0, UINT32_MAX, &label, &last_label)))
        return fault_set(fault, ERR_USAGE, "as: label %lld and those after it have no region",
                         (long long)label);
    qsort(regions->range, regions->count, sizeof *regions->range, sort_compare_32);
    for (size_t i = 1; i < regions->count; i++)
        if (regions->range[i].first <= regions->range[i - 1].last)
            return fault_set(fault, ERR_USAGE, "regions: %u is listed twice",
                             regions->range[i].first);
    return OK;
}

enum err regions_read(struct regions *regions, const char *list, const char *as,
                      struct fault *fault)
{
    *regions = (struct regions){0};
    if (as && !list)
        return fault_set(fault, ERR_USAGE, "as: needs `regions`, which become these labels");
    const enum err err = pair_up(regions, list ? list : "1-4294967295", as, fault);
    if (err)
        regions_release(regions);
    return err;
}

bool regions_choose(const struct regions *regions, uint32_t region, uint32_t *number)
{
    size_t low = 0, high = regions->count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        const struct region_range *range = &regions->range[middle];
        if (region >= range->first && region <= range->last) {
            *number = range->as + (region - range->first);
            return true;
        }
        if (region < range->first)
            high = middle;
        else
            low = middle + 1;
    }
    return false;
}

enum err regions_table(uint16_t **as, const struct regions *regions, const struct volume *map,
                       const struct kept *kept, struct fault *fault)
{
    uint16_t *made = *as = mem_array(REGION_MOST + 1, sizeof *made);
    const uint32_t known = numbering_is_used(kept) ? UINT32_MAX : LABELS - 1;
    if (!made)
        return fault_memory(fault, "the regions");
    for (uint32_t r = 0, number = 0; r <= REGION_MOST; r++) {
        const bool is_there = regions_choose(regions, map_number(map, r), &number);
        const int label = !is_there        ? REGION_NONE
                          : number > known ? NUMBER_UNKNOWN
                                           : numbering_find(kept, number);
        made[r] = (uint16_t)(label == NUMBER_UNKNOWN ? REGION_UNKNOWN : label);
    }
    return OK;
}

void regions_list(bool listed[LABELS], const struct regions *regions, struct kept *kept)
{
    uint64_t count = 0;
    for (size_t i = 0; i < regions->count; i++)
        count += (uint64_t)regions->range[i].last - regions->range[i].first + 1;
    for (size_t i = 0; i < regions->count && count < LABELS; i++)
        for (uint32_t k = 0; k <= regions->range[i].last - regions->range[i].first; k++)
            if (numbering_find(kept, regions->range[i].as + k) == NUMBER_UNKNOWN)
                numbering_add(kept, regions->range[i].as + k, NULL);
    for (unsigned label = 1; label < LABELS; label++)
        for (size_t i = 0; i < regions->count && numbering_of(kept, label); i++) {
            const struct region_range *range = &regions->range[i];
            const uint32_t number = numbering_of(kept, label);
            listed[label] |=
                number >= range->as && number - range->as <= range->last - range->first;
        }
}

enum err regions_check(const struct regions *regions, const struct kept *kept, struct fault *fault)
{
    for (size_t i = 0; i < regions->count; i++) {
        const struct region_range *range = &regions->range[i];
        for (uint32_t k = 0; k <= range->last - range->first; k++) /* at most 256 exist */
            if (numbering_find(kept, range->as + k) == NUMBER_UNKNOWN)
                return fault_set(fault, ERR_USAGE,
                                 "as: there is no label %u; `label %u NAME` makes it; nothing has "
                                 "changed",
                                 range->as + k, range->as + k);
    }
    return OK;
}

enum err numbering_admit(struct kept *kept, const struct volume *map, const struct regions *regions,
                         const struct markers *markers, struct fault *fault)
{
    OWNED(mem_release) bool *has = map_regions(map);
    if (!has)
        return fault_memory(fault, "the regions");
    unsigned wanted = 0;
    for (uint32_t r = 0, number; r <= REGION_MOST; r++) {
        const bool is_there = has[r] && regions_choose(regions, map_number(map, r), &number);
        const int label = is_there ? numbering_find(kept, number) : 0;
        wanted += label == NUMBER_UNKNOWN;
        if (label > 0)
            kept->label_is_region[label] = true;
    }
    for (uint32_t r = 0, number; wanted && r <= REGION_MOST; r++) {
        if (!has[r] || !regions_choose(regions, map_number(map, r), &number) ||
            numbering_find(kept, number) != NUMBER_UNKNOWN)
            continue;
        const int label = numbering_add(kept, number, markers);
        if (label == NUMBER_UNKNOWN)
            break;
        kept->label_is_region[label] = true;
        wanted--;
    }
    return wanted
               ? fault_set(fault, ERR_LIMIT,
                           "more than 255 labels at a time, by %u; choose some with regions=, as "
                           "in regions=1-100",
                           wanted)
               : OK;
}

/* ---- copies ---- */

enum { PIECE = 4096 };

enum err label_copy_digest(char digest[LABEL_COPY_DIGEST], const struct volume *map,
                           const struct buf *names, struct watch *watch, struct fault *fault)
{
    const size_t voxels = (size_t)map->size[0] * map->size[1] * map->size[2];
    struct sha256_ctx sha;
    uint32_t size[3];
    uint16_t piece[PIECE];
    struct task task = task_begin(watch, "digest of the labels", voxels);
    for (int a = 0; a < 3; a++)
        size[a] = htole32(map->size[a]);
    sha256_init(&sha);
    sha256_update(&sha, sizeof size, (const uint8_t *)size);
    for (size_t i = 0; i < voxels && task_advance(&task, PIECE);) {
        size_t n = 0;
        while (n < PIECE && i < voxels)
            piece[n++] = htole16(map->intensity[i++]);
        sha256_update(&sha, n * sizeof *piece, (const uint8_t *)piece);
    }
    if (names->length)
        sha256_update(&sha, names->length, (const uint8_t *)names->data);
    sha256_hex(digest, &sha, (LABEL_COPY_DIGEST - 1) / 2);
    return watch_fault(watch, fault);
}

void label_copy_name(struct buf *out, const char *digest)
{
    buf_printf(out, "labels-%s.nii.gz", digest);
}

static void copy_row(void *context, uint32_t y, uint32_t z, void *values)
{
    const struct volume *map = context;
    const size_t row = map->size[0];
    memcpy(values, map->intensity + row * (y + (size_t)map->size[1] * z), row * sizeof(uint16_t));
}

enum err label_copy_write(const char *path, const struct volume *map,
                          const struct volume_label label[256], const struct geometry *geometry,
                          struct watch *watch, struct fault *fault)
{
    const struct volume_map copy = {.size = map->size,
                                    .geometry = geometry,
                                    .type = VOXEL_UINT16,
                                    .description = "iftty labels, copied",
                                    .row = copy_row,
                                    .context = (void *)(uintptr_t)map,
                                    .label = label};
    return volume_write(path, FILE_KEEP, &copy, watch, fault);
}
