#include "tui/picture/shaded.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

void shaded_release(struct shaded *s)
{
    shades_release(&s->shades);
    free(s->bytes);
    *s = (struct shaded){0};
}

bool shaded_has_palette(const struct image_view *view, enum shaded_for what)
{
    return what == SHADED_SIXEL || (view->hue && !view->smooth);
}

static void fill_colours(uint8_t *bytes, const struct image_view *view, size_t stride)
{
    for (uint32_t y = 0; y < view->height; y++) {
        uint8_t *out = bytes + y * stride;
        for (uint32_t x = 0; x < view->width; x++) {
            const uint32_t colour = image_view_colour(view, (size_t)y * view->width + x);
            *out++ = (uint8_t)(colour >> 16);
            *out++ = (uint8_t)(colour >> 8);
            *out++ = (uint8_t)colour;
        }
    }
}

bool shaded_fill(uint8_t *bytes, uint32_t width, uint32_t height, struct shades *shades,
                 const struct image_view *view, bool has_palette)
{
    const size_t each = has_palette ? 1 : 3, stride = width * each;
    for (uint32_t y = 0; width > view->width && y < view->height; y++)
        memset(bytes + y * stride + view->width * each, 0, (width - view->width) * each);
    memset(bytes + view->height * stride, 0, (height - view->height) * stride);
    if (has_palette)
        return shades_apply(shades, view, bytes, stride);
    fill_colours(bytes, view, stride);
    return true;
}

/* A picture that is sent once, of whose colours nothing is known, gets those that suit it best. */
static bool seek_colours(struct shaded *s, const struct image_view *view)
{
    s->raster.colour = s->sought.colour;
    if (!colour_table_reduce(&s->sought, view, SHADES_MOST, s->bytes))
        return false;
    s->raster.colours = s->sought.count;
    return true;
}

/* Sets *has_palette. False without memory, which exact colours do not need. */
static bool take_palette(struct shaded *s, const struct image_view *view, enum shaded_for what,
                         bool *has_palette)
{
    *has_palette = shaded_has_palette(view, what);
    if (*has_palette && view->hue)
        return shades_choose(&s->shades, view);
    *has_palette |= shades_take_exact(&s->shades, view);
    return true;
}

bool shaded_take(struct shaded *s, const struct image_view *view, enum shaded_for what)
{
    bool has_palette;
    size_t pixels, bytes;
    if (!take_palette(s, view, what, &has_palette) ||
        !size_multiply(view->width, view->height, &pixels) ||
        !size_multiply(pixels, has_palette ? 1 : 3, &bytes) ||
        !mem_grow(&s->bytes, &s->capacity, bytes, 1))
        return false;
    s->raster = (struct raster){.width = view->width,
                                .height = view->height,
                                .stride = (size_t)view->width * (has_palette ? 1 : 3),
                                .bytes = s->bytes};
    if (has_palette && !view->hue && !s->shades.is_exact)
        return seek_colours(s, view);
    shaded_fill(s->bytes, view->width, view->height, &s->shades, view, has_palette);
    if (has_palette) {
        s->raster.colour = s->shades.colour;
        s->raster.colours = s->shades.count;
    }
    return true;
}
