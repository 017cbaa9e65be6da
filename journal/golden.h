/* SPDX-License-Identifier: MIT */
/*
 * Golden images: two decoded pictures compared bit for bit.
 *
 * All results are integers, so no tolerance is needed. Depths are compared as the bits of their
 * floats: a NaN equals itself, -0 differs from 0.
 *
 * This file knows planes in memory only, not files or formats.
 */
#ifndef JOURNAL_GOLDEN_H
#define JOURNAL_GOLDEN_H

#include <stdbool.h>
#include <stdint.h>

#include "base/buf.h"
#include "base/err.h"

/* In order of comparison. Each plane has four bytes per pixel: R G B A; a float; a uint32_t; a
 * uint32_t. */
enum golden_plane { GOLDEN_RGBA, GOLDEN_DEPTH, GOLDEN_LABEL, GOLDEN_VOXEL, GOLDEN_PLANES };

/* A decoded picture: rows from the top, columns from the left, column fastest. A missing plane
 * is NULL. Borrowed. */
struct golden_planes {
    uint32_t width, height;
    const void *plane[GOLDEN_PLANES];
};

struct golden_difference {
    bool is_same;
    bool shape_differs; /* another size, or a plane that only one picture has; then nothing
                           else is known */
    uint64_t pixels;    /* pixels that differ in any plane */
    uint64_t pixels_of[GOLDEN_PLANES];
    uint32_t column, row;                  /* first of them in reading order, from 0 */
    enum golden_plane plane;               /* first plane that differs there */
    char expected[64], actual[64];         /* values there: "255,0,0,255", "12.5
                                              (0x41480000)", "7" */
    uint32_t expected_voxel, actual_voxel; /* seen there; UINT32_MAX: none; 0: no such plane */
    uint8_t *image; /* [height][width][4]: different pixels in bright red over a dim grey copy
                       of the expected picture. NULL if is_same or shape_differs. Released
                       with the rest. */
    uint32_t width, height; /* size of `image` */
};

/* Compare two pictures. *difference receives the result, to be released. OK even if they differ,
 * ERR_MEMORY if the image does not fit. */
enum err golden_compare(const struct golden_planes *expected, const struct golden_planes *actual,
                        struct golden_difference *difference, struct fault *fault);
void golden_difference_release(struct golden_difference *difference);

/* Describe *difference in one line: "12 pixels differ, first column 3, row 4: ...". */
void golden_describe(struct buf *out, const struct golden_difference *difference);

/* Golden names are [a-z0-9][a-z0-9_-]{0,63}, so that none leads to another folder. */
bool golden_name_is_valid(const char *name);

/* Ending of the name of an incomplete journal, written by `iftty run --whole`. */
#define JOURNAL_PART ".part"

/* out = the journal's file name in pictures: after following a link, without the ending of an
 * incomplete journal. */
void golden_journal_name(struct buf *out, const char *journal_path);

/* out = "<journal path without .iftty>.golden", the folder of a journal's golden images. For a link
 * to a journal, use the folder of the journal itself, unless only the link has one. ERR_MEMORY. */
enum err golden_folder(struct buf *out, const char *journal_path, struct fault *fault);

/* out = the folder next to a link to a journal, if golden_folder returns another one; otherwise
 * "". */
enum err golden_folder_next_to_link(struct buf *out, const char *journal_path, struct fault *fault);

/* out = "<folder>/<name>.exr", the path of a golden image. ERR_INPUT for an invalid name. */
enum err golden_path(struct buf *out, const char *journal_path, const char *name,
                     struct fault *fault);

#endif
