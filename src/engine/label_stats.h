/* SPDX-License-Identifier: MIT */
/*
 * What is known of each label: voxels, where they lie, their intensities, the pairs that they make,
 * and how they hang together. Of labels of any kind (engine/labels.h). All are integers, and the
 * same for any number of threads.
 *
 * Counts say how often the voxels of a label have each intensity, and how many lie in each plane
 * across x, y and z. Number, mean and deviation, median and extremes of intensities, centre and
 * bounding box follow from them, however voxels come and go. Label 0, the background, is not
 * counted. Memory is 4 bytes for each intensity of the scene and each plane, for each label in use.
 *
 * Counts and pairs (engine/label_stats.h) are kept from one time to the next, and follow what edits
 * change (engine/changes.h), counts with eight counters for each voxel that has another label. A
 * change of some voxels changes components and holes in ways that no list of changes says: they are
 * counted when asked for.
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
 * Pairs: how many pairs of voxels have the same label, for each way in which one may lie from the
 * other. The area of a surface is estimated from them (show/label_area.h): a pair of which one
 * voxel alone has the label has the surface between its two.
 *
 * Two voxels make a pair where they are at most two steps apart along each axis. A step is one
 * voxel along the axis with the widest spacing, and as many as are about as long along the others,
 * STEP_MOST at most: so pairs lead about as far in all directions. The kind of a pair is how many
 * steps it is long along each axis, |x| + 3 |y| + 9 |z|; pairs of kind 0 are single voxels. No pair
 * leads out of the scene, so the edge of the scene is a surface too.
 *
 * Counts of pairs follow an edit with 124 looks around each voxel that has another label, and one
 * byte a voxel for the label that it was last seen with. Label 0 has no surface and is not counted.
 *
 * Invariant
 *   P1 counts of pairs that have followed equal a recount (test_tally).
 */
enum { PAIR_KINDS = 27, STEP_MOST = 8 };

/* The voxels of one step along each axis. */
void label_pairs_step(uint32_t step[3], const uint32_t spacing_nm[3]);

struct label_sums {
    uint64_t voxels; /* where there are none, the rest is 0 */
    uint64_t sum[3]; /* of positions along x, y, z */
    uint32_t first[3], last[3];
    uint64_t intensity, intensity_squares; /* sums */
    uint16_t least, most;
    uint16_t middle[2]; /* the two intensities in the middle, which are one of an odd number */
};

struct label_stats {
    struct label_sums sums; /* of a label without voxels, the rest is of no meaning */
    uint64_t pairs[PAIR_KINDS];
    uint32_t components; /* pieces that hang together by faces */
    uint32_t holes;      /* what is enclosed: components of voxels of other labels, all as one, with
                             no voxel at the edge of the scene */
};

/* What is kept. {0} is nothing. */
struct label_measures {
    struct label_counts *counts;
    struct label_pairs *pairs;
};
/* An edit of the forest has changed labels, or they are others in a way that nobody says. */
void label_measures_follow(struct label_measures *measures, const struct changes *changes);
void label_measures_forget(struct label_measures *measures);
void label_measures_release(struct label_measures *measures);
size_t label_measures_memory(const struct label_measures *measures);

/* Of each label but 0, of which nothing is known. What is kept is made where there is none, and
 * always of the same kind of labels. ERR_MEMORY, or ERR_CANCELLED by the scene's watch. */
enum err label_stats_find(struct label_stats stats[256], struct label_measures *measures,
                          const struct labels *labels, struct team *team, struct fault *fault);

/* Recounts the pairs of all labels, or follows what has changed, as label_stats_find does: the part
 * of it that surfaces need. */
enum err label_measures_refresh_pairs(struct label_measures *measures, const struct labels *labels,
                                      struct team *team, struct fault *fault);

/* Of one label, what follows from counts alone. */
enum err label_measures_sum(struct label_measures *measures, const struct labels *labels,
                            unsigned label, struct team *team, struct label_sums *sums,
                            struct fault *fault);

#endif
