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

#include "base/buf.h"
#include "engine/label_stats.h"
#include "image/levels.h"
#include "show/label_area.h"
#include "session/session.h"
#include "session/state.h"

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

/* An object with an object for each label that has voxels or is listed. */
void label_report_write_json(struct buf *out, const struct label_report *report);

/* A line of names, then one for each label that has voxels or is listed. */
void label_report_write_csv(struct buf *out, const struct label_report *report);

#endif
