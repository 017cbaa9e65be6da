#include "tui/painter.h"

#include <string.h>

#include "tui/kitty.h"
#include "tui/sixel.h"

static void move_to(const struct painter *p, unsigned row, struct buf *out)
{
    buf_printf(out, "\033[%u;%uH", p->row + row + 1, p->column + 1);
}

static void show_blocks(const struct painter *p, const struct image_view *view, struct buf *out)
{
    struct buf lines = {0};
    blocks_encode(view, p->facts.colours, p->columns, p->rows, &lines);
    const char *at = buf_text(&lines);
    for (unsigned row = 0; *at; row++) {
        const char *end = strstr(at, "\r\n");
        move_to(p, row, out);
        buf_add(out, at, (size_t)(end - at));
        at = end + 2;
    }
    out->failed |= lines.failed;
    buf_release(&lines);
}

void painter_place(struct painter *p, const struct terminal_facts *facts, unsigned column,
                   unsigned row, unsigned columns, unsigned rows)
{
    p->facts = *facts;
    p->column = column;
    p->row = row;
    p->columns = columns;
    p->rows = rows;
}

void painter_size(const struct painter *p, uint32_t *width, uint32_t *height)
{
    bool blocks = p->facts.graphics == GRAPHICS_BLOCKS || p->facts.graphics == GRAPHICS_ITERM;
    *width = p->columns * (blocks ? 1 : p->facts.cell_width);
    *height = p->rows * (blocks ? 2 : p->facts.cell_height);
}

bool painter_show(struct painter *p, const struct image_view *view, struct buf *out)
{
    if (view->width == 0 || view->height == 0 || p->facts.graphics == GRAPHICS_NONE)
        return true;
    move_to(p, 0, out);
    if (p->facts.graphics == GRAPHICS_KITTY)
        kitty_encode(view, out);
    else if (p->facts.graphics == GRAPHICS_SIXEL)
        sixel_encode(view, out);
    else
        show_blocks(p, view, out);
    p->is_shown = true;
    return !out->failed;
}

void painter_forget(struct painter *p)
{
    p->is_shown = false;
}

void painter_remove(struct painter *p, struct buf *out)
{
    if (p->facts.graphics == GRAPHICS_KITTY)
        buf_add_text(out, "\033_Ga=d,d=A,q=2\033\\");
    for (unsigned row = 0; p->is_shown && row < p->rows; row++) {
        move_to(p, row, out);
        buf_printf(out, "\033[%uX", p->columns);
    }
    p->is_shown = false;
}

void painter_release(struct painter *p)
{
    *p = (struct painter){0};
}
