#include "tui/picture/strips.h"

#include <nettle/sha2.h>
#include <stdlib.h>
#include <string.h>

#include "base/least.h"
#include "base/mem.h"
#include "tui/picture/painter.h"

void strips_forget(struct strips *k)
{
    k->images = 0;
    k->pixels = 0;
    k->strips = 0;
    memset(k->slot, 0, sizeof k->slot);
}

void strips_release(struct strips *k)
{
    free(k->image);
    free(k->greys);
    *k = (struct strips){0};
}

/* ---- what the terminal has ---- */

static struct strips_image *find(struct strips *k, const uint8_t key[STRIPS_KEY])
{
    for (size_t i = 0; i < k->images; i++)
        if (memcmp(k->image[i].key, key, STRIPS_KEY) == 0)
            return &k->image[i];
    return NULL;
}

static void remove_image(struct strips *k, struct strips_image *image)
{
    k->pixels -= image->pixels;
    *image = k->image[--k->images];
}

bool strips_lost(struct strips *k, uint32_t number)
{
    for (unsigned i = 0; i < STRIPS_MOST; i++)
        if (k->slot[i].number == number)
            k->slot[i].number = 0;
    for (size_t i = 0; i < k->images; i++)
        if (k->image[i].number == number) {
            remove_image(k, &k->image[i]);
            return true;
        }
    return false;
}

/* Frees what was not used for longest, until so many pixels more are no longer too many. What is
 * used by the view at hand stays. */
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
        strips_lost(k, oldest->number);
    }
}

/* ---- strips ---- */

/* How many pixels a strip has: more where slices are so large that strips would be too many. */
static uint32_t strip_pixels(const struct image_view *view)
{
    uint64_t all = 0;
    for (unsigned i = 0; i < view->slices; i++)
        all += (uint64_t)view->slice[i].width * view->slice[i].height;
    const uint64_t each = all / (STRIPS_MOST / 2);
    return each < STRIPS_EACH_PIXELS ? STRIPS_EACH_PIXELS
           : each < UINT32_MAX       ? (uint32_t)each
                                     : UINT32_MAX;
}

/* Cuts the boxes of slices into strips of whole rows of cells. */
static void cut(struct painter *p, const struct image_view *view)
{
    struct strips *k = &p->kept;
    const uint32_t pixels = strip_pixels(view);
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
                {box.left, box.top + y, box.width, least(height, box.height - y)}, false};
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

static void take(struct strips *k, unsigned i, struct strips_image *image)
{
    image->used = k->clock;
    k->number[i] = image->number;
    k->strip[i].is_there = true;
}

static bool fill(struct strips *k, const struct image_view *view, const struct raster_box *box)
{
    if (!mem_grow(&k->greys, &k->greys_capacity, (size_t)box->width * box->height, 1))
        return false;
    for (uint32_t y = 0; y < box->height; y++)
        for (uint32_t x = 0; x < box->width; x++) {
            const uint8_t grey = view->below[(size_t)(box->top + y) * view->width + box->left + x];
            k->greys[(size_t)y * box->width + x] =
                (uint8_t)((grey * (STRIPS_GREYS - 1u) + 127) / 255);
        }
    return true;
}

static void send(struct painter *p, const struct image_view *view, unsigned i,
                 const uint8_t key[STRIPS_KEY], struct buf *out)
{
    struct strips *k = &p->kept;
    const struct raster_box *box = &k->strip[i].box;
    const uint32_t pixels = box->width * box->height;
    uint32_t grey[STRIPS_GREYS];
    for (unsigned level = 0; level < STRIPS_GREYS; level++)
        grey[level] =
            (level * 255 + (STRIPS_GREYS - 1) / 2) / (STRIPS_GREYS - 1) * UINT32_C(0x010101);
    if (!fill(k, view, box) ||
        !mem_grow(&k->image, &k->capacity, k->images + 1, sizeof *k->image)) {
        out->failed = true;
        return;
    }
    make_room(p, pixels, out);
    const struct raster raster = {.width = box->width,
                                  .height = box->height,
                                  .stride = box->width,
                                  .bytes = k->greys,
                                  .colour = grey,
                                  .colours = STRIPS_GREYS};
    struct strips_image *image = &k->image[k->images++];
    *image = (struct strips_image){.number = ++k->last, .pixels = pixels};
    memcpy(image->key, key, STRIPS_KEY);
    k->pixels += pixels;
    p->effort = view->is_slow ? PNG_SLOW_LINE : PNG_FAST;
    p->facts.graphics->keeping->send(p, &raster, image->number, out);
    take(k, i, image);
}

static bool is_looked_at(const struct image_view *view, const struct raster_box *box)
{
    return box->left >= view->focus.left && box->top >= view->focus.top &&
           box->left < view->focus.left + view->focus.width &&
           box->top < view->focus.top + view->focus.height;
}

void strips_prepare(struct painter *p, const struct image_view *view, size_t budget,
                    struct buf *out)
{
    struct strips *k = &p->kept;
    uint8_t key[STRIPS_MOST][STRIPS_KEY];
    const size_t before = out->length;
    size_t most = 0;
    k->clock++;
    cut(p, view);
    for (unsigned i = 0; i < k->strips; i++) {
        key_of(key[i], view, &k->strip[i].box);
        struct strips_image *image = find(k, key[i]);
        k->number[i] = 0;
        if (image)
            take(k, i, image);
    }
    for (unsigned round = 0; budget > 0 && round < 2; round++)
        for (unsigned i = 0; i < k->strips; i++) {
            const size_t length = out->length;
            struct strips_image *image = find(k, key[i]); /* black ones are much alike */
            if (k->number[i] || is_looked_at(view, &k->strip[i].box) == (round > 0))
                continue;
            if (image) {
                take(k, i, image);
                continue;
            }
            if (most > 0 && length - before + most > budget)
                return;
            send(p, view, i, key[i], out);
            most = out->length - length > most ? out->length - length : most;
        }
}

void strips_clear(const struct strips *k, const struct image_view *view, uint8_t *places,
                  uint32_t stride)
{
    for (unsigned i = 0; i < view->strips; i++) {
        const struct raster_box *box = &view->strip[i].box;
        if (!view->strip[i].is_there || k->number[i] == 0)
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

/* ---- on the screen ---- */

static bool same_box(const struct raster_box *a, const struct raster_box *b)
{
    return memcmp(a, b, sizeof *a) == 0;
}

static void hide(struct painter *p, unsigned i, struct buf *out)
{
    struct strips_slot *slot = &p->kept.slot[i];
    if (slot->number)
        p->facts.graphics->keeping->hide(slot->number, i, out);
    slot->number = 0;
}

/* A strip comes before the one in its place goes, so that nothing is black in between; but those of
 * another layout, which may lie over it, go first. */
void strips_show(struct painter *p, struct buf *out)
{
    struct strips *k = &p->kept;
    for (unsigned i = 0; i < STRIPS_MOST; i++)
        if (i >= k->strips || !same_box(&k->slot[i].box, &k->strip[i].box))
            hide(p, i, out);
    for (unsigned i = 0; i < k->strips; i++) {
        const struct strips_slot former = k->slot[i];
        const struct raster_box *box = &k->strip[i].box;
        if (!k->strip[i].is_there || (former.number == k->number[i] && same_box(&former.box, box)))
            continue;
        p->facts.graphics->keeping->place(p, k->number[i], i, box, out);
        hide(p, i, out);
        k->slot[i] = (struct strips_slot){k->number[i], *box};
    }
}

void strips_hide(struct painter *p, struct buf *out)
{
    for (unsigned i = 0; i < STRIPS_MOST; i++)
        hide(p, i, out);
    p->kept.strips = 0;
}
