/* What pictures cost on their way to a terminal by the painter. */
#include "program/bench_terminal.h"

#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "program/bench.h"
#include "tui/picture/painter.h"

enum { PATCH_SIDE = 40, CELL_WIDTH = 8, CELL_HEIGHT = 16, ROUNDS = 21, FRAMES_MOST = 24 };

struct frames {
    struct painter painter;
    struct buf out;
    double ms[FRAMES_MOST], bytes[FRAMES_MOST];
    size_t count;
};

static void begin_frames(struct frames *f, const struct graphics *by, uint32_t side)
{
    const struct terminal_facts facts = {.graphics = by,
                                         .colours = COLOURS_24BIT,
                                         .cell_width = CELL_WIDTH,
                                         .cell_height = CELL_HEIGHT,
                                         .image_side_most = 10000,
                                         .shape = BLOCK_HALF,
                                         .answers = true,
                                         .edits = true};
    *f = (struct frames){.count = 0};
    painter_place(&f->painter, &facts, 0, 0, side / CELL_WIDTH, side / CELL_HEIGHT);
}

static bool time_frame(struct frames *f, const struct image_view *view)
{
    buf_clear(&f->out);
    const uint64_t begin = clock_ns();
    painter_show(&f->painter, view, &f->out);
    f->ms[f->count] = times_since(begin);
    f->bytes[f->count++] = (double)f->out.length;
    return !f->out.failed;
}

static void end_frames(struct frames *f, bool good, struct bench_cost *cost)
{
    if (good)
        *cost =
            (struct bench_cost){times_median(f->bytes, f->count), times_median(f->ms, f->count)};
    painter_release(&f->painter);
    buf_release(&f->out);
}

bool bench_painter_whole(struct bench_cost *cost, const struct graphics *by,
                         const struct image_view *view)
{
    struct frames f;
    struct image_view fitting = *view;
    uint8_t *small = NULL;
    begin_frames(&f, by, view->width);
    painter_size(&f.painter, &fitting.width, &fitting.height);
    if (fitting.width < view->width)
        fitting.rgba = small = image_view_shrink(view, fitting.width, fitting.height);
    bool good = fitting.rgba != NULL;
    for (int i = 0; good && i < ROUNDS; i++) {
        painter_forget(&f.painter);
        good = time_frame(&f, &fitting);
    }
    end_frames(&f, good, cost);
    free(small);
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
    uint8_t *rgba = malloc(all);
    struct image_view changed = *view;
    struct frames f;
    changed.rgba = rgba;
    begin_frames(&f, by, view->width);
    bool good = rgba && painter_show(&f.painter, view, &f.out);
    for (uint32_t top = 11; good && top + PATCH_SIDE + 3 < view->height; top += 53)
        for (uint32_t left = 17; good && left + PATCH_SIDE + 5 < view->width; left += 67) {
            if (f.count + 2 > FRAMES_MOST || !is_full(view, left, top))
                continue;
            memcpy(rgba, view->rgba, all);
            change_patch(rgba, view, left, top);
            good = time_frame(&f, &changed) && time_frame(&f, view);
        }
    end_frames(&f, good, cost);
    free(rgba);
    return good;
}
