#include "render/border.h"

#include <string.h>

#include "base/mem.h"
#include "render/walk.h"

enum { BLOCK = 1 << BORDER_BLOCK_BITS };

static uint32_t blocks_along(const struct border *border, int a)
{
    return walk_blocks(&border->scene->grid, a, BORDER_BLOCK_BITS);
}

/* None of a border that is zeroed. */
static size_t blocks_in(const struct border *border)
{
    return border->scene ? walk_blocks_in(&border->scene->grid, BORDER_BLOCK_BITS) : 0;
}

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
    border->occupied = mem_pages(blocks_in(border));
    for (int label = 1; label < 256; label++)
        border->visible[label] = true;
    memset(border->opacity, BORDER_OPAQUE, sizeof border->opacity);
    border->solid = border->whole = border->shown;
    border->hull = border->border;
    if (border->shown && border->border && border->marked && border->stale && border->changed &&
        border->occupied)
        return OK;
    border_release(border);
    return fault_memory(fault, "the border");
}

static void drop_skin(struct border *border)
{
    const size_t bytes = border->words * sizeof(uint64_t);
    if (border->has_skin) {
        mem_pages_free(border->solid, bytes);
        mem_pages_free(border->hull, bytes);
        mem_pages_free(border->whole, bytes);
        mem_pages_free(border->open, bytes);
    }
    border->has_skin = false;
    border->whole = border->shown;
    border->solid = border->shown;
    border->hull = border->border;
    border->open = NULL;
}

void border_release(struct border *border)
{
    drop_skin(border);
    mem_pages_free(border->shown, border->words * sizeof *border->shown);
    mem_pages_free(border->border, border->words * sizeof *border->border);
    mem_pages_free(border->marked, (border->words / 64 + 1) * sizeof *border->marked);
    mem_pages_free(border->stale, border->words * sizeof *border->stale);
    mem_pages_free(border->changed, border->words * sizeof *border->changed);
    mem_pages_free(border->occupied, blocks_in(border));
    *border = (struct border){0};
}

size_t border_memory(const struct border *border)
{
    const size_t sets = border->has_skin ? 6 : 2;
    return border->words * (sets * sizeof(uint64_t) + sizeof(uint32_t)) + blocks_in(border);
}

/* Which of the 64 cells of word `w` of a set are in it, and not all six neighbours are. */
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

/* Which of the 64 cells of word `w` are shown or skin. */
static uint64_t solid_word(const struct border *border, size_t w)
{
    uint64_t near = border->shown[w];
    for (int a = 0; border->open[w] && a < 3; a++) {
        const ptrdiff_t at = (ptrdiff_t)w * 64, step = border->scene->grid.step[a];
        near |= border_shown_from(border, at - step) | border_shown_from(border, at + step);
    }
    return near & border->open[w];
}

/* Which voxels have a label that the view shows. False where the watch has stopped it. */
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

/* Of solid voxels as they are. */
static void find_blocks(struct border *border)
{
    const struct grid *grid = &border->scene->grid;
    memset(border->occupied, 0, blocks_in(border));
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            const uint32_t first = grid_row(grid, y, z).first;
            uint8_t *block = block_of(border, (struct place){0, y, z});
            for (uint32_t x = 0; x < grid->size[0]; x += BLOCK) /* or a few of the next row */
                *block++ |=
                    (border_solid_from(border, (ptrdiff_t)(first + x)) & ((1 << BLOCK) - 1)) != 0;
        }
}

/* A voxel is solid from now on. */
static void add_block(struct border *border, uint32_t cell)
{
    *block_of(border, grid_place(&border->scene->grid, cell)) = true;
}

/* ---- the skin ---- */

/* Of shown voxels as they are. */
static void find_skin(struct border *border, struct task *task)
{
    /* Which voxels of the scene are not cut away. */
    const struct grid *grid = &border->scene->grid;
    memset(border->open, 0, border->words * sizeof *border->open);
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c = (c | 63) + 1) {
                uint64_t bits = UINT64_MAX << (c & 63);
                if (row.end >> 6 == c >> 6)
                    bits &= ~(UINT64_MAX << (row.end & 63));
                border->open[c >> 6] |= bits;
            }
        }
    cut_clear(&border->cut, border->scene, border->open);
    for (size_t w = 0; w + 1 < border->words && task_advance(task, 32); w++)
        border->solid[w] = solid_word(border, w);
    for (size_t w = 0; w + 1 < border->words && task_advance(task, 32); w++)
        border->hull[w] = edge_word(border, border->solid, w);
}

enum err border_set_skin(struct border *border, bool has_skin, struct fault *fault)
{
    const size_t bytes = border->words * sizeof(uint64_t);
    if (has_skin == border->has_skin)
        return OK;
    drop_skin(border);
    if (!has_skin)
        return OK;
    uint64_t *set[4] = {mem_pages(bytes), mem_pages(bytes), mem_pages(bytes), mem_pages(bytes)};
    if (!set[0] || !set[1] || !set[2] || !set[3]) {
        for (int i = 0; i < 4; i++)
            mem_pages_free(set[i], bytes);
        return fault_memory(fault, "the border");
    }
    border->has_skin = true;
    border->solid = set[0], border->hull = set[1], border->open = set[2], border->whole = set[3];
    border->version++;
    for (size_t w = 0; w < border->words; w++)
        border->changed[w] = border->version;
    struct task task = task_begin(border->scene->watch, "border", 2 * border->scene->grid.cells);
    if (cut_is_none(&border->cut))
        memcpy(border->whole, border->shown, bytes);
    else if (!find_visible(border, border->whole, &task))
        return OK;
    find_skin(border, &task);
    find_blocks(border);
    return OK;
}

/* ---- recounts ---- */

/* Words that end up different count as changed. */
static void take_words(struct border *border, uint64_t *set, const uint64_t *next,
                       struct task *task)
{
    for (size_t w = 0; w + 1 < border->words && task_advance(task, 8); w++) {
        if (next[w] != set[w])
            border->changed[w] = border->version;
        set[w] = next[w];
    }
}

/* False where the watch has stopped it. `border`, which is made anew afterwards, holds what is to
 * be shown until the cut is made, so that only words that end up different count as changed. */
static bool count_shown(struct border *border, struct task *task)
{
    uint64_t *next = border->border;
    if (!find_visible(border, next, task))
        return false;
    border->unnoted = ++border->version;
    if (border->has_skin)
        take_words(border, border->whole, next, task);
    if (!cut_clear(&border->cut, border->scene, next))
        return false;
    take_words(border, border->shown, next, task);
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
    const unsigned scans = border->has_skin ? 3 : 2;
    struct task task = task_begin(border->scene->watch, "border", scans * cells);
    if (!count_shown(border, &task))
        return;
    for (size_t w = 0; w + 1 < border->words && task_advance(&task, 64); w++)
        border->border[w] = edge_word(border, border->shown, w);
    if (border->has_skin)
        find_skin(border, &task);
    find_blocks(border);
}

/* ---- updates ---- */

/* Notes that the word is out of date. */
static inline void mark_word(struct border *border, uint32_t w)
{
    const uint64_t bit = UINT64_C(1) << (w & 63);
    if (border->marked[w >> 6] & bit)
        return;
    border->marked[w >> 6] |= bit;
    border->stale[border->stales++] = w;
}

static inline void mark(struct border *border, uint32_t cell)
{
    mark_word(border, cell >> 6);
}

/* Makes the words anew that are noted. What is solid around them changes the hull further off. */
static void follow_marks(struct border *border, struct task *task)
{
    const size_t beside = border->stales;
    for (size_t i = 0; i < beside; i++) {
        const uint32_t w = border->stale[i];
        border->border[w] = edge_word(border, border->shown, w);
        const uint64_t solid = border->has_skin ? solid_word(border, w) : 0;
        if (border->has_skin && solid != border->solid[w]) {
            for (uint64_t more = solid & ~border->solid[w]; more; more &= more - 1)
                add_block(border, w * 64 + (uint32_t)__builtin_ctzll(more));
            border->solid[w] = solid;
            /* Notes the words in which neighbours of the 64 cells of word `w` lie. */
            const ptrdiff_t *step = border->scene->grid.step;
            for (int a = 0; a < 3; a++)
                for (int sign = -1; sign <= 1; sign += 2)
                    for (int end = 0; end < 64; end += 63) {
                        const ptrdiff_t at = (ptrdiff_t)w * 64 + sign * step[a] + end;
                        if (at >= 0 && (size_t)at >> 6 < border->words - 1)
                            mark_word(border, (uint32_t)(at >> 6));
                    }
        }
        task_advance(task, 1);
    }
    while (border->stales > 0) {
        const uint32_t w = border->stale[--border->stales];
        border->marked[w >> 6] &= ~(UINT64_C(1) << (w & 63));
        if (border->has_skin)
            border->hull[w] = edge_word(border, border->solid, w);
    }
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
        if (border->visible[change->label] == border->visible[change->former_label])
            continue;
        if (border->has_skin) {
            border->whole[at >> 6] ^= UINT64_C(1) << (at & 63);
            border->changed[at >> 6] = border->version;
        }
        if (cut_takes(&border->cut, grid, at))
            continue;
        border->shown[at >> 6] ^= UINT64_C(1) << (at & 63);
        border->changed[at >> 6] = border->version;
        if (border_shows(border, at))
            add_block(border, at);
        for (int a = 0; a < 3; a++) {
            mark(border, at - (uint32_t)step[a]);
            mark(border, at + (uint32_t)step[a]);
        }
        mark(border, at);
    }
    follow_marks(border, &task);
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
