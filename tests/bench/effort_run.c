#include "tests/bench/effort_run.h"

#include "engine/overlap.h"
#include "program/times.h"

static unsigned dice_of(const struct effort_tool *tool)
{
    struct overlap overlap;
    overlap_count(&overlap, tool->label, tool->object->truth, tool->object->voxels);
    return overlap_dice(&overlap, 1);
}

/* The first two gestures; the place in the curve that they have come to. */
static enum err begin(struct effort_run *run, struct effort_robot *robot, struct effort_tool *tool,
                      unsigned *at, struct fault *fault)
{
    const enum effort_shape background = tool->method->background;
    struct effort_gesture gesture;
    enum err err = effort_robot_object(robot, &gesture, fault);
    err = err ? err : effort_tool_apply(tool, &gesture, fault);
    *at = background == SHAPE_BOX;
    run->dice[0] = err ? 0 : dice_of(tool);
    err = err ? err : effort_robot_background(robot, background, &gesture, fault);
    return err ? err : effort_tool_apply(tool, &gesture, fault);
}

static enum err go_on(struct effort_run *run, struct effort_robot *robot, struct effort_tool *tool,
                      unsigned at, struct fault *fault)
{
    struct effort_gesture gesture;
    double ms[CURVE];
    size_t times = 0;
    bool wrong = true;
    enum err err = OK;
    run->dice[at] = dice_of(tool);
    while (!err && ++at < CURVE) {
        run->dice[at] = DICE_ONE;
        if (wrong)
            err = effort_robot_next(robot, tool->label, &gesture, &wrong, fault);
        if (err || !wrong)
            continue;
        err = effort_tool_apply(tool, &gesture, fault);
        run->dice[at] = err ? 0 : dice_of(tool);
        ms[times++] = tool->ms;
    }
    run->ms = times_median(ms, times);
    return err;
}

enum err effort_run(struct effort_run *run, const struct effort_method *method,
                    const struct effort_object *object, const char *folder, struct fault *fault)
{
    struct effort_robot robot;
    struct effort_tool tool;
    unsigned at = 0;
    for (int a = 0; a < 3; a++)
        run->size[a] = object->size[a];
    for (size_t i = 0; i < object->voxels; i++)
        run->voxels += object->truth[i];
    enum err err = effort_robot_init(&robot, run->robot, object, fault);
    robot.radius_most = run->radius_most ? run->radius_most : robot.radius_most;
    enum err begun = effort_tool_begin(&tool, method, object, folder, err ? NULL : fault);
    err = err ? err : begun;
    err = err ? err : begin(run, &robot, &tool, &at, fault);
    err = err ? err : go_on(run, &robot, &tool, at, fault);
    effort_tool_end(&tool);
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
    }
    for (int l = 0; l < EFFORT_LOOKS; l++)
        count->after[l] += run->dice[look[l]];
    for (unsigned k = 1; k < CURVE; k++) {
        const unsigned drop = run->dice[k] < run->dice[k - 1] ? run->dice[k - 1] - run->dice[k] : 0;
        count->collapses += drop > COLLAPSE;
        count->largest = drop > count->largest ? drop : count->largest;
    }
}
