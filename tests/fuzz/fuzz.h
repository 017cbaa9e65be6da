/* SPDX-License-Identifier: MIT */
/*
 * Fuzz targets: each file fuzz_NAME.c hands any bytes at all to one reader of what comes from
 * outside, and ends the program where a promise of that reader does not hold.
 *
 * `make fuzz` has libFuzzer look for such bytes, under clang's AddressSanitizer and UBSan. The
 * same targets, with a plain driver (replay.c), read what lies in tests/fuzz/corpus/NAME in every
 * `make test`, whole, cut, and with bytes changed.
 */
#ifndef TESTS_FUZZ_FUZZ_H
#define TESTS_FUZZ_FUZZ_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

/* Always 0. The name is libFuzzer's. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

#define HOLDS(condition)                                                                           \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            fprintf(stderr, "%s:%d: does not hold: %s\n", __FILE__, __LINE__, #condition);         \
            abort();                                                                               \
        }                                                                                          \
    } while (0)

/* The path of a file in memory with these bytes, for readers that open files; the same one each
 * time. */
const char *fuzz_file(const uint8_t *bytes, size_t length);

/* The path of the header of a pair of files, A.hdr and A.img, with these bytes; likewise. */
const char *fuzz_pair(const uint8_t *header, size_t header_length, const uint8_t *voxels,
                      size_t voxels_length);

/* What is in that path as a scene: the header alone, its voxels, half of them along each axis, and
 * as a map of a scene that lies elsewhere. */
void fuzz_volume(const char *path);

#endif
