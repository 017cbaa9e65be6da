/* SPDX-License-Identifier: MIT */
/*
 * Maps: volumes on the scene's grid whose voxels hold whole numbers. Label maps, masks, weights.
 *
 * Regions are the numbers of a map or a table. Those of a map become labels of the same numbers, or
 * a user chooses: regions "2001,2002,2101-2110" as "1,2,11-20", the first region as the first label
 * and so on.
 *
 * A copy of a label map keeps the labels that a command has read from a file, which may be moved,
 * changed or deleted later. It is stored with the golden images, so a replay needs neither the file
 * nor the program or learned model that made it. It holds labels 0..255, and 65535 in voxels of
 * regions that were not chosen, or 256 more than the number of one that is kept, as uint16 on the
 * scene's grid, and the names, colours and codes of those labels, if the file has some, and nothing
 * else of the file. Its name is the digest of both, which the command records:
 *
 *     study.golden/labels-0123456789abcdef0123456789abcdef.nii.gz
 */
#ifndef SESSION_MAP_H
#define SESSION_MAP_H

#include "base/buf.h"
#include "base/err.h"
#include "engine/grid.h"
#include "image/regrid.h"
#include "session/markers.h"
#include "session/setting.h"
#include "session/state.h"

/* The last region, a region whose number no label has, and none: not chosen. */
enum { REGION_MOST = 65533, REGION_UNKNOWN = 65534, REGION_NONE = 65535 };

/* Chosen regions, in rising order: `first` to `last` are the labels with numbers from `as` on. */
struct region_range {
    uint32_t first, last, as;
};
struct regions {
    struct region_range *range;
    size_t count;
};
void regions_release(struct regions *regions);

/* Read both lists, as the parser accepts them. `list` NULL chooses all regions but 0, `as` NULL
 * uses each region's own number. ERR_USAGE if their lengths differ, or a region is chosen twice. On
 * errors *regions is empty. */
enum err regions_read(struct regions *regions, const char *list, const char *as,
                      struct fault *fault);

/* Find the number of a region's label. False for a region that is not chosen. */
bool regions_choose(const struct regions *regions, uint32_t region, uint32_t *number);

/* Make a table of the label of each region of a map, [REGION_MOST + 1], freed by free():
 * REGION_NONE for one that is not chosen, REGION_UNKNOWN for one whose number no label has. */
enum err regions_table(uint16_t **as, const struct regions *regions, const struct volume *map,
                       const struct kept *kept, struct fault *fault);

/* Set listed[label] for the labels of the chosen regions, except 0. If 255 regions or fewer are
 * chosen, labels are made of regions without one. */
void regions_list(bool listed[256], const struct regions *regions, struct kept *kept);

/* ERR_USAGE if the regions become a number that no label has. */
enum err regions_check(const struct regions *regions, const struct kept *kept, struct fault *fault);

/* ERR_INPUT if a map of this size is not on the scene's grid. */
enum err map_check_size(const uint32_t is[3], const struct grid *grid, struct fault *fault);

/* ERR_INPUT if the axes of a map run along other axes of the world than those of the scene at
 * `place`. If one of them is unknown, both are assumed equal. */
enum err map_check_axes(const struct volume *map, const struct geometry *place,
                        struct fault *fault);

/* The part of a file that a scene is (image/image_inside.h). All zero: the whole file. */
struct map_part {
    uint32_t whole[3], size[3]; /* voxels of the file, and of the part */
    struct volume_choice choice;
};

/* The grid that a map must have: that of the scene. */
struct map_place {
    const struct grid *grid;
    const struct geometry *geometry;
    const struct map_part *part; /* NULL: the scene is the whole file */
    /* Choice from a file with several volumes or segments: has_volume, volume, data, segments,
     * threshold, and the command for messages. */
    struct volume_choice choice;
    enum regrid_how resample; /* resample a map on another grid, nearest voxel (image/regrid.h) */
    bool is_channel;          /* read intensities as those of a scene, not as numbers of labels */
    bool is_copy;             /* the map was written on this grid: compare only sizes and axes */
    uint8_t *beyond;          /* receives 1 for voxels outside the map, [voxels], all 0; or NULL */
    struct buf *names;        /* receives the file's table of labels (image/names.h); or NULL */
};

/* Read a map on the scene's grid by volume_read; resample or reject another grid. Size and
 * position are checked before a voxel is read, so that memory is bounded by the scene, or by the
 * user's choice. If the scene is a part of its file and the map covers that file, read the same
 * part, and the middle voxel of each block; of a channel the mean. Watched, as volume_read is. An
 * error names the file; notes of the map say how it was converted. */
enum err map_read(struct volume *map, const char *path, const struct map_place *place,
                  struct watch *watch, struct fault *fault);

/* Replace intensities by regions, in place, unless it was done: the numbers first..last that they
 * represent, and REGION_NONE for others. If a number is above REGION_MOST, regions are the ranks of
 * the numbers, and map->number has these. The map is invalid after errors: ERR_INPUT for a
 * fraction, ERR_LIMIT for more than REGION_MOST regions, ERR_MEMORY, ERR_CANCELLED by the watch, or
 * NULL. */
enum err map_to_regions(struct volume *map, uint32_t first, uint32_t last, struct watch *watch,
                        struct fault *fault);

/* The number of a region. */
static inline uint32_t map_number(const struct volume *map, uint32_t region)
{
    return map->number ? map->number[region] : region;
}

/* The labels that the regions of a map become. */
enum { LABEL_OWN = -1 };
struct map_labels {
    const uint16_t *as; /* labels of chosen regions (regions_table); NULL: regions 1..255 */
    int label;          /* one label for all chosen regions but 0; LABEL_OWN: that of `as`, or
                           the region's number */
};

/* Replace the regions of a map, converted by map_to_regions, by these labels, in place, and
 * others by REGION_NONE. ERR_INPUT for a region whose number no label has, ERR_CANCELLED. */
enum err map_label(struct volume *map, const struct map_labels *choice, struct watch *watch,
                   struct fault *fault);

/* Count voxels whose numbers are not 0..2^32 - 1, before map_to_regions makes them REGION_NONE. */
uint64_t map_count_beyond(const struct volume *map, struct watch *watch);

/* map_label to a byte per voxel, [z][y][x], freed by free(), with 0 for others. The map is invalid
 * afterwards. The errors of map_label, and ERR_MEMORY; *label is then NULL. */
enum err map_to_labels(uint8_t **label, struct volume *map, const struct map_labels *choice,
                       struct watch *watch, struct fault *fault);

/* The error of a region without a label. */
enum err map_refuse_region(uint32_t region, struct fault *fault);

/* As map_to_regions; ERR_INPUT if a voxel is not a whole number 0..65535. */
enum err map_to_weights(struct volume *map, struct watch *watch, struct fault *fault);

/* ---- copies ---- */

enum { KEPT_FROM = 256 /* added to the number of a region that is kept */ };
enum { LABEL_COPY_DIGEST = 33 }; /* 32 digits and NUL: 128 bits of SHA-256 */

/* Digest of a map after map_label: over its sides as 32 bits each, then its labels, x fastest,
 * as 16 bits; all little-endian; then the table of its labels (image/names.h). */
enum err label_copy_digest(char digest[LABEL_COPY_DIGEST], const struct volume *map,
                           const struct buf *names, struct watch *watch,
                           struct fault *fault); /* ERR_CANCELLED */

/* Append the file name of a copy. */
void label_copy_name(struct buf *out, const char *digest);

/* Write a new copy, at the place of `geometry`, with names and colours of labels, or NULL. The
 * errors of volume_write. */
enum err label_copy_write(const char *path, const struct volume *map,
                          const struct volume_label label[256], const struct geometry *geometry,
                          struct watch *watch, struct fault *fault);

/*
 * Numbers of labels.
 *
 * A label of the engine is an index 0..255. People, journals, JSON and files see its *number*,
 * 0..4294967295, which is that of the file where the label came from a file. The index is internal.
 *
 * A session begins with the labels 1..255, whose numbers are their indices. As soon as a label gets
 * another number, by `label 300 NAME`, `number=` or a file, the labels are *numbered*: those exist
 * that are planted or have a name, and each further one is made by `label N NAME` or comes from a
 * file. Its index is its number if that is free, or the lowest free one; regions of a file get
 * theirs in rising order.
 *
 *     a file has 2, 41, 1001, 1035       labels 2, 41, 1001, 1035, of index 2, 41, 1, 3
 *     `seed 1,2,3 77`                    is rejected: no label has the number 77
 *     `label 77 lesion`                  makes label 77, of index 77
 *
 * A region that has become a label is that label in every later file. A label that was made
 * otherwise, and is planted, clashes with a region of its number.
 *
 * Invariants
 *   N1 no two labels have the same number, and label 0 has the number 0;
 *   N2 the labels of a list of regions depend on the list and the state only.
 */

/* True if the labels are numbered. */
bool numbering_is_used(const struct kept *kept);

/* Number of a label; 0 for the background, and for a label that does not exist. */
uint32_t numbering_of(const struct kept *kept, unsigned label);

/* The label with a number, or NUMBER_UNKNOWN. */
enum { NUMBER_UNKNOWN = -1 };
int numbering_find(const struct kept *kept, uint32_t number);

/* The existing number from `least` on that is nearest to `number`. */
uint32_t numbering_nearest(const struct kept *kept, uint32_t number, uint32_t least);

/* Get the numbers of all labels, as numbering_of does. */
void numbering_fill(uint32_t number[256], const struct kept *kept);

/* List all labels by rising numbers; labels that do not exist are last. */
void numbering_order(uint8_t order[256], const uint32_t number[256]);

/* Append a set of labels as their numbers, "0,3-7". */
void numbering_write_set(struct buf *out, const uint32_t number[256], const struct label_set *set);

/* Append the steps of `finish` (finish_write). */
void numbering_write_finish(struct buf *out, const struct kept *kept);

/* Make a label with a number that no label has; return it, or NUMBER_UNKNOWN if all 255 exist.
 * `markers` NULL: nothing is planted. */
int numbering_add(struct kept *kept, uint32_t number, const struct markers *markers);

/* Give a label another number. False, and *kept is invalid, if another label has it. */
bool numbering_change(struct kept *kept, int label, uint32_t number, const struct markers *markers);

/* Append to `list`, as the parser reads it, the numbers of the regions that a map has (`has`) and
 * that `as` chooses; nothing if the labels are not numbered and all these regions are labels. */
void numbering_list(struct buf *list, const uint16_t *as, const struct volume *map,
                    const bool has[REGION_MOST + 1], const struct kept *kept);

/* Result of a list. */
struct numbering_tally {
    unsigned added; /* labels that came with files for the first time */
    unsigned names; /* labels that were not planted, and were replaced by some of these */
};

/* Make labels of the regions of a list that have none yet. ERR_INPUT, and *kept is invalid, if the
 * list is longer than the free labels, or a region clashes. */
enum err numbering_take(struct kept *kept, struct numbering_tally *tally, const char *list,
                        const struct markers *markers, struct fault *fault);

/* Find the regions that a map has, after map_to_regions: [REGION_MOST + 1], freed by free(). NULL
 * without memory. */
bool *map_regions(const struct volume *map);

/* Make labels of its chosen regions without one, for a comparison. ERR_LIMIT, ERR_MEMORY. */
enum err numbering_admit(struct kept *kept, const struct volume *map, const struct regions *regions,
                         const struct markers *markers, struct fault *fault);

#endif
