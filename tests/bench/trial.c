/* SPDX-License-Identifier: MIT */
#include "tests/bench/trial.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "tests/bench/times.h"
#include "render/incremental.h"
#include "render/shade.h"
#include "render/projection.h"
#include "tests/border_check.h"
#include "show/draw.h"
#include "show/pictures.h"

const char *const experiment_name[EXPERIMENTS] = {"IFT + SP", "DIFT + SP", "BDIFT + BP",
                                                  "DIFT + II", "DIFT + scan + BP"};

/* Test whether an experiment updates session->border. */
static bool keeps_border(enum experiment e)
{
    return e == BDIFT_BP || e == DIFT_II;
}

struct work {
    struct session *session; /* its border is the one that is kept up to date */
    struct border sought;    /* and this one is sought in the whole scene */
    struct mesh mesh[2]; /* of `sought`, recomputed each time; of the session's border, updated */
    struct rendition former; /* before the step, */
    struct rendition made;   /* by the experiment at hand, */
    struct rendition first;  /* and by the first experiment of this step */
    struct shader shader[2]; /* for `sought` and for the session's border */
    struct edit *erase;      /* undoes the step */
    double ms[EXPERIMENTS][PHASES][TRIAL_ROUNDS_MOST];
};

static void work_free(struct work *work)
{
    mesh_release(&work->mesh[0]);
    mesh_release(&work->mesh[1]);
    border_release(&work->sought);
    rendition_release(&work->former);
    rendition_release(&work->made);
    rendition_release(&work->first);
    shader_release(&work->shader[0]);
    shader_release(&work->shader[1]);
    free(work->erase);
    free(work);
}

static struct work *work_new(struct session *session)
{
    struct work *work = must_have(sizeof *work);
    work->session = session;
    work->erase = must_have(PROCEDURE_SEEDS * sizeof *work->erase);
    must(border_init(&work->sought, session->scene, &bench_fault));
    must(rendition_init(&work->former, TRIAL_SIDE, TRIAL_SIDE, &bench_fault));
    must(rendition_init(&work->made, TRIAL_SIDE, TRIAL_SIDE, &bench_fault));
    must(rendition_init(&work->first, TRIAL_SIDE, TRIAL_SIDE, &bench_fault));
    return work;
}

static void copy_rendition(struct rendition *to, const struct rendition *from)
{
    const size_t pixels = (size_t)from->width * from->height;
    memcpy(to->depth, from->depth, pixels * sizeof *to->depth);
    memcpy(to->cell, from->cell, pixels * sizeof *to->cell);
    memcpy(to->label, from->label, pixels);
    memcpy(to->rgba, from->rgba, pixels * 4);
    memcpy(to->normal, from->normal, pixels * 4 * sizeof *to->normal);
    memcpy(to->stale, from->stale, (size_t)from->tiles_x * from->tiles_y);
    memcpy(to->blank, from->blank, (size_t)from->tiles_x * from->tiles_y * sizeof *to->blank);
}

/* ---- one experiment ---- */

static double segment(struct work *work, enum experiment e, const struct edit *edit, size_t count)
{
    struct forest *forest = work->session->forest;
    uint64_t begin = clock_ns();
    must(forest_edit(forest, edit, count, &bench_fault));
    if (e == IFT_SP) {
        begin = clock_ns();
        must(forest_rebuild(forest, &bench_fault));
    }
    return times_since(begin);
}

/* Shading keeps the same data of the previous step for each experiment. */
static void colour(struct work *work, struct rendition *rendition, bool of_kept)
{
    const struct session *session = work->session;
    must(shade(rendition, &session->pictures->camera, &work->mesh[of_kept],
               &session->now.kept.palette, &session->now.outlook.look, &work->shader[of_kept],
               &bench_fault));
}

static void update_mesh(struct work *work, bool of_kept, const struct changes *changes)
{
    const struct session *session = work->session;
    const struct border *border = of_kept ? &session->border : &work->sought;
    if (of_kept)
        mesh_note(&work->mesh[1], border, changes);
    else
        mesh_release(&work->mesh[0]);
    must(mesh_update(&work->mesh[of_kept], border, shade_kind(&session->now.outlook.look),
                     session->team, NULL, &bench_fault));
}

static void render(struct work *work, enum experiment e)
{
    const struct session *session = work->session;
    const struct camera *camera = &session->pictures->camera;
    const struct changes changes = forest_changes(session->forest);
    if (e == IFT_SP || e == DIFT_SP)
        border_recount(&work->sought);
    if (e == DIFT_II) {
        mesh_note(&work->mesh[1], &session->border, &changes);
        must(incremental_image(&work->made, camera, &work->mesh[1], &session->border,
                               &session->now.outlook.look, &changes, session->team, &bench_fault));
    } else {
        update_mesh(work, keeps_border(e), &changes);
        (e == BDIFT_BP || e == DIFT_SCAN_BP ? project_border : project_scene)(
            &work->made, camera, &work->mesh[keeps_border(e)]);
    }
    colour(work, &work->made, keeps_border(e));
}

/* From the forest before the step, with `former` its picture, to the one after it. */
static void carry_out(struct work *work, enum experiment e, const struct edit *edit, size_t count,
                      double ms[PHASES])
{
    copy_rendition(&work->made, &work->former);
    ms[SEGMENTATION] = segment(work, e, edit, count);
    const uint64_t begin = clock_ns();
    const struct changes changes = forest_changes(work->session->forest);
    if (keeps_border(e))
        border_update(&work->session->border, &changes);
    else if (e == DIFT_SCAN_BP)
        border_recount(&work->sought);
    const uint64_t between = clock_ns();
    render(work, e);
    ms[BORDER] = e == IFT_SP || e == DIFT_SP ? 0 : times_between(begin, between);
    ms[RENDITION] = times_since(between);
}

/* Back to the forest before the step; a border that was kept goes with it. */
static void take_back(struct work *work, enum experiment e, const struct edit *edit, size_t count)
{
    for (size_t i = 0; i < count; i++)
        work->erase[i] = (struct edit){edit[i].cell, EDIT_ERASE, 0};
    must(forest_edit(work->session->forest, work->erase, count, &bench_fault));
    const struct changes changes = forest_changes(work->session->forest);
    if (keeps_border(e)) {
        border_update(&work->session->border, &changes);
        update_mesh(work, true, &changes);
    }
}

/* ---- E1 ---- */

static void name_voxel(char out[40], const struct grid *grid, uint32_t cell)
{
    const struct place p = cell == CELL_NONE ? (struct place){0, 0, 0} : grid_place(grid, cell);
    if (cell == CELL_NONE)
        snprintf(out, 40, "nothing");
    else
        snprintf(out, 40, "voxel %u,%u,%u", p.x, p.y, p.z);
}

bool trial_same_picture(const struct rendition *a, const struct rendition *b,
                        const struct grid *grid, struct fault *fault)
{
    char voxel[2][40];
    for (size_t i = 0; i < (size_t)a->width * a->height; i++) {
        const uint8_t *colour[2] = {a->rgba + 4 * i, b->rgba + 4 * i};
        const bool cells = a->cell[i] != b->cell[i] || a->label[i] != b->label[i];
        const bool depths = a->depth[i] != b->depth[i];
        if (!cells && !depths && memcmp(colour[0], colour[1], 4) == 0)
            continue;
        name_voxel(voxel[0], grid, a->cell[i]);
        name_voxel(voxel[1], grid, b->cell[i]);
        if (cells)
            fault_set(fault, ERR_CHECK, "pixel %zu,%zu shows %s of label %u, not %s of label %u",
                      i % a->width, i / a->width, voxel[0], a->label[i], voxel[1], b->label[i]);
        else if (depths)
            fault_set(fault, ERR_CHECK, "pixel %zu,%zu has depth %lld, not %lld", i % a->width,
                      i / a->width, (long long)a->depth[i], (long long)b->depth[i]);
        else
            fault_set(fault, ERR_CHECK,
                      "pixel %zu,%zu has colour %02x%02x%02x%02x, not %02x%02x%02x%02x",
                      i % a->width, i / a->width, colour[0][0], colour[0][1], colour[0][2],
                      colour[0][3], colour[1][0], colour[1][1], colour[1][2], colour[1][3]);
        return false;
    }
    return true;
}

static enum err compare(struct trial *trial, const struct work *work, unsigned s, enum experiment e,
                        struct fault *fault)
{
    const struct forest *forest = work->session->forest;
    const struct trial_step *step = &trial->step[s];
    enum err err = OK;
    if (forest_label_digest(forest) != step->labels)
        err = fault_set(fault, ERR_CHECK, "the labels have digest %016llx, not %016llx",
                        (unsigned long long)forest_label_digest(forest),
                        (unsigned long long)step->labels);
    else if (forest_digest(forest) != step->keys)
        err = fault_set(fault, ERR_CHECK, "the keys have digest %016llx, not %016llx",
                        (unsigned long long)forest_digest(forest), (unsigned long long)step->keys);
    else if (!trial_same_picture(&work->made, &work->first, &work->session->scene->grid, fault))
        err = ERR_CHECK;
    if (err)
        return fault_prefix(fault, err, "%s, step %u, (%u) %s differs", trial->name, s + 1, e + 1,
                            experiment_name[e]);
    trial->compared++;
    return OK;
}

/* Store the results of a step's first experiment for comparison. */
static void remember(struct trial_step *step, struct work *work)
{
    step->labels = forest_label_digest(work->session->forest);
    step->keys = forest_digest(work->session->forest);
    step->picture = rendition_digest(&work->made);
    copy_rendition(&work->first, &work->made);
}

/* ---- a step ---- */

/* The experiments in turn, each beginning a round once. */
static enum err run_round(struct trial *trial, struct work *work, unsigned s, unsigned round,
                          const struct edit *edit, size_t count, struct fault *fault)
{
    struct trial_step *step = &trial->step[s];
    enum err err = OK;
    for (unsigned i = 0; !err && i < EXPERIMENTS; i++) {
        const enum experiment e = (round + i) % EXPERIMENTS;
        double ms[PHASES];
        carry_out(work, e, edit, count, ms);
        for (enum phase p = 0; p < PHASES; p++)
            work->ms[e][p][round] = ms[p];
        step->cost[e].served = forest_stats(work->session->forest).served;
        step->cost[e].is_whole = forest_changes(work->session->forest).everything;
        if (round == 0 && i == 0)
            remember(step, work);
        else
            err = compare(trial, work, s, e, fault);
        if (!err)
            take_back(work, e, edit, count);
    }
    return err;
}

static enum err run_step(struct trial *trial, struct work *work, unsigned s,
                         const struct edit *edit, size_t count, const struct trial_watch *watch,
                         struct fault *fault)
{
    struct trial_step *step = &trial->step[s];
    double ms[PHASES];
    enum err err = OK;
    if (s == 0) { /* once without the clock, so that memory is there */
        carry_out(work, BDIFT_BP, edit, count, ms);
        take_back(work, BDIFT_BP, edit, count);
    }
    for (unsigned round = 0; !err && round < trial->rounds; round++) {
        err = run_round(trial, work, s, round, edit, count, fault);
        if (!err && watch && !watch->advanced(watch->context, s, round))
            err = fault_set(fault, ERR_CANCELLED, "cancelled");
    }
    if (err)
        return err;
    carry_out(work, BDIFT_BP, edit, count, ms); /* and on to the next step */
    copy_rendition(&work->former, &work->made);
    step->border_voxels = border_count(&work->session->border);
    for (enum experiment e = 0; e < EXPERIMENTS; e++)
        for (enum phase p = 0; p < PHASES; p++)
            step->cost[e].ms[p] = times_median(work->ms[e][p], trial->rounds);
    return OK;
}

enum err trial_run(struct trial *trial, struct session *session, const struct seeds *seeds,
                   unsigned steps, unsigned rounds, const struct trial_watch *watch,
                   struct fault *fault)
{
    struct view view = view_default(session->scene);
    trial->rounds = rounds;
    trial->threads = team_size(session->team);
    trial->voxels = session->scene->grid.voxels;
    memcpy(trial->size, session->scene->grid.size, sizeof trial->size);
    view.angle[0] = 30000, view.angle[1] = 15000; /* from in front, a little aside and above */
    view.width = view.height = TRIAL_SIDE;
    session->now.outlook.look = look_default();
    session->now.outlook.look.mode = SHADE_CUBES; /* faces of voxels, as the paper has them */
    struct pictures *pictures;                    /* the session's, which hold the camera */
    must(session_set_view(session, &view, &bench_fault));
    must(pictures_begin(&pictures, session, &bench_fault));
    struct work *work = work_new(session);
    rendition_clear(&work->former);
    update_mesh(work, true, &(struct changes){.everything = true});
    colour(work, &work->former, true);
    enum err err = OK;
    unsigned planted = 0;
    for (unsigned s = 0; !err && s < steps; s++) {
        trial->step[s].seeds = procedure_count[s];
        err = run_step(trial, work, s, seeds->edit + planted, procedure_count[s] - planted, watch,
                       fault);
        planted = procedure_count[s];
        trial->steps = s + 1;
    }
    if (!err && (!forest_check(session->forest, fault) || !border_check(&session->border, fault)))
        err = fault_prefix(fault, ERR_CHECK, "%s", trial->name);
    work_free(work);
    return err;
}

/* ---- figures ---- */

double trial_total(const struct trial_step *step, enum experiment e)
{
    const double *ms = step->cost[e].ms;
    return ms[SEGMENTATION] + ms[BORDER] + ms[RENDITION];
}

double trial_mean(const struct trial *trial, enum experiment e, enum phase phase)
{
    const unsigned first = trial->steps > 1 ? 1 : 0;
    double sum = 0;
    for (unsigned s = first; s < trial->steps; s++)
        sum += trial->step[s].cost[e].ms[phase];
    return trial->steps ? sum / (trial->steps - first) : 0;
}

double trial_mean_total(const struct trial *trial, enum experiment e)
{
    return trial_mean(trial, e, SEGMENTATION) + trial_mean(trial, e, BORDER) +
           trial_mean(trial, e, RENDITION);
}

double trial_ns_per_voxel(const struct trial_step *step, enum experiment e)
{
    const struct trial_cost *cost = &step->cost[e];
    return cost->served ? cost->ms[SEGMENTATION] * 1e6 / (double)cost->served : 0;
}
