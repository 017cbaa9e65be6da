/* SPDX-License-Identifier: MIT */
/*
 * Pictures made of text, for terminals without graphics: block characters, whose foreground (ink)
 * covers some parts of the cell and whose background (paper) the others.
 *
 *     ESC[38;2;200;10;10;48;2;90;5;5m U+2580      ink and paper, and the upper half block
 *     38;5;N and 48;5;N with 256 colours; 30..37, 90..97 and 40..47, 100..107 with 16
 *
 *     BLOCK_HALF 1x2 parts   BLOCK_QUADRANT 2x2, U+2596 ..   BLOCK_SEXTANT 2x3, U+1FB00 ..
 *
 * A cell of more than two colours is split into the two sets with the least squared error to their
 * means. A colour is sent only where it changes; a cell of one colour is a space on it. Without
 * colours a cell is one character of a ramp from dark to bright. A note of the view
 * (tui/picture/image_view.h) is a cell of its own: a bright character on black.
 *
 * A cell counts as half as wide as it is high, as nearly all are. So that pixels are square, a cell
 * has 1x2, 2x4 or 6x12 of them, and each part is the mean of its own.
 *
 * Lines over a slice, contours, cross-hair, marks and frame, are thinner than a part: a mean would
 * hide them. So a part with a line has the line's colour alone, and a cell with lines has them in
 * one of its two colours, and all else in the other.
 */
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "base/least.h"
#include "base/mem.h"
#include "base/safe.h"
#include "tui/cells.h"
#include "tui/picture/graphics.h"

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

/* The levels of the cube are 0, 95, 135, 175, 215, 255. */
static uint32_t cube_place(uint32_t channel)
{
    return channel < 48 ? 0 : channel < 115 ? 1 : (channel - 35) / 40;
}

static uint32_t cube_level(uint32_t place)
{
    return place == 0 ? 0 : 55 + 40 * place;
}

/* The nearest of the 240 fixed entries (16..255) of the 256-colour palette: a 6x6x6 cube and a
 * ramp of 24 greys. */
static uint8_t nearest_256(uint32_t colour)
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

/* Return the nearest of the 16 colours as xterm has them. */
static uint8_t nearest_16(uint32_t colour)
{
    static const uint32_t xterm[16] = {0x000000, 0xCD0000, 0x00CD00, 0xCDCD00, 0x0000EE, 0xCD00CD,
                                       0x00CDCD, 0xE5E5E5, 0x7F7F7F, 0xFF0000, 0x00FF00, 0xFFFF00,
                                       0x5C5CFF, 0xFF00FF, 0x00FFFF, 0xFFFFFF};
    uint8_t best = 0;
    for (uint8_t i = 1; i < 16; i++)
        if (distance(colour, xterm[i]) < distance(colour, xterm[best]))
            best = i;
    return best;
}

/* ---- from pixels to cells ---- */

enum { PARTS_MOST = 6 };

/* Parts of a cell, and its pixels across; twice as many are below each other. */
static const struct {
    uint32_t columns, rows, width;
} cell_of[] = {[BLOCK_HALF] = {1, 2, 1}, [BLOCK_QUADRANT] = {2, 2, 2}, [BLOCK_SEXTANT] = {2, 3, 6}};

static void cell_pixels(const struct terminal_facts *facts, uint32_t *width, uint32_t *height)
{
    *width = cell_of[facts->shape].width;
    *height = 2 * *width;
}

/* A part of a cell: the mean of its pixels, or of those of lines, and how far these differ from the
 * slice below them: 0 without lines. */
struct part {
    uint32_t colour, contrast;
};

/* Return the contrast of a pixel, 1..255, if it belongs to a line: it has a colour over the grey of
 * a slice, is much brighter, or is a mark. Darker greys next to a line are no part of it. */
static uint32_t contrast_at(const struct image_view *view, bool is_slice, size_t at)
{
    enum { BRIGHTER = 24 };
    const uint8_t *p = view->rgba + 4 * at, below = is_slice ? view->below[at] : 0;
    const bool is_grey = p[0] == p[1] && p[0] == p[2];
    if (view->words && view->words[at])
        return 255;
    if (!is_slice || (is_grey && p[0] < below + BRIGHTER))
        return 0;
    return shades_apart(image_view_colour(view, at), below * UINT32_C(0x010101));
}

/* Return the smallest contrast of a line. Where all pixels or parts have some, as in a tint, a line
 * has most of it. */
static uint32_t least_of_lines(uint32_t least, uint32_t most)
{
    return least > 0 ? (2 * most + 2) / 3 : 1;
}

/* Pixels outside the view are black. */
static struct part part_of(const struct image_view *view, bool is_slice,
                           const struct raster_box *box)
{
    enum { PIXELS_MOST = 12 };
    uint32_t contrast[PIXELS_MOST], sum[3] = {0}, count = 0, least_contrast = 255;
    const uint32_t pixels = box->width * box->height;
    struct part part = {0, 0};
    for (uint32_t i = 0; i < pixels; i++) {
        const uint32_t x = box->left + i % box->width, y = box->top + i / box->width;
        const bool is_inside = x < view->width && y < view->height;
        contrast[i] = is_inside ? contrast_at(view, is_slice, (size_t)y * view->width + x) : 0;
        part.contrast = contrast[i] > part.contrast ? contrast[i] : part.contrast;
        least_contrast = least(contrast[i], least_contrast);
    }
    const uint32_t from = part.contrast ? least_of_lines(least_contrast, part.contrast) : 0;
    for (uint32_t i = 0; i < pixels; i++) {
        const uint32_t x = box->left + i % box->width, y = box->top + i / box->width;
        if (contrast[i] < from)
            continue;
        count++;
        if (x >= view->width || y >= view->height)
            continue;
        const uint32_t c = image_view_colour(view, (size_t)y * view->width + x);
        for (unsigned k = 0; k < 3; k++)
            sum[k] += c >> (16 - 8 * k) & 255;
    }
    for (unsigned k = 0; k < 3; k++)
        part.colour = part.colour << 8 | (sum[k] + count / 2) / count;
    return part;
}

static uint32_t mean_of(const uint32_t sum[3], unsigned set)
{
    const unsigned count = (unsigned)__builtin_popcount(set);
    uint32_t mean = 0;
    for (unsigned k = 0; k < 3; k++)
        mean = mean << 8 | (sum[k] + count / 2) / count;
    return mean;
}

/* The squared error of a set to its mean is the sum of squares minus this, in sixtieths, which are
 * whole for sets of 1 .. 6 parts. */
static uint32_t explained(const uint32_t sum[3], unsigned set)
{
    return (sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) *
           (60 / (unsigned)__builtin_popcount(set));
}

/* Return the best set of parts for the ink, for more than two colours; the first part has the
 * paper's colour. */
static unsigned best_parts(uint32_t sum[][3], unsigned all)
{
    uint32_t most = 0;
    unsigned best = 2;
    for (unsigned set = 2; set < all; set += 2) {
        const uint32_t e = explained(sum[set], set) + explained(sum[all ^ set], all ^ set);
        if (e > most) {
            most = e;
            best = set;
        }
    }
    return best;
}

static int32_t number_of(uint32_t colour, enum colours colours)
{
    return colours == COLOURS_256  ? nearest_256(colour)
           : colours == COLOURS_16 ? nearest_16(colour)
                                   : (int32_t)colour;
}

/* The parts in the bits of `lines` get a colour of their own. */
static struct block coloured(const uint32_t *colour, unsigned count, unsigned lines,
                             enum colours colours)
{
    const unsigned all = (1u << count) - 1;
    uint32_t sum[1 << PARTS_MOST][3];
    unsigned parts = 0;
    for (unsigned i = 1; i < count; i++)
        parts |= (unsigned)(colour[i] != colour[0]) << i;
    if (!parts) /* most cells have one colour */
        return (struct block){.ink = BLOCK_DEFAULT, .paper = number_of(colour[0], colours)};
    /* Sums of the channels of each set, by its bits: a set is its first part and the rest. */
    memset(sum[0], 0, sizeof sum[0]);
    for (unsigned set = 1; set < 1u << count; set++)
        for (unsigned k = 0; k < 3; k++)
            sum[set][k] =
                sum[set & (set - 1)][k] + (colour[__builtin_ctz(set)] >> (16 - 8 * k) & 255);
    if (lines && lines != all)
        parts = lines & 1 ? all ^ lines : lines;
    else if (count > 2)
        parts = best_parts(sum, all);
    const int32_t ink = number_of(mean_of(sum[parts], parts), colours);
    const int32_t paper = number_of(mean_of(sum[all ^ parts], all ^ parts), colours);
    if (ink == paper)
        return (struct block){.ink = BLOCK_DEFAULT, .paper = paper};
    return (struct block){ink, paper, (uint8_t)parts, 0};
}

static struct block colourless(const uint32_t *colour, unsigned count)
{
    static const char ink[] = " .:-=+*#%@";
    uint32_t light = count / 2;
    for (unsigned i = 0; i < count; i++) /* luminance */
        light +=
            (299 * (colour[i] >> 16) + 587 * (colour[i] >> 8 & 255) + 114 * (colour[i] & 255)) /
            1000;
    light /= count;
    return (struct block){BLOCK_DEFAULT, BLOCK_DEFAULT,
                          (uint8_t)ink[(light * (sizeof ink - 2) + 127) / 255], 0};
}

/* Return true if a pixel belongs to a slice, as all of its cell do. */
static bool is_in_slice(const struct image_view *view, uint32_t x, uint32_t y)
{
    bool is_slice = false;
    for (unsigned i = 0; i < view->slices; i++)
        is_slice |= x - view->slice[i].left < view->slice[i].width &&
                    y - view->slice[i].top < view->slice[i].height;
    return is_slice;
}

void blocks_fill(struct block *cell, size_t stride, const struct image_view *view,
                 const struct terminal_facts *facts)
{
    const uint32_t across = cell_of[facts->shape].columns, down = cell_of[facts->shape].rows;
    uint32_t width, height, colour[PARTS_MOST];
    cell_pixels(facts, &width, &height);
    struct raster_box box = {0, 0, width / across, height / down};
    for (uint32_t top = 0; top < view->height; top += height, cell += stride)
        for (uint32_t left = 0; left < view->width; left += width) {
            const bool is_slice = is_in_slice(view, left, top);
            uint32_t contrast[PARTS_MOST], most = 0, least_contrast = 255;
            unsigned lines = 0;
            for (unsigned i = 0; i < across * down; i++) {
                box.left = left + i % across * box.width;
                box.top = top + i / across * box.height;
                const struct part part = part_of(view, is_slice, &box);
                colour[i] = part.colour;
                contrast[i] = part.contrast;
                most = part.contrast > most ? part.contrast : most;
                least_contrast = least(part.contrast, least_contrast);
            }
            for (unsigned i = 0; i < across * down; i++)
                lines |= (unsigned)(contrast[i] >= least_of_lines(least_contrast, most)) << i;
            cell[left / width] = facts->colours == COLOURS_NONE
                                     ? colourless(colour, across * down)
                                     : coloured(colour, across * down, lines, facts->colours);
        }
}

/* ---- bytes ---- */

/* Colours of the terminal's next character. */
struct pen {
    enum colours colours;
    enum block_shape shape;
    int32_t ink, paper;
};

static void add_colour(const struct pen *pen, int32_t colour, bool paper, struct buf *out)
{
    const unsigned c = (unsigned)colour;
    if (colour == BLOCK_DEFAULT)
        buf_add_text(out, paper ? "49" : "39");
    else if (pen->colours == COLOURS_16)
        buf_printf(out, "%u", (c < 8 ? 30 + c : 82 + c) + (paper ? 10 : 0));
    else if (pen->colours == COLOURS_256)
        buf_printf(out, "%c8;5;%u", paper ? '4' : '3', c);
    else
        buf_printf(out, "%c8;2;%u;%u;%u", paper ? '4' : '3', c >> 16, c >> 8 & 255, c & 255);
}

static void set_colours(struct pen *pen, int32_t ink, int32_t paper, struct buf *out)
{
    const bool inks = ink != pen->ink, papers = paper != pen->paper;
    if (!inks && !papers)
        return;
    buf_add_text(out, "\033[");
    if (inks)
        add_colour(pen, ink, false, out);
    if (inks && papers)
        buf_add_char(out, ';');
    if (papers)
        add_colour(pen, paper, true, out);
    buf_add_char(out, 'm');
    pen->ink = ink;
    pen->paper = paper;
}

/* Return the character whose ink covers these parts; neither none nor all of them. */
static uint32_t character_of(enum block_shape shape, unsigned parts)
{
    static const uint16_t quadrant[16] = {0x0020, 0x2598, 0x259D, 0x2580, 0x2596, 0x258C,
                                          0x259E, 0x259B, 0x2597, 0x259A, 0x2590, 0x259C,
                                          0x2584, 0x2599, 0x259F, 0x2588};
    enum { LEFT_HALF = 21, RIGHT_HALF = 42 }; /* not among the sextants */
    if (shape == BLOCK_HALF)
        return parts == 1 ? 0x2580 : 0x2584;
    if (shape == BLOCK_QUADRANT)
        return quadrant[parts];
    if (parts == LEFT_HALF || parts == RIGHT_HALF)
        return parts == LEFT_HALF ? 0x258C : 0x2590;
    return 0x1FB00 + parts - 1 - (parts > LEFT_HALF) - (parts > RIGHT_HALF);
}

static void add_parts(enum block_shape shape, unsigned parts, struct buf *out)
{
    char character[UTF8_BYTES_MOST];
    buf_add(out, character, utf8_write(character, character_of(shape, parts)));
}

/* Add a cell, which moves the cursor by one. */
static void put_cell(struct pen *pen, const struct block *cell, struct buf *out)
{
    const unsigned all = (1u << cell_of[pen->shape].columns * cell_of[pen->shape].rows) - 1;
    if (pen->colours == COLOURS_NONE) {
        buf_add_char(out, (char)cell->parts);
    } else if (cell->note) {
        set_colours(pen, cell->ink, cell->paper, out);
        buf_add_char(out, cell->note);
    } else if (!cell->parts) {
        set_colours(pen, pen->ink, cell->paper, out);
        buf_add_char(out, ' ');
    } else if ((pen->ink == cell->ink) + (pen->paper == cell->paper) >
               (pen->ink == cell->paper) + (pen->paper == cell->ink)) {
        set_colours(pen, cell->ink, cell->paper, out);
        add_parts(pen->shape, cell->parts, out);
    } else {
        set_colours(pen, cell->paper, cell->ink, out);
        add_parts(pen->shape, all & ~(unsigned)cell->parts, out);
    }
}

/* ---- lines ---- */

/* Add the view, shrunk into columns x rows cells in its own shape, as lines that end in CR LF. */
static void lines(const struct terminal_facts *facts, const struct image_view *view,
                  uint32_t columns, uint32_t rows, struct buf *out)
{
    const bool is_plain = facts->colours == COLOURS_NONE;
    struct image_view small = *view;
    uint32_t width, height;
    cell_pixels(facts, &width, &height);
    image_view_fit(view, (uint32_t)least_64((uint64_t)columns * width, UINT32_MAX),
                   (uint32_t)least_64((uint64_t)rows * height, UINT32_MAX), &small.width,
                   &small.height);
    const size_t across = (small.width + width - 1) / width;
    const size_t down = (small.height + height - 1) / height;
    OWNED(mem_release) uint8_t *rgba = image_view_shrink(view, small.width, small.height);
    OWNED(mem_release) struct block *cell = mem_array(across * down, sizeof *cell);
    small.rgba = rgba;
    if (rgba && cell)
        blocks_fill(cell, across, &small, facts);
    else
        out->failed = true;
    for (size_t y = 0; y < down && !out->failed; y++) {
        struct pen pen = {facts->colours, facts->shape, BLOCK_DEFAULT, BLOCK_DEFAULT};
        size_t columns_used = across;
        while (is_plain && columns_used > 0 && cell[y * across + columns_used - 1].parts == ' ')
            columns_used--;
        for (size_t x = 0; x < columns_used; x++)
            put_cell(&pen, &cell[y * across + x], out);
        buf_add_text(out, is_plain ? "\r\n" : "\033[m\r\n");
    }
}

/* ---- as a way to show pictures ---- */

/* The painter's bytes are cells for text. */
static bool show(struct painter *p, const struct image_view *view, struct buf *out)
{
    const size_t cells = (size_t)p->columns * p->rows;
    const enum colours colours = p->facts.colours;
    for (unsigned i = 0; i < 2; i++)
        if (!mem_grow(&p->of[i].bytes, &p->of[i].capacity, cells * sizeof(struct block), 1))
            return false;
    struct block *then = (void *)p->of[0].bytes, *now = (void *)p->of[1].bytes;
    for (size_t i = 0; i < cells; i++)
        now[i] = (struct block){BLOCK_DEFAULT, BLOCK_DEFAULT, colours == COLOURS_NONE ? ' ' : 0, 0};
    blocks_fill(now, p->columns, view, &p->facts);
    static const uint32_t ink = 0xE8E8E8, paper = 0x000000;
    for (size_t i = 0; i < view->notes; i++) {
        const struct raster_note *note = &view->note[i];
        if (note->column >= p->columns || note->row >= p->rows)
            continue;
        struct block *at = &now[(size_t)note->row * p->columns + note->column];
        *at = colours == COLOURS_NONE
                  ? (struct block){BLOCK_DEFAULT, BLOCK_DEFAULT, (uint8_t)note->character, 0}
                  : (struct block){number_of(ink, colours), number_of(paper, colours), 0,
                                   note->character};
    }
    struct pen pen = {colours, p->facts.shape, BLOCK_DEFAULT, BLOCK_DEFAULT};
    const size_t before = out->length;
    for (unsigned row = 0; row < p->rows; row++) {
        unsigned at = UINT_MAX; /* column of the cursor in this row */
        for (unsigned column = 0; column < p->columns; column++) {
            const size_t i = (size_t)row * p->columns + column;
            if (p->is_shown && (then[i].parts == now[i].parts && then[i].ink == now[i].ink &&
                                then[i].paper == now[i].paper && then[i].note == now[i].note))
                continue;
            if (out->length == before && pen.colours != COLOURS_NONE)
                buf_add_text(out, "\033[m");
            if (at == UINT_MAX)
                painter_move_to(p, column, row, out);
            else if (at < column)
                buf_printf(out, "\033[%uC", column - at);
            put_cell(&pen, &now[i], out);
            at = column + 1;
        }
    }
    if (out->length > before && pen.colours != COLOURS_NONE)
        buf_add_text(out, "\033[m");
    return !out->failed;
}

static bool has_sextants(const struct probe_replies *replies)
{
    return probe_shape(replies) == BLOCK_SEXTANT;
}

static bool has_quadrants(const struct probe_replies *replies)
{
    return probe_shape(replies) >= BLOCK_QUADRANT;
}

#define TEXT .kind = GRAPHICS_TEXT, .cell_pixels = cell_pixels, .show = show, .lines = lines

const struct graphics graphics_sextants = {
    .name = "sextants",
    .title = "text: sextants",
    .fits = has_sextants,
    .question = {"\r\xF0\x9F\xAC\x80\033[6n", probe_asks_for_sextants},
    .shape = BLOCK_SEXTANT,
    TEXT,
};

const struct graphics graphics_quadrants = {
    .name = "quadrants",
    .title = "text: quadrants",
    .fits = has_quadrants,
    .shape = BLOCK_QUADRANT,
    TEXT,
};

const struct graphics graphics_halves = {
    .name = "halves",
    .title = "text: half blocks",
    .shape = BLOCK_HALF,
    TEXT,
};
