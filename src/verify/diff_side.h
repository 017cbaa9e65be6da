/*
 * One side of a comparison: what a journal comes to, which a process of its own carries out and
 * hands back as bytes: the facts, then, where it went well, a label for each voxel, then the pixels
 * of the picture, if there is one.
 */
#ifndef VERIFY_DIFF_SIDE_H
#define VERIFY_DIFF_SIDE_H

#include "show/export_picture.h"
#include "verify/diff.h"

/* From one process of this program to another, so they are sent as they are. */
struct diff_facts {
    enum err err;
    char why[sizeof((struct fault *)0)->text];
    uint32_t size[3], picture_width, picture_height; /* 0, 0: none */
    uint64_t scene_digest;
    char proof[SHA256_HEX];
    size_t voxels, pending;
    uint8_t is_edited, is_torn; /* booleans */
    char label_name[256][LABEL_NAME_BYTES];
    struct palette palette;
};

struct diff_side {
    struct buf bytes;
    /* Places in them, once it was carried out well. */
    const struct diff_facts *facts;
    const uint8_t *labels; /* [z][y][x] */
    const uint8_t *pixels; /* [height][width][4] */
};

/* Carries out options->path[which]; with `other`, the side of B, draws the picture of both. To be
 * released, whatever is returned. */
enum err diff_side_carry_out(struct diff_side *side, const struct diff_options *options, int which,
                             const struct diff_side *other, struct fault *fault);
void diff_side_release(struct diff_side *side);

#endif
