/* SPDX-License-Identifier: MIT */
/* A worker: a program that segments one scene again and again, on request.
 *
 * It is started with the folder that workload.c has filled. It reads requests from standard input,
 * one a line, and answers each by one line on standard output; an answer that is neither "ok" nor
 * begins with a number is an error in words.
 *
 *     > reset                           the next run knows nothing of those before
 *     < ok
 *     > markers /w/markers-0.u8     what the next run begins with
 *     < ok
 *     > run                             markers to labels, both in memory: milliseconds, and what
 *     < 812.304                         else there is to say as NAME=VALUE
 *     > labels /w/itk-0.u8          writes the labels of the last run
 *     < ok
 *     > costs /w/iftty-0.cost       likewise the cost of every voxel, where the program has it
 *     < ok
 *
 * Maps are files of a byte a voxel, x fastest. A marker is label + 1, and 0 where there is none;
 * labels are written in the same way. Written so that C17 and C++17 both understand it. */
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
    uint8_t *gradient, *marker, *label; /* [voxels] */
    uint8_t *cost;                      /* [voxels], filled by run; may be NULL */
    bool afresh;                        /* the next run knows nothing of those before */
    double ms;                          /* of the last run */
    char note[160];                     /* of the last run: " NAME=VALUE..." or "" */
};

/* One run: fills label, ms and note. False, with words in note, where it failed. */
typedef bool worker_run(struct worker *worker);

/* Processor time of this process, the kernel's work for it included: on one core it is what a clock
 * on the wall shows, less what other programs take of it. */
static inline double worker_clock_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec / 1e6;
}

/* A whole map, read or written; false where the file is of another length. */
static inline bool worker_read(const char *path, uint8_t *map, size_t voxels)
{
    FILE *file = fopen(path, "rb");
    bool fine = file && fread(map, 1, voxels, file) == voxels && fgetc(file) == EOF;
    if (file)
        fclose(file);
    return fine;
}

static inline bool worker_write(const char *path, const uint8_t *map, size_t voxels)
{
    FILE *file = fopen(path, "wb");
    bool fine = file && fwrite(map, 1, voxels, file) == voxels;
    return file && fclose(file) == 0 && fine;
}

/* Read the data of all runs; false, with a message, if `folder` lacks them. */
static inline bool worker_begin(struct worker *worker, const char *folder)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/size", folder ? folder : ".");
    FILE *file = fopen(path, "r");
    unsigned *size = worker->size;
    bool fine = file && fscanf(file, "%u %u %u", &size[0], &size[1], &size[2]) == 3;
    if (file)
        fclose(file);
    if (!fine) {
        fprintf(stderr, "%s cannot be read; expected the folder that workload has filled\n", path);
        return false;
    }
    worker->voxels = (size_t)size[0] * size[1] * size[2];
    worker->gradient = (uint8_t *)malloc(worker->voxels);
    worker->marker = (uint8_t *)calloc(worker->voxels, 1);
    worker->label = (uint8_t *)calloc(worker->voxels, 1);
    worker->afresh = true;
    snprintf(path, sizeof path, "%s/gradient.u8", folder);
    fine = worker->gradient && worker->marker && worker->label &&
           worker_read(path, worker->gradient, worker->voxels);
    if (!fine)
        fprintf(stderr, "%s cannot be read\n", path);
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
        if (run(worker))
            printf("%.6f%s\n", worker->ms, worker->note);
        else
            printf("cannot run: %s\n", worker->note);
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
        fine = worker->cost && worker_write(path, worker->cost, worker->voxels);
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
