/*
 * Bytes put away: deflated, held by as many as need them, given back whole. For what is large and
 * seldom wanted again, such as the masks and weights of former states.
 */
#ifndef BASE_PACKED_H
#define BASE_PACKED_H

#include <stddef.h>

#include "base/err.h"

struct packed;

/* A copy of `length` bytes, held once. NULL when out of memory. */
struct packed *packed_new(const void *bytes, size_t length);

/* One holder more, or fewer: the last one frees it. Both take NULL. */
struct packed *packed_hold(struct packed *packed);
void packed_release(struct packed *packed);

/* Writes the bytes, as many as were put away, to `out`. ERR_MEMORY. */
enum err packed_take_out(const struct packed *packed, void *out, struct fault *fault);

/* How many were put away, and how many that takes. */
size_t packed_length(const struct packed *packed);
size_t packed_memory(const struct packed *packed);

#endif
