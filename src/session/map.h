/* SPDX-License-Identifier: MIT */
/*
 * Maps: volumes on the scene's grid whose voxels hold whole numbers. Label maps, masks, weights.
 *
 * Regions are the numbers of a map or a table. Atlases number them up to 65533, but labels are
 * 1..255 (0 is the background), so a user chooses: regions "2001,2002,2101-2110" as "1,2,11-20",
 * the first region as the first label and so on.
 *
 * A copy of a label map keeps the labels that a command has read from a file, which may be moved,
 * changed or deleted later. It is stored with the golden images, so a replay needs neither the file
 * nor the program or learned model that made it. It holds labels 0..255, and 65535 in voxels of
 * regions that were not chosen, as uint16 on the scene's grid, and the names and colours of those
 * labels, if the file has some, and nothing else of the file. Its name is the digest of both, which
 * the command records:
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
#include "session/state.h"

enum { REGION_MOST = 65533, REGION_NONE = 65535 };

/* Make a table of the label of each region, [REGION_MOST + 1], freed by free(); REGION_NONE for
 * one that is not chosen. `regions` NULL chooses 1..REGION_MOST. `labels` NULL uses each region's
 * own number, which may exceed a label. Both are lists as the parser reads them. ERR_USAGE if their
 * lengths differ, or a region is chosen twice. */
enum err regions_new(uint16_t **as, const char *regions, const char *labels, struct fault *fault);

/* Set listed[1..255] for the labels of the chosen regions. */
void regions_list(bool listed[256], const uint16_t *as);

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
    /* Choice from a file with several volumes: has_volume, volume, data, and the command for
     * messages. */
    struct volume_choice choice;
    enum regrid_how resample; /* resample a map on another grid, nearest voxel (image/regrid.h) */
    bool is_copy;             /* the map was written on this grid: compare only sizes and axes */
    struct buf *names;        /* receives the file's table of labels (image/names.h); or NULL */
};

/* Read a map on the scene's grid by volume_read; resample or reject another grid. Size and
 * position are checked before a voxel is read, so that memory is bounded by the scene, or by the
 * user's choice. If the scene is a part of its file and the map covers that file, read the same
 * part, and the middle voxel of each block. Watched, as volume_read is. An error names the file;
 * notes of the map say how it was converted. */
enum err map_read(struct volume *map, const char *path, const struct map_place *place,
                  struct watch *watch, struct fault *fault);

/* Replace intensities by the numbers they represent, in place: first..last, at most REGION_MOST,
 * and REGION_NONE for others. The map is invalid after errors: ERR_INPUT for a fraction,
 * ERR_CANCELLED by the watch, or NULL. */
enum err map_to_regions(struct volume *map, uint32_t first, uint32_t last, struct watch *watch,
                        struct fault *fault);

/* The labels that the regions of a map become. */
enum { LABEL_OWN = -1 };
struct map_labels {
    const uint16_t *as; /* labels of chosen regions (regions_new); NULL: all regions from 1 */
    int label;          /* one label for all chosen regions but 0; LABEL_OWN: that of `as`, or
                           the region's number */
};

/* Replace the regions of a map, converted by map_to_regions, by these labels, in place, and
 * others by REGION_NONE. ERR_INPUT for a region that would be a label above 255, ERR_CANCELLED. */
enum err map_label(struct volume *map, const struct map_labels *choice, struct watch *watch,
                   struct fault *fault);

/* Count voxels whose numbers are not regions; map_to_regions ignores them. */
uint64_t map_count_beyond(const struct volume *map, struct watch *watch);

/* Do both in turn, to a byte per voxel, [z][y][x], freed by free(), with 0 for others. The map
 * is invalid afterwards, and *label is NULL on errors. */
enum err map_to_labels(uint8_t **label, struct volume *map, const struct map_labels *choice,
                       struct watch *watch, struct fault *fault);

/* The error of a region that should be a label and is not in 0..255. */
enum err map_refuse_region(uint32_t region, struct fault *fault);

/* As map_to_regions; ERR_INPUT if a voxel is not a whole number 0..65535. */
enum err map_to_weights(struct volume *map, struct watch *watch, struct fault *fault);

/* ---- copies ---- */

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
 * Own numbers of labels: their numbers in files.
 *
 * A label is 0..255, and atlases number their regions up to 65533. So if a file has regions that
 * cannot be labels of the same number, its regions become labels in ascending order, each the
 * lowest free one, and the label keeps the number: saved maps and tables have it again, and files
 * that are read later are interpreted by it.
 *
 *     a file has 2, 41, 1001, 1035       they become labels 1, 2, 3, 4
 *     label 77 is planted in addition    it has no own number, and is 77 in files
 *
 * A region that has become a label is that label in every later file. A label is free if it has no
 * own number, and no valid marker plants it.
 *
 * Invariants
 *   N1 no two labels have the same own number, and label 0 has none: it is 0 in every file;
 *   N2 the labels of a list of regions depend on the list and the state only.
 */

/* Number of a label in files; 0 for the background, and if its number belongs to another label.
 * */
uint16_t numbering_of(const struct kept *kept, unsigned label);

/* Translate as[r] for regions that would become labels of their numbers (regions_new without
 * labels): own numbers become their labels. A region whose number is another label's exceeds a
 * label, as those above 255 do. */
void numbering_translate(uint16_t *as, const struct kept *kept);

/* True if labels have own numbers. */
bool numbering_is_used(const struct kept *kept);

/* Append to `list`, as the parser reads it, the regions that need numbers: regions in the file
 * (`has`) that `as` chooses and that exceed a label; if no label has an own number yet, all but 0.
 * Append nothing if all regions are labels. */
void numbering_list(struct buf *list, const uint16_t *as, const bool has[REGION_MOST + 1],
                    const struct kept *kept);

/* Result of a list. */
struct numbering_tally {
    unsigned regions, first_label, last_label; /* labels of the first and of the last region */
    unsigned names;                            /* names that were removed from these labels */
};

/* Give free labels the numbers of a list in ascending order, except for existing own numbers. A
 * former name of such a label is removed. ERR_INPUT, and *kept is invalid, if the list is longer
 * than the free labels. */
enum err numbering_take(struct kept *kept, struct numbering_tally *tally, const char *list,
                        const struct markers *markers, struct fault *fault);

/* ERR_INPUT if the number of one of these labels is the own number of another. */
enum err numbering_check(const struct kept *kept, const bool used[256], struct fault *fault);

#endif
