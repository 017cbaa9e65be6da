/* Voxels without a header: plain numbers in a file, whose layout the user says. */
#ifndef IMAGE_RAW_H
#define IMAGE_RAW_H

#include <stdbool.h>
#include <stdint.h>

struct raw_layout {
    uint32_t size[3]; /* 0: no layout is given */
    unsigned type;    /* enum voxel_type */
    bool big_endian;
    uint64_t offset; /* bytes before the voxels */
};

#endif
