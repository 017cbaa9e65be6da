/* SPDX-License-Identifier: MIT */
/*
 * Statistics of labels: text, JSON and CSV.
 *
 * Intensities are real values (image/geometry.h). A measure that is undefined, such as the
 * deviation of one voxel, or unknown, such as millimetres without a spacing, is left out of text,
 * null in JSON and an empty field in CSV.
 */
#ifndef SHOW_LABEL_REPORT_H
#define SHOW_LABEL_REPORT_H

#include <stdint.h>

#include "base/buf.h"
#include "engine/label_stats.h"
#include "image/geometry.h"
#include "image/levels.h"
#include "render/slice.h"
#include "session/doubtful.h"
#include "session/session.h"
#include "session/state.h"

/*
 * Surface area of a label, as of a smooth body, from pairs of its voxels (engine/label_stats.h).
 *
 * A plane of area A separates the two voxels of A |n.v| / V pairs that are v apart, where n is its
 * normal and V the volume of a voxel. So the area is a sum over all kinds of pairs of the number of
 * separated pairs, with a weight for each kind, chosen to be right for planes of all normals; that
 * is Crofton's formula, as Ohser and Muecklich use it with 13 directions (Statistical Analysis of
 * Microstructures in Materials Science, 2000), with 49. A pair near an edge of a body can pass
 * through the body with both voxels outside: each kind misses |n.v| |m.v| / 2 V pairs per unit of
 * an edge between two perpendicular planes with normals n and m. This grows with the square of v,
 * and some pairs are twice as long as others, so weights can be chosen, some of them negative, for
 * which edges cost nothing.
 *
 * The weights minimise the sum of three sums of squares: over normals in all directions, the error
 * of a plane; over edges in all directions, the missed area; and over the planes and edges along
 * the axes, which count a little more. So they depend on the spacing alone.
 *
 * Measured accuracy (test_stats), with s the longest spacing: 2 % for balls with a radius of 6 s or
 * more, for boxes with sides of 30 s or more in any orientation, and of 10 s or more along the
 * axes. Of turned boxes with sides of 20 s, one in some hundred is off by 2 to 2.7 %, and of 12 s
 * by up to 3 %, because voxels do not determine the place of a side between them; the mean of many
 * is right to 0.3 %. A smaller cube along the axes has 0.97 of its area at 5 voxels, 0.94 at 3, 0.7
 * at 1. A sheet of a single voxel counts 1.4 times, since a pair of two steps sees it as one of
 * two. Pairs of a kind differ in length on sheared axes: balls are as accurate there, and bodies
 * with few directions are off by up to 5 % at 15 degrees, and 12 % at 30, which answers mention.
 *
 * The net that pictures show (engine/net.h) is no better measure. It is more accurate for round
 * small bodies and thin ones: balls of 1.5, 2.4, 3.2 s have 1.03, 1.04, 1.01 of their area, by
 * pairs 1.08, 1.08, 1.03; turned sheets of one, two voxels .92, .95, by pairs 1.15, 1.11. But it
 * rounds edges off (cubes of 3, 10, 30 voxels along the axes .83, .89, .96, turned boxes of 12, 20,
 * 30 .94, .96, .98), and slices 7 times as far apart as voxels stay steps, 1.07 of any ball.
 */

/* Area of a separated pair of each kind, in mm2. */
struct area_weights {
    double mm2[PAIR_KINDS];
};

void area_weights_init(struct area_weights *weights, const struct geometry *geometry);

double label_area_mm2(const struct area_weights *weights, const uint64_t pairs[PAIR_KINDS]);

/* Input of a report; everything is borrowed. */
struct label_report {
    const struct label_stats *stats;            /* [256] */
    const struct area_weights *area;            /* for the scene's spacing */
    const uint64_t *gained, *lost;              /* [256], by the last edit; NULL: not known, */
    const uint64_t *before;                     /* [256], voxels before it; NULL: not known */
    const char (*label_name)[LABEL_NAME_BYTES]; /* [256] */
    const char (*label_code)[LABEL_CODE_BYTES]; /* [256] */
    const uint32_t *label_number;               /* [256] (numbering_fill) */
    const struct geometry *geometry;
    const struct levels *levels; /* the session's */
    unsigned channel;   /* number of the channel with these intensities; 0 if it is the only one */
    const bool *listed; /* [256], labels with a row although they have no voxel; or NULL */
};

/* Lines about one label that has voxels, each indented by four blanks. */
void label_report_write_text(struct buf *out, const struct label_report *report, unsigned label);

/* "mean 93, SD 12.3, 78 x 102 x 94 mm": intensities of a label that has voxels, and its bounding
 * box, in voxels if the spacing is unknown. */
void label_report_write_sums(struct buf *out, const struct label_sums *sums,
                             const struct geometry *geometry);

/* "2 cerebellum", "2" without a name: number and name of a label, in the present state. */
void label_report_write_label(struct buf *out, const struct kept *kept, unsigned label);
void label_report_write_name(struct buf *out, const struct session *session, unsigned label);

/* A volume: "1.24 l", or "3 voxels" if the spacing is unknown. */
void label_report_write_extent(struct buf *out, const struct session *session, uint64_t voxels);

/* " (+1.2 ml)": the change from `former` voxels, if there is one and `former` is not 0. */
void label_report_write_change(struct buf *out, const struct session *session, uint64_t voxels,
                               uint64_t former);

/* "coronal y=108: 1.2 ml in doubt". Returns the plane of the slice. */
enum slice_plane label_report_write_doubt(struct buf *out, const struct session *session,
                                          const struct doubtful_slice *slice);

/* An object with an object for each label that has voxels or is listed. */
void label_report_write_json(struct buf *out, const struct label_report *report);

/* A line of names, and a row for each label that has voxels or is listed. */
void label_report_write_csv(struct buf *out, const struct label_report *report);

#endif
