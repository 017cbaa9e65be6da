/* SPDX-License-Identifier: MIT */
#include "image/image_inside.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "engine/grid.h"

enum { FRACTION_BITS = 30, WEIGHT_BITS = 15, SWELLS_MOST = 8 };
#define WHOLE (INT64_C(1) << FRACTION_BITS)

static const double SHEAR_LEAST = 0.1; /* degrees off a right angle */
static const double SAME = 1e-6;       /* tolerance of cosines, for files in single precision */

/* The order of the axes: `first` and `second` keep their plane. A voxel of the volume has the new
 * position second + second_by_third * third along the second axis, and first + first_by_second *
 * second + first_by_third * third along the first, in 2^-30 voxels; the result begins at `begin`,
 * in voxels. */
struct shear {
    int first, second, third;
    int64_t first_by_second, first_by_third, second_by_third;
    int64_t begin[3];
    uint32_t size[3];
};

static double product(const double to_mm[3][4], int a, int b)
{
    return to_mm[0][a] * to_mm[0][b] + to_mm[1][a] * to_mm[1][b] + to_mm[2][a] * to_mm[2][b];
}

static double cosine(const double to_mm[3][4], int a, int b)
{
    return fabs(product(to_mm, a, b)) / sqrt(product(to_mm, a, a) * product(to_mm, b, b));
}

/* Convert to fixed point; false on overflow. */
static bool to_fixed(int64_t *out, double voxels, double most)
{
    *out = (int64_t)floor(ldexp(fabs(voxels) <= most ? voxels : 0, FRACTION_BITS) + 0.5);
    return fabs(voxels) <= most;
}

/* Make the columns of the second and the third axis perpendicular to those before them. */
static void unshear(double to_mm[3][4], const struct shear *s)
{
    for (int w = 0; w < 3; w++) {
        double *row = to_mm[w];
        row[s->second] -= ldexp((double)s->first_by_second, -FRACTION_BITS) * row[s->first];
        row[s->third] -= ldexp((double)s->second_by_third, -FRACTION_BITS) * row[s->second] +
                         ldexp((double)s->first_by_third, -FRACTION_BITS) * row[s->first];
    }
}

/* Compute the size along an axis whose `count` voxels are shifted by `low`, 0 or less, to `high`.
 */
static void set_size(struct shear *s, int axis, uint32_t count, int64_t low, int64_t high)
{
    s->begin[axis] = -((WHOLE - 1 - low) / WHOLE);
    s->size[axis] = (uint32_t)((int64_t)count + (high + WHOLE - 1) / WHOLE - s->begin[axis]);
}

static int64_t below_zero(int64_t n)
{
    return n < 0 ? n : 0;
}

static enum err plan_shear(struct shear *s, const uint32_t size[3], const struct geometry *geometry,
                           struct fault *fault)
{
    struct grid grid;
    double m[3][4];
    memcpy(m, geometry->to_mm, sizeof m);
    *s = (struct shear){.first = 0, .second = 1, .third = 2};
    const double(*of)[4] = (const double(*)[4])m;
    const double room = 65534;
    if (cosine(of, 0, 2) + SAME < cosine(of, s->first, s->second))
        s->second = 2, s->third = 1;
    if (cosine(of, 1, 2) + SAME < cosine(of, s->first, s->second))
        s->first = 1, s->second = 2, s->third = 0;
    const int a = s->first, b = s->second, c = s->third;
    bool fits = to_fixed(&s->first_by_second, product(of, a, b) / product(of, a, a), 4);
    fits &= to_fixed(&s->first_by_third, product(of, a, c) / product(of, a, a), room / size[c]);
    struct shear only = *s; /* only the second axis is perpendicular so far */
    only.first_by_third = 0;
    unshear(m, &only);
    fits &= to_fixed(&s->second_by_third, product(of, b, c) / product(of, b, b), room / size[c]);
    const int64_t along_b = s->second_by_third * (size[c] - 1);
    const int64_t by_b = s->first_by_second * (size[b] - 1);
    const int64_t by_c = s->first_by_third * (size[c] - 1);
    set_size(s, a, size[a], below_zero(by_b) + below_zero(by_c),
             by_b + by_c - below_zero(by_b) - below_zero(by_c));
    set_size(s, b, size[b], below_zero(along_b), along_b - below_zero(along_b));
    set_size(s, c, size[c], 0, 0);
    const double voxels = (double)size[0] * size[1] * size[2];
    if (!fits || (double)s->size[0] * s->size[1] * s->size[2] > SWELLS_MOST * voxels)
        return fault_set(fault, ERR_LIMIT,
                         "straighten: its axes are %.2g degrees off a right angle: straightened, "
                         "it would be more than %d times as large",
                         geometry_shear(geometry), SWELLS_MOST);
    return grid_init(&grid, s->size, fault);
}

enum err straighten_size(uint32_t out[3], const uint32_t size[3], const struct geometry *geometry,
                         struct fault *fault)
{
    struct shear s;
    memcpy(out, size, 3 * sizeof *out);
    if (geometry_shear(geometry) < SHEAR_LEAST)
        return OK;
    TRY(plan_shear(&s, size, geometry, fault));
    memcpy(out, s.size, sizeof s.size);
    return OK;
}

/* ---- voxels ---- */

struct work {
    const struct shear *shear;
    const uint16_t *from;
    uint16_t *to;
    const uint32_t *size;
    size_t from_step[3], to_step[3]; /* voxels between neighbours */
    uint16_t beyond;                 /* intensity of voxels outside the slices */
    size_t count;                    /* number of such voxels */
};

/* Find the two neighbours of a position among `count` voxels, and the weight of the second. False
 * if the position is half a voxel or more outside. */
static bool find_neighbours(int64_t voxel[2], uint32_t *weight, int64_t at, uint32_t count)
{
    const int64_t last = ((int64_t)count - 1) * WHOLE;
    if (at < -WHOLE / 2 || at >= last + WHOLE / 2)
        return false;
    at = at < 0 ? 0 : at > last ? last : at;
    voxel[0] = at >> FRACTION_BITS;
    voxel[1] = voxel[0] < (int64_t)count - 1 ? voxel[0] + 1 : voxel[0];
    *weight = (uint32_t)((at & (WHOLE - 1)) >> (FRACTION_BITS - WEIGHT_BITS));
    return true;
}

/* Fill a row of the result along the first axis, at these positions along the others. */
static void straighten_row(struct work *work, int64_t second, int64_t third)
{
    const struct shear *s = work->shear;
    const int a = s->first, b = s->second, c = s->third;
    const int64_t at_b = second * WHOLE - s->second_by_third * third;
    const int64_t whole = at_b >> FRACTION_BITS, part = at_b & (WHOLE - 1);
    const int64_t lean =
        s->first_by_second * whole + ((s->first_by_second * part) >> FRACTION_BITS);
    int64_t at_a = s->begin[a] * WHOLE - lean - s->first_by_third * third;
    int64_t row[2] = {0, 0}, voxel[2];
    uint32_t by_b = 0, by_a;
    const bool is_inside = find_neighbours(row, &by_b, at_b, work->size[b]);
    const uint16_t *slice = work->from + (size_t)third * work->from_step[c];
    const uint16_t *near = slice + (size_t)row[0] * work->from_step[b];
    const uint16_t *far = slice + (size_t)row[1] * work->from_step[b];
    uint16_t *to = work->to + (size_t)(second - s->begin[b]) * work->to_step[b] +
                   (size_t)third * work->to_step[c];
    for (uint32_t i = 0; i < s->size[a]; i++, at_a += WHOLE, to += work->to_step[a]) {
        if (!is_inside || !find_neighbours(voxel, &by_a, at_a, work->size[a])) {
            *to = work->beyond;
            work->count++;
            continue;
        }
        const uint32_t one = 1U << WEIGHT_BITS;
        const size_t p = (size_t)voxel[0] * work->from_step[a];
        const size_t q = (size_t)voxel[1] * work->from_step[a];
        const uint64_t n = (uint64_t)near[p] * (one - by_a) + (uint64_t)near[q] * by_a;
        const uint64_t f = (uint64_t)far[p] * (one - by_a) + (uint64_t)far[q] * by_a;
        const uint64_t sum = n * (one - by_b) + f * by_b;
        *to = (uint16_t)((sum + (UINT64_C(1) << (2 * WEIGHT_BITS - 1))) >> (2 * WEIGHT_BITS));
    }
}

/* Change to the geometry of the result. False, without a change, if its spacing is no valid
 * distance. */
static bool place_result(struct geometry *geometry, const struct shear *s)
{
    const double begin[3] = {(double)s->begin[0], (double)s->begin[1], (double)s->begin[2]};
    const double as_it_is[3] = {1, 1, 1};
    struct geometry next = *geometry;
    unshear(next.to_mm, s);
    unshear(next.sform.to_mm, s);
    unshear(next.qform.to_mm, s);
    for (int a = 0; a < 3; a++) {
        const double shorter = geometry_step_mm(&next, a) / geometry_step_mm(geometry, a);
        if (!geometry_spacing(&next.spacing_nm[a], geometry->spacing_nm[a] / 1e6 * shorter))
            return false;
    }
    if (!geometry_derive(&next, begin, as_it_is) ||
        !geometry_place(&next, (const double(*)[4])next.to_mm, next.orientation))
        return false;
    *geometry = next;
    return true;
}

enum err straighten(struct volume *volume, struct watch *watch, struct fault *fault)
{
    struct shear s;
    const double degrees = geometry_shear(&volume->geometry);
    if (degrees < SHEAR_LEAST) {
        volume_note(volume->notes, volume->geometry.orientation == ORIENTATION_UNKNOWN
                                       ? "the orientation of its axes is unknown: not straightened"
                                       : "its axes are at right angles: nothing to straighten");
        return OK;
    }
    TRY(plan_shear(&s, volume->size, &volume->geometry, fault));
    uint16_t *out = mem_array((size_t)s.size[0] * s.size[1] * s.size[2], sizeof *out);
    if (!out)
        return fault_memory(fault, "a straightened volume");
    struct work work = {.shear = &s,
                        .from = volume->intensity,
                        .to = out,
                        .size = volume->size,
                        .beyond = volume->intensity[0]};
    const bool falls = volume->geometry.slope < 0;
    for (size_t i = 0; i < voxels_in(volume->size); i++) { /* the least real value */
        const uint16_t is = volume->intensity[i];
        work.beyond = (falls ? is > work.beyond : is < work.beyond) ? is : work.beyond;
    }
    for (int a = 0; a < 3; a++) {
        work.from_step[a] = a ? work.from_step[a - 1] * volume->size[a - 1] : 1;
        work.to_step[a] = a ? work.to_step[a - 1] * s.size[a - 1] : 1;
    }
    const uint32_t rows = s.size[s.second];
    struct task task = task_begin(watch, "straightening", (uint64_t)rows * s.size[s.third]);
    for (uint32_t third = 0; third < s.size[s.third]; third++)
        for (uint32_t y = 0; y < rows && task_advance(&task, 1); y++)
            straighten_row(&work, s.begin[s.second] + y, third);
    if (watch_stops(watch) || !place_result(&volume->geometry, &s)) {
        free(out);
        return watch_stops(watch) ? watch_fault(watch, fault)
                                  : fault_set(fault, ERR_INPUT,
                                              "straighten: its voxels would be no distance apart");
    }
    free(volume->intensity);
    volume->intensity = out;
    memcpy(volume->size, s.size, sizeof s.size);
    volume_note(volume->notes,
                "straightened: its axes were %.2g degrees off a right angle; slices are shifted in "
                "their planes, values linear between pixels; %zu voxels beyond them are %g",
                degrees, work.count, geometry_value(&volume->geometry, work.beyond));
    return OK;
}
