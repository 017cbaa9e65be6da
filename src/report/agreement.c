/* SPDX-License-Identifier: MIT */
#include "report/agreement.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "report/figures.h"
#include "session/state.h"
#include "session/tally.h"

/* ---- the consensus ---- */

/* The label that most of them give a voxel; 0, and *tied, where that is more than one. `votes` is
 * all zeros, and is so again. */
static uint8_t vote(const uint8_t *const label[], unsigned raters, size_t voxel, uint8_t votes[256],
                    bool *tied)
{
    unsigned most = 0;
    uint8_t winner = 0;
    *tied = false;
    for (unsigned r = 0; r < raters; r++) {
        const uint8_t l = label[r][voxel];
        const unsigned now = ++votes[l];
        if (now > most) {
            most = now;
            winner = l;
            *tied = false;
        } else if (now == most) {
            *tied = true;
        }
    }
    for (unsigned r = 0; r < raters; r++)
        votes[label[r][voxel]] = 0;
    return *tied ? 0 : winner;
}

enum err agreement_majority(uint8_t *consensus, uint64_t *ties, const uint8_t *const label[],
                            unsigned raters, size_t voxels, struct watch *watch,
                            struct fault *fault)
{
    uint8_t votes[256] = {0};
    struct task task = task_begin(watch, "the consensus", voxels);
    *ties = 0;
    for (size_t i = 0; i < voxels && task_advance(&task, 1); i++) {
        bool tied;
        consensus[i] = vote(label, raters, i, votes, &tied);
        *ties += tied;
    }
    return watch_fault(watch, fault);
}

/* ---- counts ---- */

static enum err count(struct overlap *overlap, const uint8_t *a, const uint8_t *b, size_t voxels,
                      struct watch *watch, struct fault *fault)
{
    overlap_count(overlap, a, b, voxels);
    return watch_fault(watch, fault);
}

enum err agreement_count(struct agreement *agreement, struct watch *watch, struct fault *fault)
{
    const unsigned raters = agreement->raters;
    const size_t voxels = agreement->voxels;
    agreement->rater = mem_array(raters, sizeof *agreement->rater);
    agreement->pair = mem_array((size_t)raters * (raters - 1) / 2, sizeof *agreement->pair);
    enum err err =
        agreement->rater && agreement->pair ? OK : fault_memory(fault, "how far raters agree");
    struct overlap *pair = agreement->pair;
    for (unsigned a = 0; a < raters; a++) {
        if (!err)
            err = count(&agreement->rater[a], agreement->label[a], agreement->consensus, voxels,
                        watch, fault);
        for (unsigned b = a + 1; b < raters && !err; b++)
            err = count(pair++, agreement->label[a], agreement->label[b], voxels, watch, fault);
    }
    return err;
}

void agreement_release(struct agreement *agreement)
{
    free(agreement->rater);
    free(agreement->pair);
    agreement->rater = agreement->pair = NULL;
}

/* ---- figures ---- */

static double sensitivity(const struct agreement *g, unsigned rater, unsigned label)
{
    const struct overlap_counts n = overlap_counts_of(&g->rater[rater], label);
    const double *estimate = g->estimate[rater].sensitivity;
    return !label ? NAN : estimate ? estimate[label] : figures_ratio((double)n.both, (double)n.b);
}

static double specificity(const struct agreement *g, unsigned rater, unsigned label)
{
    const struct overlap_counts n = overlap_counts_of(&g->rater[rater], label);
    const double *estimate = g->estimate[rater].specificity, outside = (double)(g->voxels - n.b);
    return !label     ? NAN
           : estimate ? estimate[label]
                      : figures_ratio(outside - (double)(n.a - n.both), outside);
}

/* Whether any rater has the label; label 0, which stands for all, is always there. */
static bool has(const struct agreement *g, unsigned label)
{
    bool is_there = !label;
    for (unsigned r = 0; r < g->raters && !is_there; r++)
        is_there = g->rater[r].a[label] || g->rater[r].b[label];
    return is_there;
}

static struct figures figures_of(const struct agreement *g, unsigned rater, unsigned label)
{
    const struct overlap_counts n = overlap_counts_of(&g->rater[rater], label);
    const double mm3 = tally_voxel_mm3(g->geometry);
    struct figures f = {.count = 0};
    figures_add(&f, "voxels", (double)n.a);
    figures_add(&f, "voxels_consensus", (double)n.b);
    figures_add(&f, "voxels_both", (double)n.both);
    figures_add(&f, "volume_mm3", (double)n.a * mm3);
    figures_add(&f, "volume_consensus_mm3", (double)n.b * mm3);
    figures_add(&f, "dice", figures_dice(&g->rater[rater], label));
    figures_add(&f, "sensitivity", sensitivity(g, rater, label));
    figures_add(&f, "specificity", specificity(g, rater, label));
    return f;
}

/* ---- JSON ---- */

static void add_label(struct json *json, const struct agreement *g, unsigned label)
{
    json_object(json, NULL);
    json_count(json, "label", label);
    json_text(json, "name", g->label_name[label]);
}

static void add_rater(struct json *json, const struct agreement *g, unsigned rater)
{
    struct figures f = figures_of(g, rater, 0);
    json_object(json, NULL);
    json_text(json, "file", g->name[rater]);
    json_object(json, "all");
    figures_write_json(json, &f);
    json_end(json);
    json_array(json, "labels");
    for (unsigned label = 1; label < 256; label++) {
        if (!has(g, label))
            continue;
        f = figures_of(g, rater, label);
        add_label(json, g, label);
        figures_write_json(json, &f);
        json_end(json);
    }
    json_end(json);
    json_end(json);
}

static void add_pair(struct json *json, const struct agreement *g, unsigned a, unsigned b,
                     const struct overlap *overlap)
{
    json_object(json, NULL);
    json_text(json, "a", g->name[a]);
    json_text(json, "b", g->name[b]);
    json_count(json, "differing", overlap->differing);
    json_real(json, "dice", figures_dice(overlap, 0), 12);
    json_array(json, "labels");
    for (unsigned label = 1; label < 256; label++) {
        if (!has(g, label))
            continue;
        add_label(json, g, label);
        json_real(json, "dice", figures_dice(overlap, label), 12);
        json_end(json);
    }
    json_end(json);
    json_end(json);
}

void agreement_write_json(struct buf *out, const struct agreement *g)
{
    struct json json = {.out = out};
    const struct overlap *pair = g->pair;
    json_object(&json, NULL);
    json_text(&json, "by", g->by);
    json_count(&json, "voxels", g->voxels);
    if (g->has_ties)
        json_count(&json, "tied", g->ties);
    json_array(&json, "raters");
    for (unsigned r = 0; r < g->raters; r++)
        add_rater(&json, g, r);
    json_end(&json);
    json_array(&json, "pairs");
    for (unsigned a = 0; a < g->raters; a++)
        for (unsigned b = a + 1; b < g->raters; b++)
            add_pair(&json, g, a, b, pair++);
    json_end(&json);
    json_end(&json);
}

/* ---- CSV ---- */

void agreement_write_csv(struct buf *out, const struct agreement *g)
{
    struct figures f = figures_of(g, 0, 0);
    buf_add_text(out, "rater,");
    figures_write_csv_names(out, &f);
    for (unsigned r = 0; r < g->raters; r++) {
        struct buf name = {0};
        buf_add_safe_text(&name, g->name[r]);
        for (unsigned n = 1; n <= 256; n++) {
            const unsigned label = n % 256; /* all together come last */
            if (!has(g, label))
                continue;
            f = figures_of(g, r, label);
            buf_add_csv(out, buf_text(&name));
            if (label)
                buf_printf(out, ",%u", label);
            else
                buf_add_text(out, ",all");
            figures_write_csv(out, label ? g->label_name[label] : "", &f);
        }
        out->failed |= name.failed;
        buf_release(&name);
    }
}

/* ---- tables ---- */

/* A row for each rater, and one for the consensus. */
static void write_label(struct buf *out, const struct agreement *g, unsigned label)
{
    struct buf name = {0};
    if (label)
        buf_printf(&name, "%u ", label);
    buf_add_safe_text(&name, label ? g->label_name[label] : "all");
    for (unsigned r = 0; r < g->raters; r++) {
        buf_printf(out, "%-16s", r ? "" : buf_text(&name));
        figures_add_cell(out, 7, 4, figures_dice(&g->rater[r], label));
        figures_add_cell(out, 11, 4, sensitivity(g, r, label));
        figures_add_cell(out, 11, 4, specificity(g, r, label));
        figures_add_volume(out, 9, "", g->geometry, overlap_counts_of(&g->rater[r], label).a);
        buf_add_text(out, "  ");
        buf_add_safe_text(out, g->name[r]);
        buf_add_char(out, '\n');
    }
    buf_printf(out, "%-48s", "");
    figures_add_volume(out, 9, "", g->geometry, overlap_counts_of(&g->rater[0], label).b);
    buf_add_text(out, "  consensus\n");
    out->failed |= name.failed;
    buf_release(&name);
}

void agreement_write_text(struct buf *out, const struct agreement *g)
{
    const struct overlap *pair = g->pair;
    unsigned labels = 0;
    buf_printf(out, "%-16s    Dice sensitivity specificity    volume  rater\n", "");
    for (unsigned label = 1; label < 256; label++)
        if (has(g, label)) {
            write_label(out, g, label);
            labels++;
        }
    if (labels != 1)
        write_label(out, g, 0);
    buf_printf(out, "%-16s %7s\n", "pairs of raters", "Dice");
    for (unsigned a = 0; a < g->raters; a++)
        for (unsigned b = a + 1; b < g->raters; b++) {
            buf_printf(out, "%-16s", "");
            figures_add_cell(out, 7, 4, figures_dice(pair++, 0));
            buf_add_text(out, "  ");
            buf_add_safe_text(out, g->name[a]);
            buf_add_text(out, ", ");
            buf_add_safe_text(out, g->name[b]);
            buf_add_char(out, '\n');
        }
    buf_printf(out, "consensus by %s of %u raters, %zu voxels\n",
               g->has_ties ? "majority" : "STAPLE", g->raters, g->voxels);
    if (g->has_ties && g->ties)
        buf_printf(out,
                   "%" PRIu64 " voxel%s tied between two labels or more, and %s no label in the "
                   "consensus\n",
                   g->ties, g->ties == 1 ? " is" : "s are", g->ties == 1 ? "has" : "have");
    else if (g->has_ties)
        buf_add_text(out, "no voxel is tied\n");
    figures_add_spacing(out, g->geometry->spacing_unknown);
}
