/* SPDX-License-Identifier: MIT */
/*
 * Sixel graphics (DEC STD 070): a picture as bands of six rows, one pass per colour and band.
 *
 *     ESC P 0;1 q "1;1;W;H             pixels are square, W x H of them
 *     #3;2;100;0;50                    colour 3 is RGB 100 %, 0 %, 50 %
 *     #3!12~?@                         colour 3: 12 times six pixels, six left out, the top one
 *     $                                back to the left edge, for the next colour of this band
 *     -                                down to the next band
 *     ESC \
 *
 * A sixel is a byte 63 + bits, the lowest bit on top; !N repeats. Every pixel is painted, black
 * ones too: terminals treat unpainted pixels differently; but none below the last row, where the
 * last band has more. Colours are whole percents, so a channel may be up to 1 of 255 off. Only
 * colours that occur are declared, with new numbers, so each picture is complete in itself.
 *
 * On a slow line a colour may also paint pixels that a later colour of the band paints over, which
 * joins its runs: the colours with most runs come first. Slices of a head take half the bytes.
 */
#include <string.h>

#include "base/least.h"
#include "base/mem.h"
#include "tui/picture/graphics.h"
#include "tui/picture/painter.h"

enum { BAND = 6, COLOURS = RASTER_COLOURS_MOST };
#define NONE UINT32_MAX

/* Columns from .. to - 1 in which a colour has the same bits. */
struct sixel_run {
    uint32_t from, to, next; /* the next one of the same colour, or NONE */
    uint8_t bits;
};

struct band {
    struct sixel_run *run;
    uint32_t runs;
    uint32_t first[COLOURS], last[COLOURS], count[COLOURS]; /* runs of each colour */
    uint8_t used[COLOURS];                                  /* the colours of this band */
    unsigned used_count;
    bool is_used[COLOURS];
    uint8_t
        *painted; /* [width] bits of the colours so far; NULL: each paints its own pixels alone */
};

/* ---- runs ---- */

static void add_run(struct band *band, uint8_t colour, uint8_t bits, uint32_t from, uint32_t to)
{
    if (!band->is_used[colour]) {
        band->is_used[colour] = true;
        band->used[band->used_count++] = colour;
        band->first[colour] = band->runs;
        band->count[colour] = 0;
    } else {
        struct sixel_run *last = &band->run[band->last[colour]];
        if (last->to == from && last->bits == bits) {
            last->to = to;
            return;
        }
        last->next = band->runs;
    }
    band->count[colour]++;
    band->last[colour] = band->runs;
    band->run[band->runs++] = (struct sixel_run){from, to, NONE, bits};
}

/* Return which of the six bytes of `column` are `colour`, as bits, the lowest byte first. A byte
 * that is equal differs in no bit, so adding 127 to its lower 7 bits carries nothing into bit 7;
 * the product moves bit 8 i to 56 + i. */
static uint8_t bits_of(uint64_t column, uint8_t colour)
{
    const uint64_t low = UINT64_C(0x7F7F7F7F7F7F);
    const uint64_t differs = column ^ colour * UINT64_C(0x010101010101);
    const uint64_t same = ~(((differs & low) + low) | differs | low) & UINT64_C(0x808080808080);
    return (uint8_t)((same >> 7) * UINT64_C(0x0102040810200000) >> 56);
}

static void gather_column(struct band *band, const uint8_t *top, size_t stride, uint32_t rows,
                          uint32_t x)
{
    const unsigned all = (1u << rows) - 1;
    uint64_t column = 0;
    for (uint32_t y = 0; y < rows; y++)
        column |= (uint64_t)top[y * stride + x] << 8 * y;
    for (unsigned left = all; left > 0;) {
        const uint8_t colour = (uint8_t)(column >> 8 * __builtin_ctz(left));
        const uint8_t bits = bits_of(column, colour) & (uint8_t)all;
        add_run(band, colour, bits, x, x + 1);
        left &= ~(unsigned)bits;
    }
}

/* Return true if eight columns have a single colour. */
static bool is_flat(const uint8_t *top, size_t stride, uint32_t rows)
{
    const uint64_t wanted = top[0] * UINT64_C(0x0101010101010101);
    uint64_t differs = 0;
    for (uint32_t y = 0; y < rows; y++) {
        uint64_t eight;
        memcpy(&eight, top + y * stride, 8);
        differs |= eight ^ wanted;
    }
    return differs == 0;
}

/* ---- bytes ---- */

static char *put_number(char *place, uint32_t n)
{
    char digits[10];
    unsigned count = 0;
    do
        digits[count++] = (char)('0' + n % 10);
    while ((n /= 10) > 0);
    while (count > 0)
        *place++ = digits[--count];
    return place;
}

/* Write `run` times the same sixel, without a repeat count if that is shorter. */
static char *put_run(char *place, uint8_t bits, uint32_t run)
{
    if (run > 3) {
        *place++ = '!';
        place = put_number(place, run);
        run = 1;
    }
    for (; run > 0; run--)
        *place++ = (char)(63 + bits);
    return place;
}

/* Write a colour in as few runs as possible, of the bits `all`. Columns join a run as long as one
 * pattern has all that they must have, and nothing that was painted before. */
static char *put_joined(char *place, const struct band *band, uint8_t colour, uint8_t all)
{
    uint32_t begin = 0, x = 0;
    uint8_t least = 0, most = all;
    for (uint32_t j = band->first[colour]; j != NONE; j = band->run[j].next) {
        const struct sixel_run *run = &band->run[j];
        for (; x < run->to; x++) {
            const uint8_t must = x < run->from ? 0 : run->bits;
            const uint8_t may = (uint8_t)(all & ~band->painted[x]);
            if ((least | must) & ~(most & may)) {
                place = put_run(place, least, x - begin);
                begin = x;
                least = 0;
                most = all;
            }
            least |= must;
            most &= may;
            band->painted[x] |= must;
        }
    }
    return put_run(place, least, x - begin);
}

/* Put the colours with most runs first. */
static void sort_colours(struct band *band)
{
    for (unsigned i = 1; i < band->used_count; i++) {
        const uint8_t colour = band->used[i];
        unsigned k = i;
        for (; k > 0 && band->count[band->used[k - 1]] < band->count[colour]; k--)
            band->used[k] = band->used[k - 1];
        band->used[k] = colour;
    }
}

static void write_band(struct band *band, const uint8_t *number, uint8_t all, struct buf *out)
{
    enum { RUN_MOST = 2 * 12, COLOUR_MOST = 5 }; /* bytes, with the gap before it */
    char *begin =
        buf_reserve(out, (size_t)band->runs * RUN_MOST + band->used_count * COLOUR_MOST + 1);
    if (!begin)
        return;
    char *end = begin;
    if (band->painted)
        sort_colours(band);
    for (unsigned i = 0; i < band->used_count; i++) {
        if (i > 0)
            *end++ = '$';
        *end++ = '#';
        end = put_number(end, number[band->used[i]]);
        if (band->painted) {
            end = put_joined(end, band, band->used[i], all);
            continue;
        }
        uint32_t x = 0;
        for (uint32_t j = band->first[band->used[i]]; j != NONE; j = band->run[j].next) {
            const struct sixel_run *run = &band->run[j];
            end = put_run(end, 0, run->from - x);
            end = put_run(end, run->bits, run->to - run->from);
            x = run->to;
        }
    }
    *end = '\0';
    out->length += (size_t)(end - begin);
}

static unsigned percent(uint32_t channel)
{
    return (channel * 100 + 127) / 255;
}

static void once(struct painter *p, const struct raster *raster, struct buf *out)
{
    uint8_t number[RASTER_COLOURS_MOST];
    uint32_t used[RASTER_COLOURS_MOST];
    struct band band;
    const size_t runs = (size_t)raster->width * BAND * sizeof *band.run;
    if (raster->width > UINT32_MAX / BAND ||
        !mem_grow(&p->scratch, &p->scratch_capacity, runs + raster->width, 1)) {
        out->failed = true;
        return;
    }
    band.run = p->scratch;
    band.painted = p->effort == PNG_SLOW_LINE ? (uint8_t *)p->scratch + runs : NULL;
    buf_printf(out, "\033P0;1q\"1;1;%u;%u", raster->width, raster->height);
    const unsigned colours = raster_used(raster, number, used, NULL);
    for (unsigned i = 0; i < colours; i++)
        buf_printf(out, "#%u;2;%u;%u;%u", i, percent(used[i] >> 16), percent(used[i] >> 8 & 255),
                   percent(used[i] & 255));
    for (uint32_t y = 0; y < raster->height; y += BAND) {
        const uint32_t rows = raster->height - y < BAND ? raster->height - y : BAND;
        const uint8_t *top = raster->bytes + y * raster->stride;
        const size_t stride = raster->stride;
        const uint32_t width = raster->width;
        uint32_t x = 0;
        band.runs = 0;
        band.used_count = 0;
        memset(band.is_used, 0, sizeof band.is_used);
        if (band.painted)
            memset(band.painted, 0, width);
        while (x < width) {
            if (x + 8 <= width && is_flat(top + x, stride, rows)) {
                add_run(&band, top[x], (uint8_t)((1u << rows) - 1), x, x + 8);
                x += 8;
            } else {
                gather_column(&band, top, stride, rows, x++);
            }
        }
        write_band(&band, number, (uint8_t)((1u << rows) - 1), out);
        if (y + rows < raster->height)
            buf_add_char(out, '-');
    }
    buf_add_text(out, "\033\\");
}

/* ---- parts of the screen ---- */

/* Return the most pixels of a side that are drawn, in whole cells. */
static uint32_t side_most(const struct painter *p, uint32_t cell)
{
    const uint32_t cells = p->facts.image_side_most / cell;
    return cells > 0 ? cells * cell : UINT32_MAX;
}

/* Send as many pictures as the terminal's limit requires: xterm does not draw a larger one. tmux
 * draws its last pictures again when it draws a pane, so these must show all. */
static void patch(struct painter *p, const struct raster *raster, const struct raster_box *box,
                  struct buf *out)
{
    const uint32_t width = p->facts.cell_width, height = p->facts.cell_height;
    const uint32_t across = side_most(p, width), down = side_most(p, height);
    for (struct raster_box piece = {0}; painter_next_piece(box, across, down, &piece);) {
        const struct raster part = raster_part(raster, piece);
        painter_move_to(p, piece.left / width, piece.top / height, out);
        once(p, &part, out);
        p->images++;
    }
    p->is_whole_next = p->facts.images_most && p->images > p->facts.images_most / 2;
}

/* DA1 with parameter 4; a tmux that has sixel answers so whatever the terminal outside has. */
static bool fits(const struct probe_replies *replies)
{
    return replies->attributes >> 4 & 1 && (!probe_is_tmux(replies) || replies->outer.has_sixel);
}

const struct graphics graphics_sixel = {
    .name = "sixel",
    .title = "sixel",
    .kind = GRAPHICS_PIXELS,
    .fits = fits,
    .over_cells = true,
    .tmux_keeps = 19,
    .palette_always = true,
    .patch_cost = 300,
    .once = once,
    .patch = patch,
};
