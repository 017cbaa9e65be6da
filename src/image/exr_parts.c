/* SPDX-License-Identifier: MIT */
#include "image/exr_parts.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/least.h"
#include "base/mem.h"
#include "image/linear.h"

enum { LARGE_FROM = 1 << 20 };

/* ---- the channels, one table for both ways ---- */

const struct exr_channel exr_channels[EXR_CHANNELS] = {
    {"R", EXR_BOTH, 0, PLANE_RGBA, 0, EXR_PIXEL_HALF, 2},
    {"G", EXR_BOTH, 0, PLANE_RGBA, 1, EXR_PIXEL_HALF, 2},
    {"B", EXR_BOTH, 0, PLANE_RGBA, 2, EXR_PIXEL_HALF, 2},
    {"A", EXR_BOTH, 0, PLANE_RGBA, 3, EXR_PIXEL_HALF, 2},
    {"Z", EXR_STRAIGHT, PICTURE_DEPTH, PLANE_DEPTH, 0, EXR_PIXEL_FLOAT, 4},
    {"Z", EXR_ASSOCIATED, PICTURE_DEPTH, PLANE_EYE, 0, EXR_PIXEL_FLOAT, 4},
    {"depth", EXR_ASSOCIATED, PICTURE_DEPTH, PLANE_DEPTH, 0, EXR_PIXEL_FLOAT, 4},
    {"label", EXR_BOTH, PICTURE_LABEL, PLANE_LABEL, 0, EXR_PIXEL_UINT, 4},
    {"voxel", EXR_BOTH, PICTURE_VOXEL, PLANE_VOXEL, 0, EXR_PIXEL_UINT, 4},
    {"N.X", EXR_BOTH, PICTURE_NORMAL, PLANE_NORMAL, 0, EXR_PIXEL_FLOAT, 4},
    {"N.Y", EXR_BOTH, PICTURE_NORMAL, PLANE_NORMAL, 1, EXR_PIXEL_FLOAT, 4},
    {"N.Z", EXR_BOTH, PICTURE_NORMAL, PLANE_NORMAL, 2, EXR_PIXEL_FLOAT, 4},
};

const struct exr_channel *exr_channel_named(const char *name, bool is_associated)
{
    const unsigned kind = is_associated ? EXR_ASSOCIATED : EXR_STRAIGHT;
    for (int i = 0; i < EXR_CHANNELS; i++)
        if (exr_channels[i].kinds & kind && strcmp(exr_channels[i].name, name) == 0)
            return &exr_channels[i];
    return NULL;
}

void *exr_plane_of(const struct picture *picture, enum exr_plane plane)
{
    switch (plane) {
    case PLANE_RGBA:
        return picture->rgba;
    case PLANE_DEPTH:
    case PLANE_EYE:
        return picture->depth_mm;
    case PLANE_LABEL:
        return picture->label;
    case PLANE_VOXEL:
        return picture->voxel;
    case PLANE_NORMAL:
        return picture->normal;
    }
    return NULL;
}

/* ---- blocks ---- */

void exr_point_at(exr_coding_channel_info_t *info, const struct exr_channel *channel,
                  const struct picture *picture, const struct exr_block *block,
                  const struct exr_room *room)
{
    const enum exr_plane plane = channel->plane;
    const bool goes_by_room = plane == PLANE_RGBA || plane == PLANE_EYE;
    const int32_t pixel = plane == PLANE_RGBA ? 8 : plane == PLANE_NORMAL ? 12 : 4;
    const size_t line = (size_t)(goes_by_room ? block->width : picture->width) * (size_t)pixel;
    uint8_t *at = plane == PLANE_RGBA  ? (uint8_t *)room->halves
                  : plane == PLANE_EYE ? (uint8_t *)room->eye
                                       : (uint8_t *)exr_plane_of(picture, plane) + block->y * line +
                                             block->x * (size_t)pixel;
    info->decode_to_ptr = at + channel->index * (size_t)channel->bytes;
    info->user_pixel_stride = pixel;
    info->user_line_stride = (int32_t)line;
    info->user_bytes_per_element = (int16_t)channel->bytes;
    info->user_data_type = (uint16_t)channel->type;
}

void exr_fill_room(const struct exr_room *room, const struct picture *picture,
                   const struct exr_block *block)
{
    uint16_t alpha[256], *halves = room->halves;
    float *eye = room->eye;
    linear_alpha(alpha);
    for (uint32_t y = block->y; y < block->y + block->height; y++) {
        const size_t first = (size_t)y * picture->width + block->x;
        const uint8_t *rgba = picture->rgba + 4 * first;
        for (uint32_t x = 0; x < block->width; x++, rgba += 4, halves += 4) {
            const uint8_t covered = picture->is_associated ? rgba[3] : 255;
            for (size_t c = 0; c < 3; c++)
                halves[c] =
                    covered == 255 ? linear_half[rgba[c]] : linear_associated(rgba[c], covered);
            halves[3] = alpha[rgba[3]];
            if (picture->depth_mm)
                *eye++ = (float)((double)picture->depth_mm[first + x] + picture->space.eye_mm);
        }
    }
}

exr_result_t exr_each_block(const struct picture *picture, const uint32_t step[2],
                            exr_result_t (*each)(void *context, const struct exr_block *block),
                            void *context)
{
    exr_result_t result = EXR_ERR_SUCCESS;
    for (uint32_t y = 0; y < picture->height; y += step[1])
        for (uint32_t x = 0; x < picture->width && !result; x += step[0]) {
            const struct exr_block block = {x, y, least(picture->width - x, step[0]),
                                            least(picture->height - y, step[1])};
            result = each(context, &block);
        }
    return result;
}

bool exr_is_reserved(const char *name)
{
    static const char *const reserved[] = {
        "channels",           "chunkCount",         "compression", "dataWindow", "displayWindow",
        "lineOrder",          "maxSamplesPerPixel", "name",        "preview",    "pixelAspectRatio",
        "screenWindowCenter", "screenWindowWidth",  "tiles",       "type",       "version",
        "worldToCamera",      "worldToNDC",         EXR_ALPHA,     EXR_CAMERA,
    };
    for (size_t i = 0; i < sizeof reserved / sizeof reserved[0]; i++)
        if (strcmp(reserved[i], name) == 0)
            return true;
    return false;
}

/* ---- bytes in and out ---- */

static int64_t stream_failed(struct exr_stream *stream)
{
    stream->number = stream->number ? stream->number : errno;
    return -1;
}

static int64_t stream_read(exr_const_context_t context, void *user, void *to, uint64_t length,
                           uint64_t offset, exr_stream_error_func_ptr_t report)
{
    struct exr_stream *stream = user;
    (void)context;
    (void)report;
    if (offset > stream->bytes)
        return 0;
    const ssize_t n = file_read_at(stream->fd, to, (size_t)length, offset);
    return n < 0 ? stream_failed(stream) : n;
}

static int64_t stream_write(exr_const_context_t context, void *user, const void *from,
                            uint64_t length, uint64_t offset, exr_stream_error_func_ptr_t report)
{
    struct exr_stream *stream = user;
    (void)context;
    (void)report;
    if (stream->sink) { /* in order: a header */
        if (offset == stream->sink->length)
            buf_add(stream->sink, from, (size_t)length);
        return (int64_t)length;
    }
    const bool written =
        stream->fd < 0 || (lseek(stream->fd, (off_t)offset, SEEK_SET) >= 0 &&
                           file_step_write(stream->fd, stream->path, from, (size_t)length));
    return written ? (int64_t)length : stream_failed(stream);
}

static int64_t stream_size(exr_const_context_t context, void *user)
{
    (void)context;
    const struct exr_stream *stream = user;
    return (int64_t)stream->bytes;
}

/* The library would print. Its result codes say enough. */
static void stay_silent(exr_const_context_t context, exr_result_t code, const char *words)
{
    (void)context;
    (void)code;
    (void)words;
}

/* No more than is free, of which a limit is a part (mem_available). */
static void *allocate(size_t bytes)
{
    return bytes >= LARGE_FROM && bytes > mem_available() ? NULL : malloc(bytes);
}

exr_context_initializer_t exr_stream_setup(struct exr_stream *stream)
{
    exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
    setup.error_handler_fn = stay_silent;
    setup.alloc_fn = allocate;
    setup.free_fn = free;
    setup.user_data = stream;
    setup.read_fn = stream_read;
    setup.write_fn = stream_write;
    setup.size_fn = stream_size;
    return setup;
}

enum err exr_fault(const char *what, const struct exr_stream *stream, exr_result_t result,
                   struct fault *fault)
{
    if (stream->number) {
        errno = stream->number;
        return fault_errno(fault, what, stream->path);
    }
    if (result == EXR_ERR_OUT_OF_MEMORY)
        return fault_memory(fault, stream->path);
    return fault_set(fault, ERR_INPUT, "cannot %s %s: OpenEXR says: %s", what, stream->path,
                     exr_get_default_error_message(result));
}
