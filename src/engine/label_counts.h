/*
 * The counts of each label: how often its voxels have each intensity, and how many lie in each
 * plane across x, y and z. Number, mean and deviation, median and extremes of intensities,
 * centre and bounding box follow from them (label_counts_sum), however voxels come and go.
 *
 * Counts are kept up to date: an edit notes what it changes (engine/changes.h), and
 * label_counts_refresh follows, with eight counters for each voxel that has another label.
 * Memory is 4 bytes for each intensity of the scene and each plane, for each label in use. Label
 * 0, the background, is not counted.
 *
 * Invariant
 *   C1 after label_counts_refresh the counts equal a recount (test_tally).
 */
#ifndef ENGINE_LABEL_COUNTS_H
#define ENGINE_LABEL_COUNTS_H

#include "base/team.h"
#include "engine/changes.h"
#include "engine/labels.h"

struct label_sums {
    uint64_t voxels; /* where there are none, the rest is 0 */
    uint64_t sum[3]; /* of positions along x, y, z */
    uint32_t first[3], last[3];
    uint64_t intensity, intensity_squares; /* sums */
    uint16_t least, most;
    uint16_t middle[2]; /* the two intensities in the middle, which are one of an odd number */
};

struct label_counts;

/* Of a scene, which outlives it, so far of nothing. ERR_MEMORY. */
enum err label_counts_new(struct label_counts **counts, const struct scene *scene,
                          struct fault *fault);
void label_counts_free(struct label_counts *counts);

/* An edit of the forest has changed labels; NULL is told nothing. */
void label_counts_follow(struct label_counts *counts, const struct changes *changes);
/* The labels of the forest are others in a way that nobody says. */
void label_counts_forget(struct label_counts *counts);

/* Counts what is not counted yet of these labels, which are always the forest's, or, the one time
 * that this is called, any. ERR_MEMORY, or ERR_CANCELLED by the scene's watch; all is counted the
 * next time then. */
enum err label_counts_refresh(struct label_counts *counts, const struct labels *labels,
                              struct team *team, struct fault *fault);

/* As of the last refresh; in time proportional to the number of intensities and planes. */
struct label_sums label_counts_sum(const struct label_counts *counts, unsigned label);

size_t label_counts_memory(const struct label_counts *counts); /* bytes; of NULL too */

#endif
