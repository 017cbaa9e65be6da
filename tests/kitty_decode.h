/*
 * What a kitty terminal makes of our graphics: pictures by number, shown at cells, changed in place
 * and deleted. Stricter than any terminal: what the protocol or kitty 0.26.5 needs (q=2 and at most
 * 4096 bytes a chunk, a=f,i=,r=1 on every chunk of a patch) is insisted on.
 */
#ifndef TESTS_KITTY_DECODE_H
#define TESTS_KITTY_DECODE_H

#include <stdio.h>

#include "tests/png_decode.h"

enum { KITTY_PICTURES = 4 };

struct kitty_picture {
    bool is_there;
    uint32_t number; /* 0: none was told */
    struct decoded_png png;
    unsigned column, row;
};

struct kitty_screen {
    struct kitty_picture picture[KITTY_PICTURES];
    unsigned chunks; /* all there were */
    bool waits;      /* more chunks are to come, for: */
    char keys[200];  /* the keys of the first one */
    struct buf data;
};

static inline void kitty_release(struct kitty_screen *k)
{
    for (unsigned i = 0; i < KITTY_PICTURES; i++)
        free(k->picture[i].png.pixel);
    buf_release(&k->data);
    *k = (struct kitty_screen){0};
}

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

static inline struct kitty_picture *kitty_find(struct kitty_screen *k, uint32_t number)
{
    for (unsigned i = 0; i < KITTY_PICTURES; i++)
        if (k->picture[i].is_there && k->picture[i].number == number)
            return &k->picture[i];
    return NULL;
}

static inline bool kitty_take(struct kitty_screen *k, struct decoded_png *png, unsigned column,
                              unsigned row)
{
    uint32_t number = kitty_value(k->keys, "i");
    if (strcmp(kitty_key(k->keys, "C"), "1") != 0 || (number > 0 && kitty_find(k, number)))
        return false;
    for (unsigned i = 0; i < KITTY_PICTURES; i++)
        if (!k->picture[i].is_there) {
            k->picture[i] = (struct kitty_picture){true, number, *png, column, row};
            *png = (struct decoded_png){0};
            return true;
        }
    return false;
}

static inline bool kitty_change(struct kitty_screen *k, const struct decoded_png *png)
{
    struct kitty_picture *p = kitty_find(k, kitty_value(k->keys, "i"));
    uint32_t left = kitty_value(k->keys, "x"), top = kitty_value(k->keys, "y");
    if (!p || kitty_value(k->keys, "s") != png->width || kitty_value(k->keys, "v") != png->height ||
        kitty_value(k->keys, "X") != 1 || left + png->width > p->png.width ||
        top + png->height > p->png.height)
        return false;
    for (uint32_t y = 0; y < png->height; y++)
        memcpy(p->png.pixel + (size_t)(top + y) * p->png.width + left,
               png->pixel + (size_t)y * png->width, png->width * sizeof *png->pixel);
    return true;
}

static inline bool kitty_pixels(const struct kitty_screen *k, struct decoded_png *png)
{
    *png = (struct decoded_png){.width = kitty_value(k->keys, "s"),
                                .height = kitty_value(k->keys, "v")};
    const size_t pixels = (size_t)png->width * png->height;
    uLongf length = (uLongf)(3 * pixels);
    uint8_t *raw = calloc(pixels + 1, 3);
    png->pixel = calloc(pixels + 1, sizeof *png->pixel);
    bool fine = strcmp(kitty_key(k->keys, "o"), "z") == 0 &&
                uncompress(raw, &length, (const Bytef *)buf_text(&k->data),
                           (uLong)k->data.length) == Z_OK &&
                length == 3 * pixels;
    for (size_t i = 0; i < pixels; i++)
        png->pixel[i] = (uint32_t)raw[3 * i] << 16 | (uint32_t)raw[3 * i + 1] << 8 | raw[3 * i + 2];
    free(raw);
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
    if (fine && *kitty_key(k->keys, "a") == 'T')
        fine = kitty_take(k, &png, column, row);
    else
        fine = fine && *kitty_key(k->keys, "a") == 'f' && kitty_change(k, &png);
    free(png.pixel);
    buf_clear(&k->data);
    return fine;
}

static inline bool kitty_delete_one(struct kitty_screen *k, const char *keys)
{
    struct kitty_picture *p = kitty_find(k, kitty_value(keys, "i"));
    if (!p || strcmp(kitty_key(keys, "d"), "I") != 0)
        return false;
    free(p->png.pixel);
    *p = (struct kitty_picture){0};
    return true;
}

/* Takes one escape sequence, which begins at `text` with ESC _ G; the cursor is at column, row.
 * Returns what follows it, or NULL where anything is amiss. */
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
    if (strcmp(kitty_key(keys, "q"), "2") != 0)
        return NULL;
    if (*kitty_key(keys, "a") == 'd')
        return !k->waits && kitty_delete_one(k, keys) ? end + 2 : NULL;
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

#endif
