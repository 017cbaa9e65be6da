/* SPDX-License-Identifier: MIT */
#include "image/image_inside.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/scan.h"
#include "engine/grid.h"
#include "image/volume_format.h"

/* ---- the choice ---- */

enum err part_choose(struct volume_header *header, struct fault *fault)
{
    const struct volume_choice *choice = &header->choice;
    const uint32_t reduce = choice->reduce > 1 ? choice->reduce : 1;
    double first[3], step[3];
    struct grid grid;
    enum err err = OK;
    memcpy(header->whole, header->size, sizeof header->whole);
    for (int a = 0; a < 3 && choice->has_crop; a++)
        if (choice->first[a] > choice->last[a] || choice->last[a] >= header->whole[a])
            return fault_set(fault, ERR_USAGE,
                             "crop: %" PRIu32 "-%" PRIu32 " is not in the %" PRIu32
                             " voxels along %c, 0-%" PRIu32,
                             choice->first[a], choice->last[a], header->whole[a], 'x' + a,
                             header->whole[a] - 1);
    for (int a = 0; a < 3; a++) {
        const uint32_t begin = choice->has_crop ? choice->first[a] : 0;
        const uint32_t count = choice->has_crop ? choice->last[a] - begin + 1 : header->whole[a];
        header->begin[a] = begin;
        header->step[a] = count >= reduce ? reduce : 1;
        header->size[a] = count / header->step[a];
        step[a] = header->step[a];
        first[a] = begin + (step[a] - 1) / 2;
        const uint32_t rest = count - header->size[a] * header->step[a];
        if (rest)
            volume_note(header->notes,
                        "reduce: the last %" PRIu32 " of %" PRIu32 " voxels along %c left out, "
                        "which fill no block",
                        rest, count, 'x' + a);
    }
    if (part_is_less(header) && !geometry_derive(&header->geometry, first, step))
        err = fault_set(fault, ERR_INPUT,
                        "reduce=%" PRIu32 ": its voxels would be more than 4 m apart; those of the "
                        "file are %g x %g x %g mm",
                        reduce, header->geometry.spacing_nm[0] / 1e6,
                        header->geometry.spacing_nm[1] / 1e6, header->geometry.spacing_nm[2] / 1e6);
    if (!err)
        err = grid_init(&grid, header->size, fault);
    if (err == ERR_LIMIT)
        fault_prefix(fault, err, "open a part of it, with crop=A-B,C-D,E-F or reduce=2");
    return err;
}

/* ---- numbers in the order of the file ---- */

static double get_number(const uint8_t *at, const struct volume_header *header)
{
    const unsigned width = voxel_bytes(header->type);
    const uint64_t bits = bits_get(at, width, header->big_endian);
    switch (header->type) {
    case VOXEL_INT8:
        return (int8_t)bits;
    case VOXEL_INT16:
        return (int16_t)bits;
    case VOXEL_INT32:
        return (int32_t)bits;
    case VOXEL_INT64:
        return (double)(int64_t)bits;
    case VOXEL_FLOAT32:
    case VOXEL_FLOAT64:
        return real_of_bits(bits, width);
    default:
        return (double)bits;
    }
}

/* Write a mean, which the type can hold. */
static void put_number(uint8_t *at, double value, const struct volume_header *header)
{
    const unsigned width = voxel_bytes(header->type);
    uint64_t bits;
    switch (header->type) {
    case VOXEL_FLOAT32:
    case VOXEL_FLOAT64:
        bits = bits_of_real(value, width);
        break;
    case VOXEL_UINT64:
        bits = value < 0x1p64 ? (uint64_t)floor(value + 0.5) : UINT64_MAX;
        break;
    default:
        bits = value < 0x1p63 ? (uint64_t)(int64_t)floor(value + 0.5) : INT64_MAX;
    }
    bits_put(at, width, bits, header->big_endian);
}

/* ---- blocks ---- */

struct blocks {
    const struct volume_header *header;
    struct volume_source *source;
    uint64_t offset; /* position of the volume */
    unsigned width;  /* bytes of a number */
    uint8_t *row;    /* a row of the file */
    double *sum;     /* sums of the blocks in one plane of the part, */
    uint32_t *count; /* and the finite numbers in each */
};

/* Add a row of the file to the sums of row y of the part. */
static void add_row(struct blocks *blocks, uint32_t y)
{
    const struct volume_header *header = blocks->header;
    const size_t first = (size_t)header->size[0] * y;
    const uint8_t *at = blocks->row + (size_t)header->begin[0] * blocks->width;
    for (uint32_t x = 0; x < header->size[0]; x++)
        for (uint32_t i = 0; i < header->step[0]; i++, at += blocks->width) {
            const double number = get_number(at, header);
            if (!isfinite(number))
                continue;
            blocks->sum[first + x] += number;
            blocks->count[first + x]++;
        }
}

/* Copy the middle voxel of each block of a row. */
static void pick_row(uint8_t *to, const struct blocks *blocks)
{
    const struct volume_header *header = blocks->header;
    const size_t step = header->step[0], width = blocks->width;
    const uint8_t *at = blocks->row + (header->begin[0] + (step - 1) / 2) * width;
    const size_t each =
        step == 1 ? header->size[0] * width : width; /* all at once, or one by one */
    for (size_t done = 0; done < header->size[0] * width; done += each, at += step * width)
        memcpy(to + done, at, each);
}

/* Read plane z of the box, counted from its beginning. */
static enum err read_plane(uint8_t *to, struct blocks *blocks, uint32_t z, struct task *task,
                           struct fault *fault)
{
    const struct volume_header *header = blocks->header;
    const uint32_t *whole = header->whole, *step = header->step;
    const size_t bytes = (size_t)whole[0] * blocks->width;
    const size_t part_bytes = (size_t)header->size[0] * blocks->width;
    const uint64_t row = ((uint64_t)header->begin[2] + z) * whole[1] + header->begin[1];
    const size_t plane = (size_t)(z / step[2]) * header->size[1];
    TRY(source_go_to(blocks->source, blocks->offset + row * bytes, "the voxels", fault));
    for (uint32_t y = 0; y < header->size[1] * step[1]; y++) {
        TRY(source_read(blocks->source, blocks->row, bytes, "the voxels", NULL, fault));
        if (blocks->sum)
            add_row(blocks, y / step[1]);
        else if (y % step[1] == (step[1] - 1) / 2 && z % step[2] == (step[2] - 1) / 2)
            pick_row(to + (plane + y / step[1]) * part_bytes, blocks); /* the middle of blocks */
        if (!task_advance(task, whole[0]))
            TRY(watch_fault(task->watch, fault));
    }
    if (!blocks->sum || (z + 1) % step[2] != 0)
        return OK;
    to += plane * part_bytes;
    for (size_t i = 0; i < (size_t)header->size[0] * header->size[1];
         i++) { /* and clear the sums */
        const double mean = blocks->count[i] ? blocks->sum[i] / blocks->count[i] : (double)NAN;
        put_number(to + i * blocks->width, mean, header);
        blocks->sum[i] = 0;
        blocks->count[i] = 0;
    }
    return OK;
}

enum err part_read(void *to, const struct volume_header *header, uint64_t offset,
                   struct volume_source *source, struct watch *watch, struct fault *fault)
{
    const bool means = header->choice.reduce > 1 && !header->choice.nearest;
    const size_t plane = means ? (size_t)header->size[0] * header->size[1] : 0;
    const unsigned width = voxel_bytes(header->type);
    OWNED(mem_release) uint8_t *row = mem_array(header->whole[0], width);
    OWNED(mem_release) double *sum = means ? mem_array(plane, sizeof *sum) : NULL;
    OWNED(mem_release) uint32_t *count = means ? mem_array(plane, sizeof *count) : NULL;
    if (!row || (means && (!sum || !count)))
        return fault_memory(fault, "a plane of voxels");
    for (size_t i = 0; i < plane; i++) {
        sum[i] = 0;
        count[i] = 0;
    }
    struct blocks blocks = {header, source, offset, width, row, sum, count};
    const uint32_t planes = header->size[2] * header->step[2];
    struct task task = task_begin(
        watch, "reading", (uint64_t)planes * header->size[1] * header->step[1] * header->whole[0]);
    for (uint32_t z = 0; z < planes; z++)
        TRY(read_plane(to, &blocks, z, &task, fault));
    return source_finish(source, fault);
}
