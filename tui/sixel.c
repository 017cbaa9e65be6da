#include "tui/sixel.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "tui/colour_table.h"

/* One band of six rows, as bits per colour and column. */
struct band {
    uint32_t width;
    uint8_t *bits; /* bits[colour][x]; all zero between bands */
    uint32_t first[SIXEL_COLOURS], last[SIXEL_COLOURS]; /* columns that a colour touches */
    uint8_t used[SIXEL_COLOURS];                        /* the colours of this band */
    unsigned used_count;
    bool is_used[SIXEL_COLOURS];
};

static void band_gather(struct band *band, const uint8_t *index, uint32_t rows)
{
    for (uint32_t y = 0; y < rows; y++) {
        const uint8_t *row = index + (size_t)y * band->width;
        for (uint32_t x = 0; x < band->width; x++) {
            uint8_t colour = row[x];
            if (!band->is_used[colour]) {
                band->is_used[colour] = true;
                band->used[band->used_count++] = colour;
                band->first[colour] = band->last[colour] = x;
            }
            if (x < band->first[colour])
                band->first[colour] = x;
            if (x > band->last[colour])
                band->last[colour] = x;
            band->bits[(size_t)colour * band->width + x] |= (uint8_t)(1u << y);
        }
    }
}

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

/* `run` times the same sixel; spelt out where that is shorter. */
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

static char *put_colour(char *place, const uint8_t *bits, uint32_t first, uint32_t last)
{
    if (first > 0)
        place = put_run(place, 0, first);
    for (uint32_t x = first; x <= last;) {
        uint8_t sixel = bits[x];
        uint32_t from = x++;
        while (x <= last && bits[x] == sixel)
            x++;
        place = put_run(place, sixel, x - from);
    }
    return place;
}

/* Writes the band and makes it empty again. */
static void band_write(struct band *band, struct buf *out)
{
    for (unsigned i = 0; i < band->used_count; i++) {
        uint8_t colour = band->used[i];
        uint8_t *bits = band->bits + (size_t)colour * band->width;
        uint32_t first = band->first[colour], last = band->last[colour];
        /* a run takes no more bytes than sixels, but for the first, which may be a number */
        char *begin = buf_reserve(out, (size_t)last - first + 32);
        if (!begin)
            return;
        char *end = begin;
        if (i > 0)
            *end++ = '$';
        *end++ = '#';
        end = put_number(end, colour);
        end = put_colour(end, bits, first, last);
        *end = '\0';
        out->length += (size_t)(end - begin);
        memset(bits + first, 0, (size_t)last - first + 1);
        band->is_used[colour] = false;
    }
    band->used_count = 0;
}

static unsigned percent(uint32_t channel)
{
    return (channel * 100 + 127) / 255;
}

static void add_colours(struct buf *out, const struct colour_table *table)
{
    for (unsigned i = 0; i < table->count; i++)
        buf_printf(out, "#%u;2;%u;%u;%u", i, percent(table->colour[i] >> 16),
                   percent(table->colour[i] >> 8 & 255), percent(table->colour[i] & 255));
}

void sixel_encode(const struct image_view *view, struct buf *out)
{
    struct colour_table table;
    struct band *band = calloc(1, sizeof *band);
    size_t pixels = 0;
    uint8_t *index = NULL;
    if (!band || !size_multiply(view->width, view->height, &pixels) ||
        !(index = mem_array(pixels, 1)) || !(band->bits = calloc(SIXEL_COLOURS, view->width)) ||
        (!colour_table_exact(&table, view, SIXEL_COLOURS, index) &&
         !colour_table_reduce(&table, view, SIXEL_COLOURS, index))) {
        out->failed = true;
        goto done;
    }
    band->width = view->width;
    buf_printf(out, "\033P0;1q\"1;1;%u;%u", view->width, view->height);
    add_colours(out, &table);
    for (uint32_t y = 0; y < view->height; y += 6) {
        uint32_t rows = view->height - y < 6 ? view->height - y : 6;
        band_gather(band, index + (size_t)y * view->width, rows);
        band_write(band, out);
        if (y + rows < view->height)
            buf_add_char(out, '-');
    }
    buf_add_text(out, "\033\\");
done:
    if (band)
        free(band->bits);
    free(band);
    free(index);
}
