#include "tui/picture/show.h"

#include <stdlib.h>

#include "tui/picture/blocks.h"
#include "tui/picture/iterm.h"
#include "tui/picture/kitty.h"
#include "tui/picture/sixel.h"

static uint32_t least(uint64_t a, uint64_t b)
{
    return (uint32_t)(a < b ? a : b);
}

static void add_framed(const struct terminal_facts *facts, const struct image_view *view,
                       struct buf *out)
{
    uint32_t rows = (view->height + facts->cell_height - 1) / facts->cell_height;
    buf_add_char(out, '\r');
    for (uint32_t i = 0; i < rows; i++)
        buf_add_char(out, '\n');
    buf_printf(out, "\033[%uA\0337", rows);
    if (facts->graphics == GRAPHICS_KITTY)
        kitty_encode(view, out);
    else if (facts->graphics == GRAPHICS_ITERM)
        iterm_encode(view, out);
    else
        sixel_encode(view, out);
    buf_printf(out, "\0338\033[%uB\r", rows);
}

void show_inline(const struct terminal_facts *facts, const struct image_view *view,
                 uint32_t columns, uint32_t rows, struct buf *out)
{
    struct image_view fitting = *view;
    uint32_t picture_rows = rows > 1 ? rows - 1 : 1;
    if (view->width == 0 || view->height == 0 || facts->graphics == GRAPHICS_NONE)
        return;
    if (facts->graphics == GRAPHICS_BLOCKS) {
        blocks_encode(view, facts->colours, facts->shape, columns, picture_rows, out);
        return;
    }
    uint32_t side = facts->image_side_most;
    image_view_fit(view, least((uint64_t)columns * facts->cell_width, side),
                   least((uint64_t)picture_rows * facts->cell_height, side), &fitting.width,
                   &fitting.height);
    if (fitting.width == view->width && fitting.height == view->height) {
        add_framed(facts, view, out);
        return;
    }
    uint8_t *rgba = image_view_shrink(view, fitting.width, fitting.height);
    fitting.rgba = rgba;
    if (rgba)
        add_framed(facts, &fitting, out);
    else
        out->failed = true;
    free(rgba);
}
