#include "image/intensities.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/outliers.h"
#include "image/voxels.h"

enum { PIECE = 1 << 16 /* values between two looks at the watch */ };
static const double DOUBLE_EXACT = 9007199254740992; /* whole numbers up to here */

/* ---- byte order ---- */

static void swap_16(uint16_t *value, size_t count)
{
    for (size_t i = 0; i < count; i++)
        value[i] = (uint16_t)(value[i] << 8 | value[i] >> 8);
}

static void swap_32(uint32_t *value, size_t count)
{
    for (size_t i = 0; i < count; i++)
        value[i] = __builtin_bswap32(value[i]);
}

static void swap_64(uint64_t *value, size_t count)
{
    for (size_t i = 0; i < count; i++)
        value[i] = __builtin_bswap64(value[i]);
}

void intensities_reorder(void *value, size_t count, enum voxel_type type, bool big_endian)
{
    if (big_endian == (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__))
        return;
    if (voxel_bytes(type) == 2)
        swap_16(value, count);
    if (voxel_bytes(type) == 4)
        swap_32(value, count);
    if (voxel_bytes(type) == 8)
        swap_64(value, count);
}

/* ---- 8 and 16 bits ---- */

/* Spreads `count` bytes from the upper half of an array over the whole of it. Piecewise through a
 * small buffer: the compiler cannot see that reading stays ahead of writing. */
static void widen_bytes(uint16_t *value, size_t count, bool is_signed, struct task *task)
{
    const uint8_t *from = (const uint8_t *)value + count;
    uint8_t piece[4096];
    for (size_t done = 0; done < count;) {
        size_t n = count - done < sizeof piece ? count - done : sizeof piece;
        memcpy(piece, from + done, n);
        if (is_signed)
            for (size_t i = 0; i < n; i++)
                value[done + i] = (uint16_t)(int16_t)(int8_t)piece[i];
        else
            for (size_t i = 0; i < n; i++)
                value[done + i] = piece[i];
        done += n;
        if (!task_advance(task, n))
            return;
    }
}

/* Lane by lane, in which the compiler sees vectors. */
static int least_signed(const uint16_t *value, size_t count)
{
    enum { LANES = 32 };
    int16_t low[LANES] = {0};
    int least = 0;
    size_t i = 0;
    for (; i + LANES <= count; i += LANES)
        for (size_t k = 0; k < LANES; k++) {
            const int16_t v = (int16_t)value[i + k];
            low[k] = v < low[k] ? v : low[k];
        }
    for (; i < count; i++)
        least = (int16_t)value[i] < least ? (int16_t)value[i] : least;
    for (size_t k = 0; k < LANES; k++)
        least = low[k] < least ? low[k] : least;
    return least;
}

/* Signed to unsigned by the least value, where that is below 0; returns what was added to every
 * voxel's value. */
static int shift_signed(uint16_t *value, size_t count, struct task *task)
{
    int least = 0;
    for (size_t i = 0, n; i < count && task_advance(task, PIECE); i += n) {
        n = count - i < PIECE ? count - i : PIECE;
        const int low = least_signed(value + i, n);
        least = low < least ? low : least;
    }
    for (size_t i = 0, end; least < 0 && i < count && task_advance(task, PIECE); i = end)
        for (end = i + PIECE < count ? i + PIECE : count; i < end; i++)
            value[i] = (uint16_t)((int16_t)value[i] - least);
    return least;
}

/* ---- 32 and 64 bits ---- */

/* Number of the file = factor * intensity + least. */
struct way_back {
    double factor, least;
};

/* What is turned into intensities in its place: a voxel's two bytes never lie after its four or
 * eight. */
struct fitting {
    struct volume *volume;
    const uint8_t *from;
    size_t count;
    enum voxel_type type;
    struct task *task;
    struct fault *fault;
    struct levels *levels; /* the volume's; in numbers of the file until they are made real */
};

static inline void note_level(struct levels *levels, uint16_t is, double number)
{
    struct level *level = &levels->level[is];
    level->least = number < level->least ? number : level->least;
    level->greatest = number > level->greatest ? number : level->greatest;
}

static enum err want_levels(struct fitting *f)
{
    if (f->volume->choice.by_extremes)
        return OK;
    f->levels = f->volume->levels = mem_new(sizeof *f->levels);
    if (!f->levels)
        return fault_memory(f->fault, "the scale of the scene");
    for (size_t i = 0; i < LEVELS; i++)
        f->levels->level[i] = (struct level){INFINITY, -INFINITY};
    return OK;
}

/* Whether the scale is cut, to a core then. */
static enum err find_outliers(bool *is_clamped, uint64_t core[2], const struct fitting *f,
                              const struct numbers *numbers)
{
    *is_clamped = false;
    if (f->volume->choice.by_extremes)
        return OK;
    uint64_t *room = mem_array(OUTLIERS_ROOM, sizeof *room);
    if (!room)
        return fault_memory(f->fault, "the scale of the scene");
    *is_clamped = outliers_find(core, numbers, room, f->task->watch);
    free(room);
    return OK;
}

/* ---- wide whole numbers ---- */

static struct numbers find_whole(const struct fitting *f)
{
    const unsigned width = voxel_bytes(f->type);
    struct numbers out = {f->from, f->count, f->type, 0, UINT64_MAX, 0};
    for (size_t i = 0, end; i < f->count && task_advance(f->task, PIECE); i = end)
        for (end = i + PIECE < f->count ? i + PIECE : f->count; i < end; i++) {
            const uint64_t order = order_at(f->from + width * i, f->type);
            out.least = order < out.least ? order : out.least;
            out.greatest = order > out.greatest ? order : out.greatest;
        }
    return out;
}

/* Level `first` and those after it are the numbers from `least` to `greatest`, so many each. */
struct steps {
    uint64_t least, greatest, step;
    uint16_t first;
};

static struct steps steps_between(const struct numbers *n)
{
    struct steps s = {n->least, n->greatest, 1, 0};
    const uint64_t zero = order_zero(n->type);
    if (s.least >= zero && s.greatest - zero <= UINT16_MAX)
        s.least = zero;
    if (s.greatest - s.least > UINT16_MAX)
        s.step = (s.greatest - s.least - 1) / UINT16_MAX + 1;
    return s;
}

static struct steps steps_around(const uint64_t core[2], const struct numbers *n)
{
    static const uint64_t most = LEVELS - 3; /* from the first level within to the last */
    const uint64_t wide = core[1] - core[0];
    struct steps s = {n->least, n->greatest, wide <= most ? 1 : (wide - 1) / most + 1, 1};
    const uint64_t left = (most * s.step - wide) / 2, margin = wide < left ? wide : left;
    if (core[0] - n->least > margin)
        s.least = core[0] - margin;
    if (n->greatest - core[1] > margin)
        s.greatest = core[1] + margin;
    return s;
}

static void divide(const struct fitting *f, const struct steps *s)
{
    const unsigned width = voxel_bytes(f->type);
    const uint64_t step = s->step;
    for (size_t i = 0, end; i < f->count && task_advance(f->task, PIECE); i = end)
        for (end = i + PIECE < f->count ? i + PIECE : f->count; i < end; i++) {
            const uint64_t order = order_at(f->from + width * i, f->type);
            const uint64_t above = order - s->least;
            uint16_t is =
                (uint16_t)(step == 1 ? above : above / step + (above % step >= step - step / 2));
            if (f->levels) {
                const bool is_below = order<s->least, is_above = order> s->greatest;
                is = is_below ? 0 : is_above ? LEVELS - 1 : (uint16_t)(is + s->first);
                f->levels->beyond[0] += is_below;
                f->levels->beyond[1] += is_above;
                note_level(f->levels, is, order_number(order, f->type));
            }
            f->volume->intensity[i] = is;
        }
}

static enum err fit_whole(struct way_back *back, struct fitting *f)
{
    const struct numbers numbers = find_whole(f);
    struct steps steps = steps_between(&numbers);
    bool is_clamped = false;
    uint64_t core[2];
    enum err err = OK;
    if (steps.step > 1) {
        err = find_outliers(&is_clamped, core, f, &numbers);
        if (!err && is_clamped)
            steps = steps_around(core, &numbers);
        if (!err)
            err = want_levels(f);
    }
    if (err)
        return err;
    const double least = order_number(steps.least, f->type);
    const double greatest = order_number(steps.greatest, f->type);
    const double most = fmax(fabs(least), fabs(greatest));
    if (f->levels) {
        f->levels->is_clamped = is_clamped;
        f->levels->ends[0] = least;
        f->levels->ends[1] = greatest;
    }
    divide(f, &steps);
    f->volume->is_coarse = steps.step > 1 || is_clamped;
    if (steps.step > 1)
        volume_note(f->volume->notes,
                    "its values are %.17g to %.17g, more than a scene tells apart: %" PRIu64
                    " of them are one intensity",
                    least, greatest, steps.step);
    if (!f->volume->choice.by_extremes && most > DOUBLE_EXACT)
        volume_note(f->volume->notes,
                    "its values are beyond 2^53: they are known as double precision holds them, "
                    "to %g",
                    nextafter(most, INFINITY) - most);
    *back = (struct way_back){(double)steps.step, least - (double)steps.first * (double)steps.step};
    return OK;
}

/* ---- floating point ---- */

struct extent {
    double low, high;
    size_t odd; /* voxels that are no number, or infinite */
};

static inline struct extent find_extent(const uint8_t *from, size_t count, bool is_double,
                                        struct task *task)
{
    struct extent extent = {INFINITY, -INFINITY, 0};
    for (size_t i = 0, end; i < count && task_advance(task, PIECE); i = end)
        for (end = i + PIECE < count ? i + PIECE : count; i < end; i++) {
            const double value = real_at(from + (is_double ? 8 : 4) * i, is_double);
            const bool is_odd = !isfinite(value);
            extent.odd += is_odd;
            extent.low = !is_odd && value < extent.low ? value : extent.low;
            extent.high = !is_odd && value > extent.high ? value : extent.high;
        }
    if (extent.odd == count)
        extent.low = extent.high = 0;
    if (extent.odd && extent.low > 0)
        extent.low = 0;
    return extent;
}

/* Which most scenes show among the first voxels that they are not. */
static inline bool are_whole(const struct fitting *f, bool is_double, bool is_small)
{
    for (size_t i = 0, end; i < f->count; i = end) {
        bool all = true;
        for (end = i + PIECE < f->count ? i + PIECE : f->count; i < end; i++) {
            const double value = real_at(f->from + (is_double ? 8 : 4) * i, is_double);
            const double real = isfinite(value) ? value : 0;
            all &= real == (is_small ? (double)(int32_t)real : rint(real));
        }
        if (!all)
            return false;
    }
    return true;
}

static bool is_exact(const struct fitting *f, const struct extent *extent)
{
    const bool is_small = extent->low > INT32_MIN && extent->high < INT32_MAX;
    if (extent->high - extent->low > UINT16_MAX)
        return false;
    if (f->type == VOXEL_FLOAT64)
        return is_small ? are_whole(f, true, true) : are_whole(f, true, false);
    return is_small ? are_whole(f, false, true) : are_whole(f, false, false);
}

/* Levels first .. first + range are the numbers from low to high. */
struct line {
    double low, high;
    uint16_t first, range;
};

/* Of a piece that the cache holds. Halves keep the range of the widest doubles finite. */
static inline void find_levels(uint16_t *is, const uint8_t *from, size_t count,
                               const struct line *line, bool is_double)
{
    const double half = isfinite(line->high - line->low) ? 1 : 0.5;
    const double base = line->low * half, range = line->high * half - base;
    const double first = line->first + 0.5, levels = line->range;
    for (size_t i = 0; i < count; i++) {
        const double value = real_at(from + (is_double ? 8 : 4) * i, is_double);
        const double part = range > 0 && isfinite(value) ? (value * half - base) / range : 0;
        const double level = part < 0 ? 0 : part > 1 ? LEVELS - 1 : part * levels + first;
        is[i] = (uint16_t)(isfinite(value) ? level : 0);
    }
}

/* Neighbours often have the same number. */
static inline void note_piece(struct levels *levels, const uint16_t *is, const uint8_t *from,
                              size_t count, bool is_double)
{
    double before = NAN;
    for (size_t i = 0; i < count; i++) {
        const double value = real_at(from + (is_double ? 8 : 4) * i, is_double);
        if (value != before && isfinite(value))
            note_level(levels, is[i], value);
        before = value;
    }
    for (size_t i = 0; levels->is_clamped && i < count; i++) {
        levels->beyond[0] +=
            is[i] == 0 && isfinite(real_at(from + (is_double ? 8 : 4) * i, is_double));
        levels->beyond[1] += is[i] == LEVELS - 1;
    }
}

static inline void spread(const struct fitting *f, const struct line *line, bool is_double)
{
    enum { SMALL = 4096 };
    uint16_t is[SMALL];
    for (size_t done = 0, n; done < f->count && task_advance(f->task, SMALL); done += n) {
        const uint8_t *from = f->from + (is_double ? 8 : 4) * done;
        n = f->count - done < SMALL ? f->count - done : SMALL;
        find_levels(is, from, n, line, is_double);
        if (f->levels)
            note_piece(f->levels, is, from, n, is_double);
        memcpy(f->volume->intensity + done, is, n * sizeof *is);
    }
}

/* Whole numbers that fit have a level each; else the line may be cut. */
static enum err find_line(struct line *line, const struct extent *extent, struct fitting *f)
{
    const struct numbers numbers = {f->from,
                                    f->count,
                                    f->type,
                                    extent->odd,
                                    order_of_real(extent->low, f->type),
                                    order_of_real(extent->high, f->type)};
    const double range = extent->high - extent->low;
    uint64_t core[2];
    bool is_clamped;
    *line = (struct line){extent->low, extent->high, 0, LEVELS - 1};
    if (f->volume->choice.by_extremes && !f->volume->choice.whole_are_exact)
        return OK;
    if (is_exact(f, extent)) {
        line->low = extent->low >= 0 && extent->high <= UINT16_MAX ? 0 : extent->low;
        line->high = line->low + UINT16_MAX;
        return OK;
    }
    if (range == 0 || f->volume->choice.by_extremes)
        return OK;
    enum err err = find_outliers(&is_clamped, core, f, &numbers);
    if (!err)
        err = want_levels(f);
    if (!err && is_clamped) {
        const double low = order_number(core[0], f->type), high = order_number(core[1], f->type);
        *line = (struct line){fmax(extent->low, low - (high - low)),
                              fmin(extent->high, high + (high - low)), 1, LEVELS - 3};
    }
    if (!err) {
        f->levels->is_clamped = is_clamped;
        f->levels->ends[0] = line->low;
        f->levels->ends[1] = line->high;
    }
    return err;
}

static enum err fit_reals(struct way_back *back, struct fitting *f)
{
    const bool is_double = f->type == VOXEL_FLOAT64;
    const struct extent extent = is_double ? find_extent(f->from, f->count, true, f->task)
                                           : find_extent(f->from, f->count, false, f->task);
    struct line line;
    const enum err err = find_line(&line, &extent, f);
    if (err)
        return err;
    if (is_double)
        spread(f, &line, true);
    else
        spread(f, &line, false);
    if (extent.odd && line.first) /* below every number, and in no range */
        f->levels->level[0].least = -INFINITY;
    if (extent.odd)
        volume_note(f->volume->notes, "%zu voxel%s no number or infinite: taken for %s%g",
                    extent.odd, extent.odd == 1 ? " is" : "s are", line.first ? "less than " : "",
                    line.first ? line.low : extent.low);
    const double levels = line.range, range = line.high - line.low;
    const double factor = isfinite(range) ? range / levels : line.high / levels - line.low / levels;
    *back = (struct way_back){range > 0 ? factor : 1, line.low};
    back->least -= line.first * back->factor;
    return OK;
}

/* ---- levels ---- */

static void swap_reals(double *a, double *b)
{
    const double was = *a;
    *a = *b;
    *b = was;
}

/* Numbers of the file as real values, which rise where those fall. */
static void make_real(struct levels *levels, const struct geometry *of_file)
{
    for (size_t i = 0; i < LEVELS; i++) {
        struct level *level = &levels->level[i];
        if (level->least > level->greatest)
            continue;
        level->least = geometry_value(of_file, level->least);
        level->greatest = geometry_value(of_file, level->greatest);
        if (of_file->slope < 0)
            swap_reals(&level->least, &level->greatest);
    }
    for (int i = 0; i < 2; i++)
        levels->ends[i] = geometry_value(of_file, levels->ends[i]);
    if (of_file->slope < 0) {
        const size_t below = levels->beyond[0];
        levels->beyond[0] = levels->beyond[1];
        levels->beyond[1] = below;
        swap_reals(&levels->ends[0], &levels->ends[1]);
    }
}

/* Fewer levels than a scene of bytes has, of which each stands for several numbers, are worth a
 * word. */
static void note_levels(struct volume *volume)
{
    enum { FEW = 256 };
    struct levels *levels = volume->levels;
    const struct level *last = &levels->level[LEVELS - 1];
    size_t taken = 0, of_several = 0;
    for (const struct level *level = levels->level; level <= last; level++) {
        taken += level->least <= level->greatest;
        of_several += level->least < level->greatest;
    }
    if (levels->is_clamped)
        volume_note(volume->notes,
                    "values far from all others: the scale is %g to %g, and what is beyond, %zu "
                    "voxel%s below and %zu above, counts as its end",
                    levels->ends[0], levels->ends[1], levels->beyond[0],
                    levels->beyond[0] == 1 ? "" : "s", levels->beyond[1]);
    else if (of_several && taken < FEW)
        volume_note(volume->notes,
                    "a few of its values lie far from the others, which differ by less than it "
                    "tells apart: %zu levels are taken, and one is %g; without those few in the "
                    "file the others have more",
                    taken, levels->step);
}

/* ---- all ---- */

enum err intensities_make(struct volume *volume, const struct volume_header *header,
                          struct watch *watch, struct fault *fault)
{
    const size_t count = (size_t)header->size[0] * header->size[1] * header->size[2];
    const enum voxel_type type = header->type;
    const unsigned width = voxel_bytes(type);
    struct task task = task_begin(watch, "intensities", 3 * (uint64_t)count);
    struct way_back back = {1, 0};
    uint8_t *at = (uint8_t *)volume->intensity;
    struct fitting fitting = {volume, at, count, type, &task, fault, NULL};
    enum err err = OK;
    for (size_t i = 0, n; i < count && task_advance(&task, PIECE); i += n) {
        n = count - i < PIECE ? count - i : PIECE;
        intensities_reorder(at + i * width, n, type, header->big_endian);
    }
    if (width == 1)
        widen_bytes(volume->intensity, count, type == VOXEL_INT8, &task);
    if (type == VOXEL_INT16 || type == VOXEL_INT8)
        back.least = shift_signed(volume->intensity, count, &task);
    else if (order_is_real(type))
        err = fit_reals(&back, &fitting);
    else if (width > 2)
        err = fit_whole(&back, &fitting);
    volume->geometry.intercept = header->geometry.slope * back.least + header->geometry.intercept;
    volume->geometry.slope = header->geometry.slope * back.factor;
    if (err || !volume->levels)
        return err;
    const bool is_scaled = header->geometry.slope != 1 || header->geometry.intercept != 0;
    volume->levels->is_single = type == VOXEL_FLOAT32 && !is_scaled;
    volume->levels->step = fabs(volume->geometry.slope);
    make_real(volume->levels, &header->geometry);
    note_levels(volume);
    return OK;
}
