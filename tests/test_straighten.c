/* SPDX-License-Identifier: MIT */
/* Straightened volumes of sheared axes: every voxel compared with the file's voxels around its
 * place in the world. */
#include "tests/check_main.h"
#include "stopping.h"

#include <math.h>

#include "base/file.h"
#include "engine/grid.h"
#include "image/image_inside.h"
#include "image/volume.h"

static uint64_t state = 1;
static double between(double low, double high)
{
    return low + (high - low) * check_below(&state, 1000001) / 1e6;
}

/* ---- volumes ---- */

/* Grey values that are linear in the world's coordinates. */
static double value_at(const double mm[3])
{
    return 30000 + 211 * mm[0] - 157 * mm[1] + 93 * mm[2];
}

/* Oblique axes of three spacings; `second` and `third` lean by parts of the axes before them. */
static void place(struct geometry *geometry, const int order[3], const double lean[3])
{
    static const double axis[3][3] = {
        {0.96, -0.28, 0}, {0.2688, 0.9216, -0.28}, {0.0784, 0.2688, 0.96}};
    static const double spacing[3] = {0.75, 1, 2.5};
    double to_mm[3][4], column[3][3];
    for (int w = 0; w < 3; w++) {
        const double a = axis[w][0] * spacing[0], b = axis[w][1] * spacing[1];
        column[0][w] = a;
        column[1][w] = b + lean[0] * a;
        column[2][w] = axis[w][2] * spacing[2] + lean[1] * a + lean[2] * b;
        for (int i = 0; i < 3; i++)
            to_mm[w][order[i]] = column[i][w];
        to_mm[w][3] = 7 * w - 5;
    }
    *geometry = (struct geometry){.slope = 0.5, .intercept = -3};
    if (!CHECK(geometry_place(geometry, (const double(*)[4])to_mm, ORIENTATION_SFORM)))
        abort();
    memcpy(geometry->sform.to_mm, to_mm, sizeof to_mm);
    memcpy(geometry->qform.to_mm, to_mm, sizeof to_mm);
    geometry->sform.code = geometry->qform.code = 1;
    for (int a = 0; a < 3; a++)
        CHECK(geometry_spacing(&geometry->spacing_nm[a], geometry_step_mm(geometry, a)));
}

static struct volume volume_of(const uint32_t size[3], const struct geometry *geometry)
{
    struct volume volume = {.geometry = *geometry};
    memcpy(volume.size, size, sizeof volume.size);
    volume.intensity = malloc(sizeof *volume.intensity * size[0] * size[1] * size[2]);
    if (!volume.intensity)
        abort();
    uint16_t *to = volume.intensity;
    for (uint32_t z = 0; z < size[2]; z++)
        for (uint32_t y = 0; y < size[1]; y++)
            for (uint32_t x = 0; x < size[0]; x++) {
                double mm[3];
                geometry_point(geometry, (const uint32_t[3]){x, y, z}, mm);
                *to++ = (uint16_t)(value_at(mm) + 0.5);
            }
    return volume;
}

static uint16_t least_of(const struct volume *volume)
{
    uint16_t least = UINT16_MAX;
    for (size_t i = 0; i < (size_t)volume->size[0] * volume->size[1] * volume->size[2]; i++)
        least = volume->intensity[i] < least ? volume->intensity[i] : least;
    return least;
}

/* ---- stories ---- */

/* Expected value at a place of the world: linear inside the file's voxels, the nearest slice up to
 * half a voxel outside, and the least value beyond. NAN near that limit, where either is right. */
static double expected_at(const double mm[3], const struct volume *from, uint16_t least)
{
    const struct geometry *geometry = &from->geometry;
    double along[3], at[3], clamped[3] = {0};
    for (int w = 0; w < 3; w++)
        along[w] = mm[w] - geometry->to_mm[w][3];
    geometry_solve(geometry, along, at);
    for (int a = 0; a < 3; a++) {
        const double beyond = fmax(-at[a], at[a] - (from->size[a] - 1));
        if (fabs(beyond - 0.5) < 1e-4)
            return NAN;
        if (beyond > 0.5)
            return least;
        at[a] = fmin(fmax(at[a], 0), from->size[a] - 1);
    }
    for (int w = 0; w < 3; w++)
        clamped[w] = geometry->to_mm[w][0] * at[0] + geometry->to_mm[w][1] * at[1] +
                     geometry->to_mm[w][2] * at[2] + geometry->to_mm[w][3];
    return value_at(clamped);
}

static double box_mm3(const struct geometry *geometry)
{
    return geometry_fill(geometry) * (geometry->spacing_nm[0] / 1e6) *
           (geometry->spacing_nm[1] / 1e6) * (geometry->spacing_nm[2] / 1e6);
}

static void is_straight(const struct volume *is, const struct volume *from)
{
    const uint16_t least = least_of(from), *at = is->intensity;
    size_t wrong = 0, inside = 0;
    CHECK(geometry_shear(&is->geometry) < 1e-5);
    CHECK(fabs(box_mm3(&is->geometry) / box_mm3(&from->geometry) - 1) < 1e-5);
    for (uint32_t z = 0; z < is->size[2]; z++)
        for (uint32_t y = 0; y < is->size[1]; y++)
            for (uint32_t x = 0; x < is->size[0]; x++, at++) {
                double mm[3];
                geometry_point(&is->geometry, (const uint32_t[3]){x, y, z}, mm);
                const double expected = expected_at(mm, from, least);
                wrong += fabs(*at - expected) > 1.1;
                inside += *at != least;
            }
    CHECK_INT(wrong, 0);
    CHECK(inside >= (size_t)from->size[0] * from->size[1] * from->size[2] / 2);
    CHECK(memcmp(is->geometry.sform.to_mm, is->geometry.to_mm, sizeof is->geometry.to_mm) == 0);
    CHECK(!is->geometry.fields.given);
}

static void straighten_one(const int order[3], const double lean[3])
{
    const uint32_t size[3] = {9, 12, 7};
    struct geometry geometry;
    struct fault fault = {0};
    uint32_t foretold[3];
    place(&geometry, order, lean);
    OWNED(volume_release)
    struct volume from = volume_of(size, &geometry), is = volume_of(size, &geometry);
    CHECK_INT(straighten_size(foretold, size, &geometry, &fault), OK);
    if (CHECK(straighten(&is, NULL, &fault) == OK)) {
        CHECK(same_size(is.size, foretold));
        is_straight(&is, &from);
        CHECK_HAS(is.notes, "straightened: its axes were");
    }
}

static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};

STORY(a_gantry_that_leans_either_way_and_randomly_sheared_axes)
{
    for (int o = 0; o < 6; o++)
        for (int degrees = -30; degrees <= 30; degrees += 5) {
            const double lean[3] = {0, 0, 2.5 * tan(degrees * acos(-1) / 180)};
            if (degrees)
                straighten_one(orders[o], lean);
        }
    for (int n = 0; n < 300; n++) {
        const double lean[3] = {between(-0.3, 0.3), between(-1, 1), between(-1, 1)};
        straighten_one(orders[n % 6], lean);
    }
}

STORY(slices_that_are_aligned_or_shifted_by_whole_voxels_are_unchanged)
{
    const uint32_t size[3] = {5, 6, 4};
    for (unsigned shift = 0; shift < 2; shift++) { /* voxels per slice */
        struct geometry geometry;
        struct fault fault = {0};
        place(&geometry, (const int[]){0, 1, 2}, (const double[]){0, 0, shift});
        OWNED(volume_release)
        struct volume from = volume_of(size, &geometry), is = volume_of(size, &geometry);
        CHECK_INT(straighten(&is, NULL, &fault), OK);
        const uint32_t rows = shift ? 9 : 6;
        CHECK(same_size(is.size, (const uint32_t[3]){5, rows, 4}));
        for (uint32_t z = 0; z < 4; z++)
            CHECK(memcmp(is.intensity + z * (rows + shift) * 5, from.intensity + z * 30, 60) == 0);
        if (!shift)
            CHECK_HAS(is.notes, "its axes are at right angles: nothing to straighten");
    }
}

STORY(too_much_shear_is_refused_and_a_stop_changes_nothing)
{
    const int order[3] = {0, 1, 2};
    const double far[3] = {0, 300, 0}, lean[3] = {0, 0, 0.7};
    const uint32_t size[3] = {5, 6, 40};
    struct geometry geometry;
    struct fault fault = {0};
    place(&geometry, order, far);
    struct volume is = volume_of((const uint32_t[3]){5, 6, 2}, &geometry);
    CHECK_INT(straighten_size(is.size, size, &geometry, &fault), ERR_LIMIT);
    CHECK_HAS(fault.text, "it would be more than 8 times as large");
    volume_release(&is);
    place(&geometry, order, lean);
    bool finishes = false;
    for (int most = 0; !finishes; most++) {
        int looks = most;
        struct watch watch = {.context = &looks, .poll = stop_after_looks};
        OWNED(volume_release) struct volume from = volume_of(size, &geometry);
        is = volume_of(size, &geometry);
        finishes = straighten(&is, &watch, &fault) == OK;
        if (!finishes) {
            CHECK(same_size(is.size, size) && memcmp(is.intensity, from.intensity, 2400) == 0);
        }
        volume_release(&is);
    }
}
