/* SPDX-License-Identifier: MIT */
/* The painter against a small model of each terminal: after every picture the screen must show that
 * picture, whatever was there before. */
#include "tests/check_main.h"
#include "tests/kitty_decode.h"
#include "tests/sixel_decode.h"
#include "tests/scarce_memory.h"
#include "tui/picture/graphics.h"
#include "tui/picture/painter.h"
#include "tui/picture/shades.h"

/* ---- pictures ---- */

enum { SIDE_MOST = 400, BLANK = 0x123456 };

static uint8_t pixels[4 * SIDE_MOST * SIDE_MOST];
static const uint32_t hues[] = {0xD6B296, 0x56B4E9, 0xF0C842, 0x6B594B};

static struct image_view picture(uint32_t width, uint32_t height)
{
    memset(pixels, 0, sizeof pixels);
    return (struct image_view){
        .width = width, .height = height, .rgba = pixels, .hue = hues, .hues = 4};
}

/* A hue in this light, of 255. */
static uint32_t lit(uint32_t hue, uint32_t light)
{
    uint32_t colour = 0;
    for (unsigned shift = 24; shift > 0;) {
        shift -= 8;
        colour = colour << 8 | (hue >> shift & 255) * light / 255;
    }
    return colour;
}

static void put(size_t i, uint32_t colour)
{
    for (unsigned k = 0; k < 3; k++)
        pixels[4 * i + k] = (uint8_t)(colour >> (16 - 8 * k));
    pixels[4 * i + 3] = 255;
}

/* A shade of one of the hues; at times a highlight, a grey, or a tint. */
static uint32_t random_shade(uint64_t *seed)
{
    uint32_t hue = hues[check_below(seed, 3)], light = check_below(seed, 256), colour = 0;
    uint32_t kind = check_below(seed, 8), more = kind == 0 ? check_below(seed, 70) : 0;
    for (unsigned shift = 24; shift > 0;) {
        shift -= 8;
        uint32_t c = kind == 1 ? light : (hue >> shift & 255) * light / 255 + more;
        colour = colour << 8 | (c > 255 ? 255 : c);
    }
    return colour;
}

static void fill_box(const struct image_view *view, uint32_t left, uint32_t top, uint32_t width,
                     uint32_t height, uint64_t *seed)
{
    const bool is_flat = check_below(seed, 2) == 0;
    uint32_t colour = random_shade(seed);
    for (uint32_t y = top; y < top + height && y < view->height; y++)
        for (uint32_t x = left; x < left + width && x < view->width; x++) {
            const size_t i = (size_t)y * view->width + x;
            colour = is_flat ? colour : random_shade(seed);
            put(i, colour);
            if (check_below(seed, 50) == 0)
                pixels[4 * i + 3] = (uint8_t)check_below(seed, 256);
        }
}

static void fill_all(const struct image_view *view, uint64_t *seed)
{
    for (unsigned i = 0; i < 30; i++)
        fill_box(view, check_below(seed, view->width), check_below(seed, view->height),
                 1 + check_below(seed, 90), 1 + check_below(seed, 90), seed);
}

static struct image_view filled(uint32_t width, uint32_t height, uint64_t *seed)
{
    const struct image_view view = picture(width, height);
    fill_all(&view, seed);
    return view;
}

/* ---- terminals ---- */

enum { CELLS_MOST = 160, PLACEHOLDER = 0x10EEEE, SIXEL_OFF = 2 };

struct glyph {
    uint32_t point;
    int64_t ink, paper; /* -1 is the terminal's */
    uint8_t marks;      /* of a placeholder: row, column and highest byte, */
    unsigned mark[3];   /* by their places in kitty's list */
};

struct screen {
    uint32_t cell_width, cell_height, side_most;
    unsigned column, row;
    int64_t ink, paper;
    struct kitty_screen kitty;
    uint32_t pixel[SIDE_MOST * SIDE_MOST]; /* pixels drawn over cells */
    struct glyph cell[CELLS_MOST][CELLS_MOST];
};

static struct screen screen;
static struct painter painter;

static void draw(uint32_t width, uint32_t height, const uint32_t *pixel)
{
    const uint32_t left = screen.column * screen.cell_width, top = screen.row * screen.cell_height;
    for (uint32_t y = 0; y < height && top + y < SIDE_MOST; y++)
        for (uint32_t x = 0; x < width && left + x < SIDE_MOST; x++)
            screen.pixel[(top + y) * SIDE_MOST + left + x] = pixel[(size_t)y * width + x];
}

static void erase_cells(unsigned count)
{
    for (unsigned i = 0; i < count && screen.column + i < CELLS_MOST; i++)
        screen.cell[screen.row][screen.column + i] = (struct glyph){.ink = -1, .paper = -1};
    for (uint32_t y = 0; y < screen.cell_height; y++)
        for (uint32_t x = 0; x < count * screen.cell_width; x++)
            if (screen.column * screen.cell_width + x < SIDE_MOST &&
                screen.row * screen.cell_height + y < SIDE_MOST)
                screen.pixel[(screen.row * screen.cell_height + y) * SIDE_MOST +
                             screen.column * screen.cell_width + x] = BLANK;
}

static const char *take_sixel(const char *text)
{
    struct decoded_sixel s;
    bool fine = sixel_decode(&s, &text) && s.all_painted && s.width % screen.cell_width == 0 &&
                s.height % screen.cell_height == 0 && s.width <= screen.side_most &&
                s.height <= screen.side_most;
    if (fine)
        draw(s.width, s.height, s.pixel);
    free(s.pixel);
    return fine ? text : NULL;
}

static const char *take_iterm(const char *text)
{
    size_t size = 0;
    unsigned columns = 0, rows = 0;
    int taken = 0;
    const char *end = strchr(text, '\a');
    struct decoded_png png = {0};
    OWNED(buf_release) struct buf file = {0};
    bool fine = end &&
                sscanf(text,
                       "\033]1337;File=inline=1;size=%zu;width=%u;height=%u;"
                       "preserveAspectRatio=0;doNotMoveCursor=1:%n",
                       &size, &columns, &rows, &taken) == 3 &&
                taken > 0 && base64_decode(&file, text + taken, (size_t)(end - text - taken)) &&
                file.length == size &&
                png_decode(&png, (const uint8_t *)buf_text(&file), file.length) &&
                png.width == columns * screen.cell_width && png.height == rows * screen.cell_height;
    if (fine)
        draw(png.width, png.height, png.pixel);
    free(png.pixel);
    return fine ? end + 1 : NULL;
}

/* One of the 256 colours, or of 16, stays a number. */
static bool take_colours(const uint32_t *n, unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        bool paper = n[i] / 10 == 4 || n[i] / 10 == 10;
        int64_t *colour = paper ? &screen.paper : &screen.ink;
        if (n[i] == 0) {
            screen.ink = screen.paper = -1;
        } else if (n[i] % 10 == 8 && i + 2 < count && n[i + 1] == 5) {
            *colour = n[i + 2];
            i += 2;
        } else if (n[i] % 10 == 8 && i + 4 < count && n[i + 1] == 2) {
            *colour = n[i + 2] << 16 | n[i + 3] << 8 | n[i + 4];
            i += 4;
        } else if (n[i] % 10 == 9) {
            *colour = -1;
        } else if (n[i] % 10 < 8) {
            *colour = n[i] % 10 + (n[i] >= 90 ? 8 : 0);
        } else {
            return false;
        }
    }
    return true;
}

/* ESC[38;2;r;g;b;48;2;r;g;bm has ten numbers: the longest there is. */
static const char *take_csi(const char *text)
{
    uint32_t n[12];
    unsigned count = 0;
    for (text += 2;; text++) {
        n[count] = sixel_number(&text);
        if (++count == 12 || *text != ';')
            break;
    }
    if (*text == 'H' && count == 2) {
        screen.row = n[0] - 1;
        screen.column = n[1] - 1;
    } else if (*text == 'C' && count == 1 && n[0] > 0) {
        screen.column += n[0];
    } else if (*text == 'X' && count == 1) {
        erase_cells(n[0]);
    } else if (*text != 'm' || !take_colours(n, count)) {
        return NULL;
    }
    return text + 1;
}

/* The first of gen/rowcolumn-diacritics.txt of kitty; -1 for another character. */
static int mark_of(uint32_t point)
{
    static const uint16_t kitty[] = {
        0x305, 0x30d, 0x30e, 0x310, 0x312, 0x33d, 0x33e, 0x33f, 0x346, 0x34a, 0x34b, 0x34c, 0x350,
        0x351, 0x352, 0x357, 0x35b, 0x363, 0x364, 0x365, 0x366, 0x367, 0x368, 0x369, 0x36a, 0x36b,
        0x36c, 0x36d, 0x36e, 0x36f, 0x483, 0x484, 0x485, 0x486, 0x487, 0x592, 0x593, 0x594, 0x595,
        0x597, 0x598, 0x599, 0x59c, 0x59d, 0x59e, 0x59f, 0x5a0, 0x5a1, 0x5a8, 0x5a9, 0x5ab, 0x5ac,
        0x5af, 0x5c4, 0x610, 0x611, 0x612, 0x613, 0x614, 0x615, 0x616, 0x617, 0x657, 0x658};
    for (size_t i = 0; i < sizeof kitty / sizeof kitty[0]; i++)
        if (kitty[i] == point)
            return (int)i;
    return -1;
}

static bool take_mark(uint32_t point)
{
    if (screen.column == 0)
        return false;
    struct glyph *base = &screen.cell[screen.row][screen.column - 1];
    const int mark = mark_of(point);
    if (mark < 0 || base->point != PLACEHOLDER || base->marks == 3)
        return false;
    base->mark[base->marks++] = (unsigned)mark;
    return true;
}

static const char *take_character(const char *text)
{
    const uint8_t *c = (const uint8_t *)text;
    unsigned length = c[0] < 0x80 ? 1 : c[0] < 0xE0 ? 2 : c[0] < 0xF0 ? 3 : 4;
    uint32_t point = c[0] < 0x80   ? c[0]
                     : c[0] < 0xE0 ? c[0] & 31u
                     : c[0] < 0xF0 ? c[0] & 15u
                                   : c[0] & 7u;
    for (unsigned i = 1; i < length; i++) {
        if ((c[i] & 0xC0) != 0x80)
            return NULL;
        point = point << 6 | (c[i] & 63u);
    }
    if (length == 2)
        return take_mark(point) ? text + length : NULL;
    if (point < ' ' || screen.column >= CELLS_MOST || screen.row >= CELLS_MOST)
        return NULL;
    screen.cell[screen.row][screen.column++] =
        (struct glyph){.point = point, .ink = screen.ink, .paper = screen.paper};
    return text + length;
}

/* A command that tmux passes on: the terminal outside gets it with each pair of ESC as one. */
static const char *take_passed(const char *text)
{
    OWNED(buf_release) struct buf inner = {0};
    for (text += strlen("\033Ptmux;"); *text; text++) {
        if (*text == '\033' && text[1] == '\\') {
            const char *end = kitty_feed(&screen.kitty, buf_text(&inner), 0, 0);
            return end && !*end ? text + 2 : NULL;
        }
        text += *text == '\033';
        buf_add_char(&inner, *text);
    }
    return NULL;
}

/* Draw the cells that name pictures: one without marks continues the one to its left. */
static void draw_placeholders(uint32_t *seen)
{
    for (unsigned y = 0; y < CELLS_MOST; y++) {
        struct glyph left = {0};
        for (unsigned x = 0; x < CELLS_MOST; x++) {
            struct glyph g = screen.cell[y][x];
            if (g.point == PLACEHOLDER && g.marks == 0 && left.point == PLACEHOLDER &&
                left.ink == g.ink) {
                memcpy(g.mark, left.mark, sizeof g.mark);
                g.mark[1]++;
            }
            left = g;
            const struct kitty_picture *p =
                g.point == PLACEHOLDER
                    ? kitty_find(&screen.kitty, g.mark[2] << 24 | (uint32_t)g.ink)
                    : NULL;
            const uint32_t width = screen.cell_width, height = screen.cell_height;
            const uint32_t from_x = g.mark[1] * width, from_y = g.mark[0] * height;
            if (!p || p->columns * width != p->png.width || p->rows * height != p->png.height ||
                g.mark[1] >= p->columns || g.mark[0] >= p->rows)
                continue;
            for (uint32_t j = 0; j < height && y * height + j < SIDE_MOST; j++)
                for (uint32_t i = 0; i < width && x * width + i < SIDE_MOST; i++)
                    seen[(y * height + j) * SIDE_MOST + x * width + i] =
                        p->png.pixel[(size_t)(from_y + j) * p->png.width + from_x + i];
        }
    }
}

/* False where the terminal would not understand. */
static bool screen_feed(const struct buf *bytes)
{
    const char *text = buf_text(bytes);
    while (text && *text) {
        if (strncmp(text, "\033_G", 3) == 0)
            text = kitty_feed(&screen.kitty, text, screen.column, screen.row);
        else if (strncmp(text, "\033Ptmux;", 7) == 0)
            text = take_passed(text);
        else if (strncmp(text, "\033P", 2) == 0)
            text = take_sixel(text);
        else if (strncmp(text, "\033]", 2) == 0)
            text = take_iterm(text);
        else if (strncmp(text, "\033[", 2) == 0)
            text = take_csi(text);
        else
            text = take_character(text);
    }
    return text && !screen.kitty.waits;
}

/* ---- the expected screen ---- */

static struct terminal_facts facts_of(const struct graphics *graphics, uint32_t width,
                                      uint32_t height)
{
    return (struct terminal_facts){.graphics = graphics,
                                   .colours = COLOURS_24BIT,
                                   .cell_width = width,
                                   .cell_height = height,
                                   .image_side_most = 1000};
}

/* Return all pixels of the screen: those drawn over cells, and those of kitty's pictures. */
static const uint32_t *seen_pixels(void)
{
    static uint32_t seen[SIDE_MOST * SIDE_MOST];
    memcpy(seen, screen.pixel, sizeof seen);
    kitty_compose(&screen.kitty, &(struct kitty_view){screen.cell_width, screen.cell_height,
                                                      SIDE_MOST, SIDE_MOST, seen});
    draw_placeholders(seen);
    return seen;
}

static int64_t blemishes(void)
{
    const uint32_t *seen = seen_pixels();
    int64_t count = 0;
    for (size_t i = 0; i < SIDE_MOST * SIDE_MOST; i++)
        count += seen[i] != BLANK;
    return count;
}

/* Return true if the terminal stores the grey of this pixel, which shows nothing else. */
static bool is_kept(const struct image_view *view, size_t i)
{
    const uint32_t x = (uint32_t)(i % view->width), y = (uint32_t)(i / view->width);
    for (unsigned s = 0; s < view->strips; s++) {
        const struct raster_box *b = &view->strip[s].box;
        if (view->strip[s].number && x - b->left < b->width && y - b->top < b->height)
            return image_view_colour(view, i) == view->below[i] * UINT32_C(0x010101);
    }
    return false;
}

/* The colour that the palette shows for one. */
static uint32_t shades_shown(struct shades *s, uint32_t colour)
{
    const uint8_t rgba[4] = {(uint8_t)(colour >> 16), (uint8_t)(colour >> 8), (uint8_t)colour, 255};
    const struct image_view view = {.width = 1, .height = 1, .rgba = rgba};
    uint8_t place = 0;
    return s->is_exact || !shades_fill(s, true, &view, &place, 1, 1) ? colour : s->colour[place];
}

static uint32_t expected_at(const struct image_view *view, size_t i)
{
    uint32_t colour = image_view_colour(view, i);
    if (painter.has_palette && is_kept(view, i))
        return strips_colour(strips_level(view->below[i]));
    if (painter.has_palette)
        colour = shades_shown(&painter.shades, colour);
    return painter.facts.graphics == &graphics_sixel ? sixel_round_trip(colour) : colour;
}

/* Count the pixels of the place that differ from the view, which is extended with black to whole
 * cells if cells are drawn over; no others may be drawn. */
static int64_t wrong_pixels(const struct image_view *view)
{
    const uint32_t *seen = seen_pixels();
    const bool over_cells = painter.facts.graphics->over_cells;
    const uint32_t unit[2] = {over_cells ? painter.facts.cell_width : 1,
                              over_cells ? painter.facts.cell_height : 1};
    uint32_t width, height;
    int64_t wrong = 0;
    painter_size(&painter, &width, &height);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            const size_t at = (size_t)(painter.row * painter.facts.cell_height + y) * SIDE_MOST +
                              painter.column * painter.facts.cell_width + x;
            const bool beyond =
                x / unit[0] * unit[0] >= view->width || y / unit[1] * unit[1] >= view->height;
            uint32_t wanted = beyond ? BLANK : 0;
            if (x < view->width && y < view->height)
                wanted = expected_at(view, (size_t)y * view->width + x);
            const bool is_joined =
                painter.facts.graphics->palette_always && (view->is_slow || painter.is_mixed);
            const uint32_t off =
                (painter.is_mixed ? PAINTER_NEAR : 0u) + (is_joined ? SHADES_JOINED : 0u);
            if (!off || x >= view->width || y >= view->height) {
                wrong += wanted != seen[at];
                continue;
            }
            const uint32_t colour = image_view_colour(view, (size_t)y * view->width + x);
            wrong += wanted != seen[at] && channel_distance(seen[at], colour) >
                                               channel_distance(wanted, colour) + off + SIXEL_OFF;
        }
    return wrong;
}

/* Place the painter on a blank screen. */
static void begin_at(const struct terminal_facts *facts, unsigned column, unsigned row,
                     unsigned columns, unsigned rows)
{
    painter_release(&painter);
    kitty_release(&screen.kitty);
    memset(&screen, 0, sizeof screen);
    screen.cell_width = facts->cell_width;
    screen.cell_height = facts->cell_height;
    screen.side_most = 1000;
    screen.ink = screen.paper = -1;
    for (size_t i = 0; i < SIDE_MOST * SIDE_MOST; i++)
        screen.pixel[i] = BLANK;
    painter_place(&painter, facts, column, row, columns, rows);
}

static void begin_painter(const struct graphics *graphics, uint32_t width, uint32_t height,
                          unsigned column, unsigned row, unsigned columns, unsigned rows)
{
    const struct terminal_facts facts = facts_of(graphics, width, height);
    begin_at(&facts, column, row, columns, rows);
}

static size_t show(const struct image_view *view)
{
    OWNED(buf_release) struct buf out = {0};
    CHECK(painter_show(&painter, view, &out) && screen_feed(&out));
    return out.length;
}

/* The same, and the screen shows the picture then, to the pixel. */
static size_t show_right(const struct image_view *view)
{
    const size_t bytes = show(view);
    CHECK_INT(wrong_pixels(view), 0);
    return bytes;
}

/* Remove the picture; nothing of it is left. */
static void remove_all(void)
{
    OWNED(buf_release) struct buf out = {0};
    painter_remove(&painter, &out);
    CHECK(screen_feed(&out));
    CHECK_INT(blemishes(), 0);
    CHECK_INT(kitty_pictures(&screen.kitty), 0);
}

enum { WITH_PIXELS = 5 };
static const struct graphics *const with_pixels[WITH_PIXELS] = {
    &graphics_kitty, &graphics_sixel, &graphics_iterm, &graphics_tiles, &graphics_placeholders};

/* ---- stories ---- */

/* By the screen here (screen.h), which has a decoder for each. */
STORY(every_protocol_of_the_table_is_decoded)
{
    for (size_t i = 0; i < graphics_auto.count; i++) {
        const struct graphics *graphics = graphics_auto.of[i];
        bool is_decoded = graphics == &graphics_none || graphics->kind == GRAPHICS_TEXT;
        for (unsigned g = 0; g < WITH_PIXELS; g++)
            is_decoded |= graphics == with_pixels[g];
        CHECK_WITH(is_decoded, "%s has no decoder here", graphics->name);
    }
}

STORY(after_thousands_of_edits_the_screen_shows_the_picture)
{
    for (unsigned g = 0; g < WITH_PIXELS; g++) {
        begin_painter(with_pixels[g], 9, 19, 2, 1, 20, 10);
        uint64_t seed = g;
        unsigned wholes = 0;
        struct image_view view = filled(180, 190, &seed);
        const size_t whole = show_right(&view);
        CHECK(painter.has_palette && !painter.shades.is_exact);
        for (unsigned i = 0; i < 1500; i++) {
            for (uint32_t n = 1 + check_below(&seed, 4); n > 0; n--)
                fill_box(&view, check_below(&seed, 180), check_below(&seed, 190),
                         1 + check_below(&seed, 30), 1 + check_below(&seed, 30), &seed);
            view.is_slow = i / 500 == 1;
            view.is_coarse = i % 5 == 0;
            wholes += show(&view) >= whole;
            if (i % 10 == 0)
                CHECK_INT(wrong_pixels(&view), 0);
        }
        CHECK(wholes < 5); /* greys or tints came in, and wanted a palette */
        CHECK_INT(wrong_pixels(&view), 0);
        CHECK_INT(show(&view), 0);
    }
}

/* When tmux draws a pane again, it draws the last 19 sixel pictures: they show everything. */
STORY(the_last_pictures_that_tmux_keeps_show_all)
{
    struct terminal_facts facts = facts_of(&graphics_sixel, 8, 16);
    uint64_t seed = 14;
    unsigned wholes = 0;
    facts.images_most = graphics_sixel.tmux_keeps;
    begin_at(&facts, 0, 0, 40, 20);
    struct image_view view = filled(320, 320, &seed);
    for (unsigned i = 0; i < 300; i++) {
        show(&view);
        wholes += painter.images == 1;
        CHECK(painter.images <= 19);
        for (unsigned n = check_below(&seed, 9); n > 0; n--)
            fill_box(&view, check_below(&seed, 320), check_below(&seed, 320), 4, 4, &seed);
    }
    show_right(&view);
    CHECK(wholes > 20 && wholes < 150);
}

/* No side of a tile has more than 64 cells, and one may end in the middle of another's row. */
STORY(placeholders_of_a_large_picture_are_several_tiles)
{
    begin_painter(&graphics_placeholders, 4, 4, 0, 0, 100, 90);
    uint64_t seed = 12;
    struct image_view view = filled(400, 360, &seed);
    show_right(&view);
    CHECK_INT(kitty_pictures(&screen.kitty), 4);
    for (unsigned i = 0; i < 600; i++) {
        fill_box(&view, check_below(&seed, 400), check_below(&seed, 360),
                 1 + check_below(&seed, 300), 1 + check_below(&seed, 20), &seed);
        show(&view);
        if (i % 20 == 0)
            CHECK_INT(wrong_pixels(&view), 0);
        CHECK(kitty_pictures(&screen.kitty) <= 240);
    }
    CHECK_INT(wrong_pixels(&view), 0);
    painter_forget(&painter); /* the screen was cleared */
    memset(screen.cell, 0, sizeof screen.cell);
    show_right(&view);
    remove_all();
    show_right(&view);
    view.width = 200;
    show_right(&view);
    remove_all();
}

/* Cells that name a tile may stay on the screen of another session. */
STORY(sessions_number_their_pictures_apart)
{
    struct terminal_facts facts = facts_of(&graphics_placeholders, 8, 16);
    uint64_t seed = 13;
    uint32_t number[2];
    for (unsigned i = 0; i < 2; i++) {
        facts.space = (uint8_t)(62 + 193 * i); /* 62, 255 */
        begin_at(&facts, 0, 0, 10, 5);
        struct image_view view = filled(80, 80, &seed);
        show_right(&view);
        number[i] = screen.kitty.picture[0].number;
    }
    CHECK_INT(number[0], 63 << 24 | 16);
    CHECK_INT(number[1], 4 << 24 | 16);
}

STORY(pictures_of_every_size_and_kind_follow_each_other)
{
    for (unsigned g = 0; g < WITH_PIXELS; g++) {
        begin_painter(with_pixels[g], 7, 15, 0, 0, 12, 6);
        uint64_t seed = 100 + g;
        for (unsigned i = 0; i < 400; i++) {
            uint32_t width = 1 + check_below(&seed, 84), height = 1 + check_below(&seed, 90);
            struct image_view view = picture(width, height);
            view.smooth = check_below(&seed, 4) == 0;
            view.is_slow = check_below(&seed, 2);
            view.hues = check_below(&seed, 4);
            view.hue = check_below(&seed, 4) ? hues : NULL;
            if (check_below(&seed, 3) == 0)
                fill_box(&view, 0, 0, width, height / 2, &seed); /* few colours, or none */
            else
                fill_all(&view, &seed);
            for (unsigned edits = check_below(&seed, 4); edits < 4; edits++) {
                show_right(&view);
                fill_box(&view, check_below(&seed, width), check_below(&seed, height),
                         1 + check_below(&seed, 20), 1 + check_below(&seed, 20), &seed);
            }
        }
    }
}

STORY(few_colours_come_exactly_and_more_may_join_them)
{
    begin_painter(&graphics_kitty, 8, 16, 0, 0, 16, 8);
    struct image_view view = picture(128, 128);
    for (uint32_t i = 0; i < 400; i++) {
        uint8_t *pixel = pixels + 4 * (i * 37);
        pixel[0] = (uint8_t)(i % 251);
        pixel[1] = (uint8_t)(i / 251 + 7);
        pixel[3] = 255;
        show_right(&view);
        CHECK_INT(painter.shades.is_exact, i < SHADES_MOST - 1);
    }
}

STORY(a_cursor_move_costs_next_to_nothing)
{
    static const size_t most[WITH_PIXELS] = {500, 700, 900, 700, 800};
    for (unsigned g = 0; g < WITH_PIXELS; g++) {
        begin_painter(with_pixels[g], 8, 16, 0, 0, 40, 20);
        uint64_t seed = 3;
        struct image_view view = filled(320, 320, &seed);
        show(&view);
        memset(pixels + 4 * (100 * 320 + 100), 255, 4);
        CHECK(show_right(&view) < most[g]);
    }
}

/* Where another label appears, its palette is sent with the pixels that need it; others stay, up to
 * PAINTER_NEAR worse. */
STORY(another_palette_leaves_pixels_that_are_near_it)
{
    for (unsigned g = 0; g < WITH_PIXELS; g++) {
        begin_painter(with_pixels[g], 8, 16, 0, 0, 40, 20);
        uint64_t seed = 5;
        struct image_view view = filled(320, 320, &seed);
        view.hues = 3;
        const size_t whole = show_right(&view);
        for (view.hues = 4; view.hues >= 2; view.hues--) { /* a label comes, labels go */
            for (uint32_t i = 0; i < 900; i++)
                put((100 + i / 30) * 320 + 100 + i % 30, hues[view.hues - 1]);
            CHECK(show_right(&view) < whole / 4 && painter.is_mixed);
            CHECK_INT(seen_pixels()[110 * SIDE_MOST + 110] >> 16,
                      expected_at(&view, 110 * 320 + 110) >> 16);
            CHECK_INT(show(&view), 0);
        }
        painter_forget(&painter);
        show_right(&view);
        CHECK(!painter.is_mixed);
    }
}

/* A coarse picture has few colours, here one that no palette of these hues has. The first rows
 * become fine, and then all. */
STORY(coarse_pixels_do_not_stay_where_fine_ones_get_their_place)
{
    enum { SIDE = 80, FIRST = SIDE * 25, ALL = SIDE * SIDE };
    static uint8_t fine[4 * ALL];
    for (unsigned g = 0; g < WITH_PIXELS; g++)
        for (unsigned i = 0; i < 30; i++) {
            begin_painter(with_pixels[g], 8, 16, 0, 0, 10, 5);
            uint64_t seed = i;
            struct image_view view = picture(SIDE, SIDE);
            const uint32_t coarse = 0x6B594B ^ ((uint32_t)check_random(&seed) & 0x1C1C1C);
            for (size_t at = 0; at < ALL; at++)
                put(at, at < FIRST ? check_below(&seed, 256) * 0x010101 + check_below(&seed, 4)
                                   : 0x6B594B);
            memcpy(fine, pixels, sizeof fine);
            for (size_t at = 0; at < ALL; at++)
                put(at, coarse);
            view.hues = 3;
            view.fine = fine;
            show_right(&view);
            memcpy(pixels, fine, 4 * FIRST);
            show_right(&view);
            memcpy(pixels, fine, sizeof fine);
            show_right(&view);
        }
}

/* The first picture on a line that may be slow. */
STORY(a_whole_picture_of_blocks_takes_fewer_bytes_where_they_count)
{
    uint64_t seed = 12;
    struct image_view view = filled(320, 320, &seed);
    for (size_t i = 0; i < 320 * 320; i++)
        memcpy(pixels + 4 * i, pixels + 4 * (i / 320 / 8 * 8 * 320 + i % 320 / 8 * 8), 4);
    size_t bytes[2];
    for (unsigned is_coarse = 0; is_coarse < 2; is_coarse++) {
        begin_painter(&graphics_kitty, 8, 16, 0, 0, 40, 20);
        view.is_coarse = is_coarse;
        bytes[is_coarse] = show_right(&view);
    }
    CHECK_WITH(bytes[1] < bytes[0] && bytes[1] < 2 * 40 * 40, "%zu bytes coarse, %zu otherwise",
               bytes[1], bytes[0]);
}

/* Greys with noise, as in a slice of a head. */
STORY(sixel_takes_fewer_bytes_on_a_slow_line)
{
    uint64_t seed = 12;
    size_t bytes[4];
    struct image_view view = picture(320, 320);
    view.hues = 0;
    for (uint32_t i = 0; i < 320 * 320; i++)
        put(i, i < 300 ? i * 0x010203 : /* too many colours for an exact palette */
                   (50 + i % 320 / 2 + i / 320 / 16 + check_below(&seed, 12)) * UINT32_C(0x010101));
    for (unsigned i = 0; i < 4; i++) {
        begin_painter(&graphics_sixel, 8, 16, 0, 0, 40, 20);
        view.hue = i < 2 ? hues : NULL; /* without hues the colours are chosen for the picture */
        view.is_slow = i % 2;
        bytes[i] = show_right(&view);
    }
    CHECK_WITH(bytes[1] < bytes[0] / 4 && bytes[3] < bytes[2] / 2,
               "%zu, %zu bytes on a slow line, %zu, %zu otherwise", bytes[1], bytes[3], bytes[0],
               bytes[2]);
}

STORY(a_large_patch_for_kitty_goes_in_chunks)
{
    begin_painter(&graphics_kitty, 8, 16, 0, 0, 40, 20);
    uint64_t seed = 13;
    struct image_view view = filled(320, 320, &seed);
    show(&view);
    for (size_t y = 10; y < 130; y++)
        for (size_t x = 20; x < 150; x++)
            pixels[4 * (y * 320 + x)] = (uint8_t)check_random(&seed);
    screen.kitty.chunks = 0;
    CHECK(show_right(&view) > 8192 && screen.kitty.chunks > 2);
    CHECK_INT(screen.kitty.picture[0].png.width, 320); /* it is the same one, changed */
}

STORY(what_moves_or_was_overwritten_goes_whole_and_what_is_removed_is_gone)
{
    for (unsigned g = 0; g < WITH_PIXELS; g++) {
        struct terminal_facts facts = facts_of(with_pixels[g], 8, 16);
        uint64_t seed = 4;
        begin_at(&facts, 3, 1, 10, 5);
        struct image_view view = filled(80, 80, &seed);
        const size_t whole = show(&view);
        painter_place(&painter, &facts, 3, 1, 10, 5);
        CHECK_INT(show(&view), 0);
        painter_forget(&painter);
        CHECK(show_right(&view) + 4 >= whole);
        remove_all();
        painter_place(&painter, &facts, 12, 7, 10, 5);
        show_right(&view);
    }
}

STORY(one_means_after_another_leaves_nothing)
{
    struct terminal_facts kitty = facts_of(&graphics_kitty, 8, 16);
    struct terminal_facts sixel = facts_of(&graphics_sixel, 8, 16);
    uint64_t seed = 16;
    struct image_view view = filled(80, 80, &seed);
    begin_at(&kitty, 0, 0, 10, 5);
    show(&view);
    painter_place(&painter, &sixel, 0, 0, 10, 5);
    show_right(&view);
    remove_all();
}

STORY(sixels_beyond_the_limit_of_the_terminal_come_in_pieces)
{
    struct terminal_facts facts = facts_of(&graphics_sixel, 9, 19);
    uint64_t seed = 15;
    facts.image_side_most = 64;
    begin_at(&facts, 1, 1, 20, 10);
    screen.side_most = 64;
    struct image_view view = picture(173, 190);
    for (unsigned i = 0; i < 20; i++) {
        fill_all(&view, &seed);
        show_right(&view);
    }
}

/* Ghostty, WezTerm and Konsole have no frame edits. Tiles that are covered go, and the terminal
 * holds no more than several times the picture. */
STORY(without_frame_edits_tiles_are_laid_over_tiles)
{
    begin_painter(&graphics_tiles, 8, 16, 0, 0, 40, 20);
    uint64_t seed = 5, most = 0;
    unsigned wholes = 0;
    screen.kitty.lacks_edits = true;
    struct image_view view = filled(320, 320, &seed);
    const size_t whole = show(&view);
    for (unsigned i = 0; i < 2000; i++) {
        const uint32_t large = check_below(&seed, 30) ? 20 : 200;
        fill_box(&view, check_below(&seed, 320), check_below(&seed, 320),
                 1 + check_below(&seed, large), 1 + check_below(&seed, large), &seed);
        wholes += show(&view) >= whole;
        most = kitty_bytes(&screen.kitty) > most ? kitty_bytes(&screen.kitty) : most;
        CHECK(kitty_pictures(&screen.kitty) <= 512);
        if (i % 40 == 0)
            CHECK_INT(wrong_pixels(&view), 0);
    }
    CHECK(most <= 8 * 4 * 320 * 320 && wholes < 40);
}

/* ---- slices that live in the terminal ---- */

enum { SLICES = 3, SLICE_KINDS = 5 };
static uint8_t below[SIDE_MOST * SIDE_MOST];

/* Fill the slices below, few different ones for each box, and draw `over` pixels over them. */
static void lay_slices(struct image_view *view, const struct raster_box box[SLICES],
                       const uint32_t kind[SLICES], uint32_t over, uint64_t *seed)
{
    for (unsigned s = 0; s < SLICES; s++)
        for (uint32_t y = box[s].top; y < box[s].top + box[s].height; y++)
            for (uint32_t x = box[s].left; x < box[s].left + box[s].width; x++) {
                const size_t i = (size_t)y * view->width + x;
                below[i] = (uint8_t)(x * x / 31 + y * (3 + kind[s]) + kind[s] * 40);
                memset(pixels + 4 * i, below[i], 3);
                pixels[4 * i + 3] = 255;
            }
    for (uint32_t n = 0; n < over; n++)
        fill_box(view, check_below(seed, view->width), check_below(seed, view->height),
                 1 + check_below(seed, 40), 1 + check_below(seed, 3), seed);
    view->below = below;
    view->slice = box;
    view->slices = SLICES;
}

static size_t show_kept(struct image_view *view, size_t budget)
{
    OWNED(buf_release) struct buf out = {0};
    painter_keep(&painter, view, budget, &out);
    CHECK(painter_show(&painter, view, &out) && screen_feed(&out));
    return out.length;
}

static size_t show_kept_right(struct image_view *view)
{
    const size_t bytes = show_kept(view, SIZE_MAX);
    CHECK_INT(wrong_pixels(view), 0);
    return bytes;
}

/* Read the reports of dropped strips. */
static unsigned hear_replies(void)
{
    unsigned lost = 0;
    OWNED(mem_release) char *text = strdup(buf_text(&screen.kitty.replies));
    for (char *at = strstr(text, "\033_G"); at; at = strstr(at + 1, "\033_G"))
        lost += painter_take_reply(&painter, at + 1);
    buf_clear(&screen.kitty.replies);
    return lost;
}

STORY(slices_go_once_and_are_placed_again)
{
    static const struct raster_box boxes[SLICES] = {
        {0, 0, 150, 160}, {152, 0, 148, 160}, {3, 165, 150, 150}};
    begin_painter(&graphics_kitty, 8, 16, 1, 1, 40, 20);
    uint64_t seed = 21;
    uint32_t kind[SLICES] = {0, 1, 2};
    struct image_view view = filled(320, 320, &seed);
    lay_slices(&view, boxes, kind, 0, &seed);
    const size_t first = show_kept_right(&view);
    CHECK_INT(show_kept(&view, SIZE_MAX), 0);
    kind[1] = 3;
    lay_slices(&view, boxes, kind, 0, &seed);
    CHECK(show_kept_right(&view) > 1000);
    kind[1] = 1;
    lay_slices(&view, boxes, kind, 0, &seed);
    const size_t again = show_kept_right(&view); /* the greys are there */
    CHECK(again < 300 && again * 20 < first);
    /* A tint over a slice is opaque, since terminals blend in different ways. */
    for (size_t i = 0; i < 3 * 40; i++) {
        uint8_t *channel = pixels + 4 * (70 * 320 + 20 + i / 3) + i % 3;
        *channel = (uint8_t)((2 * *channel + (hues[1] >> (16 - 8 * (i % 3)) & 255) + 1) / 3);
    }
    show_kept_right(&view);
    OWNED(buf_release) struct buf out = {0};
    painter_remove(&painter, &out);
    CHECK(screen_feed(&out));
    CHECK_INT(blemishes(), 1); /* the pixel that keeps them placed */
    buf_clear(&out);
    painter_drop(&painter, &out);
    CHECK(screen_feed(&out));
    CHECK_INT(kitty_pictures(&screen.kitty), 0);
}

/* Edits, moves, other sizes, budgets and views that are only sent ahead, in a terminal that drops
 * any strip, clears the screen, or loses everything. */
STORY(whatever_the_terminal_drops_is_sent_again)
{
    for (uint64_t seed = 0; seed < 6; seed++) {
        begin_painter(&graphics_kitty, 8, 16, 1, 1, 40, 20);
        unsigned lost = 0;
        screen.kitty.quota = seed % 2 ? 4 * 5 * 320 * 320 : 0;
        struct image_view view = filled(320, 320, &seed);
        for (unsigned i = 0; i < 400; i++) {
            const uint32_t what = check_below(&seed, 40), left = 100 + 10 * check_below(&seed, 3);
            const struct raster_box boxes[SLICES] = {{0, 0, left, 160},
                                                     {left + 2, 0, 298 - left, 160},
                                                     {3, 165, 150, what == 0 ? 0 : 150}};
            uint32_t kind[SLICES];
            OWNED(buf_release) struct buf out = {0};
            for (unsigned s = 0; s < SLICES; s++)
                kind[s] = check_below(&seed, SLICE_KINDS);
            lay_slices(&view, boxes, kind, check_below(&seed, 9), &seed);
            view.focus = boxes[check_below(&seed, SLICES)];
            view.is_slow = check_below(&seed, 2);
            view.smooth = what == 1;
            if (what == 2) { /* send another picture ahead of the next view */
                painter_keep(&painter, &view, 1, &out);
                lay_slices(&view, boxes, kind, 20, &seed);
            } else if (what == 3) {
                painter_remove(&painter, &out);
            } else if (what == 4) {
                painter_drop(&painter, &out);
            } else if (what == 5 || what == 6) {
                for (unsigned k = 0; k < KITTY_PICTURES; k++)
                    if (screen.kitty.picture[k].number >= 270000 && check_below(&seed, 3) == 0)
                        kitty_drop(&screen.kitty, &screen.kitty.picture[k]);
            } else if (what == 7) {
                kitty_clear(&screen.kitty); /* ESC[2J */
                painter_forget(&painter);
                painter.image = 0;
            }
            CHECK(screen_feed(&out));
            show_kept(&view, check_below(&seed, 2) ? check_below(&seed, 9000) : 0);
            for (unsigned more = 0; more < 3; more++)
                if (hear_replies()) {
                    lost++;
                    show_kept(&view, 1);
                }
            if (what == 7 || (what < 7 && what > 4) || screen.kitty.quota) {
                OWNED(buf_release) struct buf all = {0};
                painter_drop(&painter, &all); /* a dropped strip is not reported: restart */
                CHECK(screen_feed(&all));
                show_kept(&view, 1);
            }
            CHECK_INT(wrong_pixels(&view), 0);
        }
        CHECK(lost > 0);
    }
}

STORY(a_terminal_that_drops_all_at_once_is_not_sent_it_for_ever)
{
    static const struct raster_box boxes[SLICES] = {
        {0, 0, 150, 160}, {152, 0, 148, 160}, {3, 165, 150, 150}};
    static const uint32_t kind[SLICES] = {0, 1, 2};
    begin_painter(&graphics_kitty, 8, 16, 1, 1, 40, 20);
    uint64_t seed = 22;
    struct image_view view = filled(320, 320, &seed);
    lay_slices(&view, boxes, kind, 0, &seed);
    unsigned rounds = 0;
    do {
        OWNED(buf_release) struct buf out = {0};
        painter_keep(&painter, &view, SIZE_MAX, &out);
        CHECK(screen_feed(&out));
        for (unsigned k = 0; k < KITTY_PICTURES; k++)
            if (screen.kitty.picture[k].number >= 270000)
                kitty_drop(&screen.kitty, &screen.kitty.picture[k]);
        buf_clear(&out);
        CHECK(painter_show(&painter, &view, &out) && screen_feed(&out));
    } while (hear_replies() && ++rounds < 100);
    CHECK(rounds > 1 && rounds < 20);
    show_kept_right(&view);
    CHECK_INT(view.strips, 0);
    painter.kept.losses = 0; /* a key */
    show_kept_right(&view);
    CHECK(view.strips > 0);
}

STORY(a_picture_larger_than_its_place_is_cut)
{
    for (unsigned g = 0; g < WITH_PIXELS; g++) {
        begin_painter(with_pixels[g], 8, 16, 0, 0, 5, 3);
        uint64_t seed = 6;
        struct image_view view = filled(83, 71, &seed);
        show(&view);
        for (uint32_t y = 0; y < 48; y++)
            memmove(pixels + 4 * y * 40, pixels + 4 * y * 83, 4 * 40);
        view.width = 40;
        view.height = 48;
        CHECK_INT(wrong_pixels(&view), 0);
    }
}

/* Which of a cell's parts have the ink, by its character. */
static unsigned parts_of(uint32_t point, enum block_shape shape)
{
    static const uint32_t quadrant[] = {' ',    0x2598, 0x259D, 0x2580, 0x2596, 0x258C,
                                        0x259E, 0x259B, 0x2597, 0x259A, 0x2590, 0x259C,
                                        0x2584, 0x2599, 0x259F, 0x2588};
    if (point == ' ')
        return 0;
    if (shape == BLOCK_HALF)
        return point == 0x2580 ? 1 : point == 0x2584 ? 2 : 99;
    if (shape == BLOCK_SEXTANT && (point == 0x258C || point == 0x2590))
        return point == 0x258C ? 21 : 42;
    if (shape == BLOCK_SEXTANT) {
        unsigned parts = point - 0x1FB00 + 1;
        parts += parts >= 21;
        return parts + (parts >= 42);
    }
    for (unsigned i = 0; i < 16; i++)
        if (quadrant[i] == point)
            return i;
    return 99;
}

/* Every cell that the picture reaches shows what blocks_fill says, part by part. */
static int64_t wrong_parts(const struct image_view *view)
{
    static struct block cell[CELLS_MOST * CELLS_MOST];
    const enum block_shape shape = painter.facts.shape;
    const unsigned parts = shape == BLOCK_HALF ? 2 : shape == BLOCK_QUADRANT ? 4 : 6;
    int64_t wrong = 0;
    for (size_t i = 0; i < CELLS_MOST * CELLS_MOST; i++)
        cell[i] = (struct block){-1, -1, 0, 0};
    blocks_fill(cell, CELLS_MOST, view, &painter.facts);
    for (unsigned y = 0; y < painter.rows; y++)
        for (unsigned x = 0; x < painter.columns; x++) {
            const struct block *wanted = &cell[y * CELLS_MOST + x];
            const struct glyph *shown = &screen.cell[painter.row + y][painter.column + x];
            if (painter.facts.colours == COLOURS_NONE) {
                wrong += (wanted->parts ? wanted->parts : ' ') != shown->point;
                continue;
            }
            const unsigned inked = parts_of(shown->point, shape);
            for (unsigned i = 0; i < parts; i++)
                wrong += (wanted->parts >> i & 1 ? wanted->ink : wanted->paper) !=
                         (inked >> i & 1 ? shown->ink : shown->paper);
        }
    return wrong;
}

STORY(cells_show_what_they_should_after_every_edit)
{
    for (unsigned i = 0; i < 12; i++) {
        struct terminal_facts facts = facts_of(&graphics_halves, 8, 16);
        uint64_t seed = i;
        uint32_t width, height;
        facts.colours = (enum colours)(i % 4);
        facts.shape = (enum block_shape)(i / 4);
        begin_at(&facts, 5, 2, 20, 9);
        painter_size(&painter, &width, &height);
        struct image_view view = filled(width, height, &seed);
        const size_t whole = show(&view);
        for (unsigned n = 0; n < 200; n++) {
            fill_box(&view, check_below(&seed, width), check_below(&seed, height),
                     1 + check_below(&seed, width / 5), 1 + check_below(&seed, height / 5), &seed);
            CHECK(show(&view) < whole);
            CHECK_INT(wrong_parts(&view), 0);
        }
        CHECK_INT(show(&view), 0);
        view.width -= width / 20 + 1; /* a smaller one leaves nothing of the larger */
        view.height -= height / 3;
        show(&view);
        CHECK_INT(wrong_parts(&view), 0);
    }
}

/* Letters over a picture made of text: there as soon as it is, in any colours; gone with the next
 * picture that has none. */
STORY(notes_stand_in_cells_of_text)
{
    static const struct raster_note note[] = {
        {0, 0, 'R'}, {3, 1, 'L'}, {29, 14, 'A'}, {30, 2, 'x'}, {4, 15, 'x'}};
    for (int colours = 0; colours < 4; colours++) {
        struct terminal_facts facts = facts_of(&graphics_halves, 8, 16);
        uint64_t seed = 8;
        facts.colours = (enum colours)colours;
        begin_at(&facts, 2, 1, 30, 15);
        struct image_view view = filled(30, 30, &seed);
        view.note = note;
        view.notes = 5;
        show(&view);
        CHECK_INT(screen.cell[1][2].point, 'R');
        CHECK_INT(screen.cell[2][5].point, 'L');
        CHECK_INT(screen.cell[15][31].point, 'A');
        CHECK(wrong_parts(&view) <= 6); /* no other cell */
        CHECK_INT(show(&view), 0);
        view.notes = 0;
        show(&view);
        CHECK_INT(wrong_parts(&view), 0);
    }
}

STORY(half_blocks_in_all_colours_show_every_pixel)
{
    begin_painter(&graphics_halves, 8, 16, 0, 0, 30, 15);
    uint64_t seed = 8;
    struct image_view view = filled(30, 30, &seed);
    show(&view);
    for (uint32_t y = 0; y < 30; y++)
        for (uint32_t x = 0; x < 30; x++) {
            const struct glyph *g = &screen.cell[y / 2][x];
            const bool ink = parts_of(g->point, BLOCK_HALF) >> y % 2 & 1;
            CHECK_INT(ink ? g->ink : g->paper, image_view_colour(&view, y * 30 + x));
        }
}

/* Contours, cross-hair and marks are a pixel wide, and a part has up to twelve pixels. */
STORY(lines_over_a_slice_keep_their_colour_in_cells_of_text)
{
    enum { COLUMNS = 10, ROWS = 5, LINE = 0xFC961E, MARK = 0xFFFFFF };
    static uint8_t words[SIDE_MOST * SIDE_MOST];
    static const uint32_t parts[][2] = {{1, 2}, {2, 2}, {2, 3}};
    for (unsigned i = 0; i < 3 * 50; i++) {
        struct terminal_facts facts = facts_of(&graphics_halves, 8, 16);
        struct block cell[ROWS][COLUMNS];
        uint64_t seed = i;
        uint32_t width, height;
        facts.shape = (enum block_shape)(i / 50);
        begin_at(&facts, 0, 0, COLUMNS, ROWS);
        painter_size(&painter, &width, &height);
        struct image_view view = picture(width, height);
        const struct raster_box slice = {0, 0, width, height};
        const uint32_t at = check_below(&seed, width);
        memset(words, 0, sizeof words);
        for (uint32_t p = 0; p < width * height; p++) {
            below[p] = (uint8_t)check_below(&seed, 256);
            words[p] = i % 2 && p % width == at;
            put(p, (i % 2 ? check_below(&seed, 1 << 24) : below[p] * UINT32_C(0x010101)));
            if (p % width == at)
                put(p, i % 2 ? MARK : LINE);
            else if (p % width == at + 1) /* a dark line next to it */
                put(p, below[p] / 4 * UINT32_C(0x010101));
        }
        view.below = below;
        view.slice = &slice;
        view.slices = i % 2 == 0;
        view.words = words;
        blocks_fill(cell[0], COLUMNS, &view, &facts);
        const uint32_t *part = parts[facts.shape], all = part[0] * part[1];
        for (uint32_t k = 0; k < ROWS * all; k++) {
            const struct block *b = &cell[k / all][at * COLUMNS / width];
            const uint32_t bit =
                k % all / part[0] * part[0] + at * COLUMNS * part[0] / width % part[0];
            CHECK_INT(b->parts >> bit & 1 ? b->ink : b->paper, i % 2 ? MARK : LINE);
        }
    }
}

/* The squared error of six colours in two sets, each to its mean. */
static double error_of(const uint32_t colour[6], unsigned parts)
{
    double error = 0;
    for (unsigned side = 0; side < 2; side++)
        for (unsigned shift = 0; shift < 24; shift += 8) {
            double sum = 0, squares = 0, count = 0;
            for (unsigned i = 0; i < 6; i++) {
                const double c = colour[i] >> shift & 255;
                if ((parts >> i & 1) != side)
                    continue;
                sum += c, squares += c * c, count++;
            }
            error += count > 0 ? squares - sum * sum / count : 0;
        }
    return error;
}

STORY(a_cell_is_parted_where_the_error_is_least)
{
    const struct terminal_facts facts = {.colours = COLOURS_24BIT, .shape = BLOCK_SEXTANT};
    uint64_t seed = 14;
    struct image_view view = picture(6, 12);
    for (unsigned n = 0; n < 500; n++) {
        uint32_t colour[6];
        struct block block;
        double least = 1e9;
        for (unsigned i = 0; i < 6; i++)
            colour[i] = (uint32_t)check_random(&seed) & 0xFFFFFF;
        for (uint32_t i = 0; i < 72; i++)
            put(i, colour[i / 6 / 4 * 2 + i % 6 / 3]);
        blocks_fill(&block, 1, &view, &facts);
        for (unsigned parts = 0; parts < 64; parts += 2)
            least = error_of(colour, parts) < least ? error_of(colour, parts) : least;
        CHECK(error_of(colour, block.parts) < least + 0.01);
    }
}

STORY(a_picture_of_512x512_and_a_change_in_it_cost_what_was_promised)
{
    static const size_t whole_most[WITH_PIXELS] = {90000, 180000, 90000, 90000, 100000};
    static const size_t change_most[WITH_PIXELS] = {1500, 4000, 1700, 1700, 2200};
    enum { SIDE = 512 };
    static uint8_t large[4 * SIDE * SIDE];
    struct image_view view = {.width = SIDE, .height = SIDE, .rgba = large, .hue = hues, .hues = 3};
    memset(large, 0, sizeof large);
    for (uint32_t y = 0; y < SIDE; y++)
        for (uint32_t x = 0; x < SIDE; x++) { /* folds on a ball, of two hues */
            const int32_t dx = (int32_t)x - 256, dy = (int32_t)y - 256, d = dx * dx + dy * dy;
            const int32_t fold = (int32_t)((x * x / 97 + y * y / 61 + x * y / 53) % 64) - 32;
            const int32_t light = 235 - d / 128 + fold;
            for (unsigned k = 0; d < 145 * 145 && k < 4; k++)
                large[4 * (y * SIDE + x) + k] =
                    k == 3
                        ? 255
                        : (uint8_t)((hues[y > 300] >> (16 - 8 * k) & 255) * (uint32_t)light / 270);
        }
    for (unsigned g = 0; g < WITH_PIXELS; g++) {
        OWNED(buf_release) struct buf out = {0};
        begin_painter(with_pixels[g], 8, 16, 0, 0, 64, 32);
        CHECK(painter_show(&painter, &view, &out));
        printf("# 512x512: %zu bytes", out.length);
        CHECK(out.length <= whole_most[g]);
        buf_clear(&out);
        for (uint32_t y = 200; y < 240; y++) /* 40x40 become another label's */
            for (uint32_t x = 200; x < 240; x++) {
                uint8_t *pixel = large + 4 * (y * SIDE + x);
                for (unsigned k = 0; k < 3; k++)
                    pixel[k] = (uint8_t)((uint32_t)pixel[0] *
                                         (hues[1 + g % 2] >> (16 - 8 * k) & 255) / 256);
            }
        CHECK(painter_show(&painter, &view, &out));
        printf(", a change of 40x40: %zu bytes\n", out.length);
        CHECK(out.length <= change_most[g]);
    }
}

STORY(without_memory_nothing_is_shown_and_the_next_picture_goes_whole)
{
    static const struct graphics *const all[] = {&graphics_kitty, &graphics_sixel, &graphics_iterm,
                                                 &graphics_tiles, &graphics_halves};
    for (unsigned g = 0; g < 5; g++) {
        uint64_t seed = 9;
        bool shown = false;
        for (unsigned limit = 0; !shown && limit < 60; limit++) {
            begin_painter(all[g], 8, 16, 0, 0, 10, 5);
            OWNED(buf_release) struct buf out = {0};
            struct image_view view = picture(80, 80);
            if (all[g] == &graphics_halves)
                view.width = view.height = 10;
            fill_all(&view, &seed);
            allow_allocations(limit);
            shown = painter_show(&painter, &view, &out);
            mem_allows = NULL;
            CHECK_INT(shown, !out.failed);
            if (!shown) {
                show(&view);
                CHECK_INT(all[g] == &graphics_halves ? wrong_parts(&view) : wrong_pixels(&view), 0);
            }
        }
        CHECK(shown);
    }
}

STORY(a_stream_cut_short_is_not_taken_for_a_picture)
{
    for (unsigned g = 0; g < WITH_PIXELS; g++) {
        begin_painter(with_pixels[g], 8, 16, 0, 0, 5, 3);
        OWNED(buf_release) struct buf out = {0};
        uint64_t seed = 10;
        struct image_view view = filled(40, 48, &seed);
        CHECK(painter_show(&painter, &view, &out));
        for (size_t length = out.length - 1; length > 6; length -= length > 60 ? 17 : 1) {
            out.data[length] = '\0';
            CHECK(!screen_feed(&out));
        }
    }
}

/* ---- shades ---- */

STORY(shades_of_told_hues_are_near_what_was_asked_for)
{
    OWNED(shades_release) struct shades s = {0};
    uint64_t seed = 11;
    struct image_view view = picture(300, 300);
    view.hues = 2;
    fill_all(&view, &seed);
    CHECK(shades_choose(&s, &view) && !s.is_exact);
    CHECK_INT(shades_shown(&s, 0), 0);
    for (uint32_t light = 0; light <= 255; light++)
        for (unsigned h = 0; h < 2; h++) {
            const uint32_t colour = lit(hues[h], light);
            CHECK(channel_distance(shades_shown(&s, colour), colour) <= 8);
        }
    for (unsigned h = 0; h < 2; h++)
        CHECK_INT(shades_shown(&s, hues[h]), hues[h]);
}

STORY(what_is_drawn_over_slices_keeps_its_colour)
{
    OWNED(shades_release) struct shades s = {0};
    struct image_view view = picture(256, 256);
    view.hues = 0;
    for (size_t i = 0; i < 256 * 256; i++) /* no two rows of greys alike, so they are too many */
        put(i, (uint32_t)((i & 255) * 0x010100 + ((i ^ (i >> 15)) & 255)));
    CHECK(shades_choose(&s, &view) && !s.is_exact);
    CHECK_INT(shades_shown(&s, 0xFFDC00), 0xFFDC00);
    for (uint32_t grey = 0; grey < 256; grey++)
        CHECK(channel_distance(shades_shown(&s, grey * 0x010101), grey * 0x010101) <= 3);
}

/* Greys, and a line over them that every look at every so manieth pixel meets. */
STORY(a_cross_hair_over_a_slice_is_no_tint)
{
    begin_painter(&graphics_kitty, 8, 16, 0, 0, 40, 20);
    struct image_view view = picture(320, 320);
    for (size_t i = 0; i < 320 * 320; i++)
        put(i, lit(0xFFFFFF, (uint32_t)(i * 7 % 251 | (i / 320 < 160 ? 1 : 0))));
    show(&view);
    const uint32_t image = painter.image;
    for (unsigned line = 0; line < 22; line++)
        for (size_t y = 0; y < 320; y++) {
            uint8_t *pixel = pixels + 4 * (y * 320 + 5 + line);
            for (unsigned k = 0; k < 3; k++)
                pixel[k] = (uint8_t)((pixel[k] + 2u * (k == 0 ? 255 : k == 1 ? 220 : 0) + 1) / 3);
        }
    show(&view);
    CHECK_INT(painter.image, image); /* it did not go whole */
    CHECK(!painter.shades.has_tints);
}

STORY(tints_that_come_with_an_edit_get_their_colours)
{
    struct image_view view = picture(320, 320);
    begin_painter(&graphics_kitty, 8, 16, 0, 0, 40, 20);
    for (size_t i = 0; i < 320 * 320; i++)
        put(i, lit(i < 160 * 320 ? 0xFFFFFF : hues[0], (uint32_t)i % 251));
    show(&view);
    CHECK(!painter.shades.is_exact && painter.shades.has_greys && !painter.shades.has_tints);
    for (uint32_t y = 40; y < 140; y++)
        for (uint32_t x = 20; x < 140; x++) {
            uint8_t *pixel = pixels + 4 * (y * 320 + x);
            for (unsigned k = 0; k < 3; k++)
                pixel[k] = (uint8_t)((2u * pixel[k] + (hues[1] >> (16 - 8 * k) & 255)) / 3);
        }
    show_right(&view);
    CHECK(painter.shades.has_tints);
    static uint8_t part[4 * 320 * 320]; /* the first to come, of the same picture */
    memcpy(part, pixels, sizeof part / 20);
    begin_painter(&graphics_kitty, 8, 16, 0, 0, 40, 20);
    view.fine = view.rgba;
    view.rgba = part;
    show(&view);
    CHECK(!painter.shades.is_exact && painter.shades.has_tints);
}

STORY(hundreds_of_hues_share_the_palette)
{
    static uint32_t many[SHADES_HUES_MOST];
    OWNED(shades_release) struct shades s = {0};
    uint64_t seed = 12;
    struct image_view view = picture(256, 256);
    for (unsigned i = 0; i < SHADES_HUES_MOST; i++)
        many[i] = (uint32_t)check_random(&seed) & 0xFFFFFF;
    view.hue = many;
    view.hues = SHADES_HUES_MOST;
    for (size_t i = 0; i < 256 * 256; i++)
        put(i, lit(many[i / 256], 192 + (uint32_t)i % 64));
    CHECK(shades_choose(&s, &view) && !s.is_exact && s.count <= SHADES_MOST);
    for (unsigned i = 0; i < SHADES_HUES_MOST; i++)
        CHECK(channel_distance(shades_shown(&s, many[i]), many[i]) <= 45);
}

/* The mean of how far the worst channel is off, in tenths. */
static uint32_t tenths_off(struct shades *s)
{
    uint64_t sum = 0;
    for (size_t i = 0; i < 320 * 320; i++) {
        const uint8_t *p = pixels + 4 * i;
        const uint32_t colour = (uint32_t)p[0] << 16 | (uint32_t)p[1] << 8 | p[2];
        sum += 10 * channel_distance(shades_shown(s, colour), colour);
    }
    return (uint32_t)(sum / (320 * 320));
}

STORY(shades_of_an_atlas_have_no_bands)
{
    static uint32_t many[116];
    begin_painter(&graphics_kitty, 8, 16, 0, 0, 40, 20);
    uint64_t seed = 12;
    struct image_view view = picture(320, 320);
    for (unsigned i = 0; i < 116; i++)
        many[i] = ((uint32_t)check_random(&seed) & 0xFFFFFF) | 0x404040;
    view.hue = many;
    view.hues = 116;
    for (unsigned turn = 0; turn < 3; turn++) {
        /* Many regions, each lit from dark to light, and then others. */
        for (size_t i = 0; i < 320 * 320; i++) {
            const unsigned region =
                30 * turn + (unsigned)(i % 320 / 64) + 5 * (unsigned)(i / 320 / 64);
            put(i, lit(many[region], 80 + (uint32_t)(i % 64 + i / 320 % 64) * 175 / 126));
        }
        show(&view);
        CHECK(painter.has_palette && !painter.shades.is_exact &&
              shades_serve(&painter.shades, &view));
        CHECK(!shades_lack(&painter.shades, &view));
        if (!CHECK(tenths_off(&painter.shades) < 60))
            printf("# turn %u: %u tenths of a level off\n", turn, tenths_off(&painter.shades));
        CHECK_INT(shades_shown(&painter.shades, 0xFFDC00), 0xFFDC00);
    }
    const uint32_t image = painter.image;
    memset(pixels + 4 * (320 * 100 + 100), 200, 4 * 30);
    show(&view);
    CHECK_INT(painter.image, image); /* a small change does not have it go whole */
}
