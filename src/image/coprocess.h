/* SPDX-License-Identifier: MIT */
/*
 * A coprocess: one of our programs that runs a large library in a separate process, and answers
 * requests over a socket pair on its standard input and output.
 *
 * A decoder that crashes on a hostile file costs one error message: the request fails, and the next
 * request starts the program again. Nothing here raises SIGPIPE or waits without a limit. The
 * program is killed if it neither reads nor writes the expected bytes within `patience_ms`, plus a
 * second for each megabyte, since its memory last grew, without the time for which the client was
 * stopped (Ctrl-Z); if it used five seconds of the processor (work_ms) without either, as a decoder
 * in an endless loop does; if it closes the socket and keeps running; and if the watch stops while
 * it is waited for. Its standard error is /dev/null, it has no environment, and it is a separate
 * process group, so that an interrupt from the keyboard does not reach it. It confines itself
 * before it decodes a byte, and it ends with the thread that started it, however that ends
 * (wire.hh).
 *
 * The client defines requests and answers (image_helper.h, volume_helper.h): lines of words and
 * decimal numbers, and counted bytes; each helper answers "versions\n" by "versions LENGTH\n words"
 * and ends. The functions below return false and set `trouble` if the program is silent, gone, or
 * sends an invalid answer; coprocess_fault ends it and reports the error.
 */
#ifndef IMAGE_COPROCESS_H
#define IMAGE_COPROCESS_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

#include "base/err.h"
#include "base/watch.h"

#define COPROCESS_OF_ITK "ITK, which Debian has as libinsighttoolkit5-dev"

enum { COPROCESS_LINE = 96 }; /* bytes of the longest line, with its line feed */

struct coprocess {
    const char *kind;    /* "the image helper", for messages */
    const char *hint;    /* features that work without it: " (...)"; or NULL */
    const char *made_of; /* if it is missing: the library from which a checkout builds it, */
    const char *package; /* and the package that has it */
    char *program;       /* its path; owned */
    pid_t process;       /* 0: not running */
    int fd;              /* our end of the socket pair; -1: none */
    int patience_ms;     /* applies from the next start */
    int work_ms;         /* limit of processor time without progress; 0: five seconds */
    uint64_t memory;     /* limit of its own memory in bytes, from the next start; 0: none */
    struct watch *watch; /* polled while it is waited for, as `doing`; or NULL */
    const char *doing;
    enum trouble { FINE, SILENT, STUCK, GONE, ODD, STOPPED } trouble; /* with the current request */
    uint64_t busy_ms; /* processor time at its last progress; */
    uint64_t pages;   /* and its pages of memory; 0: unknown */
};

/* Find the program by coprocess_find, unless `program` is a path. */
enum err coprocess_init(struct coprocess *c, const char *name, const char *program,
                        struct fault *fault);
void coprocess_release(struct coprocess *c); /* ends it, and waits for it */

/* Start it unless it runs. A program that ended between requests is replaced without an error. */
enum err coprocess_start(struct coprocess *c, struct fault *fault);

/* Kill it, unless it has ended, and return its status, as waitpid does; -1 if unknown. */
int coprocess_stop(struct coprocess *c);

/* Limit its own memory to `soft` bytes from now on, and later limits to `hard`; no limit in a build
 * that cannot be limited. False, with errno, on failure. */
bool coprocess_limit(struct coprocess *c, uint64_t soft, uint64_t hard);

bool coprocess_transmit(struct coprocess *c, const void *bytes, size_t length);
bool coprocess_receive(struct coprocess *c, void *bytes, size_t length);
bool coprocess_receive_line(struct coprocess *c, char line[COPROCESS_LINE]); /* no line feed */
bool coprocess_odd(struct coprocess *c); /* set trouble: an invalid answer; returns false */

/* Read `count` numbers 0..most, separated by one blank, up to the end of the line. */
bool coprocess_numbers(const char *line, unsigned count, const int64_t most[], int64_t out[]);

/* In these two, `path` may be NULL: then the caller adds the action and the file to the message.
 *
 * Receive the first line of an answer. If it is "error LENGTH", receive the words too and report
 * the error: "cannot read PATH: words". */
enum err coprocess_answer(struct coprocess *c, char line[COPROCESS_LINE], const char *doing,
                          const char *path, struct fault *fault);

/* After trouble: end the program and report the trouble with the file. */
enum err coprocess_fault(struct coprocess *c, const char *doing, const char *path,
                         struct fault *fault);

/* Find the program `name`: in the folder of the running one, as in a checkout, or in
 * ../libexec/iftty, as `make install` puts it. */
struct buf;
enum err coprocess_find(struct buf *out, const char *name, struct fault *fault);

/* Append the libraries of the helper `name`, "ITK 5.2.1, ...", by its own answer; or that it is
 * missing, with its package; or that it does not answer. */
void coprocess_add_versions(struct buf *out, const char *name, const char *package);

#endif
