/* SPDX-License-Identifier: MIT */
#include "render/face.h"

#include <assert.h>
#include <string.h>

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

/* Adds the points of an outline without parts, moved by x, y. */
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
