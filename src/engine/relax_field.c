/* SPDX-License-Identifier: MIT */
#include "engine/relax.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/least.h"

/* Vectors of values, which the compiler splits if the machine has none of this size. */
enum { LANES = RELAX_CHUNK / 2, WORD_CHUNKS = 64 / RELAX_CHUNK };
typedef int32_t lanes __attribute__((vector_size(4 * LANES)));
typedef uint32_t sums __attribute__((vector_size(4 * LANES))); /* may overflow 32 bits */
typedef uint64_t quads __attribute__((vector_size(4 * LANES)));

/* Weights of a chunk, 0 for voxels that do not move: -z and +z, -y and +y, -x and +x, low and high
 * half. */
struct relax_weights {
    sums of[3];
};

/* ---- rows ---- */

/* Index of a voxel's row among the stored rows; the first and last rows of each plane, and the
 * planes before and after all, are a rim. */
static size_t row_of(const struct relax_field *f, uint32_t y, uint32_t z)
{
    return ((size_t)z + 1) * (f->size[1] + 2) + y + 1;
}

static uint32_t first_cell(const struct relax_field *f, uint32_t y, uint32_t z)
{
    return grid_cell(&f->scene->grid, f->box.first[0], f->box.first[1] + y, f->box.first[2] + z);
}

/* True if voxels of a parity of x + y + z have an odd x in the box. */
static bool is_odd(const struct relax_field *f, unsigned parity, uint32_t y, uint32_t z)
{
    return ((f->box.first[0] + f->box.first[1] + f->box.first[2] + y + z) & 1) != parity;
}

/* The bits of a chunk: voxels with an even x, and with an odd one. */
enum { EVEN = 0x5555, ODD = 0xaaaa };

static unsigned bits_of(const struct relax_field *f, const uint64_t *set, size_t row, size_t chunk)
{
    const uint64_t word = set[row * f->words + chunk / WORD_CHUNKS];
    return (unsigned)(word >> chunk % WORD_CHUNKS * RELAX_CHUNK) & 0xffff;
}

/* ---- the band ---- */

/* Compare eight labels with `which`; return bits. */
static uint64_t which_of_eight(const uint8_t label[8], uint8_t which)
{
    const uint64_t low = UINT64_C(0x7f7f7f7f7f7f7f7f);
    uint64_t differs = 0;
    for (unsigned i = 0; i < 8; i++)
        differs |= (uint64_t)(label[i] ^ which) << 8 * i;
    const uint64_t same = ~(((differs & low) + low) | differs | low) >> 7;
    return same * UINT64_C(0x0102040810204080) >> 56;
}

/* The bits first..end - 1 of a set, of one of its words. */
static uint64_t bits_between(size_t first, size_t end, size_t word)
{
    const size_t from = 64 * word, low = first > from ? first - from : 0;
    const size_t high = end > from ? end - from : 0;
    const uint64_t before_high = high < 64 ? (UINT64_C(1) << high) - 1 : UINT64_MAX;
    return low < 64 ? before_high & UINT64_MAX << low : 0;
}

/* The bits of a word that are voxels of the row. */
static uint64_t voxels_of(const struct relax_field *f, size_t word)
{
    return bits_between(2, (size_t)f->size[0] + 2, word);
}

/* Fill a row of bits of the label. A voxel outside the box repeats the nearest one inside, so that
 * there is no border: outside the scene there is no other side, and elsewhere no voxel outside the
 * box has the label. */
static void find_inside(const struct relax_field *f, size_t stored_y, size_t stored_z)
{
    const uint32_t *size = f->size;
    const size_t y = stored_y < 1 ? 1 : stored_y > size[1] ? size[1] : stored_y;
    const size_t z = stored_z < 1 ? 1 : stored_z > size[2] ? size[2] : stored_z;
    const uint8_t *label = f->label + first_cell(f, (uint32_t)y - 1, (uint32_t)z - 1);
    uint64_t *row = f->inside + (stored_z * (size[1] + 2) + stored_y) * f->words;
    memset(row, 0, f->words * sizeof *row);
    for (uint32_t x = 0; x < size[0]; x += 8) {
        const uint64_t bits = which_of_eight(label + x, f->which);
        const unsigned shift = (x + 2) % 64;
        row[(x + 2) / 64] |= bits << shift;
        if (shift > 56 && (x + 2) / 64 + 1 < f->words)
            row[(x + 2) / 64 + 1] |= bits >> (64 - shift);
    }
    for (size_t w = 0; w < f->words; w++)
        row[w] &= voxels_of(f, w);
    const size_t end = (size_t)size[0] + 2;
    row[0] |= row[0] >> 1 & 2;
    row[end / 64] |= (row[(end - 1) / 64] >> (end - 1) % 64 & 1) << end % 64;
}

/* Words of a row are processed in pairs. */
typedef uint64_t pair __attribute__((vector_size(16)));

static pair pair_at(const uint64_t *at)
{
    pair words;
    memcpy(&words, at, sizeof words);
    return words;
}

/* Neighbours of a pair along the six directions. Bits from the rows before and after are removed by
 * voxels_of. */
static void find_beside(pair beside[6], const struct relax_field *f, const uint64_t *at)
{
    const size_t across = f->words, along = across * (f->size[1] + 2);
    const pair here = pair_at(at);
    beside[0] = pair_at(at - along);
    beside[1] = pair_at(at - across);
    beside[2] = here << 1 | pair_at(at - 1) >> 63;
    beside[3] = here >> 1 | pair_at(at + 1) << 63;
    beside[4] = pair_at(at + across);
    beside[5] = pair_at(at + along);
}

/* Spread a set in a plane to the neighbours; or, with `edge`, find the voxels with a neighbour on
 * the other side: exactly one of both is in the set. */
static inline void spread(const struct relax_field *f, uint64_t *out, const uint64_t *set,
                          uint32_t z, bool edge)
{
    const size_t first = row_of(f, 0, z) * f->words, end = row_of(f, f->size[1], z) * f->words;
    for (size_t w = first; w < end; w += 2) {
        const pair here = pair_at(set + w), own = edge ? here : (pair){0};
        pair beside[6], any = edge ? (pair){0} : here;
        find_beside(beside, f, set + w);
        for (int way = 0; way < 6; way++)
            any |= own ^ beside[way];
        memcpy(out + w, &any, sizeof any);
    }
}

/* Clear bits outside the voxels of the rows. */
static void clear_ends(const struct relax_field *f, uint64_t *set, uint32_t z)
{
    const size_t first = row_of(f, 0, z) * f->words, end = row_of(f, f->size[1], z) * f->words;
    for (size_t row = first; row < end; row += f->words)
        for (size_t w = 0; w < f->words; w++)
            set[row + w] &= voxels_of(f, w);
}

/* ---- initial chunks ---- */

/* Find the chunks of a row with bits of a mask, as bits. */
static void find_chunks(const struct relax_field *f, uint64_t *chunks, const uint64_t *set,
                        unsigned mask, size_t row)
{
    uint64_t *of_row = chunks + row * f->chunk_words;
    memset(of_row, 0, f->chunk_words * sizeof *of_row);
    for (size_t w = 0; w < f->words; w++)
        for (size_t c = w * WORD_CHUNKS; set[row * f->words + w] && c < (w + 1) * WORD_CHUNKS; c++)
            of_row[c / 64] |= (uint64_t)((bits_of(f, set, row, c) & mask) != 0) << c % 64;
}

/* Assign a chunk its initial values. */
static void fill_chunk(const struct relax_field *f, unsigned parity, bool odd, size_t row,
                       size_t chunk)
{
    static const lanes bit = {1, 4, 16, 64, 256, 1024, 4096, 16384};
    const int32_t inside = (int32_t)(bits_of(f, f->inside, row, chunk) >> odd);
    const lanes value = ((inside & bit) != 0) & RELAX_ONE;
    memcpy(f->u[parity] + (row * f->words * WORD_CHUNKS + chunk) * LANES, &value, sizeof value);
}

static void fill_row(const struct relax_field *f, uint32_t y, uint32_t z)
{
    const size_t row = row_of(f, y, z);
    for (unsigned parity = 0; parity < 2; parity++) {
        const bool odd = is_odd(f, parity, y, z);
        find_chunks(f, f->may[parity], f->band, odd ? ODD : EVEN, row);
        for (size_t c = 0; c < f->words * WORD_CHUNKS; c++)
            if (bits_of(f, f->near, row, c))
                fill_chunk(f, parity, odd, row, c);
    }
}

/* Clear a row outside the box. Nothing moves there, and values matter only next to the box, where
 * the scene continues: they are 0. */
static void clear_rim(const struct relax_field *f, size_t row)
{
    const size_t count = f->words * WORD_CHUNKS * LANES;
    memset(f->band + row * f->words, 0, f->words * sizeof *f->band);
    memset(f->near + row * f->words, 0, f->words * sizeof *f->near);
    for (unsigned parity = 0; parity < 2; parity++) {
        memset(f->u[parity] + row * count, 0, count * sizeof *f->u[parity]);
        memset(f->moved[parity] + row * f->chunk_words, 0, f->chunk_words * sizeof(uint64_t));
        memset(f->end_moved[parity] + row * f->chunk_words, 0, f->chunk_words * sizeof(uint64_t));
        f->row_moved[parity][row] = 0;
    }
}

/* ---- initial field ---- */

/* The buffer of the edge after some spreads: `near` has the last one. */
static uint64_t *spread_set(const struct relax_field *f, uint32_t spreads)
{
    return (f->reach + spreads) % 2 ? f->band : f->near;
}

static void begin_plane(const struct relax_field *f, uint32_t z)
{
    uint64_t *edge = spread_set(f, 0);
    spread(f, edge, f->inside, z, true);
    clear_ends(f, edge, z);
    f->busy[z] = 0;
    for (uint32_t y = 0; y < f->size[1]; y++)
        for (unsigned parity = 0; parity < 2; parity++) {
            const size_t row = row_of(f, y, z), at = row * f->chunk_words;
            memset(f->end_moved[parity] + at, 0, f->chunk_words * sizeof(uint64_t));
            find_chunks(f, f->moved[parity], edge, is_odd(f, parity, y, z) ? ODD : EVEN, row);
            memset(f->known[parity] + at, 0, f->chunk_words * sizeof(uint64_t));
            f->row_moved[parity][row] = 0;
            for (size_t w = 0; w < f->chunk_words; w++)
                f->row_moved[parity][row] |= f->moved[parity][at + w] != 0;
            f->busy[z] += f->row_moved[parity][row];
        }
}

static void make_part(void *context, unsigned worker)
{
    const struct relax_field *f = context;
    const struct share stored = team_share(f->team, worker, (size_t)f->size[2] + 2);
    const struct share planes = team_share(f->team, worker, f->size[2]);
    const uint64_t cost = (uint64_t)f->size[1] * f->words * 4; /* cost of a pass through a plane */
    struct task task = task_begin_part(f->scene->watch, "relaxed labels", 0, f->worker + worker);
    bool may_continue = true;
    for (size_t z = stored.first; z < stored.end && may_continue; z++) {
        for (size_t y = 0; y < (size_t)f->size[1] + 2; y++)
            find_inside(f, y, z);
        const size_t rows = (size_t)f->size[1] + 2, first = z * rows;
        const bool is_rim = z == 0 || z == (size_t)f->size[2] + 1;
        for (size_t y = 0; y < rows; y += is_rim ? 1 : rows - 1)
            clear_rim(f, first + y);
        may_continue = task_advance(&task, 8 * cost);
    }
    team_wait(f->team);
    for (size_t z = planes.first; z < planes.end && may_continue; z++) {
        begin_plane(f, (uint32_t)z);
        may_continue = task_advance(&task, 2 * cost);
    }
    /* The border's own voxels are one step from the other side; the last step is beyond the
     * band. */
    for (uint32_t step = 1; step <= f->reach; step++) {
        uint64_t *const from = spread_set(f, step - 1), *const to = spread_set(f, step);
        team_wait(f->team);
        for (size_t z = planes.first; z < planes.end && may_continue; z++) {
            spread(f, to, from, (uint32_t)z, false);
            if (step < f->reach)
                clear_ends(f, to, (uint32_t)z);
            may_continue = task_advance(&task, cost);
        }
    }
    for (size_t z = planes.first; z < planes.end && may_continue; z++) {
        for (uint32_t y = 0; y < f->size[1]; y++)
            fill_row(f, y, (uint32_t)z);
        may_continue = task_advance(&task, 8 * cost);
    }
}

/* ---- weights ---- */

/* 65536 * exp(-400 * (d / 255)^2), to the nearest; 1 from there on. */
static const uint32_t conductances[] = {
    65536, 65134, 63943, 62006, 59393, 56194, 52517, 48481, 44208, 39818, 35426,
    31133, 27026, 23173, 19627, 16420, 13569, 11076, 8931,  7113,  5596,  4348,
    3338,  2531,  1895,  1402,  1024,  739,   527,   371,   258,   177,   120,
    81,    53,    35,    23,    14,    9,     6,     3,     2,
};
enum { CONDUCTANCES = sizeof conductances / sizeof conductances[0] };

static uint32_t conductance(const struct relax_field *f, const struct cell *a, const struct cell *b)
{
    const struct scene *scene = f->scene;
    const uint32_t difference = (uint32_t)abs(a->intensity - b->intensity);
    uint64_t grey = ((uint64_t)difference * f->scale[0] + (1 << 15)) >> 16;
    for (unsigned i = 0; i < scene->channels; i++) {
        const uint16_t *is = scene->channel[i].intensity;
        const uint32_t other = (uint32_t)abs(is[a - scene->cell] - is[b - scene->cell]);
        const uint64_t greys = ((uint64_t)other * f->scale[1 + i] + (1 << 15)) >> 16;
        grey = greys > grey ? greys : grey;
    }
    return grey < CONDUCTANCES ? conductances[grey] : 1;
}

/* Compute the weights of a voxel. False if it does not move. */
static bool find_weights(uint32_t w[3], const struct relax_field *f, const struct cell *cell)
{
    const ptrdiff_t *step = f->scene->grid.step;
    uint32_t by_face[6], sum = 0;
    if (cell->flags & (CELL_SEED | CELL_OUTSIDE))
        return false;
    for (int i = 0; i < 6; i++) {
        const struct cell *other = cell + (i % 2 ? step[2 - i / 2] : -step[2 - i / 2]);
        by_face[i] = other->flags & (CELL_RIM | CELL_OUTSIDE) ? 0 : conductance(f, cell, other);
        sum += by_face[i];
    }
    if (sum == 0)
        return false;
    const uint64_t each = (UINT64_C(1536) << 32) / sum;
    for (int i = 0; i < 3; i++)
        w[i] = (uint32_t)(by_face[2 * i] * each >> 32 | by_face[2 * i + 1] * each >> 32 << 16);
    return true;
}

/* Compute the weights of a chunk and mark it as known; or, if none of its voxels moves, mark that
 * it may not move, and return false. */
static bool find_chunk(struct relax_field *f, unsigned parity, uint32_t y, uint32_t z, size_t chunk)
{
    const size_t row = row_of(f, y, z), word = row * f->chunk_words + chunk / 64;
    const bool odd = is_odd(f, parity, y, z);
    const unsigned band = bits_of(f, f->band, row, chunk) >> odd;
    const uint64_t bit = UINT64_C(1) << chunk % 64;
    struct relax_weights weights = {0};
    bool moves = false;
    for (unsigned lane = 0; lane < LANES; lane++) {
        const size_t x = chunk * RELAX_CHUNK + 2 * lane + odd - 2;
        uint32_t w[3];
        if (!(band >> 2 * lane & 1) ||
            !find_weights(w, f, f->scene->cell + first_cell(f, y, z) + x))
            continue;
        for (int i = 0; i < 3; i++)
            weights.of[i][lane] = w[i];
        moves = true;
    }
    if (!moves) {
        f->may[parity][word] &= ~bit;
        return false;
    }
    const uint32_t slot = __atomic_fetch_add(&f->slots, 1, __ATOMIC_RELAXED);
    f->weights[slot] = weights;
    f->slot[parity][row * f->words * WORD_CHUNKS + chunk] = slot;
    f->known[parity][word] |= bit;
    return true;
}

/* ---- sweeps ---- */

/* Add the contribution of two neighbours. No sum overflows 32 bits: 1536 * RELAX_ONE < 2^31; an
 * overflow without a voxel does not matter, since the weights are 0. */
static inline void pull(sums *by, const sums *weights, const int32_t *low, const int32_t *high,
                        const sums *own)
{
    sums of_low, of_high;
    memcpy(&of_low, low, sizeof of_low);
    memcpy(&of_high, high, sizeof of_high);
    *by += (*weights & 0xffff) * (of_low - *own) + (*weights >> 16) * (of_high - *own);
}

enum { ROWS_AT_ONCE = sizeof(uint64_t) };

/* A chunk to be moved, of a row of one parity. Their values are independent of each other. */
enum { DUE_MOST = 64 };
struct due {
    size_t at;     /* index among all chunks */
    size_t word;   /* word in sets of chunks, */
    uint64_t bit;  /* and bit */
    uint32_t slot; /* slot with its weights */
    bool odd;
};

/* Move chunks, and mark chunks that moved, and chunks whose voxel next to another chunk of the row
 * moved: the last voxel for odd x, else the first. */
WIDE static void move_chunks(const struct relax_field *f, unsigned parity, struct due *due,
                             unsigned count)
{
    const size_t across = f->words * WORD_CHUNKS * LANES, along = across * (f->size[1] + 2);
    const struct relax_weights *const weights = f->weights;
    uint64_t *const moved = f->moved[parity], *const end_moved = f->end_moved[parity];
    int32_t *const values = f->u[parity];
    const int32_t *const others = f->u[!parity];
    for (const struct due *end = due + count; due < end; due++) {
        const struct relax_weights *const w = &weights[due->slot];
        const int32_t *const other = others + due->at * LANES, *const lower = other - !due->odd;
        int32_t *const u = values + due->at * LANES;
        sums own, all = {0};
        memcpy(&own, u, sizeof own);
        pull(&all, &w->of[0], other - along, other + along, &own);
        pull(&all, &w->of[1], other - across, other + across, &own);
        pull(&all, &w->of[2], lower, lower + 1, &own);
        const lanes by = (lanes)all;
        lanes value = (lanes)own + ((by + 511 + (by >> 10 & 1)) >> 10);
        value &= value > 0;
        const lanes over = value > RELAX_ONE;
        value = (value & ~over) | (RELAX_ONE & over);
        memcpy(u, &value, sizeof value);
        const quads differs = (quads)(value ^ (lanes)own);
        const uint64_t any = differs[0] | differs[1] | differs[2] | differs[3];
        const lanes by_lane = (lanes)differs;
        const int32_t at_end = due->odd ? by_lane[LANES - 1] : by_lane[0];
        moved[due->word] |= any ? due->bit : 0;
        end_moved[due->word] |= at_end ? due->bit : 0;
    }
}

/* Move rows first..end - 1 of a plane, and update row_moved. Return the number of visited rows. */
static uint32_t move_rows(struct relax_field *f, unsigned parity, uint32_t first, uint32_t end,
                          uint32_t z)
{
    const size_t across = f->chunk_words, along = across * (f->size[1] + 2);
    const size_t chunks = f->words * WORD_CHUNKS, first_row = row_of(f, first, z);
    uint64_t *const moved = f->moved[parity], *const end_moved = f->end_moved[parity];
    uint64_t *const may = f->may[parity], *const known = f->known[parity];
    const uint64_t *const others = f->moved[!parity], *const other_spills = f->end_moved[!parity];
    const uint32_t *const slot = f->slot[parity];
    struct due due[DUE_MOST];
    unsigned count = 0;
    bool odd = is_odd(f, parity, first, z);
    for (uint32_t i = 0; i < end - first; i++, odd = !odd)
        for (size_t c = 0; c < across; c++) {
            /* Bits before and after the word may belong to another row: that costs only a visit. */
            const size_t row = first_row + i, at = row * across + c;
            const uint64_t *const other = others + at, *const spill = other_spills + at;
            const uint64_t beside =
                odd ? *spill >> 1 | spill[1] << 63 : *spill << 1 | *(spill - 1) >> 63;
            uint64_t some = (moved[at] | *other | beside | *(other - along) | *(other - across) |
                             other[across] | other[along]) &
                            may[at];
            moved[at] = end_moved[at] = 0;
            for (; some; some &= some - 1) {
                const uint64_t bit = some & -some;
                const size_t chunk = 64 * c + (unsigned)__builtin_ctzll(some);
                if (!(known[at] & bit) && !find_chunk(f, parity, first + i, z, chunk))
                    continue;
                /* Weights are stored in the order of first visits: a large object then needs 0.8 of
                 * the time. */
                const uint32_t weights = slot[row * chunks + chunk];
                __builtin_prefetch(&f->weights[weights]);
                __builtin_prefetch(&f->weights[weights].of[2]);
                due[count++] = (struct due){row * chunks + chunk, at, bit, weights, odd};
                if (count == DUE_MOST) {
                    move_chunks(f, parity, due, count);
                    count = 0;
                }
            }
        }
    move_chunks(f, parity, due, count);
    for (size_t row = first_row; row < first_row + (end - first); row++) {
        uint64_t any = 0;
        for (size_t c = 0; c < across; c++)
            any |= moved[row * across + c];
        f->row_moved[parity][row] = any != 0;
    }
    return end - first;
}

/* The same, if a chunk in the rows or next to them has moved. */
static uint32_t move_some_rows(struct relax_field *f, unsigned parity, uint32_t first, uint32_t end,
                               uint32_t z)
{
    const size_t row = row_of(f, first, z), along = (size_t)f->size[1] + 2;
    const uint8_t *own = f->row_moved[parity] + row, *other = f->row_moved[!parity] + row;
    const uint8_t *near[6] = {own, other, other - 1, other + 1, other - along, other + along};
    uint64_t some = 0;
    if (end - first < ROWS_AT_ONCE)
        return move_rows(f, parity, first, end, z);
    for (int i = 0; i < 6; i++) {
        uint64_t of_rows;
        memcpy(&of_rows, near[i], sizeof of_rows);
        some |= of_rows;
    }
    return some ? move_rows(f, parity, first, end, z) : 0;
}

/*
 * Several half-sweeps, at most RELAX_CHECKPOINT, are done at a time, while the data are in the
 * cache: half-sweep h of a row follows once h - 1 is done in the adjacent rows, and h + 1 in none
 * of them. So rows are processed in the order of y + h, a few at a time, then of z + h, then of h.
 *
 * Each worker has a slab of planes. First it does the work that needs its slab alone, one plane
 * less at both ends with each half-sweep; then, when all have done so, the rest around its last
 * plane.
 */
struct sweeping {
    struct relax_field *field;
    uint32_t first, end, halves; /* half-sweeps; and their total number */
    uint32_t slabs, slab[TEAM_MOST + 1];
};

/* Divide the planes into slabs with similar amounts of movement, with room for `halves` at both
 * ends of each. */
static void divide_rows(struct sweeping *s, uint32_t halves)
{
    const struct relax_field *f = s->field;
    const uint32_t planes = f->size[2], least = 2 * halves, workers = team_size(f->team);
    uint64_t all = 0, before = 0;
    for (uint32_t z = 0; z < planes; z++)
        all += f->busy[z];
    s->slabs = planes / least < workers ? planes / least : workers;
    s->slabs = s->slabs ? s->slabs : 1;
    for (uint32_t i = 1, z = 0; i < s->slabs; i++) {
        const uint32_t least_end = z + least, most = planes - least * (s->slabs - i);
        while (z < most && (z < least_end || before < all * i / s->slabs))
            before += f->busy[z++];
        s->slab[i] = z;
    }
    s->slab[0] = 0;
    s->slab[s->slabs] = planes;
    memset(f->busy, 0, planes * sizeof *f->busy);
}

/* Planes z of half-sweeps h, counted from s->first, with first + h * first_by <= z + h < end + h *
 * end_by. */
struct region {
    uint32_t first, first_by, end, end_by;
};

static bool sweep_region(const struct sweeping *s, struct region region, struct task *task)
{
    struct relax_field *f = s->field;
    const uint32_t halves = s->end - s->first, rows = f->size[1];
    const uint32_t end = region.end + halves * region.end_by;
    for (uint32_t block = 0; block < rows + halves; block += ROWS_AT_ONCE)
        for (uint32_t at = region.first; at < end; at++)
            for (uint32_t h = 0; h < halves; h++) {
                const uint32_t first = block > h ? block - h : 0;
                const uint32_t last = block + ROWS_AT_ONCE > h ? block + ROWS_AT_ONCE - h : 0;
                const uint32_t row_end = last < rows ? last : rows;
                if (at < region.first + h * region.first_by ||
                    at >= region.end + h * region.end_by || first >= row_end)
                    continue;
                f->busy[at - h] += move_some_rows(f, (s->first + h) & 1, first, row_end, at - h);
                if (!task_advance(task, (uint64_t)(row_end - first) * (f->size[0] / 2)))
                    return false;
            }
    return true;
}

static void sweep_part(void *context, unsigned worker)
{
    const struct sweeping *s = context;
    const struct relax_field *f = s->field;
    const bool has_slab = worker < s->slabs;
    const uint32_t first = has_slab ? s->slab[worker] : 0, end = has_slab ? s->slab[worker + 1] : 0;
    const uint64_t each =
        (uint64_t)(end - first) * f->size[1] * (f->size[0] / 2); /* a half-sweep */
    struct task task =
        task_begin_part(f->scene->watch, "relaxed labels", s->halves * each, f->worker + worker);
    task.done = s->first * each;
    /* At the edges of the field there is no adjacent slab. */
    const struct region slab = {first, first ? 2 : 1, end, end == f->size[2]};
    const bool may_continue = has_slab && sweep_region(s, slab, &task);
    team_wait(f->team);
    if (may_continue && worker + 1 < s->slabs)
        sweep_region(s, (struct region){end, 0, end, 2}, &task);
}

/* ---- storing ---- */

static uint32_t checkpoints_of(const struct relax_field *f)
{
    return (f->halves + RELAX_CHECKPOINT - 1) / RELAX_CHECKPOINT;
}

/* First half-sweep after a checkpoint. */
static uint32_t half_after(const struct relax_field *f, uint32_t checkpoint)
{
    const uint32_t half = (checkpoint + 1) * RELAX_CHECKPOINT;
    return half < f->halves ? half : f->halves;
}

static size_t chunk_at(const struct relax_field *f, uint32_t x)
{
    return (x - f->box.first[0] + 2) / RELAX_CHUNK;
}

/* Values of a stored chunk at a checkpoint, even voxels first. */
static int32_t *stored_at(const struct relax_stored *s, uint32_t checkpoint, size_t chunk)
{
    return s->value[(size_t)checkpoint * s->capacity + s->slot[chunk] - 1];
}

/* Allocate a stored field of at most `most` bytes, or NULL: with all checkpoints, for all chunks of
 * the band; or with the end alone, for chunks that may have moved. */
static struct relax_stored *store_new(const struct relax_field *f, bool all, size_t most)
{
    const size_t chunks = f->words * WORD_CHUNKS, rows = f->rows;
    const size_t band = all ? rows * f->words * sizeof *f->band : 0;
    const uint32_t checkpoints = all ? checkpoints_of(f) : 1;
    uint64_t *const *const of = all ? f->may : f->known;
    size_t count = 0;
    for (uint32_t z = 0; z < f->size[2] && most; z++)
        for (size_t w = row_of(f, 0, z) * f->chunk_words;
             w < row_of(f, f->size[1], z) * f->chunk_words; w++)
            count += (size_t)__builtin_popcountll(of[0][w] | of[1][w]);
    const size_t capacity = all ? count + count / 8 + 64 : count; /* updates add some */
    const size_t bytes = sizeof(struct relax_stored) + band + rows * chunks * sizeof(uint32_t) +
                         checkpoints * capacity * sizeof(int32_t[RELAX_CHUNK]);
    struct relax_stored *s = bytes <= most ? mem_pages(bytes) : NULL;
    if (!s)
        return NULL;
    *s = (struct relax_stored){.bytes = bytes,
                               .box = f->box,
                               .checkpoints = checkpoints,
                               .is_updatable = all,
                               .capacity = (uint32_t)capacity};
    memcpy(s->scale, f->scale, sizeof s->scale);
    s->band = (uint64_t *)(s + 1);
    s->slot = (uint32_t *)(s->band + band / sizeof *s->band);
    s->value = (int32_t(*)[RELAX_CHUNK])(s->slot + rows * chunks);
    memcpy(s->band, f->band, band);
    for (uint32_t z = 0; z < f->size[2]; z++)
        for (size_t row = row_of(f, 0, z); row < row_of(f, f->size[1], z); row++)
            for (size_t w = row * f->chunk_words; w < (row + 1) * f->chunk_words; w++)
                for (uint64_t some = of[0][w] | of[1][w]; some; some &= some - 1)
                    s->slot[row * chunks + 64 * (w - row * f->chunk_words) +
                            (unsigned)__builtin_ctzll(some)] = ++s->count;
    return s;
}

/* Copy the values of a chunk out of a field, or into it; even voxels first. */
static void copy_values(const struct relax_field *f, size_t chunk, int32_t value[RELAX_CHUNK],
                        bool out)
{
    for (unsigned parity = 0; parity < 2; parity++) {
        int32_t *u = f->u[parity] + chunk * LANES, *stored = value + parity * LANES;
        memcpy(out ? stored : u, out ? u : stored, LANES * sizeof *u);
    }
}

static void store_values(const struct relax_field *f, struct relax_stored *s, uint32_t checkpoint)
{
    const size_t chunks = f->words * WORD_CHUNKS;
    for (size_t at = row_of(f, 0, 0) * chunks; at < row_of(f, 0, f->size[2]) * chunks; at++)
        if (s->slot[at])
            copy_values(f, at, stored_at(s, checkpoint, at), true);
}

struct relax_stored *relax_field_store(struct relax_field *f, size_t most)
{
    struct relax_stored *s = f->store ? f->store : store_new(f, false, most);
    if (s && !f->store)
        store_values(f, s, 0);
    f->store = NULL;
    return s;
}

/* Do half-sweeps first..end - 1, and show the result after each group of them if `shows`. */
static void sweep(struct relax_field *f, uint32_t first, uint32_t end)
{
    struct watch *watch = f->scene->watch;
    struct sweeping sweeping = {.field = f, .first = first, .halves = f->halves};
    const uint32_t fit = f->size[2] / (2 * team_size(f->team));
    const uint32_t most = fit < RELAX_CHECKPOINT ? fit : RELAX_CHECKPOINT, halves = most ? most : 1;
    for (; sweeping.first < end; sweeping.first = sweeping.end) {
        const uint32_t left = end - sweeping.first;
        sweeping.end = sweeping.first + (left < halves ? left : halves);
        divide_rows(&sweeping, halves);
        team_run(f->team, sweep_part, &sweeping);
        if (f->shows && watch_wants_show(watch) && !watch->ignores_stop)
            watch_show(watch);
    }
}

/* Scale of the intensities in the cells, or, from 1 on, of a further channel: those of the band,
 * without 2 % at each end, to 255 greys. `count` [65536] is overwritten. */
static uint32_t find_scale(const struct relax_field *f, const uint64_t *band, unsigned channel,
                           uint32_t *count)
{
    const struct scene *scene = f->scene;
    const uint16_t *is = channel ? scene->channel[channel - 1].intensity : NULL;
    const uint64_t percent = channel ? scene->channel[channel - 1].percent : scene->percent;
    int32_t range[2];
    memset(count, 0, (UINT16_MAX + 1) * sizeof *count);
    for (uint32_t z = 0; z < f->size[2]; z++)
        for (uint32_t y = 0; y < f->size[1]; y++) {
            const uint64_t *of_row = band + row_of(f, y, z) * f->words;
            const struct cell *row = f->scene->cell + first_cell(f, y, z) - 2;
            for (size_t w = 0; w < f->words; w++)
                for (uint64_t bits = of_row[w]; bits; bits &= bits - 1) {
                    const struct cell *cell = row + 64 * w + (unsigned)__builtin_ctzll(bits);
                    count[is ? is[cell - scene->cell] : cell->intensity]++;
                }
        }
    intensities_range(range, count, 20, 980);
    const uint64_t scale =
        (255U << 16) / (range[1] > range[0] ? (uint32_t)(range[1] - range[0]) : 1);
    return (uint32_t)(scene->channels ? scale * percent / 100 : scale);
}

static void find_scales(uint32_t scale[CHANNELS_MOST + 1], const struct relax_field *f,
                        const uint64_t *band, uint32_t *count)
{
    memset(scale, 0, (CHANNELS_MOST + 1) * sizeof *scale);
    for (unsigned i = 0; i <= f->scene->channels; i++)
        scale[i] = find_scale(f, band, i, count);
}

static bool has_scales(const struct relax_field *f, const struct relax_stored *stored,
                       uint32_t *count)
{
    uint32_t scale[CHANNELS_MOST + 1];
    find_scales(scale, f, stored->band, count);
    return memcmp(scale, stored->scale, sizeof scale) == 0;
}

void relax_field_make(struct relax_field *f)
{
    const struct watch *watch = f->scene->watch;
    team_run(f->team, make_part, f);
    if (watch && watch->stopped) /* the field may be incomplete */
        return;
    find_scales(f->scale, f, f->band, f->count);
    f->store = store_new(f, true, f->room);
    for (uint32_t k = 0; k < checkpoints_of(f); k++) {
        sweep(f, k * RELAX_CHECKPOINT, half_after(f, k));
        if (f->store)
            store_values(f, f->store, k);
    }
}

/* ---- allocation ---- */

/* Reserve bytes of the memory at `*at`, and advance it. */
static void *take_bytes(const struct relax_field *f, size_t *at, size_t bytes)
{
    enum { APART = 64 };
    const size_t first = *at;
    *at += (bytes + APART - 1) / APART * APART;
    return *at <= f->bytes ? (uint8_t *)f->memory + first : NULL;
}

/* Assign memory to all arrays, and return the number of bytes. */
static size_t lay_out(struct relax_field *f)
{
    const size_t voxels = f->rows * f->words * sizeof(uint64_t);
    const size_t chunks = f->rows * f->chunk_words * sizeof(uint64_t);
    const size_t all = f->rows * f->words * WORD_CHUNKS;
    size_t at = 0;
    f->count = take_bytes(f, &at, (UINT16_MAX + 1) * sizeof *f->count);
    f->inside = take_bytes(f, &at, voxels);
    f->band = take_bytes(f, &at, voxels);
    f->near = take_bytes(f, &at, voxels);
    f->busy = take_bytes(f, &at, f->size[2] * sizeof *f->busy);
    for (unsigned parity = 0; parity < 2; parity++) {
        f->moved[parity] = take_bytes(f, &at, chunks);
        f->end_moved[parity] = take_bytes(f, &at, chunks);
        f->may[parity] = take_bytes(f, &at, chunks);
        f->row_moved[parity] = take_bytes(f, &at, f->rows);
        f->known[parity] = take_bytes(f, &at, chunks);
        f->slot[parity] = take_bytes(f, &at, all * sizeof *f->slot[parity]);
        f->u[parity] = take_bytes(f, &at, all * LANES * sizeof *f->u[parity]);
    }
    f->weights = take_bytes(f, &at, 2 * all * sizeof *f->weights);
    return at;
}

/* Set label, box and sizes of a field; its memory is unchanged. */
static void shape(struct relax_field *f, const struct finish_work *work, uint8_t which,
                  struct finish_box box)
{
    mem_pages_free(f->store, f->store ? f->store->bytes : 0);
    *f = (struct relax_field){.scene = work->scene,
                              .label = work->label,
                              .which = which,
                              .team = work->team,
                              .box = box,
                              .memory = f->memory,
                              .bytes = f->bytes};
    for (int a = 0; a < 3; a++)
        f->size[a] = f->box.last[a] - f->box.first[a] + 1;
    f->rows = ((size_t)f->size[1] + 2) * ((size_t)f->size[2] + 2);
    f->words = ((size_t)f->size[0] + 3 + 127) / 128 * 2; /* processed in pairs */
    f->chunk_words = (f->words * WORD_CHUNKS + 63) / 64;
}

void relax_field_read(struct relax_field *f, const struct finish_work *work, uint8_t which,
                      const struct relax_stored *stored)
{
    shape(f, work, which, stored->box);
    f->stored = stored;
}

enum err relax_field_begin(struct relax_field *f, const struct finish_work *work, uint8_t which,
                           const struct finish_box *box, uint32_t reach, uint32_t sweeps,
                           struct fault *fault)
{
    shape(f, work, which, *box);
    f->reach = reach;
    f->halves = 2 * sweeps;
    const size_t bytes = lay_out(f);
    if (bytes > f->bytes) {
        relax_field_release(f);
        f->memory = mem_pages(bytes);
        f->bytes = f->memory ? bytes : 0;
        lay_out(f);
    }
    return f->memory ? OK : fault_memory(fault, "relaxed labels");
}

void relax_field_release(struct relax_field *f)
{
    mem_pages_free(f->store, f->store ? f->store->bytes : 0);
    mem_pages_free(f->memory, f->bytes);
    f->store = NULL;
    f->memory = NULL;
    f->bytes = 0;
}

/* ---- reading ---- */

/* True if a chunk may have moved: its values are listed. */
static bool may_have_moved(const struct relax_field *f, size_t row, size_t chunk)
{
    const size_t word = row * f->chunk_words + chunk / 64;
    return f->stored ? f->stored->slot[row * f->words * WORD_CHUNKS + chunk] != 0
                     : (f->known[0][word] | f->known[1][word]) >> chunk % 64 & 1;
}

bool relax_field_is_initial(const struct relax_field *f, uint32_t x, uint32_t y, uint32_t z)
{
    const uint32_t at[3] = {x, y, z};
    for (int a = 0; a < 3; a++)
        if (at[a] < f->box.first[a] || at[a] > f->box.last[a])
            return true;
    return !may_have_moved(f, row_of(f, y - f->box.first[1], z - f->box.first[2]), chunk_at(f, x));
}

bool relax_field_next(const struct relax_field *f, uint32_t y, uint32_t z, struct relax_part *part)
{
    const size_t row = row_of(f, y, z), chunks = f->words * WORD_CHUNKS;
    for (size_t c = part->chunk; c < chunks; c++) {
        if (!may_have_moved(f, row, c))
            continue;
        const size_t skipped = c ? 0 : 2;
        const size_t x = c * RELAX_CHUNK + skipped - 2, left = f->size[0] - x;
        part->chunk = c + 1;
        part->x = (uint32_t)x;
        part->count = (uint32_t)(left < RELAX_CHUNK - skipped ? left : RELAX_CHUNK - skipped);
        for (unsigned parity = 0; parity < 2; parity++) {
            const bool odd = is_odd(f, parity, y, z);
            const struct relax_stored *stored = f->stored;
            const int32_t *value =
                stored
                    ? stored_at(stored, stored->checkpoints - 1, row * chunks + c) + parity * LANES
                    : f->u[parity] + (row * chunks + c) * LANES;
            for (size_t lane = skipped / 2; lane < LANES; lane++)
                part->value[2 * lane + odd - skipped] = value[lane];
        }
        return true;
    }
    return false;
}

/* ---- updating ---- */

/*
 * The stored field, `whole`, is recomputed around the differences, as a field of its own, `part`. A
 * difference spreads one step along an axis with each half-sweep, and so do wrong values from the
 * border of the part. So values are stored as many steps around the differences as there are
 * half-sweeps in a group, computed in twice as many, and the next group begins with stored values.
 */
struct updating {
    struct relax_stored *stored;
    struct relax_field whole, *part;
    uint32_t checkpoint;
    struct finish_box differs; /* voxels whose values, band or weights may differ from before */
};

/* A chunk in both: its row, its place in the row, and its index among all chunks. */
struct twin {
    size_t row, chunk, at, part_row, part_chunk, part_at;
    uint32_t y, z; /* in the part */
};

typedef bool visit_twin(struct updating *u, const struct twin *twin);

static uint32_t distance(const struct finish_box *box, int a, uint32_t at)
{
    return at < box->first[a] ? box->first[a] - at : at > box->last[a] ? at - box->last[a] : 0;
}

/* Visit the chunks of the part with voxels at most `steps` from a box, until a visit returns
 * false. */
static bool visit_twins(struct updating *u, const struct finish_box *box, uint32_t steps,
                        visit_twin *visit)
{
    const struct relax_field *whole = &u->whole, *part = u->part;
    const uint32_t *from = whole->box.first, *own = part->box.first;
    const size_t shift = (own[0] - from[0]) / RELAX_CHUNK;
    const struct finish_box near = finish_box_widen(box, steps, &part->box);
    bool goes_on = true;
    for (uint32_t z = near.first[2]; z <= near.last[2]; z++)
        for (uint32_t y = near.first[1]; y <= near.last[1]; y++) {
            const uint32_t away = distance(box, 1, y) + distance(box, 2, z);
            if (away > steps)
                continue;
            const struct finish_box row = finish_box_widen(box, steps - away, &part->box);
            struct twin t = {.row = row_of(whole, y - from[1], z - from[2]),
                             .part_row = row_of(part, y - own[1], z - own[2]),
                             .chunk = chunk_at(whole, row.first[0]),
                             .y = y - own[1],
                             .z = z - own[2]};
            for (; goes_on && t.chunk <= chunk_at(whole, row.last[0]); t.chunk++) {
                t.part_chunk = t.chunk - shift;
                t.at = t.row * whole->words * WORD_CHUNKS + t.chunk;
                t.part_at = t.part_row * part->words * WORD_CHUNKS + t.part_chunk;
                goes_on = visit(u, &t);
            }
        }
    return goes_on;
}

/* Store the band of a chunk, and give it initial values at all checkpoints if it is new in the
 * band. False if there is no room. */
static bool define_twin(struct updating *u, const struct twin *t)
{
    struct relax_stored *s = u->stored;
    struct relax_field *part = u->part;
    uint64_t *word = &s->band[t->row * u->whole.words + t->chunk / WORD_CHUNKS];
    const unsigned shift = t->chunk % WORD_CHUNKS * RELAX_CHUNK;
    const uint64_t bits = bits_of(part, part->band, t->part_row, t->part_chunk);
    *word = (*word & ~(UINT64_C(0xffff) << shift)) | bits << shift;
    if (!bits && !s->slot[t->at])
        return true;
    for (unsigned parity = 0; parity < 2; parity++)
        fill_chunk(part, parity, is_odd(part, parity, t->y, t->z), t->part_row, t->part_chunk);
    if (s->slot[t->at])
        return true;
    if (s->count == s->capacity)
        return false;
    s->slot[t->at] = ++s->count;
    for (uint32_t k = 0; k < s->checkpoints; k++)
        copy_values(part, t->part_at, stored_at(s, k, t->at), true);
    return true;
}

/* Give a chunk of the part the values of a checkpoint. */
static bool load_twin(struct updating *u, const struct twin *t)
{
    if (u->stored->slot[t->at])
        copy_values(u->part, t->part_at, stored_at(u->stored, u->checkpoint, t->at), false);
    return true;
}

/* Store the values of a chunk that differ from those of a checkpoint. */
static bool store_twin(struct updating *u, const struct twin *t)
{
    const struct relax_field *f = u->part;
    int32_t now[RELAX_CHUNK], *before;
    if (!u->stored->slot[t->at])
        return true;
    before = stored_at(u->stored, u->checkpoint, t->at);
    copy_values(f, t->part_at, now, true);
    if (memcmp(now, before, sizeof now) == 0)
        return true;
    for (unsigned i = 0; i < RELAX_CHUNK; i++) {
        const size_t lane = 2 * (i % LANES) + is_odd(f, i / LANES, t->y, t->z);
        const uint32_t x = f->box.first[0] + (uint32_t)(t->part_chunk * RELAX_CHUNK + lane) - 2;
        const uint32_t y = f->box.first[1] + t->y, z = f->box.first[2] + t->z;
        if (now[i] != before[i])
            finish_box_include(&u->differs, &(struct finish_box){{x, y, z}, {x, y, z}});
        before[i] = now[i];
    }
    return true;
}

/* Let chunks move that are near enough to the differences: after a checkpoint all of them, else
 * those next to a border. Chunks with voxels to be stored extend further along x. */
static void limit_part(const struct updating *u, bool is_first)
{
    enum { STEPS = 2 * RELAX_CHECKPOINT };
    struct relax_field *f = u->part;
    const uint32_t *first = f->box.first;
    for (uint32_t z = 0; z < f->size[2]; z++)
        for (uint32_t y = 0; y < f->size[1]; y++) {
            const uint32_t away =
                distance(&u->differs, 1, first[1] + y) + distance(&u->differs, 2, first[2] + z);
            const struct finish_box row = finish_box_widen(
                &u->differs, STEPS + RELAX_CHUNK - (away < STEPS ? away : STEPS), &f->box);
            const size_t low = chunk_at(f, row.first[0]), high = chunk_at(f, row.last[0]);
            for (unsigned parity = 0; parity < 2; parity++) {
                const size_t at = row_of(f, y, z) * f->chunk_words;
                const size_t bytes = f->chunk_words * sizeof(uint64_t);
                uint64_t *may = f->may[parity] + at;
                find_chunks(f, f->may[parity], f->band, is_odd(f, parity, y, z) ? ODD : EVEN,
                            row_of(f, y, z));
                for (size_t w = 0; w < f->chunk_words; w++)
                    may[w] &= away > STEPS ? 0 : bits_between(low, high + 1, w);
                if (is_first)
                    continue;
                memcpy(f->moved[parity] + at, may, bytes);
                memcpy(f->end_moved[parity] + at, may, bytes);
                f->row_moved[parity][row_of(f, y, z)] = 1;
                f->busy[z]++;
            }
        }
}

static uint64_t voxels_in(const struct finish_box *box)
{
    uint64_t voxels = 1;
    for (int a = 0; a < 3; a++)
        voxels *= box->last[a] - box->first[a] + 1;
    return voxels;
}

/* The box, `by` larger on each side and extended to chunks along x. */
static struct finish_box whole_chunks(const struct finish_box *box, uint32_t by,
                                      const struct finish_box *all)
{
    struct finish_box wide = finish_box_widen(box, by + RELAX_CHUNK, all);
    const struct finish_box near = finish_box_widen(box, by, all);
    for (int a = 1; a < 3; a++)
        wide.first[a] = near.first[a], wide.last[a] = near.last[a];
    wide.first[0] -= (wide.first[0] - all->first[0]) % RELAX_CHUNK;
    return wide;
}

bool relax_field_update(struct relax_field *part, const struct finish_work *work, uint8_t which,
                        struct relax_stored *stored, uint32_t reach, uint32_t sweeps,
                        struct finish_box *changed, struct finish_box *stale)
{
    const struct finish_box *const all = &stored->box;
    const struct watch *watch = work->scene->watch;
    /* The band changes within `reach` voxels of a border; weights change next to a voxel. */
    const struct finish_box defined = finish_box_widen(changed, reach + 1, all);
    struct updating u = {.stored = stored, .part = part, .differs = defined};
    relax_field_read(&u.whole, work, which, stored);
    part->box = finish_box_none();
    /* Voxels around the differences with a valid band. */
    const uint32_t around = 2 * RELAX_CHECKPOINT + reach + 1;
    for (uint32_t k = 0; k < stored->checkpoints; k++) {
        const struct finish_box sees = whole_chunks(&u.differs, around, all);
        if (!finish_box_contains(&part->box, &sees)) {
            /* Its weights are computed again: leave room for more differences. */
            const struct finish_box box = whole_chunks(&sees, RELAX_CHECKPOINT, all);
            if (2 * voxels_in(&box) > voxels_in(all))
                return false;
            if (relax_field_begin(part, work, which, &box, reach, sweeps, NULL))
                return false;
            team_run(part->team, make_part, part);
            memcpy(part->scale, stored->scale, sizeof part->scale);
        }
        if (!watch || !watch->stopped) {
            if (k)
                visit_twins(&u, &u.differs, 2 * RELAX_CHECKPOINT + RELAX_CHUNK + 1, load_twin);
            else if (!visit_twins(&u, &defined, 0, define_twin) ||
                     !has_scales(&u.whole, stored, part->count))
                return false;
            limit_part(&u, k == 0);
            sweep(part, k * RELAX_CHECKPOINT, half_after(part, k));
        }
        if (watch && watch->stopped) {
            *changed = u.differs; /* these and all that they change are still to be stored */
            return true;
        }
        const struct finish_box differed = u.differs;
        u.checkpoint = k;
        u.differs = defined;
        visit_twins(&u, &differed, RELAX_CHECKPOINT, store_twin);
    }
    finish_box_include(stale, &u.differs);
    *changed = finish_box_none();
    return true;
}
