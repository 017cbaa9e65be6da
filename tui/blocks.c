#include "tui/blocks.h"

#include <stdlib.h>

/* ---- 256 colours ---- */

static uint32_t distance(uint32_t a, uint32_t b)
{
    uint32_t sum = 0;
    for (unsigned shift = 0; shift < 24; shift += 8) {
        int32_t d = (int32_t)(a >> shift & 255) - (int32_t)(b >> shift & 255);
        sum += (uint32_t)(d * d);
    }
    return sum;
}

/* Levels of the cube are 0, 95, 135, 175, 215, 255. */
static uint32_t cube_place(uint32_t channel)
{
    return channel < 48 ? 0 : channel < 115 ? 1 : (channel - 35) / 40;
}

static uint32_t cube_level(uint32_t place)
{
    return place == 0 ? 0 : 55 + 40 * place;
}

uint8_t blocks_nearest_256(uint32_t colour)
{
    uint32_t red = colour >> 16, green = colour >> 8 & 255, blue = colour & 255;
    uint32_t r = cube_place(red), g = cube_place(green), b = cube_place(blue);
    uint32_t in_cube = cube_level(r) << 16 | cube_level(g) << 8 | cube_level(b);
    uint32_t mean = (red + green + blue) / 3;
    uint32_t step = mean < 8 ? 0 : mean > 238 ? 23 : (mean - 3) / 10; /* levels 8, 18 .. 238 */
    uint32_t grey = (8 + 10 * step) * UINT32_C(0x010101);
    if (distance(colour, grey) < distance(colour, in_cube))
        return (uint8_t)(232 + step);
    return (uint8_t)(16 + 36 * r + 6 * g + b);
}

/* ---- cells ---- */

struct pen {
    enum colours colours;
    int64_t ink, paper; /* what the terminal has now, -1 for its default */
};

/* The colour as the terminal will show it, so that equal ones are recognised as equal. */
static int64_t shown(const struct pen *pen, uint32_t colour)
{
    return pen->colours != COLOURS_24BIT ? blocks_nearest_256(colour) : colour;
}

static void set_colour(struct pen *pen, int64_t colour, bool paper, struct buf *out)
{
    int64_t *now = paper ? &pen->paper : &pen->ink;
    unsigned c = (unsigned)colour;
    if (*now == colour)
        return;
    *now = colour;
    if (pen->colours != COLOURS_24BIT)
        buf_printf(out, "\033[%c8;5;%um", paper ? '4' : '3', c);
    else
        buf_printf(out, "\033[%c8;2;%u;%u;%um", paper ? '4' : '3', c >> 16, c >> 8 & 255, c & 255);
}

static void put_cell(struct pen *pen, uint32_t upper, uint32_t lower, struct buf *out)
{
    int64_t top = shown(pen, upper), bottom = shown(pen, lower);
    if (top == bottom) {
        set_colour(pen, top, true, out);
        buf_add_char(out, ' ');
    } else if (pen->ink == bottom && pen->paper == top) {
        buf_add_text(out, "\u2584"); /* the lower half block: nothing to change */
    } else {
        set_colour(pen, top, false, out);
        set_colour(pen, bottom, true, out);
        buf_add_text(out, "\u2580");
    }
}

static uint32_t luminance(uint32_t colour)
{
    return (299 * (colour >> 16) + 587 * (colour >> 8 & 255) + 114 * (colour & 255)) / 1000;
}

static char ramp(uint32_t upper, uint32_t lower)
{
    static const char ink[] = " .:-=+*#%@";
    uint32_t light = (luminance(upper) + luminance(lower) + 1) / 2;
    return ink[(light * (sizeof ink - 2) + 127) / 255];
}

static void put_row(const struct image_view *view, enum colours colours, uint32_t y,
                    struct buf *out)
{
    struct pen pen = {.colours = colours, .ink = -1, .paper = -1};
    size_t first = (size_t)y * view->width;
    size_t text_end = out->length; /* of a line without colours: its trailing blanks go */
    for (size_t i = first; i < first + view->width; i++) {
        uint32_t upper = image_view_colour(view, i);
        uint32_t lower = y + 1 < view->height ? image_view_colour(view, i + view->width) : 0;
        if (colours != COLOURS_NONE) {
            put_cell(&pen, upper, lower, out);
        } else {
            char c = ramp(upper, lower);
            buf_add_char(out, c);
            if (c != ' ')
                text_end = out->length;
        }
    }
    if (colours != COLOURS_NONE)
        buf_add_text(out, "\033[m");
    else if (!out->failed)
        out->length = text_end;
    buf_add_text(out, "\r\n");
}

void blocks_encode(const struct image_view *view, enum colours colours, uint32_t columns,
                   uint32_t rows, struct buf *out)
{
    struct image_view small = {0};
    image_view_fit(view, columns, rows > UINT32_MAX / 2 ? rows : 2 * rows, &small.width,
                   &small.height);
    uint8_t *rgba = image_view_shrink(view, small.width, small.height);
    if (!rgba) {
        out->failed = true;
        return;
    }
    small.rgba = rgba;
    for (uint32_t y = 0; y < small.height; y += 2)
        put_row(&small, colours, y, out);
    free(rgba);
}
