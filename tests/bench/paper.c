/* SPDX-License-Identifier: MIT */
/* The paper's scenes, one after the other, and what is printed of them. */
#include "tests/bench/bench.h"

#include <stdlib.h>
#include <string.h>

#include "tests/bench/report.h"
#include "tests/bench/times.h"

enum { SCENES_MOST = 24, QUICK_STEPS = 2 };

/* Sources of scenes. Seeds are made on the base, which has the atlas's grid. */
struct source {
    const char *name, *base, *atlas, *file;
    unsigned megavoxels;
    bool interpolated; /* may be */
};
static const struct source source[] = {
    {"brain", "ch2.nii.gz", "aal.nii.gz", "ch2.nii.gz", 7, true},
    {"geom", "synth:geom", NULL, "synth:geom", 4, true},
    {"ch2better", "ch2.nii.gz", "aal.nii.gz", "ch2better.nii.gz", 35, false},
};
enum { SOURCES = sizeof source / sizeof source[0] };

static const char *const usual[] = {"brain", "geom"};
static const char *const every[] = {"brain",    "brain211", "brain121", "brain112", "brain122",
                                    "brain212", "brain221", "brain222", "geom",     "geom211",
                                    "geom121",  "geom112",  "geom122",  "geom212",  "geom221",
                                    "geom222",  "ch2better"};

struct scene_choice {
    const struct source *from;
    unsigned doubled; /* as in engine/scene.h */
};

/* ---- which scenes ---- */

static bool scan_scene(struct scene_choice *choice, const char *name)
{
    for (int i = 0; i < SOURCES; i++) {
        const size_t n = strlen(source[i].name);
        if (strncmp(name, source[i].name, n) != 0)
            continue;
        *choice = (struct scene_choice){&source[i], 0};
        if (name[n] == '\0')
            return true;
        if (!source[i].interpolated || strlen(name + n) != 3 || strspn(name + n, "12") != 3)
            return false;
        for (unsigned a = 0; a < 3; a++)
            choice->doubled |= (unsigned)(name[n + a] == '2') << a;
        return true;
    }
    return false;
}

static uint64_t megavoxels(const struct scene_choice *choice)
{
    uint64_t count = choice->from->megavoxels;
    for (unsigned a = 0; a < 3; a++)
        count <<= choice->doubled >> a & 1;
    return count;
}

struct run {
    const struct bench_options *options;
    struct scene_choice choice[SCENES_MOST];
    struct trial trial[SCENES_MOST];
    size_t scenes, at;
    unsigned steps;
    uint64_t done, total; /* megavoxels times steps times rounds */
};

static void choose_scenes(struct run *run)
{
    const struct options *o = &run->options->common;
    const bool all = o->words == 1 && strcmp(o->word[0], "all") == 0;
    const char *const *name = all ? every : o->words ? (const char *const *)o->word : usual;
    run->scenes = all        ? sizeof every / sizeof every[0]
                  : o->words ? (size_t)o->words
                             : sizeof usual / sizeof usual[0];
    run->steps = run->options->quick ? QUICK_STEPS : PROCEDURE_STEPS;
    for (size_t i = 0; i < run->scenes; i++) {
        struct trial *trial = &run->trial[i];
        if (!scan_scene(&run->choice[i], name[i]))
            must(fault_set(&bench_fault, ERR_USAGE,
                           "expected brain or geom, as they are or interpolated as in brain211, or "
                           "ch2better, or all; not %s",
                           name[i]));
        snprintf(trial->name, sizeof trial->name, "%s", name[i]);
        /* The paper has every interpolation of geom, and of brain along one axis or two. */
        trial->in_paper = run->choice[i].from->interpolated &&
                          (run->choice[i].from->atlas == NULL || run->choice[i].doubled != 7);
        run->total += megavoxels(&run->choice[i]) * run->steps * run->options->rounds;
    }
}

/* ---- one scene ---- */

/* Show the progress; false after Ctrl-C. */
static bool goes_on(struct run *run, const char *doing, unsigned step)
{
    char what[64];
    if (step)
        snprintf(what, sizeof what, "%s, %s %u of %u", run->trial[run->at].name, doing, step,
                 run->steps);
    else
        snprintf(what, sizeof what, "%s, %s", run->trial[run->at].name, doing);
    return !watch_poll(console_watch(), what, run->done, run->total);
}

static bool advanced(void *context, unsigned step, unsigned round)
{
    struct run *run = context;
    const unsigned next = step + (round + 1 == run->options->rounds && step + 1 < run->steps);
    run->done += megavoxels(&run->choice[run->at]);
    return goes_on(run, "step", next + 1);
}

/* The scene in the interpreter's session, and its seeds. */
static void prepare(struct interpreter *interp, struct seeds *seeds,
                    const struct scene_choice *choice)
{
    const struct source *from = choice->from;
    struct session *session = interp->session;
    OWNED(procedure_release) struct procedure procedure = {0};
    procedure_load(&procedure, interp, from->base, from->atlas);
    if (strcmp(from->file, from->base) != 0) {
        session_reset(session);
        procedure_open(interp, from->file);
    } else {
        must(session_interpolate(session, choice->doubled, &bench_fault));
        session_settle(session);
    }
    must(procedure_seeds(seeds, &procedure, session, &bench_fault));
}

static void run_scene(struct run *run)
{
    const struct trial_watch watch = {advanced, run};
    struct trial *trial = &run->trial[run->at];
    OWNED(seeds_release) struct seeds seeds = {0};
    OWNED(interpreter_release) struct interpreter interp;
    must(interpreter_init(&interp, &bench_fault));
    if (!goes_on(run, "opening", 0))
        must(fault_set(&bench_fault, ERR_CANCELLED, "cancelled"));
    bench_subject = trial->name;
    prepare(&interp, &seeds, &run->choice[run->at]);
    bench_subject = NULL;
    must(trial_run(trial, interp.session, &seeds, run->steps, (unsigned)run->options->rounds,
                   &watch, &bench_fault));
}

enum err run_paper(const struct options *common, struct fault *fault)
{
    OWNED(mem_release) struct run *run = must_have(sizeof *run);
    (void)fault;
    console_handle_interrupts();
    run->options = bench_options(common);
    choose_scenes(run);
    for (; run->at < run->scenes; run->at++) {
        run_scene(run);
        console_print(NULL, ""); /* erase the progress */
        if (!common->json)
            report_scenes(stdout, &run->trial[run->at], 1);
    }
    (common->json ? report_json : report_summary)(stdout, run->trial, run->scenes);
    return OK;
}
