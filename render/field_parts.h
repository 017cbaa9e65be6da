/*
 * What a block of the field of shown voxels is made of, and what its gradients, and how far inside
 * a place is, follow from: values at voxel centres, and the patterns of shown voxels around them.
 */
#ifndef RENDER_FIELD_PARTS_H
#define RENDER_FIELD_PARTS_H

#include <string.h>

#include "render/field.h"

enum {
    SAMPLES = FIELD_SIDE + 2,           /* values along an axis: a gradient is their difference */
    ROW = 16,                           /* SAMPLES, and room for whole vectors */
    INPUT = SAMPLES + 2 * FIELD_RADIUS, /* rows and planes of voxels that a block is made of */
    DEEP = 4096,                        /* the value deep inside */
};

/* Eight samples, added at once where the machine can. */
typedef int16_t lanes __attribute__((vector_size(16)));

struct row {
    lanes half[2]; /* values along x */
};

/* [z][y]; place i of a block is sample i + 1. */
struct values {
    struct row row[SAMPLES][SAMPLES];
};

/* The shown voxels that a block is made of, [z][y], bit 0 the first of a row; sample i is voxel i +
 * FIELD_RADIUS. Some more, so that four rows may be read at once. */
struct patterns {
    uint32_t row[INPUT + 1][INPUT];
};

static inline lanes lanes_at(const int16_t *at)
{
    lanes v;
    memcpy(&v, at, sizeof v);
    return v;
}

/* How far inside the places of a block are (render/inside.c). */
void inside_find(struct field_block *block, const struct values *values,
                 const struct patterns *patterns);

#endif
