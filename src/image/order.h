/*
 * Orders: the numbers of a file as unsigned whole numbers that rise as they do, so that what is
 * asked of their order alone (the least, the thousandth) is answered without floating point.
 * Numbers that are equal have equal orders; what is no number, or infinite, has none.
 */
#ifndef IMAGE_ORDER_H
#define IMAGE_ORDER_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "image/volume.h"

/* Above every finite real number; of whole ones, the greatest of uint64 has it. */
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

/* Of a number that a real type has. */
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

/* Of the number at `at`, of 4 or 8 bytes. */
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

/* The number of an order, or what is nearest to it in double precision. */
static inline double order_number(uint64_t order, enum voxel_type type)
{
    const uint64_t zero = order_zero(type);
    if (!order_is_real(type))
        return order < zero ? -(double)(zero - order) : (double)(order - zero);
    const uint64_t bits = order >= zero ? order ^ zero : ~order;
    const uint32_t few = (uint32_t)bits;
    double value;
    float narrow;
    memcpy(&value, &bits, sizeof value);
    memcpy(&narrow, &few, sizeof narrow);
    return type == VOXEL_FLOAT32 ? (double)narrow : value;
}

#endif
