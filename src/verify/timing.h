/*
 * Which records of a journal take longest to carry out: the slowest few, in memory that does not
 * grow with the journal.
 */
#ifndef VERIFY_TIMING_H
#define VERIFY_TIMING_H

#include "base/buf.h"

enum { TIMING_MOST = 10 };

/* Begins as {0}. */
struct timing {
    struct timing_row {
        uint64_t ns;
        size_t number;      /* of the record */
        struct buf command; /* the beginning of it, safe to print */
    } row[TIMING_MOST];     /* the slowest first; of two that are equal the earlier */
    size_t rows;
};

void timing_add(struct timing *timing, size_t number, uint64_t ns, const char *command);

/* Lines: "12.345 ms, record 31: run". */
void timing_tell(struct buf *lines, const struct timing *timing);
void timing_release(struct timing *timing);

#endif
