/* SPDX-License-Identifier: MIT */
/*
 * A comparison: how far two sets of labels of the same voxels agree, label by label.
 *
 * A is what is judged, B what it is judged by. Of each label, with A and B the sets of its voxels:
 *
 *     Dice        2 |A and B| / (|A| + |B|), Jaccard |A and B| / |A or B|, volumes from the voxels
 *     Hausdorff   the largest distance from a voxel of either set to the nearest voxel of the other
 *     surfaces    from each voxel of either contour (engine/distance.h) the distance to the nearest
 *                 voxel of the other's. Their mean over both contours; and the 95th percentile:
 *                 the larger one of both directions, between ranks as numpy has it
 *
 * Distances are between the centres of voxels, in millimetres. Overlaps are those of ITK's
 * LabelOverlapMeasuresImageFilter, Hausdorff that of its HausdorffDistanceImageFilter, and the
 * larger of the two directed means that of its ContourMeanDistanceImageFilter. For all labels
 * together, overlaps are sums over the labels, where a voxel agrees that has the same label in
 * both; distances are those of all objects as one set.
 */
#ifndef REPORT_COMPARISON_H
#define REPORT_COMPARISON_H

#include "base/buf.h"
#include "base/json.h"
#include "base/team.h"
#include "base/watch.h"
#include "engine/grid.h"
#include "engine/labels.h"
#include "image/geometry.h"
#include "session/state.h"

/* Two sets of labels on one grid. */
struct compared {
    uint32_t size[3], spacing_nm[3];
    uint8_t *label[2]; /* A, B: [z][y][x] */
};

struct label_distances {
    bool has_hausdorff; /* both have voxels: */
    double hausdorff_mm;
    uint32_t farthest[3]; /* a voxel of either that is so far from the other */
    bool has_surfaces;    /* both have contours: */
    double mean_mm, percentile_95_mm, most_mm;
    double directed_mean_mm[2], directed_percentile_95_mm[2]; /* A to B, B to A */
};

struct comparison {
    struct overlap overlap;
    unsigned labels;                      /* that A or B has voxels of, but for label 0 */
    struct label_distances distance[256]; /* [0]: of all objects as one */
};

/* Takes 11 bytes a voxel of the box around the label in both, one label at a time. ERR_MEMORY,
 * ERR_CANCELLED. */
enum err comparison_make(struct comparison *comparison, const struct compared *compared,
                         struct team *team, struct watch *watch, struct fault *fault);

/* Classes of A's voxels, all objects as one, by their distance to the nearest voxel of B's contour:
 * 0 outside A; COMPARISON_CLASS_ON on the contour; by up to COMPARISON_CLASS_STEPS less within B,
 * and more outside it, at `most_mm` and beyond. By cell of the grid, and 0 before. Takes 10 bytes a
 * voxel of the box around all objects. ERR_MEMORY, ERR_CANCELLED. */
enum { COMPARISON_CLASS_ON = 128, COMPARISON_CLASS_STEPS = 127 };
enum err comparison_classify(uint8_t *class, const struct grid *grid,
                             const struct compared *compared, double most_mm, struct team *team,
                             struct watch *watch, struct fault *fault);

/* Whether a label is there to be listed: label 0, which stands for all together, always. */
bool comparison_has(const struct comparison *comparison, unsigned label);

/* The voxel where all objects are farthest apart; where they are not, `else_place`. */
const uint32_t *comparison_farthest(const struct comparison *comparison,
                                    const uint32_t else_place[3]);

/* ---- in words: a table for people, JSON and CSV for programs ---- */

/* What is not known, as the distance to a label that the other has not, is "-" in the table, null
 * in JSON and an empty field in CSV. */

/* What is reported, all of it borrowed. */
struct comparison_report {
    const struct comparison *comparison;
    const char *name[2];                        /* of A and B, as files are called: any bytes */
    const char (*label_name)[LABEL_NAME_BYTES]; /* [256] */
    const struct geometry *geometry;            /* its spacing unknown: taken for 1 mm */
    const bool *listed; /* [256], labels with a row though neither has them; or NULL */
};

/* Lines; a row for each label, and one for all where there are several. */
void comparison_write_text(struct buf *out, const struct comparison_report *report);

/* An object with a member for each measure of all labels together, and of each label. */
void comparison_write_json(struct buf *out, const struct comparison_report *report);

/* A line of names, then one for each label, and one for all, whose label is "all". */
void comparison_write_csv(struct buf *out, const struct comparison_report *report);

/*
 * Figures of a label for programs: members of an object in JSON, and a row of a table in CSV, both
 * with 12 digits. One that is not known is NAN, which is null in JSON and an empty field in CSV.
 */

struct geometry;

enum { FIGURES_MOST = 32 };

struct figures {
    int count;
    struct {
        const char *name;
        double value;
    } of[FIGURES_MOST];
};

void figures_add(struct figures *figures, const char *name, double value);

void figures_write_json(struct json *json, const struct figures *figures);

/* The first line of a table; and what comes after the label in one of its own. */
void figures_write_csv_names(struct buf *out, const struct figures *figures);
void figures_write_csv(struct buf *out, const char *label_name, const struct figures *figures);

/* Dice's coefficient of a label, or 0 for all: 2 both / (a + b). */
double figures_dice(const struct overlap *overlap, unsigned label);

#endif
