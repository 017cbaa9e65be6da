#include "render/border.h"

#include <string.h>

#include "base/mem.h"

enum err border_init(struct border *border, const struct scene *scene, struct fault *fault)
{
    size_t words = scene->grid.cells / 64 + 2;
    *border = (struct border){
        .scene = scene, .labels = labels_of_forest(scene), .words = words, .cut = cut_none()};
    border->shown = mem_pages(words * sizeof *border->shown);
    border->border = mem_pages(words * sizeof *border->border);
    border->marked = mem_pages((words / 64 + 1) * sizeof *border->marked);
    border->stale = mem_pages(words * sizeof *border->stale);
    border->changed = mem_pages(words * sizeof *border->changed);
    for (int label = 1; label < 256; label++)
        border->visible[label] = true;
    memset(border->opacity, BORDER_OPAQUE, sizeof border->opacity);
    if (border->shown && border->border && border->marked && border->stale && border->changed)
        return OK;
    border_release(border);
    return fault_memory(fault, "the border");
}

void border_release(struct border *border)
{
    mem_pages_free(border->shown, border->words * sizeof *border->shown);
    mem_pages_free(border->border, border->words * sizeof *border->border);
    mem_pages_free(border->marked, (border->words / 64 + 1) * sizeof *border->marked);
    mem_pages_free(border->stale, border->words * sizeof *border->stale);
    mem_pages_free(border->changed, border->words * sizeof *border->changed);
    *border = (struct border){0};
}

size_t border_memory(const struct border *border)
{
    return border->words * (2 * sizeof(uint64_t) + sizeof(uint32_t));
}

/* Which of the 64 cells of word `w` are border voxels: shown, and not all six neighbours shown. */
static uint64_t border_word(const struct border *border, size_t w)
{
    uint64_t inside = border->shown[w];
    uint64_t shown = inside;
    for (int a = 0; shown && a < 3; a++) {
        ptrdiff_t at = (ptrdiff_t)w * 64, step = border->scene->grid.step[a];
        inside &= border_shown_from(border, at - step);
        inside &= border_shown_from(border, at + step);
    }
    return shown & ~inside;
}

/* False where the watch has stopped it. `border`, which is made anew afterwards, holds what is to
 * be shown until the cut is made, so that only words that end up different count as changed. */
static bool count_shown(struct border *border, struct task *task)
{
    const struct grid *grid = &border->scene->grid;
    const struct labels labels = border->labels;
    uint64_t *next = border->border;
    for (size_t w = 0; w + 1 < border->words; w++) {
        uint64_t word = 0;
        size_t end = w * 64 + 64 < grid->cells ? w * 64 + 64 : grid->cells;
        for (size_t c = w * 64; c < end; c++)
            word |= (uint64_t)border->visible[labels_at(&labels, (uint32_t)c)] << (c & 63);
        next[w] = word;
        if (!task_advance(task, 64))
            return false;
    }
    if (!cut_clear(&border->cut, border->scene, next))
        return false;
    border->unnoted = ++border->version;
    for (size_t w = 0; w + 1 < border->words && task_advance(task, 8); w++) {
        if (next[w] != border->shown[w])
            border->changed[w] = border->version;
        border->shown[w] = next[w];
    }
    return task_advance(task, 0);
}

void border_recount_shown(struct border *border)
{
    const uint64_t cells = border->scene->grid.cells;
    struct task task = task_begin(border->scene->watch, "shown voxels", cells);
    count_shown(border, &task);
}

void border_recount(struct border *border)
{
    const uint64_t cells = border->scene->grid.cells;
    struct task task = task_begin(border->scene->watch, "border", 2 * cells);
    if (!count_shown(border, &task))
        return;
    for (size_t w = 0; w + 1 < border->words && task_advance(&task, 64); w++)
        border->border[w] = border_word(border, w);
}

/* Notes that the word of a cell is out of date. */
static inline void mark(struct border *border, uint32_t at)
{
    const uint32_t w = at >> 6;
    const uint64_t bit = UINT64_C(1) << (w & 63);
    if (border->marked[w >> 6] & bit)
        return;
    border->marked[w >> 6] |= bit;
    border->stale[border->stales++] = w;
}

/* Voxels that change sides lie close together, and many of them share a word. */
void border_update(struct border *border, const struct changes *changes)
{
    if (changes->everything) {
        border_recount(border);
        return;
    }
    const struct grid *grid = &border->scene->grid;
    const ptrdiff_t *step = grid->step;
    struct task task = task_begin(border->scene->watch, "border", changes->count);
    const bool notes_labels = border_is_translucent(border);
    border->version++;
    border->unnoted = notes_labels ? border->unnoted : border->version;
    for (size_t i = 0; i < changes->count && task_advance(&task, 1); i++) {
        const struct change *change = changes->item + i;
        const uint32_t at = change->cell;
        if (notes_labels)
            border->changed[at >> 6] = border->version;
        if (border->visible[change->label] == border->visible[change->former_label] ||
            cut_takes(&border->cut, grid, at))
            continue;
        border->shown[at >> 6] ^= UINT64_C(1) << (at & 63);
        border->changed[at >> 6] = border->version;
        for (int a = 0; a < 3; a++) {
            mark(border, at - (uint32_t)step[a]);
            mark(border, at + (uint32_t)step[a]);
        }
        mark(border, at);
    }
    while (border->stales > 0) {
        const uint32_t w = border->stale[--border->stales];
        border->marked[w >> 6] &= ~(UINT64_C(1) << (w & 63));
        border->border[w] = border_word(border, w);
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
