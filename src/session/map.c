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

enum { LABELS = 256, OTHER = REGION_NONE - 1 };

/* Return the label with this own number, or LABELS. */
static unsigned kept_label(const struct kept *kept, uint32_t number)
{
    unsigned label = number ? 1 : LABELS;
    while (label < LABELS && kept->label_number[label] != number)
        label++;
    return label;
}

uint16_t numbering_of(const struct kept *kept, unsigned label)
{
    return kept->label_number[label]          ? kept->label_number[label]
           : kept_label(kept, label) < LABELS ? 0
                                              : (uint16_t)label;
}

void numbering_translate(uint16_t *as, const struct kept *kept)
{
    for (unsigned label = 1; label < LABELS; label++)
        if (kept->label_number[label] && as[label] == label)
            as[label] = OTHER;
    for (unsigned label = 1; label < LABELS; label++) {
        const uint16_t number = kept->label_number[label];
        if (number && as[number] != REGION_NONE)
            as[number] = (uint16_t)label;
    }
}

bool numbering_is_used(const struct kept *kept)
{
    bool is_used = false;
    for (unsigned label = 1; label < LABELS; label++)
        is_used |= kept->label_number[label] > 0;
    return is_used;
}

static bool is_chosen(const uint16_t *as, const bool *has, uint32_t r)
{
    return has[r] && as[r] != REGION_NONE;
}

void numbering_list(struct buf *list, const uint16_t *as, const bool has[REGION_MOST + 1],
                    const struct kept *kept)
{
    const bool takes_all = !numbering_is_used(kept);
    bool is_needed = false;
    for (uint32_t r = 1; r <= REGION_MOST; r++)
        is_needed |= is_chosen(as, has, r) && as[r] >= LABELS;
    for (uint32_t r = 1, last; is_needed && r <= REGION_MOST; r = last + 1) {
        last = r;
        if (!is_chosen(as, has, r) || (!takes_all && as[r] < LABELS))
            continue;
        while (last < REGION_MOST && is_chosen(as, has, last + 1) &&
               (takes_all || as[last + 1] >= LABELS))
            last++;
        buf_printf(list, list->length ? ",%u" : "%u", r);
        if (last > r)
            buf_printf(list, "-%u", last);
    }
}

/* ---- numbering by a list ---- */

static enum err refuse(const char *list, unsigned fits, struct fault *fault)
{
    int64_t first, last;
    uint32_t count = 0, low = 0, high = 0;
    for (const char *at = list; scan_list_range(&at, 0, REGION_MOST, &first, &last);)
        for (int64_t r = first; r <= last; r++, count++) {
            low = count == 0 ? (uint32_t)r : low;
            high = count < fits ? (uint32_t)r : high;
        }
    if (fits == 0)
        return fault_set(fault, ERR_INPUT,
                         "it has %u regions that are no labels yet, and no label is free; nothing "
                         "was planted",
                         count);
    return fault_set(fault, ERR_INPUT,
                     "it has %u regions, and labels for %u are free; choose some, as in "
                     "regions=%u-%u, or make all one label with label=1; nothing was planted",
                     count, fits, low, high);
}

enum err numbering_take(struct kept *kept, struct numbering_tally *tally, const char *list,
                        const struct markers *markers, struct fault *fault)
{
    bool is_free[LABELS];
    unsigned label = 1, fits = 0;
    int64_t first, last;
    *tally = (struct numbering_tally){0};
    for (unsigned l = 0; l < LABELS; l++)
        is_free[l] = l && !kept->label_number[l];
    for (size_t i = 0; i < markers->count; i++)
        if (markers->marker[i].is_valid && markers->marker[i].label > 0)
            is_free[markers->marker[i].label] = false;
    for (unsigned l = 0; l < LABELS; l++)
        fits += is_free[l];
    for (const char *at = list; scan_list_range(&at, 1, REGION_MOST, &first, &last);)
        for (int64_t r = first; r <= last; r++) {
            if (kept_label(kept, (uint32_t)r) < LABELS)
                continue;
            while (label < LABELS && !is_free[label])
                label++;
            if (label == LABELS)
                return refuse(list, fits, fault);
            tally->names += *kept->label_name[label] != '\0';
            memset(kept->label_name[label], 0, LABEL_NAME_BYTES);
            kept->label_number[label] = (uint16_t)r;
            tally->first_label = tally->regions++ ? tally->first_label : label;
            tally->last_label = label++;
        }
    return OK;
}

enum err numbering_check(const struct kept *kept, const bool used[256], struct fault *fault)
{
    for (unsigned label = 1; label < LABELS; label++) {
        const unsigned other = kept_label(kept, label);
        if (used[label] && !kept->label_number[label] && other < LABELS)
            return fault_set(fault, ERR_INPUT,
                             "label %u would be %u in a file, and that is the number of label %u; "
                             "`label %u NAME number=N` sets another number; nothing was written",
                             label, label, other, label);
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
    choice.nearest = choice.by_extremes = true;
    struct regrid_order order;
    enum err err = OK;
    if (part && !is_shifted && same_size(size, part->size) &&
        regrid_check(header->size, &header->geometry, size, place->geometry, false, NULL) &&
        find_order(&order, place, header))
        err = choose_part(&choice, part, &order, fault);
    const uint64_t voxels = (uint64_t)size[0] * size[1] * size[2]; /* the scene needs more memory */
    choice.huge = (uint64_t)header->size[0] * header->size[1] * header->size[2] == voxels;
    return err ? err : volume_choose(reader, &choice, fault);
}

/* Reject a map that has neither the size of the scene nor that of its file. */
static enum err refuse_size(const struct map_place *place, const uint32_t is[3],
                            struct fault *fault)
{
    const uint32_t *size = place->grid->size, *whole = place->part->whole;
    return fault_set(fault, ERR_INPUT,
                     "the map has %ux%ux%u voxels, the scene %ux%ux%u, and its file %ux%ux%u; a "
                     "map must be on the grid of the scene or of its file; otherwise use "
                     "resample=yes; nothing has changed",
                     is[0], is[1], is[2], size[0], size[1], size[2], whole[0], whole[1], whole[2]);
}

static enum err check_grid(const struct map_place *place, const struct volume_header *header,
                           struct fault *fault)
{
    const uint32_t *size = header->size;
    const bool names_file = place->resample != REGRID_RESAMPLE && place->part &&
                            place->part->whole[0] && !same_size(size, place->grid->size);
    struct fault *own = names_file ? NULL : fault;
    const enum err err = place->is_copy ? map_check_size(size, place->grid, own)
                                        : regrid_check(size, &header->geometry, place->grid->size,
                                                       place->geometry, place->resample, own);
    return err && names_file ? refuse_size(place, size, fault) : err;
}

static enum err prefix_file(const char *path, enum err err, struct fault *fault)
{
    return err ? fault_prefix(fault, err, "%s", file_name(path)) : OK;
}

enum err map_read(struct volume *map, const char *path, const struct map_place *place,
                  struct watch *watch, struct fault *fault)
{
    struct volume_reader reader;
    enum err err = volume_begin(&reader, path, &place->choice, watch, fault);
    if (!err)
        err = choose_voxels(&reader, place, fault);
    if (!err)
        err = prefix_file(path, check_grid(place, &reader.header, fault), fault);
    reader.header.notes[0] = '\0'; /* notes are for scenes */
    if (!err)
        err = volume_take(map, &reader, fault);
    if (!err && place->names)
        err = volume_read_names(place->names, &reader, map->notes, fault);
    volume_close(&reader);
    if (!err && *reader.header.contents)
        volume_note(map->notes, "volume %" PRIu32 " of %" PRIu32 ": %s", place->choice.volume,
                    reader.header.volumes, reader.header.contents);
    if (err)
        return err;
    err = place->is_copy
              ? map_check_axes(map, place->geometry, fault)
              : regrid(map, place->grid->size, place->geometry, place->resample, watch, fault);
    return prefix_file(path, err, fault);
}

/* ---- numbers ---- */

enum { VALUES = 65536, ODD = VALUES };

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
            return fault_set(
                fault, ERR_INPUT, "voxel %zu,%zu,%zu of the map holds %g; %s; nothing has changed",
                i % row, i % plane / row, i / plane, geometry_value(&map->geometry, is), holds);
        map->intensity[i] = (uint16_t)table[is];
    }
    return watch_fault(watch, fault);
}

/* Replace intensities by the whole numbers they represent: those in first..last unchanged,
 * others by `beyond`, which may be ODD. */
static enum err convert(struct volume *map, uint32_t first, uint32_t last, uint32_t beyond,
                        const char *holds, struct watch *watch, struct fault *fault)
{
    uint32_t *table = mem_array(VALUES, sizeof *table);
    if (map->is_coarse) {
        free(table);
        return fault_set(fault, ERR_INPUT,
                         "its whole numbers span more than the 65536 that a map can hold; %s; "
                         "nothing has changed",
                         holds);
    }
    if (!table)
        return fault_memory(fault, "a map");
    for (uint32_t i = 0; i < VALUES; i++) {
        /* An intensity represents a whole number to within half a step, which the conversion
         * from float32 to 16 bits loses. */
        const double value = geometry_value(&map->geometry, (uint16_t)i);
        const double step = fabs(map->geometry.slope);
        const double n = floor(value + 0.5);
        const bool whole = fabs(value - n) <= (step < 0.2 ? step / 2 : 0.1) + 1e-6;
        table[i] = !whole ? (uint32_t)ODD : n >= first && n <= last ? (uint32_t)n : beyond;
    }
    const enum err err = translate(map, table, holds, watch, fault);
    free(table);
    return err;
}

enum err map_to_regions(struct volume *map, uint32_t first, uint32_t last, struct watch *watch,
                        struct fault *fault)
{
    return convert(map, first, last, REGION_NONE, "regions are whole numbers", watch, fault);
}

enum err map_refuse_region(uint32_t region, struct fault *fault)
{
    return fault_set(fault, ERR_INPUT,
                     "region %u of the map is no label 0..255; choose regions and their labels, as "
                     "in regions=%u,%u as=1,2, or give all one label with label=; nothing has "
                     "changed",
                     region, region, region + 1);
}

/* REGION_NONE if it is not chosen; the result may exceed a label. */
static uint32_t label_of(const struct map_labels *choice, uint16_t region)
{
    const uint32_t as = region == REGION_NONE ? REGION_NONE
                        : choice->as          ? choice->as[region]
                        : region              ? region
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
            return map_refuse_region(map->intensity[i], fault);
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
        const double value = geometry_value(&map->geometry, map->intensity[i]);
        count += value < -0.5 || value > REGION_MOST + 0.5;
    }
    return count;
}

enum err map_to_labels(uint8_t **label, struct volume *map, const struct map_labels *choice,
                       struct watch *watch, struct fault *fault)
{
    const size_t voxels = (size_t)map->size[0] * map->size[1] * map->size[2];
    *label = NULL;
    enum err err = map_to_regions(map, 0, REGION_MOST, watch, fault);
    err = err ? err : map_label(map, choice, watch, fault);
    if (err)
        return err;
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

/* The numbers of a list, in order. */
struct numbers {
    const char *at;
    int64_t next, last;
};

static struct numbers numbers_of(const char *list)
{
    return (struct numbers){list, 1, 0};
}

static bool take_number(struct numbers *numbers, int64_t *number)
{
    if (numbers->next > numbers->last &&
        !scan_list_range(&numbers->at, 0, REGION_MOST, &numbers->next, &numbers->last))
        return false;
    *number = numbers->next++;
    return true;
}

static enum err pair_up(uint16_t *as, const char *regions, const char *labels, struct fault *fault)
{
    struct numbers region = numbers_of(regions), label = numbers_of(labels ? labels : regions);
    int64_t r, l;
    while (take_number(&region, &r)) {
        if (as[r] != REGION_NONE)
            return fault_set(fault, ERR_USAGE, "regions: %lld is listed twice", (long long)r);
        if (!take_number(&label, &l))
            return fault_set(fault, ERR_USAGE,
                             "as: expected a label for each of `regions`; labels are missing from "
                             "region %lld on",
                             (long long)r);
        as[r] = (uint16_t)l;
    }
    if (take_number(&label, &l))
        return fault_set(fault, ERR_USAGE, "as: label %lld and those after it have no region",
                         (long long)l);
    return OK;
}

enum err regions_new(uint16_t **as, const char *regions, const char *labels, struct fault *fault)
{
    *as = NULL;
    if (labels && !regions)
        return fault_set(fault, ERR_USAGE, "as: needs `regions`, which become these labels");
    uint16_t *made = mem_array(REGION_MOST + 1, sizeof *made);
    if (!made)
        return fault_memory(fault, "the regions");
    for (uint32_t r = 0; r <= REGION_MOST; r++)
        made[r] = regions || r == 0 ? REGION_NONE : (uint16_t)r;
    const enum err err = regions ? pair_up(made, regions, labels, fault) : OK;
    if (err)
        free(made);
    else
        *as = made;
    return err;
}

void regions_list(bool listed[256], const uint16_t *as)
{
    for (size_t value = 0; value <= REGION_MOST; value++)
        if (as[value] > 0 && as[value] < 256)
            listed[as[value]] = true;
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
