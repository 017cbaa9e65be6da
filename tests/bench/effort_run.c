/* SPDX-License-Identifier: MIT */
#include "tests/bench/effort_run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "engine/overlap.h"
#include "program/times.h"
#include "session/session.h"

static unsigned dice_of(const struct effort_tool *tool)
{
    struct overlap overlap;
    overlap_count(&overlap, tool->label, tool->object->truth, tool->object->voxels);
    return overlap_dice(&overlap, 1);
}

/* A gesture is made; what it takes of the hand counts from here on. */
static enum err make(struct effort_run *run, struct effort_tool *tool, unsigned at,
                     const struct effort_gesture *g, struct fault *fault)
{
    const bool has_way = g->shape == SHAPE_STROKE || g->shape == SHAPE_BOX;
    double squared = 0;
    for (int a = 0; a < 3; a++)
        squared += has_way ? ((double)g->to[a] - g->at[a]) * ((double)g->to[a] - g->at[a]) : 0;
    for (unsigned k = at; k < CURVE; k++) {
        run->path[k] += g->shape == SHAPE_OUTLINE ? g->path : sqrt(squared);
        run->clicks[k] += g->shape == SHAPE_OUTLINE ? g->clicks : has_way ? 2 : 1;
    }
    return effort_tool_apply(tool, g, fault);
}

void effort_judge(struct effort_warnings *w, const struct effort_object *object,
                  const uint8_t *former, const uint8_t *label, bool is_called)
{
    size_t taken = 0, wrong = 0, voxels = 0;
    for (size_t i = 0; i < object->voxels; i++) {
        voxels += object->truth[i];
        taken += label[i] != former[i];
        wrong += label[i] != former[i] && label[i] != object->truth[i];
    }
    const bool is_right = 2 * wrong <= taken;
    const bool is_leak = !is_right && (2 * wrong - taken) * LEAK_SHARE > voxels;
    w->leaks += is_leak, w->found += is_leak && is_called;
    w->right += is_right, w->called += is_right && is_called;
}

/* The first two gestures; the place in the curve that they have come to. */
static enum err begin(struct effort_run *run, struct effort_robot *robot, struct effort_tool *tool,
                      unsigned *at, struct fault *fault)
{
    const enum effort_shape background = tool->method->background;
    struct effort_gesture gesture;
    enum err err = effort_robot_object(robot, &gesture, fault);
    err = err ? err : make(run, tool, 0, &gesture, fault);
    *at = background == SHAPE_BOX;
    run->dice[0] = err ? 0 : dice_of(tool);
    err = err ? err : effort_robot_background(robot, background, &gesture, fault);
    return err ? err : make(run, tool, *at, &gesture, fault);
}

static enum err next(struct effort_robot *robot, struct effort_outliner *outliner,
                     const struct effort_tool *tool, struct effort_gesture *gesture, bool *wrong,
                     struct fault *fault)
{
    const struct session *session = tool->interp ? tool->interp->session : NULL;
    struct doubt doubt = {0};
    enum err err = OK;
    if (outliner->next == NEXT_NONE)
        return effort_robot_next(robot, tool->label, gesture, wrong, fault);
    if (outliner->next == NEXT_DOUBT)
        err = doubt_find(&doubt, &session_kept(session)->finish, session_scene(session),
                         session_team(session), 1, fault);
    err = err ? err : effort_outline_next(outliner, tool->label, &doubt, gesture, wrong, fault);
    doubt_release(&doubt);
    return err;
}

static enum err go_on(struct effort_run *run, struct effort_robot *robot,
                      struct effort_outliner *outliner, struct effort_tool *tool, unsigned at,
                      struct fault *fault)
{
    const bool is_judged = tool->method->by == BY_IFTTY && !tool->method->reach;
    uint8_t *former = mem_new(tool->object->voxels);
    struct effort_gesture gesture;
    double ms[CURVE];
    size_t times = 0;
    bool wrong = true;
    enum err err = former ? OK : fault_memory(fault, "labels");
    run->dice[at] = dice_of(tool);
    while (!err && ++at < CURVE) {
        run->dice[at] = DICE_ONE;
        if (wrong)
            err = next(robot, outliner, tool, &gesture, &wrong, fault);
        if (err || !wrong)
            continue;
        memcpy(former, tool->label, tool->object->voxels);
        err = make(run, tool, at, &gesture, fault);
        if (!err && is_judged)
            effort_judge(&run->warnings, tool->object, former, tool->label,
                         strstr(buf_text(&tool->reply.text), "; undo takes it back") != NULL);
        run->dice[at] = err ? 0 : dice_of(tool);
        ms[times++] = tool->ms;
    }
    free(former);
    run->ms = times_median(ms, times);
    return err;
}

/* At most a tenth of the scene, and a voxel. */
static uint32_t brush_in(const struct effort_object *object, uint32_t brush)
{
    for (int a = 0; a < 3; a++)
        brush = object->size[a] / 10 < brush ? object->size[a] / 10 : brush;
    return brush ? brush : 1;
}

enum err effort_run(struct effort_run *run, const struct effort_method *method,
                    const struct effort_object *object, const char *folder, struct fault *fault)
{
    struct effort_robot robot;
    struct effort_outliner outliner;
    struct effort_tool tool;
    unsigned at = 0;
    for (int a = 0; a < 3; a++)
        run->size[a] = object->size[a];
    for (size_t i = 0; i < object->voxels; i++)
        run->voxels += object->truth[i];
    enum err err = effort_robot_init(&robot, run->robot, object, fault);
    robot.radius_most = run->radius_most ? run->radius_most
                        : method->brush  ? brush_in(object, method->brush)
                                         : robot.radius_most;
    const enum err ready =
        effort_outliner_init(&outliner, object, method->next, method->hand, err ? NULL : fault);
    err = err ? err : ready;
    enum err begun = effort_tool_begin(&tool, method, object, folder, err ? NULL : fault);
    err = err ? err : begun;
    err = err ? err : begin(run, &robot, &tool, &at, fault);
    err = err ? err : go_on(run, &robot, &outliner, &tool, at, fault);
    effort_tool_end(&tool);
    effort_outliner_release(&outliner);
    effort_robot_release(&robot);
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
        if (g == 0) {
            count->path += run->path[k < CURVE ? k : CURVE - 1];
            count->clicks += run->clicks[k < CURVE ? k : CURVE - 1];
        }
    }
    count->warnings.leaks += run->warnings.leaks;
    count->warnings.found += run->warnings.found;
    count->warnings.right += run->warnings.right;
    count->warnings.called += run->warnings.called;
    for (int l = 0; l < EFFORT_LOOKS; l++)
        count->after[l] += run->dice[look[l]];
    for (unsigned k = 1; k < CURVE; k++) {
        const unsigned drop = run->dice[k] < run->dice[k - 1] ? run->dice[k - 1] - run->dice[k] : 0;
        count->collapses += drop > COLLAPSE;
        count->largest = drop > count->largest ? drop : count->largest;
    }
}
