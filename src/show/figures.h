/* SPDX-License-Identifier: MIT */
/*
 * Figures of a label for programs: members of an object in JSON, and a row of a table in CSV, both
 * with 12 digits. One that is not known is NAN, which is null in JSON and an empty field in CSV.
 */
#ifndef REPORT_FIGURES_H
#define REPORT_FIGURES_H

#include "base/buf.h"
#include "base/json.h"
#include "engine/labels.h"

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

/* NAN of nothing. */
double figures_ratio(double part, double whole);

/* Dice's coefficient of a label, or 0 for all: 2 both / (a + b). */
double figures_dice(const struct overlap *overlap, unsigned label);

/* A cell of a table for people, to the right in so many columns after a blank: "-" for NAN; and a
 * volume, as tally_write_volume has it, after a sign, or "0". */
void figures_add_cell(struct buf *out, int columns, int decimals, double value);
void figures_add_volume(struct buf *out, int columns, const char *sign,
                        const struct geometry *geometry, uint64_t voxels);

/* A line below a table of millimetres where the file does not say how large voxels are. */
void figures_add_spacing(struct buf *out, bool is_unknown);

#endif
