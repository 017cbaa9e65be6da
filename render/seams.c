#include "render/seams.h"

#include <string.h>

#include "base/mem.h"

void seams_release(struct seams *seams)
{
    for (int a = 0; a < 3; a++)
        mem_pages_free(seams->between[a], seams->words * sizeof(uint64_t));
    mem_pages_free(seams->edge, seams->words * sizeof(uint64_t));
    mem_pages_free(seams->near, seams->words * sizeof(uint64_t));
    mem_pages_free(seams->label, seams->words * 64);
    *seams = (struct seams){0};
}

size_t seams_bytes(const struct seams *seams)
{
    return seams->words * (5 * sizeof(uint64_t) + 64);
}

static enum err make_room(struct seams *seams, size_t words, struct fault *fault)
{
    if (seams->words == words)
        return OK;
    seams_release(seams);
    seams->words = words;
    for (int a = 0; a < 3; a++)
        seams->between[a] = mem_pages(words * sizeof(uint64_t));
    seams->edge = mem_pages(words * sizeof(uint64_t));
    seams->near = mem_pages(words * sizeof(uint64_t));
    seams->label = mem_pages(words * 64);
    if (seams->between[0] && seams->between[1] && seams->between[2] && seams->edge && seams->near &&
        seams->label)
        return OK;
    seams_release(seams);
    return fault_memory(fault, "faces between objects");
}

/* Of the faces of a word, and those before it. */
static uint64_t edge_word(const struct seams *seams, const struct border *border, size_t w)
{
    const ptrdiff_t at = (ptrdiff_t)w * 64;
    const uint64_t own = border->shown[w];
    uint64_t found = 0;
    for (int a = 0; a < 3; a++) {
        const ptrdiff_t step = border->scene->grid.step[a];
        found |= own ^ border_shown_from(border, at + step);
        found |= own ^ border_shown_from(border, at - step);
        found |= seams_toward(seams, w, a, step) | seams_toward(seams, w, a, -step);
    }
    return found;
}

enum err seams_count(struct seams *seams, const struct border *border, struct fault *fault)
{
    if (seams->border == border && seams->version == border->version)
        return OK;
    seams->border = NULL;
    seams->has_near = false;
    const enum err err = make_room(seams, border->words, fault);
    struct task task = task_begin(border->scene->watch, "border", 2 * border->scene->grid.cells);
    if (err)
        return err;
    labels_copy(&border->labels, seams->label, NULL);
    for (size_t w = 0; w + 1 < border->words && task_advance(&task, 64); w++) {
        /* One word for each axis. */
        const ptrdiff_t at = (ptrdiff_t)w * 64;
        for (int a = 0; a < 3; a++) {
            const ptrdiff_t step = border->scene->grid.step[a];
            uint64_t both = border->shown[w], found = 0;
            both &= border_shown_from(border, at + step);
            for (; both; both &= both - 1) {
                const uint32_t cell = (uint32_t)at + (uint32_t)__builtin_ctzll(both);
                const bool differ = seams->label[cell] != seams->label[cell + (uint32_t)step];
                found |= differ ? both & -both : 0;
            }
            seams->between[a][w] = found;
        }
    }
    for (size_t w = 0; w + 1 < border->words && task_advance(&task, 64); w++)
        seams->edge[w] = edge_word(seams, border, w);
    if (!task_advance(&task, 0))
        return OK;
    seams->border = border;
    seams->version = border->version;
    return OK;
}

/* ---- what is near an edge ---- */

/* Each cell gets what is up to SEAMS_NEAR steps after it, and before it. */
static void spread(uint64_t *set, size_t words, ptrdiff_t step)
{
    _Static_assert(SEAMS_NEAR == 1 + 2 + 4, "the steps of three passes");
    for (ptrdiff_t apart = step; apart <= 4 * step; apart *= 2) {
        for (size_t w = 0; w + 1 < words; w++)
            set[w] |= border_bits_from(set, words, (ptrdiff_t)w * 64 + apart);
        for (size_t w = words - 1; w-- > 0;)
            set[w] |= border_bits_from(set, words, (ptrdiff_t)w * 64 - apart);
    }
}

void seams_find_near(struct seams *seams)
{
    if (seams->has_near || !seams->border)
        return;
    memcpy(seams->near, seams->edge, seams->words * sizeof *seams->near);
    for (int a = 0; a < 3; a++)
        spread(seams->near, seams->words, seams->border->scene->grid.step[a]);
    seams->has_near = true;
}

/* ---- after an edit ---- */

/* The face between a cell and the next along an axis. */
static void judge(struct seams *seams, const struct border *border, uint32_t cell, int a)
{
    const uint32_t next = cell + (uint32_t)border->scene->grid.step[a];
    const uint64_t bit = UINT64_C(1) << (cell & 63);
    const bool is_seam = border_shows(border, cell) && border_shows(border, next) &&
                         seams->label[cell] != seams->label[next];
    uint64_t *word = &seams->between[a][cell >> 6];
    *word = is_seam ? *word | bit : *word & ~bit;
}

enum err seams_follow(struct seams *seams, const struct border *border,
                      const struct changes *changes, struct fault *fault)
{
    if (changes->everything || seams->border != border || seams->version + 1 != border->version)
        return seams_count(seams, border, fault);
    struct task task = task_begin(border->scene->watch, "border", 3 * changes->count);
    for (size_t i = 0; i < changes->count; i++)
        seams->label[changes->item[i].cell] = labels_at(&border->labels, changes->item[i].cell);
    for (size_t i = 0; i < changes->count && task_advance(&task, 1); i++)
        for (int a = 0; a < 3; a++) {
            const uint32_t cell = changes->item[i].cell;
            judge(seams, border, cell, a);
            judge(seams, border, cell - (uint32_t)border->scene->grid.step[a], a);
        }
    for (size_t i = 0; i < changes->count && task_advance(&task, 1); i++) {
        /* Around a cell, once its faces are known: in words of its own and of its neighbours. */
        const uint32_t cell = changes->item[i].cell;
        const ptrdiff_t *step = border->scene->grid.step;
        const size_t own = cell >> 6;
        seams->edge[own] = edge_word(seams, border, own);
        for (int k = 0; k < 6; k++) {
            const size_t w = (cell + (uint32_t)(k % 2 ? step[k / 2] : -step[k / 2])) >> 6;
            if (w != own)
                seams->edge[w] = edge_word(seams, border, w);
        }
    }
    for (size_t i = 0; seams->has_near && i < changes->count && task_advance(&task, 1); i++) {
        /* A cell's own faces or those of its neighbours may have become edges. */
        enum { REACH = SEAMS_NEAR + 1 };
        for (ptrdiff_t z = -REACH; z <= REACH; z++)
            for (ptrdiff_t y = -REACH; y <= REACH; y++) {
                const ptrdiff_t middle = (ptrdiff_t)changes->item[i].cell +
                                         y * border->scene->grid.step[1] +
                                         z * border->scene->grid.step[2];
                for (ptrdiff_t at = middle - REACH; at <= middle + REACH; at++)
                    if (at >= 0 && (size_t)at < border->scene->grid.cells)
                        seams->near[at >> 6] |= UINT64_C(1) << (at & 63);
            }
    }
    seams->version = border->version;
    if (watch_stops(border->scene->watch))
        seams->border = NULL;
    return OK;
}
