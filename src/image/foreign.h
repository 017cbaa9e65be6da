/* SPDX-License-Identifier: MIT */
/* Formats that nobody here reads, known by their first bytes or their names, and what converts
 * them. */
#ifndef IMAGE_FOREIGN_H
#define IMAGE_FOREIGN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* By its bytes; a name alone where there are none. */
struct foreign {
    const char *endings; /* or the whole name */
    unsigned at, length;
    const char *bytes, *advice;
};

/* Up to one without advice. What a format reads that there is now, has no place here
 * (tests/test_foreign.c). */
extern const struct foreign foreign_formats[];

/* "a data set of AFNI, which is not read: `3dAFNItoNIFTI FILE` makes a NIfTI of it"; NULL for what
 * is not known. `begin` is what a file begins with, inflated where it is gzip; by_name:
 * whether its name alone is enough. */
const char *foreign_advice(const char *path, const uint8_t *begin, size_t length, bool by_name);

/* Whether what is advised is that it is a picture, and no scene. */
bool foreign_is_picture(const char *advice);

#endif
