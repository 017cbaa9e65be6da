#include "engine/brush.h"

#include <stdlib.h>

#include "base/mem.h"

static int64_t square(int64_t x)
{
    return x * x;
}

enum err brush_init(struct brush *brush, const uint32_t unit[3], int64_t radius,
                    struct fault *fault)
{
    *brush = (struct brush){0};
    for (int a = 0; a < 3; a++) {
        const int64_t reach = radius / unit[a];
        if (reach > BRUSH_REACH_MOST)
            return fault_set(fault, ERR_LIMIT,
                             "radius: it reaches %lld voxels along %c; at most %d; nothing has "
                             "changed",
                             (long long)reach, "xyz"[a], BRUSH_REACH_MOST);
        brush->reach[a] = (int)reach;
    }
    const int *reach = brush->reach;
    brush->row =
        mem_array((size_t)(2 * reach[1] + 1) * (size_t)(2 * reach[2] + 1), sizeof *brush->row);
    if (!brush->row)
        return fault_memory(fault, "a brush");
    for (int z = -reach[2]; z <= reach[2]; z++)
        for (int y = -reach[1]; y <= reach[1]; y++) {
            const int64_t left =
                square(radius) - square((int64_t)y * unit[1]) - square((int64_t)z * unit[2]);
            int half = reach[0];
            while (half >= 0 && square((int64_t)half * unit[0]) > left)
                half--;
            if (half >= 0)
                brush->row[brush->rows++] =
                    (struct brush_row){(int16_t)y, (int16_t)z, (int16_t)half};
        }
    return OK;
}

void brush_release(struct brush *brush)
{
    free(brush->row);
    *brush = (struct brush){0};
}
