/* SPDX-License-Identifier: MIT */
/*
 * The picture writer: compress and write pictures in the background of a session.
 *
 * Its thread executes one job after the other, with its own image helper. The outcome of each is
 * stored as a line until picture_writer_news returns it; a descriptor signals that there are some.
 *
 * Invariants
 *   P1 jobs are executed one at a time, in the order of picture_writer_give;
 *   P2 each has one outcome, reported once, in that order, and a file is complete before its
 *      outcome reports it;
 *   P3 at most PICTURE_WRITER_WAITING_MOST jobs wait: picture_writer_give waits for room, so memory
 *      is bounded;
 *   P4 every job is done when picture_writer_free returns, unless picture_writer_wait cancelled it.
 *
 * Apart from its own thread, a picture writer belongs to one thread.
 */
#ifndef IMAGE_PICTURE_WRITER_H
#define IMAGE_PICTURE_WRITER_H

#include <stdbool.h>

#include "base/buf.h"
#include "base/err.h"
#include "base/file.h"
#include "base/watch.h"
#include "image/picture.h"

enum { PICTURE_WRITER_WAITING_MOST = 4 };

struct picture_writer;

/* One picture to be written; created by picture_job_new, owned by the writer after
 * picture_writer_give. */
struct picture_job;

/* `program` as for image_helper_new; it starts with the first job that needs it. ERR_MEMORY, or
 * ERR_IO without a descriptor or a thread. */
enum err picture_writer_new(struct picture_writer **writer, const char *program);

/* Wait for all jobs and free the writer; accepts NULL. */
void picture_writer_free(struct picture_writer *writer);

/* Return true if the extension of the name can be written. Other names are written while the caller
 * waits for the outcome. */
bool picture_writer_takes(const char *path);

/* Check the path (the folder exists, and under FILE_KEEP the file does not), and create a job,
 * which owns the picture then. On error the picture remains the caller's. */
enum err picture_job_new(struct picture_job **job, const char *path, enum file_mode mode,
                         struct picture *picture, struct fault *fault);
void picture_job_free(struct picture_job *job); /* before picture_writer_give; accepts NULL */

/* Queue a job, which cannot fail; waits while PICTURE_WRITER_WAITING_MOST are before it. */
void picture_writer_give(struct picture_writer *writer, struct picture_job *job);

/* Return true if a job for this path is not done yet. */
bool picture_writer_holds(struct picture_writer *writer, const char *path);

/* Wait until all jobs are done. If the watch (or NULL) stops, cancel jobs that have not begun,
 * report it as their outcome, and return ERR_CANCELLED. */
enum err picture_writer_wait(struct picture_writer *writer, struct watch *watch);

/* Append a line for each new outcome: "wrote a.png", or "error: " and the message. */
void picture_writer_news(struct picture_writer *writer, struct buf *out);

/* A descriptor that is readable while there are new outcomes. */
int picture_writer_descriptor(const struct picture_writer *writer);

#endif
