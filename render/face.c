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

/* What is moved by x, y is not itself made of others that are, but once. */
static size_t read_outline(struct face_point *out, size_t count, unsigned outline, int x, int y)
{
    struct reader index = {face_index, (size_t)outline * INDEX_DIGITS}, r = {face_outline, 0};
    const int x0 = x, y0 = y;
    for (int i = 0; i < INDEX_DIGITS - 2; i++)
        r.at = r.at * FACE_BASE + (size_t)digit(&index);
    for (int kind = digit(&r); kind; kind = digit(&r)) {
        if (kind == 1) {
            const int part = large(&r), right = large(&r), up = large(&r);
            count = read_outline(out, count, (unsigned)part, x0 + right, y0 + up);
            continue;
        }
        const int which = (kind - 2) / 9, across = (kind - 2) / 3 % 3, down = (kind - 2) % 3;
        x += across == 0 ? 0 : across == 1 ? small(&r) : large(&r);
        y += down == 0 ? 0 : down == 1 ? small(&r) : large(&r);
        assert(count < FACE_POINTS_MOST);
        out[count++] = (struct face_point){(int16_t)x, (int16_t)y, which > 0, which == 2};
    }
    return count;
}

size_t face_read(struct face_point out[FACE_POINTS_MOST], unsigned outline)
{
    assert(outline < FACE_OUTLINES);
    return read_outline(out, 0, outline, 0, 0);
}
