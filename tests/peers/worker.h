/* SPDX-License-Identifier: MIT */
/* A worker: a program that segments one scene again and again, on request.
 *
 * It is started with the folder that workload.c has filled. It reads requests from standard input,
 * one a line, and answers each by one line on standard output; an answer that does not begin with
 * "ok" is an error in words.
 *
 *     > reset                           the next run knows nothing of those before
 *     < ok
 *     > markers /w/markers-0.u8     what the next run begins with
 *     < ok
 *     > run                             markers to labels, both in memory: the times of its stages
 *     < ok run=812.304,815.120          (worker_stage) and other notes as NAME=VALUE
 *     > labels /w/itk-0.u8          writes the labels of the last run
 *     < ok
 *     > costs /w/iftty-0.u16        likewise the cost of every voxel, where the program has it
 *     < ok
 *
 * Maps are files of a byte per voxel, x fastest; gradient and costs have two bytes, in the order of
 * this machine. A marker is label + 1, and 0 where there is none; labels are written in the same
 * way. Written so that C17 and C++17 both understand it. */
#ifndef TESTS_PEERS_WORKER_H
#define TESTS_PEERS_WORKER_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

struct worker {
    unsigned size[3];
    size_t voxels;
    uint16_t *gradient;              /* [voxels] */
    uint8_t *narrow;                 /* [voxels], the gradient if it has 8 bits, else NULL */
    uint8_t *marker, *label;         /* [voxels] */
    uint16_t *cost;                  /* [voxels], filled by run; may be NULL */
    bool afresh;                     /* the next run knows nothing of those before */
    double processor_ms, elapsed_ms; /* at the end of the last stage */
    char note[400];                  /* of the last run: " NAME=VALUE..." or "" */
};

/* One run: fills label and note. False, with words in note, where it failed. */
typedef bool worker_run(struct worker *worker);

static inline double worker_clock_ms(clockid_t clock)
{
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec / 1e6;
}

/* End a stage of a run: note NAME=PROCESSOR,ELAPSED, the milliseconds since the former call. The
 * processor time is that of all threads and of the kernel's work for them. NULL notes nothing. */
static inline void worker_stage(struct worker *worker, const char *name)
{
    const double processor = worker_clock_ms(CLOCK_PROCESS_CPUTIME_ID);
    const double elapsed = worker_clock_ms(CLOCK_MONOTONIC);
    const size_t used = strlen(worker->note);
    if (name)
        snprintf(worker->note + used, sizeof worker->note - used, " %s=%.6f,%.6f", name,
                 processor - worker->processor_ms, elapsed - worker->elapsed_ms);
    worker->processor_ms = processor;
    worker->elapsed_ms = elapsed;
}

/* A whole map, read or written; false where the file is of another length. */
static inline bool worker_read(const char *path, void *map, size_t bytes)
{
    FILE *file = fopen(path, "rb");
    bool fine = file && fread(map, 1, bytes, file) == bytes && fgetc(file) == EOF;
    if (file)
        fclose(file);
    return fine;
}

static inline bool worker_write(const char *path, const void *map, size_t bytes)
{
    FILE *file = fopen(path, "wb");
    bool fine = file && fwrite(map, 1, bytes, file) == bytes;
    return file && fclose(file) == 0 && fine;
}

/* Read the data of all runs; false, with a message, if `folder` lacks them. */
static inline bool worker_begin(struct worker *worker, const char *folder)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/size", folder ? folder : ".");
    FILE *file = fopen(path, "r");
    unsigned *size = worker->size, bits = 0;
    bool fine = file && fscanf(file, "%u %u %u %u", &size[0], &size[1], &size[2], &bits) == 4;
    if (file)
        fclose(file);
    if (!fine) {
        fprintf(stderr, "%s cannot be read; expected the folder that workload has filled\n", path);
        return false;
    }
    worker->voxels = (size_t)size[0] * size[1] * size[2];
    worker->gradient = (uint16_t *)malloc(worker->voxels * sizeof *worker->gradient);
    worker->narrow = bits == 8 ? (uint8_t *)malloc(worker->voxels) : NULL;
    worker->marker = (uint8_t *)calloc(worker->voxels, 1);
    worker->label = (uint8_t *)calloc(worker->voxels, 1);
    worker->afresh = true;
    snprintf(path, sizeof path, "%s/gradient.u16", folder);
    fine = worker->gradient && worker->marker && worker->label && (worker->narrow || bits > 8) &&
           worker_read(path, worker->gradient, worker->voxels * sizeof *worker->gradient);
    if (!fine)
        fprintf(stderr, "%s cannot be read\n", path);
    for (size_t i = 0; fine && worker->narrow && i < worker->voxels; i++)
        worker->narrow[i] = (uint8_t)worker->gradient[i];
    return fine;
}

static inline void worker_answer(struct worker *worker, char *request, worker_run *run)
{
    char *path = strchr(request, ' ');
    bool fine = true;
    if (path)
        *path++ = '\0';
    if (strcmp(request, "run") == 0) {
        worker->note[0] = '\0';
        const bool ran = run(worker);
        printf("%s%s\n", ran ? "ok" : "cannot run: ", worker->note);
        worker->afresh = false;
        return;
    }
    if (strcmp(request, "reset") == 0)
        worker->afresh = true;
    else if (path && strcmp(request, "markers") == 0)
        fine = worker_read(path, worker->marker, worker->voxels);
    else if (path && strcmp(request, "labels") == 0)
        fine = worker_write(path, worker->label, worker->voxels);
    else if (path && strcmp(request, "costs") == 0)
        fine =
            worker->cost && worker_write(path, worker->cost, worker->voxels * sizeof *worker->cost);
    else
        fine = false;
    puts(fine ? "ok" : "cannot do that");
}

/* Serves requests until there are no more. */
static inline void worker_serve(struct worker *worker, worker_run *run)
{
    char request[4200];
    while (fgets(request, sizeof request, stdin)) {
        request[strcspn(request, "\n")] = '\0';
        worker_answer(worker, request, run);
        fflush(stdout);
    }
}

#endif
