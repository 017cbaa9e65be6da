/* SPDX-License-Identifier: MIT */
/* Fuzz targets: each hands any bytes at all to one reader of what comes from outside, and ends the
 * program where a promise of that reader does not hold.
 *
 * `make fuzz` has libFuzzer look for such bytes, under clang's AddressSanitizer and UBSan. The
 * same targets, with a plain driver (replay.c), read the files of tests/fuzz/corpus/NAME in every
 * `make test`, whole, cut, and with bytes changed. */
#ifndef TESTS_FUZZ_FUZZ_H
#define TESTS_FUZZ_FUZZ_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/drop.h"

typedef void fuzz_reader(const uint8_t *bytes, size_t length);
fuzz_reader fuzz_command, fuzz_config, fuzz_csa, fuzz_exr, fuzz_helper, fuzz_journal, fuzz_keys,
    fuzz_labels, fuzz_line, fuzz_mgh, fuzz_nifti, fuzz_nrrd, fuzz_png, fuzz_procedure, fuzz_raw,
    fuzz_request, fuzz_seeds, fuzz_seg, fuzz_surface, fuzz_transform;

struct fuzz_target {
    const char *name;
    fuzz_reader *read;
    unsigned changes; /* changed copies of each file that a replay makes */
};

/* The target of a name; NULL where there is none, after printing the names of all. */
const struct fuzz_target *fuzz_find(const char *name);

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

/* Read that path as a scene: the header only, its voxels, half of them along each axis, and as a
 * map of a displaced scene. */
void fuzz_volume(const char *path);

#endif
