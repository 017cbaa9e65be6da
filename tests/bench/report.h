/* SPDX-License-Identifier: MIT */
/* Results of the paper's experiments next to the paper's own figures: text for people, JSON for
 * programs. */
#ifndef TESTS_BENCH_REPORT_H
#define TESTS_BENCH_REPORT_H

#include <stdio.h>

#include "tests/bench/trial.h"

/* Each scene: means of each experiment, and each step (the paper's figure 9). */
void report_scenes(FILE *out, const struct trial *trial, size_t count);

/* All scenes: times and ratios (the paper's figure 7). */
void report_summary(FILE *out, const struct trial *trial, size_t count);

/* One object. */
void report_json(FILE *out, const struct trial *trial, size_t count);

/* Ratios in the paper. */
enum ratio {
    RATIO_IFT,          /* segmentation of (1) to that of (2) */
    RATIO_BDIFT,        /* segmentation and border of (3) to segmentation of (2) */
    RATIO_KEEP,         /* segmentation and border of (3) to those of (5) */
    RATIO_BP,           /* rendition of (3) to that of (2) */
    RATIO_II,           /* rendition of (4) to that of (2) */
    RATIO_WITH_BP,      /* whole step of (3) to that of (2) */
    RATIO_WITH_II,      /* whole step of (4) to that of (2) */
    RATIO_BORDER_SHARE, /* border upkeep of (3) to its segmentation and border */
    RATIOS
};
struct ratio_told {
    const char *name, *words[2]; /* for programs; of a column */
    double paper;                /* 0 if the paper has none */
    const char *paper_words;
};
extern const struct ratio_told ratio_told[RATIOS];
double report_ratio(const struct trial *trial, enum ratio ratio);

#endif
