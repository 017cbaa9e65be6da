/* SPDX-License-Identifier: MIT */
#include "image/image_inside.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/mem.h"
#include "base/sort.h"

enum { PIECE = 1 << 16 /* values between two polls of the watch */ };
enum { DIGIT = 16 /* bits */, OUTLIERS_ROOM = 1 << DIGIT /* a count of each */ };
static const double DOUBLE_EXACT = 9007199254740992; /* whole numbers up to here */

/* ---- orders ----
 *
 * The numbers of a file mapped to unsigned whole numbers of the same order, so that ranks (the
 * least, the thousandth) are computed without floating point. Equal numbers have equal orders; NaN
 * and infinite numbers have no order. */

/* Above every finite real number, but also the order of the greatest uint64. */
#define ORDER_NONE UINT64_MAX

static inline bool order_is_real(enum voxel_type type)
{
    return type == VOXEL_FLOAT32 || type == VOXEL_FLOAT64;
}

/* The order of 0. */
static inline uint64_t order_zero(enum voxel_type type)
{
    return type == VOXEL_UINT32 || type == VOXEL_UINT64 ? 0
           : type == VOXEL_FLOAT32                      ? UINT64_C(1) << 31
                                                        : UINT64_C(1) << 63;
}

static inline double real_at(const uint8_t *at, bool is_double)
{
    double wide;
    float narrow;
    if (is_double) {
        memcpy(&wide, at, sizeof wide);
        return wide;
    }
    memcpy(&narrow, at, sizeof narrow);
    return (double)narrow;
}

/* The order of a number of a real type. */
static inline uint64_t order_of_real(double value, enum voxel_type type)
{
    uint64_t bits;
    uint32_t few;
    if (!isfinite(value))
        return ORDER_NONE;
    if (type == VOXEL_FLOAT32) {
        const float narrow = (float)value + 0.0F; /* -0 is 0 */
        memcpy(&few, &narrow, sizeof few);
        return few >> 31 ? ~few : few | UINT32_C(1) << 31;
    }
    value += 0.0;
    memcpy(&bits, &value, sizeof bits);
    return bits >> 63 ? ~bits : bits | UINT64_C(1) << 63;
}

/* The order of the number at `at`, of 4 or 8 bytes. */
static inline uint64_t order_at(const uint8_t *at, enum voxel_type type)
{
    uint64_t wide;
    uint32_t narrow;
    if (order_is_real(type))
        return order_of_real(real_at(at, type == VOXEL_FLOAT64), type);
    if (type == VOXEL_INT64 || type == VOXEL_UINT64) {
        memcpy(&wide, at, sizeof wide);
        return wide ^ order_zero(type);
    }
    memcpy(&narrow, at, sizeof narrow);
    return type == VOXEL_INT32 ? (uint64_t)(int64_t)(int32_t)narrow ^ order_zero(type) : narrow;
}

/* The number of an order, rounded to double precision. */
static inline double order_number(uint64_t order, enum voxel_type type)
{
    const uint64_t zero = order_zero(type);
    if (!order_is_real(type))
        return order < zero ? -(double)(zero - order) : (double)(order - zero);
    return real_of_bits(order >= zero ? order ^ zero : ~order, voxel_bytes(type));
}

/* Numbers of 4 or 8 bytes, in the order of this machine. */
struct numbers {
    const uint8_t *at;
    size_t count;
    enum voxel_type type;
    size_t odd;               /* count of numbers without an order */
    uint64_t least, greatest; /* orders of the ends of their range; if some are odd, which count as
                                 0, `least` is at most the order of 0 */
};

/* ---- outliers ----
 *
 * Decide whether a few numbers, far from all others, use up the levels that the others need.
 *
 * A pure function of the frequencies of the numbers: ranks and comparisons of differences, no sums,
 * so that neither the order of voxels nor the machine matters.
 *
 * T(k) is the range that remains after removing the least and the greatest number, however frequent
 * they are (fill values, say), and k more voxels at each end; n is the number of voxels that are
 * numbers.
 *
 *     k = 8, or n / 2^20 if that is more, or n / 128 if that is less than 8
 *     the core is the range of T(k), which must be above 0, and at most half of the whole range
 *     k and the core become those of 8 k, as long as that is at most n / 128, and T(8 k) is above
 *     0, at most a half and at least a 32nd of T(k): a tail that thins out, as quotients have
 *     outliers use up the levels if T(k) is finally less than a 16th of the whole range: 4096
 *     levels, as CT has, would remain
 *
 * So very few voxels are removed, or a tail without a clear end. A bright object remains within the
 * scale, whatever is around it: beyond its own values T drops at once, which is not a tail. */

/* Parameters of the first test, and of each further one with its limit. */
enum { ASIDE_LEAST = 8, ASIDE_SHARE = 20, MORE = 8, MOST_SHARE = 128 };
enum { THINS_OUT = 2, FALLS_OFF = 32, TAKES_LEVELS = 16 };

static void count_digits(uint64_t *room, const struct numbers *n, unsigned shift, uint64_t above,
                         struct watch *watch)
{
    const unsigned width = voxel_bytes(n->type);
    const uint64_t range = n->greatest - n->least;
    struct task task = task_begin(watch, "outliers", n->count);
    memset(room, 0, OUTLIERS_ROOM * sizeof *room);
    for (size_t i = 0, end; i < n->count && task_advance(&task, PIECE); i = end)
        for (end = i + PIECE < n->count ? i + PIECE : n->count; i < end; i++) {
            const uint64_t key = order_at(n->at + width * i, n->type) - n->least;
            if (key <= range && key >> shift >> DIGIT == above)
                room[key >> shift & (OUTLIERS_ROOM - 1)]++;
        }
}

/* The order at a rank, found digit by digit. */
static uint64_t order_of_rank(const struct numbers *n, size_t rank, uint64_t *room,
                              struct watch *watch)
{
    uint64_t above = 0;
    unsigned shift = 0;
    while ((n->greatest - n->least) >> shift >> DIGIT)
        shift += DIGIT;
    for (;; shift -= DIGIT) {
        uint64_t digit = 0;
        count_digits(room, n, shift, above, watch);
        for (; digit + 1 < OUTLIERS_ROOM && rank >= room[digit]; digit++)
            rank -= room[digit];
        above = above << DIGIT | digit;
        if (shift == 0)
            return n->least + above;
    }
}

/* Half of a difference, which never overflows a double. */
static double half_width(const struct numbers *n, const uint64_t order[2])
{
    if (!order_is_real(n->type))
        return (double)(order[1] - order[0]) / 2;
    return order_number(order[1], n->type) / 2 - order_number(order[0], n->type) / 2;
}

/* A quick test that is sufficient for most scenes: more voxels than are removed are within the
 * lowest 16th of the range, and within the highest two fifths. */
static bool is_spread(const struct numbers *n, size_t aside, struct watch *watch)
{
    const unsigned width = voxel_bytes(n->type);
    const uint64_t ends[2] = {n->least, n->greatest};
    const double least = order_number(n->least, n->type) / 2, range = half_width(n, ends);
    const double greatest = order_number(n->greatest, n->type) / 2;
    const double low = least + range / 16, high = greatest - range * 2 / 5;
    struct task task = task_begin(watch, "outliers", n->count);
    size_t below = 0, above = 0;
    for (size_t i = 0, end; i < n->count && task_advance(&task, PIECE); i = end) {
        for (end = i + PIECE < n->count ? i + PIECE : n->count; i < end; i++) {
            const uint8_t *at = n->at + width * i;
            const double half = order_is_real(n->type)
                                    ? real_at(at, n->type == VOXEL_FLOAT64) / 2
                                    : order_number(order_at(at, n->type), n->type) / 2;
            below += half > least && half <= low;
            above += half >= high && half < greatest;
        }
        if (below > aside && above > aside)
            return true;
    }
    return false;
}

/* Insert an order into an ascending list and drop the last one; a descending list if `flip` has all
 * bits. */
static void insert_order(uint64_t *list, size_t last, uint64_t order, uint64_t flip)
{
    size_t i = last;
    for (; i > 0 && (list[i - 1] ^ flip) > (order ^ flip); i--)
        list[i] = list[i - 1];
    list[i] = order;
}

/* Compute the core for the first, small k; false if nothing remains. */
static bool put_first_aside(uint64_t core[2], const struct numbers *n, size_t k, uint64_t *room,
                            struct watch *watch)
{
    const unsigned width = voxel_bytes(n->type);
    uint64_t *lowest = room, *highest = room + k + 1;
    struct task task = task_begin(watch, "outliers", n->count);
    size_t between = 0;
    for (size_t i = 0; i <= k; i++) {
        lowest[i] = n->greatest;
        highest[i] = n->least;
    }
    for (size_t i = 0, end; i < n->count && task_advance(&task, PIECE); i = end)
        for (end = i + PIECE < n->count ? i + PIECE : n->count; i < end; i++) {
            const uint64_t order = order_at(n->at + width * i, n->type);
            if (order <= n->least || order >= n->greatest)
                continue;
            between++;
            if (order < lowest[k])
                insert_order(lowest, k, order, 0);
            if (order > highest[k])
                insert_order(highest, k, order, UINT64_MAX);
        }
    core[0] = lowest[k];
    core[1] = highest[k];
    return between > 2 * k && core[0] < core[1];
}

/* Return true if outliers use up the levels of the others, whose orders are core[0] .. core[1]
 * then. `room` is [OUTLIERS_ROOM] of scratch memory. Invalid if the watch (or NULL) stopped. */
static bool find_outliers(uint64_t core[2], const struct numbers *n, uint64_t *room,
                          struct watch *watch)
{
    const size_t count = n->count - n->odd, most = count / MOST_SHARE;
    const size_t share = count >> ASIDE_SHARE;
    const uint64_t ends[2] = {n->least, n->greatest};
    uint64_t next[2];
    size_t extreme[2] = {0, 0};
    size_t k = share > ASIDE_LEAST ? share : most < ASIDE_LEAST ? most : ASIDE_LEAST;
    if (n->least == n->greatest || is_spread(n, k, watch) ||
        !put_first_aside(core, n, k, room, watch))
        return false;
    double width = half_width(n, core);
    const double all = half_width(n, ends);
    if (width > all / THINS_OUT)
        return false;
    const unsigned bytes = voxel_bytes(n->type); /* count the ends of the range: */
    struct task task = task_begin(watch, "outliers", n->count);
    for (size_t i = 0, end; i < n->count && task_advance(&task, PIECE); i = end)
        for (end = i + PIECE < n->count ? i + PIECE : n->count; i < end; i++) {
            const uint64_t order = order_at(n->at + bytes * i, n->type);
            extreme[0] += order == n->least;
            extreme[1] += order == n->greatest;
        }
    for (k *= MORE; k > 0 && k <= most; k *= MORE) { /* the same by ranks */
        if (extreme[0] + k >= count || extreme[1] + k >= count - extreme[0] - k)
            break;
        next[0] = order_of_rank(n, extreme[0] + k, room, watch);
        next[1] = order_of_rank(n, count - 1 - extreme[1] - k, room, watch);
        if (next[0] >= next[1])
            break;
        const double less = half_width(n, next);
        if (less > width / THINS_OUT || less < width / FALLS_OFF)
            break;
        memcpy(core, next, sizeof next);
        width = less;
    }
    return width < all / TAKES_LEVELS;
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

/* Lane by lane, so that the compiler uses vectors. */
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

/* Subtract the least value if it is below 0; returns the subtracted value. */
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

/* A conversion to intensities in place: the two bytes of a voxel are never after its four or
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

/* Make the levels, unless by_extremes; levels->is_clamped if outliers cut the scale to a core. */
static enum err make_levels(uint64_t core[2], struct fitting *f, const struct numbers *numbers)
{
    if (f->volume->choice.by_extremes)
        return OK;
    OWNED(mem_release) uint64_t *room = mem_array(OUTLIERS_ROOM, sizeof *room);
    f->levels = f->volume->levels = mem_new(sizeof *f->levels);
    const bool fits = room && f->levels;
    for (size_t i = 0; fits && i < LEVELS; i++)
        f->levels->level[i] = (struct level){INFINITY, -INFINITY};
    if (fits)
        f->levels->is_clamped = find_outliers(core, numbers, room, f->task->watch);
    return fits ? OK : fault_memory(f->fault, "the scale of the scene");
}

/* ---- wide whole numbers ---- */

/* Levels from `first` hold the numbers from `least` to `greatest`, `step` numbers each. */
struct steps {
    uint64_t least, greatest, step;
    uint16_t first;
};

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

static void convert_whole(const struct fitting *f, const struct steps *s)
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

/* ---- few distinct numbers ---- */

enum { DISTINCT_MOST = 65534, DISTINCT_ROOM = 1 << 18 };

/* Distinct orders, by open addressing, and their ranks. */
struct distinct {
    uint64_t order[DISTINCT_ROOM]; /* ORDER_NONE: free */
    uint16_t rank[DISTINCT_ROOM];
    uint64_t rising[DISTINCT_MOST];
    size_t count;
};

/* The place of an order, or a free one. */
static size_t find_slot(const struct distinct *d, uint64_t order)
{
    size_t at = hash_mix_at(order, 0) % DISTINCT_ROOM;
    while (d->order[at] != ORDER_NONE && d->order[at] != order)
        at = (at + 1) % DISTINCT_ROOM;
    return at;
}

/* Find the distinct numbers, and 0. False if they are too many. */
static bool find_distinct(struct distinct *d, const struct fitting *f)
{
    const unsigned width = voxel_bytes(f->type);
    uint64_t order = order_zero(f->type), before = ORDER_NONE;
    memset(d->order, 0xff, sizeof d->order);
    d->count = 0;
    for (size_t i = 0; i <= f->count; i++) {
        if (order == ORDER_NONE)
            return false;
        const size_t at = order == before ? 0 : find_slot(d, order);
        if (order != before && d->order[at] == ORDER_NONE) {
            if (d->count == DISTINCT_MOST)
                return false;
            d->order[at] = d->rising[d->count++] = order;
        }
        before = order;
        if (i % PIECE == 0 && !task_advance(f->task, PIECE))
            return true;
        order = i < f->count ? order_at(f->from + width * i, f->type) : before;
    }
    return true;
}

/* Convert to the ranks of few distinct numbers; *fits is false if they are too many. */
static enum err fit_distinct(bool *fits, const struct fitting *f)
{
    const unsigned width = voxel_bytes(f->type);
    struct volume *volume = f->volume;
    OWNED(mem_release) struct distinct *d = mem_new(sizeof *d);
    *fits = d && find_distinct(d, f);
    if (*fits)
        volume->value = mem_array(d->count, sizeof *volume->value);
    if (!d || (*fits && !volume->value))
        return fault_memory(f->fault, "a map");
    if (!*fits)
        return OK;
    qsort(d->rising, d->count, sizeof *d->rising, sort_compare);
    volume->values = (uint32_t)d->count;
    for (size_t i = 0; i < d->count; i++) {
        d->rank[find_slot(d, d->rising[i])] = (uint16_t)i;
        volume->value[i] = order_number(d->rising[i], f->type);
    }
    for (size_t i = 0, end; i < f->count && task_advance(f->task, PIECE); i = end)
        for (end = i + PIECE < f->count ? i + PIECE : f->count; i < end; i++)
            volume->intensity[i] = d->rank[find_slot(d, order_at(f->from + width * i, f->type))];
    return OK;
}

static enum err fit_whole(struct way_back *back, struct fitting *f)
{
    const unsigned width = voxel_bytes(f->type);
    const uint64_t zero = order_zero(f->type);
    struct numbers numbers = {f->from, f->count, f->type, 0, UINT64_MAX, 0};
    uint64_t core[2];
    for (size_t i = 0, end; i < f->count && task_advance(f->task, PIECE); i = end)
        for (end = i + PIECE < f->count ? i + PIECE : f->count; i < end; i++) {
            const uint64_t order = order_at(f->from + width * i, f->type);
            numbers.least = order < numbers.least ? order : numbers.least;
            numbers.greatest = order > numbers.greatest ? order : numbers.greatest;
        }
    struct steps steps = {numbers.least, numbers.greatest, 1, 0};
    if (steps.least >= zero && steps.greatest - zero <= UINT16_MAX)
        steps.least = zero;
    if (steps.greatest - steps.least > UINT16_MAX && steps.least >= zero &&
        f->volume->choice.by_extremes) {
        bool fits;
        TRY(fit_distinct(&fits, f));
        if (fits)
            return OK;
    }
    if (steps.greatest - steps.least > UINT16_MAX) {
        steps.step = (steps.greatest - steps.least - 1) / UINT16_MAX + 1;
        TRY(make_levels(core, f, &numbers));
    }
    const bool is_clamped = f->levels && f->levels->is_clamped;
    if (is_clamped)
        steps = steps_around(core, &numbers);
    const double least = order_number(steps.least, f->type);
    const double greatest = order_number(steps.greatest, f->type);
    const double most = fmax(fabs(least), fabs(greatest));
    if (f->levels) {
        f->levels->ends[0] = least;
        f->levels->ends[1] = greatest;
    }
    convert_whole(f, &steps);
    f->volume->is_coarse = steps.step > 1 || is_clamped;
    if (steps.step > 1)
        volume_note(f->volume->notes,
                    "its values are %.17g to %.17g, more than a scene distinguishes: %" PRIu64
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

/* Return true if all numbers are whole; most scenes fail among the first voxels. */
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

/* Convert a piece that fits the cache. Halves keep the range of the widest doubles finite. */
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

static inline void convert_reals(const struct fitting *f, const struct line *line, bool is_double)
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

/* Find the scale: whole numbers that fit have a level each, others may be cut. */
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
    *line = (struct line){extent->low, extent->high, 0, LEVELS - 1};
    if (is_exact(f, extent)) {
        line->low = extent->low >= 0 && extent->high <= UINT16_MAX ? 0 : extent->low;
        line->high = line->low + UINT16_MAX;
        return OK;
    }
    if (range == 0 || f->volume->choice.by_extremes)
        return OK;
    TRY(make_levels(core, f, &numbers));
    if (f->levels->is_clamped) {
        const double low = order_number(core[0], f->type), high = order_number(core[1], f->type);
        *line = (struct line){fmax(extent->low, low - (high - low)),
                              fmin(extent->high, high + (high - low)), 1, LEVELS - 3};
    }
    f->levels->ends[0] = line->low;
    f->levels->ends[1] = line->high;
    return OK;
}

static enum err fit_reals(struct way_back *back, struct fitting *f)
{
    const bool is_double = f->type == VOXEL_FLOAT64;
    const struct extent extent = is_double ? find_extent(f->from, f->count, true, f->task)
                                           : find_extent(f->from, f->count, false, f->task);
    struct line line;
    TRY(find_line(&line, &extent, f));
    if (is_double)
        convert_reals(f, &line, true);
    else
        convert_reals(f, &line, false);
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

/* Convert numbers of the file to real values, which rise where the numbers fall if the slope is
 * negative. */
static void make_real(struct levels *levels, const struct geometry *of_file)
{
    const bool falls = of_file->slope < 0;
    for (size_t i = 0; i < LEVELS; i++) {
        const struct level was = levels->level[i];
        if (was.least <= was.greatest)
            levels->level[i] =
                (struct level){geometry_value(of_file, falls ? was.greatest : was.least),
                               geometry_value(of_file, falls ? was.least : was.greatest)};
    }
    const double low = geometry_value(of_file, levels->ends[0]);
    const double high = geometry_value(of_file, levels->ends[1]);
    const size_t below = levels->beyond[0];
    levels->ends[0] = falls ? high : low;
    levels->ends[1] = falls ? low : high;
    levels->beyond[0] = falls ? levels->beyond[1] : below;
    levels->beyond[1] = falls ? below : levels->beyond[1];
}

/* Note a clamped scale, and fewer levels than a scene of bytes has if some have several numbers. */
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
                    "outliers: the scale is %g to %g; %zu voxel%s below and %zu above are clamped "
                    "to its ends",
                    levels->ends[0], levels->ends[1], levels->beyond[0],
                    levels->beyond[0] == 1 ? "" : "s", levels->beyond[1]);
    else if (of_several && taken < FEW)
        volume_note(volume->notes,
                    "a few outliers use up its levels: the other values have %zu levels, and one "
                    "is %g; without the outliers in the file they have more",
                    taken, levels->step);
}

/* ---- all ---- */

enum err quantise(struct volume *volume, const struct volume_header *header, struct watch *watch,
                  struct fault *fault)
{
    const size_t count = voxels_in(header->size);
    const enum voxel_type type = header->type;
    const unsigned width = voxel_bytes(type);
    struct task task = task_begin(watch, "intensities", 3 * (uint64_t)count);
    struct way_back back = {1, 0};
    uint8_t *at = (uint8_t *)volume->intensity;
    struct fitting fitting = {volume, at, count, type, &task, fault, NULL};
    enum err err = OK;
    for (size_t i = 0, n; i < count && task_advance(&task, PIECE); i += n) {
        n = count - i < PIECE ? count - i : PIECE;
        voxels_reorder(at + i * width, n, type, header->big_endian);
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
    for (size_t i = 0; !err && i < volume->values; i++)
        volume->value[i] = geometry_value(&header->geometry, volume->value[i]);
    if (err || !volume->levels)
        return err;
    const bool is_scaled = header->geometry.slope != 1 || header->geometry.intercept != 0;
    volume->levels->is_single = type == VOXEL_FLOAT32 && !is_scaled;
    volume->levels->step = fabs(volume->geometry.slope);
    make_real(volume->levels, &header->geometry);
    note_levels(volume);
    return OK;
}
