/* SPDX-License-Identifier: MIT */
/*
 * Write OpenEXR as image/exr.h describes it, from a complete picture or while it is drawn. A strip
 * (image/strips.h) is a block of lines that ZIP compresses together, or a row of tiles.
 */
#ifndef IMAGE_EXR_WRITE_H
#define IMAGE_EXR_WRITE_H

#include <openexr.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/buf.h"
#include "base/err.h"
#include "base/file.h"
#include "image/picture.h"
#include "image/strips.h"

/* ERR_INPUT for an attribute whose name OpenEXR uses itself (such as "channels") or that is empty
 * or longer than 255 bytes. */
extern const struct strips_format exr_strips;

/* out = the header of `like` without its notes; other bytes may follow it. */
enum err exr_write_header_of(struct buf *out, const struct picture *like, struct fault *fault);

/*
 * Declarations for reading and writing: the channels of our files, blocks of their pixels, and
 * input and output for OpenEXR's C library.
 */

/* ---- the channels, one table for both ways ---- */

/* PLANE_EYE, the depth from the camera, exists in files alone. */
enum exr_plane { PLANE_RGBA, PLANE_DEPTH, PLANE_EYE, PLANE_LABEL, PLANE_VOXEL, PLANE_NORMAL };

/* Files whose colours are as they are, and those in which they are multiplied by alpha. */
enum { EXR_STRAIGHT = 1, EXR_ASSOCIATED = 2, EXR_BOTH = EXR_STRAIGHT | EXR_ASSOCIATED };

#define EXR_ALPHA       "iftty:alpha" /* the attribute for multiplied colours */
#define EXR_ALPHA_VALUE "associated"

#define EXR_CAMERA      "iftty:cameraToWorld" /* for Blender and Nuke (image/exr.h) */

enum { EXR_CHANNELS = 12 };
extern const struct exr_channel {
    const char *name;
    unsigned kinds; /* kinds of files that have it, */
    unsigned needs; /* if the picture has this plane (image/picture.h); 0: always */
    enum exr_plane plane;
    unsigned index; /* index in the plane's pixel */
    exr_pixel_type_t type;
    int bytes;
} exr_channels[EXR_CHANNELS];

/* Find the channel of a file of that kind, or NULL. */
const struct exr_channel *exr_channel_named(const char *name, bool is_associated);

/* ---- blocks ---- */

/* The pixels of one block of the file: some lines, or a tile. */
struct exr_block {
    uint32_t x, y, width, height;
};

/* Samples of a block that are converted in memory: RGBA, 4 halves a pixel, and the depth from the
 * camera. */
struct exr_room {
    uint16_t *halves;
    float *eye;
};

/* Point the library at a channel's pixels of a block. */
void exr_point_at(exr_coding_channel_info_t *info, const struct exr_channel *channel,
                  const struct picture *picture, const struct exr_block *block,
                  const struct exr_room *room);

/* Call `each` for the blocks of `step` pixels (lines are as wide as the picture), in the order of
 * the file, until one fails. */
exr_result_t exr_each_block(const struct picture *picture, const uint32_t step[2],
                            exr_result_t (*each)(void *context, const struct exr_block *block),
                            void *context);

/* Convert the pixels of a block of the picture to the samples of a file. */
void exr_fill_room(const struct exr_room *room, const struct picture *picture,
                   const struct exr_block *block);

/* Return true for names that an OpenEXR header uses itself; it would refuse or misread a string. */
bool exr_is_reserved(const char *name);

/* ---- bytes in and out ---- */

/* The library's own file layer neither returns errno nor checks the kind of the file. */
struct exr_stream {
    int fd;           /* -1: written bytes are appended to `sink`, or dropped without one */
    struct buf *sink; /* or NULL */
    uint64_t bytes;
    int number; /* errno of the first error, or 0 */
    const char *path;
};

/* Return the settings of a context on `stream`, for reading or writing. */
exr_context_initializer_t exr_stream_setup(struct exr_stream *stream);

/* Report an error; `what` is "read" or "write". */
enum err exr_fault(const char *what, const struct exr_stream *stream, exr_result_t result,
                   struct fault *fault);

#endif
