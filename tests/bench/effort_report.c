/* SPDX-License-Identifier: MIT */
#include "tests/bench/effort_report.h"

#include <stdio.h>

#include "base/file.h"
#include "base/json.h"
#include "program/times.h"
#include "tests/bench/plot.h"

enum { RUNS_MOST = 256, HANDS_A_LINE = 3 };

static bool belongs(const struct effort_run *run, size_t method, enum effort_robot_kind robot,
                    enum effort_group group)
{
    return run->method == method && run->robot == robot &&
           effort_object_group(run->object) == group;
}

struct effort_count effort_report_count(const struct effort_report *report, size_t method,
                                        enum effort_robot_kind robot, enum effort_group group)
{
    struct effort_count count = {0};
    for (size_t i = 0; i < report->runs; i++)
        if (belongs(&report->run[i], method, robot, group))
            effort_count(&count, &report->run[i]);
    return count;
}

/* Of the medians of the runs. */
static double median_ms(const struct effort_report *report, size_t method,
                        enum effort_robot_kind robot, enum effort_group group)
{
    double ms[RUNS_MOST];
    size_t count = 0;
    for (size_t i = 0; i < report->runs && count < RUNS_MOST; i++)
        if (belongs(&report->run[i], method, robot, group))
            ms[count++] = report->run[i].ms;
    return times_median(ms, count);
}

static unsigned most_runs(const struct effort_report *report, enum effort_robot_kind robot,
                          enum effort_group group)
{
    unsigned most = 0;
    for (size_t m = 0; m < report->methods; m++) {
        const unsigned runs = effort_report_count(report, m, robot, group).runs;
        most = runs > most ? runs : most;
    }
    return most;
}

/* ---- tables ---- */

static double mean(unsigned sum, const struct effort_count *count, double one)
{
    return (double)sum / one / (double)count->runs;
}

static void add_row(struct buf *out, const char *name, const struct effort_count *count,
                    double first, double ms)
{
    const double to = mean(count->gestures[0], count, 1);
    buf_printf(out, "%-27s %4.1f (%2u)", name, to, count->reached[0]);
    if (first > 0)
        buf_printf(out, " %4.2f", to / first);
    else
        buf_printf(out, " %4s", "-");
    buf_printf(out, " %5.0f %5.1f  %4.1f (%2u)  %4.2f %4.2f %4.2f %3u (%4.2f) %6.1f\n",
               count->path / count->runs, mean(count->clicks, count, 1),
               mean(count->gestures[1], count, 1), count->reached[1],
               mean(count->after[0], count, 1e4), mean(count->after[1], count, 1e4),
               mean(count->after[2], count, 1e4), count->collapses, count->largest / 1e4, ms);
}

static void add_table(struct buf *out, const struct effort_report *report,
                      enum effort_robot_kind robot, enum effort_group group)
{
    const unsigned objects = most_runs(report, robot, group);
    double first = 0;
    if (!objects)
        return;
    buf_printf(out,
               "%s robot, %u object%s: %s\n"
               "%-27s %9s %4s %11s  %9s  %14s %10s %6s\n"
               "%-27s %9s %4s %5s %5s  %9s  %4s %4s %4s %10s %6s\n",
               effort_robot_name[robot], objects, plural(objects), effort_group_name[group], "",
               "gestures", "of", "or to 0.8:", "gestures", "Dice after", "collapses", "ms a", "",
               "to 0.8", "1st", "drawn", "click", "to 0.9", "5", "10", "20", "(largest)", "one");
    for (size_t m = 0; m < report->methods; m++) {
        const struct effort_count count = effort_report_count(report, m, robot, group);
        if (!count.runs)
            continue;
        char name[64];
        snprintf(name, sizeof name, "%s%s", report->method[m].name,
                 count.runs < objects ? " *" : "");
        first = m == 0 ? mean(count.gestures[0], &count, 1) : first;
        add_row(out, name, &count, first, median_ms(report, m, robot, group));
    }
    buf_add_char(out, '\n');
}

static struct effort_warnings warnings_of(const struct effort_report *report,
                                          enum effort_robot_kind robot, enum effort_group group)
{
    struct effort_count sum = {0};
    for (size_t i = 0; i < report->runs; i++)
        if (belongs(&report->run[i], report->run[i].method, robot, group))
            effort_count(&sum, &report->run[i]);
    return sum.warnings;
}

static void add_warnings(struct buf *out, const struct effort_report *report)
{
    buf_printf(out, "%-27s %17s %17s\n%-27s %8s %8s %8s %8s\n", "Warnings", "leaks", "right", "",
               "all", "warned", "all", "warned");
    for (int group = 0; group < EFFORT_GROUPS; group++)
        for (int robot = 0; robot < ROBOT_KINDS; robot++) {
            const struct effort_warnings w =
                warnings_of(report, (enum effort_robot_kind)robot, (enum effort_group)group);
            char name[64];
            snprintf(name, sizeof name, "%s, %s", effort_group_name[group],
                     effort_robot_name[robot]);
            if (w.leaks || w.right)
                buf_printf(out, "%-27s %8u %8u %8u %8u\n", name, w.leaks, w.found, w.right,
                           w.called);
        }
    buf_add_char(out, '\n');
}

static bool is_first_of_object(const struct effort_report *report, size_t run)
{
    for (size_t i = 0; i < run; i++)
        if (report->run[i].object == report->run[run].object)
            return false;
    return true;
}

static void add_hands(struct buf *out, const struct effort_report *report)
{
    size_t column = HANDS_A_LINE;
    buf_add_text(out, "Dice of a hand that is off by 0.7 voxels, all slices across one axis drawn");
    for (size_t i = 0; i < report->runs; i++) {
        if (!is_first_of_object(report, i))
            continue;
        column = column < HANDS_A_LINE ? column + 1 : 1;
        buf_printf(out, "%s%-18s %4.2f", column == 1 ? "\n" : "   ",
                   effort_object_name(report->run[i].object), report->run[i].most / 1e4);
    }
    buf_add_text(out, "\n\n");
}

void effort_report_tables(struct buf *out, const struct effort_report *report)
{
    for (int group = 0; group < EFFORT_GROUPS; group++)
        for (int robot = 0; robot < ROBOT_KINDS; robot++)
            add_table(out, report, (enum effort_robot_kind)robot, (enum effort_group)group);
    add_warnings(out, report);
    add_hands(out, report);
    buf_add_text(
        out,
        "Gestures count the first two, a box as two, and 23 where 22 do not reach the "
        "goal; in brackets,\nhow many objects reach it. Of 1st: by the gestures to "
        "0.8 of the first method. The hand up to 0.8:\nvoxels to drag along, or instead of that "
        "clicks at corners. A collapse is a drop of more than 0.05\nfrom one gesture "
        "to the next. Times are medians, of the processor. * is of fewer objects.\n"
        "A leak makes labels worse by more than a tenth of the object.\n");
    buf_add_text(out, buf_text(&report->missing));
}

/* ---- JSON ---- */

static void add_run(struct json *json, const struct effort_report *report,
                    const struct effort_run *run)
{
    json_object(json, NULL);
    json_text(json, "object", effort_object_name(run->object));
    json_text(json, "group", effort_group_name[effort_object_group(run->object)]);
    json_text(json, "robot", effort_robot_name[run->robot]);
    json_text(json, "method", report->method[run->method].name);
    json_format(json, "size", "%ux%ux%u", run->size[0], run->size[1], run->size[2]);
    json_count(json, "voxels", run->voxels);
    json_fixed(json, "dice_by_hand", run->most / 1e4, 4);
    json_array(json, "dice");
    for (int k = 0; k < CURVE; k++)
        json_fixed(json, NULL, run->dice[k] / 1e4, 4);
    json_end(json);
    json_array(json, "drawn");
    for (int k = 0; k < CURVE; k++)
        json_fixed(json, NULL, run->path[k], 1);
    json_end(json);
    json_array(json, "clicks");
    for (int k = 0; k < CURVE; k++)
        json_count(json, NULL, run->clicks[k]);
    json_end(json);
    json_fixed(json, "ms", run->ms, 3);
    json_end(json);
}

static void add_count(struct json *json, const struct effort_report *report, size_t method,
                      enum effort_robot_kind robot, enum effort_group group)
{
    const struct effort_count count = effort_report_count(report, method, robot, group);
    if (!count.runs)
        return;
    json_object(json, NULL);
    json_text(json, "group", effort_group_name[group]);
    json_text(json, "robot", effort_robot_name[robot]);
    json_text(json, "method", report->method[method].name);
    json_count(json, "objects", count.runs);
    json_fixed(json, "gestures_to_0.8", mean(count.gestures[0], &count, 1), 3);
    json_count(json, "reach_0.8", count.reached[0]);
    json_fixed(json, "drawn_to_0.8", count.path / count.runs, 1);
    json_fixed(json, "clicks_to_0.8", mean(count.clicks, &count, 1), 2);
    json_fixed(json, "gestures_to_0.9", mean(count.gestures[1], &count, 1), 3);
    json_count(json, "reach_0.9", count.reached[1]);
    json_fixed(json, "dice_after_5", mean(count.after[0], &count, 1e4), 4);
    json_fixed(json, "dice_after_10", mean(count.after[1], &count, 1e4), 4);
    json_fixed(json, "dice_after_20", mean(count.after[2], &count, 1e4), 4);
    json_count(json, "collapses", count.collapses);
    json_count(json, "leaks", count.warnings.leaks);
    json_count(json, "leaks_warned", count.warnings.found);
    json_count(json, "right", count.warnings.right);
    json_count(json, "right_warned", count.warnings.called);
    json_fixed(json, "largest_collapse", count.largest / 1e4, 4);
    json_fixed(json, "ms", median_ms(report, method, robot, group), 3);
    json_end(json);
}

void effort_report_json(struct buf *out, const struct effort_report *report)
{
    struct json json = {.out = out, .lines = 2};
    json_object(&json, NULL);
    json_array(&json, "counts");
    for (int group = 0; group < EFFORT_GROUPS; group++)
        for (int robot = 0; robot < ROBOT_KINDS; robot++)
            for (size_t m = 0; m < report->methods; m++)
                add_count(&json, report, m, (enum effort_robot_kind)robot,
                          (enum effort_group)group);
    json_end(&json);
    json_array(&json, "runs");
    for (size_t i = 0; i < report->runs; i++)
        add_run(&json, report, &report->run[i]);
    json_end(&json);
    json_text(&json, "left_out", buf_text(&report->missing));
    json_end(&json);
}

/* ---- charts ---- */

static bool mean_curve(double curve[CURVE], const struct effort_report *report, size_t method,
                       enum effort_robot_kind robot, enum effort_group group)
{
    unsigned runs = 0;
    for (int k = 0; k < CURVE; k++)
        curve[k] = 0;
    for (size_t i = 0; i < report->runs; i++) {
        if (!belongs(&report->run[i], method, robot, group))
            continue;
        runs++;
        for (int k = 0; k < CURVE; k++)
            curve[k] += report->run[i].dice[k] / 1e4;
    }
    for (int k = 0; k < CURVE && runs; k++)
        curve[k] /= runs;
    return runs > 0;
}

static enum err write_chart(const struct effort_report *report, enum effort_robot_kind robot,
                            enum effort_group group, const char *path, struct fault *fault)
{
    double curve[PLOT_SERIES_MOST][CURVE];
    struct plot_series series[PLOT_SERIES_MOST];
    char title[96], number[CURVE][12];
    const char *name[CURVE];
    size_t count = 0;
    for (size_t m = 0; m < report->methods && count < PLOT_SERIES_MOST; m++)
        if (report->method[m].charted && mean_curve(curve[count], report, m, robot, group)) {
            series[count] =
                (struct plot_series){report->method[m].name, curve[count], (unsigned)count};
            count++;
        }
    for (int k = 0; k < CURVE; k++) {
        snprintf(number[k], sizeof number[k], "%d", k + 2);
        name[k] = number[k];
    }
    snprintf(title, sizeof title, "Dice by gestures, %s robot: %u objects, %s",
             effort_robot_name[robot], most_runs(report, robot, group), effort_group_name[group]);
    const struct plot plot = {
        .title = title,
        .caption = "mean over objects; each gesture corrects what is most wrong",
        .unit = "Dice",
        .group = name,
        .groups = CURVE,
        .groups_are = "gestures",
        .series = series,
        .count = count,
    };
    struct buf svg = {0};
    plot_lines(&svg, &plot);
    const enum err err = svg.failed
                             ? fault_memory(fault, "a chart")
                             : file_write(path, buf_text(&svg), svg.length, FILE_KEEP, fault);
    buf_release(&svg);
    return err;
}

enum err effort_report_plots(const struct effort_report *report, const char *folder,
                             struct fault *fault)
{
    struct buf path = {0};
    enum err err = file_make_folder(folder, fault);
    for (int group = 0; group < EFFORT_GROUPS; group++)
        for (int robot = 0; robot < ROBOT_KINDS && !err; robot++) {
            const enum effort_robot_kind r = (enum effort_robot_kind)robot;
            const enum effort_group g = (enum effort_group)group;
            buf_clear(&path);
            buf_printf(&path, "%s/effort-%s-%s.svg", folder, effort_group_name[g],
                       effort_robot_name[r]);
            if (path.failed)
                err = fault_memory(fault, "a path");
            else if (most_runs(report, r, g))
                err = write_chart(report, r, g, buf_text(&path), fault);
        }
    buf_release(&path);
    return err;
}
