/* SPDX-License-Identifier: MIT */
/* How many gestures a segmentation takes: robots, objects and methods, all with all. */
#include "tests/bench/bench.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "program/console.h"
#include "tests/bench/effort_report.h"

#define OWN(title, by_weight, by_shape, ...)                                                       \
    {                                                                                              \
        .name = (title), .by = BY_IFTTY, .weight = (by_weight), .background = (by_shape),          \
        __VA_ARGS__                                                                                \
    }
#define OWN_FIVE(title, weight)                                                                    \
    OWN(title, weight, SHAPE_BALL, .charted = true),                                               \
        OWN(title ", sphere", weight, SHAPE_SPHERE, .reach = 0),                                   \
        OWN(title ", box", weight, SHAPE_BOX, .reach = 0),                                         \
        OWN(title ", relax", weight, SHAPE_BALL, .reach = FINISH_BAND),                            \
        OWN(title ", sphere, relax", weight, SHAPE_SPHERE, .reach = FINISH_BAND, .charted = true)
#define OUTLINES(title, off, by_next, does_relax)                                                  \
    OWN(title, "morph", SHAPE_SPHERE, .reach = (does_relax) ? FINISH_BAND : 0, .next = (by_next),  \
        .hand = (off), .charted = (off) == 7)
#define WORKER(title, program, by_shape, is_charted)                                               \
    {                                                                                              \
        .name = (title), .by = BY_WORKER, .background = (by_shape), .weight = (program),           \
        .charted = (is_charted), .once = true                                                      \
    }

/* The first is what others are compared with. */
static const struct effort_method method[] = {
    OWN_FIVE("morph", "morph"),
    OWN_FIVE("gauss 1", "gauss 1"),
    OWN("morph, within", "morph", SHAPE_BALL, .limits = true),
    OWN("sphere, relax, within", "morph", SHAPE_SPHERE, .reach = FINISH_BAND, .limits = true),
    OWN("sphere, relax, reach 16", "morph", SHAPE_SPHERE, .reach = FINISH_BAND_MOST),
    OWN("sphere, relax, brush 6", "morph", SHAPE_SPHERE, .reach = FINISH_BAND, .brush = 6),
    OUTLINES("outline, hand 0, relax", 0, NEXT_WRONG, true),
    OUTLINES("outline, hand .7, relax", 7, NEXT_WRONG, true),
    OUTLINES("outline, hand 1, relax", 10, NEXT_WRONG, true),
    OUTLINES("outline, hand .7", 7, NEXT_WRONG, false),
    OUTLINES("outline by doubt, relax", 7, NEXT_DOUBT, true),
    OUTLINES("outline by chance, relax", 7, NEXT_CHANCE, true),
    WORKER("random walker", "walker", SHAPE_BALL, true),
    WORKER("random walker, sphere", "walker", SHAPE_SPHERE, false),
    {.name = "GrowCut", .by = BY_GROWCUT, .background = SHAPE_BALL, .once = true},
    WORKER("watershed, scikit-image", "skimage", SHAPE_BALL, false),
    WORKER("watershed, ITK", "itk", SHAPE_BALL, false),
};
enum { METHODS = sizeof method / sizeof *method, HAND = 7 };

struct efforts {
    const struct bench_options *options;
    struct interpreter interp; /* finds files */
    struct effort_report report;
    struct effort_object object;
    unsigned most; /* of it: effort_outline_most of HAND */
    bool is_missing[METHODS];
    struct buf folder;
    size_t done, total;
};

/* ---- what is wanted ---- */

static bool wants_object(const struct options *o, size_t object)
{
    bool wanted = o->words == 0;
    for (int i = 0; i < o->words; i++)
        wanted |= strcmp(o->word[i], effort_object_name(object)) == 0 ||
                  strcmp(o->word[i], effort_group_name[effort_object_group(object)]) == 0;
    return wanted;
}

/* By its whole name, or by a part of it where none has that name. */
static bool wants_method(const struct bench_options *o, size_t m)
{
    bool is_name = false;
    for (size_t i = 0; o->method && i < METHODS; i++)
        is_name |= strcmp(method[i].name, o->method) == 0;
    return !o->method || (is_name ? strcmp(method[m].name, o->method) == 0
                                  : strstr(method[m].name, o->method) != NULL);
}

static bool wants_run(const struct bench_options *o, size_t object, enum effort_robot_kind robot,
                      size_t m)
{
    const bool is_short = robot == ROBOT_CAREFUL && effort_object_group(object) != GROUP_WHOLE;
    return wants_object(&o->common, object) && (is_short || !method[m].once) &&
           (robot == ROBOT_CAREFUL || method[m].next == NEXT_NONE) &&
           (robot == ROBOT_CAREFUL || effort_object_group(object) != GROUP_WHOLE) &&
           (!o->robot || strcmp(o->robot, effort_robot_name[robot]) == 0) &&
           (!o->quick || method[m].by == BY_IFTTY) && wants_method(o, m);
}

static size_t count_runs(const struct bench_options *o)
{
    size_t count = 0;
    for (size_t object = 0; effort_object_name(object); object++)
        for (int robot = 0; robot < ROBOT_KINDS; robot++)
            for (size_t m = 0; m < METHODS; m++)
                count += wants_run(o, object, (enum effort_robot_kind)robot, m);
    return count;
}

/* ---- runs ---- */

static enum err run_one(struct efforts *e, size_t object, enum effort_robot_kind robot, size_t m,
                        struct fault *fault)
{
    struct effort_report *report = &e->report;
    if (watch_poll(console_watch(), e->object.name, e->done++, e->total))
        return fault_set(fault, ERR_CANCELLED, "cancelled");
    if (e->is_missing[m])
        return OK;
    if (!mem_grow(&report->run, &report->capacity, report->runs + 1, sizeof *report->run))
        return fault_memory(fault, "a run");
    struct effort_run *run = &report->run[report->runs];
    *run = (struct effort_run){
        .object = object,
        .method = m,
        .robot = robot,
        .radius_most = (uint32_t)e->options->brush,
        .most = e->most,
    };
    const enum err err = effort_run(run, &method[m], &e->object, buf_text(&e->folder), fault);
    if (!err) {
        report->runs++;
        return OK;
    }
    if (err != ERR_IO || method[m].by != BY_WORKER)
        return fault_prefix(fault, err, "%s, %s", e->object.name, method[m].name);
    e->is_missing[m] = true;
    buf_printf(&report->missing, "%s is left out from %s on: %s\n", method[m].name, e->object.name,
               fault->text);
    return OK;
}

static enum err run_object(struct efforts *e, size_t object, struct fault *fault)
{
    enum err err = effort_object_load(&e->object, object, &e->interp, fault);
    err = err ? err : effort_tool_prepare(&e->object, buf_text(&e->folder), fault);
    err = err ? err : effort_outline_most(&e->most, &e->object, HAND, fault);
    for (int robot = 0; robot < ROBOT_KINDS; robot++)
        for (size_t m = 0; m < METHODS && !err; m++)
            if (wants_run(e->options, object, (enum effort_robot_kind)robot, m))
                err = run_one(e, object, (enum effort_robot_kind)robot, m, fault);
    effort_object_release(&e->object);
    return err;
}

static enum err run_all(struct efforts *e, struct fault *fault)
{
    enum err err = OK;
    for (size_t object = 0; effort_object_name(object) && !err; object++)
        if (wants_object(&e->options->common, object))
            err = run_object(e, object, fault);
    return err;
}

/* ---- the program ---- */

static enum err check_words(const struct bench_options *o, struct fault *fault)
{
    for (int i = 0; i < o->common.words; i++) {
        bool known = false;
        for (size_t object = 0; effort_object_name(object); object++)
            known |= strcmp(o->common.word[i], effort_object_name(object)) == 0 ||
                     strcmp(o->common.word[i], effort_group_name[effort_object_group(object)]) == 0;
        if (!known)
            return fault_set(fault, ERR_USAGE,
                             "expected tuned, other, whole, pairs, ct, or an object of those, as "
                             "putamen; not %s",
                             o->common.word[i]);
    }
    return count_runs(o) ? OK
                         : fault_set(fault, ERR_USAGE,
                                     "no run is asked for; robots are careful, sloppy and stroke, "
                                     "and a method is a part of its name in the table");
}

static enum err report(const struct efforts *e, struct fault *fault)
{
    struct buf text = {0};
    (e->options->common.json ? effort_report_json : effort_report_tables)(&text, &e->report);
    const bool failed = text.failed;
    if (!failed)
        console_print(NULL, buf_text(&text));
    buf_release(&text);
    if (failed)
        return fault_memory(fault, "a report");
    return e->options->plots ? effort_report_plots(&e->report, e->options->plots, fault) : OK;
}

enum err run_effort(const struct options *common, struct fault *fault)
{
    struct efforts *e = mem_new(sizeof *e);
    if (!e)
        return fault_memory(fault, "a benchmark");
    e->options = bench_options(common);
    e->report.method = method;
    e->report.methods = METHODS;
    e->total = count_runs(e->options);
    console_handle_interrupts();
    enum err err = check_words(e->options, fault);
    err = err ? err : interpreter_init(&e->interp, fault);
    if (err) {
        free(e);
        return err;
    }
    err = folder_fresh(&e->folder, NULL, fault);
    err = err ? err : run_all(e, fault);
    if (!err || (err == ERR_CANCELLED && e->report.runs > 0)) { /* Ctrl-C: what there is so far */
        const enum err told = report(e, err ? NULL : fault);
        err = err ? err : told;
    }
    if (e->folder.length)
        folder_remove(buf_text(&e->folder));
    interpreter_release(&e->interp);
    buf_release(&e->folder);
    buf_release(&e->report.missing);
    free(e->report.run);
    free(e);
    return err;
}
