/* SPDX-License-Identifier: MIT */
/*
 * Golden images: two decoded pictures compared bit for bit.
 *
 * Results are integers all the way, so there is no tolerance to choose: a pixel is the same or it
 * is not. Depths are compared as the bits of their floats; a NaN equals itself, -0 is not 0.
 *
 * Here are planes in memory only. Who decodes and writes pictures is not known here.
 */
#ifndef JOURNAL_GOLDEN_H
#define JOURNAL_GOLDEN_H

#include <stdbool.h>
#include <stdint.h>

#include "base/buf.h"
#include "base/err.h"

/* In the order in which a pixel is compared. Each has four bytes for a pixel: R G B A; a float; a
 * uint32_t; a uint32_t. */
enum golden_plane { GOLDEN_RGBA, GOLDEN_DEPTH, GOLDEN_LABEL, GOLDEN_VOXEL, GOLDEN_PLANES };

/* A decoded picture: rows from the top, columns from the left, column fastest. A plane that is not
 * there is NULL. Borrowed. */
struct golden_planes {
    uint32_t width, height;
    const void *plane[GOLDEN_PLANES];
};

struct golden_difference {
    bool is_same;
    bool shape_differs; /* another size, or a plane that only one has; nothing else is known then */
    uint64_t pixels;    /* that differ in any plane */
    uint64_t pixels_of[GOLDEN_PLANES];
    uint32_t column, row;                  /* the first of them in reading order, from 0 */
    enum golden_plane plane;               /* the first plane that differs there */
    char expected[64], actual[64];         /* its values: "255,0,0,255", "12.5 (0x41480000)", "7" */
    uint32_t expected_voxel, actual_voxel; /* under that pixel; 0 without a voxel plane */
    uint8_t *image; /* [height][width][4]: what differs bright red over a dim grey copy of what was
                       expected. NULL where is_same or shape_differs. Released with the rest. */
    uint32_t width, height; /* of `image` */
};

/* OK whatever the comparison says, which is in *difference, to be released; ERR_CHECK never.
 * ERR_MEMORY when there is no room for the image. */
enum err golden_compare(const struct golden_planes *expected, const struct golden_planes *actual,
                        struct golden_difference *difference, struct fault *fault);
void golden_difference_release(struct golden_difference *difference);

/* One line about *difference for a person: "12 pixels differ, first column 3, row 4: ...". */
void golden_describe(struct buf *out, const struct golden_difference *difference);

/* Golden names are [a-z0-9][a-z0-9_-]{0,63}: nothing that leads to another folder. */
bool golden_name_is_valid(const char *name);

/* What follows the name of a journal that is not whole yet: of `iftty run --whole`. */
#define JOURNAL_PART ".part"

/* out = the file name that pictures have of a journal: the one of what a link leads to, and the one
 * that it will have. */
void golden_journal_name(struct buf *out, const char *journal_path);

/* out = "<journal path without .iftty>.golden", the folder of a journal's golden images, and the
 * path of one of them in it: "<folder>/<name>.exr". Of a link to a journal it is that of the
 * journal itself, unless there is only one beside the link. ERR_INPUT for a name that is not
 * valid. */
enum err golden_folder(struct buf *out, const char *journal_path, struct fault *fault);

/* out = the folder next to a link to a journal, where golden_folder has another; else "". */
enum err golden_folder_next_to_link(struct buf *out, const char *journal_path, struct fault *fault);
enum err golden_path(struct buf *out, const char *journal_path, const char *name,
                     struct fault *fault);

#endif
