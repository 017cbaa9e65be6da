/*
 * A part of many journals, for several machines that share the work: "2/5" is the second of five.
 *
 * Which part a journal belongs to follows from the SHA-256 of its bytes, and from nothing else: not
 * from its place in the list, so that a journal which is added moves no other; and not from its
 * path, so that machines which keep it in different places agree. So every journal is in exactly
 * one part. One that cannot be read is in all of them, where it fails.
 */
#ifndef VERIFY_SHARD_H
#define VERIFY_SHARD_H

#include <stdbool.h>
#include <stddef.h>

#include "base/err.h"

enum { SHARDS_MOST = 10000 };

struct shard {
    unsigned number, of; /* 1..of; of is 0 where there are no parts */
};

/* Reads "K/N"; false where it is none. */
bool shard_read(struct shard *shard, const char *text);

bool shard_has(const struct shard *shard, const char *path);

/* Moves the journals of the shard to the front, in their order, with what stands beside them in
 * `other` (or NULL); how many they are. */
size_t shard_choose(const struct shard *shard, char **path, char **other, size_t count);

#endif
