/*
 * A comparison in words: a table for people, JSON and CSV for programs.
 *
 * What is not known, as the distance to a label that the other has not, is "-" in the table, null
 * in JSON and an empty field in CSV.
 */
#ifndef REPORT_COMPARISON_REPORT_H
#define REPORT_COMPARISON_REPORT_H

#include "base/buf.h"
#include "image/geometry.h"
#include "report/comparison.h"
#include "session/state.h"

/* What is reported, all of it borrowed. */
struct comparison_report {
    const struct comparison *comparison;
    const char *name[2];                        /* of A and B, as files are called: any bytes */
    const char (*label_name)[LABEL_NAME_BYTES]; /* [256] */
    const struct geometry *geometry;            /* its spacing unknown: taken for 1 mm */
};

/* Lines; a row for each label, and one for all where there are several. */
void comparison_write_text(struct buf *out, const struct comparison_report *report);

/* An object with a member for each measure of all labels together, and of each label. */
void comparison_write_json(struct buf *out, const struct comparison_report *report);

/* A line of names, then one for each label, and one for all, whose label is "all". */
void comparison_write_csv(struct buf *out, const struct comparison_report *report);

#endif
