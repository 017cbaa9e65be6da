/* SPDX-License-Identifier: MIT */
/* The figures of the report for programs, and as charts. */
#include "tests/bench/report.h"

#include <string.h>

#include "base/file.h"
#include "base/json.h"
#include "tests/bench/plot.h"

static const char *const phase_name[PHASES] = {"segmentation_ms", "border_ms", "rendition_ms"};

/* ---- JSON ---- */

static void add_experiment(struct json *json, const struct trial_step *step, enum experiment e)
{
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
    for (enum experiment e = 0; e < EXPERIMENTS; e++)
        add_experiment(json, step, e);
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
    struct buf text = {0};
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
    buf_release(&text);
}

/* ---- CSV ---- */

void report_csv(FILE *out, const struct trial *trial, size_t count)
{
    fputs("scene,scene_voxels,step,seeds,experiment,method,segmentation_ms,border_ms,rendition_ms,"
          "total_ms,voxels,ns_per_voxel,whole,border_voxels,forest,labels,picture\n",
          out);
    for (size_t i = 0; i < count; i++)
        for (unsigned s = 0; s < trial[i].steps; s++)
            for (enum experiment e = 0; e < EXPERIMENTS; e++) {
                const struct trial_step *step = &trial[i].step[s];
                fprintf(out, "%s,%zu,%u,%u,%u,%s", trial[i].name, trial[i].voxels, s + 1,
                        step->seeds, e + 1, experiment_name[e]);
                for (enum phase p = 0; p < PHASES; p++)
                    fprintf(out, ",%.4f", step->cost[e].ms[p]);
                fprintf(out, ",%.4f,%llu,%.2f,%d,%zu,%016llx,%016llx,%016llx\n",
                        trial_total(step, e), (unsigned long long)step->cost[e].served,
                        trial_ns_per_voxel(step, e), step->cost[e].is_whole, step->border_voxels,
                        (unsigned long long)step->keys, (unsigned long long)step->labels,
                        (unsigned long long)step->picture);
            }
}

/* ---- charts ---- */

enum { SCENES_MOST = 32 };

static void chart_path(struct buf *path, const char *folder, const char *what, const char *scene)
{
    buf_clear(path);
    buf_printf(path, "%s/%s%s%s.svg", folder, what, scene ? "-" : "", scene ? scene : "");
}

enum err report_plots_check(const char *folder, const struct trial *trial, size_t count,
                            struct fault *fault)
{
    struct buf path = {0};
    enum err err = file_make_folder(folder, fault);
    for (size_t i = 0; !err && i < count + 2; i++) {
        chart_path(&path, folder,
                   i < count    ? "steps"
                   : i == count ? "segmentation"
                                : "rendition",
                   i < count ? trial[i].name : NULL);
        if (path.failed)
            err = fault_memory(fault, "a path");
        else if (file_exists(buf_text(&path)))
            err = fault_set(fault, ERR_IO, "%s is there already; nothing is overwritten",
                            buf_text(&path));
    }
    buf_release(&path);
    return err;
}

static enum err write_chart(const struct plot *plot, bool lines, const char *path,
                            struct fault *fault)
{
    struct buf svg = {0};
    if (lines)
        plot_lines(&svg, plot);
    else
        plot_bars(&svg, plot);
    enum err err = svg.failed ? fault_memory(fault, "a chart")
                              : file_write(path, buf_text(&svg), svg.length, FILE_KEEP, fault);
    buf_release(&svg);
    return err;
}

/* The means of all scenes. */
static enum err chart_scenes(const char *path, bool renditions, const struct trial *trial,
                             size_t count, struct fault *fault)
{
    static const enum experiment segmentations[] = {IFT_SP, DIFT_SP, BDIFT_BP, DIFT_SCAN_BP};
    static const enum experiment pictures[] = {DIFT_SP, BDIFT_BP, DIFT_II};
    static const char *const segmentation_name[] = {"(1) IFT", "(2) DIFT", "(3) BDIFT",
                                                    "(5) DIFT and scan"};
    static const char *const picture_name[] = {"(2) scene projection", "(3) border projection",
                                               "(4) incremental image"};
    const size_t bars = renditions ? 3 : 4;
    double value[4][SCENES_MOST];
    struct plot_series series[4];
    const char *name[SCENES_MOST];
    for (size_t b = 0; b < bars; b++) {
        const enum experiment e = renditions ? pictures[b] : segmentations[b];
        for (size_t i = 0; i < count; i++)
            value[b][i] = renditions ? trial_mean(&trial[i], e, RENDITION)
                                     : trial_mean(&trial[i], e, SEGMENTATION) +
                                           trial_mean(&trial[i], e, BORDER);
        series[b] =
            (struct plot_series){renditions ? picture_name[b] : segmentation_name[b], value[b], e};
    }
    for (size_t i = 0; i < count; i++)
        name[i] = trial[i].name;
    const struct plot plot = {
        .title = renditions ? "Rendition, 512x512 pixels" : "Segmentation and border upkeep",
        .caption = "mean of the steps after the first, each a median over rounds",
        .unit = "milliseconds",
        .group = name,
        .groups = count,
        .series = series,
        .count = bars,
    };
    return write_chart(&plot, false, path, fault);
}

/* Each step of one scene, from seeds to picture. */
static enum err chart_steps(const char *path, const struct trial *trial, struct fault *fault)
{
    double value[EXPERIMENTS][PROCEDURE_STEPS];
    struct plot_series series[EXPERIMENTS];
    char names[EXPERIMENTS][32], steps[PROCEDURE_STEPS][24], title[64];
    const char *group[PROCEDURE_STEPS];
    for (unsigned s = 0; s < trial->steps; s++) {
        snprintf(steps[s], sizeof steps[s], "%u (%u)", s + 1, trial->step[s].seeds);
        group[s] = steps[s];
        for (enum experiment e = 0; e < EXPERIMENTS; e++)
            value[e][s] = trial_total(&trial->step[s], e);
    }
    for (enum experiment e = 0; e < EXPERIMENTS; e++) {
        snprintf(names[e], sizeof names[e], "(%u) %s", e + 1, experiment_name[e]);
        series[e] = (struct plot_series){names[e], value[e], e};
    }
    snprintf(title, sizeof title, "%s: from seeds to picture", trial->name);
    const struct plot plot = {
        .title = title,
        .caption = "segmentation, border upkeep and rendition of each step; median over rounds",
        .unit = "milliseconds",
        .group = group,
        .groups = trial->steps,
        .groups_are = "step (seeds so far)",
        .series = series,
        .count = EXPERIMENTS,
    };
    return write_chart(&plot, true, path, fault);
}

enum err report_plots(const char *folder, const struct trial *trial, size_t count,
                      struct fault *fault)
{
    struct buf path = {0};
    enum err err = OK;
    count = count < SCENES_MOST ? count : SCENES_MOST;
    for (int renditions = 0; !err && renditions < 2; renditions++) {
        chart_path(&path, folder, renditions ? "rendition" : "segmentation", NULL);
        err = chart_scenes(buf_text(&path), renditions, trial, count, fault);
    }
    for (size_t i = 0; !err && i < count; i++) {
        chart_path(&path, folder, "steps", trial[i].name);
        err = chart_steps(buf_text(&path), &trial[i], fault);
    }
    buf_release(&path);
    return err;
}
