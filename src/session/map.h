/* SPDX-License-Identifier: MIT */
/*
 * Maps: volumes on the scene's grid whose voxels hold whole numbers. Label maps, masks, weights.
 *
 * Regions are the numbers of a map or a table. Atlases number them up to 65533, and labels are
 * 1..255 (0 for the background), so a user chooses: regions "2001,2002,2101-2110" as "1,2,11-20",
 * the first region the first label and so on.
 *
 * A copy of a label map is what a command has taken from a file that somebody else may move, change
 * or delete, as the result of a learned model. It lies beside the journal, in the folder of its
 * golden images, and goes with it; so a replay needs neither the file nor the model. It holds
 * labels 0..255, and 65535 in voxels of regions that were not chosen, as uint16 on the scene's
 * grid, and nothing that the file said besides. Its name is the digest of those numbers, which the
 * command records:
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

/* The label that each region becomes, [REGION_MOST + 1], freed by free(); REGION_NONE for one that
 * is not chosen. `regions` NULL chooses 1..REGION_MOST. `labels` NULL gives each its own number,
 * which may be none of a label. Both are lists as the parser takes them. ERR_USAGE where they are
 * not of one length, or choose a region twice. */
enum err regions_new(uint16_t **as, const char *regions, const char *labels, struct fault *fault);

/* The labels that the chosen regions become: listed[1..255]. */
void regions_list(bool listed[256], const uint16_t *as);

/* ERR_INPUT where a map of this size does not lie on the scene's grid. */
enum err map_check_size(const uint32_t is[3], const struct grid *grid, struct fault *fault);

/* ERR_INPUT where a map runs along other axes of the world than the scene at `place`; where one of
 * both does not say, it is taken to lie as the other. */
enum err map_check_axes(const struct volume *map, const struct geometry *place,
                        struct fault *fault);

/* Which part of its file a scene is (image/image_inside.h). All zero: it is the whole. */
struct map_part {
    uint32_t whole[3], size[3]; /* voxels of the file, and of the part */
    struct volume_choice choice;
};

/* Where maps have to lie: on the scene's grid. */
struct map_place {
    const struct grid *grid;
    const struct geometry *geometry;
    const struct map_part *part; /* or NULL: it is the whole */
    /* Of the file, where it holds several: has_volume, volume, data, and the command for words. */
    struct volume_choice choice;
    enum regrid_how
        resample; /* one that lies elsewhere is taken by its nearest voxels (image/regrid.h) */
    bool is_copy; /* the map was written on this grid: compare sizes and axes only */
};

/* volume_read, on the scene's grid: what lies elsewhere is resampled, or refused. Size and place
 * are asked before a voxel is read, so that memory is bounded by the scene, or by what the user has
 * asked for. Of a map on the grid of the whole file, of which the scene is a part, the same part is
 * read, the voxel in the middle of each block. Watched, as volume_read is. The words of an error
 * name the file; notes of the map are what was done to bring it here. */
enum err map_read(struct volume *map, const char *path, const struct map_place *place,
                  struct watch *watch, struct fault *fault);

/* Replaces intensities by the numbers they stand for, in place: those of first..last, at most
 * REGION_MOST, and REGION_NONE for others. With the map of no use any more: ERR_INPUT where one is
 * not whole, ERR_CANCELLED by the watch, or NULL. */
enum err map_to_regions(struct volume *map, uint32_t first, uint32_t last, struct watch *watch,
                        struct fault *fault);

/* Which labels the regions of a map become. */
enum { LABEL_OWN = -1 };
struct map_labels {
    const uint16_t *as; /* those chosen and their labels (regions_new); NULL: 1 and above */
    int label;          /* of all that are chosen but 0, or LABEL_OWN: by `as`, or its number */
};

/* Replaces the regions of a map that has been through map_to_regions by these labels, in place, and
 * others by REGION_NONE. ERR_INPUT for a region that would be a label above 255, ERR_CANCELLED. */
enum err map_label(struct volume *map, const struct map_labels *choice, struct watch *watch,
                   struct fault *fault);

/* How many voxels hold numbers that are those of no region, which map_to_regions passes over. */
uint64_t map_count_beyond(const struct volume *map, struct watch *watch);

/* Both in turn, as a byte a voxel, [z][y][x], freed by free(), with 0 for others. The map is of no
 * use afterwards, and *label NULL on errors. */
enum err map_to_labels(uint8_t **label, struct volume *map, const struct map_labels *choice,
                       struct watch *watch, struct fault *fault);

/* The error of a region that is no label 0..255 and was to be one. */
enum err map_refuse_region(uint32_t region, struct fault *fault);

/* As map_to_regions; ERR_INPUT where one is not a whole number 0..65535. */
enum err map_to_weights(struct volume *map, struct watch *watch, struct fault *fault);

/* ---- copies ---- */

enum { LABEL_COPY_DIGEST = 33 }; /* 32 digits and NUL: 128 bits of SHA-256 */

/* Of a map as map_label leaves it: over its sides as 32 bits each, then its labels, x fastest, as
 * 16 bits; all little-endian. */
enum err label_copy_digest(char digest[LABEL_COPY_DIGEST], const struct volume *map,
                           struct watch *watch, struct fault *fault); /* ERR_CANCELLED */

/* Adds the name of a copy in its folder. */
void label_copy_name(struct buf *out, const char *digest);

/* Writes it, at the place of `geometry`; there is none yet. The errors of volume_write. */
enum err label_copy_write(const char *path, const struct volume *map,
                          const struct geometry *geometry, struct watch *watch,
                          struct fault *fault);

/*
 * Own numbers of labels: what they are called in files.
 *
 * A label is 0..255, and atlases number their regions up to 65533 (session/map.h). So regions
 * of a file that are not all labels by their own numbers become labels in rising order, each the
 * lowest that is free, and the label remembers its number: maps and tables that are saved have it
 * again, and those that are read are understood by it.
 *
 *     a file has 2, 41, 1001, 1035       they become labels 1, 2, 3, 4
 *     label 77 is planted beside them    it has no own number, and is 77 in files
 *
 * A region that has become a label once is that label in every file from then on. A label is free
 * where it has no own number, and no marker that stands plants it.
 *
 * Invariants
 *   N1 no two labels have the same own number, and label 0 has none: it is 0 in every file;
 *   N2 which labels the regions of a list become follows from the list and the state.
 */

/* What a label is in files; 0 for the background, and where its number is another label's. */
uint16_t numbering_of(const struct kept *kept, unsigned label);

/* Of regions that would become labels of their numbers (regions_new without labels), as[r]: those
 * that are own numbers become these labels; one that is another label's is none, as those above
 * 255 are. */
void numbering_translate(uint16_t *as, const struct kept *kept);

/* Whether labels have own numbers. */
bool numbering_is_used(const struct kept *kept);

/* Adds to `list`, as the parser takes it, the regions that are to be numbered: of those that a file
 * `has` and `as` chooses, the ones that are no label; where no label has an own number yet, all of
 * them but 0. Nothing where all of them are labels. */
void numbering_list(struct buf *list, const uint16_t *as, const bool has[REGION_MOST + 1],
                    const struct kept *kept);

/* What has become of a list. */
struct numbering_tally {
    unsigned regions, first_label, last_label; /* the labels of the first and of the last one */
    unsigned names;                            /* that were taken away from these labels */
};

/* Numbers free labels by a list in rising order, but for what is an own number already. A name that
 * such a label had is not that of the region, and goes. ERR_INPUT, and *kept is of no use, where
 * more are listed than are free. */
enum err numbering_take(struct kept *kept, struct numbering_tally *tally, const char *list,
                        const struct markers *markers, struct fault *fault);

/* ERR_INPUT where the number of one of these labels is another label's. */
enum err numbering_check(const struct kept *kept, const bool used[256], struct fault *fault);

#endif
