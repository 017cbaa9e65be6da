/* SPDX-License-Identifier: MIT */
/* How a terminal of kitty's family reads our graphics: numbered pictures, placed at cells, unscaled
 * or scaled, in layers, changed in place and deleted. It is stricter than any terminal: it requires
 * what the protocol or kitty 0.26.5 needs (q= and at most 4096 bytes a chunk, a=f,i=,r=1 on every
 * chunk of a patch), and that no number is used twice while its picture exists.
 *
 * A terminal may have no frame edits (Ghostty, WezTerm, Konsole), and a limited memory: then it
 * silently drops pictures that are not placed at once, and after that the oldest. */
#ifndef TESTS_KITTY_DECODE_H
#define TESTS_KITTY_DECODE_H

#include <stdio.h>

#include "base/mem.h"
#include "tests/png_decode.h"

enum { KITTY_PICTURES = 1024, KITTY_PLACEMENTS = 2048 };

struct kitty_picture {
    bool is_there;
    uint32_t number;        /* 0: none given */
    uint32_t columns, rows; /* U=1: it is shown by cells of text that name it; else 0 */
    uint64_t age;
    struct decoded_png png;
};

struct kitty_placement {
    bool is_there;
    uint32_t number, name; /* of the picture, and of the placement (p=) */
    unsigned column, row;
    uint32_t across, down;             /* X=, Y=: pixels within the cell */
    uint32_t left, top, width, height; /* the part of the picture */
    uint32_t columns, rows;            /* scaled to so many cells; 0: unscaled */
    int32_t z;
};

struct kitty_screen {
    bool lacks_edits; /* a=f is not known */
    uint64_t quota;   /* bytes, 4 a pixel; 0: without end */
    struct kitty_picture picture[KITTY_PICTURES];
    struct kitty_placement placement[KITTY_PLACEMENTS];
    uint64_t pictures; /* that there ever were */
    unsigned chunks;   /* all there were */
    bool waits;        /* more chunks are to come, for: */
    char keys[200];    /* the keys of the first one */
    struct buf data;
    struct buf replies; /* replies under q=1: ESC _ G i=7,p=1;ENOENT ESC \ */
};

static inline void kitty_release(struct kitty_screen *k)
{
    for (unsigned i = 0; i < KITTY_PICTURES; i++)
        free(k->picture[i].png.pixel);
    buf_release(&k->data);
    buf_release(&k->replies);
    *k = (struct kitty_screen){0};
}

/* ---- keys ---- */

/* The value of "name=value" among keys parted by commas. */
static inline const char *kitty_key(const char *keys, const char *name)
{
    static char value[32];
    size_t length = strlen(name);
    for (const char *at = keys; at; at = strchr(at, ','), at = at ? at + 1 : NULL)
        if (strncmp(at, name, length) == 0 && at[length] == '=') {
            snprintf(value, sizeof value, "%.*s", (int)strcspn(at + length + 1, ","),
                     at + length + 1);
            return value;
        }
    return "";
}

static inline uint32_t kitty_value(const char *keys, const char *name)
{
    return (uint32_t)strtoul(kitty_key(keys, name), NULL, 10);
}

/* ---- pictures and where they are shown ---- */

static inline struct kitty_picture *kitty_find(struct kitty_screen *k, uint32_t number)
{
    for (unsigned i = 0; i < KITTY_PICTURES; i++)
        if (k->picture[i].is_there && k->picture[i].number == number)
            return &k->picture[i];
    return NULL;
}

static inline unsigned kitty_pictures(const struct kitty_screen *k)
{
    unsigned count = 0;
    for (unsigned i = 0; i < KITTY_PICTURES; i++)
        count += k->picture[i].is_there;
    return count;
}

static inline bool kitty_is_placed(const struct kitty_screen *k, uint32_t number)
{
    for (unsigned i = 0; i < KITTY_PLACEMENTS; i++)
        if (k->placement[i].is_there && k->placement[i].number == number)
            return true;
    return false;
}

/* Remove the placements of a picture, or only the one of that name. */
static inline void kitty_take_off(struct kitty_screen *k, uint32_t number, uint32_t name)
{
    for (unsigned i = 0; i < KITTY_PLACEMENTS; i++)
        if (k->placement[i].number == number && (name == 0 || k->placement[i].name == name))
            k->placement[i].is_there = false;
}

static inline void kitty_drop(struct kitty_screen *k, struct kitty_picture *p)
{
    kitty_take_off(k, p->number, 0);
    free(p->png.pixel);
    *p = (struct kitty_picture){0};
}

/* Everything goes, as by ESC[2J or d=A. */
static inline void kitty_clear(struct kitty_screen *k)
{
    for (unsigned i = 0; i < KITTY_PICTURES; i++)
        if (k->picture[i].is_there)
            kitty_drop(k, &k->picture[i]);
}

static inline uint64_t kitty_bytes(const struct kitty_screen *k)
{
    uint64_t bytes = 0;
    for (unsigned i = 0; i < KITTY_PICTURES; i++)
        bytes += (uint64_t)4 * k->picture[i].png.width * k->picture[i].png.height;
    return bytes;
}

static inline void kitty_keep_quota(struct kitty_screen *k)
{
    if (k->quota == 0 || kitty_bytes(k) <= k->quota)
        return;
    for (unsigned i = 0; i < KITTY_PICTURES; i++)
        if (k->picture[i].is_there && !kitty_is_placed(k, k->picture[i].number))
            kitty_drop(k, &k->picture[i]);
    while (kitty_bytes(k) > k->quota) {
        struct kitty_picture *oldest = NULL;
        for (unsigned i = 0; i < KITTY_PICTURES; i++)
            if (k->picture[i].is_there && (!oldest || k->picture[i].age < oldest->age))
                oldest = &k->picture[i];
        kitty_drop(k, oldest);
    }
}

/* a=p, or the second half of a=T; the same name again moves. */
static inline bool kitty_place(struct kitty_screen *k, const char *keys, unsigned column,
                               unsigned row)
{
    const uint32_t number = kitty_value(keys, "i"), name = kitty_value(keys, "p");
    const struct kitty_picture *picture = kitty_find(k, number);
    if (!picture) {
        if (kitty_value(keys, "q") == 1)
            buf_printf(&k->replies, "\033_Gi=%u,p=%u;ENOENT:no such picture\033\\", number, name);
        return *kitty_key(keys, "a") == 'p';
    }
    struct kitty_placement p = {.is_there = true,
                                .number = number,
                                .name = name,
                                .column = column,
                                .row = row,
                                .across = kitty_value(keys, "X"),
                                .down = kitty_value(keys, "Y"),
                                .left = kitty_value(keys, "x"),
                                .top = kitty_value(keys, "y"),
                                .width = kitty_value(keys, "w"),
                                .height = kitty_value(keys, "h"),
                                .columns = kitty_value(keys, "c"),
                                .rows = kitty_value(keys, "r"),
                                .z = (int32_t)strtol(kitty_key(keys, "z"), NULL, 10)};
    p.width = p.width ? p.width : picture->png.width - p.left;
    p.height = p.height ? p.height : picture->png.height - p.top;
    if (strcmp(kitty_key(keys, "C"), "1") != 0 || p.left + p.width > picture->png.width ||
        p.top + p.height > picture->png.height || (p.columns == 0) != (p.rows == 0) ||
        (p.columns > 0 && p.across + p.down > 0) || p.z < 0) /* kitty.c: why */
        return false;
    if (name > 0)
        kitty_take_off(k, number, name);
    for (unsigned i = 0; i < KITTY_PLACEMENTS; i++)
        if (!k->placement[i].is_there) {
            k->placement[i] = p;
            return true;
        }
    return false;
}

static inline bool kitty_take(struct kitty_screen *k, struct decoded_png *png, unsigned column,
                              unsigned row)
{
    const uint32_t number = kitty_value(k->keys, "i");
    if (number > 0 && kitty_find(k, number))
        return false;
    for (unsigned i = 0; i < KITTY_PICTURES; i++)
        if (!k->picture[i].is_there) {
            const bool is_in_cells = kitty_value(k->keys, "U") == 1;
            const uint32_t columns = is_in_cells ? kitty_value(k->keys, "c") : 0;
            const uint32_t rows = is_in_cells ? kitty_value(k->keys, "r") : 0;
            k->picture[i] =
                (struct kitty_picture){true, number, columns, rows, k->pictures++, *png};
            *png = (struct decoded_png){0};
            const bool fine = is_in_cells ? columns > 0 && rows > 0
                                          : *kitty_key(k->keys, "a") == 't' ||
                                                kitty_place(k, k->keys, column, row);
            kitty_keep_quota(k);
            return fine;
        }
    return false;
}

static inline bool kitty_change(struct kitty_screen *k, const struct decoded_png *png)
{
    struct kitty_picture *p = kitty_find(k, kitty_value(k->keys, "i"));
    uint32_t left = kitty_value(k->keys, "x"), top = kitty_value(k->keys, "y");
    if (k->lacks_edits || !p || kitty_value(k->keys, "s") != png->width ||
        kitty_value(k->keys, "v") != png->height || kitty_value(k->keys, "X") != 1 ||
        left + png->width > p->png.width || top + png->height > p->png.height)
        return false;
    for (uint32_t y = 0; y < png->height; y++)
        memcpy(p->png.pixel + (size_t)(top + y) * p->png.width + left,
               png->pixel + (size_t)y * png->width, png->width * sizeof *png->pixel);
    return true;
}

/* ---- transmissions ---- */

static inline bool kitty_pixels(const struct kitty_screen *k, struct decoded_png *png)
{
    *png = (struct decoded_png){.width = kitty_value(k->keys, "s"),
                                .height = kitty_value(k->keys, "v")};
    const size_t pixels = (size_t)png->width * png->height;
    uLongf length = (uLongf)(3 * pixels);
    OWNED(mem_release) uint8_t *raw = calloc(pixels + 1, 3);
    png->pixel = calloc(pixels + 1, sizeof *png->pixel);
    bool fine = strcmp(kitty_key(k->keys, "o"), "z") == 0 &&
                uncompress(raw, &length, (const Bytef *)buf_text(&k->data),
                           (uLong)k->data.length) == Z_OK &&
                length == 3 * pixels;
    for (size_t i = 0; i < pixels; i++)
        png->pixel[i] = (uint32_t)raw[3 * i] << 16 | (uint32_t)raw[3 * i + 1] << 8 | raw[3 * i + 2];
    return fine;
}

static inline bool kitty_complete(struct kitty_screen *k, unsigned column, unsigned row)
{
    struct decoded_png png = {0};
    bool fine = false;
    if (strcmp(kitty_key(k->keys, "f"), "100") == 0)
        fine = png_decode(&png, (const uint8_t *)buf_text(&k->data), k->data.length);
    else if (strcmp(kitty_key(k->keys, "f"), "24") == 0)
        fine = kitty_pixels(k, &png);
    if (fine && (*kitty_key(k->keys, "a") == 'T' || *kitty_key(k->keys, "a") == 't'))
        fine = kitty_take(k, &png, column, row);
    else
        fine = fine && *kitty_key(k->keys, "a") == 'f' && kitty_change(k, &png);
    free(png.pixel);
    buf_clear(&k->data);
    return fine;
}

/* d=I frees a picture, d=i removes a placement, d=A clears the screen. */
static inline bool kitty_delete_one(struct kitty_screen *k, const char *keys)
{
    const char what = *kitty_key(keys, "d");
    struct kitty_picture *p = kitty_find(k, kitty_value(keys, "i"));
    if (what == 'A')
        kitty_clear(k);
    else if (what == 'I' && p)
        kitty_drop(k, p);
    else if (what == 'i' && p)
        kitty_take_off(k, p->number, kitty_value(keys, "p"));
    return strchr("AIi", what) != NULL;
}

/* Read one escape sequence, which begins at `text` with ESC _ G; the cursor is at column, row.
 * Return the text after it, or NULL if anything is wrong. */
static inline const char *kitty_feed(struct kitty_screen *k, const char *text, unsigned column,
                                     unsigned row)
{
    char keys[200];
    const char *semicolon, *end = strstr(text, "\033\\");
    if (strncmp(text, "\033_G", 3) != 0 || !end)
        return NULL;
    text += 3;
    semicolon = memchr(text, ';', (size_t)(end - text));
    semicolon = semicolon ? semicolon : end;
    snprintf(keys, sizeof keys, "%.*s", (int)(semicolon - text), text);
    if (kitty_value(keys, "q") != 2 && kitty_value(keys, "q") != 1)
        return NULL;
    if (*kitty_key(keys, "a") == 'd')
        return !k->waits && kitty_delete_one(k, keys) ? end + 2 : NULL;
    if (*kitty_key(keys, "a") == 'p')
        return !k->waits && kitty_place(k, keys, column, row) ? end + 2 : NULL;
    if (k->waits && *kitty_key(k->keys, "a") == 'f' &&
        (*kitty_key(keys, "a") != 'f' || kitty_value(keys, "r") != 1 ||
         kitty_value(keys, "i") != kitty_value(k->keys, "i")))
        return NULL;
    if (!k->waits)
        memcpy(k->keys, keys, sizeof keys);
    size_t length = semicolon < end ? (size_t)(end - semicolon - 1) : 0;
    k->chunks++;
    k->waits = kitty_value(keys, "m") == 1;
    if (length == 0 || length > 4096 || !base64_decode(&k->data, semicolon + 1, length))
        return NULL;
    return k->waits || kitty_complete(k, column, row) ? end + 2 : NULL;
}

/* ---- the visible picture ---- */

/* A picture of width x height pixels, row by row. */
struct kitty_view {
    uint32_t cell_width, cell_height, width, height;
    uint32_t *pixel;
};

static inline void kitty_draw(const struct kitty_view *view, const struct kitty_placement *p,
                              const struct decoded_png *png)
{
    const uint32_t width = p->columns ? p->columns * view->cell_width : p->width;
    const uint32_t height = p->rows ? p->rows * view->cell_height : p->height;
    const uint32_t left = p->column * view->cell_width + p->across;
    const uint32_t top = p->row * view->cell_height + p->down;
    for (uint32_t y = 0; y < height && top + y < view->height; y++)
        for (uint32_t x = 0; x < width && left + x < view->width; x++) {
            const uint32_t from_x = p->left + (2 * x + 1) * p->width / (2 * width);
            const uint32_t from_y = p->top + (2 * y + 1) * p->height / (2 * height);
            const uint32_t colour = png->pixel[(size_t)from_y * png->width + from_x];
            if (colour != PNG_CLEAR)
                view->pixel[(size_t)(top + y) * view->width + left + x] = colour;
        }
}

static inline int kitty_order(const void *a, const void *b)
{
    const struct kitty_placement *p = a, *q = b;
    return p->z != q->z ? (p->z > q->z) - (p->z < q->z)
                        : (p->number > q->number) - (p->number < q->number);
}

/* Draw all placements over the background: by z, and by number if z is equal. */
static inline void kitty_compose(struct kitty_screen *k, const struct kitty_view *view)
{
    static struct kitty_placement shown[KITTY_PLACEMENTS];
    size_t count = 0;
    for (unsigned i = 0; i < KITTY_PLACEMENTS; i++)
        if (k->placement[i].is_there)
            shown[count++] = k->placement[i];
    qsort(shown, count, sizeof *shown, kitty_order);
    for (size_t i = 0; i < count; i++)
        kitty_draw(view, &shown[i], &kitty_find(k, shown[i].number)->png);
}

#endif
