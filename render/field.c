#include "render/field.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum {
    SAMPLES = FIELD_SIDE + 2,           /* values along an axis: a gradient is their difference */
    ROW = 16,                           /* SAMPLES, and room for whole vectors */
    INPUT = SAMPLES + 2 * FIELD_RADIUS, /* rows and planes of voxels that a block is made of */
    DEEP = 4096,                        /* the value deep inside */
};

/* Eight samples, added at once where the machine can. */
typedef int16_t lanes __attribute__((vector_size(16)));

struct row {
    lanes half[2]; /* values along x */
};

/* [z][y]; place i of a block is sample i + 1. */
struct values {
    struct row row[SAMPLES][SAMPLES];
};

/* The shown voxels that a block is made of, [z][y], bit 0 the first of a row; sample i is voxel i +
 * FIELD_RADIUS. Some more, so that four rows may be read at once. */
struct patterns {
    uint32_t row[INPUT + 1][INPUT];
};

static inline lanes lanes_at(const int16_t *at)
{
    lanes v;
    memcpy(&v, at, sizeof v);
    return v;
}

enum {
    SLOTS_LEAST = 256,         /* 1.9 MB of blocks, */
    SLOTS_MOST = 4096,         /* 30 MB, */
    LAYERS_TIMES = 4,          /* and so many times that where objects are translucent, */
    VOXELS_A_SLOT = 1625,      /* and at most five bytes for each voxel of the scene */
    WAYS = 4,                  /* slots that may hold a block */
    BEFORE = 2 + FIELD_RADIUS, /* the first of them lies so many before the block */
    PART_BITS = 6,             /* voxels of a row that are looked up at once */
    PARTS = (INPUT + PART_BITS - 1) / PART_BITS,
    SCENE_BITS = 12,
};

struct field_slot {
    uint64_t key;     /* of the block; 0 where none is made */
    uint32_t version; /* of the border, for which it is known to be right */
    uint32_t asked;   /* when it was asked for last */
};

/* What each pattern of a part of a row adds to the row smoothed along x. */
struct field_tables {
    struct row of[PARTS][1 << PART_BITS];
};

/* The tent along x: 1 2 3 4 3 2 1. */
static void fill_tables(struct field_tables *tables)
{
    for (int part = 0; part < PARTS; part++)
        for (unsigned bits = 0; bits < 1 << PART_BITS; bits++) {
            int16_t sum[ROW] = {0};
            for (int j = 0; j < PART_BITS; j++)
                for (int x = 0; x < SAMPLES && bits >> j & 1; x++) {
                    int apart = abs(part * PART_BITS + j - FIELD_RADIUS - x);
                    sum[x] = (int16_t)(sum[x] + (apart <= FIELD_RADIUS ? 4 - apart : 0));
                }
            memcpy(&tables->of[part][bits], sum, sizeof sum);
        }
}

static uint32_t blocks_along(const struct grid *grid, int a)
{
    return grid->size[a] / FIELD_BLOCK + 1;
}

/* No more slots than there are blocks. Pixels of several layers need blocks of several labels. */
static uint32_t slots_for(const struct border *border, unsigned threads)
{
    const struct grid *grid = &border->scene->grid;
    const unsigned times = border_is_translucent(border) ? LAYERS_TIMES : 1;
    uint64_t blocks = times, most = times * (grid->voxels / VOXELS_A_SLOT) / threads;
    uint32_t slots = WAYS;
    for (int a = 0; a < 3; a++)
        blocks *= blocks_along(grid, a);
    const uint64_t limit = (uint64_t)times * SLOTS_MOST;
    most = most < SLOTS_LEAST ? SLOTS_LEAST : most > limit ? limit : most;
    while (slots < blocks && 2 * slots <= most)
        slots *= 2;
    return slots;
}

enum err field_init(struct field *field, const struct border *border, enum field_kind kind,
                    unsigned threads, struct fault *fault)
{
    *field = (struct field){.border = border, .kind = kind};
    field->slots = slots_for(border, threads);
    field->block = mem_array(field->slots, sizeof *field->block);
    field->slot = mem_new(field->slots * sizeof *field->slot);
    field->tables = aligned_alloc(sizeof(struct row), sizeof *field->tables);
    if (!field->block || !field->slot || !field->tables) {
        field_release(field);
        return fault_memory(fault, "shading");
    }
    fill_tables(field->tables);
    if (kind == FIELD_SCENE) { /* the largest intensity has SCENE_BITS */
        const struct scene *scene = border->scene;
        struct task task = task_begin(scene->watch, "intensities", scene->grid.cells);
        unsigned all = 1;
        for (size_t c = 0; c < scene->grid.cells && task_advance(&task, 1); c++)
            all |= scene->cell[c].intensity;
        field->brighter = SCENE_BITS - (32 - __builtin_clz(all));
    }
    const enum err err = watch_fault(border->scene->watch, fault);
    if (err)
        field_release(field);
    return err;
}

bool field_fits(const struct field *field, const struct border *border, unsigned threads)
{
    return field->border == border && field->slots == slots_for(border, threads);
}

void field_release(struct field *field)
{
    free(field->block);
    free(field->slot);
    free(field->tables);
    *field = (struct field){0};
}

size_t field_bytes(const struct field *field)
{
    return field->slots * (sizeof *field->block + sizeof *field->slot) +
           (field->tables ? sizeof *field->tables : 0);
}

/* ---- what a block is made of ---- */

/* The voxels that a block is made of, and which of them lie in the scene: bit i of inside[a] is
 * for plane i along axis a. */
struct input {
    int64_t first[3];
    unsigned inside[3];
    uint8_t label; /* of the voxels to be taken; 0 for all that are shown */
};

static struct input input_of(const struct grid *grid, const uint32_t number[3], uint8_t label)
{
    struct input input = {{0}, {0}, label};
    for (int a = 0; a < 3; a++) {
        input.first[a] = (int64_t)number[a] * FIELD_BLOCK - BEFORE;
        for (int i = 0; i < INPUT; i++) {
            const int64_t at = input.first[a] + i;
            input.inside[a] |= (unsigned)(at >= 0 && at < grid->size[a]) << i;
        }
    }
    return input;
}

/* The cell of the first voxel of row (y, z) of the input; that voxel may lie outside the row, but
 * never before the array or after it, because of the rim. */
static size_t row_cell(const struct grid *grid, const struct input *input, int y, int z)
{
    return (size_t)(1 + input->first[0] + (1 + input->first[1] + y) * grid->step[1] +
                    (1 + input->first[2] + z) * grid->step[2]);
}

static bool has_row(const struct input *input, int y, int z)
{
    return input->inside[1] >> y & input->inside[2] >> z & 1;
}

/* Whether no word that the block was made of has changed since `version`. */
static bool is_still_right(const struct border *border, const struct input *input, uint32_t version)
{
    if (input->label && version < border->unnoted)
        return false;
    for (int z = 0; z < INPUT; z++)
        for (int y = 0; y < INPUT; y++) {
            if (!has_row(input, y, z))
                continue;
            const size_t cell = row_cell(&border->scene->grid, input, y, z);
            if (border->changed[cell >> 6] > version ||
                border->changed[(cell + INPUT - 1) >> 6] > version)
                return false;
        }
    return true;
}

/* ---- smoothing ---- */

static inline void add_row(struct row *to, const struct row *from)
{
    to->half[0] += from->half[0];
    to->half[1] += from->half[1];
}

/* The tent over `count` rows, `step` apart, in place; there are 2 * FIELD_RADIUS fewer after it.
 * It is four sums of two, 1, 2, 1 and 2 rows apart. */
static void smooth_rows(struct row *row, int count, int step)
{
    static const int apart[4] = {1, 2, 1, 2};
    for (int pass = 0; pass < 4; pass++) {
        count -= apart[pass];
        for (int i = 0; i < count; i++)
            add_row(row + i * step, row + (i + apart[pass]) * step);
    }
}

/* Those of some voxels of a row, bit 0 the first, that have a label: runs of them have the same
 * between two seams, which are known of what is not cut away. */
static unsigned labelled_bits(const struct field *field, size_t cell, unsigned bits, uint8_t label)
{
    const struct seams *seams = field->seams;
    const uint64_t after = border_bits_from(seams->between[0], seams->words, (ptrdiff_t)cell);
    const bool has_seams = field->kind == FIELD_SHOWN || cut_is_none(&field->border->cut);
    const unsigned begins = has_seams ? bits & (~(bits << 1) | (unsigned)after << 1) : bits;
    unsigned found = 0;
    for (unsigned left = begins; left; left &= left - 1) {
        const unsigned first = left & -left, next = left & (left - 1);
        const unsigned to_next = (next & -next) - first; /* all from the first on, where it is 0 */
        const uint32_t at = (uint32_t)cell + (uint32_t)__builtin_ctz(first);
        if (seams_label(seams, at) == label)
            found |= bits & to_next;
    }
    return found;
}

static void find_patterns(struct patterns *patterns, const struct field *field,
                          const struct input *input)
{
    const struct border *border = field->border;
    const uint64_t *set = field->kind == FIELD_SHOWN ? border->shown : border->whole;
    memset(patterns, 0, sizeof *patterns);
    for (int z = 0; z < INPUT; z++)
        for (int y = 0; y < INPUT; y++) {
            if (!has_row(input, y, z))
                continue;
            const size_t cell = row_cell(&border->scene->grid, input, y, z);
            const unsigned bits = (unsigned)border_bits_at(set, cell) & input->inside[0];
            patterns->row[z][y] =
                input->label ? labelled_bits(field, cell, bits, input->label) : bits;
        }
}

/* ---- the scene, smoothed by 1 4 6 4 1 along each axis ---- */

enum { SCENE_RADIUS = 2, SCENE_INPUT = SAMPLES + 2 * SCENE_RADIUS };

/* The voxels along each axis that a block is made of. Outside the scene they are those of its edge,
 * so that the edge is no surface. */
struct scene_input {
    uint32_t at[3][SCENE_INPUT];
};

/* Over rows, in place: sums of two, two of them at a time so that 12 bits stay within 16. */
static void smooth_scene_rows(struct row *row, int count, int step)
{
    for (int pass = 0; pass < 2 * SCENE_RADIUS; pass++) {
        count--;
        for (int i = 0; i < count; i++) {
            add_row(row + i * step, row + (i + 1) * step);
            row[i * step].half[0] >>= 2 * (pass % 2);
            row[i * step].half[1] >>= 2 * (pass % 2);
        }
    }
}

static void smooth_scene(struct values *values, const struct field *field,
                         const struct input *input)
{
    struct scene_input in;
    for (int a = 0; a < 3; a++)
        for (int i = 0; i < SCENE_INPUT; i++) {
            const int64_t p = input->first[a] + FIELD_RADIUS - SCENE_RADIUS + i;
            const int64_t last = (int64_t)field->border->scene->grid.size[a] - 1;
            in.at[a][i] = (uint32_t)(p < 0 ? 0 : p > last ? last : p);
        }
    struct row plane[SCENE_INPUT][SCENE_INPUT];
    for (int z = 0; z < SCENE_INPUT; z++) {
        for (int y = 0; y < SCENE_INPUT; y++) {
            /* A row of intensities of 12 bits, smoothed along x. */
            const struct scene *scene = field->border->scene;
            const int left = field->brighter > 0 ? field->brighter : 0;
            const int right = field->brighter < 0 ? -field->brighter : 0;
            int value[SCENE_INPUT];
            int16_t smooth[ROW] = {0};
            for (int x = 0; x < SCENE_INPUT; x++) {
                const uint32_t cell =
                    grid_cell(&scene->grid, in.at[0][x], in.at[1][y], in.at[2][z]);
                value[x] = scene->cell[cell].intensity << left >> right;
            }
            for (int x = 0; x < SAMPLES; x++) {
                const int *v = value + x;
                smooth[x] = (int16_t)((v[0] + 4 * v[1] + 6 * v[2] + 4 * v[3] + v[4]) >> 4);
            }
            memcpy(&plane[z][y], smooth, sizeof smooth);
        }
        smooth_scene_rows(plane[z], SCENE_INPUT, 1);
    }
    for (int y = 0; y < SAMPLES; y++)
        smooth_scene_rows(&plane[0][y], SCENE_INPUT, SCENE_INPUT);
    for (int z = 0; z < SAMPLES; z++)
        memcpy(values->row[z], plane[z], sizeof values->row[z]);
}

/* ---- gradients ---- */

/* Eight gradients out of their parts, side by side. */
static inline void put_gradients(struct gradient *out, lanes x, lanes y, lanes z)
{
    const lanes none = {0};
    const lanes xy[2] = {__builtin_shufflevector(x, y, 0, 8, 1, 9, 2, 10, 3, 11),
                         __builtin_shufflevector(x, y, 4, 12, 5, 13, 6, 14, 7, 15)};
    const lanes zn[2] = {__builtin_shufflevector(z, none, 0, 8, 1, 9, 2, 10, 3, 11),
                         __builtin_shufflevector(z, none, 4, 12, 5, 13, 6, 14, 7, 15)};
    for (int i = 0; i < 2; i++) {
        const lanes first = __builtin_shufflevector(xy[i], zn[i], 0, 1, 8, 9, 2, 3, 10, 11);
        const lanes last = __builtin_shufflevector(xy[i], zn[i], 4, 5, 12, 13, 6, 7, 14, 15);
        memcpy(out + 4 * i, &first, sizeof first);
        memcpy(out + 4 * i + 2, &last, sizeof last);
    }
}

/* Differences over two voxels, times 2^shift: such that those of two places differ by less than
 * 2^14. A tent over a step gives 7/16 of it at most. */
static void fill_gradients(struct field_block *block, const struct values *values, int shift)
{
    enum { Y = ROW, Z = SAMPLES * ROW };
    int16_t value[SAMPLES * SAMPLES * ROW];
    memcpy(value, values->row, sizeof value);
    for (int z = 0; z < FIELD_SIDE; z++)
        for (int y = 0; y < FIELD_SIDE; y++) {
            const int16_t *v = value + (z + 1) * Z + (y + 1) * Y + 1;
            put_gradients(block->at[z][y], (lanes_at(v + 1) - lanes_at(v - 1)) << shift,
                          (lanes_at(v + Y) - lanes_at(v - Y)) << shift,
                          (lanes_at(v + Z) - lanes_at(v - Z)) << shift);
            v += FIELD_BLOCK;
            int16_t *last = block->at[z][y][FIELD_BLOCK].along;
            last[0] = (int16_t)((v[1] - v[-1]) * (1 << shift));
            last[1] = (int16_t)((v[Y] - v[-Y]) * (1 << shift));
            last[2] = (int16_t)((v[Z] - v[-Z]) * (1 << shift));
            last[3] = 0;
        }
}

/* ---- how far inside ---- */

/* How far inside a place is: its value less the level there, above 0 for inside.
 *
 * The level is half, where the smoothed border of anything thick lies. What is thin never gets
 * that far, and would vanish: so where no value around is well above half, the level is 7/8 of the
 * greatest, at which a sheet of any thickness has its faces; and what is thin beside something
 * thick asks for 7/8 of its own value around it. Gaps are the same, with inside and outside
 * exchanged. Where the level is not half, shown voxels are inside and all others outside, by a
 * little at least, so that neither holes nor bridges come of it. */

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

static void find_inside(struct field_block *block, const struct values *values,
                        const struct patterns *patterns)
{
    enum { FIRST = FIELD_RADIUS + 1 }; /* the voxel of place 0 */
    struct levels levels;
    const lanes half = (lanes){0} + HALF;
    struct thin thin;
    memcpy(levels.least.at, values->row, PLACES * sizeof *levels.least.at);
    memcpy(levels.most.at, values->row, PLACES * sizeof *levels.most.at);
    spread(&levels.least, lesser);
    spread(&levels.most, greater);
    thin.has_shown = thin.has_gaps = false;
    for (int z = 0; z < SAMPLES; z++)
        for (int y = 0; y < SAMPLES; y += 4)
            find_thin_rows(&thin, patterns, y, z);
    levels.inside.is_any = thin.has_shown;
    levels.outside.is_any = thin.has_gaps;
    if (thin.has_shown)
        ask(&levels.inside, values, thin.shown, below, lesser, half);
    if (thin.has_gaps)
        ask(&levels.outside, values, thin.gaps, above, greater, half);
    for (int z = 0; z < FIELD_SIDE; z++)
        for (int y = 0; y < FIELD_SIDE; y++) {
            const uint32_t shown = patterns->row[z + FIRST][y + FIRST] >> FIRST;
            int16_t value[ROW + 8] = {0}, row[ROW];
            memcpy(value, &values->row[z + 1][y + 1], ROW * sizeof *value);
            for (int x = 0; x < ROW; x += 8)
                put(row + x, (lanes)(FIELD_INSIDE_UNIT *
                                     (wraps)inside_of(&levels, (z * SAMPLES + y) * ROW + x,
                                                      lanes_at(value + x + 1), shown >> x)));
            memcpy(block->inside[z][y], row, sizeof block->inside[z][y]);
        }
}

/* ---- blocks ---- */

static void make_block(struct field_block *block, const struct field *field,
                       const struct input *input)
{
    struct values values;
    struct patterns patterns;
    if (field->kind == FIELD_SCENE) {
        smooth_scene(&values, field, input);
        fill_gradients(block, &values, 1);
        return;
    }
    find_patterns(&patterns, field, input);
    struct row plane[INPUT][SAMPLES];
    for (int z = 0; z < INPUT; z++) {
        /* One plane of the input, smoothed along x and y. */
        const unsigned part = (1 << PART_BITS) - 1;
        struct row row[INPUT];
        for (int y = 0; y < INPUT; y++) {
            const unsigned bits = patterns.row[z][y];
            row[y] = field->tables->of[0][bits & part];
            add_row(&row[y], &field->tables->of[1][bits >> PART_BITS & part]);
            add_row(&row[y], &field->tables->of[2][bits >> (2 * PART_BITS)]);
        }
        smooth_rows(row, INPUT, 1);
        memcpy(plane[z], row, SAMPLES * sizeof *plane[z]);
    }
    for (int y = 0; y < SAMPLES; y++)
        smooth_rows(&plane[0][y], INPUT, SAMPLES);
    memcpy(values.row, plane, sizeof values.row);
    fill_gradients(block, &values, 2);
    if (field->kind == FIELD_SURFACES || (field->kind == FIELD_SURFACE && !input->label))
        find_inside(block, &values, &patterns);
}

/* A block's number, and whose it is. */
static uint64_t key_of(const struct field *field, const uint32_t number[3], uint8_t label)
{
    const struct grid *grid = &field->border->scene->grid;
    const uint32_t row = number[1] + number[2] * blocks_along(grid, 1);
    return ((uint64_t)label << 32 | (number[0] + row * blocks_along(grid, 0))) + 1;
}

/* The first of the slots that may hold it. Blocks of a surface, and of several labels, have numbers
 * at regular distances: the product spreads them. */
static uint32_t set_of(const struct field *field, uint64_t key)
{
    const uint64_t mixed = key * UINT64_C(0x9e3779b97f4a7c15);
    return (uint32_t)(mixed >> 40) & (field->slots - 1) & ~(uint32_t)(WAYS - 1);
}

/* Where a block is, or is to be made: of the slots that may hold it, that of the one which was
 * asked for longest ago. */
static struct field_slot *slot_for(struct field *field, uint64_t key)
{
    struct field_slot *set = field->slot + set_of(field, key), *oldest = set;
    for (int i = 0; i < WAYS; i++) {
        if (set[i].key == key)
            return set + i;
        oldest = field->asked - set[i].asked > field->asked - oldest->asked ? set + i : oldest;
    }
    return oldest;
}

void field_fetch(const struct field_reader *reader, const int32_t point[3])
{
    const struct field *field = reader->field;
    uint32_t number[3], first[3];
    int32_t part[3];
    for (int a = 0; a < 3; a++)
        number[a] = field_along(point[a], &first[a], &part[a]);
    const uint64_t key = key_of(field, number, reader->label);
    const uint32_t set = set_of(field, key);
    for (uint32_t i = set; i < set + WAYS; i++) {
        const struct field_block *block = field->block + i;
        for (uint32_t z = first[2]; z < first[2] + 2 && field->slot[i].key == key; z++) {
            __builtin_prefetch(&block->inside[z][first[1]][first[0]]);
            __builtin_prefetch(&block->at[z][first[1]][first[0]]);
            __builtin_prefetch(&block->at[z][first[1] + 1][first[0]]);
        }
    }
}

const struct field_block *field_block(struct field *field, const uint32_t number[3], uint8_t label)
{
    const struct border *border = field->border;
    const uint64_t key = key_of(field, number, label);
    struct field_slot *slot = slot_for(field, key);
    struct field_block *block = field->block + (slot - field->slot);
    const bool is_here = slot->key == key;
    slot->asked = field->asked++;
    if (is_here && (slot->version == border->version || field->kind == FIELD_SCENE))
        return block;
    const struct input input = input_of(&border->scene->grid, number, label);
    if (!is_here || !is_still_right(border, &input, slot->version))
        make_block(block, field, &input);
    slot->key = key;
    slot->version = border->version;
    return block;
}
