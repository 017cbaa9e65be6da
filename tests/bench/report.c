/* SPDX-License-Identifier: MIT */
#include "tests/bench/report.h"

#include "base/json.h"
#include "base/mem.h"

const struct ratio_told ratio_told[RATIOS] = {
    [RATIO_IFT] = {"ift_to_dift", {"IFT/", "DIFT"}, 4, "> 4"},
    [RATIO_BDIFT] = {"bdift_to_dift", {"BDIFT/", "DIFT"}, 1.14, "1.14"},
    [RATIO_KEEP] = {"bdift_to_scan", {"BDIFT/", "scan"}, 0.80, "0.80"},
    [RATIO_BP] = {"bp_to_sp", {"BP/", "SP"}, 0.58, "0.58"},
    [RATIO_II] = {"ii_to_sp", {"II/", "SP"}, 0.76, "0.76"},
    [RATIO_WITH_BP] = {"step_3_to_2", {"step", "(3)/(2)"}, 1.08, "1.08"},
    [RATIO_WITH_II] = {"step_4_to_2", {"step", "(4)/(2)"}, 0.97, "0.97"},
    [RATIO_BORDER_SHARE] = {"border_share", {"border", "share"}, 0, "-"},
};

static double over(double a, double b)
{
    return b > 0 ? a / b : 0;
}

static double kept(const struct trial *trial, enum experiment e)
{
    return trial_mean(trial, e, SEGMENTATION) + trial_mean(trial, e, BORDER);
}

double report_ratio(const struct trial *t, enum ratio ratio)
{
    const double dift = trial_mean(t, DIFT_SP, SEGMENTATION);
    const double sp = trial_mean(t, DIFT_SP, RENDITION), step = trial_mean_total(t, DIFT_SP);
    switch (ratio) {
    case RATIO_IFT:
        return over(trial_mean(t, IFT_SP, SEGMENTATION), dift);
    case RATIO_BDIFT:
        return over(kept(t, BDIFT_BP), dift);
    case RATIO_KEEP:
        return over(kept(t, BDIFT_BP), kept(t, DIFT_SCAN_BP));
    case RATIO_BP:
        return over(trial_mean(t, BDIFT_BP, RENDITION), sp);
    case RATIO_II:
        return over(trial_mean(t, DIFT_II, RENDITION), sp);
    case RATIO_WITH_BP:
        return over(trial_mean_total(t, BDIFT_BP), step);
    case RATIO_WITH_II:
        return over(trial_mean_total(t, DIFT_II), step);
    case RATIO_BORDER_SHARE:
        return over(trial_mean(t, BDIFT_BP, BORDER), kept(t, BDIFT_BP));
    case RATIOS:
        break;
    }
    return 0;
}

/* ---- one scene ---- */

static void print_means(FILE *out, const struct trial *t)
{
    fprintf(out, "%-24s %12s %10s %10s %10s %12s\n", t->steps > 1 ? "mean after step 1, ms" : "ms",
            "segmentation", "border", "rendition", "total", "step 1");
    for (enum experiment e = 0; e < EXPERIMENTS; e++) {
        char border[16] = "-";
        if (trial_mean(t, e, BORDER) > 0)
            snprintf(border, sizeof border, "%.2f", trial_mean(t, e, BORDER));
        fprintf(out, "(%u) %-20s %12.2f %10s %10.2f %10.2f %12.2f\n", e + 1, experiment_name[e],
                trial_mean(t, e, SEGMENTATION), border, trial_mean(t, e, RENDITION),
                trial_mean_total(t, e), trial_total(&t->step[0], e));
    }
}

static void print_steps(FILE *out, const struct trial *t)
{
    bool some_whole = false;
    fprintf(out, "\n%31s %6s %9s  %s\n", "voxels", "ns per", "border", "total, ms");
    fprintf(out, "%4s %6s %19s %6s %9s %8s %8s %8s %8s %8s\n", "step", "seeds", "updated", "voxel",
            "voxels", "(1)", "(2)", "(3)", "(4)", "(5)");
    for (unsigned s = 0; s < t->steps; s++) {
        const struct trial_step *step = &t->step[s];
        const struct trial_cost *cost = &step->cost[DIFT_SP];
        fprintf(out, "%4u %6u %11llu %3.0f %% %c %6.1f %9zu", s + 1, step->seeds,
                (unsigned long long)cost->served, 100 * (double)cost->served / (double)t->voxels,
                cost->is_whole ? '*' : ' ', trial_ns_per_voxel(step, DIFT_SP), step->border_voxels);
        for (enum experiment e = 0; e < EXPERIMENTS; e++)
            fprintf(out, " %8.1f", trial_total(step, e));
        putc('\n', out);
        some_whole = some_whole || cost->is_whole;
    }
    if (some_whole)
        fputs("* so many that border and incremental image are made from nothing\n", out);
}

static void print_scene(FILE *out, const struct trial *t)
{
    fprintf(out, "%s: %ux%ux%u, %zu voxels%s; median of %u round%s, %u thread%s\n\n", t->name,
            t->size[0], t->size[1], t->size[2], t->voxels, t->in_paper ? "" : " (not in the paper)",
            t->rounds, t->rounds == 1 ? "" : "s", t->threads, t->threads == 1 ? "" : "s");
    print_means(out, t);
    print_steps(out, t);
    fprintf(out, "\nidentical labels, keys and pictures in all experiments: %llu comparisons\n\n\n",
            (unsigned long long)t->compared);
}

void report_scenes(FILE *out, const struct trial *trial, size_t count)
{
    for (size_t i = 0; i < count; i++)
        print_scene(out, &trial[i]);
}

/* ---- all scenes ---- */

static void print_times(FILE *out, const struct trial *trial, size_t count)
{
    fprintf(out, "Segmentation with border upkeep, and rendition: means after step 1, ms\n\n");
    fprintf(out, "%-12s %8s %8s %8s %8s  %8s %8s  %8s %8s %8s\n", "", "IFT", "DIFT", "BDIFT",
            "scan", "DIFT", "BDIFT", "SP", "BP", "II");
    fprintf(out, "%-12s %8s %8s %8s %8s  %8s %8s  %8s %8s %8s\n", "", "(1)", "(2)", "(3)", "(5)",
            "step 1", "step 1", "(2)", "(3)", "(4)");
    for (size_t i = 0; i < count; i++) {
        const struct trial *t = &trial[i];
        const double *first = t->step[0].cost[BDIFT_BP].ms;
        fprintf(out, "%-12s %8.1f %8.1f %8.1f %8.1f  %8.1f %8.1f  %8.1f %8.1f %8.1f\n", t->name,
                kept(t, IFT_SP), kept(t, DIFT_SP), kept(t, BDIFT_BP), kept(t, DIFT_SCAN_BP),
                t->step[0].cost[DIFT_SP].ms[SEGMENTATION], first[SEGMENTATION] + first[BORDER],
                trial_mean(t, DIFT_SP, RENDITION), trial_mean(t, BDIFT_BP, RENDITION),
                trial_mean(t, DIFT_II, RENDITION));
    }
    fprintf(out, "%-12s %8s %8s %8s %8s  %8s %8s  %8s %8s %8s\n", "paper, brain", "16000", "< 4500",
            "< 4500", "-", "17000", "21000", "300", "174", "228");
    fprintf(out, "%-12s %8s %8s %8s %8s  %8s %8s  %8s %8s %8s\n\n", "paper, g.222", "-", "-", "-",
            "-", "-", "-", "1300", "460", "-");
}

/* The border's share may be a few thousandths. */
static int decimals(enum ratio ratio)
{
    return ratio == RATIO_BORDER_SHARE ? 4 : 2;
}

static void print_ratios(FILE *out, const struct trial *trial, size_t count)
{
    fprintf(out, "Ratios of these means\n\n%-12s", "");
    for (int half = 0; half < 2; half++) {
        for (enum ratio r = 0; r < RATIOS; r++)
            fprintf(out, " %8s", ratio_told[r].words[half]);
        fprintf(out, half == 0 ? "\n%-12s" : "\n", "");
    }
    double sum[RATIOS] = {0};
    for (size_t i = 0; i < count; i++) {
        fprintf(out, "%-12s", trial[i].name);
        for (enum ratio r = 0; r < RATIOS; r++) {
            const double ratio = report_ratio(&trial[i], r);
            fprintf(out, " %8.*f", decimals(r), ratio);
            sum[r] += ratio / (double)count;
        }
        putc('\n', out);
    }
    if (count > 1) {
        fprintf(out, "%-12s", "mean");
        for (enum ratio r = 0; r < RATIOS; r++)
            fprintf(out, " %8.*f", decimals(r), sum[r]);
        putc('\n', out);
    }
    fprintf(out, "%-12s", "paper");
    for (enum ratio r = 0; r < RATIOS; r++)
        fprintf(out, " %8s", ratio_told[r].paper_words);
    fprintf(out, "\n\n");
}

static const char caption[] =
    "(1) IFT + SP: forest from scratch, scene projection. (2) DIFT + SP: differential update.\n"
    "(3) BDIFT + BP: border kept up to date, border projection. (4) DIFT + II: incremental\n"
    "image. (5) DIFT + scan + BP: border sought in the whole scene, border projection.\n"
    "Segmentation is the forest with its digests. Rendition ends with the shaded picture of\n"
    "512x512; that of SP begins with a scan of all labels. II looks into the border too, so (4)\n"
    "pays for its upkeep. Border share: upkeep of the border in an update of (3). Threads, where\n"
    "there are several, grow a forest from nothing; IFTTY_THREADS=1 leaves it to one. The paper:\n"
    "a Pentium 4 of 2.4 GHz.\n";

void report_summary(FILE *out, const struct trial *trial, size_t count)
{
    print_times(out, trial, count);
    print_ratios(out, trial, count);
    fputs(caption, out);
}

/* ---- for programs ---- */

static const char *const phase_name[PHASES] = {"segmentation_ms", "border_ms", "rendition_ms"};

static void add_step(struct json *json, const struct trial *trial, unsigned s)
{
    const struct trial_step *step = &trial->step[s];
    json_object(json, NULL);
    json_count(json, "step", s + 1);
    json_count(json, "seeds", step->seeds);
    json_count(json, "border_voxels", step->border_voxels);
    json_format(json, "forest", "%016llx", (unsigned long long)step->keys);
    json_format(json, "labels", "%016llx", (unsigned long long)step->labels);
    json_format(json, "picture", "%016llx", (unsigned long long)step->picture);
    json_array(json, "experiments");
    for (enum experiment e = 0; e < EXPERIMENTS; e++) {
        json_object(json, NULL);
        json_count(json, "experiment", e + 1);
        json_text(json, "method", experiment_name[e]);
        for (enum phase p = 0; p < PHASES; p++)
            json_fixed(json, phase_name[p], step->cost[e].ms[p], 4);
        json_fixed(json, "total_ms", trial_total(step, e), 4);
        json_count(json, "voxels", step->cost[e].served);
        json_fixed(json, "ns_per_voxel", trial_ns_per_voxel(step, e), 2);
        json_boolean(json, "whole", step->cost[e].is_whole);
        json_end(json);
    }
    json_end(json);
    json_end(json);
}

static void add_scene(struct json *json, const struct trial *t)
{
    json_object(json, NULL);
    json_text(json, "scene", t->name);
    json_boolean(json, "in_paper", t->in_paper);
    json_array(json, "size");
    for (int a = 0; a < 3; a++)
        json_count(json, NULL, t->size[a]);
    json_end(json);
    json_count(json, "voxels", t->voxels);
    json_boolean(json, "identical", true);
    json_count(json, "comparisons", t->compared);
    json_object(json, "ratios");
    for (enum ratio r = 0; r < RATIOS; r++)
        json_fixed(json, ratio_told[r].name, report_ratio(t, r), 4);
    json_end(json);
    json_array(json, "steps");
    for (unsigned s = 0; s < t->steps; s++)
        add_step(json, t, s);
    json_end(json);
    json_end(json);
}

void report_json(FILE *out, const struct trial *trial, size_t count)
{
    OWNED(buf_release) struct buf text = {0};
    struct json json = {.out = &text, .lines = 6};
    json_object(&json, NULL);
    json_count(&json, "rounds", count ? trial[0].rounds : 0);
    json_count(&json, "threads", count ? trial[0].threads : 0);
    json_array(&json, "picture");
    json_count(&json, NULL, TRIAL_SIDE);
    json_count(&json, NULL, TRIAL_SIDE);
    json_end(&json);
    json_array(&json, "scenes");
    for (size_t i = 0; i < count; i++)
        add_scene(&json, trial + i);
    json_end(&json);
    json_object(&json, "paper");
    for (enum ratio r = 0; r < RATIOS; r++)
        if (ratio_told[r].paper > 0)
            json_fixed(&json, ratio_told[r].name, ratio_told[r].paper, 2);
    json_end(&json);
    json_end(&json);
    fputs(buf_text(&text), out);
}
