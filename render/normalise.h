/*
 * Normalising: many gradients at once, each to a vector of its direction and of one length.
 *
 * It is a third of the time that a large picture takes, so it is written as loops over arrays, of
 * products that the compiler does several at a time. There are integers only, and of these none
 * that would not come out the same one by one: normalise_one says what the result is, and
 * `test_normalise` that it is that.
 */
#ifndef RENDER_NORMALISE_H
#define RENDER_NORMALISE_H

#include <stdbool.h>
#include <stdint.h>

enum {
    NORMAL_BITS = 14, /* 1 of a normal's length */
    NORMALISED = 64,  /* at once: the pixels of a tile */
};

/* Along x, y, z; of each as many as are at once. */
struct gradients {
    int32_t along[3][NORMALISED]; /* above -2^31 */
};
struct directions {
    int16_t along[3][NORMALISED];
};

/* Of length 2^NORMAL_BITS; 0, 0, 0 where the gradient is, which has no direction. */
void normalise_all(struct directions *directions, const struct gradients *gradients);

/* The same of one gradient, of any size below 2^63; false, and nothing is set, where it is 0. */
bool normalise_one(int16_t direction[3], const int64_t gradient[3]);

#endif
