#include "tui/picture/painter.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "tui/picture/iterm.h"
#include "tui/picture/kitty.h"
#include "tui/picture/shaded.h"
#include "tui/picture/stale.h"

enum {
    IMAGE = 26982, /* and the next: numbers in kitty that others hardly use */
    PIXEL_TILE = 16,
    FAST_FROM = 1 << 13, /* pixels; from here on time counts more than bytes */
};

/* What a patch costs beyond its pixels, in pixels: escape, headers, palette. */
enum { KITTY_BOX_COST = 250, SIXEL_BOX_COST = 300, ITERM_BOX_COST = 300 };

/* ---- the place ---- */

static void move_to(const struct painter *p, unsigned column, unsigned row, struct buf *out)
{
    buf_printf(out, "\033[%u;%uH", p->row + row + 1, p->column + column + 1);
}

void painter_place(struct painter *p, const struct terminal_facts *facts, unsigned column,
                   unsigned row, unsigned columns, unsigned rows)
{
    const struct terminal_facts *f = &p->facts;
    if (f->graphics != facts->graphics || f->colours != facts->colours ||
        f->cell_width != facts->cell_width || f->cell_height != facts->cell_height ||
        f->shape != facts->shape || f->edits != facts->edits || p->column != column ||
        p->row != row || p->columns != columns || p->rows != rows)
        painter_forget(p);
    p->facts = *facts;
    p->column = column;
    p->row = row;
    p->columns = columns;
    p->rows = rows;
}

void painter_size(const struct painter *p, uint32_t *width, uint32_t *height)
{
    uint32_t across = p->facts.cell_width, down = p->facts.cell_height;
    if (p->facts.graphics == GRAPHICS_BLOCKS)
        blocks_pixels(p->facts.shape, &across, &down);
    *width = p->columns * across;
    *height = p->rows * down;
}

void painter_forget(struct painter *p)
{
    p->is_shown = false;
}

static bool draws_over_cells(const struct painter *p)
{
    return p->facts.graphics != GRAPHICS_KITTY;
}

static void erase(const struct painter *p, struct buf *out)
{
    buf_add_text(out, "\033[m");
    for (unsigned row = 0; row < p->rows; row++) {
        move_to(p, 0, row, out);
        buf_printf(out, "\033[%uX", p->columns);
    }
}

void painter_remove(struct painter *p, struct buf *out)
{
    if (p->image > 0)
        kitty_delete(p->image, out);
    if (p->is_shown && draws_over_cells(p))
        erase(p, out);
    p->image = 0;
    p->is_shown = false;
}

void painter_release(struct painter *p)
{
    for (unsigned i = 0; i < 2; i++) {
        free(p->of[i].bytes);
        free(p->of[i].cell);
    }
    shades_release(&p->shades);
    png_release(&p->png);
    sixel_release(&p->sixel);
    *p = (struct painter){0};
}

/* What was the next picture is the one that is shown. */
static void turn_over(struct painter *p)
{
    const struct painter_picture former = p->of[0];
    p->of[0] = p->of[1];
    p->of[1] = former;
    p->is_shown = true;
}

/* ---- cells ---- */

static void write_changes(const struct painter *p, bool all, struct buf *out)
{
    struct block_pen pen = {p->facts.colours, p->facts.shape, BLOCK_DEFAULT, BLOCK_DEFAULT};
    const size_t before = out->length;
    for (unsigned row = 0; row < p->rows; row++) {
        unsigned at = UINT_MAX; /* where the cursor is in this row */
        for (unsigned column = 0; column < p->columns; column++) {
            const size_t i = (size_t)row * p->columns + column;
            if (!all && blocks_equal(&p->of[0].cell[i], &p->of[1].cell[i]))
                continue;
            if (out->length == before && pen.colours != COLOURS_NONE)
                buf_add_text(out, "\033[m");
            if (at == UINT_MAX)
                move_to(p, column, row, out);
            else if (at < column)
                buf_printf(out, "\033[%uC", column - at);
            blocks_put(&pen, &p->of[1].cell[i], out);
            at = column + 1;
        }
    }
    if (out->length > before && pen.colours != COLOURS_NONE)
        buf_add_text(out, "\033[m");
}

static bool show_cells(struct painter *p, const struct image_view *view, struct buf *out)
{
    const size_t cells = (size_t)p->columns * p->rows;
    const bool colourless = p->facts.colours == COLOURS_NONE;
    for (unsigned i = 0; i < 2; i++)
        if (!mem_grow(&p->of[i].cell, &p->of[i].cells, cells, sizeof *p->of[i].cell))
            return false;
    for (size_t i = 0; i < cells; i++)
        p->of[1].cell[i] = (struct block){BLOCK_DEFAULT, BLOCK_DEFAULT, colourless ? ' ' : 0};
    blocks_fill(p->of[1].cell, p->columns, view, p->facts.colours, p->facts.shape);
    write_changes(p, !p->is_shown, out);
    return !out->failed;
}

/* ---- pixels ---- */

static uint32_t least(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static uint32_t whole(uint32_t length, uint32_t unit)
{
    return (length + unit - 1) / unit * unit;
}

static struct raster raster_of(const struct painter *p, unsigned i)
{
    struct raster raster = {.width = p->width,
                            .height = p->height,
                            .stride = (size_t)p->width * (p->has_palette ? 1 : 3),
                            .bytes = p->of[i].bytes};
    if (p->has_palette) {
        raster.colour = p->shades.colour;
        raster.colours = p->shades.count;
    }
    return raster;
}

static bool fill(struct painter *p, const struct image_view *view)
{
    return shaded_fill(p->of[1].bytes, p->width, p->height, &p->shades, view, p->has_palette);
}

static struct stale_rule rule_of(const struct painter *p)
{
    if (!draws_over_cells(p))
        return (struct stale_rule){PIXEL_TILE, PIXEL_TILE, false, KITTY_BOX_COST};
    return (struct stale_rule){p->facts.cell_width, p->facts.cell_height, true,
                               p->facts.graphics == GRAPHICS_SIXEL ? SIXEL_BOX_COST
                                                                   : ITERM_BOX_COST};
}

/* The most pixels of a side that are drawn at all, in whole cells. */
static uint32_t side_most(const struct painter *p, uint32_t cell)
{
    const uint32_t cells = p->facts.image_side_most / cell;
    return cells > 0 ? cells * cell : UINT32_MAX;
}

/* Sixels, in as many pictures as the terminal's limit asks for: beyond it xterm draws nothing. */
static void add_sixels(struct painter *p, const struct raster *raster, struct raster_box box,
                       struct buf *out)
{
    const uint32_t across = side_most(p, p->facts.cell_width);
    const uint32_t down = side_most(p, p->facts.cell_height);
    for (uint32_t y = 0; y < box.height; y += least(down, box.height - y))
        for (uint32_t x = 0; x < box.width; x += least(across, box.width - x)) {
            const struct raster_box piece = {box.left + x, box.top + y,
                                             least(across, box.width - x),
                                             least(down, box.height - y)};
            const struct raster part = raster_part(raster, piece);
            move_to(p, piece.left / p->facts.cell_width, piece.top / p->facts.cell_height, out);
            sixel_add(&p->sixel, &part, out);
        }
}

/* `box` is whole cells. */
static void add_over_cells(struct painter *p, const struct raster *raster, struct raster_box box,
                           enum png_effort effort, struct buf *out)
{
    const uint32_t width = p->facts.cell_width, height = p->facts.cell_height;
    const struct raster part = raster_part(raster, box);
    if (p->facts.graphics == GRAPHICS_SIXEL) {
        add_sixels(p, raster, box, out);
        return;
    }
    move_to(p, box.left / width, box.top / height, out);
    iterm_add(&p->png, &part, box.width / width, box.height / height, effort, out);
}

static void show_patches(struct painter *p, const struct stale *stale, bool is_coarse,
                         struct buf *out)
{
    const struct raster raster = raster_of(p, 1);
    const enum png_effort effort = stale->cost < FAST_FROM || is_coarse ? PNG_SMALL : PNG_FAST;
    for (unsigned i = 0; i < stale->count; i++) {
        const struct raster_box box = stale->box[i];
        const struct raster part = raster_part(&raster, box);
        if (draws_over_cells(p))
            add_over_cells(p, &raster, box, effort, out);
        else
            kitty_patch(&p->png, &part, effort, p->image, box.left, box.top, out);
    }
}

static void show_whole(struct painter *p, struct buf *out)
{
    const struct raster raster = raster_of(p, 1);
    if (draws_over_cells(p)) {
        add_over_cells(p, &raster, (struct raster_box){0, 0, p->width, p->height}, PNG_FAST, out);
        return;
    }
    const uint32_t former = p->image, image = former == IMAGE ? IMAGE + 1 : IMAGE;
    move_to(p, 0, 0, out);
    kitty_show(&p->png, &raster, image, out);
    if (former > 0)
        kitty_delete(former, out);
    if (!out->failed)
        p->image = image;
}

/* A picture of another size cannot be compared, and what it leaves uncovered is erased. */
static void take_size(struct painter *p, const struct image_view *view, struct buf *out)
{
    uint32_t width = view->width, height = view->height;
    if (draws_over_cells(p)) {
        width = whole(width, p->facts.cell_width);
        height = whole(height, p->facts.cell_height);
    }
    if (p->is_shown && draws_over_cells(p) && (width < p->width || height < p->height))
        erase(p, out);
    if (width != p->width || height != p->height)
        painter_forget(p);
    p->width = width;
    p->height = height;
}

/* Whether a picture has a palette: it must, it must not, or only one that has all its colours. */
enum palette_need { PALETTE_ALWAYS, PALETTE_NEVER, PALETTE_EXACT };

static enum palette_need need_of(const struct painter *p, const struct image_view *view)
{
    if (shaded_has_palette(view, p->facts.graphics == GRAPHICS_SIXEL ? SHADED_SIXEL : SHADED_PNG))
        return PALETTE_ALWAYS;
    return view->smooth ? PALETTE_NEVER : PALETTE_EXACT;
}

/* Whether the palette that is there, or none, will do for a picture that changes the last one. */
static bool can_compare(const struct painter *p, const struct image_view *view)
{
    const enum palette_need need = need_of(p, view);
    if (!p->is_shown || (need == PALETTE_NEVER && p->has_palette) ||
        (need == PALETTE_ALWAYS && !p->has_palette) ||
        (need == PALETTE_EXACT && p->has_palette && !p->shades.is_exact))
        return false;
    return !p->has_palette || shades_serve(&p->shades, view);
}

/* True where patches make it, with stale->count 0 where nothing is to be done. */
static bool can_patch(struct painter *p, const struct image_view *view, struct stale *stale)
{
    if (!can_compare(p, view) || !fill(p, view))
        return false;
    const struct raster now = raster_of(p, 1), then = raster_of(p, 0);
    const struct stale_rule rule = rule_of(p);
    stale_find(stale, &now, &then, &rule);
    if (stale->count == 0)
        return true;
    if (p->facts.graphics == GRAPHICS_KITTY && !p->facts.edits)
        return false;
    const uint64_t all = (uint64_t)p->width * p->height;
    if (p->has_palette && stale->cost > all / 32 && shades_lack(&p->shades, view))
        return false;
    return stale->cost < all / 2;
}

/* Palette and memory for a picture that goes whole; false without memory. */
static bool begin_whole(struct painter *p, const struct image_view *view)
{
    const enum palette_need need = need_of(p, view);
    size_t bytes;
    p->has_palette =
        need == PALETTE_ALWAYS || (need == PALETTE_EXACT && shades_take_exact(&p->shades, view));
    return (need != PALETTE_ALWAYS || shades_choose(&p->shades, view)) &&
           size_multiply((size_t)p->width * (p->has_palette ? 1 : 3), p->height, &bytes) &&
           mem_grow(&p->of[0].bytes, &p->of[0].capacity, bytes, 1) &&
           mem_grow(&p->of[1].bytes, &p->of[1].capacity, bytes, 1);
}

static bool show_pixels(struct painter *p, const struct image_view *view, struct buf *out)
{
    struct stale stale;
    take_size(p, view, out);
    if (can_patch(p, view, &stale)) {
        show_patches(p, &stale, view->is_coarse, out);
        return !out->failed;
    }
    if (!begin_whole(p, view))
        return false;
    fill(p, view);
    show_whole(p, out);
    return !out->failed;
}

/* ---- pictures ---- */

/* The part of a view that the place has room for; *copy is to be freed. */
static bool cut(struct image_view *view, uint32_t width, uint32_t height, uint8_t **copy)
{
    const size_t stride = (size_t)view->width * 4, kept = (size_t)width * 4;
    *copy = NULL;
    if (view->height > height)
        view->height = height;
    if (view->width <= width)
        return true;
    if (!(*copy = mem_array(view->height, kept)))
        return false;
    for (uint32_t y = 0; y < view->height; y++)
        memcpy(*copy + y * kept, view->rgba + y * stride, kept);
    view->rgba = *copy;
    view->width = width;
    return true;
}

bool painter_show(struct painter *p, const struct image_view *view, struct buf *out)
{
    struct image_view fitting = *view;
    uint32_t width, height;
    uint8_t *copy = NULL;
    painter_size(p, &width, &height);
    if (view->width == 0 || view->height == 0 || width == 0 || height == 0 ||
        p->facts.graphics == GRAPHICS_NONE)
        return true;
    const bool fine = cut(&fitting, width, height, &copy) &&
                      (p->facts.graphics == GRAPHICS_BLOCKS ? show_cells(p, &fitting, out)
                                                            : show_pixels(p, &fitting, out));
    free(copy);
    if (fine) {
        turn_over(p);
        return true;
    }
    painter_forget(p);
    out->failed = true;
    return false;
}
