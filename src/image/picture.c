/* SPDX-License-Identifier: MIT */
#include "image/picture.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum err picture_init(struct picture *picture, uint32_t width, uint32_t height, unsigned planes,
                      struct fault *fault)
{
    *picture = (struct picture){0};
    if (width == 0 || height == 0)
        return fault_set(fault, ERR_INPUT, "a picture needs at least one pixel on every side");
    if (width > PICTURE_SIDE_MOST || height > PICTURE_SIDE_MOST)
        return fault_set(fault, ERR_LIMIT, "a picture of %ux%u pixels; at most %d a side are held",
                         width, height, PICTURE_SIDE_MOST);
    size_t pixels = (size_t)width * height; /* at most 2^28 */
    size_t pixel_bytes = 4 * (1 + (size_t)__builtin_popcount(planes & ~(unsigned)PICTURE_NORMAL));
    if (planes & PICTURE_NORMAL)
        pixel_bytes += 3 * sizeof *picture->normal;
    if (pixels > SIZE_MAX / pixel_bytes || !mem_has_room(pixels * pixel_bytes))
        return fault_memory(fault, "a picture");
    picture->width = width;
    picture->height = height;
    picture->rgba = calloc(pixels, 4);
    if (planes & PICTURE_DEPTH)
        picture->depth_mm = calloc(pixels, sizeof *picture->depth_mm);
    if (planes & PICTURE_LABEL)
        picture->label = calloc(pixels, sizeof *picture->label);
    if (planes & PICTURE_VOXEL)
        picture->voxel = calloc(pixels, sizeof *picture->voxel);
    if (planes & PICTURE_NORMAL)
        picture->normal = calloc(pixels, 3 * sizeof *picture->normal);
    if (picture->rgba && picture_planes(picture) == planes)
        return OK;
    picture_release(picture);
    return fault_memory(fault, "a picture");
}

unsigned picture_planes(const struct picture *picture)
{
    return (picture->depth_mm ? PICTURE_DEPTH : 0) | (picture->label ? PICTURE_LABEL : 0) |
           (picture->voxel ? PICTURE_VOXEL : 0) | (picture->normal ? PICTURE_NORMAL : 0);
}

struct picture picture_rows(const struct picture *picture, uint32_t top, uint32_t height)
{
    const size_t first = (size_t)top * picture->width;
    struct picture rows = *picture;
    rows.height = height;
    rows.rgba += 4 * first;
    rows.shown = rows.shown ? rows.shown + 4 * first : NULL;
    rows.depth_mm = rows.depth_mm ? rows.depth_mm + first : NULL;
    rows.label = rows.label ? rows.label + first : NULL;
    rows.voxel = rows.voxel ? rows.voxel + first : NULL;
    rows.normal = rows.normal ? rows.normal + 3 * first : NULL;
    rows.attribute = NULL;
    rows.attributes = 0;
    return rows;
}

void picture_release(struct picture *picture)
{
    for (size_t i = 0; i < picture->attributes; i++) {
        free(picture->attribute[i].name);
        free(picture->attribute[i].value);
    }
    free(picture->attribute);
    free(picture->rgba);
    free(picture->shown);
    free(picture->depth_mm);
    free(picture->label);
    free(picture->voxel);
    free(picture->normal);
    *picture = (struct picture){0};
}

static struct attribute *find_attribute(const struct picture *picture, const char *name)
{
    for (size_t i = 0; i < picture->attributes; i++)
        if (strcmp(picture->attribute[i].name, name) == 0)
            return &picture->attribute[i];
    return NULL;
}

enum err picture_note(struct picture *picture, const char *name, const char *value,
                      struct fault *fault)
{
    struct attribute *former = find_attribute(picture, name);
    struct attribute fresh = {former ? NULL : strdup(name), strdup(value)};
    struct attribute *grown = NULL;
    if (former && fresh.value) {
        free(former->value);
        former->value = fresh.value;
        return OK;
    }
    if (fresh.name && fresh.value)
        grown = realloc(picture->attribute, (picture->attributes + 1) * sizeof *grown);
    if (!grown) {
        free(fresh.name);
        free(fresh.value);
        return fault_memory(fault, "a note on a picture");
    }
    picture->attribute = grown;
    picture->attribute[picture->attributes++] = fresh;
    return OK;
}

const char *picture_find(const struct picture *picture, const char *name)
{
    const struct attribute *attribute = find_attribute(picture, name);
    return attribute ? attribute->value : NULL;
}

/* ---- rasters ---- */

struct raster raster_part(const struct raster *raster, struct raster_box box)
{
    struct raster part = *raster;
    part.width = box.width;
    part.height = box.height;
    part.bytes += box.top * raster->stride + box.left * raster_pixel_bytes(raster);
    return part;
}

unsigned raster_used(const struct raster *raster, uint8_t place[RASTER_COLOURS_MOST],
                     uint32_t used[RASTER_COLOURS_MOST], bool *is_clear)
{
    bool occurs[RASTER_COLOURS_MOST] = {false};
    unsigned count = 0;
    for (uint32_t y = 0; y < raster->height; y++) {
        const uint8_t *row = raster->bytes + y * raster->stride;
        occurs[row[0]] = true;
        /* Most pixels equal their neighbours: skip eight at a time if all are `same`. */
        uint64_t same = 0, eight;
        uint32_t x = 0;
        for (; x + 8 <= raster->width; x += 8) {
            memcpy(&eight, row + x, 8);
            if (eight == same)
                continue;
            for (uint32_t k = 0; k < 8; k++)
                occurs[row[x + k]] = true;
            same = row[x + 7] * UINT64_C(0x0101010101010101);
        }
        for (; x < raster->width; x++)
            occurs[row[x]] = true;
    }
    memset(place, 0, RASTER_COLOURS_MOST);
    if (is_clear)
        *is_clear = raster->has_clear && occurs[RASTER_CLEAR];
    if (raster->has_clear && occurs[RASTER_CLEAR])
        used[count++] = 0;
    for (unsigned p = 0; p < raster->colours; p++)
        if (occurs[p]) {
            place[p] = (uint8_t)count;
            used[count++] = raster->colour[p];
        }
    return count;
}
