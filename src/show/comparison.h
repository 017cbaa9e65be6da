/* SPDX-License-Identifier: MIT */
/*
 * Comparison of two label maps on one grid, label by label.
 *
 * A is the map under test, B the reference. For each label, with A and B the sets of its voxels:
 *
 *     Dice        2 |A and B| / (|A| + |B|), Jaccard |A and B| / |A or B|, volumes from the voxels
 *     Hausdorff   the largest distance from a voxel of either set to the nearest voxel of the other
 *     surfaces    the distance from each voxel of either contour (engine/distance.h) to the nearest
 *                 voxel of the other contour: its mean over both contours, and its 95th percentile,
 *                 the larger one of both directions, interpolated between ranks as in numpy
 *
 * Distances are between the centres of voxels, in millimetres. Overlaps equal those of ITK's
 * LabelOverlapMeasuresImageFilter, Hausdorff that of its HausdorffDistanceImageFilter, and the
 * larger of the two directed means that of its ContourMeanDistanceImageFilter. For all labels
 * together, overlaps are sums over the labels, where a voxel agrees if it has the same label in
 * both; distances are those of all objects as one set.
 */
#ifndef SHOW_COMPARISON_H
#define SHOW_COMPARISON_H

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
    uint32_t farthest[3]; /* a voxel of either at that distance from the other */
    bool has_surfaces;    /* both have contours: */
    double mean_mm, percentile_95_mm, most_mm;
    double directed_mean_mm[2], directed_percentile_95_mm[2]; /* A to B, B to A */
};

struct comparison {
    const struct compared *of; /* borrowed */
    struct overlap overlap;
    unsigned labels;                      /* labels above 0 with a voxel in A or B */
    struct label_distances distance[256]; /* [0]: all objects as one */
};

/* Uses 11 bytes for each voxel of the box around a label in both, one label at a time. ERR_MEMORY,
 * ERR_CANCELLED. */
enum err comparison_make(struct comparison *comparison, const struct compared *compared,
                         struct team *team, struct watch *watch, struct fault *fault);

/* Classify A's voxels, all objects as one, by the distance to the nearest voxel of B's contour:
 * COMPARISON_CLASS_ON on the contour, up to COMPARISON_CLASS_STEPS less inside B and more outside
 * it, where the last step means `most_mm` or more; 0 outside A. class[cell] must be 0 before. Uses
 * 10 bytes for each voxel of the box around all objects. ERR_MEMORY, ERR_CANCELLED. */
enum { COMPARISON_CLASS_ON = 128, COMPARISON_CLASS_STEPS = 127 };
enum err comparison_classify(uint8_t *class, const struct grid *grid,
                             const struct compared *compared, double most_mm, struct team *team,
                             struct watch *watch, struct fault *fault);

/* True if A or B has voxels of the label; always for 0, all objects together. */
bool comparison_has(const struct comparison *comparison, unsigned label);

/* The voxel where all objects together are farthest apart; `else_place` if they are equal. */
const uint32_t *comparison_farthest(const struct comparison *comparison,
                                    const uint32_t else_place[3]);

/* ---- text, JSON and CSV ---- */

/* Input of a report. Everything is borrowed. An unknown value, such as the distance of a label that
 * only A has, is "-" in text, null in JSON and an empty field in CSV. */
struct comparison_report {
    const struct comparison *comparison;
    const char *name[2];             /* file names of A and B: any bytes */
    const struct kept *kept;         /* names and numbers of labels */
    const struct geometry *geometry; /* an unknown spacing counts as 1 mm */
    const bool *listed; /* [256], labels with a row although neither has voxels of them; or NULL */
};

/* Text: a row for each label, and one for all if there are several. */
void comparison_write_text(struct buf *out, const struct comparison_report *report);

/* An object with the measures of all labels together and of each label. */
void comparison_write_json(struct buf *out, const struct comparison_report *report);

/* A line of names, a row for each label, and the row "all". */
void comparison_write_csv(struct buf *out, const struct comparison_report *report);

/*
 * Figures of a label: members of an object in JSON, fields of a row in CSV, both with 12 digits. An
 * unknown figure is NAN: null in JSON and an empty field in CSV.
 */

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

/* The first line of a table; and the fields of a row after the label. */
void figures_write_csv_names(struct buf *out, const struct figures *figures);
void figures_write_csv(struct buf *out, const char *label_name, const struct figures *figures);

/* Dice's coefficient of a label, 0 for all labels: 2 both / (a + b). */
double figures_dice(const struct overlap *overlap, unsigned label);

#endif
