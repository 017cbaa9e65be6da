#include "image/intensities.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "image/voxels.h"

enum { PIECE = 1 << 16 /* values between two looks at the watch */ };

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

/* ---- the way back ---- */

/* Number of the file = factor * intensity + least. */
struct way_back {
    double factor, least;
};

/* ---- wide whole numbers ---- */

static bool is_signed(enum voxel_type type)
{
    return type == VOXEL_INT8 || type == VOXEL_INT16 || type == VOXEL_INT32 || type == VOXEL_INT64;
}

static uint64_t zero_of(enum voxel_type type)
{
    return is_signed(type) ? UINT64_C(1) << 63 : 0;
}

/* The whole number at `at` with 2^63 added where its type is signed: all in one order. */
static inline uint64_t ordered(const uint8_t *at, enum voxel_type type)
{
    uint64_t wide;
    uint32_t narrow;
    if (type == VOXEL_INT64 || type == VOXEL_UINT64) {
        memcpy(&wide, at, sizeof wide);
        return wide ^ zero_of(type);
    }
    memcpy(&narrow, at, sizeof narrow);
    return type == VOXEL_INT32 ? (uint64_t)(int64_t)(int32_t)narrow ^ zero_of(type) : narrow;
}

static double number_of(uint64_t order, enum voxel_type type)
{
    return order < zero_of(type) ? -(double)(zero_of(type) - order)
                                 : (double)(order - zero_of(type));
}

/* In place: a voxel's two bytes never lie after its four or eight. */
static struct way_back fit_whole(struct volume *volume, size_t count, enum voxel_type type,
                                 struct task *task)
{
    const unsigned width = voxel_bytes(type);
    const uint8_t *from = (const uint8_t *)volume->intensity;
    uint64_t least = UINT64_MAX, greatest = 0;
    for (size_t i = 0, end; i < count && task_advance(task, PIECE); i = end)
        for (end = i + PIECE < count ? i + PIECE : count; i < end; i++) {
            const uint64_t order = ordered(from + width * i, type);
            least = order < least ? order : least;
            greatest = order > greatest ? order : greatest;
        }
    if (least >= zero_of(type) && greatest - zero_of(type) <= UINT16_MAX)
        least = zero_of(type);
    const uint64_t range = greatest - least;
    const uint64_t step = range <= UINT16_MAX ? 1 : (range - 1) / UINT16_MAX + 1;
    for (size_t i = 0, end; i < count && task_advance(task, PIECE); i = end)
        for (end = i + PIECE < count ? i + PIECE : count; i < end; i++) {
            const uint64_t above = ordered(from + width * i, type) - least;
            volume->intensity[i] =
                (uint16_t)(step == 1 ? above : above / step + (above % step >= step - step / 2));
        }
    volume->is_coarse = step > 1;
    if (step > 1)
        volume_note(volume->notes,
                    "its values are %.17g to %.17g, more than a scene tells apart: %" PRIu64
                    " of them are one intensity",
                    number_of(least, type), number_of(greatest, type), step);
    return (struct way_back){(double)step, number_of(least, type)};
}

/* ---- floating point ---- */

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

/* In place, as above. Halves keep the range of the widest doubles finite. */
static inline void spread(uint16_t *to, size_t count, const struct extent *extent, bool is_double,
                          struct task *task)
{
    const uint8_t *from = (const uint8_t *)to;
    const double half = isfinite(extent->high - extent->low) ? 1 : 0.5;
    const double base = extent->low * half, range = extent->high * half - base;
    for (size_t i = 0, end; i < count && task_advance(task, PIECE); i = end)
        for (end = i + PIECE < count ? i + PIECE : count; i < end; i++) {
            const double value = real_at(from + (is_double ? 8 : 4) * i, is_double);
            const double part = range > 0 && isfinite(value) ? (value * half - base) / range : 0;
            to[i] = (uint16_t)(part * 65535 + 0.5);
        }
}

static struct way_back fit_reals(struct volume *volume, size_t count, enum voxel_type type,
                                 struct task *task)
{
    const uint8_t *from = (const uint8_t *)volume->intensity;
    struct extent extent;
    if (type == VOXEL_FLOAT64) {
        extent = find_extent(from, count, true, task);
        spread(volume->intensity, count, &extent, true, task);
    } else {
        extent = find_extent(from, count, false, task);
        spread(volume->intensity, count, &extent, false, task);
    }
    if (extent.odd)
        volume_note(volume->notes, "%zu voxel%s no number or infinite: taken for %g", extent.odd,
                    extent.odd == 1 ? " is" : "s are", extent.low);
    const double factor = extent.high / 65535 - extent.low / 65535;
    const double range = extent.high - extent.low;
    return (struct way_back){range > 0 ? isfinite(range) ? range / 65535 : factor : 1, extent.low};
}

void intensities_make(struct volume *volume, const struct volume_header *header,
                      struct watch *watch)
{
    const size_t count = (size_t)header->size[0] * header->size[1] * header->size[2];
    const enum voxel_type type = header->type;
    const unsigned width = voxel_bytes(type);
    struct task task = task_begin(watch, "intensities", 3 * (uint64_t)count);
    struct way_back back = {1, 0};
    uint8_t *at = (uint8_t *)volume->intensity;
    for (size_t i = 0, n; i < count && task_advance(&task, PIECE); i += n) {
        n = count - i < PIECE ? count - i : PIECE;
        intensities_reorder(at + i * width, n, type, header->big_endian);
    }
    if (width == 1)
        widen_bytes(volume->intensity, count, is_signed(type), &task);
    if (type == VOXEL_INT16 || type == VOXEL_INT8)
        back.least = shift_signed(volume->intensity, count, &task);
    else if (type == VOXEL_FLOAT32 || type == VOXEL_FLOAT64)
        back = fit_reals(volume, count, type, &task);
    else if (width > 2)
        back = fit_whole(volume, count, type, &task);
    volume->geometry.intercept = header->geometry.slope * back.least + header->geometry.intercept;
    volume->geometry.slope = header->geometry.slope * back.factor;
}
