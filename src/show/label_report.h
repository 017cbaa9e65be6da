/* SPDX-License-Identifier: MIT */
/*
 * What is known of each label in words: lines for people, JSON and CSV for programs.
 *
 * Intensities are real values (image/geometry.h). A measure that the geometry of the scene does not
 * tell, as millimetres where the spacing is unknown, is left out, null in JSON and an empty field
 * in CSV; so is what has no meaning, as the deviation of a single voxel.
 */
#ifndef REPORT_LABEL_REPORT_H
#define REPORT_LABEL_REPORT_H

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
 * The area of the surface of a label, as it would be were it not made of voxels, from the pairs
 * that its voxels make (engine/label_stats.h).
 *
 * A plane of area A lies between the two voxels of A |n.v| / V pairs that are v apart, n being
 * its normal and V the volume of a voxel. So the area is a sum over all kinds of pairs of how
 * many the plane lies between, each kind with a weight of its own, chosen so that planes of all
 * normals come out right; that is Crofton's formula, as Ohser and Muecklich use it with 13
 * directions (Statistical Analysis of Microstructures in Materials Science, 2000), with 49. A
 * pair near an edge of a body can pass through the body, both of its voxels outside: each kind
 * misses |n.v| |m.v| / 2 V pairs a unit of an edge between two planes across each other, with
 * normals n and m. These grow with the square of v, and some pairs are twice as long as others,
 * so weights can be chosen, some of them below 0, that have edges cost nothing.
 *
 * The weights are those of the least squares of three sums: over normals in all directions, of
 * how far a plane is from its area; over edges in all directions, of what is missed; and over
 * the planes and edges along the axes, which count a little more. So they depend on the spacing
 * alone.
 *
 * What comes out (test_stats), s being the longest spacing: balls with a radius of 6 s or more
 * are right to 2 %, and so are boxes with sides of 30 s or more however they are turned, and of
 * 10 s or more along the axes. Of boxes with sides of 20 s that are turned anyhow, one in some
 * hundred is off by 2 to 2.7 %, and of 12 s by up to 3 %: voxels do not say where between them a
 * side lies; the mean of many is right to 0.3 %. Below that, of a cube along the axes: 0.97 of
 * its area at 5 voxels, 0.94 at 3, 0.7 at 1. A sheet of a single voxel counts 1.4 times, for to
 * a pair of two steps it is as thick as one of two. Pairs of
 * a kind differ in length where axes are sheared: balls are as right there, and what has few
 * directions is off by up to 5 % at 15 degrees, and 12 % at 30, which answers say.
 *
 * The net that pictures show (engine/net.h) is no better measure. It is truer of what is round
 * and small, or thin: balls of 1.5, 2.4, 3.2 s have 1.03, 1.04, 1.01 of their area, by pairs 1.08,
 * 1.08, 1.03; turned sheets of one, two voxels .92, .95, by pairs 1.15, 1.11. But it rounds
 * edges off (cubes of 3, 10, 30 voxels along the axes .83, .89, .96, turned boxes of 12, 20, 30
 * .94, .96, .98), and slices 7 times as far apart as voxels stay steps, 1.07 of any ball.
 */

/* What each pair of a kind that a surface lies between adds to its area, in mm2. */
struct area_weights {
    double mm2[PAIR_KINDS];
};

void area_weights_init(struct area_weights *weights, const struct geometry *geometry);

double label_area_mm2(const struct area_weights *weights, const uint64_t pairs[PAIR_KINDS]);

/* What is reported, all of it borrowed. */
struct label_report {
    const struct label_stats *stats;            /* [256] */
    const struct area_weights *area;            /* of the scene's spacing */
    const uint64_t *gained, *lost;              /* [256], by the last edit; NULL: not known, */
    const uint64_t *before;                     /* [256], voxels before it; NULL: not known */
    const char (*label_name)[LABEL_NAME_BYTES]; /* [256] */
    const uint16_t *label_number;               /* [256], own numbers, 0 for none; or NULL */
    const struct geometry *geometry;
    const struct levels *levels; /* the session's */
    const bool *listed;          /* [256], labels with a row though they have no voxel; or NULL */
};

/* Lines about one label that has voxels, each after so many blanks. */
void label_report_write_text(struct buf *out, const struct label_report *report, unsigned label,
                             int blanks);

/* "mean 93, SD 12.3, 78 x 102 x 94 mm": the intensities of a label that has voxels, and the
 * box around it, in voxels where their distances are unknown. */
void label_report_write_sums(struct buf *out, const struct label_sums *sums,
                             const struct geometry *geometry);

/* "2 cerebellum", or "2" where the label has no name; "2 cerebellum (1008)" with its own number. */
void label_report_write_name(struct buf *out, const struct session *session, unsigned label);

/* The volume of so many voxels: "1.24 l", or "3 voxels" where their distances are unknown. */
void label_report_write_extent(struct buf *out, const struct session *session, uint64_t voxels);

/* " (+1.2 ml)": how much more that is than the voxels that there were before, where there were any
 * and are others now. */
void label_report_write_change(struct buf *out, const struct session *session, uint64_t voxels,
                               uint64_t former);

/* "coronal y=108: 1.2 ml in doubt", of a slice whose plane is returned. */
enum slice_plane label_report_write_doubt(struct buf *out, const struct session *session,
                                          const struct doubtful_slice *slice);

/* An object with an object for each label that has voxels or is listed. */
void label_report_write_json(struct buf *out, const struct label_report *report);

/* A line of names, then one for each label that has voxels or is listed. */
void label_report_write_csv(struct buf *out, const struct label_report *report);

#endif
