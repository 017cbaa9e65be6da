/*
 * Packed bytes: an immutable value as large as a scene, deflated and shared by all its holders.
 * For what is large and rarely read again: the masks and the weights out of files of every state.
 *
 * Reading takes no memory of its own, so that a state can be gone back to when there is none left.
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

/* Reads the bytes in order, `piece` at a time (the last piece may be shorter), each handed to
 * `take` once. ERR_MEMORY where the inflater needs more room than zlib is known to need. */
enum err packed_read(const struct packed *packed, void *piece, size_t length,
                     void (*take)(void *context, const void *piece, size_t length), void *context,
                     struct fault *fault);

/* Writes all the bytes, packed_length of them, to `out`. ERR_MEMORY as above. */
enum err packed_take_out(const struct packed *packed, void *out, struct fault *fault);

/* How many bytes were packed, and how many they take now. */
size_t packed_length(const struct packed *packed);
size_t packed_memory(const struct packed *packed);

#endif
