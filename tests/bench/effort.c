/* SPDX-License-Identifier: MIT */
/* Count the gestures of a segmentation: a robot segments each object by each method. */
#include "tests/bench/bench.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/bench/times.h"
#include "tests/bench/effort_run.h"

/* The first is the one that the others are compared with. */
static const struct effort_method method[] = {
    {"morph", "morph", SHAPE_BALL, .reach = 0},
    {"morph, within", "morph", SHAPE_BALL, .limits = true},
    {"morph, sphere", "morph", SHAPE_SPHERE, .reach = 0},
    {"morph, relax", "morph", SHAPE_BALL, .reach = FINISH_BAND},
    {"morph, sphere, relax", "morph", SHAPE_SPHERE, .reach = FINISH_BAND},
    {"sphere, relax, within", "morph", SHAPE_SPHERE, .reach = FINISH_BAND, .limits = true},
    {"sphere, relax, reach 16", "morph", SHAPE_SPHERE, .reach = FINISH_BAND_MOST},
    {"sphere, relax, brush 6", "morph", SHAPE_SPHERE, .reach = FINISH_BAND, .brush = 6},
    {"as the row proposes", "morph", SHAPE_SPHERE, .reach = FINISH_BAND, .outlines = true},
    {"gauss 1", "gauss 1", SHAPE_BALL, .reach = 0},
    {"gauss 1, sphere", "gauss 1", SHAPE_SPHERE, .reach = 0},
    {"gauss 1, relax", "gauss 1", SHAPE_BALL, .reach = FINISH_BAND},
    {"gauss 1, sphere, relax", "gauss 1", SHAPE_SPHERE, .reach = FINISH_BAND},
    {"corrects, grows", "morph", .corrects = CORRECTS_GROWING},
    {"corrects, within", "morph", .corrects = CORRECTS_WITHIN},
    {"corrects, within over=", "morph", .corrects = CORRECTS_OVER},
    {"corrects, exact", "morph", .corrects = CORRECTS_EXACTLY},
};
enum { METHODS = sizeof method / sizeof *method, OBJECTS_MOST = 64 };

struct efforts {
    const struct bench_options *options;
    struct interpreter interp; /* finds files */
    const char *folder;
    struct effort_run run[METHODS * OBJECTS_MOST];
    size_t runs, done, total;
};

static bool is_object(const char *word, size_t object)
{
    return strcmp(word, effort_object_name(object)) == 0 ||
           strcmp(word, effort_group_name[effort_object_group(object)]) == 0;
}

static bool wants_object(const struct options *o, size_t object)
{
    bool wanted = o->words == 0;
    for (int i = 0; i < o->words; i++)
        wanted |= is_object(o->word[i], object);
    return wanted;
}

/* By its whole name, or by a part of it if no method has that name. */
static bool wants_method(const struct bench_options *o, size_t m)
{
    bool is_name = false;
    for (size_t i = 0; o->method && i < METHODS; i++)
        is_name |= strcmp(method[i].name, o->method) == 0;
    return !o->method || (is_name ? strcmp(method[m].name, o->method) == 0
                                  : strstr(method[m].name, o->method) != NULL);
}

static void check_words(struct efforts *e)
{
    const struct options *o = &e->options->common;
    for (size_t object = 0; effort_object_name(object); object++)
        for (size_t m = 0; m < METHODS; m++)
            e->total += wants_object(o, object) && wants_method(e->options, m);
    for (int i = 0; i < o->words; i++) {
        bool known = false;
        for (size_t object = 0; effort_object_name(object); object++)
            known |= is_object(o->word[i], object);
        if (!known)
            must(fault_set(&bench_fault, ERR_USAGE,
                           "expected tuned, other, ct, or an object of those, such as putamen; "
                           "not %s",
                           o->word[i]));
    }
    if (!e->total)
        must(
            fault_set(&bench_fault, ERR_USAGE, "no method has %s in its name", e->options->method));
}

/* False after Ctrl-C. */
static bool run_object(struct efforts *e, size_t object)
{
    OWNED(effort_object_release) struct effort_object loaded = {0};
    bool goes_on = true;
    effort_object_load(&loaded, object, &e->interp);
    must(effort_prepare(&loaded, e->folder, &bench_fault));
    for (size_t m = 0; m < METHODS && goes_on; m++) {
        if (!wants_method(e->options, m))
            continue;
        goes_on = !watch_poll(console_watch(), loaded.name, e->done++, e->total);
        if (!goes_on)
            break;
        struct effort_run *run = &e->run[e->runs++];
        *run = (struct effort_run){
            .object = object, .method = m, .radius_most = (uint32_t)e->options->brush};
        const enum err err = effort_run(run, &method[m], &loaded, e->folder, &bench_fault);
        must(err ? fault_prefix(&bench_fault, err, "%s, %s", loaded.name, method[m].name) : OK);
    }
    return goes_on;
}

/* Print what corrections of a loaded segmentation repaired. */
static void print_corrections(const struct efforts *e, enum effort_group group)
{
    for (size_t m = 0; m < METHODS; m++) {
        size_t maps = 0, wrong = 0, repaired = 0, beyond = 0;
        for (size_t i = 0; i < e->runs; i++) {
            const struct effort_run *run = &e->run[i];
            if (run->method != m || effort_object_group(run->object) != group)
                continue;
            maps++;
            wrong += run->wrong;
            repaired += run->repaired;
            beyond += run->beyond;
        }
        if (method[m].corrects && maps)
            printf("%-27s %zu of %zu wrong voxels repaired in %zu map%s, %zu others made wrong\n",
                   method[m].name, repaired, wrong, maps, plural(maps), beyond);
    }
}

static void print_table(const struct efforts *e, enum effort_group group)
{
    double first = 0;
    bool has_title = false;
    for (size_t m = 0; m < METHODS; m++) {
        struct effort_count count = {0};
        double ms[OBJECTS_MOST];
        for (size_t i = 0; i < e->runs; i++)
            if (e->run[i].method == m && effort_object_group(e->run[i].object) == group) {
                ms[count.runs] = e->run[i].ms;
                effort_count(&count, &e->run[i]);
            }
        if (!count.runs || method[m].corrects)
            continue;
        if (!has_title)
            printf("%u object%s: %s\n%-27s  gestures  of      gestures  Dice after      "
                   "collapses     ms a\n%-27s    to 0.8  1st       to 0.9  5    10   20    "
                   "(largest)  gesture\n",
                   count.runs, plural(count.runs), effort_group_name[group], "", "");
        has_title = true;
        const double runs = count.runs, to = count.gestures[0] / runs;
        first = m == 0 ? to : first;
        printf("%-27s %5.1f (%2u) ", method[m].name, to, count.reached[0]);
        if (first > 0)
            printf("%5.2f", to / first);
        else
            printf("%5s", "-");
        printf("  %5.1f (%2u)  %4.2f %4.2f %4.2f  %3u (%4.2f) %7.1f\n", count.gestures[1] / runs,
               count.reached[1], count.after[0] / runs / 1e4, count.after[1] / runs / 1e4,
               count.after[2] / runs / 1e4, count.collapses, count.largest / 1e4,
               times_median(ms, count.runs));
    }
    if (has_title)
        printf("\n");
}

enum err run_effort(const struct options *common, struct fault *fault)
{
    OWNED(mem_release) struct efforts *e = must_have(sizeof *e);
    bool goes_on = true;
    e->options = bench_options(common);
    console_handle_interrupts();
    check_words(e);
    must(interpreter_init(&e->interp, &bench_fault));
    e->folder = bench_folder(NULL);
    for (size_t object = 0; effort_object_name(object) && goes_on; object++)
        if (wants_object(common, object))
            goes_on = run_object(e, object);
    for (int group = 0; group < EFFORT_GROUPS; group++) /* after Ctrl-C, of the runs so far */
    {
        print_table(e, (enum effort_group)group);
        print_corrections(e, (enum effort_group)group);
    }
    printf("Gestures count the first two, and 23 where 22 do not reach the goal; in brackets, how "
           "many\nobjects reach it. Of 1st: by the gestures to 0.8 of the first method. A "
           "collapse is a drop of\nmore than 0.05 from one gesture to the next. Times are "
           "medians, of the processor.\n");
    interpreter_release(&e->interp);
    return goes_on ? OK : fault_set(fault, ERR_CANCELLED, "cancelled");
}
