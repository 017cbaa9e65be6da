/* SPDX-License-Identifier: MIT */
/* The works: a fixed list of things that engine, render and journal do, each told as one line
 * "name digest". The list is the same on every machine, under every compiler, at every optimisation
 * and with any number of threads: tests/matrix/run.sh builds it in all those ways and compares.
 *
 * Here is nothing but src/base, src/engine, render and journal, and no library but SHA-256, so that
 * it can be built for machines for which nothing is installed but a compiler. */
#ifndef TESTS_MATRIX_WORKS_H
#define TESTS_MATRIX_WORKS_H

#include "base/team.h"
#include "tests/drop.h"
#include "base/err.h"
#include "engine/forest.h"
#include "engine/weight.h"

/* End the program if `err` is an error, or if `holds` is false; the last printed line names the
 * work. */
void must(enum err err, const struct fault *fault, const char *what);
void must_hold(bool holds, const char *what);

/* One line of the list: the name is printf-like, and names one thing only. */
void tell(uint64_t digest, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* A digest of bytes, the same for the same bytes: the first 64 bits of their SHA-256. */
uint64_t bytes_digest(const void *bytes, size_t length);

/* The scene that all works are about: a small geom of uneven spacing whose axes are not the
 * world's. Owned by the caller. */
struct scene *works_scene(void);

/* Random edits of the scene, the same each time: seeds of labels 0..5, no cell twice. */
enum { WORKS_SEEDS = 60 };
void works_edits(struct edit edit[WORKS_SEEDS], const struct scene *scene, uint64_t random);

/* Threads to work with; NULL for the caller alone. `folder` is there, and may be written to. */
void works_engine(struct team *team);
void works_render(void);
void works_journal(const char *folder);

#endif
