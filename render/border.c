/* SPDX-License-Identifier: MIT */
#include "render/border.h"

#include <string.h>

#include "base/mem.h"
#include "engine/changes.h"

enum { BLOCK = 1 << BORDER_BLOCK_BITS };

static size_t blocks_along(const struct border *border, int a)
{
    return ((border->scene->grid.size[a] - 1) >> BORDER_BLOCK_BITS) + 1;
}

/* Number of blocks; 0 for a zeroed border. */
static size_t blocks_in(const struct border *border)
{
    return border->scene
               ? blocks_along(border, 0) * blocks_along(border, 1) * blocks_along(border, 2)
               : 0;
}

/* All sets share one piece of memory: `shown`, `border`, `marked`, `stale`, `changed`, `occupied`.
 */
size_t border_memory(const struct border *border)
{
    const size_t a_word =
        2 * sizeof *border->shown + sizeof *border->stale + sizeof *border->changed;
    const size_t marks = border->words ? border->words / 64 + 1 : 0;
    return border->words * a_word + marks * sizeof *border->marked + blocks_in(border);
}

enum err border_init(struct border *border, const struct scene *scene, struct fault *fault)
{
    const size_t words = scene->grid.cells / 64 + 2;
    *border = (struct border){
        .scene = scene, .labels = labels_of_forest(scene), .words = words, .cut = cut_none()};
    for (int label = 1; label < 256; label++)
        border->visible[label] = true;
    memset(border->opacity, BORDER_OPAQUE, sizeof border->opacity);
    border->shown = mem_pages(border_memory(border));
    if (!border->shown) {
        *border = (struct border){0};
        return fault_memory(fault, "the border");
    }
    border->border = border->shown + words;
    border->marked = border->border + words;
    border->stale = (uint32_t *)(border->marked + words / 64 + 1);
    border->changed = border->stale + words;
    border->occupied = (uint8_t *)(border->changed + words);
    return OK;
}

void border_release(struct border *border)
{
    mem_pages_free(border->shown, border_memory(border));
    *border = (struct border){0};
}

/* Return the cells of word `w` of a set that have a face neighbour outside the set. */
static uint64_t edge_word(const struct border *border, const uint64_t *set, size_t w)
{
    const uint64_t own = set[w];
    uint64_t inside = own;
    for (int a = 0; own && a < 3; a++) {
        const ptrdiff_t at = (ptrdiff_t)w * 64, step = border->scene->grid.step[a];
        inside &= border_bits_from(set, border->words, at - step);
        inside &= border_bits_from(set, border->words, at + step);
    }
    return own & ~inside;
}

/* Find the voxels whose label is visible. False if the watch has stopped it. */
static bool find_visible(const struct border *border, uint64_t *bits, struct task *task)
{
    const size_t cells = border->scene->grid.cells;
    const struct labels labels = border->labels;
    for (size_t w = 0; w + 1 < border->words; w++) {
        uint64_t word = 0;
        size_t end = w * 64 + 64 < cells ? w * 64 + 64 : cells;
        for (size_t c = w * 64; c < end; c++)
            word |= (uint64_t)border->visible[labels_at(&labels, (uint32_t)c)] << (c & 63);
        bits[w] = word;
        if (!task_advance(task, 64))
            return false;
    }
    return true;
}

/* ---- blocks ---- */

static inline uint8_t *block_of(const struct border *border, struct place p)
{
    const size_t x = p.x >> BORDER_BLOCK_BITS, y = p.y >> BORDER_BLOCK_BITS;
    const size_t z = p.z >> BORDER_BLOCK_BITS;
    return border->occupied + (z * blocks_along(border, 1) + y) * blocks_along(border, 0) + x;
}

/* ---- recounts ---- */

void border_recount(struct border *border)
{
    const uint64_t cells = border->scene->grid.cells;
    struct task task = task_begin(border->scene->watch, "border", 2 * cells);
    /* border->border is recomputed below. Until then it holds the voxels to be shown before the
     * cut, so that only words that differ after the cut count as changed. */
    uint64_t *next = border->border;
    if (!find_visible(border, next, &task))
        return;
    border->version++;
    if (!cut_clear(&border->cut, border->scene, next))
        return;
    /* Note the version of each word that differs. */
    for (size_t w = 0; w + 1 < border->words && task_advance(&task, 8); w++) {
        if (next[w] != border->shown[w])
            border->changed[w] = border->version;
        border->shown[w] = next[w];
    }

    if (!task_advance(&task, 0))
        return;
    for (size_t w = 0; w + 1 < border->words && task_advance(&task, 64); w++)
        border->border[w] = edge_word(border, border->shown, w);
    /* Recompute which blocks have a shown voxel. */
    const struct grid *grid = &border->scene->grid;
    memset(border->occupied, 0, blocks_in(border));
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            const uint32_t first = grid_row(grid, y, z).first;
            uint8_t *block = block_of(border, (struct place){0, y, z});
            for (uint32_t x = 0; x < grid->size[0]; x += BLOCK) /* the last block may include cells
                                                                   of the next row */
                *block++ |= (border_bits_at(border->shown, first + x) & ((1 << BLOCK) - 1)) != 0;
        }
}

/* ---- updates ---- */

/* Mark the word of a cell as out of date. */
static inline void mark_word(struct border *border, uint32_t cell)
{
    const uint32_t w = cell >> 6;
    const uint64_t bit = UINT64_C(1) << (w & 63);
    if (border->marked[w >> 6] & bit)
        return;
    border->marked[w >> 6] |= bit;
    border->stale[border->stales++] = w;
}

/* Voxels that change are close together, and many share a word. */
void border_update(struct border *border, const struct changes *changes)
{
    if (changes->everything) {
        border_recount(border);
        return;
    }
    const struct grid *grid = &border->scene->grid;
    const ptrdiff_t *step = grid->step;
    struct task task = task_begin(border->scene->watch, "border", changes->count);
    border->version++;
    for (size_t i = 0; i < changes->count && task_advance(&task, 1); i++) {
        const struct change *change = changes->item + i;
        const uint32_t at = change->cell;
        if (border->visible[change->label] == border->visible[change->former_label])
            continue;
        if (cut_removes(&border->cut, grid, at))
            continue;
        border->shown[at >> 6] ^= UINT64_C(1) << (at & 63);
        border->changed[at >> 6] = border->version;
        if (border_shows(border, at)) /* the voxel has become visible */
            *block_of(border, grid_place(&border->scene->grid, at)) = true;
        for (int a = 0; a < 3; a++) {
            mark_word(border, at - (uint32_t)step[a]);
            mark_word(border, at + (uint32_t)step[a]);
        }
        mark_word(border, at);
    }
    /* Recompute the words that are marked. */
    while (border->stales > 0) {
        const uint32_t w = border->stale[--border->stales];
        border->marked[w >> 6] &= ~(UINT64_C(1) << (w & 63));
        border->border[w] = edge_word(border, border->shown, w);
        task_advance(&task, 1);
    }
}

bool border_is_translucent(const struct border *border)
{
    for (int label = 1; label < 256; label++)
        if (border->visible[label] && border->opacity[label] < BORDER_OPAQUE)
            return true;
    return false;
}

size_t border_count(const struct border *border)
{
    size_t count = 0;
    for (size_t w = 0; w < border->words; w++)
        count += (size_t)__builtin_popcountll(border->border[w]);
    return count;
}
