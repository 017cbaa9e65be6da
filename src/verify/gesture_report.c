/* SPDX-License-Identifier: MIT */
#include "verify/gesture_report.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "engine/overlap.h"
#include "report/figures.h"
#include "verify/side.h"

/* Rows of the table of steps. */
enum { ROWS_MOST = 16 };

static const char *const who[2] = {"expert", "trainee"};

/* ---- figures ---- */

void gesture_report_count(struct gesture_report *report)
{
    for (int i = 0; i < 2; i++) {
        const struct gestures *g = report->gestures[i];
        const struct side *side = report->side[i];
        struct gesture_counts *count = &report->count[i];
        for (size_t n = 0; n < g->count; n++) {
            const struct gesture *gesture = &g->gesture[n];
            count->kind[gesture->kind]++;
            count->taken_back += gesture->is_taken_back;
            if (gesture_may_match(gesture)) {
                count->label[gesture->label]++;
                count->placed++;
            }
        }
        for (int l = 0; l < GESTURE_NO_LABEL; l++)
            report->has[l] |= count->label[l] ||
                              (l && l <= UINT8_MAX && memchr(side->labels, l, side->facts->voxels));
    }
}

const char *gesture_report_name(const struct gesture_report *report, unsigned label)
{
    if (label == GESTURE_ERASES)
        return "eliminators";
    const char *name = report->side[0]->facts->label_name[label];
    name = *name ? name : report->side[1]->facts->label_name[label];
    return *name || label ? name : "background";
}

/* Ten-thousandths, after so many gestures; 0 before the first step. */
static unsigned dice_after(const struct gestures *gestures, uint32_t after, unsigned label)
{
    unsigned dice = 0;
    for (size_t i = 0; i < gestures->steps && gestures->step[i].gestures <= after; i++)
        dice = gestures->step[i].dice[label];
    return dice;
}

struct distances {
    size_t count;
    double median_mm, most_mm; /* of two in the middle the farther; NAN of none */
};

static int compare_squared(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

/* Those of matched gestures of a label; without memory `out` has failed. */
static struct distances distances_of(struct buf *out, const struct gesture_report *report,
                                     unsigned label)
{
    const struct gesture_match *match = report->match;
    struct distances d = {0, NAN, NAN};
    struct gesture_pair of = {.squared = 0};
    uint64_t *squared = mem_array(match->pairs + 1, sizeof *squared);
    out->failed |= !squared;
    for (size_t i = 0; squared && i < match->pairs; i++)
        if (report->gestures[0]->gesture[match->pair[i].expert].label == label)
            squared[d.count++] = match->pair[i].squared;
    if (d.count) {
        qsort(squared, d.count, sizeof *squared, compare_squared);
        of.squared = squared[d.count / 2];
        d.median_mm = gesture_pair_mm(match, &of);
        of.squared = squared[d.count - 1];
        d.most_mm = gesture_pair_mm(match, &of);
    }
    free(squared);
    return d;
}

static uint32_t last_gesture(const struct gesture_report *report)
{
    const size_t a = report->gestures[0]->count, b = report->gestures[1]->count;
    return (uint32_t)(a > b ? a : b);
}

/* ---- for people ---- */

static void write_count(struct buf *out, const char *name, size_t expert, size_t trainee)
{
    if (expert || trainee)
        buf_printf(out, "%-22s %8zu %8zu\n", name, expert, trainee);
}

static void write_kinds(struct buf *out, const struct gesture_report *report)
{
    const struct gesture_counts *a = &report->count[0], *b = &report->count[1];
    buf_printf(out, "%-22s %8s %8s\n", "gestures", who[0], who[1]);
    for (unsigned kind = 0; kind < GESTURE_KIND_COUNT; kind++)
        write_count(out, gesture_kind_name[kind], a->kind[kind], b->kind[kind]);
    write_count(out, "all", report->gestures[0]->count, report->gestures[1]->count);
    write_count(out, "taken back", a->taken_back, b->taken_back);
}

static void write_places(struct buf *out, const struct gesture_report *report)
{
    const struct gesture_counts *a = &report->count[0], *b = &report->count[1];
    const size_t pairs = report->match->pairs;
    buf_printf(out, "%-22s %8s %8s %8s %8s %8s %8s\n", "places", who[0], who[1], "matched",
               "median", "most mm", "Dice");
    for (unsigned label = 0; label <= GESTURE_ERASES; label++) {
        struct buf name = {0};
        if (!report->has[label])
            continue;
        if (label < GESTURE_ERASES)
            buf_printf(&name, "%u ", label);
        buf_add_safe_text(&name, gesture_report_name(report, label));
        const struct distances d = distances_of(out, report, label);
        buf_printf(out, "%-22s %8zu %8zu %8zu", buf_text(&name), a->label[label], b->label[label],
                   d.count);
        buf_release(&name);
        figures_add_cell(out, 8, 2, d.median_mm);
        figures_add_cell(out, 8, 2, d.most_mm);
        const unsigned dice = dice_after(report->gestures[1], UINT32_MAX, label);
        if (label && label < GESTURE_ERASES)
            buf_printf(out, " %3u.%04u", dice / DICE_ONE, dice % DICE_ONE);
        buf_add_char(out, '\n');
    }
    buf_printf(out,
               "the nearest of the same label, one to one, no farther than %.2f mm:\n"
               "%zu matched, %zu of the expert and %zu of the trainee not\n",
               report->match->limit_mm, pairs, a->placed - pairs, b->placed - pairs);
    figures_add_spacing(out, report->side[0]->facts->spacing_unknown);
}

/* Kendall's tau is a fraction of whole numbers: it is printed as it is, and as a decimal. */
static void write_order(struct buf *out, const struct gesture_report *report)
{
    const struct gesture_match *m = report->match;
    const uint64_t all = m->agreeing + m->disagreeing;
    if (!all) {
        buf_add_text(out, "order     fewer than two gestures are matched\n");
        return;
    }
    const int64_t more = (int64_t)m->agreeing - (int64_t)m->disagreeing;
    buf_printf(out,
               "order     Kendall's tau %" PRId64 "/%" PRIu64 " (%.4f); the longest common order "
               "has %" PRIu64 " of %zu matched\n",
               more, all, (double)more / (double)all, m->longest, m->pairs);
}

static void write_steps(struct buf *out, const struct gesture_report *report)
{
    const uint32_t last = last_gesture(report);
    const uint32_t rows = last < ROWS_MOST ? last : ROWS_MOST;
    buf_printf(out, "%-22s %8s %8s\n", "Dice after gestures", who[0], who[1]);
    for (uint32_t row = 1; row <= rows; row++) {
        const uint32_t after = (uint32_t)((uint64_t)row * last / rows);
        buf_printf(out, "%-22u", after);
        for (int i = 0; i < 2; i++) {
            const struct gestures *g = report->gestures[i];
            const unsigned dice = dice_after(g, after, DICE_OF_ALL);
            const uint64_t before = (uint64_t)(row - 1) * last / rows;
            if (before >= g->count && row > 1) /* it has ended: the table says so */
                buf_printf(out, " %8s", "-");
            else
                buf_printf(out, " %3u.%04u", dice / DICE_ONE, dice % DICE_ONE);
        }
        buf_add_char(out, '\n');
    }
    buf_add_text(out, "Dice is with the labels that the expert ends with, of all labels; edits "
                      "that wait count from\nthe run that applies them\n");
}

void gesture_report_write_text(struct buf *out, const struct gesture_report *report)
{
    for (int i = 0; i < 2; i++) {
        buf_printf(out, "%-9s ", who[i]);
        buf_add_safe_text(out, report->path[i]);
        buf_add_char(out, '\n');
    }
    write_kinds(out, report);
    write_places(out, report);
    write_order(out, report);
    buf_add_text(out, "time      a journal records none\n");
    write_steps(out, report);
}

/* ---- for programs ---- */

static void add_json_side(struct json *json, const struct gesture_report *report, int i)
{
    json_object(json, i ? "b" : "a");
    json_text(json, "file", report->path[i]);
    json_text(json, "scene", report->side[i]->facts->proof);
    json_count(json, "gestures", report->gestures[i]->count);
    json_count(json, "taken_back", report->count[i].taken_back);
    json_count(json, "placed", report->count[i].placed);
    json_end(json);
}

static void add_json_kinds(struct json *json, const struct gesture_report *report)
{
    json_array(json, "kinds");
    for (unsigned kind = 0; kind < GESTURE_KIND_COUNT; kind++) {
        json_object(json, NULL);
        json_text(json, "kind", gesture_kind_name[kind]);
        json_count(json, "a", report->count[0].kind[kind]);
        json_count(json, "b", report->count[1].kind[kind]);
        json_end(json);
    }
    json_end(json);
}

static void add_json_labels(struct json *json, const struct gesture_report *report)
{
    json_array(json, "labels");
    for (unsigned label = 0; label <= GESTURE_ERASES; label++) {
        if (!report->has[label])
            continue;
        const struct distances d = distances_of(json->out, report, label);
        json_object(json, NULL);
        if (label < GESTURE_ERASES)
            json_count(json, "label", label);
        json_text(json, "name", gesture_report_name(report, label));
        json_count(json, "a", report->count[0].label[label]);
        json_count(json, "b", report->count[1].label[label]);
        json_count(json, "matched", d.count);
        json_real(json, "median_mm", d.median_mm, 12);
        json_real(json, "most_mm", d.most_mm, 12);
        if (label && label < GESTURE_ERASES)
            json_count(json, "dice_ten_thousandths",
                       dice_after(report->gestures[1], UINT32_MAX, label));
        json_end(json);
    }
    json_end(json);
}

static void add_json_pairs(struct json *json, const struct gesture_report *report)
{
    const struct gesture_match *m = report->match;
    json_real(json, "matched_within_mm", m->limit_mm, 12);
    json_array(json, "matched");
    for (size_t i = 0; i < m->pairs; i++) {
        json_object(json, NULL);
        json_count(json, "a", report->gestures[0]->gesture[m->pair[i].expert].record);
        json_count(json, "b", report->gestures[1]->gesture[m->pair[i].trainee].record);
        json_real(json, "mm", gesture_pair_mm(m, &m->pair[i]), 12);
        json_end(json);
    }
    json_end(json);
    for (int side = 0; side < 2; side++) {
        json_array(json, side ? "unmatched_b" : "unmatched_a");
        for (size_t i = 0; i < report->gestures[side]->count; i++) {
            bool is_free = gesture_may_match(&report->gestures[side]->gesture[i]);
            for (size_t p = 0; is_free && p < m->pairs; p++)
                is_free = (side ? m->pair[p].trainee : m->pair[p].expert) != i;
            if (is_free)
                json_count(json, NULL, report->gestures[side]->gesture[i].record);
        }
        json_end(json);
    }
}

static void add_json_order(struct json *json, const struct gesture_match *m)
{
    const double all = (double)m->agreeing + (double)m->disagreeing;
    json_object(json, "order");
    json_count(json, "agreeing", m->agreeing);
    json_count(json, "disagreeing", m->disagreeing);
    json_real(json, "tau", all > 0 ? ((double)m->agreeing - (double)m->disagreeing) / all : NAN,
              12);
    json_count(json, "longest_common", m->longest);
    json_end(json);
}

static void add_json_steps(struct json *json, const struct gesture_report *report, int side)
{
    const struct gestures *g = report->gestures[side];
    json_array(json, side ? "steps_b" : "steps_a");
    for (size_t i = 0; i < g->steps; i++) {
        json_object(json, NULL);
        json_count(json, "record", g->step[i].record);
        json_count(json, "gestures", g->step[i].gestures);
        json_count(json, "dice_ten_thousandths", g->step[i].dice[DICE_OF_ALL]);
        json_array(json, "labels");
        for (unsigned label = 1; label < 256; label++) {
            if (!report->has[label])
                continue;
            json_object(json, NULL);
            json_count(json, "label", label);
            json_count(json, "dice_ten_thousandths", g->step[i].dice[label]);
            json_end(json);
        }
        json_end(json);
        json_end(json);
    }
    json_end(json);
}

void gesture_report_write_json(struct buf *out, const struct gesture_report *report)
{
    struct json json = {.out = out};
    json_object(&json, NULL);
    add_json_side(&json, report, 0);
    add_json_side(&json, report, 1);
    json_boolean(&json, "same_scene", side_scene_is_same(report->side[0], report->side[1]));
    add_json_kinds(&json, report);
    add_json_labels(&json, report);
    add_json_pairs(&json, report);
    add_json_order(&json, report->match);
    add_json_steps(&json, report, 0);
    add_json_steps(&json, report, 1);
    json_end(&json);
}
