/*
 * How far inside a place is: its value less the level there, above 0 for inside.
 *
 * The level is half, where the smoothed border of anything thick lies. What is thin never gets
 * that far, and would vanish: so where no value around is well above half, the level is 7/8 of the
 * greatest, at which a sheet of any thickness has its faces; and what is thin beside something
 * thick asks for 7/8 of its own value around it. Gaps are the same, with inside and outside
 * exchanged. Where the level is not half, shown voxels are inside and all others outside, by a
 * little at least, so that neither holes nor bridges come of it.
 */
#include "render/field_parts.h"

#ifdef __SSE2__
#include <emmintrin.h>
#endif

enum { HALF = DEEP / 2 - DEEP / 64, PLACES = SAMPLES * SAMPLES * ROW, PART = 16 };

/* A value for each sample, and room for a vector after the last. */
struct map {
    int16_t at[PLACES + ROW];
};

/* ---- what is thin ---- */

/* Patterns of four rows beside each other, along y. */
typedef uint32_t rows __attribute__((vector_size(16)));

static inline rows rows_at(const uint32_t *pattern)
{
    rows r;
    memcpy(&r, pattern, sizeof r);
    return r;
}

/* Which voxels lie in runs of one or two of their kind, and at the end of longer ones, along any
 * axis; of those that are shown, and of the others. */
struct runs {
    rows are_short, are_ends, are_short_gaps, are_gaps_ends;
};

/* By which of the two voxels before and after each are shown. */
static inline void add_runs(struct runs *runs, rows before_2, rows before, rows after, rows after_2)
{
    const rows one = before ^ after, both = before & after, none = ~(before | after);
    const rows longer = (after & after_2) | (before & before_2);
    const rows longer_gap = (~after & ~after_2) | (~before & ~before_2);
    runs->are_short |= none | (one & ~longer);
    runs->are_ends |= one & longer;
    runs->are_short_gaps |= both | (one & ~longer_gap);
    runs->are_gaps_ends |= one & longer_gap;
}

/* Which samples of each row are thin: in a short run, and not at the end of a longer one, which is
 * a bump or a pit. Some rows more than there are, so that four are found at once. */
struct thin {
    uint32_t shown[SAMPLES][SAMPLES + 1], gaps[SAMPLES][SAMPLES + 1];
    bool has_shown, has_gaps;
};

static inline void find_thin_rows(struct thin *thin, const struct patterns *patterns, int y, int z)
{
    enum { R = FIELD_RADIUS };
    const uint32_t *row = &patterns->row[z + R][y + R];
    const rows own = rows_at(row), all = {(1u << SAMPLES) - 1, (1u << SAMPLES) - 1,
                                          (1u << SAMPLES) - 1, (1u << SAMPLES) - 1};
    struct runs runs = {{0}, {0}, {0}, {0}};
    add_runs(&runs, own << 2, own << 1, own >> 1, own >> 2);
    add_runs(&runs, rows_at(row - 2), rows_at(row - 1), rows_at(row + 1), rows_at(row + 2));
    add_runs(&runs, rows_at(row - 2 * INPUT), rows_at(row - INPUT), rows_at(row + INPUT),
             rows_at(row + 2 * INPUT));
    const rows shown = (own & runs.are_short & ~runs.are_ends) >> R & all;
    const rows gaps = (~own & runs.are_short_gaps & ~runs.are_gaps_ends) >> R & all;
    memcpy(&thin->shown[z][y], &shown, sizeof shown);
    memcpy(&thin->gaps[z][y], &gaps, sizeof gaps);
    thin->has_shown |= (shown[0] | shown[1] | shown[2] | shown[3]) != 0;
    thin->has_gaps |= (gaps[0] | gaps[1] | gaps[2] | gaps[3]) != 0;
}

static void find_thin(struct thin *thin, const struct patterns *patterns)
{
    thin->has_shown = thin->has_gaps = false;
    for (int z = 0; z < SAMPLES; z++)
        for (int y = 0; y < SAMPLES; y += 4)
            find_thin_rows(thin, patterns, y, z);
}

/* ---- eight at once ---- */

static inline lanes chosen(lanes mask, lanes a, lanes b)
{
    return (a & mask) | (b & ~mask);
}

/* Compilers do not find the instructions that there are for these. */
static inline lanes lesser(lanes a, lanes b)
{
#ifdef __SSE2__
    return (lanes)_mm_min_epi16((__m128i)a, (__m128i)b);
#else
    return chosen(a < b, a, b);
#endif
}

static inline lanes greater(lanes a, lanes b)
{
#ifdef __SSE2__
    return (lanes)_mm_max_epi16((__m128i)a, (__m128i)b);
#else
    return chosen(a > b, a, b);
#endif
}

/* -1 where a bit is set, bit 0 the first. */
static inline lanes lanes_of(uint32_t bits)
{
    const lanes bit = {1, 2, 4, 8, 16, 32, 64, 128}, none = {0};
    return ((none + (int16_t)(bits & 255)) & bit) != 0;
}

static inline void put(int16_t *at, lanes v)
{
    memcpy(at, &v, sizeof v);
}

/* ---- levels ---- */

/* The level of what is to be inside, by its own value: 7/8 of it for sheets, at which their faces
 * lie; down to 13/16 for lines and single voxels, so that they are as thick as their cubes. */
static inline lanes below(lanes value)
{
    const lanes none = {0}, small = lesser(value, none + DEEP / 4) >> 3;
    return value - (value >> 3) - (small >> 1) + (small * small >> 8);
}

/* The same for what is to be outside. */
static inline lanes above(lanes value)
{
    return DEEP - below(DEEP - value);
}

typedef lanes choice(lanes a, lanes b);

/* Each place gets the extreme of the 27 samples around it; places count from that of sample 1. */
static inline void spread(struct map *map, choice *extreme)
{
    enum { Y = ROW, Z = SAMPLES * ROW };
    int16_t *at = map->at;
    memset(at + PLACES, 0, sizeof map->at - PLACES * sizeof *at);
    for (int i = 0; i < PLACES; i += 8)
        put(at + i, extreme(lanes_at(at + i), extreme(lanes_at(at + i + 1), lanes_at(at + i + 2))));
    for (int i = 0; i < PLACES - 2 * Y; i += 8)
        put(at + i,
            extreme(lanes_at(at + i), extreme(lanes_at(at + i + Y), lanes_at(at + i + 2 * Y))));
    for (int i = 0; i < PLACES - 2 * Z; i += 8)
        put(at + i,
            extreme(lanes_at(at + i), extreme(lanes_at(at + i + Z), lanes_at(at + i + 2 * Z))));
}

/* The level that what is thin asks for, where anything is: its own at its own place, that of the
 * face neighbours beside it, and that of all 26 where none of those is thin. */
struct asked {
    struct map own, around;
    bool is_any;
};

/* Samples that are not thin ask for `none`. */
static inline void ask(struct asked *asked, const struct values *values,
                       uint32_t thin[SAMPLES][SAMPLES + 1], lanes (*level)(lanes), choice *extreme,
                       lanes none)
{
    for (int z = 0; z < SAMPLES; z++)
        for (int y = 0; y < SAMPLES; y++)
            for (int half = 0; half < 2; half++)
                put(asked->own.at + (z * SAMPLES + y) * ROW + 8 * half,
                    chosen(lanes_of(thin[z][y] >> (8 * half)), level(values->row[z][y].half[half]),
                           none));
    asked->around = asked->own;
    spread(&asked->around, extreme);
}

/* Of eight places from `i` on. */
static inline lanes asked_at(const struct asked *asked, int i, choice *extreme, lanes none)
{
    enum { Y = ROW, Z = SAMPLES * ROW };
    const int16_t *at = asked->own.at + i + Z + Y + 1;
    const lanes own = lanes_at(at);
    const lanes x = extreme(lanes_at(at - 1), lanes_at(at + 1));
    const lanes y = extreme(lanes_at(at - Y), lanes_at(at + Y));
    const lanes z = extreme(lanes_at(at - Z), lanes_at(at + Z));
    const lanes beside = extreme(x, extreme(y, z));
    return chosen(own != none, own, chosen(beside != none, beside, lanes_at(asked->around.at + i)));
}

struct levels {
    struct map least, most; /* values around each place */
    struct asked inside, outside;
};

static void find_levels(struct levels *levels, const struct values *values,
                        const struct patterns *patterns)
{
    const lanes half = (lanes){0} + HALF;
    struct thin thin;
    memcpy(levels->least.at, values->row, PLACES * sizeof *levels->least.at);
    memcpy(levels->most.at, values->row, PLACES * sizeof *levels->most.at);
    spread(&levels->least, lesser);
    spread(&levels->most, greater);
    find_thin(&thin, patterns);
    levels->inside.is_any = thin.has_shown;
    levels->outside.is_any = thin.has_gaps;
    if (thin.has_shown)
        ask(&levels->inside, values, thin.shown, below, lesser, half);
    if (thin.has_gaps)
        ask(&levels->outside, values, thin.gaps, above, greater, half);
}

/* Lanes beyond the block may hold anything, of which sums and products may wrap. */
typedef uint16_t wraps __attribute__((vector_size(sizeof(lanes))));

/* Eight places from `i` on, whose values and shown voxels these are. */
static inline lanes inside_of(const struct levels *levels, int i, lanes value, uint32_t shown)
{
    const lanes half = (lanes){0} + HALF;
    lanes low = lesser(half, below(lanes_at(levels->most.at + i)));
    lanes high = greater(half, above(lanes_at(levels->least.at + i)));
    if (levels->inside.is_any)
        low = lesser(low, asked_at(&levels->inside, i, lesser, half));
    if (levels->outside.is_any)
        high = greater(high, asked_at(&levels->outside, i, greater, half));
    const lanes inside = (lanes)((wraps)value - ((wraps)low + (wraps)high - (wraps)half));
    const lanes little = (lesser(value, DEEP - value) >> 4) + 1;
    const lanes kept = chosen(lanes_of(shown), greater(inside, little), lesser(inside, -little));
    return chosen(low < high, kept, inside);
}

static inline lanes times_unit(lanes inside)
{
    return (lanes)((wraps)inside * FIELD_INSIDE_UNIT);
}

void inside_find(struct field_block *block, const struct values *values,
                 const struct patterns *patterns)
{
    enum { FIRST = FIELD_RADIUS + 1 }; /* the voxel of place 0 */
    struct levels levels;
    find_levels(&levels, values, patterns);
    for (int z = 0; z < FIELD_SIDE; z++)
        for (int y = 0; y < FIELD_SIDE; y++) {
            const uint32_t shown = patterns->row[z + FIRST][y + FIRST] >> FIRST;
            int16_t value[ROW + 8] = {0}, row[ROW];
            memcpy(value, &values->row[z + 1][y + 1], ROW * sizeof *value);
            for (int x = 0; x < ROW; x += 8)
                put(row + x, times_unit(inside_of(&levels, (z * SAMPLES + y) * ROW + x,
                                                  lanes_at(value + x + 1), shown >> x)));
            memcpy(block->inside[z][y], row, sizeof block->inside[z][y]);
        }
}
