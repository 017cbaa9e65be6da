/* SPDX-License-Identifier: MIT */
#include "tests/bench/effort_run.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/mem.h"
#include "command/execute.h"
#include "engine/labels.h"
#include "image/volume.h"
#include "tests/bench/times.h"
#include "session/session.h"

struct work {
    const struct effort_method *method;
    const struct effort_object *object;
    struct grid grid;
    uint8_t *label; /* [voxels]: after the last gesture */
    double ms;      /* of the last gesture */
    struct interpreter *interp;
    struct reply reply;
};

enum err effort_prepare(const struct effort_object *object, const char *folder, struct fault *fault)
{
    char path[PATH_MAX];
    snprintf(path, sizeof path, "%s/scene.nii", folder);
    return effort_object_save(object, path, fault);
}

void effort_write_command(struct buf *line, const struct effort_gesture *gesture, bool limits)
{
    const uint32_t *at = gesture->at;
    buf_clear(line);
    if (gesture->shape == SHAPE_OUTLINE) {
        buf_printf(line, "outline %u,%u,%u %u", at[0], at[1], at[2], gesture->label);
        for (size_t i = 1; i < gesture->corners; i++)
            buf_printf(line, " to=%u,%u,%u", gesture->corner[i][0], gesture->corner[i][1], at[2]);
        return;
    }
    buf_printf(line, "seed %u,%u,%u %u", at[0], at[1], at[2], gesture->label);
    if (gesture->radius)
        buf_printf(line, " radius=%u", gesture->radius);
    if (limits && gesture->shape == SHAPE_BALL && gesture->within)
        buf_printf(line, " within=%u", gesture->within);
    if (gesture->shape == SHAPE_SPHERE)
        buf_add_text(line, " shell=yes around=1");
}

static enum err command(struct work *work, const char *line, struct fault *fault)
{
    const enum err err = interpreter_execute(work->interp, line, &work->reply, fault);
    return err ? fault_prefix(fault, err, "%s", line) : OK;
}

static enum err work_begin(struct work *work, const char *folder, struct fault *fault)
{
    char line[PATH_MAX + 16];
    enum err err = grid_init(&work->grid, work->object->size, fault);
    work->label = mem_new(work->object->voxels);
    work->interp = mem_new(sizeof *work->interp);
    if (!err && (!work->label || !work->interp))
        err = fault_memory(fault, "a session");
    err = err ? err : interpreter_init(work->interp, fault);
    snprintf(line, sizeof line, "open %s/scene.nii", folder);
    err = err ? err : command(work, line, fault);
    err = err ? err : command(work, "auto on", fault);
    snprintf(line, sizeof line, "weight %s", work->method->weight);
    err = err ? err : command(work, line, fault);
    snprintf(line, sizeof line, "finish relax reach=%u", work->method->reach);
    return err || !work->method->reach ? err : command(work, line, fault);
}

static void work_end(struct work *work)
{
    if (work->interp)
        interpreter_release(work->interp);
    free(work->interp);
    reply_release(&work->reply);
    free(work->label);
}

static double clock_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec / 1e6;
}

/* Carry out a gesture, and read the labels. */
static enum err apply(struct work *work, const struct effort_gesture *gesture, struct fault *fault)
{
    struct labels labels;
    OWNED(buf_release) struct buf line = {0};
    const enum effort_correction corrects = work->method->corrects;
    effort_write_command(&line, gesture,
                         work->method->limits || corrects == CORRECTS_WITHIN ||
                             corrects == CORRECTS_OVER);
    if (corrects == CORRECTS_EXACTLY)
        buf_add_text(&line, " within=0");
    if (corrects >= CORRECTS_OVER)
        buf_printf(&line, " over=%u", !gesture->label);
    const double begin = clock_ms();
    enum err err = command(work, buf_text(&line), fault);
    err =
        err ? err : session_labels(work->interp->session, work->method->reach > 0, &labels, fault);
    work->ms = clock_ms() - begin;
    uint8_t *out = work->label;
    for (uint32_t z = 0; !err && z < work->grid.size[2]; z++)
        for (uint32_t y = 0; y < work->grid.size[1]; y++, out += work->grid.size[0])
            labels_copy_row(&labels, grid_row(&work->grid, y, z), out);
    return err;
}

static unsigned dice_of(const struct work *work)
{
    struct overlap overlap = {0};
    overlap_add(&overlap, work->label, work->object->truth, work->object->voxels);
    return overlap_dice(&overlap, 1);
}

static void wrong_row(void *context, uint32_t y, uint32_t z, void *values)
{
    const struct work *work = context;
    const uint32_t *n = work->object->size;
    memcpy(values, work->label + ((size_t)z * n[1] + y) * n[0], n[0]);
}

/* Load the truth with defects, which stay in `wrong`. */
static enum err begin_correction(uint8_t *wrong, struct effort_robot *robot, struct work *work,
                                 const char *folder, struct fault *fault)
{
    static const double spacing_mm[3] = {1, 1, 1};
    struct geometry geometry = {.slope = 1, .spacing_nm = {1000000, 1000000, 1000000}};
    const struct volume_map map = {.size = work->object->size,
                                   .geometry = &geometry,
                                   .type = VOXEL_UINT8,
                                   .description = "a map with defects",
                                   .row = wrong_row,
                                   .context = work};
    char path[PATH_MAX], line[PATH_MAX + 16];
    geometry_place_plain(&geometry, spacing_mm);
    effort_robot_damage(robot, work->label);
    memcpy(wrong, work->label, work->object->voxels);
    snprintf(path, sizeof path, "%s/wrong.nii", folder);
    snprintf(line, sizeof line, "labels %s/wrong.nii", folder);
    const enum err err = volume_write(path, FILE_REPLACE, &map, NULL, fault);
    return err ? err : command(work, line, fault);
}

static enum err begin_segmentation(struct effort_robot *robot, struct work *work,
                                   struct fault *fault)
{
    struct effort_gesture gesture;
    enum err err = effort_robot_object(robot, &gesture, fault);
    err = err ? err : apply(work, &gesture, fault);
    err = err ? err : effort_robot_background(robot, work->method->background, &gesture, fault);
    return err ? err : apply(work, &gesture, fault);
}

static enum err segment(struct effort_run *run, struct effort_robot *robot, struct work *work,
                        const char *folder, struct fault *fault)
{
    const struct effort_method *method = work->method;
    OWNED(mem_release) uint8_t *damaged = mem_new(work->object->voxels);
    struct effort_gesture gesture;
    double ms[CURVE];
    size_t times = 0;
    bool wrong = true;
    enum err err = !damaged           ? fault_memory(fault, "a map")
                   : method->corrects ? begin_correction(damaged, robot, work, folder, fault)
                                      : begin_segmentation(robot, work, fault);
    if (!err)
        run->dice[0] = dice_of(work);
    for (size_t at = 1; !err && at < CURVE; at++) {
        run->dice[at] = DICE_ONE;
        const bool outlines = at == 1 && method->outlines && wrong;
        if (outlines)
            effort_robot_outline(robot, work->label, &gesture);
        if (wrong && (!outlines || gesture.corners < 3))
            err = effort_robot_next(robot, work->label, &gesture, &wrong, fault);
        if (err || !wrong)
            continue;
        err = apply(work, &gesture, fault);
        run->dice[at] = err ? 0 : dice_of(work);
        ms[times++] = work->ms;
    }
    run->ms = times_median(ms, times);
    if (!err && method->corrects) {
        const uint8_t *truth = work->object->truth, *label = work->label;
        for (size_t i = 0; i < work->object->voxels; i++) {
            run->wrong += damaged[i] != truth[i];
            run->repaired += damaged[i] != truth[i] && label[i] == truth[i];
            run->beyond += damaged[i] == truth[i] && label[i] != truth[i];
        }
    }
    return err;
}

/* At most a tenth of the scene, and at least 1 voxel. */
static uint32_t brush_in(const struct effort_object *object, uint32_t brush)
{
    for (int a = 0; a < 3; a++)
        brush = object->size[a] / 10 < brush ? object->size[a] / 10 : brush;
    return brush ? brush : 1;
}

enum err effort_run(struct effort_run *run, const struct effort_method *method,
                    const struct effort_object *object, const char *folder, struct fault *fault)
{
    OWNED(effort_robot_release) struct effort_robot robot = {0};
    OWNED(work_end) struct work work = {.method = method, .object = object};
    enum err err = effort_robot_init(&robot, object, fault);
    robot.radius_most = run->radius_most ? run->radius_most
                        : method->brush  ? brush_in(object, method->brush)
                                         : robot.radius_most;
    robot.is_exact = method->corrects == CORRECTS_EXACTLY;
    err = err ? err : work_begin(&work, folder, fault);
    err = err ? err : segment(run, &robot, &work, folder, fault);
    return err;
}

void effort_count(struct effort_count *count, const struct effort_run *run)
{
    static const unsigned goal[EFFORT_GOALS] = {8000, 9000}, look[EFFORT_LOOKS] = {5, 10, 20};
    count->runs++;
    for (int g = 0; g < EFFORT_GOALS; g++) {
        unsigned k = 0;
        while (k < CURVE && run->dice[k] < goal[g])
            k++;
        count->gestures[g] += 2 + k;
        count->reached[g] += k < CURVE;
    }
    for (int l = 0; l < EFFORT_LOOKS; l++)
        count->after[l] += run->dice[look[l]];
    for (unsigned k = 1; k < CURVE; k++) {
        const unsigned drop = run->dice[k] < run->dice[k - 1] ? run->dice[k - 1] - run->dice[k] : 0;
        count->collapses += drop > COLLAPSE;
        count->largest = drop > count->largest ? drop : count->largest;
    }
}
