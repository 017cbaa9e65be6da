/* SPDX-License-Identifier: MIT */
#include "tui/picture/painter.h"

#include <nettle/sha2.h>
#include <stdlib.h>
#include <string.h>

#include "base/least.h"
#include "base/mem.h"

enum {
    PIXEL_TILE = 16,
    FAST_FROM = 1 << 13, /* pixels; from here on time counts more than bytes */
    BOXES_MOST = 32,
    CLEAR_FACTOR = 16, /* with stored slices most pixels are clear, and cost much less */
};

/* ---- the place ---- */

void painter_move_to(const struct painter *p, unsigned column, unsigned row, struct buf *out)
{
    buf_printf(out, "\033[%u;%uH", p->row + row + 1, p->column + column + 1);
}

bool painter_next_piece(const struct raster_box *box, uint32_t width, uint32_t height,
                        struct raster_box *piece)
{
    if (piece->width == 0)
        piece->left = box->left, piece->top = box->top;
    else
        piece->left += piece->width;
    if (piece->left >= box->left + box->width)
        piece->left = box->left, piece->top += piece->height;
    if (piece->top >= box->top + box->height)
        return false;
    piece->width = least(width, box->left + box->width - piece->left);
    piece->height = least(height, box->top + box->height - piece->top);
    return true;
}

void painter_place(struct painter *p, const struct terminal_facts *facts, unsigned column,
                   unsigned row, unsigned columns, unsigned rows)
{
    const struct terminal_facts *f = &p->facts;
    rows -= facts->images_most > 0 && rows > 1;
    if (f->graphics != facts->graphics || f->colours != facts->colours ||
        f->cell_width != facts->cell_width || f->cell_height != facts->cell_height ||
        f->shape != facts->shape || p->column != column || p->row != row || p->columns != columns ||
        p->rows != rows)
        painter_forget(p);
    p->facts = *facts;
    p->column = column;
    p->row = row;
    p->columns = columns;
    p->rows = rows;
}

void painter_size(const struct painter *p, uint32_t *width, uint32_t *height)
{
    uint32_t across = p->facts.cell_width, down = p->facts.cell_height;
    if (p->facts.graphics->cell_pixels)
        p->facts.graphics->cell_pixels(&p->facts, &across, &down);
    *width = p->columns * across;
    *height = p->rows * down;
}

void painter_forget(struct painter *p)
{
    p->is_shown = false;
}

/* ---- slices that live in the terminal ---- */

static struct strips_image *find_strip(struct strips *k, const uint8_t key[STRIPS_KEY])
{
    for (size_t i = 0; i < k->images; i++)
        if (memcmp(k->image[i].key, key, STRIPS_KEY) == 0)
            return &k->image[i];
    return NULL;
}

/* The terminal has lost this strip; return false if the reply is about no strip of ours. */
static bool drop_strip(struct strips *k, uint32_t number)
{
    for (unsigned i = 0; i < STRIPS_MOST; i++)
        if (k->slot[i].number == number)
            k->slot[i].number = 0;
    for (size_t i = 0; i < k->images; i++)
        if (k->image[i].number == number) {
            k->pixels -= k->image[i].pixels;
            k->image[i] = k->image[--k->images];
            return true;
        }
    return false;
}

/* Free the least recently used strips until `pixels` more fit. Strips of the present view stay. */
static void make_room(struct painter *p, uint32_t pixels, struct buf *out)
{
    struct strips *k = &p->kept;
    while (k->pixels + pixels > STRIPS_PIXELS_MOST) {
        struct strips_image *oldest = NULL;
        for (size_t i = 0; i < k->images; i++)
            if (k->image[i].used < k->clock && (!oldest || k->image[i].used < oldest->used))
                oldest = &k->image[i];
        if (!oldest)
            return;
        p->facts.graphics->keeping->free(oldest->number, out);
        drop_strip(k, oldest->number);
    }
}

/* Cut the boxes of slices into strips of whole rows of cells. */
static void cut_strips(struct painter *p, const struct image_view *view)
{
    struct strips *k = &p->kept;
    /* Make strips larger where slices are so large that there would be too many strips. */
    uint64_t all = 0;
    for (unsigned i = 0; i < view->slices; i++)
        all += (uint64_t)view->slice[i].width * view->slice[i].height;
    const uint64_t each = all / (STRIPS_MOST / 2);
    const uint32_t pixels = each < STRIPS_EACH_PIXELS ? STRIPS_EACH_PIXELS
                            : each < UINT32_MAX       ? (uint32_t)each
                                                      : UINT32_MAX;
    k->strips = 0;
    for (unsigned i = 0; i < view->slices; i++) {
        const struct raster_box box = view->slice[i];
        const uint32_t row = box.width * p->facts.cell_height;
        if (box.width == 0 || box.height == 0)
            continue;
        const uint32_t rows = row < pixels ? pixels / row : 1;
        const uint32_t height = rows * p->facts.cell_height;
        for (uint32_t y = 0; y < box.height; y += height) {
            if (k->strips == STRIPS_MOST) {
                k->strips = 0;
                return;
            }
            k->strip[k->strips++] = (struct image_strip){
                {box.left, box.top + y, box.width, least(height, box.height - y)}, 0};
        }
    }
}

static void key_of(uint8_t key[STRIPS_KEY], const struct image_view *view,
                   const struct raster_box *box)
{
    const uint32_t size[2] = {box->width, box->height};
    struct sha256_ctx sha;
    sha256_init(&sha);
    sha256_update(&sha, sizeof size, (const uint8_t *)size);
    for (uint32_t y = box->top; y < box->top + box->height; y++)
        sha256_update(&sha, box->width, view->below + (size_t)y * view->width + box->left);
    sha256_digest(&sha, STRIPS_KEY, key);
}

static void take_strip(struct strips *k, unsigned i, struct strips_image *image)
{
    image->used = k->clock;
    k->strip[i].number = image->number;
}

static void send_strip(struct painter *p, const struct image_view *view, unsigned i,
                       const uint8_t key[STRIPS_KEY], struct buf *out)
{
    struct strips *k = &p->kept;
    const struct raster_box *box = &k->strip[i].box;
    const uint32_t pixels = box->width * box->height;
    uint32_t grey[STRIPS_GREYS];
    if (!mem_grow(&k->greys, &k->greys_capacity, pixels, 1) ||
        !mem_grow(&k->image, &k->capacity, k->images + 1, sizeof *k->image)) {
        out->failed = true;
        return;
    }
    make_room(p, pixels, out);
    for (unsigned level = 0; level < STRIPS_GREYS; level++)
        grey[level] = strips_colour(level);
    for (uint32_t y = 0; y < box->height; y++)
        for (uint32_t x = 0; x < box->width; x++)
            k->greys[(size_t)y * box->width + x] =
                strips_level(view->below[(size_t)(box->top + y) * view->width + box->left + x]);
    const struct raster raster = {.width = box->width,
                                  .height = box->height,
                                  .stride = box->width,
                                  .bytes = k->greys,
                                  .colour = grey,
                                  .colours = STRIPS_GREYS};
    struct strips_image *image = &k->image[k->images++];
    *image = (struct strips_image){.number = p->facts.graphics->keeping->first + ++k->last,
                                   .pixels = pixels};
    memcpy(image->key, key, STRIPS_KEY);
    k->pixels += pixels;
    p->effort = view->is_slow ? PNG_SLOW_LINE : PNG_FAST;
    p->facts.graphics->keeping->send(p, &raster, image->number, out);
    take_strip(k, i, image);
}

/* Find the strips of a view, and send those the terminal lacks (painter_keep). */
static void send_strips(struct painter *p, const struct image_view *view, size_t budget,
                        struct buf *out)
{
    struct strips *k = &p->kept;
    uint8_t key[STRIPS_MOST][STRIPS_KEY];
    const size_t before = out->length;
    size_t most = 0;
    k->clock++;
    cut_strips(p, view);
    for (unsigned i = 0; i < k->strips; i++) {
        key_of(key[i], view, &k->strip[i].box);
        struct strips_image *image = find_strip(k, key[i]);
        if (image)
            take_strip(k, i, image);
    }
    for (unsigned round = 0; budget > 0 && round < 2; round++)
        for (unsigned i = 0; i < k->strips; i++) {
            const size_t length = out->length;
            struct strips_image *image = find_strip(k, key[i]); /* black strips are often equal */
            const struct raster_box *box = &k->strip[i].box;
            const bool in_focus = box->left - view->focus.left < view->focus.width &&
                                  box->top - view->focus.top < view->focus.height;
            if (k->strip[i].number || in_focus == (round > 0))
                continue;
            if (image) {
                take_strip(k, i, image);
                continue;
            }
            if (most > 0 && length - before + most > budget)
                return;
            send_strip(p, view, i, key[i], out);
            most = out->length - length > most ? out->length - length : most;
        }
}

/* Clear pixels that the strips show anyway: `places` has `stride` a row. */
static void clear_strips(const struct image_view *view, uint8_t *places, uint32_t stride)
{
    for (unsigned i = 0; i < view->strips; i++) {
        const struct raster_box *box = &view->strip[i].box;
        if (!view->strip[i].number)
            continue;
        for (uint32_t y = box->top; y < box->top + box->height; y++) {
            const size_t first = (size_t)y * view->width + box->left;
            const uint8_t *rgba = view->rgba + 4 * first, *below = view->below + first;
            uint8_t *place = places + (size_t)y * stride + box->left;
            for (uint32_t x = 0; x < box->width; x++, rgba += 4)
                if (rgba[0] == below[x] && rgba[1] == below[x] && rgba[2] == below[x])
                    place[x] = RASTER_CLEAR;
        }
    }
}

static bool same_box(const struct raster_box *a, const struct raster_box *b)
{
    return memcmp(a, b, sizeof *a) == 0;
}

static void hide_slot(struct painter *p, unsigned i, struct buf *out)
{
    struct image_strip *slot = &p->kept.slot[i];
    if (slot->number)
        p->facts.graphics->keeping->hide(slot->number, i, out);
    slot->number = 0;
}

/* ---- coming and going ---- */

static void erase(const struct painter *p, struct buf *out)
{
    buf_add_text(out, "\033[m");
    for (unsigned row = 0; row < p->rows; row++) {
        painter_move_to(p, 0, row, out);
        buf_printf(out, "\033[%uX", p->columns);
    }
}

static bool is_erased(const struct painter *p)
{
    return !p->facts.graphics->remove || p->facts.graphics->in_cells;
}

void painter_remove(struct painter *p, struct buf *out)
{
    if (p->holder)
        p->holder->remove(p, out);
    for (unsigned i = 0; p->holder && p->holder->keeping && i < STRIPS_MOST; i++)
        hide_slot(p, i, out); /* the terminal still stores it */
    p->kept.strips = 0;
    if (p->is_shown && is_erased(p))
        erase(p, out);
    p->holder = NULL;
    p->is_shown = false;
}

void painter_release(struct painter *p)
{
    for (unsigned i = 0; i < 2; i++)
        free(p->of[i].bytes);
    free(p->scratch);
    free(p->held);
    free(p->kept.image);
    free(p->kept.greys);
    shades_release(&p->shades);
    png_release(&p->png);
    *p = (struct painter){0};
}

/* ---- changes ---- */

struct stale {
    struct raster_box box[BOXES_MOST];
    unsigned count, most;
    uint64_t cost; /* pixels in all boxes, and the fixed cost of each box */
};

static uint64_t cost_of(struct raster_box box, uint32_t box_cost)
{
    return (uint64_t)box.width * box.height + box_cost;
}

static struct raster_box bounding_box(struct raster_box a, struct raster_box b)
{
    const uint32_t right =
        a.left + a.width > b.left + b.width ? a.left + a.width : b.left + b.width;
    const uint32_t bottom =
        a.top + a.height > b.top + b.height ? a.top + a.height : b.top + b.height;
    const uint32_t left = least(a.left, b.left), top = least(a.top, b.top);
    return (struct raster_box){left, top, right - left, bottom - top};
}

/* Join a box to the other for which it costs least, if that is no more than both cost apart, or if
 * there is no room for another. */
static void add_box(struct stale *stale, struct raster_box box, uint32_t box_cost)
{
    while (stale->count > 0) {
        unsigned best = 0;
        int64_t least_growth = INT64_MAX;
        for (unsigned i = 0; i < stale->count; i++) {
            const int64_t growth =
                (int64_t)(cost_of(bounding_box(stale->box[i], box), box_cost) -
                          cost_of(stale->box[i], box_cost) - cost_of(box, box_cost));
            if (growth < least_growth) {
                least_growth = growth;
                best = i;
            }
        }
        if (least_growth > 0 && stale->count < stale->most)
            break;
        box = bounding_box(stale->box[best], box);
        stale->box[best] = stale->box[--stale->count];
    }
    stale->box[stale->count++] = box;
}

/* Find the first and last of `length` bytes that differ; return false if none do. */
static bool find_difference(const uint8_t *a, const uint8_t *b, size_t length, size_t *first,
                            size_t *last)
{
    if (memcmp(a, b, length) == 0)
        return false;
    *first = 0;
    *last = length - 1;
    while (a[*first] == b[*first])
        ++*first;
    while (a[*last] == b[*last])
        --*last;
    return true;
}

/* Shrink a tile to the part that differs; return false if nothing does. */
static bool shrink_box(struct raster_box *tile, const struct raster *now, const struct raster *then)
{
    const size_t each = raster_pixel_bytes(now);
    uint32_t left = tile->width, right = 0, top = tile->height, bottom = 0;
    for (uint32_t y = 0; y < tile->height; y++) {
        size_t first, last;
        if (!find_difference(now->bytes + (tile->top + y) * now->stride + tile->left * each,
                             then->bytes + (tile->top + y) * then->stride + tile->left * each,
                             tile->width * each, &first, &last))
            continue;
        left = least(left, (uint32_t)(first / each));
        right = right > last / each ? right : (uint32_t)(last / each);
        top = least(top, y);
        bottom = y;
    }
    if (top == tile->height)
        return false;
    *tile =
        (struct raster_box){tile->left + left, tile->top + top, right - left + 1, bottom - top + 1};
    return true;
}

/* ---- pixels ---- */

static uint32_t whole_units(uint32_t length, uint32_t unit)
{
    return (length + unit - 1) / unit * unit;
}

static struct raster raster_of(const struct painter *p, unsigned i)
{
    struct raster raster = {.width = p->width,
                            .height = p->height,
                            .stride = (size_t)p->width * (p->has_palette ? 1 : 3),
                            .bytes = p->of[i].bytes};
    if (p->has_palette) {
        raster.colour = p->shades.colour;
        raster.colours = p->shades.count;
        raster.has_clear = p->kept.strips > 0;
    }
    return raster;
}

static bool fill_raster(struct painter *p, const struct image_view *view)
{
    if (!shades_fill(&p->shades, p->has_palette, view, p->of[1].bytes, p->width, p->height))
        return false;
    if (p->has_palette)
        clear_strips(view, p->of[1].bytes, p->width);
    return true;
}

/* Palette of a picture: required, forbidden, or allowed if it holds all colours. */
enum palette_need { PALETTE_ALWAYS, PALETTE_NEVER, PALETTE_EXACT };

static enum palette_need need_of(const struct painter *p, const struct image_view *view)
{
    if (shades_needed(view, p->facts.graphics->palette_always))
        return PALETTE_ALWAYS;
    return view->smooth ? PALETTE_NEVER : PALETTE_EXACT;
}

/* Find the boxes that differ from the shown picture; none, with count 0. */
static void find_stale(const struct painter *p, struct stale *stale)
{
    const struct raster now = raster_of(p, 1), then = raster_of(p, 0);
    const struct graphics *g = p->facts.graphics;
    const uint32_t tile_width = g->over_cells ? p->facts.cell_width : PIXEL_TILE;
    const uint32_t tile_height = g->over_cells ? p->facts.cell_height : PIXEL_TILE;
    const uint32_t box_cost = p->kept.strips ? CLEAR_FACTOR * g->patch_cost : g->patch_cost;
    const size_t each = raster_pixel_bytes(&now);
    stale->count = 0;
    stale->most = p->facts.images_most ? p->facts.images_most / 4 : BOXES_MOST;
    stale->cost = 0;
    for (uint32_t top = 0; top < now.height; top += tile_height) {
        const uint32_t height = least(tile_height, now.height - top);
        /* Find the first and last column of bytes in which any of these rows differ. */
        size_t from = SIZE_MAX, to = 0;
        for (uint32_t y = top; y < top + height; y++) {
            size_t first, last;
            if (!find_difference(now.bytes + y * now.stride, then.bytes + y * then.stride,
                                 now.width * each, &first, &last))
                continue;
            from = first < from ? first : from;
            to = last > to ? last : to;
        }
        if (from == SIZE_MAX)
            continue;
        uint32_t left = (uint32_t)(from / each / tile_width) * tile_width;
        for (; left < now.width && left <= to / each; left += tile_width) {
            const struct raster_box tile = {left, top, least(tile_width, now.width - left), height};
            struct raster_box tight = tile;
            if (shrink_box(&tight, &now, &then))
                add_box(stale, g->over_cells ? tile : tight, box_cost);
        }
    }
    for (unsigned i = 0; i < stale->count; i++)
        stale->cost += cost_of(stale->box[i], box_cost);
}

/* Make another palette for the view. Pixels whose shown colour is near that of the view and of the
 * final picture get its index, so they are not sent again. */
static bool change_palette(struct painter *p, const struct image_view *view)
{
    uint32_t former[SHADES_MOST];
    struct image_view fine = *view;
    fine.rgba = view->fine ? view->fine : view->rgba;
    memcpy(former, p->shades.colour, sizeof former);
    if (!shades_choose(&p->shades, view) || !fill_raster(p, view))
        return false;
    for (uint32_t y = 0; y < view->height; y++)
        for (uint32_t x = 0; x < view->width; x++) {
            const size_t at = (size_t)y * p->width + x;
            uint8_t *then = p->of[0].bytes + at, now = p->of[1].bytes[at];
            if (*then == RASTER_CLEAR || now == RASTER_CLEAR)
                continue;
            const size_t i = (size_t)y * view->width + x;
            const uint32_t colours[] = {image_view_colour(view, i), image_view_colour(&fine, i)};
            const uint32_t near = PAINTER_NEAR + (view->has_few_greys ? SHADES_JOINED : 0);
            bool is_near = true;
            for (unsigned k = 0; k < 2; k++)
                is_near &= shades_apart(former[*then], colours[k]) <=
                           shades_apart(p->shades.colour[now], colours[k]) + near;
            *then = is_near ? now : (uint8_t)!now;
        }
    p->is_mixed = true;
    return true;
}

/* Return true if patches suffice, with stale->count 0 if nothing has changed. */
static bool can_patch(struct painter *p, const struct image_view *view, struct stale *stale)
{
    const enum palette_need need = need_of(p, view);
    const uint64_t all = (uint64_t)p->width * p->height;
    if (!p->is_shown || p->is_whole_next || (need == PALETTE_NEVER && p->has_palette) ||
        (need == PALETTE_ALWAYS && !p->has_palette) ||
        (need == PALETTE_EXACT && p->has_palette && !p->shades.is_exact))
        return false;
    const bool serves = (!p->has_palette || shades_serve(&p->shades, view)) && fill_raster(p, view);
    if (!serves && (need != PALETTE_ALWAYS || !change_palette(p, view)))
        return false;
    find_stale(p, stale);
    if (p->has_palette && stale->cost > all / 32 && shades_lack(&p->shades, view)) {
        if (need != PALETTE_ALWAYS || !change_palette(p, view))
            return false;
        find_stale(p, stale);
    }
    return stale->count == 0 || stale->cost < (view->is_slow ? all : all / 2);
}

static bool show_whole(struct painter *p, const struct image_view *view, struct buf *out)
{
    const enum palette_need need = need_of(p, view);
    size_t bytes;
    p->has_palette =
        need == PALETTE_ALWAYS || (need == PALETTE_EXACT && shades_take_exact(&p->shades, view));
    if ((need == PALETTE_ALWAYS && !shades_choose(&p->shades, view)) ||
        !size_multiply((size_t)p->width * (p->has_palette ? 1 : 3), p->height, &bytes) ||
        !mem_grow(&p->of[0].bytes, &p->of[0].capacity, bytes, 1) ||
        !mem_grow(&p->of[1].bytes, &p->of[1].capacity, bytes, 1))
        return false;
    fill_raster(p, view);
    const struct raster raster = raster_of(p, 1);
    const struct raster_box all = {0, 0, p->width, p->height};
    const struct graphics *g = p->facts.graphics;
    p->effort = view->is_slow ? PNG_SLOW_LINE : view->is_coarse ? PNG_FILE : PNG_FAST;
    p->is_whole_next = p->is_mixed = false;
    p->images = 0;
    if (g->whole)
        g->whole(p, &raster, out);
    else
        g->patch(p, &raster, &all, out);
    if (g->remove)
        p->holder = g;
    return !out->failed;
}

static bool show_pixels(struct painter *p, const struct image_view *view, struct buf *out)
{
    struct stale stale;
    /* A picture of another size cannot be compared; cells that it leaves uncovered are erased. */
    uint32_t width = view->width, height = view->height;
    if (p->facts.graphics->over_cells) {
        width = whole_units(width, p->facts.cell_width);
        height = whole_units(height, p->facts.cell_height);
    }
    if (p->is_shown && p->facts.graphics->over_cells && is_erased(p) &&
        (width < p->width || height < p->height))
        erase(p, out);
    if (width != p->width || height != p->height)
        painter_forget(p);
    p->width = width;
    p->height = height;
    if (p->facts.graphics->keeping) {
        p->kept.strips = view->strips;
        /* Show exactly the strips of the present view that the terminal has. Place a strip before
         * removing the one it replaces, so that nothing is black in between; but first remove
         * strips of another layout, which may overlap it. */
        struct strips *k = &p->kept;
        for (unsigned i = 0; i < STRIPS_MOST; i++)
            if (i >= k->strips || !same_box(&k->slot[i].box, &k->strip[i].box))
                hide_slot(p, i, out);
        for (unsigned i = 0; i < k->strips; i++) {
            const struct image_strip *now = &k->strip[i], *former = &k->slot[i];
            if (!now->number ||
                (former->number == now->number && same_box(&former->box, &now->box)))
                continue;
            p->facts.graphics->keeping->place(p, now->number, i, &now->box, out);
            hide_slot(p, i, out);
            k->slot[i] = *now;
        }
    }
    if (can_patch(p, view, &stale)) {
        const struct raster raster = raster_of(p, 1);
        p->effort = view->is_slow                               ? PNG_SLOW_LINE
                    : stale.cost < FAST_FROM || view->is_coarse ? PNG_SMALL
                                                                : PNG_FAST;
        for (unsigned i = 0; i < stale.count; i++)
            p->facts.graphics->patch(p, &raster, &stale.box[i], out);
        return !out->failed;
    }
    return show_whole(p, view, out);
}

/* ---- pictures ---- */

/* Cut the view to the place; *copy is to be freed. */
static bool cut_view(struct image_view *view, uint32_t width, uint32_t height, uint8_t **copy)
{
    const size_t stride = (size_t)view->width * 4, kept = (size_t)width * 4;
    *copy = NULL;
    if (view->height > height)
        view->height = height;
    if (view->width <= width)
        return true;
    if (!(*copy = mem_array(view->height, kept)))
        return false;
    for (uint32_t y = 0; y < view->height; y++)
        memcpy(*copy + y * kept, view->rgba + y * stride, kept);
    view->rgba = *copy;
    view->width = width;
    return true;
}

/* Without a palette no pixel is clear. */
void painter_keep(struct painter *p, struct image_view *view, size_t budget, struct buf *out)
{
    uint32_t width, height;
    painter_size(p, &width, &height);
    p->kept.strips = 0;
    if (p->facts.graphics->keeping && p->kept.losses <= STRIPS_MOST && view->below &&
        !view->smooth && view->hue && view->width <= width && view->height <= height)
        send_strips(p, view, budget, out);
    view->strip = p->kept.strip;
    view->strips = p->kept.strips;
}

bool painter_has_room(const struct painter *p)
{
    return p->kept.pixels < STRIPS_PIXELS_MOST / 4 * 3;
}

bool painter_take_reply(struct painter *p, const char *reply)
{
    const struct keeping *keeping = p->facts.graphics->keeping;
    const uint32_t number = keeping ? keeping->lost(reply) : 0;
    const bool is_lost = number > 0 && drop_strip(&p->kept, number);
    p->kept.losses += is_lost;
    return is_lost;
}

void painter_drop(struct painter *p, struct buf *out)
{
    if (p->facts.graphics->keeping)
        p->facts.graphics->keeping->free_all(out);
    p->kept.images = 0;
    p->kept.pixels = 0;
    p->kept.strips = p->kept.losses = 0;
    memset(p->kept.slot, 0, sizeof p->kept.slot);
    painter_forget(p);
}

bool painter_show(struct painter *p, const struct image_view *view, struct buf *out)
{
    const struct graphics *g = p->facts.graphics;
    struct image_view fitting = *view;
    uint32_t width, height;
    OWNED(mem_release) uint8_t *copy = NULL;
    painter_size(p, &width, &height);
    if (view->width == 0 || view->height == 0 || width == 0 || height == 0 ||
        g->kind == GRAPHICS_NOTHING)
        return true;
    if (p->holder && p->holder != g)
        painter_remove(p, out);
    fitting.has_few_greys = view->is_slow && g->palette_always;
    /* Another palette for an outline would cost more. */
    fitting.has_tints |= view->strips > 0 || (view->has_balls && !fitting.has_few_greys);
    const bool fine = cut_view(&fitting, width, height, &copy) &&
                      (g->show ? g->show(p, &fitting, out) : show_pixels(p, &fitting, out));
    if (fine) {
        /* The next picture becomes the shown one. */
        const struct painter_picture former = p->of[0];
        p->of[0] = p->of[1];
        p->of[1] = former;
        p->is_shown = true;
        return true;
    }
    painter_forget(p);
    out->failed = true;
    return false;
}
