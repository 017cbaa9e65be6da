#include "program/bench_painter.h"

#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "tui/picture/painter.h"

enum { PATCH_SIDE = 40, CELL_WIDTH = 8, CELL_HEIGHT = 16, ROUNDS = 21, PATCHES = 12 };

static void place_painter(struct painter *painter, const struct graphics *by, uint32_t side)
{
    const struct terminal_facts facts = {.graphics = by,
                                         .colours = COLOURS_24BIT,
                                         .cell_width = CELL_WIDTH,
                                         .cell_height = CELL_HEIGHT,
                                         .image_side_most = 10000,
                                         .shape = BLOCK_HALF,
                                         .answers = true,
                                         .edits = true};
    painter_place(painter, &facts, 0, 0, side / CELL_WIDTH, side / CELL_HEIGHT);
}

/* Adds the time and bytes of one frame. */
static bool time_frame(struct painter *painter, const struct image_view *view, struct buf *out,
                       double *ms, double *bytes)
{
    buf_clear(out);
    const uint64_t begin = clock_ns();
    painter_show(painter, view, out);
    *ms = times_since(begin);
    *bytes = (double)out->length;
    return !out->failed;
}

/* A picture as large as the painter wants it; *owned is to be freed. */
static bool fit(struct painter *painter, const struct image_view *view, struct image_view *fitting,
                uint8_t **owned)
{
    uint32_t width, height;
    painter_size(painter, &width, &height);
    *fitting = *view;
    *owned = NULL;
    if (width >= view->width && height >= view->height)
        return true;
    *owned = image_view_shrink(view, width, height);
    fitting->width = width;
    fitting->height = height;
    fitting->rgba = *owned;
    return *owned != NULL;
}

bool bench_painter_whole(struct bench_cost *cost, const struct graphics *by,
                         const struct image_view *view)
{
    struct painter painter = {0};
    struct image_view fitting;
    struct buf out = {0};
    double ms[ROUNDS], bytes[ROUNDS];
    uint8_t *owned;
    place_painter(&painter, by, view->width);
    bool good = fit(&painter, view, &fitting, &owned);
    for (int i = 0; good && i < ROUNDS; i++) {
        painter_forget(&painter);
        good = time_frame(&painter, &fitting, &out, ms + i, bytes + i);
    }
    if (good)
        *cost = (struct bench_cost){times_median(bytes, ROUNDS), times_median(ms, ROUNDS)};
    painter_release(&painter);
    buf_release(&out);
    free(owned);
    return good;
}

/* Nine tenths of the patch show an object, before and after. */
static bool is_full(const struct image_view *view, uint32_t left, uint32_t top)
{
    unsigned shown = 0;
    for (uint32_t y = 0; y < PATCH_SIDE; y++)
        for (uint32_t x = 0; x < PATCH_SIDE; x++)
            shown += image_view_colour(view, (size_t)(top + y) * view->width + left + x) != 0;
    return shown >= PATCH_SIDE * PATCH_SIDE * 9 / 10;
}

/* The patch, and what is seen 5 pixels to the right of it and 3 below. */
static void change_patch(uint8_t *rgba, const struct image_view *view, uint32_t left, uint32_t top)
{
    for (uint32_t y = 0; y < PATCH_SIDE; y++)
        memcpy(rgba + 4 * ((size_t)(top + y) * view->width + left),
               view->rgba + 4 * ((size_t)(top + y + 3) * view->width + left + 5), 4 * PATCH_SIDE);
}

/* Patches all over the object; each is changed and comes back. */
bool bench_painter_patches(struct bench_cost *cost, const struct graphics *by,
                           const struct image_view *view)
{
    const size_t all = 4 * (size_t)view->width * view->height;
    struct painter painter = {0};
    struct buf out = {0};
    uint8_t *rgba = malloc(all);
    double ms[2 * PATCHES], bytes[2 * PATCHES];
    size_t count = 0;
    bool good = rgba != NULL;
    struct image_view changed = *view;
    changed.rgba = rgba;
    place_painter(&painter, by, view->width);
    if (good)
        good = painter_show(&painter, view, &out);
    for (uint32_t top = 11; good && top + PATCH_SIDE + 3 < view->height; top += 53) {
        for (uint32_t left = 17; good && left + PATCH_SIDE + 5 < view->width; left += 67) {
            if (count + 2 > 2 * PATCHES || !is_full(view, left, top))
                continue;
            memcpy(rgba, view->rgba, all);
            change_patch(rgba, view, left, top);
            good = time_frame(&painter, &changed, &out, ms + count, bytes + count) &&
                   time_frame(&painter, view, &out, ms + count + 1, bytes + count + 1);
            count += 2;
        }
    }
    if (good)
        *cost = (struct bench_cost){times_median(bytes, count), times_median(ms, count)};
    painter_release(&painter);
    buf_release(&out);
    free(rgba);
    return good;
}
