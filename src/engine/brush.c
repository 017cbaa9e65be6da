/* SPDX-License-Identifier: MIT */
#include "engine/brush.h"

#include <stdbool.h>
#include <stdlib.h>

#include "base/mem.h"

static int64_t square(int64_t x)
{
    return x * x;
}

enum err brush_init(struct brush *brush, const uint32_t unit[3], int64_t radius, int most,
                    struct fault *fault)
{
    *brush = (struct brush){0};
    for (int a = 0; a < 3; a++) {
        const int64_t reach = radius / unit[a];
        if (reach > most)
            return fault_set(fault, ERR_LIMIT,
                             "radius: it reaches %lld voxels along %c; at most %d; nothing has "
                             "changed",
                             (long long)reach, "xyz"[a], most);
        brush->reach[a] = (int)reach;
    }
    const int *reach = brush->reach;
    brush->row =
        mem_array((size_t)(2 * reach[1] + 1) * (size_t)(2 * reach[2] + 1), sizeof *brush->row);
    if (!brush->row)
        return fault_memory(fault, "a brush");
    for (int z = -reach[2]; z <= reach[2]; z++) {
        int half = -1; /* half-length of the previous row, from which the next differs little */
        for (int y = -reach[1]; y <= reach[1]; y++) {
            const int64_t left =
                square(radius) - square((int64_t)y * unit[1]) - square((int64_t)z * unit[2]);
            while (half < reach[0] && square(((int64_t)half + 1) * unit[0]) <= left)
                half++;
            while (half >= 0 && square((int64_t)half * unit[0]) > left)
                half--;
            if (half >= 0)
                brush->row[brush->rows++] =
                    (struct brush_row){(int16_t)y, (int16_t)z, (int16_t)half, -1};
        }
    }
    return OK;
}

/* Index of the row (y, z) in half[], which has one more row on each side of the ball. */
static size_t at_row(const struct brush *brush, int y, int z)
{
    const int width = 2 * (brush->reach[1] + 1) + 1;
    return (size_t)((z + brush->reach[2] + 1) * width + y + brush->reach[1] + 1);
}

enum err brush_hollow(struct brush *brush, unsigned neighbours, struct fault *fault)
{
    const size_t rows = at_row(brush, brush->reach[1] + 1, brush->reach[2] + 1) + 1;
    OWNED(mem_release) int16_t *half = mem_array(rows, sizeof *half);
    if (!half)
        return fault_memory(fault, "a shell");
    for (size_t i = 0; i < rows; i++)
        half[i] = -1;
    for (size_t i = 0; i < brush->rows; i++)
        half[at_row(brush, brush->row[i].y, brush->row[i].z)] = brush->row[i].half;
    for (size_t i = 0; i < brush->rows; i++) {
        /* Half-length, from the middle of the row, of the part whose neighbours are all in the
         * ball; -1 for none. */
        int hole = brush->row[i].half - 1;
        for (int z = -1; z <= 1; z++)
            for (int y = -1; y <= 1; y++) {
                const bool is_corner = y && z, is_beside = y || z;
                const int reach = half[at_row(brush, brush->row[i].y + y, brush->row[i].z + z)] -
                                  (neighbours == 26);
                if (is_beside && (!is_corner || neighbours == 26) && reach < hole)
                    hole = reach;
            }
        brush->row[i].hole = (int16_t)(hole < -1 ? -1 : hole);
    }
    return OK;
}

void brush_release(struct brush *brush)
{
    free(brush->row);
    *brush = (struct brush){0};
}
