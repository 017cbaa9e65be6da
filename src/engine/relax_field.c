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

/* The bits of a word that are voxels of the row. */
static uint64_t voxels_of(const struct relax_field *f, size_t word)
{
    const size_t end = (size_t)f->size[0] + 2, first = 64 * word;
    const uint64_t before_end = end >= first + 64 ? UINT64_MAX
                                : end > first     ? (UINT64_C(1) << (end - first)) - 1
                                                  : 0;
    return word ? before_end : before_end & ~UINT64_C(3);
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

static void fill_row(const struct relax_field *f, uint32_t y, uint32_t z)
{
    const size_t row = row_of(f, y, z);
    for (unsigned parity = 0; parity < 2; parity++) {
        const bool odd = is_odd(f, parity, y, z);
        find_chunks(f, f->may[parity], f->band, odd ? ODD : EVEN, row);
        for (size_t c = 0; c < f->words * WORD_CHUNKS; c++)
            if (bits_of(f, f->near, row, c)) {
                /* Fill the values of the chunk. */
                static const lanes bit = {1, 4, 16, 64, 256, 1024, 4096, 16384};
                const int32_t inside = (int32_t)(bits_of(f, f->inside, row, c) >> odd);
                const lanes value = ((inside & bit) != 0) & RELAX_ONE;
                memcpy(f->u[parity] + (row * f->words * WORD_CHUNKS + c) * LANES, &value,
                       sizeof value);
            }
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
    const uint32_t difference = (uint32_t)abs(a->intensity - b->intensity);
    const uint64_t grey = ((uint64_t)difference * f->scale + (1 << 15)) >> 16;
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
 * Several half-sweeps are done at a time, while the data are in the cache: half-sweep h of a row
 * follows once h - 1 is done in the adjacent rows, and h + 1 in none of them. So rows are processed
 * in the order of y + h, a few at a time, then of z + h, then of h.
 *
 * Each worker has a slab of planes. First it does the work that needs its slab alone, one plane
 * less at both ends with each half-sweep; then, when all have done so, the rest around its last
 * plane.
 */
enum { HALVES_AT_ONCE = 16 };

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

void relax_field_make(struct relax_field *f, uint32_t sweeps)
{
    struct watch *watch = f->scene->watch;
    struct sweeping sweeping = {.field = f, .halves = 2 * sweeps};
    const uint32_t fit = f->size[2] / (2 * team_size(f->team));
    const uint32_t most = fit < HALVES_AT_ONCE ? fit : HALVES_AT_ONCE, halves = most ? most : 1;
    team_run(f->team, make_part, f);
    if (watch && watch->stopped) /* the field may be incomplete */
        return;
    /* Scale the intensities of the band, without 2 % at each end, to 255 greys. */
    int32_t range[2];
    memset(f->count, 0, (UINT16_MAX + 1) * sizeof *f->count);
    for (uint32_t z = 0; z < f->size[2]; z++)
        for (uint32_t y = 0; y < f->size[1]; y++) {
            const uint64_t *band = f->band + row_of(f, y, z) * f->words;
            const struct cell *row = f->scene->cell + first_cell(f, y, z) - 2;
            for (size_t w = 0; w < f->words; w++)
                for (uint64_t bits = band[w]; bits; bits &= bits - 1)
                    f->count[row[64 * w + (unsigned)__builtin_ctzll(bits)].intensity]++;
        }
    intensities_range(range, f->count, 20, 980);
    f->scale = (255U << 16) / (range[1] > range[0] ? (uint32_t)(range[1] - range[0]) : 1);
    for (; sweeping.first < sweeping.halves; sweeping.first = sweeping.end) {
        const uint32_t left = sweeping.halves - sweeping.first;
        sweeping.end = sweeping.first + (left < halves ? left : halves);
        divide_rows(&sweeping, halves);
        team_run(f->team, sweep_part, &sweeping);
        if (f->shows && watch_wants_show(watch) && !watch->ignores_stop)
            watch_show(watch);
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
                           const struct finish_box *around, uint32_t reach, struct fault *fault)
{
    /* The field's box is `reach` voxels larger than the label's on each side, within the scene. */
    struct finish_box box;
    for (int a = 0; a < 3; a++) {
        const uint32_t first = around->first[a], last = around->last[a],
                       end = work->scene->grid.size[a] - 1;
        box.first[a] = first > reach ? first - reach : 0;
        box.last[a] = end - last > reach ? last + reach : end;
    }
    shape(f, work, which, box);
    f->reach = reach;
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
    mem_pages_free(f->memory, f->bytes);
    f->memory = NULL;
    f->bytes = 0;
}

/* ---- storing ---- */

/* Chunks of a word that may have moved. */
static uint64_t known_at(const struct relax_field *f, size_t word)
{
    return f->stored ? f->stored->known[word] : f->known[0][word] | f->known[1][word];
}

bool relax_field_is_initial(const struct relax_field *f, uint32_t x, uint32_t y, uint32_t z)
{
    const uint32_t at[3] = {x, y, z};
    for (int a = 0; a < 3; a++)
        if (at[a] < f->box.first[a] || at[a] > f->box.last[a])
            return true;
    const size_t chunk = (x - f->box.first[0] + 2) / RELAX_CHUNK;
    const size_t row = row_of(f, y - f->box.first[1], z - f->box.first[2]);
    return !(known_at(f, row * f->chunk_words + chunk / 64) >> chunk % 64 & 1);
}

struct relax_stored *relax_field_store(const struct relax_field *f, size_t most)
{
    const size_t chunks = f->words * WORD_CHUNKS, words = f->rows * f->chunk_words;
    uint32_t count = 0;
    for (size_t word = 0; word < words; word++)
        count += (uint32_t)__builtin_popcountll(known_at(f, word));
    const size_t bytes = sizeof(struct relax_stored) + words * sizeof(uint64_t) +
                         f->rows * sizeof(uint32_t) + count * sizeof(int32_t[RELAX_CHUNK]);
    struct relax_stored *stored = bytes <= most ? mem_pages(bytes) : NULL;
    if (!stored)
        return NULL;
    count = 0;
    stored->bytes = bytes;
    stored->box = f->box;
    stored->known = (uint64_t *)(stored + 1);
    stored->before = (uint32_t *)(stored->known + words);
    stored->value = (int32_t(*)[RELAX_CHUNK])(stored->before + f->rows);
    for (size_t row = 0; row < f->rows; row++) {
        stored->before[row] = count;
        for (size_t w = 0; w < f->chunk_words; w++) {
            uint64_t known = known_at(f, row * f->chunk_words + w);
            stored->known[row * f->chunk_words + w] = known;
            for (; known; known &= known - 1) {
                const size_t chunk = 64 * w + (unsigned)__builtin_ctzll(known);
                int32_t *value = stored->value[count++];
                for (unsigned parity = 0; parity < 2; parity++)
                    memcpy(value + parity * LANES, f->u[parity] + (row * chunks + chunk) * LANES,
                           LANES * sizeof *value);
            }
        }
    }
    return stored;
}

/* ---- reading ---- */

/* Values of a chunk that may have moved, of one parity. */
static const int32_t *values_of(const struct relax_field *f, unsigned parity, size_t row,
                                size_t chunk)
{
    if (!f->stored)
        return f->u[parity] + (row * f->words * WORD_CHUNKS + chunk) * LANES;
    const uint64_t *known = f->stored->known + row * f->chunk_words;
    size_t at = f->stored->before[row];
    for (size_t w = 0; w < chunk / 64; w++)
        at += (size_t)__builtin_popcountll(known[w]);
    at += (size_t)__builtin_popcountll(known[chunk / 64] & ((UINT64_C(1) << chunk % 64) - 1));
    return f->stored->value[at] + parity * LANES;
}

bool relax_field_next(const struct relax_field *f, uint32_t y, uint32_t z, struct relax_part *part)
{
    const size_t row = row_of(f, y, z), chunks = f->words * WORD_CHUNKS;
    for (size_t c = part->chunk; c < chunks; c++) {
        if (!(known_at(f, row * f->chunk_words + c / 64) >> c % 64 & 1))
            continue;
        const size_t skipped = c ? 0 : 2;
        const size_t x = c * RELAX_CHUNK + skipped - 2, left = f->size[0] - x;
        part->chunk = c + 1;
        part->x = (uint32_t)x;
        part->count = (uint32_t)(left < RELAX_CHUNK - skipped ? left : RELAX_CHUNK - skipped);
        for (unsigned parity = 0; parity < 2; parity++) {
            const bool odd = is_odd(f, parity, y, z);
            const int32_t *value = values_of(f, parity, row, c);
            for (size_t lane = skipped / 2; lane < LANES; lane++)
                part->value[2 * lane + odd - skipped] = value[lane];
        }
        return true;
    }
    return false;
}
