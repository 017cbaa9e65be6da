#include "image/exr.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <openexr.h>

#include "base/file.h"
#include "base/least.h"
#include "base/mem.h"
#include "image/linear.h"
#include "image/swelling.h"

enum {
    BLOCK_LINES = 16, /* scan lines that ZIP packs together */
    TILE_SIDE = 64,   /* of the tiles that are written, */
    TILE_MOST = 4096, /* and of those that are read */
    NAME_MOST = 255,
    SHORT_NAME_MOST = 31,
    ZIP_LEVEL = 4,
    ZIP_MOST = 1032,     /* what deflate can make of a byte */
    NOTE_MOST = 1 << 20, /* bytes of one attribute that is read */
};

/* ---- the channels, one table for both ways ---- */

/* Of PLANE_EYE the file alone has pixels: the depth, from the camera on. */
enum plane { PLANE_RGBA, PLANE_DEPTH, PLANE_EYE, PLANE_LABEL, PLANE_VOXEL, PLANE_NORMAL };

/* Files whose colours are as they are, and those in which they are multiplied by alpha. */
enum { STRAIGHT = 1, ASSOCIATED = 2, BOTH = STRAIGHT | ASSOCIATED };

#define ALPHA       "iftty:alpha" /* the attribute that says so */
#define ALPHA_VALUE "associated"

static const struct channel {
    const char *name;
    unsigned kinds; /* of files that have it */
    enum plane plane;
    unsigned index; /* within the plane's pixel */
    exr_pixel_type_t type;
    int bytes;
} channels[] = {
    {"R", BOTH, PLANE_RGBA, 0, EXR_PIXEL_HALF, 2},
    {"G", BOTH, PLANE_RGBA, 1, EXR_PIXEL_HALF, 2},
    {"B", BOTH, PLANE_RGBA, 2, EXR_PIXEL_HALF, 2},
    {"A", BOTH, PLANE_RGBA, 3, EXR_PIXEL_HALF, 2},
    {"Z", STRAIGHT, PLANE_DEPTH, 0, EXR_PIXEL_FLOAT, 4},
    {"Z", ASSOCIATED, PLANE_EYE, 0, EXR_PIXEL_FLOAT, 4},
    {"depth", ASSOCIATED, PLANE_DEPTH, 0, EXR_PIXEL_FLOAT, 4},
    {"label", BOTH, PLANE_LABEL, 0, EXR_PIXEL_UINT, 4},
    {"voxel", BOTH, PLANE_VOXEL, 0, EXR_PIXEL_UINT, 4},
    {"N.X", BOTH, PLANE_NORMAL, 0, EXR_PIXEL_FLOAT, 4},
    {"N.Y", BOTH, PLANE_NORMAL, 1, EXR_PIXEL_FLOAT, 4},
    {"N.Z", BOTH, PLANE_NORMAL, 2, EXR_PIXEL_FLOAT, 4},
};

enum { CHANNELS = sizeof channels / sizeof channels[0] };

/* The channel of a file of that kind, or NULL. */
static const struct channel *channel_named(const char *name, bool is_associated)
{
    const unsigned kind = is_associated ? ASSOCIATED : STRAIGHT;
    for (int i = 0; i < CHANNELS; i++)
        if (channels[i].kinds & kind && strcmp(channels[i].name, name) == 0)
            return &channels[i];
    return NULL;
}

/* The plane of a picture that a channel is made of, or NULL. */
static void *plane_of(const struct picture *picture, enum plane plane)
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

/* The pixels that one block of the file packs: some lines, or a tile. */
struct block {
    uint32_t x, y, width, height;
};

/* What goes by way of memory for a block: RGBA, 4 halves a pixel, and the depth from the camera. */
struct room {
    uint16_t *halves;
    float *eye; /* written only */
};

/* Points the library at a channel's pixels of a block. */
static void point_at(exr_coding_channel_info_t *info, const struct channel *channel,
                     const struct picture *picture, const struct block *block,
                     const struct room *room)
{
    const enum plane plane = channel->plane;
    const bool goes_by_room = plane == PLANE_RGBA || plane == PLANE_EYE;
    const int32_t pixel = plane == PLANE_RGBA ? 8 : plane == PLANE_NORMAL ? 12 : 4;
    const size_t line = (size_t)(goes_by_room ? block->width : picture->width) * (size_t)pixel;
    uint8_t *at = plane == PLANE_RGBA  ? (uint8_t *)room->halves
                  : plane == PLANE_EYE ? (uint8_t *)room->eye
                                       : (uint8_t *)plane_of(picture, plane) + block->y * line +
                                             block->x * (size_t)pixel;
    info->decode_to_ptr = at + channel->index * (size_t)channel->bytes;
    info->user_pixel_stride = pixel;
    info->user_line_stride = (int32_t)line;
    info->user_bytes_per_element = (int16_t)channel->bytes;
    info->user_data_type = (uint16_t)channel->type;
}

/* Calls `each` for the blocks of `step` pixels (lines are as wide as the picture), in the order of
 * the file, until one fails. */
static exr_result_t each_block(const struct picture *picture, const uint32_t step[2],
                               exr_result_t (*each)(void *context, const struct block *block),
                               void *context)
{
    exr_result_t result = EXR_ERR_SUCCESS;
    for (uint32_t y = 0; y < picture->height; y += step[1])
        for (uint32_t x = 0; x < picture->width && !result; x += step[0]) {
            const struct block block = {x, y, least(picture->width - x, step[0]),
                                        least(picture->height - y, step[1])};
            result = each(context, &block);
        }
    return result;
}

/* Names that an OpenEXR header uses itself, where a string would be refused or misread. */
static bool is_reserved(const char *name)
{
    static const char *const reserved[] = {
        "channels",           "chunkCount",         "compression", "dataWindow", "displayWindow",
        "lineOrder",          "maxSamplesPerPixel", "name",        "preview",    "pixelAspectRatio",
        "screenWindowCenter", "screenWindowWidth",  "tiles",       "type",       "version",
        "worldToCamera",      "worldToNDC",         ALPHA,
    };
    for (size_t i = 0; i < sizeof reserved / sizeof reserved[0]; i++)
        if (strcmp(reserved[i], name) == 0)
            return true;
    return false;
}

bool exr_is_named(const char *path)
{
    return file_is_named(path, ".exr|.sxr|.mxr");
}

/* ---- bytes in and out ---- */

/* The library's own file layer neither returns errno nor checks what it opens. */
struct stream {
    int fd;
    uint64_t bytes;
    int number; /* errno of the first failure, or 0 */
    const char *path;
};

static int64_t stream_failed(struct stream *stream)
{
    stream->number = stream->number ? stream->number : errno;
    return -1;
}

static int64_t stream_read(exr_const_context_t context, void *user, void *to, uint64_t length,
                           uint64_t offset, exr_stream_error_func_ptr_t report)
{
    struct stream *stream = user;
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
    struct stream *stream = user;
    (void)context;
    (void)report;
    const bool written = lseek(stream->fd, (off_t)offset, SEEK_SET) >= 0 &&
                         file_step_write(stream->fd, stream->path, from, (size_t)length);
    return written ? (int64_t)length : stream_failed(stream);
}

static int64_t stream_size(exr_const_context_t context, void *user)
{
    (void)context;
    const struct stream *stream = user;
    return (int64_t)stream->bytes;
}

/* The library would print. Its result codes say enough. */
static void stay_silent(exr_const_context_t context, exr_result_t code, const char *words)
{
    (void)context;
    (void)code;
    (void)words;
}

/* Settings of a context on `stream`, for reading or writing. */
static exr_context_initializer_t stream_setup(struct stream *stream)
{
    exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
    setup.error_handler_fn = stay_silent;
    setup.user_data = stream;
    setup.read_fn = stream_read;
    setup.write_fn = stream_write;
    setup.size_fn = stream_size;
    return setup;
}

/* What failed, in words. `what` is "read" or "write". */
static enum err library_fault(const char *what, const struct stream *stream, exr_result_t result,
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

/* ---- writing ---- */

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
        result = exr_set_tile_descriptor(context, part, TILE_SIDE, TILE_SIDE, EXR_TILE_ONE_LEVEL,
                                         EXR_TILE_ROUND_DOWN);
    if (!result)
        result = exr_set_zip_compression_level(context, part, ZIP_LEVEL);
    const unsigned kind = picture->is_associated ? ASSOCIATED : STRAIGHT;
    for (int i = 0; i < CHANNELS && !result; i++)
        if (channels[i].kinds & kind && plane_of(picture, channels[i].plane))
            result = exr_add_channel(context, part, channels[i].name, channels[i].type,
                                     EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    for (size_t i = 0; i < picture->attributes && !result; i++)
        result = exr_attr_set_string(context, part, picture->attribute[i].name,
                                     picture->attribute[i].value);
    if (!result && picture->is_associated)
        result = exr_attr_set_string(context, part, ALPHA, ALPHA_VALUE);
    if (!result && picture->is_associated && picture->space.has_world) { /* standard attributes */
        exr_attr_m44f_t camera, ndc;
        memcpy(camera.m, picture->space.to_camera, sizeof camera.m);
        memcpy(ndc.m, picture->space.to_ndc, sizeof ndc.m);
        result = exr_attr_set_m44f(context, part, "worldToCamera", &camera);
        if (!result)
            result = exr_attr_set_m44f(context, part, "worldToNDC", &ndc);
    }
    if (!result)
        result = exr_write_header(context);
    return result;
}

static void fill_room(const struct room *room, const struct picture *picture,
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
    struct room room; /* of the largest block */
};

static exr_result_t put_block(void *context, const struct block *block)
{
    struct writer *w = context;
    const int x = (int)block->x, y = (int)block->y;
    exr_chunk_info_t chunk;
    const bool first = x == 0 && y == 0;
    exr_encode_pipeline_t *pipeline = &w->pipeline;
    exr_result_t result =
        w->picture->tiled
            ? exr_write_tile_chunk_info(w->context, 0, x / TILE_SIDE, y / TILE_SIDE, 0, 0, &chunk)
            : exr_write_scanline_chunk_info(w->context, 0, y, &chunk);
    if (!result)
        result = first ? exr_encoding_initialize(w->context, 0, &chunk, pipeline)
                       : exr_encoding_update(w->context, 0, &chunk, pipeline);
    if (result)
        return result;
    fill_room(&w->room, w->picture, block);
    for (int i = 0; i < pipeline->channel_count; i++) {
        const char *name = pipeline->channels[i].channel_name;
        point_at(&pipeline->channels[i], channel_named(name, w->picture->is_associated), w->picture,
                 block, &w->room);
    }
    if (first) {
        result = exr_encoding_choose_default_routines(w->context, 0, pipeline);
        w->compress = pipeline->compress_fn;
        pipeline->compress_fn = compress_block;
        pipeline->encoding_user_data = &w->compress;
    }
    return result ? result : exr_encoding_run(w->context, 0, pipeline);
}

static exr_result_t write_stream(struct stream *stream, const struct picture *picture,
                                 bool any_long, const uint32_t step[2], const struct room *room)
{
    const exr_context_initializer_t setup = stream_setup(stream);
    struct writer w = {.picture = picture, .room = *room, .compress = NULL};
    exr_result_t result =
        exr_start_write(&w.context, stream->path, EXR_WRITE_FILE_DIRECTLY, &setup);
    if (result)
        return result;
    result = exr_set_longname_support(w.context, any_long);
    if (!result)
        result = put_header(w.context, picture);
    if (!result) {
        w.pipeline = (exr_encode_pipeline_t)EXR_ENCODE_PIPELINE_INITIALIZER;
        result = each_block(picture, step, put_block, &w);
        exr_encoding_destroy(w.context, &w.pipeline);
    }
    exr_result_t closed = exr_finish(&w.context); /* writes the table of chunks */
    return result ? result : closed;
}

static enum err write_draft(const char *draft, const char *path, const struct picture *picture,
                            bool any_long, struct fault *fault)
{
    struct stream stream = {.path = path};
    const uint32_t step[2] = {picture->tiled ? TILE_SIDE : picture->width,
                              picture->tiled ? TILE_SIDE : BLOCK_LINES};
    const size_t pixels = (size_t)step[0] * step[1];
    const struct room room = {mem_array(pixels, 4 * sizeof *room.halves),
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
            err = library_fault("write", &stream, result, fault);
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
    bool any_long = false;
    for (size_t i = 0; i < picture->attributes; i++) {
        const char *name = picture->attribute[i].name;
        const size_t length = strlen(name);
        if (length == 0 || length > NAME_MOST || is_reserved(name))
            return fault_set(fault, ERR_INPUT,
                             "cannot write %s: \"%.40s\" cannot name a note in OpenEXR", path,
                             name);
        any_long |= length > SHORT_NAME_MOST;
    }
    enum err err = file_draft(&draft, path, mode, fault);
    if (!err)
        err = write_draft(buf_text(&draft), path, picture, any_long, fault);
    if (!err)
        err = file_publish(buf_text(&draft), path, mode, fault);
    buf_release(&draft);
    return err;
}

/* ---- reading ---- */

static const char *const type_name[] = {"uint", "half", "float"};

/* How the pixels are packed: tiles of step[0] x step[1], or blocks of step[1] lines. */
struct form {
    bool tiled;
    uint32_t step[2];
};

/* Whether the file says that its colours are multiplied by alpha. */
static bool is_associated(exr_context_t context)
{
    static const char value[] = ALPHA_VALUE;
    const exr_attribute_t *attribute;
    return exr_get_attribute_by_name(context, 0, ALPHA, &attribute) == EXR_ERR_SUCCESS &&
           attribute->type == EXR_ATTR_STRING && attribute->string->length == sizeof value - 1 &&
           memcmp(attribute->string->str, value, sizeof value - 1) == 0;
}

/* Which of our channels the file has; refuses one of another type or sampling, and a lack of
 * colour. */
static enum err find_channels(bool has[CHANNELS], exr_context_t context, bool associated,
                              size_t *pixel_bytes, struct fault *fault)
{
    const exr_attr_chlist_t *list;
    memset(has, 0, CHANNELS * sizeof *has);
    *pixel_bytes = 0;
    if (exr_get_channels(context, 0, &list) != EXR_ERR_SUCCESS)
        return fault_set(fault, ERR_INPUT, "it has no channels; expected R, G, B and A");
    for (int i = 0; i < list->num_channels; i++) {
        const exr_attr_chlist_entry_t *entry = &list->entries[i];
        const struct channel *channel = channel_named(entry->name.str, associated);
        if (entry->x_sampling != 1 || entry->y_sampling != 1)
            return fault_set(fault, ERR_INPUT, "a channel is sampled %d by %d; expected 1 by 1",
                             entry->x_sampling, entry->y_sampling);
        if ((unsigned)entry->pixel_type >= EXR_PIXEL_LAST_TYPE)
            return fault_set(fault, ERR_INPUT, "a channel is of no known type");
        *pixel_bytes += entry->pixel_type == EXR_PIXEL_HALF ? 2 : 4;
        if (!channel)
            continue;
        if (entry->pixel_type != channel->type)
            return fault_set(fault, ERR_INPUT, "channel %s is %s; expected %s", channel->name,
                             type_name[entry->pixel_type], type_name[channel->type]);
        has[channel - channels] = true;
    }
    for (int i = 0; i < CHANNELS; i++)
        if (!has[i] && channels[i].plane == PLANE_RGBA)
            return fault_set(fault, ERR_INPUT, "it has no channel %s; expected R, G, B and A",
                             channels[i].name);
    return OK;
}

/* Finds whether it is tiled, and in what tiles. */
static enum err check_form(struct form *form, exr_context_t context, struct fault *fault)
{
    int parts = 0;
    exr_storage_t storage;
    exr_compression_t compression;
    exr_tile_level_mode_t level;
    exr_tile_round_mode_t round;
    if (exr_get_count(context, &parts) || parts != 1)
        return fault_set(fault, ERR_INPUT, "it has %d parts; expected one", parts);
    if (exr_get_storage(context, 0, &storage) ||
        (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED))
        return fault_set(fault, ERR_INPUT, "it is deep; expected scan lines or tiles");
    if (exr_get_compression(context, 0, &compression) ||
        (compression != EXR_COMPRESSION_NONE && compression != EXR_COMPRESSION_ZIPS &&
         compression != EXR_COMPRESSION_ZIP))
        return fault_set(fault, ERR_INPUT, "its compression is not the ZIP that iftty writes");
    form->tiled = storage == EXR_STORAGE_TILED;
    if (form->tiled &&
        (exr_get_tile_descriptor(context, 0, &form->step[0], &form->step[1], &level, &round) ||
         level != EXR_TILE_ONE_LEVEL || form->step[0] < 1 || form->step[1] < 1 ||
         form->step[0] > TILE_MOST || form->step[1] > TILE_MOST))
        return fault_set(fault, ERR_INPUT, "its tiles have several levels, or sides beyond %d",
                         TILE_MOST);
    return OK;
}

/* Width and height, that they are within limits, and that so small a file can hold them. */
static enum err find_window(exr_context_t context, exr_attr_box2i_t *window, size_t pixel_bytes,
                            uint64_t file_bytes, struct fault *fault)
{
    if (exr_get_data_window(context, 0, window))
        return fault_set(fault, ERR_INPUT, "it has no data window");
    const int64_t width = (int64_t)window->max.x - window->min.x + 1;
    const int64_t height = (int64_t)window->max.y - window->min.y + 1;
    if (width < 1 || height < 1 || width > PICTURE_SIDE_MOST || height > PICTURE_SIDE_MOST)
        return fault_set(fault, ERR_LIMIT,
                         "it is %" PRId64 "x%" PRId64 " pixels; expected 1 to %d a side", width,
                         height, PICTURE_SIDE_MOST);
    if ((uint64_t)width * (uint64_t)height * pixel_bytes / ZIP_MOST > file_bytes)
        return fault_set(fault, ERR_INPUT,
                         "cut short: %" PRIu64 " bytes cannot hold %" PRId64 "x%" PRId64 " pixels",
                         file_bytes, width, height);
    if (swelling_needs_yes((uint64_t)width * (uint64_t)height * pixel_bytes,
                           (uint64_t)width * (uint64_t)height, file_bytes))
        return fault_set(fault, ERR_LIMIT,
                         "%" PRIu64 " bytes claim %" PRId64 "x%" PRId64 " pixels; so large a "
                         "picture takes a byte for each %d of them",
                         file_bytes, width, height, SWELLING_MOST);
    return OK;
}

static enum err make_planes(struct picture *out, const exr_attr_box2i_t *window,
                            const bool has[CHANNELS], struct fault *fault)
{
    uint32_t width = (uint32_t)(window->max.x - window->min.x + 1);
    uint32_t height = (uint32_t)(window->max.y - window->min.y + 1);
    size_t pixels = (size_t)width * height;
    enum err err = picture_init(out, width, height, false, fault);
    bool fine = true;
    for (int i = 0; i < CHANNELS && !err; i++) {
        const enum plane plane = channels[i].plane;
        if (!has[i] || plane == PLANE_RGBA || plane == PLANE_EYE)
            continue;
        if (!plane_of(out, plane)) { /* the first channel of it */
            void *memory = calloc(pixels * (plane == PLANE_NORMAL ? 3 : 1), 4);
            if (plane == PLANE_DEPTH)
                out->depth_mm = memory;
            else if (plane == PLANE_LABEL)
                out->label = memory;
            else if (plane == PLANE_VOXEL)
                out->voxel = memory;
            else
                out->normal = memory;
        }
        fine = fine && plane_of(out, plane);
    }
    return err || fine ? err : fault_memory(fault, "a picture");
}

static enum err get_attributes(struct picture *out, exr_context_t context, struct fault *fault)
{
    int32_t count = 0;
    enum err err = OK;
    exr_get_attribute_count(context, 0, &count);
    for (int32_t i = 0; i < count && !err; i++) {
        const exr_attribute_t *attribute;
        if (exr_get_attribute_by_index(context, 0, EXR_ATTR_LIST_FILE_ORDER, i, &attribute) ||
            attribute->type != EXR_ATTR_STRING || is_reserved(attribute->name))
            continue;
        const exr_attr_string_t *string = attribute->string;
        if (string->length < 0 || string->length > NOTE_MOST)
            return fault_set(fault, ERR_LIMIT, "a note of %d bytes; expected at most %d",
                             string->length, NOTE_MOST);
        char *value = mem_array((size_t)string->length + 1, 1);
        if (!value)
            return fault_memory(fault, "a note on a picture");
        memcpy(value, string->length ? string->str : "", (size_t)string->length);
        value[string->length] = '\0';
        err = picture_note(out, attribute->name, value, fault);
        free(value);
    }
    return err;
}

struct reader {
    exr_context_t context;
    struct picture *out;
    struct form form;
    exr_attr_box2i_t window;
    exr_decode_pipeline_t pipeline;
    bool begun;
    struct room room;               /* of the largest block */
    uint8_t level[2][HALF_ONE + 1]; /* of colours, of alpha */
};

static void take_halves(struct reader *r, const struct block *block)
{
    const uint16_t *half = r->room.halves;
    for (uint32_t y = block->y; y < block->y + block->height; y++) {
        uint8_t *rgba = r->out->rgba + 4 * ((size_t)y * r->out->width + block->x);
        for (uint32_t x = 0; x < block->width; x++, rgba += 4, half += 4) {
            rgba[3] = linear_level(r->level[1], half[3]);
            const bool divides = r->out->is_associated && rgba[3] < 255;
            for (int k = 0; k < 3; k++)
                rgba[k] = divides ? linear_straight(half[k], rgba[3])
                                  : linear_level(r->level[0], half[k]);
        }
    }
}

static exr_result_t get_block(void *context, const struct block *block)
{
    struct reader *r = context;
    exr_decode_pipeline_t *pipeline = &r->pipeline;
    exr_chunk_info_t chunk;
    const uint32_t *step = r->form.step;
    const int32_t top = r->window.min.y + (int32_t)block->y;
    exr_result_t result = r->form.tiled
                              ? exr_read_tile_chunk_info(r->context, 0, (int)(block->x / step[0]),
                                                         (int)(block->y / step[1]), 0, 0, &chunk)
                              : exr_read_scanline_chunk_info(r->context, 0, top, &chunk);
    if (!result &&
        (chunk.height != (int32_t)block->height || chunk.width != (int32_t)block->width ||
         (!r->form.tiled && chunk.start_y != top)))
        result = EXR_ERR_BAD_CHUNK_LEADER; /* of another place or size than it has */
    if (!result)
        result = r->begun ? exr_decoding_update(r->context, 0, &chunk, pipeline)
                          : exr_decoding_initialize(r->context, 0, &chunk, pipeline);
    if (result)
        return result;
    for (int i = 0; i < pipeline->channel_count; i++) {
        const struct channel *channel =
            channel_named(pipeline->channels[i].channel_name, r->out->is_associated);
        if (channel && channel->plane != PLANE_EYE)
            point_at(&pipeline->channels[i], channel, r->out, block, &r->room);
    }
    if (!r->begun)
        result = exr_decoding_choose_default_routines(r->context, 0, pipeline);
    r->begun = true;
    if (!result)
        result = exr_decoding_run(r->context, 0, pipeline);
    if (!result)
        take_halves(r, block);
    return result;
}

static enum err get_pixels(struct reader *r, const struct stream *stream, struct fault *fault)
{
    uint16_t alpha[256];
    uint32_t *step = r->form.step;
    int32_t lines = 0;
    if (!r->form.tiled) {
        if (exr_get_scanlines_per_chunk(r->context, 0, &lines) || lines < 1 || lines > BLOCK_LINES)
            return library_fault("read", stream, EXR_ERR_INVALID_ATTR, fault);
        step[0] = r->out->width;
        step[1] = (uint32_t)lines;
    }
    r->room.halves = calloc((size_t)least(r->out->width, step[0]) * least(r->out->height, step[1]),
                            4 * sizeof *r->room.halves);
    if (!r->room.halves)
        return fault_memory(fault, stream->path);
    linear_alpha(alpha);
    linear_invert(r->level[0], linear_half);
    linear_invert(r->level[1], alpha);
    r->pipeline = (exr_decode_pipeline_t)EXR_DECODE_PIPELINE_INITIALIZER;
    const exr_result_t result = each_block(r->out, r->form.step, get_block, r);
    exr_decoding_destroy(r->context, &r->pipeline);
    free(r->room.halves);
    return result ? library_fault("read", stream, result, fault) : OK;
}

static enum err read_context(struct picture *out, exr_context_t context,
                             const struct stream *stream, struct fault *fault)
{
    struct reader *r = calloc(1, sizeof *r); /* tables of 30 kB */
    bool has[CHANNELS];
    size_t pixel_bytes;
    if (!r)
        return fault_memory(fault, stream->path);
    r->context = context;
    r->out = out;
    enum err err = check_form(&r->form, context, fault);
    const bool associated = is_associated(context);
    if (!err)
        err = find_channels(has, context, associated, &pixel_bytes, fault);
    if (!err)
        err = find_window(context, &r->window, pixel_bytes, stream->bytes, fault);
    if (!err)
        err = make_planes(out, &r->window, has, fault);
    if (!err)
        err = get_attributes(out, context, fault);
    out->tiled = r->form.tiled;
    out->is_associated = associated;
    if (err)
        fault_prefix(fault, err, "%s", stream->path);
    else
        err = get_pixels(r, stream, fault);
    free(r);
    return err;
}

enum err exr_read(struct picture *out, const char *path, struct fault *fault)
{
    struct stream stream = {.path = path};
    exr_context_initializer_t setup = stream_setup(&stream);
    exr_context_t context;
    *out = (struct picture){0};
    enum err err = file_open(&stream.fd, &stream.bytes, path, O_RDONLY, fault);
    if (err)
        return err;
    setup.max_image_width = setup.max_image_height = PICTURE_SIDE_MOST;
    setup.flags =
        EXR_CONTEXT_FLAG_SILENT_HEADER_PARSE | EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    exr_result_t result = exr_start_read(&context, path, &setup);
    if (result) {
        err = library_fault("read", &stream, result, fault);
    } else {
        err = read_context(out, context, &stream, fault);
        exr_finish(&context);
    }
    close(stream.fd);
    if (err)
        picture_release(out);
    return err;
}
