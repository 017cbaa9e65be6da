/*
 * bench_brain: measurements of the whole way on the T1 scene ch2 of Debian's mricron-data, or on
 * synth:geom where that is not there: run from scratch, single edits with their picture, full
 * pictures, memory, and the time from the start of the program to its prompt.
 *
 * bench_paper: the paper's five experiments on its scenes (command/bench_trial.h), with the same
 * seeds in the same eight steps, beside the paper's figures.
 *
 * bench_growth: one edit in scenes of 4 to 300 million voxels, as many as memory holds together. It
 * touches the same voxels in each.
 *
 * bench_render: whole frames of ch2 with brain and cerebellum, their parts, and incremental images;
 * VTK beside them, where it is there.
 *
 * bench_journal: what a journal costs: 100 000 records encoded and read, recording beside the
 * session that is recorded, verifying beside the forests and renditions that are made on the way.
 *
 * Medians; no time is compared with a limit.
 */
#ifndef PROGRAM_BENCH_H
#define PROGRAM_BENCH_H

#include <stdbool.h>
#include <stdio.h>

#include "base/buf.h"
#include "base/err.h"
#include "base/watch.h"

/* `scene` names another file, or is NULL. The table goes to `out`, or one JSON object. */
enum err bench_brain(const char *scene, bool json, FILE *out, struct fault *fault);

enum bench_form { BENCH_TEXT, BENCH_JSON, BENCH_CSV };

struct bench_paper_options {
    char *const
        *scene;      /* "brain", "geom" or either with XYZ as in "brain211", "ch2better"; "all" */
    int scenes;      /* none: brain and geom */
    unsigned rounds; /* 1..99: each experiment is timed so often */
    bool quick;      /* two steps instead of eight */
    enum bench_form form;
    const char *plots;                            /* a folder for charts, or NULL */
    struct watch *watch;                          /* told how far it is, or NULL */
    void (*say)(void *context, const char *text); /* what goes to the user */
    void *context;
};

/* ERR_CHECK where two experiments do not give the same; ERR_CANCELLED. Nothing is said of JSON and
 * CSV then. */
enum err bench_paper(const struct bench_paper_options *options, struct fault *fault);

/* `quick`: the first two scenes alone. ERR_CANCELLED. */
enum err bench_growth(bool json, bool quick, FILE *out, struct watch *watch, struct fault *fault);

enum err bench_render(bool json, FILE *out, struct watch *watch, struct fault *fault);

/* On this journal; NULL: examples/brain.iftty, or examples/geom.iftty where the scene of that is
 * not here. ERR_CHECK where the journal does not verify. */
enum err bench_journal(const char *journal, bool json, FILE *out, struct fault *fault);

/* The path of a file of the source tree that the program lies in; false where it was installed
 * without it. */
bool bench_find_in_tree(struct buf *out, const char *name);

/* Milliseconds from starting this program on `scene` (or without one where NULL) in a terminal of
 * its own until the prompt is there, and until the scene is loaded and the prompt back. False where
 * there is no pseudo-terminal. */
bool bench_prompt(const char *scene, double *prompt_ms, double *loaded_ms);

/* A session of many commands on 7 million voxels, and how long going on with its journal takes: the
 * least of three times. ERR_CHECK where what is resumed is not what was left. */
struct bench_resume {
    unsigned commands;
    uint64_t voxels;
    double session_ms, resume_ms;
};
enum err bench_resuming(struct bench_resume *figures, struct fault *fault);

#endif
