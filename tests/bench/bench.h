/* SPDX-License-Identifier: MIT */
/* The benchmarks, a program outside of iftty: build/tests/bench/bench, with its table in bench.c.
 * Figures are medians; no time is compared with a limit. */
#ifndef TESTS_BENCH_BENCH_H
#define TESTS_BENCH_BENCH_H

#include "command/interpreter.h"
#include "tests/drop.h"
#include "program/program.h"
#include "engine/forest.h"
#include "render/rendition.h"

/* Options of the command lines. */
struct bench_options {
    struct options common; /* first: a benchmark gets a pointer to this, */
    size_t rounds, brush;
    const char *method;
    const char *program; /* another iftty than this tree's, or NULL */
    bool quick;
};

/* and accesses the others through it. */
static inline const struct bench_options *bench_options(const struct options *common)
{
    return (const struct bench_options *)(const void *)common;
}

enum err run_brain(const struct options *options, struct fault *fault);
enum err run_terminal(const struct options *options, struct fault *fault);
enum err run_paper(const struct options *options, struct fault *fault);
enum err run_growth(const struct options *options, struct fault *fault);
enum err run_render(const struct options *options, struct fault *fault);
enum err run_frames(const struct options *options, struct fault *fault);
enum err run_journal(const struct options *options, struct fault *fault);
enum err run_keys(const struct options *options, struct fault *fault);
enum err run_effort(const struct options *options, struct fault *fault);
enum err run_register(const struct options *options, struct fault *fault);
enum err run_surface(const struct options *options, struct fault *fault);
enum err run_looks(const struct options *options, struct fault *fault);

/* Segment by the commands of a journal of examples/, without writing anything. */
void bench_segment(struct interpreter *interp, const char *journal);

/* Time VTK on the same labels (tests/peers/vtk_render.py); no rows without VTK. */
enum { VTK_ROWS_MOST = 8 };
struct bench_vtk {
    char version[24];
    struct {
        char what[40];
        double ms;
    } row[VTK_ROWS_MOST];
    int rows;
};
void bench_vtk(struct bench_vtk *out, const struct session *session);

/* Cost of an iftty process that runs examples/brain.iftty and further commands, each with its line
 * feed, in a temporary folder. */
struct bench_process {
    double seconds, of_processors, megabytes; /* elapsed; of processors; peak */
};
struct bench_process bench_turntable(const char *commands);

/* Edits of the voxels of a ball that are no seeds: seeds of label 0, and their erasure. */
enum { BENCH_BALL_MOST = 4096 };
struct bench_ball {
    struct edit seed[BENCH_BALL_MOST], undo[BENCH_BALL_MOST];
    size_t count;
};
void bench_ball_make(struct bench_ball *ball, const struct scene *scene, uint32_t cell, int radius);

/* Next pixel of a fixed sequence that shows an object. */
size_t bench_next_pixel(const struct rendition *frame, size_t pixel);

/* A session of many commands on 7 million voxels, and the least of three times to resume its
 * journal. */
struct bench_resume {
    unsigned commands;
    uint64_t voxels;
    double session_ms, resume_ms;
};
struct bench_resume bench_resuming(void);

#endif
