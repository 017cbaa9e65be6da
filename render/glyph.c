/* SPDX-License-Identifier: MIT */
#include "render/glyph.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/least.h"
#include "render/face_table.h"

enum { SMALL_LESS = 45, LARGE_LESS = FACE_BASE * FACE_BASE / 2, INDEX_DIGITS = 5, KERN_DIGITS = 3 };

_Static_assert(sizeof face_index / sizeof *face_index ==
                   (FACE_OUTLINES * INDEX_DIGITS + FACE_ROW - 1) / FACE_ROW,
               "the table has these outlines");

/* ---- digits ---- */

struct reader {
    const char (*sheet)[FACE_ROW + 1];
    size_t at;
};

static int digit(struct reader *r)
{
    const char c = r->sheet[r->at / FACE_ROW][r->at % FACE_ROW];
    r->at++;
    return c - '#' - (c > '?') - (c > '\\');
}

static int small(struct reader *r)
{
    return digit(r) - SMALL_LESS;
}

static int large(struct reader *r)
{
    const int high = digit(r);
    return high * FACE_BASE + digit(r) - LARGE_LESS;
}

/* ---- characters ---- */

unsigned face_find(uint32_t point)
{
    for (int i = 0; i < FACE_RUNS && face_run[i][0] <= point; i++)
        if (point - face_run[i][0] < face_run[i][1])
            return face_run[i][2] + point - face_run[i][0];
    return 0;
}

int face_advance(unsigned outline)
{
    assert(outline < FACE_OUTLINES);
    struct reader r = {face_index, (size_t)outline * INDEX_DIGITS + 3};
    return large(&r);
}

int face_kerning(uint32_t point, uint32_t next)
{
    size_t low = 0, high = FACE_KERNS;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        struct reader r = {face_kern, middle * KERN_DIGITS};
        const char *pair = &face_kern[r.at / FACE_ROW][r.at % FACE_ROW];
        const int32_t apart =
            (uint8_t)pair[0] != point  ? (int32_t)((uint8_t)pair[0] > point) * 2 - 1
            : (uint8_t)pair[1] != next ? (int32_t)((uint8_t)pair[1] > next) * 2 - 1
                                       : 0;
        r.at += 2;
        if (apart == 0)
            return small(&r);
        if (apart < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return 0;
}

/* ---- outlines ---- */

static struct reader begin_of(unsigned outline)
{
    struct reader index = {face_index, (size_t)outline * INDEX_DIGITS}, r = {face_outline, 0};
    for (int i = 0; i < INDEX_DIGITS - 2; i++)
        r.at = r.at * FACE_BASE + (size_t)digit(&index);
    return r;
}

/* Append the points of an outline without parts, moved by x, y. */
static size_t add_points(struct face_point *out, size_t count, struct reader r, int x, int y)
{
    for (int kind = digit(&r); kind; kind = digit(&r)) {
        const int which = (kind - 2) / 9, across = (kind - 2) / 3 % 3, up = (kind - 2) % 3;
        x += across == 0 ? 0 : across == 1 ? small(&r) : large(&r);
        y += up == 0 ? 0 : up == 1 ? small(&r) : large(&r);
        assert(kind > 1 && count < FACE_POINTS_MOST);
        out[count++] = (struct face_point){(int16_t)x, (int16_t)y, which > 0, which == 2};
    }
    return count;
}

size_t face_read(struct face_point out[FACE_POINTS_MOST], unsigned outline)
{
    assert(outline < FACE_OUTLINES);
    size_t count = 0;
    struct reader r = begin_of(outline), rest = r;
    if (digit(&rest) != 1)
        return add_points(out, 0, r, 0, 0);
    while (digit(&r) == 1) {
        const int part = large(&r), x = large(&r), y = large(&r);
        count = add_points(out, count, begin_of((unsigned)part), x, y);
    }
    return count;
}

enum {
    ONE = GLYPH_ONE,
    PARTS_MOST = GLYPH_LINES_MOST / FACE_POINTS_MOST, /* lines that a curve is divided into */
    FLAT = ONE / 16,                                  /* largest distance of such lines from the
                                                         curve */
    STEMS_MOST = 12,                                  /* upright edges of a letter */
    STEM_LEAST = 150,     /* units of length from which upright edges are aligned to whole pixels */
    STEMS_TALL_MOST = 16, /* rows of a capital up to which they are */
    BAND = 8192,          /* pixels drawn at once */
    WHOLE = 2 * ONE * ONE /* sum of a fully covered pixel */
};

int64_t glyph_scaled(int64_t units, uint32_t tall)
{
    const int64_t capital = FACE_CAPITAL, twice = 2 * units * tall * ONE;
    return (twice + (twice < 0 ? -capital : capital)) / (2 * capital);
}

/* ---- outlines ---- */

static int64_t whole_rows(int64_t units, uint32_t tall)
{
    return (glyph_scaled(units, tall) + ONE / 2) / ONE * ONE;
}

/* Return the height of a point, in parts of a pixel. The lines of the face are moved to whole rows,
 * with the overshoot of round letters; heights in between and beyond follow proportionally. */
static int64_t height_of(int64_t y, uint32_t tall)
{
    static const int16_t line[] = {-FACE_LOWEST, 0, FACE_SMALL, FACE_CAPITAL, FACE_TALLEST};
    enum { LINES = sizeof line / sizeof *line };
    const bool is_small = 2 * glyph_scaled(FACE_ROUND, tall) < ONE;
    int64_t place[LINES];
    for (int i = 0; i < LINES; i++)
        place[i] = line[i] < 0 ? -whole_rows(-line[i], tall) : whole_rows(line[i], tall);
    if (is_small && y < 0 && y >= -FACE_ROUND)
        return 0;
    for (int i = 2; i <= 3 && is_small; i++)
        if (y > line[i] && y <= line[i] + FACE_ROUND)
            return place[i];
    if (y <= line[0])
        return place[0] + glyph_scaled(y - line[0], tall);
    for (int i = 1; i < LINES; i++)
        if (y <= line[i]) {
            const int64_t of = line[i] - line[i - 1], over = y - line[i - 1];
            return place[i - 1] + ((place[i] - place[i - 1]) * over + of / 2) / of;
        }
    return place[LINES - 1] + glyph_scaled(y - line[LINES - 1], tall);
}

/* ---- stems ---- */

/* Edges of upright strokes, from left to right, and the aligned positions of stems. */
struct stems {
    struct edge {
        int32_t from, to;
        bool rises; /* the ink is on its right */
    } edge[STEMS_MOST];
    int count;
};

static void add_edge(struct stems *s, int32_t from, bool rises)
{
    int at = s->count;
    while (at > 0 && s->edge[at - 1].from > from)
        at--;
    if (s->count == STEMS_MOST || (at > 0 && s->edge[at - 1].from == from))
        return;
    memmove(&s->edge[at + 1], &s->edge[at], (size_t)(s->count++ - at) * sizeof *s->edge);
    s->edge[at] = (struct edge){from, from, rises};
}

/* Keep only the edges of stems; align their left edges to pixels, and make them a pixel wide at
 * least. */
static void place_stems(struct stems *s)
{
    int kept = 0;
    for (int i = 0; i < s->count; i++)
        for (int k = i + 1; k < s->count && s->edge[i].rises; k++) {
            const struct edge left = s->edge[i], right = s->edge[k];
            const int32_t wide = right.from - left.from, least = wide < ONE ? ONE : wide;
            const int32_t at = (left.from - (least - wide) / 2 + ONE / 2) & ~(ONE - 1);
            if (right.rises || wide < ONE * 3 / 4)
                continue;
            if (wide < 2 * ONE && (kept == 0 || at > s->edge[kept - 1].to)) {
                s->edge[kept++] = (struct edge){left.from, at, true};
                s->edge[kept++] = (struct edge){right.from, at + least, false};
                i = k;
            }
            break;
        }
    s->count = kept;
}

/* Move a point with its stem, or interpolate between the stems around it. */
static int32_t place_by_stems(const struct stems *s, int32_t x)
{
    if (s->count == 0)
        return x;
    const struct edge *e = s->edge, *last = e + s->count - 1;
    if (x <= e->from)
        return x + e->to - e->from;
    for (; e < last; e++)
        if (x <= e[1].from)
            return e->to + (x - e->from) * (e[1].to - e->to) / (e[1].from - e->from);
    return x + last->to - last->from;
}

static void add_line(struct glyph *l, struct spot from, struct spot to)
{
    l->from[l->lines] = from;
    l->to[l->lines++] = to;
    l->least.x = to.x < l->least.x ? to.x : l->least.x;
    l->least.y = to.y < l->least.y ? to.y : l->least.y;
    l->most.x = to.x > l->most.x ? to.x : l->most.x;
    l->most.y = to.y > l->most.y ? to.y : l->most.y;
}

static void add_curve(struct glyph *l, struct spot from, struct spot by, struct spot to)
{
    const int32_t x2 = from.x - 2 * by.x + to.x, y2 = from.y - 2 * by.y + to.y;
    int32_t parts = 1;
    while (parts < PARTS_MOST && abs(x2) + abs(y2) > 4 * FLAT * parts * parts)
        parts *= 2;
    struct spot last = from;
    for (int32_t i = 1; i <= parts; i++) {
        const int32_t twice = 2 * parts * i, all = parts * parts;
        const struct spot next = {from.x + ((by.x - from.x) * twice + x2 * i * i) / all,
                                  from.y + ((by.y - from.y) * twice + y2 * i * i) / all};
        add_line(l, last, next);
        last = next;
    }
}

/* The position on an outline; `by` is the control point of a curve that has begun. */
struct pen {
    struct spot begin, at, by;
    bool curves;
};

static void draw_to(struct glyph *g, struct pen *pen, struct spot to)
{
    if (pen->curves)
        add_curve(g, pen->at, pen->by, to);
    else
        add_line(g, pen->at, to);
    pen->at = to;
    pen->curves = false;
}

void glyph_make(struct glyph *g, unsigned outline, uint32_t tall, int64_t left, int64_t base)
{
    struct face_point point[FACE_POINTS_MOST];
    const size_t count = face_read(point, outline);
    struct stems stems;
    struct pen pen = {.curves = false};
    g->column = left >> GLYPH_BITS;
    g->row = base;
    g->lines = 0;
    g->least = (struct spot){INT32_MAX, INT32_MAX};
    g->most = (struct spot){INT32_MIN, INT32_MIN};
    const int32_t part = (int32_t)(left - g->column * ONE);
    stems.count = 0;
    for (size_t i = 0, begin = 0; i < count && tall <= STEMS_TALL_MOST; i++) {
        begin = point[i].begins ? i : begin;
        const struct face_point *next =
            &point[i + 1 < count && !point[i + 1].begins ? i + 1 : begin];
        if (next->x == point[i].x && abs(next->y - point[i].y) >= STEM_LEAST)
            add_edge(&stems, (int32_t)glyph_scaled(next->x, tall) + part, next->y > point[i].y);
    }
    place_stems(&stems);
    for (const struct face_point *p = point; p < point + count; p++) {
        const int32_t x = (int32_t)glyph_scaled(p->x, tall) + part;
        const struct spot next = {place_by_stems(&stems, x), -(int32_t)height_of(p->y, tall)};
        if (p->begins) {
            if (p > point)
                draw_to(g, &pen, pen.begin);
            pen.begin = pen.at = next;
        } else if (p->is_on) {
            draw_to(g, &pen, next);
        } else {
            if (pen.curves)
                draw_to(g, &pen, (struct spot){(pen.by.x + next.x) / 2, (pen.by.y + next.y) / 2});
            pen.by = next;
            pen.curves = true;
        }
    }
    if (count)
        draw_to(g, &pen, pen.begin);
}

/* ---- pixels ---- */

/* Rows of a glyph being drawn; a row of pixels has `columns` + 2 numbers. */
struct band {
    int32_t left, top; /* column and row of the first pixel */
    int32_t columns, rows;
    int32_t pixel[BAND];
};

static int32_t *band_row(struct band *b, int32_t row)
{
    return b->pixel + (ptrdiff_t)row * (b->columns + 2);
}

/* Add the area to the right of a line segment in a row, `down` high, to the pixels that it crosses,
 * and the rest to the next pixel: sums are accumulated from left to right. */
static void cover_row(int32_t *row, int32_t from, int32_t to, int32_t down)
{
    const int32_t left = from < to ? from : to, right = from < to ? to : from;
    int32_t at = left, done = 0;
    for (int32_t x = left / ONE; at < right || x == left / ONE; x++) {
        const int32_t end = right < (x + 1) * ONE ? right : (x + 1) * ONE;
        const int32_t until =
            end == right ? down : (int32_t)((int64_t)down * (end - left) / (right - left));
        const int32_t before = at + end - 2 * x * ONE;
        row[x] += (until - done) * (2 * ONE - before);
        row[x + 1] += (until - done) * before;
        done = until;
        at = end;
    }
}

static void cover_line(struct band *b, struct spot from, struct spot to)
{
    const int32_t sign = from.y < to.y ? 1 : -1;
    const struct spot a = from.y < to.y ? from : to, z = from.y < to.y ? to : from;
    const int32_t top = b->top * ONE, end = top + b->rows * ONE, left = b->left * ONE;
    int32_t y = a.y > top ? a.y : top;
    if (a.y == z.y)
        return;
    int32_t x = a.x + (int32_t)((int64_t)(z.x - a.x) * (y - a.y) / (z.y - a.y));
    while (y < z.y && y < end) {
        const int32_t row = (y - top) / ONE, below = top + (row + 1) * ONE;
        const int32_t next = below < z.y ? below : z.y;
        const int32_t to_x = a.x + (int32_t)((int64_t)(z.x - a.x) * (next - a.y) / (z.y - a.y));
        cover_row(band_row(b, row), x - left, to_x - left, sign * (next - y));
        y = next;
        x = to_x;
    }
}

/* Lower each pixel's squared distance to that from a line, if it is smaller. */
static void approach_line(struct band *b, struct spot from, struct spot to, int32_t reach)
{
    const int64_t vx = to.x - from.x, vy = to.y - from.y, squares = vx * vx + vy * vy;
    const int64_t beyond = reach * (llabs(vx) + llabs(vy));
    const int32_t left = (from.x < to.x ? from.x : to.x) - reach - b->left * ONE,
                  right = (from.x < to.x ? to.x : from.x) + reach - b->left * ONE,
                  top = (from.y < to.y ? from.y : to.y) - reach - b->top * ONE,
                  bottom = (from.y < to.y ? to.y : from.y) + reach - b->top * ONE;
    for (int32_t y = top > 0 ? top / ONE : 0; y < b->rows && y * ONE < bottom; y++) {
        int32_t *pixel = band_row(b, y);
        const int64_t wy = (b->top + y) * ONE + ONE / 2 - from.y;
        for (int32_t x = left > 0 ? left / ONE : 0; x < b->columns && x * ONE < right; x++) {
            if (pixel[x] <= (reach - ONE) * (reach - ONE))
                continue; /* already covered */
            const int64_t wx = (b->left + x) * ONE + ONE / 2 - from.x;
            const int64_t along = wx * vx + wy * vy, across = wx * vy - wy * vx;
            int64_t apart;
            if (along <= 0)
                apart = wx * wx + wy * wy;
            else if (along >= squares)
                apart = (wx - vx) * (wx - vx) + (wy - vy) * (wy - vy);
            else if (llabs(across) < beyond)
                apart = across * across / squares;
            else
                continue;
            pixel[x] = apart < pixel[x] ? (int32_t)apart : pixel[x];
        }
    }
}

/* Blend sums of ink, or squared distances of the halo. */
static void blend_band(const struct canvas *canvas, struct band *b, int64_t column, int64_t row,
                       const uint8_t rgb[3], int32_t reach)
{
    const bool is_dark = rgb[1] < 128; /* dark letters would look thinner than bright ones of the
                                          same width */
    const int32_t last =
        column + b->columns < canvas->width ? b->columns : (int32_t)(canvas->width - column);
    for (int32_t y = 0; y < b->rows; y++) {
        const int32_t *pixel = band_row(b, y);
        int32_t sum = 0;
        if (row + y < canvas->from || row + y >= canvas_end(canvas))
            continue;
        for (int32_t x = 0; x < last; x++) {
            const size_t at =
                (size_t)(row + y - canvas->from) * canvas->stride + (size_t)(column + x);
            int32_t share = 255;
            sum += pixel[x];
            if (reach && pixel[x] > (reach - ONE) * (reach - ONE))
                share = (reach - (int32_t)square_root((uint32_t)pixel[x])) * 255 / ONE;
            else if (!reach && abs(sum) < WHOLE)
                share = (abs(sum) * 255 + WHOLE / 2) / WHOLE;
            if (!reach && is_dark)
                share += share * (255 - share) / 510;
            if (share == 0 || column + x < 0)
                continue;
            canvas_blend(canvas->rgba + 4 * at, rgb, (uint32_t)share);
            if (canvas->words)
                canvas->words[at] = 1;
        }
    }
}

void glyph_draw(const struct canvas *canvas, const struct glyph *g, uint32_t halo,
                const uint8_t rgb[3])
{
    const int32_t reach = halo ? (int32_t)halo + ONE / 2 : 0;
    struct band b;
    if (g->lines == 0)
        return;
    const int32_t top = (g->least.y - reach) >> GLYPH_BITS;
    const int32_t end = ((g->most.y + reach) >> GLYPH_BITS) + 1;
    b.left = (g->least.x - reach) >> GLYPH_BITS;
    b.columns = ((g->most.x + reach) >> GLYPH_BITS) + 1 - b.left;
    const int64_t column = g->column + b.left;
    if (column >= canvas->width || column + b.columns <= 0 || g->row + top >= canvas_end(canvas) ||
        g->row + end <= canvas->from)
        return;
    const int32_t rows = BAND / (b.columns + 2);
    for (b.top = top; b.top < end; b.top += rows) {
        b.rows = end - b.top < rows ? end - b.top : rows;
        const size_t pixels = (size_t)b.rows * (size_t)(b.columns + 2);
        for (size_t i = 0; i < pixels; i++)
            b.pixel[i] = reach * reach;
        for (size_t i = 0; i < g->lines; i++)
            if (reach)
                approach_line(&b, g->from[i], g->to[i], reach);
            else
                cover_line(&b, g->from[i], g->to[i]);
        blend_band(canvas, &b, column, g->row + b.top, rgb, reach);
    }
}
