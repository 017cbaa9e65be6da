/* SPDX-License-Identifier: MIT */
/*
 * Statistics of each label: voxels, their places and intensities, pairs and components. For labels
 * of any kind (engine/labels.h). All are integers, and the same for any number of threads.
 *
 * Counts are the number of voxels of a label with each intensity, and in each plane across x, y and
 * z. They determine number, mean and deviation, median and extremes of intensities, centre and
 * bounding box, and can be updated when voxels are added or removed. Label 0, the background, is
 * not counted. Memory is 4 bytes for each intensity of the scene and each plane, for each label in
 * use.
 *
 * Counts and pairs are stored between calls and follow the changes of edits (engine/changes.h);
 * counts need eight counters for each relabelled voxel. Components and holes cannot be updated from
 * a list of changes: they are recounted on demand.
 *
 * Invariant
 *   C1 counts that have followed equal a recount (test_tally).
 */
#ifndef ENGINE_LABEL_STATS_H
#define ENGINE_LABEL_STATS_H

#include "base/team.h"
#include "engine/changes.h"
#include "engine/labels.h"

/*
 * Pairs: the number of pairs of voxels with the same label, for each offset between them. The area
 * of a surface is estimated from them (show/label_report.h): the surface separates the voxels of a
 * pair if only one of them has the label.
 *
 * Two voxels make a pair if they are at most two steps apart along each axis. A step is one voxel
 * along the axis with the widest spacing, and a similar length along the others, at most STEP_MOST
 * voxels: so pairs have similar lengths in all directions. The kind of a pair encodes its steps
 * along each axis, |x| + 3 |y| + 9 |z|; pairs of kind 0 are single voxels. No pair leaves the
 * scene, so the edge of the scene is a surface too.
 *
 * Counts of pairs follow an edit by visiting 124 neighbours of each relabelled voxel, and need one
 * byte a voxel for its label at the last refresh. Label 0 has no surface and is not counted.
 *
 * Invariant
 *   P1 counts of pairs that have followed equal a recount (test_tally).
 */
enum { PAIR_KINDS = 27, STEP_MOST = 8 };

/* Length in voxels of one step along each axis. */
void label_pairs_step(uint32_t step[3], const uint32_t spacing_nm[3]);

struct label_sums {
    uint64_t voxels; /* if 0, the other members are 0 */
    uint64_t sum[3]; /* sums of positions along x, y, z */
    uint32_t first[3], last[3];
    uint64_t intensity, intensity_squares; /* sums */
    uint16_t least, most;
    uint16_t middle[2]; /* the two middle intensities, equal for an odd number of voxels */
};

struct label_stats {
    struct label_sums sums; /* for a label without voxels, the other members are undefined */
    uint64_t pairs[PAIR_KINDS];
    uint32_t components; /* connected by faces */
    uint32_t holes;      /* components of all other voxels that it encloses */
};

/* Stored counts. {0} is empty. */
struct label_measures {
    struct label_counts *counts;
    struct label_pairs *pairs;
};
/* Note the changes of an edit; or that labels changed in an unknown way: recount. */
void label_measures_follow(struct label_measures *measures, const struct changes *changes);
void label_measures_forget(struct label_measures *measures);
void label_measures_release(struct label_measures *measures);
size_t label_measures_memory(const struct label_measures *measures);

/* Compute the statistics of each label except 0. Stored counts are created on demand, and always
 * belong to the same kind of labels. ERR_MEMORY, or ERR_CANCELLED by the scene's watch. */
enum err label_stats_find(struct label_stats stats[256], struct label_measures *measures,
                          const struct labels *labels, struct team *team, struct fault *fault);

/* Refresh the counts of pairs alone, as label_stats_find does, by recounting or by following
 * changes. */
enum err label_measures_refresh_pairs(struct label_measures *measures, const struct labels *labels,
                                      struct team *team, struct fault *fault);

/* Refresh the counts alone, and return the sums of one label. ERR_MEMORY, ERR_CANCELLED. */
enum err label_measures_sum(struct label_measures *measures, const struct labels *labels,
                            unsigned label, struct team *team, struct label_sums *sums,
                            struct fault *fault);

#endif
