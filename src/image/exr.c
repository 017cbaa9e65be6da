#include "image/exr.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <openexr.h>

#include "base/mem.h"
#include "image/linear.h"

enum {
    SIDE_MOST = 16384,
    NAME_MOST = 255,
    SHORT_NAME_MOST = 31,
    ZIP_MOST = 1032,     /* what deflate can make of a byte */
    NOTE_MOST = 1 << 20, /* bytes of one attribute that is read */
    CHUNK_ROWS = 16,     /* scan lines that ZIP packs together */
    ZIP_LEVEL = 4,
};

/* ---- the channels, one table for both ways ---- */

enum plane { PLANE_RGBA, PLANE_DEPTH, PLANE_LABEL, PLANE_VOXEL };

static const struct channel {
    const char *name;
    enum plane plane;
    unsigned index; /* within rgba */
    exr_pixel_type_t type;
    int bytes;
} channels[] = {
    {"R", PLANE_RGBA, 0, EXR_PIXEL_HALF, 2},      {"G", PLANE_RGBA, 1, EXR_PIXEL_HALF, 2},
    {"B", PLANE_RGBA, 2, EXR_PIXEL_HALF, 2},      {"A", PLANE_RGBA, 3, EXR_PIXEL_HALF, 2},
    {"Z", PLANE_DEPTH, 0, EXR_PIXEL_FLOAT, 4},    {"label", PLANE_LABEL, 0, EXR_PIXEL_UINT, 4},
    {"voxel", PLANE_VOXEL, 0, EXR_PIXEL_UINT, 4},
};
enum { CHANNELS = sizeof channels / sizeof channels[0] };

static const char *const type_name[] = {"uint", "half", "float"};

static const struct channel *channel_named(const char *name)
{
    for (int i = 0; i < CHANNELS; i++)
        if (strcmp(channels[i].name, name) == 0)
            return &channels[i];
    return NULL;
}

static void *plane_of(const struct picture *picture, enum plane plane)
{
    switch (plane) {
    case PLANE_RGBA:
        return picture->rgba;
    case PLANE_DEPTH:
        return picture->depth_mm;
    case PLANE_LABEL:
        return picture->label;
    case PLANE_VOXEL:
        return picture->voxel;
    }
    return NULL;
}

/* Points the library at the rows from `y` of a channel's plane; RGBA goes by way of `halves`. */
static void point(exr_coding_channel_info_t *info, const struct channel *channel,
                  const struct picture *picture, uint32_t y, uint16_t *halves)
{
    const int32_t pixel = channel->plane == PLANE_RGBA ? 8 : 4;
    const size_t row = (size_t)picture->width * (size_t)pixel;
    uint8_t *at = channel->plane == PLANE_RGBA
                      ? (uint8_t *)(halves + channel->index)
                      : (uint8_t *)plane_of(picture, channel->plane) + y * row;
    info->decode_to_ptr = at;
    info->user_pixel_stride = pixel;
    info->user_line_stride = (int32_t)row;
    info->user_bytes_per_element = (int16_t)channel->bytes;
    info->user_data_type = (uint16_t)channel->type;
}

/* ---- bytes in and out; the library's own file layer neither keeps errno nor checks what it
 *      opens ---- */

struct stream {
    int fd;
    int64_t bytes;
    int number; /* errno of the first failure, or 0 */
    const char *path;
};

static struct stream *stream_of(void *user)
{
    return user;
}

static int64_t stream_read(exr_const_context_t context, void *user, void *to, uint64_t length,
                           uint64_t offset, exr_stream_error_func_ptr_t report)
{
    struct stream *stream = stream_of(user);
    uint64_t done = 0;
    (void)context;
    (void)report;
    if (offset > (uint64_t)stream->bytes)
        return 0;
    while (done < length) {
        ssize_t n = pread(stream->fd, (uint8_t *)to + done, length - done, (off_t)(offset + done));
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0) {
            stream->number = stream->number ? stream->number : errno;
            return -1;
        }
        if (n == 0)
            break;
        done += (uint64_t)n;
    }
    return (int64_t)done;
}

static int64_t stream_write(exr_const_context_t context, void *user, const void *from,
                            uint64_t length, uint64_t offset, exr_stream_error_func_ptr_t report)
{
    struct stream *stream = stream_of(user);
    uint64_t done = 0;
    (void)context;
    (void)report;
    while (done < length) {
        int number = file_step_hook ? file_step_hook(FILE_STEP_WRITE, stream->path) : 0;
        ssize_t n = number ? (errno = number, -1)
                           : pwrite(stream->fd, (const uint8_t *)from + done, length - done,
                                    (off_t)(offset + done));
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0) {
            stream->number = stream->number ? stream->number : errno;
            return -1;
        }
        done += (uint64_t)n;
    }
    return (int64_t)done;
}

static int64_t stream_size(exr_const_context_t context, void *user)
{
    (void)context;
    return stream_of(user)->bytes;
}

/* The library would print. Its result codes say enough. */
static void stay_silent(exr_const_context_t context, exr_result_t code, const char *words)
{
    (void)context;
    (void)code;
    (void)words;
}

/* ---- writing ---- */

static enum err library_fault(const char *what, const char *path, const struct stream *stream,
                              exr_result_t result, struct fault *fault)
{
    if (stream->number) {
        errno = stream->number;
        return fault_errno(fault, what, path);
    }
    if (result == EXR_ERR_OUT_OF_MEMORY)
        return fault_memory(fault, path);
    return fault_set(fault, ERR_INPUT, "cannot %s %s: OpenEXR says: %s", what, path,
                     exr_get_default_error_message(result));
}

static exr_result_t put_attributes(exr_context_t context, const struct picture *picture)
{
    exr_result_t result = EXR_ERR_SUCCESS;
    for (size_t i = 0; i < picture->attributes && !result; i++)
        result = exr_attr_set_string(context, 0, picture->attribute[i].name,
                                     picture->attribute[i].value);
    return result;
}

static exr_result_t put_header(exr_context_t context, const struct picture *picture)
{
    const exr_attr_box2i_t window = {
        .max = {.x = (int32_t)picture->width - 1, .y = (int32_t)picture->height - 1}};
    const exr_attr_v2f_t centre = {.x = 0, .y = 0};
    int part;
    exr_result_t result = exr_add_part(context, NULL, EXR_STORAGE_SCANLINE, &part);
    if (!result)
        result = exr_initialize_required_attr(context, part, &window, &window, 1.0f, &centre, 1.0f,
                                              EXR_LINEORDER_INCREASING_Y, EXR_COMPRESSION_ZIP);
    if (!result)
        result = exr_set_zip_compression_level(context, part, ZIP_LEVEL);
    for (int i = 0; i < CHANNELS && !result; i++)
        if (plane_of(picture, channels[i].plane))
            result = exr_add_channel(context, part, channels[i].name, channels[i].type,
                                     EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    if (!result)
        result = put_attributes(context, picture);
    if (!result)
        result = exr_write_header(context);
    return result;
}

static void fill_halves(uint16_t *halves, const struct picture *picture, uint32_t y, uint32_t rows)
{
    const size_t pixels = (size_t)rows * picture->width;
    const uint8_t *rgba = picture->rgba + 4 * (size_t)y * picture->width;
    uint16_t alpha[256];
    linear_alpha(alpha);
    for (size_t i = 0; i < pixels; i++) {
        for (size_t c = 0; c < 3; c++)
            halves[4 * i + c] = linear_half[rgba[4 * i + c]];
        halves[4 * i + 3] = alpha[rgba[4 * i + 3]];
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
        memcpy(pipeline->compressed_buffer, pipeline->packed_buffer, pipeline->packed_bytes);
    return result;
}

static exr_result_t put_rows(exr_context_t context, const struct picture *picture, uint16_t *halves)
{
    exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
    exr_result_t (*compress)(exr_encode_pipeline_t *) = NULL;
    exr_result_t result = EXR_ERR_SUCCESS;
    for (uint32_t y = 0; y < picture->height && !result; y += CHUNK_ROWS) {
        const uint32_t left = picture->height - y;
        exr_chunk_info_t chunk;
        result = exr_write_scanline_chunk_info(context, 0, (int)y, &chunk);
        if (!result)
            result = y == 0 ? exr_encoding_initialize(context, 0, &chunk, &pipeline)
                            : exr_encoding_update(context, 0, &chunk, &pipeline);
        if (result)
            break;
        fill_halves(halves, picture, y, left < CHUNK_ROWS ? left : CHUNK_ROWS);
        for (int i = 0; i < pipeline.channel_count; i++)
            point(&pipeline.channels[i], channel_named(pipeline.channels[i].channel_name), picture,
                  y, halves);
        if (y == 0) {
            result = exr_encoding_choose_default_routines(context, 0, &pipeline);
            compress = pipeline.compress_fn;
            pipeline.compress_fn = compress_block;
            pipeline.encoding_user_data = &compress;
        }
        if (!result)
            result = exr_encoding_run(context, 0, &pipeline);
    }
    exr_encoding_destroy(context, &pipeline);
    return result;
}

/* Names that an OpenEXR header uses itself, where a string would be refused or misread. */
static bool is_reserved(const char *name)
{
    static const char *const reserved[] = {
        "channels",           "chunkCount",         "compression", "dataWindow", "displayWindow",
        "lineOrder",          "maxSamplesPerPixel", "name",        "preview",    "pixelAspectRatio",
        "screenWindowCenter", "screenWindowWidth",  "tiles",       "type",       "version",
    };
    for (size_t i = 0; i < sizeof reserved / sizeof reserved[0]; i++)
        if (strcmp(reserved[i], name) == 0)
            return true;
    return false;
}

static enum err check_names(const char *path, const struct picture *picture, bool *any_long,
                            struct fault *fault)
{
    *any_long = false;
    for (size_t i = 0; i < picture->attributes; i++) {
        size_t length = strlen(picture->attribute[i].name);
        if (length == 0 || length > NAME_MOST || is_reserved(picture->attribute[i].name))
            return fault_set(fault, ERR_INPUT,
                             "cannot write %s: \"%.40s\" cannot name a note in OpenEXR", path,
                             picture->attribute[i].name);
        *any_long = *any_long || length > SHORT_NAME_MOST;
    }
    return OK;
}

static exr_result_t write_stream(struct stream *stream, const struct picture *picture,
                                 bool any_long, uint16_t *halves)
{
    exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
    exr_context_t context;
    setup.error_handler_fn = stay_silent;
    setup.user_data = stream;
    setup.write_fn = stream_write;
    exr_result_t result = exr_start_write(&context, stream->path, EXR_WRITE_FILE_DIRECTLY, &setup);
    if (result)
        return result;
    result = exr_set_longname_support(context, any_long);
    if (!result)
        result = put_header(context, picture);
    if (!result)
        result = put_rows(context, picture, halves);
    exr_result_t closed = exr_finish(&context); /* writes the table of chunks */
    return result ? result : closed;
}

static enum err write_draft(const char *draft, const char *path, const struct picture *picture,
                            bool any_long, struct fault *fault)
{
    struct stream stream = {.path = path};
    uint16_t *halves = mem_array((size_t)picture->width * CHUNK_ROWS * 4, sizeof *halves);
    if (!halves)
        return fault_memory(fault, path);
    int number = file_step_hook ? file_step_hook(FILE_STEP_OPEN, path) : 0;
    stream.fd =
        number ? (errno = number, -1) : open(draft, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    enum err err = stream.fd < 0 ? fault_errno(fault, "write", path) : OK;
    if (!err) {
        exr_result_t result = write_stream(&stream, picture, any_long, halves);
        if (close(stream.fd) != 0 && !stream.number)
            stream.number = errno;
        if (result || stream.number) {
            err = library_fault("write", path, &stream, result, fault);
            file_discard(draft);
        }
    }
    free(halves);
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

/* ---- reading ---- */

/* Which of our channels the file has; refuses one of another type or sampling, and a lack of
 * colour. */
static enum err find_channels(bool has[CHANNELS], exr_context_t context, size_t *pixel_bytes,
                              struct fault *fault)
{
    const exr_attr_chlist_t *list;
    memset(has, 0, CHANNELS * sizeof *has);
    *pixel_bytes = 0;
    if (exr_get_channels(context, 0, &list) != EXR_ERR_SUCCESS)
        return fault_set(fault, ERR_INPUT, "it has no channels; expected R, G, B and A");
    for (int i = 0; i < list->num_channels; i++) {
        const exr_attr_chlist_entry_t *entry = &list->entries[i];
        const struct channel *channel = channel_named(entry->name.str);
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

static enum err check_form(exr_context_t context, struct fault *fault)
{
    int parts = 0;
    exr_storage_t storage;
    exr_compression_t compression;
    if (exr_get_count(context, &parts) || parts != 1)
        return fault_set(fault, ERR_INPUT, "it has %d parts; expected one", parts);
    if (exr_get_storage(context, 0, &storage) || storage != EXR_STORAGE_SCANLINE)
        return fault_set(fault, ERR_INPUT, "it is tiled or deep; expected scan lines");
    if (exr_get_compression(context, 0, &compression) ||
        (compression != EXR_COMPRESSION_NONE && compression != EXR_COMPRESSION_ZIPS &&
         compression != EXR_COMPRESSION_ZIP))
        return fault_set(fault, ERR_INPUT, "its compression is not the ZIP that iftty writes");
    return OK;
}

/* Width and height, that they are within limits, and that so small a file can hold them. */
static enum err find_window(exr_context_t context, exr_attr_box2i_t *window, size_t pixel_bytes,
                            int64_t file_bytes, struct fault *fault)
{
    if (exr_get_data_window(context, 0, window))
        return fault_set(fault, ERR_INPUT, "it has no data window");
    const int64_t width = (int64_t)window->max.x - window->min.x + 1;
    const int64_t height = (int64_t)window->max.y - window->min.y + 1;
    if (width < 1 || height < 1 || width > SIDE_MOST || height > SIDE_MOST)
        return fault_set(fault, ERR_LIMIT,
                         "it is %" PRId64 "x%" PRId64 " pixels; expected 1 to %d a side", width,
                         height, SIDE_MOST);
    if ((uint64_t)width * (uint64_t)height * pixel_bytes / ZIP_MOST > (uint64_t)file_bytes)
        return fault_set(fault, ERR_INPUT,
                         "cut short: %" PRId64 " bytes cannot hold %" PRId64 "x%" PRId64 " pixels",
                         file_bytes, width, height);
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
        if (!has[i] || channels[i].plane == PLANE_RGBA)
            continue;
        void *plane = calloc(pixels, 4);
        fine = fine && plane;
        if (channels[i].plane == PLANE_DEPTH)
            out->depth_mm = plane;
        else if (channels[i].plane == PLANE_LABEL)
            out->label = plane;
        else
            out->voxel = plane;
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

static exr_result_t get_rows(struct picture *out, exr_context_t context, int32_t top,
                             uint16_t *halves)
{
    exr_decode_pipeline_t pipeline = EXR_DECODE_PIPELINE_INITIALIZER;
    uint8_t level[2][HALF_ONE + 1];
    uint16_t alpha[256];
    int32_t step = 0;
    bool begun = false;
    linear_alpha(alpha);
    linear_invert(level[0], linear_half);
    linear_invert(level[1], alpha);
    exr_result_t result = exr_get_scanlines_per_chunk(context, 0, &step);
    if (!result && (step < 1 || step > CHUNK_ROWS))
        result = EXR_ERR_INVALID_ATTR;
    for (uint32_t y = 0; y < out->height && !result; y += (uint32_t)step) {
        exr_chunk_info_t chunk;
        const uint32_t left = out->height - y;
        const uint32_t rows = left < (uint32_t)step ? left : (uint32_t)step;
        result = exr_read_scanline_chunk_info(context, 0, top + (int32_t)y, &chunk);
        if (!result && (chunk.start_y != top + (int32_t)y || chunk.height != (int32_t)rows ||
                        chunk.width != (int32_t)out->width))
            result = EXR_ERR_BAD_CHUNK_LEADER;
        if (!result)
            result = begun ? exr_decoding_update(context, 0, &chunk, &pipeline)
                           : exr_decoding_initialize(context, 0, &chunk, &pipeline);
        if (result)
            break;
        for (int i = 0; i < pipeline.channel_count; i++) {
            const struct channel *channel = channel_named(pipeline.channels[i].channel_name);
            if (channel)
                point(&pipeline.channels[i], channel, out, y, halves);
        }
        if (!begun)
            result = exr_decoding_choose_default_routines(context, 0, &pipeline);
        begun = true;
        if (!result)
            result = exr_decoding_run(context, 0, &pipeline);
        uint8_t *rgba = out->rgba + 4 * (size_t)y * out->width;
        for (size_t i = 0; i < 4 * (size_t)rows * out->width && !result; i++)
            rgba[i] = linear_level(level[i % 4 == 3], halves[i]);
    }
    exr_decoding_destroy(context, &pipeline);
    return result;
}

static enum err read_context(struct picture *out, exr_context_t context,
                             const struct stream *stream, struct fault *fault)
{
    exr_attr_box2i_t window;
    bool has[CHANNELS];
    size_t pixel_bytes;
    enum err err = check_form(context, fault);
    if (!err)
        err = find_channels(has, context, &pixel_bytes, fault);
    if (!err)
        err = find_window(context, &window, pixel_bytes, stream->bytes, fault);
    if (!err)
        err = make_planes(out, &window, has, fault);
    if (!err)
        err = get_attributes(out, context, fault);
    if (err)
        return fault_prefix(fault, err, "%s", stream->path);
    uint16_t *halves = calloc((size_t)out->width * CHUNK_ROWS * 4, sizeof *halves);
    if (!halves)
        return fault_memory(fault, stream->path);
    exr_result_t result = get_rows(out, context, window.min.y, halves);
    free(halves);
    return result ? library_fault("read", stream->path, stream, result, fault) : OK;
}

enum err exr_read(struct picture *out, const char *path, struct fault *fault)
{
    struct stream stream = {.path = path};
    struct stat status;
    exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
    exr_context_t context;
    enum err err = OK;
    *out = (struct picture){0};
    stream.fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (stream.fd < 0)
        return fault_errno(fault, "open", path);
    if (fstat(stream.fd, &status) != 0 || !S_ISREG(status.st_mode)) {
        close(stream.fd);
        return fault_set(fault, ERR_INPUT, "%s is not a regular file", path);
    }
    stream.bytes = status.st_size;
    setup.error_handler_fn = stay_silent;
    setup.user_data = &stream;
    setup.read_fn = stream_read;
    setup.size_fn = stream_size;
    setup.max_image_width = setup.max_image_height = SIDE_MOST;
    setup.flags =
        EXR_CONTEXT_FLAG_SILENT_HEADER_PARSE | EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    exr_result_t result = exr_start_read(&context, path, &setup);
    if (result) {
        err = library_fault("read", path, &stream, result, fault);
    } else {
        err = read_context(out, context, &stream, fault);
        exr_finish(&context);
    }
    close(stream.fd);
    if (err)
        picture_release(out);
    return err;
}
