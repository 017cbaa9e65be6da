/* SPDX-License-Identifier: MIT */
/*
 * The benchmarks that are no part of iftty: a program of its own, build/tests/bench/bench, whose
 * table is in bench.c. Medians; no time is compared with a limit.
 */
#ifndef TESTS_BENCH_BENCH_H
#define TESTS_BENCH_BENCH_H

#include "command/interpreter.h"
#include "program/program.h"
#include "engine/forest.h"
#include "render/rendition.h"

/* What their command lines give. */
struct bench_options {
    struct options common; /* first: a benchmark is run with a pointer to this, */
    size_t rounds, brush;
    const char *method;
    const char *program; /* another iftty than that of this tree, or NULL */
    bool quick;
};

/* and finds the others by it. */
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

/* What the commands of a journal of examples/ segment; nothing is written. */
enum err bench_segment(struct interpreter *interp, const char *journal, struct fault *fault);

/* What VTK takes for the same labels, one JSON object a line (tests/peers/vtk_render.py); nothing
 * where it is not here. */
enum err bench_vtk(const struct session *session, struct buf *lines, struct fault *fault);

/* What a process of iftty took that carries out examples/brain.iftty, and then commands, each with
 * its line feed, in a folder of its own that is removed. */
struct bench_process {
    double seconds, of_processors, megabytes; /* elapsed; of processors; held at most */
};
enum err bench_turntable(struct bench_process *process, const char *commands, struct fault *fault);

/* Edits of the voxels of a ball that are no seeds: seeds of label 0, and their erasure. */
enum { BENCH_BALL_MOST = 4096 };
struct bench_ball {
    struct edit seed[BENCH_BALL_MOST], undo[BENCH_BALL_MOST];
    size_t count;
};
void bench_ball_make(struct bench_ball *ball, const struct scene *scene, uint32_t cell, int radius);

/* The next of a fixed sequence of pixels that show an object. */
size_t bench_next_pixel(const struct rendition *frame, size_t pixel);

/* A session of many commands on 7 million voxels, and how long going on with its journal takes: the
 * least of three times. ERR_CHECK where what is resumed is not what was left. */
struct bench_resume {
    unsigned commands;
    uint64_t voxels;
    double session_ms, resume_ms;
};
enum err bench_resuming(struct bench_resume *figures, struct fault *fault);

#endif
