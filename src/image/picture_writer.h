/* SPDX-License-Identifier: MIT */
/*
 * The picture writer: compresses and writes pictures while the session goes on.
 *
 * A thread of its own takes one job after the other and has an image helper of its own. The outcome
 * of each is stored as a line until picture_writer_news takes it; a descriptor says that there are
 * some.
 *
 * Invariants
 *   P1 jobs are carried out one at a time, in the order in which they were given;
 *   P2 each has one outcome, reported once, in that order, and a file is there, whole, before its
 *      outcome says so;
 *   P3 at most PICTURE_WRITER_WAITING_MOST jobs wait: picture_writer_give waits for room, so memory
 *      is bounded;
 *   P4 every job that was given is done when picture_writer_free returns, unless
 *      picture_writer_wait cancelled it.
 *
 * Apart from the thread inside, a picture writer belongs to one thread.
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

/* One picture to be written; made by picture_job_new, and owned by the writer once it is given. */
struct picture_job;

/* `program` as for image_helper_new; it is started with the first job that needs it. */
enum err picture_writer_new(struct picture_writer **writer, const char *program,
                            struct fault *fault);

/* Waits for everything that was given. NULL is fine. */
void picture_writer_free(struct picture_writer *writer);

/* Whether it takes a file of this name: its extension says that it can be written. A picture of
 * another name is better written while the caller waits for the outcome. */
bool picture_writer_takes(const char *path);

/* Checks what can be checked now (that the folder is there, and the file not, under FILE_KEEP), and
 * makes a job, into which the picture goes. On error the picture stays the caller's. */
enum err picture_job_new(struct picture_job **job, const char *path, enum file_mode mode,
                         struct picture *picture, struct fault *fault);
void picture_job_free(struct picture_job *job); /* one that is not given; NULL is fine */

/* Gives a job, which cannot fail; waits while PICTURE_WRITER_WAITING_MOST are before it. */
void picture_writer_give(struct picture_writer *writer, struct picture_job *job);

/* Whether a job for this path is not done yet. */
bool picture_writer_holds(struct picture_writer *writer, const char *path);

/* Waits until all is done. Where the watch (or NULL) stops it, jobs not yet begun are cancelled,
 * which their outcomes say, and ERR_CANCELLED. */
enum err picture_writer_wait(struct picture_writer *writer, struct watch *watch,
                             struct fault *fault);

/* Adds a line for every outcome not yet reported: "wrote a.png", or "error: " and the words. */
void picture_writer_news(struct picture_writer *writer, struct buf *out);

/* Becomes readable when there are news, until they are taken. */
int picture_writer_descriptor(const struct picture_writer *writer);

#endif
