#include "render/notes.h"

#include "render/text.h"

const struct ink notes_light = {{232, 232, 232}, {0, 0, 0}};
const struct ink notes_dark = {{16, 16, 16}, {255, 255, 255}};
const uint8_t notes_yellow[3] = {255, 220, 0};

uint32_t notes_side(const struct canvas *canvas)
{
    return canvas->width < canvas->height ? canvas->width : canvas->height;
}

uint32_t notes_letter_scale(const struct canvas *canvas, uint32_t unit)
{
    return unit + (notes_side(canvas) >= NOTES_LARGE_FROM);
}

void notes_draw_sides(const struct canvas *canvas, uint32_t unit, const char *const word[4],
                      const struct ink *ink)
{
    const uint32_t scale = notes_letter_scale(canvas, unit);
    const int64_t tall = TEXT_TALL * (int64_t)scale, margin = 2 * scale;
    for (int i = 0; i < 4; i++) {
        const int64_t right = canvas->width - text_width(word[i], scale);
        const int64_t bottom = canvas->height - tall;
        const int64_t left = i == 0 ? margin : i == 1 ? right - margin : right / 2;
        const int64_t top = i == 2 ? margin : i == 3 ? bottom - margin : bottom / 2;
        text_draw_outlined(canvas, left, top, scale, word[i], ink->rgb, ink->outline);
    }
}

void notes_draw_scale(const struct canvas *canvas, uint32_t unit, int64_t pixels, const char *words,
                      const struct ink *ink)
{
    const int64_t u = unit, left = 4 * u, bottom = canvas->height - 4 * u, tick = 3 * u;
    canvas_box(canvas, left - u, bottom - 2 * u, pixels + 2 * u, 3 * u, ink->outline);
    canvas_box(canvas, left - u, bottom - u - tick, 3 * u, tick + 2 * u, ink->outline);
    canvas_box(canvas, left + pixels - 2 * u, bottom - u - tick, 3 * u, tick + 2 * u, ink->outline);
    canvas_box(canvas, left, bottom - u, pixels, u, ink->rgb);
    canvas_box(canvas, left, bottom - tick, u, tick, ink->rgb);
    canvas_box(canvas, left + pixels - u, bottom - tick, u, tick, ink->rgb);
    text_draw_outlined(canvas, left, bottom - tick - (TEXT_TALL + 3) * u, unit, words, ink->rgb,
                       ink->outline);
}
