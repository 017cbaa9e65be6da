/* SPDX-License-Identifier: MIT */
/*
 * A picture: plain pixels and the words that go with them, as files hold it.
 *
 * Rows run from the top, pixels from the left. A rendition fills all planes; what comes out of a
 * PNG has `rgba` alone.
 */
#ifndef IMAGE_PICTURE_H
#define IMAGE_PICTURE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/err.h"

enum { PICTURE_SIDE_MOST = 16384 };

/* One piece of metadata: text under a name (PNG text chunk, EXR string attribute). */
struct attribute {
    char *name;
    char *value;
};

/* Where a picture was seen from, for formats that say it. Points are rows, as OpenEXR has them:
 * (x, y, z, 1) times the matrix. */
struct picture_space {
    double eye_mm;         /* how far in front of depth 0 the camera is: nothing is nearer to it */
    bool has_world;        /* and where that is in the world, millimetres: */
    float to_camera[4][4]; /* right, up, ahead of it, millimetres */
    float to_ndc[4][4];    /* 0,0 is the picture's upper left corner and 1,1 its lower right one */
};

struct picture {
    uint32_t width, height;
    uint8_t *rgba;   /* [height][width][4], sRGB, alpha 0 where no object is seen */
    uint8_t *shown;  /* the same over its background, opaque: for files that hold colours alone;
                        NULL: black is behind it, which alpha times the colours shows */
    bool is_clear;   /* nothing is behind it: alpha goes to files that hold it */
    float *depth_mm; /* [height][width] along the view, +infinity where nothing is seen; or NULL */
    uint32_t *label; /* [height][width], 0 where nothing is seen; or NULL */
    uint32_t *voxel; /* [height][width] voxel index, 0xFFFFFFFF where nothing is seen; or NULL */
    float *normal;   /* [height][width][3] unit vector towards Right, Anterior, Superior, out of the
                        object; 0,0,0 where nothing is seen; or NULL */
    bool is_associated; /* OpenEXR: colours are multiplied by alpha, and the rest that goes with it
                           (image/exr.h) */
    struct picture_space space;
    double pixel_mm; /* the length of a pixel in what is shown; 0 where that is not known */
    bool tiled;      /* in tiles rather than lines, where the format knows them */
    struct attribute *attribute; /* names differ from one another */
    size_t attributes;
};

/* Planes beside the colours. */
enum {
    PICTURE_DEPTH = 1,
    PICTURE_LABEL = 2,
    PICTURE_VOXEL = 4,
    PICTURE_NORMAL = 8,
    PICTURE_EVERY = 15,
};

/* All planes but normals (or rgba alone) for width x height pixels, zeroed. ERR_LIMIT over 16384 a
 * side. */
enum err picture_init(struct picture *picture, uint32_t width, uint32_t height, bool all_planes,
                      struct fault *fault);
/* The same with these planes. */
enum err picture_init_planes(struct picture *picture, uint32_t width, uint32_t height,
                             unsigned planes, struct fault *fault);
/* Which there are. */
unsigned picture_planes(const struct picture *picture);

/* Normals for all pixels, zeroed. On failure the picture is as it was. */
enum err picture_add_normals(struct picture *picture, struct fault *fault);
void picture_release(struct picture *picture);

/* `height` rows of it from row `top` on; borrows the planes, and has no notes. */
struct picture picture_rows(const struct picture *picture, uint32_t top, uint32_t height);

/* What people see, where something is transparent over black. */
static inline const uint8_t *picture_colours(const struct picture *picture)
{
    return picture->shown ? picture->shown : picture->rgba;
}

/* Adds a copy of name and value; a value already under that name is replaced, so names are unique.
 * On failure the picture is as it was. */
enum err picture_note(struct picture *picture, const char *name, const char *value,
                      struct fault *fault);

/* The value under `name`, or NULL. */
const char *picture_find(const struct picture *picture, const char *name);

#endif
