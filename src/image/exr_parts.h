/*
 * What writing and reading OpenEXR share: the channels, the bytes of the file, the blocks in which
 * pixels are packed. For exr_write.c, exr_read.c and exr_parts.c alone.
 */
#ifndef IMAGE_EXR_PARTS_H
#define IMAGE_EXR_PARTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <openexr.h>

#include "base/err.h"
#include "image/picture.h"

enum {
    EXR_BLOCK_LINES = 16, /* scan lines that ZIP packs together */
    EXR_TILE_SIDE = 64,   /* of the tiles that are written */
    EXR_TILE_MOST = 4096, /* of those that are read */
};

/* Of PLANE_EYE the file alone has pixels: the depth, from the camera on. */
enum plane { PLANE_RGBA, PLANE_DEPTH, PLANE_EYE, PLANE_LABEL, PLANE_VOXEL, PLANE_NORMAL };

/* Files whose colours are as they are, and those in which they are multiplied by alpha. */
enum { EXR_STRAIGHT = 1, EXR_ASSOCIATED = 2 };

struct channel {
    const char *name;
    unsigned kinds; /* of files that have it */
    enum plane plane;
    unsigned index; /* within the plane's pixel */
    exr_pixel_type_t type;
    int bytes;
};

enum { EXR_CHANNELS = 12 };
extern const struct channel exr_channel[EXR_CHANNELS];

#define EXR_ALPHA       "iftty:alpha" /* the attribute that says so */
#define EXR_ALPHA_VALUE "associated"

/* The channel of a file of that kind, or NULL. */
const struct channel *exr_channel_named(const char *name, bool is_associated);
/* The plane of a picture that a channel is made of, or NULL. */
void *exr_plane_of(const struct picture *picture, enum plane plane);

/* The pixels that one block of the file packs: some lines, or a tile. */
struct block {
    uint32_t x, y, width, height;
};

/* What goes by way of memory for a block: RGBA, 4 halves a pixel, and the depth from the camera. */
struct exr_room {
    uint16_t *halves;
    float *eye; /* written only */
};

/* Points the library at a channel's pixels of a block. */
void exr_point(exr_coding_channel_info_t *info, const struct channel *channel,
               const struct picture *picture, const struct block *block,
               const struct exr_room *room);

/* Calls `each` for the blocks of `step` pixels (lines are as wide as the picture), in the order of
 * the file, until one fails. */
exr_result_t exr_each_block(const struct picture *picture, const uint32_t step[2],
                            exr_result_t (*each)(void *context, const struct block *block),
                            void *context);

/* Bytes in and out: the library's own file layer neither returns errno nor checks what it opens. */
struct stream {
    int fd;
    uint64_t bytes;
    int number; /* errno of the first failure, or 0 */
    const char *path;
};

/* Settings of a context on `stream`, for reading or writing. */
exr_context_initializer_t exr_stream_setup(struct stream *stream);

/* What failed, in words. `what` is "read" or "write". */
enum err exr_library_fault(const char *what, const struct stream *stream, exr_result_t result,
                           struct fault *fault);

/* Names that an OpenEXR header uses itself, where a string would be refused or misread. */
bool exr_name_is_reserved(const char *name);

#endif
