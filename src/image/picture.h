/* SPDX-License-Identifier: MIT */
/*
 * A picture: pixels and the notes that go with them, as files hold it; and a raster, pixels ready
 * to be encoded.
 *
 * Rows run from the top, pixels from the left. A rendition fills all planes; a picture read from a
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

/* The camera of a picture, for formats that can store it. Points are rows, as in OpenEXR:
 * (x, y, z, 1) times the matrix. */
struct picture_space {
    double eye_mm;         /* distance of the camera in front of depth 0: nothing is nearer to it */
    bool has_world;        /* the matrices below are known, in millimetres of the world: */
    float to_camera[4][4]; /* right, up, ahead of it, millimetres */
    float to_ndc[4][4];    /* 0,0 is the picture's upper left corner and 1,1 its lower right one */
};

struct picture {
    uint32_t width, height;
    uint8_t *rgba;   /* [height][width][4], sRGB, alpha 0 where no object is seen */
    uint8_t *shown;  /* the same over its background, opaque: for files without alpha; NULL: the
                        background is black, and the colours are multiplied by alpha */
    bool is_clear;   /* no background: formats that have alpha store it */
    float *depth_mm; /* [height][width] along the view, +infinity where nothing is seen; or NULL */
    uint32_t *label; /* [height][width], 0 where nothing is seen; or NULL */
    uint32_t *voxel; /* [height][width] voxel index, 0xFFFFFFFF where nothing is seen; or NULL */
    float *normal;   /* [height][width][3] unit vector towards Right, Anterior, Superior, out of the
                        object; 0,0,0 where nothing is seen; or NULL */
    bool is_associated; /* OpenEXR: colours are multiplied by alpha, with the other attributes of
                           such files (image/exr.h) */
    struct picture_space space;
    double pixel_mm;             /* the length of a pixel in the scene; 0: unknown */
    bool tiled;                  /* in tiles rather than lines, in formats that have both */
    struct attribute *attribute; /* names differ from one another */
    size_t attributes;
};

/* Planes in addition to the colours. */
enum {
    PICTURE_DEPTH = 1,
    PICTURE_LABEL = 2,
    PICTURE_VOXEL = 4,
    PICTURE_NORMAL = 8,
    PICTURE_BUT_NORMAL = 7,
    PICTURE_EVERY = 15,
};

/* Allocate colours and these planes for width x height pixels, zeroed. ERR_LIMIT over 16384 a
 * side. */
enum err picture_init(struct picture *picture, uint32_t width, uint32_t height, unsigned planes,
                      struct fault *fault);

/* The planes of a picture. */
unsigned picture_planes(const struct picture *picture);
void picture_release(struct picture *picture);

/* `height` rows from row `top`; borrows the planes, and has no notes. */
struct picture picture_rows(const struct picture *picture, uint32_t top, uint32_t height);

/* The visible colours; a picture without `shown` is over black. */
static inline const uint8_t *picture_colours(const struct picture *picture)
{
    return picture->shown ? picture->shown : picture->rgba;
}

/* Add a copy of name and value; replace a value already under that name, so names are unique. On
 * failure the picture is unchanged. */
enum err picture_note(struct picture *picture, const char *name, const char *value,
                      struct fault *fault);

/* The value under `name`, or NULL. */
const char *picture_find(const struct picture *picture, const char *name);

/*
 * A raster: indices into a palette, 24-bit colours, or 24-bit colours and alpha. The pixels are
 * borrowed, so a part of a raster is a raster too.
 */
enum { RASTER_COLOURS_MOST = 256 };

struct raster {
    uint32_t width, height; /* never 0 */
    size_t stride;          /* bytes from row to row */
    const uint8_t *bytes; /* a palette index a pixel; without a palette red, green, blue (alpha) */
    const uint32_t *colour; /* [colours] 0xRRGGBB; NULL without a palette */
    unsigned colours;
    bool has_alpha; /* without a palette alone */
    bool has_clear; /* with a palette alone: RASTER_CLEAR is an index too, of transparent pixels */
};

enum { RASTER_CLEAR = 255 }; /* a palette that uses it has fewer colours than that */

static inline size_t raster_pixel_bytes(const struct raster *raster)
{
    return raster->colour ? 1 : raster->has_alpha ? 4 : 3;
}

/* A rectangle of pixels, in coordinates of the whole picture. */
struct raster_box {
    uint32_t left, top, width, height;
};

/* An ASCII character in a cell of the screen, for pictures made of text, which have too few pixels
 * for letters. */
struct raster_note {
    uint16_t column, row; /* in cells of the picture */
    char character;
};

struct raster raster_part(const struct raster *raster, struct raster_box box);

/* Collect the colours that occur, numbered from 0 in the palette's order: place[p] is the new index
 * of index p, and used[] the new palette. The transparent index comes first, as black; *is_clear,
 * which may be NULL, says whether it occurs. Returns the number of colours. */
unsigned raster_used(const struct raster *raster, uint8_t place[RASTER_COLOURS_MOST],
                     uint32_t used[RASTER_COLOURS_MOST], bool *is_clear);

#endif
