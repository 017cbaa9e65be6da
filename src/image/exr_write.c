/* SPDX-License-Identifier: MIT */
#include "image/exr_write.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

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

/* ---- blocks ---- */

void exr_point_at(exr_coding_channel_info_t *info, const struct exr_channel *channel,
                  const struct picture *picture, const struct exr_block *block,
                  const struct exr_room *room)
{
    const enum exr_plane plane = channel->plane;
    const bool is_in_room = plane == PLANE_RGBA || plane == PLANE_EYE;
    const int32_t pixel = plane == PLANE_RGBA ? 8 : plane == PLANE_NORMAL ? 12 : 4;
    const size_t line = (size_t)(is_in_room ? block->width : picture->width) * (size_t)pixel;
    void *first = plane == PLANE_RGBA    ? (void *)room->halves
                  : plane == PLANE_EYE   ? (void *)room->eye
                  : plane == PLANE_DEPTH ? (void *)picture->depth_mm
                  : plane == PLANE_LABEL ? (void *)picture->label
                  : plane == PLANE_VOXEL ? (void *)picture->voxel
                                         : (void *)picture->normal;
    uint8_t *at = (uint8_t *)first;
    at += is_in_room ? 0 : block->y * line + block->x * (size_t)pixel;
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
    (void)context, (void)report;
    if (offset > stream->bytes)
        return 0;
    const ssize_t n = file_read_at(stream->fd, to, (size_t)length, offset);
    return n < 0 ? stream_failed(stream) : n;
}

static int64_t stream_write(exr_const_context_t context, void *user, const void *from,
                            uint64_t length, uint64_t offset, exr_stream_error_func_ptr_t report)
{
    struct exr_stream *stream = user;
    (void)context, (void)report;
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
    return (int64_t)((const struct exr_stream *)user)->bytes;
}

/* The library would print errors. Its result codes are sufficient. */
static void stay_silent(exr_const_context_t context, exr_result_t code, const char *words)
{
    (void)context, (void)code, (void)words;
}

/* Allocate only free memory, within the limit (mem_available). */
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

enum {
    BLOCK_LINES = 16, /* scan lines that ZIP packs together */
    TILE_SIDE = 64,
    NAME_MOST = 255,
    SHORT_NAME_MOST = 31,
    ZIP_LEVEL = 4,
};

/* ---- the header ---- */

/* Compute the camera of Blender and Nuke: its third axis points backward, so that the matrix is a
 * rotation with a position. False if the axes are not unit vectors at right angles in the world, as
 * in a sheared scene: a camera cannot have them. */
static bool set_camera(exr_attr_m44f_t *to_world, const float to_camera[4][4])
{
    memset(to_world, 0, sizeof *to_world);
    for (int d = 0; d < 3; d++)
        for (int e = 0; e < 3; e++) {
            double product = 0;
            for (int w = 0; w < 3; w++)
                product += (double)to_camera[w][d] * (double)to_camera[w][e];
            if (!(product > (d == e) - 1e-4 && product < (d == e) + 1e-4))
                return false;
            const float along = to_camera[e][d]; /* component along world axis e */
            to_world->m[4 * d + e] = d == 2 ? -along : along;
            to_world->m[12 + e] -= along * to_camera[3][d];
        }
    to_world->m[15] = 1;
    return true;
}

static exr_result_t put_header(exr_context_t context, const struct picture *like, unsigned planes)
{
    const exr_attr_box2i_t window = {
        .max = {.x = (int32_t)like->width - 1, .y = (int32_t)like->height - 1}};
    const exr_attr_v2f_t centre = {.x = 0, .y = 0};
    const exr_storage_t storage = like->tiled ? EXR_STORAGE_TILED : EXR_STORAGE_SCANLINE;
    bool has_long_name = false;
    int part;
    for (size_t i = 0; i < like->attributes; i++)
        has_long_name |= strlen(like->attribute[i].name) > SHORT_NAME_MOST;
    exr_result_t result = exr_set_longname_support(context, has_long_name);
    if (!result)
        result = exr_add_part(context, NULL, storage, &part);
    if (!result)
        result = exr_initialize_required_attr(context, part, &window, &window, 1.0f, &centre, 1.0f,
                                              EXR_LINEORDER_INCREASING_Y, EXR_COMPRESSION_ZIP);
    if (!result && like->tiled)
        result = exr_set_tile_descriptor(context, part, TILE_SIDE, TILE_SIDE, EXR_TILE_ONE_LEVEL,
                                         EXR_TILE_ROUND_DOWN);
    if (!result)
        result = exr_set_zip_compression_level(context, part, ZIP_LEVEL);
    const unsigned kind = like->is_associated ? EXR_ASSOCIATED : EXR_STRAIGHT;
    for (int i = 0; i < EXR_CHANNELS && !result; i++)
        if (exr_channels[i].kinds & kind &&
            (exr_channels[i].needs & planes) == exr_channels[i].needs)
            result = exr_add_channel(context, part, exr_channels[i].name, exr_channels[i].type,
                                     EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    for (size_t i = 0; i < like->attributes && !result; i++)
        result =
            exr_attr_set_string(context, part, like->attribute[i].name, like->attribute[i].value);
    if (!result && like->is_associated)
        result = exr_attr_set_string(context, part, EXR_ALPHA, EXR_ALPHA_VALUE);
    if (!result && like->is_associated && like->space.has_world) {
        exr_attr_m44f_t camera, ndc, to_world;
        memcpy(camera.m, like->space.to_camera, sizeof camera.m);
        memcpy(ndc.m, like->space.to_ndc, sizeof ndc.m);
        result = exr_attr_set_m44f(context, part, "worldToCamera", &camera);
        if (!result)
            result = exr_attr_set_m44f(context, part, "worldToNDC", &ndc);
        if (!result && set_camera(&to_world, like->space.to_camera))
            result = exr_attr_set_m44f(context, part, EXR_CAMERA, &to_world);
    }
    if (!result)
        result = exr_write_header(context);
    return result;
}

enum err exr_write_header_of(struct buf *out, const struct picture *like, struct fault *fault)
{
    struct exr_stream stream = {.fd = -1, .sink = out, .path = "a header"};
    const exr_context_initializer_t setup = exr_stream_setup(&stream);
    struct picture plain = *like;
    exr_context_t context;
    plain.attributes = 0;
    exr_result_t result = exr_start_write(&context, stream.path, EXR_WRITE_FILE_DIRECTLY, &setup);
    if (!result) {
        result = put_header(context, &plain, picture_planes(like));
        exr_finish(&context);
    }
    return result        ? exr_fault("write", &stream, result, fault)
           : out->failed ? fault_memory(fault, stream.path)
                         : OK;
}

static enum err check_names(const char *path, const struct picture *picture, struct fault *fault)
{
    for (size_t i = 0; i < picture->attributes; i++) {
        const char *name = picture->attribute[i].name;
        const size_t length = strlen(name);
        if (length == 0 || length > NAME_MOST || exr_is_reserved(name))
            return fault_set(fault, ERR_INPUT,
                             "cannot write %s: \"%.40s\" cannot name a note in OpenEXR", path,
                             name);
    }
    return OK;
}

/* ---- strips ---- */

/* The library compresses pixels for a file only: this one has our header without notes, and its
 * bytes are dropped. */
struct exr_coder {
    exr_context_t context;
    struct exr_stream nowhere;
    pthread_mutex_t lock; /* protects the context */
    unsigned planes;
};

static uint32_t strip_height(const struct picture *like)
{
    return like->tiled ? TILE_SIDE : BLOCK_LINES;
}

static void end_coder(void *context)
{
    struct exr_coder *coder = context;
    exr_finish(&coder->context);
    pthread_mutex_destroy(&coder->lock);
    free(coder);
}

static enum err begin_coder(void **out, const char *path, const struct picture *like,
                            unsigned planes, struct fault *fault)
{
    struct exr_coder *coder = mem_new(sizeof *coder);
    struct picture plain = *like;
    *out = NULL;
    if (!coder)
        return fault_memory(fault, path);
    plain.attributes = 0;
    coder->planes = planes;
    coder->nowhere = (struct exr_stream){.fd = -1, .path = path};
    pthread_mutex_init(&coder->lock, NULL);
    const exr_context_initializer_t setup = exr_stream_setup(&coder->nowhere);
    exr_result_t result = exr_start_write(&coder->context, path, EXR_WRITE_FILE_DIRECTLY, &setup);
    if (!result)
        result = put_header(coder->context, &plain, planes);
    if (result) {
        end_coder(coder);
        return exr_fault("write", &(struct exr_stream){.path = path}, result, fault);
    }
    *out = coder;
    return OK;
}

struct packing {
    struct exr_coder *coder;
    const struct picture *rows;
    uint32_t top; /* first of these rows in the picture */
    struct exr_room room;
    struct buf *out;
    exr_result_t (*compress)(exr_encode_pipeline_t *);
};

/* Run the library's step and correct its result: it stores a block deflated even if it has the same
 * length then, but every reader interprets this length as "stored plain" (seen in 3.1.5). */
static exr_result_t compress_block(exr_encode_pipeline_t *pipeline)
{
    const struct packing *packing = pipeline->encoding_user_data;
    exr_result_t result = packing->compress(pipeline);
    if (!result && pipeline->compressed_bytes == pipeline->packed_bytes &&
        pipeline->compressed_buffer != pipeline->packed_buffer)
        memcpy(pipeline->compressed_buffer, pipeline->packed_buffer,
               (size_t)pipeline->packed_bytes);
    return result;
}

/* Replace the step that writes: append the length of the block, and its bytes. */
static exr_result_t keep_block(exr_encode_pipeline_t *pipeline)
{
    const struct packing *packing = pipeline->encoding_user_data;
    const uint64_t bytes = pipeline->compressed_bytes;
    buf_add(packing->out, &bytes, sizeof bytes);
    buf_add(packing->out, pipeline->compressed_buffer, (size_t)bytes);
    return packing->out->failed ? EXR_ERR_OUT_OF_MEMORY : EXR_ERR_SUCCESS;
}

static exr_result_t pack_block(void *context, const struct exr_block *block)
{
    struct packing *packing = context;
    exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
    exr_context_t file = packing->coder->context;
    const int x = (int)block->x, y = (int)(block->y + packing->top);
    exr_chunk_info_t chunk;
    pthread_mutex_lock(&packing->coder->lock);
    exr_result_t result =
        packing->rows->tiled
            ? exr_write_tile_chunk_info(file, 0, x / TILE_SIDE, y / TILE_SIDE, 0, 0, &chunk)
            : exr_write_scanline_chunk_info(file, 0, y, &chunk);
    if (!result)
        result = exr_encoding_initialize(file, 0, &chunk, &pipeline);
    pthread_mutex_unlock(&packing->coder->lock);
    if (result)
        return result;
    exr_fill_room(&packing->room, packing->rows, block);
    for (int i = 0; i < pipeline.channel_count; i++) {
        const char *name = pipeline.channels[i].channel_name;
        exr_point_at(&pipeline.channels[i], exr_channel_named(name, packing->rows->is_associated),
                     packing->rows, block, &packing->room);
    }
    result = exr_encoding_choose_default_routines(file, 0, &pipeline);
    packing->compress = pipeline.compress_fn;
    pipeline.encoding_user_data = packing;
    pipeline.compress_fn = compress_block;
    pipeline.yield_until_ready_fn = NULL; /* it would wait for the order of blocks */
    pipeline.write_fn = keep_block;
    if (!result)
        result = exr_encoding_run(file, 0, &pipeline);
    exr_encoding_destroy(file, &pipeline);
    return result;
}

static void step_of(uint32_t step[2], const struct picture *like)
{
    step[0] = like->tiled ? TILE_SIDE : like->width;
    step[1] = strip_height(like);
}

static enum err compress_strip(void *context, const struct picture *rows, uint32_t top,
                               struct buf *out, uint32_t *check, struct fault *fault)
{
    struct exr_coder *coder = context;
    uint32_t step[2];
    step_of(step, rows);
    const size_t pixels = (size_t)least(step[0], rows->width) * rows->height;
    OWNED(mem_release) uint16_t *halves = mem_array(pixels, 4 * sizeof *halves);
    OWNED(mem_release) float *eye = mem_array(pixels, sizeof *eye);
    struct packing packing = {coder, rows, top, {halves, eye}, out, NULL};
    exr_result_t result =
        halves && eye ? exr_each_block(rows, step, pack_block, &packing) : EXR_ERR_OUT_OF_MEMORY;
    *check = 0;
    return result ? exr_fault("write", &coder->nowhere, result, fault) : OK;
}

/* ---- the file ---- */

struct copying {
    exr_context_t context;
    bool tiled;
    uint32_t top;
    const char *at, *end; /* bytes of the piece */
};

static exr_result_t copy_block(void *context, const struct exr_block *block)
{
    struct copying *c = context;
    const int x = (int)block->x, y = (int)(block->y + c->top);
    uint64_t bytes = 0;
    if (c->end - c->at < (ptrdiff_t)sizeof bytes)
        return EXR_ERR_READ_IO;
    memcpy(&bytes, c->at, sizeof bytes);
    const char *from = c->at + sizeof bytes;
    if (bytes > (uint64_t)(c->end - from))
        return EXR_ERR_READ_IO;
    c->at = from + bytes;
    return c->tiled ? exr_write_tile_chunk(c->context, 0, x / TILE_SIDE, y / TILE_SIDE, 0, 0, from,
                                           bytes)
                    : exr_write_scanline_chunk(c->context, 0, y, from, bytes);
}

static exr_result_t copy_pieces(exr_context_t context, const struct picture *like,
                                const struct strips_pieces *pieces, enum err *err,
                                struct fault *fault)
{
    struct copying copying = {.context = context, .tiled = like->tiled};
    OWNED(buf_release) struct buf bytes = {0};
    uint32_t step[2];
    exr_result_t result = EXR_ERR_SUCCESS;
    step_of(step, like);
    for (size_t i = 0; i < pieces->count && !*err && !result; i++) {
        const struct picture rows = {.width = like->width, .height = pieces->piece[i].rows};
        *err = strips_read(pieces, i, &bytes, fault);
        copying.at = buf_text(&bytes);
        copying.end = copying.at + bytes.length;
        if (!*err)
            result = exr_each_block(&rows, step, copy_block, &copying);
        copying.top += rows.height;
    }
    return result;
}

static enum err write_file(void *coder, const char *draft, const struct picture *like,
                           const struct strips_pieces *pieces, struct fault *fault)
{
    struct exr_stream stream = {.path = pieces->path};
    const exr_context_initializer_t setup = exr_stream_setup(&stream);
    exr_context_t context;
    enum err err = OK;
    TRY(check_names(stream.path, like, fault));
    stream.fd = file_step_open(draft, O_RDWR | O_CREAT | O_EXCL);
    if (stream.fd < 0)
        return fault_errno(fault, "write", stream.path);
    exr_result_t result = exr_start_write(&context, stream.path, EXR_WRITE_FILE_DIRECTLY, &setup);
    if (!result) {
        result = put_header(context, like, ((const struct exr_coder *)coder)->planes);
        if (!result)
            result = copy_pieces(context, like, pieces, &err, fault);
        const exr_result_t closed = exr_finish(&context); /* writes the table of chunks */
        result = result ? result : closed;
    }
    if (close(stream.fd) != 0 && !stream.number)
        stream.number = errno;
    if (!err && (result || stream.number))
        err = exr_fault("write", &stream, result, fault);
    return err;
}

const struct strips_format exr_strips = {.holds_planes = true,
                                         .height = strip_height,
                                         .begin = begin_coder,
                                         .pack = compress_strip,
                                         .write = write_file,
                                         .end = end_coder};
