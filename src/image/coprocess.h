/* SPDX-License-Identifier: MIT */
/*
 * A coprocess: a program of our own that does the work of a large library in a process of its own,
 * and answers requests over a socket pair on its standard input and output.
 *
 * A decoder that dies on a hostile file costs one error message: what it was asked fails, and the
 * next request starts the program again. Nothing here ever raises SIGPIPE or waits without end: one
 * that does not take or give what is its turn within `patience_ms`, and a second for each megabyte,
 * since it last took more memory, is ended; so is one that has worked for five seconds of the
 * processor (work_ms) without either, as a decoder in a circle does, one that closes the socket and
 * goes on, and one that is waited for when the watch stops. Its errors go nowhere, it has no
 * environment, and it is a process group of its own, so that an interrupt from the keyboard is not
 * meant for it.
 * From all else it keeps itself before it decodes a byte, and it ends with the thread that started
 * it, however that ends (wire.hh).
 *
 * The requests and answers are the client's (image_helper.h, volume_helper.h): lines of words and
 * decimal numbers, and counted bytes; each helper answers "versions\n" by "versions LENGTH\n words"
 * and ends. Each function that talks returns false and sets `trouble` where the program is silent,
 * gone, or makes no sense; coprocess_fault says so, after ending it.
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
    const char *kind;    /* "the image helper", for words */
    const char *hint;    /* what can be done without it: " (...)"; or NULL */
    const char *made_of; /* where it is not there: what a checkout builds it of, */
    const char *package; /* and which package has it elsewhere */
    char *program;       /* its path; owned */
    pid_t process;       /* 0: none runs */
    int fd;              /* our end of the socket pair, -1: none */
    int patience_ms;     /* of the next start */
    int work_ms;         /* of the processor that may pass without getting on; 0: five seconds */
    uint64_t memory;     /* bytes that it may hold for itself, of the next start; 0: any number */
    struct watch *watch; /* polled while it is waited for, as `doing`; or NULL */
    const char *doing;
    enum trouble { FINE, SILENT, STUCK, GONE, ODD, STOPPED } trouble; /* of the current request */
    uint64_t busy_ms; /* of the processor, which it had taken when it last got on; */
    uint64_t pages;   /* of memory, the same; 0: not known */
};

/* The program of this name is looked for by coprocess_find, unless `program` gives a path. */
enum err coprocess_init(struct coprocess *c, const char *name, const char *program,
                        struct fault *fault);
void coprocess_release(struct coprocess *c); /* ends it, and waits for it */

/* Makes sure that it runs. One that has ended while nothing was asked of it costs nothing and is
 * replaced. */
enum err coprocess_start(struct coprocess *c, struct fault *fault);

/* Kills it, unless it has ended, and returns how it ended, as waitpid does; -1 where that is not
 * known. */
int coprocess_stop(struct coprocess *c);

/* It may hold so many bytes for itself from now on, and never more than it could be given; any
 * number in a build that cannot be limited. False, with errno, where that cannot be had. */
bool coprocess_limit(struct coprocess *c, uint64_t soft, uint64_t hard);

bool coprocess_transmit(struct coprocess *c, const void *bytes, size_t length);
bool coprocess_receive(struct coprocess *c, void *bytes, size_t length);
bool coprocess_receive_line(struct coprocess *c, char line[COPROCESS_LINE]); /* no line feed */
bool coprocess_odd(struct coprocess *c); /* false: what it sent makes no sense */

/* `count` numbers 0..most, each after a blank but the first, up to the end of the line. */
bool coprocess_numbers(const char *line, unsigned count, const int64_t most[], int64_t out[]);

/* In these two, `path` may be NULL: then the caller says what could not be done, and with what.
 *
 * Takes the first line of an answer into `line`. Where it is "error LENGTH", takes the words too,
 * and makes them an error: "cannot read PATH: words". */
enum err coprocess_answer(struct coprocess *c, char line[COPROCESS_LINE], const char *doing,
                          const char *path, struct fault *fault);

/* After trouble: ends it and says what it did, and with which file. */
enum err coprocess_fault(struct coprocess *c, const char *doing, const char *path,
                         struct fault *fault);

/* The path of the program `name`: beside the running one, as in a checkout; else, where it is
 * there, in ../libexec/iftty, as `make install` has it. */
struct buf;
enum err coprocess_find(struct buf *out, const char *name, struct fault *fault);

/* Append the libraries of the helper `name`, "ITK 5.2.1, ...", as it answers itself; or that it is
 * missing and which package has it; or that it does not answer. */
void coprocess_add_versions(struct buf *out, const char *name, const char *package);

#endif
