/* SPDX-License-Identifier: MIT */
#include "image/exr.h"

#include <fcntl.h>
#include <inttypes.h>
#include <libdeflate.h>
#include <openexr.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/least.h"
#include "base/mem.h"
#include "base/scan.h"
#include "base/watch.h"
#include "image/exr_write.h"
#include "image/linear.h"
#include "image/reader_common.h"

enum { BEFORE = 8, FIRST_READ = 1 << 14, LONG_NAMES = 0x400, WINDOW = 16, ATTRIBUTES_MOST = 200 };

/* ---- reading ---- */

bool exr_header_next(const struct buf *header, size_t *at, struct exr_attribute_bytes *out)
{
    *at = *at < BEFORE ? BEFORE : *at;
    const char *name = header->data + *at, *end = header->data + header->length;
    if (*at >= header->length || !*name)
        return false;
    const char *type = memchr(name, 0, (size_t)(end - name));
    const char *size = type ? memchr(type + 1, 0, (size_t)(end - type) - 1) : NULL;
    if (!size || end - size < 5)
        return false;
    const size_t length = bits_get(size + 1, 4, false);
    if (length > (size_t)(end - size) - 5)
        return false;
    *out = (struct exr_attribute_bytes){name, type + 1, size + 5, length};
    *at = (size_t)(size + 5 - header->data) + length;
    return true;
}

/* Cut the bytes after the header; false if its end is not among the bytes. */
static bool cut_header(struct buf *header)
{
    struct exr_attribute_bytes attribute;
    size_t at = 0;
    while (exr_header_next(header, &at, &attribute))
        ;
    if (at < BEFORE || at >= header->length || header->data[at])
        return false;
    header->length = at + 1;
    return true;
}

enum err exr_header_read(struct buf *bytes, int fd, struct fault *fault)
{
    static const char magic[] = {0x76, 0x2f, 0x31, 0x01, 2};
    for (size_t length = FIRST_READ; length <= EXR_HEADER_MOST; length *= 2) {
        buf_clear(bytes);
        char *to = buf_reserve(bytes, length);
        const ssize_t n = to ? file_read_at(fd, to, length, 0) : 0;
        if (!to)
            return fault_memory(fault, "a header");
        if (n < 0)
            return fault_errno(fault, "read", "a header");
        bytes->length = (size_t)n;
        if (n < BEFORE || memcmp(to, magic, sizeof magic) != 0)
            return fault_set(fault, ERR_INPUT, "it is no OpenEXR file");
        if (cut_header(bytes))
            return OK;
        if ((size_t)n < length)
            return fault_set(fault, ERR_INPUT, "its header is cut short");
    }
    return fault_set(fault, ERR_INPUT, "its header has more than %d bytes", EXR_HEADER_MOST);
}

/* ---- comparing ---- */

static bool find_attribute(const struct buf *header, const char *name,
                           struct exr_attribute_bytes *out)
{
    size_t at = 0;
    while (exr_header_next(header, &at, out))
        if (strcmp(out->name, name) == 0)
            return true;
    return false;
}

/* Check that each attribute of `a` except notes is in `b`, once and with the same bytes. */
static enum err compare_attributes(const struct buf *a, const struct buf *b, const char *what,
                                   struct fault *fault)
{
    struct exr_attribute_bytes one, other;
    size_t at = 0, count = 0;
    while (exr_header_next(a, &at, &one)) {
        if (++count > ATTRIBUTES_MOST)
            return fault_set(fault, ERR_CHECK, "it has more than %d attributes", ATTRIBUTES_MOST);
        bool is_twice = false;
        for (size_t rest = at; !is_twice && exr_header_next(a, &rest, &other);)
            is_twice = strcmp(other.name, one.name) == 0;
        /* Bytes after a NUL would not belong to the note that is compared. */
        const bool is_note = strcmp(one.type, "string") == 0 && !exr_is_reserved(one.name) &&
                             !memchr(one.value, 0, one.length);
        if (!is_twice &&
            (is_note ||
             (find_attribute(b, one.name, &other) && strcmp(one.type, other.type) == 0 &&
              one.length == other.length && memcmp(one.value, other.value, one.length) == 0)))
            continue;
        OWNED(buf_release) struct buf name = {0};
        buf_add_safe_excerpt(&name, one.name, strlen(one.name));
        return fault_set(fault, ERR_CHECK, what, is_twice ? "two attributes" : "an attribute",
                         buf_text(&name));
    }
    return OK;
}

/* Check that the header is that of `like` as iftty writes it, without the notes: the same size,
 * channels, windows and every other attribute. ERR_CHECK with the first difference. */
static enum err check_header(const struct buf *header, const struct picture *like,
                             struct fault *fault)
{
    struct exr_attribute_bytes window;
    OWNED(buf_release) struct buf expected = {0};
    int64_t side[2] = {0, 0};
    if (find_attribute(header, "dataWindow", &window) && window.length == WINDOW)
        for (size_t d = 0; d < 2; d++)
            side[d] = (int64_t)(int32_t)bits_get(window.value + 8 + 4 * d, 4, false) -
                      (int32_t)bits_get(window.value + 4 * d, 4, false) + 1;
    if (side[0] != like->width || side[1] != like->height)
        return fault_set(fault, ERR_CHECK,
                         "the sizes differ: it is %lldx%lld pixels, and %ux%u are drawn",
                         (long long)side[0], (long long)side[1], like->width, like->height);
    TRY(exr_write_header_of(&expected, like, fault));
    if (!cut_header(&expected))
        return fault_memory(fault, "a header");
    if ((bits_get(header->data + 4, 4, false) ^ bits_get(expected.data + 4, 4, false)) &
        ~(uint64_t)LONG_NAMES)
        return fault_set(fault, ERR_CHECK, "it has several parts, or is of another kind");
    TRY(compare_attributes(header, &expected, "it has %s %s that iftty does not write there",
                           fault));
    return compare_attributes(&expected, header, "it lacks %s %s, or has it otherwise", fault);
}

enum {
    LINES_MOST = 16,     /* that ZIP packs together */
    TILE_MOST = 4096,    /* the side of a tile that is read */
    ZIP_MOST = 1032,     /* most bytes that deflate expands a byte to */
    NOTE_MOST = 1 << 20, /* bytes of one attribute that is read */
    FILE_MORE = 4 << 20, /* most bytes of a golden image without its pixels */
    PIXEL_BYTES = 28,    /* most bytes of a pixel in all planes */
};

static const char *const type_name[] = {"uint", "half", "float"};

/* The blocks of pixels: tiles of step[0] x step[1], or step[1] lines. */
struct form {
    bool tiled;
    uint32_t step[2];
};

/* Return true if the colours of the file are multiplied by alpha. */
static bool is_associated(exr_context_t context)
{
    static const char value[] = EXR_ALPHA_VALUE;
    const exr_attribute_t *attribute;
    return exr_get_attribute_by_name(context, 0, EXR_ALPHA, &attribute) == EXR_ERR_SUCCESS &&
           attribute->type == EXR_ATTR_STRING && attribute->string->length == sizeof value - 1 &&
           memcmp(attribute->string->str, value, sizeof value - 1) == 0;
}

/* Find the planes of the file; refuse channels of another type or sampling, and missing colours. */
static enum err find_channels(unsigned *planes, exr_context_t context, bool associated,
                              size_t *pixel_bytes, struct fault *fault)
{
    const exr_attr_chlist_t *list;
    bool has[EXR_CHANNELS] = {false};
    *planes = 0;
    *pixel_bytes = 0;
    if (exr_get_channels(context, 0, &list) != EXR_ERR_SUCCESS)
        return fault_set(fault, ERR_INPUT, "it has no channels; expected R, G, B and A");
    for (int i = 0; i < list->num_channels; i++) {
        const exr_attr_chlist_entry_t *entry = &list->entries[i];
        const struct exr_channel *channel = exr_channel_named(entry->name.str, associated);
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
        has[channel - exr_channels] = true;
        *planes |= channel->plane == PLANE_EYE ? 0 : channel->needs;
    }
    for (int i = 0; i < EXR_CHANNELS; i++)
        if (!has[i] && exr_channels[i].plane == PLANE_RGBA)
            return fault_set(fault, ERR_INPUT, "it has no channel %s; expected R, G, B and A",
                             exr_channels[i].name);
    return OK;
}

/* Find the tiles of a tiled file; refuse other forms. */
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

/* Check width and height against the limits and the size of the file. */
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
                         "%" PRIu64 " bytes claim %" PRId64 "x%" PRId64 " pixels; a picture of "
                         "this size needs a byte for each %d of them",
                         file_bytes, width, height, SWELLING_MOST);
    return OK;
}

static enum err get_attributes(struct picture *out, exr_context_t context, struct fault *fault)
{
    int32_t count = 0;
    exr_get_attribute_count(context, 0, &count);
    for (int32_t i = 0; i < count; i++) {
        const exr_attribute_t *attribute;
        if (exr_get_attribute_by_index(context, 0, EXR_ATTR_LIST_FILE_ORDER, i, &attribute) ||
            attribute->type != EXR_ATTR_STRING || exr_is_reserved(attribute->name))
            continue;
        const exr_attr_string_t *string = attribute->string;
        if (string->length < 0 || string->length > NOTE_MOST)
            return fault_set(fault, ERR_LIMIT, "a note of %d bytes; expected at most %d",
                             string->length, NOTE_MOST);
        OWNED(mem_release) char *value = mem_array((size_t)string->length + 1, 1);
        if (!value)
            return fault_memory(fault, "a note on a picture");
        memcpy(value, string->length ? string->str : "", (size_t)string->length);
        value[string->length] = '\0';
        TRY(picture_note(out, attribute->name, value, fault));
    }
    return OK;
}

struct reader {
    exr_context_t context;
    struct picture *out;
    struct watch *watch;
    const struct picture *like; /* the expected picture, or NULL */
    uint64_t next;              /* with `like`: the expected offset of the next block */
    bool has_more;              /* with `like`: the file has superfluous bytes or samples */
    struct form form;
    exr_attr_box2i_t window;
    exr_decode_pipeline_t pipeline;
    bool begun;
    struct exr_room room,
        again; /* samples of a block; with `like`: encoded again from its pixels */
    uint8_t *inflated;
    struct libdeflate_decompressor *inflater;
    uint8_t level[2][HALF_ONE + 1]; /* tables for colours and for alpha */
};

static void take_halves(struct reader *r, const struct exr_block *block)
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

/* With `like`: check that the block follows the one before it, that its packed bytes are one stream
 * of zlib with nothing after it, and that its colours and Z equal the decoded picture's. */
static void check_block(struct reader *r, const struct exr_block *block,
                        const exr_chunk_info_t *chunk)
{
    enum { LINE_LEADER = 8, TILE_LEADER = 20 }; /* bytes before the packed ones */
    const size_t pixels = (size_t)block->width * block->height;
    size_t used = 0, made = 0;
    const bool is_one_stream =
        chunk->packed_size == chunk->unpacked_size ||
        (libdeflate_zlib_decompress_ex(
             r->inflater, r->pipeline.packed_buffer, (size_t)chunk->packed_size, r->inflated,
             (size_t)chunk->unpacked_size, &used, &made) == LIBDEFLATE_SUCCESS &&
         used == chunk->packed_size);
    exr_fill_room(&r->again, r->out, block);
    r->has_more = r->has_more || !is_one_stream ||
                  chunk->data_offset != r->next + (r->form.tiled ? TILE_LEADER : LINE_LEADER) ||
                  memcmp(r->room.halves, r->again.halves, pixels * 8) != 0 ||
                  (r->out->depth_mm && r->out->is_associated &&
                   memcmp(r->room.eye, r->again.eye, pixels * 4) != 0);
    r->next = chunk->data_offset + chunk->packed_size;
}

static exr_result_t get_block(void *context, const struct exr_block *block)
{
    struct reader *r = context;
    exr_decode_pipeline_t *pipeline = &r->pipeline;
    exr_chunk_info_t chunk;
    const uint32_t *step = r->form.step;
    if (watch_poll(r->watch, NULL, 0, 0))
        return EXR_ERR_READ_IO; /* the caller checks the watch */
    const int32_t top = r->window.min.y + (int32_t)block->y;
    exr_result_t result = r->form.tiled
                              ? exr_read_tile_chunk_info(r->context, 0, (int)(block->x / step[0]),
                                                         (int)(block->y / step[1]), 0, 0, &chunk)
                              : exr_read_scanline_chunk_info(r->context, 0, top, &chunk);
    if (!result &&
        (chunk.height != (int32_t)block->height || chunk.width != (int32_t)block->width ||
         (!r->form.tiled && chunk.start_y != top)))
        result = EXR_ERR_BAD_CHUNK_LEADER; /* another position or size than expected */
    if (!result)
        result = r->begun ? exr_decoding_update(r->context, 0, &chunk, pipeline)
                          : exr_decoding_initialize(r->context, 0, &chunk, pipeline);
    if (result)
        return result;
    for (int i = 0; i < pipeline->channel_count; i++) {
        const struct exr_channel *channel =
            exr_channel_named(pipeline->channels[i].channel_name, r->out->is_associated);
        if (channel && (channel->plane != PLANE_EYE || r->like))
            exr_point_at(&pipeline->channels[i], channel, r->out, block, &r->room);
    }
    if (!r->begun)
        result = exr_decoding_choose_default_routines(r->context, 0, pipeline);
    r->begun = true;
    if (!result)
        result = exr_decoding_run(r->context, 0, pipeline);
    if (!result)
        take_halves(r, block);
    if (!result && r->like)
        check_block(r, block, &chunk);
    return result;
}

static enum err get_pixels(struct reader *r, const struct exr_stream *stream, struct fault *fault)
{
    uint16_t alpha[256];
    uint32_t *step = r->form.step;
    int32_t lines = 0;
    if (!r->form.tiled) {
        if (exr_get_scanlines_per_chunk(r->context, 0, &lines) || lines < 1 || lines > LINES_MOST)
            return exr_fault("read", stream, EXR_ERR_INVALID_ATTR, fault);
        step[0] = r->out->width;
        step[1] = (uint32_t)lines;
    }
    const size_t pixels = (size_t)least(r->out->width, step[0]) * least(r->out->height, step[1]);
    r->room.halves = calloc(pixels, 4 * sizeof *r->room.halves);
    bool fits = r->room.halves;
    if (r->like) {
        r->room.eye = calloc(pixels, sizeof *r->room.eye);
        r->again.halves = calloc(pixels, 4 * sizeof *r->again.halves);
        r->again.eye = calloc(pixels, sizeof *r->again.eye);
        r->inflated = calloc(pixels, EXR_CHANNELS * 4);
        r->inflater = libdeflate_alloc_decompressor();
        fits = fits && r->room.eye && r->again.halves && r->again.eye && r->inflated && r->inflater;
    }
    if (!fits)
        return fault_memory(fault, stream->path);
    linear_alpha(alpha);
    linear_invert(r->level[0], linear_half);
    linear_invert(r->level[1], alpha);
    r->pipeline = (exr_decode_pipeline_t)EXR_DECODE_PIPELINE_INITIALIZER;
    const exr_result_t result = exr_each_block(r->out, r->form.step, get_block, r);
    exr_decoding_destroy(r->context, &r->pipeline);
    if (!result && (r->has_more || (r->like && r->next != stream->bytes)))
        return fault_set(fault, ERR_CHECK,
                         "%s has bytes or samples that iftty does not write there", stream->path);
    return result ? exr_fault("read", stream, result, fault) : OK;
}

/* Make the picture of an open file, without its pixels. */
static enum err make_picture(struct reader *r, const struct exr_stream *stream, struct fault *fault)
{
    struct picture *out = r->out;
    unsigned planes;
    size_t pixel_bytes;
    TRY(check_form(&r->form, r->context, fault));
    const bool associated = is_associated(r->context);
    TRY(find_channels(&planes, r->context, associated, &pixel_bytes, fault));
    TRY(find_window(r->context, &r->window, pixel_bytes, stream->bytes, fault));
    const uint32_t width = (uint32_t)(r->window.max.x - r->window.min.x + 1);
    const uint32_t height = (uint32_t)(r->window.max.y - r->window.min.y + 1);
    if ((size_t)width * height > mem_available() / PIXEL_BYTES)
        return fault_memory(fault, "a picture");
    TRY(picture_init(out, width, height, planes, fault));
    TRY(get_attributes(out, r->context, fault));
    out->tiled = r->form.tiled;
    out->is_associated = associated;
    int32_t chunks = 0;
    if (r->like) { /* the table of the blocks follows the header */
        exr_get_chunk_count(r->context, 0, &chunks);
        r->next += (uint64_t)chunks * 8;
        out->space.eye_mm = r->like->space.eye_mm;
    }
    return OK;
}

/* Read the picture of an open file by r->context. */
static enum err read_context(struct reader *r, const struct exr_stream *stream, struct fault *fault)
{
    enum err err = fault_prefix(fault, make_picture(r, stream, fault), "%s", stream->path);
    if (!err)
        err = get_pixels(r, stream, fault);
    return err && watch_stops(r->watch) ? watch_fault(r->watch, fault) : err;
}

/* Check a golden image as far as possible before OpenEXR decodes it. */
static enum err check_golden(uint64_t *header_bytes, const struct exr_stream *stream,
                             const struct picture *like, struct fault *fault)
{
    /* A file of more bytes than pixels and notes can need is another one. */
    const uint64_t most = (uint64_t)like->width * like->height * EXR_CHANNELS * 4 + FILE_MORE;
    OWNED(buf_release) struct buf header = {0};
    enum err err = exr_header_read(&header, stream->fd, fault);
    if (!err)
        err = check_header(&header, like, fault);
    if (!err && stream->bytes > most)
        err = fault_set(fault, ERR_CHECK, "it has %" PRIu64 " bytes, too many for its pixels",
                        stream->bytes);
    *header_bytes = header.length;
    return fault_prefix(fault, err, "%s", stream->path);
}

enum err exr_read_golden(struct picture *out, const char *path, const struct picture *like,
                         struct watch *watch, struct fault *fault)
{
    struct exr_stream stream = {.path = path};
    exr_context_initializer_t setup = exr_stream_setup(&stream);
    *out = (struct picture){0};
    TRY(file_open(&stream.fd, &stream.bytes, path, O_RDONLY, fault));
    struct reader *r = calloc(1, sizeof *r); /* tables of 30 kB */
    if (r) {
        r->out = out;
        r->like = like;
        r->watch = watch;
    }
    enum err err = r ? OK : fault_memory(fault, path);
    if (!err && like)
        err = check_golden(&r->next, &stream, like, fault);
    setup.max_image_width = setup.max_image_height = PICTURE_SIDE_MOST;
    setup.flags =
        EXR_CONTEXT_FLAG_SILENT_HEADER_PARSE | EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    const exr_result_t result = err ? EXR_ERR_SUCCESS : exr_start_read(&r->context, path, &setup);
    if (result) {
        err = exr_fault("read", &stream, result, fault);
    } else if (!err) {
        err = read_context(r, &stream, fault);
        exr_finish(&r->context);
        free(r->room.halves);
        free(r->room.eye);
        free(r->again.halves);
        free(r->again.eye);
        free(r->inflated);
        if (r->inflater)
            libdeflate_free_decompressor(r->inflater);
    }
    close(stream.fd);
    free(r);
    if (err)
        picture_release(out);
    return err;
}

enum err exr_read(struct picture *out, const char *path, struct fault *fault)
{
    return exr_read_golden(out, path, NULL, NULL, fault);
}
