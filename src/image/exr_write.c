#include "image/exr.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/mem.h"
#include "image/exr_parts.h"
#include "image/linear.h"

enum {
    NAME_MOST = 255,
    SHORT_NAME_MOST = 31,
    ZIP_LEVEL = 4,
};

static exr_result_t put_attributes(exr_context_t context, const struct picture *picture)
{
    exr_result_t result = EXR_ERR_SUCCESS;
    for (size_t i = 0; i < picture->attributes && !result; i++)
        result = exr_attr_set_string(context, 0, picture->attribute[i].name,
                                     picture->attribute[i].value);
    return result;
}

/* What a file of this kind says, and where it was seen from (OpenEXR's standard attributes). */
static exr_result_t put_kind(exr_context_t context, const struct picture *picture)
{
    exr_attr_m44f_t camera, ndc;
    exr_result_t result = exr_attr_set_string(context, 0, EXR_ALPHA, EXR_ALPHA_VALUE);
    if (result || !picture->space.has_world)
        return result;
    memcpy(camera.m, picture->space.to_camera, sizeof camera.m);
    memcpy(ndc.m, picture->space.to_ndc, sizeof ndc.m);
    result = exr_attr_set_m44f(context, 0, "worldToCamera", &camera);
    return result ? result : exr_attr_set_m44f(context, 0, "worldToNDC", &ndc);
}

static exr_result_t put_header(exr_context_t context, const struct picture *picture)
{
    const exr_attr_box2i_t window = {
        .max = {.x = (int32_t)picture->width - 1, .y = (int32_t)picture->height - 1}};
    const exr_attr_v2f_t centre = {.x = 0, .y = 0};
    const exr_storage_t storage = picture->tiled ? EXR_STORAGE_TILED : EXR_STORAGE_SCANLINE;
    int part;
    exr_result_t result = exr_add_part(context, NULL, storage, &part);
    if (!result)
        result = exr_initialize_required_attr(context, part, &window, &window, 1.0f, &centre, 1.0f,
                                              EXR_LINEORDER_INCREASING_Y, EXR_COMPRESSION_ZIP);
    if (!result && picture->tiled)
        result = exr_set_tile_descriptor(context, part, EXR_TILE_SIDE, EXR_TILE_SIDE,
                                         EXR_TILE_ONE_LEVEL, EXR_TILE_ROUND_DOWN);
    if (!result)
        result = exr_set_zip_compression_level(context, part, ZIP_LEVEL);
    const unsigned kind = picture->is_associated ? EXR_ASSOCIATED : EXR_STRAIGHT;
    for (int i = 0; i < EXR_CHANNELS && !result; i++)
        if (exr_channel[i].kinds & kind && exr_plane_of(picture, exr_channel[i].plane))
            result = exr_add_channel(context, part, exr_channel[i].name, exr_channel[i].type,
                                     EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    if (!result)
        result = put_attributes(context, picture);
    if (!result && picture->is_associated)
        result = put_kind(context, picture);
    if (!result)
        result = exr_write_header(context);
    return result;
}

static void fill_room(const struct exr_room *room, const struct picture *picture,
                      const struct block *block)
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

/* The library's own step, then mended: a block that deflate leaves exactly as long as it was is
 * stored deflated, but every reader takes that length to mean "stored plain" (seen in 3.1.5). */
static exr_result_t compress_block(exr_encode_pipeline_t *pipeline)
{
    exr_result_t (*const *compress)(exr_encode_pipeline_t *) = pipeline->encoding_user_data;
    exr_result_t result = (*compress)(pipeline);
    if (!result && pipeline->compressed_bytes == pipeline->packed_bytes &&
        pipeline->compressed_buffer != pipeline->packed_buffer)
        memcpy(pipeline->compressed_buffer, pipeline->packed_buffer,
               (size_t)pipeline->packed_bytes);
    return result;
}

struct writer {
    exr_context_t context;
    const struct picture *picture;
    exr_encode_pipeline_t pipeline;
    exr_result_t (*compress)(exr_encode_pipeline_t *);
    struct exr_room room; /* of the largest block */
};

static exr_result_t put_block(void *context, const struct block *block)
{
    struct writer *w = context;
    const int x = (int)block->x, y = (int)block->y;
    exr_chunk_info_t chunk;
    const bool first = x == 0 && y == 0;
    exr_encode_pipeline_t *pipeline = &w->pipeline;
    exr_result_t result = w->picture->tiled
                              ? exr_write_tile_chunk_info(w->context, 0, x / EXR_TILE_SIDE,
                                                          y / EXR_TILE_SIDE, 0, 0, &chunk)
                              : exr_write_scanline_chunk_info(w->context, 0, y, &chunk);
    if (!result)
        result = first ? exr_encoding_initialize(w->context, 0, &chunk, pipeline)
                       : exr_encoding_update(w->context, 0, &chunk, pipeline);
    if (result)
        return result;
    fill_room(&w->room, w->picture, block);
    for (int i = 0; i < pipeline->channel_count; i++) {
        const char *name = pipeline->channels[i].channel_name;
        exr_point(&pipeline->channels[i], exr_channel_named(name, w->picture->is_associated),
                  w->picture, block, &w->room);
    }
    if (first) {
        result = exr_encoding_choose_default_routines(w->context, 0, pipeline);
        w->compress = pipeline->compress_fn;
        pipeline->compress_fn = compress_block;
        pipeline->encoding_user_data = &w->compress;
    }
    return result ? result : exr_encoding_run(w->context, 0, pipeline);
}

static exr_result_t put_pixels(exr_context_t context, const struct picture *picture,
                               const uint32_t step[2], const struct exr_room *room)
{
    struct writer w = {.context = context, .picture = picture, .room = *room, .compress = NULL};
    w.pipeline = (exr_encode_pipeline_t)EXR_ENCODE_PIPELINE_INITIALIZER;
    const exr_result_t result = exr_each_block(picture, step, put_block, &w);
    exr_encoding_destroy(context, &w.pipeline);
    return result;
}

static enum err check_names(const char *path, const struct picture *picture, bool *any_long,
                            struct fault *fault)
{
    *any_long = false;
    for (size_t i = 0; i < picture->attributes; i++) {
        size_t length = strlen(picture->attribute[i].name);
        if (length == 0 || length > NAME_MOST || exr_name_is_reserved(picture->attribute[i].name))
            return fault_set(fault, ERR_INPUT,
                             "cannot write %s: \"%.40s\" cannot name a note in OpenEXR", path,
                             picture->attribute[i].name);
        *any_long = *any_long || length > SHORT_NAME_MOST;
    }
    return OK;
}

static exr_result_t write_stream(struct stream *stream, const struct picture *picture,
                                 bool any_long, const uint32_t step[2], const struct exr_room *room)
{
    const exr_context_initializer_t setup = exr_stream_setup(stream);
    exr_context_t context;
    exr_result_t result = exr_start_write(&context, stream->path, EXR_WRITE_FILE_DIRECTLY, &setup);
    if (result)
        return result;
    result = exr_set_longname_support(context, any_long);
    if (!result)
        result = put_header(context, picture);
    if (!result)
        result = put_pixels(context, picture, step, room);
    exr_result_t closed = exr_finish(&context); /* writes the table of chunks */
    return result ? result : closed;
}

static enum err write_draft(const char *draft, const char *path, const struct picture *picture,
                            bool any_long, struct fault *fault)
{
    struct stream stream = {.path = path};
    const uint32_t step[2] = {picture->tiled ? EXR_TILE_SIDE : picture->width,
                              picture->tiled ? EXR_TILE_SIDE : EXR_BLOCK_LINES};
    const size_t pixels = (size_t)step[0] * step[1];
    const struct exr_room room = {mem_array(pixels, 4 * sizeof *room.halves),
                                  mem_array(pixels, sizeof *room.eye)};
    enum err err = room.halves && room.eye ? OK : fault_memory(fault, path);
    if (!err) {
        stream.fd = file_step_open(draft, O_RDWR | O_CREAT | O_EXCL);
        err = stream.fd < 0 ? fault_errno(fault, "write", path) : OK;
    }
    if (!err) {
        exr_result_t result = write_stream(&stream, picture, any_long, step, &room);
        if (close(stream.fd) != 0 && !stream.number)
            stream.number = errno;
        if (result || stream.number) {
            err = exr_library_fault("write", &stream, result, fault);
            file_discard(draft);
        }
    }
    free(room.halves);
    free(room.eye);
    return err;
}

enum err exr_write(const char *path, enum file_mode mode, const struct picture *picture,
                   struct fault *fault)
{
    struct buf draft = {0};
    bool any_long;
    enum err err = check_names(path, picture, &any_long, fault);
    if (!err)
        err = file_draft(&draft, path, mode, fault);
    if (!err)
        err = write_draft(buf_text(&draft), path, picture, any_long, fault);
    if (!err)
        err = file_publish(buf_text(&draft), path, mode, fault);
    buf_release(&draft);
    return err;
}
