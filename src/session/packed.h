/* SPDX-License-Identifier: MIT */
/*
 * Packed bytes: an immutable value as large as a scene, deflated and shared by all its holders.
 * For what is large and rarely read again: the masks and the weights out of files of every state.
 *
 * Reading takes no memory of its own, so that a state can be gone back to when there is none left.
 */
#ifndef SESSION_PACKED_H
#define SESSION_PACKED_H

#include <stddef.h>

#include "base/err.h"
#include "base/watch.h"

struct packed;

/* A copy of `length` bytes, held once. ERR_MEMORY; ERR_CANCELLED by the watch, or NULL. */
enum err packed_new(struct packed **packed, const void *bytes, size_t length, struct watch *watch,
                    struct fault *fault);

/* One holder more, or fewer: the last one frees it. Both take NULL. */
struct packed *packed_hold(struct packed *packed);
void packed_release(struct packed *packed);

/* Reads the bytes in order, a piece at a time, PACKED_PIECE bytes or at the end fewer, each handed
 * to `take` once. ERR_MEMORY where the inflater needs more room than zlib is known to need;
 * ERR_CANCELLED by the watch, or NULL. */
enum { PACKED_PIECE = 16384 };
enum err packed_read(const struct packed *packed,
                     void (*take)(void *context, const void *piece, size_t length), void *context,
                     struct watch *watch, struct fault *fault);

/* Writes all the bytes, packed_length of them, to `out`. Errors as above. */
enum err packed_take_out(const struct packed *packed, void *out, struct watch *watch,
                         struct fault *fault);

/* How many bytes were packed, and how many they take now. */
size_t packed_length(const struct packed *packed);
size_t packed_memory(const struct packed *packed);

#endif
