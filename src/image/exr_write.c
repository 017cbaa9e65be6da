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
#include "image/exr_parts.h"

enum {
    BLOCK_LINES = 16, /* scan lines that ZIP packs together */
    TILE_SIDE = 64,
    NAME_MOST = 255,
    SHORT_NAME_MOST = 31,
    ZIP_LEVEL = 4,
};

/* ---- the header ---- */

/* As Blender and Nuke place a camera: the third axis points backward, not ahead, so that the matrix
 * is a rotation and a place. False where the axes are no unit vectors at right angles in the world,
 * as those of a sheared scene are: no camera stands like that. */
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
            const float along = to_camera[e][d]; /* of world axis e */
            to_world->m[4 * d + e] = d == 2 ? -along : along;
            to_world->m[12 + e] -= along * to_camera[3][d];
        }
    to_world->m[15] = 1;
    return true;
}

/* Of the picture's standard attributes, and that one. */
static exr_result_t put_space(exr_context_t context, const struct picture_space *space)
{
    exr_attr_m44f_t camera, ndc, to_world;
    memcpy(camera.m, space->to_camera, sizeof camera.m);
    memcpy(ndc.m, space->to_ndc, sizeof ndc.m);
    exr_result_t result = exr_attr_set_m44f(context, 0, "worldToCamera", &camera);
    if (!result)
        result = exr_attr_set_m44f(context, 0, "worldToNDC", &ndc);
    if (!result && set_camera(&to_world, space->to_camera))
        result = exr_attr_set_m44f(context, 0, EXR_CAMERA, &to_world);
    return result;
}

static bool has_long_name(const struct picture *picture)
{
    for (size_t i = 0; i < picture->attributes; i++)
        if (strlen(picture->attribute[i].name) > SHORT_NAME_MOST)
            return true;
    return false;
}

static exr_result_t put_header(exr_context_t context, const struct picture *like, unsigned planes)
{
    const exr_attr_box2i_t window = {
        .max = {.x = (int32_t)like->width - 1, .y = (int32_t)like->height - 1}};
    const exr_attr_v2f_t centre = {.x = 0, .y = 0};
    const exr_storage_t storage = like->tiled ? EXR_STORAGE_TILED : EXR_STORAGE_SCANLINE;
    int part;
    exr_result_t result = exr_set_longname_support(context, has_long_name(like));
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
    if (!result && like->is_associated && like->space.has_world)
        result = put_space(context, &like->space);
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

/* The library packs pixels for a file alone: this one has our header without notes, and what goes
 * into it goes nowhere. */
struct exr_coder {
    exr_context_t context;
    struct exr_stream nowhere;
    pthread_mutex_t lock; /* of the context */
    unsigned planes;
};

static uint32_t height_of(const struct picture *like)
{
    return like->tiled ? TILE_SIDE : BLOCK_LINES;
}

static void end(void *context)
{
    struct exr_coder *coder = context;
    exr_finish(&coder->context);
    pthread_mutex_destroy(&coder->lock);
    free(coder);
}

static enum err begin(void **out, const char *path, const struct picture *like, unsigned planes,
                      struct fault *fault)
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
        end(coder);
        return exr_fault("write", &(struct exr_stream){.path = path}, result, fault);
    }
    *out = coder;
    return OK;
}

struct packing {
    struct exr_coder *coder;
    const struct picture *rows;
    uint32_t top; /* of these rows, in the picture */
    struct exr_room room;
    struct buf *out;
    exr_result_t (*compress)(exr_encode_pipeline_t *);
};

/* The library's own step, then mended: a block that deflate leaves exactly as long as it was is
 * stored deflated, but every reader takes that length to mean "stored plain" (seen in 3.1.5). */
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

/* In place of the step that writes: how long the block is, and its bytes. */
static exr_result_t keep_block(exr_encode_pipeline_t *pipeline)
{
    const struct packing *packing = pipeline->encoding_user_data;
    const uint64_t bytes = pipeline->compressed_bytes;
    buf_add(packing->out, &bytes, sizeof bytes);
    buf_add(packing->out, pipeline->compressed_buffer, (size_t)bytes);
    return packing->out->failed ? EXR_ERR_OUT_OF_MEMORY : EXR_ERR_SUCCESS;
}

/* Where a block goes; the pipeline that packs it. */
static exr_result_t begin_block(const struct packing *packing, const struct exr_block *block,
                                exr_encode_pipeline_t *pipeline)
{
    struct exr_coder *coder = packing->coder;
    const int x = (int)block->x, y = (int)(block->y + packing->top);
    exr_chunk_info_t chunk;
    pthread_mutex_lock(&coder->lock);
    exr_result_t result = packing->rows->tiled
                              ? exr_write_tile_chunk_info(coder->context, 0, x / TILE_SIDE,
                                                          y / TILE_SIDE, 0, 0, &chunk)
                              : exr_write_scanline_chunk_info(coder->context, 0, y, &chunk);
    if (!result)
        result = exr_encoding_initialize(coder->context, 0, &chunk, pipeline);
    pthread_mutex_unlock(&coder->lock);
    return result;
}

static exr_result_t pack_block(void *context, const struct exr_block *block)
{
    struct packing *packing = context;
    exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
    exr_context_t file = packing->coder->context;
    exr_result_t result = begin_block(packing, block, &pipeline);
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
    pipeline.yield_until_ready_fn = NULL; /* it would see to the order */
    pipeline.write_fn = keep_block;
    if (!result)
        result = exr_encoding_run(file, 0, &pipeline);
    exr_encoding_destroy(file, &pipeline);
    return result;
}

static void step_of(uint32_t step[2], const struct picture *like)
{
    step[0] = like->tiled ? TILE_SIDE : like->width;
    step[1] = height_of(like);
}

static enum err pack(void *context, const struct picture *rows, uint32_t top, struct buf *out,
                     uint32_t *check, struct fault *fault)
{
    struct exr_coder *coder = context;
    uint32_t step[2];
    step_of(step, rows);
    const size_t pixels = (size_t)least(step[0], rows->width) * rows->height;
    struct packing packing = {.coder = coder, .rows = rows, .top = top, .out = out};
    packing.room = (struct exr_room){mem_array(pixels, 4 * sizeof *packing.room.halves),
                                     mem_array(pixels, sizeof *packing.room.eye)};
    exr_result_t result = packing.room.halves && packing.room.eye
                              ? exr_each_block(rows, step, pack_block, &packing)
                              : EXR_ERR_OUT_OF_MEMORY;
    *check = 0;
    free(packing.room.halves);
    free(packing.room.eye);
    return result ? exr_fault("write", &coder->nowhere, result, fault) : OK;
}

/* ---- the file ---- */

struct copying {
    exr_context_t context;
    bool tiled;
    uint32_t top;
    const char *at, *end; /* of the piece */
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
                                const struct strips *strips, enum err *err, struct fault *fault)
{
    struct copying copying = {.context = context, .tiled = like->tiled};
    struct buf bytes = {0};
    uint32_t step[2];
    exr_result_t result = EXR_ERR_SUCCESS;
    step_of(step, like);
    for (size_t i = 0; i < strips_count(strips) && !*err && !result; i++) {
        const struct picture rows = {.width = like->width, .height = strips_piece(strips, i)->rows};
        *err = strips_read(strips, i, &bytes, fault);
        copying.at = buf_text(&bytes);
        copying.end = copying.at + bytes.length;
        if (!*err)
            result = exr_each_block(&rows, step, copy_block, &copying);
        copying.top += rows.height;
    }
    buf_release(&bytes);
    return result;
}

static enum err write_file(void *coder, const char *draft, const struct picture *like,
                           const struct strips *strips, struct fault *fault)
{
    struct exr_stream stream = {.path = strips_path(strips)};
    const exr_context_initializer_t setup = exr_stream_setup(&stream);
    exr_context_t context;
    enum err err = check_names(stream.path, like, fault);
    if (err)
        return err;
    stream.fd = file_step_open(draft, O_RDWR | O_CREAT | O_EXCL);
    if (stream.fd < 0)
        return fault_errno(fault, "write", stream.path);
    exr_result_t result = exr_start_write(&context, stream.path, EXR_WRITE_FILE_DIRECTLY, &setup);
    if (!result) {
        result = put_header(context, like, ((const struct exr_coder *)coder)->planes);
        if (!result)
            result = copy_pieces(context, like, strips, &err, fault);
        const exr_result_t closed = exr_finish(&context); /* writes the table of chunks */
        result = result ? result : closed;
    }
    if (close(stream.fd) != 0 && !stream.number)
        stream.number = errno;
    if (!err && (result || stream.number))
        err = exr_fault("write", &stream, result, fault);
    return err;
}

const struct strips_format exr_strips = {height_of, begin, pack, write_file, end};

enum err exr_write(const char *path, enum file_mode mode, const struct picture *picture,
                   struct fault *fault)
{
    struct strips *strips;
    enum err err = check_names(path, picture, fault);
    if (!err)
        err =
            strips_begin(&strips, &exr_strips, path, mode, picture, picture_planes(picture), fault);
    if (err)
        return err;
    strips_give_all(strips, picture);
    return strips_end(strips, picture, fault);
}
