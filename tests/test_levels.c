/* SPDX-License-Identifier: MIT */
/* Levels: numbers as users write them; which scale real and wide whole numbers get, against the
 * rule read plainly off sorted numbers; ranges, against the numbers of the file. */
#include "tests/check_main.h"

#include <math.h>

#include "image/image_inside.h"
#include "image/volume.h"

DRAW_FROM(28)

/* 0..1, of 20 bits */
static double part(void)
{
    return below(1u << 20) / 1048576.0;
}

/* ---- decimals ---- */

static struct decimal decimal(const char *text)
{
    struct decimal out = {1, 1, 1};
    const char *at = text;
    CHECK(decimal_scan(&at, &out) && *at == '\0');
    return out;
}

static const char *written(const struct decimal *d)
{
    static struct buf out;
    buf_clear(&out);
    decimal_write(&out, d);
    return buf_text(&out);
}

STORY(a_number_is_taken_as_it_is_written_and_written_one_way)
{
    static const struct {
        const char *text, *written;
        double value;
    } row[] = {
        {"0", "0", 0},
        {"-0.000", "0", 0},
        {"40", "40", 40},
        {"1200.500", "1200.5", 1200.5},
        {"-0.05", "-0.05", -0.05},
        {"1e3", "1000", 1000},
        {"1.5e-3", "0.0015", 0.0015},
        {"2.5E+6", "2500000", 2.5e6},
        {"0.00000000000015", "1.5e-13", 1.5e-13},
        {"1e20", "1e20", 1e20},
        {"-12345e300", "-1.2345e304", -1.2345e304},
        {"9223372036854775807", "9223372036854775807", 9223372036854775807.0},
        {"18446744073709551615", "18446744073709551615", 18446744073709551615.0},
        {"10000000000000000000000", "1e22", 1e22},
        {"0.7", "0.7", 0.7},
    };
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        const struct decimal d = decimal(row[i].text), again = decimal(row[i].written);
        CHECK_TEXT(written(&d), row[i].written);
        CHECK(memcmp(&d, &again, sizeof d) == 0 && decimal_value(&d) == row[i].value);
    }
    static const char *const wrong[] = {"",      "-",      ".5",    "+5",  "e5",
                                        "1e400", "1e-400", "1e309", "nan", "99999999999999999999"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        const char *at = wrong[i];
        struct decimal d;
        CHECK(!decimal_scan(&at, &d) && at == wrong[i]);
    }
    const char *at = "1..2";
    struct decimal one;
    CHECK(decimal_scan(&at, &one) && strcmp(at, "..2") == 0);
}

STORY(decimals_of_whole_units_and_of_doubles)
{
    for (int i = 0; i < 20000; i++) {
        const int64_t units = (int64_t)check_random(&seed) >> below(63);
        const struct decimal d = decimal_of(units, 3), same = decimal(written(&d));
        CHECK(memcmp(&d, &same, sizeof d) == 0);
        if (llabs(units) < INT64_C(1) << 53) /* as ranges were before */
            CHECK(decimal_value(&d) == (double)units / 1000);
        const double value = ldexp(part() - 0.5, (int)below(100) - 50);
        const struct decimal near = decimal_near(value, 17);
        CHECK(decimal_value(&near) == value);
    }
    const struct decimal least = decimal_of(INT64_MIN, 3);
    CHECK_TEXT(written(&least), "-9223372036854775.808");
}

/* ---- scenes of a row of voxels ---- */

enum { MOST = 20000 };
static double number[MOST]; /* of the file */

static void put_number(uint8_t *at, enum voxel_type type, double value)
{
    const float narrow = (float)value;
    const int64_t wide = type <= VOXEL_UINT64 && value < 9e18 ? (int64_t)value : 0;
    const uint64_t whole = type == VOXEL_UINT64 ? (uint64_t)value : (uint64_t)wide;
    const uint32_t low = (uint32_t)whole;
    if (type == VOXEL_FLOAT32)
        memcpy(at, &narrow, sizeof narrow);
    else if (type == VOXEL_FLOAT64)
        memcpy(at, &value, sizeof value);
    else if (voxel_bytes(type) == 4)
        memcpy(at, &low, sizeof low);
    else
        memcpy(at, &whole, sizeof whole);
}

/* A volume of small numbers, converted to the type. */
static struct volume make(enum voxel_type type, size_t count, double slope, bool by_extremes)
{
    struct volume_header header = {.size = {(uint32_t)count, 1, 1}, .type = type};
    struct volume v = {.size = {(uint32_t)count, 1, 1}};
    const unsigned width = voxel_bytes(type);
    uint8_t *bytes = malloc(count * width);
    v.choice.by_extremes = by_extremes;
    header.big_endian = __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__;
    header.geometry.slope = slope;
    v.geometry = header.geometry;
    for (size_t i = 0; i < count; i++) {
        number[i] = type == VOXEL_FLOAT32   ? (double)(float)number[i]
                    : type == VOXEL_FLOAT64 ? number[i]
                                            : floor(number[i]);
        put_number(bytes + i * width, type, number[i]);
    }
    v.intensity = (uint16_t *)(void *)bytes;
    CHECK_INT(quantise(&v, &header, NULL, NULL), OK);
    return v;
}

static double value_of(const struct volume *v, size_t i)
{
    return geometry_value(&v->geometry, v->intensity[i]);
}

/* ---- the rule, read plainly ---- */

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

struct sorted {
    double x[MOST], low, high;
    size_t count, at_low, at_high;
};

static void sort(struct sorted *s, size_t count)
{
    *s = (struct sorted){.count = 0};
    for (size_t i = 0; i < count; i++)
        if (isfinite(number[i]))
            s->x[s->count++] = number[i];
    if (!s->count)
        return;
    qsort(s->x, s->count, sizeof *s->x, compare);
    s->low = s->count < count && s->x[0] > 0 ? 0 : s->x[0];
    s->high = s->x[s->count - 1];
    for (size_t i = 0; i < s->count; i++) {
        s->at_low += s->x[i] == s->low;
        s->at_high += s->x[i] == s->high;
    }
}

/* T(k), between core[0] and core[1]; 0 for nothing. */
static double left(const struct sorted *s, size_t k, double core[2])
{
    if (s->at_low + s->at_high + 2 * k >= s->count)
        return 0;
    core[0] = s->x[s->at_low + k];
    core[1] = s->x[s->count - 1 - s->at_high - k];
    return core[1] - core[0];
}

static bool has_outliers(const struct sorted *s, double core[2], unsigned *thinning)
{
    const size_t most = s->count / 128;
    size_t k = s->count >> 20 > 8 ? s->count >> 20 : 8;
    k = k < most || k > 8 ? k : most;
    double next[2], width = left(s, k, core);
    if (!(width > 0) || width > (s->high - s->low) / 2)
        return false;
    for (k *= 8; k && k <= most; k *= 8) {
        const double less = left(s, k, next);
        if (!(less > 0) || less > width / 2 || less < width / 32)
            break;
        memcpy(core, next, sizeof next);
        width = less;
        ++*thinning;
    }
    return width < (s->high - s->low) / 16;
}

/* ---- numbers of all kinds ---- */

enum { KINDS = 9 };
static void fill(unsigned kind, size_t count)
{
    const double scale = ldexp(1, (int)below(40) - 10), shift = below(2) ? 0 : scale * below(2000);
    for (size_t i = 0; i < count; i++) {
        const double p = part(), z = part() + part() + part() - 1.5;
        number[i] = kind == 0   ? p
                    : kind == 1 ? 1 / (p + 1e-6)             /* a tail, as quotients have */
                    : kind == 2 ? below(20) * 0.1            /* few numbers */
                    : kind == 3 ? (below(100) ? 0 : p)       /* mostly background */
                    : kind == 4 ? 7                          /* constant */
                    : kind == 5 ? (below(50) ? z * 1e-7 : p) /* a bright object in noise */
                    : kind == 6 ? (below(3) ? p : -9999)     /* a fill value */
                    : kind == 7 ? z / (fabs(z) + 1e-5) / (p + 1e-4)
                                : z;
        number[i] = number[i] * scale + shift;
    }
    for (uint32_t far = below(2) ? below(12) : 0; far > 0; far--)
        number[below((uint32_t)count)] = (below(2) ? -1 : 1) * ldexp(1 + part(), (int)below(60));
}

static const enum voxel_type types[] = {VOXEL_FLOAT32, VOXEL_FLOAT64, VOXEL_INT32,
                                        VOXEL_INT64,   VOXEL_UINT32,  VOXEL_UINT64};

static void fit_type(enum voxel_type type, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (type == VOXEL_UINT32 || type == VOXEL_UINT64)
            number[i] = fabs(number[i]);
        if (type == VOXEL_INT32)
            number[i] = fmod(number[i], 2147483648.0);
        if (type == VOXEL_UINT32)
            number[i] = fmod(number[i], 4294967296.0);
        if (fabs(number[i]) > 9e15) /* as the rule is read here, in double precision */
            number[i] = fmod(number[i], 9e15);
    }
}

static bool is_real(enum voxel_type type)
{
    return type == VOXEL_FLOAT32 || type == VOXEL_FLOAT64;
}

/* Every voxel is where the scale has it, and counted where it is beyond. */
static void check_scale(const struct volume *v, const struct levels *l, size_t count)
{
    size_t below = 0, above = 0;
    bool fits = true;
    for (size_t i = 0; i < count; i++) {
        const bool odd = !isfinite(number[i]);
        const bool is_below = l->is_clamped && (odd || number[i] < l->ends[0]);
        const bool is_above = l->is_clamped && !odd && number[i] > l->ends[1];
        below += is_below && !odd;
        above += is_above;
        fits &=
            is_below   ? v->intensity[i] == 0
            : is_above ? v->intensity[i] == LEVELS - 1
            : odd      ? v->intensity[i] == 0
                  : fabs(value_of(v, i) - number[i]) <= l->step * 0.5001 + fabs(number[i]) * 1e-15;
        fits &= odd || (l->level[v->intensity[i]].least <= number[i] &&
                        l->level[v->intensity[i]].greatest >= number[i]);
    }
    CHECK(fits);
    CHECK_INT(l->beyond[0], below);
    CHECK_INT(l->beyond[1], above);
}

STORY(the_scale_is_the_one_that_sorted_numbers_have)
{
    static struct sorted s;
    unsigned clamped = 0, kept = 0, thinning = 0;
    for (unsigned i = 0; i < 900; i++) {
        const enum voxel_type type = types[below(6)];
        const size_t count = 1 + below(below(3) ? MOST : 60);
        double core[2] = {0, 0};
        fill(i % KINDS, count);
        fit_type(type, count);
        for (size_t k = 0; is_real(type) && i % 5 == 0 && k < count; k += 1 + below(40))
            number[k] = below(2) ? NAN : INFINITY;
        struct volume v = make(type, count, 1, false);
        sort(&s, count);
        const double range = s.high - s.low;
        bool whole = true;
        for (size_t k = 0; k < s.count; k++)
            whole &= s.x[k] == floor(s.x[k]);
        if (s.count == 0 || range == 0 || (whole && range <= 65535)) {
            CHECK(!v.levels && !v.is_coarse); /* exact */
            for (size_t k = 0; k < count; k++)
                CHECK(!isfinite(number[k]) || value_of(&v, k) == number[k]);
            CHECK(!whole || v.geometry.slope == 1);
            volume_release(&v);
            continue;
        }
        if (!CHECK(v.levels != NULL))
            continue;
        const bool has = has_outliers(&s, core, &thinning);
        const double wide = core[1] - core[0], *ends = v.levels->ends;
        CHECK(v.levels->is_clamped == has);
        CHECK(has == (strstr(v.notes, "outliers: the scale is ") != NULL));
        clamped += has;
        kept += !has;
        if (has && is_real(type)) {
            CHECK(ends[0] == fmax(s.low, core[0] - wide) &&
                  ends[1] == fmin(s.high, core[1] + wide));
        } else if (has) {
            CHECK(v.levels->step == fmax(1, ceil(wide / 65533)));
            CHECK(ends[0] <= core[0] && ends[0] >= fmax(s.low, core[0] - wide));
            CHECK(ends[1] >= core[1] && ends[1] <= fmin(s.high, core[1] + wide));
        } else {
            CHECK(ends[1] == s.high && (ends[0] == s.low || (ends[0] == 0 && s.low > 0)));
        }
        check_scale(&v, v.levels, count);
        volume_release(&v);
    }
    CHECK(clamped > 200 && kept > 100 && thinning > 25);
}

STORY(the_order_of_voxels_does_not_matter)
{
    for (unsigned i = 0; i < 60; i++) {
        const size_t count = 2000;
        fill(1 + i % 2 * 6, count);
        OWNED(volume_release) struct volume v = make(types[i % 2], count, 1, false);
        for (size_t k = count - 1; k > 0; k--) {
            const size_t other = below((uint32_t)k + 1);
            const double was = number[k];
            number[k] = number[other];
            number[other] = was;
        }
        OWNED(volume_release) struct volume w = make(types[i % 2], count, 1, false);
        CHECK(v.geometry.slope == w.geometry.slope && v.geometry.intercept == w.geometry.intercept);
        CHECK(levels_digest(v.levels) == levels_digest(w.levels));
        CHECK_TEXT(v.notes, w.notes);
    }
}

STORY(the_scale_of_a_map_is_from_the_least_to_the_greatest)
{
    for (unsigned i = 0; i < 200; i++) {
        const size_t count = 2 + below(MOST - 2);
        fill(i % KINDS, count);
        number[0] = number[1] - 1.5;
        OWNED(volume_release) struct volume v = make(types[i % 2], count, 1, true);
        bool are_whole = true; /* which may be exact */
        for (size_t k = 0; k < count; k++)
            are_whole &= number[k] == floor(number[k]);
        static struct sorted s;
        sort(&s, count);
        bool fits = true;
        const double range = s.high > s.low ? s.high - s.low : 1;
        for (size_t k = 0; k < count; k++)
            fits &= v.intensity[k] == (uint16_t)((number[k] - s.low) / range * 65535 + 0.5);
        CHECK((are_whole || (fits && v.geometry.intercept == s.low)) && !v.levels);
    }
}

/* ---- by hand ---- */

STORY(one_voxel_far_off_takes_no_levels_from_the_others)
{
    static const double far[] = {1e4, 1e20, -1e30};
    for (int i = 0; i < 3; i++) {
        for (unsigned k = 0; k < 2000; k++)
            number[k] = k / 2000.0;
        number[77] = far[i];
        OWNED(volume_release) struct volume v = make(VOXEL_FLOAT32, 2000, 1, false);
        CHECK(v.levels && v.levels->step < 1e-4 && fabs(value_of(&v, 1574) - 0.787) < 1e-4);
        CHECK_INT(v.intensity[77], far[i] < 0 ? 0 : 65535);
        CHECK_HAS(v.notes, far[i] < 0 ? "1 voxel below and 0 above are clamped to its ends\n"
                                      : "0 voxels below and 1 above are clamped to its ends\n");
    }
    for (unsigned k = 0; k < 4000; k++) /* CT, and 2e9 */
        number[k] = -1000 + (int)k;
    number[5] = 2e9;
    struct volume v = make(VOXEL_INT32, 4000, 1, false);
    CHECK(v.levels && v.levels->step == 1 && v.is_coarse && value_of(&v, 1234) == 234);
    volume_release(&v);
    for (unsigned k = 0; k < 2000; k++) /* a small bright object in noise keeps its levels */
        number[k] = k < 100 ? k / 100.0 : k * 1e-9;
    v = make(VOXEL_FLOAT32, 2000, 1, false);
    CHECK(v.levels && !v.levels->is_clamped && fabs(value_of(&v, 50) - 0.5) < 1e-4);
    volume_release(&v);
    for (unsigned k = 0; k < MOST; k++) /* one that thins out, and ends, too */
        number[k] = k < 40 ? pow(1 - k / 40.0, 3) : k * 1e-13;
    v = make(VOXEL_FLOAT32, MOST, 1, false);
    CHECK(v.levels && !v.levels->is_clamped && fabs(value_of(&v, 20) - 0.125) < 1e-4);
    volume_release(&v);
    for (unsigned k = 0; k < MOST; k++) /* many lie far apart: no scale fits all; reported */
        number[k] = k % 10 ? k / 20000.0 : 1e6 + k / 1e4;
    v = make(VOXEL_FLOAT32, MOST, 1, false);
    CHECK(v.levels && !v.levels->is_clamped);
    CHECK_HAS(v.notes, "without the outliers in the file they have more");
    volume_release(&v);
}

STORY(numbers_beyond_what_doubles_tell_apart_are_noted)
{
    for (unsigned k = 0; k < 100; k++)
        number[k] = 4503599627370496.0 * 256 + 65536.0 * k;
    OWNED(volume_release) struct volume v = make(VOXEL_INT64, 100, 1, false);
    CHECK_HAS(v.notes, "its values are beyond 2^53");
}

/* ---- ranges ---- */

static struct decimal near(double value)
{
    return decimal_near(value, 1 + below(9));
}

/* If no level is split, exactly the voxels whose number is in the range. A split level has numbers
 * on both sides. */
STORY(a_range_takes_the_voxels_whose_numbers_are_in_it)
{
    unsigned split = 0, exact = 0;
    for (unsigned i = 0; i < 900; i++) {
        const size_t count = 100 + below(MOST - 100);
        const enum voxel_type type = types[below(4)];
        const double slope = below(3) ? 1 : below(2) ? -0.5 : 2;
        fill(i % KINDS, count);
        fit_type(type, count);
        OWNED(volume_release) struct volume v = make(type, count, slope, false);
        double a = number[below((uint32_t)count)], b = number[below((uint32_t)count)];
        struct decimal range[2] = {near(slope * (a < b ? a : b)), near(slope * (a < b ? b : a))};
        if (decimal_value(&range[0]) > decimal_value(&range[1])) {
            const struct decimal was = range[0];
            range[0] = range[1];
            range[1] = was;
        }
        double low = decimal_value(&range[0]), high = decimal_value(&range[1]);
        if (v.levels && v.levels->is_single) {
            low = (double)(float)low;
            high = (double)(float)high;
        }
        const struct interval in = levels_within(&v.geometry, v.levels, range);
        size_t inside[2] = {0, 0}, outside[2] = {0, 0};
        bool fits = true;
        for (size_t k = 0; k < count; k++) {
            const bool is_in = slope * number[k] >= low && slope * number[k] <= high;
            if (!interval_splits(&in, v.intensity[k]))
                fits &= is_in == interval_holds(&in, v.intensity[k]);
            for (int e = 0; e < 2; e++) {
                inside[e] += v.intensity[k] == in.split[e] && is_in;
                outside[e] += v.intensity[k] == in.split[e] && !is_in;
            }
        }
        CHECK(fits);
        for (int e = 0; e < 2; e++) {
            const bool is_within = in.split[1] < 0; /* the range, perhaps, in the level */
            CHECK(in.split[e] < 0 || (outside[e] && (inside[e] || is_within)));
        }
        split += in.split[0] >= 0;
        exact += v.levels && in.split[0] < 0;
    }
    CHECK(split > 20 && exact > 200);
}

STORY(numbers_of_single_precision_are_compared_as_such)
{
    for (unsigned k = 0; k <= 1000; k++)
        number[k] = k / 100.0;
    OWNED(volume_release) struct volume v = make(VOXEL_FLOAT32, 1001, 1, false);
    for (unsigned k = 0; k <= 1000; k++) {
        const struct decimal range[2] = {decimal_of(k, 2), decimal_of(k, 2)};
        const struct interval in = levels_within(&v.geometry, v.levels, range);
        CHECK(in.split[0] < 0 && in.low == v.intensity[k] && in.high == v.intensity[k]);
    }
}

static const char *word(const struct volume *v, size_t i)
{
    static struct buf out;
    buf_clear(&out);
    levels_write(&out, &v->geometry, v->levels, v->intensity[i]);
    return buf_text(&out);
}

STORY(a_value_is_written_with_the_digits_that_tell_it_from_others)
{
    for (unsigned k = 0; k < 2000; k++)
        number[k] = 1000 + k / 2000.0;
    struct volume v = make(VOXEL_FLOAT64, 2000, 1, false);
    CHECK_TEXT(word(&v, 1001), "1000.5005");
    volume_release(&v);
    for (unsigned k = 0; k < 2000; k++)
        number[k] = 1234500000 + k;
    v = make(VOXEL_INT32, 2000, 1, false);
    CHECK_TEXT(word(&v, 67), "1234500067");
    volume_release(&v);
    for (unsigned k = 0; k < 3000; k++)
        number[k] = k < 2998 ? k / 3000.0 : 1e10 * k;
    v = make(VOXEL_FLOAT64, 3000, 1, false);
    CHECK_TEXT(word(&v, 2999), "2.998e+13..2.999e+13");
    v.levels->is_blended = true;
    CHECK_HAS(word(&v, 1500), " +-1.5e-05");
    CHECK(fabs(atof(word(&v, 1500)) - 0.5) < 5e-5);
    volume_release(&v);
}
