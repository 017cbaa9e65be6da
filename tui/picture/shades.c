/* SPDX-License-Identifier: MIT */
#include "tui/picture/shades.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum { PLACES = 1 << 18, SLOTS = 1024, NOWHERE = SHADES_MOST };

void shades_release(struct shades *s)
{
    free(s->place);
    *s = (struct shades){0};
}

/* Colours treated as one: six bits a channel, so that none changes by more than 3 of 255. */
static uint32_t colour_cell(uint32_t colour)
{
    return (colour >> 18 & 63) << 12 | (colour >> 10 & 63) << 6 | (colour >> 2 & 63);
}

/* ---- the colours that suit a picture ---- */

/*
 * A few colours for a picture without known hues. The colours are cut into boxes: begin with one
 * box that holds all, and repeatedly halve at its mean the box and axis with the largest squared
 * error (Wan, Prusinkiewicz and Wong, "Variance-based color image quantization", 1990). Integers
 * only: the same picture results in the same colours.
 */

struct sample {
    uint8_t channel[3];
    uint32_t cell;
    uint32_t weight; /* pixels */
};

struct box {
    size_t first, count; /* its part of the samples */
    uint64_t error;      /* the largest squared error along one axis */
    unsigned axis;       /* that axis */
    uint8_t mean[3];
};

static void measure_box(struct box *box, const struct sample *sample)
{
    uint64_t weight = 0, sum[3] = {0}, square[3] = {0};
    for (size_t i = box->first; i < box->first + box->count; i++) {
        uint64_t w = sample[i].weight;
        weight += w;
        for (unsigned k = 0; k < 3; k++) {
            sum[k] += w * sample[i].channel[k];
            square[k] += w * sample[i].channel[k] * sample[i].channel[k];
        }
    }
    box->error = 0;
    box->axis = 0;
    for (unsigned k = 0; k < 3; k++) {
        uint64_t mean = (sum[k] + weight / 2) / weight;
        /* sum w (c - mean)^2, which is never negative, without a fraction */
        uint64_t error = square[k] + weight * mean * mean - 2 * mean * sum[k];
        box->mean[k] = (uint8_t)mean;
        if (error > box->error) {
            box->error = error;
            box->axis = k;
        }
    }
}

/* Split the samples of `box` at its mean; those above go into `above`. A box with an error has
 * samples on both sides, except if the rounded mean equals the largest value. */
static void cut_box(struct box *box, struct box *above, struct sample *sample)
{
    unsigned axis = box->axis;
    uint8_t most = 0;
    for (size_t i = box->first; i < box->first + box->count; i++)
        if (sample[i].channel[axis] > most)
            most = sample[i].channel[axis];
    unsigned limit = box->mean[axis] < most ? box->mean[axis] : most - 1u;
    size_t low = box->first, high = box->first + box->count;
    while (low < high) {
        if (sample[low].channel[axis] <= limit) {
            low++;
        } else {
            struct sample moved = sample[--high];
            sample[high] = sample[low];
            sample[low] = moved;
        }
    }
    above->first = low;
    above->count = box->first + box->count - low;
    box->count = low - box->first;
    measure_box(box, sample);
    measure_box(above, sample);
}

/* Count the pixels of each cell in `weight` and list the cells that have any, each with the first
 * colour seen in it. Return their number, or 0 without memory. */
static size_t gather_samples(const struct image_view *view, uint32_t *weight,
                             struct sample **sample)
{
    size_t pixels = (size_t)view->width * view->height, count = 0, capacity = 0;
    for (size_t i = 0; i < pixels; i++) {
        uint32_t colour = image_view_colour(view, i), cell = colour_cell(colour);
        if (weight[cell]++ > 0)
            continue;
        if (!mem_grow(sample, &capacity, count + 1, sizeof **sample))
            return 0;
        (*sample)[count++] = (struct sample){
            .channel = {(uint8_t)(colour >> 16), (uint8_t)(colour >> 8), (uint8_t)colour},
            .cell = cell};
    }
    for (size_t i = 0; i < count; i++)
        (*sample)[i].weight = weight[(*sample)[i].cell];
    return count;
}

/* Fill `box` with at most `most` boxes around all colours of the view. Return their number, or 0
 * without memory. */
static unsigned cut_colours(struct box *box, unsigned most, const struct image_view *view)
{
    OWNED(mem_release) struct sample *sample = NULL;
    OWNED(mem_release) uint32_t *weight = calloc(PLACES, sizeof *weight);
    unsigned count = 1, worst = 0;
    box[0] = (struct box){.count = weight ? gather_samples(view, weight, &sample) : 0};
    if (box[0].count > 0)
        measure_box(&box[0], sample);
    else
        count = 0;
    while (count > 0 && count < most && box[worst].error > 0) {
        cut_box(&box[worst], &box[count++], sample);
        worst = 0;
        for (unsigned i = 1; i < count; i++)
            if (box[i].error > box[worst].error)
                worst = i;
    }
    return count;
}

/* ---- exact ---- */

static unsigned exact_place(struct shades *s, uint32_t colour)
{
    uint32_t at = colour * UINT32_C(0x9e3779b1) >> 22;
    while (s->slot[at] && s->colour[s->slot[at] - 1] != colour)
        at = (at + 1) % SLOTS;
    if (!s->slot[at]) {
        if (s->count == SHADES_MOST)
            return NOWHERE;
        s->colour[s->count] = colour;
        s->slot[at] = (uint16_t)++s->count;
    }
    return s->slot[at] - 1u;
}

/* `index` is NULL if only the colours are wanted. */
static bool apply_exact(struct shades *s, const struct image_view *view, uint8_t *index,
                        size_t stride)
{
    uint32_t last, pixel;
    unsigned place = exact_place(s, image_view_colour(view, 0));
    memcpy(&last, view->rgba, 4);
    for (uint32_t y = 0; y < view->height; y++) {
        const size_t first = (size_t)y * view->width;
        for (uint32_t x = 0; x < view->width; x++) {
            memcpy(&pixel, view->rgba + 4 * (first + x), 4);
            if (pixel != last) {
                place = exact_place(s, image_view_colour(view, first + x));
                last = pixel;
            }
            if (place == NOWHERE)
                return false;
            if (index)
                index[y * stride + x] = (uint8_t)place;
        }
    }
    return true;
}

/* ---- the nearest entry ---- */

/* Return the squared difference, with channels weighted as the eye sees them. */
static uint32_t distance(uint32_t a, uint32_t b)
{
    const int32_t red = (int32_t)(a >> 16) - (int32_t)(b >> 16);
    const int32_t green = (int32_t)(a >> 8 & 255) - (int32_t)(b >> 8 & 255);
    const int32_t blue = (int32_t)(a & 255) - (int32_t)(b & 255);
    return (uint32_t)(2 * red * red + 4 * green * green + 3 * blue * blue);
}

/* Look up the middle of a cell, so that the order of lookups does not matter. */
static uint8_t find_shade(struct shades *s, uint32_t cell)
{
    const uint32_t middle =
        (cell >> 12) << 18 | (cell >> 6 & 63) << 10 | (cell & 63) << 2 | UINT32_C(0x020202);
    unsigned best = 0;
    uint32_t least = UINT32_MAX;
    for (unsigned i = 0; i < s->count; i++) {
        const uint32_t d = distance(s->colour[i], middle);
        if (d < least) {
            least = d;
            best = i;
        }
    }
    s->place[cell] = (uint8_t)(best + 1);
    return s->place[cell];
}

static uint8_t place_of(struct shades *s, uint32_t colour)
{
    const uint32_t cell = colour_cell(colour);
    const uint8_t place = s->place[cell];
    return (uint8_t)((place ? place : find_shade(s, cell)) - 1);
}

/* The first entry of a cell has that cell: black is black. */
static void forget_places(struct shades *s)
{
    memset(s->place, 0, PLACES);
    for (unsigned i = s->count; i-- > 0;)
        s->place[colour_cell(s->colour[i])] = (uint8_t)(i + 1);
}

static uint32_t channel(uint32_t colour, unsigned k)
{
    return colour >> (16 - 8 * k) & 255;
}

uint32_t shades_apart(uint32_t a, uint32_t b)
{
    uint32_t most = 0;
    for (unsigned k = 0; k < 3; k++) {
        const uint32_t one = channel(a, k), other = channel(b, k);
        const uint32_t apart = one < other ? other - one : one - other;
        most = apart > most ? apart : most;
    }
    return most;
}

/* Opaque pixels, nearly all of them, are looked up directly. */
static void apply_nearest(struct shades *s, const struct image_view *view, uint8_t *index,
                          size_t stride)
{
    for (uint32_t y = 0; y < view->height; y++) {
        const size_t first = (size_t)y * view->width;
        const uint8_t *p = view->rgba + 4 * first;
        uint8_t *out = index + y * stride;
        for (uint32_t x = 0; x < view->width; x++, p += 4) {
            const unsigned cell = (p[0] & 252u) << 10 | (p[1] & 252u) << 4 | p[2] >> 2;
            const uint8_t place = s->place[cell];
            if (p[3] == 255 && place)
                out[x] = (uint8_t)(place - 1);
            else if (p[3] == 0)
                out[x] = 0;
            else
                out[x] = place_of(s, image_view_colour(view, first + x));
        }
    }
}

/* Give a pixel the place of the one on its left, or of one above it, in the same block of COLUMNS x
 * BAND pixels, if that is at most SHADES_JOINED off: each place that occurs in a column of a band
 * of sixels costs a byte. A change has an effect in its own block alone. Blocks are the bands of a
 * whole picture; those of a patch begin at its top. */
static void join_places(const struct shades *s, const struct image_view *view, uint8_t *index,
                        size_t stride)
{
    enum { COLUMNS = 16, BAND = 6 };
    for (uint32_t y = 0; y < view->height; y++)
        for (uint32_t x = 0; x < view->width; x++) {
            uint8_t *place = index + y * stride + x;
            const uint32_t colour = image_view_colour(view, (size_t)y * view->width + x);
            unsigned other = NOWHERE;
            for (uint32_t k = x % COLUMNS ? 0 : 1; k <= y % BAND && other != *place; k++) {
                const unsigned former = other; /* often the same */
                other = k ? *(place - k * stride) : place[-1];
                if (other != former && shades_apart(s->colour[other], colour) <= SHADES_JOINED)
                    *place = (uint8_t)other;
            }
        }
}

/* ---- ladders ---- */

/* Return entry `i` of `n` between one colour and another; entry n is the latter. */
static uint32_t between(uint32_t from, uint32_t to, unsigned i, unsigned n)
{
    uint32_t colour = 0;
    for (unsigned k = 0; k < 3; k++)
        colour = colour << 8 | (channel(from, k) * (n - i) + channel(to, k) * i + n / 2) / n;
    return colour;
}

static void add_colour(struct shades *s, uint32_t colour)
{
    for (unsigned i = 0; i < s->count; i++)
        if (s->colour[i] == colour)
            return;
    if (s->count < SHADES_MOST)
        s->colour[s->count++] = colour;
}

static void add_ladder(struct shades *s, uint32_t from, uint32_t to, unsigned rungs)
{
    for (unsigned i = 1; i <= rungs; i++)
        add_colour(s, between(from, to, i, rungs));
}

static uint32_t brightened(uint32_t colour, uint32_t by)
{
    uint32_t bright = 0;
    for (unsigned k = 0; k < 3; k++) {
        const uint32_t v = channel(colour, k) + by;
        bright = bright << 8 | (v > 255 ? 255 : v);
    }
    return bright;
}

/* Gloss adds up to 70 of 255 (SPECULAR in render/shade.c), where a face is turned to the light. */
enum { GLOSS = 70 };

static uint32_t third(uint32_t colour)
{
    return between(0, colour, 1, 3);
}

/* Return the distance of a colour from the line between two colours: to the nearest of 16 points on
 * it. */
static uint32_t distance_to_line(uint32_t colour, uint32_t from, uint32_t to)
{
    uint32_t least = UINT32_MAX;
    for (unsigned i = 0; i <= 16; i++) {
        const uint32_t d = distance(colour, between(from, to, i, 16));
        least = d < least ? d : least;
    }
    return least;
}

/* ---- which ladders ---- */

/* Cross-hairs of screens and files, and eliminators (render/notes.c); marks in front of a slice
 * (src/program/panes.c). */
enum { CROSSES = 2, MARKS = 4, CROSS_RUNGS = 7, ACCENTS = MARKS + CROSS_RUNGS + 1 };
static const uint32_t accent[MARKS] = {0xB4FF1E, 0xFFDC00, 0xFF4838, 0xE6C85A};

enum { NEAR = 9 * 12 * 12, HUE_OF_ANOTHER = 9 * 4 * 4 };

static bool is_grey(uint32_t colour)
{
    return distance(colour, (colour >> 8 & 255) * UINT32_C(0x010101)) < 9 * 3 * 3;
}

/* A line of the cross-hair over a slice, two thirds of its colour and one of a grey, is no tint. */
static bool is_crossed(uint32_t colour)
{
    bool is = false;
    for (unsigned i = 0; i < CROSSES; i++) {
        int32_t least = INT32_MAX, most = INT32_MIN;
        for (unsigned k = 0; k < 3; k++) {
            const int32_t grey =
                3 * (int32_t)channel(colour, k) - 2 * (int32_t)channel(accent[i], k);
            least = grey < least ? grey : least;
            most = grey > most ? grey : most;
        }
        is |= most - least <= 6;
    }
    return is;
}

static bool is_shaded(uint32_t colour, const uint32_t *hue, unsigned hues)
{
    for (unsigned i = 0; i < hues; i++)
        if (distance_to_line(colour, 0, hue[i]) < NEAR ||
            distance_to_line(colour, hue[i], brightened(hue[i], GLOSS)) < NEAR)
            return true;
    return false;
}

/* Add marks, and the cross-hair of a screen over greys. */
static void add_accents(struct shades *s)
{
    const uint32_t over_black = between(0, accent[0], 2, 3);
    for (unsigned i = 0; i < MARKS; i++)
        add_colour(s, accent[i]);
    add_colour(s, over_black);
    add_ladder(s, over_black, brightened(over_black, 85), CROSS_RUNGS);
}

/* Use the brighter hues first, without hues that are shades of another. Return true if the hues are
 * new. */
static bool take_hues(struct shades *s, const struct image_view *view)
{
    const unsigned given = view->hues < SHADES_HUES_MOST ? view->hues : SHADES_HUES_MOST;
    if (s->givens == given && memcmp(s->given, view->hue, given * sizeof *s->given) == 0)
        return false;
    memcpy(s->given, view->hue, given * sizeof *s->given);
    s->givens = given;
    s->hues = 0;
    for (unsigned level = 256; level-- > 8;)
        for (unsigned i = 0; i < given; i++) {
            const uint32_t hue = s->given[i] & 0xFFFFFF;
            bool is_new = shades_apart(hue, 0) == level && !is_grey(hue);
            for (unsigned k = 0; is_new && k < s->hues; k++)
                is_new = distance_to_line(hue, 0, s->hue[k]) >= HUE_OF_ANOTHER;
            if (is_new)
                s->hue[s->hues++] = hue;
        }
    return true;
}

/* Get the colours of about 32 x 32 pixels, evenly distributed over the picture; return their
 * number. */
enum { SAMPLED_MOST = 32 * 32 };
static unsigned sample_pixels(const struct image_view *view, const uint8_t *rgba,
                              uint32_t look[SAMPLED_MOST])
{
    const uint32_t across = view->width / 32 + 1, down = view->height / 32 + 1;
    const struct image_view looks = {.rgba = rgba};
    unsigned count = 0;
    for (uint32_t y = down / 2; y < view->height; y += down)
        for (uint32_t x = across / 2; x < view->width; x += across)
            look[count++] = image_view_colour(&looks, (size_t)y * view->width + x);
    return count;
}

/* Look at the picture as it will be when it is fine. */
static void sample_colours(const struct image_view *view, const uint32_t *hue, unsigned hues,
                           bool *has_greys, bool *has_tints)
{
    uint32_t look[SAMPLED_MOST];
    const unsigned looks = sample_pixels(view, view->fine ? view->fine : view->rgba, look);
    unsigned seen = 0, greys = 0, tints = 0;
    for (unsigned i = 0; i < looks; i++) {
        if (shades_apart(look[i], 0) < 16)
            continue;
        seen++;
        if (is_grey(look[i]))
            greys++;
        else if (!is_crossed(look[i]) && !is_shaded(look[i], hue, hues < 32 ? hues : 32))
            tints++;
    }
    *has_greys = greys * 32 > seen;
    *has_tints = view->has_tints || tints * 32 > seen;
}

/* More than 64 greys, or much the same of any hue, the table could not distinguish. */
enum { GREYS_LEAST = 8, RUNGS_MOST = 56, RUNGS_FEW = 8 };

/* Return true if each hue would have only a few levels: bands of colour would be visible. */
static bool are_crowded(const struct shades *s)
{
    return s->hues * RUNGS_FEW > SHADES_MOST - 1 - ACCENTS - GREYS_LEAST;
}

/* ---- no hues are known, or too many ---- */

/* Return the mean error of about 32 x 32 pixels, in their worst channels, times 16. */
static uint32_t mean_error(struct shades *s, const struct image_view *view)
{
    uint32_t look[SAMPLED_MOST], sum = 0;
    const unsigned looks = sample_pixels(view, view->rgba, look);
    for (unsigned i = 0; i < looks; i++)
        sum += 16 * shades_apart(s->colour[place_of(s, look[i])], look[i]);
    return looks ? sum / looks : 0;
}

static bool take_colours(struct shades *s, const struct image_view *view)
{
    struct box box[SHADES_MOST];
    const unsigned boxes = cut_colours(box, SHADES_MOST - 2 - ACCENTS, view);
    if (boxes == 0)
        return false;
    s->count = 0;
    s->is_laddered = false;
    s->is_suited = true;
    add_colour(s, 0);
    add_colour(s, 0xFFFFFF);
    if (view->hue)
        add_accents(s);
    for (unsigned i = 0; i < boxes; i++)
        add_colour(s,
                   (uint32_t)box[i].mean[0] << 16 | (uint32_t)box[i].mean[1] << 8 | box[i].mean[2]);
    forget_places(s);
    s->off = mean_error(s, view);
    return true;
}

/* ---- the palette ---- */

/* Return true if the colours chosen for another picture suit this one too. */
static bool are_near(struct shades *s, const struct image_view *view)
{
    enum { FURTHER = 2 * 16 };
    return mean_error(s, view) <= s->off + s->off / 2 + FURTHER;
}

static bool choose_colours(struct shades *s, const struct image_view *view)
{
    bool has_greys, has_tints;
    const bool is_new = take_hues(s, view);
    if (are_crowded(s))
        return (!is_new && s->is_suited && are_near(s, view)) || take_colours(s, view);
    sample_colours(view, s->hue, s->hues, &has_greys, &has_tints);
    if (!is_new && s->is_laddered && s->has_greys == has_greys && s->has_tints == has_tints &&
        s->has_few_greys == view->has_few_greys)
        return true;
    s->has_greys = has_greys;
    s->has_tints = has_tints;
    s->has_few_greys = view->has_few_greys;
    const unsigned share = 256 / (s->hues + 1),
                   wanted = view->has_few_greys ? SHADES_GREYS_FEW : 64;
    const unsigned greys = !s->has_greys     ? GREYS_LEAST
                           : share >= wanted ? wanted
                           : share < 16      ? 16
                                             : share;
    const unsigned each = s->hues ? (SHADES_MOST - 1 - ACCENTS - greys) / s->hues : 0;
    const unsigned most = each < 2 ? 2 : each > RUNGS_MOST ? RUNGS_MOST : each;
    const unsigned tints = s->has_tints ? most * 3 / 8 : 0;
    const unsigned rungs = (most - tints) / (view->has_few_greys ? 2 : 1), gloss = rungs / 4;
    s->count = 0;
    s->is_laddered = true;
    s->is_suited = false;
    add_colour(s, 0);
    add_accents(s);
    add_ladder(s, 0, 0xFFFFFF, greys);
    for (unsigned i = 0; i < s->hues; i++) {
        const uint32_t hue = s->hue[i];
        add_ladder(s, 0, hue, rungs - gloss);
        add_ladder(s, hue, brightened(hue, GLOSS), gloss);
        add_ladder(s, third(hue), brightened(third(hue), 170), tints);
    }
    forget_places(s);
    return true;
}

bool shades_take_exact(struct shades *s, const struct image_view *view)
{
    uint32_t former[SHADES_MOST];
    const unsigned former_count = s->count;
    memcpy(former, s->colour, sizeof former);
    memset(s->slot, 0, sizeof s->slot);
    s->count = 0;
    s->is_exact = true;
    exact_place(s, 0);
    if (apply_exact(s, view, NULL, 0)) {
        s->is_laddered = s->is_suited = false;
        return true;
    }
    s->is_exact = false;
    s->count = former_count;
    memcpy(s->colour, former, sizeof former);
    return false;
}

bool shades_choose(struct shades *s, const struct image_view *view)
{
    if (!s->place && !(s->place = mem_array(PLACES, 1)))
        return false;
    if (shades_take_exact(s, view))
        return true;
    return view->hue ? choose_colours(s, view) : take_colours(s, view);
}

bool shades_serve(const struct shades *s, const struct image_view *view)
{
    const unsigned given = view->hues < SHADES_HUES_MOST ? view->hues : SHADES_HUES_MOST;
    if (s->is_exact)
        return true;
    if (s->count == 0 || (s->is_laddered && !view->hue))
        return false;
    if (s->is_laddered && view->has_few_greys && !s->has_few_greys)
        return false;
    return !view->hue || ((are_crowded(s) ? s->is_suited : s->is_laddered) && given == s->givens &&
                          memcmp(s->given, view->hue, given * sizeof *s->given) == 0);
}

bool shades_lack(struct shades *s, const struct image_view *view)
{
    bool has_greys, has_tints;
    if (s->is_exact)
        return false;
    if (s->is_suited)
        return view->hue && !are_near(s, view);
    sample_colours(view, s->hue, s->hues, &has_greys, &has_tints);
    return (has_greys && !s->has_greys) || (has_tints && !s->has_tints);
}

/* ---- for the wire ---- */

bool shades_needed(const struct image_view *view, bool always)
{
    return always || (view->hue && !view->smooth);
}

bool shades_fill(struct shades *s, bool has_palette, const struct image_view *view, uint8_t *bytes,
                 uint32_t width, uint32_t height)
{
    const size_t each = has_palette ? 1 : 3, stride = width * each;
    for (uint32_t y = 0; width > view->width && y < view->height; y++)
        memset(bytes + y * stride + view->width * each, 0, (width - view->width) * each);
    memset(bytes + view->height * stride, 0, (height - view->height) * stride);
    if (has_palette && s->is_exact)
        return apply_exact(s, view, bytes, stride);
    if (has_palette)
        apply_nearest(s, view, bytes, stride);
    if (has_palette && view->has_few_greys)
        join_places(s, view, bytes, stride);
    for (uint32_t y = 0; y < view->height && !has_palette; y++) {
        uint8_t *out = bytes + y * stride;
        for (uint32_t x = 0; x < view->width; x++) {
            const uint32_t colour = image_view_colour(view, (size_t)y * view->width + x);
            *out++ = (uint8_t)(colour >> 16);
            *out++ = (uint8_t)(colour >> 8);
            *out++ = (uint8_t)colour;
        }
    }
    return true;
}
