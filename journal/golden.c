/* SPDX-License-Identifier: MIT */
#include "journal/golden.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"

enum { NAME_MAX_BYTES = 64 };

static const char journal_ending[] = ".iftty";

static const char *const plane_name[] = {"colour", "depth", "label", "voxel"};

/* ---- comparing ------------------------------------------------------------------------------- */

/* Return the sample at a pixel, or NULL if there is no such plane. */
static const uint8_t *sample(const struct golden_planes *planes, enum golden_plane plane,
                             size_t pixel)
{
    const uint8_t *bytes = planes->plane[plane];
    return bytes ? bytes + 4 * pixel : NULL;
}

static uint32_t voxel_at(const struct golden_planes *planes, size_t pixel)
{
    const uint32_t *voxel = planes->plane[GOLDEN_VOXEL];
    return voxel ? voxel[pixel] : 0;
}

static void print_sample(char out[64], const struct golden_planes *planes, enum golden_plane plane,
                         size_t pixel)
{
    const uint8_t *byte = sample(planes, plane, pixel);
    uint32_t bits;
    float depth;
    memcpy(&bits, byte, 4);
    memcpy(&depth, byte, 4);
    if (plane == GOLDEN_RGBA)
        snprintf(out, 64, "%u,%u,%u,%u", byte[0], byte[1], byte[2], byte[3]);
    else if (plane == GOLDEN_DEPTH)
        snprintf(out, 64, "%.9g (0x%08" PRIx32 ")", (double)depth, bits);
    else
        snprintf(out, 64, "%" PRIu32, bits);
}

enum err golden_compare(const struct golden_planes *expected, const struct golden_planes *actual,
                        struct golden_difference *out, struct fault *fault)
{
    size_t pixels, bytes;
    *out = (struct golden_difference){.width = expected->width, .height = expected->height};
    out->shape_differs = expected->width != actual->width || expected->height != actual->height;
    for (enum golden_plane plane = 0; plane < GOLDEN_PLANES; plane++)
        out->shape_differs |= !expected->plane[plane] != !actual->plane[plane];
    if (out->shape_differs)
        return OK;
    if (!size_multiply(expected->width, expected->height, &pixels) ||
        !size_multiply(pixels, 4, &bytes))
        return fault_memory(fault, "a difference image");
    /* Compare whole planes first: a loop over pixels is ten times slower. */
    out->is_same = true;
    for (enum golden_plane plane = 0; plane < GOLDEN_PLANES && out->is_same; plane++)
        out->is_same = !expected->plane[plane] ||
                       memcmp(expected->plane[plane], actual->plane[plane], bytes) == 0;
    if (out->is_same)
        return OK;
    out->image = mem_array(bytes, 1);
    if (!out->image)
        return fault_memory(fault, "a difference image");
    for (size_t i = 0; i < pixels; i++) { /* red is distinct at a third of the brightness */
        const uint8_t *rgba = sample(expected, GOLDEN_RGBA, i);
        const unsigned grey = rgba ? (77u * rgba[0] + 150u * rgba[1] + 29u * rgba[2]) / 256 / 3 : 0;
        uint8_t *pixel = out->image + 4 * i;
        memset(pixel, (int)grey, 3);
        /* Compare the pixel in all planes; describe the first that differs. */
        bool differs = false;
        for (enum golden_plane plane = 0; plane < GOLDEN_PLANES; plane++) {
            const uint8_t *a = sample(expected, plane, i), *b = sample(actual, plane, i);
            if (!a || memcmp(a, b, 4) == 0)
                continue;
            if (out->pixels == 0 && !differs) {
                out->column = (uint32_t)(i % expected->width);
                out->row = (uint32_t)(i / expected->width);
                out->plane = plane;
                print_sample(out->expected, expected, plane, i);
                print_sample(out->actual, actual, plane, i);
                out->expected_voxel = voxel_at(expected, i);
                out->actual_voxel = voxel_at(actual, i);
            }
            out->pixels_of[plane]++;
            differs = true;
        }
        out->pixels += differs;
        if (differs)
            memcpy(pixel, (uint8_t[]){255, 32, 32}, 3);
        pixel[3] = 255;
    }
    return OK;
}

void golden_difference_release(struct golden_difference *difference)
{
    free(difference->image);
    difference->image = NULL;
}

/* Name the kind of difference first: another object, or the same object in other colours. */
static void write_kind(struct buf *out, const struct golden_difference *d)
{
    const uint64_t labels = d->pixels_of[GOLDEN_LABEL], voxels = d->pixels_of[GOLDEN_VOXEL];
    if (labels)
        buf_printf(out, "; labels differ in %" PRIu64 " pixel%s", labels, plural(labels));
    if (voxels)
        buf_printf(out, "%s voxels differ in %" PRIu64 " pixel%s", labels ? "," : ";", voxels,
                   plural(voxels));
    if (labels || voxels)
        return;
    buf_add_text(out, d->pixels_of[GOLDEN_DEPTH]
                          ? "; depths differ, labels and voxels are the same"
                          : "; colours alone differ, labels and voxels are the same");
}

void golden_describe(struct buf *out, const struct golden_difference *difference)
{
    if (difference->is_same) {
        buf_add_text(out, "no pixel differs");
    } else if (difference->shape_differs) {
        buf_add_text(out, "the sizes or channels of the pictures differ");
    } else {
        buf_printf(out,
                   "%" PRIu64 " of %" PRIu64 " pixels differ, first column %" PRIu32
                   ", row %" PRIu32 ": %s is %s, %s was expected",
                   difference->pixels, (uint64_t)difference->width * difference->height,
                   difference->column, difference->row, plane_name[difference->plane],
                   difference->actual, difference->expected);
        write_kind(out, difference);
        /* The voxel seen at that pixel; UINT32_MAX for no voxel. */
        const uint32_t expected = difference->expected_voxel, actual = difference->actual_voxel;
        if (expected != actual && actual == UINT32_MAX)
            buf_printf(out, "; it shows nothing instead of voxel %" PRIu32, expected);
        else if (expected != actual && expected == UINT32_MAX)
            buf_printf(out, "; it shows voxel %" PRIu32 " where nothing was", actual);
        else if (expected != actual)
            buf_printf(out, "; it shows voxel %" PRIu32 " instead of %" PRIu32, actual, expected);
    }
}

/* ---- names ----------------------------------------------------------------------------------- */

bool golden_name_is_valid(const char *name)
{
    static const char allowed[] = "abcdefghijklmnopqrstuvwxyz0123456789_-";
    const size_t length = strlen(name);
    return length >= 1 && length <= NAME_MAX_BYTES && name[0] != '_' && name[0] != '-' &&
           strspn(name, allowed) == length;
}

/* Length without the ending of a journal that is not complete yet. */
static size_t whole_length(const char *journal_path)
{
    const size_t length = strlen(journal_path), ending = sizeof JOURNAL_PART - 1;
    return length > ending && strcmp(journal_path + length - ending, JOURNAL_PART) == 0
               ? length - ending
               : length;
}

void golden_journal_name(struct buf *out, const char *journal_path)
{
    OWNED(buf_release) struct buf real = {0};
    file_real(&real, journal_path);
    const char *name = file_name(buf_text(&real));
    buf_clear(out);
    buf_add(out, name, whole_length(name));
    out->failed |= real.failed;
}

static void write_folder(struct buf *out, const char *journal_path)
{
    const size_t ending = sizeof journal_ending - 1;
    size_t length = whole_length(journal_path);
    /* a journal named ".iftty" keeps its name */
    if (length > ending && memcmp(journal_path + length - ending, journal_ending, ending) == 0 &&
        journal_path[length - ending - 1] != '/')
        length -= ending;
    buf_clear(out);
    buf_add(out, journal_path, length);
    buf_add_text(out, ".golden");
}

enum err golden_folder(struct buf *out, const char *journal_path, struct fault *fault)
{
    OWNED(buf_release) struct buf real = {0};
    file_real(&real, journal_path);
    write_folder(out, journal_path);
    if (!real.failed && strcmp(buf_text(&real), journal_path) != 0) {
        const bool is_beside_link = file_is_folder(buf_text(out));
        OWNED(buf_release) struct buf beside_link = *out;
        *out = (struct buf){0};
        write_folder(out, buf_text(&real));
        if (is_beside_link && !file_is_folder(buf_text(out))) {
            buf_clear(out);
            buf_add_text(out, buf_text(&beside_link));
        }
    }
    return out->failed || real.failed ? fault_memory(fault, "a file name") : OK;
}

enum err golden_folder_next_to_link(struct buf *out, const char *journal_path, struct fault *fault)
{
    OWNED(buf_release) struct buf used = {0};
    TRY(golden_folder(&used, journal_path, fault));
    write_folder(out, journal_path);
    if (!file_is_folder(buf_text(out)) || file_is_same(buf_text(out), buf_text(&used)))
        buf_clear(out);
    return OK;
}

enum err golden_path(struct buf *out, const char *journal_path, const char *name,
                     struct fault *fault)
{
    if (!golden_name_is_valid(name))
        return fault_set(fault, ERR_INPUT,
                         "a golden image's name is 1 to %d of a-z 0-9 _ - and begins with a letter "
                         "or digit, not: %.100s",
                         NAME_MAX_BYTES, name);
    TRY(golden_folder(out, journal_path, fault));
    buf_printf(out, "/%s.exr", name);
    return out->failed ? fault_memory(fault, "a file name") : OK;
}
