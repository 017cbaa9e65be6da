/* SPDX-License-Identifier: MIT */
/*
 * What robots and methods came to: a table a group and robot for people, JSON for programs, and
 * charts.
 */
#ifndef TESTS_BENCH_EFFORT_REPORT_H
#define TESTS_BENCH_EFFORT_REPORT_H

#include "tests/bench/effort_run.h"

struct effort_report {
    const struct effort_method *method;
    size_t methods;
    struct effort_run *run; /* in any order */
    size_t runs, capacity;
    struct buf missing; /* lines on what was left out */
};

/* All runs of a method, by one robot, in one group: {0} where there are none. */
struct effort_count effort_report_count(const struct effort_report *report, size_t method,
                                        enum effort_robot_kind robot, enum effort_group group);

void effort_report_tables(struct buf *out, const struct effort_report *report);
void effort_report_json(struct buf *out, const struct effort_report *report);

/* The mean Dice by gestures, of each group and robot that has runs, as FOLDER/effort-GROUP-ROBOT
 * .svg. ERR_IO where one is there already. */
enum err effort_report_plots(const struct effort_report *report, const char *folder,
                             struct fault *fault);

#endif
